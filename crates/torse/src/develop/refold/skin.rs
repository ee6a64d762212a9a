//! From the neutral fibre of a sheet, which is drawn, to its skin, which panels show: the outer side of a body, or the surface that was
//! given the sheet, wherever in that it lies.
//!
//! *Method* (docs/algorithms/refold.md, "Sheet metal"). Both are offsets of each other: they have the same directions of rulings and
//! the same tangent planes. Over a turn dκ towards the eye the skin goes `δ dκ` less far across the rulings than the neutral
//! fibre at the depth δ below it, and as far along them. The depth follows from K at the radius of the skin half way along the ruling,
//! as where the part was laid flat.

use crate::develop::unfold::allowance::Fibre;
use crate::torse::ribbon::pose::{Pose, Rates};
use crate::torse::ribbon::Ribbon;

/// Steps towards the radius of the skin, from which K follows: tables are gentle, so that each takes most of what is left.
const STEPS: usize = 30;

/// How a ruling of the skin moves in space where that of the neutral fibre moves as given; `reach` is the part of the ruling that belongs
/// to the sheet, mm.
pub(super) fn on_skin(fibre: &Fibre, rates: Rates, reach: [f64; 2]) -> Rates {
    if rates.turn == 0.0 {
        return rates;
    }
    let hollow = rates.turn > 0.0;
    let middle = 0.5 * (reach[0] + reach[1]);
    let neutral = ((rates.across + rates.spin * middle) / rates.turn).abs();
    let skin = |depth: f64| if hollow { neutral - depth } else { neutral + depth };
    let mut depth = fibre.depth(neutral, hollow);
    for _ in 0..STEPS {
        depth = fibre.depth(skin(depth).max(0.0), hollow);
    }
    Rates { across: rates.across - depth * rates.turn, ..rates }
}

/// The ribbon of the skin, its first ruling where that of the neutral fibre is.
pub(super) fn skin(mut ribbon: Ribbon, fibre: &Fibre) -> Ribbon {
    let mut ends: Option<[Pose; 2]> = None;
    for span in &mut ribbon.spans {
        let old = span.space;
        if let Some([before, here]) = ends {
            // What lies between spans, folds, stays.
            let back = before.axes.transpose();
            let (axes, at) = (here.axes * back * old.axes, here.at + here.axes * back * (old.at - before.at));
            span.space = Pose { axes, at };
        }
        let before = old.moved(&span.in_space, 1.0);
        span.in_space = on_skin(fibre, span.in_space, span.reach);
        ends = Some([before, span.space.moved(&span.in_space, 1.0)]);
    }
    ribbon
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::develop::unfold::allowance::KFactor;
    use crate::geom::Vec2;
    use crate::torse::ribbon::Span;

    #[test]
    fn the_skin_of_a_quarter_has_its_own_radius_either_way() {
        let (t, radius) = (2.0, 10.0);
        for k in [KFactor::Ansi(0.3), KFactor::Din, KFactor::Table(vec![[1.0, 0.2], [9.0, 0.5]])] {
            let fibre = Fibre { k, thickness: t, above: 0.0 };
            for hollow in [true, false] {
                let sign = if hollow { 1.0 } else { -1.0 };
                let depth = fibre.depth(radius, hollow);
                let neutral = radius + sign * depth;
                let turn = sign * std::f64::consts::FRAC_PI_2 / 100.0;
                let rates = Rates { turn, across: neutral * turn.abs(), ..Rates::default() };
                let start = Pose::flat(Vec2::zeros(), Vec2::x());
                let mut spans: Vec<Span> = Vec::new();
                let mut space = start;
                for _ in 0..100 {
                    spans.push(Span { flat: start, space, in_plane: rates, in_space: rates, reach: [0.0, 5.0] });
                    space = space.moved(&rates, 1.0);
                }
                let made = skin(Ribbon { spans }, &fibre);
                let chord = (made.space(100.0).at - start.at).norm();
                assert!((chord - radius * 2.0_f64.sqrt()).abs() < 1e-9, "{hollow} {chord}");
            }
        }
    }
}
