//! Trimming curves of ruled strips: the border of a label carried over by the strip's map; strips of one row share the
//! curves between them (certificate specification, section 5).

use super::borders::{Borders, BoundaryError, BoundaryOptions, Stretch};
use super::path::smoothed;
use crate::fit::panels::chains::{BorderStretch, Right};
use crate::fit::panels::trim::{self, Waypoint};
use crate::fit::ruled::strip_map::RuledStrip;
use crate::num::hash::HashMap;
use crate::num::parallel;
use crate::patchwork::foot_map::FootMap;
use crate::patchwork::panel::{Border, Coedge, Panel, PanelForm, PanelTrim};
use crate::spline::curve::Curve;
use crate::torse::form::PanelKind;
use crate::torse::strip::Strip;

/// A ruled strip for a label.
#[derive(Clone, Copy, Debug)]
pub struct AssignedStrip<'a> {
    /// Label of the triangles.
    pub label: u32,
    /// The strip, with room around its region.
    pub strip: &'a RuledStrip,
    /// Row of strips that share their boundary curves, and place in it; `None` for a strip that shares none.
    pub row: Option<(usize, usize)>,
}

/// Points of a run at least.
const WANTED: usize = 48;
/// Room beside the border, share of the strip's length.
const ROOM: f64 = 0.01;
/// Places tried for a first guess, across and along the rulings.
const GUESSES: [usize; 2] = [24, 4];
/// Share of a strip's image that its border may miss: the proof says what that costs.
const MISSED: f64 = 0.05;
/// Newton steps for a place on a boundary curve.
const STEPS: usize = 20;

/// A trimming curve for both sides of a chain: the parameter across the rulings, in the direction of the chain.
struct SharedLine {
    places: Vec<f64>,
    trim: Curve<2>,
    edge: Curve<3>,
    /// Places along the rulings on the left and on the right.
    sides: [f64; 2],
}

impl Borders<'_> {
    /// Panels of ruled strips, named by the caller, in the order of the strips.
    ///
    /// *Guarantee*: neighbours in a row have one edge in space, and the same parameters on it.
    pub(crate) fn ruled_panels(
        &self,
        face_index: usize,
        assigned: &[AssignedStrip],
        options: &BoundaryOptions,
    ) -> Vec<Result<Panel, BoundaryError>> {
        let of: HashMap<u32, &AssignedStrip> = assigned.iter().map(|a| (a.label, a)).collect();
        let shared: HashMap<usize, SharedLine> =
            parallel::map(0..self.chains.len(), |k| Some((k, self.shared_line(&self.chains[k], &of, options)?)))
                .into_iter()
                .flatten()
                .collect();
        parallel::map(assigned.iter(), |a| self.ruled_panel(face_index, a, &shared, options))
    }

    /// The line between two neighbours of a row.
    fn shared_line(
        &self,
        chain: &BorderStretch,
        of: &HashMap<u32, &AssignedStrip>,
        options: &BoundaryOptions,
    ) -> Option<SharedLine> {
        let Right::Label(right) = chain.right else { return None };
        let (left, right) = (of.get(&chain.left)?, of.get(&right)?);
        let ((row, i), (other, j)) = (left.row?, right.row?);
        let sides = match (row == other, i.abs_diff(j)) {
            (true, 1) if i < j => [1.0, 0.0],
            (true, 1) => [0.0, 1.0],
            _ => return None,
        };
        let strip = left.strip;
        let at = |k: usize| self.partition.vertices[chain.vertices[k] as usize];
        let mut guess = first_guess(&strip.map, at(0))[0];
        let count = chain.vertices.len();
        let mut places = Vec::with_capacity(count);
        for k in 0..count {
            guess = on_line(&strip.map, sides[0], at(k), guess)?;
            places.push(guess);
        }
        let path = RuledPath { borders: self, map: &strip.map, vertices: &chain.vertices, line: Some(sides[0]) };
        let ends: Vec<[f64; 2]> = places.iter().map(|s| [*s, sides[0]]).collect();
        let waypoints = path.waypoints(&chain.parameters, &ends, options.trim_tolerance)?;
        let mut trim = trim::trim(&strip.patch, waypoints, |_, _| None).ok()?.curve;
        trim.control.iter_mut().for_each(|c| c[1] = sides[0]);
        let edge = trim::edge(&strip.patch, &trim, options.edge_tolerance).ok()?;
        Some(SharedLine { places, trim, edge, sides })
    }

    fn ruled_panel(
        &self,
        face_index: usize,
        assigned: &AssignedStrip,
        shared: &HashMap<usize, SharedLine>,
        options: &BoundaryOptions,
    ) -> Result<Panel, BoundaryError> {
        let (label, strip) = (assigned.label, assigned.strip);
        let loops = self.loops(label)?;
        let places = self.ruled_places(label, &strip.map, &loops, shared)?;
        let mut out = Vec::new();
        for l in &loops {
            let mut runs = Vec::new();
            for stretch in l {
                let chain = &self.chains[stretch.chain];
                let (vertices, parameters) = stretch.oriented(chain);
                let (trim, edge) = match shared.get(&stretch.chain) {
                    Some(line) => {
                        let mut trim = line.trim.clone();
                        let side = line.sides[usize::from(!stretch.forward)];
                        trim.control.iter_mut().for_each(|c| c[1] = side);
                        if stretch.forward {
                            (trim, line.edge.clone())
                        } else {
                            (trim.reversed(), line.edge.reversed())
                        }
                    }
                    None => {
                        let bad = || BoundaryError::Foot { label, uv: self.partition.vertices[vertices[0] as usize] };
                        let path = RuledPath { borders: self, map: &strip.map, vertices: &vertices, line: None };
                        let ends: Vec<[f64; 2]> = vertices.iter().map(|v| places[v]).collect();
                        let waypoints = path.waypoints(&parameters, &ends, options.trim_tolerance).ok_or_else(bad)?;
                        let spline = |source| BoundaryError::Spline { label, source };
                        let trim = trim::trim(&strip.patch, waypoints, |_, _| None).map_err(spline)?.curve;
                        let edge = trim::edge(&strip.patch, &trim, options.edge_tolerance).map_err(spline)?;
                        (trim, edge)
                    }
                };
                let border = match chain.right {
                    Right::Trim(edge) => Border::Trim { edge },
                    Right::Label(_) => Border::Seam { seam: self.seams[stretch.chain], forward: stretch.forward },
                };
                runs.push(Coedge { border, vertices, parameters, trim, edge });
            }
            out.push(runs);
        }
        let used = out.iter().flatten().flat_map(|r: &Coedge| &r.trim.control).map(|c| c[0]);
        let (lo, hi) = used.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), s| (lo.min(s), hi.max(s)));
        let (first, last) = strip.map.knots_s.domain();
        let room = ROOM * (hi - lo);
        let cut = strip
            .restricted((lo - room).max(first), (hi + room).min(last))
            .map_err(|source| BoundaryError::Spline { label, source })?;
        Ok(Panel {
            strip: Strip { name: String::new(), kind: PanelKind::Ruled, patch: cut.patch },
            trim: Some(PanelTrim { face: face_index, label, form: PanelForm::Ruled(cut.map), loops: out }),
            outline: Vec::new(),
        })
    }

    /// Places on the strip of all vertices of a label's border.
    fn ruled_places(
        &self,
        label: u32,
        map: &FootMap,
        loops: &[Vec<Stretch>],
        shared: &HashMap<usize, SharedLine>,
    ) -> Result<HashMap<u32, [f64; 2]>, BoundaryError> {
        let mut places = HashMap::default();
        for stretch in loops.iter().flatten() {
            let Some(line) = shared.get(&stretch.chain) else { continue };
            let side = line.sides[usize::from(!stretch.forward)];
            let vertices = &self.chains[stretch.chain].vertices;
            places.extend(vertices.iter().zip(&line.places).map(|(&v, &s)| (v, [s, side])));
        }
        for l in loops {
            let mut guess = None;
            for v in l.iter().flat_map(|s| s.oriented(&self.chains[s.chain]).0) {
                let uv = self.partition.vertices[v as usize];
                let at = match places.get(&v) {
                    Some(&at) => at,
                    None => place_of(map, uv, guess).ok_or(BoundaryError::Foot { label, uv })?,
                };
                places.insert(v, at);
                guess = Some(at);
            }
        }
        Ok(places)
    }
}

/// The run of vertices that a trimming curve follows, on a boundary curve of the strip or anywhere.
struct RuledPath<'a> {
    borders: &'a Borders<'a>,
    map: &'a FootMap,
    vertices: &'a [u32],
    line: Option<f64>,
}

impl RuledPath<'_> {
    /// Vertices and points between them, with the places of the vertices given.
    fn waypoints(&self, parameters: &[f64], ends: &[[f64; 2]], tolerance: f64) -> Option<Vec<Waypoint>> {
        let edges = self.vertices.len() - 1;
        let inner = (WANTED / edges).clamp(1, 40);
        let at = |k: usize| self.borders.partition.vertices[self.vertices[k] as usize];
        let bend = |k: usize| {
            let known = self.borders.bend.get(&self.vertices[k]).copied().unwrap_or(0.0);
            if k == 0 || k == edges {
                0.0
            } else {
                known
            }
        };
        let mut out = Vec::with_capacity((inner + 1) * edges + 1);
        for k in 0..edges {
            out.push(Waypoint { s: parameters[k], place: ends[k], allowance: smoothed(bend(k), tolerance) });
            let (p, q) = (at(k), at(k + 1));
            for i in 1..=inner {
                let l = i as f64 / (inner + 1) as f64;
                let between = |a: f64, b: f64| a + (b - a) * l;
                let uv = [between(p[0], q[0]), between(p[1], q[1])];
                let guess = [between(ends[k][0], ends[k + 1][0]), between(ends[k][1], ends[k + 1][1])];
                let place = match self.line {
                    Some(t) => [on_line(self.map, t, uv, guess[0])?, t],
                    None => place_of(self.map, uv, Some(guess))?,
                };
                let s = between(parameters[k], parameters[k + 1]);
                out.push(Waypoint { s, place, allowance: smoothed(bend(k).max(bend(k + 1)), tolerance) });
            }
        }
        out.push(Waypoint { s: parameters[edges], place: ends[edges], allowance: tolerance });
        Some(out)
    }
}

/// The place on the strip that goes with one on the face: its own where the map has it, else the nearest, if it is near.
fn place_of(map: &FootMap, uv: [f64; 2], guess: Option<[f64; 2]>) -> Option<[f64; 2]> {
    if let Some(at) = guess.and_then(|g| map.inverse(uv, g)) {
        return Some(within(map, at));
    }
    let first = first_guess(map, uv);
    if let Some(at) = map.inverse(uv, first) {
        return Some(within(map, at));
    }
    let tries = guess.into_iter().chain([first]).map(|g| map.nearest(uv, g));
    tries.min_by(|a, b| a.1.total_cmp(&b.1)).filter(|n| n.1 <= MISSED).map(|n| n.0)
}

/// The nearest place on the strip: borders meet boundary curves only nearly where these are.
fn within(map: &FootMap, at: [f64; 2]) -> [f64; 2] {
    let ((s0, s1), (t0, t1)) = (map.knots_s.domain(), map.knots_t.domain());
    [at[0].clamp(s0, s1), at[1].clamp(t0, t1)]
}

/// The place of a coarse grid that lies nearest.
fn first_guess(map: &FootMap, uv: [f64; 2]) -> [f64; 2] {
    let ((s0, s1), (t0, t1)) = (map.knots_s.domain(), map.knots_t.domain());
    let mut best = ([s0, t0], f64::INFINITY);
    for i in 0..=GUESSES[0] {
        for j in 0..=GUESSES[1] {
            let at = [s0 + (s1 - s0) * i as f64 / GUESSES[0] as f64, t0 + (t1 - t0) * j as f64 / GUESSES[1] as f64];
            let jet = map.jet(at[0], at[1]);
            // Distances in units of the map's own derivatives there.
            let det = (jet.ds[0] * jet.dt[1] - jet.ds[1] * jet.dt[0]).abs().max(f64::MIN_POSITIVE);
            let off = [uv[0] - jet.p[0], uv[1] - jet.p[1]];
            let s = (off[0] * jet.dt[1] - off[1] * jet.dt[0]) / det / (s1 - s0);
            let t = (jet.ds[0] * off[1] - jet.ds[1] * off[0]) / det / (t1 - t0);
            let far = s.hypot(t);
            if far < best.1 {
                best = (at, far);
            }
        }
    }
    best.0
}

/// Parameter at which the line of constant `t` comes nearest to a place, by Newton's method on the way across the
/// rulings.
fn on_line(map: &FootMap, t: f64, uv: [f64; 2], guess: f64) -> Option<f64> {
    let (lo, hi) = map.knots_s.domain();
    let mut s = guess;
    for _ in 0..STEPS {
        let j = map.jet(s, t);
        let off = [uv[0] - j.p[0], uv[1] - j.p[1]];
        // Along the ruling nothing is asked.
        let step = (off[0] * j.dt[1] - off[1] * j.dt[0]) / (j.ds[0] * j.dt[1] - j.ds[1] * j.dt[0]);
        if !step.is_finite() {
            return None;
        }
        s = (s + step).clamp(lo, hi);
        if step.abs() <= f64::EPSILON * (hi - lo) * 16.0 {
            break;
        }
    }
    Some(s)
}
