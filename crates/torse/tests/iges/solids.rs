//! Solids and shells with analytic surfaces.

use super::file::{entry, Entry, File};
use super::{has_area, model};
use std::f64::consts::PI;
use torse::brep::raw::SurfaceKind;
use torse::geom::Vec3;

const PART: &str = "00010000";

fn part(kind: u32) -> Entry<'static> {
    Entry { status: PART, ..entry(kind) }
}

/// A closed cylinder of radius 2 and height 5, as a solid of three faces.
fn drum(f: &mut File) -> u64 {
    let low = f.add(part(116), "0.,0.,0.");
    let high = f.add(part(116), "0.,0.,5.");
    let up = f.add(part(123), "0.,0.,1.");
    let down = f.add(part(123), "0.,0.,-1.");
    let side = f.add(part(192), &format!("{low},{up},2."));
    let bottom = f.add(part(190), &format!("{low},{down}"));
    let top = f.add(part(190), &format!("{high},{up}"));
    let circles = ["0.", "5."].map(|z| f.add(part(100), &format!("{z},0.,0.,2.,0.,2.,0.")));
    let seam = f.add(part(110), "2.,0.,0.,2.,0.,5.");
    let vertices = f.add(part(502), "2,2.,0.,0.,2.,0.,5.");
    let v = vertices;
    let edges =
        f.add(part(504), &format!("3,{},{v},1,{v},1,{},{v},2,{v},2,{seam},{v},1,{v},2", circles[0], circles[1]));
    // Loop: kind, list, index, sense, no curves in the parameter plane.
    let e = edges;
    let around = f.add(Entry { form: 1, ..part(508) }, &format!("4,0,{e},1,1,0,0,{e},3,1,0,0,{e},2,0,0,0,{e},3,0,0"));
    let below = f.add(Entry { form: 1, ..part(508) }, &format!("1,0,{e},1,0,0"));
    let above = f.add(Entry { form: 1, ..part(508) }, &format!("1,0,{e},2,1,0"));
    let faces = [(side, around), (bottom, below), (top, above)]
        .map(|(s, l)| f.add(Entry { form: 1, ..part(510) }, &format!("{s},1,1,{l}")));
    let shell = f.add(Entry { form: 1, ..part(514) }, &format!("3,{},1,{},1,{},1", faces[0], faces[1], faces[2]));
    f.add(entry(186), &format!("{shell},1,0"))
}

#[test]
fn a_solid_has_its_faces_with_outward_normals_and_one_body() {
    let mut f = File::new();
    drum(&mut f);
    f.rectangle(entry(128), 1.0, 1.0);
    let m = model(&f);
    assert_eq!(m.faces.len(), 4);
    let kinds: Vec<SurfaceKind> = m.faces.iter().map(|f| f.kind).collect();
    assert_eq!(kinds[..3], [SurfaceKind::Cylinder, SurfaceKind::Plane, SurfaceKind::Plane]);
    for (face, wanted) in m.faces.iter().zip([20.0 * PI, 4.0 * PI, 4.0 * PI]) {
        has_area(face, wanted);
    }
    let bodies: Vec<u32> = m.faces.iter().map(|f| f.body).collect();
    assert!(bodies[0] == bodies[1] && bodies[1] == bodies[2] && bodies[3] != bodies[0], "{bodies:?}");
    for face in &m.faces[..3] {
        let s = &face.surface;
        let [u, v] = face.loops[0].points[0];
        let j = s.jet(u, v);
        let n = j.normal() * if face.reversed { -1.0 } else { 1.0 };
        let out = j.p - Vec3::new(0.0, 0.0, 2.5);
        assert!(n.dot(&out) > 0.0, "{:?} {n:?}", face.kind);
    }
}

#[test]
fn spheres_cones_and_tori_by_themselves_or_in_shells() {
    let mut f = File::new();
    let centre = f.add(part(116), "1.,2.,3.");
    let up = f.add(part(123), "0.,0.,1.");
    f.add(entry(196), &format!("{centre},2."));
    f.add(entry(198), &format!("{centre},{up},5.,1."));
    let m = model(&f);
    has_area(&m.faces[0], 16.0 * PI);
    has_area(&m.faces[1], 20.0 * PI * PI);
    // A cone of half angle 45° from radius 2 to its tip, bounded by one circle and a vertex.
    let mut f = File::new();
    let centre = f.add(part(116), "0.,0.,0.");
    let down = f.add(part(123), "0.,0.,-1.");
    let cone = f.add(part(194), &format!("{centre},{down},2.,45."));
    let circle = f.add(part(100), "0.,0.,0.,2.,0.,2.,0.");
    let v = f.add(part(502), "2,2.,0.,0.,0.,0.,2.");
    let e = f.add(part(504), &format!("1,{circle},{v},1,{v},1"));
    let l = f.add(part(508), &format!("1,0,{e},1,1,0"));
    let tip = f.add(part(508), &format!("1,1,{v},2,1,0"));
    let face = f.add(part(510), &format!("{cone},2,1,{l},{tip}"));
    f.add(Entry { form: 2, ..entry(514) }, &format!("1,{face},1"));
    has_area(&model(&f).faces[0], 2.0 * PI * 8f64.sqrt());
}
