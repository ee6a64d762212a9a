//! A few damaged files of `examples/mutate` for every reader: none of them panics, none answers with what is no number.

#[path = "../examples/mutate/case.rs"]
mod case;
#[path = "../examples/mutate/mutation.rs"]
mod mutation;
#[path = "../examples/mutate/parts.rs"]
mod parts;
#[expect(dead_code, reason = "the adversary asks for more sorts of numbers")]
#[path = "../examples/attack/random.rs"]
mod random;
#[path = "../examples/mutate/readers.rs"]
mod readers;
#[path = "../examples/mutate/specimen.rs"]
mod specimen;

use case::Verdict;
use std::collections::BTreeSet;

const CASES: u64 = 10_000;
const SEED: u64 = 7;
/// Seconds that a file may take.
const LONGEST: f64 = 10.0;

#[test]
fn damaged_files_are_read_or_refused_with_a_message() {
    let stock = specimen::Stock::new().expect("good files");
    // Good files are good: each is read by a reader of its kind.
    for (kind, bytes) in &stock.all {
        assert!(bytes.len() < mutation::LONGEST, "{kind:?}: {} bytes, which would be cut", bytes.len());
        let own: Vec<_> = readers::READERS.iter().filter(|r| r.kinds.contains(kind)).map(|r| (r.read)(bytes)).collect();
        assert!(own.contains(&Ok(true)), "{kind:?}: {own:?}");
    }
    case::silence();
    let (mut read, mut refused, mut bad) = (0, 0, Vec::new());
    let mut unread: BTreeSet<&str> = readers::READERS.iter().map(|r| r.name).collect();
    for number in 0..CASES {
        let (reader, bytes) = case::case(&stock, SEED, number);
        let outcome = case::tried(reader, &bytes);
        match outcome.verdict {
            Verdict::Read => {
                read += 1;
                unread.remove(reader.name);
            }
            Verdict::Refused => refused += 1,
            other => bad.push(format!("{}, case {number}: {other:?} {}", reader.name, outcome.told)),
        }
        if outcome.seconds > LONGEST {
            bad.push(format!("{}, case {number}: {} s", reader.name, outcome.seconds));
        }
    }
    // What is wrong is told aloud again.
    drop(std::panic::take_hook());
    assert!(bad.is_empty(), "{}", bad.join("\n"));
    // Changes that matter, and changes that do not, to every reader.
    assert!(unread.is_empty(), "{unread:?}");
    assert!(read > CASES / 10 && refused > CASES / 4, "{read} read, {refused} refused");
}
