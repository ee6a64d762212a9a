//! Work on all cores. What rayon builds for each closure that it is given is some eight thousand lines of machine-independent code;
//! here it is given one, which places share. Loops over rows of matrices and faces of hulls, which are many and short, ask it themselves.

use std::sync::Mutex;

use rayon::prelude::*;

/// Calls a function for every index below a number.
fn each(count: usize, call: &(dyn Fn(usize) + Sync)) {
    (0..count).into_par_iter().for_each(call);
}

/// An input until it is taken, and what came of it.
struct Slot<T, R> {
    input: Option<T>,
    output: Option<R>,
}

/// What a function makes of every input, in their order. Inputs are gathered first, by one thread: what is slow belongs into the
/// function.
pub(crate) fn map<T: Send, R: Send>(inputs: impl IntoIterator<Item = T>, f: impl Fn(T) -> R + Sync) -> Vec<R> {
    let slot = |input| Mutex::new(Slot { input: Some(input), output: None });
    let slots: Vec<Mutex<Slot<T, R>>> = inputs.into_iter().map(slot).collect();
    each(slots.len(), &|i| {
        // No lock is held while the function runs: none is ever poisoned.
        let Some(input) = slots[i].lock().ok().and_then(|mut s| s.input.take()) else { return };
        let output = f(input);
        if let Ok(mut s) = slots[i].lock() {
            s.output = Some(output);
        }
    });
    slots.into_iter().filter_map(|s| s.into_inner().ok()?.output).collect()
}

/// Calls a function with every input; these are gathered first.
pub(crate) fn for_each<T: Send>(inputs: impl IntoIterator<Item = T>, f: impl Fn(T) + Sync) {
    let inputs: Vec<Mutex<Option<T>>> = inputs.into_iter().map(|i| Mutex::new(Some(i))).collect();
    each(inputs.len(), &|i| {
        if let Some(input) = inputs[i].lock().ok().and_then(|mut s| s.take()) {
            f(input);
        }
    });
}

/// Two results, each by a thread of its own where one is free.
pub(crate) fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    fn both(a: &mut (dyn FnMut() + Send), b: &mut (dyn FnMut() + Send)) {
        rayon::join(a, b);
    }
    let (mut a, mut b, mut x, mut y) = (Some(a), Some(b), None, None);
    both(&mut || x = a.take().map(|f| f()), &mut || y = b.take().map(|f| f()));
    match (x, y) {
        (Some(x), Some(y)) => (x, y),
        _ => unreachable!("both were called"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_the_order_of_the_inputs() {
        let words: Vec<String> = (0..1000).map(|k| k.to_string()).collect();
        let lengths = map(words.iter().zip(0..), |(w, k)| (w.len(), k));
        assert!(lengths.iter().enumerate().all(|(k, l)| *l == (k.to_string().len(), k)));
        assert_eq!(map(words.clone(), |w| w), words);
        assert!(map(Vec::<String>::new(), |w| w).is_empty());
    }

    #[test]
    fn every_input_is_changed_once() {
        let mut counts = vec![0; 1000];
        for_each(counts.iter_mut(), |c| *c += 1);
        assert!(counts.iter().all(|c| *c == 1));
        assert_eq!(join(|| counts.len(), || "both"), (1000, "both"));
    }
}
