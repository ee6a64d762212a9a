//! Arguments of `ruled`.

use super::{Chosen, Files};
use crate::quantity::{positive_length, positive_time, Length};
use clap::Args;
use std::path::PathBuf;
use std::time::Duration;

/// Arguments of `ruled`.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  torse ruled roof.step --tolerance 10mm --out formwork
  torse ruled roof.step --tolerance 10mm --width 2m --spacing 100mm --out beams
  torse ruled roof.step --tolerance 10mm --conoidal --out books

Strips are ruled surfaces along the asymptotic curves of the faces: wide where these are nearly straight. They are not
developable; nothing is laid flat. Where a face bends to one side (a dome) there are no straight lines near: that part is
named, red in curvature.png, and the rest goes on.

Files: panels.step, rulings.csv, rulings.dxf, curvature.png, panels.png, deviation.png, model.glb, report.html (with the
kink at every seam), report.json")]
pub struct Ruled {
    /// STEP (AP203, AP214, AP242), IGES or Rhino file (3DM)
    #[arg(value_name = "FILE")]
    pub file: PathBuf,

    /// Largest distance allowed between faces and strips, with its unit: 10mm, 1cm, 1/4in
    #[arg(short, long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub tolerance: Length,

    /// Greatest width of a strip along its rulings, with its unit: 2m
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub width: Option<Length>,

    /// Distance of the rulings in rulings.csv and rulings.dxf, with its unit: 100mm; else a sixtieth of the model's diagonal
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub spacing: Option<Length>,

    /// Rulings of each strip parallel to a plane of its own, for boards of constant thickness
    #[arg(long)]
    pub conoidal: bool,

    /// Stop after this time, with its unit: 60s, 5min; what was found until then is kept and marked
    #[arg(long, value_name = "TIME", value_parser = positive_time, allow_hyphen_values = true)]
    pub time_limit: Option<Duration>,

    #[command(flatten)]
    pub files: Files,

    #[command(flatten)]
    pub chosen: Chosen,

    /// Refuse the whole file if any of its faces cannot be used
    #[arg(long)]
    pub strict: bool,
}
