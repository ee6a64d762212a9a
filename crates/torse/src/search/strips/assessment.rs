//! What is proven and measured about strips between rails: the same for every job that makes them.

use crate::certify::claim::{Claim, Counted, Subject, UpperBound, What};
use crate::certify::rails::{rail_bound, twist_bound, TwistBound};
use crate::control::Control;
use crate::design::loft::build::BuiltStrip;
use crate::draw::field::{FieldMeaning, PanelField};
use crate::geom::unit::SQUARE_METRES;
use crate::num::parallel;
use crate::reason::{Reason, StripReason, Witness};
use crate::torse::form::PanelKind;
use crate::torse::rail::Rail;
use crate::torse::strip::Strip;

/// Stations per strip where twist and clearance are measured.
const STATIONS: usize = 64;
/// Twist (rad) that counts as developable where nothing else is asked for: 0.0006°, a hundredth of a millimetre over
/// a metre.
pub(crate) const TWIST_TOLERANCE: f64 = 1e-5;

/// A strip to be judged.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate<'a> {
    /// Index of the strip among all strips of the job.
    pub index: usize,
    /// The strip with the parts of the rails that it stands for.
    pub built: &'a BuiltStrip,
    /// The rails of both sides; none where a side was not asked for.
    pub rails: [Option<&'a Rail>; 2],
}

/// Bounds, claims and colours of strips.
#[derive(Clone, Debug)]
pub(crate) struct Assessment {
    /// Greatest distance (mm) from the rails on the first and the second side; unknown for sides not asked for.
    pub off: [UpperBound; 2],
    /// Greatest twist, rad.
    pub twist: UpperBound,
    /// Greatest measured twist, rad.
    pub measured: f64,
    /// Least measured distance between a strip and its regression curve, mm; cones of fans left out.
    pub clearance: f64,
    /// What is said of the strips one by one.
    pub claims: Vec<Claim>,
    /// Measured twist (degrees) for colours.
    pub fields: Vec<PanelField>,
    /// What the colours mean.
    pub meaning: FieldMeaning,
    /// Strips that were judged, and those of them that are exact: planes, and strips ruled between the given curves
    /// themselves.
    pub counts: [usize; 2],
    /// What keeps the whole from being developable.
    pub missing: Vec<Reason>,
    /// Twist (rad) that counts as developable.
    pub limit: f64,
    /// For each side: the strip whose bound from its rail is the greatest, and the middle of that side.
    pub farthest: [Option<Witness>; 2],
    /// Where the greatest twist was measured.
    pub most_twisted: Option<Witness>,
}

impl Assessment {
    /// What is said of the whole, without the distances from rails.
    pub fn whole(&self) -> Vec<Claim> {
        let whole = Subject::Whole;
        let [judged, exact] = self.counts;
        let mut out = vec![
            Claim::count(Counted::ExactStrips, whole, exact),
            Claim::count(Counted::FittedStrips, whole, judged - exact),
        ];
        if judged > 0 {
            let Self { measured, limit, .. } = *self;
            let most = self.most_twisted.clone();
            let reason = StripReason::Twist { measured, bound: self.twist.value(), limit, most };
            let twist = Claim::at_most(What::Twist, whole, self.twist.degrees());
            out.push(twist.within(limit.to_degrees()).because(Reason::from(reason)));
        }
        out.push(Claim::measured(What::Twist, whole, self.measured.to_degrees()));
        out.push(Claim::measured(What::RegressionClearance, whole, self.clearance));
        out
    }
}

/// What was found of one strip.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    /// Distances from the rails that were asked for.
    off: [Option<UpperBound>; 2],
    twist: TwistBound,
    at: Vec<f64>,
    twists: Vec<f64>,
    clearance: f64,
    /// The ruling of which the clearance was measured to be least.
    tightest: f64,
}

/// A strip and a place on it.
fn witness(strip: &Strip, u: f64, v: f64) -> Option<Witness> {
    let at = strip.patch.point(u, v);
    at.iter().all(|x| x.is_finite()).then(|| Witness { strip: strip.name.clone(), at })
}

impl Found {
    /// The ruling of which the twist was measured to be greatest.
    fn most_twisted(&self) -> f64 {
        let most = (0..self.at.len()).max_by(|&a, &b| self.twists[a].total_cmp(&self.twists[b]));
        most.map_or(0.0, |k| self.at[k])
    }

    /// Whether its distances and its twist are bounded at all.
    pub fn is_bounded(&self) -> bool {
        self.twist.is_regular() && self.off.iter().flatten().all(|b| *b != UpperBound::UNKNOWN)
    }

    /// Whether its distances are proven to stay within `tolerance` (mm) and its twist within `limit` (rad).
    pub fn is_within(&self, tolerance: f64, limit: f64) -> bool {
        let near = self.off.iter().flatten().all(|b| b.value() <= tolerance);
        self.is_bounded() && near && self.twist.angle().value() <= limit
    }
}

fn found_of(candidate: &Candidate, limit: f64, control: &Control) -> Found {
    let Candidate { built, rails, .. } = candidate;
    let strip = &built.strip;
    let off = [0, 1].map(|side: usize| rails[side].map(|r| rail_bound(strip, side, r, &built.rails[side], control)));
    let (u0, u1) = strip.domain();
    let at: Vec<f64> = (0..=STATIONS).map(|k| u0 + (u1 - u0) * k as f64 / STATIONS as f64).collect();
    // Cones have no twist: what would be measured is rounding.
    let fan = strip.is_point(0) || strip.is_point(1);
    let twists: Vec<f64> = at.iter().map(|&u| if fan { 0.0 } else { strip.twist(u) }).collect();
    let twist = twists.iter().copied().fold(0.0, f64::max);
    let (tightest, clearance) = match fan {
        true => (0.5 * (u0 + u1), f64::INFINITY),
        false => at
            .iter()
            .map(|&u| (u, strip.regression_clearance(u)))
            .fold((0.5 * (u0 + u1), f64::INFINITY), |least, now| if now.1 < least.1 { now } else { least }),
    };
    // Where samples exceed the limit, a bound twice as large says as much, for far less work; where rulings meet the
    // regression curve there is none.
    let twist = match clearance > 0.0 {
        true => twist_bound(strip, limit.max(2.0 * twist), control),
        false => TwistBound::UNKNOWN,
    };
    Found { off, twist, at, twists, clearance, tightest }
}

/// What is found of strips; `limit` (rad) is the twist that counts as developable. Each strip for itself, on all cores;
/// what a control stops is not proven.
pub(crate) fn findings(strips: &[Candidate], limit: f64, control: &Control) -> Vec<Found> {
    parallel::map(strips.iter(), |s| found_of(s, limit, control))
}

/// Judges strips; `sides` say what the distances from their rails are called, `limit` (rad) is the twist that counts as
/// developable. The proof has its own clock: what was found is judged even when time is up.
pub fn assess(strips: &[Candidate], sides: [What; 2], limit: f64) -> Assessment {
    let found = findings(strips, limit, &Control::default());
    summed(&strips.iter().zip(&found).map(|(s, f)| (*s, f)).collect::<Vec<_>>(), sides, limit)
}

/// Measured twist for colours; one value for a plane between straight rails, which is two triangles in every picture.
fn field(strip: &Strip, found: &Found) -> PanelField {
    let plain = strip.kind == PanelKind::Plane && strip.patch.knots_u.control_count() == 2;
    let (u, twists) = match (plain, &found.at[..]) {
        (true, [first, .., last]) => (vec![*first, *last], vec![found.twists.iter().copied().fold(0.0, f64::max); 2]),
        _ => (found.at.clone(), found.twists.clone()),
    };
    PanelField { u, v: vec![0.0, 1.0], values: twists.iter().flat_map(|t| [t.to_degrees(); 2]).collect() }
}

/// Sums up what was found of strips: see [`assess`].
pub(crate) fn summed(strips: &[(Candidate, &Found)], sides: [What; 2], limit: f64) -> Assessment {
    let mut off: [Vec<UpperBound>; 2] = Default::default();
    let mut twists_shown = Vec::new();
    let mut out = Assessment {
        off: [UpperBound::UNKNOWN; 2],
        twist: UpperBound::UNKNOWN,
        measured: 0.0,
        clearance: f64::INFINITY,
        claims: Vec::new(),
        fields: Vec::new(),
        meaning: FieldMeaning::default(),
        counts: [strips.len(), 0],
        missing: Vec::new(),
        limit,
        farthest: [None, None],
        most_twisted: None,
    };
    let mut largest = [f64::NEG_INFINITY; 2];
    for (Candidate { index, built, .. }, found) in strips {
        let strip = &built.strip;
        let subject = Subject::Panel(*index);
        // The curves themselves, and not a fit to them, if their parameters are linear.
        out.counts[1] += usize::from(built.rails.iter().all(|r| r.parameter.knots.degree() == 1));
        let twist = found.twists.iter().copied().fold(0.0, f64::max);
        let shown = found.twist.angle();
        twists_shown.push(shown);
        if twist > out.measured {
            out.most_twisted = witness(strip, found.most_twisted(), 0.5);
        }
        out.measured = out.measured.max(twist);
        out.clearance = out.clearance.min(found.clearance);
        if found.clearance <= 0.0 {
            let at = strip.patch.point(found.tightest, 0.5);
            out.missing.push(StripReason::Regression { strip: strip.name.clone(), at }.into());
        } else if !found.twist.is_regular() {
            let at = strip.patch.point(found.tightest, 0.5);
            out.missing.push(StripReason::MayRegress { strip: strip.name.clone(), at }.into());
        }
        for side in 0..2 {
            let Some(bound) = found.off[side] else { continue };
            off[side].push(bound);
            if bound.value() > largest[side] {
                largest[side] = bound.value();
                let (from, to) = strip.domain();
                out.farthest[side] = witness(strip, 0.5 * (from + to), side as f64);
            }
            out.claims.push(Claim::at_most(sides[side], subject, bound));
        }
        out.claims.extend([
            Claim::at_most(What::Twist, subject, shown.degrees()),
            Claim::measured(What::Twist, subject, twist.to_degrees()),
            Claim::measured(What::RegressionClearance, subject, found.clearance),
            Claim::measured(What::Area, subject, strip.area_estimate() * SQUARE_METRES),
        ]);
        out.fields.push(field(strip, found));
    }
    out.off = off.map(UpperBound::largest);
    out.twist = UpperBound::largest(twists_shown);
    let top = out.fields.iter().flat_map(|f| &f.values).fold(limit.to_degrees(), |m: f64, x| m.max(*x));
    out.meaning = FieldMeaning { name: "twist".into(), unit: "°".into(), limit: top };
    out
}
