//! Progress on a terminal, and requests to stop.

use crate::failure::Failure;
use crate::folder::discard;
use crate::signals::{self, Request};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use torse::control::{Control, Progress};

/// Steps of the bar: fractions are shown to a tenth of a percent.
const STEPS: u64 = 1000;

/// The terminal's part in a long job: a bar that appears only where somebody sees it.
pub struct Terminal {
    bar: ProgressBar,
    control: Control,
    interrupted: Arc<AtomicBool>,
    /// Folder to remove if the program must end at once.
    unfinished: Arc<Mutex<Option<PathBuf>>>,
}

impl Terminal {
    /// A bar (hidden unless stderr is a terminal and the job is not quiet), and a control that feeds it and that Ctrl-C
    /// and its like cancel; a second request removes the unfinished folder and ends the program.
    pub fn new(quiet: bool, limit: Option<Duration>) -> Result<Self, Failure> {
        let bar = ProgressBar::new(STEPS);
        if quiet || !std::io::stderr().is_terminal() {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        if let Ok(style) = ProgressStyle::with_template("{msg:48!} [{bar:24}] {percent:>3}%  {elapsed}") {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.enable_steady_tick(Duration::from_millis(200));

        let (shown, pace) = (bar.clone(), Mutex::new(Pace::new()));
        let mut control = Control::with_progress(Arc::new(move |p: &Progress| {
            let text = if p.detail.is_empty() { p.stage.to_string() } else { format!("{}: {}", p.stage, p.detail) };
            let rest = pace.lock().unwrap_or_else(PoisonError::into_inner).rest(p.stage, p.fraction, Instant::now());
            shown.set_message(text + &left(rest));
            // What is counted within a stage without knowing its end leaves the bar where it is.
            if p.fraction > 0.0 {
                shown.set_position((p.fraction.clamp(0.0, 1.0) * STEPS as f64) as u64);
            }
        }));
        if let Some(limit) = limit {
            control = control.until(Instant::now() + limit);
        }

        let unfinished = Arc::new(Mutex::new(None::<PathBuf>));
        let (folder, cancel, seen) = (unfinished.clone(), control.clone(), bar.clone());
        let interrupted = signals::watch(move |request| match request {
            Request::End(status) => {
                let folder = folder.lock().unwrap_or_else(PoisonError::into_inner).take();
                if let Some(folder) = folder {
                    // What resists is left to the next run.
                    let _ = discard(&folder);
                }
                std::process::exit(status);
            }
            Request::Stop => {
                cancel.cancel();
                seen.suspend(|| {
                    if !quiet {
                        let _ = writeln!(
                            std::io::stderr(),
                            "stopping: writing what was found; press Ctrl-C again to stop at once"
                        );
                    }
                });
            }
        })
        .map_err(|e| Failure::new(format!("cannot watch for Ctrl-C: {e}"), ""))?;
        Ok(Self { bar, control, interrupted, unfinished })
    }

    /// The control to hand to the library.
    pub fn control(&self) -> &Control {
        &self.control
    }

    /// Shows what the program itself is doing.
    pub fn say(&self, message: &'static str) {
        self.bar.set_message(message);
    }

    /// Whether Ctrl-C or its like asked to stop.
    pub fn interrupted(&self) -> bool {
        self.interrupted.load(Ordering::SeqCst)
    }

    /// Names the folder to remove should the program have to end at once; `None` when it is complete.
    pub fn guard(&self, folder: Option<PathBuf>) {
        *self.unfinished.lock().unwrap_or_else(PoisonError::into_inner) = folder;
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// How fast a stage goes on. What comes after it nobody knows.
struct Pace {
    stage: String,
    /// When the stage began, and the share of it that was done then.
    begun: (Instant, f64),
    /// The share done that was heard of last.
    done: f64,
}

impl Pace {
    /// Time in a stage after which an estimate of its rest is worth something.
    const ESTIMATED: Duration = Duration::from_secs(4);
    /// Share of a stage of which the same is true.
    const LEAST: f64 = 0.05;

    fn new() -> Self {
        Self { stage: String::new(), begun: (Instant::now(), 0.0), done: 0.0 }
    }

    /// About how long the rest of a stage will take, once enough of it is done; a share that falls begins anew.
    fn rest(&mut self, stage: &str, done: f64, now: Instant) -> Option<Duration> {
        if self.stage != stage || done < self.done {
            (self.stage, self.begun) = (stage.to_owned(), (now, done));
        }
        self.done = done;
        let (since, share) = (now.saturating_duration_since(self.begun.0), done - self.begun.1);
        let told = since >= Self::ESTIMATED && share >= Self::LEAST && done < 1.0;
        told.then(|| since.mul_f64((1.0 - done) / share))
    }
}

/// The rest of a stage in words.
fn left(rest: Option<Duration>) -> String {
    match rest.map(|r| r.as_secs_f64()) {
        None => String::new(),
        Some(rest) if rest < 90.0 => format!(", {rest:.0} s more"),
        Some(rest) => format!(", {:.0} min more", rest / 60.0),
    }
}

/// An error leaves no bar behind either.
impl Drop for Terminal {
    fn drop(&mut self) {
        self.finish();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rest_of_a_stage_is_estimated_from_what_is_done_of_it() {
        let begun = Instant::now();
        let at = |s: u64| begun + Duration::from_secs(s);
        let mut pace = Pace::new();
        assert_eq!(pace.rest("read", 0.0, begun), None);
        // A new stage, long after the beginning of the job, knows nothing of its rest.
        assert_eq!(pace.rest("fit", 0.0, at(100)), None);
        assert_eq!(pace.rest("fit", 0.2, at(102)), None);
        assert_eq!(pace.rest("fit", 0.25, at(110)), Some(Duration::from_secs(30)));
        // What is begun again is estimated again, and what begins late by what is done of it since.
        assert_eq!(pace.rest("fit", 0.0, at(111)), None);
        assert_eq!(pace.rest("prove", 0.5, at(120)), None);
        assert_eq!(pace.rest("prove", 0.75, at(130)), Some(Duration::from_secs(10)));
        assert_eq!(pace.rest("prove", 1.0, at(140)), None);
    }

    #[test]
    fn long_rests_are_told_in_minutes() {
        assert_eq!(left(Some(Duration::from_secs(30))), ", 30 s more");
        assert_eq!(left(Some(Duration::from_secs(540))), ", 9 min more");
        assert_eq!(left(None), "");
    }
}
