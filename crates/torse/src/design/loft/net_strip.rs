//! Strips of nets \[FJ07\] as those of lofts: with the stretch of the rail that they follow.

use super::build::{classified, BuiltStrip};
use crate::spline::curve::Curve;
use crate::torse::form::PanelKind;
use crate::torse::net::{NetError, NetKind, TaperedNet};
use crate::torse::rail::RailPart;
use crate::torse::strip::Strip;

/// The strip of a net, and the stretch of the rail that it follows; `along` is the stretch that the rail stands for.
///
/// # Errors
/// A boundary with a weight that is not positive, or one that is no spline.
pub fn strip(net: &TaperedNet, index: usize, along: [f64; 2]) -> Result<BuiltStrip, NetError> {
    let (c, d) = if net.is_constant() {
        let net = net.net.between(0.0, net.taper.0)?;
        (net.curve().clone(), net.opposite())
    } else {
        net.boundaries()?
    };
    for (i, w) in d.control.iter().enumerate().map(|(i, p)| (i, p[3])) {
        if w.is_nan() || w <= 0.0 {
            return Err(NetError::Weight { index: i, weight: w });
        }
    }
    let kind = match net.net.kind() {
        NetKind::Cylinder { .. } => PanelKind::Cylinder,
        NetKind::Cone { .. } => PanelKind::Cone,
        NetKind::Tangent => PanelKind::Torse,
    };
    let strip = Strip::between(&format!("A-{:02}", index + 1), kind, &c, &d)?;
    // Planes have their own name; for the rest the net knows best.
    let seen = classified(strip.clone());
    let strip = if seen.kind == PanelKind::Plane { seen } else { strip };
    let (a, b) = net.net.domain();
    let share = |u: f64| (u - along[0]) / (along[1] - along[0]);
    let linear = |x: f64, y: f64| Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], vec![[x], [y]]);
    let part = |x: f64, y: f64| Ok::<_, NetError>(RailPart { piece: 0, parameter: linear(x, y)? });
    let whole = part(share(a).clamp(0.0, 1.0), share(b).clamp(0.0, 1.0))?;
    Ok(BuiltStrip { strip, rails: [whole.clone(), whole] })
}
