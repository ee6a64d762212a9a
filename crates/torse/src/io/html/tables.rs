//! Tables of panels and faces, and the flat layout as inline SVG.

use super::escape;
use super::words::{lower, plain, upper, witness};
use crate::draw::colour;
use crate::draw::flat::FlatPiece;
use crate::draw::scene::{titled, NOT_CERTIFIED};
use crate::geom::Vec2;
use crate::io::bends;
use crate::io::json::{PanelRecord, Report};
use std::fmt::Write;

/// Rows of the table of panels.
pub(super) fn panels(report: &Report) -> String {
    report.panels.iter().enumerate().map(|(i, p)| panel_row(i, p, report)).collect()
}

fn panel_row(index: usize, panel: &PanelRecord, report: &Report) -> String {
    let mut row = format!("<tr id=\"panel-{index}\" data-panel=\"{index}\" tabindex=\"0\">");
    let mut cell = |class: &str, key: &str, text: &str| {
        let _ = write!(row, "<td class=\"{class}\" data-value=\"{key}\">{text}</td>");
    };
    let swatch = colour::hex(colour::shown(index, !panel.certified));
    let name = escape(&titled(&panel.name, !panel.certified));
    cell("name", &name, &format!("<i style=\"background:{swatch}\"></i>{name}"));
    let face = report.faces.get(panel.face);
    let face_name =
        face.map_or_else(String::new, |f| if f.name.is_empty() { format!("#{}", f.entity) } else { f.name.clone() });
    cell("", &format!("{:06}", panel.face), &escape(&face_name));
    cell("", &escape(&panel.kind), &escape(&panel.kind));
    let share = panel.deviation_bound.map_or(1.0, |b| (b / report.tolerance).clamp(0.0, 1.0));
    let over = panel.deviation_bound.is_none_or(|b| b > report.tolerance);
    cell(
        "number",
        &key(panel.deviation_bound, true),
        &format!(
            "<span class=\"bar{}\" style=\"--share:{:.3}\">{}</span>",
            if over { " over" } else { "" },
            share,
            upper(panel.deviation_bound)
        ),
    );
    let degrees = panel.developability_bound.map(f64::to_degrees);
    cell("number", &key(degrees, true), &degrees.map_or_else(|| upper(None), exponent));
    cell("number", &key(panel.regression_clearance, true), &lower(panel.regression_clearance));
    cell("number", &key(panel.min_bend_radius, true), &lower(panel.min_bend_radius));
    let measure =
        |x: Option<f64>, unit: f64, digits: usize| x.map_or_else(|| "\u{2014}".into(), |x| plain(x * unit, digits));
    cell("number", &key(panel.length, false), &measure(panel.length, 1.0, 5));
    cell("number", &key(panel.width, false), &measure(panel.width, 1.0, 5));
    cell("number", &key(panel.flat_area, false), &measure(panel.flat_area, 1e-6, 4));
    cell(
        "number",
        &key(panel.isometry_error, false),
        &panel.isometry_error.map_or_else(|| "\u{2014}".into(), exponent),
    );
    let verdict = if panel.certified {
        "<span class=\"yes\">\u{2713} yes</span>".to_string()
    } else {
        format!("<span class=\"no\">no</span> <span class=\"why\">{}{}</span>", escape(&panel.reason), witness(panel))
    };
    cell("verdict", if panel.certified { "1" } else { "0" }, &verdict);
    row + "</tr>"
}

/// Sorting key of a number; where there is none it counts as infinite or as less than everything.
fn key(x: Option<f64>, infinite: bool) -> String {
    x.map_or_else(|| if infinite { "Infinity" } else { "-1" }.to_string(), |x| format!("{x:e}"))
}

/// A tiny number in powers of ten, rounded up.
pub(super) fn exponent(x: f64) -> String {
    if x == 0.0 {
        return "0".into();
    }
    let power = x.abs().log10().floor() as i32;
    let mantissa = (x / 10f64.powi(power) * 10.0).ceil() / 10.0;
    if power >= -2 {
        return upper(Some(x));
    }
    format!("{mantissa:.1}\u{b7}10<sup>{}</sup>", power.to_string().replace('-', "\u{2212}"))
}

/// Rows of the table of faces.
pub(super) fn faces(report: &Report) -> String {
    let mut out = String::new();
    for face in &report.faces {
        let numbers = match &face.joined[..] {
            [] => format!("#{}", face.entity),
            parts => parts.iter().map(|p| format!("#{}", p.entity)).collect::<Vec<_>>().join(" + "),
        };
        let estimate = |x: Option<f64>| x.map_or_else(|| "?".into(), |x| plain(x, 2));
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
    out
}

/// The table of seams, if there are any.
pub(super) fn seams(report: &Report) -> String {
    if report.seams.is_empty() {
        return String::new();
    }
    let name = |k: usize| report.panels.get(k).map_or_else(String::new, |p| escape(&p.name));
    let mut out = String::from(
        "<details><summary>Seams</summary><div class=\"scroll\"><table><thead><tr><th>Between</th><th>Joint</th><th>Gap, mm</th>\
         <th>Length, mm</th><th>Angle, degrees</th></tr></thead><tbody>",
    );
    for s in &report.seams {
        let [a, b] = s.between.map(name);
        let joint = match s.joint.as_str() {
            "exact" => "exact: one common edge",
            "tolerance" => "within the tolerance",
            _ => "open",
        };
        let _ = write!(
            out,
            "<tr><td>{a} \u{2013} {b}</td><td>{joint}</td><td class=\"number\">{}</td><td class=\"number\">{}</td>\
             <td class=\"number\">{} to {}</td></tr>",
            upper(s.gap_bound),
            s.seam_length.map_or_else(|| "?".into(), |x| plain(x, 5)),
            plain(s.kink_deg[0], 3),
            plain(s.kink_deg[1], 3),
        );
    }
    out + "</tbody></table></div></details>"
}

/// The table of panels along curves, if there are any.
pub(super) fn along(report: &Report) -> String {
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
            upper(panel.and_then(|p| p.deviation_bound)),
            upper(a.paper_deviation_estimate),
        );
    }
    out + "</tbody></table><p>The certified bound is proven at every point, edges as exported included. The last column \
        compares points with equal parameters, as the method of envelopes along curves does; it counts their \
        mismatch along the surface too, and is no bound.</p></details>"
}

/// What was left out, if anything, and notes.
pub(super) fn skipped(report: &Report) -> String {
    let items: String = report.notes.iter().map(|n| format!("<li>{}</li>", escape(n))).collect();
    let notes = if items.is_empty() { items } else { format!("<h3>Notes</h3><ul>{items}</ul>") };
    if report.skipped.is_empty() {
        return notes;
    }
    let mut out = String::from("<h3>Left out</h3><ul class=\"missing\">");
    for item in &report.skipped {
        let area = item.area_estimate.map_or("area unknown".into(), |a| format!("about {} mm\u{b2}", plain(a, 4)));
        let _ = write!(out, "<li>#{}: {} ({area})</li>", item.entity, escape(&item.reason));
    }
    out + "</ul>" + &notes
}

/// The flat patterns as SVG, one group per panel, 1 unit = 1 mm.
pub(super) fn layout(pieces: &[FlatPiece]) -> String {
    let finite = |p: &&Vec2| p.x.is_finite() && p.y.is_finite();
    let (mut low, mut high) = (Vec2::repeat(f64::INFINITY), Vec2::repeat(f64::NEG_INFINITY));
    for p in pieces.iter().flat_map(|p| p.outlines.iter().flatten()).filter(finite) {
        (low, high) = (low.inf(p), high.sup(p));
    }
    if low.x > high.x {
        return "<p class=\"quiet\">There are no flat patterns.</p>".into();
    }
    let margin = 0.01 * (high - low).norm();
    let (width, height) = (high.x - low.x + 2.0 * margin, high.y - low.y + 2.0 * margin);
    let place = |p: &Vec2| (p.x - low.x + margin, high.y - p.y + margin);
    let mut out = format!(
        "<svg class=\"flat\" viewBox=\"0 0 {width:.3} {height:.3}\" role=\"img\" aria-label=\"Flat patterns\">"
    );
    for piece in pieces {
        let _ = write!(
            out,
            "<g data-panel=\"{}\" style=\"--hue:{}\"><title>{}</title><path class=\"piece\" d=\"",
            piece.panel,
            colour::hex(colour::shown(piece.panel, piece.marked)),
            escape(&titled(&piece.name, piece.marked))
        );
        for outline in &piece.outlines {
            for (i, p) in outline.iter().filter(finite).enumerate() {
                let (x, y) = place(p);
                let _ = write!(out, "{}{x:.2} {y:.2}", if i == 0 { "M" } else { "L" });
            }
            out.push('Z');
        }
        out.push_str("\"/><path class=\"ruling\" d=\"");
        for [a, b] in piece.rulings.iter().filter(|r| r.iter().all(|p| finite(&p))) {
            let ((ax, ay), (bx, by)) = (place(a), place(b));
            let _ = write!(out, "M{ax:.2} {ay:.2}L{bx:.2} {by:.2}");
        }
        let (x, y) = place(&piece.label);
        // As large as the place allows, but never so small next to the sheet that it cannot be read.
        let size = (0.9 * piece.room).clamp(0.010 * width, 0.028 * width);
        let _ = write!(
            out,
            "\"/><text x=\"{x:.2}\" y=\"{:.2}\" font-size=\"{size:.2}\">{}</text>",
            y + 0.35 * size,
            escape(&piece.name)
        );
        if piece.marked {
            // Below the name and smaller: the words are longer.
            let (y, size) = (y + 1.1 * size, 0.5 * size);
            let _ = write!(out, "<text x=\"{x:.2}\" y=\"{y:.2}\" font-size=\"{size:.2}\">{NOT_CERTIFIED}</text>");
        }
        out.push_str("</g>");
    }
    out + "</svg>" + &bends::table(pieces)
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
    fn tiny_numbers_are_written_with_powers_and_rounded_up() {
        assert_eq!(exponent(2.41e-9), "2.5\u{b7}10<sup>\u{2212}9</sup>");
        assert_eq!(exponent(0.0), "0");
    }

    #[test]
    fn the_layout_has_a_group_per_panel_with_y_downwards() {
        let square = vec![Vec2::new(0.0, 0.0), Vec2::new(10.0, 0.0), Vec2::new(10.0, 5.0), Vec2::new(0.0, 5.0)];
        let piece = FlatPiece { name: "A-01".into(), outlines: vec![square], ..FlatPiece::default() };
        let svg = layout(&[piece]);
        assert!(svg.contains("data-panel=\"0\"") && svg.contains("A-01"));
        assert!(svg.contains("M0.11 5.11L10.11 5.11"), "{svg}");
        assert!(layout(&[]).contains("no flat patterns"));
    }
}
