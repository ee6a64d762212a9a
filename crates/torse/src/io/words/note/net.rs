//! Sentences on nets.

use super::super::numbers::{length, number};
use crate::answer::note::{NetNote, Route};
use crate::torse::net::Shape;

pub(super) fn words(note: &NetNote) -> String {
    match note {
        NetNote::Candidate { number, shape, quality, clearance_estimate, last } => {
            let clearance = if clearance_estimate.is_finite() {
                format!("regression curve at least {} from the curve along the rulings", length(*clearance_estimate))
            } else {
                "no regression curve".into()
            };
            format!("solution {number}: {}; it {quality}; {clearance}, last ruling {}", stars(shape), length(*last))
        }
        NetNote::Asked { number } => format!("solution {number} was taken because it was asked for"),
        NetNote::Route { route, good } => way(*route, *good),
        NetNote::Stretch { along: [from, to] } => format!(
            "the strip runs from {from} to {to} of the curve's parameter, 0 to 1{}",
            if *from < 0.0 || *to > 1.0 { "; beyond the curve's ends curve and surface are continued" } else { "" }
        ),
        NetNote::NoRegression { strip } => format!("strip {strip} has no regression curve"),
        NetNote::Regression { strip, apex, linear, at } => {
            let side = |v: f64| if v < 0.0 { "behind the curve" } else { "beyond the opposite edge" };
            format!(
                "strip {strip}: its {} lies {}, {} times the ruling from the curve on the first ruling and {} times on the \
                 last{}",
                if *apex { "apex" } else { "regression curve" },
                if at[0] * at[1] > 0.0 { side(at[0]) } else { "on both sides" },
                number(at[0].abs()),
                number(at[1].abs()),
                if *linear { " (linear in between)" } else { "" }
            )
        }
    }
}

/// The free parameters: with the digits that it takes to ask for them again.
fn stars(shape: &Shape) -> String {
    if shape.m == 0.0 {
        format!("m = 0, κ = {:.6}", shape.kappa)
    } else {
        format!("M* = {:.6}, Λ* = {:.6}", shape.m_star(), shape.lambda_star())
    }
}

fn way(route: Route, good: usize) -> String {
    match route {
        Route::Polynomial if good > 1 => {
            format!("solution 1 was taken: of {good} regular ones its regression curve keeps farthest from the curve")
        }
        Route::Polynomial => "solution 1 was taken: it is the only regular polynomial one".into(),
        Route::Cylinder => "the end rulings are parallel: the surface is a cylinder".into(),
        Route::Cone => "the end rulings meet: the surface is a cone".into(),
        Route::Rational => {
            "no polynomial net is regular with both end rulings on the sides given: a rational one was taken, \
                            that with the most even rulings"
                .into()
        }
        Route::Split => {
            "no single net is regular: the curve was split, and a ruling in between was chosen so that both parts \
                         are regular and join smoothly"
                .into()
        }
    }
}
