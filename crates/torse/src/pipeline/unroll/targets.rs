//! What curves are carried to: parts with their maps.

use crate::brep::face::Face;
use crate::develop::carried::Target;
use crate::develop::joints::panel_map;
use crate::develop::refold::atlas::{Atlas, PanelPatch};
use crate::develop::unfold::part::FlatPart;
use crate::patchwork::panel::{Coedge, Patchwork};
use crate::patchwork::pattern::Pattern;
use crate::search::strips::face_panel::LaidFace;

/// Points on every span of a panel's border.
const BORDER_POINTS: usize = 16;

/// A part with its maps.
pub(super) fn target(part: &FlatPart, laid: Option<&LaidFace>, faces: &[Face]) -> Option<Target> {
    let leap = part.allowances.iter().map(|a| a.abs()).fold(0.0, f64::max);
    let Some(laid) = laid else {
        let atlas = Atlas::placed(part.faces.iter().map(|f| &faces[*f]).zip(&part.places)).ok()?;
        let target = Target::new(atlas, &part.pattern, leap);
        return Some(match part.sheet.thickness > 0.0 {
            true => target.of_sheet(other_skin(part, faces)),
            false => target,
        });
    };
    of_panel(&laid.patchwork, laid.pattern.panel, &laid.pattern, leap)
}

/// A panel with its map to the plane, its pattern, and by how much (mm) its image may leap.
pub(super) fn of_panel(patchwork: &Patchwork, number: usize, pattern: &Pattern, leap: f64) -> Option<Target> {
    let panel = patchwork.panels.get(number)?;
    let border = |l: &Vec<Coedge>| {
        let mut out = Vec::new();
        for r in l {
            for w in r.trim.knots.breaks().windows(2) {
                let at = |k: usize| w[0] + (w[1] - w[0]) * k as f64 / BORDER_POINTS as f64;
                out.extend((0..BORDER_POINTS).map(|k| r.trim.point(at(k))));
            }
        }
        out
    };
    let patch = PanelPatch {
        name: panel.strip.name.clone(),
        surface: panel.strip.patch.clone(),
        loops: panel.loops().iter().map(border).collect(),
        corners: Vec::new(),
    };
    Some(Target::new(Atlas::mapped(patch, panel_map(patchwork, number)?), pattern, leap))
}

/// How far (mm) the other skin of a sheet is along the normals of the faces of a part, as these are in the file.
fn other_skin(part: &FlatPart, faces: &[Face]) -> Vec<f64> {
    let of = |(k, face): (usize, &usize)| {
        let thickness = part.sheet.local.get(k).copied().unwrap_or(part.sheet.thickness);
        // Sheet is behind the outside.
        let inwards = faces[*face].reversed != part.sheet.turned.get(k).copied().unwrap_or(false);
        if inwards {
            thickness
        } else {
            -thickness
        }
    };
    part.faces.iter().enumerate().map(of).collect()
}
