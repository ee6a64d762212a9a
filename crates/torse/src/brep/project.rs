//! Nearest points on surfaces: Newton steps on the squared distance inside a box, from sampled starts.
//!
//! Method: Piegl & Tiller, The NURBS Book (1997), section 6.1, with the Gauss–Newton matrix where the full Hessian is
//! not positive definite, step halving, and parameters held at the border while the distance falls outward.

use crate::geom::Vec3;
use crate::spline::surface::Surface;

/// Newton steps before giving up; convergence is quadratic and usually takes 5.
const STEPS: usize = 60;
/// Halved steps below this share of the domain vanish in the rounding of its parameters.
const VANISHED: f64 = 1e-16;
/// Share of the product of both speeds below which the determinant of the full Hessian is that of a fold: near a focal
/// point the Gauss–Newton matrix leads on.
const DEFINITE: f64 = 1e-6;
/// Share of the product of both diagonal terms that is added where the two directions are nearly dependent (poles,
/// slivers) …
const DAMPING: f64 = 1e-12;
/// … and share of it below which the determinant is rounding: then one direction is followed alone.
const SINGULAR: f64 = 1e-14;

/// A nearest point found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// Parameters.
    pub at: [f64; 2],
    /// Distance, mm.
    pub distance: f64,
}

/// Nearest points on one surface: holds the samples from which searches start.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SurfaceProjector {
    us: Vec<f64>,
    vs: Vec<f64>,
    points: Vec<Vec3>,
}

/// Samples per direction at least: patches of one span still bend, and meet themselves at seams.
const FEWEST_SAMPLES: usize = 12;
/// Newton steps are cut to this share of the domain: near poles and folds longer ones end anywhere.
const LONGEST_STEP: f64 = 0.25;
/// A side shorter than this share of the surface is a point.
const COLLAPSED: f64 = 1e-7;
/// Samples per direction at most; keeps the search linear in the size of huge nets.
const MOST_SAMPLES: usize = 160;

impl SurfaceProjector {
    /// Samples a surface.
    pub fn new(surface: &Surface) -> Self {
        let grid = |knots: &crate::spline::knots::Knots| {
            let breaks = knots.breaks();
            let spans = breaks.len().saturating_sub(1).max(1);
            let wanted = (2 * knots.degree().min(4)).max(FEWEST_SAMPLES.div_ceil(spans));
            let per_span = wanted.min(MOST_SAMPLES / spans).max(1);
            let mut out = Vec::new();
            for w in breaks.windows(2) {
                out.extend((0..per_span).map(|i| w[0] + (w[1] - w[0]) * i as f64 / per_span as f64));
            }
            out.push(knots.domain().1);
            out
        };
        let (mut us, mut vs) = (grid(&surface.knots_u), grid(&surface.knots_v));
        // On a side that is a point, steps along it say nothing; its samples move a little inside.
        let size = surface.bbox().diagonal();
        let collapsed = |side: &dyn Fn(f64) -> Vec3, along: &[f64]| {
            let first = side(along[0]);
            along.iter().all(|&t| (side(t) - first).norm() <= COLLAPSED * size)
        };
        let (n, m) = (us.len(), vs.len());
        let sides = [
            collapsed(&|v| surface.point(us[0], v), &vs),
            collapsed(&|v| surface.point(us[n - 1], v), &vs),
            collapsed(&|u| surface.point(u, vs[0]), &us),
            collapsed(&|u| surface.point(u, vs[m - 1]), &us),
        ];
        for (grid, ends) in [(&mut us, [sides[0], sides[1]]), (&mut vs, [sides[2], sides[3]])] {
            let k = grid.len();
            if ends[0] {
                grid[0] += 0.01 * (grid[1] - grid[0]);
            }
            if ends[1] {
                grid[k - 1] -= 0.01 * (grid[k - 1] - grid[k - 2]);
            }
        }
        let points =
            us.iter().flat_map(|&u| vs.iter().map(move |&v| (u, v))).map(|(u, v)| surface.point(u, v)).collect();
        Self { us, vs, points }
    }

    /// A nearest point of the whole surface: the best samples that are local minima, refined.
    pub fn nearest(&self, surface: &Surface, x: &Vec3) -> Foot {
        let (n, m) = (self.us.len(), self.vs.len());
        let d: Vec<f64> = self.points.iter().map(|p| (p - x).norm_squared()).collect();
        let mut starts: Vec<(f64, usize)> = Vec::new();
        for i in 0..n {
            for j in 0..m {
                let here = d[i * m + j];
                let lowest = (i.saturating_sub(1)..=(i + 1).min(n - 1))
                    .all(|a| (j.saturating_sub(1)..=(j + 1).min(m - 1)).all(|b| d[a * m + b] >= here));
                if lowest {
                    starts.push((here, i * m + j));
                }
            }
        }
        starts.sort_by(|p, q| p.0.total_cmp(&q.0));
        let mut best: Option<Foot> = None;
        for &(_, k) in starts.iter().take(8) {
            let foot = refine(surface, x, [self.us[k / m], self.vs[k % m]]);
            if best.is_none_or(|b| foot.distance < b.distance) {
                best = Some(foot);
            }
        }
        best.unwrap_or_else(|| refine(surface, x, [self.us[0], self.vs[0]]))
    }
}

/// Improves the parameters `start` of a point of `surface` near `x`, inside the domain.
pub fn refine(surface: &Surface, x: &Vec3, start: [f64; 2]) -> Foot {
    let ((u0, u1), (v0, v1)) = surface.domain();
    let (lo, hi) = ([u0, v0], [u1, v1]);
    let mut q = [start[0].clamp(u0, u1), start[1].clamp(v0, v1)];
    let mut jet = surface.jet(q[0], q[1]);
    let mut best = (jet.p - x).norm_squared();
    for _ in 0..STEPS {
        let r = jet.p - x;
        let g = [r.dot(&jet.du), r.dot(&jet.dv)];
        let first = [jet.du.norm_squared(), jet.du.dot(&jet.dv), jet.dv.norm_squared()];
        let full = [first[0] + r.dot(&jet.duu), first[1] + r.dot(&jet.duv), first[2] + r.dot(&jet.dvv)];
        let determinant = full[0] * full[2] - full[1] * full[1];
        let definite = full[0] > 0.0 && determinant > DEFINITE * first[0] * first[2];
        let h = if definite { full } else { first };
        let held = [0, 1].map(|k| (q[k] <= lo[k] && g[k] > 0.0) || (q[k] >= hi[k] && g[k] < 0.0));
        let mut step = newton_step(h, g, held);
        let over = (0..2).map(|k| step[k].abs() / (LONGEST_STEP * (hi[k] - lo[k]))).fold(1.0, f64::max);
        step = [step[0] / over, step[1] / over];
        let mut moved = false;
        for _ in 0..25 {
            let next = [(q[0] + step[0]).clamp(lo[0], hi[0]), (q[1] + step[1]).clamp(lo[1], hi[1])];
            let j = surface.jet(next[0], next[1]);
            let d = (j.p - x).norm_squared();
            if d < best {
                (q, jet, best, moved) = (next, j, d, true);
                break;
            }
            step = [0.5 * step[0], 0.5 * step[1]];
            if (0..2).all(|k| step[k].abs() <= VANISHED * (hi[k] - lo[k])) {
                break;
            }
        }
        if !moved {
            break;
        }
    }
    Foot { at: q, distance: best.sqrt() }
}

/// Solves `h s = −g` for the parameters that are not held.
fn newton_step(h: [f64; 3], g: [f64; 2], held: [bool; 2]) -> [f64; 2] {
    let single = |a: f64, b: f64| if a > 0.0 { -b / a } else { 0.0 };
    match held {
        [true, true] => [0.0, 0.0],
        [true, false] => [0.0, single(h[2], g[1])],
        [false, true] => [single(h[0], g[0]), 0.0],
        [false, false] => {
            // A little damping where the two directions are nearly dependent (poles, slivers).
            let d = h[0] * h[2] * (1.0 + DAMPING) - h[1] * h[1];
            if d > SINGULAR * h[0] * h[2] {
                [(h[1] * g[1] - h[2] * g[0]) / d, (h[1] * g[0] - h[0] * g[1]) / d]
            } else if h[0] >= h[2] {
                [single(h[0], g[0]), 0.0]
            } else {
                [0.0, single(h[2], g[1])]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::knots::Knots;

    #[test]
    fn feet_near_a_pole_are_found() {
        let k = Knots::new(1, vec![0., 0., 1., 1.], 2).expect("knots");
        let b = Knots::uniform(2, 1, 0.0, 1.0).expect("knots");
        // A fan around the origin over three quarters of a turn: control points (i, j), j along the fan.
        let p = [Vec3::zeros(); 3].into_iter().chain([Vec3::x(), Vec3::new(-2.0, 2.0, 0.3), -Vec3::y()]);
        let s = Surface::new(k, b, &p.collect::<Vec<_>>(), None).expect("surface");
        let projector = SurfaceProjector::new(&s);
        for v in [0.02, 0.5, 0.97] {
            let foot = projector.nearest(&s, &s.point(1e-3, v));
            assert!(foot.distance < 1e-12, "{v}: {foot:?}");
        }
    }

    #[test]
    fn feet_around_the_apex_of_a_cone_are_found() {
        use crate::brep::support_surface::SupportSurface;
        use crate::geom::Frame;
        let cone = SupportSurface::Cone { frame: Frame::world(), radius: 10.0, slope: -0.4 };
        let (s, map) = cone.to_spline((0.0, std::f64::consts::TAU), (0.0, 25.0)).expect("a cone");
        let projector = SurfaceProjector::new(&s);
        for i in 0..200 {
            let (u, v) = (f64::from(i) * 0.0314, 25.0 - 25.0 * 0.95_f64.powi(i));
            let x = cone.jet([u, v]).p;
            let foot = projector.nearest(&s, &x);
            assert!(foot.distance < 1e-9, "{i} at {u}, {v} (spline {}): {foot:?}", map[0].forward(u));
        }
    }

    #[test]
    fn feet_are_nearest_also_from_outside_the_border() {
        let k = Knots::uniform(3, 2, 0.0, 1.0).expect("knots");
        let mut pts = Vec::new();
        for i in 0..5 {
            for j in 0..5 {
                pts.push(Vec3::new(i as f64, j as f64, ((i * j) as f64 * 0.4).sin()));
            }
        }
        let s = Surface::new(k.clone(), k, &pts, None).expect("surface");
        let projector = SurfaceProjector::new(&s);
        for (u, v, off) in [(0.2, 0.8, 0.1), (0.5, 0.5, -0.2), (0.9, 0.05, 0.3)] {
            let j = s.jet(u, v);
            let foot = projector.nearest(&s, &(j.p + j.normal().normalize() * off));
            assert!((foot.at[0] - u).abs() < 1e-9 && (foot.at[1] - v).abs() < 1e-9);
            assert!((foot.distance - off.abs()).abs() < 1e-12);
        }
        // A point beyond the side u = 0 has its foot on that side.
        let x = Vec3::new(-1.0, 2.0, 0.0);
        let foot = projector.nearest(&s, &x);
        assert!(foot.at[0] <= 0.0);
        for i in 0..=200 {
            assert!((s.point(0.0, i as f64 / 200.0) - x).norm() >= foot.distance - 1e-12);
        }
    }
}
