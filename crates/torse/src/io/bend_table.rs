//! The bend table of flat parts: what a press brake's operator asks for, one line for each bend.

use crate::answer::Answer;
use std::fmt::Write as _;

/// The table as CSV: part, bend, way, angle, inside radius, length, allowance, K, proposed place in the sequence. `None`
/// where there are no bends.
pub fn csv(answer: &Answer) -> Option<Vec<u8>> {
    let unit = answer.cut.unit;
    let sign = unit.sign();
    let mut out = format!(
        "part,bend,kind,sense,angle_deg,inside_radius_{sign},length_{sign},allowance_{sign},k_ansi,lines,sequence\n"
    );
    let number = |x: f64, digits: usize| if x.is_finite() { format!("{x:.digits$}") } else { String::new() };
    let length = |mm: f64, digits: usize| number(unit.of(mm), digits);
    let mut any = false;
    for (pattern, bends) in answer.patterns.iter().zip(&answer.sheet_bends) {
        for (k, b) in bends.iter().enumerate() {
            any = true;
            let name = pattern.name.replace('"', "\"\"");
            // Writing to a string cannot fail.
            _ = writeln!(
                out,
                "\"{name}\",{},{},{},{:.4},{},{},{},{},{},{}",
                k + 1,
                b.kind.name(),
                b.sense.name(),
                b.angle.to_degrees(),
                length(b.inside_radius, 4),
                length(b.length, 3),
                length(b.allowance, 4),
                number(b.k, 4),
                b.lines.len(),
                b.order
            );
        }
    }
    any.then(|| out.into_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answer::Job;
    use crate::develop::unfold::allowance::KFactor;
    use crate::develop::unfold::part::{flat_parts, PartOptions};
    use crate::develop::unfold::specimens::{BentSheet, Stretch};

    #[test]
    fn every_bend_has_its_line() {
        let profile = [Stretch::Line(40.0), Stretch::Bend(0.5, 3.0), Stretch::Line(25.0)];
        let faces = BentSheet::new(2.0, &profile, &[0.0, 30.0], &[]).faces();
        let options = PartOptions { tolerance: 0.01, k: KFactor::Ansi(0.5), surfaces: false };
        let made = flat_parts(&faces.iter().collect::<Vec<_>>(), "a \"b\"", &options);
        let answer = Answer {
            patterns: made.parts.iter().map(|p| p.pattern.clone()).collect(),
            sheet_bends: made.parts.iter().map(|p| p.bends.clone()).collect(),
            ..Answer::new(Job::Unroll, "a", 0.01)
        };
        let text = String::from_utf8(csv(&answer).expect("bends")).expect("text");
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 2);
        assert!(lines[1].starts_with("\"a \"\"b\"\"\",1,bend,"), "{text}");
        assert!(lines[1].ends_with(",28.6479,3.0000,30.000,2.0000,0.5000,1,1"), "{text}");
        assert!(csv(&Answer::new(Job::Unroll, "a", 0.01)).is_none());
    }
}
