//! DXF writer: cutting drawings in the R2000 format (AC1015), in millimetres or inches, 1:1.
//!
//! Outlines are closed LWPOLYLINEs of lines and arcs on `CUT_OUTER` and `CUT_INNER`, rulings LINEs on `BEND_UP`,
//! `BEND_DOWN` and, where the sheet stays flat, `RULING`, lines where bends begin and end on `BEND_EXTENT`, outlines of formed
//! features on `FORMED`, holes that are circles as CIRCLEs, matching marks LINEs on `MARK`, sections with planes LINEs, CIRCLEs and
//! LWPOLYLINEs of lines and arcs on `MARK_SECTION`, curves of the model that lie on the part on `MARK_CURVE`, names and labels strokes on
//! `TEXT`, a square by which the scale is seen on `SCALE_CHECK`; parts that must not be cut are wholly on `NOT_CERTIFIED`,
//! with these words across them. There is no live text that a cutter's program could lose. Group codes and the order of sections follow Autodesk's DXF reference; tables, blocks and objects that
//! strict readers ask for are all there, with handles and owners.

use std::fmt::{Display, Write as _};
use std::io;

use super::stretches::flush;
use crate::draw::drawing::{Drawing, DrawnPattern, Lettering, LETTER_DECIMALS};
use crate::geom::unit::LengthUnit;
use crate::geom::Vec2;
use crate::patchwork::pattern::{BendSense, Contour, MarkLine};

/// Layers and their colours (AutoCAD colour index).
const LAYERS: [(&str, u8); 13] = [
    (OUTER, 7),
    (INNER, 7),
    (BEND_UP, 5),
    (BEND_DOWN, 30),
    (RULING, 3),
    (EXTENT, 8),
    (FORMED, 4),
    (MARK, 6),
    (SECTION, 2),
    (CURVE, 140),
    (TEXT, 9),
    (SCALE, 8),
    (NOT_CERTIFIED, 1),
];
const OUTER: &str = "CUT_OUTER";
const INNER: &str = "CUT_INNER";
const BEND_UP: &str = "BEND_UP";
const BEND_DOWN: &str = "BEND_DOWN";
const RULING: &str = "RULING";
/// Where bent zones begin and end.
const EXTENT: &str = "BEND_EXTENT";
/// Features that are formed into the sheet.
const FORMED: &str = "FORMED";
const MARK: &str = "MARK";
/// Lines in which planes cut the part.
const SECTION: &str = "MARK_SECTION";
/// Curves of the model that lie on the part.
const CURVE: &str = "MARK_CURVE";
const TEXT: &str = "TEXT";
/// The test square.
const SCALE: &str = "SCALE_CHECK";
/// Everything of parts that must not be cut: nothing of them is on a layer that a machine follows.
const NOT_CERTIFIED: &str = "NOT_CERTIFIED";

/// Handles of things that others refer to. Entities and layers are numbered from [`FIRST_FREE`].
mod handle {
    pub const BLOCK_RECORDS: u32 = 0x1;
    pub const LAYERS: u32 = 0x2;
    pub const STYLES: u32 = 0x3;
    pub const LINETYPES: u32 = 0x5;
    pub const VIEWS: u32 = 0x6;
    pub const UCS: u32 = 0x7;
    pub const VIEWPORTS: u32 = 0x8;
    pub const APPLICATIONS: u32 = 0x9;
    pub const DIMENSION_STYLES: u32 = 0xA;
    pub const ROOT: u32 = 0xC;
    pub const GROUPS: u32 = 0xD;
    pub const PLOT_STYLES: u32 = 0xE;
    pub const PLOT_STYLE: u32 = 0xF;
    pub const LAYOUTS: u32 = 0x1A;
    pub const PAPER_SPACE: u32 = 0x1B;
    pub const PAPER_LAYOUT: u32 = 0x1E;
    pub const MODEL_SPACE: u32 = 0x1F;
    pub const MODEL_LAYOUT: u32 = 0x22;
    pub const FIRST_FREE: u32 = 0x30;
}

/// The file of a drawing.
///
/// # Errors
/// A coordinate that is not a finite number ([`io::ErrorKind::InvalidData`]).
pub fn write(drawing: &Drawing) -> io::Result<Vec<u8>> {
    let mut out = Vec::new();
    write_to(drawing, &mut out)?;
    Ok(out)
}

/// Writes the file of a drawing, part by part: files of many parts are long.
///
/// # Errors
/// As [`write`](fn@write), and those of `out`.
pub(crate) fn write_to(drawing: &Drawing, out: &mut dyn io::Write) -> io::Result<()> {
    let mut body = Pairs { unit: drawing.unit, ..Pairs::default() };
    tables(&mut body);
    blocks(&mut body);
    // The header comes first but names the first handle that is still free.
    let mut head = Pairs { next: body.next + entities(drawing) as u32, unit: drawing.unit, ..Pairs::default() };
    header(&mut head, drawing);
    flush(&mut head.text, head.finite, out)?;
    body.section("ENTITIES");
    for piece in &drawing.pieces {
        let on = |layer| if piece.marked { NOT_CERTIFIED } else { layer };
        let inner = piece.inner.iter().map(|c| (on(INNER), c));
        for (layer, contour) in piece.outer.iter().map(|c| (on(OUTER), c)).chain(inner) {
            body.contour(layer, contour);
        }
        for contour in &piece.formed {
            body.contour(on(FORMED), contour);
        }
        for [a, b] in &piece.extents {
            body.line(on(EXTENT), a, b);
        }
        for (layer, sense) in [(BEND_UP, BendSense::Up), (BEND_DOWN, BendSense::Down), (RULING, BendSense::Flat)] {
            for [a, b] in piece.bent(sense) {
                let layer = on(layer);
                body.line(layer, a, b);
            }
        }
        for [a, b] in &piece.marks {
            body.line(on(MARK), a, b);
        }
        for line in &piece.sections {
            body.marked(on(SECTION), line);
        }
        for line in &piece.curves {
            body.marked(on(CURVE), line);
        }
        for stroke in piece.strokes() {
            body.stroke(on(TEXT), &stroke);
        }
        flush(&mut body.text, body.finite, out)?;
    }
    if let Some(square) = &drawing.test_square {
        body.polyline(SCALE, true, square.corners.iter().map(|p| (*p, 0.0)));
        for stroke in Lettering::all(&square.texts) {
            body.stroke(SCALE, &stroke);
        }
    }
    body.pair(0, "ENDSEC");
    objects(&mut body);
    body.pair(0, "EOF");
    flush(&mut body.text, body.finite, out)
}

/// Entities of a drawing.
fn entities(drawing: &Drawing) -> usize {
    let of = |p: &DrawnPattern| {
        let contours = usize::from(p.outer.is_some()) + p.inner.len() + p.formed.len();
        let lines = p.extents.len() + p.rulings.len() + p.marks.len() + p.sections.len() + p.curves.len();
        contours + lines + p.strokes().count()
    };
    let square = drawing.test_square.as_ref().map_or(0, |square| 1 + Lettering::all(&square.texts).count());
    drawing.pieces.iter().map(of).sum::<usize>() + square
}

/// Pairs of group code and value, two lines each.
struct Pairs {
    text: String,
    next: u32,
    finite: bool,
    /// Unit of coordinates.
    unit: LengthUnit,
}

impl Default for Pairs {
    fn default() -> Self {
        Self { text: String::new(), next: handle::FIRST_FREE, finite: true, unit: LengthUnit::default() }
    }
}

impl Pairs {
    fn pair(&mut self, code: u32, value: impl Display) {
        // Writing to a string cannot fail.
        _ = write!(self.text, "{code:3}\n{value}\n");
    }

    /// Integers as the reference prints them, right-aligned.
    fn integer(&mut self, code: u32, value: usize) {
        self.pair(code, format_args!("{value:6}"));
    }

    fn hex(&mut self, code: u32, handle: u32) {
        self.pair(code, format_args!("{handle:X}"));
    }

    /// A real number to a millionth of a micrometre.
    fn real(&mut self, code: u32, x: f64) {
        self.rounded(code, x, 9);
    }

    /// A real number to as many decimals at most, without idle zeros.
    fn rounded(&mut self, code: u32, x: f64, decimals: usize) {
        self.finite &= x.is_finite();
        // Writing to a string cannot fail.
        _ = writeln!(self.text, "{code:3}");
        let start = self.text.len();
        _ = write!(self.text, "{x:.decimals$}");
        let keep = self.text.trim_end_matches('0').len();
        self.text.truncate(keep);
        if self.text.ends_with('.') {
            self.text.push('0');
        }
        if &self.text[start..] == "-0.0" {
            self.text.remove(start);
        }
        self.text.push('\n');
    }

    /// Bulges need more digits: an arc's height is the bulge times half its chord, which may be metres.
    fn bulge(&mut self, b: f64) {
        self.finite &= b.is_finite();
        self.pair(42, format_args!("{b:.12}"));
    }

    fn point(&mut self, code: u32, x: f64, y: f64) {
        self.real(code, x);
        self.real(code + 10, y);
    }

    fn point3(&mut self, code: u32, x: f64, y: f64, z: f64) {
        self.point(code, x, y);
        self.real(code + 20, z);
    }

    fn section(&mut self, name: &str) {
        self.pair(0, "SECTION");
        self.pair(2, name);
    }

    fn fresh(&mut self) -> u32 {
        self.next += 1;
        self.next - 1
    }

    /// Head of a symbol table.
    fn table(&mut self, name: &str, handle: u32, count: usize) {
        self.pair(0, "TABLE");
        self.pair(2, name);
        self.hex(5, handle);
        self.hex(330, 0);
        self.pair(100, "AcDbSymbolTable");
        self.integer(70, count);
    }

    /// Head of a symbol table's record.
    fn record(&mut self, kind: &str, owner: u32, handle: u32, subclass: &str, name: &str) {
        self.pair(0, kind);
        self.hex(if kind == "DIMSTYLE" { 105 } else { 5 }, handle);
        self.hex(330, owner);
        self.pair(100, "AcDbSymbolTableRecord");
        self.pair(100, subclass);
        self.pair(2, name);
    }

    /// Head of an entity of the model space.
    fn entity(&mut self, kind: &str, layer: &str, subclass: &str) {
        let handle = self.fresh();
        self.pair(0, kind);
        self.hex(5, handle);
        self.hex(330, handle::MODEL_SPACE);
        self.pair(100, "AcDbEntity");
        self.pair(8, layer);
        self.pair(100, subclass);
    }

    fn line(&mut self, layer: &str, a: &Vec2, b: &Vec2) {
        self.entity("LINE", layer, "AcDbLine");
        for (code, p) in [(10, a), (11, b)] {
            let p = p / self.unit.mm();
            self.point3(code, p.x, p.y, 0.0);
        }
    }

    /// Holes that are circles as such: machines drill or punch these.
    fn contour(&mut self, layer: &str, c: &Contour) {
        if let Some((centre, radius)) = c.circle().filter(|_| layer != OUTER) {
            self.entity("CIRCLE", layer, "AcDbCircle");
            let centre = centre / self.unit.mm();
            self.point3(10, centre.x, centre.y, 0.0);
            self.real(40, self.unit.of(radius));
            return;
        }
        self.polyline(layer, true, c.vertices.iter().map(|v| (v.point, v.bulge)));
    }

    /// Lines that are straight or circles as such.
    fn marked(&mut self, layer: &str, line: &MarkLine) {
        match &line.joints[..] {
            _ if line.closed => self.contour(layer, &line.contour()),
            [a, b] if a.bulge == 0.0 => self.line(layer, &a.point, &b.point),
            joints => self.polyline(layer, false, joints.iter().map(|j| (j.point, j.bulge))),
        }
    }

    /// Head of a polyline of so many vertices.
    fn head(&mut self, layer: &str, closed: bool, count: usize) {
        self.entity("LWPOLYLINE", layer, "AcDbPolyline");
        self.integer(90, count);
        self.integer(70, usize::from(closed));
        self.real(43, 0.0);
    }

    fn polyline(&mut self, layer: &str, closed: bool, vertices: impl ExactSizeIterator<Item = (Vec2, f64)>) {
        self.head(layer, closed, vertices.len());
        for (p, bulge) in vertices {
            let p = p / self.unit.mm();
            self.point(10, p.x, p.y);
            if bulge != 0.0 {
                self.bulge(bulge);
            }
        }
    }

    /// Part of a letter.
    fn stroke(&mut self, layer: &str, points: &[Vec2]) {
        self.head(layer, false, points.len());
        let decimals = self.unit.decimals(LETTER_DECIMALS);
        for p in points {
            self.rounded(10, self.unit.of(p.x), decimals);
            self.rounded(20, self.unit.of(p.y), decimals);
        }
    }

    fn object(&mut self, kind: &str, handle: u32, owner: u32) {
        self.pair(0, kind);
        self.hex(5, handle);
        self.hex(330, owner);
    }

    fn dictionary(&mut self, handle: u32, owner: u32, entries: &[(&str, u32)]) {
        self.object("DICTIONARY", handle, owner);
        self.pair(100, "AcDbDictionary");
        self.integer(281, 1);
        for &(name, entry) in entries {
            self.pair(3, name);
            self.hex(350, entry);
        }
    }
}

/// Version, units, extent, and the next handle.
fn header(p: &mut Pairs, drawing: &Drawing) {
    let free = format!("{:X}", p.next);
    p.section("HEADER");
    let mut text = |name: &str, code: u32, value: &str| {
        p.pair(9, name);
        p.pair(code, value);
    };
    text("$ACADVER", 1, "AC1015");
    text("$DWGCODEPAGE", 3, "ANSI_1252");
    text("$HANDSEED", 5, &free);
    // Millimetres; metric linetypes and hatches; decimal lengths with four places.
    let (unit, metric) = match drawing.unit {
        LengthUnit::Millimetre => ("     4", "     1"),
        LengthUnit::Inch => ("     1", "     0"),
    };
    text("$INSUNITS", 70, unit);
    text("$MEASUREMENT", 70, metric);
    text("$LUNITS", 70, "     2");
    text("$LUPREC", 70, "     4");
    text("$CLAYER", 8, "0");
    let (min, max) = (drawing.min / drawing.unit.mm(), drawing.max / drawing.unit.mm());
    for (name, corner) in [("$EXTMIN", min), ("$EXTMAX", max)] {
        p.pair(9, name);
        p.point3(10, corner.x, corner.y, 0.0);
    }
    for (name, corner) in [("$LIMMIN", min), ("$LIMMAX", max)] {
        p.pair(9, name);
        p.point(10, corner.x, corner.y);
    }
    p.pair(0, "ENDSEC");
    p.section("CLASSES");
    p.pair(0, "ENDSEC");
}

/// Symbol tables.
fn tables(p: &mut Pairs) {
    p.section("TABLES");
    p.table("VPORT", handle::VIEWPORTS, 0);
    p.pair(0, "ENDTAB");

    p.table("LTYPE", handle::LINETYPES, 3);
    for (name, description) in [("ByBlock", ""), ("ByLayer", ""), ("Continuous", "Solid line")] {
        let h = p.fresh();
        p.record("LTYPE", handle::LINETYPES, h, "AcDbLinetypeTableRecord", name);
        p.integer(70, 0);
        p.pair(3, description);
        p.integer(72, 65);
        p.integer(73, 0);
        p.real(40, 0.0);
    }
    p.pair(0, "ENDTAB");

    p.table("LAYER", handle::LAYERS, LAYERS.len() + 1);
    for (name, colour) in std::iter::once(("0", 7)).chain(LAYERS) {
        let h = p.fresh();
        p.record("LAYER", handle::LAYERS, h, "AcDbLayerTableRecord", name);
        p.integer(70, 0);
        p.integer(62, colour.into());
        p.pair(6, "Continuous");
        // Thinnest line: laser drivers take it for a cut.
        p.integer(370, 0);
        p.hex(390, handle::PLOT_STYLE);
    }
    p.pair(0, "ENDTAB");

    p.table("STYLE", handle::STYLES, 1);
    let h = p.fresh();
    p.record("STYLE", handle::STYLES, h, "AcDbTextStyleTableRecord", "Standard");
    p.integer(70, 0);
    p.real(40, 0.0);
    p.real(41, 1.0);
    p.real(50, 0.0);
    p.integer(71, 0);
    p.real(42, 2.5);
    p.pair(3, "txt");
    p.pair(4, "");
    p.pair(0, "ENDTAB");

    for (name, table) in [("VIEW", handle::VIEWS), ("UCS", handle::UCS)] {
        p.table(name, table, 0);
        p.pair(0, "ENDTAB");
    }

    p.table("APPID", handle::APPLICATIONS, 1);
    let h = p.fresh();
    p.record("APPID", handle::APPLICATIONS, h, "AcDbRegAppTableRecord", "ACAD");
    p.integer(70, 0);
    p.pair(0, "ENDTAB");

    p.table("DIMSTYLE", handle::DIMENSION_STYLES, 1);
    p.pair(100, "AcDbDimStyleTable");
    p.integer(71, 0);
    let h = p.fresh();
    p.record("DIMSTYLE", handle::DIMENSION_STYLES, h, "AcDbDimStyleTableRecord", "Standard");
    p.integer(70, 0);
    p.pair(0, "ENDTAB");

    p.table("BLOCK_RECORD", handle::BLOCK_RECORDS, 2);
    for (name, h, layout) in SPACES {
        p.record("BLOCK_RECORD", handle::BLOCK_RECORDS, h, "AcDbBlockTableRecord", name);
        p.hex(340, layout);
    }
    p.pair(0, "ENDTAB");
    p.pair(0, "ENDSEC");
}

/// Model and paper space: name, block record, layout.
const SPACES: [(&str, u32, u32); 2] = [
    ("*Model_Space", handle::MODEL_SPACE, handle::MODEL_LAYOUT),
    ("*Paper_Space", handle::PAPER_SPACE, handle::PAPER_LAYOUT),
];

/// The two blocks that every drawing has; the entities of the model space stand in ENTITIES.
fn blocks(p: &mut Pairs) {
    p.section("BLOCKS");
    for (name, owner, _) in SPACES {
        for (kind, subclass) in [("BLOCK", "AcDbBlockBegin"), ("ENDBLK", "AcDbBlockEnd")] {
            let h = p.fresh();
            p.object(kind, h, owner);
            p.pair(100, "AcDbEntity");
            if owner == handle::PAPER_SPACE {
                p.integer(67, 1);
            }
            p.pair(8, "0");
            p.pair(100, subclass);
            if kind == "BLOCK" {
                p.pair(2, name);
                p.integer(70, 0);
                p.point3(10, 0.0, 0.0, 0.0);
                p.pair(3, name);
                p.pair(1, "");
            }
        }
    }
    p.pair(0, "ENDSEC");
}

/// The root dictionary and what hangs below it.
fn objects(p: &mut Pairs) {
    p.section("OBJECTS");
    p.dictionary(
        handle::ROOT,
        0,
        &[
            ("ACAD_GROUP", handle::GROUPS),
            ("ACAD_LAYOUT", handle::LAYOUTS),
            ("ACAD_PLOTSTYLENAME", handle::PLOT_STYLES),
        ],
    );
    p.dictionary(handle::GROUPS, handle::ROOT, &[]);
    p.dictionary(handle::LAYOUTS, handle::ROOT, &[("Layout1", handle::PAPER_LAYOUT), ("Model", handle::MODEL_LAYOUT)]);
    p.object("ACDBDICTIONARYWDFLT", handle::PLOT_STYLES, handle::ROOT);
    p.pair(100, "AcDbDictionary");
    p.integer(281, 1);
    p.pair(3, "Normal");
    p.hex(350, handle::PLOT_STYLE);
    p.pair(100, "AcDbDictionaryWithDefault");
    p.hex(340, handle::PLOT_STYLE);
    p.object("ACDBPLACEHOLDER", handle::PLOT_STYLE, handle::PLOT_STYLES);
    for (name, tab, model, layout, space) in [
        ("Model", 0, true, handle::MODEL_LAYOUT, handle::MODEL_SPACE),
        ("Layout1", 1, false, handle::PAPER_LAYOUT, handle::PAPER_SPACE),
    ] {
        p.object("LAYOUT", layout, handle::LAYOUTS);
        plot_settings(p, model);
        p.pair(100, "AcDbLayout");
        p.pair(1, name);
        p.integer(70, 1);
        p.integer(71, tab);
        p.point(10, 0.0, 0.0);
        p.point(11, 420.0, 297.0);
        p.point3(12, 0.0, 0.0, 0.0);
        p.point3(14, 1e20, 1e20, 1e20);
        p.point3(15, -1e20, -1e20, -1e20);
        p.real(146, 0.0);
        p.point3(13, 0.0, 0.0, 0.0);
        p.point3(16, 1.0, 0.0, 0.0);
        p.point3(17, 0.0, 1.0, 0.0);
        p.integer(76, 0);
        p.hex(330, space);
    }
    p.pair(0, "ENDSEC");
}

/// Page set-up of a layout: A3, millimetres, 1:1.
fn plot_settings(p: &mut Pairs, model: bool) {
    p.pair(100, "AcDbPlotSettings");
    p.pair(1, "");
    p.pair(2, "");
    p.pair(4, "A3");
    p.pair(6, "");
    for margin in 40..=43 {
        p.real(margin, 7.5);
    }
    p.real(44, 420.0);
    p.real(45, 297.0);
    for offset in [46, 47, 48, 49, 140, 141] {
        p.real(offset, 0.0);
    }
    p.real(142, 1.0);
    p.real(143, 1.0);
    // Bit 1024: the layout is the model tab.
    p.integer(70, if model { 1024 } else { 0 });
    p.integer(72, 1);
    p.integer(73, 0);
    p.integer(74, 5);
    p.pair(7, "");
    p.integer(75, 16);
    p.real(147, 1.0);
    p.real(148, 0.0);
    p.real(149, 0.0);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::drawing::DrawnPattern;
    use crate::patchwork::pattern::ContourVertex;
    use std::collections::BTreeSet;

    fn vertex(x: f64, y: f64, bulge: f64) -> ContourVertex {
        ContourVertex { point: Vec2::new(x, y), bulge, corner: true }
    }

    fn drawing() -> Drawing {
        let disc = |x: f64, r: f64| Contour { vertices: vec![vertex(x - r, 0., 1.), vertex(x + r, 0., 1.)] };
        let piece = DrawnPattern {
            name: "A".into(),
            outer: Some(disc(0., 100.)),
            inner: vec![disc(30., 1.0 / 3.0)],
            rulings: vec![[Vec2::new(-5., 5.), Vec2::new(-5., -5.)]],
            senses: vec![BendSense::Down],
            marks: vec![[Vec2::new(-100., 0.), Vec2::new(-95., 0.)]],
            texts: vec![Lettering::Line([Vec2::zeros(), Vec2::x()])],
            ..DrawnPattern::default()
        };
        Drawing { pieces: vec![piece], min: Vec2::repeat(-100.), max: Vec2::repeat(100.), ..Drawing::default() }
    }

    /// Group codes and values of the file.
    fn pairs(d: &Drawing) -> Vec<(u32, String)> {
        let text = String::from_utf8(write(d).expect("written")).expect("text");
        let lines: Vec<&str> = text.lines().map(str::trim).collect();
        lines.chunks(2).map(|c| (c[0].parse().expect("a group code"), c[1].into())).collect()
    }

    #[test]
    fn handles_are_unique_and_owners_exist() {
        let all = pairs(&drawing());
        let mut known = BTreeSet::from(["0".to_string()]);
        // Handles are given under 5, and under 105 by dimension styles; $HANDSEED comes first.
        for (_, handle) in all.iter().filter(|p| p.0 == 5 || p.0 == 105).skip(1) {
            assert!(known.insert(handle.clone()), "handle {handle} is given twice");
        }
        for (code, handle) in all.iter().filter(|p| matches!(p.0, 330 | 340 | 350 | 390)) {
            assert!(known.contains(handle), "{code} points to {handle}");
        }
        let seed = all.iter().position(|p| p.1 == "$HANDSEED").map(|i| &all[i + 1].1).expect("a seed");
        let value = |h: &String| u32::from_str_radix(h, 16).expect("a handle");
        assert!(known.iter().all(|h| value(h) < value(seed)));
    }

    #[test]
    fn outlines_are_closed_polylines_with_bulges_in_millimetres() {
        let all = pairs(&drawing());
        let after = |name: &str| all.iter().position(|p| p.1 == name).map(|i| all[i + 1].clone());
        assert_eq!(after("$INSUNITS"), Some((70, "4".into())));
        assert_eq!(after("$MEASUREMENT"), Some((70, "1".into())));
        assert_eq!(after("$EXTMIN"), Some((10, "-100.0".into())));
        let entities = all.iter().position(|p| p.1 == "ENTITIES").expect("entities");
        let starts: Vec<usize> = (entities..all.len()).filter(|&i| all[i].0 == 0).collect();
        let entity = |i: usize| &all[starts[i]..starts[i + 1]];
        let value =
            |e: &[(u32, String)], code| e.iter().filter(|p| p.0 == code).map(|p| p.1.clone()).collect::<Vec<_>>();
        for (i, layer, closed) in [(0, "CUT_OUTER", "1"), (4, "TEXT", "0")] {
            assert_eq!(entity(i)[0].1, "LWPOLYLINE");
            assert_eq!(value(entity(i), 8), [layer]);
            assert_eq!(value(entity(i), 70), [closed]);
        }
        assert_eq!(value(entity(0), 42), ["1.000000000000"; 2]);
        // A round hole is one entity.
        assert_eq!((entity(1)[0].1.as_str(), value(entity(1), 8)), ("CIRCLE", vec!["CUT_INNER".into()]));
        assert_eq!((value(entity(1), 10), value(entity(1), 40)), (vec!["30.0".into()], vec!["0.333333333".into()]));
        assert_eq!((value(entity(2), 8), value(entity(3), 8)), (vec!["BEND_DOWN".into()], vec!["MARK".into()]));
    }

    #[test]
    fn nothing_of_a_part_that_must_not_be_cut_is_on_a_layer_of_others() {
        let mut d = drawing();
        d.pieces.push(DrawnPattern { marked: true, ..d.pieces[0].clone() });
        let all = pairs(&d);
        let start = all.iter().position(|p| p.1 == "ENTITIES").expect("entities");
        let layers: Vec<&str> = all[start..].iter().filter(|p| p.0 == 8).map(|p| p.1.as_str()).collect();
        assert_eq!(layers[..5], ["CUT_OUTER", "CUT_INNER", "BEND_DOWN", "MARK", "TEXT"]);
        assert_eq!(layers[5..], ["NOT_CERTIFIED"; 5]);
        assert!(all[..start].iter().any(|p| p.0 == 2 && p.1 == "NOT_CERTIFIED"), "a layer of its own");
    }

    #[test]
    fn numbers_that_are_not_finite_are_refused() {
        let mut d = drawing();
        d.pieces[0].marks[0][0].x = f64::INFINITY;
        assert_eq!(write(&d).expect_err("refused").kind(), io::ErrorKind::InvalidData);
    }
}
