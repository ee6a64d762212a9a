//! STEP writer: shells of trimmed faces in an AP214 file, millimetres and radians.
//!
//! Every shell becomes one OPEN_SHELL in a SHELL_BASED_SURFACE_MODEL of its own, named, so that CAD systems show it
//! as a separate body; faces carry names too. Numbers are written so that they read back bit for bit; rational
//! control points are written divided by their weights, which rounds each coordinate once.
//! The writer neither checks nor repairs geometry.

mod cones;
mod geometry;
mod records;
pub(crate) mod sewn;
mod shell;

use std::io;

use crate::geom::Frame;
use crate::patchwork::panel::Patchwork;
pub use crate::patchwork::shell_surface::{ShellSurface, SurfaceForm};
use records::{boolean, list, real, references, string, Records};
pub use shell::{EdgeUse, Shell, ShellCurve, ShellEdge, ShellFace};

/// What the file says about itself.
#[derive(Clone, Debug)]
pub struct Header {
    /// Name of the product and of the file.
    pub name: String,
    /// Time stamp in the form `2026-11-21T14:30:00`.
    pub time: String,
    /// Distance (mm) within which edges, faces and vertices meet: UNCERTAINTY_MEASURE_WITH_UNIT.
    pub uncertainty: f64,
}

/// The file of the panels of a patchwork, normals on the side of the input faces' normals: panels that share edges are
/// sewn into one shell, the others are shells of their own. Names of panels that `marked` holds for say that they must not
/// be cut.
///
/// # Errors
/// As [`shells`].
///
/// # Example
/// ```
/// use torse::io::step::write::{panels, Header};
/// let plate = torse::read(include_bytes!("../../../../../data/cylinder_holes.step"))?;
/// let answer = torse::approximate(&plate, &torse::Approximate::new(0.5))?;
/// let header = Header { name: "plate".into(), time: "2026-01-31T12:00:00".into(), uncertainty: 0.01 };
/// let bytes = panels(&header, answer.patchwork(), &[])?;
/// let back = torse::read_step(&bytes)?;
/// assert_eq!(back.faces[0].surface, answer.patchwork().panels[0].strip.patch);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn panels(header: &Header, patchwork: &Patchwork, marked: &[bool]) -> io::Result<Vec<u8>> {
    self::shells(header, &sewn::shells(patchwork, marked))
}

/// The file of shells.
///
/// # Errors
/// An edge or vertex number that is out of range ([`io::ErrorKind::InvalidInput`]).
pub fn shells(header: &Header, shells: &[Shell]) -> io::Result<Vec<u8>> {
    let mut r = Records::after(head(header));
    let product = product(&mut r, &header.name);
    let context = context(&mut r, header.uncertainty);
    let plane = r.push(
        "(GEOMETRIC_REPRESENTATION_CONTEXT(2) PARAMETRIC_REPRESENTATION_CONTEXT() REPRESENTATION_CONTEXT('2D SPACE',''))",
    );
    let mut items = vec![geometry::placement(&mut r, &Frame::world())];
    for s in shells {
        items.push(shell_model(&mut r, s, plane)?);
    }
    let shape = r.push(&format!(
        "MANIFOLD_SURFACE_SHAPE_REPRESENTATION({},{},#{context})",
        string(&header.name),
        references(items)
    ));
    let definition = r.push(&format!("PRODUCT_DEFINITION_SHAPE('',$,#{product})"));
    r.push(&format!("SHAPE_DEFINITION_REPRESENTATION(#{definition},#{shape})"));
    let mut text = r.into_text();
    text.push_str("ENDSEC;\nEND-ISO-10303-21;\n");
    Ok(text.into_bytes())
}

/// Everything before the first record.
fn head(header: &Header) -> String {
    let program = string(concat!("torse ", env!("CARGO_PKG_VERSION")));
    let mut s = String::from("ISO-10303-21;\nHEADER;\n");
    records::wrap("FILE_DESCRIPTION(('Developable panels and freeform sheets'),'2;1');", &mut s);
    let name =
        format!("FILE_NAME({},{},(''),(''),{program},{program},'');", string(&header.name), string(&header.time));
    records::wrap(&name, &mut s);
    records::wrap("FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));", &mut s);
    s.push_str("ENDSEC;\nDATA;\n");
    s
}

/// The product and its definition; answers the PRODUCT_DEFINITION.
fn product(r: &mut Records, name: &str) -> u64 {
    let application = r.push("APPLICATION_CONTEXT('core data for automotive mechanical design processes')");
    r.push(&format!(
        "APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#{application})"
    ));
    let context = r.push(&format!("PRODUCT_CONTEXT('',#{application},'mechanical')"));
    let name = string(name);
    let product = r.push(&format!("PRODUCT({name},{name},'',(#{context}))"));
    r.push(&format!("PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(#{product}))"));
    let formation = r.push(&format!("PRODUCT_DEFINITION_FORMATION('','',#{product})"));
    let stage = r.push(&format!("PRODUCT_DEFINITION_CONTEXT('part definition',#{application},'design')"));
    r.push(&format!("PRODUCT_DEFINITION('design','',#{formation},#{stage})"))
}

/// Units and uncertainty of the model space.
fn context(r: &mut Records, uncertainty: f64) -> u64 {
    let length = r.push("(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.))");
    let angle = r.push("(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.))");
    let solid = r.push("(NAMED_UNIT(*) SI_UNIT($,.STERADIAN.) SOLID_ANGLE_UNIT())");
    let measure = r.push(&format!(
        "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({}),#{length},'distance_accuracy_value','confusion accuracy')",
        real(uncertainty)
    ));
    r.push(&format!(
        "(GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{measure})) \
         GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length},#{angle},#{solid})) REPRESENTATION_CONTEXT('','3D'))"
    ))
}

/// One shell; answers its SHELL_BASED_SURFACE_MODEL.
fn shell_model(r: &mut Records, s: &Shell, plane: u64) -> io::Result<u64> {
    let vertices: Vec<u64> = s
        .vertices
        .iter()
        .map(|p| {
            let p = geometry::point(r, p.as_slice());
            r.push(&format!("VERTEX_POINT('',#{p})"))
        })
        .collect();
    let surfaces: Vec<u64> = s.faces.iter().map(|f| geometry::surface(r, &f.surface)).collect();
    let mut edges = Vec::with_capacity(s.edges.len());
    for (i, e) in s.edges.iter().enumerate() {
        let (Some(&a), Some(&b)) = (vertices.get(e.start), vertices.get(e.end)) else {
            return Err(out_of_range(&s.name, "vertex", e.start.max(e.end)));
        };
        let space = geometry::edge_curve(r, &e.curve, &s.vertices[e.start], &s.vertices[e.end]);
        let curve = with_trims(r, s, &surfaces, i, space, plane);
        edges.push(r.push(&format!("EDGE_CURVE('',#{a},#{b},#{curve},.T.)")));
    }
    let mut faces = Vec::with_capacity(s.faces.len());
    for (f, &surface) in s.faces.iter().zip(&surfaces) {
        faces.push(face(r, s, f, surface, &edges)?);
    }
    let name = string(&s.name);
    let shell = r.push(&format!("OPEN_SHELL({name},{})", references(faces)));
    Ok(r.push(&format!("SHELL_BASED_SURFACE_MODEL({name},(#{shell}))")))
}

/// The space curve of edge `i` together with its curves in the parameter planes of the faces that it bounds.
fn with_trims(r: &mut Records, s: &Shell, surfaces: &[u64], i: usize, space: u64, plane: u64) -> u64 {
    let mut trims = Vec::new();
    let mut seam = false;
    for (f, &surface) in s.faces.iter().zip(surfaces) {
        let before = trims.len();
        for trim in f.loops.iter().flatten().filter(|u| u.edge == i).filter_map(|u| u.trim.as_ref()) {
            let c = geometry::curve(r, trim);
            let representation = r.push(&format!("DEFINITIONAL_REPRESENTATION('',(#{c}),#{plane})"));
            trims.push(r.push(&format!("PCURVE('',#{surface},#{representation})")));
        }
        seam |= trims.len() > before + 1;
    }
    if trims.is_empty() {
        return space;
    }
    let keyword = if seam { "SEAM_CURVE" } else { "SURFACE_CURVE" };
    r.push(&format!("{keyword}('',#{space},{},.CURVE_3D.)", references(trims)))
}

/// One face; answers its ADVANCED_FACE.
fn face(r: &mut Records, s: &Shell, f: &ShellFace, surface: u64, edges: &[u64]) -> io::Result<u64> {
    let mut bounds = Vec::with_capacity(f.loops.len());
    for (k, uses) in f.loops.iter().enumerate() {
        let mut oriented = Vec::with_capacity(uses.len());
        for u in uses {
            let Some(edge) = edges.get(u.edge) else {
                return Err(out_of_range(&s.name, "edge", u.edge));
            };
            oriented.push(r.push(&format!("ORIENTED_EDGE('',*,*,#{edge},{})", boolean(u.forward))));
        }
        let edge_loop = r.push(&format!("EDGE_LOOP('',{})", references(oriented)));
        let keyword = if k == 0 { "FACE_OUTER_BOUND" } else { "FACE_BOUND" };
        bounds.push(format!("#{}", r.push(&format!("{keyword}('',#{edge_loop},.T.)"))));
    }
    Ok(r.push(&format!("ADVANCED_FACE({},{},#{surface},{})", string(&f.name), list(bounds), boolean(!f.reversed))))
}

fn out_of_range(shell: &str, what: &str, index: usize) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, format!("sheet {shell:?} names {what} {index}, which it does not have"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;
    use crate::patchwork::panel::{Border, Coedge, Panel, PanelForm, PanelTrim};
    use crate::spline::curve::Curve;
    use crate::spline::knots::Knots;
    use crate::spline::surface::Surface;
    use crate::torse::form::{DualTorse, PanelKind, Torse};
    use crate::torse::strip::Strip;

    /// Parabolic cylinder (100 t, 200 r, 50 t²) with a rectangular outline and a hole; all edges exact.
    /// With `mirrored` the loops run the other way round in the parameter plane.
    fn panel(mirrored: bool) -> Panel {
        let points: Vec<Vec3> = [(0.0, 0.0), (50.0, 0.0), (100.0, 50.0)]
            .iter()
            .flat_map(|&(x, z)| [Vec3::new(x, 0.0, z), Vec3::new(x, 200.0, z)])
            .collect();
        let knots = |p| Knots::clamped(p, &[0.0, 1.0]).expect("knots");
        let patch = Surface::new(knots(2), knots(1), &points, None).expect("patch");
        let side = |a: [f64; 2], b: [f64; 2]| {
            let at = |t: f64, r: f64| [100.0 * t, 200.0 * r, 50.0 * t * t];
            let mut middle = at(0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]));
            middle[2] = 50.0 * a[0] * b[0]; // blossom of t²
            let ends = [0.0, 0.0, 1.0, 1.0].to_vec();
            Coedge {
                border: Border::Trim { edge: 0 },
                vertices: Vec::new(),
                parameters: Vec::new(),
                trim: Curve::new(1, ends, vec![a, b]).expect("trim"),
                edge: Curve { knots: knots(2), control: vec![at(a[0], a[1]), middle, at(b[0], b[1])] },
            }
        };
        let ring = |mut corners: Vec<[f64; 2]>| -> Vec<Coedge> {
            if mirrored {
                corners.reverse();
            }
            (0..corners.len()).map(|i| side(corners[i], corners[(i + 1) % corners.len()])).collect()
        };
        let planes = Curve { knots: knots(1), control: vec![[0.0, 0.0, 1.0, 0.0], [-1.0, 0.0, 1.0, -50.0]] };
        Panel {
            strip: Strip { name: "A-01 'Bug'".into(), kind: PanelKind::Cylinder, patch },
            trim: Some(PanelTrim {
                face: 0,
                label: 0,
                form: PanelForm::Torse(Torse::Dual(DualTorse { planes })),
                loops: vec![
                    ring(vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]),
                    ring(vec![[0.3, 0.4], [0.3, 0.7], [0.6, 0.7], [0.6, 0.4]]),
                ],
            }),
            outline: Vec::new(),
        }
    }

    fn written(shell: Shell) -> String {
        let header = Header { name: "test".into(), time: "2026-01-01T00:00:00".into(), uncertainty: 1e-6 };
        String::from_utf8(shells(&header, &[shell]).expect("written")).expect("text").replace('\n', "")
    }

    #[test]
    fn every_reference_points_back_to_a_record() {
        let text = written(Shell::of_panel(&panel(false), false));
        let data = text.split_once("DATA;").expect("a data section").1;
        for (known, record) in data.split(';').filter(|r| r.starts_with('#')).enumerate() {
            let (id, body) = record.split_once('=').expect("a record");
            assert_eq!(id, format!("#{}", known + 1));
            for reference in body.split('#').skip(1) {
                let digits: String = reference.chars().take_while(char::is_ascii_digit).collect();
                assert!(digits.parse::<usize>().expect("a number") <= known, "{record}");
            }
        }
        for (keyword, count) in [
            ("ADVANCED_FACE('A-01 ''Bug''',", 1),
            ("OPEN_SHELL('A-01 ''Bug''',", 1),
            ("FACE_OUTER_BOUND(", 1),
            ("FACE_BOUND(", 1),
            ("EDGE_CURVE(", 8),
            ("VERTEX_POINT(", 8),
            ("PCURVE(", 8),
            (".SURF_OF_LINEAR_EXTRUSION.", 1),
            ("LENGTH_MEASURE(1.E-6)", 1),
            ("SI_UNIT(.MILLI.,.METRE.)", 1),
        ] {
            assert_eq!(data.matches(keyword).count(), count, "{keyword}");
        }
    }

    #[test]
    fn borders_that_are_points_are_not_edges() {
        let mut with_pole = panel(false);
        let outer = &mut with_pole.loops_mut()[0];
        let (place, point) = (outer[0].trim.control[0], outer[0].edge.control[0]);
        let mut pole = outer[0].clone();
        pole.trim.control.fill(place);
        pole.edge.control.fill(point);
        outer.insert(0, pole);
        let without = written(Shell::of_panel(&panel(false), false));
        assert_eq!(written(Shell::of_panel(&with_pole, false)), without);
    }

    #[test]
    fn the_sense_of_a_face_follows_its_loops_and_the_input_face() {
        let same_sense = |mirrored, reversed| {
            let text = written(Shell::of_panel(&panel(mirrored), reversed));
            let face = text.split("ADVANCED_FACE(").nth(1).expect("a face");
            face.split_once(");").expect("its end").0.ends_with(".T.")
        };
        assert!(same_sense(false, false) && !same_sense(true, false));
        assert!(!same_sense(false, true) && same_sense(true, true));
        let uses = written(Shell::of_panel(&panel(false), true));
        assert_eq!(uses.matches("ORIENTED_EDGE('',*,*,#").count(), 8);
        assert!(uses.split("ORIENTED_EDGE(").skip(1).all(|u| u.split(';').next().is_some_and(|u| u.ends_with(".F.)"))));
    }

    #[test]
    fn a_rational_surface_is_a_complex_record() {
        let knots = Knots::clamped(1, &[0.0, 1.0]).expect("knots");
        let points = [Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::x() + Vec3::y()];
        let s = Surface::new(knots.clone(), knots, &points, Some(&[1.0, 0.5, 1.0, 1.0])).expect("surface");
        let text = written(Shell::untrimmed("twisted", &s));
        assert!(text.contains("RATIONAL_B_SPLINE_SURFACE(((1.,0.5),(1.,1.)))"));
        assert_eq!(text.matches("RATIONAL_B_SPLINE_CURVE((").count(), 4);
        // Control point (1, 0, 0) of weight 0.5 is written as itself, not times its weight.
        assert!(text.contains("CARTESIAN_POINT('',(1.,0.,0.))") && !text.contains("CARTESIAN_POINT('',(0.5,0.,0.))"));
    }

    #[test]
    fn an_edge_that_does_not_exist_is_an_error() {
        let mut shell = Shell::of_panel(&panel(false), false);
        shell.faces[0].loops[0][0].edge = 99;
        let header = Header { name: String::new(), time: String::new(), uncertainty: 1e-6 };
        let error = shells(&header, &[shell]).expect_err("refused");
        assert!(error.to_string().contains("edge 99"), "{error}");
    }
}
