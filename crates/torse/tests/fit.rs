//! Fitted torses against the theory of narrow strips, against exact torses, and against bad data.

use proptest::prelude::*;
use torse::control::Control;
use torse::fit::near::dual::DualOptions;
use torse::fit::near::primal::PrimalOptions;
use torse::fit::near::samples::{error, thin, Fit, Sample};
use torse::fit::near::{descent::RefitOptions, refit::refit};
use torse::fit::near::{dual::dual, plane::plane, primal::primal};
use torse::geom::Vec3;
use torse::torse::form::{PanelKind, Ruling, Torse};

/// A strip of a surface: `point(a, b)` gives position and unit normal, a runs along the centre line b = 0, the ruling of
/// the tangent developable at `(a, 0)` is `ruling(a)`.
struct Strip {
    point: Box<dyn Fn(f64, f64) -> (Vec3, Vec3)>,
    ruling: Box<dyn Fn(f64) -> Vec3>,
    along: (f64, f64),
    /// Half the width, in units of b, for which theory gives the error 1 mm.
    half: f64,
}

impl Strip {
    fn samples(&self, width: f64, n: usize, m: usize) -> Vec<Sample> {
        let mut out = Vec::new();
        for i in 0..n {
            for j in 0..m {
                let a = self.along.0 + (self.along.1 - self.along.0) * i as f64 / (n - 1) as f64;
                let b = width * self.half * (2.0 * j as f64 / (m - 1) as f64 - 1.0);
                let (x, n) = (self.point)(a, b);
                out.push(Sample { x, n, weight: 1.0 });
            }
        }
        out
    }

    fn centre(&self) -> Vec<Ruling> {
        (0..60)
            .map(|i| {
                let a = self.along.0 + (self.along.1 - self.along.0) * i as f64 / 59.0;
                let (x, n) = (self.point)(a, 0.0);
                Ruling { point: x, direction: (self.ruling)(a), normal: n }
            })
            .collect()
    }
}

/// Radius of the test surfaces, mm.
const R: f64 = 1000.0;

fn sphere(turn: f64) -> Strip {
    Strip {
        point: Box::new(|a, b| {
            let n = Vec3::new(b.sin(), a.sin() * b.cos(), a.cos() * b.cos());
            (n * R, n)
        }),
        ruling: Box::new(|_| Vec3::x()),
        along: (-0.5 * turn, 0.5 * turn),
        half: 2.0 / R.sqrt(),
    }
}

/// `z = (p² − q²) / 2R`, strip at the angle `theta` to the p-axis.
fn hypar(theta: f64) -> Strip {
    let (s, c) = theta.sin_cos();
    Strip {
        point: Box::new(move |a, b| {
            let (p, q) = (a * c + b * s, a * s + b * c);
            (Vec3::new(p, q, (p * p - q * q) / (2.0 * R)), Vec3::new(-p / R, q / R, 1.0).normalize())
        }),
        ruling: Box::new(move |a| {
            let (p, q) = (a * c, a * s);
            Vec3::new(s, c, (p * s - q * c) / R).normalize()
        }),
        along: (-700.0, 700.0),
        half: 2.0 * R.sqrt() / (c * c - s * s).sqrt(),
    }
}

/// Torus with radii 1500 and 500; the strip follows the parallel at the angle `b0` of the meridian.
fn torus(b0: f64) -> Strip {
    let (big, small) = (1500.0, 500.0_f64);
    Strip {
        point: Box::new(move |a, b| {
            let n = Vec3::new(a.cos() * (b + b0).cos(), a.sin() * (b + b0).cos(), (b + b0).sin());
            (Vec3::new(a.cos(), a.sin(), 0.0) * big + n * small, n)
        }),
        ruling: Box::new(move |a| Vec3::new(-a.cos() * b0.sin(), -a.sin() * b0.sin(), b0.cos())),
        along: (-0.6, 0.6),
        half: 2.0 / small.sqrt(),
    }
}

fn strips() -> Vec<(&'static str, Strip)> {
    vec![
        ("sphere", sphere(1.3)),
        ("hypar along", hypar(0.0)),
        ("hypar oblique", hypar(0.35)),
        ("torus outside", torus(0.5)),
        ("torus inside", torus(3.6)),
    ]
}

/// The feet of all samples lie inside the domain with a margin.
fn assert_margin(fit: &Fit, samples: &[Sample]) {
    let (lo, hi) = fit.torse.domain();
    let (mut a, mut b) = (f64::INFINITY, f64::NEG_INFINITY);
    for s in samples {
        // The sample is near the surface: its foot is where its own ruling plane is nearest.
        let guess = match &fit.torse {
            Torse::Primal(p) => p.frame.to_local(&s.x).x,
            Torse::Dual(_) | Torse::Cylinder(_) => (0..=200)
                .map(|i| lo + (hi - lo) * i as f64 / 200.0)
                .min_by(|&p, &q| {
                    let off = |t: f64| {
                        let r = fit.torse.ruling(t);
                        (s.x - r.point).cross(&r.direction).norm()
                    };
                    off(p).total_cmp(&off(q))
                })
                .expect("not empty"),
        };
        let t = fit.torse.foot(&s.x, guess).expect("a foot");
        (a, b) = (a.min(t), b.max(t));
        assert!(fit.torse.plane_distance(&s.x, t).abs() <= fit.error * (1.0 + 1e-9) + 1e-9);
    }
    let margin = 0.05 * (b - a);
    assert!(lo < a - margin && hi > b + margin, "domain {lo}..{hi}, feet {a}..{b}");
}

#[test]
fn best_fit_error_is_half_the_tangent_strip_s() {
    // The tangent strip's error is κ w²/8 = 2 mm at unit width.
    for (name, strip) in strips() {
        let samples = strip.samples(1.0, 61, 13);
        let p = primal(&samples, &PrimalOptions::new(0.0)).expect("primal fit");
        assert!((0.9..1.1).contains(&p.error), "{name}, primal: {}", p.error);
        assert_margin(&p, &samples);
        let d = dual(&samples, &strip.centre(), &DualOptions::new(0.0)).expect("dual fit");
        assert!((0.9..1.1).contains(&d.error), "{name}, dual: {}", d.error);
        assert_margin(&d, &samples);
    }
}

#[test]
fn a_fit_that_is_stopped_ends_with_what_it_has() {
    let control = Control::default();
    control.cancel();
    for (name, strip) in strips() {
        let samples = strip.samples(1.0, 61, 13);
        let options = PrimalOptions::new(0.0);
        let whole = primal(&samples, &options).expect("primal fit");
        let cut = primal(&samples, &PrimalOptions { control: control.clone(), ..options }).expect("primal fit");
        assert!(cut.error > whole.error && cut.error.is_finite(), "{name}: {} {}", cut.error, whole.error);
        let options = DualOptions::new(0.0);
        let whole = dual(&samples, &strip.centre(), &options).expect("dual fit");
        let cut = dual(&samples, &strip.centre(), &DualOptions { control: control.clone(), ..options });
        assert!(cut.is_none_or(|cut| cut.error > whole.error), "{name}");
    }
}

#[test]
fn doubling_the_width_quadruples_the_error() {
    for (name, strip) in strips() {
        let errors: Vec<(f64, f64)> = [0.5, 1.0, 2.0]
            .iter()
            .map(|&w| {
                let samples = strip.samples(w, 61, 13);
                let p = primal(&samples, &PrimalOptions::new(0.0)).expect("primal fit");
                let d = dual(&samples, &strip.centre(), &DualOptions::new(0.0)).expect("dual fit");
                (p.error, d.error)
            })
            .collect();
        for w in errors.windows(2) {
            for ratio in [w[1].0 / w[0].0, w[1].1 / w[0].1] {
                assert!((3.5..4.5).contains(&ratio), "{name}: {errors:?}");
            }
        }
    }
}

#[test]
fn dual_form_follows_a_strip_past_a_right_angle() {
    let strip = sphere(3.5);
    let samples = strip.samples(1.0, 81, 9);
    assert_eq!(primal(&samples, &PrimalOptions::new(1.0)).expect("some fit").kind, PanelKind::Plane);
    let d = dual(&samples, &strip.centre(), &DualOptions::new(0.0)).expect("dual fit");
    assert!((0.9..1.1).contains(&d.error), "{}", d.error);
    assert_margin(&d, &samples);
}

/// Samples of `c(t) + y e(t)` with normals from differences.
fn ruled(c: impl Fn(f64) -> Vec3, e: impl Fn(f64) -> Vec3, t: (f64, f64), y: (f64, f64)) -> Vec<Sample> {
    let mut out = Vec::new();
    for i in 0..=40 {
        for j in 0..=10 {
            let (s, v) = (t.0 + (t.1 - t.0) * i as f64 / 40.0, y.0 + (y.1 - y.0) * j as f64 / 10.0);
            let d = 1e-5;
            let x = |s: f64| c(s) + e(s) * v;
            let n = ((x(s + d) - x(s - d)) / (2.0 * d)).cross(&e(s)).normalize();
            out.push(Sample { x: x(s), n, weight: 1.0 });
        }
    }
    out
}

#[test]
fn simple_kinds_are_recognised() {
    let cylinder =
        ruled(|t| Vec3::new(200.0 * t.sin(), 0.0, 200.0 * t.cos()), |_| Vec3::y(), (-0.8, 0.7), (-100.0, 300.0));
    let fit = primal(&cylinder, &PrimalOptions::new(0.05)).expect("fit");
    assert_eq!(fit.kind, PanelKind::Cylinder);
    assert!(fit.error <= 0.05);

    let ray = |t: f64| Vec3::new(0.3 * t.sin(), 1.0, 0.3 * t.cos());
    let cone = ruled(|_| Vec3::new(0.0, -500.0, 0.0), ray, (-0.8, 0.7), (400.0, 700.0));
    let fit = primal(&cone, &PrimalOptions::new(0.05)).expect("fit");
    assert_eq!(fit.kind, PanelKind::Cone);
    assert!(fit.error <= 0.05);

    let helix = |t: f64| Vec3::new(100.0 * t.cos(), 100.0 * t.sin(), 80.0 * t);
    let tangent = |t: f64| Vec3::new(-100.0 * t.sin(), 100.0 * t.cos(), 80.0).normalize();
    let torse = ruled(helix, tangent, (-0.5, 0.5), (110.0, 240.0));
    let fit = primal(&torse, &PrimalOptions::new(0.05)).expect("fit");
    assert_eq!(fit.kind, PanelKind::Torse);
    assert!(fit.error <= 0.05, "{}", fit.error);
    assert_margin(&fit, &torse);
}

#[test]
fn inflections_are_no_obstacle_to_the_primal_form() {
    let wave = ruled(|t| Vec3::new(t, 0.0, 40.0 * (t / 100.0).sin()), |_| Vec3::y(), (-300.0, 300.0), (-200.0, 200.0));
    let fit = primal(&wave, &PrimalOptions::new(0.5)).expect("fit");
    assert!(fit.error <= 0.5, "{}", fit.error);
}

#[test]
fn witnesses_are_taken_in_by_a_refit() {
    let strip = torus(0.5);
    let coarse = strip.samples(1.0, 13, 3);
    let mut all = coarse.clone();
    all.extend(strip.samples(1.0, 61, 13));
    let fits = [
        primal(&coarse, &PrimalOptions::new(0.0)).expect("primal fit"),
        dual(&coarse, &strip.centre(), &DualOptions::new(0.0)).expect("dual fit"),
    ];
    for fit in fits {
        let before = error(&fit.torse, &all).map_or(f64::INFINITY, |e| e.0);
        let after = refit(&fit, &all, &RefitOptions::new(0.0)).expect("refit");
        assert!(after.error <= before && (0.9..1.1).contains(&after.error), "{before} {}", after.error);
        let measured = error(&after.torse, &all).expect("regular");
        assert!((measured.0 - after.error).abs() < 1e-9 * after.error);
        assert_eq!(measured.1, after.worst);
    }
}

#[test]
fn error_refuses_samples_beyond_the_regression_curve() {
    let ray = |t: f64| Vec3::new(0.3 * t.sin(), 1.0, 0.3 * t.cos());
    let mut cone = ruled(|_| Vec3::new(0.0, -500.0, 0.0), ray, (-0.8, 0.7), (400.0, 700.0));
    let fit = primal(&cone, &PrimalOptions::new(0.05)).expect("fit");
    cone.push(Sample { x: Vec3::new(0.0, -600.0, -30.0), n: Vec3::z(), weight: 1.0 });
    assert!(error(&fit.torse, &cone).is_none());
}

#[test]
fn scaling_and_motion_commute_with_the_fit() {
    let samples = hypar(0.35).samples(1.0, 41, 9);
    let e0 = primal(&samples, &PrimalOptions::new(0.0)).expect("fit").error;
    let axis = Vec3::new(1.0, 2.0, 3.0).normalize();
    // Reflection in a plane, shift and scaling.
    let turn = |v: &Vec3| v - axis * (2.0 * axis.dot(v));
    for scale in [1e-3, 1.0, 1e3] {
        let moved: Vec<Sample> = samples
            .iter()
            .map(|s| Sample {
                x: turn(&s.x) * scale + Vec3::new(300.0, -100.0, 50.0) * scale,
                n: turn(&s.n),
                weight: s.weight,
            })
            .collect();
        let e = primal(&moved, &PrimalOptions::new(0.0)).expect("fit").error / scale;
        assert!((e / e0 - 1.0).abs() < 0.05, "{e0} {e}");
    }
}

#[test]
fn degenerate_samples_give_a_plane_or_nothing() {
    let at = |x: f64, y: f64, z: f64| Sample { x: Vec3::new(x, y, z), n: Vec3::zeros(), weight: 1.0 };
    let o = PrimalOptions::new(0.01);
    assert!(primal(&[], &o).is_none());
    for count in 1..12 {
        let line: Vec<Sample> = (0..count).map(|i| at(i as f64, 2.0 * i as f64, -0.5 * i as f64)).collect();
        assert_eq!(primal(&line, &o).expect("a plane").kind, PanelKind::Plane);
        let same = vec![at(1.0, 2.0, 3.0); count];
        assert!(primal(&same, &o).expect("a plane").error < 1e-9);
    }
    let centre = [Ruling { point: Vec3::zeros(), direction: Vec3::x(), normal: Vec3::z() }; 6];
    assert!(dual(&[at(0.0, 0.0, 0.0); 8], &centre, &DualOptions::new(0.1)).is_none());
    assert!(primal(&[at(f64::NAN, 0.0, 0.0); 9], &o).is_none());
    assert!(plane(&[at(f64::INFINITY, 0.0, 0.0); 9]).is_none());
    // Zero weights and zero normals: the frame comes from the positions.
    let mut bowl: Vec<Sample> = sphere(0.6).samples(1.0, 21, 7);
    for s in &mut bowl {
        s.n = Vec3::zeros();
        s.weight = 0.0;
    }
    assert!((0.9..1.1).contains(&primal(&bowl, &PrimalOptions::new(0.0)).expect("fit").error));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Whatever the samples are, a fit has finite numbers and its error is that of its torse.
    #[test]
    fn any_samples_are_survived(
        points in prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64), 0..60),
        flat in prop::sample::select(vec![0.0, 1e-9, 1e-3, 1.0]),
        thin_y in prop::sample::select(vec![0.0, 1e-6, 1.0]),
        tolerance in prop::sample::select(vec![0.0, 1e-6, 0.1]),
    ) {
        let samples: Vec<Sample> = points
            .iter()
            .map(|&(x, y, z)| {
                let n = Vec3::new(0.3 * x, 0.2 * y, 1.0).normalize();
                Sample { x: Vec3::new(x, thin_y * y, flat * z), n, weight: 1.0 }
            })
            .collect();
        if let Some(fit) = primal(&samples, &PrimalOptions::new(tolerance)) {
            prop_assert!(fit.error.is_finite());
            if let Some(r) = refit(&fit, &samples, &RefitOptions::new(tolerance)) {
                let before = error(&fit.torse, &samples).map_or(f64::MAX, |e| e.0);
                prop_assert!(r.error <= before);
            }
        } else {
            prop_assert!(samples.is_empty());
        }
        let chosen = thin(&samples, 20);
        prop_assert!(chosen.len() <= 20 && chosen.iter().all(|&i| i < samples.len()));
    }
}

/// Facets between two rows of corners, two to a field.
fn facets(low: &[Vec3], high: &[Vec3]) -> torse::geom::cloud::Cloud {
    let n = low.len() as u32;
    let field = |i: u32| [[i, i + 1, n + i], [n + i, i + 1, n + i + 1]];
    torse::geom::cloud::Cloud {
        points: low.iter().chain(high).copied().collect(),
        triangles: (0..n - 1).flat_map(field).collect(),
    }
}

/// Area of facets.
fn flat_area(mesh: &torse::geom::cloud::Cloud) -> f64 {
    let corner = |i: u32| mesh.points[i as usize];
    mesh.triangles
        .iter()
        .map(|t| 0.5 * (corner(t[1]) - corner(t[0])).cross(&(corner(t[2]) - corner(t[0]))).norm())
        .sum()
}

/// The greatest proven distance of the strips from what was measured, mm.
fn reach(answer: &torse::Answer) -> f64 {
    answer.claim(torse::certify::claim::What::FromMeasured).expect("a distance").value()
}

#[test]
fn strips_under_coarse_meshes_end_where_the_mesh_does() {
    // Half a pipe cut off askew above and half a cone: what hugs their corners is a tenth larger.
    let turn = |i: usize| std::f64::consts::PI * i as f64 / 20.0;
    let round = |r: f64, i: usize| Vec3::new(r * turn(i).cos(), r * turn(i).sin(), 0.0);
    let pipe: [Vec<Vec3>; 2] = [
        (0..=20).map(|i| round(100.0, i)).collect(),
        (0..=20).map(|i| round(100.0, i) + Vec3::z() * (200.0 + 80.0 * turn(i).cos())).collect(),
    ];
    let cone: [Vec<Vec3>; 2] =
        [(0..=20).map(|i| round(200.0, i)).collect(), (0..=20).map(|i| round(80.0, i) + Vec3::z() * 250.0).collect()];
    for [low, high] in [pipe, cone] {
        let mesh = facets(&low, &high);
        let answer = torse::fit(&mesh, &torse::FitOptions::new(0.5, "mesh"), &Control::default()).expect("an answer");
        assert_eq!(answer.status(), torse::Status::Certified);
        let area: f64 = answer.patterns().iter().map(|p| p.area).sum();
        let wanted = flat_area(&mesh);
        assert!((area / wanted - 1.0).abs() < 0.006, "{area} {wanted}");
        assert!(reach(&answer) < 2.0, "{}", reach(&answer));
    }
}

#[test]
fn parts_of_a_mesh_that_are_apart_are_parts() {
    let line = |x: f64, y: f64| (0..=20).map(|i| Vec3::new(x + 5.0 * f64::from(i), y, 0.0)).collect::<Vec<_>>();
    let mut mesh = facets(&line(0.0, 0.0), &line(0.0, 100.0));
    let other = facets(&line(300.0, 20.0), &line(300.0, 70.0));
    let first = mesh.points.len() as u32;
    mesh.points.extend(other.points);
    mesh.triangles.extend(other.triangles.into_iter().map(|t| t.map(|c| c + first)));
    let answer = torse::fit(&mesh, &torse::FitOptions::new(0.5, "two"), &Control::default()).expect("an answer");
    assert_eq!(answer.status(), torse::Status::Certified);
    let mut areas: Vec<f64> = answer.patterns().iter().map(|p| p.area).collect();
    areas.sort_by(f64::total_cmp);
    assert!(areas.len() == 2 && (areas[0] - 5000.0).abs() < 1.0 && (areas[1] - 10_000.0).abs() < 1.0, "{areas:?}");
}
