use super::envelope::Envelope;
use super::form::{Band, Tie};
use super::profile::Profile;
use super::program::{distances, COUNTS};
use super::strip::Strip;
use super::*;
use crate::brep::face::Face;
use crate::brep::support_surface::SupportSurface;
use crate::fit::near::samples::Fit;
use crate::fit::panels::boundary::Borders;
use crate::geom::Frame;
use crate::num::runs::Runs;
use crate::spline::knots::Knots;
use crate::spline::lsq;
use crate::torse::form::{DualTorse, PanelKind};
use std::collections::BTreeSet;
use std::sync::Arc;

const RADIUS: f64 = 500.0;

/// Point of the unit sphere with longitude a and latitude b.
fn radial(a: f64, b: f64) -> Vec3 {
    Vec3::new(b.cos() * a.cos(), b.cos() * a.sin(), b.sin())
}

/// The cone tangent to the sphere along a parallel from longitude 0 to `end`, its rulings of unequal length; beyond both ends it
/// may leave the sphere, by the square of the longitude.
fn tangent_cone(b: f64, (end, leaves): (f64, f64)) -> DualTorse {
    let angles: Vec<f64> = (0..=400).map(|i| -0.2 + (end + 0.4) * f64::from(i) / 400.0).collect();
    let plane = |a: f64| {
        let (n, beyond) = (radial(a, b), (-a).max(a - end).max(0.0));
        [n.x, n.y, n.z, RADIUS * (1.0 + leaves * beyond * beyond)]
    };
    let planes: Vec<[f64; 4]> = angles.iter().map(|&a| plane(a)).collect();
    let knots = Knots::uniform(3, 20 * end.ceil() as usize, angles[0], angles[400]).expect("knots");
    DualTorse { planes: lsq::fit(&planes, &angles, &knots).expect("planes").curve }
}

/// The sphere between longitudes 0 and 1 and the outer latitudes, cut at the inner ones, with tangent cones.
fn zones(latitudes: &[f64]) -> Cover {
    zones_to((1.0, 0.0), latitudes)
}

/// The same to another longitude, with cones that leave the sphere beyond.
fn zones_to((end, leaves): (f64, f64), latitudes: &[f64]) -> Cover {
    let last = latitudes.len() - 1;
    let sphere = SupportSurface::Sphere { frame: Frame::world(), radius: RADIUS };
    let (surface, map) = sphere.to_spline((0.0, end), (latitudes[0], latitudes[last])).expect("a spline");
    let face = Face::untrimmed(surface);
    let mut cover = Cover::of_face(&face, 30.0).expect("a cover");
    cover.partition.labels.fill(0);
    for (k, &b) in latitudes[1..last].iter().enumerate() {
        let at = map[1].forward(b);
        cover.cut(k as u32, k as u32 + 1, |p| p[1] - at);
    }
    for (k, w) in latitudes.windows(2).enumerate() {
        let torse = Torse::Dual(tangent_cone(0.5 * (w[0] + w[1]), (end, leaves)));
        cover.panels.insert(k as u32, Arc::new(Fit { torse, kind: PanelKind::Cone, error: 0.0, worst: 0 }));
    }
    cover
}

fn asked(held: &dyn Fn([u32; 2]) -> bool, tolerance: f64) -> Asked<'_> {
    static ALL: BTreeSet<u32> = BTreeSet::new();
    Asked { held, without: &ALL, regular: 0.9, tolerance, borders: None, most: f64::INFINITY }
}

fn chains(cover: &Cover) -> Vec<SeamChain> {
    Borders::new(&cover.face, &cover.partition, &|_, _| 0, 0).seam_chains()
}

/// Strips as far as one program takes them.
fn joined(cover: &Cover, chains: Vec<SeamChain>, asked: &Asked, control: &Control) -> Option<Joined> {
    Joint::new(cover, chains, asked)?.joined(control)
}

/// What half the sagitta of a zone is.
fn half_sagitta(width: f64) -> f64 {
    RADIUS * (1.0 - (0.5 * width).cos()) / 2.0
}

#[test]
fn unequal_zones_become_even_by_slides() {
    // Widths 0.13, 0.09, 0.11; three even zones of 0.11 are off by half their sagitta.
    let cover = zones(&[-0.15, -0.02, 0.07, 0.18]);
    let tolerance = half_sagitta(0.11) / 0.9;
    let free = Control::default();
    let found = joined(&cover, chains(&cover), &asked(&|_| false, tolerance), &free).expect("joined");
    assert!(found.start[0] > 1.5, "{:?}", found.start);
    let end = found.steps.last().expect("a step").reached;
    assert!(end[0] < 0.97 && end[1] < 0.03 && found.steps.len() <= 6, "{:?}", found.steps);
    // Lines that must stay leave the wide zone as far off as it is alone.
    let held = joined(&cover, chains(&cover), &asked(&|_| true, tolerance), &free).expect("joined");
    let end = held.steps.last().expect("a step").reached;
    assert!(end[0] > 0.97 * half_sagitta(0.13) / tolerance, "{:?}", held.steps);
    for (a, b) in held.lines.iter().zip(chains(&cover)) {
        let v = cover.partition.vertices[b.vertices[0] as usize];
        assert!(a.uv.iter().all(|p| (p[1] - v[1]).abs() < 1e-6 * v[1].abs().max(1.0)));
    }
}

/// Zones that go all round overlap themselves where they begin: what they are there at their other end does not count.
#[test]
fn zones_all_round_have_their_own_feet() {
    let cover = zones_to((std::f64::consts::TAU, 0.1), &[0.3, 0.41, 0.52]);
    let tolerance = half_sagitta(0.11) / 0.9;
    let held = |_| false;
    let found = joined(&cover, chains(&cover), &asked(&held, 2.0 * tolerance), &Control::default());
    let start = found.expect("joined").start;
    assert!(start[0] < 1.0, "{start:?}");
}

#[test]
fn edges_lie_on_both_strips() {
    let cover = zones(&[-0.15, -0.02, 0.07, 0.18]);
    let tolerance = half_sagitta(0.11) / 0.9;
    let found = joined(&cover, chains(&cover), &asked(&|_| false, tolerance), &Control::default()).expect("joined");
    for l in &found.lines {
        let edge = l.edge.as_ref().expect("an edge");
        let (a, b) = edge.domain();
        for k in 5..=95 {
            let x = Vec3::from(edge.point(a + (b - a) * f64::from(k) / 100.0));
            for torse in found.torses.iter().filter(|t| l.labels.contains(&t.0)).map(|t| &t.1) {
                let t =
                    strip::FootGuesses::of(torse).near(&x).into_iter().find_map(|t| torse.foot(&x, t)).expect("a foot");
                assert!(torse.plane_distance(&x, t).abs() < 1e-4 * tolerance);
            }
        }
    }
}

#[test]
fn strips_that_are_left_out_keep_their_borders() {
    let mut cover = zones(&[-0.15, -0.04, 0.07, 0.18]);
    let tolerance = half_sagitta(0.11) / 0.9;
    let free = Control::default();
    let last = BTreeSet::from([2]);
    let all = asked(&|_| false, tolerance);
    let found = joined(&cover, chains(&cover), &Asked { without: &last, ..all }, &free).expect("joined");
    assert_eq!(found.torses.iter().map(|t| t.0).collect::<Vec<_>>(), [0, 1]);
    assert_eq!((found.lines.len(), found.lines[0].edge.is_some()), (1, true));
    assert!(found.distances.iter().all(|d| *d < 0.97), "{:?}", found.distances);
    // A strip without a torse cannot take part, and is left out without being asked.
    cover.panels.remove(&2);
    let found = joined(&cover, chains(&cover), &all, &free).expect("joined");
    assert_eq!((found.torses.len(), found.lines.len()), (2, 1));
    let none = BTreeSet::from([0, 2]);
    assert!(joined(&cover, chains(&cover), &Asked { without: &none, ..all }, &free).is_none());
}

/// Distances and what must keep its sign against small changes of every unknown of a strip in turn.
#[test]
fn rows_of_strips_match_differences() {
    let cone = tangent_cone(0.06, (1.0, 0.0));
    let range = (-0.15, 1.15);
    let strips =
        [Envelope::new(&cone, range, 12).map(Strip::Planes), Profile::of_planes(&cone, range, 12).map(Strip::Profile)];
    for strip in strips.into_iter().map(|s| s.expect("a strip")) {
        let at = match &strip {
            Strip::Planes(e) => e.greville(),
            Strip::Profile(_) => vec![strip.torse().domain().0],
        };
        let ruling = |t: f64| {
            let r = strip.torse().ruling(t);
            let point =
                |b: f64| r.point + r.direction * (r.direction.dot(&(radial(t.clamp(0.0, 1.0), b) * RADIUS - r.point)));
            (t, [point(0.06), point(0.0), point(0.12)])
        };
        let band = Band { rulings: at.into_iter().map(ruling).collect(), half_width: 30.0 };
        let strip = strip.on_band(&band);
        for (a, b) in [(0.1, 0.01), (0.43, 0.11), (0.8, 0.05)] {
            let x = radial(a, b) * (RADIUS + 0.3);
            let t = strip::FootGuesses::of(strip.torse()).near(&x)[0];
            let foot = strip.foot(&x, t, 1.0).expect("a foot");
            let (mut rows, mut regular) = (Runs::default(), Runs::default());
            strip.row(0, &x, &foot, 1.0, &mut rows);
            let way = strip.regular_row(0, &x, &foot, 1.0, &mut regular);
            rows.end();
            regular.end();
            let ruling = strip.torse().ruling(foot.t).direction;
            for axis in [ruling, ruling.cross(&foot.normal)] {
                let at = |h: f64| strip.foot(&(x + axis * h), foot.t, 1.0).expect("a foot").regular;
                let change = (at(1e-3) - at(-1e-3)) / 2e-3;
                let size = foot.regular.abs() / RADIUS;
                assert!((change - way.dot(&axis)).abs() < 0.05 * (change.abs() + size), "{change} {}", way.dot(&axis));
            }
            for j in 0..strip.unknowns() {
                let h = 1e-3;
                let moved = |h: f64| {
                    let mut change = vec![0.0; strip.unknowns()];
                    change[j] = h;
                    strip.moved(&change).expect("a strip").foot(&x, foot.t, 1.0).expect("a foot")
                };
                let (up, down) = (moved(h), moved(-h));
                let unit: Vec<f64> = (0..strip.unknowns()).map(|i| f64::from(u8::from(i == j))).collect();
                let d = (up.distance - down.distance) / (2.0 * h);
                assert!((d - rows.dot(0, &unit)).abs() < 1e-5, "{j}: {d} {}", rows.dot(0, &unit));
                let g = (up.regular - down.regular) / (2.0 * h);
                let expected = regular.dot(0, &unit);
                assert!((g - expected).abs() < 0.1 * (g.abs() + 1e-3 * foot.regular.abs()), "{j}: {g} {expected}");
            }
        }
    }
}

/// Distances and gaps against a slide of a line, alike all along it.
#[test]
fn rows_of_a_line_match_differences() {
    let cover = zones(&[0.0, 0.12, 0.2]);
    let network = start::network(&cover, chains(&cover), &asked(&|_| false, 1.0)).expect("a network");
    let fleet = Fleet::of(network.clone());
    let columns = fleet.columns();
    let mut tie = Tie { damping: 1.0, ..Tie::none() };
    let program = distances(&fleet, &columns, 1.0, &mut tie).expect("rows");
    let columns = &columns[0];
    let mut x = vec![0.0; program.limits.len()];
    x[columns.slides[0]..columns.slides[0] + 12].fill(1e-3);
    let next = network.stepped(columns, &x).expect("a step");
    let first = program.hard.len() - 2 * network.lines[0].count;
    // Samples beside the line, which go with it.
    let largest = network.largest_of_strips();
    let counts = |s: &&super::network::Sample| {
        s.lean(&s.foot.expect("a foot")) * s.foot.expect("a foot").distance.abs() > COUNTS * largest[s.strip]
    };
    let mut carried = 0;
    for (k, s) in network.samples.iter().filter(counts).enumerate() {
        let foot = s.foot.expect("a foot");
        let expected = program.hard.dot(k, &x);
        let Some((_, p, share)) = network.carried(s) else {
            assert!(expected == 0.0);
            continue;
        };
        carried += 1;
        let gone = s.x + p.slide * (share * network.unit * 1e-3);
        let moved = network.members[s.strip].foot(&gone, foot.t).expect("a foot");
        let change = s.lean(&foot) * (moved.distance - foot.distance);
        assert!((change - expected).abs() < 0.02 * expected.abs() + 1e-6, "{k}: {change} {expected}");
    }
    assert!(carried > 20, "{carried}");
    for (k, (p, q)) in next.lines[0].points.iter().zip(&network.lines[0].points).enumerate() {
        for e in 0..2 {
            let change = p.feet[e].expect("a foot").distance - q.feet[e].expect("a foot").distance;
            let expected = program.hard.dot(first + 2 * k + e, &x);
            assert!((change - expected).abs() < 0.02 * expected.abs() + 1e-7, "{k}: {change} {expected}");
        }
        let gap = p.middle.expect("a middle").gap() - q.middle.expect("a middle").gap();
        let expected = tie.rows.dot(k, &x);
        assert!((gap - expected).abs() < 0.02 * expected.abs() + 1e-7, "{k}: {gap} {expected}");
    }
}

#[test]
fn one_strip_has_nothing_to_be_joined_with() {
    let cover = zones(&[0.0, 0.1]);
    assert!(joined(&cover, Vec::new(), &asked(&|_| false, 1.0), &Control::default()).is_none());
}

/// Strips of two faces, which are one sphere, become equally high along the border between these.
#[test]
fn strips_of_two_faces_become_equally_high_where_these_meet() {
    let faces = [zones(&[-0.15, -0.02]), zones(&[-0.02, 0.07])];
    let tolerance = half_sagitta(0.13) / 0.8;
    let (even, held) = (|_: &Vec3| 1.0, |_: [u32; 2]| false);
    let asked = Asked { borders: Some(&even), ..asked(&held, tolerance) };
    let meeting = |k: u32| {
        let normal = radial(f64::from(k) / 40.0, -0.02);
        let (places, normals) = ([normal * RADIUS; 2], [normal; 2]);
        Meeting { faces: [0, 1], labels: [0; 2], places, normals, share: 1.0 / 41.0, edge: 0, length: RADIUS }
    };
    let meetings: Vec<Meeting> = (0..=40).map(meeting).collect();
    let given = faces.iter().map(|cover| Some((cover, Vec::new(), &asked))).collect();
    let mut joint = Joint::of_faces(given, &meetings);
    assert!(joint.start[1] > 0.5, "{:?}", joint.start);
    let found = joint.joined_all(&Control::default());
    for m in &meetings {
        let height = |k: usize| {
            let (torse, x) = (&found[k].as_ref().expect("joined").torses[0].1, &m.places[k]);
            let t = strip::FootGuesses::of(torse).near(x).into_iter().find_map(|t| torse.foot(x, t)).expect("a foot");
            torse.plane_distance(x, t).abs() / tolerance
        };
        let heights = [height(0), height(1)];
        assert!((heights[0] - heights[1]).abs() < 0.02 && heights[0] < 0.97, "{heights:?}");
    }
}

/// Beside finer strips lines have two points for every span, on the curve that they had.
#[test]
fn lines_beside_finer_strips_have_more_points() {
    let cover = zones(&[0.0, 0.2, 0.4]);
    let held = |_: [u32; 2]| false;
    let network = start::network(&cover, chains(&cover), &asked(&held, 1.0)).expect("a network");
    let line = &network.lines[0];
    let spans = network.members.iter().map(|m| m.strip.spans()).fold(0, usize::max);
    assert!(line.count == line.points.len() && line.count > 2 * spans);
    let finer = line.clone().for_spans(2 * (line.count - 1), &cover.face, 1.0).expect("a line");
    assert_eq!(finer.points.len(), 4 * (line.count - 1) + 1);
    for (p, q) in line.points.iter().zip(finer.points.iter().step_by(4)) {
        assert!((p.x - q.x).norm() < 1e-6 * line.length, "{} {}", p.x, q.x);
    }
}
