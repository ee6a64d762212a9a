//! Strips bent back beside panels whose distance is known.

use super::*;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use crate::torse::ribbon::pose::Rates;

const RADIUS: f64 = 100.0;
const HEIGHT: f64 = 50.0;
const TURN: f64 = 0.5;

/// A piece of a circular cylinder of the radius 100: its rail in the parameter 0 to 1.
fn patch() -> Surface {
    let (s, c) = (0.5 * TURN).sin_cos();
    let rail = [Vec2::new(-s, c), Vec2::new(0.0, 1.0 / c), Vec2::new(s, c)];
    let points: Vec<Vec3> =
        rail.iter().flat_map(|p| [0.0, HEIGHT].map(|z| Vec3::new(RADIUS * p.x, RADIUS * p.y, z))).collect();
    let weights = [1.0, 1.0, c, c, 1.0, 1.0];
    let knots = |p: usize| Knots::clamped(p, &[0.0, 1.0]).expect("knots");
    Surface::new(knots(2), knots(1), &points, Some(&weights)).expect("a surface")
}

/// The parameter of an angle from the middle.
fn parameter(angle: f64) -> f64 {
    let s = patch();
    let (mut a, mut b) = (0.0, 1.0);
    for _ in 0..60 {
        let m = 0.5 * (a + b);
        let p = s.point(m, 0.0);
        if p.x.atan2(p.y) < angle {
            a = m;
        } else {
            b = m;
        }
    }
    0.5 * (a + b)
}

/// A rectangle bent to a cylinder of a radius in `n` spans, with its outline.
fn strip(n: usize, radius: f64) -> (Vec<Span>, Vec<Along>, Vec<SpanChord>) {
    let angle = |k: usize| -0.5 * TURN + TURN * k as f64 / n as f64;
    let step = RADIUS * TURN / n as f64;
    let rates = Rates { turn: step / radius, across: step, ..Rates::default() };
    let flat = |k: usize| Pose::flat(Vec2::new(step * k as f64, 0.0), -Vec2::y());
    // The first ruling as it lies on the patch, then on and on.
    let a = angle(0);
    let (e, b) = (-Vec3::z(), Vec3::new(a.cos(), -a.sin(), 0.0));
    let axes = nalgebra::Matrix3::from_columns(&[e, b, e.cross(&b)]);
    let mut space = Pose { axes, at: Vec3::new(RADIUS * a.sin(), RADIUS * a.cos(), 0.0) };
    let mut spans = Vec::new();
    for k in 0..n {
        let in_plane = Rates { turn: 0.0, ..rates };
        let in_space = Rates { turn: -rates.turn, ..rates };
        let reach = [-HEIGHT, 0.0];
        // Inwards, to the axis, is where the sheet turns.
        let in_space =
            if space.normal().dot(&space.at) < 0.0 { Rates { turn: rates.turn, ..in_space } } else { in_space };
        spans.push(Span { flat: flat(k), space, in_plane, in_space, reach });
        space = space.moved(&in_space, 1.0);
    }
    let places = (0..=n)
        .map(|k| Along { at: [parameter(angle(k)), 0.0], slope: [0.0, -1.0 / HEIGHT], bend: [0.0; 2] })
        .collect();
    let drawn = |k: usize, v: f64| Vec2::new(step * k as f64, -v);
    let low = (0..n).map(|k| SpanChord {
        span: k,
        ends: [[0.0, 0.0], [1.0, 0.0]],
        border: [k, k + 1].map(|k| parameter(angle(k))),
        drawn: Some([drawn(k, 0.0), drawn(k + 1, 0.0)]),
    });
    let high = (0..n).rev().map(|k| SpanChord {
        span: k,
        ends: [[1.0, -HEIGHT], [0.0, -HEIGHT]],
        border: [k + 1, k].map(|k| 3.0 - parameter(angle(k))),
        drawn: Some([drawn(k + 1, -HEIGHT), drawn(k, -HEIGHT)]),
    });
    let side = |span: usize, s: f64, ways: [f64; 2], border: [f64; 2], k: usize| SpanChord {
        span,
        ends: ways.map(|v| [s, v]),
        border,
        drawn: Some(ways.map(|v| drawn(k, v))),
    };
    let mut line: Vec<SpanChord> = low.collect();
    line[0].border[0] = 0.0;
    line[n - 1].border[1] = 1.0;
    line.push(side(n - 1, 1.0, [0.0, -HEIGHT], [1.0, 2.0], n));
    line.extend(high);
    line[n + 1].border[0] = 2.0;
    line[2 * n].border[1] = 3.0;
    line.push(side(0, 0.0, [-HEIGHT, 0.0], [3.0, 4.0], 0));
    (spans, places, line)
}

const BORDER: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

fn bound(n: usize, radius: f64, change: impl Fn(&mut Vec<Span>, &mut Vec<SpanChord>)) -> Result<f64, Unshown> {
    let (mut spans, places, mut line) = strip(n, radius);
    change(&mut spans, &mut line);
    let (surface, borders) = (patch(), [BORDER.to_vec()]);
    let stretch = Stretch {
        spans: &spans,
        places,
        lines: vec![(0, line)],
        panel: &JudgedPanel::by_parameters(&surface, &borders),
        chords: 0.0,
    };
    distance(&stretch, &Control::default()).map(UpperBound::value)
}

#[test]
fn a_cylinder_bent_back_rightly_is_on_its_panel() {
    for n in [20, 100] {
        let found = bound(n, RADIUS, |_, _| {}).expect("a bound");
        assert!(found < 1.0 / (n * n) as f64, "{n}: {found:e}");
    }
}

#[test]
fn bounds_are_the_same_on_any_number_of_threads_and_stop_when_asked() {
    let (spans, places, line) = strip(20, 1.01 * RADIUS);
    let (surface, borders) = (patch(), [BORDER.to_vec()]);
    let lines = vec![(0, line)];
    let stretch =
        Stretch { spans: &spans, places, lines, panel: &JudgedPanel::by_parameters(&surface, &borders), chords: 0.0 };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| distance(&stretch, &Control::default())).map(|b| b.value().to_bits())
    };
    assert!(on(1).is_ok() && [2, 5].into_iter().all(|n| on(n) == on(1)));
    let stopped = Control::default();
    stopped.cancel();
    assert!(matches!(distance(&stretch, &stopped), Err(Unshown::Stopped)));
}

#[test]
fn what_enclosures_leave_falls_with_the_parts() {
    let (spans, places, line) = strip(3, RADIUS);
    let (surface, borders) = (patch(), [BORDER.to_vec()]);
    let lines = vec![(0, line)];
    let stretch =
        Stretch { spans: &spans, places, lines, panel: &JudgedPanel::by_parameters(&surface, &borders), chords: 0.0 };
    let judge = Judge::new(&stretch).expect("a judge");
    let [coarse, fine] = [1, 8].map(|n| judge.span(1, n));
    // The greatest distance at places of the span.
    let seen = (0..=20).map(|i| judge.corner(1, f64::from(i) / 20.0, 0.0)).fold(0.0, f64::max);
    assert!(seen <= fine && fine < 0.5 * coarse && fine < 2.0 * seen, "{seen} {fine} {coarse}");
}

/// A plane panel whose rulings fan out, and a part whose rulings are parallel: on the panel these are curves of its parameters.
#[test]
fn rulings_across_those_of_the_panel_are_followed() {
    let corners = [[0.0, 0.0], [0.0, HEIGHT], [RADIUS, 0.0], [2.0 * RADIUS, HEIGHT]];
    let points = corners.map(|c| Vec3::new(c[0], c[1], 0.0));
    let knots = || Knots::clamped(1, &[0.0, 1.0]).expect("knots");
    let surface = Surface::new(knots(), knots(), &points, None).expect("a surface");
    let (from, step) = (60.0, 4.0);
    let ruling = |x: f64, curved: bool| {
        let at = |v: f64| [x / (RADIUS * (1.0 - v / HEIGHT)), -v / HEIGHT];
        let [p, m, q] = [0.0, -0.5 * HEIGHT, -HEIGHT].map(at);
        let square = if curved { HEIGHT * HEIGHT } else { f64::INFINITY };
        let bend = [0, 1].map(|d: usize| 4.0 * (0.5 * (p[d] + q[d]) - m[d]) / square);
        Along { at: p, slope: [0, 1].map(|d: usize| bend[d] * HEIGHT - (q[d] - p[d]) / HEIGHT), bend }
    };
    let pose = Pose::flat(Vec2::new(from, 0.0), -Vec2::y());
    let rates = Rates { across: step, ..Rates::default() };
    let spans = [Span { flat: pose, space: pose, in_plane: rates, in_space: rates, reach: [-HEIGHT, 0.0] }];
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, -HEIGHT], [0.0, -HEIGHT]];
    let piece =
        |k: usize| SpanChord { span: 0, ends: [corners[k], corners[(k + 1) % 4]], border: [0.0; 2], drawn: None };
    let borders = [BORDER.to_vec()];
    let found = [false, true].map(|curved| {
        let places = [from, from + step].map(|x| ruling(x, curved)).to_vec();
        let lines = vec![(0, (0..4).map(piece).collect())];
        let stretch = Stretch {
            spans: &spans,
            places,
            lines,
            panel: &JudgedPanel::by_parameters(&surface, &borders),
            chords: 0.0,
        };
        let judge = Judge::new(&stretch).expect("a judge");
        assert!(judge.orientation(0, [-HEIGHT, 0.0]).is_some());
        let seen = (0..=20).map(|i| judge.corner(0, 0.5, -HEIGHT * f64::from(i) / 20.0)).fold(0.0, f64::max);
        let bound = judge.span(0, 8);
        assert!(seen <= bound && bound < 1.2 * seen, "{seen} {bound}");
        bound
    });
    assert!(found[0] > 5.0 && found[1] < 0.2 * found[0], "{found:?}");
}

#[test]
fn beyond_the_part_nothing_is_asked() {
    // A part that ends along a line across one wide span: only beside it would its corner be off.
    let (mut spans, places, _) = strip(1, RADIUS);
    spans[0].in_space.spin = 0.05;
    let piece = |[a, b]: [[f64; 2]; 2]| SpanChord { span: 0, ends: [a, b], border: [0.0; 2], drawn: None };
    let [a, b, c] = [[0.0, 0.0], [1.0, -HEIGHT], [0.0, -HEIGHT]];
    let lines = vec![(0, vec![piece([a, b]), piece([b, c]), piece([c, a])])];
    let (surface, borders) = (patch(), [BORDER.to_vec()]);
    let stretch =
        Stretch { spans: &spans, places, lines, panel: &JudgedPanel::by_parameters(&surface, &borders), chords: 0.0 };
    let judge = Judge::new(&stretch).expect("a judge");
    let near = |found: Option<[f64; 2]>, wanted: [f64; 2]| {
        found.is_some_and(|f| f.iter().zip(wanted).all(|(x, y)| (x - y).abs() < 1e-6))
    };
    assert!(near(judge.column(0, [0.0, 1.0]), [-HEIGHT, 0.0]) && near(judge.column(0, [0.5, 1.0]), [-HEIGHT, -25.0]));
    assert!(near(judge.column(0, [0.25, 0.5]), [-HEIGHT, -12.5]));
    // Nothing that lies in the part is left out.
    let inside = |s: f64, v: f64| judge.corner(0, s, v);
    let seen = (0..=20).flat_map(|i| (0..=20).map(move |j| (f64::from(i) / 20.0, f64::from(j) / 20.0)));
    let seen = seen.map(|(s, x)| inside(s, -HEIGHT + x * (1.0 - s) * HEIGHT)).fold(0.0, f64::max);
    let [coarse, fine] = [1, 16].map(|n| judge.span(0, n));
    assert!(seen <= fine && fine < 0.9 * coarse, "{seen} {fine} {coarse}");
}

#[test]
fn another_radius_is_as_far_off_as_its_last_ruling() {
    for radius in [99.0, 101.0] {
        let found = bound(50, radius, |_, _| {}).expect("a bound");
        let (spans, ..) = strip(50, radius);
        let last = spans[49].space.moved(&spans[49].in_space, 1.0).at;
        let there = Vec3::new(RADIUS * (0.5 * TURN).sin(), RADIUS * (0.5 * TURN).cos(), 0.0);
        let off = (last - there).norm();
        assert!(found >= off && found < 1.2 * off + 1e-3, "{found} {off}");
    }
}

#[test]
fn places_moved_anywhere_are_noticed() {
    let right = bound(50, RADIUS, |_, _| {}).expect("a bound");
    // A ruling in the middle that is off, a drawing that is, and an outline that ends before the panel does.
    let off = bound(50, RADIUS, |s, _| s[25].space.at.x += 0.5).expect("a bound");
    assert!(off >= 0.5 && off > right, "{off}");
    let drawn = bound(50, RADIUS, |_, l| l[7].drawn = l[7].drawn.map(|d| [d[0], d[1] + Vec2::new(0.0, 0.3)]));
    assert!(drawn.expect("a bound") >= 0.3);
    let short = bound(50, RADIUS, |_, l| {
        let near = |v: f64| if v < -0.5 * HEIGHT { v + 1.0 } else { v };
        l.iter_mut().for_each(|p| p.ends = p.ends.map(|[s, v]| [s, near(v)]));
    });
    assert!(short.expect("a bound") >= 1.0);
}

#[test]
fn open_lines_and_folds_show_nothing() {
    assert_eq!(bound(50, RADIUS, |_, l| l.truncate(60)), Err(Unshown::Lines));
    // An outline that crosses itself: both sides of two spans change places.
    let crossed = bound(50, RADIUS, |_, l| {
        let other = |v: f64| -HEIGHT - v;
        l.iter_mut().filter(|p| p.span < 2).for_each(|p| {
            let share = |s: f64| (p.span as f64 + s) / 2.0;
            p.ends = p.ends.map(|[s, v]| [s, other(v) + (v - other(v)) * share(s)]);
        });
    });
    assert_eq!(crossed, Err(Unshown::Lines));
    let turned = bound(50, RADIUS, |s, _| s[10].in_plane.across = -1.0);
    assert_eq!(turned, Err(Unshown::Folds));
}
