//! Chains of fitted strips replaced by exactly developable ones \[PW99\], where these come near enough to the rails.

use super::exact_strip::{exact_strips, ExactError};
use crate::control::Control;
use crate::design::loft::build::BuiltStrip;
use crate::torse::rail::Rail;

/// Share of the tolerance within which exactly developable strips must keep to the rails; beyond it a ruled spline with
/// a small twist is taken, which keeps to a tenth.
const EXACT_SHARE: f64 = 0.5;

/// An exactly developable strip of a chain.
#[derive(Clone, Debug, PartialEq)]
pub struct ExactPiece {
    /// Its name.
    pub strip: String,
    /// Spans of its spline of planes.
    pub spans: usize,
    /// Proven distance from the rails, mm.
    pub off_bound: f64,
}

/// A chain of strips, and which of them are exactly developable.
#[derive(Clone, Debug, Default)]
pub(crate) struct ExactChain {
    /// The strips, named and so on.
    pub strips: Vec<BuiltStrip>,
    /// Those that are exactly developable by construction.
    pub exact: Vec<ExactPiece>,
    /// Numbers, from 1, of those that are ruled splines with a small twist, and why there is no exact one.
    pub ruled: Vec<(usize, ExactError)>,
}

/// Fitted strips replaced by exactly developable ones where these come near enough to the rails; `tolerance` (mm) is that
/// of the job. What a stopped control leaves is told.
pub(crate) fn exact_chain(built: Vec<BuiltStrip>, rails: [&Rail; 2], tolerance: f64, control: &Control) -> ExactChain {
    let mut out = ExactChain::default();
    for mut one in built {
        let number = out.strips.len() + 1;
        let fitted = one.rails.iter().any(|r| r.parameter.knots.degree() > 1);
        if fitted && !control.stopped() {
            match exact_strips(&one, rails, EXACT_SHARE * tolerance, control) {
                Ok(parts) => {
                    for mut p in parts {
                        let strip = format!("A-{:02}", out.strips.len() + 1);
                        p.built.strip.name.clone_from(&strip);
                        out.exact.push(ExactPiece { strip, spans: p.spans, off_bound: p.off });
                        out.strips.push(p.built);
                    }
                    continue;
                }
                Err(why) => out.ruled.push((number, why)),
            }
        } else if fitted {
            out.ruled.push((number, ExactError::NotLookedFor));
        }
        one.strip.name = format!("A-{number:02}");
        out.strips.push(one);
    }
    out
}
