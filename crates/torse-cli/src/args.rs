//! Arguments and help.

mod back;
mod flat;
mod layout;
mod ruled;
mod shop;

use crate::input::stem;
use crate::quantity::{
    ball, bend_step, direction, entity, positive_count, positive_length, positive_share, positive_time, section, sheet,
    smooth_angle, two_numbers, two_shares, unit_of_length, zone, Length, Section,
};
pub use back::{Info, Map, Refold, To};
use clap::{Args, Parser, Subcommand};
pub use flat::{Shape, Unroll, K};
pub use layout::Layout;
pub use ruled::Ruled;
pub use shop::Shop;
use std::path::{Path, PathBuf};
use std::time::Duration;
use torse::answer::CutFiles;
use torse::develop::bends::BendSpacing;
use torse::develop::view::Drawn;
use torse::geom::unit::LengthUnit;
use torse::geom::Vec3;
use torse::patchwork::pattern::ViewSide;
use torse::pipeline::approximate::SMOOTH_ANGLE_DEG;
use torse::pipeline::select::{Selection, Skin};
use torse::torse::zone::Zone;

/// Builds curved shapes from flat sheet.
///
/// Covers CAD surfaces with panels that bend from flat material without stretching, lays such panels between curves or
/// near measured points, proves how far they are from what was asked for, and writes flat patterns for the cutter and
/// models for CAD.
#[derive(Parser, Debug)]
#[command(name = "torse", version, about, arg_required_else_help = true)]
#[command(after_help = "Examples:
  torse approximate hull.step --tolerance 2mm --out hull-panels
  torse fit scan.ply --tolerance 0.5mm --out sheet
  torse info hull.step

Exit status: 0 certified, 2 bad input or usage, 3 finished but not certified, 130 stopped at once (Ctrl-C twice).")]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Subcommand, Debug)]
pub enum Command {
    /// Cover every face of a CAD model with developable panels and write cut-ready files
    Approximate(Approximate),
    /// Turn ruled developable faces of a CAD model into exact cones, cylinders and planes with flat patterns
    Cones(Cones),
    /// Fit developable strips to measured points, rulings, tangent planes or faces and write cut-ready files
    Fit(Fit),
    /// Lay a developable surface between two curves and write cut-ready files
    Loft(Loft),
    /// Lay a developable surface through one curve, from its first and last ruling, and write cut-ready files
    Net(Net),
    /// Wrap curves in the developables of their convex hull and write cut-ready files
    Hull(Hull),
    /// Make the quadrilaterals of a strip plane, refine them, and write cut-ready files
    Planarise(Planarise),
    /// Cover the saddle-shaped faces of a CAD model with ruled strips: formwork, hot wire, straight beams
    Ruled(Ruled),
    /// Pull strips between curves by handles while they stay developable, and write cut-ready files
    Shape(Shape),
    /// Lay bodies of sheet and developable faces of a CAD model flat, with bend allowance and bend table
    Unroll(Unroll),
    /// Bend the flat parts of a result back and measure how far they are from where they belong
    Refold(Refold),
    /// Carry points and curves between the parts of a result and their flat patterns
    Map(Map),
    /// Tell what a CAD file holds: unit, faces, sizes, curvature, what was not read
    Info(Info),
}

/// Arguments of `approximate`.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  torse approximate hull.step --tolerance 2mm --out hull-panels
  torse approximate roof.step --tolerance 1/8in --out roof --max-panels 40
  torse approximate hull.step -t 2mm -o plates --sheet 2mx6m --min-bend-radius 150mm
  torse approximate wing.step -t 0.5mm -o wing --force --time-limit 5min

Written into the output folder: panels.step (CAD), patterns.dxf and patterns.svg (cutter), parts.csv (sizes, quantities),
bends.csv (bend lines) and further tables of the shop, model.glb, pictures, report.html (open it in a browser) and report.json.

Ctrl-C stops the search and writes what was found, marked as not certified; a second Ctrl-C stops at once
and writes nothing.

A result that leaves out any face of the file is not certified.

Exit status: 0 certified, 2 bad input or usage, 3 finished but not certified (files written and marked).")]
pub struct Approximate {
    /// STEP (AP203, AP214, AP242), IGES or Rhino file (3DM)
    #[arg(value_name = "FILE")]
    pub file: PathBuf,

    /// Largest deviation allowed between surface and panels, with its unit: 2mm, 0.1cm, 1/16in. If not given,
    /// the least one of --sweep
    #[arg(
        short,
        long,
        value_name = "LENGTH",
        value_parser = positive_length,
        allow_hyphen_values = true,
        required_unless_present = "sweep"
    )]
    pub tolerance: Option<Length>,

    #[command(flatten)]
    pub files: Files,

    /// Refuse the whole file if any of its faces cannot be used
    #[arg(long)]
    pub strict: bool,

    /// Stop at this number of panels; the result may then be uncertified
    #[arg(long, value_name = "N", value_parser = positive_count, allow_hyphen_values = true)]
    pub max_panels: Option<u32>,

    #[command(flatten)]
    pub chosen: Chosen,

    /// Sheet that every flat pattern must fit on: the smallest rectangle around it, such as 1250x2550 (mm), 1.25mx2.55m,
    /// 4ftx8ft
    #[arg(long, value_name = "SIZE", value_parser = sheet, allow_hyphen_values = true)]
    pub sheet: Option<[f64; 2]>,

    /// Greatest width of a strip square to its middle line, with its unit; strips that are curved in the plane need a
    /// wider sheet (--sheet)
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub max_width: Option<Length>,

    /// Least mean width of a flat pattern (area over length), with its unit [default: panels narrower than a tenth of
    /// their widest neighbour are avoided where that can be proven]
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub min_width: Option<Length>,

    /// Greatest length of a flat pattern (of the smallest rectangle around it), with its unit
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub max_length: Option<Length>,

    /// Smallest radius to which the material bends, with its unit
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub min_bend_radius: Option<Length>,

    /// Smallest distance along the rulings (the lines about which the sheet bends) between a panel and its regression
    /// curve, where they meet and the sheet would crease; with its unit
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub min_clearance: Option<Length>,

    /// How panels are laid
    #[arg(long, value_name = "HOW", value_enum, default_value_t = Layout::Auto)]
    pub layout: Layout,

    /// Direction that strips run along: x, y, z or three numbers, such as 1,0,0.5
    #[arg(long, value_name = "DIRECTION", value_parser = direction, allow_hyphen_values = true, conflicts_with = "guide")]
    pub direction: Option<Vec3>,

    /// Curve whose tangents strips run along: an edge or curve of a CAD file (FILE#NUMBER), a DXF curve, or a table of
    /// points
    #[arg(long, value_name = "CURVE")]
    pub guide: Option<String>,

    /// Unit of a guide or curve that does not say its own: mm, cm, m, in, ft
    #[arg(long, value_name = "UNIT", value_parser = unit_of_length)]
    pub unit: Option<f64>,

    /// Plane in which a seam must run, such as x=1200mm; may be given several times
    #[arg(long, value_name = "AXIS=LENGTH", value_parser = section, allow_hyphen_values = true)]
    pub seam_at: Vec<Section>,

    /// Curve along which a seam must run, as for --curves; may be given several times. Where it ends on a face the seam goes on
    /// straight to the border
    #[arg(long, value_name = "CURVE", allow_hyphen_values = true)]
    pub seam_along: Vec<String>,

    /// Curve that a panel must run along; may be given several times. A section such as x=1200mm, a parameter curve
    /// such as u=0.5 or v=0.25 (share of the range), an edge or curve of a CAD file (FILE#NUMBER), all curves of a DXF
    /// file, or a table of points, which are projected onto the surface. Further panels follow from the borders of these
    #[arg(long, value_name = "CURVE", allow_hyphen_values = true, conflicts_with_all = ["direction", "guide"])]
    pub curves: Vec<String>,

    /// Stop after this time, with its unit: 60s, 5min; the result may then be uncertified
    #[arg(long, value_name = "TIME", value_parser = positive_time, allow_hyphen_values = true)]
    pub time_limit: Option<Duration>,

    /// Write the panels once more as chains of exact cones, cylinders and planes: cones.step and files that begin with
    /// cones-. The panels keep to 0.6 of the tolerance then, so that the cones are within all of it
    #[arg(long)]
    pub cones: bool,

    /// Also run the job at these tolerances and draw panels and seam length over them: 1mm,2mm,5mm
    #[arg(long, value_name = "LENGTH,...", value_delimiter = ',', value_parser = positive_length)]
    pub sweep: Vec<Length>,

    /// Whether neighbouring strips meet in common edges where that can be certified, or are laid one by one, in half the time
    #[arg(long, value_name = "HOW", value_enum, default_value_t = Seams::Meet)]
    pub seams: Seams,

    /// Cover faces as one where they meet at no more than this angle, in degrees; 0 covers each face for itself
    #[arg(long, value_name = "DEGREES", default_value_t = SMOOTH_ANGLE_DEG, value_parser = smooth_angle, allow_hyphen_values = true)]
    pub smooth_angle: f64,

    #[command(flatten)]
    pub drawing: Drawing,
}

/// Which faces of a model are meant.
#[derive(Args, Clone, Debug)]
pub struct Chosen {
    /// Only this face, by its number in the file (see 'torse info'); may be given several times
    #[arg(long, value_name = "#NUMBER", value_parser = entity)]
    pub face: Vec<u64>,

    /// Only this part, by its name in the file; may be given several times
    #[arg(long, value_name = "NAME")]
    pub part: Vec<String>,

    /// Of sheets of constant thickness that are drawn as bodies, only the outer skin
    #[arg(long, conflicts_with = "inner")]
    pub outer: bool,

    /// Of sheets of constant thickness that are drawn as bodies, only the inner skin
    #[arg(long)]
    pub inner: bool,
}

impl Chosen {
    /// The same in the library's words.
    pub fn selection(&self) -> Selection {
        let skin = match (self.outer, self.inner) {
            (true, _) => Some(Skin::Outer),
            (_, true) => Some(Skin::Inner),
            _ => None,
        };
        Selection { faces: self.face.clone(), parts: self.part.clone(), skin }
    }
}

/// Where results go, and what is told on the way.
#[derive(Args, Clone, Debug)]
pub struct Files {
    /// Folder to create for the results
    #[arg(short, long, value_name = "DIR")]
    pub out: PathBuf,

    /// Replace the files of an earlier result in that folder; everything else in it is kept
    #[arg(long)]
    pub force: bool,

    /// Also write a DXF drawing of every part alone: part-A-01.dxf
    #[arg(long)]
    pub one_file_per_part: bool,

    /// Also write the panels in these formats, as copies of panels.step or cones.step: iges, 3dm
    #[arg(long, value_name = "FORMAT,...", value_delimiter = ',', value_enum)]
    pub also: Vec<Also>,

    /// Unit of drawings and tables of parts; reports and models are in mm
    #[arg(long, value_name = "UNIT", value_enum, default_value_t = DrawnUnit::Mm)]
    pub drawing_unit: DrawnUnit,

    /// Name of the job in the files [default: name of the first input]
    #[arg(long, value_name = "NAME")]
    pub name: Option<String>,

    /// Print nothing but errors
    #[arg(short, long)]
    pub quiet: bool,

    #[command(flatten)]
    pub shop: Shop,
}

/// Formats of copies of the panels.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Also {
    /// IGES 5.3, trimmed surfaces
    Iges,
    /// Rhino archive of version 6
    #[value(name = "3dm")]
    ThreeDm,
}

/// Unit of drawings.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrawnUnit {
    /// Millimetres
    Mm,
    /// Inches
    In,
}

impl Files {
    /// How drawings are written, in the library's words.
    pub fn cut(&self) -> CutFiles {
        let unit = match self.drawing_unit {
            DrawnUnit::Mm => LengthUnit::Millimetre,
            DrawnUnit::In => LengthUnit::Inch,
        };
        let also = |format: Also| self.also.contains(&format);
        let (iges, threedm) = (also(Also::Iges), also(Also::ThreeDm));
        CutFiles { unit, one_per_part: self.one_file_per_part, iges, threedm }
    }

    /// Name of the job: what was asked for, else the name of the input.
    pub fn job_name(&self, input: &Path) -> String {
        self.name.clone().unwrap_or_else(|| stem(input))
    }
}

/// How flat patterns are drawn.
#[derive(Args, Clone, Copy, Debug)]
pub struct Drawing {
    /// Side of the model from which patterns are seen: bend lines on BEND_UP bend towards you then
    #[arg(long, value_name = "SIDE", value_enum, default_value_t = View::Outside)]
    pub view: View,

    /// Turn of the sheet from one bend line to the next, in degrees: 5deg
    #[arg(long, value_name = "ANGLE", default_value = "5deg", value_parser = bend_step, allow_hyphen_values = true)]
    #[arg(conflicts_with = "facets")]
    pub bend_step: f64,
}

impl Drawing {
    /// The same in the library's words.
    pub fn drawn(&self, shop: &Shop) -> Drawn {
        let view = match self.view {
            View::Outside => ViewSide::Outside,
            View::Inside => ViewSide::Inside,
        };
        let step = self.bend_step.to_radians();
        Drawn { view, bends: BendSpacing { step, facets: shop.facets, ..BendSpacing::default() } }
    }
}

/// Side of the model.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// From outside: away from the volume of a closed body, from the middle of an open one
    Outside,
    /// From inside
    Inside,
}

/// How neighbouring strips are joined.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seams {
    /// In common edges, as far as the certificate allows
    Meet,
    /// Not at all: each strip is the best for itself; gaps are bounded, reported, and can be wider than the tolerance
    Independent,
}

/// Arguments of `cones`.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  torse cones chute.step --tolerance 0.5mm --out chute-cones
  torse cones chute.step -t 0.5mm -o chute-cones --force --bending --thickness 2mm

Every face that is ruled and developable becomes a smooth chain of pieces of right circular cones, cylinders and
planes, proven to lie within the tolerance both ways, with the holes and edges of the face. Faces that are not ruled
developables are left out and named, and the result is then not certified; 'torse approximate' handles those.

Written into the output folder: cones.step (exact conical, cylindrical and plane faces), patterns.dxf and
patterns.svg (true arcs), model.glb, pictures, report.html and report.json; with --thickness also inner, neutral and outer
surfaces: thickness.step, thickness.glb.

Exit status: 0 certified, 2 bad input or usage, 3 finished but not certified (files written and marked).")]
pub struct Cones {
    /// STEP (AP203, AP214, AP242), IGES or Rhino file (3DM)
    #[arg(value_name = "FILE")]
    pub file: PathBuf,

    /// Largest distance allowed between surface and cones, with its unit: 2mm, 0.1cm, 1/16in
    #[arg(short, long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub tolerance: Length,

    #[command(flatten)]
    pub drawing: Drawing,

    #[command(flatten)]
    pub files: Files,

    #[command(flatten)]
    pub chosen: Chosen,

    /// Refuse the whole file if any of its faces cannot be used
    #[arg(long)]
    pub strict: bool,

    /// Also show how the parts bend into the plane: bending.glb (animation) and bending.png
    #[arg(long)]
    pub bending: bool,
}

/// Arguments of `fit`.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  torse fit scan.ply --tolerance 0.5mm --out sheet
  torse fit points.csv --unit m --tolerance 1/32in --out sheet
  torse fit rulings.csv --tolerance 0.1mm --out hood
  torse fit rulings.dxf --tolerance 0.1mm --out hood
  torse fit planes.csv --region 0,0,0,500 --tolerance 0.2mm --out shell
  torse fit face.step --tolerance 0.01mm --out lighter
  torse fit rulings.csv -t 0.5mm -o hood --robust --fix-ends
  torse fit planes.csv -t 0.2mm -o shell --min-clearance 20mm --clear-zone x=0mm..1200mm

Points need no normals and no order. Normals are estimated, the points are split into pieces that a developable
strip can follow, and every point is proven to lie within the tolerance, or counted.

Tables of points have columns x, y, z: in any order among others if the first line names them, else just these three.
Semicolons, tabs, commas or blanks separate; decimal commas need semicolons or tabs. Triangles of coarse STL and OBJ
meshes guide the strips; what is held to the tolerance are their corners.

A table whose first line names its columns may hold rulings (px,py,pz,qx,qy,qz, and nx,ny,nz if their tangent planes
are known) or tangent planes a x + b y + c z = d (a,b,c,d, and x,y,z,r for the region of interest of each: a disc
around x,y,z with radius r). Planes must be in order along the surface; a column t, if there is
one, must increase, and a column w gives weights in the fit (the proof does not know them). The lines of a DXF
drawing are rulings, in any order. Ruled developable faces of a STEP file are fitted anew, or stay as they are
where nothing simpler is found; the report tells degrees and control points before and after. Strips have as few
control points as were found within the tolerance, and end where rulings or faces end. Rulings and planes, those
of faces too, are proven one by one; of faces the distance from strips all over is proven and told besides. Those that --robust leaves out are named with their distances, and nothing is proven of them.

With --min-clearance or --clear-zone the surface nearest to the data is sought whose regression curve (where rulings
meet and the sheet would crease) keeps its distance from the strip and stays out of the zones; this is proven for
every ruling. Where the tolerance leaves no such surface, the report says how near one comes.

Written into the output folder: panels.step (CAD), patterns.dxf and patterns.svg (cutter), model.glb, pictures,
report.html (open it in a browser), report.json and, for points, deviation.ply (every point with its deviation) and
points.png (a map of them).

Exit status: 0 certified, 2 bad input or usage, 3 finished but not certified (files written and marked).")]
pub struct Fit {
    /// Measured points (.ply, .csv, .xyz, .txt, .obj, .stl, meshes of .3dm), rulings (.csv, .dxf), planes (.csv) or faces
    /// (STEP, IGES, 3DM)
    #[arg(value_name = "FILE")]
    pub file: PathBuf,

    /// Largest distance allowed between what is given and the strips, with its unit: 0.5mm, 1/32in
    #[arg(short, long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub tolerance: Length,

    #[command(flatten)]
    pub files: Files,

    /// Unit of the numbers in files that do not tell theirs: mm, cm, m, in, ft. Drawings may tell it, and headings of
    /// tables, such as x [m] [default: mm]
    #[arg(long, value_name = "UNIT", value_parser = unit_of_length)]
    pub unit: Option<f64>,

    /// Region of interest of planes that come without: centre and radius, in the unit of the file
    #[arg(long, value_name = "X,Y,Z,R", value_parser = ball, allow_hyphen_values = true)]
    pub region: Option<[f64; 4]>,

    /// Smallest distance along the rulings (the lines about which the sheet bends) between a strip and its regression
    /// curve, where they meet and the sheet would crease; with its unit
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub min_clearance: Option<Length>,

    /// Zone that regression curves must keep out of, by ranges of coordinates: x=0mm..1200mm (a slab),
    /// x=0mm..1m,y=-5cm..5cm,z=0mm..1m (a box); may be given several times
    #[arg(long, value_name = "ZONE", value_parser = zone, allow_hyphen_values = true)]
    pub clear_zone: Vec<Zone>,

    /// Keep the first and the last ruling or plane of each strip exactly (rulings with their planes)
    #[arg(long)]
    pub fix_ends: bool,

    /// Weight of bending against the data, as a share such as 1e-6: the larger, the smoother and the farther away
    #[arg(long, value_name = "WEIGHT", value_parser = positive_share, allow_hyphen_values = true)]
    pub smooth: Option<f64>,

    /// Refuse the whole file if any of its faces, rulings or planes cannot be used
    #[arg(long)]
    pub strict: bool,

    /// Leave out and name rulings or planes that lie far from a surface on which the others agree
    #[arg(long)]
    pub robust: bool,

    /// Stop at this number of strips; the result may then be uncertified
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub max_strips: Option<u32>,

    /// Stop after this time, with its unit: 60s, 5min; the result may then be uncertified
    #[arg(long, value_name = "TIME", value_parser = positive_time, allow_hyphen_values = true)]
    pub time_limit: Option<Duration>,

    #[command(flatten)]
    pub drawing: Drawing,
}

/// Arguments of `loft`.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  torse loft chine.csv sheer.csv --unit m --tolerance 0.5mm --rulings 250mm --out plate
  torse loft duct.step#12 duct.step#57 --tolerance 0.01mm --out duct
  torse loft a.dxf b.dxf -t 0.1mm -o strip --ends extend

A rail is a STEP or IGES file (FILE#NUMBER names an edge or curve), a Rhino file (FILE#NUMBER or FILE#NAME), a DXF file
(FILE#LAYER or FILE#HANDLE), or a table of points with columns x, y, z. Written into the output folder: panels.step,
patterns.dxf, patterns.svg, model.glb, pictures, report.html and report.json.

Exit status: 0 developable within the tolerance, 2 bad input or usage, 3 finished but not developable within the
tolerance (files written and marked).")]
pub struct Loft {
    /// First rail: an edge or curve of a CAD file (FILE#NUMBER), a DXF curve, or a table of points
    #[arg(value_name = "RAIL_A")]
    pub a: String,

    /// Second rail: an edge or curve of a CAD file (FILE#NUMBER), a DXF curve, or a table of points
    #[arg(value_name = "RAIL_B")]
    pub b: String,

    /// Largest distance allowed between strips and rails, with its unit: 0.1mm
    #[arg(short, long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub tolerance: Length,

    #[command(flatten)]
    pub files: Files,

    /// Unit of tables and of drawings that do not say theirs: mm, cm, m, in, ft
    #[arg(long, value_name = "UNIT", value_parser = unit_of_length)]
    pub unit: Option<f64>,

    /// Take points of tables as corners of a polyline instead of points of a smooth curve
    #[arg(long)]
    pub polyline: bool,

    /// What becomes of rails that the surface does not use up
    #[arg(long, value_enum, default_value_t = LoftEnds::Fan)]
    pub ends: LoftEnds,

    /// How rails are extended
    #[arg(long, value_enum, default_value_t = LoftExtension::Curve)]
    pub extension: LoftExtension,

    /// Stop looking for better strips after this time, with its unit: 60s, 5min
    #[arg(long, value_name = "TIME", value_parser = positive_time, allow_hyphen_values = true)]
    pub time_limit: Option<Duration>,

    /// Demand tangent planes common to both rails; refuse if there are none
    #[arg(long, conflicts_with = "least_twist")]
    pub exact: bool,

    /// Make the strip of least twist from end to end, developable or not
    #[arg(long)]
    pub least_twist: bool,

    /// Take another of the solutions listed in the report, counted from 1
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub alternative: u32,

    /// A ruling to be used, as shares of both rails' lengths: 0.25,0.3 (may be repeated, in order)
    #[arg(long = "ruling", value_name = "A,B", value_parser = two_shares)]
    pub fixed: Vec<[f64; 2]>,

    /// Distance between drawn rulings, with its unit [default: as --bend-step says]
    #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
    pub rulings: Option<Length>,

    /// Distance between marks on the rails, with its unit [default: 8 over the length]
    #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
    pub marks: Option<Length>,

    #[command(flatten)]
    pub drawing: Drawing,
}

/// What becomes of rails that are not used up.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoftEnds {
    /// They are trimmed
    Trim,
    /// All of both rails is used: cones about the ends of the other rail
    #[value(alias = "all")]
    Fan,
    /// Rails are extended until both are used up
    Extend,
}

/// How rails go on beyond their ends.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoftExtension {
    /// With the curvature of the end
    Curve,
    /// Straight
    Line,
}

/// Arguments of `net`.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  torse net keel.csv --unit mm --start-ruling 0,1,0.3 --width 400mm --end-ruling 0.2,1,0 -t 0.05mm -o plate
  torse net edge.step#12 --start-ruling y --width 80mm --stars 1.4,1.3 -t 0.01mm -o strip
  torse net net.json --tolerance 0.01mm --out strip

The curve is a STEP or IGES file (FILE#NUMBER names an edge or curve), a Rhino file (FILE#NUMBER or FILE#NAME), a DXF
file (FILE#LAYER or FILE#HANDLE), a table of points x, y, z, or a control net (JSON: unit, degree, knots, points,
first_ruling, last_ruling). It must be smooth. The strip is exactly developable. All solutions are listed in the
report; the one whose regression curve keeps farthest from the curve is taken. Written into the output folder:
panels.step, patterns.dxf, patterns.svg, model.glb, pictures, report.html and report.json.

Exit status: 0 developable within the tolerance, 2 bad input or usage, 3 no regular surface holds the rulings, or not
certified (files written and marked).")]
pub struct Net {
    /// Curve (an edge or curve of a CAD file, FILE#NUMBER; a DXF curve; a table of points), or control net (JSON)
    #[arg(value_name = "CURVE")]
    pub curve: String,

    /// Largest distance allowed between strip and curve, with its unit: 0.1mm
    #[arg(short, long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub tolerance: Length,

    #[command(flatten)]
    pub files: Files,

    /// Direction of the first ruling, away from the curve: x, -y, z or three numbers such as 0,1,0.3
    #[arg(long, value_name = "DIRECTION", value_parser = direction, allow_hyphen_values = true)]
    pub start_ruling: Option<Vec3>,

    /// Length of the first ruling, with its unit
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub width: Option<Length>,

    /// Direction of the last ruling, on the same side of the curve
    #[arg(long, value_name = "DIRECTION", value_parser = direction, allow_hyphen_values = true)]
    pub end_ruling: Option<Vec3>,

    /// Length of the last ruling, with its unit [default: what the surface gives]
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub end_width: Option<Length>,

    /// The free parameters M* and Λ* instead of a last ruling; the curve's parameter runs from 0 to 1
    #[arg(long, value_name = "M*,L*", value_parser = two_numbers, allow_hyphen_values = true, conflicts_with_all = ["end_ruling", "end_width"])]
    pub stars: Option<[f64; 2]>,

    /// The same as m = 1/(M* - 1/2) and kappa = (L* - M*) m: 0,KAPPA are cones, M,0 cylinders
    #[arg(long, value_name = "M,KAPPA", value_parser = two_numbers, allow_hyphen_values = true, conflicts_with_all = ["end_ruling", "end_width", "stars"])]
    pub shape: Option<[f64; 2]>,

    /// Stretch of the curve's parameter that is used; beyond 0 and 1 the surface is continued
    #[arg(long, value_name = "FROM,TO", default_value = "0,1", value_parser = two_numbers, allow_hyphen_values = true)]
    pub along: [f64; 2],

    /// Take another of the regular solutions listed in the report, counted from 1
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub alternative: u32,

    /// Accept only a single polynomial net as wide as asked for: no rational one, no split, no narrower strip
    #[arg(long)]
    pub polynomial: bool,

    /// Unit of tables and of drawings that do not say theirs: mm, cm, m, in, ft
    #[arg(long, value_name = "UNIT", value_parser = unit_of_length)]
    pub unit: Option<f64>,

    /// Distance between drawn rulings, with its unit [default: as --bend-step says]
    #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
    pub rulings: Option<Length>,

    /// Distance between marks on the curve, with its unit [default: 8 over the length]
    #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
    pub marks: Option<Length>,

    #[command(flatten)]
    pub drawing: Drawing,
}

/// Arguments of `hull`.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  torse hull inlet.dxf outlet.dxf --tolerance 0.1mm --out hopper
  torse hull loop.csv --unit mm --tolerance 0.1mm --out cushion

A curve is a STEP or IGES file (FILE#NUMBER names an edge or curve), a Rhino file (all its curves, or FILE#NUMBER or
FILE#NAME), a DXF file (all its curves, or FILE#LAYER or FILE#HANDLE), or a table of points with columns x, y, z. The
boundary of the convex hull of all curves consists of planar triangles and developable strips; planar pieces within a
single planar curve, such as the mouths of a duct, are left open. Curves inside the hull of the others are not
touched.

Written into the output folder: panels.step, patterns.dxf, patterns.svg, model.glb, pictures, report.html and
report.json.

Exit status: 0 developable within the tolerance, 2 bad input or usage, 3 finished but not developable within the
tolerance (files written and marked).")]
pub struct Hull {
    /// Curves: edges or curves of CAD files (FILE#NUMBER), DXF drawings, or tables of points
    #[arg(value_name = "CURVE", required = true)]
    pub curves: Vec<String>,

    /// Largest distance allowed between strips and curves, with its unit: 0.1mm
    #[arg(short, long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub tolerance: Length,

    #[command(flatten)]
    pub files: Files,

    /// Unit of tables and of drawings that do not say theirs: mm, cm, m, in, ft
    #[arg(long, value_name = "UNIT", value_parser = unit_of_length)]
    pub unit: Option<f64>,

    /// Take points of tables as corners of a polyline instead of points of a smooth curve
    #[arg(long)]
    pub polyline: bool,

    /// Distance between drawn rulings, with its unit [default: as --bend-step says]
    #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
    pub rulings: Option<Length>,

    /// Distance between marks on the curves, with its unit [default: 8 over the length]
    #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
    pub marks: Option<Length>,

    /// Stop after this time, with its unit: 60s, 5min; what was found until then is kept and marked
    #[arg(long, value_name = "TIME", value_parser = positive_time, allow_hyphen_values = true)]
    pub time_limit: Option<Duration>,

    #[command(flatten)]
    pub drawing: Drawing,
}

/// Arguments of `planarise`.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  torse planarise strip.csv --tolerance 0.01mm --out strip
  torse planarise strip.obj --unit m --levels 3 --hold first --tolerance 0.01mm --out strip

A strip is a table with one ruling on each line (six numbers: both ends), a table of two polylines (three numbers on
each line, an empty line between them), or an OBJ file of quadrilaterals that form one open strip. Points are moved as
little and as smoothly as makes every quadrilateral plane; each level of subdivision doubles their number.

Written into the output folder: panels.step, patterns.dxf, patterns.svg, model.glb, pictures, report.html
and report.json.

Exit status: 0 plane within the tolerance, 2 bad input or usage, 3 finished but not plane within the tolerance (files
written and marked).")]
pub struct Planarise {
    /// Strip of quadrilaterals: .csv, .txt, .obj or .3dm (a mesh)
    #[arg(value_name = "STRIP")]
    pub file: PathBuf,

    /// Largest distance allowed between the diagonals of a quadrilateral, with its unit: 0.01mm
    #[arg(short, long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub tolerance: Length,

    #[command(flatten)]
    pub files: Files,

    /// Unit of the numbers in the file: mm, cm, m, in, ft [default: what headings such as ax [m] tell, else mm]
    #[arg(long, value_name = "UNIT", value_parser = unit_of_length)]
    pub unit: Option<f64>,

    /// Levels of subdivision
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub levels: u32,

    /// Points that keep their places
    #[arg(long, value_enum, default_value_t = HeldPoints::Nothing)]
    pub hold: HeldPoints,

    /// Greatest displacement of a given point, with its unit; more is not certified
    #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
    pub max_move: Option<Length>,

    #[command(flatten)]
    pub drawing: Drawing,
}

/// Points of a strip that keep their places.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeldPoints {
    /// None
    Nothing,
    /// Those of the first polyline
    First,
    /// Those of the second polyline
    Second,
    /// The first and the last ruling
    Ends,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_definition_is_sound() {
        Arguments::command().debug_assert();
    }
}
