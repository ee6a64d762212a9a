//! Sentences on sheet and work.

use super::super::numbers::{length, number};
use super::unroll::factor;
use crate::answer::note::{LeastRadius, Material, OffsetSide, ShopNote, TooTight};

/// Parts that are named in one note; more are counted.
const NAMED: usize = 4;

pub(super) fn words(note: &ShopNote) -> String {
    match note {
        ShopNote::Material(m) => material(m),
        ShopNote::Sheet(sheet) => format!(
            "Sheet of {}; the panels are its {}. {}. Parts hollow both ways have it in the middle.",
            length(sheet.thickness),
            sheet.side.words(),
            factor(&sheet.k)
        ),
        ShopNote::Neutral { parts } => format!(
            "Flat patterns are those of the neutral fibre, not of the panels: {}. They are computed from patterns of the \
             panels and measured, not proven.",
            named(parts)
        ),
        ShopNote::OfFibre { parts, sheet } => format!(
            "Flat patterns are those of the neutral fibre of a sheet of {}, of which the faces are the {}: {}. {}. Sharp edges have no \
             radius and move nothing.",
            length(sheet.thickness),
            sheet.side.words(),
            named(parts),
            factor(&sheet.k)
        ),
        ShopNote::NoPlaces { parts } => {
            format!(
                "Roll radii, kinks and sections are not known of {}: the maps of the faces do not fit what is drawn.",
                named(parts)
            )
        }
        ShopNote::NotNeutral { parts } => format!(
            "Flat patterns are those of the panels, not of the neutral fibre, where cones end in a point or panels are drawn \
             from other surfaces: {}.",
            named(parts)
        ),
        ShopNote::TooTight { part, tight: TooTight::NoRoom { thickness } } => {
            format!("{part}: a sheet of {} does not fit inside its tightest bend.", length(*thickness))
        }
        ShopNote::TooTight { part, tight: TooTight::BelowLeast { radius, needed, material, least } } => format!(
            "{part}: its least inside radius of {} is below {}, the least for {material} ({}).",
            length(*radius),
            length(*needed),
            least_radius(*least)
        ),
        ShopNote::Kinked { displacement_estimate } => format!(
            "Kinked parts come to lie up to {} from the curved ones (sampled); kinks, angles and a sequence from both ends \
             inwards are in facets.csv.",
            length(*displacement_estimate)
        ),
        ShopNote::KinkedFibre { parts } => kinked_fibre(parts),
        ShopNote::Offsets { edge_error } => format!(
            "inside.step, neutral.step and outside.step hold the sides of the sheet and its neutral surface, the panels at a constant \
             distance each; edges are within {} of it (measured, not proven).",
            length(*edge_error)
        ),
        ShopNote::NoOffset { panel, side, none } => format!(
            "{panel} is not in {}: at ({}, {}, {}) mm it has a radius of {}, for which that side of the sheet is too far away.",
            side.file(),
            number(none.at.x),
            number(none.at.y),
            number(none.at.z),
            length(none.radius)
        ),
        ShopNote::NoOffsets { parts } => format!(
            "No sides of the sheet are written of {}: bodies of sheet have both, and faces without a panel have none.",
            named(parts)
        ),
        ShopNote::NeutralVaries { parts } => format!(
            "{}: the neutral surface is not at one distance from the panels, and not in {}.",
            named(parts),
            OffsetSide::Neutral.file()
        ),
        ShopNote::OffsetsOfCones => {
            "The sides of the sheet and its middle are in thickness.step, as cones, cylinders and planes.".into()
        }
        ShopNote::Unknown { parts } => format!(
            "Roll radii, kinks, sections and the neutral fibre are not known of {}: patterns drawn from other surfaces than \
             the panels. Patterns and weights are those of the faces in the file, also where the sheet lies to one side of these.",
            named(parts)
        ),
    }
}

fn kinked_fibre(parts: &[String]) -> String {
    format!(
        "How far kinked parts come to lie from the curved ones is not known of {}: the neutral fibre that is drawn is not at one \
         distance from their faces, as their radii and with them K change; kinks, angles and a sequence are in facets.csv.",
        named(parts)
    )
}

fn material(m: &Material) -> String {
    let least = m.least_radius.map_or_else(String::new, |r| format!(", least inside radius {}", least_radius(r)));
    let from = match m.source.as_str() {
        "" => "typical numbers, ask the supplier".into(),
        source => format!("numbers from: {source}"),
    };
    format!("Material: {}, {} kg/m³{least}; {from}.", m.name, number(m.density))
}

fn least_radius(least: LeastRadius) -> String {
    match least {
        LeastRadius::Thicknesses(n) => format!("{} times the thickness", number(n)),
        LeastRadius::Length(mm) => length(mm),
    }
}

fn named(names: &[String]) -> String {
    match names.len() {
        n if n > NAMED => format!("{} and {} more", names[..NAMED].join(", "), n - NAMED),
        _ => names.join(", "),
    }
}
