//! SVG writer: cutting drawings in millimetres or inches, one user unit being one of these.
//!
//! Every panel is a group with sub-groups for cuts, rulings, marks and text, which Inkscape shows as layers; panels that
//! must not be cut have one sub-group in a colour of its own. Arcs of
//! outlines stay arcs (`A`). Strokes are hairlines of 0.01 mm, as laser drivers expect of cuts; browsers, which would
//! not show these, are told to draw one pixel.

use std::fmt::Write as _;
use std::io;

use super::stretches::flush;
use crate::draw::drawing::{Drawing, DrawnPattern, Lettering, LETTER_DECIMALS};
use crate::draw::scene::titled;
use crate::geom::unit::LengthUnit;
use crate::geom::Vec2;
use crate::patchwork::pattern::{BendSense, Contour, ContourVertex};

/// White border around the drawing, mm.
const MARGIN: f64 = 10.0;
/// Stroke width of everything, mm.
const HAIRLINE: f64 = 0.01;
/// Colours: red cuts and blue scores for most laser drivers; holes differ so that they can be cut first.
const COLOURS: [(&str, &str); 11] = [
    ("cut-outer", "#ff0000"),
    ("cut-inner", "#ff00ff"),
    ("bend-up", "#0080ff"),
    ("bend-down", "#ff8000"),
    ("rulings", "#00a000"),
    ("bend-extent", "#808080"),
    ("formed", "#00a0a0"),
    ("mark-section", "#b08000"),
    ("mark-curve", "#008080"),
    ("marks", "#0000ff"),
    ("text", "#000000"),
];

/// Class and colour of everything of parts that must not be cut: no machine takes orange for a cut.
const NOT_CERTIFIED: (&str, &str) = ("not-certified", "#ff0080");

/// Class of the test square.
const SCALE: &str = "scale-check";

/// Decimals of millimetres.
const LENGTHS: usize = 6;

/// Writes the file of a drawing, part by part: files of many parts are long.
///
/// # Errors
/// A coordinate that is not a finite number ([`io::ErrorKind::InvalidData`]), and those of `out`.
pub(crate) fn write(drawing: &Drawing, out: &mut dyn io::Write) -> io::Result<()> {
    let (left, top) = (drawing.min.x - MARGIN, drawing.max.y + MARGIN);
    let mut document = Document { text: String::new(), left, top, finite: true, unit: drawing.unit };
    let size = drawing.max - drawing.min + Vec2::repeat(2.0 * MARGIN);
    let (width, height) = (document.number(size.x), document.number(size.y));
    let (unit, hairline) = (drawing.unit.sign(), document.number(HAIRLINE));
    // Writing to a string cannot fail.
    _ = write!(
        document.text,
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" \
         width=\"{width}{unit}\" height=\"{height}{unit}\" viewBox=\"0 0 {width} {height}\" \
         fill=\"none\" stroke-width=\"{hairline}\" stroke-linejoin=\"round\">\n\
         <style>@media screen {{ path {{ stroke-width: 1px; vector-effect: non-scaling-stroke }} }}</style>\n"
    );
    for (i, piece) in drawing.pieces.iter().enumerate() {
        document.piece(i, piece);
        flush(&mut document.text, document.finite, out)?;
    }
    if let Some(square) = &drawing.test_square {
        _ = writeln!(
            document.text,
            "<g class=\"{SCALE}\" inkscape:groupmode=\"layer\" inkscape:label=\"{SCALE}\" stroke=\"#808080\">"
        );
        let [a, b, c, d] = square.corners;
        let mut paths = vec![document.open(&[a, b, c, d, a])];
        paths.extend(Lettering::all(&square.texts).map(|s| document.polyline(&s, LETTER_DECIMALS)));
        for path in paths {
            _ = writeln!(document.text, "<path d=\"{path}\"/>");
        }
        document.text.push_str("</g>\n");
    }
    document.text.push_str("</svg>\n");
    flush(&mut document.text, document.finite, out)
}

/// The document while it grows, and where its upper left corner lies in the drawing, whose y-axis points up.
struct Document {
    text: String,
    left: f64,
    top: f64,
    finite: bool,
    /// Unit of coordinates.
    unit: LengthUnit,
}

impl Document {
    /// A length (mm) in the unit of the drawing, to a nanometre or finer.
    fn number(&mut self, x: f64) -> String {
        self.rounded(x, LENGTHS)
    }

    /// A length (mm) in the unit of the drawing, as fine as so many decimals of millimetres, without idle zeros.
    fn rounded(&mut self, x: f64, decimals: usize) -> String {
        self.finite &= x.is_finite();
        let mut s = format!("{:.*}", self.unit.decimals(decimals), self.unit.of(x));
        let keep = s.trim_end_matches('0').trim_end_matches('.').len();
        s.truncate(keep);
        if s == "-0" {
            "0".into()
        } else {
            s
        }
    }

    fn point(&mut self, p: &Vec2) -> String {
        self.rounded_point(p, LENGTHS)
    }

    fn rounded_point(&mut self, p: &Vec2, decimals: usize) -> String {
        let (x, y) = (self.rounded(p.x - self.left, decimals), self.rounded(self.top - p.y, decimals));
        format!("{x} {y}")
    }

    fn piece(&mut self, index: usize, piece: &DrawnPattern) {
        let name = escaped(&titled(&piece.name, piece.marked));
        _ = write!(
            self.text,
            "<g id=\"panel-{}\" inkscape:groupmode=\"layer\" inkscape:label=\"{name}\">\n<title>{name}</title>\n",
            identifier(index, &piece.name)
        );
        let outer = piece.outer.iter().map(|c| self.contour(c)).collect::<Vec<_>>();
        let inner = piece.inner.iter().map(|c| self.contour(c)).collect::<Vec<_>>();
        let [up, down, rulings] = [BendSense::Up, BendSense::Down, BendSense::Flat]
            .map(|sense| piece.bent(sense).map(|l| self.open(l)).collect::<Vec<_>>());
        let marks = piece.marks.iter().map(|l| self.open(l)).collect::<Vec<_>>();
        // One path for all letters: they are never picked one by one.
        let text = piece.strokes().map(|s| self.polyline(&s, LETTER_DECIMALS)).collect::<Vec<_>>().concat();
        let text = if text.is_empty() { Vec::new() } else { vec![text] };
        let extents = piece.extents.iter().map(|l| self.open(l)).collect::<Vec<_>>();
        let formed = piece.formed.iter().map(|c| self.contour(c)).collect::<Vec<_>>();
        let sections = piece.sections.iter().map(|l| self.path(&l.joints, l.closed)).collect::<Vec<_>>();
        let curves = piece.curves.iter().map(|l| self.path(&l.joints, l.closed)).collect::<Vec<_>>();
        let groups = [outer, inner, up, down, rulings, extents, formed, sections, curves, marks, text];
        let groups: Vec<_> = if piece.marked {
            vec![(NOT_CERTIFIED, groups.concat())]
        } else {
            COLOURS.into_iter().zip(groups).collect()
        };
        for ((class, colour), paths) in groups {
            if paths.is_empty() {
                continue;
            }
            _ = writeln!(
                self.text,
                "<g class=\"{class}\" inkscape:groupmode=\"layer\" inkscape:label=\"{class}\" stroke=\"{colour}\">"
            );
            for path in paths {
                _ = writeln!(self.text, "<path d=\"{path}\"/>");
            }
            self.text.push_str("</g>\n");
        }
        self.text.push_str("</g>\n");
    }

    fn open(&mut self, points: &[Vec2]) -> String {
        self.polyline(points, LENGTHS)
    }

    fn polyline(&mut self, points: &[Vec2], decimals: usize) -> String {
        let mut d = String::new();
        for (i, p) in points.iter().enumerate() {
            d.push(if i == 0 { 'M' } else { 'L' });
            d.push_str(&self.rounded_point(p, decimals));
        }
        d
    }

    fn contour(&mut self, c: &Contour) -> String {
        self.path(&c.vertices, true)
    }

    /// Lines and arcs from joint to joint, and of a closed one from the last to the first.
    fn path(&mut self, joints: &[ContourVertex], closed: bool) -> String {
        let mut d = joints.first().map_or_else(String::new, |v| format!("M{}", self.point(&v.point)));
        for (i, v) in joints.iter().enumerate().take(joints.len() - usize::from(!closed && !joints.is_empty())) {
            let next = &joints[(i + 1) % joints.len()].point;
            let end = self.point(next);
            if v.bulge == 0.0 {
                if i + 1 < joints.len() {
                    _ = write!(d, "L{end}");
                }
                continue;
            }
            // Radius from the chord and the bulge b = tan(sweep / 4).
            let b = v.bulge.abs();
            let radius = 0.25 * (next - v.point).norm() * (b + 1.0 / b);
            let radius = self.number(radius);
            // Sweep 1 runs clockwise in drawings with y up.
            _ = write!(d, "A{radius} {radius} 0 {} {} {end}", u8::from(b > 1.0), u8::from(v.bulge < 0.0));
        }
        if closed {
            d.push('Z');
        }
        d
    }
}

/// A name for `id`: letters, digits, `-`, `_` and `.` kept, the rest replaced; the number keeps it unique if needed.
fn identifier(index: usize, name: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    if !name.is_empty() && name.chars().all(plain) {
        return name.into();
    }
    let kept: String = name.chars().map(|c| if plain(c) { c } else { '_' }).collect();
    format!("{kept}.{index}")
}

/// Text of an XML document.
fn escaped(s: &str) -> String {
    s.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vertex(x: f64, y: f64, bulge: f64) -> ContourVertex {
        ContourVertex { point: Vec2::new(x, y), bulge, corner: true }
    }

    /// A square of 100 mm whose right side is a half circle outwards.
    fn drawing() -> Drawing {
        let vertices = vec![vertex(0., 0., 0.), vertex(100., 0., 1.), vertex(100., 100., 0.), vertex(0., 100., 0.)];
        let piece = DrawnPattern {
            name: "A & <B>".into(),
            outer: Some(Contour { vertices }),
            rulings: vec![[Vec2::new(10., 0.), Vec2::new(10., 100.)]],
            ..DrawnPattern::default()
        };
        Drawing { pieces: vec![piece], max: Vec2::new(150., 100.), ..Drawing::default() }
    }

    fn written(drawing: &Drawing) -> io::Result<String> {
        let mut out = Vec::new();
        write(drawing, &mut out)?;
        Ok(String::from_utf8(out).expect("text"))
    }

    #[test]
    fn lengths_are_millimetres_and_y_points_down() {
        let text = written(&drawing()).expect("written");
        assert!(text.contains("width=\"170mm\" height=\"120mm\" viewBox=\"0 0 170 120\""));
        // The counter-clockwise half circle of radius 50 from (100, 0) to (100, 100) keeps bulging to the right.
        assert!(text.contains("d=\"M10 110L110 110A50 50 0 0 0 110 10L10 10Z\""), "{text}");
        assert!(text.contains("<path d=\"M20 110L20 10\"/>"));
        assert!(text.contains("id=\"panel-A____B_.0\"") && text.contains("<title>A &amp; &lt;B&gt;</title>"));
    }

    #[test]
    fn a_part_that_must_not_be_cut_has_no_cuts() {
        let mut d = drawing();
        d.pieces[0].marked = true;
        let text = written(&d).expect("written");
        assert!(!text.contains("cut-outer") && !text.contains("#ff0000") && !text.contains("rulings"), "{text}");
        assert!(
            text.contains("class=\"not-certified\"") && text.contains("<title>A &amp; &lt;B&gt; NOT CERTIFIED</title>")
        );
        assert_eq!(text.matches("<path ").count(), 2);
    }

    #[test]
    fn numbers_that_are_not_finite_are_refused() {
        let mut d = drawing();
        d.pieces[0].rulings[0][0].x = f64::NAN;
        assert_eq!(written(&d).expect_err("refused").kind(), io::ErrorKind::InvalidData);
    }
}
