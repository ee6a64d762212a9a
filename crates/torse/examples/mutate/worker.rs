//! A process that tries cases and tells of each in a line, and the one that listens: what ends a process, or lets it
//! hang, or takes more memory than it may have, is known by the line that does not come.

use crate::case::{case, tried, Verdict};
use crate::readers::READERS;
use crate::specimen::Stock;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{channel, Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

/// Longest that a case may take.
pub const LONGEST: Duration = Duration::from_secs(10);
/// Longest that the good files may take to be made.
const PREPARATION: Duration = Duration::from_secs(300);
/// Memory (KiB) that a process may ask for: 2 GiB, and a quarter more for its code, threads and good files.
const MEMORY: u64 = 5 << 19;
/// First argument of a process that tries cases.
pub const WORKER: &str = "--worker";

/// A line of the process that tries.
pub struct Told {
    pub number: u64,
    pub reader: usize,
    pub verdict: Verdict,
    pub seconds: f64,
    /// Most memory (KiB) that the process held since the case began; 0 where the system does not tell.
    pub memory: u64,
    pub told: String,
}

impl Told {
    fn of(line: &str) -> Option<Self> {
        let mut words = line.splitn(6, ' ');
        let mut next = || words.next();
        Some(Self {
            number: next()?.parse().ok()?,
            reader: next()?.parse().ok().filter(|k| *k < READERS.len())?,
            verdict: match next()? {
                "read" => Verdict::Read,
                "refused" => Verdict::Refused,
                "panicked" => Verdict::Panicked,
                _ => Verdict::Unsound,
            },
            seconds: next()?.parse().ok()?,
            memory: next()?.parse().ok()?,
            told: next()?.to_owned(),
        })
    }
}

/// Tries the cases `first`, `first + step`, … and tells of each on the standard output.
///
/// # Errors
/// Good files that cannot be made; nobody listens.
pub fn work(seed: u64, first: u64, step: u64, seconds: f64) -> Result<(), String> {
    let stock = Stock::new()?;
    let mut out = std::io::stdout().lock();
    let start = Instant::now();
    writeln!(out, "ready").map_err(|e| e.to_string())?;
    for number in (first..).step_by(step as usize) {
        if start.elapsed().as_secs_f64() > seconds {
            break;
        }
        let (reader, bytes) = case(&stock, seed, number);
        // Where this is not Linux, memory is limited but not measured.
        let reset = fs::write("/proc/self/clear_refs", "5").is_ok();
        let outcome = tried(reader, &bytes);
        let memory = if reset { peak() } else { 0 };
        let index = READERS.iter().position(|r| r.name == reader.name).unwrap_or(0);
        let verdict = match outcome.verdict {
            Verdict::Read => "read",
            Verdict::Refused => "refused",
            Verdict::Panicked => "panicked",
            Verdict::Unsound => "unsound",
        };
        writeln!(out, "{number} {index} {verdict} {:.6} {memory} {}", outcome.seconds, outcome.told)
            .map_err(|e| e.to_string())?;
    }
    Ok(())
}

/// Most memory (KiB) that this process held since it was last asked to forget.
fn peak() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    line.and_then(|l| l.trim().trim_end_matches("kB").trim().parse().ok()).unwrap_or(0)
}

fn start(seed: u64, first: u64, step: u64, seconds: f64) -> std::io::Result<Child> {
    let limited = format!("ulimit -v {MEMORY} 2>/dev/null; exec \"$@\"");
    let numbers = [seed.to_string(), first.to_string(), step.to_string(), seconds.to_string()];
    Command::new("sh")
        .args(["-c", &limited, "sh"])
        .arg(std::env::current_exe()?)
        .arg(WORKER)
        .args(numbers)
        // One case at a time in each process, so that time and memory are those of the case.
        .env("RAYON_NUM_THREADS", "1")
        .stdout(Stdio::piped())
        .spawn()
}

fn lines(child: &mut Child) -> Receiver<String> {
    let (send, receive) = channel();
    if let Some(out) = child.stdout.take() {
        std::thread::spawn(move || {
            for line in BufReader::new(out).lines().map_while(Result::ok) {
                if send.send(line).is_err() {
                    break;
                }
            }
        });
    }
    receive
}

/// Has every `step`-th case from `first` tried for so many seconds. Cases that end the process are told as `lost`.
///
/// # Errors
/// A process that cannot be started.
pub fn listen(
    seed: u64,
    first: u64,
    step: u64,
    seconds: f64,
    mut told: impl FnMut(Told),
    mut lost: impl FnMut(u64, String),
) -> Result<(), String> {
    let begin = Instant::now();
    let mut next = first;
    while begin.elapsed().as_secs_f64() < seconds {
        let left = seconds - begin.elapsed().as_secs_f64();
        let mut child = start(seed, next, step, left).map_err(|e| format!("no process: {e}"))?;
        let lines = lines(&mut child);
        if lines.recv_timeout(PREPARATION).is_err() {
            _ = child.kill();
            return Err("the good files could not be made".into());
        }
        loop {
            match lines.recv_timeout(LONGEST) {
                Ok(line) => {
                    let Some(t) = Told::of(&line) else { return Err(format!("a line that is none: {line}")) };
                    next = t.number + step;
                    told(t);
                }
                Err(RecvTimeoutError::Timeout) => {
                    _ = child.kill();
                    _ = child.wait();
                    lost(next, format!("no answer within {} s", LONGEST.as_secs()));
                    next += step;
                    break;
                }
                Err(RecvTimeoutError::Disconnected) => {
                    let status = child.wait().map_err(|e| e.to_string())?;
                    if !status.success() {
                        lost(next, format!("the process ended: {status}"));
                        next += step;
                    }
                    break;
                }
            }
        }
    }
    Ok(())
}
