//! Progress and cancellation: the one value through which long work talks to its caller.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// What a long computation reports.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// What is being done.
    pub stage: &'static str,
    /// Share done of the whole, 0..=1.
    pub fraction: f64,
    /// Free text: a count, a face name.
    pub detail: String,
}

/// Receiver of progress.
pub(crate) type ProgressFn = dyn Fn(&Progress) + Send + Sync;

/// Progress callback, cancellation flag and deadline. Cloning shares them.
#[derive(Clone, Default)]
pub struct Control {
    cancelled: Arc<AtomicBool>,
    deadline: Option<Instant>,
    progress: Option<Arc<ProgressFn>>,
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

    /// Asks the computation to end early; it answers with the best it has.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Whether the computation should end early.
    pub fn stopped(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed) || self.deadline.is_some_and(|d| Instant::now() >= d)
    }

    /// Time that is left until the deadline; `None` without a deadline.
    pub fn remaining(&self) -> Option<Duration> {
        self.deadline.map(|d| d.saturating_duration_since(Instant::now()))
    }

    /// Reports progress.
    pub fn report(&self, stage: &'static str, fraction: f64, detail: impl Into<String>) {
        if let Some(f) = &self.progress {
            f(&Progress { stage, fraction, detail: detail.into() });
        }
    }
}
