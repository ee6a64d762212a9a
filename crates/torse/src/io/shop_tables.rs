//! Tables for the shop floor: roll radii along parts, kinks for the press brake, bevels along seams.

use super::json::FacetsRecord;
use super::markup::escape;
use crate::answer::Answer;
use crate::geom::unit::LengthUnit;
use std::fmt::Write as _;

/// Radii along every curved part: `roll_table.csv`; lengths in `unit`. `None` where nothing is known.
pub(crate) fn roll(answer: &Answer, unit: LengthUnit) -> Option<Vec<u8>> {
    let sign = unit.sign();
    let mut out =
        format!("part,seen_from,station,position_{sign},radius_start_{sign},radius_end_{sign},turn_deg,panel\n");
    let mut any = false;
    for (pattern, work) in answer.patterns.iter().zip(&answer.shop.work) {
        for (k, s) in work.roll.iter().enumerate() {
            any = true;
            let [a, b] = s.radii.map(|r| if r.is_finite() { format!("{:.3}", unit.of(r)) } else { String::new() });
            // Writing to a string cannot fail.
            _ = writeln!(
                out,
                "{},{},{},{:.3},{a},{b},{:.3},{}",
                quoted(&pattern.name),
                pattern.view.name(),
                k + 1,
                unit.of(s.position),
                s.turn.to_degrees(),
                panel(&work.panels, s.panel)
            );
        }
    }
    any.then(|| out.into_bytes())
}

/// Kinks of every part that is to be kinked: `facets.csv`; lengths in `unit`. `None` where there are none.
pub fn facets(answer: &Answer, unit: LengthUnit) -> Option<Vec<u8>> {
    let sign = unit.sign();
    let mut out = format!(
        "part,seen_from,kink,sequence,sense,angle_deg,from_last_{sign},length_{sign},radius_start_{sign},radius_end_{sign},\
         first_line,last_line,panel\n"
    );
    let mut any = false;
    for (pattern, work) in answer.patterns.iter().zip(&answer.shop.work) {
        for (k, kink) in work.faceted.iter().flat_map(|f| &f.kinks).enumerate() {
            any = true;
            let length = |x: f64| if x.is_finite() { format!("{:.3}", unit.of(x)) } else { String::new() };
            let [a, b] = kink.bend.radii.map(length);
            _ = writeln!(
                out,
                "{},{},{},{},{},{:.4},{},{},{a},{b},{},{},{}",
                quoted(&pattern.name),
                pattern.view.name(),
                k + 1,
                kink.order,
                kink.bend.sense.name(),
                kink.bend.angle.to_degrees(),
                length(kink.from_last),
                length(kink.length),
                kink.lines[0] + 1,
                kink.lines[1] + 1,
                panel(&work.panels, kink.panel())
            );
        }
    }
    any.then(|| out.into_bytes())
}

/// Bevels along every seam and joint that has a kink: `bevels.csv`; lengths in `unit`. `None` where there are none.
pub fn bevels(answer: &Answer, unit: LengthUnit) -> Option<Vec<u8>> {
    let sign = unit.sign();
    let mut out = format!(
        "seam,part_a,part_b,station,position_{sign},fold,kink_deg,bevel_deg,inside_ends_before_outside_{sign}\n"
    );
    let mut any = false;
    for seam in &answer.shop.bevels {
        // Where parts go on smoothly there is nothing to bevel.
        if seam.stations.iter().all(|s| printed(s.kink.abs().to_degrees(), 4) == printed(0.0, 4)) {
            continue;
        }
        any = true;
        for (k, s) in seam.stations.iter().enumerate() {
            let thickness = seam.thickness.or(answer.shop.thickness);
            let setback = thickness.map_or_else(String::new, |t| printed(unit.of(s.setback(t)), 3));
            _ = writeln!(
                out,
                "{},{},{},{},{:.3},{},{:.4},{:.4},{setback}",
                seam.name,
                quoted(&seam.between[0]),
                quoted(&seam.between[1]),
                k + 1,
                unit.of(s.position),
                if s.kink < 0.0 { "valley" } else { "ridge" },
                s.kink.abs().to_degrees(),
                s.bevel().to_degrees()
            );
        }
    }
    any.then(|| out.into_bytes())
}

/// A number with so many digits behind the point; zero without a sign.
fn printed(x: f64, digits: usize) -> String {
    let text = format!("{x:.digits$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| "0.".contains(c)) => rest.to_owned(),
        _ => text,
    }
}

/// Joints of parts that were laid flat with the lengths of both sides in the plane: `joints.csv`; lengths in `unit`. `None` where
/// there are none.
pub(crate) fn joints(answer: &Answer, unit: LengthUnit) -> Option<Vec<u8>> {
    let sign = unit.sign();
    let mut out =
        format!("joint,part_a,part_b,length_a_{sign},length_b_{sign},difference_{sign},kink_least_deg,kink_most_deg\n");
    let name = |k: usize| answer.parts.get(k).map_or_else(String::new, |p| quoted(&p.name));
    for joint in &answer.joints {
        let [a, b] = joint.lengths;
        let length = |x: f64| if x.is_finite() { printed(unit.of(x), 4) } else { String::new() };
        let kinks = || joint.stations.iter().map(|s| s.kink.to_degrees());
        _ = writeln!(
            out,
            "{},{},{},{},{},{},{},{}",
            joint.name,
            name(joint.parts[0]),
            name(joint.parts[1]),
            length(a),
            length(b),
            length(b - a),
            printed(kinks().fold(f64::INFINITY, f64::min), 4),
            printed(kinks().fold(f64::NEG_INFINITY, f64::max), 4)
        );
    }
    (!answer.joints.is_empty()).then(|| out.into_bytes())
}

/// The name of a panel; empty where it has none.
fn panel(names: &[String], k: usize) -> String {
    names.get(k).map_or_else(String::new, |n| quoted(n))
}

fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "\"\""))
}

/// How far kinked parts are from the curved ones, for a report; empty where none is kinked.
pub(super) fn facets_table<'a>(parts: impl Iterator<Item = (&'a str, &'a FacetsRecord)>) -> String {
    let number = |x: Option<f64>| x.map_or_else(|| "unknown".into(), |x| format!("{x:.3}"));
    let mut rows = String::new();
    for (name, f) in parts {
        _ = write!(
            rows,
            "<tr><td>{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td></tr>",
            escape(name),
            f.kinks,
            number(f.sagitta_estimate),
            number(f.displacement_estimate)
        );
    }
    if rows.is_empty() {
        return rows;
    }
    format!(
        "<p class=\"quiet\">Kinks for the press brake; lengths in mm, sampled. Angles, places and a sequence are in \
         <code>facets.csv</code>.</p><div class=\"scroll\"><table><thead><tr><th>Part</th><th class=\"number\">Kinks</th>\
         <th class=\"number\" title=\"Height of the arcs over the facets\">Arc height</th>\
         <th class=\"number\" title=\"Largest distance of a place of the kinked part from the curved one\">Off the curve</th></tr>\
         </thead><tbody>{rows}</tbody></table></div>"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answer::shop::PartWork;
    use crate::answer::Job;
    use crate::develop::shop::bevel::{BevelStation, SeamBevel};
    use crate::develop::shop::roll::RollStation;
    use crate::develop::unfold::joints::PartJoint;
    use crate::geom::Vec2;
    use crate::patchwork::part::Part;
    use crate::patchwork::pattern::Pattern;

    #[test]
    fn tables_hold_what_is_known_and_nothing_else() {
        let station = RollStation {
            panel: 0,
            position: 254.0,
            ends: [Vec2::zeros(); 2],
            radii: [508.0, f64::INFINITY],
            turn: -0.5f64.to_radians(),
        };
        let mut answer = Answer {
            patterns: vec![Pattern { name: "a \"b\"".into(), ..Pattern::default() }],
            ..Answer::new(Job::Loft, "a", 0.1)
        };
        let mm = LengthUnit::Millimetre;
        assert!(roll(&answer, mm).is_none() && facets(&answer, mm).is_none() && bevels(&answer, mm).is_none());
        answer.shop.work = vec![PartWork { roll: vec![station], panels: vec!["a-01".into()], ..PartWork::default() }];
        answer.shop.bevels = vec![SeamBevel {
            name: "S3".into(),
            between: ["A".into(), "B".into()],
            thickness: None,
            stations: vec![BevelStation { position: 0.0, kink: (-4.0f64).to_radians() }],
        }];
        let text = |b: Option<Vec<u8>>| String::from_utf8(b.expect("a table")).expect("text");
        assert!(text(roll(&answer, LengthUnit::Inch))
            .ends_with("\n\"a \"\"b\"\"\",outside,1,10.000,20.000,,-0.500,\"a-01\"\n"));
        assert!(text(bevels(&answer, mm)).ends_with("\nS3,\"A\",\"B\",1,0.000,valley,4.0000,2.0000,\n"));
        answer.shop.thickness = Some(10.0);
        assert!(text(bevels(&answer, mm)).ends_with(",2.0000,-0.349\n"));
        assert!(joints(&answer, mm).is_none());
        let station = |kink: f64| BevelStation { position: 0.0, kink: kink.to_radians() };
        let stations = vec![station(-1e-9), station(3.5)];
        answer.parts = vec![Part::new("a", 0, 1), Part::new("b", 1, 1)];
        answer.joints = vec![
            PartJoint { name: "J1".into(), parts: [0, 1], lengths: [80.0, 80.0 - 1e-9], stations: stations.clone() },
            PartJoint { name: "J2".into(), parts: [1, 1], lengths: [80.0, f64::NAN], stations },
        ];
        let rows = text(joints(&answer, mm));
        assert!(
            rows.ends_with(
                "J1,\"a\",\"b\",80.0000,80.0000,0.0000,0.0000,3.5000\nJ2,\"b\",\"b\",80.0000,,,0.0000,3.5000\n"
            ),
            "{rows}"
        );
    }
}
