//! Requests to stop from outside: Ctrl-C, and where there are signals also those that end a session or a service.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;
#[cfg(unix)]
use std::time::{Duration, Instant};

/// Exit status after a second Ctrl-C (128 + SIGINT, the shell's convention).
const INTERRUPTED: i32 = 130;

/// What a request asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// Stop soon and keep what was found.
    Stop,
    /// End now, with this exit status.
    End(i32),
}

/// Calls `told` on a thread of its own at every request. The flag is set from the first request on.
///
/// # Errors
/// Why the system gives no notice, in words.
pub fn watch(mut told: impl FnMut(Request) + Send + 'static) -> Result<Arc<AtomicBool>, String> {
    let asked = Arc::new(AtomicBool::new(false));
    let flag = asked.clone();
    listen(move |status| {
        let again = flag.swap(true, Ordering::SeqCst);
        told(if again { Request::End(status) } else { Request::Stop });
    })?;
    Ok(asked)
}

/// Ctrl-C, a request to end (SIGTERM), the end of the terminal (SIGHUP). `nohup` has the last one ignored, which stays
/// so.
#[cfg(unix)]
fn listen(mut heard: impl FnMut(i32) + Send + 'static) -> Result<(), String> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    /// One request often comes twice, as when `timeout` tells the program and then its group, or a shell passes on
    /// what the terminal said. Fingers are told apart from that by the key that they press.
    const ECHO: Duration = Duration::from_secs(1);
    /// Added to a signal's number for the exit status, the shell's convention.
    const KILLED: i32 = 128;
    let wanted = if hangup_is_ignored() { vec![SIGINT, SIGTERM] } else { vec![SIGINT, SIGTERM, SIGHUP] };
    let mut signals = signal_hook::iterator::Signals::new(wanted).map_err(|e| e.to_string())?;
    debug_assert_eq!(KILLED + SIGINT, INTERRUPTED);
    std::thread::Builder::new()
        .name("signals".into())
        .spawn(move || {
            let mut last: Option<Instant> = None;
            for signal in signals.forever() {
                let echo = signal != SIGINT && last.is_some_and(|t| t.elapsed() < ECHO);
                last = Some(Instant::now());
                if !echo {
                    heard(KILLED + signal);
                }
            }
        })
        .map(|_| ())
        .map_err(|e| e.to_string())
}

/// Whether the program was started so that the end of its terminal does not matter. Linux says it; elsewhere programs
/// started so are known by having no terminal.
#[cfg(unix)]
fn hangup_is_ignored() -> bool {
    use std::io::IsTerminal;
    let Ok(status) = std::fs::read_to_string("/proc/self/status") else {
        return !std::io::stderr().is_terminal() && !std::io::stdout().is_terminal();
    };
    ignores_hangup(&status)
}

/// The lowest bit of the mask of ignored signals stands for signal 1, SIGHUP.
#[cfg(unix)]
fn ignores_hangup(status: &str) -> bool {
    let mask = status.lines().find_map(|l| l.strip_prefix("SigIgn:"));
    mask.and_then(|m| u64::from_str_radix(m.trim(), 16).ok()).is_some_and(|m| m & 1 == 1)
}

/// Ctrl-C.
#[cfg(not(unix))]
fn listen(mut heard: impl FnMut(i32) + Send + 'static) -> Result<(), String> {
    ctrlc::set_handler(move || heard(INTERRUPTED)).map_err(|e| e.to_string())
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn programs_started_by_nohup_are_known() {
        assert!(ignores_hangup("Name:\ttorse\nSigIgn:\t0000000000001001\n"));
        assert!(!ignores_hangup("Name:\ttorse\nSigIgn:\t0000000000001000\n"));
        assert!(!ignores_hangup(""));
    }
}
