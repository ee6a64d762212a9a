//! Tables of panels, parts and faces.

use super::numbers::{lower, millimetres, number as rounded, plain, size, upper};
use crate::certify::claim::{Evidence, What};
use crate::draw::colour;
use crate::draw::scene::titled;
use crate::geom::unit::SQUARE_METRES;
use crate::io::json::{value, FigureRecord, JointRecord, PanelRecord, PartRecord, Report, UNKNOWN};
use crate::io::markup::escape;
use crate::io::words::numbers::is_endless;
use crate::io::words::{counted, evidence, id};
use crate::io::{bend_table, shop_tables};
use crate::torse::form::PanelKind;
use std::fmt::Write;

/// Digits of what is counted or given.
const GIVEN_DIGITS: usize = 9;

/// What the kind of the most general panels means, where there are such panels.
pub(super) fn kinds(report: &Report) -> String {
    if report.panels.iter().all(|p| p.kind != PanelKind::Torse.name()) {
        return String::new();
    }
    " A torse is a developable that is neither plane nor cylinder nor cone: its rulings are the tangents of a curve."
        .into()
}

/// Heading of a figure in the table of panels.
fn heading(f: &FigureRecord) -> String {
    let short = [
        (What::Deviation, "Distance"),
        (What::Twist, "Twist"),
        (What::RegressionClearance, "Regression"),
        (What::BendRadius, "Bend radius"),
        (What::LengthError, "Length error"),
        (What::DrawingDistance, "Drawing error"),
    ];
    let known = short.iter().find(|(what, _)| id(*what) == f.what);
    let name = known.map_or_else(|| f.name.clone(), |(_, name)| (*name).to_owned());
    let sign = match f.bound.as_str() {
        "lower" => " \u{2265}",
        "upper" => " \u{2264}",
        _ => "",
    };
    let unit = if f.unit.is_empty() { String::new() } else { format!(" ({})", f.unit) };
    format!("{name}{sign}{unit}")
}

/// The figures that panels have, in order: one of each name.
fn columns(report: &Report) -> Vec<&FigureRecord> {
    let mut out: Vec<&FigureRecord> = Vec::new();
    for f in report.panels.iter().flat_map(|p| &p.figures) {
        if !out.iter().any(|c| c.name == f.name) {
            out.push(f);
        }
    }
    out
}

/// Headings of the figures in the table of panels.
pub(super) fn figure_heads(report: &Report) -> String {
    let head = |f: &&FigureRecord| {
        let (words, title) = (escape(&heading(f)), escape(&format!("{}, {}", f.name, f.basis)));
        format!("<th class=\"number\"><button type=\"button\" title=\"{title}\">{words}</button></th>")
    };
    columns(report).iter().map(head).collect()
}

/// Rows of the table of panels.
pub(super) fn panels(report: &Report) -> String {
    let columns = columns(report);
    report.panels.iter().enumerate().map(|(i, p)| panel_row(i, p, &columns, report)).collect()
}

fn panel_row(index: usize, panel: &PanelRecord, columns: &[&FigureRecord], report: &Report) -> String {
    let mut row = format!("<tr id=\"panel-{index}\" data-panel=\"{index}\" tabindex=\"0\">");
    let mut cell = |class: &str, key: &str, text: &str| {
        let _ = write!(row, "<td class=\"{class}\" data-value=\"{key}\">{text}</td>");
    };
    let swatch = colour::hex(colour::shown(index, !panel.certified));
    let name = escape(&titled(&panel.name, !panel.certified));
    cell("name", &name, &format!("<i style=\"background:{swatch}\"></i>{name}"));
    // Under its heading, which only reports of covers have.
    if report.covers_faces() {
        let (key, text) =
            panel.face.map_or_else(Default::default, |f| (format!("{f:06}"), escape(&face_name(report, f))));
        cell("", &key, &text);
    }
    cell("", &escape(&panel.kind), &escape(&panel.kind));
    for column in columns {
        let Some(f) = panel.figures.iter().find(|f| f.name == column.name) else {
            cell("number", "-1", "\u{2014}");
            continue;
        };
        let text = match f.limit {
            Some(limit) if limit > 0.0 => {
                let share = f.value.map_or(1.0, |b| (b / limit).clamp(0.0, 1.0));
                let over = if f.value.is_none_or(|b| b > limit) { " over" } else { "" };
                format!("<span class=\"bar{over}\" style=\"--share:{share:.3}\">{}</span>", number(f))
            }
            _ => number(f),
        };
        // The bound is that of the spline in the file, whose curvature waves a little about the cylinder's.
        let radius = panel.face.filter(|_| f.what == id(What::BendRadius) && panel.kind == PanelKind::Cylinder.name());
        let radius = radius.and_then(|k| report.faces.get(k)?.radius);
        let text =
            radius.map_or(text.clone(), |r| format!("{text} <span class=\"quiet\">(face {})</span>", rounded(r)));
        cell("number", &f.value.map_or_else(|| "Infinity".into(), |x| format!("{x:e}")), &text);
    }
    let verdict = if panel.certified {
        "<span class=\"yes\">\u{2713} yes</span>".to_string()
    } else {
        format!("<span class=\"no\">no</span> <span class=\"why\">{}</span>", escape(&panel.reason))
    };
    cell("verdict", if panel.certified { "1" } else { "0" }, &verdict);
    row + "</tr>"
}

/// What a face is called: by its name, else by its number in the file.
pub(super) fn face_name(report: &Report, face: usize) -> String {
    match report.faces.get(face) {
        Some(f) if f.name.is_empty() => format!("#{}", f.entity),
        Some(f) => f.name.clone(),
        None => String::new(),
    }
}

/// A figure for people: bounds rounded to the safe side, and no radius where there is no bend.
pub(super) fn number(f: &FigureRecord) -> String {
    let endless = f.value.is_none_or(is_endless);
    match f.value {
        None if f.basis == UNKNOWN => "unknown".into(),
        // Of planes, or of cylinders.
        _ if endless && f.what == id(What::BendRadius) => "no bend".into(),
        _ if endless && f.what == id(What::RegressionClearance) => "none".into(),
        None => "\u{221e}".into(),
        Some(x) if f.bound == "lower" => lower(Some(x)),
        Some(x) if f.bound == "upper" => upper(Some(x)),
        Some(x) if f.basis == evidence(Evidence::Given) => plain(x, GIVEN_DIGITS),
        Some(x) => rounded(x),
    }
}

/// Rows of the table of parts.
pub(super) fn parts(report: &Report) -> String {
    let none = || "\u{2014}".to_string();
    let sized = |x: Option<f64>| x.map_or_else(none, size);
    let cell = |x: Option<f64>, unit: f64| x.map_or_else(none, |x| rounded(x * unit));
    // What is proven goes before what was measured.
    let error = |bound: Option<f64>, measured: Option<f64>| match (bound, measured) {
        (Some(x), _) => format!("\u{2264} {}", upper(Some(x))),
        (None, Some(x)) => format!("{} measured", rounded(x)),
        (None, None) => "\u{2014}".into(),
    };
    let remark = |p: &PartRecord| match (p.same_as.as_str(), p.mirrored) {
        ("", _) => p.missing.clone(),
        (name, false) => format!("same as {name}"),
        (name, true) => format!("same as {name} turned over"),
    };
    // Which part of a model with several it is.
    let several = report.parts.iter().any(|p| p.source != report.parts[0].source);
    let remark = |p: &PartRecord| match remark(p) {
        rest if !several || p.source.is_empty() || p.source == p.name => rest,
        rest if rest.is_empty() => format!("of {}", p.source),
        rest => format!("of {}; {rest}", p.source),
    };
    let quantity = |p: &PartRecord| match (p.quantity, p.quantity_turned_over) {
        (n, 0) => n.to_string(),
        (n, m) => format!("{n} + {m} turned over"),
    };
    let row = |p: &PartRecord| {
        format!(
            "<tr><td>{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td>\
             <td class=\"number\">{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td>\
             <td class=\"number\">{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td>\
             <td class=\"number\">{}</td><td class=\"number\">{}</td><td>{}</td></tr>",
            escape(&titled(&p.name, !p.certified)),
            p.panels.len(),
            quantity(p),
            sized(p.length),
            sized(p.width),
            cell(p.flat_area, SQUARE_METRES),
            cell(p.area, SQUARE_METRES),
            sized(p.cut_length),
            p.pierces,
            cell(p.weight_kg, 1.0),
            error(p.strain_bound, p.isometry_error),
            error(p.drawing_bound, p.contour_error),
            escape(&remark(p)),
        )
    };
    report.parts.iter().map(row).collect()
}

/// Map of the measured points, with the worst of them in words; nothing without points. `map` is the address of the
/// picture and the number of points outside it.
pub(super) fn points(report: &Report, map: Option<(String, usize)>, limit: f64) -> String {
    let Some((image, outside)) = map else { return String::new() };
    let mut words = format!(
        "Every measured point with its own distance from the strips; points beyond {}&nbsp;mm are larger and magenta.",
        rounded(limit)
    );
    if let Some(w) = &report.worst_point {
        let place = w.place.map(|x| plain(x, 7)).join(", ");
        let far = w.deviation.map_or_else(|| "infinitely".into(), |d| millimetres(d.abs()));
        let _ = write!(words, " The farthest is point {} at ({place}), {far} away.", w.index);
    }
    if outside > 0 {
        let (s, lie) = if outside == 1 { ("", "lies") } else { ("s", "lie") };
        let _ = write!(words, " {outside} point{s} {lie} outside the picture.");
    }
    format!(
        "<section class=\"card\" id=\"points\"><h2>Measured points</h2><p class=\"quiet\">{words} All values are in \
         <code>deviation.ply</code>.</p><img src=\"{image}\" alt=\"Map of the measured points\"></section>"
    )
}

/// Picture and table of the shapes along each part; nothing if there are none.
pub(super) fn shapes(report: &Report, picture: Option<String>) -> String {
    if report.shapes.is_empty() {
        return String::new();
    }
    let swatch = |name: &str| {
        let kind = match name {
            "plane" => PanelKind::Plane,
            "cylinder" => PanelKind::Cylinder,
            "cone" => PanelKind::Cone,
            _ => PanelKind::Torse,
        };
        colour::hex(colour::kind(kind))
    };
    let mut rows = String::new();
    for s in &report.shapes {
        let vector = s.vector.map_or_else(|| "\u{2014}".to_string(), |v| v.map(|x| plain(x, 5)).join(", "));
        let doubt = if s.ambiguous { "noise may hide another" } else { "" };
        let strips = if s.first == s.last {
            escape(&s.first)
        } else {
            format!("{}&nbsp;… {}", escape(&s.first), escape(&s.last))
        };
        let _ = write!(
            rows,
            "<tr><td>{}</td><td class=\"name\"><i style=\"background:{}\"></i>{}</td><td>{strips}</td>\
             <td class=\"number\">{}</td><td class=\"number\">{vector}</td><td class=\"number\">{}</td><td>{doubt}</td></tr>",
            escape(&s.part),
            swatch(&s.shape),
            escape(&s.shape),
            rounded(s.turn),
            rounded(s.residual),
        );
    }
    let picture = picture.map_or_else(String::new, |p| format!("<img src=\"{p}\" alt=\"Strips coloured by shape\">"));
    format!(
        "<section class=\"card\" id=\"shapes\"><h2>Shapes</h2><p class=\"quiet\">What each part consists of, told from its \
         tangent planes (measured). The vector is the normal of a plane, the direction of a cylinder, the apex of a cone in \
         mm.</p>{picture}<div class=\"scroll\"><table><thead><tr><th>Part</th><th>Shape</th><th>Strips</th>\
         <th class=\"number\">Turn (°)</th><th class=\"number\">Vector</th><th class=\"number\">Residual</th><th>Doubt</th></tr></thead>\
         <tbody>{rows}</tbody></table></div></section>"
    )
}

/// The table of faces.
pub(super) fn faces(report: &Report) -> String {
    let mut out = String::from(
        "<section class=\"card\" id=\"faces\"><h2>Faces</h2><div class=\"scroll\"><table><thead><tr><th>Entity</th>\
         <th>Name</th><th>Part</th><th>Surface</th><th class=\"number\">Panels</th><th class=\"number\">Covered</th>\
         <th class=\"number\">Edges read to (mm)</th><th class=\"number\">Surface read to (mm)</th></tr></thead><tbody>",
    );
    for face in &report.faces {
        let numbers = match &face.joined[..] {
            [] => format!("#{}", face.entity),
            parts => parts.iter().map(|p| format!("#{}", p.entity)).collect::<Vec<_>>().join(" + "),
        };
        let estimate = |x: Option<f64>| x.map_or_else(|| "?".into(), rounded);
        let _ = write!(
            out,
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td class=\"number\">{}</td><td class=\"number\">{} %</td>\
             <td class=\"number\">{}</td><td class=\"number\">{}</td></tr>",
            numbers,
            escape(&face.name),
            escape(&face.part),
            escape(&face.kind),
            face.panels,
            plain((face.coverage * 10_000.0).floor() / 100.0, 4),
            estimate(face.trim_deviation_estimate),
            estimate(face.surface_deviation_estimate),
        );
    }
    out + "</tbody></table></div>" + &skipped(report) + &notes(report) + "</section>"
}

/// The table of seams, if there are any.
pub(super) fn seams(report: &Report) -> String {
    if report.seams.is_empty() {
        return String::new();
    }
    let name = |k: usize| report.panels.get(k).map_or_else(String::new, |p| escape(&p.name));
    let mut out = String::from(
        "<details><summary>Seams</summary><div class=\"scroll\"><table><thead><tr><th>Seam</th><th>Between</th><th>Joint</th><th>Gap, mm</th>\
         <th>Length, mm</th><th>Angle, degrees</th></tr></thead><tbody>",
    );
    for s in &report.seams {
        let between = both_sides(&s.between.map(name));
        let joint = match s.joint.as_str() {
            "exact" => "exact: one common edge",
            "tolerance" => "within the tolerance",
            _ => "open",
        };
        let _ = write!(
            out,
            "<tr><td>{}</td><td>{between}</td><td>{joint}</td><td class=\"number\">{}</td><td class=\"number\">{}</td>\
             <td class=\"number\">{} to {}</td></tr>",
            s.number.map_or_else(String::new, |n| format!("S{n}")),
            upper(s.gap_bound),
            s.seam_length.map_or_else(|| "?".into(), size),
            rounded(s.kink_deg[0]),
            rounded(s.kink_deg[1]),
        );
    }
    out + "</tbody></table></div></details>"
}

/// The panels on both sides of a seam or joint, which may be one.
fn both_sides([a, b]: &[String; 2]) -> String {
    if a == b {
        format!("{a}, with itself")
    } else {
        format!("{a} \u{2013} {b}")
    }
}

/// The table of joints between parts, if there are any.
pub(super) fn joints(report: &Report) -> String {
    if report.joints.is_empty() {
        return String::new();
    }
    let row = |j: &JointRecord| {
        let between = both_sides(&j.between.each_ref().map(|name| escape(name)));
        let gap = j.gap_estimate.map_or_else(|| "unknown".into(), rounded);
        let lengths = j.lengths_estimate.map_or_else(String::new, |[a, b]| format!("{a:.3} \u{2013} {b:.3}"));
        format!(
            "<tr><td>{}</td><td>{between}</td><td class=\"number\">{}</td><td class=\"number\">{gap}</td>\
             <td class=\"number\">{lengths}</td></tr>",
            escape(&j.name),
            j.marks
        )
    };
    let rows: String = report.joints.iter().map(row).collect();
    format!(
        "<details open><summary>Joints</summary><p class=\"quiet\">Borders that meet carry marks with the same labels on both \
         sides: J1.1, J1.2, \u{2026} along joint J1.</p><div class=\"scroll\"><table><thead><tr><th>Joint</th><th>Between</th>\
         <th class=\"number\">Marks on each side</th><th class=\"number\">Gap at marks, mm, measured</th>\
         <th class=\"number\">Lengths of both sides in the plane, mm, measured</th></tr></thead><tbody>{rows}</tbody></table></div></details>"
    )
}

/// The table of joins, if there are any.
pub(super) fn joins(report: &Report) -> String {
    if report.joins.is_empty() {
        return String::new();
    }
    let mut out = format!(
        "<section class=\"card\" id=\"joins\"><h2>{}</h2><p class=\"quiet\">Proven, the worst first.</p><div class=\"scroll\">\
         <table><thead><tr><th>Join</th><th>Between</th><th class=\"number\">Gap \u{2264}, mm</th>\
         <th class=\"number\">Angle \u{2264}, degrees</th><th class=\"number\">Flat sides of a fold apart \u{2264}, mm</th>\
         <th>Smooth</th><th>Certified</th></tr></thead><tbody>",
        counted(report.joins.len(), "join"),
    );
    for j in &report.joins {
        let certified =
            if j.certified { "<span class=\"yes\">\u{2713} yes</span>" } else { "<span class=\"no\">no</span>" };
        let _ = write!(
            out,
            "<tr><td>{}</td><td>{} \u{2013} {}</td><td class=\"number\">{}</td><td class=\"number\">{}</td>\
             <td class=\"number\">{}</td><td>{}</td><td class=\"verdict\">{certified}</td></tr>",
            j.number,
            escape(&j.between[0]),
            escape(&j.between[1]),
            upper(j.gap_bound),
            upper(j.angle_bound_deg),
            j.fold_bound.map_or(String::new(), |b| upper(Some(b))),
            if j.smooth { "should be" } else { "" },
        );
    }
    out + "</tbody></table></div></section>"
}

/// The table of panels along curves, if there are any.
pub(super) fn panels_along_curves(report: &Report) -> String {
    if report.along.is_empty() {
        return String::new();
    }
    let mut out = String::from(
        "<details><summary>Panels along curves</summary><table><thead><tr><th>Panel</th><th>Curve</th>\
         <th>Strips from it</th><th>Certified bound, mm</th><th>Matching points (sampled), mm</th></tr></thead><tbody>",
    );
    for a in &report.along {
        let panel = report.panels.get(a.panel);
        let _ = write!(
            out,
            "<tr><td>{}</td><td>{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td>\
             <td class=\"number\">{}</td></tr>",
            panel.map_or_else(String::new, |p| escape(&p.name)),
            escape(&a.curve),
            a.step,
            upper(panel.and_then(|p| value(&p.figures, What::Deviation))),
            upper(a.paper_deviation_estimate),
        );
    }
    out + "</tbody></table><p>The certified bound is proven at every point, edges as exported included. The last column \
        compares points with equal parameters, as the method of envelopes along curves does; it counts their \
        mismatch along the surface too, and is no bound.</p></details>"
}

/// Notes, if there are any.
pub(super) fn notes(report: &Report) -> String {
    let items: String = report.notes.iter().map(|n| format!("<li>{}</li>", escape(n))).collect();
    if items.is_empty() {
        items
    } else {
        format!("<h3>Notes</h3><ul>{items}</ul>")
    }
}

/// What was left out, if anything.
pub(super) fn skipped(report: &Report) -> String {
    if report.skipped.is_empty() {
        return String::new();
    }
    let mut out = String::from("<h3>Left out</h3><ul class=\"missing\">");
    for item in &report.skipped {
        let area = match (item.entity, item.area_estimate) {
            (_, Some(a)) => format!(" (about {} mm\u{b2})", rounded(a)),
            (Some(_), None) => " (area unknown)".into(),
            (None, None) => String::new(),
        };
        let entity = item.entity.map_or_else(String::new, |e| format!("#{e}: "));
        let _ = write!(out, "<li>{entity}{}{area}</li>", escape(&item.reason));
    }
    out + "</ul>"
}

/// The bend table of sheet metal; empty without bends.
pub(super) fn sheet_bends(report: &Report) -> String {
    bend_table::table(report.parts.iter().map(|p| (p.name.as_str(), p.sheet_bends.as_slice())))
}

/// How kinked parts are kinked; empty without kinks.
pub(super) fn facets(report: &Report) -> String {
    shop_tables::facets_table(report.parts.iter().filter_map(|p| Some((p.name.as_str(), p.facets.as_ref()?))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::json::tests::sample;

    #[test]
    fn one_row_per_panel_with_sortable_values() {
        let rows = panels(&sample());
        assert_eq!(rows.matches("<tr ").count(), 2);
        assert!(rows.contains("data-value=\"9.5e-1\""));
    }

    #[test]
    fn a_panel_of_a_cylinder_says_the_radius_of_its_face() {
        let mut report = sample();
        (report.panels[0].face, report.panels[0].kind) = (Some(0), "cylinder".into());
        report.faces[0].radius = Some(250.0);
        assert_eq!(panels(&report).matches("240 <span class=\"quiet\">(face 250)</span>").count(), 1);
    }

    #[test]
    fn planes_do_not_bend_and_tiny_numbers_are_not_told_to_the_last() {
        let mut f = sample().panels[0].figures[3].clone();
        assert_eq!(number(&f), "240");
        for value in [Some(4.676e155), None] {
            f.value = value;
            assert_eq!(number(&f), "no bend");
        }
        let mut twist = sample().panels[0].figures[1].clone();
        twist.value = Some(4.9e-306);
        assert_eq!(number(&twist), "1e\u{2212}12");
        (twist.value, twist.basis, twist.bound) = (Some(12_345.0), "given".into(), String::new());
        assert_eq!(number(&twist), "12345");
    }

    #[test]
    fn joints_name_the_parts_that_they_join() {
        let mut report = sample();
        assert!(joints(&report).contains(
            "<td>J1</td><td>A-01 \u{2013} A-02</td><td class=\"number\">3</td><td class=\"number\">0.25</td>\
             <td class=\"number\">80.000 \u{2013} 80.500</td>"
        ));
        report.joints[0].between[1] = "A-01".into();
        assert!(joints(&report).contains("A-01, with itself"));
        report.joints.clear();
        assert_eq!(joints(&report), "");
    }
}
