//! Surfaces and torses for the tests of this floor, and a measurement by brute force.

use crate::brep::face::Face;
use crate::geom::{Frame, Vec3};
use crate::patchwork::panel::{Border, Coedge, Panel, PanelForm, PanelTrim, Patchwork};
use crate::patchwork::partition::Partition;
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use crate::torse::form::{CylinderTorse, DualTorse, PanelKind, PrimalTorse, Torse};
use crate::torse::strip::Strip;
use nalgebra::DMatrix;

fn greville(k: &Knots) -> Vec<f64> {
    let (p, v) = (k.degree(), k.values());
    (0..k.control_count()).map(|i| v[i + 1..=i + p].iter().sum::<f64>() / p as f64).collect()
}

fn collocation(k: &Knots, at: &[f64]) -> DMatrix<f64> {
    let mut m = DMatrix::zeros(at.len(), k.control_count());
    for (r, &t) in at.iter().enumerate() {
        let b = k.basis(t, 0);
        for j in 0..=k.degree() {
            m[(r, b.first + j)] = b.rows[0][j];
        }
    }
    m
}

/// The strip between two rails without inner knots, from their control points.
pub fn strip(a: &[[f64; 3]], b: &[[f64; 3]]) -> Strip {
    let n = a.len();
    let knots = [vec![0.0; n], vec![1.0; n]].concat();
    let side = |p: &[[f64; 3]]| Curve::new(n - 1, knots.clone(), p.to_vec()).expect("a curve");
    Strip::polynomial("s", PanelKind::Torse, &side(a), &side(b)).expect("a strip")
}

/// The spline surface through `f` at the Greville points.
pub(crate) fn interpolant(ku: &Knots, kv: &Knots, f: &dyn Fn(f64, f64) -> Vec3) -> Surface {
    let (gu, gv) = (greville(ku), greville(kv));
    let iu = collocation(ku, &gu).try_inverse().expect("regular");
    let iv = collocation(kv, &gv).try_inverse().expect("regular");
    let mut points = vec![Vec3::zeros(); gu.len() * gv.len()];
    for d in 0..3 {
        let values = DMatrix::from_fn(gu.len(), gv.len(), |i, j| f(gu[i], gv[j])[d]);
        let c = &iu * values * iv.transpose();
        for i in 0..gu.len() {
            for j in 0..gv.len() {
                points[i * gv.len() + j][d] = c[(i, j)];
            }
        }
    }
    Surface::new(ku.clone(), kv.clone(), &points, None).expect("surface")
}

/// The spline curve through `f` at the Greville points.
pub fn curve<const D: usize>(k: &Knots, f: &dyn Fn(f64) -> [f64; D]) -> Curve<D> {
    let g = greville(k);
    let inverse = collocation(k, &g).try_inverse().expect("regular");
    let mut control = vec![[0.0; D]; g.len()];
    for d in 0..D {
        let c = &inverse * DMatrix::from_fn(g.len(), 1, |i, _| f(g[i])[d]);
        for i in 0..g.len() {
            control[i][d] = c[(i, 0)];
        }
    }
    Curve::new(k.degree(), k.values().to_vec(), control).expect("curve")
}

/// A frame that is not axis-parallel.
pub(crate) fn tilted_frame() -> Frame {
    let z = Vec3::new(0.3, -0.2, 0.9).normalize();
    let x = Vec3::new(1.0, 0.5, 0.0).cross(&z).cross(&z).normalize() * -1.0;
    let x = (x - z * x.dot(&z)).normalize();
    Frame { origin: Vec3::new(40.0, -20.0, 10.0), x, y: z.cross(&x), z }
}

/// Profile `f = .3 t² − .1 t³` with an inflection at t = 1, ruling slopes `a = .1 + .2 t`; t ∈ [−.3, 1.6].
pub fn primal() -> PrimalTorse {
    let knots = Knots::clamped(3, &[-0.3, 0.2, 0.8, 1.6]).expect("knots");
    let profile = curve(&knots, &|t| [0.3 * t * t - 0.1 * t * t * t, 0.1 + 0.2 * t]);
    PrimalTorse::new(tilted_frame(), profile, 0.05)
}

/// A cylinder over a meander `(3 t − 4 sin 2t, 6 sin t)` that turns far to both sides of its inflection at t = 0.
pub fn cylinder() -> CylinderTorse {
    let knots = Knots::uniform(3, 16, -2.2, 2.2).expect("knots");
    let profile = curve(&knots, &|t| [3.0 * t - 4.0 * (2.0 * t).sin(), 6.0 * t.sin()]);
    CylinderTorse { frame: tilted_frame(), profile }
}

/// Point of [`primal`] in world coordinates, from the closed form.
pub(crate) fn primal_point(t: f64, y: f64) -> Vec3 {
    let f = 0.3 * t * t - 0.1 * t * t * t;
    let a = 0.1 + 0.2 * t;
    let integral = |t: f64| 0.2 * (0.3 * t * t - 0.1 * t * t * t);
    let g = 0.05 + integral(t) - integral(-0.3);
    tilted_frame().to_world(&Vec3::new(t + y * a, y, f + y * g))
}

/// A surface within `bump` of [`primal`]: the torse over t ∈ [0, 1.3], y ∈ [−.4, .4], plus a wave along the frame's z.
pub(crate) fn near_primal(bump: f64) -> Surface {
    let knots = Knots::clamped(3, &[0.0, 0.3, 0.6, 1.0]).expect("knots");
    interpolant(&knots, &knots, &|u, v| {
        primal_point(1.3 * u, 0.8 * v - 0.4) + tilted_frame().z * (bump * (7.0 * u + 2.0 * v).sin() * (3.0 * v).cos())
    })
}

/// A dual torse near the sphere of radius 5 about the origin: tangent planes along a small circle.
pub fn dual() -> DualTorse {
    let knots = Knots::uniform(3, 12, -0.1, 1.1).expect("knots");
    let planes = curve(&knots, &|t| {
        let (s, c) = t.sin_cos();
        let n = Vec3::new(c * 0.9f64.cos(), s * 0.9f64.cos(), 0.9f64.sin());
        [n.x, n.y, n.z, 5.0]
    });
    DualTorse { planes }
}

/// The sphere of radius 5 as a rational biquadratic: longitude 0 to 1, latitude .9 ± `half`.
pub(crate) fn sphere_strip(half: f64) -> Surface {
    // Circular arcs as rational quadratics; control points of an arc of half-angle b about the middle direction.
    let arc = |middle: f64, b: f64| {
        let w = b.cos();
        [(middle - b, 1.0, 1.0), (middle, 1.0 / w, w), (middle + b, 1.0, 1.0)]
    };
    let k = Knots::clamped(2, &[0.0, 1.0]).expect("knots");
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for (a, ra, wa) in arc(0.5, 0.5) {
        for (b, rb, wb) in arc(0.9, half) {
            let (r, z) = (5.0 * rb * b.cos(), 5.0 * rb * b.sin());
            points.push(Vec3::new(r * ra * a.cos(), r * ra * a.sin(), z));
            weights.push(wa * wb);
        }
    }
    Surface::new(k.clone(), k, &points, Some(&weights)).expect("surface")
}

/// Triangles of an nu × nv grid over the whole domain, with lines at the knots.
pub fn grid(s: &Surface, nu: usize, nv: usize) -> Vec<[[f64; 2]; 3]> {
    let lines = |k: &Knots, n: usize| {
        let mut out = Vec::new();
        for w in k.breaks().windows(2) {
            out.extend((0..n).map(|i| w[0] + (w[1] - w[0]) * i as f64 / n as f64));
        }
        out.push(k.domain().1);
        out
    };
    let (us, vs) = (lines(&s.knots_u, nu), lines(&s.knots_v, nv));
    let mut out = Vec::new();
    for a in us.windows(2) {
        for b in vs.windows(2) {
            let (p, q, r, t) = ([a[0], b[0]], [a[1], b[0]], [a[1], b[1]], [a[0], b[1]]);
            out.push([p, q, r]);
            out.push([p, r, t]);
        }
    }
    out
}

/// Distance from `x` to the nearest of densely sampled rulings, refined by golden section.
pub(crate) fn brute_distance(torse: &Torse, x: &Vec3) -> f64 {
    let (t0, t1) = torse.domain();
    let to_line = |t: f64| {
        let r = torse.ruling(t);
        (x - r.point).cross(&r.direction).norm()
    };
    let n = 400;
    let place = |i: usize| t0 + (t1 - t0) * i as f64 / n as f64;
    let best = (0..=n).min_by(|&i, &j| to_line(place(i)).total_cmp(&to_line(place(j)))).expect("places");
    let (mut a, mut b) = (place(best.saturating_sub(1)), place((best + 1).min(n)));
    for _ in 0..60 {
        let (c, d) = (a + 0.382 * (b - a), a + 0.618 * (b - a));
        if to_line(c) < to_line(d) {
            b = d;
        } else {
            a = c;
        }
    }
    to_line(0.5 * (a + b))
}

/// Largest [`brute_distance`] over points spread on triangles.
pub(crate) fn brute_sup(s: &Surface, torse: &Torse, triangles: &[[[f64; 2]; 3]], per_triangle: usize) -> f64 {
    let mut sup = 0.0f64;
    let n = per_triangle;
    for t in triangles {
        for i in 0..=n {
            for j in 0..=n - i {
                let w = [i as f64 / n as f64, j as f64 / n as f64];
                let w = [w[0], w[1], 1.0 - w[0] - w[1]];
                let uv = [0, 1].map(|d| (0..3).map(|k| w[k] * t[k][d]).sum::<f64>());
                sup = sup.max(brute_distance(torse, &s.point(uv[0], uv[1])));
            }
        }
    }
    sup
}

/// A ruled patch through two rational curves that are polynomials of `degree` (homogeneous) between breaks.
pub fn ruled_patch(degree: usize, breaks: &[f64], end: &dyn Fn(f64, usize) -> [f64; 4]) -> Surface {
    let mut knots = vec![breaks[0]; degree + 1];
    for &b in &breaks[1..breaks.len() - 1] {
        knots.extend(std::iter::repeat_n(b, degree));
    }
    knots.extend(std::iter::repeat_n(breaks[breaks.len() - 1], degree + 1));
    let spans = breaks.len() - 1;
    let ku = Knots::new(degree, knots, degree * spans + 1).expect("knots");
    let kv = Knots::clamped(1, &[0.0, 1.0]).expect("knots");
    let unit = Knots::clamped(degree, &[0.0, 1.0]).expect("knots");
    let mut points = vec![Vec3::zeros(); 2 * (degree * spans + 1)];
    let mut weights = vec![1.0; points.len()];
    for (i, w) in breaks.windows(2).enumerate() {
        for e in 0..2 {
            let piece = curve(&unit, &|s| end(w[0] + s * (w[1] - w[0]), e));
            for (k, c) in piece.control.iter().enumerate() {
                points[2 * (degree * i + k) + e] = Vec3::new(c[0], c[1], c[2]) / c[3];
                weights[2 * (degree * i + k) + e] = c[3];
            }
        }
    }
    let exact = weights.iter().all(|w| (w - 1.0).abs() < 1e-12);
    Surface::new(ku, kv, &points, (!exact).then_some(&weights)).expect("patch")
}

/// Range of the ruling coordinate y covered by the patches of [`primal_patch`].
pub(crate) const PATCH_Y: [f64; 2] = [-0.6, 0.6];

/// The exported patch of [`primal`] over t ∈ [−.2, 1.5].
pub(crate) fn primal_patch() -> Surface {
    ruled_patch(5, &[-0.2, 0.2, 0.8, 1.5], &|t, e| {
        let p = primal_point(t, PATCH_Y[e]);
        [p.x, p.y, p.z, 1.0]
    })
}

/// The exported patch of [`cylinder`], as long as that of [`primal`].
pub(crate) fn cylinder_patch() -> Surface {
    let c = cylinder();
    ruled_patch(3, &c.profile.knots.breaks(), &|t, e| {
        let [x, z] = c.profile.point(t);
        let p = c.frame.to_world(&Vec3::new(x, PATCH_Y[e], z));
        [p.x, p.y, p.z, 1.0]
    })
}

/// The exported patch of [`dual`] over t ∈ [0, 1], between the planes z = 3 and z = 4.5.
pub(crate) fn dual_patch() -> Surface {
    let d = dual();
    let breaks: Vec<f64> = d.planes.knots.breaks().into_iter().filter(|t| (-1e-9..=1.0 + 1e-9).contains(t)).collect();
    ruled_patch(4, &breaks, &|t, e| {
        let j = d.planes.jet(t);
        let n = Vec3::new(j[0][0], j[0][1], j[0][2]);
        let m = Vec3::new(j[1][0], j[1][1], j[1][2]);
        let (a, alpha) = (Vec3::z(), [3.0, 4.5][e]);
        let x = m.cross(&a) * j[0][3] + a.cross(&n) * j[1][3] + n.cross(&m) * alpha;
        let w = n.cross(&m).dot(&a);
        [x.x, x.y, x.z, w]
    })
}

/// Foot of a point of [`near_primal`] as (t, r) on [`primal_patch`].
pub(crate) fn primal_foot(x: &Vec3) -> [f64; 2] {
    let torse = Torse::Primal(primal());
    let q = tilted_frame().to_local(x);
    let t = torse.foot(x, q.x).expect("a foot");
    let n = torse.ruling(t).normal;
    let y = tilted_frame().to_local(&(x - n * torse.plane_distance(x, t))).y;
    [t, (y - PATCH_Y[0]) / (PATCH_Y[1] - PATCH_Y[0])]
}

/// A patchwork of [`near_primal`] in two panels on either side of v = .5 with a common torse, on an `n`-fold grid.
#[expect(clippy::too_many_lines, reason = "one patchwork, part by part")]
pub(crate) fn two_panels(bump: f64, n: usize) -> Patchwork {
    let surface = near_primal(bump);
    let lines = |k: &Knots| {
        let b = k.breaks();
        let mut out: Vec<f64> =
            b.windows(2).flat_map(|w| (0..n).map(move |i| w[0] + (w[1] - w[0]) * i as f64 / n as f64)).collect();
        out.push(b[b.len() - 1]);
        out.push(0.5);
        out.sort_by(f64::total_cmp);
        out.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        out
    };
    let (us, vs) = (lines(&surface.knots_u), lines(&surface.knots_v));
    let middle = vs.iter().position(|v| (v - 0.5).abs() < 1e-9).expect("a line at the middle");
    let (nu, nv) = (us.len(), vs.len());
    let index = |i: usize, j: usize| (i * nv + j) as u32;
    let mut partition = Partition::default();
    for &u in &us {
        partition.vertices.extend(vs.iter().map(|&v| [u, v]));
    }
    for i in 0..nu - 1 {
        for j in 0..nv - 1 {
            let (a, b, c, d) = (index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1));
            partition.triangles.extend([[a, b, c], [a, c, d]]);
            partition.labels.extend([u32::from(j >= middle); 2]);
        }
    }
    let along_u = |j: usize| (0..nu).map(|i| index(i, j)).collect::<Vec<_>>();
    let along_v = |i: usize, from: usize, to: usize| (from..=to).map(|j| index(i, j)).collect::<Vec<_>>();
    let reversed = |v: Vec<u32>| v.into_iter().rev().collect::<Vec<_>>();
    let patch = primal_patch();
    let foot = |uv: [f64; 2]| primal_foot(&surface.point(uv[0], uv[1]));
    let run = |border: Border, vertices: Vec<u32>| {
        let at = |k: u32| partition.vertices[k as usize];
        let (a, b) = (at(vertices[0]), at(vertices[vertices.len() - 1]));
        let length = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).abs() + (p[1] - q[1]).abs();
        let parameters: Vec<f64> = vertices.iter().map(|&k| length(at(k), a) / length(a, b)).collect();
        let on = |s: f64| [a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])];
        let knots = Knots::uniform(3, 24, 0.0, 1.0).expect("knots");
        let mut trim = curve(&knots, &|s| foot(on(s)));
        let last = trim.control.len() - 1;
        (trim.control[0], trim.control[last]) = (foot(a), foot(b));
        let edge = curve(&knots, &|s| {
            let q = trim.point(s);
            let p = patch.point(q[0], q[1]);
            [p.x, p.y, p.z]
        });
        Coedge { border, vertices, parameters, trim, edge }
    };
    let trim = |edge| Border::Trim { edge };
    let seam = |forward| Border::Seam { seam: 0, forward };
    let loops = [
        vec![
            run(trim(0), reversed(along_v(0, 0, middle))),
            run(trim(3), along_u(0)),
            run(trim(1), along_v(nu - 1, 0, middle)),
            run(seam(true), reversed(along_u(middle))),
        ],
        vec![
            run(trim(0), reversed(along_v(0, middle, nv - 1))),
            run(seam(false), along_u(middle)),
            run(trim(1), along_v(nu - 1, middle, nv - 1)),
            run(trim(2), reversed(along_u(nv - 1))),
        ],
    ];
    let mut loops = loops.into_iter();
    let panels = (0..2)
        .map(|label| Panel {
            strip: Strip { name: format!("A-{label}"), kind: PanelKind::Torse, patch: primal_patch() },
            trim: Some(PanelTrim {
                face: 0,
                label,
                form: PanelForm::Torse(Torse::Primal(primal())),
                loops: vec![loops.next().expect("two loops")],
            }),
            outline: Vec::new(),
        })
        .collect();
    Patchwork {
        faces: vec![Face::untrimmed(surface.clone())],
        partitions: vec![partition.clone()],
        panels,
        seam_count: 1,
        joint_count: 0,
    }
}
