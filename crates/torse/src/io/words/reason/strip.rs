//! Why strips and jobs are not what was asked for, in words.

use super::items::{many, name, one};
use super::proof;
use crate::geom::unit::LengthUnit;
use crate::geom::Vec3;
use crate::io::words::numbers::{angle, angle_bound, length, length_bound, number, percent, percent_least, place};
use crate::io::words::told;
use crate::reason::{Covered, Curves, JobReason, Reason, Sort, Stalled, StripReason, Witness};

#[expect(clippy::too_many_lines, reason = "one sentence after another")]
pub(super) fn words(reason: &StripReason, why: fn(&Reason) -> String) -> String {
    match reason {
        StripReason::None => "no strip could be made".into(),
        StripReason::Unbounded => "nothing bounds its distance from the curves or its twist; not written".into(),
        StripReason::MoreUnbounded(count) => format!("{count} more strips: nothing bounds them either"),
        StripReason::NotWritten(1) => "1 strip has no proof and is not written".into(),
        StripReason::NotWritten(count) => format!("{count} strips have no proof and are not written"),
        StripReason::NotTheHull { by, at } => format!(
            "the strips are not the whole convex hull: near ({:.1}, {:.1}, {:.1}) mm both are {by:.3} mm apart; with more points per \
             curve, or curves in shorter pieces, more of it may be found",
            at.x, at.y, at.z
        ),
        StripReason::NoHull => "the hull has no developable strips between smooth curves".into(),
        StripReason::TooMany(count) => {
            format!("{count} strips were found, too many to be laid flat and written after a stop")
        }
        StripReason::Stray { by, from: Curves::All, most } => {
            format!("the strips stray up to {} from the curves{}", length_bound(*by), worst(most.as_ref()))
        }
        StripReason::Stray { by, from: Curves::Fixed, most } => {
            format!("the strips stray up to {} from fixed curves{}", length_bound(*by), worst(most.as_ref()))
        }
        StripReason::Stray { by, from: Curves::One(curve), most } => {
            format!("the strips stray up to {} from {curve}{}", length_bound(*by), worst(most.as_ref()))
        }
        StripReason::OffRail { by, rail, most } => format!(
            "the strips stray up to {} from {rail}{}; a tolerance of {} is met",
            length_bound(*by),
            worst(most.as_ref()),
            length(reached(*by))
        ),
        StripReason::InPart(rails) => {
            let told = rails.iter().map(|(rail, covered)| match covered {
                Covered::Share(share) => format!("{} of {rail}", percent_least(*share)),
                Covered::Past(past) => format!("{} past the ends of {rail}", length_bound(*past)),
            });
            format!("certified in part: {}", told.collect::<Vec<_>>().join(", "))
        }
        StripReason::Narrower { width, asked } => format!(
            "certified in part: a strip {} wide on its first ruling, where {} were asked for; wider, it would meet its \
             regression curve",
            length(*width),
            length(*asked)
        ),
        StripReason::Twist { measured, bound, limit, most } => format!(
            "twist up to {} (measured), proven bound {}, where {} count as developable{}",
            angle(*measured),
            angle_bound(*bound),
            angle(*limit),
            worst(most.as_ref())
        ),
        StripReason::Regression { strip, at } => {
            format!("strip {strip} has regression points between its rails, on the ruling through {}", place(at))
        }
        StripReason::MayRegress { strip, at } => {
            format!("strip {strip} was not shown to keep off its regression curve, nearest around {}", place(at))
        }
        StripReason::OutOfBounds { strip, at, proven } => out_of_bounds(strip, at, *proven),
        StripReason::Margin { strip, shown, asked } => format!(
            "strip {strip}: the regression curve is shown to keep off by {} lengths of the ruling, where {asked} are \
             asked for; give the curves more spans, hold less, make the strip narrower, or ask for less by \"margin\"",
            number(*shown)
        ),
        StripReason::NetRegression { strip, u, v, at } => format!(
            "strip {strip} meets its regression curve on ruling u = {u:.4} at {:.0} % of its length, at {}; choose other \
             parameters, or a shorter stretch",
            100.0 * v,
            place(at)
        ),
        StripReason::TangentRuling { strip, curve, u, at } => {
            format!("strip {strip} has a ruling tangent to {curve} at u = {u:.4}, at {}", place(at))
        }
        StripReason::Weight { strip, weight, index } => {
            format!("strip {strip} has weight {} at control point {index}", number(*weight))
        }
        StripReason::NotFollowed { tolerance, fixed_ends, smoothing, kept_off } => {
            not_followed(*tolerance, *fixed_ends, *smoothing, *kept_off)
        }
        StripReason::PointsAround { count, at, why: reason } => {
            format!("{count:.0} points around {}: {}", place(at), why(reason))
        }
        StripReason::Points(count, reason) => {
            let reason = reason.as_ref().map_or(String::new(), |r| format!(": {}", why(r)));
            format!("{count} points have no strip{reason}")
        }
        StripReason::NoStrip { kind, error } => format!("the {kind} found gives no strip ({})", why(error)),
        StripReason::Blank(error) => format!("its outline is not cut, it is a blank: {}", why(error)),
        StripReason::NoOutline(error) => format!("nothing is proven of its outline: {}", why(error)),
        StripReason::Vertex => "its edges run through its vertex".into(),
        StripReason::Nothing => "nothing was tried".into(),
        StripReason::NoCones => "it has no cone spline".into(),
        StripReason::NoProof => "it has no proof for its outline".into(),
        StripReason::Beyond(bound) => format!("not proven to stay within the tolerance (bound {})", length_bound(*bound)),
        StripReason::NotComplete => "it is not complete".into(),
        StripReason::PointOutside { within, worst } => {
            let worst = worst.map_or(String::new(), |(i, p)| format!(": point {i} at {}", place(&p)));
            format!("a point is not shown to lie within {} of what its outline leaves of it{worst}", length(*within))
        }
        StripReason::OutlineOutside { within, at } => {
            let around = at.map_or(String::new(), |p| format!(", around {}", place(&p)));
            format!("its outline is not shown to keep within {} of what is given{around}", length(*within))
        }
        StripReason::EndOutside { within, worst } => {
            let worst = worst.map_or(String::new(), |p| format!(": that at {}", place(&p)));
            format!("an end of a ruling is not shown to lie within {} of what its outline leaves of it{worst}", length(*within))
        }
        StripReason::FromFace { within, seen } => {
            let seen = seen.map_or(String::new(), |(far, p)| format!(", seen: {} at {}", length(far), place(&p)));
            format!("it and its face are not shown to lie within {} of each other{seen}", length(*within))
        }
        StripReason::Outline(fault, at) => {
            let at = at.map_or(String::new(), |p| format!(" at {}", place(&p)));
            format!("{}{at}", proof::of_loops(*fault))
        }
    }
}

/// Which strip is the worst, and where.
fn worst(most: Option<&Witness>) -> String {
    most.map_or(String::new(), |w| format!(", most by {} around {}", w.strip, place(&w.at)))
}

/// What is said of a regression curve that does not keep to what was asked.
pub(in crate::io::words) fn out_of_bounds(strip: &str, at: &Vec3, proven: bool) -> String {
    if proven {
        format!("the regression curve of {strip} is out of bounds at {}", place(at))
    } else {
        format!("it could not be shown that the regression curve of {strip} stays in bounds, around {}", place(at))
    }
}

fn not_followed(tolerance: f64, fixed_ends: bool, smoothing: Option<f64>, kept_off: Option<f64>) -> String {
    let mut out = format!("no developable strip follows them within {tolerance} mm");
    if fixed_ends {
        out += " and keeps the first and the last as they are";
    }
    if let Some(weight) = smoothing {
        out += &format!(", smoothed with the weight {weight}; a smaller one comes nearer");
    }
    let Some(nearest) = kept_off else { return out };
    let how = if nearest.is_finite() {
        format!("the nearest found is {} away", length(nearest))
    } else {
        "none was found that is".to_string()
    };
    out + &format!(
        " with its regression curve in bounds ({how}); raise the tolerance, or ask for less of the regression curve"
    )
}

/// The tolerance that a distance meets, rounded up to two digits.
fn reached(x: f64) -> f64 {
    if !(x > 0.0 && x.is_finite()) {
        return x;
    }
    let unit = 10f64.powf(x.log10().floor() - 1.0);
    (x / unit).ceil() * unit
}

#[expect(clippy::too_many_lines, reason = "one sentence after another")]
pub(super) fn of_job(reason: &JobReason, why: fn(&Reason) -> String) -> String {
    match reason {
        JobReason::EndedEarly(None) => "ended early".into(),
        JobReason::EndedEarly(Some(bound)) => {
            format!("ended early; the panels found so far are proven within {} only", length_bound(*bound))
        }
        JobReason::Stopped => "the job was stopped early".into(),
        JobReason::StoppedCones => "stopped before all surfaces were done".into(),
        JobReason::Levels(done, all) => format!("stopped after {done} of {all} levels"),
        JobReason::NotAllJudged(sort) => format!("stopped before all {} were judged", many(*sort)),
        JobReason::Unfollowed(Sort::Points) => "no developable strip follows the points within the tolerance".into(),
        JobReason::Unfollowed(sort) => format!("no developable strip follows the {}", many(*sort)),
        JobReason::Beyond { sort, beyond, all, tolerance, worst, at, away } => {
            let worst = match sort {
                Sort::Points => format!("point {worst} at"),
                _ => format!("number {worst} around"),
            };
            format!(
                "{beyond} of {all} {} are not within {tolerance} mm; the worst is {worst} {}, {} away",
                many(*sort),
                place(at),
                length(*away)
            )
        }
        JobReason::Outlier { sort, index, away } => format!(
            "{} {index}: the others agree on a surface without it, {} away; nothing is proven of it",
            one(*sort),
            length(*away)
        ),
        JobReason::Turned { index, angle: by, limit } => format!(
            "the tangent plane given with ruling {index} is up to {} from that of the strip, where {} are allowed; mend the \
             normals, or leave out nx, ny, nz: tangent planes are found from the rulings then",
            angle_bound(*by),
            angle(*limit)
        ),
        JobReason::Before { index, at, away } => format!(
            "the strips are up to {} from the place given with plane {index}, {}, while they pass by those of most planes: they \
             may end before it, or touch the plane elsewhere; a smaller tolerance, or planes that are closer together there, help",
            length(*away),
            place(at)
        ),
        JobReason::Bare(share, at) => format!(
            "{} of the places on the mesh have no strip near them, for example around {}",
            percent(*share),
            place(at)
        ),
        JobReason::Unmet { class, left, item } => format!(
            "{class} ask for more than there is: {} are left, most of it at {item}; hold less, or give the curves more \
             spans",
            length(*left)
        ),
        JobReason::Move { index, made, steps } => format!(
            "move {index} was made to step {made} of {steps}, the last shape that meets all conditions; make it in more \
             steps, move less far, or hold less"
        ),
        JobReason::Off(item, off) => {
            format!("{} is {} from what it should be; hold less, or move it in steps", name(item), length(*off))
        }
        JobReason::Backwards(item) => format!(
            "{}: the curve runs the other way there; turn the direction round, or begin with a curve that runs along it",
            name(item)
        ),
        JobReason::NothingAsked => {
            "nothing is asked of the ruled strips that could be proven: join them, or give a target".into()
        }
        JobReason::JoinGap { index, between: [a, b] } => {
            format!("join {index}, {a} and {b}: the gap is not shown to keep within the tolerance")
        }
        JobReason::JoinAngle { index, between: [a, b], seen, limit } => format!(
            "join {index}, {a} and {b}: they should go on smoothly, but meet at up to {} where {} count as none; give the \
             curves more spans, or ask for less",
            angle(*seen),
            angle(*limit)
        ),
        JobReason::Fold { index, between: [a, b], apart } => {
            let what = match apart.is_finite() {
                true => format!("laid flat, both sides of the fold are up to {} apart", length_bound(*apart)),
                false => "nothing is shown of how both sides of the fold lie in the plane".to_owned(),
            };
            format!(
                "join {index}, {a} and {b}: {what}, so they do not unfold to one sheet; begin with curves nearer to such a \
                 fold, give them more spans, or leave the fold out"
            )
        }
        JobReason::Target { index, file, apart, at, within, covered } => format!(
            "target {index}{}: {} apart at {}, where {within} mm are allowed; give the curves \
             more spans, take more or narrower strips, hold less, or allow more by \"within\"{}",
            file.as_ref().map_or(String::new(), |f| format!(" ({f})")),
            length(*apart),
            place(at),
            if *covered { "; if the target goes on beyond the strips, say \"covered\": false" } else { "" }
        ),
        JobReason::Crossing(ruling) => format!(
            "rulings {ruling} and {} (counted from 1) cross on the strip: regression point inside; give rulings that fan out \
             less there",
            ruling + 1
        ),
        JobReason::Moved(moved, most) => format!("points moved up to {} where {most} mm are allowed", length(*moved)),
        JobReason::Diagonals(gap, stalled) => {
            let stalled = match stalled {
                None => "",
                Some(Stalled::Rulings) => ": no displacement makes them plane; look for rulings that cross",
                Some(Stalled::Held) => ": the held points leave no room; hold fewer",
                Some(Stalled::Steps) => ": the steps are used up",
            };
            format!("diagonals up to {} apart{stalled}", length(*gap))
        }
        JobReason::Thickness { part, own, asked, unit } => format!(
            "part {part} is sheet of {}, not of {}: leave out --thickness",
            sheet(*own, *unit),
            sheet(*asked, *unit)
        ),
        JobReason::NoRoom { part, asked, unit } => {
            format!("part {part} bends so tightly that a sheet of {} has no room inside", sheet(*asked, *unit))
        }
        JobReason::NotNeutral { part } => {
            format!(
                "the flat pattern of part {part} is that of its surface, not of the neutral fibre of the sheet, which is no surface \
                 where faces run to a point; leave out --k to cut the surface as it is"
            )
        }
        JobReason::Panels(reasons) => {
            let told = told(reasons.iter().map(why).collect());
            format!("the panels are not certified: {told}")
        }
    }
}

/// A thickness, with the digits that a message needs.
fn sheet(mm: f64, unit: LengthUnit) -> String {
    let number = format!("{:.3}", unit.of(mm));
    format!("{} {}", number.trim_end_matches('0').trim_end_matches('.'), unit.sign())
}
