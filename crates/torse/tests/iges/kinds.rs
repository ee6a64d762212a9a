//! Every sort of surface and curve.

use super::file::{entry, Entry, File};
use super::{area, has_area, model};
use std::f64::consts::{PI, TAU};
use torse::brep::raw::SurfaceKind;
use torse::io::iges::read::{self, free};

const PART: &str = "00010000";

fn part(kind: u32) -> Entry<'static> {
    Entry { status: PART, ..entry(kind) }
}

#[test]
fn units_and_scale_make_millimetres() {
    for (units, factor) in
        [("1.0,2,2HMM", 1.0), ("1.0D0,1,4HINCH", 25.4), (",6,1HM", 1000.0), ("1.,3,2HCM", 10.0), ("0.5,4,2HFT", 609.6)]
    {
        let mut f = File::new();
        f.units = units.into();
        f.rectangle(entry(128), 3.0, 2.0);
        let m = model(&f);
        assert!((area(&m.faces[0]) / (6.0 * factor * factor) - 1.0).abs() < 1e-12, "{units}");
    }
}

#[test]
fn a_surface_without_the_range_of_its_parameters_is_whole() {
    let mut f = File::new();
    f.add(entry(128), "1,1,1,1,0,0,1,0,0,0.,0.,1.,1.,0.,0.,1.,1.,1.,1.,1.,1.,0.,0.,0.,3.,0.,0.,0.,2.,0.,3.,2.,0.");
    has_area(&model(&f).faces[0], 6.0);
    let mut f = File::new();
    f.add(
        entry(128),
        "1,1,1,1,0,0,1,0,0,0.,0.,1.,1.,0.,0.,1.,1.,1.,1.,1.,1.,0.,0.,0.,3.,0.,0.,0.,2.,0.,3.,2.,0.,0.5,1.,0.,1.",
    );
    has_area(&model(&f).faces[0], 3.0);
}

#[test]
fn a_parametric_spline_surface_is_the_polynomial() {
    // One patch over [0, 2] × [1, 2]: x = s, y = 3 t, z = 0, with the row and column of padding, and without.
    let coefficients = |x: &[(usize, f64)]| -> String {
        (0..16)
            .map(|k| x.iter().find(|p| p.0 == k).map_or("0.".into(), |p| format!("{:?}", p.1)))
            .collect::<Vec<_>>()
            .join(",")
    };
    let patch = [coefficients(&[(1, 1.0)]), coefficients(&[(4, 3.0)]), coefficients(&[(0, 7.0)])].join(",");
    let padding = vec!["9.,"; 48 * 3].concat();
    for tail in [String::new(), format!(",{}", padding.trim_end_matches(','))] {
        let mut f = File::new();
        f.add(entry(114), &format!("3,1,1,1,0.,2.,1.,2.,{patch}{tail}"));
        let m = model(&f);
        has_area(&m.faces[0], 6.0);
        let s = &m.faces[0].surface;
        assert_eq!((s.knots_u.degree(), s.knots_v.degree()), (1, 1));
        assert!((s.point(1.0, 1.5) - torse::geom::Vec3::new(1.0, 1.5, 7.0)).norm() < 1e-14);
    }
}

#[test]
fn patches_that_go_on_smoothly_have_no_crease() {
    // x = u, y = v, z = u² over two patches, of which the second continues the parabola, or begins anew.
    for (slope, creases) in [(2.0, 0), (0.0, 1)] {
        let row = |x: &[(usize, f64)]| -> Vec<String> {
            (0..16).map(|k| format!("{:?}", x.iter().find(|p| p.0 == k).map_or(0.0, |p| p.1))).collect()
        };
        let patch = |x0: f64, z: &[(usize, f64)]| [row(&[(0, x0), (1, 1.0)]), row(&[(4, 1.0)]), row(z)].concat();
        let both = [patch(0.0, &[(2, 1.0)]), patch(1.0, &[(0, 1.0), (1, slope), (2, 1.0)])].concat().join(",");
        let mut f = File::new();
        f.add(entry(114), &format!("3,1,2,1,0.,1.,2.,0.,1.,{both}"));
        let m = model(&f);
        let s = &m.faces[0].surface;
        assert_eq!((s.c0_lines().0.len(), m.faces[0].surface_deviation_estimate()), (creases, 0.0));
        let p = s.point(1.5, 0.5);
        assert!((p - torse::geom::Vec3::new(1.5, 0.5, 1.25 + 0.5 * slope)).norm() < 1e-14, "{p:?}");
    }
}

#[test]
fn ruled_surfaces_between_lines_arcs_and_both() {
    // Two circles of one radius: a tube, exactly a cylinder over its curve.
    let mut f = File::new();
    let low = f.add(part(100), "0.,0.,0.,2.,0.,2.,0.");
    let high = f.add(part(100), "5.,0.,0.,2.,0.,2.,0.");
    f.add(Entry { form: 1, ..entry(118) }, &format!("{low},{high},0,1"));
    let m = model(&f);
    assert_eq!(m.faces[0].kind, SurfaceKind::Extrusion);
    has_area(&m.faces[0], 20.0 * PI);
    // Two lines, the second run backwards: a plane rectangle only if it is turned.
    let mut f = File::new();
    let low = f.add(part(110), "0.,0.,0.,3.,0.,0.");
    let high = f.add(part(110), "3.,2.,0.,0.,2.,0.");
    f.add(entry(118), &format!("{low},{high},1,1"));
    has_area(&model(&f).faces[0], 6.0);
    // A half circle and its diameter: half a disc, however points belong together.
    for form in [0, 1] {
        let mut f = File::new();
        let arc = f.add(part(100), "0.,0.,0.,2.,0.,-2.,0.");
        let line = f.add(part(110), "2.,0.,0.,-2.,0.,0.");
        f.add(Entry { form, ..entry(118) }, &format!("{arc},{line},0,0"));
        let m = model(&f);
        assert!((area(&m.faces[0]) - TAU).abs() < 1e-5, "{}", area(&m.faces[0]));
        assert!(m.faces[0].surface_deviation_estimate() < 1e-5);
    }
}

#[test]
fn surfaces_of_revolution_are_what_they_are() {
    let revolved = |generatrix: (u32, &str), angles: &str| {
        let mut f = File::new();
        let axis = f.add(part(110), "0.,0.,0.,0.,1.,0.");
        let curve = f.add(part(generatrix.0), generatrix.1);
        f.add(entry(120), &format!("{axis},{curve},{angles}"));
        model(&f).faces.swap_remove(0)
    };
    let cylinder = revolved((110, "2.,0.,0.,2.,5.,0."), "0.,3.14159265358979");
    assert_eq!(cylinder.kind, SurfaceKind::Cylinder);
    has_area(&cylinder, 10.0 * PI);
    let cone = revolved((110, "0.,0.,0.,3.,4.,0."), "0.,6.28318530717959");
    assert_eq!(cone.kind, SurfaceKind::Cone);
    has_area(&cone, 15.0 * PI);
    let disc = revolved((110, "0.,1.,0.,3.,1.,0."), "0.,1.");
    assert_eq!(disc.kind, SurfaceKind::Plane);
    has_area(&disc, 4.5);
    let sphere = revolved((100, "0.,0.,0.,0.,-2.,0.,2."), "0.,6.28318530717959");
    assert_eq!(sphere.kind, SurfaceKind::Sphere);
    has_area(&sphere, 16.0 * PI);
    let torus = revolved((100, "0.,5.,0.,6.,0.,6.,0."), "0.,6.28318530717959");
    assert_eq!(torus.kind, SurfaceKind::Torus);
    has_area(&torus, 20.0 * PI * PI);
}

#[test]
fn tabulated_cylinders_and_offsets() {
    let mut f = File::new();
    let arc = f.add(part(100), "0.,0.,0.,2.,0.,-2.,0.");
    let tube = f.add(part(122), &format!("{arc},2.,0.,5."));
    // The indicator shows to the outside: two more.
    f.add(entry(140), &format!("0.,1.,0.,2.,{tube}"));
    let e = read::read(&f.bytes()).expect_err("an endless cylinder");
    assert!(e.to_string().contains("D5"), "{e}");
    let mut f = File::new();
    let arc = f.add(part(100), "0.,0.,0.,2.,0.,-2.,0.");
    f.add(entry(122), &format!("{arc},2.,0.,5."));
    let m = model(&f);
    assert_eq!(m.faces[0].kind, SurfaceKind::Extrusion);
    has_area(&m.faces[0], 10.0 * PI);
    let mut f = File::new();
    let flat = f.rectangle(part(128), 3.0, 2.0);
    f.add(entry(140), &format!("0.,0.,-1.,0.25,{flat}"));
    let m = model(&f);
    assert!((m.faces[0].surface.point(0.5, 0.5).z + 0.25).abs() < 1e-9);
    has_area(&m.faces[0], 6.0);
}

#[test]
fn free_curves_come_in_millimetres() {
    let mut f = File::new();
    f.units = "1.0,10,2HCM".into();
    f.add(entry(110), "0.,0.,0.,1.,2.,2.");
    f.add(entry(100), "1.,0.,0.,2.,0.,0.,2.");
    f.add(Entry { form: 1, ..entry(104) }, "0.25,0.,1.,0.,0.,-1.,0.,2.,0.,0.,1.");
    f.add(Entry { form: 12, ..entry(106) }, "2,3,0.,0.,0.,3.,0.,0.,3.,4.,0.");
    f.add(Entry { form: 63, ..entry(106) }, "1,3,1.,0.,0.,3.,0.,3.,4.");
    // x = t, y = t², z = 1 on [0, 2], and a cubic on top: a parabola written as two pieces.
    f.add(entry(112), "3,0,3,2,0.,1.,2.,0.,1.,0.,0.,0.,0.,1.,0.,1.,0.,0.,0.,1.,1.,0.,0.,1.,2.,1.,0.,1.,0.,0.,0.");
    f.add(entry(126), "2,2,1,0,1,0,0.,0.,0.,1.,1.,1.,1.,1.,1.,0.,0.,0.,1.,0.,0.,1.,1.,0.,0.,1.,0.,0.,1.");
    // Those that are parts of others, marks and drawings are not meant.
    let line = f.add(part(110), "9.,0.,0.,9.,1.,0.");
    f.add(entry(122), &format!("{line},9.,0.,5."));
    f.add(Entry { form: 1, ..entry(106) }, "1,2,0.,0.,0.,1.,1.");
    f.add(Entry { status: "00000100", ..entry(110) }, "7.,0.,0.,8.,0.,0.");
    let all = free::curves(&f.bytes()).expect("curves");
    let ids: Vec<u64> = all.iter().map(|c| c.entity).collect();
    assert_eq!(ids, [1, 3, 5, 7, 9, 11, 13]);
    let length = |k: usize| -> f64 {
        let points = |c: &torse::spline::curve::Curve<4>| -> Vec<torse::geom::Vec3> {
            let (a, b) = c.domain();
            let at = |i: i32| c.point(a + (b - a) * f64::from(i) / 500.0);
            (0..=500).map(at).map(|h| torse::geom::Vec3::new(h[0], h[1], h[2]) / h[3]).collect()
        };
        all[k].curves.iter().map(|c| points(c).windows(2).map(|w| (w[1] - w[0]).norm()).sum::<f64>()).sum()
    };
    let parabola = |x: f64| 0.5 * x * (1.0 + 4.0 * x * x).sqrt() + 0.25 * (2.0 * x).asinh();
    let wanted = [3.0, PI, 2.422_112_055, 7.0, 12.0, parabola(2.0), 1.622_525_3];
    for (k, w) in wanted.into_iter().enumerate() {
        assert!((length(k) - 10.0 * w).abs() < 2e-3 * 10.0 * w, "curve {k}: {} instead of {}", length(k), 10.0 * w);
    }
}

#[test]
fn edges_of_faces_serve_where_no_curve_is_free() {
    let mut f = File::new();
    let surface = f.rectangle(part(128), 4.0, 3.0);
    let c = f.polygon(&[[1., 1., 0.], [3., 1., 0.], [3., 2., 0.]], PART);
    let b = f.add(part(142), &format!("0,{surface},0,{c},2"));
    f.add(entry(144), &format!("{surface},1,0,{b}"));
    let all = free::curves(&f.bytes()).expect("curves");
    assert_eq!(all.iter().map(|c| c.entity).collect::<Vec<_>>(), [3, 5, 7]);
}
