//! Which item asks for more than there is, where conditions outnumber coordinates \[W15, section 4D; TBWP16\].

use super::built::{Built, HandleAt, Item};
use super::check::{curve_item, facet_item, handle_item, other_item, strip_item, At};
use super::Composite;
use std::collections::BTreeSet;

/// What would help against too many strips.
const STRIPS: &str =
    "strips side by side share their curves: give these a higher degree with continuity 1 (degree d carries \
                      3(d - 1) strips), or say redundant, and the result shows whether all can be met";
/// What would help against a fixed curve.
const FIXED: &str = "let it move, or give the curves beside it more spans";
/// What would help against anything else.
const HELD: &str = "leave it out, let a handle pull instead of holding exactly, or give its curves more spans";

/// The first item with which conditions outnumber coordinates, strips first, then fixed curves, planar pieces, joins,
/// handles and lengths; and what would help.
pub(super) fn too_much(c: &Composite, built: &Built) -> (Box<At>, &'static str) {
    let asked: Vec<(Item, usize)> = built.items.iter().copied().zip(built.system.conditions()).collect();
    let of = |wanted: &dyn Fn(Item) -> bool| -> usize { asked.iter().filter(|a| wanted(a.0)).map(|a| a.1).sum() };
    let of_strip = |k: usize| of(&|i| matches!(i, Item::Ruling { strip, .. } | Item::Plane { strip } if strip == k));
    let fixed: Vec<usize> = (0..c.curves.len()).filter(|&k| c.curves[k].fixed).collect();
    let mut frozen: BTreeSet<u32> = BTreeSet::new();
    let mut freezes = |points: &[u32]| 3 * points.iter().filter(|p| frozen.insert(**p)).count();
    let mut all: Vec<(Box<At>, &'static str, usize)> = Vec::new();
    all.extend((0..c.strips.len()).map(|k| (strip_item(c, k), STRIPS, of_strip(k))));
    for k in fixed {
        all.push((curve_item(c, k, "fixed curve"), FIXED, freezes(&built.points[k])));
    }
    all.extend((0..c.facets.len()).map(|k| (facet_item(c, k), HELD, of(&|i| i == Item::Facet(k)))));
    all.extend((0..c.joins.len()).map(|k| (other_item("joins", "join", k), HELD, of(&|i| i == Item::Join(k)))));
    for (k, h) in c.handles.iter().enumerate() {
        let taken = match built.handles.get(k) {
            Some(HandleAt::Control(p)) => freezes(&[*p]),
            _ => of(&|i| i == Item::Handle(k)),
        };
        all.push((handle_item(k, h), HELD, taken));
    }
    all.extend((0..c.lengths.len()).map(|k| (other_item("lengths", "length", k), HELD, of(&|i| i == Item::Length(k)))));
    let mut left = built.system.free() + 3 * all_frozen(c, built);
    let mut last = all.len() - 1;
    for (k, (_, _, taken)) in all.iter().enumerate() {
        match left.checked_sub(*taken) {
            Some(rest) => left = rest,
            None => {
                last = k;
                break;
            }
        }
    }
    let (item, help, _) = all.swap_remove(last);
    (item, help)
}

/// Control points that fixed curves and handles keep.
fn all_frozen(c: &Composite, built: &Built) -> usize {
    let curves = (0..c.curves.len()).filter(|&k| c.curves[k].fixed).flat_map(|k| built.points[k].iter().copied());
    let handles = built.handles.iter().filter_map(|h| match h {
        HandleAt::Control(p) => Some(*p),
        _ => None,
    });
    curves.chain(handles).collect::<BTreeSet<u32>>().len()
}
