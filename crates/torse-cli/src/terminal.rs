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

        let (shown, begun) = (bar.clone(), Instant::now());
        let mut control = Control::with_progress(Arc::new(move |p: &Progress| {
            let text = if p.detail.is_empty() { p.stage.to_string() } else { format!("{}: {}", p.stage, p.detail) };
            shown.set_message(text + &left(p.fraction, begun.elapsed()));
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

/// Time after which an estimate of the rest is worth something.
const ESTIMATED: Duration = Duration::from_secs(2);

/// About how long the rest will take, in words, once a share of the work is done.
fn left(done: f64, since: Duration) -> String {
    if !(done > 0.0 && done < 1.0) || since < ESTIMATED {
        return String::new();
    }
    let rest = since.as_secs_f64() * (1.0 - done) / done;
    if rest < 90.0 {
        format!(", about {rest:.0} s left")
    } else {
        format!(", about {:.0} min left", rest / 60.0)
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
    fn the_rest_is_estimated_from_what_is_done() {
        assert_eq!(left(0.25, Duration::from_secs(10)), ", about 30 s left");
        assert_eq!(left(0.1, Duration::from_secs(60)), ", about 9 min left");
        assert_eq!(left(0.0, Duration::from_secs(60)) + &left(1.0, Duration::from_secs(60)), "");
    }
}
