//! Bend tables: which way, how far and with what radius the sheet bends about every line that is drawn.

use super::markup::escape;
use crate::draw::flat::FlatPiece;
use crate::geom::unit::LengthUnit;
use crate::patchwork::pattern::{Bend, BendSense, Pattern};
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;

/// One bend line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BendRecord {
    /// `up`, `down` or `flat`, as the pattern lies before the eye.
    pub sense: String,
    /// Turn of the sheet between the middles to the neighbouring lines, degrees.
    pub angle_deg: f64,
    /// Radius of curvature at both ends of the line, mm; 0 for a fold, null where the sheet is flat.
    pub radii: [Option<f64>; 2],
    /// Length of the line, mm.
    pub length: f64,
    /// Turn of the sheet from the first ruling of the part to the line (to half of its fold), positive up, degrees.
    pub turned_deg: f64,
    /// `radii` just before the line, where two pieces join in it and they are others; null where they are not.
    pub radii_before: Option<[Option<f64>; 2]>,
}

/// The bend lines of a pattern in the order in which they are drawn.
pub(crate) fn records(pattern: &Pattern) -> Vec<BendRecord> {
    pattern
        .rulings
        .iter()
        .zip(&pattern.bends)
        .map(|([a, b], bend)| BendRecord {
            sense: bend.sense.name().into(),
            angle_deg: bend.angle.to_degrees(),
            radii: bend.radii.map(|r| r.is_finite().then_some(r)),
            length: (b - a).norm(),
            turned_deg: bend.turned.to_degrees(),
            radii_before: (bend.before != bend.radii).then(|| bend.before.map(|r| r.is_finite().then_some(r))),
        })
        .collect()
}

/// What stands in the table for the radius of a flat sheet just before a line.
pub(super) const FLAT: &str = "flat";

/// The bend lines of all patterns as a table: `bends.csv`, lengths in `unit`. `None` where there are none.
///
/// # Example
/// ```
/// use torse::geom::unit::LengthUnit;
/// let bracket = torse::read(include_bytes!("../../../../data/bracket.step"))?;
/// let answer = torse::unroll(&bracket, &torse::UnrollOptions::new(0.1), &torse::Control::default())?;
/// let table = torse::io::bends::csv(answer.patterns(), LengthUnit::Millimetre).expect("it is bent");
/// let lines = answer.patterns()[0].rulings.len();
/// assert_eq!(String::from_utf8(table)?.lines().count(), 1 + lines);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn csv(patterns: &[Pattern], unit: LengthUnit) -> Option<Vec<u8>> {
    let sign = unit.sign();
    let mut out = format!(
        "part,seen_from,line,sense,angle_deg,radius_start_{sign},radius_end_{sign},length_{sign},turned_deg,\
         before_start_{sign},before_end_{sign}\n"
    );
    let mut any = false;
    for p in patterns {
        for (k, r) in records(p).iter().enumerate() {
            any = true;
            let radius = |r: f64| format!("{:.3}", unit.of(r));
            let [a, b] = r.radii.map(|r| r.map_or(String::new(), radius));
            // Nothing: as behind the line.
            let [c, d] = match r.radii_before {
                None => [String::new(), String::new()],
                Some(radii) => radii.map(|r| r.map_or_else(|| FLAT.into(), radius)),
            };
            let name = p.name.replace('"', "\"\"");
            // Writing to a string cannot fail.
            _ = writeln!(
                out,
                "\"{name}\",{},{},{},{:.4},{a},{b},{:.3},{:.4},{c},{d}",
                p.view.name(),
                k + 1,
                r.sense,
                r.angle_deg,
                unit.of(r.length),
                r.turned_deg
            );
        }
    }
    any.then(|| out.into_bytes())
}

/// What a reader of the report needs to know: for every part from where it is seen, lines each way, whole turn, radii.
pub(super) fn table(pieces: &[FlatPiece]) -> String {
    let mut out = String::from(
        "<p class=\"quiet\">Patterns are drawn as seen from the side named. Lines marked up bend towards you, lines \
         marked down away from you; every line is in <code>bends.csv</code>.</p>\
         <div class=\"scroll\"><table><thead><tr><th>Part</th><th>Seen from</th><th>Up</th><th>Down</th><th>Turn, up and down</th>\
         <th>Smallest radius</th></tr></thead><tbody>",
    );
    for p in pieces {
        let of = |sense: BendSense| p.bends.iter().filter(move |b| b.sense == sense);
        let turn = |sense| turn(&p.bends, sense);
        let radius = radius(&p.bends);
        _ = write!(
            out,
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.1}°, {:.1}°</td><td>{radius}</td></tr>",
            escape(&p.name),
            p.view.name(),
            of(BendSense::Up).count(),
            of(BendSense::Down).count(),
            turn(BendSense::Up),
            turn(BendSense::Down)
        );
    }
    out.push_str("</tbody></table></div>");
    out
}

/// The whole turn (degrees) one way. Holes cut a line into pieces, which follow each other and bend as one.
fn turn(bends: &[Bend], sense: BendSense) -> f64 {
    let same = |k: usize| {
        let [a, b] = [k - 1, k].map(|k| (bends[k].sense, bends[k].angle.to_bits(), bends[k].turned.to_bits()));
        a == b && bends[k].turned != 0.0
    };
    let counted = |k: &usize| bends[*k].sense == sense && (*k == 0 || !same(*k));
    // The sum of nothing is −0.
    (0..bends.len()).filter(counted).map(|k| bends[k].angle.to_degrees()).sum::<f64>() + 0.0
}

/// Radius (mm) below which a line has come to a tip, or is a fold.
const POINTED: f64 = 0.05;

/// The smallest radius of bend lines in words: those that run to a tip bend there to a point, folds have none.
fn radius(bends: &[Bend]) -> String {
    let least = |radii: &mut dyn Iterator<Item = f64>| radii.filter(|r| *r > POINTED).fold(f64::INFINITY, f64::min);
    let pointed = |b: &&Bend| b.radii.iter().any(|r| *r <= POINTED);
    let folded = bends.iter().any(|b| b.radii.iter().all(|r| *r <= POINTED));
    let radius = least(&mut bends.iter().flat_map(|b| b.radii));
    let mut words = Vec::new();
    if bends.iter().filter(pointed).any(|b| b.radii.iter().any(|r| *r > POINTED)) {
        words.push("0 at the tip".to_owned());
    }
    if folded {
        words.push("folds".to_owned());
    }
    if radius.is_finite() {
        words.push(format!("{radius:.1}&nbsp;mm{}", if words.is_empty() { "" } else { " elsewhere on its lines" }));
    }
    if words.is_empty() {
        return "none".into();
    }
    words.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec2;

    #[test]
    fn the_table_says_which_way_how_far_and_how_sharp() {
        let p = Pattern {
            name: "A-01".into(),
            rulings: vec![[Vec2::zeros(), Vec2::new(3.0, 4.0)], [Vec2::zeros(), Vec2::x()]],
            bends: vec![
                Bend {
                    before: [f64::INFINITY, 15.0],
                    turned: -0.25f64.to_radians(),
                    ..Bend::of(BendSense::Down, 0.5f64.to_radians(), [10.0, 20.0])
                },
                Bend::of(BendSense::Flat, 0.0, [f64::INFINITY; 2]),
            ],
            ..Pattern::default()
        };
        let text =
            String::from_utf8(csv(std::slice::from_ref(&p), LengthUnit::Millimetre).expect("lines")).expect("text");
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[1], "\"A-01\",outside,1,down,0.5000,10.000,20.000,5.000,-0.2500,flat,15.000");
        assert_eq!(lines[2], "\"A-01\",outside,2,flat,0.0000,,,1.000,0.0000,,");
        assert!(csv(&[Pattern::default()], LengthUnit::Millimetre).is_none());
        assert_eq!(records(&p)[1].radii, [None, None]);
    }

    #[test]
    fn pieces_of_one_line_turn_once() {
        let bend = |turned: f64| Bend { turned, ..Bend::of(BendSense::Up, 5.0f64.to_radians(), [9.0; 2]) };
        let bends = [bend(0.1), bend(0.1), bend(0.2), bend(0.3), bend(0.3)];
        assert!((turn(&bends, BendSense::Up) - 15.0).abs() < 1e-9);
        assert!(turn(&bends, BendSense::Down).is_sign_positive());
    }

    #[test]
    fn radii_at_tips_and_in_folds_are_told_in_words() {
        let bend = |radii| Bend::of(BendSense::Up, 0.1, radii);
        assert_eq!(radius(&[bend([30.0, 20.0]), bend([f64::INFINITY; 2])]), "20.0&nbsp;mm");
        assert_eq!(radius(&[bend([0.0, 20.0])]), "0 at the tip, 20.0&nbsp;mm elsewhere on its lines");
        assert_eq!(radius(&[bend([0.0; 2])]), "folds");
        assert_eq!(radius(&[]), "none");
    }
}
