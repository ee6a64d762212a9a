//! STEP writer: sheets of trimmed faces in an AP214 file, millimetres and radians.
//!
//! Every sheet becomes one OPEN_SHELL in a SHELL_BASED_SURFACE_MODEL of its own, named, so that CAD systems show it
//! as a separate body; faces carry names too. Numbers are written so that they read back bit for bit; rational
//! control points are written divided by their weights, which rounds each coordinate once.
//! The writer neither checks nor repairs geometry.

mod geometry;
mod records;

use std::io;

use crate::geom::{Frame, Vec3};
use crate::spline::curve::Curve;
use crate::spline::surface::Surface;
use crate::surface::panel::{Panel, Patchwork};
use crate::surface::torse::PanelKind;
use records::{boolean, list, real, references, string, Records};

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

/// Connected faces with the edges and vertices that they share.
#[derive(Clone, Debug, Default)]
pub struct Sheet {
    /// Name of the body.
    pub name: String,
    /// Corner points, mm.
    pub vertices: Vec<Vec3>,
    /// Edges between them.
    pub edges: Vec<SheetEdge>,
    /// Faces.
    pub faces: Vec<SheetFace>,
}

/// An edge: a curve between two vertices (twice the same for a closed edge).
#[derive(Clone, Debug)]
pub struct SheetEdge {
    /// Index of the first vertex.
    pub start: usize,
    /// Index of the last vertex.
    pub end: usize,
    /// Curve from start to end.
    pub curve: SheetCurve,
}

/// Curve of an edge.
#[derive(Clone, Debug)]
pub enum SheetCurve {
    /// The straight line between the vertices.
    Line,
    /// Arc of a circle about the frame's z-axis, run counter-clockwise.
    Circle {
        /// Centre and axes.
        frame: Frame,
        /// Radius, mm.
        radius: f64,
    },
    /// Polynomial spline.
    Spline(Curve<3>),
    /// Rational spline, homogeneous, weight last.
    Rational(Curve<4>),
}

/// A face: a surface and its loops.
#[derive(Clone, Debug)]
pub struct SheetFace {
    /// Name of the face.
    pub name: String,
    /// Surface that carries it.
    pub surface: SheetSurface,
    /// Whether the face's normal is the opposite of the surface's.
    pub reversed: bool,
    /// Loops, outer first, counter-clockwise about the face's normal; holes clockwise.
    pub loops: Vec<Vec<EdgeUse>>,
}

/// An edge as part of a loop.
#[derive(Clone, Debug)]
pub struct EdgeUse {
    /// Index of the edge.
    pub edge: usize,
    /// Whether the loop follows the edge's own direction.
    pub forward: bool,
    /// The edge in the surface's parameter plane, if known: in the edge's own direction and parameter.
    pub trim: Option<Curve<2>>,
}

/// Surface of a face.
#[derive(Clone, Debug)]
pub enum SheetSurface {
    /// The plane z = 0 of the frame.
    Plane(Frame),
    /// Cylinder about the frame's z-axis.
    Cylinder {
        /// Axis z; angles from x.
        frame: Frame,
        /// Radius, mm.
        radius: f64,
    },
    /// Cone about the frame's z-axis, widening along z.
    Cone {
        /// Axis z; angles from x.
        frame: Frame,
        /// Radius at z = 0, mm.
        radius: f64,
        /// Angle between axis and rulings, rad.
        half_angle: f64,
    },
    /// B-spline surface.
    Spline {
        /// The surface.
        surface: Surface,
        /// What it is, for readers that care.
        form: SurfaceForm,
    },
}

/// The hint `surface_form` of a B-spline surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceForm {
    /// Plane.
    Plane,
    /// Cylinder over any curve.
    Extrusion,
    /// Cone over any curve.
    Cone,
    /// Other ruled surface.
    Ruled,
    /// Freeform.
    Unspecified,
}

impl SurfaceForm {
    fn keyword(self) -> &'static str {
        match self {
            Self::Plane => "PLANE_SURF",
            Self::Extrusion => "SURF_OF_LINEAR_EXTRUSION",
            Self::Cone => "GENERALISED_CONE",
            Self::Ruled => "RULED_SURF",
            Self::Unspecified => "UNSPECIFIED",
        }
    }
}

impl From<PanelKind> for SurfaceForm {
    fn from(kind: PanelKind) -> Self {
        match kind {
            PanelKind::Plane => Self::Plane,
            PanelKind::Cylinder => Self::Extrusion,
            PanelKind::Cone => Self::Cone,
            PanelKind::Torse => Self::Ruled,
        }
    }
}

impl Sheet {
    /// One panel: its patch, trimmed by its runs. With `reversed` the normal is turned over (as that of a face
    /// whose normal is −S_u × S_v).
    pub fn of_panel(panel: &Panel, reversed: bool) -> Self {
        let mut sheet = Self { name: panel.name.clone(), ..Self::default() };
        let mut loops = Vec::with_capacity(panel.loops.len());
        for runs in &panel.loops {
            let first = sheet.edges.len();
            let mut uses = Vec::with_capacity(runs.len());
            for (i, run) in runs.iter().enumerate() {
                let ends = run.edge.domain();
                sheet.vertices.push(Vec3::from(run.edge.point(ends.0)));
                uses.push(EdgeUse { edge: first + i, forward: !reversed, trim: Some(run.trim.clone()) });
                sheet.edges.push(SheetEdge {
                    start: first + i,
                    end: first + (i + 1) % runs.len(),
                    curve: SheetCurve::Spline(run.edge.clone()),
                });
            }
            if reversed {
                uses.reverse();
            }
            loops.push(uses);
        }
        sheet.faces.push(SheetFace {
            name: panel.name.clone(),
            surface: SheetSurface::Spline { surface: panel.patch.clone(), form: panel.kind.into() },
            reversed: panel.mirrored() != reversed,
            loops,
        });
        sheet
    }

    /// The whole of a clamped spline surface, bounded by its four boundary curves.
    pub fn untrimmed(name: &str, surface: &Surface) -> Self {
        let ((u0, u1), (v0, v1)) = surface.domain();
        let (n, row) = (surface.knots_u.control_count(), surface.row());
        let along_u = |j: usize| Curve {
            knots: surface.knots_u.clone(),
            control: (0..n).map(|i| surface.control[i * row + j]).collect(),
        };
        let along_v = |i: usize| Curve {
            knots: surface.knots_v.clone(),
            control: surface.control[i * row..(i + 1) * row].to_vec(),
        };
        let corners = [[u0, v0], [u1, v0], [u1, v1], [u0, v1]];
        // Edges in the direction of their parameter; the loop runs the last two backwards.
        let sides = [
            (0, 1, along_u(0), true),
            (1, 2, along_v(n - 1), true),
            (3, 2, along_u(row - 1), false),
            (0, 3, along_v(0), false),
        ];
        let mut sheet = Self { name: name.into(), ..Self::default() };
        sheet.vertices = corners.iter().map(|c| surface.point(c[0], c[1])).collect();
        let mut uses = Vec::new();
        for (edge, (start, end, curve, forward)) in sides.into_iter().enumerate() {
            let (a, b) = curve.domain();
            let trim = Curve::new(1, vec![a, a, b, b], vec![corners[start], corners[end]]).ok();
            uses.push(EdgeUse { edge, forward, trim });
            sheet.edges.push(SheetEdge { start, end, curve: edge_of(curve, surface.rational) });
        }
        sheet.faces.push(SheetFace {
            name: name.into(),
            surface: SheetSurface::Spline { surface: surface.clone(), form: SurfaceForm::Unspecified },
            reversed: false,
            loops: vec![uses],
        });
        sheet
    }
}

fn edge_of(c: Curve<4>, rational: bool) -> SheetCurve {
    if rational {
        return SheetCurve::Rational(c);
    }
    SheetCurve::Spline(Curve { control: c.control.iter().map(|h| [h[0], h[1], h[2]]).collect(), knots: c.knots })
}

/// Writes the panels of a patchwork, one sheet each, normals on the side of the input faces' normals.
///
/// # Errors
/// Those of `out`.
pub fn panels(out: &mut dyn io::Write, header: &Header, patchwork: &Patchwork) -> io::Result<()> {
    let sheets: Vec<Sheet> = patchwork
        .panels
        .iter()
        .map(|p| Sheet::of_panel(p, patchwork.faces.get(p.face).is_some_and(|f| f.reversed)))
        .collect();
    self::sheets(out, header, &sheets)
}

/// Writes sheets.
///
/// # Errors
/// Those of `out`; an edge or vertex number that is out of range ([`io::ErrorKind::InvalidInput`]).
pub fn sheets(out: &mut dyn io::Write, header: &Header, sheets: &[Sheet]) -> io::Result<()> {
    let mut r = Records::default();
    let product = product(&mut r, &header.name);
    let context = context(&mut r, header.uncertainty);
    let plane = r.push(
        "(GEOMETRIC_REPRESENTATION_CONTEXT(2) PARAMETRIC_REPRESENTATION_CONTEXT() REPRESENTATION_CONTEXT('2D SPACE',''))",
    );
    let mut items = vec![geometry::placement(&mut r, &Frame::world())];
    for s in sheets {
        items.push(shell_model(&mut r, s, plane)?);
    }
    let shape = r.push(&format!(
        "MANIFOLD_SURFACE_SHAPE_REPRESENTATION({},{},#{context})",
        string(&header.name),
        references(items)
    ));
    let definition = r.push(&format!("PRODUCT_DEFINITION_SHAPE('',$,#{product})"));
    r.push(&format!("SHAPE_DEFINITION_REPRESENTATION(#{definition},#{shape})"));
    out.write_all(head(header).as_bytes())?;
    out.write_all(r.text().as_bytes())?;
    out.write_all(b"ENDSEC;\nEND-ISO-10303-21;\n")
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

/// One sheet; answers its SHELL_BASED_SURFACE_MODEL.
fn shell_model(r: &mut Records, s: &Sheet, plane: u64) -> io::Result<u64> {
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
fn with_trims(r: &mut Records, s: &Sheet, surfaces: &[u64], i: usize, space: u64, plane: u64) -> u64 {
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
fn face(r: &mut Records, s: &Sheet, f: &SheetFace, surface: u64, edges: &[u64]) -> io::Result<u64> {
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

fn out_of_range(sheet: &str, what: &str, index: usize) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, format!("sheet {sheet:?} names {what} {index}, which it does not have"))
}
