//! What is true of a patchwork of one face, by dense sampling and local refinement. No number of the judge is used, and
//! none of its methods: distances are those of points, found by search. What is found is a little more than the true
//! distance, by the sampling of the trimming curve.

use torse::geom::Vec3;
use torse::patchwork::panel::{Border, Coedge, Panel, Patchwork};
use torse::spline::surface::Surface;

/// Measured on samples.
pub struct Measured {
    /// Largest distance from the face to the trimmed panels.
    pub from_face: f64,
    /// Largest distance from the trimmed panels, and from their edges in space, to the face.
    pub from_panel: f64,
    /// Largest distance between both sides of the seam at equal parameters; 0 without one.
    pub gap: f64,
    /// What is true of every panel for itself.
    pub panels: Vec<Bent>,
}

/// How a panel is bent.
#[derive(Clone, Copy)]
pub struct Bent {
    /// Smallest radius of curvature of the panel inside its trimming curves.
    pub radius: f64,
    /// Smallest distance along a ruling from the panel to its regression curve.
    pub clearance: f64,
}

impl Measured {
    /// How far face and panels are apart.
    pub fn distance(&self) -> f64 {
        self.from_face.max(self.from_panel)
    }
}

/// The trimmed panel: outline in the parameter plane and in space, and rulings in a table.
struct Trimmed<'a> {
    patch: &'a Surface,
    outline: Vec<[f64; 2]>,
    border: Vec<Vec3>,
    rulings: Vec<(f64, Vec3, Vec3)>,
}

const OUTLINE: usize = 400;
const RULINGS: usize = 160;

impl<'a> Trimmed<'a> {
    fn of(panel: &'a Panel) -> Option<Self> {
        let patch = &panel.strip.patch;
        let mut outline = Vec::new();
        for run in panel.loops().first()? {
            // Between all knots: what happens within a narrow interval would be cut off by even samples.
            let mut at = places(&run.trim.knots.breaks(), OUTLINE);
            at.pop();
            outline.extend(at.into_iter().map(|s| run.trim.point(s)));
        }
        let ((t0, t1), _) = patch.domain();
        if outline.iter().any(|p| !(p[0] >= t0 && p[0] <= t1 && p[1].is_finite())) {
            return None;
        }
        let border = outline.iter().map(|p| patch.point(p[0], p[1].clamp(0.0, 1.0))).collect();
        let (lo, hi) = outline.iter().fold((t1, t0), |(a, b), p| (a.min(p[0]), b.max(p[0])));
        let rulings = (0..=RULINGS)
            .map(|i| {
                let t = lo + (hi - lo) * i as f64 / RULINGS as f64;
                (t, patch.point(t, 0.0), patch.point(t, 1.0))
            })
            .collect();
        Some(Self { patch, outline, border, rulings })
    }

    fn contains(&self, q: [f64; 2]) -> bool {
        let n = self.outline.len();
        let mut inside = false;
        for k in 0..n {
            let (a, b) = (self.outline[k], self.outline[(k + 1) % n]);
            if (a[1] > q[1]) != (b[1] > q[1]) && q[0] < a[0] + (q[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) {
                inside = !inside;
            }
        }
        inside
    }

    /// Distance of a point from the trimmed panel.
    fn distance(&self, x: &Vec3) -> f64 {
        let to_line = |p: &Vec3, q: &Vec3| {
            let d = (q - p).normalize();
            (x - p - d * d.dot(&(x - p))).norm()
        };
        let best = (0..self.rulings.len())
            .min_by(|&i, &j| {
                let of = |k: usize| to_line(&self.rulings[k].1, &self.rulings[k].2);
                of(i).total_cmp(&of(j))
            })
            .unwrap_or(0);
        let at = |t: f64| to_line(&self.patch.point(t, 0.0), &self.patch.point(t, 1.0));
        let (mut a, mut b) =
            (self.rulings[best.saturating_sub(1)].0, self.rulings[(best + 1).min(self.rulings.len() - 1)].0);
        for _ in 0..40 {
            let (c, d) = (a + 0.382 * (b - a), a + 0.618 * (b - a));
            if at(c) < at(d) {
                b = d;
            } else {
                a = c;
            }
        }
        let t = 0.5 * (a + b);
        // The place on the ruling by halving: weights make its parameter uneven.
        let (p, q) = (self.patch.point(t, 0.0), self.patch.point(t, 1.0));
        let (mut lo, mut hi) = (0.0, 1.0);
        for _ in 0..50 {
            let m = 0.5 * (lo + hi);
            if (x - self.patch.point(t, m)).dot(&(q - p)) > 0.0 {
                lo = m;
            } else {
                hi = m;
            }
        }
        if self.contains([t, lo]) {
            return (x - self.patch.point(t, lo)).norm();
        }
        let n = self.border.len();
        (0..n).map(|k| to_segment(x, &self.border[k], &self.border[(k + 1) % n])).fold(f64::INFINITY, f64::min)
    }
}

fn to_segment(x: &Vec3, a: &Vec3, b: &Vec3) -> f64 {
    let d = b - a;
    let l = if d.norm_squared() > 0.0 { ((x - a).dot(&d) / d.norm_squared()).clamp(0.0, 1.0) } else { 0.0 };
    (x - a - d * l).norm()
}

/// Parameters where a surface may do something: between its knots, however close they are.
fn places(breaks: &[f64], n: usize) -> Vec<f64> {
    let per = (n / (breaks.len() - 1)).max(5);
    let mut out: Vec<f64> =
        breaks.windows(2).flat_map(|w| (0..per).map(move |i| w[0] + (w[1] - w[0]) * i as f64 / per as f64)).collect();
    out.push(breaks[breaks.len() - 1]);
    out
}

/// Places of a table from which feet are looked for.
const STARTS: usize = 3;

/// Distance of a point from an untrimmed surface: steps of Newton's method from the nearest of a table. A distance above
/// the one given is looked at once more, by steps downhill: on spikes Newton's method leaps over the foot.
fn to_surface(s: &Surface, table: &[(f64, f64, Vec3)], x: &Vec3, most: f64) -> f64 {
    let mut starts: Vec<(f64, usize)> = table.iter().map(|at| (at.2 - x).norm_squared()).zip(0..).collect();
    if starts.len() > STARTS {
        starts.select_nth_unstable_by(STARTS, |a, b| a.0.total_cmp(&b.0));
    }
    starts.truncate(STARTS);
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let ((u0, u1), (v0, v1)) = s.domain();
    let mut best = (f64::INFINITY, u0, v0);
    let closer = |best: &mut (f64, f64, f64), u: f64, v: f64| {
        let d = (x - s.point(u, v)).norm();
        if d < best.0 {
            *best = (d, u, v);
        }
    };
    for (_, start) in starts {
        let (mut u, mut v, _) = table[start];
        for _ in 0..12 {
            let j = s.jet(u, v);
            closer(&mut best, u, v);
            let d = x - j.p;
            let (e, f, g) = (j.du.dot(&j.du), j.du.dot(&j.dv), j.dv.dot(&j.dv));
            let (a, b) = (j.du.dot(&d), j.dv.dot(&d));
            let det = e * g - f * f;
            let (du, dv) = ((g * a - f * b) / det, (e * b - f * a) / det);
            if !(du.is_finite() && dv.is_finite()) {
                break;
            }
            let (mut nu, mut nv) = ((u + du).clamp(u0, u1), (v + dv).clamp(v0, v1));
            // On a side, along it.
            if nu <= u0 || nu >= u1 {
                nv = (v + b / g).clamp(v0, v1);
            }
            if nv <= v0 || nv >= v1 {
                nu = (u + a / e).clamp(u0, u1);
            }
            (u, v) = (nu, nv);
        }
        closer(&mut best, u, v);
    }
    if best.0 <= most {
        return best.0;
    }
    let (mut hu, mut hv) = (0.05 * (u1 - u0), 0.05 * (v1 - v0));
    for _ in 0..400 {
        let (_, u, v) = best;
        for (a, b) in [(u + hu, v), (u - hu, v), (u, v + hv), (u, v - hv), (u + hu, v + hv), (u - hu, v - hv)] {
            closer(&mut best, a.clamp(u0, u1), b.clamp(v0, v1));
        }
        if best.1 == u && best.2 == v {
            (hu, hv) = (0.6 * hu, 0.6 * hv);
            if hu < 1e-12 * (u1 - u0) {
                break;
            }
        }
    }
    best.0
}

/// Largest principal curvature at a place of the patch, and the distance along the ruling to the regression curve.
fn shape(s: &Surface, t: f64, r: f64) -> Option<(f64, f64)> {
    let j = s.jet(t, r);
    let n = j.normal().try_normalize(0.0)?;
    let (e, f, g) = (j.du.dot(&j.du), j.du.dot(&j.dv), j.dv.dot(&j.dv));
    let [l, m, k] = j.second_form(&n);
    let det = e * g - f * f;
    let (mean, gauss) = ((e * k - 2.0 * f * m + g * l) / (2.0 * det), (l * k - m * m) / det);
    let curvature = mean.abs() + (mean * mean - gauss).max(0.0).sqrt();
    let (a, b) = (s.jet(t, 0.0), s.jet(t, 1.0));
    let ruling = b.p - a.p;
    let (na, nb) = (a.du.cross(&ruling).dot(&n), b.du.cross(&ruling).dot(&n));
    let at = na / (na - nb) * ruling.norm();
    let here = (j.p - a.p).dot(&ruling) / ruling.norm();
    let clearance = if at.is_finite() { (at - here).abs() } else { f64::INFINITY };
    Some((curvature, clearance))
}

/// Measures a patchwork of one face at so many places in each direction; `None` if the outline of a panel leaves its patch.
pub fn measure(patchwork: &Patchwork, grid: usize) -> Option<Measured> {
    let s = &patchwork.faces.first()?.surface;
    let trimmed: Option<Vec<Trimmed>> = patchwork.panels.iter().map(Trimmed::of).collect();
    let trimmed = trimmed?;
    let (us, vs) = (places(&s.knots_u.breaks(), grid), places(&s.knots_v.breaks(), grid));
    let mut table: Vec<(f64, f64, Vec3)> = Vec::new();
    for &u in &us {
        table.extend(vs.iter().map(|&v| (u, v, s.point(u, v))));
    }
    let mut found: Vec<(f64, f64, f64)> = table.iter().map(|(u, v, x)| (nearest(&trimmed, x), *u, *v)).collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let from_face = found.iter().take(3).map(|f| climbed(s, &trimmed, f, grid)).fold(0.0, f64::max);
    let mut from_panel = 0.0f64;
    let panels = trimmed.iter().map(|t| bent(s, &table, t, grid, &mut from_panel)).collect();
    for run in patchwork.panels.iter().flat_map(|p| p.loops()).flatten() {
        for x in places(&run.edge.knots.breaks(), grid).into_iter().step_by(3) {
            from_panel = from_panel.max(to_surface(s, &table, &Vec3::from(run.edge.point(x)), from_panel));
        }
    }
    Some(Measured { from_face, from_panel, gap: gap(patchwork, grid), panels })
}

/// Distance of a point from the nearest panel.
fn nearest(trimmed: &[Trimmed], x: &Vec3) -> f64 {
    trimmed.iter().map(|t| t.distance(x)).fold(f64::INFINITY, f64::min)
}

/// How a panel is bent; raises the largest distance of panels from the face.
fn bent(s: &Surface, table: &[(f64, f64, Vec3)], trimmed: &Trimmed, grid: usize, from_panel: &mut f64) -> Bent {
    let mut out = Bent { radius: f64::INFINITY, clearance: f64::INFINITY };
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for p in &trimmed.outline {
        for d in 0..2 {
            low[d] = low[d].min(p[d]);
            high[d] = high[d].max(p[d]);
        }
    }
    let inner = (0..grid * grid).map(|k| {
        let (i, j) = ((k / grid) as f64 + 0.5, (k % grid) as f64 + 0.5);
        [low[0] + (high[0] - low[0]) * i / grid as f64, low[1] + (high[1] - low[1]) * j / grid as f64]
    });
    let rim = trimmed.outline.iter().step_by(OUTLINE / grid).copied();
    for (q, sure) in inner.map(|q| (q, false)).chain(rim.map(|q| (q, true))) {
        if !sure && !trimmed.contains(q) {
            continue;
        }
        *from_panel = from_panel.max(to_surface(s, table, &trimmed.patch.point(q[0], q[1]), *from_panel));
        if let Some((k, c)) = shape(trimmed.patch, q[0], q[1]) {
            out = Bent { radius: out.radius.min(1.0 / k), clearance: out.clearance.min(c) };
        }
    }
    out
}

/// Largest distance between both sides of the seam at equal parameters.
fn gap(patchwork: &Patchwork, grid: usize) -> f64 {
    let sides: Vec<(&Surface, &Coedge, bool)> = patchwork
        .panels
        .iter()
        .flat_map(|p| p.loops().iter().flatten().map(move |r| (&p.strip.patch, r)))
        .filter_map(|(patch, r)| match r.border {
            Border::Seam { forward, .. } => Some((patch, r, forward)),
            _ => None,
        })
        .collect();
    let [(p, a, forward), (q, b, back)] = sides[..] else { return 0.0 };
    let mut at = places(&a.trim.knots.breaks(), grid);
    at.extend(places(&b.trim.knots.breaks(), grid).into_iter().map(|x| if forward == back { x } else { 1.0 - x }));
    let on = |patch: &Surface, run: &Coedge, x: f64| {
        let [t, r] = run.trim.point(x);
        patch.point(t, r)
    };
    at.into_iter()
        .map(|x| (on(p, a, x) - on(q, b, if forward == back { x } else { 1.0 - x })).norm())
        .fold(0.0, f64::max)
}

/// The distance at a place after steps uphill, each half as long as the one before when nothing is gained.
fn climbed(s: &Surface, trimmed: &[Trimmed], start: &(f64, f64, f64), grid: usize) -> f64 {
    let ((u0, u1), (v0, v1)) = s.domain();
    let &(mut best, mut u, mut v) = start;
    let (mut hu, mut hv) = ((u1 - u0) / grid as f64, (v1 - v0) / grid as f64);
    for _ in 0..24 {
        let mut gained = false;
        for (du, dv) in [(hu, 0.0), (-hu, 0.0), (0.0, hv), (0.0, -hv)] {
            let (a, b) = ((u + du).clamp(u0, u1), (v + dv).clamp(v0, v1));
            let d = nearest(trimmed, &s.point(a, b));
            if d > best {
                (best, u, v, gained) = (d, a, b, true);
            }
        }
        if !gained {
            (hu, hv) = (0.4 * hu, 0.4 * hv);
        }
    }
    best
}
