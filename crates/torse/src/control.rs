//! Progress and cancellation: the one value through which long work talks to its caller.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// What a long computation reports.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// What is being done.
    pub stage: &'static str,
    /// Share done, 0..=1; not a number where nobody knows it.
    pub fraction: f64,
    /// Free text: a count, a face name.
    pub detail: String,
}

/// Receiver of progress.
pub(crate) type ProgressFn = dyn Fn(&Progress) + Send + Sync;

/// Progress callback, cancellation flag, deadline and effort. Cloning shares them.
///
/// # Example
/// ```
/// use std::sync::{Arc, Mutex};
/// let stages = Arc::new(Mutex::new(Vec::new()));
/// let heard = stages.clone();
/// let control = torse::Control::with_progress(Arc::new(move |p| heard.lock().unwrap().push(p.stage)));
/// let model = torse::read(include_bytes!("../../../data/bracket.step"))?;
/// let mut options = torse::UnrollOptions::new(0.1);
/// options.input = "bracket".into();
/// torse::unroll(&model, &options, &control)?;
/// assert!(!stages.lock().unwrap().is_empty() && !control.stopped());
/// control.cancel();
/// assert!(control.stopped());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Default)]
pub struct Control {
    cancelled: Arc<AtomicBool>,
    deadline: Option<Instant>,
    grace: Option<Duration>,
    effort: Option<Arc<Effort>>,
    progress: Option<Arc<ProgressFn>>,
}

/// Time to put together what a job has when it is asked to stop: people who asked wait for it.
const GRACE: Duration = Duration::from_millis(1000);

/// Work that may be spent, counted in attempts: unlike time it is the same on every machine.
struct Effort {
    spent: AtomicUsize,
    most: usize,
}

impl Effort {
    fn is_spent(&self) -> bool {
        self.spent.load(Ordering::Relaxed) > self.most
    }
}

impl std::fmt::Debug for Control {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Control")
            .field("stopped", &self.stopped())
            .field("deadline", &self.deadline)
            .finish_non_exhaustive()
    }
}

impl Control {
    /// A control that reports to `progress`.
    pub fn with_progress(progress: Arc<ProgressFn>) -> Self {
        Self { progress: Some(progress), ..Self::default() }
    }

    /// The same control with a deadline.
    pub fn until(mut self, deadline: Instant) -> Self {
        self.deadline = Some(deadline);
        self
    }

    /// The same control with time to put together what there is when the computation is asked to stop, for all faces of a model;
    /// a second unless told otherwise.
    pub fn finishing_within(mut self, grace: Duration) -> Self {
        self.grace = Some(grace);
        self
    }

    /// See [`Self::finishing_within`].
    pub(crate) fn grace(&self) -> Duration {
        self.grace.unwrap_or(GRACE)
    }

    /// The same control for a search that ends when it needs more than so many attempts.
    pub(crate) fn within(mut self, attempts: usize) -> Self {
        self.effort = Some(Arc::new(Effort { spent: AtomicUsize::new(0), most: attempts }));
        self
    }

    /// Counts an attempt.
    pub(crate) fn attempt(&self) {
        if let Some(effort) = &self.effort {
            effort.spent.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// Asks the computation to end early; it answers with the best it has.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Whether the computation should end early.
    pub fn stopped(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
            || self.effort.as_ref().is_some_and(|e| e.is_spent())
            || self.deadline.is_some_and(|d| Instant::now() >= d)
    }

    /// Time that is left until the deadline; `None` without a deadline.
    pub(crate) fn remaining(&self) -> Option<Duration> {
        self.deadline.map(|d| d.saturating_duration_since(Instant::now()))
    }

    /// Reports progress.
    pub(crate) fn report(&self, stage: &'static str, fraction: f64, detail: impl Into<String>) {
        if let Some(f) = &self.progress {
            f(&Progress { stage, fraction, detail: detail.into() });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn efforts_end_after_so_many_attempts_and_no_sooner() {
        let whole = Control::default();
        let part = whole.clone().within(2);
        let counted: Vec<bool> = (0..3)
            .map(|_| {
                part.clone().attempt();
                whole.attempt();
                part.stopped()
            })
            .collect();
        assert_eq!(counted, [false, false, true]);
        assert!(!whole.stopped());
        whole.cancel();
        assert!(whole.clone().within(2).stopped());
    }
}
