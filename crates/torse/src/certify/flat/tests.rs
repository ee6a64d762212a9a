use super::*;
use crate::certify::specimens::two_panels;
use crate::geom::Vec2;
use crate::patchwork::panel::Border;
use crate::patchwork::pattern::Mark;
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;

const TOLERANCE: f64 = 0.01;

/// A drawing of panel `k` in straight lines, with one mark on its seam.
fn drawn(p: &Patchwork, k: usize) -> Pattern {
    let panel = &p.panels[k];
    let side = if panel.mirrored() { 1.0 } else { -1.0 };
    let all = |_: f64, _: f64| Some(Interval::new(0.0, 1.0));
    let rails = FlatRails::new(&Ruled::new(&panel.strip.patch).expect("ruled"), &all, side).expect("flat rails");
    let motion = Motion { turn: [0.6, 0.8], from: [1.0, 2.0], to: [30.0, -7.0] };
    const LINES: usize = 400;
    let mut vertices = Vec::new();
    let mut marks = Vec::new();
    for run in &panel.loops()[0] {
        let image = Image { flat: &rails, trim: &run.trim, motion };
        for i in 0..LINES {
            let [x, y] = image.place(i as f64 / LINES as f64).expect("a place");
            vertices.push(ContourVertex { point: Vec2::new(x, y), bulge: 0.0, corner: i == 0 });
        }
        if let Border::Seam { forward, .. } = run.border {
            let [x, y] = image.place(if forward { 0.25 } else { 0.75 }).expect("a place");
            marks.push(Mark {
                point: Vec2::new(x, y),
                inward: Vec2::x(),
                label: "S0.1".into(),
                on: MarkPlace::Seam,
                apart: 0.0,
            });
        }
    }
    let ends = rails.ruling(0.5).expect("inside").map(|q| motion.point(&q).map(Interval::mid));
    Pattern {
        panel: k,
        name: panel.strip.name.clone(),
        contours: vec![Contour { vertices }],
        rulings: vec![ends.map(|q| Vec2::new(q[0], q[1]))],
        marks,
        length: 50.0,
        ..Pattern::default()
    }
}

fn judged(p: &Patchwork, patterns: &[Pattern]) -> Vec<FlatCertificate> {
    flat(p, patterns, TOLERANCE, &Control::default())
}

#[test]
fn a_true_drawing_is_proven_as_closely_as_its_lines_follow_the_border() {
    let p = two_panels(1e-3, 4);
    let patterns = [drawn(&p, 0), drawn(&p, 1)];
    for f in judged(&p, &patterns) {
        assert!(f.holds(), "{:?}", f.reason());
        assert!(f.strain_bound() < 1e-8, "{:e}", f.strain_bound());
        assert!(f.outline_bound() < 1e-3 && f.ruling_bound() < 1e-9 && f.mark_bound() < 1e-6, "{f:?}");
    }
}

#[test]
fn places_are_found_where_the_speed_jumps() {
    let p = two_panels(1e-3, 4);
    let all = |_: f64, _: f64| Some(Interval::new(0.0, 1.0));
    let flat = FlatRails::new(&Ruled::new(&p.panels[0].strip.patch).expect("ruled"), &all, 1.0).expect("flat rails");
    let [a, b] = [flat.breaks()[0], flat.breaks()[flat.breaks().len() - 1]];
    let shares = [0.0, 0.01, 0.4, 0.41, 0.8, 0.81, 1.0];
    let knots = Knots::clamped(1, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(|k| k / 6.0)).expect("knots");
    let trim = Curve { knots, control: shares.map(|x| [a + (b - a) * x, 0.0]).to_vec() };
    let motion = Motion { turn: [1.0, 0.0], from: [0.0; 2], to: [0.0; 2] };
    let image = Image { flat: &flat, trim: &trim, motion };
    for k in 0..=60 {
        let s = f64::from(k) / 60.0;
        let to = image.place(s).expect("a place");
        for from in [0.0, 0.17, 0.49, 0.51, 0.83, 1.0] {
            let found = image.nearest(&to, from, 0.0);
            let at = image.place(found).expect("a place");
            assert!((at[0] - to[0]).hypot(at[1] - to[1]) < 1e-6, "{s} from {from}: {found}");
        }
    }
}

#[test]
fn what_is_drawn_wrongly_is_seen() {
    let p = two_panels(1e-3, 4);
    let good = [drawn(&p, 0), drawn(&p, 1)];
    type Damage = fn(&mut Pattern);
    let damages: [(&str, Damage); 9] = [
        ("a joint off the border", |d| d.contours[0].vertices[50].point.x += 0.2),
        ("a joint that is not a number", |d| d.contours[0].vertices[50].point.x = f64::NAN),
        ("an arc for a line", |d| d.contours[0].vertices[50].bulge = 5.0),
        ("a larger pattern", |d| d.contours[0].vertices.iter_mut().for_each(|v| v.point *= 1.05)),
        ("a mirrored pattern", |d| {
            d.contours[0].vertices.iter_mut().for_each(|v| v.point.x = -v.point.x);
        }),
        ("a corner too many", |d| d.contours[0].vertices[50].corner = true),
        ("a ruling across", |d| d.rulings[0][1].x += 0.5),
        ("a mark elsewhere on the seam", |d| {
            let other = d.contours[0].vertices.len() * 7 / 8;
            let off = d.contours[0].vertices[other].point - d.marks[0].point;
            d.marks[0].point += off * 0.5;
        }),
        ("a mark without partner", |d| d.marks[0].label = "S0.2".into()),
    ];
    for (what, damage) in damages {
        let mut bad = good.clone();
        damage(&mut bad[0]);
        assert!(!judged(&p, &bad)[0].holds(), "{what}");
    }
}
