//! Two jobs of a sheet metal shop from their files to their drawings: a pipe with a conical branch, whose edges must meet, and a
//! trough over a spline with holes across its bends. What is expected is computed here, from the measures of the models.

use std::f64::consts::{PI, TAU};
use std::path::Path;
use std::process::Command;

/// Largest distance allowed, mm, as given to the program.
const TOLERANCE: f64 = 0.01;

type Point = [f64; 2];

/// What the program writes of a model: its report and its drawing.
struct Flat {
    report: serde_json::Value,
    drawing: String,
}

fn unrolled(model: &str) -> Flat {
    let dir = tempfile::tempdir().expect("a folder");
    let out = dir.path().join("flat");
    let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data").join(model);
    let mut command = Command::new(env!("CARGO_BIN_EXE_torse"));
    command.arg("unroll").arg(model).args(["--surfaces", "--tolerance", "0.01mm", "--out"]).arg(&out);
    let run = command.output().expect("torse runs");
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    let read = |name: &str| std::fs::read_to_string(out.join(name)).expect(name);
    let report: serde_json::Value = serde_json::from_str(&read("report.json")).expect("JSON");
    assert_eq!((&report["status"], &report["skipped"]), (&"certified".into(), &serde_json::json!([])));
    Flat { report, drawing: read("patterns.dxf") }
}

impl Flat {
    fn areas(&self) -> Vec<f64> {
        let parts = self.report["parts"].as_array().expect("parts");
        parts.iter().map(|p| p["flat_area"].as_f64().expect("an area")).collect()
    }

    /// Closed outlines on a layer.
    fn outlines(&self, layer: &str) -> Vec<Outline> {
        let lines: Vec<&str> = self.drawing.lines().map(str::trim).collect();
        let pairs: Vec<(&str, &str)> = lines.chunks_exact(2).map(|p| (p[0], p[1])).collect();
        let outline = |entity: &[(&str, &str)]| {
            let mut corners: Vec<[f64; 3]> = Vec::new();
            for (code, value) in entity {
                let number = || value.parse::<f64>().expect("a number");
                match *code {
                    "10" => corners.push([number(), 0.0, 0.0]),
                    "20" => corners.last_mut().expect("a corner")[1] = number(),
                    "42" => corners.last_mut().expect("a corner")[2] = number(),
                    _ => {}
                }
            }
            Outline { corners }
        };
        let entities = pairs.chunk_by(|_, next| next.0 != "0");
        let wanted = entities.filter(|e| e[0] == ("0", "LWPOLYLINE") && e.contains(&("8", layer)));
        wanted.map(outline).collect()
    }
}

/// A closed outline of lines and arcs.
struct Outline {
    /// Place, and the tangent of a quarter of the angle of the arc to the next corner.
    corners: Vec<[f64; 3]>,
}

impl Outline {
    /// Every side: its ends and half the angle of its arc.
    fn sides(&self) -> impl Iterator<Item = (Point, Point, f64)> + '_ {
        let next = self.corners.iter().cycle().skip(1);
        self.corners.iter().zip(next).map(|(a, b)| ([a[0], a[1]], [b[0], b[1]], 2.0 * a[2].atan()))
    }

    fn arcs(&self) -> usize {
        self.corners.iter().filter(|c| c[2] != 0.0).count()
    }

    fn length(&self) -> f64 {
        let side = |(a, b, half): (Point, Point, f64)| {
            let chord = distance(a, b);
            if half == 0.0 {
                chord
            } else {
                chord * half / half.sin()
            }
        };
        self.sides().map(side).sum()
    }

    /// Points on its sides, close to each other.
    fn points(&self) -> Vec<Point> {
        const PARTS: usize = 8;
        let on = |(a, b, half): (Point, Point, f64), k: usize| {
            let t = k as f64 / PARTS as f64;
            if half == 0.0 {
                return [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
            }
            // From its first end an arc is seen as a chord of the angle that it has turned by then.
            let (sin, cos) = ((t - 1.0) * half).sin_cos();
            let share = (t * half).sin() / half.sin();
            let [x, y] = [b[0] - a[0], b[1] - a[1]];
            [a[0] + share * (cos * x - sin * y), a[1] + share * (sin * x + cos * y)]
        };
        self.sides().flat_map(|s| (0..PARTS).map(move |k| on(s, k))).collect()
    }

    /// The ways to lay coordinates along the sides of a rectangle of that width: each as origin and both axes.
    fn frames(&self, width: f64) -> Vec<[Point; 3]> {
        let at = |k: usize| [self.corners[k % 4][0], self.corners[k % 4][1]];
        let frame = |(k, along, aside): (usize, usize, usize)| {
            let long = distance(at(k), at(k + along));
            let axis = |to: Point| [0, 1].map(|d| (to[d] - at(k)[d]) / distance(at(k), to));
            ((long - width).abs() < TOLERANCE).then(|| [at(k), axis(at(k + along)), axis(at(k + aside))])
        };
        (0..4).flat_map(|k| [(k, 1, 3), (k, 3, 1)]).filter_map(frame).collect()
    }
}

fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Distance of a point from a closed polygon.
fn off(p: Point, polygon: &[Point]) -> f64 {
    let side = |k: usize| {
        let (a, b) = (polygon[k], polygon[(k + 1) % polygon.len()]);
        let (d, e) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
        let t = ((d[0] * e[0] + d[1] * e[1]) / (d[0] * d[0] + d[1] * d[1])).clamp(0.0, 1.0);
        (e[0] - t * d[0]).hypot(e[1] - t * d[1])
    };
    (0..polygon.len()).map(side).fold(f64::INFINITY, f64::min)
}

/// Largest distance of holes from the nearest of the curves they may follow, in the frame of the sheet where it is least.
fn worst(outer: &Outline, width: f64, holes: &[Outline], curves: &[Vec<Point>]) -> f64 {
    let in_frame = |[origin, x, y]: [Point; 3]| {
        let seen = |p: Point| {
            let [a, b] = [p[0] - origin[0], p[1] - origin[1]];
            [a * x[0] + b * x[1], a * y[0] + b * y[1]]
        };
        let apart = |hole: &Outline| {
            let points: Vec<Point> = hole.points().into_iter().map(seen).collect();
            let nearest = |a: &&Vec<Point>, b: &&Vec<Point>| off(points[0], a).total_cmp(&off(points[0], b));
            let own = curves.iter().min_by(nearest).expect("a curve");
            points.iter().map(|p| off(*p, own)).fold(0.0, f64::max)
        };
        holes.iter().map(apart).fold(0.0, f64::max)
    };
    outer.frames(width).into_iter().map(in_frame).fold(f64::INFINITY, f64::min)
}

/// Doubly signed area of a polygon, halved.
fn area(polygon: &[Point]) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    0.5 * polygon.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>()
}

/// What a measure of polygons comes to that falls with the square of their sides.
fn limit(measure: impl Fn(usize) -> f64) -> f64 {
    const SIDES: usize = 1024;
    (4.0 * measure(2 * SIDES) - measure(SIDES)) / 3.0
}

/// A pipe of 250 mm radius from −1 m to 1.5 m, and a cone about an axis that leaves it at 45° from height 0 on; its radius is 240 mm there
/// and 150 mm after 1 m.
mod branch {
    use super::{area, limit, PI, TAU};

    pub const PIPE: f64 = 250.0;
    pub const FOOT: f64 = -1000.0;
    pub const HEIGHT: f64 = 2500.0;
    pub const END: f64 = 150.0;
    const ROOT: f64 = 240.0;
    const REACH: f64 = 1000.0;
    const SLOPE: f64 = (ROOT - END) / REACH;

    /// Way along the axis at which the ruling at an angle (from the plane of both axes, on the side of the pipe's upper end) leaves the
    /// pipe, and the place there.
    pub fn meeting(angle: f64) -> (f64, [f64; 3]) {
        let half = 0.5_f64.sqrt();
        let (sin, cos) = angle.sin_cos();
        // x = half (s − r cos), y = r sin, z = half (s + r cos) with the radius r = ROOT − SLOPE s; x² + y² is that of the pipe.
        let at = |s: f64| {
            let r = ROOT - SLOPE * s;
            [half * (s - r * cos), r * sin, half * (s + r * cos)]
        };
        let out = |s: f64| at(s)[0].hypot(at(s)[1]) - PIPE;
        // From inside, where x is 0, to the end.
        let (mut low, mut high) = (ROOT * cos / (1.0 + SLOPE * cos), REACH);
        assert!(out(low) < 0.0 && out(high) > 0.0, "{angle}");
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if out(middle) < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        (low, at(low))
    }

    fn around(count: usize) -> impl Iterator<Item = (f64, [f64; 3])> {
        (0..count).map(move |k| meeting(TAU * k as f64 / count as f64))
    }

    /// The seam on the pipe laid flat from its back and its foot on.
    pub fn hole(count: usize) -> Vec<[f64; 2]> {
        around(count).map(|(_, [x, y, z])| [PIPE * (PI + y.atan2(x)), z - FOOT]).collect()
    }

    pub fn seam_length() -> f64 {
        let square = |a: [f64; 3], b: [f64; 3]| (0..3).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>();
        limit(|count| {
            let points: Vec<[f64; 3]> = around(count + 1).map(|p| p.1).collect();
            (0..points.len()).map(|k| square(points[k], points[(k + 1) % points.len()]).sqrt()).sum()
        })
    }

    /// Length of the ruling along which the cone is cut, the shortest one.
    pub fn cut() -> f64 {
        (REACH - meeting(0.0).0) * (1.0 + SLOPE * SLOPE).sqrt()
    }

    /// Areas of pipe and cone.
    pub fn areas() -> [f64; 2] {
        const COUNT: usize = 1024;
        let ring = |(s, _): (f64, [f64; 3])| (ROOT - SLOPE * s).powi(2) - END * END;
        let cone = PI / COUNT as f64 * around(COUNT).map(ring).sum::<f64>() * (1.0 + SLOPE.powi(-2)).sqrt();
        [TAU * PIPE * HEIGHT - limit(|count| area(&hole(count)).abs()), cone]
    }
}

#[test]
fn the_hole_of_a_pipe_is_as_long_as_the_end_of_its_branch() {
    let flat = unrolled("branch.step");
    let seam = branch::seam_length();
    // As drawn: the pipe is a rectangle with a hole; the branch has two sides, the arc of its end, and the seam.
    let (outer, holes) = (flat.outlines("CUT_OUTER"), flat.outlines("CUT_INNER"));
    assert_eq!((outer.len(), holes.len()), (2, 1));
    let (pipes, cones): (Vec<_>, Vec<_>) = outer.iter().partition(|o| o.corners.len() == 4);
    assert_eq!((pipes.len(), cones.len()), (1, 1));
    let drawn = [holes[0].length(), cones[0].length() - 2.0 * branch::cut() - TAU * branch::END];
    assert!(drawn.iter().all(|l| (l - seam).abs() < 0.5 * TOLERANCE), "{drawn:?} {seam}");
    // As the report has it of the joint of both.
    let joints = flat.report["joints"].as_array().expect("joints");
    let both = joints.iter().find(|j| j["between"][0] != j["between"][1]).expect("the joint of both");
    for side in both["lengths_estimate"].as_array().expect("two lengths") {
        let length = side.as_f64().expect("a length");
        assert!((length - seam).abs() < 0.1 * TOLERANCE, "{length} {seam}");
    }
    let curve = branch::hole(4000);
    let apart = worst(pipes[0], TAU * branch::PIPE, &holes, &[curve]);
    assert!(apart <= TOLERANCE, "{apart}");
    for (found, area) in flat.areas().iter().zip(branch::areas()) {
        assert!((found - area).abs() < TOLERANCE * seam, "{found} {area}");
    }
}

/// A sheet over a cubic spline through seven points, with upright bores across its bends.
mod trough {
    use super::{distance, TAU};

    pub const WIDTH: f64 = 800.0;
    /// Where the polynomials of the profile end.
    const KNOTS: [f64; 5] = [0.0, 400.0, 600.0, 800.0, 1200.0];
    /// Heights of the points, which lie 200 mm apart.
    const HEIGHTS: [f64; 7] = [0.0, -120.0, -180.0, -60.0, -200.0, -120.0, 0.0];
    /// Heights of the control points of the spline through them.
    const CONTROL: [f64; 7] = [0.0, -22.7778, -344.4444, 41.6667, -385.5556, 2.7778, 0.0];
    /// Axis (from the beginning, from the side) and radius of every bore.
    pub const BORES: [[f64; 3]; 6] = [
        [380.0, 170.0, 60.0],
        [620.0, 220.0, 70.0],
        [800.0, 250.0, 55.0],
        [410.0, 600.0, 80.0],
        [590.0, 560.0, 50.0],
        [810.0, 610.0, 75.0],
    ];

    /// Height and slope of the profile, by de Boor's scheme.
    fn profile(x: f64) -> [f64; 2] {
        let knot = |k: usize| KNOTS[k.clamp(3, 7) - 3];
        let span = (3..6).find(|k| x < knot(k + 1)).unwrap_or(6);
        let mut c: [f64; 4] = std::array::from_fn(|k| CONTROL[span - 3 + k]);
        let mut slope = 0.0;
        for round in 1..=3 {
            if round == 3 {
                slope = 3.0 * (c[3] - c[2]) / (knot(span + 1) - knot(span));
            }
            for k in (round..=3).rev() {
                let (a, b) = (knot(span - 3 + k), knot(span + 1 + k - round));
                c[k] = c[k - 1] + (x - a) / (b - a) * (c[k] - c[k - 1]);
            }
        }
        [c[3], slope]
    }

    /// Length of the profile up to a place, by Simpson's rule.
    pub fn run(x: f64) -> f64 {
        const STEPS: usize = 100;
        let speed = |x: f64| profile(x)[1].hypot(1.0);
        let over = |a: f64, b: f64| {
            let h = (b - a) / STEPS as f64;
            let step = |k: usize| {
                let [p, q, r] = [0.0, 0.5, 1.0].map(|s| speed(a + (k as f64 + s) * h));
                h / 6.0 * (p + 4.0 * q + r)
            };
            (0..STEPS).map(step).sum::<f64>()
        };
        KNOTS.windows(2).filter(|k| k[0] < x).map(|k| over(k[0], x.min(k[1]))).sum()
    }

    pub fn length() -> f64 {
        run(KNOTS[4])
    }

    /// A bore on the sheet laid flat.
    pub fn hole([x, y, radius]: [f64; 3], count: usize) -> Vec<[f64; 2]> {
        let angles = (0..count).map(|k| TAU * k as f64 / count as f64);
        angles.map(|a| [run(x + radius * a.cos()), y + radius * a.sin()]).collect()
    }

    /// How many corners a polygon has, at the least, that are on a curve and whose sides rise by no more than `within` over it:
    /// a side of length `h` does by `κ h²/8`, so that there are `√(κ/8 within)` in a length.
    pub fn chords(curve: &[[f64; 2]], within: f64) -> f64 {
        let at = |k: usize| curve[k % curve.len()];
        let needed = |k: usize| {
            let [a, b, c] = [at(k), at(k + 1), at(k + 2)];
            let way = |p: [f64; 2], q: [f64; 2]| (q[1] - p[1]).atan2(q[0] - p[0]);
            let turn = (way(b, c) - way(a, b)).sin().asin().abs();
            (turn * distance(a, b) / (8.0 * within)).sqrt()
        };
        (0..curve.len()).map(needed).sum()
    }

    #[test]
    fn the_spline_goes_through_its_points() {
        for (k, height) in HEIGHTS.iter().enumerate() {
            let found = profile(200.0 * k as f64)[0];
            assert!((found - height).abs() < 1e-4, "{k}: {found}");
        }
    }
}

#[test]
fn a_trough_with_holes_across_its_bends_is_drawn_with_few_arcs() {
    let flat = unrolled("trough.step");
    let (outer, holes) = (flat.outlines("CUT_OUTER"), flat.outlines("CUT_INNER"));
    assert_eq!((outer.len(), outer[0].corners.len(), outer[0].arcs(), holes.len()), (1, 4, 0, trough::BORES.len()));
    let length = trough::length();
    assert!((outer[0].length() - 2.0 * (length + trough::WIDTH)).abs() < TOLERANCE, "{length}");
    let curves = trough::BORES.map(|b| trough::hole(b, 1500));
    let apart = worst(&outer[0], length, &holes, &curves);
    assert!(apart <= TOLERANCE, "{apart}");
    let cut = limit(|count| trough::BORES.iter().map(|b| area(&trough::hole(*b, count)).abs()).sum());
    let around: f64 = holes.iter().map(Outline::length).sum();
    let wanted = length * trough::WIDTH - cut;
    assert!((flat.areas()[0] - wanted).abs() < 0.5 * TOLERANCE * around, "{} {wanted}", flat.areas()[0]);
    // 200 arcs and nothing else, where chords would need 1094 corners.
    let corners: usize = holes.iter().map(|h| h.corners.len()).sum();
    let arcs: usize = holes.iter().map(Outline::arcs).sum();
    let chords: f64 = curves.iter().map(|c| trough::chords(c, TOLERANCE)).sum();
    assert!(chords > 1000.0 && arcs == corners && arcs <= 210, "{arcs} of {corners}, {chords}");
}
