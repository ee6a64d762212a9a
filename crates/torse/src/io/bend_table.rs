//! The bend table of flat parts: what a press brake's operator asks for, one line for each bend.

use super::markup::escape;
use crate::answer::Answer;
use crate::develop::unfold::bends::SheetBend;
use crate::geom::unit::LengthUnit;
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;

/// One bend of a part. Lengths in mm; `null` where there is not one number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SheetBendRecord {
    /// `bend`, `fold`, `hem` or `rolled`.
    pub kind: String,
    /// `up` towards the eye or `down`.
    pub sense: String,
    /// Whole turn, degrees.
    pub angle_deg: f64,
    /// Inside radius; 0 for a fold.
    pub inside_radius: Option<f64>,
    /// Least inside radius by the lines drawn: that above, or of cones and other rolled faces the tightest.
    #[serde(default)]
    pub least_inside_radius: Option<f64>,
    /// Length along the bend line, holes included; null for a rolled cone, whose lines differ.
    pub length: Option<f64>,
    /// Breadth of the bent zone in the flat: length of the neutral fibre.
    pub allowance: Option<f64>,
    /// Depth of the neutral fibre as a share of the thickness, from the inside.
    pub k: Option<f64>,
    /// Number of lines drawn.
    pub lines: usize,
    /// Proposed place in the sequence, from 1: outer bends first.
    pub sequence: usize,
    /// Entity numbers of the edges that a fold is about, as far as the file has them.
    #[serde(default)]
    pub edges: Vec<u64>,
}

/// The bends of a part.
pub(crate) fn records(bends: &[SheetBend]) -> Vec<SheetBendRecord> {
    let number = |x: f64| x.is_finite().then_some(x);
    let record = |b: &SheetBend| SheetBendRecord {
        kind: b.kind.name().into(),
        sense: b.sense.name().into(),
        angle_deg: b.angle.to_degrees(),
        inside_radius: number(b.inside_radius),
        least_inside_radius: number(b.least_inside_radius),
        length: number(b.length),
        allowance: number(b.allowance),
        k: number(b.k),
        lines: b.lines.len(),
        sequence: b.order,
        edges: b.edges.clone(),
    };
    bends.iter().map(record).collect()
}

/// The table as CSV: part, bend, way, angle, inside radius, length, allowance, K, proposed place in the sequence, edges of
/// folds, least inside radius; lengths in `unit`. `None` where there are no bends.
pub fn csv(answer: &Answer, unit: LengthUnit) -> Option<Vec<u8>> {
    let sign = unit.sign();
    let mut out = format!(
        "part,bend,kind,sense,angle_deg,inside_radius_{sign},length_{sign},allowance_{sign},k_ansi,lines,sequence,edges,\
         least_inside_radius_{sign}\n"
    );
    let number = |x: Option<f64>, digits: usize| x.map_or_else(String::new, |x| format!("{x:.digits$}"));
    let length = |mm: Option<f64>, digits: usize| number(mm.map(|x| unit.of(x)), digits);
    let mut any = false;
    for (pattern, sheet) in answer.patterns.iter().zip(&answer.sheets) {
        for (k, b) in records(&sheet.bends).iter().enumerate() {
            any = true;
            let name = pattern.name.replace('"', "\"\"");
            // Writing to a string cannot fail.
            _ = writeln!(
                out,
                "\"{name}\",{},{},{},{:.4},{},{},{},{},{},{},{},{}",
                k + 1,
                b.kind,
                b.sense,
                b.angle_deg,
                length(b.inside_radius, 4),
                length(b.length, 3),
                length(b.allowance, 4),
                number(b.k, 4),
                b.lines,
                b.sequence,
                edges(b),
                length(b.least_inside_radius, 4)
            );
        }
    }
    any.then(|| out.into_bytes())
}

/// Edges as they are named everywhere: #17 #23.
fn edges(bend: &SheetBendRecord) -> String {
    bend.edges.iter().map(|e| format!("#{e}")).collect::<Vec<_>>().join(" ")
}

/// The table for a report; empty where there are no bends.
pub(super) fn table<'a>(parts: impl Iterator<Item = (&'a str, &'a [SheetBendRecord])>) -> String {
    let mut rows = String::new();
    let mm = |x: Option<f64>, digits: usize| x.map_or_else(|| "varies".into(), |x| format!("{x:.digits$}"));
    let radius = |b: &SheetBendRecord| match (b.inside_radius, b.least_inside_radius) {
        (None, Some(least)) => format!("from {least:.3}"),
        (radius, _) => mm(radius, 3),
    };
    for (name, bends) in parts {
        for (k, b) in bends.iter().enumerate() {
            _ = write!(
                rows,
                "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.2}°</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>\
                 <td>{}</td><td>{}</td></tr>",
                escape(name),
                k + 1,
                escape(&b.kind),
                escape(&b.sense),
                b.angle_deg,
                radius(b),
                mm(b.length, 2),
                mm(b.allowance, 3),
                mm(b.k, 3),
                b.sequence,
                edges(b)
            );
        }
    }
    if rows.is_empty() {
        return rows;
    }
    format!(
        "<p class=\"quiet\">Bend table: radius inside, length along the bend line and allowance (breadth of the bent zone in the \
         flat) in mm; K is the depth of the neutral fibre as a share of the thickness; the sequence is a proposal. Computed, not \
         proven.</p><div class=\"scroll\"><table><thead><tr><th>Part</th><th>Bend</th><th>Kind</th><th>Way</th><th>Angle</th>\
         <th>Radius</th><th>Length</th><th>Allowance</th><th>K</th><th>Sequence</th><th>Edges</th></tr></thead><tbody>{rows}</tbody></table></div>"
    )
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
        let options = PartOptions { k: KFactor::Ansi(0.5), ..PartOptions::new(0.01) };
        let made = flat_parts(&faces.iter().collect::<Vec<_>>(), "a \"b\"", &options);
        let answer = Answer {
            patterns: made.parts.iter().map(|p| p.pattern.clone()).collect(),
            sheets: made.parts.iter().map(|p| p.sheet.clone()).collect(),
            ..Answer::new(Job::Unroll, "a", 0.01)
        };
        let text = String::from_utf8(csv(&answer, LengthUnit::Millimetre).expect("bends")).expect("text");
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 2);
        assert!(lines[1].starts_with("\"a \"\"b\"\"\",1,bend,"), "{text}");
        assert!(lines[1].ends_with(",28.6479,3.0000,30.000,2.0000,0.5000,1,1,,3.0000"), "{text}");
        let records = records(&answer.sheets[0].bends);
        let page = table([("a \"b\"", &records[..])].into_iter());
        assert!(page.contains("<td>28.65°</td><td>3.000</td><td>30.00</td><td>2.000</td>"), "{page}");
        assert!(csv(&Answer::new(Job::Unroll, "a", 0.01), LengthUnit::Millimetre).is_none());
    }
}
