//! Sheets of panels that share edges: one shell for all panels that hang together, every shared edge once.

use super::sheet::{EdgeUse, Sheet, SheetCurve, SheetEdge, SheetFace, SheetSurface};
use crate::draw::scene::titled;
use crate::geom::Vec3;
use crate::patchwork::panel::{Border, Panel, Patchwork};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Sheets of a patchwork. Panels on both sides of a shared edge are in one sheet; its vertices are the ends of edges,
/// equal bit by bit. Panels that `marked` holds for carry it in their names.
pub(crate) fn sheets(patchwork: &Patchwork, marked: &[bool]) -> Vec<Sheet> {
    let mut group: Vec<usize> = (0..patchwork.panels.len()).collect();
    let mut shared = BTreeSet::new();
    for s in patchwork.seams().iter().filter(|s| s.is_shared()) {
        shared.insert(s.seam);
        let [a, b] = s.sides.map(|s| group[s.panel]);
        let (low, high) = (a.min(b), a.max(b));
        group.iter_mut().filter(|g| **g == high).for_each(|g| *g = low);
    }
    let mut members: BTreeMap<usize, Vec<(&Panel, bool)>> = BTreeMap::new();
    for (k, (panel, g)) in patchwork.panels.iter().zip(group).enumerate() {
        members.entry(g).or_default().push((panel, marked.get(k).copied().unwrap_or(false)));
    }
    let reversed = |p: &Panel| patchwork.face_of(p).is_some_and(|f| f.reversed);
    members
        .into_values()
        .map(|panels| match panels[..] {
            [(one, marked)] => {
                let sheet = if one.loops().is_empty() {
                    Sheet::of_strip(&one.strip)
                } else {
                    Sheet::of_panel(one, reversed(one))
                };
                if marked {
                    sheet.marked()
                } else {
                    sheet
                }
            }
            _ => sewn(&panels, &shared, &reversed),
        })
        .collect()
}

fn sewn(panels: &[(&Panel, bool)], shared: &BTreeSet<u32>, reversed: &dyn Fn(&Panel) -> bool) -> Sheet {
    let (first, last) = (&panels[0].0.strip.name, &panels[panels.len() - 1].0.strip.name);
    let whole = titled(&format!("{first}..{last}"), panels.iter().any(|p| p.1));
    let mut sheet = Sheet { name: whole, ..Sheet::default() };
    let mut vertices: HashMap<[u64; 3], usize> = HashMap::new();
    let mut edges: HashMap<u32, usize> = HashMap::new();
    for &(panel, marked) in panels {
        let turned = reversed(panel);
        let mut loops = Vec::with_capacity(panel.loops().len());
        for runs in panel.loops() {
            let mut uses = Vec::with_capacity(runs.len());
            for run in runs.iter().filter(|r| !r.is_point()) {
                let seam = match run.border {
                    Border::Seam { seam, .. } if shared.contains(&seam) => Some(seam),
                    _ => None,
                };
                if let Some(&edge) = seam.and_then(|s| edges.get(&s)) {
                    // The other side came first and gave the edge its direction.
                    uses.push(EdgeUse { edge, forward: turned, trim: Some(run.trim.reversed()) });
                    continue;
                }
                let mut vertex = |c: Option<&[f64; 3]>| {
                    let c = c.copied().unwrap_or_default();
                    *vertices.entry(c.map(f64::to_bits)).or_insert_with(|| {
                        sheet.vertices.push(Vec3::from(c));
                        sheet.vertices.len() - 1
                    })
                };
                let (start, end) = (vertex(run.edge.control.first()), vertex(run.edge.control.last()));
                let edge = sheet.edges.len();
                sheet.edges.push(SheetEdge { start, end, curve: SheetCurve::Spline(run.edge.clone()) });
                edges.extend(seam.map(|s| (s, edge)));
                uses.push(EdgeUse { edge, forward: !turned, trim: Some(run.trim.clone()) });
            }
            if turned {
                uses.reverse();
            }
            loops.push(uses);
        }
        sheet.faces.push(SheetFace {
            name: titled(&panel.strip.name, marked),
            surface: SheetSurface::Spline { surface: panel.strip.patch.clone(), form: panel.strip.kind.into() },
            reversed: panel.mirrored() != turned,
            loops,
        });
    }
    sheet
}
