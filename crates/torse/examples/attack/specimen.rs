//! Random surfaces near torses, each with a panel made by hand: nothing of the library's fits is used.

use crate::random::Random;
use nalgebra::DMatrix;
use torse::brep::face::Face;
use torse::geom::{Frame, Vec3};
use torse::patchwork::panel::{Border, Coedge, Panel, PanelForm, PanelTrim, Patchwork};
use torse::patchwork::partition::Partition;
use torse::spline::curve::Curve;
use torse::spline::knots::Knots;
use torse::spline::surface::Surface;
use torse::torse::form::{DualTorse, PanelKind, PrimalTorse, Torse};
use torse::torse::strip::Strip;

/// What makes a specimen hard.
pub const KINDS: [&str; 9] = [
    "smooth bumps",
    "inflections",
    "ripple in the torse",
    "spike in a narrow knot interval",
    "weights of 1e-6 to 1e6",
    "uneven parametrisation",
    "far from the origin",
    "pole",
    "hem",
];

fn greville(k: &Knots) -> Vec<f64> {
    let (p, v) = (k.degree(), k.values());
    (0..k.control_count()).map(|i| v[i + 1..=i + p].iter().sum::<f64>() / p as f64).collect()
}

fn inverse(k: &Knots) -> DMatrix<f64> {
    let g = greville(k);
    let mut m = DMatrix::zeros(g.len(), g.len());
    for (r, &t) in g.iter().enumerate() {
        let b = k.basis(t, 0);
        for j in 0..=k.degree() {
            m[(r, b.first + j)] = b.rows[0][j];
        }
    }
    m.try_inverse().expect("collocation at Greville points is regular")
}

/// The spline through `f` at the Greville points.
pub fn curve<const D: usize>(k: &Knots, f: &dyn Fn(f64) -> [f64; D]) -> Curve<D> {
    let (g, inverse) = (greville(k), inverse(k));
    let mut control = vec![[0.0; D]; g.len()];
    for d in 0..D {
        let c = &inverse * DMatrix::from_fn(g.len(), 1, |i, _| f(g[i])[d]);
        for i in 0..g.len() {
            control[i][d] = c[(i, 0)];
        }
    }
    Curve::new(k.degree(), k.values().to_vec(), control).expect("curve")
}

fn surface(ku: &Knots, kv: &Knots, f: &dyn Fn(f64, f64) -> Vec3) -> Surface {
    let (gu, gv, iu, iv) = (greville(ku), greville(kv), inverse(ku), inverse(kv));
    let mut points = vec![Vec3::zeros(); gu.len() * gv.len()];
    for d in 0..3 {
        let c = &iu * DMatrix::from_fn(gu.len(), gv.len(), |i, j| f(gu[i], gv[j])[d]) * iv.transpose();
        for i in 0..gu.len() {
            for j in 0..gv.len() {
                points[i * gv.len() + j][d] = c[(i, j)];
            }
        }
    }
    Surface::new(ku.clone(), kv.clone(), &points, None).expect("surface")
}

/// A torse, the patch that stands for it in files, and where both run.
pub struct Ground {
    pub torse: Torse,
    pub patch: Surface,
    /// Parameters t of the part that surfaces lie over.
    pub range: [f64; 2],
}

/// A patch of `degree` between the points `end(t, 0)` and `end(t, 1)`, polynomials between breaks.
fn ruled(degree: usize, breaks: &[f64], end: &dyn Fn(f64, usize) -> [f64; 4]) -> Surface {
    let spans = breaks.len() - 1;
    let mut knots = vec![breaks[0]; degree + 1];
    for &b in &breaks[1..spans] {
        knots.extend(std::iter::repeat_n(b, degree));
    }
    knots.extend(std::iter::repeat_n(breaks[spans], degree + 1));
    let count = degree * spans + 1;
    let unit = Knots::clamped(degree, &[0.0, 1.0]).expect("knots");
    let (mut points, mut weights) = (vec![Vec3::zeros(); 2 * count], vec![1.0; 2 * count]);
    for (i, w) in breaks.windows(2).enumerate() {
        for e in 0..2 {
            let piece = curve(&unit, &|s| end(w[0] + s * (w[1] - w[0]), e));
            for (k, c) in piece.control.iter().enumerate() {
                points[2 * (degree * i + k) + e] = Vec3::new(c[0], c[1], c[2]) / c[3];
                weights[2 * (degree * i + k) + e] = c[3];
            }
        }
    }
    let polynomial = weights.iter().all(|w| (w - 1.0).abs() < 1e-12);
    let ku = Knots::new(degree, knots, count).expect("knots");
    let kv = Knots::clamped(1, &[0.0, 1.0]).expect("knots");
    Surface::new(ku, kv, &points, (!polynomial).then_some(&weights[..])).expect("patch")
}

/// Graph over a plane profile: z = f, with rulings of slope a.
fn primal(random: &mut Random, kind: usize) -> Ground {
    let (c2, c3) = (random.between(0.05, 0.4), random.between(-0.1, 0.1));
    let bend = if kind == 1 { 0.0 } else { c2 };
    let (turn, twist) = (random.between(-0.2, 0.2), random.between(-0.15, 0.15));
    let (wave, number) = (random.scale(1e-4, 1e-3), random.between(8.0, 30.0));
    let wave = if kind == 2 { wave } else { 0.0 };
    let f = move |t: f64| bend * t * t + c3 * (t - 0.5).powi(3) + wave * (number * t).sin();
    let a = move |t: f64| turn + twist * (2.0 * t).sin();
    let offset = if kind == 6 { random.scale(1e3, 1e6) } else { random.between(-3.0, 3.0) };
    let (s, c) = random.between(0.0, 6.0).sin_cos();
    let frame = Frame {
        origin: Vec3::new(offset, -0.3 * offset, 0.7 * offset),
        x: Vec3::new(c, s, 0.0),
        y: Vec3::new(-s, c, 0.0),
        z: Vec3::z(),
    };
    let spans = if kind == 2 { 60 } else { 12 };
    let knots = Knots::uniform(3, spans, -0.6, 1.6).expect("knots");
    let profile = curve(&knots, &|t| [f(t), a(t)]);
    let torse = Torse::Primal(PrimalTorse::new(frame, profile, random.between(-0.2, 0.2)));
    let breaks: Vec<f64> = knots.breaks().into_iter().filter(|t| (-0.45..=1.45).contains(t)).collect();
    let patch = ruled(5, &breaks, &|t, e| {
        let r = torse.ruling(t);
        let (p, d) = (frame.to_local(&r.point), frame.vector_to_local(&r.direction));
        let x = r.point + r.direction * (([-0.8, 0.8][e] - p.y) / d.y);
        [x.x, x.y, x.z, 1.0]
    });
    Ground { torse, patch, range: [0.0, 1.0] }
}

/// Tangent planes of a sphere or spheroid along a circle, with normals of changing length.
fn dual(random: &mut Random) -> Ground {
    let (latitude, flat) = (random.between(0.3, 1.1), random.between(-0.15, 0.15));
    let (growth, radius) = (random.between(-0.8, 0.8), random.between(2.0, 6.0));
    let knots = Knots::uniform(3, 16, -0.4, 1.4).expect("knots");
    let planes = curve(&knots, &|t| {
        let scale = (growth * t).exp();
        let (s, c) = t.sin_cos();
        let (x, y, z) = (c * latitude.cos(), s * latitude.cos(), latitude.sin());
        [scale * x, scale * y, scale * z, scale * radius * (1.0 + flat * (2.0 * t).sin())]
    });
    let torse = Torse::Dual(DualTorse { planes: planes.clone() });
    let breaks: Vec<f64> = knots.breaks().into_iter().filter(|t| (-0.25..=1.25).contains(t)).collect();
    // Between two horizontal planes, around the points nearest to the centre.
    let middle = torse.ruling(0.5).point.z;
    let patch = ruled(4, &breaks, &|t, e| {
        let j = planes.jet(t);
        let n = Vec3::new(j[0][0], j[0][1], j[0][2]);
        let m = Vec3::new(j[1][0], j[1][1], j[1][2]);
        let (a, alpha) = (Vec3::z(), middle + [-0.9, 0.9][e]);
        let x = m.cross(&a) * j[0][3] + a.cross(&n) * j[1][3] + n.cross(&m) * alpha;
        [x.x, x.y, x.z, n.cross(&m).dot(&a)]
    });
    Ground { torse, patch, range: [0.0, 1.0] }
}

/// The surface of a specimen: over the torse, at heights of the order `size`.
fn over(ground: &Ground, random: &mut Random, kind: usize, size: f64) -> Surface {
    let warp = if kind == 5 { random.scale(0.02, 1.0) } else { 1.0 };
    let (p, q) = (random.between(1.0, 6.0), random.between(1.0, 6.0));
    let (amplitude, tilt) = (size * random.between(0.2, 1.0), size * random.between(-0.5, 0.5));
    let (hem, drop) = (random.between(0.1, 0.6) * size * 3.0, random.between(0.2, 1.0));
    let at = |u: f64, v: f64| -> Vec3 {
        // A map of [0, 1] onto itself that begins with the slope `warp`.
        let w = u * (warp + (1.0 - warp) * u * u);
        let (mut t, mut y) = (0.1 + 0.8 * w, 0.8 * (v - 0.5));
        let mut d = amplitude * (p * u + 0.3).sin() * (q * v).cos() + tilt * (v - 0.5);
        if kind == 7 {
            y *= u;
            d *= u;
        }
        if kind == 8 && u > 0.9 {
            // Turned back under itself, lower and lower.
            let x = (u - 0.9) / 0.1;
            t = 0.1 + 0.8 * 0.9 + hem * (0.3 * x - x * x);
            d -= size * drop * x;
        }
        let t = ground.range[0] + (ground.range[1] - ground.range[0]) * t;
        let r = ground.torse.ruling(t);
        r.point + r.direction * y + r.normal * d
    };
    let mut breaks = vec![0.0, 0.5, 1.0];
    if kind == 3 {
        let (x, w) = (random.between(0.2, 0.4), random.scale(1e-6, 1e-2));
        breaks = vec![0.0, x, x + w, x + 2.0 * w, x + 3.0 * w, x + 4.0 * w, 1.0];
    } else if kind == 8 {
        breaks = vec![0.0, 0.5, 0.9, 0.9, 0.9, 1.0];
    } else if kind == 4 {
        breaks = vec![0.0, 1.0];
    }
    let ku = Knots::clamped(3, &breaks).expect("knots");
    let kv = Knots::clamped(3, &[0.0, 1.0]).expect("knots");
    let mut s = surface(&ku, &kv, &at);
    let row = s.row();
    if kind == 3 {
        let k = 4 + random.below(2);
        let by = ground.torse.ruling(0.4).normal * (size * random.scale(0.3, 3.0));
        for c in &mut s.control[k * row..(k + 1) * row] {
            (0..3).for_each(|d| c[d] += by[d]);
        }
    } else if kind == 4 {
        // Powers keep the shape and change the speed.
        let (a, b) = (random.scale(1e-1, 1e1), random.scale(1e-1, 1e1));
        let all = random.scale(1e-6, 1e6);
        for i in 0..=3 {
            for j in 0..=3 {
                let w = all * a.powi(i) * b.powi(j);
                s.control[i as usize * row + j as usize].iter_mut().for_each(|x| *x *= w);
            }
        }
        s.rational = true;
    }
    s
}

/// Lines of the grid: knots, and points between them.
fn lines(k: &Knots, n: usize) -> Vec<f64> {
    let b = k.breaks();
    let mut out: Vec<f64> =
        b.windows(2).flat_map(|w| (0..n).map(move |i| w[0] + (w[1] - w[0]) * i as f64 / n as f64)).collect();
    out.push(b[b.len() - 1]);
    out
}

/// Foot of a point as (t, r) on the patch.
fn foot(ground: &Ground, x: &Vec3, near: f64) -> Option<[f64; 2]> {
    let t = ground.torse.foot(x, near)?;
    let normal = ground.torse.ruling(t).normal;
    let p = x - normal * ground.torse.plane_distance(x, t);
    let (a, b) = (ground.patch.point(t, 0.0), ground.patch.point(t, 1.0));
    let l = (p - a).dot(&(b - a)) / (b - a).norm_squared();
    // From the share of lengths to the parameter, with the weights of both ends.
    let weight = |v: f64| {
        let at = |e: usize| {
            let k = &ground.patch.knots_u;
            let basis = k.basis(t, 0);
            (0..=k.degree()).map(|j| basis.rows[0][j] * ground.patch.control[2 * (basis.first + j) + e][3]).sum::<f64>()
        };
        at(v as usize)
    };
    let (wa, wb) = (weight(0.0), weight(1.0));
    Some([t, l * wa / (l * wa + (1.0 - l) * wb)])
}

/// The same ground, moved.
fn moved(ground: &Ground, by: &Vec3) -> Ground {
    let mut patch = ground.patch.clone();
    for c in &mut patch.control {
        let w = c[3];
        (0..3).for_each(|d| c[d] += w * by[d]);
    }
    let torse = match &ground.torse {
        Torse::Primal(t) => {
            let mut t = t.clone();
            t.frame.origin += by;
            Torse::Primal(t)
        }
        Torse::Dual(t) => {
            let mut planes = t.planes.clone();
            planes.control.iter_mut().for_each(|c| c[3] += c[0] * by.x + c[1] * by.y + c[2] * by.z);
            Torse::Dual(DualTorse { planes })
        }
        other => other.clone(),
    };
    Ground { torse, patch, range: ground.range }
}

/// A random specimen; `None` where its feet leave the patch. One in three has two panels that meet at a seam, the second on a
/// torse that is moved by about the size.
pub fn specimen(random: &mut Random, kind: usize) -> Option<(Patchwork, f64)> {
    let ground = if (kind == 0 || kind == 4) && random.below(2) == 0 { dual(random) } else { primal(random, kind) };
    let size = random.scale(1e-4, 2e-2);
    let s = over(&ground, random, kind, size);
    let (us, vs) = (lines(&s.knots_u, 3), lines(&s.knots_v, 4));
    let mut partition = Partition::default();
    for &u in &us {
        partition.vertices.extend(vs.iter().map(|&v| [u, v]));
    }
    let (nu, nv) = (us.len(), vs.len());
    let index = |i: usize, j: usize| (i * nv + j) as u32;
    let cut = if random.below(3) == 0 { Some(1 + random.below(nu - 2)) } else { None };
    for i in 0..nu - 1 {
        let label = u32::from(cut.is_some_and(|c| i >= c));
        for j in 0..nv - 1 {
            let (a, b, c, d) = (index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1));
            partition.triangles.extend([[a, b, c], [a, c, d]]);
            partition.labels.extend([label, label]);
        }
    }
    let seam = |forward: bool| Border::Seam { seam: 0, forward };
    let mut panels = Vec::new();
    let mut first = 0;
    for (label, last) in (0..).zip(cut.into_iter().chain([nu - 1])) {
        let own = match label {
            0 => moved(&ground, &Vec3::zeros()),
            _ => moved(&ground, &(Vec3::new(0.4, -0.3, 0.8) * (size * random.between(-1.0, 1.0)))),
        };
        let sides = [
            (Border::Trim { edge: 0 }, (first..=last).map(|i| index(i, 0)).collect::<Vec<_>>()),
            (
                if last < nu - 1 { seam(true) } else { Border::Trim { edge: 1 } },
                (0..nv).map(|j| index(last, j)).collect(),
            ),
            (Border::Trim { edge: 2 }, (first..=last).rev().map(|i| index(i, nv - 1)).collect()),
            (
                if first > 0 { seam(false) } else { Border::Trim { edge: 3 } },
                (0..nv).rev().map(|j| index(first, j)).collect(),
            ),
        ];
        let runs: Option<Vec<Coedge>> =
            sides.into_iter().map(|(border, vertices)| run(&own, &s, &partition, vertices, border)).collect();
        let (form, loops) = (PanelForm::Torse(own.torse), vec![runs?]);
        panels.push(Panel {
            strip: Strip { name: ["A", "B"][panels.len()].into(), kind: PanelKind::Torse, patch: own.patch },
            trim: Some(PanelTrim { face: 0, label, form, loops }),
            outline: Vec::new(),
        });
        first = last;
    }
    let (faces, seam_count) = (vec![Face::untrimmed(s)], panels.len() - 1);
    Some((Patchwork { faces, partitions: vec![partition], panels, seam_count, joint_count: 0 }, size))
}

fn run(ground: &Ground, s: &Surface, partition: &Partition, vertices: Vec<u32>, border: Border) -> Option<Coedge> {
    let at = |k: u32| partition.vertices[k as usize];
    let (a, b) = (at(vertices[0]), at(vertices[vertices.len() - 1]));
    let length = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).abs() + (p[1] - q[1]).abs();
    let parameters: Vec<f64> = vertices.iter().map(|&k| length(at(k), a) / length(a, b)).collect();
    let on = |x: f64| [a[0] + x * (b[0] - a[0]), a[1] + x * (b[1] - a[1])];
    // Knots where the surface has some, so that feet are as smooth as the trimming curve.
    let mut breaks: Vec<f64> = (0..=24).map(|i| f64::from(i) / 24.0).chain(parameters.iter().copied()).collect();
    breaks.sort_by(f64::total_cmp);
    breaks.dedup_by(|x, y| (*x - *y).abs() < 1e-9);
    let knots = Knots::clamped(3, &breaks).ok()?;
    let feet: Option<Vec<[f64; 2]>> = greville(&knots)
        .iter()
        .map(|&x| {
            let uv = on(x);
            foot(ground, &s.point(uv[0], uv[1]), 0.1 + 0.8 * uv[0])
        })
        .collect();
    let (feet, m) = (feet?, inverse(&knots));
    let n = feet.len();
    let mut control = vec![[0.0; 2]; n];
    for d in 0..2 {
        let c = &m * DMatrix::from_fn(n, 1, |i, _| feet[i][d]);
        (0..n).for_each(|i| control[i][d] = c[(i, 0)]);
    }
    let end = |uv: [f64; 2]| foot(ground, &s.point(uv[0], uv[1]), 0.1 + 0.8 * uv[0]);
    (control[0], control[n - 1]) = (end(a)?, end(b)?);
    let trim = Curve::new(3, knots.values().to_vec(), control).ok()?;
    let space = curve(&knots, &|x| {
        let [t, r] = trim.point(x);
        ground.patch.point(t, r).into()
    });
    Some(Coedge { border, vertices, parameters, trim, edge: space })
}
