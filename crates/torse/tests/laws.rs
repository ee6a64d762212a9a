//! Laws of every verb: what is made of a model that is moved, turned or scaled is what is made of the model, moved, turned
//! and scaled. Tolerances are lengths and scale with it. Nearly degenerate curves get honest answers.

use std::collections::HashMap;
use std::sync::OnceLock;
use torse::answer::Answer;
use torse::brep::face::Face;
use torse::certify::claim::{Status, What};
use torse::control::Control;
use torse::geom::cloud::Cloud;
use torse::geom::Vec3;
use torse::io::refold_report::RefoldReport;
use torse::nalgebra::{Rotation3, Unit};
use torse::pipeline::map_artwork::{read_map, Side};
use torse::pipeline::net::Condition;
use torse::pipeline::refold::refold;
use torse::pipeline::ruled::RuledAnswer;
use torse::spline::curve::Curve;
use torse::spline::knots::Knots;
use torse::spline::surface::Surface;
use torse::torse::contact::Given;
use torse::torse::quad_strip::QuadStrip;
use torse::torse::rail::{Rail, RailError};
use torse::Model;

/// A similarity: turned, scaled, then moved.
#[derive(Clone, Copy)]
struct Similarity {
    turn: Rotation3<f64>,
    scale: f64,
    shift: Vec3,
}

impl Similarity {
    fn direction(&self, v: [f64; 3]) -> Vec3 {
        self.turn * Vec3::from(v) * self.scale
    }

    fn point(&self, p: [f64; 3]) -> Vec3 {
        self.direction(p) + self.shift
    }

    fn rail(&self, name: &str, degree: usize, points: &[[f64; 3]]) -> Rail {
        self.maybe_rail(name, degree, points).expect("rail")
    }

    /// A rail, or why it is none.
    fn maybe_rail(&self, name: &str, degree: usize, points: &[[f64; 3]]) -> Result<Rail, RailError> {
        let breaks: Vec<f64> = (0..=points.len() - degree).map(|k| k as f64 / (points.len() - degree) as f64).collect();
        let knots = Knots::clamped(degree, &breaks).expect("knots");
        let control = points.iter().map(|p| self.point(*p)).map(|p| [p.x, p.y, p.z, 1.0]).collect();
        Rail::new(name, &[Curve { knots, control }])
    }

    /// A face ruled between two curves of the same control points' number.
    fn ruled(&self, a: &[[f64; 3]], b: &[[f64; 3]]) -> Face {
        let knots = |degree| Knots::clamped(degree, &[0.0, 1.0]).expect("knots");
        let points: Vec<Vec3> = a.iter().zip(b).flat_map(|(a, b)| [self.point(*a), self.point(*b)]).collect();
        Face::untrimmed(Surface::new(knots(a.len() - 1), knots(1), &points, None).expect("surface"))
    }
}

/// Nothing at all, a motion, half and eight times the size, and all of it at once.
fn similarities() -> [Similarity; 5] {
    let turn = Rotation3::from_axis_angle(&Unit::new_normalize(Vec3::new(0.3, -1.0, 0.7)), 0.8);
    let still = Similarity { turn: Rotation3::identity(), scale: 1.0, shift: Vec3::zeros() };
    let shift = Vec3::new(130.0, -70.0, 40.0);
    [
        still,
        Similarity { turn, shift, ..still },
        Similarity { scale: 0.5, ..still },
        Similarity { scale: 8.0, ..still },
        Similarity { turn, shift, scale: 3.0 },
    ]
}

/// What must not change but by the scale: status, panels, parts, and the measures of flat patterns.
fn commutes(share: f64, make: impl Fn(&Similarity) -> Answer) {
    let [still, others @ ..] = similarities();
    let first = make(&still);
    let sum = |a: &Answer, of: fn(&torse::patchwork::pattern::Pattern) -> f64| a.patterns().iter().map(of).sum::<f64>();
    assert!(!first.patterns().is_empty(), "nothing is compared");
    for s in others {
        let made = make(&s);
        let counts = |a: &Answer| (a.status(), a.patchwork().panels.len(), a.parts.len(), a.patterns().len());
        assert_eq!(counts(&made), counts(&first), "scale {}: {:?} {:?}", s.scale, made.claims(), made.notes);
        let (area, length) = (sum(&first, |p| p.area), sum(&first, |p| p.length));
        let off = (sum(&made, |p| p.area) / (s.scale * s.scale) - area).abs();
        assert!(off < share * area, "scale {}: area {off} of {area}", s.scale);
        let off = (sum(&made, |p| p.length) / s.scale - length).abs();
        assert!(off < share * length, "scale {}: length {off} of {length}", s.scale);
    }
}

#[test]
#[should_panic(expected = "scale 0.5: area")]
fn the_law_can_fail() {
    commutes(1e-6, |s| {
        let s = Similarity { scale: 1.0, ..*s };
        let (low, high) = (s.rail("low", 3, &LOW), s.rail("high", 3, &HIGH));
        torse::loft(&low, &high, &torse::Loft::new(0.1), &Control::default()).expect("a loft")
    });
}

const LOW: [[f64; 3]; 5] = [[0., 0., 0.], [80., -20., 10.], [160., 10., 0.], [240., 30., 5.], [320., 0., 20.]];
const HIGH: [[f64; 3]; 5] =
    [[10., 90., 60.], [90., 100., 80.], [150., 120., 70.], [230., 110., 60.], [300., 100., 75.]];

#[test]
fn lofts_commute_with_similarities() {
    commutes(1e-6, |s| {
        let options = torse::Loft::new(0.1 * s.scale);
        torse::loft(&s.rail("low", 3, &LOW), &s.rail("high", 3, &HIGH), &options, &Control::default()).expect("a loft")
    });
}

#[test]
fn hulls_commute_with_similarities() {
    let ring = |z: f64, r: f64, bulge: f64| -> Vec<[f64; 3]> {
        let at = |k: u32| {
            let t = std::f64::consts::TAU * f64::from(k % 24) / 24.0;
            [r * t.cos(), (r + bulge) * t.sin(), z]
        };
        (0..=24).map(at).collect()
    };
    commutes(1e-3, |s| {
        let rail = |name: &str, points: Vec<[f64; 3]>| {
            Rail::through(name, &points.iter().map(|p| s.point(*p)).collect::<Vec<_>>()).expect("rail")
        };
        let curves = [rail("low", ring(0.0, 200.0, 0.0)), rail("high", ring(250.0, 150.0, 80.0))];
        let options = torse::Hull { samples: 48, ..torse::Hull::new(0.5 * s.scale) };
        torse::hull(&curves, &options, &Control::default()).expect("a hull")
    });
}

#[test]
fn nets_commute_with_similarities() {
    commutes(1e-6, |s| {
        let curve = [[0., 0., 0.], [250., 125., 75.], [500., 187.5, 150.], [750., 125., 125.], [1000., 0., 31.25]];
        let last = Condition::LastRuling { direction: s.direction([-0.25, 1.0, 0.125]), width: None };
        let options = torse::Net::new(0.01 * s.scale, s.direction([62.5, 250.0, 0.0]), last);
        torse::net(&s.rail("keel", 3, &curve), &options, &Control::default()).expect("a net")
    });
}

#[test]
fn planarisation_commutes_with_similarities() {
    commutes(1e-6, |s| {
        let side = |r: f64, z: f64, lag: f64| -> Vec<Vec3> {
            (0..=8).map(|k| 0.2 * f64::from(k) + lag).map(|t| s.point([r * t.cos(), r * t.sin(), z])).collect()
        };
        let strip = QuadStrip::new(side(100.0, 0.0, 0.0), side(150.0, 90.0, 0.1)).expect("a strip");
        torse::planarise(&strip, &torse::Planarise::new(1e-6 * s.scale), &Control::default()).expect("an answer")
    });
}

#[test]
fn fits_of_rulings_commute_with_similarities() {
    commutes(1e-3, |s| {
        // Tangents of a helix: nothing but its regression curve is special.
        let ruling = |k: u32| {
            let t = 0.03 * f64::from(k);
            let at = |v: f64| [100.0 * t.cos() - v * t.sin(), 100.0 * t.sin() + v * t.cos(), 40.0 * t + 0.4 * v];
            [s.point(at(40.0)), s.point(at(120.0))]
        };
        let given = Given::Rulings((0..40).map(ruling).collect());
        let options = torse::ElementFitOptions::new(0.05 * s.scale, "helix");
        torse::fit_elements(&given, &options, &Control::default()).expect("a fit")
    });
}

#[test]
fn fits_of_points_commute_with_similarities() {
    commutes(2e-2, |s| {
        let at = |k: usize| {
            let (i, j) = (k % 60, k / 60);
            let t = 0.02 * i as f64;
            s.point([150.0 * t.sin(), 3.0 * j as f64 + 0.3 * (i % 7) as f64, 150.0 * t.cos()])
        };
        let scan = Cloud { points: (0..60 * 40).map(at).collect(), ..Cloud::default() };
        torse::fit(&scan, &torse::FitOptions::new(0.2 * s.scale, "scan"), &Control::default()).expect("a fit")
    });
}

/// A parabola and where its rulings of a cylinder end.
const PARABOLA: [[f64; 3]; 3] = [[0., 0., 0.], [50., 0., 40.], [100., 0., 0.]];
const BEYOND: [[f64; 3]; 3] = [[10., 90., 5.], [60., 90., 45.], [110., 90., 5.]];

#[test]
fn cones_commute_with_similarities() {
    commutes(1e-3, |s| {
        let options = torse::ConesOptions::new(0.05 * s.scale, "face");
        let face = s.ruled(&PARABOLA, &BEYOND);
        torse::cones(&[face], &[], &options, &Control::default()).expect("an answer")
    });
}

#[test]
fn fits_of_faces_commute_with_similarities() {
    commutes(1e-3, |s| {
        let options = torse::ElementFitOptions::new(0.05 * s.scale, "face");
        let face = s.ruled(&PARABOLA, &BEYOND);
        torse::fit_faces(&[face], &[], &options, &Control::default()).expect("a fit")
    });
}

#[test]
fn pulled_strips_commute_with_similarities() {
    const KEEL: [[f64; 3]; 5] =
        [[0., 0., 0.], [500., 0., -40.], [1000., 0., -50.], [1500., 0., -20.], [2000., 0., 40.]];
    const CHINE: [[f64; 3]; 5] =
        [[0., 300., 150.], [500., 420., 90.], [1000., 460., 70.], [1500., 440., 90.], [2000., 330., 150.]];
    commutes(1e-3, |s| {
        let list = |points: &[[f64; 3]]| {
            let all: Vec<String> =
                points.iter().map(|p| s.point(*p)).map(|p| format!("[{:?},{:?},{:?}]", p.x, p.y, p.z)).collect();
            format!("[{}]", all.join(","))
        };
        let point = |p: [f64; 3]| list(&[p]).trim_matches(['[', ']']).to_string();
        let handle = |u: f64, p: [f64; 3]| format!(r#"{{"curve":"keel","u":{u},"point":[{}]}}"#, point(p));
        let job = format!(
            r#"{{"unit":"mm","curves":[{{"name":"keel","through":{},"spans":4}},{{"name":"chine","through":{},"spans":4}}],
            "strips":[{{"name":"bottom","sides":["keel","chine"]}}],"handles":[{},{},{}],
            "moves":[{{"handle":2,"point":[{}],"steps":3}}]}}"#,
            list(&KEEL),
            list(&CHINE),
            handle(0.0, KEEL[0]),
            handle(1.0, KEEL[4]),
            handle(0.5, KEEL[2]),
            point([1000.0, 0.0, -90.0]),
        );
        let job = torse::io::shape::read(job.as_bytes(), "hull", None).expect("a job");
        let nothing = |name: &str| Err(format!("no file {name}"));
        torse::shape(&job, &torse::Shape::new(0.5 * s.scale), &nothing, &Control::default()).expect("a shape")
    });
}

/// A model of one face.
fn model(face: Face) -> Model {
    Model {
        faces: vec![face],
        skipped: Vec::new(),
        unit: "millimetre".into(),
        notes: Vec::new(),
        products: Vec::new(),
        curves: Vec::new(),
    }
}

#[test]
fn unrolling_commutes_with_similarities() {
    commutes(1e-6, |s| {
        let options = torse::UnrollOptions { surfaces: true, ..torse::UnrollOptions::new(0.01 * s.scale) };
        torse::unroll(&model(s.ruled(&PARABOLA, &BEYOND)), &options, &Control::default()).expect("an answer")
    });
}

/// Where the upper side of a face that twists lies.
const TWISTED: [[f64; 3]; 3] = [[0., 100., 0.], [50., 100., 60.], [100., 100., 12.]];

#[test]
fn panels_commute_with_similarities() {
    commutes(1e-2, |s| {
        let options = torse::Approximate::new(s.scale);
        torse::approximate(&model(s.ruled(&PARABOLA, &TWISTED)), &options).expect("an answer")
    });
}

/// Ruled strips over the face that twists.
fn ruled(s: &Similarity) -> RuledAnswer {
    let mut options = torse::RuledOptions { spacing: Some(10.0 * s.scale), ..torse::RuledOptions::new(2.0 * s.scale) };
    options.strips.width = Some(150.0 * s.scale);
    torse::ruled(vec![s.ruled(&PARABOLA, &TWISTED)], Vec::new(), &options, &Control::default()).expect("strips")
}

#[test]
fn ruled_strips_commute_with_similarities() {
    // A seventh of the tolerance: rulings are found as near as that asks for.
    const NEAR: f64 = 0.3;
    let [still, others @ .., all] = similarities();
    let others = [others[0], all];
    let first = ruled(&still);
    assert!(first.answer.status() == Status::Certified && first.rulings.len() > 5, "{:?}", first.answer.claims());
    let bound = |found: &RuledAnswer| found.answer.claim(What::Deviation).expect("a bound").value();
    for s in others {
        let made = ruled(&s);
        let counts = |f: &RuledAnswer| (f.answer.status(), f.answer.patchwork().panels.len(), f.rulings.len());
        assert_eq!(counts(&made), counts(&first), "scale {}", s.scale);
        assert!((bound(&made) / s.scale - bound(&first)).abs() < NEAR, "{} {}", bound(&made) / s.scale, bound(&first));
        for (new, old) in made.rulings.iter().zip(&first.rulings) {
            let [p, q] = old.ends.map(|p| s.point(p.into()));
            let off = (new.ends[0] - p).norm().max((new.ends[1] - q).norm());
            assert!(off < NEAR * s.scale, "scale {}: {} {}", s.scale, new.number, off / s.scale);
        }
    }
}

#[test]
fn ruled_strips_are_read_back_as_they_were_written() {
    let mut found = ruled(&similarities()[4]);
    let files = torse::files(&mut found.answer, "2026-01-31T12:00:00").expect("files");
    let file = files.iter().find(|f| f.0 == "panels.step").expect("a file of panels");
    let faces = torse::read(&file.1).expect("a model").faces;
    let panels = &found.answer.patchwork().panels;
    assert_eq!(faces.len(), panels.len());
    for (face, panel) in faces.iter().zip(panels) {
        assert_eq!(
            (&face.surface, face.loops.len()),
            (&panel.strip.patch, panel.loops().len()),
            "{}",
            panel.strip.name
        );
    }
}

/// What files hold, by their names.
type Files = HashMap<String, Vec<u8>>;

/// A cylinder over a parabola laid flat and written: as it is, and moved, turned and scaled.
fn laid_flat() -> &'static [(Similarity, Files); 2] {
    static LAID: OnceLock<[(Similarity, Files); 2]> = OnceLock::new();
    let [still, .., all] = similarities();
    LAID.get_or_init(|| {
        [still, all].map(|s| {
            let defaults = torse::UnrollOptions::new(0.05 * s.scale);
            let options = torse::UnrollOptions { surfaces: true, bend_step: 0.2, ..defaults };
            let model = model(s.ruled(&PARABOLA, &BEYOND));
            let mut answer = torse::unroll(&model, &options, &Control::default()).expect("an answer");
            (s, torse::files(&mut answer, "2026-01-31T12:00:00").expect("files").into_iter().collect())
        })
    })
}

#[test]
fn refolding_commutes_with_similarities_and_its_report_is_read_back_as_it_was_written() {
    // Files have digits of their own, whatever the size: a share, and what is too small to have one, of a tolerance of a twentieth.
    const NEAR: f64 = 0.05;
    const SMALL: f64 = 2e-4;
    let [(_, first), (s, made)] = laid_flat();
    let back = |files: &Files| {
        refold(&|name| files.get(name).cloned(), None, &Control::default()).expect("an answer").report()
    };
    let (first, made) = (back(first), back(made));
    assert!(first.left.is_empty() && first.parts.len() == 1, "{first:?}");
    let lengths = |r: &RefoldReport| {
        let p = &r.parts[0];
        [p.distance_bound.expect("a bound"), p.matched_estimate, p.distance_estimate]
    };
    let counts = |r: &RefoldReport| (r.status.clone(), r.parts.len(), r.parts[0].lines, r.parts[0].panels.len());
    assert_eq!(counts(&made), counts(&first));
    for (new, old) in lengths(&made).into_iter().zip(lengths(&first)) {
        assert!((new / s.scale - old).abs() < NEAR * old + SMALL, "{} {old}", new / s.scale);
    }
    let json = made.to_json().expect("JSON");
    assert_eq!(serde_json::from_str::<RefoldReport>(&json).expect("a report"), made);
}

#[test]
fn maps_commute_with_similarities_keep_lengths_and_angles_and_go_back() {
    /// Share of the parameters by which lengths and angles are taken, and what may be off.
    const STEP: f64 = 1e-3;
    const NEAR: f64 = 1e-4;
    let on_face = |u: f64, v: f64| -> [f64; 3] {
        let along = |c: &[[f64; 3]; 3], k: usize| {
            (1.0 - u) * (1.0 - u) * c[0][k] + 2.0 * u * (1.0 - u) * c[1][k] + u * u * c[2][k]
        };
        std::array::from_fn(|k| (1.0 - v) * along(&PARABOLA, k) + v * along(&BEYOND, k))
    };
    let mut places = Vec::new();
    for u in [0.2, 0.45, 0.8] {
        for v in [0.25, 0.7] {
            places.extend([on_face(u, v), on_face(u + STEP, v), on_face(u, v + STEP)]);
        }
    }
    let mut first: Vec<f64> = Vec::new();
    for (s, made) in laid_flat() {
        let map = read_map(&|name| made.get(name).cloned(), None, None).expect("a map");
        let given: Vec<(usize, Vec3)> = places.iter().map(|p| s.point(*p)).enumerate().collect();
        let carried = |points: &[(usize, Vec3)], to| -> Vec<Vec3> {
            map.points(points, to).iter().map(|r| r.place.expect("a place on the part")).collect()
        };
        let flat = carried(&given, Side::Flat);
        let back = carried(&flat.iter().copied().enumerate().collect::<Vec<_>>(), Side::Space);
        for ((_, p), q) in given.iter().zip(&back) {
            assert!((p - q).norm() < NEAR * s.scale, "scale {}: {p:?} {q:?}", s.scale);
        }
        for (space, plane) in given.chunks(3).zip(flat.chunks(3)) {
            let [a, b] = [1, 2].map(|k| space[k].1 - space[0].1);
            let [c, d] = [1, 2].map(|k| plane[k] - plane[0]);
            let size = a.norm() * b.norm();
            for (old, new) in [(a.dot(&a), c.dot(&c)), (b.dot(&b), d.dot(&d)), (a.dot(&b), c.dot(&d))] {
                assert!((old - new).abs() < NEAR * size, "scale {}: {old} {new}", s.scale);
            }
        }
        // Patterns lie anywhere in the plane: their lengths tell.
        let between: Vec<f64> = flat.iter().map(|p| (p - flat[0]).norm() / s.scale).collect();
        if first.is_empty() {
            first.clone_from(&between);
        }
        assert!(
            between.iter().zip(&first).all(|(a, b)| (a - b).abs() < NEAR),
            "scale {}: {between:?} {first:?}",
            s.scale
        );
        // Farther from the part than the tolerance nothing is carried, whatever the scale.
        let away = map.points(&[(0, s.point([50.0, 45.0, 80.0]))], Side::Flat);
        assert!(away[0].place.is_none() && away[0].distance > s.scale, "{away:?}");
    }
}

#[test]
fn what_is_measured_of_faces_commutes_with_similarities() {
    let measured = |s: &Similarity| {
        let faces = [s.ruled(&PARABOLA, &BEYOND), s.ruled(&PARABOLA, &TWISTED)];
        let all = torse::measure(&faces);
        let of = |k: usize| {
            let f = &all[k];
            let curvatures = [f.curvature_min, f.curvature_max].map(|r| (r.min * s.scale, r.max * s.scale));
            let gaussian = (f.gaussian.min * s.scale.powi(2), f.gaussian.max * s.scale.powi(2));
            (f.character(), f.area_estimate / s.scale.powi(2), [curvatures[0], curvatures[1], gaussian])
        };
        [of(0), of(1)]
    };
    let [still, others @ ..] = similarities();
    let first = measured(&still);
    assert_eq!(first.each_ref().map(|f| f.0), ["developable", "saddle-like"]);
    for s in others {
        for (new, old) in measured(&s).into_iter().zip(&first) {
            assert_eq!(new.0, old.0, "scale {}", s.scale);
            assert!((new.1 - old.1).abs() < 1e-9 * old.1, "scale {}: {} {}", s.scale, new.1, old.1);
            for (a, b) in new.2.iter().zip(&old.2) {
                assert!((a.0 - b.0).abs().max((a.1 - b.1).abs()) < 1e-9, "scale {}: {a:?} {b:?}", s.scale);
            }
        }
    }
}

/// Certified answers whose strips keep to their rails wherever one looks, and whose twist is nowhere above what is proven.
fn is_honest(answer: &Answer, rails: &[&Rail], tolerance: f64) {
    const STEPS: usize = 60;
    const DENSE: usize = 3000;
    // Rounding of what is measured, degrees.
    const MEASURED: f64 = 1e-12;
    if answer.status() != Status::Certified {
        return;
    }
    let proven = answer.claim(What::Twist).expect("a bound").value();
    for (side, rail) in rails.iter().enumerate() {
        let points = rail.samples(DENSE);
        // Half of the way from sample to sample, along the rail.
        let between = rail.length() / DENSE as f64;
        for strip in answer.strips() {
            let (a, b) = strip.domain();
            for u in (0..=STEPS).map(|k| a + (b - a) * k as f64 / STEPS as f64) {
                let end = strip.ruling(u)[side];
                let off = points.iter().map(|p| (p - end).norm()).fold(f64::INFINITY, f64::min);
                assert!(off <= tolerance + between, "{off} from {}", rail.name);
                let fan = strip.is_point(0) || strip.is_point(1);
                assert!(
                    fan || strip.twist(u).to_degrees() <= proven + MEASURED,
                    "{} above {proven}",
                    strip.twist(u).to_degrees()
                );
            }
        }
    }
}

/// Smallness from plain to beyond rounding.
const SMALL: [f64; 5] = [1e-2, 1e-5, 1e-8, 1e-11, 1e-15];

#[test]
fn lofts_between_nearly_flat_and_nearly_touching_rails_are_honest() {
    let [still, ..] = similarities();
    let mut judged = 0;
    for small in SMALL {
        let nearly = |points: [[f64; 3]; 5], by: [f64; 3]| points.map(|p| [p[0] * by[0], p[1] * by[1], p[2] * by[2]]);
        // Nearly in one plane, nearly one point, nearly the same curve.
        let rail = |name: &str, points: [[f64; 3]; 5]| still.maybe_rail(name, 3, &points);
        let pairs = [
            (rail("low", nearly(LOW, [1.0, 1.0, small])), rail("high", nearly(HIGH, [1.0, 1.0, small]))),
            (rail("low", LOW), rail("point", nearly(HIGH, [small; 3]).map(|p| [p[0] + 100.0, p[1], p[2] + 200.0]))),
            (rail("low", LOW), rail("same", LOW.map(|p| [p[0], p[1], p[2] + 1000.0 * small]))),
        ];
        for (a, b) in pairs {
            // What is refused is refused by name, which is an answer too.
            let (Ok(a), Ok(b)) = (a, b) else { continue };
            if let Ok(answer) = torse::loft(&a, &b, &torse::Loft::new(0.05), &Control::default()) {
                is_honest(&answer, &[&a, &b], 0.05);
                judged += usize::from(answer.status() == Status::Certified);
            }
        }
    }
    assert!(judged > 3, "{judged} certified answers are too few to say anything");
}

#[test]
fn nets_between_nearly_parallel_and_nearly_meeting_rulings_are_honest() {
    let [still, ..] = similarities();
    let keel = still.rail("keel", 3, &LOW);
    let mut judged = 0;
    let first = Vec3::new(10.0, 90.0, 60.0);
    for small in SMALL {
        for direction in [first + Vec3::new(small, -small, small) * 50.0, first * -1.0 + Vec3::x() * small] {
            let last = Condition::LastRuling { direction, width: None };
            let options = torse::Net::new(0.05, first, last);
            if let Ok(answer) = torse::net(&keel, &options, &Control::default()) {
                is_honest(&answer, &[&keel], 0.05);
                judged += usize::from(answer.status() == Status::Certified);
            }
        }
    }
    assert!(judged > 3, "{judged} certified answers are too few to say anything");
}
