//! Things of a DXF drawing one by one, with how they are drawn: curves as in [`super::dxf`], POINT, TEXT, MTEXT line by line; insertions
//! are taken apart, and attributes are texts.

use super::blocks::{blocks, copies, placed, Block};
use super::dxf::{self, curves, unescaped, Entity, Fault};
use super::mtext;
use super::{is_dxf, not_read, CurveError, CurveOptions, BLANK};
use crate::answer::note::reader::ReaderNote;
use crate::develop::refold::artwork::{Item, Shape, Style, Words};
use crate::geom::placement::Placement;
use crate::geom::Vec3;
use crate::io::words::note::reader_note;
use crate::spline::curve::Curve;
use std::collections::HashMap;

/// A drawing as things that can be carried over.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sketch {
    /// What is drawn, in the order of the file.
    pub items: Vec<Item>,
    /// Layers of the file with the numbers of their colours.
    pub layers: Vec<(String, i32)>,
}

/// Colours of no own: of the block, of the layer.
const NOT_OWN: [i32; 2] = [OF_BLOCK, 256];
/// See [`NOT_OWN`].
const OF_BLOCK: i32 = 0;
/// Greatest coordinate, mm, as of curves elsewhere: squares and cubes of larger ones leave the numbers.
const FARTHEST: f64 = 1e12;

/// Reads a drawing, with notes on what else it holds.
///
/// # Errors
/// See [`CurveError`].
pub(in crate::io) fn sketch(bytes: &[u8], options: &CurveOptions) -> Result<(Sketch, Vec<ReaderNote>), CurveError> {
    let damaged = |reason: String| damaged(&options.name, reason);
    // Files before 2007 have one byte for a letter.
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|b| char::from(*b)).collect(),
    };
    if !is_dxf(text.trim_start_matches(BLANK)) {
        return Err(damaged("it is no ASCII DXF drawing".into()));
    }
    let groups = dxf::groups(&text, options)?;
    let blocks = blocks(&groups);
    let mut reader = Reader {
        file: &options.name,
        unit: dxf::drawn_unit(&groups, options)?,
        blocks: &blocks,
        out: Sketch::default(),
        unread: Vec::new(),
        without_length: 0,
        apart: 0,
        copied: 0,
    };
    for e in dxf::entities(&groups, "ENTITIES").ok_or_else(|| damaged(dxf::CUT_OFF.into()))? {
        reader.entity(&e, None)?;
    }
    let notes = reader.notes();
    let mut out = reader.out;
    if out.items.is_empty() {
        return Err(CurveError::Nothing { name: options.name.clone(), unread: notes.first().map(reader_note) });
    }
    for layer in dxf::entities(&groups, "TABLES").unwrap_or_default().iter().filter(|e| e.kind == "LAYER") {
        // Of layers that are switched off the number is negative.
        let colour = layer.number(62).ok().flatten().map_or(WHITE, |c| (c as i32).abs());
        out.layers.push((unescaped(layer.text(2)), colour));
    }
    Ok((out, notes))
}

/// Number of the colour of layers that have none.
const WHITE: i32 = 7;

/// Copies of blocks with what they hold, at most: blocks in blocks multiply.
const MOST_COPIED: usize = 1_000_000;
/// Blocks in each other at most; drawings have a few.
const MOST_NESTED: usize = 64;

/// A drawing that is being read.
struct Reader<'a> {
    file: &'a str,
    /// Length of a unit of the drawing, mm.
    unit: f64,
    blocks: &'a HashMap<String, Block<'a>>,
    out: Sketch,
    /// Kinds of entities that were not read, with their numbers.
    unread: Vec<(String, usize)>,
    without_length: usize,
    /// Insertions that were taken apart.
    apart: usize,
    /// Copies of blocks that they made, with what these hold.
    copied: usize,
}

/// An insertion in whose block an entity is.
struct Within<'a> {
    place: Placement,
    style: Style,
    /// What it is called, for messages.
    name: &'a str,
    /// Names of the blocks that are being taken apart.
    open: &'a [String],
}

impl Reader<'_> {
    /// Takes an entity, insertions with all that their blocks hold.
    fn entity(&mut self, e: &Entity, within: Option<&Within>) -> Result<(), CurveError> {
        let mut name = format!("{} {}", e.kind, e.text(5)).trim_end().to_owned();
        if let Some(w) = within {
            name = format!("{name} in {}", w.name);
        }
        let file = self.file;
        let fault = |x: Fault| damaged(file, format!("{name}: {x}"));
        let style = style(e, within).map_err(fault)?;
        if e.kind == "INSERT" && self.insert(e, &style, within, &name)? {
            return Ok(());
        }
        let Some(shapes) = shapes(e, self.unit, within.is_some()).map_err(fault)? else {
            match self.unread.iter_mut().find(|u| u.0 == e.kind) {
                Some(u) => u.1 += 1,
                None => self.unread.push((e.kind.to_owned(), 1)),
            }
            return Ok(());
        };
        let count = shapes.len();
        for (k, shape) in shapes.into_iter().enumerate() {
            let shape = within.map_or(Some(shape.clone()), |w| placed(shape, &w.place));
            let Some(shape) = shape.filter(|s| !matches!(s, Shape::Curves(all) if !has_length(all))) else {
                self.without_length += 1;
                continue;
            };
            if far(&shape) {
                let what = format!("{name} lies more than {FARTHEST:e} mm from the origin; check the unit");
                return Err(damaged(file, what));
            }
            let name = if count > 1 { format!("{name} line {}", k + 1) } else { name.clone() };
            self.out.items.push(Item { name, style: style.clone(), shape });
        }
        Ok(())
    }

    /// Takes an insertion apart; `false` where the file does not have its block, or this holds itself.
    fn insert(&mut self, e: &Entity, style: &Style, within: Option<&Within>, name: &str) -> Result<bool, CurveError> {
        let key = e.text(2).to_lowercase();
        let open = within.map_or(&[][..], |w| w.open);
        let Some(block) = self.blocks.get(&key).filter(|_| !open.contains(&key)) else { return Ok(false) };
        if open.len() == MOST_NESTED {
            return Err(damaged(
                self.file,
                format!("INSERT {}: more than {MOST_NESTED} blocks lie in each other", e.text(5)),
            ));
        }
        let all = copies(e, &block.base, self.unit).map_err(|x| damaged(self.file, format!("{name}: {x}")))?;
        self.copied = self.copied.saturating_add(all.len().saturating_mul(block.entities.len() + 1));
        if self.copied > MOST_COPIED {
            let what = format!("INSERT {}: blocks in blocks make more than {MOST_COPIED} copies of things", e.text(5));
            return Err(damaged(self.file, what));
        }
        let open: Vec<String> = open.iter().cloned().chain([key]).collect();
        for own in all {
            let place = within.map_or(own, |w| w.place.after(&own));
            let inner = Within { place, style: style.clone(), name, open: &open };
            for part in &block.entities {
                self.entity(part, Some(&inner))?;
            }
        }
        // Attributes lie where the insertion does, not in its block.
        for attribute in &e.parts {
            self.entity(attribute, within)?;
        }
        self.apart += 1;
        Ok(true)
    }

    /// What is to be told of what was read.
    fn notes(&self) -> Vec<ReaderNote> {
        let mut out: Vec<ReaderNote> = not_read(self.file, &self.unread).into_iter().collect();
        let file = || self.file.to_owned();
        if self.without_length > 0 {
            out.push(ReaderNote::NoLength { file: file(), curves: self.without_length });
        }
        if self.apart > 0 {
            out.push(ReaderNote::TakenApart { file: file(), insertions: self.apart });
        }
        out
    }
}

/// What is wrong with a file.
fn damaged(file: &str, reason: String) -> CurveError {
    CurveError::Damaged { name: file.to_owned(), reason }
}

/// How an entity is drawn. What a block has on layer 0 is on the layer of its insertion, and has its colour if it asks for that.
fn style(e: &Entity, within: Option<&Within>) -> Result<Style, Fault> {
    let number = e.number(62)?.map(|c| c as i32);
    let own = number.filter(|c| !NOT_OWN.contains(c));
    let layer = unescaped(e.text(8));
    Ok(match within {
        Some(w) => Style {
            layer: if layer == "0" { w.style.layer.clone() } else { layer },
            colour: if number == Some(OF_BLOCK) { w.style.colour } else { own },
        },
        None => Style { layer, colour: own },
    })
}

/// What is drawn for an entity; `None` for kinds that are not read. Attributes that are not seen, and the patterns of attributes in
/// blocks, are nothing.
fn shapes(e: &Entity, unit: f64, in_block: bool) -> Result<Option<Vec<Shape>>, Fault> {
    const UNSEEN: i64 = 1;
    const CONSTANT: i64 = 2;
    let words = || words(e, unit).map(|w| Some(vec![Shape::Words(w)]));
    match e.kind {
        "POINT" => Ok(Some(vec![Shape::Point(e.point(10)? * unit)])),
        "TEXT" => words(),
        "ATTRIB" if e.flags(70)? & UNSEEN != 0 => Ok(Some(Vec::new())),
        "ATTRIB" => words(),
        "ATTDEF" if in_block && e.flags(70)? & (UNSEEN | CONSTANT) == CONSTANT => words(),
        "ATTDEF" if in_block => Ok(Some(Vec::new())),
        "MTEXT" => Ok(Some(mtext::lines(e, unit)?.into_iter().map(Shape::Words).collect())),
        _ => Ok(curves(e, unit)?.map(|all| vec![Shape::Curves(all)])),
    }
}

/// A line of text; where it is held at another place than its beginning, that is its second point.
fn words(e: &Entity, unit: f64) -> Result<Words, Fault> {
    let frame = e.frame()?;
    // Of attributes the height has another number.
    let upwards = if e.kind == "TEXT" { 73 } else { 74 };
    let held = [72, upwards].map(|code| e.number(code).map(|x| x.unwrap_or(0.0) as i32));
    let [across, up] = held;
    let held = [across?, up?];
    let at = if held == [0; 2] { e.point(10)? } else { e.point(11)? };
    let (s, c) = e.number(50)?.unwrap_or(0.0).to_radians().sin_cos();
    Ok(Words {
        text: unescaped(e.text(1)),
        at: frame.vector_to_world(&at) * unit,
        way: frame.vector_to_world(&Vec3::new(c, s, 0.0)),
        normal: frame.z,
        height: e.positive(40)? * unit,
        stretch: e.number(41)?.filter(|x| *x > 0.0).unwrap_or(1.0),
        slant: e.number(51)?.unwrap_or(0.0),
        held,
    })
}

fn places(curves: &[Curve<4>]) -> impl Iterator<Item = Vec3> + '_ {
    curves.iter().flat_map(|c| &c.control).map(|h| Vec3::new(h[0], h[1], h[2]) / h[3])
}

fn has_length(curves: &[Curve<4>]) -> bool {
    let Some(first) = places(curves).next() else { return false };
    places(curves).any(|p| p != first)
}

/// Whether something lies where numbers fail.
fn far(shape: &Shape) -> bool {
    let near = |p: &Vec3| p.amax() <= FARTHEST;
    match shape {
        Shape::Curves(all) => !places(all).all(|p| near(&p)),
        Shape::Point(p) => !near(p),
        Shape::Words(w) => !near(&w.at),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A drawing in mm with these sections.
    fn drawing(blocks: &str, entities: &str) -> String {
        let section = |name: &str, text: &str| format!("0\nSECTION\n2\n{name}\n{text}0\nENDSEC\n");
        let header = section("HEADER", "9\n$INSUNITS\n70\n4\n");
        format!("{header}{}{}0\nEOF\n", section("BLOCKS", blocks), section("ENTITIES", entities))
    }

    fn read(blocks: &str, entities: &str) -> Result<(Vec<Item>, Vec<ReaderNote>), CurveError> {
        let text = drawing(blocks, entities);
        sketch(text.as_bytes(), &CurveOptions::new("a.dxf")).map(|(s, notes)| (s.items, notes))
    }

    fn near(p: &Vec3, [x, y]: [f64; 2]) {
        assert!((p - Vec3::new(x, y, 0.0)).norm() < 1e-12, "{p:?} {x} {y}");
    }

    /// A mark of a line of layer 0 and a circle, in a block that turns it a quarter and makes it twice as wide, inserted mirrored.
    #[test]
    fn insertions_are_taken_apart_where_they_put_their_blocks() {
        let mark = "0\nBLOCK\n2\nMark\n10\n1\n20\n0\n0\nLINE\n5\nA1\n8\n0\n62\n0\n10\n1\n20\n0\n11\n3\n21\n0\n\
                    0\nCIRCLE\n5\nA2\n8\nholes\n10\n1\n20\n0\n40\n1\n0\nATTDEF\n1\n?\n10\n0\n20\n0\n40\n1\n70\n0\n0\nENDBLK\n";
        let pair = "0\nBLOCK\n2\nPair\n10\n0\n20\n0\n0\nINSERT\n5\nB1\n8\n0\n62\n0\n2\nMARK\n10\n5\n20\n0\n41\n2\n42\n1\n50\n90\n\
                    0\nTEXT\n5\nB2\n8\n0\n1\nup\n10\n0\n20\n1\n40\n3\n0\nENDBLK\n";
        let all = "0\nINSERT\n5\nC1\n8\nframes\n62\n3\n2\npair\n66\n1\n10\n100\n20\n50\n41\n-1\n\
                   0\nATTRIB\n5\nC2\n8\n0\n1\nFR 7\n10\n7\n20\n8\n40\n2\n11\n9\n21\n8\n72\n1\n74\n2\n0\nSEQEND\n\
                   0\nINSERT\n5\nC3\n8\n0\n2\nnone\n10\n0\n20\n0\n";
        let (items, notes) = read(&format!("{mark}{pair}"), all).expect("a drawing");
        let [line, circle, text, attribute] = &items[..] else { panic!("{items:?}") };
        assert_eq!(line.name, "LINE A1 in INSERT B1 in INSERT C1");
        assert_eq!((line.style.layer.as_str(), line.style.colour), ("frames", Some(3)));
        assert_eq!((circle.style.layer.as_str(), circle.style.colour), ("holes", None));
        let Shape::Curves(c) = &line.shape else { panic!("a line") };
        let ends: Vec<Vec3> = places(c).collect();
        // Upwards from (5, 0), twice as long, and mirrored about x = 100.
        near(&ends[0], [95.0, 50.0]);
        near(&ends[1], [95.0, 54.0]);
        let Shape::Curves(c) = &circle.shape else { panic!("a circle") };
        let jet = c[0].jet(0.25 * (c[0].domain().0 + 3.0 * c[0].domain().1))[0];
        let p = Vec3::new(jet[0], jet[1], jet[2]) / jet[3] - Vec3::new(95.0, 50.0, 0.0);
        assert!((p.x * p.x + p.y * p.y / 4.0 - 1.0).abs() < 1e-12, "{p:?}");
        let Shape::Words(w) = &text.shape else { panic!("a text") };
        near(&w.at, [100.0, 51.0]);
        assert_eq!((w.way, w.normal, w.height, w.stretch), (-Vec3::x(), -Vec3::z(), 3.0, 1.0));
        let Shape::Words(w) = &attribute.shape else { panic!("a text") };
        near(&w.at, [9.0, 8.0]);
        assert_eq!((w.text.as_str(), w.held, attribute.style.layer.as_str()), ("FR 7", [1, 2], "0"));
        let unread = ReaderNote::NotRead { file: "a.dxf".into(), kinds: vec![("INSERT".into(), 1)] };
        assert_eq!(notes, [unread, ReaderNote::TakenApart { file: "a.dxf".into(), insertions: 2 }]);
    }

    #[test]
    fn rows_and_columns_are_inserted_and_blocks_that_hold_themselves_are_not() {
        let block = "0\nBLOCK\n2\nP\n10\n0\n20\n0\n0\nPOINT\n10\n1\n20\n0\n0\nINSERT\n2\nP\n10\n0\n20\n0\n0\nENDBLK\n";
        let array = "0\nINSERT\n2\nP\n10\n10\n20\n0\n50\n90\n70\n2\n71\n3\n44\n5\n45\n7\n";
        let (items, notes) = read(block, array).expect("a drawing");
        let Shape::Point(last) = &items[5].shape else { panic!("a point") };
        // One column up, two rows to the left, and the point of the block up.
        near(last, [10.0 - 14.0, 1.0 + 5.0]);
        assert!(items.len() == 6 && reader_note(&notes[0]).contains("6 INSERT"), "{notes:?}");
        let many = read(block, "0\nINSERT\n2\nP\n10\n0\n20\n0\n70\n1000\n71\n1000\n").expect_err("too many");
        assert!(many.to_string().contains("copies in rows and columns"), "{many}");
    }

    #[test]
    fn blocks_that_multiply_or_lie_deep_in_each_other_are_refused() {
        let block = |k: usize, inner: &str| format!("0\nBLOCK\n2\nB{k}\n10\n0\n20\n0\n{inner}0\nENDBLK\n");
        let insert = |k: usize, more: &str| format!("0\nINSERT\n5\nC{k}\n2\nB{k}\n10\n0\n20\n0\n{more}");
        // Nothing is in the last block: without limits 10^28 copies of nothing.
        let many: String = (0..7).map(|k| block(k, &insert(k + 1, "70\n100\n71\n100\n"))).collect();
        let refused = read(&format!("{many}{}", block(7, "")), &insert(0, "")).expect_err("too many");
        assert!(refused.to_string().contains("copies of things"), "{refused}");
        let deep: String = (0..20_000).map(|k| block(k, &insert(k + 1, ""))).collect();
        let refused = read(&deep, &insert(0, "")).expect_err("too deep");
        assert!(refused.to_string().contains("INSERT C64: more than 64 blocks"), "{refused}");
    }

    #[test]
    fn texts_of_several_lines_are_carried_line_by_line() {
        let text = "0\nMTEXT\n5\nD\n8\nnames\n10\n10\n20\n20\n40\n3\n71\n5\n50\n30\n11\n0\n21\n1\n3\n{\\fArial;Fr\n1\name} 7\\PB\n";
        let (items, _) = read("", text).expect("a drawing");
        let words: Vec<&Words> =
            items.iter().filter_map(|i| if let Shape::Words(w) = &i.shape { Some(w) } else { None }).collect();
        let [first, second] = words[..] else { panic!("{items:?}") };
        assert_eq!(
            (first.text.as_str(), second.text.as_str(), items[1].name.as_str()),
            ("Frame 7", "B", "MTEXT D line 2")
        );
        // Read upwards, its middle held: letters of 3 mm and lines 5 mm apart reach 4 mm to both sides.
        near(&first.at, [10.0 - 4.0, 20.0]);
        near(&second.at, [10.0 + 1.0, 20.0]);
        assert_eq!((first.way, first.held, first.height), (Vec3::y(), [1, 3], 3.0));
    }
}
