//! Arguments about sheet and work, the same for every command that writes flat parts.

use super::flat::{k_factor, K};
use crate::quantity::{bend_step, positive_count, positive_length, stations, Length};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use torse::develop::bends::Facets;
use torse::develop::shop::thickness::SheetSide;
use torse::pipeline::workshop::Stations;

/// Heading of these arguments in the help.
const SHEET: &str = "Sheet and work";

/// Sheet and work.
#[derive(Args, Clone, Debug, Default)]
pub struct Shop {
    /// Material of the sheet, such as mild-steel: for weights, least radii and K-factors. A name that is not known is
    /// answered with those that are
    #[arg(long, help_heading = SHEET, value_name = "NAME")]
    pub material: Option<String>,

    /// Own materials, as a table (.csv: material, density in kg/m³, least_radius (1.5t or 4mm), k, note, source) or as TOML
    /// (.toml: a table of these for every material)
    #[arg(long, help_heading = SHEET, value_name = "FILE", requires = "material")]
    pub materials: Option<PathBuf>,

    /// Thickness of the sheet, with its unit; bodies of sheet in 'torse unroll' have their own
    #[arg(long, help_heading = SHEET, value_name = "LENGTH", value_parser = positive_length, allow_hyphen_values = true)]
    pub thickness: Option<Length>,

    /// Which side of the sheet the given surface is
    #[arg(long, help_heading = SHEET, value_name = "SIDE", value_enum, default_value_t = Side::Middle, requires = "thickness")]
    pub side: Side,

    /// Also write the sides of the sheet and its neutral surface for CAD: inside.step, neutral.step and outside.step, the panels at
    /// constant distances
    #[arg(long, help_heading = SHEET, requires = "thickness")]
    pub offsets: bool,

    /// Where the neutral fibre of bends lies: its depth from the inside as a share of the thickness (ANSI, such as 0.44),
    /// 'din' for the formula of DIN 6935, or a table (.csv) with the columns R/t (inside radius over thickness) and K
    /// [default: that of the material; else 0.44 for bodies of sheet, 0.5 for panels]
    #[arg(long, help_heading = SHEET, value_name = "K", value_parser = k_factor, allow_hyphen_values = true)]
    pub k: Option<K>,

    /// Kink curved parts on a press brake: so many kinks over a part (12), arcs that rise no higher over the facets
    /// (chord=0.5mm), a kink for every turn (angle=5deg) or for every length (length=100mm). They take the place of the
    /// bend lines
    #[arg(long, help_heading = SHEET, value_name = "HOW", value_parser = facets, allow_hyphen_values = true)]
    pub facets: Option<Facets>,

    /// Planes whose sections with the parts are marked: x=500mm, x=0mm..6m/500mm (from, to, step) or z=250mm.. (all
    /// multiples of the step across the model, also z=../250mm); may be given several times
    #[arg(long, help_heading = SHEET, value_name = "AXIS=PLACES", value_parser = stations, allow_hyphen_values = true)]
    pub mark_sections: Vec<Stations>,
}

/// Side of the sheet.
#[derive(ValueEnum, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// Its inside: the sheet lies outwards
    Inside,
    /// Its middle
    #[default]
    Middle,
    /// Its outside: the sheet lies inwards
    Outside,
}

impl Side {
    /// The same in the library's words.
    pub fn of_sheet(self) -> SheetSide {
        match self {
            Self::Inside => SheetSide::Inside,
            Self::Middle => SheetSide::Middle,
            Self::Outside => SheetSide::Outside,
        }
    }
}

/// Reads how curved parts are kinked.
pub fn facets(text: &str) -> Result<Facets, String> {
    let help = "write a number of kinks such as 12, or chord=0.5mm, angle=5deg or length=100mm";
    let Some((name, value)) = text.split_once('=') else {
        return positive_count(text).map(|n| Facets::Count(n as usize)).map_err(|e| format!("{e}; {help}"));
    };
    match name.trim() {
        "chord" => positive_length(value).map(|l| Facets::Chord(l.mm)),
        "angle" => bend_step(value).map(|a| Facets::Turn(a.to_radians())),
        "length" => positive_length(value).map(|l| Facets::Length(l.mm)),
        other => Err(format!("'{other}': {help}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn facets_are_read_in_four_ways() {
        assert_eq!(facets("12"), Ok(Facets::Count(12)));
        assert_eq!(facets("chord=0.5mm"), Ok(Facets::Chord(0.5)));
        assert_eq!(facets("angle=9deg"), Ok(Facets::Turn(9f64.to_radians())));
        assert_eq!(facets("length=1in"), Ok(Facets::Length(25.4)));
        for bad in ["0", "chord=1", "x=3mm", "", "angle=0deg", "12.5"] {
            assert!(facets(bad).is_err(), "{bad}");
        }
    }
}
