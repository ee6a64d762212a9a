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
        set_style(&bar, PLAIN);
        bar.enable_steady_tick(Duration::from_millis(200));

        let (shown, stage) = (bar.clone(), Mutex::new(Stage::new()));
        let mut control = Control::with_progress(Arc::new(move |p: &Progress| {
            let mut stage = stage.lock().unwrap_or_else(PoisonError::into_inner);
            let message = stage.told(p, Instant::now());
            set_style(&shown, if stage.counted { COUNTED } else { PLAIN });
            shown.set_position((stage.done.clamp(0.0, 1.0) * STEPS as f64) as u64);
            shown.set_message(message);
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
        set_style(&self.bar, PLAIN);
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

/// The line of a stage of which a share is done.
const COUNTED: &str = "{msg:48!} [{bar:24}] {percent:>3}%  {elapsed}";
/// The line of a stage of which nobody knows how much is done.
const PLAIN: &str = "{msg:48!} {elapsed}";

fn set_style(bar: &ProgressBar, template: &str) {
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.progress_chars("=> "));
    }
}

/// What is being done, and how fast that goes on. What comes after it nobody knows.
struct Stage {
    name: String,
    /// What was said of the share done last.
    detail: String,
    /// Whether anything is known of the share done.
    counted: bool,
    /// When the stage began, and the share of it that was done then.
    begun: (Instant, f64),
    /// The share done that was heard of last.
    done: f64,
}

impl Stage {
    /// Time in a stage after which an estimate of its rest is worth something.
    const ESTIMATED: Duration = Duration::from_secs(4);
    /// Share of a stage of which the same is true.
    const LEAST_SHARE: f64 = 0.05;

    fn new() -> Self {
        Self { name: String::new(), detail: String::new(), counted: false, begun: (Instant::now(), 0.0), done: 0.0 }
    }

    /// The line for what is reported: what is counted within a stage without knowing its end stands behind what is known of it,
    /// and leaves the bar where it is.
    fn told(&mut self, p: &Progress, now: Instant) -> String {
        let known = !p.fraction.is_nan();
        if self.name != p.stage {
            *self =
                Self { name: p.stage.to_owned(), begun: (now, if known { p.fraction } else { 0.0 }), ..Self::new() };
        }
        if known {
            (self.counted, self.detail) = (true, p.detail.clone());
            if p.fraction < self.done {
                self.begun = (now, p.fraction);
            }
            self.done = p.fraction;
        }
        let mut details = vec![self.detail.as_str()];
        details.extend((!known).then_some(p.detail.as_str()));
        details.retain(|d| !d.is_empty());
        let colon = if details.is_empty() { "" } else { ": " };
        format!("{}{colon}{}{}", self.name, details.join(", "), left(self.rest(now)))
    }

    /// About how long the rest will take, once enough is done.
    fn rest(&self, now: Instant) -> Option<Duration> {
        let (since, share) = (now.saturating_duration_since(self.begun.0), self.done - self.begun.1);
        let told = since >= Self::ESTIMATED && share >= Self::LEAST_SHARE && self.done < 1.0;
        told.then(|| since.mul_f64((1.0 - self.done) / share))
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
        let mut stage = Stage::new();
        let mut told = |name: &'static str, fraction: f64, s: u64| {
            let now = begun + Duration::from_secs(s);
            stage.told(&Progress { stage: name, fraction, detail: String::new() }, now)
        };
        assert_eq!(told("read", 0.0, 0), "read");
        // A new stage, long after the beginning of the job, knows nothing of its rest.
        assert_eq!(told("fit", 0.0, 100), "fit");
        assert_eq!(told("fit", 0.2, 102), "fit");
        assert_eq!(told("fit", 0.25, 110), "fit, 30 s more");
        // What is begun again is estimated again, and what begins late by what is done of it since.
        assert_eq!(told("fit", 0.0, 111), "fit");
        assert_eq!(told("prove", 0.5, 120), "prove");
        assert_eq!(told("prove", 0.75, 130), "prove, 10 s more");
        assert_eq!(told("prove", 1.0, 140), "prove");
    }

    #[test]
    fn counts_without_an_end_leave_the_bar_and_its_estimate() {
        let begun = Instant::now();
        let mut stage = Stage::new();
        let mut told = |name: &'static str, fraction: f64, detail: &str, s: u64| {
            let line =
                stage.told(&Progress { stage: name, fraction, detail: detail.into() }, begun + Duration::from_secs(s));
            (line, stage.done, stage.counted)
        };
        assert_eq!(told("covering", 0.0, "0 of 4", 0), ("covering: 0 of 4".into(), 0.0, true));
        assert_eq!(told("covering", f64::NAN, "7 proofs", 5), ("covering: 0 of 4, 7 proofs".into(), 0.0, true));
        assert_eq!(told("covering", 0.25, "1 of 4", 10), ("covering: 1 of 4, 30 s more".into(), 0.25, true));
        let line = "covering: 1 of 4, 9 proofs, 36 s more";
        assert_eq!(told("covering", f64::NAN, "9 proofs", 12), (line.into(), 0.25, true));
        // The bar of one stage is not that of the next.
        assert_eq!(told("joining", 0.0, "", 20), ("joining".into(), 0.0, true));
        assert_eq!(told("judging", f64::NAN, "8 panels", 30), ("judging: 8 panels".into(), 0.0, false));
    }

    #[test]
    fn long_rests_are_told_in_minutes() {
        assert_eq!(left(Some(Duration::from_secs(30))), ", 30 s more");
        assert_eq!(left(Some(Duration::from_secs(540))), ", 9 min more");
        assert_eq!(left(None), "");
    }
}
