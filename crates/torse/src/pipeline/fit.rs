//! From measured points to developable strips: estimate, segment, fit, prove, develop.

use crate::answer::note::{FitNote, Note};
use crate::answer::skipped::Skipped;
use crate::answer::{Answer, Job, PointMap};
use crate::certify::claim::{Claim, Counted, Subject, What};
use crate::certify::points::PointCertificate;
use crate::control::Control;
use crate::develop::strip::StripOptions;
use crate::develop::view::Drawn;
use crate::draw::field::{means, FieldMeaning, PanelField, Sample};
use crate::fit::cloud::core;
use crate::fit::cloud::CloudError;
use crate::geom::cloud::Cloud;
use crate::geom::coarse::{is_tolerance, Coarse, Loose};
use crate::geom::Vec3;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::part::Part;
use crate::reason::{JobReason, Reason, Sort};
use crate::search::strips::cut::laid;
use crate::search::strips::regression;
use crate::search::strips::scan::{scanned, ScanOptions, Scanned, NEAR};
use crate::search::strips::scan_outline::{claims_of_ends, outlined, Ended, Followed};
use crate::torse::strip::Strip;
use crate::torse::zone::RegressionLimits;
pub use options::FitOptions;
use std::borrow::Cow;

mod options;
#[cfg(test)]
mod tests;

/// Fits developable strips to measured points.
///
/// *Input*: finite points in mm, at least 30, not in a line; no order, no normals needed. Of a coarse mesh (see
/// `fit::cloud::facets`) points between its corners guide the fit; judged are the corners, and a part of the
/// mesh without strip is an objection.
/// Points that no triangle of a mesh uses are left out, unless they are most of the points.
/// *Result*: certified if every point is proven to lie within the tolerance; otherwise the points that are not are
/// counted and the worst is named. Strips cover what was measured and are not joined to each other.
///
/// # Errors
/// See [`CloudError`].
///
/// # Example
/// ```
/// use torse::geom::{cloud::Cloud, Vec3};
/// let point = |k: i32| Vec3::new(f64::from(k % 20), f64::from(k / 20), 0.0);
/// let scan = Cloud { points: (0..400).map(point).collect(), ..Cloud::default() };
/// let answer = torse::fit(&scan, &torse::FitOptions::new(0.1, "sheet"), &torse::Control::default())?;
/// assert_eq!((answer.status(), answer.parts.len()), (torse::Status::Certified, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fit(cloud: &Cloud, options: &FitOptions, control: &Control) -> Result<Answer, CloudError> {
    let clock = std::time::Instant::now();
    let (used, unused) = cloud.used();
    let unused = FitNote::Unused { count: unused, kept: matches!(used, Cow::Borrowed(_)) };
    let cloud = used.as_ref();
    checked(cloud, options)?;
    // 1. Strips under the points, with their proof.
    let wanted = ScanOptions {
        tolerance: options.tolerance,
        places: options.places,
        max_strips: options.max_strips,
        limits: options.limits.clone(),
    };
    let Scanned { strips, certificate, skipped, noise, lonely, between, facets } = scanned(cloud, &wanted, control)?;
    // 2. Flat parts.
    control.report("developing", 0.9, String::new());
    let drawn = Drawn { bends: options.drawn.bends.of_job(options.tolerance), ..options.drawn };
    let flat = StripOptions { drawn, ..StripOptions::new(0.1 * options.tolerance) };
    let mut laid = laid(&strips, &Part::of_each(&strips), &flat, options.tolerance);
    // 3. Strips and patterns cut back to the border of the points or of the mesh, judged both ways.
    let followed = match &between {
        None => Followed::Points(&certificate, NEAR * options.tolerance),
        Some(between) => Followed::Facets(cloud, &facets, between.bulge_estimate),
    };
    let ended = match control.stopped() {
        // What was not tried is not said to have no border.
        true => Ended { whole: Vec::new(), ..Ended::whole(strips.clone()) },
        false => outlined(strips.clone(), &mut laid, followed, flat.side, options.tolerance, control),
    };
    let stretched = laid.refused();
    let own = between.is_some().then_some(&facets[..]);
    let ends = FitNote::Ends { outlines: ended.outlines, whole: ended.whole.clone(), mesh: between.is_some() };
    let mut notes = told(ends, &strips, unused, lonely);
    let whole = Subject::Whole;
    let worst = certificate.worst_bound();
    let mut claims = vec![
        Claim::count(Counted::Points, whole, cloud.points.len()),
        Claim::at_most(What::PointDistance, whole, worst).within(options.tolerance).because(too_far(
            &strips,
            &certificate,
            &cloud.points,
            options.tolerance,
            control,
        )),
        Claim::count(Counted::Beyond, whole, certificate.beyond(options.tolerance)),
    ];
    claims.push(laid.area());
    claims.extend(laid.lengths());
    claims.extend(stretched.into_iter().map(|reason| Claim::objection(whole, reason)));
    match between {
        None => claims.push(Claim::measured(What::Noise, whole, noise)),
        Some(between) => {
            let (corners, triangles) = (cloud.points.len(), cloud.triangles.len());
            notes.push(Note::Fit(FitNote::CoarseMesh { corners, triangles, between }));
            claims.extend(between.bare.map(|(share, at)| Claim::objection(whole, JobReason::Bare(share, at))));
        }
    }
    let broken = regression::broken(&strips, options.limits.as_ref());
    notes.extend(options.limits.iter().cloned().map(Note::Limits));
    notes.extend(broken.iter().cloned().map(Note::Broken));
    if worst.value() <= options.tolerance {
        claims.extend(broken.iter().map(|b| Claim::objection(whole, b)));
    }
    claims.extend(claims_of_ends(&ended, cloud, &certificate, own, options.tolerance, control));
    claims.extend(claims_of_strips(&strips, &certificate, options.tolerance));
    Ok(Answer {
        claims,
        fields: fields(&strips, &certificate, options.tolerance),
        patchwork: Patchwork { panels: ended.panels, ..Patchwork::default() },
        points: PointMap {
            places: cloud.points.clone(),
            values: certificate.signed_estimates().to_vec(),
            worst: certificate.worst(),
        },
        meaning: FieldMeaning { name: "deviation".into(), unit: "mm".into(), limit: options.tolerance },
        notes,
        skipped: skipped.into_iter().map(Skipped::from).collect(),
        seconds: clock.elapsed().as_secs_f64(),
        ..Answer::of_flat(Job::Fit, &options.input, options.tolerance, laid)
    })
}

/// Notes on outlines, on several strips, and on points that are left out or lie apart.
fn told(ends: FitNote, strips: &[Strip], unused: FitNote, lonely: usize) -> Vec<Note> {
    let ends = Some(ends).filter(|e| !matches!(e, FitNote::Ends { outlines: None, whole, .. } if whole.is_empty()));
    let mut notes: Vec<Note> = ends.into_iter().map(Note::Fit).collect();
    notes.extend((strips.len() > 1).then_some(Note::Unjoined));
    notes.extend((!matches!(unused, FitNote::Unused { count: 0, .. })).then_some(Note::Fit(unused)));
    notes.extend((lonely > 0).then_some(Note::Fit(FitNote::Lonely { count: lonely })));
    notes
}

/// Refuses options that cannot be kept, and a tolerance that does not suit the points.
fn checked(cloud: &Cloud, options: &FitOptions) -> Result<(), CloudError> {
    if !is_tolerance(options.tolerance) {
        return Err(CloudError::Tolerance(options.tolerance));
    }
    options.limits.as_ref().map_or(Ok(()), RegressionLimits::check)?;
    // A few points that lie far away do not count.
    let extent = core(&cloud.points);
    if let Some(fault) = Coarse::of(extent.min.amax().max(extent.max.amax()), options.tolerance) {
        return Err(fault.into());
    }
    Ok(Loose::check(extent.diagonal(), options.tolerance)?)
}

/// What is the matter if points are not shown to lie within the tolerance.
fn too_far(
    strips: &[Strip],
    c: &PointCertificate,
    points: &[Vec3],
    tolerance: f64,
    control: &Control,
) -> Option<Reason> {
    let sort = Sort::Points;
    let reason = match c.worst().and_then(|i| Some((i, points.get(i)?))) {
        _ if strips.is_empty() => JobReason::Unfollowed(sort),
        _ if control.stopped() => JobReason::NotAllJudged(sort),
        found => {
            let (worst, at) = found?;
            let (beyond, all, away) = (c.beyond(tolerance), points.len(), c.worst_bound().value());
            JobReason::Beyond { sort, beyond, all, tolerance, worst, at: *at, away }
        }
    };
    Some(reason.into())
}

/// Points farther than this many tolerances belong to no strip and are counted for the whole only.
const OF_A_STRIP: f64 = 10.0;

fn claims_of_strips(strips: &[Strip], c: &PointCertificate, tolerance: f64) -> Vec<Claim> {
    let within = OF_A_STRIP * tolerance;
    let mut count = vec![0usize; strips.len()];
    let mut sum = vec![0.0_f64; strips.len()];
    for ((k, _, _), b) in c.places().iter().zip(c.bounds()) {
        let k = *k as usize;
        if k < strips.len() && *b <= within {
            count[k] += 1;
            sum[k] += b * b;
        }
    }
    strips
        .iter()
        .enumerate()
        .flat_map(|(k, strip)| {
            let subject = Subject::Panel(k);
            let mean = (sum[k] / count[k].max(1) as f64).sqrt();
            [
                Claim::count(Counted::Points, subject, count[k]),
                Claim::at_most(What::PointDistance, subject, c.worst_bound_on(k, within)),
                Claim::measured(What::MeanPointDistance, subject, mean),
                regression::claim(k, strip),
            ]
        })
        .collect()
}

/// Mean signed distance of the points around places of the strips. Points far beyond the tolerance do not belong to the
/// strip and do not count here; the map of points shows them.
fn fields(strips: &[Strip], c: &PointCertificate, tolerance: f64) -> Vec<PanelField> {
    let near = |d: &f64| !d.is_nan() && d.abs() <= OF_A_STRIP * tolerance;
    let sample = |((strip, u, v), value): (&(u32, f32, f32), &f64)| {
        near(value).then_some(Sample { strip: *strip as usize, u: f64::from(*u), v: f64::from(*v), value: *value })
    };
    means(strips, c.places().iter().zip(c.signed_estimates()).filter_map(sample))
}
