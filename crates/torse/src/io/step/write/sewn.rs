//! Sheets of panels that share edges: one shell for all panels that hang together, every shared edge once.

use super::shell::{EdgeUse, Shell, ShellCurve, ShellEdge, ShellFace};
use crate::draw::scene::titled;
use crate::geom::Vec3;
use crate::patchwork::panel::{Border, Panel, Patchwork};
use crate::patchwork::seam::Seam;
use crate::patchwork::shell_surface::ShellSurface;
use std::collections::{BTreeMap, HashMap};

/// Shells of a patchwork. Panels on both sides of a shared edge are in one shell; its vertices are the ends of edges,
/// equal bit by bit. Panels that `marked` holds for carry it in their names.
pub(crate) fn shells(patchwork: &Patchwork, marked: &[bool]) -> Vec<Shell> {
    let mut group: Vec<usize> = (0..patchwork.panels.len()).collect();
    let mut shared = BTreeMap::new();
    let reversed = |p: &Panel| patchwork.face_of(p).is_some_and(|f| f.reversed);
    // A shell has one outside: where the normals of two faces contradict each other both keep their edges.
    let agree = |s: &Seam| (reversed(s.sides[0].of) == reversed(s.sides[1].of)) == s.turned;
    for s in patchwork.seams().iter().filter(|s| s.is_shared() && agree(s)) {
        shared.insert(s.seam, s.turned);
        let [a, b] = s.sides.map(|s| group[s.panel]);
        let (low, high) = (a.min(b), a.max(b));
        group.iter_mut().filter(|g| **g == high).for_each(|g| *g = low);
    }
    let mut members: BTreeMap<usize, Vec<(&Panel, bool)>> = BTreeMap::new();
    for (k, (panel, g)) in patchwork.panels.iter().zip(group).enumerate() {
        members.entry(g).or_default().push((panel, marked.get(k).copied().unwrap_or(false)));
    }
    members
        .into_values()
        .map(|panels| match panels[..] {
            [(one, marked)] => {
                let shell = if one.loops().is_empty() {
                    Shell::of_strip(&one.strip)
                } else {
                    Shell::of_panel(one, reversed(one))
                };
                if marked {
                    shell.marked()
                } else {
                    shell
                }
            }
            _ => sewn(&panels, &|b| shared_seam(patchwork, &shared, b), &reversed),
        })
        .collect()
}

/// The number of the shared seam along a border, and whether its second side runs against the first.
fn shared_seam(patchwork: &Patchwork, shared: &BTreeMap<u32, bool>, border: &Border) -> Option<(u32, bool)> {
    let seam = patchwork.side_of(border)?.0 as u32;
    shared.get(&seam).map(|turned| (seam, *turned))
}

fn sewn(
    panels: &[(&Panel, bool)],
    shared: &dyn Fn(&Border) -> Option<(u32, bool)>,
    reversed: &dyn Fn(&Panel) -> bool,
) -> Shell {
    let (first, last) = (&panels[0].0.strip.name, &panels[panels.len() - 1].0.strip.name);
    let whole = titled(&format!("{first}..{last}"), panels.iter().any(|p| p.1));
    let mut shell = Shell { name: whole, ..Shell::default() };
    let mut vertices: HashMap<[u64; 3], usize> = HashMap::new();
    let mut edges: HashMap<u32, (usize, usize)> = HashMap::new();
    for (index, &(panel, marked)) in panels.iter().enumerate() {
        let turned = reversed(panel);
        let mut loops = Vec::with_capacity(panel.loops().len());
        for runs in panel.loops() {
            let mut uses = Vec::with_capacity(runs.len());
            for run in runs.iter().filter(|r| !r.is_point()) {
                let seam = shared(&run.border);
                let first = seam.and_then(|(s, against)| Some((edges.get(&s)?, against)));
                // The ends of a panel that goes all round keep an edge each: Open CASCADE takes a face on a surface that does
                // not close, but uses one edge twice, for another one.
                if let Some((&(edge, _), against)) = first.filter(|f| f.0 .1 != index) {
                    // The other side came first and gave the edge its direction.
                    let trim = if against { run.trim.reversed() } else { run.trim.clone() };
                    uses.push(EdgeUse { edge, forward: turned == against, trim: Some(trim) });
                    continue;
                }
                let mut vertex = |c: Option<&[f64; 3]>| {
                    let c = c.copied().unwrap_or_default();
                    *vertices.entry(c.map(f64::to_bits)).or_insert_with(|| {
                        shell.vertices.push(Vec3::from(c));
                        shell.vertices.len() - 1
                    })
                };
                let (start, end) = (vertex(run.edge.control.first()), vertex(run.edge.control.last()));
                let edge = shell.edges.len();
                shell.edges.push(ShellEdge { start, end, curve: ShellCurve::Spline(run.edge.clone()) });
                edges.extend(seam.map(|s| (s.0, (edge, index))));
                uses.push(EdgeUse { edge, forward: !turned, trim: Some(run.trim.clone()) });
            }
            if turned {
                uses.reverse();
            }
            loops.push(uses);
        }
        shell.faces.push(ShellFace {
            name: titled(&panel.strip.name, marked),
            surface: ShellSurface::Spline { surface: panel.strip.patch.clone(), form: panel.strip.kind.into() },
            reversed: panel.mirrored() != turned,
            loops,
        });
    }
    shell
}
