//! Words and units of claims and notes, the same in every file and on the terminal.

pub(crate) mod note;
pub(in crate::io) mod numbers;
pub(crate) mod reason;

use crate::answer::{Answer, Job};
use crate::certify::claim::{Claim, Counted, Demand, Evidence, NetNumber, Status, Subject, Unit, What};
use crate::reason::{Item, Reason};
pub use note::{note, notes};
pub use reason::{left_out, why};
use std::collections::HashSet;

/// Reasons that are told one after the other; more are counted.
const TOLD: usize = 4;

/// What a claim is about, in lower case; `curves` are the names of the given curves.
pub(crate) fn name(claim: &Claim, curves: &[String]) -> String {
    let curve = |k: usize| curves.get(k).map_or_else(|| format!("curve {}", k + 1), Clone::clone);
    let proven = claim.evidence() == Evidence::Proven;
    match claim.what() {
        What::Deviation => "distance between panels and the surface they cover, both ways".into(),
        What::FromCurve(k) => format!("from {}", curve(k)),
        What::FromSide(0) => "from first curve".into(),
        What::FromSide(_) => "from second curve".into(),
        What::FromCurves => "from the curves".into(),
        What::PointDistance => "largest distance of a point from the uncut strips".into(),
        What::MeanPointDistance => "root mean square distance".into(),
        What::ElementDistance => "largest distance".into(),
        What::ElementAngle => "largest angle between given and fitted tangent planes".into(),
        What::BeyondRulings => "distance of the strips as they are cut from what lies between the given rulings".into(),
        What::EndDistance => "distance of the ends of given rulings from the strips as they are cut".into(),
        What::CentreDistance => "largest distance of the places x, y, z of planes from the strips".into(),
        What::FaceDistance => "distance between the strips as they are cut and the given faces, both ways".into(),
        What::RulingGap => "largest distance between neighbouring rulings".into(),
        What::FromTaken => "distance of the strips from those taken over, both ways".into(),
        What::CurvesMoved => "distance of the curves from those given".into(),
        What::TargetDistance(k) => format!("from target {k}"),
        What::JoinGap(k) => format!("gap of join {k}"),
        What::JoinAngle(k) => format!("angle along join {k}"),
        What::FoldGap(k) => format!("distance of both sides of fold {k} laid flat"),
        What::SeamGap => "seam gap".into(),
        What::MapSurfaceDistance => {
            "distance of faces and their edges from the planes, cylinders and cones laid flat".into()
        }
        What::JointGap => "gap of joints inside flat parts".into(),
        What::Twist if proven => "twist, bound".into(),
        What::Twist => "twist".into(),
        What::RegressionClearance if proven => "distance to the regression curve".into(),
        What::RegressionClearance => "regression clearance".into(),
        What::RegressionMargin => "distance to the regression curve in lengths of the ruling".into(),
        What::BendRadius => "bend radius".into(),
        What::InsideRadius => "least inside radius of the sheet".into(),
        What::DiagonalGap => "distance of diagonals".into(),
        What::PointsMoved => "points moved before refinement".into(),
        What::GivenDistance => "distance of the given points from the strip".into(),
        What::BendBefore => "bend before".into(),
        What::LargestBend => "largest bend".into(),
        What::Kink => "largest kink at seams".into(),
        What::LongestRuling => "longest ruling".into(),
        What::Noise => "noise of the measurement".into(),
        What::JointMismatch => "mismatch at joints".into(),
        What::TrimDistance => "distance of trims from the file's edges".into(),
        What::BeyondOutline => "distance of points from the strips as they are cut".into(),
        What::FromMeasured => "distance of the strips from what was measured".into(),
        What::EdgeDistance => "distance of trimmed edges from the exact surfaces".into(),
        What::OutlineDistance => "distance of trimmed edges from the outline carried over".into(),
        What::Turn => "turn about the axis".into(),
        What::FirstRuling => "first ruling".into(),
        What::LastRuling => "last ruling".into(),
        What::EndRulingError => "angle off the end rulings".into(),
        What::NetShape(NetNumber::MStar) => "M*".into(),
        What::NetShape(NetNumber::LambdaStar) => "Λ*".into(),
        What::NetShape(NetNumber::M) => "m".into(),
        What::NetShape(NetNumber::Kappa) => "κ".into(),
        What::UsedOf(k) => format!("used of {}", curve(k)),
        What::Coverage => "covered".into(),
        What::Area => "area".into(),
        What::FlatArea => "flat area".into(),
        What::LengthError => "length error of patterns".into(),
        What::RefoldDistance => "distance between the part bent back and its panels, both ways".into(),
        What::DrawingDistance => "distance of the drawing from the flat panel".into(),
        What::WrittenDistance => "distance of the written file from what was judged".into(),
        What::Count(counted) => counted_name(counted).into(),
        What::LeftOut | What::Objection | What::InPart => said(claim).unwrap_or_default(),
    }
}

fn counted_name(counted: Counted) -> &'static str {
    match counted {
        Counted::Panels => "panels",
        Counted::Strips => "strips",
        Counted::ExactStrips => "strips between the curves themselves",
        Counted::FittedStrips => "strips with fitted edges",
        Counted::Surfaces => "surfaces",
        Counted::Cones => "cones",
        Counted::Cylinders => "cylinders",
        Counted::Planes | Counted::TangentPlanes => "planes",
        Counted::Points => "points",
        Counted::Rulings => "rulings",
        Counted::Elements => "elements",
        Counted::Beyond => "beyond the tolerance",
        Counted::Outliers => "left out as outliers",
        Counted::Quadrilaterals => "quadrilaterals",
        Counted::Degree => "degree along",
        Counted::ControlPoints => "control points along",
        Counted::Solutions => "regular polynomial solutions",
    }
}

/// A name for programs, the same in every report.
pub fn id(what: What) -> &'static str {
    match what {
        What::Deviation => "deviation",
        What::FromCurve(_) => "from_curve",
        What::FromSide(_) => "from_side",
        What::FromCurves => "from_curves",
        What::PointDistance => "point_distance",
        What::MeanPointDistance => "mean_point_distance",
        What::ElementDistance => "element_distance",
        What::ElementAngle => "element_angle",
        What::BeyondRulings => "beyond_rulings",
        What::EndDistance => "end_distance",
        What::CentreDistance => "centre_distance",
        What::FaceDistance => "face_distance",
        What::RulingGap => "ruling_gap",
        What::FromTaken => "from_taken",
        What::CurvesMoved => "curves_moved",
        What::TargetDistance(_) => "target_distance",
        What::JoinGap(_) => "join_gap",
        What::JoinAngle(_) => "join_angle",
        What::FoldGap(_) => "fold_gap",
        What::SeamGap => "seam_gap",
        What::MapSurfaceDistance => "carrier_distance",
        What::JointGap => "joint_gap",
        What::Twist => "twist",
        What::RegressionClearance => "regression_clearance",
        What::RegressionMargin => "regression_margin",
        What::BendRadius => "bend_radius",
        What::InsideRadius => "inside_radius",
        What::DiagonalGap => "diagonal_gap",
        What::PointsMoved => "points_moved",
        What::GivenDistance => "given_distance",
        What::BendBefore => "bend_before",
        What::LargestBend => "largest_bend",
        What::Kink => "kink",
        What::LongestRuling => "longest_ruling",
        What::Noise => "noise",
        What::JointMismatch => "joint_mismatch",
        What::TrimDistance => "trim_distance",
        What::BeyondOutline => "beyond_outline",
        What::FromMeasured => "from_measured",
        What::EdgeDistance => "edge_distance",
        What::OutlineDistance => "outline_distance",
        What::Turn => "turn",
        What::FirstRuling => "first_ruling",
        What::LastRuling => "last_ruling",
        What::EndRulingError => "end_ruling_error",
        What::NetShape(NetNumber::MStar) => "m_star",
        What::NetShape(NetNumber::LambdaStar) => "lambda_star",
        What::NetShape(NetNumber::M) => "m",
        What::NetShape(NetNumber::Kappa) => "kappa",
        What::UsedOf(_) => "used_of_curve",
        What::Coverage => "covered",
        What::Area => "area",
        What::FlatArea => "flat_area",
        What::LengthError => "length_error",
        What::RefoldDistance => "refold_distance",
        What::DrawingDistance => "drawing_distance",
        What::WrittenDistance => "written_distance",
        What::Count(counted) => counted_id(counted),
        What::LeftOut => "left_out",
        What::Objection => "objection",
        What::InPart => "in_part",
    }
}

fn counted_id(counted: Counted) -> &'static str {
    match counted {
        Counted::Panels => "panels",
        Counted::Strips => "strips",
        Counted::ExactStrips => "exact_strips",
        Counted::FittedStrips => "fitted_strips",
        Counted::Surfaces => "surfaces",
        Counted::Cones => "cones",
        Counted::Cylinders => "cylinders",
        Counted::Planes => "planes",
        Counted::TangentPlanes => "tangent_planes",
        Counted::Points => "points",
        Counted::Rulings => "rulings",
        Counted::Elements => "elements",
        Counted::Beyond => "beyond",
        Counted::Outliers => "outliers",
        Counted::Quadrilaterals => "quadrilaterals",
        Counted::Degree => "degree",
        Counted::ControlPoints => "control_points",
        Counted::Solutions => "solutions",
    }
}

/// How a job ended, for programs.
pub(crate) fn status(status: Status) -> &'static str {
    match status {
        Status::Certified => "certified",
        Status::Uncertified => "uncertified",
    }
}

/// The unit of what is claimed; empty for plain numbers.
pub(crate) fn unit(what: What) -> &'static str {
    match what.unit() {
        Unit::Millimetre => "mm",
        Unit::Degree => "°",
        Unit::Radian => "rad",
        Unit::Percent => "%",
        Unit::SquareMetre => "m²",
        Unit::One => "",
    }
}

/// The claims of the whole with their names, for a few lines: of several joins, the worst in every respect stand for all; of
/// seams, nothing where there are none.
pub fn whole(answer: &Answer) -> Vec<(&Claim, String)> {
    let curves: Vec<String> = answer.guides.iter().map(|g| g.name.clone()).collect();
    let seamless = answer.patchwork.seam_count + answer.patchwork.joint_count == 0;
    let empty = |c: &&Claim| seamless && c.what() == What::SeamGap && c.value() == 0.0;
    let all: Vec<&Claim> = answer.claims_of(Subject::Whole).filter(|c| !empty(c)).collect();
    let group = |c: &Claim| join_group(id(c.what()), c.demand() != Demand::None);
    let mut out: Vec<(&Claim, String)> = Vec::new();
    let mut told = HashSet::new();
    for c in &all {
        let Some(words) = group(c) else {
            out.push((c, name(c, &curves)));
            continue;
        };
        let like: Vec<&Claim> = all.iter().copied().filter(|o| group(o) == Some(words)).collect();
        let worst = like.iter().max_by(|a, b| a.value().total_cmp(&b.value()));
        if let (true, Some(worst)) = (told.insert(words), worst) {
            out.push((worst, joins_name(words, like.len(), &name(worst, &curves))));
        }
    }
    out
}

/// Of what several joins have a largest one, by the name of a figure for programs, and whether something is asked of it; `None`
/// for other figures.
pub(crate) fn join_group(what: &str, asked: bool) -> Option<&'static str> {
    match (what, asked) {
        ("join_gap", _) => Some("gap"),
        ("join_angle", true) => Some("angle of smooth joins"),
        ("join_angle", false) => Some("angle of joins that need not be smooth"),
        _ => None,
    }
}

/// The name of the largest of so many figures of joins, and of the only one.
pub(crate) fn joins_name(group: &str, count: usize, only: &str) -> String {
    if count == 1 {
        only.to_owned()
    } else {
        format!("largest {group}, {count} joins")
    }
}

/// What a claim says, with its unit, bounds rounded to the safe side: "unknown" where nothing is known, "none" of what does not
/// exist.
pub fn value(c: &Claim) -> String {
    let x = c.value();
    match c.what() {
        _ if c.is_unknown() => return "unknown".into(),
        // Of planes, or of cylinders.
        What::RegressionClearance | What::BendRadius if numbers::is_endless(x) => return "none".into(),
        _ if x.is_infinite() => return "unknown".into(),
        What::Coverage => return numbers::percent_least(x),
        _ => {}
    }
    match unit(c.what()) {
        "" => digits(c),
        unit => format!("{} {unit}", digits(c)),
    }
}

/// The digits of what a claim says.
fn digits(c: &Claim) -> String {
    let x = c.value();
    match c.evidence() {
        Evidence::Proven if c.is_lower_bound() => numbers::number_least(x),
        Evidence::Proven => numbers::number_bound(x),
        Evidence::Measured => numbers::number(x),
        Evidence::Given => numbers::plain(x, GIVEN_DIGITS),
    }
}

/// Digits of what is counted or given.
const GIVEN_DIGITS: usize = 9;

/// How a value is known, in one word.
pub fn evidence(evidence: Evidence) -> &'static str {
    match evidence {
        Evidence::Proven => "proven",
        Evidence::Measured => "measured",
        Evidence::Given => "given",
    }
}

/// All that stands against a status, once each: what broken claims have to say; empty if none is broken.
pub(crate) fn objections(claims: &[Claim], curves: &[String]) -> Vec<String> {
    let mut seen = HashSet::new();
    let mut out: Vec<String> = against(claims).map(|c| said(c).unwrap_or_else(|| beyond(c, curves))).collect();
    out.retain(|r| seen.insert(r.clone()));
    out
}

/// The broken claims, without those of panels of which the whole says the same by name.
fn against(claims: &[Claim]) -> impl Iterator<Item = &Claim> + Clone {
    let broken = claims.iter().filter(|c| c.is_broken());
    let named: HashSet<String> = broken
        .clone()
        .filter_map(|c| match c.reason() {
            Some(Reason::Of(Item::Panel(_), reason)) => Some(why(reason)),
            _ => None,
        })
        .collect();
    let told = move |c: &Claim| {
        matches!(c.subject(), Subject::Panel(_))
            && !named.is_empty()
            && said(c).is_some_and(|words| named.contains(&words))
    };
    broken.filter(move |c| !told(c))
}

/// Those [`objections`] that no panel says of itself: neither those about a panel nor those that name one.
pub(crate) fn objections_beside_panels(claims: &[Claim], curves: &[String]) -> Vec<String> {
    let names_a_panel = |c: &Claim| matches!(c.reason(), Some(Reason::Of(Item::Panel(_), _)));
    let beside = |c: &&Claim| !matches!(c.subject(), Subject::Panel(_)) && !names_a_panel(c);
    let left: Vec<Claim> = claims.iter().filter(beside).cloned().collect();
    objections(&left, curves)
}

/// Why a result is not certified: what broken claims have to say; empty if none is broken.
pub fn reason(claims: &[Claim], curves: &[String]) -> String {
    let broken = against(claims);
    let all: Vec<String> = broken.clone().filter_map(said).collect();
    match all.is_empty() {
        true => broken.clone().next().map(|c| beyond(c, curves)).unwrap_or_default(),
        false => told(all),
    }
}

/// What a claim says of itself where it is broken.
fn said(claim: &Claim) -> Option<String> {
    claim.reason().map(why)
}

/// Sentences one after the other, once each; those beyond [`TOLD`] are counted.
fn told(mut all: Vec<String>) -> String {
    let mut seen = HashSet::new();
    all.retain(|r| seen.insert(r.clone()));
    let rest = all.len().saturating_sub(TOLD);
    let mut out = all[..all.len() - rest].join("; ");
    if rest > 0 {
        out += &format!("; and {rest} more");
    }
    out
}

/// A claim whose demand is not kept, in words.
fn beyond(claim: &Claim, curves: &[String]) -> String {
    let unit = match unit(claim.what()) {
        "" => String::new(),
        unit => format!(" {unit}"),
    };
    let name = name(claim, curves);
    let asked = |limit: f64| numbers::plain(limit, GIVEN_DIGITS);
    let around = claim.witness().map_or_else(String::new, |p| format!(", around {}", numbers::place(&p)));
    let told = match claim.demand() {
        _ if claim.evidence() == Evidence::Measured => format!("{name}: only measured, not proven"),
        Demand::AtMost(limit) if claim.value().is_finite() => {
            format!("{name}: {}{unit} where {}{unit} are allowed", digits(claim), asked(limit))
        }
        Demand::AtLeast(limit) if claim.value().is_finite() => {
            format!("{name}: {}{unit} where {}{unit} are wanted", digits(claim), asked(limit))
        }
        _ => format!("{name}: no bound could be shown"),
    };
    told + &around
}

/// So many things of one sort.
pub(crate) fn counted(n: usize, word: &str) -> String {
    format!("{n} {word}{}", if n == 1 { "" } else { "s" })
}

/// What a job made, and how much was left out.
pub fn made(answer: &Answer) -> String {
    let panels = answer.patchwork.panels.len();
    let number = |of: Counted| answer.claim(What::Count(of)).map_or(0, |c| c.value() as usize);
    let parts = || counted(answer.parts.len(), "flat part");
    let what = match answer.job {
        Job::Approximate => {
            format!("{} for {}", counted(panels, "panel"), counted(answer.patchwork.faces.len(), "face"))
        }
        Job::Cones => format!(
            "{}, {} and {} for {}",
            counted(number(Counted::Cones), "cone"),
            counted(number(Counted::Cylinders), "cylinder"),
            counted(number(Counted::Planes), "plane"),
            counted(number(Counted::Surfaces), "surface")
        ),
        Job::Fit => {
            let sorts = [(Counted::Points, "point"), (Counted::Rulings, "ruling"), (Counted::TangentPlanes, "plane")];
            let given =
                sorts.iter().find_map(|(of, word)| Some(counted(number(*of), word)).filter(|_| number(*of) > 0));
            format!("{} for {}", counted(panels, "strip"), given.unwrap_or_else(|| "nothing".into()))
        }
        Job::Planarise => format!("{} in {}", counted(panels, "quadrilateral"), parts()),
        Job::Ruled => {
            format!("{} for {}", counted(panels, "ruled strip"), counted(answer.patchwork.faces.len(), "piece"))
        }
        Job::Unroll => {
            format!(
                "{} of {}",
                counted(answer.patterns.len(), "flat part"),
                counted(answer.patchwork.faces.len(), "face")
            )
        }
        Job::Shape => {
            format!("{} in {}", counted(panels, "strip"), counted(answer.patterns.len(), "flat part"))
        }
        Job::Hull | Job::Loft | Job::Net => format!("{} in {}", counted(panels, "strip"), parts()),
    };
    match answer.skipped.len() {
        0 => what,
        n => format!("{what}, {n} left out"),
    }
}

/// The panels of a job in its own word, for headings: "panel" or "strip".
pub(crate) fn thing(job: Job) -> &'static str {
    match job {
        Job::Approximate => "panel",
        Job::Planarise => "quadrilateral",
        Job::Cones => "piece",
        Job::Unroll => "face",
        Job::Fit | Job::Hull | Job::Loft | Job::Net | Job::Ruled | Job::Shape => "strip",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certify::claim::Subject;
    use crate::reason::Reason;

    #[test]
    fn reasons_are_told_once_and_counted_when_there_are_many() {
        let mut claims: Vec<Claim> =
            (0..6).map(|k| Claim::objection(Subject::Panel(k), Reason::Input(format!("reason {k}")))).collect();
        claims.push(Claim::objection(Subject::Whole, Reason::Input("reason 0".into())));
        let text = reason(&claims, &[]);
        assert!(text.starts_with("reason 0; reason 1") && text.ends_with("and 2 more"), "{text}");
        assert_eq!(text.matches("reason 0").count(), 1);
        assert_eq!(reason(&[], &[]), "");
    }

    #[test]
    fn what_the_whole_says_of_a_panel_by_name_is_not_repeated() {
        let far = || Reason::Input("the face is 2 mm away".into());
        let named = Claim::objection(Subject::Whole, Reason::of(Item::Panel("A-01".into()), far()));
        let own = Claim::objection(Subject::Panel(0), far());
        let other = Claim::objection(Subject::Panel(1), Reason::Input("it folds".into()));
        let all = [named, own.clone(), other];
        assert_eq!(reason(&all, &[]), "panel A-01: the face is 2 mm away; it folds");
        assert_eq!(objections(&all, &[]), ["panel A-01: the face is 2 mm away", "it folds"]);
        assert_eq!(reason(&[own], &[]), "the face is 2 mm away");
    }

    #[test]
    fn what_hardly_bends_does_not_bend() {
        let radius = |x: f64| value(&Claim::measured(What::BendRadius, Subject::Whole, x));
        assert_eq!(
            (radius(f64::INFINITY), radius(4.676e155), radius(1250.0)),
            ("none".into(), "none".into(), "1250 mm".into())
        );
    }

    #[test]
    fn a_broken_demand_without_words_is_told_by_its_numbers() {
        let measured = Claim::measured(What::FromCurve(0), Subject::Whole, 0.5).within(1.0);
        assert_eq!(reason(&[measured], &["low.csv".into()]), "from low.csv: only measured, not proven");
        let given = Claim::count(Counted::Beyond, Subject::Whole, 3).within(0.0);
        assert_eq!(reason(&[given], &[]), "beyond the tolerance: 3 where 0 are allowed");
        // What is counted keeps its digits.
        let many = Claim::count(Counted::Beyond, Subject::Whole, 12_345).within(0.5);
        assert_eq!(reason(&[many], &[]), "beyond the tolerance: 12345 where 0.5 are allowed");
    }
}
