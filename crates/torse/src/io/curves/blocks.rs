//! Blocks of a DXF drawing (BLOCKS, INSERT): what they hold, and where an insertion puts it \[DXF2000\].

use super::dxf::{self, Entity, Fault};
use crate::develop::refold::artwork::{Shape, Words};
use crate::geom::placement::Placement;
use crate::geom::Vec3;
use nalgebra::{Matrix3, Rotation3};
use std::collections::HashMap;

/// What a drawing may insert.
pub(super) struct Block<'a> {
    /// The point that is put where a block is inserted, in units of the drawing.
    pub base: Vec3,
    /// What it holds.
    pub entities: Vec<Entity<'a>>,
}

/// The blocks of a drawing by their names in small letters.
pub(super) fn blocks<'a>(groups: &[(i32, &'a str)]) -> HashMap<String, Block<'a>> {
    let mut out: HashMap<String, Block> = HashMap::new();
    let mut open = None;
    for e in dxf::entities(groups, "BLOCKS").unwrap_or_default() {
        match e.kind {
            "BLOCK" => {
                let name = e.text(2).to_lowercase();
                // A block without a base point has its origin.
                let base = e.point(10).unwrap_or_else(|_| Vec3::zeros());
                out.insert(name.clone(), Block { base, entities: Vec::new() });
                open = Some(name);
            }
            "ENDBLK" => open = None,
            _ => {
                if let Some(block) = open.as_ref().and_then(|name| out.get_mut(name)) {
                    block.entities.push(e);
                }
            }
        }
    }
    out
}

/// Copies of one insertion at most; drawings have hundreds.
const MOST_COPIES: usize = 10_000;

/// Where an insertion puts what its block holds, once for each place of its rows and columns; maps of mm.
pub(super) fn copies(insert: &Entity, base: &Vec3, unit: f64) -> Result<Vec<Placement>, Fault> {
    let number = |code: i32, absent: f64| Ok::<f64, Fault>(insert.number(code)?.unwrap_or(absent));
    let scale = Matrix3::from_diagonal(&Vec3::new(number(41, 1.0)?, number(42, 1.0)?, number(43, 1.0)?));
    let turn = Rotation3::from_axis_angle(&Vec3::z_axis(), number(50, 0.0)?.to_radians());
    let own = Placement::of_frame(&insert.frame()?);
    let at = insert.point(10)?;
    let (columns, rows) = (number(70, 1.0)?.max(1.0) as usize, number(71, 1.0)?.max(1.0) as usize);
    let count = columns.saturating_mul(rows);
    if count > MOST_COPIES {
        return Err(Fault::Count { what: "copies in rows and columns", there: count, wanted: MOST_COPIES });
    }
    let (across, up) = (number(44, 0.0)?, number(45, 0.0)?);
    let linear = turn.matrix() * scale;
    let place = |k: usize| {
        let step = turn * Vec3::new(across * (k % columns) as f64, up * (k / columns) as f64, 0.0);
        own.after(&Placement { linear, shift: (at + step - linear * base) * unit })
    };
    Ok((0..count).map(place).collect())
}

/// A thing where a map puts it; `None` for texts that it makes flat.
pub(super) fn placed(shape: Shape, place: &Placement) -> Option<Shape> {
    match shape {
        Shape::Point(p) => Some(Shape::Point(place.point(&p))),
        Shape::Curves(mut all) => {
            for h in all.iter_mut().flat_map(|c| &mut c.control) {
                let p = place.linear * Vec3::new(h[0], h[1], h[2]) + place.shift * h[3];
                *h = [p.x, p.y, p.z, h[3]];
            }
            Some(Shape::Curves(all))
        }
        Shape::Words(w) => placed_words(w, place).map(Shape::Words),
    }
}

/// A text under an affine map: letters become wider, higher and slanting; mirrored ones are read from behind.
fn placed_words(w: Words, place: &Placement) -> Option<Words> {
    let (along, up) = (place.linear * w.way, place.linear * w.normal.cross(&w.way));
    let way = along.try_normalize(0.0)?;
    let normal = way.cross(&up).try_normalize(0.0)?;
    let across = normal.cross(&way);
    let (rise, lean) = (across.dot(&up), way.dot(&up));
    // Slanting letters lean by the tangent of their slant.
    let lean = lean + w.slant.to_radians().tan() * w.stretch * along.norm();
    let slant = if lean == 0.0 { 0.0 } else { (lean / rise).atan().to_degrees() };
    Some(Words {
        at: place.point(&w.at),
        way,
        normal,
        height: w.height * rise,
        stretch: w.stretch * along.norm() / rise,
        slant,
        ..w
    })
}
