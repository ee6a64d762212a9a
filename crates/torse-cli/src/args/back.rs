//! Arguments of `refold` and `map`, which read results, and of `info`.

use crate::quantity::{positive_length, unit_of_length, Length};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Arguments of `refold`.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  torse refold hull-panels --out hull-refolded
  torse refold pipe --tolerance 0.5mm --out pipe-refolded

Reads only what another command wrote into the folder: report.json, patterns.dxf (or patterns.svg), bends.csv, bend_table.csv
and panels.step. Bends every flat part back from its drawing and its bend tables and measures how far it is from its panels
in space after the best rigid motion: at samples, and with a proven bound for the surfaces and their edges, both ways, where
that can be had.

Written into the output folder: refold.json, refolded.glb.

Exit status: 0 all parts bent back and proven to lie within the tolerance, 2 bad input or usage, 3 some parts
left out, not proven or beyond it.")]
pub struct Refold {
    /// Folder with the result of another command
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,

    /// Folder to create for the results
    #[arg(short, long, value_name = "DIR")]
    pub out: PathBuf,

    /// Distance within which every part is to lie from its panels; default: twice the tolerance of the result, as
    /// outlines may be drawn off by one and what lies between bend lines by another
    #[arg(short, long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub tolerance: Option<Length>,

    /// Replace the files of an earlier result in that folder; everything else in it is kept
    #[arg(long)]
    pub force: bool,

    /// Print nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
}

/// Where artwork goes.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum To {
    /// To the flat patterns, as patterns.dxf has them
    Flat,
    /// To the parts in space, as panels.step has them
    Space,
}

/// Arguments of `map`.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  torse map hull-panels --to flat rivets.csv --out rivets-flat.csv
  torse map hull-panels --to space logo.dxf --part A-03 --out logo-in-space.dxf

A table (.csv) of points gives a table, a drawing (.dxf) a drawing: lines, arcs, circles, ellipses, polylines and splines become
polylines, points and texts stay what they are, on their layers and in their colours. Each is on one part, whose name is with it
as data of TORSE (1001, 1000); what runs over several parts is cut between them. Points that lie on no part are named with their
distance; of curves, it is told how much of them lies on no part.

Exit status: 0 all was carried over, 2 bad input or usage, 3 something lies on no part, or parts were left out.")]
pub struct Map {
    /// Folder with the result of another command
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,

    /// Table of points or drawing of curves
    #[arg(value_name = "POINTS.csv|CURVES.dxf")]
    pub artwork: PathBuf,

    /// Where it goes
    #[arg(long, value_name = "SIDE", value_enum)]
    pub to: To,

    /// File to write
    #[arg(short, long, value_name = "FILE")]
    pub out: PathBuf,

    /// Replace that file, if 'torse map' wrote it; what others wrote is never replaced
    #[arg(long)]
    pub force: bool,

    /// Carry over to this part alone
    #[arg(long, value_name = "NAME")]
    pub part: Option<String>,

    /// How far from a part artwork may be, with its unit [default: the tolerance of the result]
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub within: Option<Length>,

    /// How far polylines may be from the curves that they stand for, with its unit [default: 0.01mm]
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub chord: Option<Length>,

    /// Unit of artwork that does not say its own: mm, cm, m, in, ft [default: mm]
    #[arg(long, value_name = "UNIT", value_parser = unit_of_length)]
    pub unit: Option<f64>,
}

/// Arguments of `info`.
#[derive(Args, Debug)]
#[command(after_help = "Example:
  torse info hull.step")]
pub struct Info {
    /// STEP (AP203, AP214, AP242), IGES or Rhino file (3DM)
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
}
