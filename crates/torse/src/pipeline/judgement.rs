//! What is proven and measured about strips between rails: the same for every job that makes them.

use super::sheets::{Basis, FieldMeaning, Figure, StripField};
use crate::certify::rails::{rail_bound, twist_bound};
use crate::design::loft::build::BuiltStrip;
use crate::surface::rail::Rail;

/// Stations per strip where twist and clearance are measured.
const STATIONS: usize = 64;

/// Bounds, figures and colours of strips.
#[derive(Clone, Debug)]
pub struct Judgement {
    /// Greatest proven distance (mm) from the rails on the first and the second side.
    pub off: [f64; 2],
    /// Greatest proven twist, rad.
    pub twist: f64,
    /// Greatest measured twist, rad.
    pub measured: f64,
    /// Least measured distance between a strip and its regression curve, mm; cones of fans left out.
    pub clearance: f64,
    /// Figures of each strip.
    pub strip_figures: Vec<Vec<Figure>>,
    /// Measured twist (degrees) for colours.
    pub fields: Vec<StripField>,
    /// What the colours mean.
    pub meaning: FieldMeaning,
    /// Strips that are exact: planes, and strips ruled between the given curves themselves.
    pub exact: usize,
    /// What keeps the whole from being developable.
    pub missing: Vec<String>,
}

impl Judgement {
    /// Figures of the whole, without the distances from rails.
    pub fn figures(&self) -> Vec<Figure> {
        vec![
            Figure::new("strips between the curves themselves", self.exact as f64, "", Basis::Given),
            Figure::new("strips with fitted edges", (self.strip_figures.len() - self.exact) as f64, "", Basis::Given),
            Figure::new("twist, bound", self.twist.to_degrees(), "°", Basis::Proven),
            Figure::new("twist", self.measured.to_degrees(), "°", Basis::Measured),
            Figure::new("regression clearance", self.clearance, "mm", Basis::Measured),
        ]
    }
}

/// Judges strips, each with the rails that its parts refer to (none where a side was not asked for); `names` are what
/// the rails are called, `limit` (rad) is the twist that counts as developable.
pub fn judge(strips: &[(&BuiltStrip, [Option<&Rail>; 2])], names: &[String; 2], limit: f64) -> Judgement {
    let sides = [0, 1].map(|side: usize| strips.iter().any(|s| s.1[side].is_some()));
    let mut out = Judgement {
        off: [0.0; 2],
        twist: 0.0,
        measured: 0.0,
        clearance: f64::INFINITY,
        strip_figures: Vec::new(),
        fields: Vec::new(),
        meaning: FieldMeaning::default(),
        exact: 0,
        missing: Vec::new(),
    };
    for (built, rails) in strips {
        let strip = &built.strip;
        let off = [0, 1].map(|side: usize| {
            rails[side].map_or(0.0, |rail| rail_bound(strip, side, rail, &built.rails[side]).unwrap_or(f64::INFINITY))
        });
        for (w, o) in out.off.iter_mut().zip(&off) {
            *w = w.max(*o);
        }
        // The curves themselves, and not a fit to them, if their parameters are linear.
        out.exact += usize::from(built.rails.iter().all(|r| r.parameter.knots.degree() == 1));
        let (u0, u1) = strip.domain();
        let at: Vec<f64> = (0..=STATIONS).map(|k| u0 + (u1 - u0) * k as f64 / STATIONS as f64).collect();
        let twists: Vec<f64> = at.iter().map(|&u| strip.twist(u)).collect();
        let twist = twists.iter().copied().fold(0.0, f64::max);
        let fan = strip.is_point(0) || strip.is_point(1);
        let clearance = if fan {
            f64::INFINITY
        } else {
            at.iter().map(|&u| strip.regression_clearance(u)).fold(f64::INFINITY, f64::min)
        };
        // Where samples exceed the limit, a bound twice as large says as much, for far less work.
        let shown = twist_bound(strip, limit.max(2.0 * twist));
        let developable = shown.regular && shown.angle <= limit;
        out.twist = out.twist.max(shown.angle);
        out.measured = out.measured.max(twist);
        out.clearance = out.clearance.min(clearance);
        if clearance <= 0.0 {
            out.missing.push(format!("strip {} has regression points between its rails", strip.name));
        } else if !developable && shown.angle <= limit {
            out.missing.push(format!("strip {} was not shown to keep off its regression curve", strip.name));
        }
        let mut figures: Vec<Figure> = (0..2)
            .filter(|&side| sides[side])
            .map(|side| Figure::new(format!("from {}", names[side]), off[side], "mm", Basis::Proven))
            .collect();
        figures.extend([
            Figure::new("twist, bound", shown.angle.to_degrees(), "°", Basis::Proven),
            Figure::new("twist", twist.to_degrees(), "°", Basis::Measured),
            Figure::new("regression clearance", clearance, "mm", Basis::Measured),
            Figure::new("area", strip.area_estimate() * 1e-6, "m²", Basis::Measured),
        ]);
        out.strip_figures.push(figures);
        let values = twists.iter().flat_map(|t| [t.to_degrees(); 2]).collect();
        out.fields.push(StripField { u: at, v: vec![0.0, 1.0], values });
    }
    if out.twist > limit {
        out.missing.push(format!(
            "twist up to {:.3e}° (measured), proven bound {:.3e}°, where {:.3e}° count as developable",
            out.measured.to_degrees(),
            out.twist.to_degrees(),
            limit.to_degrees()
        ));
    }
    let top = out.fields.iter().flat_map(|f| &f.values).fold(limit.to_degrees(), |m: f64, x| m.max(*x));
    out.meaning = FieldMeaning { name: "twist".into(), unit: "°".into(), limit: top };
    out
}
