//! Cases as read from the file, and the comparison of an answer with what the case expects.

use serde_json::Value;

/// One case. Where the file has `data` instead of `input` and `output`, both are that `data`.
pub struct Case {
    /// What is asked.
    pub kind: String,
    /// Given.
    pub input: Value,
    /// Expected.
    pub output: Value,
    /// Tolerances stated with the case, null where none are.
    pub tol: Value,
}

/// Reads the cases of a file.
pub fn read(path: &str) -> Result<Vec<Case>, String> {
    let text = std::fs::read_to_string(path).map_err(|e| e.to_string())?;
    let file: Value = serde_json::from_str(&text).map_err(|e| e.to_string())?;
    let cases = file["cases"].as_array().ok_or("no list `cases`")?;
    cases
        .iter()
        .enumerate()
        .map(|(i, c)| {
            let kind = c["kind"].as_str().ok_or(format!("case {i} has no kind"))?.to_owned();
            let (input, output) = match c.get("data") {
                Some(data) => (data.clone(), data.clone()),
                None => (c["input"].clone(), c["output"].clone()),
            };
            Ok(Case { kind, input, output, tol: c["tol"].clone() })
        })
        .collect()
}

/// The number under a key.
pub fn number(v: &Value, key: &str) -> Result<f64, String> {
    v[key].as_f64().ok_or_else(|| format!("`{key}` is not a number"))
}

/// The list of numbers under a key.
pub fn numbers(v: &Value, key: &str) -> Result<Vec<f64>, String> {
    list(&v[key]).ok_or_else(|| format!("`{key}` is not a list of numbers"))
}

/// The vector of `D` numbers under a key.
pub fn vector<const D: usize>(v: &Value, key: &str) -> Result<[f64; D], String> {
    numbers(v, key)?.try_into().map_err(|_| format!("`{key}` does not have {D} numbers"))
}

/// The list of vectors of `D` numbers under a key.
pub fn vectors<const D: usize>(v: &Value, key: &str) -> Result<Vec<[f64; D]>, String> {
    let rows = v[key].as_array().ok_or_else(|| format!("`{key}` is not a list"))?;
    rows.iter()
        .map(|r| {
            list(r).and_then(|r| r.try_into().ok()).ok_or_else(|| format!("`{key}` has a row without {D} numbers"))
        })
        .collect()
}

fn list(v: &Value) -> Option<Vec<f64>> {
    v.as_array()?.iter().map(Value::as_f64).collect()
}

/// Differences found in one case, each with what is allowed.
#[derive(Default)]
pub struct Checks {
    worst: f64,
    failure: Option<String>,
}

impl Checks {
    /// `got` against `expected`, to `allowed · max(1, |expected|)`.
    pub fn close(&mut self, what: &str, got: f64, expected: f64, allowed: f64) {
        self.at_most(what, (got - expected).abs(), allowed * expected.abs().max(1.0));
    }

    /// Component by component, relative to the largest component of what is expected (at least 1).
    pub fn all_close(&mut self, what: &str, got: &[f64], expected: &[f64], allowed: f64) {
        if got.len() != expected.len() {
            self.fail(format!("{what}: {} numbers instead of {}", got.len(), expected.len()));
            return;
        }
        let scale = expected.iter().fold(1.0f64, |m, x| m.max(x.abs()));
        let off =
            got.iter().zip(expected).fold(0.0f64, |m, (a, b)| if a.is_nan() { f64::NAN } else { m.max((a - b).abs()) });
        self.at_most(what, off, allowed * scale);
    }

    /// An error that must not exceed what is allowed.
    pub fn at_most(&mut self, what: &str, error: f64, allowed: f64) {
        let share = if error == 0.0 { 0.0 } else { error / allowed };
        if share > 1.0 || share.is_nan() {
            self.fail(format!("{what}: {error:e} where {allowed:e} is allowed"));
        }
        self.worst = if share.is_nan() { f64::INFINITY } else { self.worst.max(share) };
    }

    /// A statement that must hold.
    pub fn holds(&mut self, what: &str, truth: bool) {
        if !truth {
            self.fail(what.to_owned());
        }
    }

    fn fail(&mut self, reason: String) {
        self.failure.get_or_insert(reason);
    }

    /// Largest error as a share of what is allowed.
    pub fn worst(&self) -> f64 {
        self.worst
    }

    /// The first failure.
    pub fn verdict(self) -> Result<(), String> {
        self.failure.map_or(Ok(()), Err)
    }
}
