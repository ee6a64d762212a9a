//! Sentences on lofts.

use super::super::counted;
use super::super::numbers::{angle, length, length_bound, number as plain_number, percent};
use crate::answer::note::{EndNote, ExactPiece, Leads, LoftNote};
use crate::geom::unit::SQUARE_METRES;

pub(super) fn words(note: &LoftNote) -> String {
    match note {
        LoftNote::Unlike { long, short, factor } => {
            format!("{long} is {factor:.0} times as long as {short}: check that both are in the unit given")
        }
        LoftNote::OnePlane => "both rails lie in one plane: what is between them is a flat piece, with the rails themselves as \
                               its outline"
            .into(),
        LoftNote::Backwards { rail } => format!("{rail} is run through backwards"),
        LoftNote::Branch { number, rails: [a, b], shares, closed } => format!(
            "alternative {number}: regular, uses {} of {a} and {} of {b}{}",
            percent(shares[0]),
            percent(shares[1]),
            if *closed { ", closed" } else { "" }
        ),
        LoftNote::Doubles { count } => {
            format!("{count} branches have their regression points between the rails and are not used")
        }
        LoftNote::LeastTwist => "no branch of common tangent planes was used: this is the strip of least twist, and it is \
                                 not developable unless its twist says so"
            .into(),
        LoftNote::LeastTwistPath { number, bends, twist, area } => format!(
            "alternative {number}: least twist near here; root of the summed squares of its bends {}, twist up to {}, area \
             {} m²",
            angle(*bends),
            angle(*twist),
            plain_number(area * SQUARE_METRES)
        ),
        LoftNote::Ends(note) => ends(note),
        LoftNote::Exact(pieces) => {
            let one = |p: &ExactPiece| format!("{} ({} spans, {})", p.strip, p.spans, length_bound(p.off_bound));
            format!(
                "exactly developable splines of planes, with their proven distance from the rails: {}",
                pieces.iter().map(one).collect::<Vec<_>>().join(", ")
            )
        }
        LoftNote::Ruled { strip, why } => format!(
            "strip A-{strip:02} is a ruled spline with a small twist, not exactly developable: as an exact one, {why}"
        ),
        LoftNote::Creases { count, sharpest, between: [a, b] } => format!(
            "{} between strips; the sharpest, {}, between {a} and {b}",
            counted(*count, "crease"),
            angle(*sharpest)
        ),
    }
}

fn ends(note: &EndNote) -> String {
    match note {
        EndNote::BothRest { at_end } => format!(
            "both rails have a rest at the {}: the cones over them meet in a crease",
            if *at_end { "end" } else { "start" }
        ),
        EndNote::Extended { rail, before, behind } => {
            format!("{rail} is extended by {} at its start and {} at its end", length(*before), length(*behind))
        }
        EndNote::Used { rail, from, to, total, leads } => {
            let help = match leads {
                Leads::ExtensionEnds => "an extension ends before, at half the length of its rail",
                Leads::NoPlanes => "no common tangent planes lead on; ask for fans at the ends",
                Leads::OtherRail => "extend the other rail, or ask for fans or extension at the ends",
            };
            format!(
                "{rail} is used from {} to {} of its length of {}; {help}",
                length(*from),
                length(*to),
                length(*total)
            )
        }
    }
}
