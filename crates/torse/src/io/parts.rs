//! The list of parts: what a shop puts on its order, one line for each.

use super::json::{PartRecord, Report};
use super::words::id;
use super::words::numbers::is_endless;
use crate::certify::claim::What;
use crate::geom::unit::LengthUnit;
use crate::patchwork::pattern::{BendSense, Pattern};
use crate::torse::form::PanelKind;
use std::fmt::Write as _;

/// The radius to which all of a part's panels bend, where each covers a face that is a cylinder of that radius in the file, and no
/// thickness moves the sheet off it.
fn radius_of_faces(report: &Report, part: &PartRecord) -> Option<f64> {
    let of = |name: &String| {
        let panel = report.panels.iter().find(|p| p.name == *name)?;
        report.faces.get(panel.face?)?.radius.filter(|_| panel.kind == PanelKind::Cylinder.name())
    };
    let radii: Option<Vec<f64>> = part.panels.iter().map(of).collect();
    let radii = radii.filter(|_| part.thickness.is_none())?;
    radii.first().copied().filter(|first| radii.iter().all(|r| r == first))
}

/// The radius (mm) above which all of a part's panels are proven to bend.
fn radius_bound(report: &Report, part: &PartRecord) -> Option<f64> {
    let of = |name: &String| {
        let panel = report.panels.iter().find(|p| p.name == *name)?;
        panel.figures.iter().find(|f| f.what == id(What::BendRadius) && f.bound == "lower")?.value
    };
    let bounds: Option<Vec<f64>> = part.panels.iter().map(of).collect();
    bounds?.into_iter().reduce(f64::min).filter(|r| !is_endless(*r))
}

/// The parts of an answer as a table: `parts.csv`; lengths in `unit`. `None` where nothing lies flat.
pub fn csv(report: &Report, patterns: &[Pattern], unit: LengthUnit) -> Option<Vec<u8>> {
    let sign = unit.sign();
    let mut out = format!(
        "part,job,quantity,seen_from,thickness_{sign},length_{sign},width_{sign},strip_width_{sign},area_{sign}2,cut_length_{sign},holes,\
         bend_lines,least_bend_radius_{sign},panels,certified,same_as,mirrored,quantity_turned_over,pierces,material,weight_kg,\
         bend_radius_basis,bend_radius_bound_{sign},opposite_hand_of,source\n"
    );
    let quoted = |s: &str| format!("\"{}\"", s.replace('"', "\"\""));
    for pattern in patterns {
        let part = report.parts.get(pattern.panel);
        let yes = |is: bool| if is { "yes" } else { "no" };
        let same = part.filter(|p| !p.same_as.is_empty());
        let length = |mm: f64| format!("{:.3}", unit.of(mm));
        // What the file says of its faces goes before what the bend lines drawn have; what is proven is a column of its own.
        let drawn = pattern.bends.iter().flat_map(|b| b.radii).filter(|r| r.is_finite()).reduce(f64::min);
        // Lines of sheet metal have the radii of its neutral fibre where these vary.
        let inside = part
            .filter(|p| p.thickness.is_some())
            .and_then(|p| p.sheet_bends.iter().filter_map(|b| b.least_inside_radius).reduce(f64::min));
        let drawn = inside.or(drawn);
        let faces = part.filter(|_| drawn.is_some()).and_then(|p| radius_of_faces(report, p));
        // With a thickness it is the inside of the sheet that is asked for, whichever side of it was given.
        let of_sheet = part.and_then(|p| p.inside_radius).filter(|_| inside.is_none() && drawn.is_some());
        let least = of_sheet.or(faces).or(drawn);
        let basis = match (of_sheet, faces, drawn) {
            (Some(_), ..) => "inside",
            (None, Some(_), _) => "face",
            (None, None, Some(_)) => "bend lines",
            (None, None, None) => "",
        };
        let bound = part.filter(|p| drawn.is_some() && p.thickness.is_none()).and_then(|p| radius_bound(report, p));
        // Writing to a string cannot fail.
        _ = writeln!(
            out,
            "{},{},{},{},{},{},{},{},{:.4},{},{},{},{},{},{},{},{},{},{},{},{},{basis},{},{},{}",
            quoted(&pattern.name),
            quoted(&report.input),
            part.map_or(1, |p| p.quantity),
            pattern.view.name(),
            part.and_then(|p| p.thickness).map_or_else(String::new, length),
            length(pattern.length),
            length(pattern.width),
            length(pattern.strip_width()),
            pattern.area / (unit.mm() * unit.mm()),
            part.and_then(|p| p.cut_length).map_or_else(String::new, length),
            pattern.contours.len().saturating_sub(1),
            // Lines where the sheet stays flat are none.
            (0..pattern.rulings.len()).filter(|k| pattern.bend(*k).sense != BendSense::Flat).count(),
            least.map_or_else(String::new, length),
            part.map_or(1, |p| p.panels.len()),
            yes(part.is_some_and(|p| p.certified)),
            same.map_or_else(String::new, |p| quoted(&p.same_as)),
            same.map_or("", |p| yes(p.mirrored)),
            part.map_or(0, |p| p.quantity_turned_over),
            part.map_or(0, |p| p.pierces),
            part.map_or_else(String::new, |p| quoted(&p.material)),
            part.and_then(|p| p.weight_kg).map_or_else(String::new, |kg| format!("{kg:.4}")),
            // Rounded down.
            bound.map_or_else(String::new, |mm| format!("{:.3}", (unit.of(mm) * 1e3).floor() / 1e3)),
            part.filter(|p| !p.opposite_hand_of.is_empty()).map_or_else(String::new, |p| quoted(&p.opposite_hand_of)),
            part.map_or_else(String::new, |p| quoted(&p.source)),
        );
    }
    (!patterns.is_empty()).then(|| out.into_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answer::presentation::present;
    use crate::answer::{Answer, Job};
    use crate::geom::Vec2;
    use crate::io::materials::material;
    use crate::patchwork::part::Part;
    use crate::patchwork::pattern::{Bend, Contour, ContourVertex};

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
        let part = Part { name: "disc".into(), first: 0, count: 1, missing: None };
        let answer = Answer { patterns: vec![pattern], parts: vec![part], ..Answer::new(Job::Approximate, "a,b", 1.0) };
        let report = Report::of(&answer, &present(&answer));
        let text = String::from_utf8(csv(&report, &answer.patterns, LengthUnit::Inch).expect("a table")).expect("text");
        let row = text.lines().nth(1).expect("a row");
        assert!(row.starts_with("\"disc \"\"A\"\"\",\"a,b\",1,outside,,10.000,10.000,10.000,78.5398,31.41"), "{row}");
        assert!(text.starts_with("part,job,quantity,seen_from,thickness_in,length_in,"));
        assert!(csv(&report, &[], LengthUnit::Millimetre).is_none());
    }

    #[test]
    fn equal_parts_are_counted_and_weighed() {
        let corner = |x: f64, y: f64| ContourVertex { point: Vec2::new(x, y), bulge: 0.0, corner: true };
        let plate = |panel: usize, name: &str| Pattern {
            panel,
            name: name.into(),
            contours: vec![Contour { vertices: vec![corner(0., 0.), corner(1000., 0.), corner(0., 2000.)] }],
            area: 1e6,
            length: 2236.0,
            width: 894.0,
            ..Pattern::default()
        };
        let part = |name: &str, first: usize| Part { name: name.into(), first, count: 1, missing: None };
        let mut answer = Answer {
            patterns: vec![plate(0, "A-01"), plate(1, "A-02"), plate(2, "A-03").turned_over()],
            parts: vec![part("A-01", 0), part("A-02", 1), part("A-03", 2)],
            ..Answer::new(Job::Approximate, "deck", 1.0)
        };
        answer.shop.material = material("mild-steel", None).ok();
        answer.shop.thickness = Some(3.0);
        let report = Report::of(&answer, &present(&answer));
        let text = csv(&report, &answer.patterns, LengthUnit::Millimetre).expect("a table");
        let rows: Vec<String> = String::from_utf8(text).expect("text").lines().map(str::to_owned).collect();
        // Without bends a triangle turned over is the same sheet from behind.
        assert!(rows[0].contains(",mirrored,quantity_turned_over,pierces,material,weight_kg,"));
        assert!(rows[1].starts_with("\"A-01\",\"deck\",2,outside,3.000,"), "{}", rows[1]);
        assert!(rows[1].ends_with(",,,1,1,\"mild-steel\",23.5500,,,,\"\""), "{}", rows[1]);
        assert!(rows[2].starts_with("\"A-02\",\"deck\",0,") && rows[2].contains(",\"A-01\",no,0,1,"), "{}", rows[2]);
        assert!(rows[3].contains(",\"A-01\",yes,0,1,"), "{}", rows[3]);
        let total: usize = report.parts.iter().map(|p| p.quantity + p.quantity_turned_over).sum();
        assert_eq!(total, 3);
    }

    #[test]
    fn a_face_that_is_a_cylinder_says_its_radius_and_the_proof_another() {
        let mut report = crate::io::json::tests::sample();
        let (name, face) = (report.panels[0].name.clone(), 0);
        report.panels[0].face = Some(face);
        report.panels[0].kind = "cylinder".into();
        report.faces[face].radius = Some(250.0);
        let mut part = report.parts[0].clone();
        part.panels = vec![name.clone()];
        part.thickness = None;
        report.parts = vec![part];
        let bend = Bend { radii: [249.973; 2], ..Bend::default() };
        let pattern =
            Pattern { name, rulings: vec![[Vec2::zeros(), Vec2::x()]], bends: vec![bend], ..Pattern::default() };
        let row = |report: &Report| {
            let table = csv(report, std::slice::from_ref(&pattern), LengthUnit::Millimetre).expect("a table");
            let text = String::from_utf8(table).expect("text");
            let cells = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
            let lines: Vec<Vec<String>> = text.lines().map(cells).collect();
            let of = |name: &str| lines[0].iter().position(|c| c == name).map(|k| lines[1][k].clone());
            ["least_bend_radius_mm", "bend_radius_basis", "bend_radius_bound_mm"].map(|n| of(n).expect(n))
        };
        assert_eq!(row(&report), ["250.000", "face", "240.500"]);
        report.faces[face].radius = None;
        assert_eq!(row(&report), ["249.973", "bend lines", "240.500"]);
        report.panels[0].figures.clear();
        assert_eq!(row(&report)[2], "");
    }
}
