//! The list of parts: what a shop puts on its order, one line for each.

use super::json::Report;
use crate::draw::flat::contour_points;
use crate::geom::unit::LengthUnit;
use crate::geom::Vec2;
use crate::patchwork::pattern::Pattern;
use std::fmt::Write as _;

/// Chord error (mm) with which the lengths of cuts are measured.
const CHORD: f64 = 1e-3;

/// The parts of an answer as a table: `parts.csv`; lengths in `unit`. `None` where nothing lies flat.
pub fn csv(report: &Report, patterns: &[Pattern], unit: LengthUnit) -> Option<Vec<u8>> {
    let sign = unit.sign();
    let mut out = format!(
        "part,job,quantity,seen_from,thickness_{sign},length_{sign},width_{sign},strip_width_{sign},area_{sign}2,cut_length_{sign},holes,\
         bend_lines,least_bend_radius_{sign},panels,certified,same_as,mirrored\n"
    );
    let quoted = |s: &str| format!("\"{}\"", s.replace('"', "\"\""));
    for pattern in patterns {
        let part = report.parts.get(pattern.panel);
        let yes = |is: bool| if is { "yes" } else { "no" };
        let same = part.filter(|p| !p.same_as.is_empty());
        let length = |mm: f64| format!("{:.3}", unit.of(mm));
        let least = pattern.bends.iter().flat_map(|b| b.radii).filter(|r| r.is_finite()).reduce(f64::min);
        // Writing to a string cannot fail.
        _ = writeln!(
            out,
            "{},{},1,{},{},{},{},{},{:.4},{},{},{},{},{},{},{},{}",
            quoted(&pattern.name),
            quoted(&report.input),
            pattern.view.name(),
            part.and_then(|p| p.thickness).map_or_else(String::new, length),
            length(pattern.length),
            length(pattern.width),
            length(pattern.strip_width()),
            pattern.area / (unit.mm() * unit.mm()),
            length(cut_length(pattern)),
            pattern.contours.len().saturating_sub(1),
            pattern.rulings.len(),
            least.map_or_else(String::new, length),
            part.map_or(1, |p| p.panels.len()),
            yes(part.is_some_and(|p| p.certified)),
            same.map_or_else(String::new, |p| quoted(&p.same_as)),
            same.map_or("", |p| yes(p.mirrored)),
        );
    }
    (!patterns.is_empty()).then(|| out.into_bytes())
}

/// Length of all outlines, mm.
fn cut_length(pattern: &Pattern) -> f64 {
    let length = |p: Vec<Vec2>| (0..p.len()).map(|k| (p[(k + 1) % p.len()] - p[k]).norm()).sum::<f64>();
    pattern.contours.iter().map(|c| length(contour_points(c, CHORD))).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answer::presentation::present;
    use crate::answer::{Answer, Job};
    use crate::patchwork::part::Part;
    use crate::patchwork::pattern::{Contour, ContourVertex};

    #[test]
    fn a_round_part_has_a_round_cut_and_inches_are_inches() {
        let end = |x: f64| ContourVertex { point: Vec2::new(x, 0.0), bulge: 1.0, corner: true };
        let pattern = Pattern {
            name: "disc \"A\"".into(),
            contours: vec![Contour { vertices: vec![end(-127.0), end(127.0)] }],
            area: 127.0 * 127.0 * std::f64::consts::PI,
            length: 254.0,
            width: 254.0,
            ..Pattern::default()
        };
        let part = Part { name: "disc".into(), first: 0, count: 1, missing: String::new() };
        let answer = Answer { patterns: vec![pattern], parts: vec![part], ..Answer::new(Job::Approximate, "a,b", 1.0) };
        let report = Report::of(&answer, &present(&answer));
        let text = String::from_utf8(csv(&report, &answer.patterns, LengthUnit::Inch).expect("a table")).expect("text");
        let row = text.lines().nth(1).expect("a row");
        assert!(row.starts_with("\"disc \"\"A\"\"\",\"a,b\",1,outside,,10.000,10.000,10.000,78.5398,31.41"), "{row}");
        assert!(text.starts_with("part,job,quantity,seen_from,thickness_in,length_in,"));
        assert!(csv(&report, &[], LengthUnit::Millimetre).is_none());
    }
}
