//! Things of a DXF drawing one by one, with how they are drawn: curves as in [`super::dxf`], POINT and TEXT.

use super::dxf::{self, curves, Entity, Fault};
use super::{is_dxf, not_read, CurveError, CurveOptions, BLANK};
use crate::develop::refold::artwork::{Item, Shape, Style, Words};
use crate::geom::Vec3;
use crate::spline::curve::Curve;

/// A drawing as things that can be carried over.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sketch {
    /// What is drawn, in the order of the file.
    pub items: Vec<Item>,
    /// Layers of the file with the numbers of their colours.
    pub layers: Vec<(String, i32)>,
}

/// Colours of no own: of the block, of the layer.
const NOT_OWN: [i32; 2] = [0, 256];
/// Greatest coordinate, mm, as of curves elsewhere: squares and cubes of larger ones leave the numbers.
const FARTHEST: f64 = 1e12;

/// Reads a drawing, with notes on what else it holds.
///
/// # Errors
/// See [`CurveError`].
pub(in crate::io) fn sketch(bytes: &[u8], options: &CurveOptions) -> Result<(Sketch, Vec<String>), CurveError> {
    let damaged = |reason: String| CurveError::Damaged { name: options.name.clone(), reason };
    // Files before 2007 have one byte for a letter.
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|b| char::from(*b)).collect(),
    };
    if !is_dxf(text.trim_start_matches(BLANK)) {
        return Err(damaged("it is no ASCII DXF drawing".into()));
    }
    let groups = dxf::groups(&text, options)?;
    let unit = dxf::drawn_unit(&groups, options)?;
    let mut out = Sketch::default();
    let mut unread: Vec<(String, usize)> = Vec::new();
    let mut without_length = 0;
    for e in dxf::entities(&groups, "ENTITIES").ok_or_else(|| damaged(dxf::CUT_OFF.into()))? {
        let name = format!("{} {}", e.kind, e.text(5)).trim_end().to_owned();
        match shape(&e, unit).map_err(|x| damaged(format!("{name}: {x}")))? {
            Some(Shape::Curves(all)) if !has_length(&all) => without_length += 1,
            Some(shape) => {
                if far(&shape) {
                    return Err(damaged(format!(
                        "{name} lies more than {FARTHEST:e} mm from the origin; check the unit"
                    )));
                }
                let style = style(&e).map_err(|x| damaged(format!("{name}: {x}")))?;
                out.items.push(Item { name, style, shape });
            }
            None => match unread.iter_mut().find(|u| u.0 == e.kind) {
                Some(u) => u.1 += 1,
                None => unread.push((e.kind.to_owned(), 1)),
            },
        }
    }
    let mut notes: Vec<String> = not_read(&options.name, &unread).into_iter().collect();
    if without_length > 0 {
        notes.push(format!("left out of {}: {without_length} curves without length", options.name));
    }
    if out.items.is_empty() {
        return Err(CurveError::Nothing { name: options.name.clone(), unread: notes.into_iter().next() });
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

fn style(e: &Entity) -> Result<Style, Fault> {
    let colour = e.number(62)?.map(|c| c as i32).filter(|c| !NOT_OWN.contains(c));
    Ok(Style { layer: unescaped(e.text(8)), colour })
}

fn shape(e: &Entity, unit: f64) -> Result<Option<Shape>, Fault> {
    match e.kind {
        "POINT" => Ok(Some(Shape::Point(e.point(10)? * unit))),
        "TEXT" => words(e, unit).map(|w| Some(Shape::Words(w))),
        _ => Ok(curves(e, unit)?.map(Shape::Curves)),
    }
}

/// A line of text; where it is held at another place than its beginning, that is its second point.
fn words(e: &Entity, unit: f64) -> Result<Words, Fault> {
    let frame = e.frame()?;
    let held = [72, 73].map(|code| e.number(code).map(|x| x.unwrap_or(0.0) as i32));
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

/// A string with the letters that it has as \U+ and four digits.
fn unescaped(text: &str) -> String {
    let mut parts = text.split("\\U+");
    let mut out = parts.next().unwrap_or("").to_owned();
    for part in parts {
        let letter = part.get(..4).and_then(|d| u32::from_str_radix(d, 16).ok()).and_then(char::from_u32);
        match letter {
            Some(letter) => {
                out.push(letter);
                out.push_str(&part[4..]);
            }
            None => {
                out.push_str("\\U+");
                out.push_str(part);
            }
        }
    }
    out
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
