//! What is done to good files: bytes, numbers, lines, words and references are changed, lost, repeated, exchanged.

use crate::random::Random;
use std::ops::Range;

/// Numbers that no writer has in mind, as text.
const WILD: [&str; 28] = [
    "0",
    "-0.",
    "1",
    "-1",
    "2",
    "0.5",
    "1e308",
    "-1e308",
    "1.E308",
    "-1.E308",
    "1e154",
    "1.E-154",
    "1e-320",
    "1.E-320",
    "nan",
    "inf",
    "-inf",
    "1e15",
    "-1.E15",
    "65536",
    "2147483648",
    "4000000000",
    "4294967295",
    "9223372036854775807",
    "-9223372036854775808",
    "18446744073709551615",
    "99999999999999999999",
    "1e9999",
];
/// Bytes with a meaning somewhere, and some that are no text.
const BYTES: &[u8] = b"\0\n\r\t \"'#$%&()*+,-./0123456789:;<=>@AEMLZ[\\]_{|}~\x7f\x80\xc3\xa9\xe2\xff";
/// Letters of several bytes, beginnings and ends of what readers pass over, escapes.
const TEXTS: [&str; 16] =
    ["é", "\u{feff}", "€", "/*", "*/", "''", "\\X2\\", "\\X\\", "\\S\\", "#", "//", "\"", "\n\n", "999\n", "-", "("];
/// Counts of binary files.
const COUNTS: [u32; 6] = [0, 1, 1000, 0x7fff_ffff, 0x8000_0000, u32::MAX];
/// Coordinates of binary files.
const FLOATS: [f32; 6] = [0.0, -0.0, f32::NAN, f32::INFINITY, f32::MAX, 1e-45];
/// Longest file that is tried, in bytes, longer than any good one: small files are many files.
pub const LONGEST: usize = 1 << 17;
/// Most times that a byte is repeated: as deep as nesting goes.
const DEEP: usize = 1 << 14;

/// A changed copy; pieces of `other` may come into it.
pub fn mutated(random: &mut Random, bytes: &[u8], other: &[u8]) -> Vec<u8> {
    let mut out = bytes.to_vec();
    for _ in 0..=random.below(4).min(random.below(6)) {
        change(random, &mut out, other);
    }
    out.truncate(LONGEST);
    out
}

fn change(random: &mut Random, b: &mut Vec<u8>, other: &[u8]) {
    match random.below(20) {
        0 | 1 => {
            let (at, bit) = (random.below(b.len()), 1 << random.below(8));
            let byte = BYTES[random.below(BYTES.len())];
            let flip = random.below(2) == 0;
            b.iter_mut().skip(at).take(1).for_each(|x| *x = if flip { *x ^ bit } else { byte });
        }
        2 => drop(b.drain(range(random, b.len()))),
        3 if random.below(2) == 0 => {
            let text = TEXTS[random.below(TEXTS.len())];
            // In front of a word, where readers look.
            let at = pick(random, words(b)).map_or(0, |r| r.start);
            b.splice(at..at, text.bytes());
        }
        3 => {
            let new: Vec<u8> = (0..=random.below(6)).map(|_| BYTES[random.below(BYTES.len())]).collect();
            insert(random, b, &new);
        }
        4 => {
            let again = b[range(random, b.len())].to_vec();
            insert(random, b, &again);
        }
        5 => b.truncate(random.below(b.len())),
        6 => {
            let piece = other[range(random, other.len())].to_vec();
            b.splice(range(random, b.len()), piece);
        }
        7 if random.below(8) == 0 => {
            let byte =
                if random.below(2) == 0 { b"([{\"'#0-"[random.below(8)] } else { BYTES[random.below(BYTES.len())] };
            let deep = vec![byte; random.below(DEEP)];
            insert(random, b, &deep);
        }
        7 | 8 => {
            let at = random.below(b.len() / 2) * 2;
            let new = if random.below(2) == 0 {
                COUNTS[random.below(COUNTS.len())].to_le_bytes()
            } else {
                FLOATS[random.below(FLOATS.len())].to_le_bytes()
            };
            b.iter_mut().skip(at).zip(new).for_each(|(x, y)| *x = y);
        }
        9 => lines(random, b),
        10 | 11 => exchange(random, b, words),
        12 => exchange(random, b, numbers),
        13 | 14 => exchange(random, b, references),
        15 => nudge(random, b),
        16 => count(random, b),
        _ => {
            if let Some(at) = pick(random, numbers(b)) {
                b.splice(at, WILD[random.below(WILD.len())].bytes());
            }
        }
    }
}

/// A short stretch of so many bytes.
fn range(random: &mut Random, n: usize) -> Range<usize> {
    let at = random.below(n);
    let most = if random.below(3) == 0 { n } else { 12 };
    at..(at + 1 + random.below(most)).min(n).max(at)
}

fn insert(random: &mut Random, b: &mut Vec<u8>, new: &[u8]) {
    let at = random.below(b.len() + 1);
    b.splice(at..at, new.iter().copied());
}

fn pick(random: &mut Random, all: Vec<Range<usize>>) -> Option<Range<usize>> {
    all.get(random.below(all.len())).cloned()
}

/// Stretches of bytes that belong together.
fn runs(b: &[u8], part: impl Fn(u8) -> bool) -> Vec<Range<usize>> {
    let mut out = Vec::new();
    let mut start = None;
    for (i, &x) in b.iter().chain(b"\n").enumerate() {
        let inside = i < b.len() && part(x);
        match (start, inside) {
            (None, true) => start = Some(i),
            (Some(s), false) => {
                out.push(s..i);
                start = None;
            }
            _ => {}
        }
    }
    out
}

fn numbers(b: &[u8]) -> Vec<Range<usize>> {
    let mut all = runs(b, |x| x.is_ascii_digit() || b"+-.eE".contains(&x));
    // Names that hold such letters are no numbers, and references are changed by themselves.
    all.retain(|r| {
        let before = r.start.checked_sub(1).map_or(b' ', |k| b[k]);
        b[r.clone()].iter().any(u8::is_ascii_digit) && !before.is_ascii_alphabetic() && before != b'#'
    });
    all
}

fn words(b: &[u8]) -> Vec<Range<usize>> {
    runs(b, |x| !b" \t\r\n,;:()[]{}<>=\"'/".contains(&x))
}

fn references(b: &[u8]) -> Vec<Range<usize>> {
    let mut all = runs(b, |x| x.is_ascii_digit());
    all.retain(|r| r.start > 0 && b[r.start - 1] == b'#');
    all
}

/// One stretch takes the place of another, or both change places.
fn exchange(random: &mut Random, b: &mut Vec<u8>, find: fn(&[u8]) -> Vec<Range<usize>>) {
    let all = find(b);
    let (Some(x), Some(y)) = (pick(random, all.clone()), pick(random, all)) else { return };
    let (x, y) = if x.start <= y.start { (x, y) } else { (y, x) };
    if x == y {
        return;
    }
    let (first, second) = (b[x.clone()].to_vec(), b[y.clone()].to_vec());
    // The later one first, so that the places stay true.
    b.splice(y, first);
    if random.below(2) == 0 {
        b.splice(x, second);
    }
}

/// A line is lost, repeated elsewhere, or changes places with another.
fn lines(random: &mut Random, b: &mut Vec<u8>) {
    match random.below(3) {
        0 => exchange(random, b, |b| runs(b, |x| x != b'\n')),
        1 => {
            let Some(r) = pick(random, runs(b, |x| x != b'\n')) else { return };
            b.drain(r.start..(r.end + 1).min(b.len()));
        }
        _ => {
            let all = runs(b, |x| x != b'\n');
            let (Some(r), Some(to)) = (pick(random, all.clone()), pick(random, all)) else { return };
            let mut line = b[r].to_vec();
            line.push(b'\n');
            let times = if random.below(8) == 0 { 1 + random.below(200) } else { 1 };
            b.splice(to.start..to.start, line.repeat(times));
        }
    }
}

/// A number a little more, less, or of the other sign.
fn nudge(random: &mut Random, b: &mut Vec<u8>) {
    let Some(at) = pick(random, numbers(b)) else { return };
    let Ok(x) = String::from_utf8_lossy(&b[at.clone()]).parse::<f64>() else { return };
    let by = random.scale(1e-16, 10.0);
    let new = match random.below(5) {
        0 => -x,
        1 => x * (1.0 + by),
        2 => x + by,
        3 => x * 10f64.powi(random.below(40) as i32 - 20),
        _ => x + 1.0,
    };
    // STEP wants the point in front of the exponent.
    let text = if b.starts_with(b"ISO") { format!("{new:?}").replace('e', "E") } else { format!("{new}") };
    b.splice(at, text.into_bytes());
}

/// A whole number, which may be a count, by one more or less, twice as much, or absurd.
fn count(random: &mut Random, b: &mut Vec<u8>) {
    let whole = |b: &[u8]| {
        let mut all = numbers(b);
        all.retain(|r| b[r.clone()].iter().all(u8::is_ascii_digit));
        all
    };
    let Some(at) = pick(random, whole(b)) else { return };
    let Ok(n) = String::from_utf8_lossy(&b[at.clone()]).parse::<u64>() else { return };
    let absurd = [1_000_000, 4_000_000_000, 1 << 40, u64::MAX / 8, u64::MAX];
    let new = match random.below(5) {
        0 => n.saturating_add(1),
        1 => n.saturating_sub(1),
        2 => n.saturating_mul(2),
        _ => absurd[random.below(absurd.len())],
    };
    b.splice(at, new.to_string().into_bytes());
}
