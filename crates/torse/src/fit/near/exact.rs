//! The torse that a developable piece of surface is: through its rulings and tangent planes, not near its points.
//!
//! *Method* (docs/algorithms/cover.md, "What is developable already"). Rulings with their tangent planes are taken from
//! the surface at places dense enough; their profile, or the planes themselves, become a cubic spline with as many spans
//! as the wanted distance asks for, twice continuously differentiable but where the curvature of the surface jumps.
//! Nothing is optimised; what comes out is measured at samples, and judged elsewhere.

use super::plane::plane;
use super::samples::{error, nearest_error, Fit, Sample};
use crate::brep::rulings::{Rulings, StraightLine};
use crate::geom::{Frame, Vec3};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::lsq;
use crate::torse::form::{CylinderTorse, DualTorse, PanelKind, PrimalTorse, Torse};

/// What is asked of [`exact`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ExactOptions {
    /// Distance (mm) below which more spans are of no use.
    pub goal: f64,
    /// Distance (mm) up to which the torse counts as that of the surface.
    pub accepted: f64,
}

/// Turn of the normal (rad) per span of the first attempt, 3°: the curvature of the spline is then right to 10⁻³.
const STEP: f64 = 0.052;
/// Spans at most, as they are halved.
const MOST_SPANS: usize = 800;
/// Rulings per span.
const PER_SPAN: usize = 8;
/// Rulings between two knots of the surface from which spans are laid.
const COARSE: usize = 32;
/// Angle (rad) between the normals and their mean up to which a plane profile serves best.
const GENTLE: f64 = 0.9;
/// Breadth of a piece of a cone at its narrow end, as a share of that at the other, below which it is pointed.
const POINTED: f64 = 0.02;
/// Share of the rulings beside an apex where nothing is measured: rulings through it are the nearer, the nearer they come to it.
const NEAR_TIP: f64 = 1e-3;
/// Least cosine between rulings and the normal of the profile's plane.
pub(crate) const LEAST_SLANT: f64 = 0.4;
/// The domain reaches this share of its range beyond the outermost rulings.
const MARGIN: f64 = 0.06;
/// Share of the width below which the distance between the first and the last ruling is that of a pipe, nearly closed.
const NEAR: f64 = 0.25;
/// Turn of the normal (rad) below which a stretch is flat.
const FLAT: f64 = 1e-9;
/// Relative deviation below which rulings count as parallel, or as meeting in a point.
const SAME: f64 = 1e-6;
/// More spans that do not bring the error below this share of what it was are of no use.
const BETTER: f64 = 0.7;

/// The torse through the rulings of a developable piece of surface.
///
/// *Input*: rulings as found on the surface; samples of the piece. *Result*: a fit within `accepted` of all samples, whose
/// domain reaches beyond the outermost rulings. `None` where there is none: pieces that are not developable, that turn
/// through half a circle and have an inflection or a flat part but are no cylinders, or whose rulings meet on them.
pub fn exact(rulings: &Rulings, samples: &[Sample], options: &ExactOptions) -> Option<Fit> {
    let flat = plane(samples)?;
    if flat.error <= options.goal {
        return Some(flat);
    }
    let stretches = stretches(rulings)?;
    let lines: Vec<StraightLine> = stretches.iter().flat_map(|s| s.lines.iter().copied()).collect();
    let facing = facing(&lines);
    let steepest = facing.map_or(f64::INFINITY, |f| f.1);
    let profile = |s: &Sampled| over_profile(s, facing?.0);
    let kind = kind(&lines);
    // Planes through one point stay planes through it: near an apex other forms lose it, and feet are lost in rounding.
    let tip = apex(&lines).filter(|_| kind == PanelKind::Cone && is_pointed(rulings));
    let pointed = tip.is_some();
    let near = |s: &Sample, tip: Vec3| (s.x - tip).norm() < NEAR_TIP * lines[0].length;
    let (places, measured): (Vec<usize>, Vec<Sample>) =
        samples.iter().copied().enumerate().filter(|s| !tip.is_some_and(|tip| near(&s.1, tip))).unzip();
    // The way to a tip is against the rulings: patches then begin beside it, and what is close to it is reckoned from there.
    let planes = |s: &Sampled| {
        let torse = of_planes(s)?;
        let first = s.lines.first()?;
        let towards = |tip: Vec3| torse.ruling(torse.domain().0).direction.dot(&(tip - first.point)) > 0.0;
        if tip.is_some_and(towards) {
            of_planes(&s.reversed())
        } else {
            Some(torse)
        }
    };
    let is_cylinder = kind == PanelKind::Cylinder;
    let forms: [(Form, bool); 5] = [
        (&profile, steepest <= GENTLE && !pointed),
        (&planes, true),
        (&profile, pointed || steepest > GENTLE),
        (&|s: &Sampled| polynomial_cylinder(s, rulings), is_cylinder),
        (&cylinder, is_cylinder),
    ];
    let reached = |form: Form| {
        let mut best: Option<Fit> = None;
        let mut finer = 1;
        while let Some(sampled) = Sampled::new(rulings, &stretches, finer) {
            finer *= 2;
            let Some(torse) = form(&sampled) else { break };
            let measure = if sampled.closes() { nearest_error } else { error };
            let Some((error, worst)) = measure(&torse, &measured) else { break };
            let before = best.as_ref().map_or(f64::INFINITY, |b| b.error);
            if error < before {
                best = Some(Fit { torse, kind, error, worst: places[worst] });
            }
            if error <= options.goal || error > BETTER * before || !error.is_finite() {
                break;
            }
        }
        best.filter(|b| b.error <= options.accepted)
    };
    forms.iter().filter(|f| f.1).find_map(|f| reached(f.0))
}

/// Whether rulings come near the point where they meet.
fn is_pointed(rulings: &Rulings) -> bool {
    let (a, b) = rulings.range();
    rulings.breadths(0.5 * (a + b)).is_some_and(|[p, q]| p.min(q) < POINTED * p.max(q))
}

/// A direction from which the normals turn away little, and by how much (rad) they do at most: their mean where that is
/// little, else the middle between the two that are farthest from each other, if it is less. A wave that is steep to one
/// side for longer than to the other has its mean off the middle.
fn facing(lines: &[StraightLine]) -> Option<(Vec3, f64)> {
    let steep = |up: Vec3| (up, lines.iter().map(|l| l.normal.angle(&up)).fold(0.0, f64::max));
    let farthest = |from: &Vec3| lines.iter().map(|l| l.normal).max_by(|a, b| a.angle(from).total_cmp(&b.angle(from)));
    let mean = lines.iter().map(|l| l.normal).sum::<Vec3>().try_normalize(0.0).map(steep);
    if mean.is_some_and(|m| m.1 <= GENTLE) {
        return mean;
    }
    let one = farthest(&mean.map_or(lines.first()?.normal, |m| m.0))?;
    let middle = (one + farthest(&one)?).try_normalize(0.0).map(steep);
    [mean, middle].into_iter().flatten().min_by(|a, b| a.1.total_cmp(&b.1))
}

/// A way to make a torse of rulings.
type Form<'a> = &'a dyn Fn(&Sampled) -> Option<Torse>;

/// The rulings between two knots of the surface.
struct Stretch {
    /// Parameters of the rulings, evenly spaced.
    at: Vec<f64>,
    lines: Vec<StraightLine>,
    /// Turn of the normal from the first ruling to each.
    turn: Vec<f64>,
    /// Whether the curvature jumps at its end.
    jump: bool,
}

fn stretches(rulings: &Rulings) -> Option<Vec<Stretch>> {
    let breaks = rulings.breaks();
    let last = breaks.len() - 2;
    breaks
        .windows(2)
        .enumerate()
        .map(|(i, w)| {
            let at: Vec<f64> = (0..=COARSE).map(|k| w[0] + (w[1] - w[0]) * k as f64 / COARSE as f64).collect();
            let lines = at.iter().map(|&s| rulings.line(s)).collect::<Option<Vec<_>>>()?;
            let mut turn = vec![0.0];
            for l in lines.windows(2) {
                turn.push(turn[turn.len() - 1] + l[0].normal.angle(&l[1].normal));
            }
            Some(Stretch { at, lines, turn, jump: i < last && rulings.bends_anew(w[1]) })
        })
        .collect()
}

/// Rulings dense enough for a spline.
struct Sampled {
    lines: Vec<StraightLine>,
    /// For every inner break of the spline its ruling and its multiplicity.
    breaks: Vec<(usize, usize)>,
}

impl Sampled {
    fn new(rulings: &Rulings, stretches: &[Stretch], finer: usize) -> Option<Self> {
        let mut out = Self { lines: Vec::new(), breaks: Vec::new() };
        for (i, stretch) in stretches.iter().enumerate() {
            let total = stretch.turn[COARSE];
            let spans = if total <= FLAT { 1 } else { ((total / STEP * finer as f64).ceil() as usize).max(finer) };
            if out.breaks.len() + spans > MOST_SPANS {
                return None;
            }
            let cut = |k: usize| stretch.at_turn(total * k as f64 / spans as f64, k as f64 / spans as f64);
            for k in 0..spans {
                let (a, b) = (cut(k), cut(k + 1));
                if i + k > 0 {
                    let double = k == 0 && stretches[i - 1].jump;
                    out.breaks.push((out.lines.len(), 1 + usize::from(double)));
                }
                for j in 0..PER_SPAN {
                    out.lines.push(rulings.line(a + (b - a) * j as f64 / PER_SPAN as f64)?);
                }
            }
        }
        out.lines.push(*stretches.last()?.lines.last()?);
        Some(out)
    }

    /// The cubic spline through values at parameters that increase from ruling to ruling, continued beyond both ends.
    fn spline<const D: usize>(&self, t: &[f64], values: &[[f64; D]]) -> Option<Curve<D>> {
        if t.windows(2).any(|w| w[0] >= w[1]) {
            return None;
        }
        let (a, b) = (t[0], t[t.len() - 1]);
        let mut knots = vec![a; 4];
        for &(ruling, times) in &self.breaks {
            knots.extend(std::iter::repeat_n(t[ruling], times));
        }
        knots.extend([b; 4]);
        let control = knots.len() - 4;
        let knots = Knots::new(3, knots, control).ok()?;
        let curve = lsq::fit(values, t, &knots).ok()?.curve;
        let margin = self.margin(b - a);
        curve.extended(a - margin, b + margin).ok()
    }

    /// How far beyond both ends of a range of this length the spline is continued.
    fn margin(&self, length: f64) -> f64 {
        let span = if self.closes() { length / (self.breaks.len() + 1) as f64 } else { f64::INFINITY };
        span.min(MARGIN * length)
    }

    /// Whether the last ruling comes back near the first: the continuation beyond one end would lie beside the other, less
    /// exact, and be taken for the surface there.
    fn closes(&self) -> bool {
        let (Some(first), Some(last)) = (self.lines.first(), self.lines.last()) else { return false };
        let wide = self.lines.iter().map(|l| (l.point - first.point).norm()).fold(0.0, f64::max);
        (last.point - first.point).norm() < NEAR * wide
    }

    /// The same rulings in the opposite order.
    fn reversed(&self) -> Self {
        let last = self.lines.len() - 1;
        Self {
            lines: self.lines.iter().rev().copied().collect(),
            breaks: self.breaks.iter().rev().map(|&(k, m)| (last - k, m)).collect(),
        }
    }
}

impl Stretch {
    /// Parameter at which the normal has turned through `turn`; on flat stretches at the share `even` of the range.
    fn at_turn(&self, turn: f64, even: f64) -> f64 {
        let (first, last) = (self.at[0], self.at[COARSE]);
        if self.turn[COARSE] <= FLAT {
            return first + (last - first) * even;
        }
        let k = self.turn.partition_point(|&x| x < turn).clamp(1, COARSE);
        let (x, y) = (self.turn[k - 1], self.turn[k]);
        let share = if y > x { ((turn - x) / (y - x)).clamp(0.0, 1.0) } else { 1.0 };
        self.at[k - 1] + (self.at[k] - self.at[k - 1]) * share
    }
}

/// The torse over the profile in the plane square to the rulings' mean direction, heights along `up`.
fn over_profile(sampled: &Sampled, up: Vec3) -> Option<Torse> {
    let y = sampled.lines.iter().map(|l| l.direction).sum::<Vec3>().try_normalize(0.0)?;
    let z = (up - y * up.dot(&y)).try_normalize(0.0)?;
    let origin = sampled.lines.iter().map(|l| l.point).sum::<Vec3>() / sampled.lines.len() as f64;
    let frame = Frame { origin, x: y.cross(&z), y, z };
    if sampled.lines.iter().any(|l| l.direction.dot(&y) < LEAST_SLANT) {
        return None;
    }
    let crossing = |l: &StraightLine| {
        let (p, d) = (frame.to_local(&l.point), frame.vector_to_local(&l.direction));
        let q = p - d * (p.y / d.y);
        (q.x, [q.z, d.x / d.y], d.z / d.y)
    };
    let ends = [sampled.lines.first()?, sampled.lines.last()?].map(|l| crossing(l).0);
    let reversed = (ends[0] > ends[1]).then(|| sampled.reversed());
    let sampled = reversed.as_ref().unwrap_or(sampled);
    let crossings: Vec<_> = sampled.lines.iter().map(crossing).collect();
    let t: Vec<f64> = crossings.iter().map(|c| c.0).collect();
    let values: Vec<[f64; 2]> = crossings.iter().map(|c| c.1).collect();
    let torse = PrimalTorse::new(frame, sampled.spline(&t, &values)?, 0.0);
    // The slope of the rulings follows from profile and directions but for a constant: its mean over all spans.
    let rest: Vec<f64> = crossings.iter().step_by(PER_SPAN).map(|c| c.2 - torse.functions(c.0)[5]).collect();
    let mean = rest.iter().sum::<f64>() / rest.len() as f64;
    Some(Torse::Primal(PrimalTorse::new(frame, torse.profile().clone(), mean)))
}

/// The torse as the envelope of the tangent planes, over the turn of their normal.
fn of_planes(sampled: &Sampled) -> Option<Torse> {
    let mut t = vec![0.0];
    let mut sense = 0.0_f64;
    for w in sampled.lines.windows(2) {
        // A turn one way and then the other is an inflection, none at all a flat part.
        let way = w[0].normal.cross(&w[1].normal).dot(&w[0].direction);
        if way == 0.0 || way * sense < 0.0 {
            return None;
        }
        sense = way;
        t.push(t[t.len() - 1] + w[0].normal.angle(&w[1].normal));
    }
    let plane = |l: &StraightLine| [l.normal.x, l.normal.y, l.normal.z, l.normal.dot(&l.point)];
    let values: Vec<[f64; 4]> = sampled.lines.iter().map(plane).collect();
    Some(Torse::Dual(DualTorse { planes: sampled.spline(&t, &values)? }))
}

/// The frame of a cylinder: rulings along y, the first of them with its normal along z.
fn cylinder_frame(sampled: &Sampled) -> Option<Frame> {
    let first = sampled.lines.first()?;
    let y = sampled.lines.iter().map(|l| l.direction).sum::<Vec3>().try_normalize(0.0)?;
    let x = y.cross(&first.normal).try_normalize(0.0)?;
    let origin = sampled.lines.iter().map(|l| l.point).sum::<Vec3>() / sampled.lines.len() as f64;
    Some(Frame { origin, x, y, z: x.cross(&y) })
}

/// The cylinder over the profile in the plane square to the rulings, over the length of its chords.
fn cylinder(sampled: &Sampled) -> Option<Torse> {
    let frame = cylinder_frame(sampled)?;
    let points: Vec<[f64; 2]> = sampled.lines.iter().map(|l| section(&frame, &l.point)).collect();
    let mut t = vec![0.0];
    for w in points.windows(2) {
        t.push(t[t.len() - 1] + (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]));
    }
    Some(Torse::Cylinder(CylinderTorse { frame, profile: sampled.spline(&t, &points)? }))
}

/// The cylinder of a surface whose profile is a cubic already, or of a lower degree, and has no corners: with that profile
/// itself, over parameters that are about its length.
fn polynomial_cylinder(sampled: &Sampled, rulings: &Rulings) -> Option<Torse> {
    let frame = cylinder_frame(sampled)?;
    let mut middle = rulings.middle()?;
    while middle.knots.degree() < 3 {
        middle = middle.elevated().ok()?;
    }
    let ((a, b), (lo, hi)) = (rulings.range(), middle.domain());
    let corner = middle.knots.distinct().iter().any(|&(s, times)| s > lo && s < hi && times > 2);
    if middle.knots.degree() > 3 || corner {
        return None;
    }
    let length: f64 = sampled.lines.windows(2).map(|w| (w[1].point - w[0].point).norm()).sum();
    let margin = sampled.margin(b - a);
    let middle = middle.extended(a - margin, b + margin).ok()?;
    let knots = middle.knots.values().iter().map(|s| (s - a) * length / (b - a)).collect();
    let control = middle.control.iter().map(|&[x, y, z]| section(&frame, &Vec3::new(x, y, z))).collect();
    Some(Torse::Cylinder(CylinderTorse { frame, profile: Curve::new(3, knots, control).ok()? }))
}

/// A point in the plane square to the rulings.
fn section(frame: &Frame, x: &Vec3) -> [f64; 2] {
    let p = frame.to_local(x);
    [p.x, p.z]
}

/// What rulings make up: parallel ones a cylinder, those through a point a cone.
fn kind(lines: &[StraightLine]) -> PanelKind {
    let mean = lines.iter().map(|l| l.direction).sum::<Vec3>();
    if lines.iter().all(|l| l.direction.cross(&mean).norm() <= SAME * mean.norm()) {
        return PanelKind::Cylinder;
    }
    apex(lines).map_or(PanelKind::Torse, |_| PanelKind::Cone)
}

/// The point where all lines meet.
fn apex(lines: &[StraightLine]) -> Option<Vec3> {
    // The point nearest to all lines: Σ(1 − d dᵀ)(x − p) = 0.
    let mut matrix = nalgebra::Matrix3::zeros();
    let mut right = Vec3::zeros();
    for l in lines {
        let square = nalgebra::Matrix3::identity() - l.direction * l.direction.transpose();
        matrix += square;
        right += square * l.point;
    }
    let apex = matrix.lu().solve(&right)?;
    let off = |l: &StraightLine| ((apex - l.point).cross(&l.direction).norm(), (apex - l.point).norm());
    lines.iter().map(off).all(|(off, reach)| off <= SAME * reach).then_some(apex)
}
