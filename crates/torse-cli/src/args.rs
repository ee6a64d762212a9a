//! Arguments and help.

use crate::quantity::{positive_count, positive_length, positive_time, two_shares, unit_of_length, Length};
use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;
use std::time::Duration;

/// Developable panels from freeform CAD surfaces, with a proof of the deviation.
#[derive(Parser, Debug)]
#[command(name = "torse", version, about, arg_required_else_help = true)]
#[command(after_help = "Examples:
  torse approximate hull.step --tolerance 2mm --out hull-panels
  torse fit scan.ply --tolerance 0.5mm --out sheet
  torse info hull.step

Exit status: 0 certified, 2 bad input or usage, 3 finished but not certified.")]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Subcommand, Debug)]
pub enum Command {
    /// Cover every face of a STEP model with developable panels and write cut-ready files
    Approximate(Approximate),
    /// Turn ruled developable faces of a STEP model into exact cones, cylinders and planes with flat patterns
    Cones(Cones),
    /// Fit developable strips to measured points (PLY, CSV, OBJ, STL) and write cut-ready files
    Fit(Fit),
    /// Lay a developable surface between two curves and write cut-ready files
    Loft(Loft),
    /// Tell what a STEP file holds: unit, faces, sizes, curvature, what was not read
    Info(Info),
}

/// Arguments of `approximate`.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  torse approximate hull.step --tolerance 2mm --out hull-panels
  torse approximate roof.step --tolerance 1/8in --out roof --max-panels 40
  torse approximate hull.step -t 2mm -o plates --max-width 2m --max-length 6m --min-bend-radius 150mm
  torse approximate wing.step -t 0.5mm -o wing --force --time-limit 5min

Written into the output folder: panels.step (CAD), patterns.dxf and patterns.svg (cutter), model.glb,
pictures, report.html (open it in a browser) and report.json.

Ctrl-C stops the search and writes what was found, marked as not certified; a second Ctrl-C stops at once
and writes nothing.

Exit status: 0 certified, 2 bad input or usage, 3 finished but not certified (files written and marked).")]
pub struct Approximate {
    /// STEP file (AP203, AP214 or AP242)
    #[arg(value_name = "FILE")]
    pub file: PathBuf,

    /// Largest deviation allowed between surface and panels, with its unit: 2mm, 0.1cm, 1/16in
    #[arg(short, long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub tolerance: Length,

    /// Folder to create for the results
    #[arg(short, long, value_name = "DIR")]
    pub out: PathBuf,

    /// Replace the results of an earlier run in that folder
    #[arg(long)]
    pub force: bool,

    /// Refuse the whole file if any of its faces cannot be used
    #[arg(long)]
    pub strict: bool,

    /// Stop at this number of panels; the result may then be uncertified
    #[arg(long, value_name = "N", value_parser = positive_count, allow_hyphen_values = true)]
    pub max_panels: Option<u32>,

    /// Greatest width of a flat pattern (sheet or coil), with its unit
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub max_width: Option<Length>,

    /// Greatest length of a flat pattern, with its unit
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub max_length: Option<Length>,

    /// Smallest radius to which the material bends, with its unit
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub min_bend_radius: Option<Length>,

    /// Smallest distance along the rulings between a panel and its regression curve, with its unit
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub min_clearance: Option<Length>,

    /// Stop after this time, with its unit: 60s, 5min; the result may then be uncertified
    #[arg(long, value_name = "TIME", value_parser = positive_time, allow_hyphen_values = true)]
    pub time_limit: Option<Duration>,

    /// Write the panels once more as chains of exact cones, cylinders and planes, within the tolerance of the panels:
    /// cones.step and files that begin with cones-
    #[arg(long)]
    pub cones: bool,

    /// Also run the job at these tolerances and draw panels and seam length over them: 1mm,2mm,5mm
    #[arg(long, value_name = "LENGTH,...", value_delimiter = ',', value_parser = positive_length)]
    pub sweep: Vec<Length>,

    /// Whether neighbouring strips meet in common edges where that can be certified, or are laid one by one
    #[arg(long, value_name = "HOW", value_enum, default_value_t = Seams::Independent)]
    pub seams: Seams,

    /// Name of the job in the files [default: name of FILE]
    #[arg(long, value_name = "NAME")]
    pub name: Option<String>,

    /// Print nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
}

/// How neighbouring strips are joined.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seams {
    /// In common edges, as far as the certificate allows
    Meet,
    /// Not at all: each strip is the best for itself, gaps stay within the tolerance
    Independent,
}

/// Arguments of `cones`.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  torse cones chute.step --tolerance 0.5mm --out chute-cones

Every face that is ruled and developable becomes a smooth chain of pieces of right circular cones, cylinders and
planes, proven to lie within the tolerance both ways. A face is taken between the least and the greatest
parameters of its boundary. Faces that are not ruled developables are left out and named; 'torse approximate'
handles those.

Written into the output folder: cones.step (exact conical, cylindrical and plane faces), patterns.dxf and
patterns.svg (true arcs), model.glb, pictures, report.html and report.json.

Exit status: 0 certified, 2 bad input or usage, 3 finished but not certified (files written and marked).")]
pub struct Cones {
    /// STEP file (AP203, AP214 or AP242)
    #[arg(value_name = "FILE")]
    pub file: PathBuf,

    /// Largest distance allowed between surface and cones, with its unit: 2mm, 0.1cm, 1/16in
    #[arg(short, long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub tolerance: Length,

    /// Folder to create for the results
    #[arg(short, long, value_name = "DIR")]
    pub out: PathBuf,

    /// Replace the results of an earlier run in that folder
    #[arg(long)]
    pub force: bool,

    /// Name of the job in the files [default: name of FILE]
    #[arg(long, value_name = "NAME")]
    pub name: Option<String>,

    /// Print nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
}

/// Arguments of `fit`.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  torse fit scan.ply --tolerance 0.5mm --out sheet
  torse fit points.csv --unit m --tolerance 1/32in --out sheet

Points need no normals and no order. Normals are estimated, the points are split into pieces that a developable
strip can follow, and every point is proven to lie within the tolerance, or counted.

Written into the output folder: strips.step (CAD), patterns.dxf and patterns.svg (cutter), model.glb, pictures,
deviation.ply (every point with its deviation), report.html (open it in a browser) and report.json.

Exit status: 0 certified, 2 bad input or usage, 3 finished but not certified (files written and marked).")]
pub struct Fit {
    /// Measured points: .ply, .csv, .xyz, .txt, .obj or .stl
    #[arg(value_name = "FILE")]
    pub file: PathBuf,

    /// Largest distance allowed between a point and the strips, with its unit: 0.5mm, 1/32in
    #[arg(short, long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub tolerance: Length,

    /// Folder to create for the results
    #[arg(short, long, value_name = "DIR")]
    pub out: PathBuf,

    /// Unit of the numbers in the file: point files do not tell it
    #[arg(long, value_name = "UNIT", default_value = "mm", value_parser = ["mm", "cm", "m", "in", "ft"])]
    pub unit: String,

    /// Replace the results of an earlier run in that folder
    #[arg(long)]
    pub force: bool,

    /// Stop at this number of strips; the result may then be uncertified
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub max_strips: Option<u32>,

    /// Stop after this time, with its unit: 60s, 5min; the result may then be uncertified
    #[arg(long, value_name = "TIME", value_parser = positive_time, allow_hyphen_values = true)]
    pub time_limit: Option<Duration>,

    /// Name of the job in the files [default: name of FILE]
    #[arg(long, value_name = "NAME")]
    pub name: Option<String>,

    /// Print nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
}

/// Arguments of `loft`.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  torse loft chine.csv sheer.csv --unit m --tolerance 0.5mm --rulings 250mm --out plate
  torse loft duct.step#12 duct.step#57 --tolerance 0.01mm --out duct
  torse loft a.dxf b.dxf -t 0.1mm -o strip --ends extend

A rail is a STEP file (FILE#NUMBER names an edge), a DXF file (FILE#LAYER or FILE#HANDLE), or a table of points
x, y, z. Written into the output folder: strips.step, patterns.dxf, patterns.svg, model.glb, pictures, report.html
and report.json.

Exit status: 0 developable within the tolerance, 2 bad input or usage, 3 finished but not developable within the
tolerance (files written and marked).")]
pub struct Loft {
    /// First rail
    #[arg(value_name = "RAIL_A")]
    pub a: String,

    /// Second rail
    #[arg(value_name = "RAIL_B")]
    pub b: String,

    /// Largest distance allowed between strips and rails, with its unit: 0.1mm
    #[arg(short, long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub tolerance: Length,

    /// Folder to create for the results
    #[arg(short, long, value_name = "DIR")]
    pub out: PathBuf,

    /// Unit of tables and of drawings that do not say theirs: mm, cm, m, in, ft
    #[arg(long, value_name = "UNIT", value_parser = unit_of_length)]
    pub unit: Option<f64>,

    /// Take points of tables as corners of a polyline instead of points of a smooth curve
    #[arg(long)]
    pub polyline: bool,

    /// What becomes of rails that the surface does not use up
    #[arg(long, value_enum, default_value_t = LoftEnds::Trim)]
    pub ends: LoftEnds,

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

    /// Distance between drawn rulings, with its unit [default: 20 over the length]
    #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
    pub rulings: Option<Length>,

    /// Distance between marks on the rails, with its unit [default: 8 over the length]
    #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
    pub marks: Option<Length>,

    /// Replace the results of an earlier run in that folder
    #[arg(long)]
    pub force: bool,

    /// Name of the job in the files [default: name of RAIL_A]
    #[arg(long, value_name = "NAME")]
    pub name: Option<String>,

    /// Print nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
}

/// What becomes of rails that are not used up.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoftEnds {
    /// They are trimmed
    Trim,
    /// Cones about the ends of the other rail
    Fan,
    /// Rails are extended until both are used up
    Extend,
}

/// Arguments of `info`.
#[derive(Args, Debug)]
#[command(after_help = "Example:
  torse info hull.step")]
pub struct Info {
    /// STEP file (AP203, AP214 or AP242)
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
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
