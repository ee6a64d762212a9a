//! A ruled face as a panel on its own rulings: nothing is fitted but the trimming curves.
//!
//! *Method*: the straight parameter lines of the face between two of its parameter curves, a little beyond its border, are the
//! patch, exact in homogeneous form. The border follows the file's own edges: their points are brought to the patch by
//! Gauss–Newton steps. Where all rulings meet in a point, the patch ends beside it, so that files have no edge without
//! length. Nothing is judged here.

use super::cut_off::{cut_off, Side, Way};
use super::trim::{edge, trim, Waypoint};
use crate::brep::boundary_stretch::{boundary_stretches, BoundaryStretch};
use crate::brep::face::Face;
use crate::brep::rulings::Rulings;
use crate::geom::Vec3;
use crate::patchwork::foot_map::FootMap;
use crate::patchwork::panel::{Border, Coedge, Panel, PanelForm, PanelTrim};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use crate::torse::form::PanelKind;
use crate::torse::strip::Strip;

/// Room beside the border, as a share of the rulings and of the range across them.
const ROOM: f64 = 0.01;
/// Way from an apex to the end of the patch, as a share of the rulings: what is missing is a ten-thousandth of a millionth of
/// the area, and its edge is long enough for files.
const BESIDE_APEX: f64 = 1e-5;
/// Places that are looked at along sides at first, across rulings and along them.
const PLACES: usize = 48;
/// Gauss–Newton steps to a place on the patch.
const STEPS: usize = 12;
/// Share of the squared measure of the parameters' net below which it has no place across the rulings, as at an apex.
const NO_PLACE: f64 = 1e-24;
/// Distance, as a share of the ranges of both parameters, up to which ends of sides are one place.
const ONE_PLACE: f64 = 1e-4;
/// Share of a range by which rounding leads beyond it.
const ROUNDING: f64 = 1e-12;
/// Share of the rulings by which places where the file's parameter is noted keep from both ends.
const CLEAR: f64 = 1e-3;

/// A face on its own rulings.
pub(crate) struct OnRulings<'a> {
    face: &'a Face,
    runs: Vec<BoundaryStretch>,
    /// The rulings over the whole face: u selects one, v in [0, 1] runs along it.
    patch: Surface,
    /// Its border in the parameter plane of the patch.
    loops: Vec<Vec<Side>>,
    map: FootMap,
    /// Whether v of the face selects the ruling.
    swapped: bool,
    /// v of the first row of the patch and how much it grows to the last, in the parameters of the face.
    along: [f64; 2],
}

impl<'a> OnRulings<'a> {
    /// The face on the rulings found on it; `None` where these have no patch or the border does not lie on it.
    pub fn new(face: &'a Face, rulings: &Rulings) -> Option<Self> {
        let swapped = rulings.is_swapped();
        let surface = if swapped { face.surface.transposed() } else { face.surface.clone() };
        let ((a, b), (lo, hi)) = (rulings.range(), rulings.reach());
        let ends = [lo, hi].map(|v| surface.curve_at_v(v));
        let room = rooms((a, b), &ends, rulings.end_in_points())?;
        let (first, last) = surface.knots_u.domain();
        let beside = ROOM * (b - a);
        let (from, to) = ((a - beside).max(first), (b + beside).min(last));
        let mean = |c: &Curve<4>| c.control.iter().map(|h| h[3]).sum::<f64>() / c.control.len() as f64;
        let share = mean(&ends[0]) / mean(&ends[1]);
        let row = |own: &Curve<4>, scale: f64, other: &Curve<4>, other_scale: f64, room: f64| {
            let mut out = own.clone();
            for (h, o) in out.control.iter_mut().zip(&other.control) {
                *h = [0, 1, 2, 3].map(|d: usize| scale * h[d] * (1.0 + room) - other_scale * o[d] * room);
                if !surface.rational {
                    h[3] = 1.0;
                }
            }
            out.restricted(from, to).ok()
        };
        let rows = [row(&ends[0], 1.0, &ends[1], share, room[0])?, row(&ends[1], share, &ends[0], 1.0, room[1])?];
        if rows.iter().flat_map(|r| &r.control).any(|h| h[3] <= 0.0) {
            return None;
        }
        let control: Vec<[f64; 4]> = rows[0].control.iter().zip(&rows[1].control).flat_map(|(p, q)| [*p, *q]).collect();
        let knots_v = Knots::clamped(1, &[0.0, 1.0]).ok()?;
        let rational = control.iter().any(|h| h[3] != 1.0);
        let patch = Surface { knots_u: rows[0].knots.clone(), knots_v, control, rational };
        let along = [lo - room[0] * (hi - lo), (hi - lo) * (1.0 + room[0] + room[1])];
        let map = foot_map(&surface, &patch, swapped, ((lo, hi), along))?;
        let mut out = Self { face, runs: Vec::new(), patch, loops: Vec::new(), map, swapped, along };
        out.follow();
        // What lies beyond an apex is cut away.
        let loops = std::mem::take(&mut out.loops);
        let on = |run: usize, s: f64| out.on(run, s);
        let loops = match room {
            [r, _] if r < 0.0 => cut_off(&loops, (0.0, true), &on)?,
            [_, r] if r < 0.0 => cut_off(&loops, (1.0, false), &on)?,
            _ => loops,
        };
        out.loops = loops;
        (!out.loops.is_empty()).then_some(out)
    }

    /// The border, along the runs of the face in the sense of its parameter plane.
    fn follow(&mut self) {
        let ((a, b), _) = self.patch.domain();
        for mut own in boundary_stretches(self.face) {
            let first = self.runs.len();
            let count = own.len();
            self.runs.append(&mut own);
            let mut sides: Vec<Side> = (first..first + count)
                .map(|k| {
                    let way = if self.face.reversed { [1.0, 0.0] } else { [0.0, 1.0] };
                    Side { way: Way::Curve(k, way), ends: way.map(|s| self.on(k, s)) }
                })
                .collect();
            if self.face.reversed {
                sides.reverse();
            }
            let mut line: Vec<Side> = Vec::new();
            for k in 0..count {
                let (side, then) = (sides[k], sides[(k + 1) % count].ends[0]);
                let [p, q] = [side.ends[1], then];
                let one = (p[0] - q[0]).abs() <= ONE_PLACE * (b - a) && (p[1] - q[1]).abs() <= ONE_PLACE;
                if one {
                    line.push(Side { ends: [side.ends[0], q], ..side });
                } else {
                    line.extend([side, Side { way: Way::Straight, ends: [p, q] }]);
                }
            }
            if !line.is_empty() {
                self.loops.push(line);
            }
        }
    }

    /// Place on the patch of a point of a run.
    fn on(&self, run: usize, s: f64) -> [f64; 2] {
        let (x, uv) = self.runs[run].at(self.face, s);
        let ((a, b), _) = self.patch.domain();
        let [across, along] = if self.swapped { [uv[1], uv[0]] } else { uv };
        let mut at = [across.clamp(a, b), (along - self.along[0]) / self.along[1]];
        for _ in 0..STEPS {
            let j = self.patch.extended_jet(at[0], at[1]);
            let off = x - j.p;
            let (uu, uv, vv) = (j.du.norm_squared(), j.du.dot(&j.dv), j.dv.norm_squared());
            let det = uu * vv - uv * uv;
            let (du, dv) = (j.du.dot(&off), j.dv.dot(&off));
            let step = if det * (b - a).powi(2) > NO_PLACE * vv * vv {
                [(du * vv - dv * uv) / det, (dv * uu - du * uv) / det]
            } else {
                [0.0, dv / vv]
            };
            if !(step[0].is_finite() && step[1].is_finite()) {
                break;
            }
            let next = [(at[0] + step[0].clamp(a - b, b - a)).clamp(a, b), at[1] + step[1]];
            let still = (next[0] - at[0]).abs() <= f64::EPSILON * (b - a) && step[1].abs() <= f64::EPSILON;
            at = next;
            if still {
                break;
            }
        }
        at
    }

    /// The panel, for the label 0 of the face of index 0. Trimming curves stray by `tolerance` (mm) from the file's edges, these in
    /// space once more. `None` where the face falls apart beside its apex or a curve cannot be fitted.
    pub fn panel(&self, name: &str, kind: PanelKind, tolerance: f64) -> Option<Panel> {
        let on = |run: usize, s: f64| self.on(run, s);
        // The outer loop is the one around most; the others turn the other way.
        let mut loops: Vec<(f64, &Vec<Side>)> = self.loops.iter().map(|l| (area(l, &on), l)).collect();
        loops.sort_by(|p, q| q.0.abs().total_cmp(&p.0.abs()));
        if loops[1..].iter().any(|l| l.0 * loops[0].0 > 0.0) {
            return None;
        }
        let coedge = |side: &Side| {
            let trim = self.trimmed(side, tolerance)?;
            let edge = edge(&self.patch, &trim, tolerance).ok()?;
            let number = match side.way {
                Way::Curve(run, _) => run,
                Way::Straight => self.runs.len(),
            };
            let border = Border::Trim { edge: number as u32 };
            Some(Coedge { border, vertices: Vec::new(), parameters: Vec::new(), trim, edge })
        };
        let loops = loops.iter().map(|l| l.1.iter().map(coedge).collect()).collect::<Option<_>>()?;
        let strip = Strip { name: name.to_owned(), kind, patch: self.patch.clone() };
        let trim = PanelTrim { face: 0, label: 0, form: PanelForm::Ruled(self.map.clone()), loops };
        Some(Panel { strip, trim: Some(trim), outline: Vec::new() })
    }

    /// The trimming curve of a side.
    fn trimmed(&self, side: &Side, tolerance: f64) -> Option<Curve<2>> {
        let [p, q] = side.ends;
        let Way::Curve(..) = side.way else {
            let control = (0..4).map(|k| side.at(f64::from(k) / 3.0, &|_, _| p)).collect();
            return Curve::new(3, vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0], control).ok();
        };
        let on = |run: usize, s: f64| self.on(run, s);
        let waypoint = |s: f64| Waypoint { s, place: side.at(s, &on), allowance: tolerance };
        let points = (0..=PLACES).map(|k| waypoint(k as f64 / PLACES as f64)).collect();
        let between = |a: &Waypoint, b: &Waypoint| {
            let s = 0.5 * (a.s + b.s);
            (s > a.s && s < b.s).then(|| waypoint(s))
        };
        let mut curve = trim(&self.patch, points, between).ok()?.curve;
        // Along an end of the patch rounding must not lead beyond it; control points of curves that only touch it may be.
        let (u, v) = self.patch.domain();
        let kept = |x: f64, (lo, hi): (f64, f64)| {
            let near = x.clamp(lo, hi);
            if (x - near).abs() <= ROUNDING * (hi - lo) {
                near
            } else {
                x
            }
        };
        for c in &mut curve.control {
            *c = [kept(c[0], u), kept(c[1], v)];
        }
        let last = curve.control.len() - 1;
        (curve.control[0], curve.control[last]) = (p, q);
        Some(curve)
    }
}

/// Area that a closed line encloses, signed.
fn area(line: &[Side], on: &impl Fn(usize, f64) -> [f64; 2]) -> f64 {
    let places = |s: &Side| (0..PLACES).map(|k| s.at(k as f64 / PLACES as f64, on)).collect::<Vec<_>>();
    let p: Vec<[f64; 2]> = line.iter().flat_map(places).collect();
    (0..p.len()).map(|k| (p[k], p[(k + 1) % p.len()])).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum()
}

/// How far the patch goes on beyond both ends of the rulings, as a share of them: less than nothing beside an apex, not at all
/// where the surface would fold back. `None` where both ends are points.
fn rooms((a, b): (f64, f64), ends: &[Curve<4>; 2], apex: [bool; 2]) -> Option<[f64; 2]> {
    if apex == [true, true] {
        return None;
    }
    let jets: Vec<[[Vec3; 2]; 2]> = (0..PLACES)
        .map(|k| a + (b - a) * (k as f64 + 0.5) / PLACES as f64)
        .map(|u| {
            [0, 1].map(|side: usize| {
                let [h, d, _] = ends[side].jet(u);
                let p = Vec3::new(h[0], h[1], h[2]) / h[3];
                [p, (Vec3::new(d[0], d[1], d[2]) - p * d[3]) / h[3]]
            })
        })
        .collect();
    let room = |side: usize| {
        let folds = jets.iter().any(|j| {
            let w = (j[1][0] - j[0][0]).normalize();
            let across = [0, 1].map(|k: usize| j[k][1] - w * w.dot(&j[k][1]));
            let beyond = across[side] + (across[side] - across[1 - side]) * ROOM;
            beyond.dot(&(across[0] + across[1])) <= 0.0
        });
        match apex[side] {
            true => -BESIDE_APEX,
            false if folds => 0.0,
            false => ROOM,
        }
    };
    Some([room(0), room(1)])
}

/// Where places of the patch are on the face: exact across the rulings, along them at places of the middle one. `reach` is that of
/// the rulings of the face.
fn foot_map(
    surface: &Surface,
    patch: &Surface,
    swapped: bool,
    (reach, along): ((f64, f64), [f64; 2]),
) -> Option<FootMap> {
    let (a, b) = patch.knots_u.domain();
    let middle = 0.5 * (a + b);
    let [p, q] = [0.0, 1.0].map(|r| patch.point(middle, r));
    let noted = (0..=PLACES).map(|k| reach.0 + (reach.1 - reach.0) * k as f64 / PLACES as f64);
    let share = |v: f64| (surface.point(middle, v) - p).dot(&(q - p)) / (q - p).norm_squared();
    // Beyond the face its rulings go on.
    let mut table = vec![(0.0, along[0])];
    table.extend(noted.map(|v| (share(v), v)).filter(|t| t.0 > CLEAR && t.0 < 1.0 - CLEAR));
    table.push((1.0, along[0] + along[1]));
    table.dedup_by(|b, a| b.0 <= a.0);
    let at: Vec<f64> = table.iter().map(|t| t.0).collect();
    let place = |u: f64, v: f64| if swapped { [v, u] } else { [u, v] };
    let control = [a, b].iter().flat_map(|u| table.iter().map(|t| place(*u, t.1))).collect();
    Some(FootMap { knots_s: Knots::clamped(1, &[a, b]).ok()?, knots_t: Knots::clamped(1, &at).ok()?, control })
}
