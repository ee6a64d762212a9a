//! Pictures of cone splines.
//!
//! Figures 3 to 17 of \[LP98\]: the inscribed sphere and its biarc (3, 4), which side of the vertex is used (5, 6), the
//! family of junction rulings (7) and its vertex distances (8), constant slope (9, 10, 12), a tangent surface with three
//! pairs (11), joins on the sphere of directions (13, 14), four and two osculating cones (15), a cone segment and its
//! development (16), the bending sequence (17).

use std::path::Path;
use torse::design::cones::{cone_spline, osculating_spline, ConeOptions, Osculating};
use torse::develop::cones::{bent, cone_pattern, Bending};
use torse::draw::drawing::{drawing, DrawingOptions};
use torse::draw::picture::{panels, Caption};
use torse::draw::scene::{PanelShape, Scene};
use torse::draw::sequence::sequence;
use torse::geom::{Vec2, Vec3};
use torse::io::{bundle::exact, dxf, png};
use torse::patchwork::pattern::Placement;
use torse::tessellate::strip;
use torse::torse::cone::forms::patches;
use torse::torse::cone::pair::{any_pair, ConePair, PairOptions};
use torse::torse::cone::part::ConeBody;
use torse::torse::cone::spline::{ConeSpline, Segment, Shape};
use torse::torse::form::PanelKind;
use torse::torse::g1_element::G1Element;
use torse::torse::ruled_patch::{tangent_strip, HelicalStrip, RuledStrip, StripJet};
use torse::torse::strip::Strip;

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// Draws them into a folder.
#[expect(clippy::too_many_lines, reason = "one figure after another")]
pub fn draw(folder: &Path) -> Result<()> {
    let eye = Vec3::new(0.5, -1.0, 0.7);

    // Figure 11: a tangent surface and three pairs.
    let nodes = [0.15, 0.45, 0.75, 1.05];
    save(
        folder,
        "fig11a_tangent_surface",
        &smooth(&|u| cubic(u), 0.15, 1.05),
        &eye,
        "tangent surface of (u, uu, uuu)",
    )?;
    let elements: Vec<G1Element> = nodes.iter().map(|&u| element(&cubic(u))).collect::<Result<_>>()?;
    let reach = vec![[-0.5, 0.5]; 4];
    let three = cone_spline(&elements, &reach, &ConeOptions::default())?;
    save(folder, "fig11b_three_pairs", &scene(&three)?, &eye, "three cone pairs")?;

    // Figures 13 to 15: four and two osculating cones.
    for (name, us, title) in [
        ("fig15a_four_osculating", vec![0.2, 0.48, 0.76, 1.04], "four osculating cones and their joins"),
        ("fig15b_two_osculating", vec![0.2, 0.75], "two osculating cones and one join"),
    ] {
        let cones: Vec<Osculating> =
            us.iter().map(|&u| Ok(Osculating::of(&element(&cubic(u))?, &cubic(u)))).collect::<Result<_>>()?;
        let s = osculating_spline(&cones, &vec![[-0.5, 0.5]; us.len()], &ConeOptions::default())?;
        save(folder, name, &scene(&s.spline)?, &eye, title)?;
    }

    let ends = [0.2, 0.75].map(cubic);
    let cones: Vec<Osculating> = ends.iter().map(|j| Ok(Osculating::of(&element(j)?, j))).collect::<Result<_>>()?;
    let joined = osculating_spline(&cones, &[], &ConeOptions::default())?;
    let arcs: Vec<Vec<Vec3>> = joined.spline.segments.iter().map(|s| directions(s, 0.0, 1.0)).collect();
    let eye_on_sphere = arcs.iter().flatten().sum::<Vec3>().normalize() + Vec3::new(0.2, 0.1, 0.3);
    let outwards = arcs.iter().flatten().sum::<Vec3>().normalize();
    let mut s = Scene { panels: vec![cap(&Vec3::zeros(), 0.995, &outwards, 0.7)], ..Scene::default() };
    // One colour for each arc.
    s.panels.extend(arcs.iter().enumerate().map(|(i, arc)| ribbon(&format!("{}", i + 1), arc)));
    save(folder, "fig13_triarc", &s, &eye_on_sphere, "directions of rulings: two cones, one join")?;
    let whole = |s: &Segment| directions(s, 0.0, std::f64::consts::TAU / s.shape.angle().abs());
    s.panels = vec![sphere(&Vec3::zeros(), 0.995)];
    s.guides = joined.spline.segments.iter().map(whole).collect();
    let middle = s.guides.iter().flatten().sum::<Vec3>();
    save(folder, "fig14_circles", &s, &middle, "the whole circles: the joining one touches both")?;

    // Figures 9, 10, 12: constant slope.
    save(folder, "fig9_constant_slope", &smooth(&over_ellipse, 0.0, 5.6), &eye, "constant slope over an ellipse")?;
    let helix = HelicalStrip { radius: 1.0, rise: 0.6, reach: [0.6, 1.8], domain: (0.0, 3.0) };
    save(folder, "fig12a_constant_slope", &smooth(&|u| helix.jet(u), 0.0, 3.0), &eye, "surface of constant slope")?;
    let elements: Vec<G1Element> = (0..4).map(|i| element(&helix.jet(f64::from(i)))).collect::<Result<_>>()?;
    let slope = cone_spline(&elements, &[[-0.6, 0.6]; 4], &ConeOptions::default())?;
    save(folder, "fig12b_three_pairs", &scene(&slope)?, &eye, "constant slope, three cone pairs")?;
    let pair = any_pair(
        &elements[0],
        &elements[1],
        &PairOptions { first: [-0.6, 0.6], second: [-0.6, 0.6], ..PairOptions::default() },
    )?;
    save(
        folder,
        "fig10_pair_of_constant_slope",
        &scene(&ConeSpline { segments: pair.segments.to_vec() })?,
        &eye,
        "parallel axes, equal openings",
    )?;

    // Figures 3, 4, 7, 8: the family over the inscribed sphere.
    let (a, b) = (element(&cubic(0.2))?, element(&cubic(0.8))?);
    let mut family = Scene::default();
    for (k, psi) in [0.3, 0.5, 0.7].into_iter().enumerate() {
        let pair = any_pair(&a, &b, &PairOptions { psi, ..PairOptions::default() })?;
        let mut s = ConeSpline { segments: pair.segments.to_vec() };
        s = s.with_circular_edges(-0.5, 0.5);
        for (i, mut shape) in scene(&s)?.panels.into_iter().enumerate() {
            shape.name = if i == 0 { format!("{psi}") } else { String::new() };
            // Side by side for the eye.
            shift(&mut shape, &(Vec3::new(1.2, 0.6, 0.0) * k as f64));
            family.panels.push(shape);
        }
    }
    save(folder, "fig7_family", &family, &eye, "three members of the family: psi 0.3, 0.5, 0.7")?;
    let pair = any_pair(&a, &b, &PairOptions::default())?;
    if let Some((m, r)) = pair.inscribed_sphere() {
        let touching = biarc(&pair, &m);
        // Seen from the side on which the cones touch, so that the sphere lies behind them.
        let points: Vec<Vec3> = touching.iter().flatten().copied().collect();
        let outwards = (points.iter().sum::<Vec3>() / points.len() as f64 - m).normalize();
        let look = outwards + pair.segments[0].start.direction * 0.35;
        let start = pair.segments[0].start;
        let foot = (m - start.point).dot(&start.direction);
        let chain = ConeSpline { segments: pair.segments.to_vec() };
        let mut s = scene(&chain.with_circular_edges(-0.9, foot.max(0.0) + 0.5))?;
        s.panels.push(sphere(&m, r.abs()));
        s.guides = touching[..2].to_vec();
        save(folder, "fig3_inscribed_sphere", &s, &look, "the inscribed sphere of both cones")?;
        let away = |p: &Vec3| (p - m).angle(&outwards);
        let widest = touching.iter().flatten().map(away).fold(0.0, f64::max);
        let mut s = Scene { panels: vec![cap(&m, r.abs(), &outwards, 1.4 * widest)], ..Scene::default() };
        s.guides = touching;
        save(folder, "fig4_biarc", &s, &look, "the biarc of contact, and its polygon")?;
    }
    let mut s = scene(&ConeSpline { segments: pair.segments.to_vec() }.with_circular_edges(-0.5, 0.5))?;
    for k in 1..20 {
        let psi = f64::from(k) / 20.0;
        if let Ok(member) = any_pair(&a, &b, &PairOptions { psi, ..PairOptions::default() }) {
            let v: Vec<Vec3> = member.segments.iter().filter_map(Segment::vertex).collect();
            if (0.25..0.75).contains(&psi) {
                s.guides.push(v);
            }
        }
    }
    save(folder, "fig8_vertex_distance", &s, &eye, "from vertex to vertex, psi 0.25 to 0.7")?;

    // Figures 5 and 6: the same cone used on either side of its vertex.
    for (name, distance, angle) in [("fig5_same_side", 1.5, 1.6), ("fig6_other_side", -1.5, -1.6)] {
        let shape = Shape::Cone { distance, cos_gamma: 0.8, sin_gamma: 0.6, angle };
        let s = ConeSpline { segments: vec![Segment::new(a, shape)] }.with_circular_edges(-0.8, 0.8);
        let segment = s.segments[0];
        let mut shown = scene(&s)?;
        // Normals along a circle of the cone meet in the centre of the sphere that touches it there.
        let (g, h) = (segment.start, segment.end());
        let apart = g.normal - h.normal;
        let r = (h.point - g.point).dot(&apart) / apart.norm_squared();
        let m = g.point + g.normal * r;
        shown.panels.push(sphere(&m, r.abs()));
        if let Some(vertex) = segment.vertex() {
            shown.panels.push(sphere(&vertex, 0.05));
            shown.guides = [0.0, 0.5, 1.0].map(|f| vec![vertex, segment.element(f).point]).to_vec();
        }
        let middle = segment.element(0.5);
        let look = (middle.point - m).normalize() + middle.forward * 0.8;
        save(folder, name, &shown, &look, "used part, vertex, touching sphere")?;
    }

    // Figure 16: a segment and its development.
    let one = ConeSpline { segments: vec![three.segments[2]] }.with_circular_edges(-0.5, 0.5);
    let mut both = scene(&one)?;
    let first = one.segments[0].start;
    for mut shape in scene(&bent(&one, 1.0, Bending::Curvature))?.panels {
        shape.name = "flat".into();
        shift(&mut shape, &(first.direction * 1.4));
        both.panels.push(shape);
    }
    let look = first.normal * 0.8 - first.forward * 0.5 + first.direction * 0.1;
    save(folder, "fig16_segment", &both, &look, "cone segment and its development")?;

    // Figure 17: the bending sequence, as a strip of pictures, and the flat pattern of true arcs.
    // Arcs across the rulings come nearer to the vertices by the length of the regression curve.
    let circular = three.clone().with_circular_edges(1.0, 1.8);
    bending(&folder.join("fig17_bending.png"), &circular)?;
    let pattern = cone_pattern(&circular, "A", 1e-4);
    let flat = drawing(&[pattern], &[Placement { angle: 0.0, offset: Vec2::zeros() }], &[], &DrawingOptions::default());
    std::fs::write(folder.join("fig17_flat.dxf"), dxf::write(&flat)?)?;
    let step = exact(
        "three pairs",
        &[ConeBody { name: "A".into(), spline: circular, part: None }],
        false,
        "2026-01-01T00:00:00",
    )?;
    std::fs::write(folder.join("fig11b_three_pairs.step"), step)?;
    Ok(())
}

fn cubic(u: f64) -> StripJet {
    let c = [
        Vec3::new(u, u * u, u * u * u),
        Vec3::new(1.0, 2.0 * u, 3.0 * u * u),
        Vec3::new(0.0, 2.0, 6.0 * u),
        Vec3::new(0.0, 0.0, 6.0),
    ];
    tangent_strip(&c, [1.0, 2.0])
}

fn element(jet: &StripJet) -> Result<G1Element> {
    Ok(jet.element()?)
}

/// A scene of one smooth strip.
fn smooth(jet: &dyn Fn(f64) -> StripJet, a: f64, b: f64) -> Scene {
    let mut shape = PanelShape { name: String::new(), ..PanelShape::default() };
    const PARTS: u32 = 60;
    for i in 0..=PARTS {
        let j = jet(a + (b - a) * f64::from(i) / f64::from(PARTS));
        let n = j.element().map_or(Vec3::z(), |g| g.normal);
        for e in &j.ends {
            shape.mesh.positions.push(e[0]);
            shape.mesh.normals.push(n);
        }
        if i % 6 == 0 {
            shape.rulings.push([j.ends[0][0], j.ends[1][0]]);
        }
        if i > 0 {
            let k = 2 * i;
            shape.mesh.triangles.extend([[k - 2, k - 1, k], [k, k - 1, k + 1]]);
        }
    }
    Scene { panels: vec![shape], ..Scene::default() }
}

/// A scene of a chain, one shape for each segment.
fn scene(spline: &ConeSpline) -> Result<Scene> {
    let mut scene = Scene::default();
    for (i, s) in spline.segments.iter().enumerate() {
        for patch in patches(s)? {
            let strip = Strip { name: format!("{}", i + 1), kind: PanelKind::Cone, patch };
            let (u, v) = strip::grid(&strip);
            scene.panels.push(PanelShape {
                name: strip.name.clone(),
                mesh: strip::mesh(&strip, &u, &v, &[]),
                rulings: vec![strip.ruling(0.25), strip.ruling(0.5), strip.ruling(0.75)],
                borders: vec![strip::border_line(&strip)],
                marked: false,
            });
        }
    }
    // The polygon of the vertices approximates the regression curve.
    Ok(scene)
}

fn shift(shape: &mut PanelShape, by: &Vec3) {
    shape.mesh.positions.iter_mut().for_each(|p| *p += by);
    shape.rulings.iter_mut().flatten().for_each(|p| *p += by);
    shape.borders.iter_mut().flatten().for_each(|p| *p += by);
}

fn sphere(m: &Vec3, r: f64) -> PanelShape {
    cap(m, r, &Vec3::z(), std::f64::consts::PI)
}

/// The part of a sphere about `m` no farther than an angle from a direction.
fn cap(m: &Vec3, r: f64, direction: &Vec3, angle: f64) -> PanelShape {
    let mut shape = PanelShape::default();
    const N: u32 = 40;
    let z = direction.normalize();
    let x = z.cross(&if z.x.abs() < 0.8 { Vec3::x() } else { Vec3::y() }).normalize();
    let y = z.cross(&x);
    for i in 0..=N {
        for j in 0..=N {
            let (a, b) = (std::f64::consts::TAU * f64::from(i) / f64::from(N), angle * f64::from(j) / f64::from(N));
            let n = (x * a.cos() + y * a.sin()) * b.sin() + z * b.cos();
            shape.mesh.positions.push(m + n * r);
            shape.mesh.normals.push(n);
            if i > 0 && j > 0 {
                let k = i * (N + 1) + j;
                shape.mesh.triangles.extend([[k - N - 2, k - N - 1, k - 1], [k - 1, k - N - 1, k]]);
            }
        }
    }
    shape
}

/// A narrow ribbon along a curve on the unit sphere.
fn ribbon(name: &str, arc: &[Vec3]) -> PanelShape {
    const HALF: f64 = 0.015;
    let mut shape = PanelShape { name: name.into(), ..PanelShape::default() };
    for (i, d) in arc.iter().enumerate() {
        let along = arc[(i + 1).min(arc.len() - 1)] - arc[i.saturating_sub(1)];
        let side = d.cross(&along).normalize() * HALF;
        for p in [d - side, d + side] {
            shape.mesh.positions.push(p * 1.01);
            shape.mesh.normals.push(*d);
        }
        if i > 0 {
            let k = 2 * i as u32;
            shape.mesh.triangles.extend([[k - 2, k, k - 1], [k, k + 1, k - 1]]);
        }
    }
    shape
}

fn save(folder: &Path, name: &str, scene: &Scene, eye: &Vec3, title: &str) -> Result<()> {
    let caption = Caption { width: 800, title: title.into(), note: "LP98".into() };
    let image = panels(scene, eye, &caption);
    std::fs::write(folder.join(format!("{name}.png")), png::write(&image)?)?;
    Ok(())
}

/// Six stages side by side.
fn bending(file: &Path, spline: &ConeSpline) -> Result<()> {
    const STAGES: usize = 6;
    // All stages share the first ruling and its plane.
    let stages: Vec<(String, Scene)> = (0..STAGES)
        .map(|k| {
            let share = 100 * k / (STAGES - 1);
            Ok((format!("{share} %"), scene(&bent(spline, 0.01 * share as f64, Bending::Curvature))?))
        })
        .collect::<Result<_>>()?;
    let first = spline.segments.first().ok_or("an empty chain")?.start;
    let eye = first.normal * 0.55 + first.forward * -0.75 + first.direction * 0.35;
    std::fs::write(file, png::write(&sequence(&stages, &eye))?)?;
    Ok(())
}

/// Directions of the rulings of a segment, as a polyline on the unit sphere.
fn directions(s: &Segment, from: f64, to: f64) -> Vec<Vec3> {
    (0..=64).map(|i| s.element(from + (to - from) * f64::from(i) / 64.0).direction).collect()
}

/// The circles in which the cones of a pair touch the sphere about `m`, and their Bézier polygon.
fn biarc(pair: &ConePair, m: &Vec3) -> Vec<Vec<Vec3>> {
    let foot = |g: &G1Element| g.at((m - g.point).dot(&g.direction));
    let arcs = pair.segments.iter().map(|s| (0..=48).map(|i| foot(&s.element(f64::from(i) / 48.0))).collect());
    let mut out: Vec<Vec<Vec3>> = arcs.collect();
    for s in &pair.segments {
        let (a, c) = (foot(&s.start), foot(&s.end()));
        // Tangents to the arc at both ends meet in the inner Bézier point.
        let chord = c - a;
        let b = a + s.start.forward * (0.5 * chord.norm_squared() / chord.dot(&s.start.forward));
        out.push(vec![a, b, c]);
    }
    out
}

/// The surface of constant slope (45°) through an ellipse.
fn over_ellipse(u: f64) -> StripJet {
    let (x, y) = (2.0, 1.4);
    let (s, c) = u.sin_cos();
    let foot = [Vec3::new(x * c, y * s, 0.0), Vec3::new(-x * s, y * c, 0.0), Vec3::new(-x * c, -y * s, 0.0)];
    // Outward normal of the ellipse; derivatives of the far end by differences, which is enough for a picture.
    let far = |u: f64| {
        let (s, c) = u.sin_cos();
        Vec3::new(x * c, y * s, 0.0) + Vec3::new(y * c, x * s, 0.0).normalize() * 1.2 - Vec3::z() * 1.2
    };
    let h = 1e-4;
    let (l, f, r) = (far(u - h), far(u), far(u + h));
    StripJet { ends: [foot, [f, (r - l) / (2.0 * h), (r - f * 2.0 + l) / (h * h)]] }
}
