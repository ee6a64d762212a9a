//! The flat layout as inline SVG.

use crate::draw::colour;
use crate::draw::flat::FlatPiece;
use crate::draw::names::{listed, on_sheet, PlacedName, SheetNames};
use crate::draw::scene::{titled, NOT_CERTIFIED};
use crate::geom::Vec2;
use crate::io::bends;
use crate::io::markup::escape;
use std::fmt::Write;

/// Height of capitals against the size of a font.
const CAPITALS: f64 = 0.72;

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
    let SheetNames { names, extent: [low, high] } = on_sheet(pieces, [low, high]);
    let margin = 0.01 * (high - low).norm();
    let (width, height) = (high.x - low.x + 2.0 * margin, high.y - low.y + 2.0 * margin);
    let place = |p: &Vec2| (p.x - low.x + margin, high.y - p.y + margin);
    let mut out = format!(
        "<svg class=\"flat\" viewBox=\"0 0 {width:.3} {height:.3}\" role=\"img\" aria-label=\"Flat patterns\">"
    );
    for (k, piece) in pieces.iter().enumerate() {
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
        for (class, lines) in [("section", &piece.sections), ("curve", &piece.curves)] {
            if lines.is_empty() {
                continue;
            }
            let _ = write!(out, "\"/><path class=\"{class}\" d=\"");
            for line in lines {
                for (i, p) in line.iter().filter(finite).enumerate() {
                    let (x, y) = place(p);
                    let _ = write!(out, "{}{x:.2} {y:.2}", if i == 0 { "M" } else { "L" });
                }
            }
        }
        out.push_str("\"/>");
        for name in names.iter().filter(|n| n.named == k) {
            if let Some([a, b]) = &name.leader {
                let ((ax, ay), (bx, by)) = (place(a), place(b));
                // A line of no length is a dot: it says which part the name is of.
                let _ = write!(
                    out,
                    "<path class=\"leader\" d=\"M{ax:.2} {ay:.2}L{bx:.2} {by:.2}\"/>\
                     <path class=\"leader dot\" d=\"M{ax:.2} {ay:.2}h0\"/>"
                );
            }
            let (x, y) = place(&name.middle);
            let mut text = |y: f64, size: f64, words: &str| {
                let size = size / CAPITALS;
                let words = escape(words);
                let _ = write!(out, "<text x=\"{x:.2}\" y=\"{y:.2}\" font-size=\"{size:.2}\">{words}</text>");
            };
            text(y + 0.5 * name.size, name.size, &name.text(&piece.name));
            if let Some((size, below)) = name.words {
                text(y + 0.5 * name.size + below, size, NOT_CERTIFIED);
            }
        }
        out.push_str("</g>");
    }
    out + "</svg>" + &name_list(pieces, &names) + &bends::table(pieces)
}

/// The names for which numbers stand.
fn name_list(pieces: &[FlatPiece], names: &[PlacedName]) -> String {
    let list = listed(names);
    if list.is_empty() {
        return String::new();
    }
    let entry = |(number, k): (usize, usize)| {
        format!("<li value=\"{number}\">{}</li>", escape(&titled(&pieces[k].name, pieces[k].marked)))
    };
    format!("<ol class=\"names\">{}</ol>", list.into_iter().map(entry).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_layout_has_a_group_per_panel_with_y_downwards() {
        let square = vec![Vec2::new(0.0, 0.0), Vec2::new(10.0, 0.0), Vec2::new(10.0, 5.0), Vec2::new(0.0, 5.0)];
        let piece = FlatPiece { name: "A-01".into(), outlines: vec![square], ..FlatPiece::default() };
        let svg = layout(&[piece]);
        assert!(svg.contains("data-panel=\"0\"") && svg.contains("A-01"));
        assert!(svg.contains("M0.11 5.11L10.11 5.11"), "{svg}");
        assert!(layout(&[]).contains("no flat patterns"));
    }

    #[test]
    fn names_for_which_numbers_stand_are_listed() {
        let part = |name: &str, x: [f64; 2], y: [f64; 2]| {
            let outline = [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]].map(Vec2::from).to_vec();
            FlatPiece { name: name.into(), outlines: vec![outline], ..FlatPiece::default() }
        };
        // A slim part with large ones on all sides.
        let mut pieces = [
            part("below", [0.0, 1000.0], [0.0, 480.0]),
            part("above", [0.0, 1000.0], [520.0, 1000.0]),
            part("left", [0.0, 395.0], [482.0, 518.0]),
            part("right", [605.0, 1000.0], [482.0, 518.0]),
            part("slim & long", [400.0, 600.0], [482.0, 518.0]),
        ];
        let fits = layout(&pieces);
        assert!(!fits.contains("<ol") && fits.contains(">slim &amp; long</text>"), "{fits}");
        pieces[4] = part("slim & long", [400.0, 600.0], [497.0, 503.0]);
        pieces[4].marked = true;
        let covers = [part("", [400.0, 600.0], [482.0, 496.0]), part("", [400.0, 600.0], [504.0, 518.0])];
        let numbered = layout(&[&pieces[..], &covers[..]].concat());
        assert!(numbered.contains("<li value=\"1\">slim &amp; long NOT CERTIFIED</li>"), "{numbered}");
        assert!(numbered.contains(">1</text>") && !numbered.contains(">slim &amp; long</text>"));
    }

    #[test]
    fn names_of_narrow_parts_stand_beside_them_with_a_line() {
        let strip = |k: usize, wide: f64| {
            let y = 90.0 * k as f64;
            let outline = [[0.0, y], [2000.0, y], [2000.0, y + wide], [0.0, y + wide]].map(Vec2::from).to_vec();
            FlatPiece { panel: k, name: format!("A-{:02}", k + 1), outlines: vec![outline], ..FlatPiece::default() }
        };
        let mut pieces = [strip(0, 8.0), strip(1, 60.0), strip(2, 8.0)];
        pieces[2].marked = true;
        let svg = layout(&pieces);
        assert_eq!(svg.matches("class=\"leader\"").count(), 2);
        assert_eq!(svg.matches("<text ").count(), 4);
        assert!(svg.contains(">A-03</text>") && svg.contains(">NOT CERTIFIED</text>"));
    }
}
