//! Arguments of `unroll` and `shape`.

use super::{Chosen, Drawing, Files};
use crate::quantity::{bend_step, positive_length, positive_time, unit_of_length, Length};
use clap::Args;
use std::path::PathBuf;
use std::time::Duration;
use torse::develop::unfold::tree::Joins;

/// Arguments of `unroll`.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  torse unroll bracket.step --k 0.47 --tolerance 0.01mm --out flat
  torse unroll duct.igs --k din --tolerance 0.05mm --out flat --one-file-per-part
  torse unroll skin.step --surfaces --tolerance 0.05mm --out flat
  torse unroll hull.3dm --surfaces --tolerance 0.1mm --approximate 2mm --out flat
  torse unroll box.step --surfaces --bends '#17,#23' --tolerance 0.05mm --out flat
  torse unroll assembly.step --tolerance 0.1mm --split 250 --out flat

A body of constant thickness is recognised as sheet: its thickness is measured, the sides are dropped, and one skin is
unfolded into one part, holes across bends included. It is cut where it would overlap or close up; the report names the edges.
Bent zones get the length of the neutral fibre. Surfaces without thickness are unfolded as they are, or, with --thickness, --side
and --k, as the neutral fibre of such a sheet.
Faces that are not developable are left out and named, and the result is then not certified; --approximate 0.5mm covers
just those by panels within that distance.

Written into the output folder: patterns.dxf and patterns.svg (cutter), bend_table.csv (angle, inside radius, direction,
allowance, order), parts.csv, panels.step, model.glb, pictures, report.html and report.json.

Exit status: 0 certified, 2 bad input or usage, 3 finished but not certified (files written and marked).")]
pub struct Unroll {
    /// STEP (AP203, AP214, AP242), IGES or Rhino file (3DM)
    #[arg(value_name = "FILE")]
    pub file: PathBuf,

    /// Largest distance allowed between drawn and exact outlines, and within which curves lie on faces, with its unit. Planes, round
    /// cylinders and cones are laid flat exactly, whatever it is
    #[arg(short, long, value_name = "LENGTH", value_parser = positive_length, default_value = "0.01mm",
          allow_hyphen_values = true)]
    pub tolerance: Length,

    #[command(flatten)]
    pub files: Files,

    #[command(flatten)]
    pub chosen: Chosen,

    /// Take all faces as surfaces without thickness; with --thickness they get one, and --k and --side say where its neutral fibre
    /// lies, which is laid flat
    #[arg(long)]
    pub surfaces: bool,

    /// Cover faces that are not developable by panels within this distance, with its unit, as 'torse approximate' does
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, requires = "surfaces", allow_hyphen_values = true)]
    pub approximate: Option<Length>,

    /// Over which edges faces are laid beside each other: all (in sharp bends where they meet at an angle), smooth (where they go
    /// on smoothly), none (every face is a part), or smooth and the sharp edges named: '#17,#23'. bend_table.csv names the edges
    /// of sharp bends, the report those that are cut
    #[arg(long, value_name = "WHICH", value_parser = joins, default_value = "all")]
    pub bends: Joins,

    /// Turn of the sheet from one bend line of a rolled face to the next, in degrees: 5deg. More are drawn where the part could not be
    /// bent back from these
    #[arg(long, value_name = "ANGLE", default_value = "5deg", value_parser = bend_step, allow_hyphen_values = true)]
    #[arg(conflicts_with = "facets")]
    pub bend_step: f64,

    /// Stop after this time, with its unit: 60s, 5min; bodies that were not begun are named and the rest is written
    #[arg(long, value_name = "TIME", value_parser = positive_time, allow_hyphen_values = true)]
    pub time_limit: Option<Duration>,

    /// Refuse the whole file if any of its faces cannot be used
    #[arg(long)]
    pub strict: bool,

    /// Write so many bodies at a time into folders of their own, 001, 002 and on, each a whole result: many bodies then need no
    /// more memory than one folder. Open sheets of one part that do not touch count as bodies, all of them with --surfaces
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..))]
    pub split: Option<u32>,
}

/// Reads over which edges faces are laid beside each other.
fn joins(text: &str) -> Result<Joins, String> {
    match text.trim() {
        "all" => Ok(Joins::All),
        "smooth" => Ok(Joins::Smooth),
        "none" => Ok(Joins::None),
        named => {
            let number = |t: &str| t.trim().trim_start_matches('#').parse::<u64>().ok().filter(|e| *e > 0);
            let all: Option<Vec<u64>> = named.split(',').map(number).collect();
            all.map(Joins::Named).ok_or_else(|| "give all, smooth, none, or numbers of edges such as '#17,#23'".into())
        }
    }
}

/// Where the neutral fibre lies.
#[derive(Clone, Debug, PartialEq)]
pub enum K {
    /// Share of the thickness.
    Share(f64),
    /// The formula of DIN 6935.
    Din,
    /// A table.
    Table(PathBuf),
}

/// Reads a K-factor; what is no number is a table.
pub fn k_factor(text: &str) -> Result<K, String> {
    match text.trim() {
        t if t.eq_ignore_ascii_case("din") => Ok(K::Din),
        t => match t.parse::<f64>() {
            Ok(k) if (0.0..=1.0).contains(&k) => Ok(K::Share(k)),
            Ok(k) => {
                Err(format!("K is a share of the thickness, between 0 and 1, not {k}; values of DIN 6935: --k din"))
            }
            Err(_) => Ok(K::Table(PathBuf::from(t))),
        },
    }
}

/// Arguments of `shape`.
#[derive(Args, Debug)]
#[command(after_help = "Example:
  torse shape hull-job.json --tolerance 0.5mm --out hull

The job names curves, strips between them, handles that pull on them, what stays fixed and what the strips should keep to;
docs/shape.md describes it. The strips stay developable while they follow; what is proven of them is in the report.

Written into the output folder: panels.step, patterns.dxf and patterns.svg (cutter), model.glb, pictures, report.html
and report.json.

Exit status: 0 certified, 2 bad input or usage, 3 finished but not certified (files written and marked).")]
pub struct Shape {
    /// The job (JSON)
    #[arg(value_name = "JOB")]
    pub job: PathBuf,

    /// Largest distance allowed where something is asked: of held places from where they are held, of strips from fixed
    /// curves and targets, across joins; with its unit: 0.5mm. What is not held goes where it is fair, however far
    #[arg(short, long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub tolerance: Length,

    #[command(flatten)]
    pub files: Files,

    /// Unit of lengths in the job, if it does not say its own: mm, cm, m, in, ft
    #[arg(long, value_name = "UNIT", value_parser = unit_of_length)]
    pub unit: Option<f64>,

    /// Distance between rulings that are drawn, with its unit
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub rulings: Option<Length>,

    /// Distance between matching marks, with its unit
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub marks: Option<Length>,

    #[command(flatten)]
    pub drawing: Drawing,
}
