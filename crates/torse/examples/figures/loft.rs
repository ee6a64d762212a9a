//! Figures of lecture notes on ruled surfaces and developables \[W15\], section 4, drawn from the library: developables
//! from boundary curves.
//!
//! One PNG per figure.

use std::error::Error;
use std::f64::consts::TAU;
use std::path::Path;
use torse::answer::presentation::present;
use torse::answer::Answer;
use torse::brep::space_curve::SpaceCurve;
use torse::control::Control;
use torse::design::loft::branches::BranchType;
use torse::draw::picture::{self, Caption};
use torse::draw::raster::{Drawing, PenLine};
use torse::geom::{Frame, Vec2, Vec3};
use torse::io::png;
use torse::patchwork::part::Part;
use torse::pipeline::hull::{hull, Options};
use torse::pipeline::loft::{self, Choice, Ends};
use torse::torse::rail::Rail;
use torse::torse::strip::Strip;

type Outcome<T> = Result<T, Box<dyn Error>>;

/// Draws them into a folder.
pub fn draw(folder: &Path) -> Outcome<()> {
    let control = Control::default();
    let save = |name: &str, answer: &Answer, title: &str, eye: Vec3| -> Outcome<()> {
        let caption = Caption { width: 800, title: title.into(), note: "W15".into() };
        let shown = present(answer);
        let image = picture::panels(&shown.scene, &eye, &caption);
        Ok(std::fs::write(folder.join(format!("{name}.png")), png::write(&image)?)?)
    };
    // 4.1: a plane rolls over a closed curve; where it touches three times, a facet is planar.
    let knot = around("curve", |t| Vec3::new(100.0 * t.cos(), 100.0 * t.sin(), 35.0 * (3.0 * t).cos()))?;
    let answer = hull(&[knot], &Options::new(0.1), &control)?;
    save("figure-4-1", &answer, "the convex hull of a closed curve", EYE)?;
    // 4.4: formwork between a circle and a rectangle.
    let rectangle = [(-110.0, -70.0), (110.0, -70.0), (110.0, 70.0), (-110.0, 70.0), (-110.0, -70.0)];
    let rectangle = Rail::polyline("rectangle", &rectangle.map(|(x, y)| Vec3::new(x, y, 0.0)))?;
    let circle = ellipse("circle", Vec3::z() * 140.0, 90.0, 90.0)?;
    let answer = hull(&[rectangle, circle], &Options::new(1e-3), &control)?;
    save("figure-4-4", &answer, "formwork from a rectangle to a circle", EYE)?;
    // 4.7: one boundary, several developables: the upper and the lower side of the hull of a saddle's edge.
    let saddle = around("loop", |t| Vec3::new(100.0 * t.cos(), 100.0 * t.sin(), 50.0 * (2.0 * t).cos()))?;
    let whole = hull(&[saddle], &Options::new(1.0), &control)?;
    let height = |p: &Vec3| 50.0 * (p.x * p.x - p.y * p.y) / 1e4;
    for (letter, upper) in [("a", true), ("b", false)] {
        let side = only(&whole, |middle| (middle.z > height(middle)) == upper);
        let title =
            if upper { "the upper developable of a closed curve" } else { "and the lower one of the same curve" };
        save(&format!("figure-4-7-{letter}"), &side, title, EYE)?;
    }
    // The same two circles bound a cone and a double cone; only the first is regular.
    let (low, high) = (ellipse("low", Vec3::zeros(), 80.0, 80.0)?, ellipse("high", Vec3::z() * 120.0, 50.0, 50.0)?);
    let double = torse::design::loft::branches::branches(&low, &high, &Default::default());
    let double = double.iter().filter(|b| b.kind == BranchType::DoubleCone).count();
    let options = loft::Options { choice: Choice::Exact, ends: Ends::Trim, ..loft::Options::new(1e-3) };
    let answer = loft::loft(&low, &high, &options, &control)?;
    let title = format!("two circles: a cone, and {double} double cone not used");
    save("figure-4-7-circles", &answer, &title, EYE)?;
    std::fs::write(folder.join("figure-4-11.png"), png::write(&subdivision().render())?)?;
    Ok(())
}

const EYE: Vec3 = Vec3::new(1.0, -1.6, 1.1);

/// A closed curve through points, as a smooth rail.
fn around(name: &str, at: impl Fn(f64) -> Vec3) -> Outcome<Rail> {
    // Rounded, as tables of points are.
    let place = |k: u32| at(TAU * f64::from(k % 96) / 96.0).map(|x| (x * 1e6).round() / 1e6);
    let points: Vec<Vec3> = (0..=96).map(place).collect();
    Ok(Rail::through(name, &points)?)
}

fn ellipse(name: &str, origin: Vec3, a: f64, b: f64) -> Outcome<Rail> {
    let frame = Frame { origin, ..Frame::world() };
    let (c, _) = SpaceCurve::Ellipse { frame, a, b }.to_spline(0.0, TAU)?;
    Ok(Rail::new(name, &[c])?)
}

/// The strips whose middles are wanted.
fn only(all: &Answer, wanted: impl Fn(&Vec3) -> bool) -> Answer {
    let chosen = |strip: &Strip| {
        let [p, q] = strip.ruling(0.5);
        wanted(&((p + q) * 0.5))
    };
    let keep: Vec<bool> = all.strips().map(chosen).collect();
    let strips: Vec<Strip> = all.strips().zip(&keep).filter(|s| *s.1).map(|s| s.0.clone()).collect();
    let parts = vec![Part { name: "A".into(), first: 0, count: strips.len(), missing: None }];
    let mut out = Answer::shown(all.job, &all.input, all.tolerance(), strips, Vec::new());
    out.fields = all.fields.iter().zip(&keep).filter(|s| *s.1).map(|s| s.0.clone()).collect();
    out.parts = parts;
    out
}

/// Figure 4.11: Lane-Riesenfeld subdivision: each step doubles the points and averages twice.
fn subdivision() -> Drawing {
    let mut drawing = Drawing::new(1200, 800);
    let mut points: Vec<Vec2> =
        [(120.0, 640.0), (220.0, 160.0), (520.0, 200.0), (600.0, 620.0), (880.0, 680.0), (1060.0, 180.0)]
            .map(|(x, y)| Vec2::new(x, y))
            .to_vec();
    for level in 0..5u32 {
        let shade = 0.75 - 0.18 * f64::from(level);
        let line = points.iter().map(|p| [p.x, p.y, 0.0]).collect();
        drawing.lines.push(PenLine {
            points: line,
            width: 1.6 + 0.4 * f64::from(level),
            colour: [shade, shade * 0.8, 0.9 - 0.6 * shade],
            alpha: 1.0,
        });
        let doubled: Vec<Vec2> = points.iter().flat_map(|p| [*p, *p]).collect();
        let averaged = |p: &[Vec2]| -> Vec<Vec2> { p.windows(2).map(|w| (w[0] + w[1]) * 0.5).collect() };
        points = averaged(&averaged(&averaged(&doubled)));
    }
    drawing.text("doubled and averaged: a cubic B-spline curve", Vec2::new(40.0, 62.0), 28.0, [0.13, 0.15, 0.19]);
    drawing
}
