//! Parts that share edges: marks with the same labels on both sides, and the table of joints.

use crate::develop::joints::{joint_name, places_on_outline};
use crate::develop::unfold::joints::{EdgePlace, PartJoint, SharedEdge};
use crate::develop::unfold::part::FlatPart;
use crate::develop::view::panels_viewed;
use crate::geom::Vec3;
use crate::patchwork::pattern::{Mark, MarkPlace, Pattern};
use crate::search::strips::face_panel::LaidFace;

/// A place on both sides of a joint, with its label.
struct Pair {
    label: String,
    parts: [usize; 2],
    /// `None` where a side is not known any more.
    sides: [Option<EdgePlace>; 2],
}

/// Marks the parts on both sides of every edge that they share, "J3.1" on either; parts that were laid flat anew through a panel are
/// marked on the outline of that. Marks are on both sides or on none.
pub(super) fn joined(parts: &mut [FlatPart], laid: &[Option<LaidFace>]) -> Vec<PartJoint> {
    let shared: Vec<SharedEdge> = parts.iter_mut().flat_map(|p| std::mem::take(&mut p.shared)).collect();
    let mut pairs: Vec<Pair> = Vec::new();
    let mut joints = Vec::with_capacity(shared.len());
    for (number, edge) in shared.into_iter().enumerate() {
        let SharedEdge { parts, lengths, places, stations } = edge;
        let name = joint_name(number);
        pairs.extend((1..).zip(places).map(|(k, sides)| {
            let label = format!("{name}.{k}");
            Pair { label, parts, sides: sides.map(Some) }
        }));
        joints.push(PartJoint { name, parts, lengths, stations });
    }
    for (k, face) in laid.iter().enumerate() {
        if let Some(face) = face {
            moved_to_panel(&mut pairs, k, &parts[k].pattern, face);
        }
    }
    for pair in pairs {
        let [Some(a), Some(b)] = pair.sides else { continue };
        let apart = (a.place - b.place).norm();
        for (part, at) in pair.parts.into_iter().zip([a, b]) {
            let (label, on) = (pair.label.clone(), MarkPlace::Joint);
            parts[part].pattern.marks.push(Mark { point: at.point, inward: at.inward, label, on, apart });
        }
    }
    joints
}

/// Places of a part that was laid flat anew: those on the outline of its panel, as the pattern is seen. Where the part is on both
/// sides its places in space do not tell the sides apart.
fn moved_to_panel(pairs: &mut [Pair], part: usize, pattern: &Pattern, laid: &LaidFace) {
    pairs.iter_mut().filter(|p| p.parts == [part; 2]).for_each(|p| p.sides = [None; 2]);
    let mut own: Vec<&mut Option<EdgePlace>> = pairs
        .iter_mut()
        .flat_map(|p| p.parts.into_iter().zip(&mut p.sides))
        .filter(|s| s.0 == part)
        .map(|s| s.1)
        .collect();
    let places: Vec<Vec3> = own.iter().filter_map(|s| s.map(|s| s.place)).collect();
    let mark = |(point, inward)| Mark { point, inward, label: String::new(), on: MarkPlace::Joint, apart: 0.0 };
    let marks = places_on_outline(&laid.patchwork, laid.pattern.panel, &places);
    let marks = marks.unwrap_or_default().into_iter().map(mark).collect();
    let seen = panels_viewed(&laid.patchwork, vec![Pattern { marks, ..laid.pattern.clone() }], pattern.view).pop();
    let mut seen = seen.map_or_else(Vec::new, |p| p.marks).into_iter();
    for side in own.iter_mut().filter(|s| s.is_some()) {
        **side = seen.next().and_then(|m| side.map(|s| EdgePlace { point: m.point, inward: m.inward, ..s }));
    }
}
