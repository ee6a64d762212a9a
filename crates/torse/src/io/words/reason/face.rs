//! Why faces, bodies and panels are left out, in words.

use super::items::numbered;
use crate::geom::place_in_words;
use crate::io::words::numbers::{angle, area, length, length_bound, length_least, number, place};
use crate::reason::{FaceReason, Limit, Reason, Unlaid};

/// `why` tells the reasons behind it.
pub(super) fn words(reason: &FaceReason, why: fn(&Reason) -> String) -> String {
    match reason {
        FaceReason::OutOfTime => "time was up before it was covered".into(),
        FaceReason::EndedBefore { entity } => format!("ended early, before face #{entity}"),
        FaceReason::Joined(reason, with) => {
            let with: Vec<String> = with.iter().map(|e| format!("#{e}")).collect();
            format!("{} (joined with {})", why(reason), with.join(", "))
        }
        FaceReason::LeftOut { count, area_estimate, unknown, entity, first } => {
            let (what, more) = match count {
                1 => ("1 face or item of the file is".to_string(), ""),
                n => (format!("{n} faces or items of the file are"), ", the first"),
            };
            format!(
                "{what} left out ({}){more}: {}",
                areas(*area_estimate, *unknown, *count),
                numbered(*entity, &why(first))
            )
        }
        FaceReason::PanelsLeftOut { count, first } => format!("{count} panels are left out, the first {}", why(first)),
        FaceReason::TooTight { entity, attempts, radius, panels } => {
            let (given, more) = match attempts {
                Some(n) => (format!("{n} attempts"), "attempts (--time-limit 10min)"),
                None => ("half of the time".into(), "time"),
            };
            format!(
                "face #{entity}: no cover was found in {given} whose panels bend with a radius of {radius} mm or more: the face \
                 asks for about {panels:.0} panels then; it is covered with panels that bend more sharply; a smaller radius or a \
                 larger tolerance would help, or more {more}"
            )
        }
        FaceReason::Trim { entity, edge, bound } => {
            let far = length_bound(*bound);
            format!("face #{entity}: the trim is only proven to keep to the file's edges within {far} (edge #{edge})")
        }
        FaceReason::Replaced { entity, bound } if bound.is_finite() => {
            let far = length_bound(*bound);
            format!("face #{entity}: its surface is read as a spline, which is only proven to keep to that of the file within {far}")
        }
        FaceReason::Replaced { entity, .. } => format!(
            "face #{entity}: its surface is read as a spline, and how far this is from that of the file is measured, not proven; \
             export the face as a spline surface"
        ),
        FaceReason::NoPanel { error, at } => {
            let place = at.map_or(String::new(), |at| format!(" at {}", place_in_words(&at)));
            format!("a region has no panel: {}{place}", why(error))
        }
        FaceReason::SeamLost { entity, by, at } => format!(
            "the seam asked for on face #{entity} is not kept: {} on its curve is {by:.3} mm from the nearest edge of a panel; a finer \
             tolerance, or a curve from border to border, may help",
            place_in_words(at)
        ),
        FaceReason::NoPattern { panel, error } => format!("panel {panel} has no flat pattern: {}", why(error)),
        FaceReason::Limit { panel, limit, value, asked, more } => {
            let more = if *more > 0 { format!(" ({more} more like it)") } else { String::new() };
            format!("panel {panel}: {}{more}", limited(*limit, *value, *asked))
        }
        FaceReason::NoCover { part } => format!("part {part} is not proven as a cover of its face"),
        FaceReason::NoImage => "not all of its faces have a flat image that could be proven".into(),
        FaceReason::LoopLost { entity, edge } => format!(
            "face #{entity}: the loop of its edge #{edge} bounds nothing as it was read; export it with curves in the parameter \
             plane, or repair it in CAD"
        ),
        FaceReason::Kinked { entity, turn, at } => format!(
            "face #{entity} has a sharp edge inside, of {} at {}, of which no bend line tells; split the face there in CAD",
            angle(*turn),
            place(at)
        ),
        FaceReason::BeyondTolerance { part } => format!("part {part} is proven, but not within the tolerance"),
        FaceReason::OutlineLeaves => "its outline leaves the patch".into(),
        FaceReason::NotRuled => "it is not ruled (of degree 1 in one direction)".into(),
        FaceReason::Tip(p) => format!(
            "it reaches its tip at {}, where all rulings meet and no sheet bends; cut a hundredth of its length off at the tip \
             in CAD",
            place(p)
        ),
        FaceReason::Unusable { u, error } => format!("its ruling u = {u:.4} is not usable: {}", why(error)),
        FaceReason::Twisted { u, off } => {
            format!("it is not developable (twist of {} along ruling u = {u:.4})", length(*off))
        }
    }
}

/// The area of what is left out, some or all of it of unknown area.
fn areas(known: f64, unknown: usize, count: usize) -> String {
    let known = area(known);
    match unknown {
        0 => format!("about {known}"),
        n if n == count => "of unknown area".to_string(),
        n => format!("about {known}, {n} of them of unknown area"),
    }
}

fn limited(limit: Limit, value: f64, asked: f64) -> String {
    let asked = format!("{asked} mm");
    match limit {
        Limit::BendRadius => {
            format!("the bending radius is only proven to be {}, where {asked} are asked for", length_least(value))
        }
        Limit::Clearance => format!(
            "the distance to the regression curve is only proven to be {}, where {asked} are asked for",
            length_least(value)
        ),
        Limit::StripWidth => format!("the width of the strip is {}, where {asked} are allowed", length(value)),
        Limit::Length => format!("the length of the pattern is {}, where {asked} are allowed", length(value)),
        Limit::SheetWidth => {
            format!("the width of the rectangle around the pattern is {}, where {asked} are allowed", length(value))
        }
        Limit::SheetLength => {
            format!("the length of the rectangle around the pattern is {}, where {asked} are allowed", length(value))
        }
        Limit::MeanWidth => format!(
            "its mean width is {}, where {asked} are asked for, and no wider panel was proven there; a larger tolerance or a \
             smaller --min-width would help",
            length(value)
        ),
    }
}

/// Why a face or a body is in no flat part.
pub(super) fn unlaid(reason: &Unlaid) -> String {
    match reason {
        Unlaid::Stopped => "the job was stopped before it was unfolded".into(),
        Unlaid::NoSheet(words) | Unlaid::Undeveloped(words) => words.clone(),
        Unlaid::Curved { twist_estimate, curvature_estimate, strain_estimate } => {
            let twist = match twist_estimate.is_finite() {
                true => format!("its tangent plane turns by {} along a ruling", angle(*twist_estimate)),
                false => "it has no straight parameter lines".into(),
            };
            format!(
                "the face is not developable: {twist}, its Gaussian curvature is up to {} per mm², and \
                 flattening it would need a strain of about {}; panels within a distance of it can take its \
                 place (--surfaces --approximate 1mm)",
                number(*curvature_estimate),
                number(*strain_estimate)
            )
        }
        Unlaid::Feature { surface, thickness } => format!(
            "the {surface} is neither a skin nor an edge of the sheet of {}: a feature formed or milled into it, or \
             a bend of a radius below the thickness",
            length(*thickness)
        ),
        Unlaid::Narrow { tolerance } => {
            format!("nothing is left of its outline within the tolerance of {tolerance} mm")
        }
        Unlaid::Face { surface } => format!("the {surface} could not be laid flat"),
        Unlaid::Group(1, reason) => unlaid(reason),
        Unlaid::Group(count, reason) => format!("{} ({count} faces that hang together)", unlaid(reason)),
        Unlaid::Panel => "it could not be laid flat".into(),
        Unlaid::NoStrips => "it names strips that do not exist".into(),
        Unlaid::NotBegun => "the job was stopped before it was laid flat".into(),
        Unlaid::Ruled => "ruled, not developable: it has no flat pattern".into(),
    }
}
