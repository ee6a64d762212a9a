//! From rulings, tangent planes or a developable face to strips of low degree: fit, prove, develop.

use super::approximate::left_face;
use crate::answer::note::{Became, FaceNote, FitNote, Note};
use crate::answer::skipped::{left_out, Skipped};
use crate::answer::{Answer, Job};
use crate::brep::face::Face;
use crate::certify::claim::{Claim, Counted, Subject, What};
use crate::certify::elements::{elements as certified, ElementCertificate};
use crate::control::Control;
use crate::develop::strip::StripOptions;
use crate::develop::view::Drawn;
use crate::draw::field::{FieldMeaning, PanelField};
use crate::fit::elements::extent::strip;
use crate::fit::elements::outliers::{outliers, MOST};
use crate::fit::elements::ruling_order::ordered;
use crate::fit::elements::sequence::{row, torses, RowOptions, RowPiece};
use crate::fit::planes::estimates::{
    planes_of_noisy_rulings, planes_of_rulings, planes_of_smooth_rulings, Ends, EstimateError,
};
use crate::geom::coarse::{Coarse, Loose};
use crate::geom::{BBox, Vec3};
use crate::io::words::note::beyond_limits;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::part::Part;
use crate::search::strips::cut::{cut, judged, lengths, refused};
use crate::search::strips::fewest::{fewest, simplest};
use crate::search::strips::regression;
use crate::search::strips::ruled_face::{is_simplest, no_simpler, reached, GivenFace, NARROW};
use crate::torse::contact::{orient, ContactElement, Given};
use crate::torse::strip::Strip;
use crate::torse::zone::RegressionLimits;

/// What the job is asked.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementFitOptions {
    /// Largest distance of a ruling, or of a plane over its region of interest, from the strips, mm.
    pub tolerance: f64,
    /// Name of the input, for files.
    pub input: String,
    /// Strips at most; 64.
    pub max_strips: usize,
    /// Rulings taken from each face; 160.
    pub rulings_of_face: usize,
    /// What is asked of regression curves; nothing beyond regular strips.
    pub limits: Option<RegressionLimits>,
    /// Whether the first and the last element of each strip are kept exactly; false.
    pub fix_ends: bool,
    /// Weight of bending against the data as a share; none: strips follow the data.
    pub smoothing: Option<f64>,
    /// Whether elements far from a surface that most of the others agree on are left out and named; false.
    pub robust: bool,
    /// How flat patterns are drawn; default seen from outside, lines every 5°.
    pub drawn: Drawn,
}

impl ElementFitOptions {
    /// The defaults with a tolerance in mm.
    pub fn new(tolerance: f64, input: &str) -> Self {
        Self {
            tolerance,
            input: input.into(),
            max_strips: 64,
            rulings_of_face: 160,
            limits: None,
            fix_ends: false,
            smoothing: None,
            robust: false,
            drawn: Drawn::default(),
        }
    }

    /// Options of the fits at a tolerance (mm) and a number of strips.
    fn fits(&self, tolerance: f64, max_pieces: usize, limits: Option<RegressionLimits>) -> RowOptions {
        let plain = RowOptions::new(tolerance);
        let smoothing = self.smoothing.unwrap_or(plain.smoothing);
        RowOptions { max_pieces, limits, smoothing, fix_ends: self.fix_ends, ..plain }
    }
}

/// Why there is no answer at all.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ElementFitError {
    /// A tolerance larger than the model.
    #[error(transparent)]
    Loose(#[from] Loose),
    /// A tolerance that is not positive.
    #[error("the tolerance {0} is not a positive length")]
    Tolerance(f64),
    /// Limits of the regression curve that cannot be kept by anything.
    #[error("{0}")]
    Limits(String),
    /// Too few elements.
    #[error("{0} {1}: at least {FEWEST} are needed")]
    Few(usize, &'static str),
    /// An element that cannot be used.
    #[error("plane {index} has a coordinate that is not finite, no normal, no region of interest, or a weight that is not positive")]
    Element {
        /// Its index.
        index: usize,
    },
    /// Two neighbours are the same.
    #[error("{what} {index} repeats the one before: remove it")]
    Repeated {
        /// Rulings or planes.
        what: &'static str,
        /// Index of the second one.
        index: usize,
    },
    /// Coordinates so large that their last digits are coarser than the tolerance.
    #[error(transparent)]
    Coarse(#[from] Coarse),
    /// Tangent planes of rulings cannot be estimated.
    #[error(transparent)]
    Estimate(#[from] EstimateError),
    /// No face can be used.
    #[error("none of the {count} faces is a ruled developable surface; the first: {reason}")]
    NoFace {
        /// Number of faces.
        count: usize,
        /// Why the first is not.
        reason: String,
    },
}

/// Elements without which no surface is looked for.
const FEWEST: usize = 4;
/// Shares of the tolerance that fits aim at in turn: the proof compares rulings, the fit distances of points.
const AIMS: [f64; 3] = [0.8, 0.4, 0.15];

/// Fits developable strips to rulings or tangent planes.
///
/// *Input*: rulings in any order; planes in order along the surface. *Result*: certified if every element is proven to
/// lie within the tolerance; otherwise those that are not are counted and the worst is named. Nothing is proven between
/// the elements.
///
/// # Errors
/// See [`ElementFitError`].
///
/// # Example
/// ```
/// use torse::{geom::Vec3, torse::contact::Given};
/// let ruling = |k: i32| {
///     let (x, y) = (0.05 * f64::from(k)).sin_cos();
///     [Vec3::new(100.0 * x, 100.0 * y, 0.0), Vec3::new(100.0 * x, 100.0 * y, 80.0)]
/// };
/// let given = Given::Rulings((0..20).map(ruling).collect());
/// let answer = torse::fit_elements(&given, &torse::ElementFitOptions::new(0.1, "hood"), &torse::Control::default())?;
/// assert_eq!((answer.status(), answer.patchwork.panels.len()), (torse::Status::Certified, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fit_elements(given: &Given, options: &ElementFitOptions, control: &Control) -> Result<Answer, ElementFitError> {
    let sort = if matches!(given, Given::Rulings(_)) { Sort::Rulings } else { Sort::Planes };
    let what = sort.many();
    if given.len() < FEWEST {
        return Err(ElementFitError::Few(given.len(), what));
    }
    if let Given::Planes(planes) = given {
        if let Some(index) = planes.iter().position(|e| !e.is_usable()) {
            return Err(ElementFitError::Element { index });
        }
    }
    if let Some(index) = repeated(given) {
        return Err(ElementFitError::Repeated { what: sort.one(), index });
    }
    let (kept, out) = if options.robust { agreeing(given, options.tolerance) } else { (given.clone(), Vec::new()) };
    let estimates = match &kept {
        Given::Planes(p) => vec![p.clone()],
        Given::Rulings(r) => of_rulings(r, options.tolerance)?,
    };
    let row = Row { name: what.to_string(), estimates, face: None };
    let mut answer = run(vec![row], Vec::new(), sort, options, control)?;
    if !out.is_empty() {
        let strips: Vec<Strip> = answer.strips().cloned().collect();
        let left = certified(&strips, &out.iter().map(|o| o.1).collect::<Vec<_>>(), control);
        let one = sort.one();
        let words = out.iter().zip(left.bounds()).map(|((i, _), b)| {
            let why =
                format!("{one} {i}: the others agree on a surface without it, {b:.3} mm away; nothing is proven of it");
            Skipped::from(why)
        });
        answer.skipped.extend(words);
        let claims = &mut answer.claims;
        claims.insert(claims.len().min(1), Claim::count(Counted::Outliers, Subject::Whole, out.len()));
    }
    Ok(answer)
}

/// What is given without its outliers, and these with their indices.
fn agreeing(given: &Given, tolerance: f64) -> (Given, Vec<(usize, ContactElement)>) {
    // Outliers taken out in turn; what is left then has more of them than agreement.
    const ROUNDS: usize = 64;
    let mut left: Vec<usize> = (0..given.len()).collect();
    let mut out: Vec<(usize, ContactElement)> = Vec::new();
    let part = |of: &[usize]| match given {
        Given::Planes(p) => Given::Planes(of.iter().map(|&i| p[i]).collect()),
        Given::Rulings(r) => Given::Rulings(of.iter().map(|&i| r[i]).collect()),
    };
    for _ in 0..ROUNDS {
        let mut estimates = match part(&left) {
            Given::Planes(p) => vec![p],
            Given::Rulings(r) => of_rulings(&r, tolerance).unwrap_or_default(),
        };
        estimates.iter_mut().for_each(|e| orient(e));
        // What is one estimate's fault, at the ends mostly, is not the ruling's.
        let all: Vec<Vec<usize>> = estimates.iter().map(|e| outliers(e, tolerance)).collect();
        let Some(elements) = estimates.first() else { break };
        let most = |i: &usize| 2 * all.iter().filter(|a| a.contains(i)).count() > all.len();
        let found: Vec<usize> = (0..elements.len()).filter(most).collect();
        if found.is_empty() || left.len() < FEWEST + found.len() {
            break;
        }
        for i in found {
            // Rulings have been put in order: they are known by their ends.
            let own = |k: &usize| match given {
                Given::Planes(_) => left.get(i) == Some(k),
                Given::Rulings(r) => {
                    let [p, q] = elements[i].ends;
                    r[*k] == [p, q] || r[*k] == [q, p]
                }
            };
            if let Some(&k) = left.iter().find(|k| own(k)) {
                out.push((k, elements[i]));
            }
        }
        left.retain(|k| out.iter().all(|o| o.0 != *k));
    }
    // So many do not agree that it is not for the fit to choose.
    if out.len() as f64 > MOST * given.len() as f64 {
        return (given.clone(), Vec::new());
    }
    out.sort_by_key(|o| o.0);
    (part(&left), out)
}

/// Index of the first element that is the same as the one before.
fn repeated(given: &Given) -> Option<usize> {
    let same = |n: usize, equal: &dyn Fn(usize) -> bool| (1..n).find(|&i| equal(i));
    match given {
        Given::Rulings(r) => same(r.len(), &|i| r[i] == r[i - 1] || r[i] == [r[i - 1][1], r[i - 1][0]]),
        Given::Planes(p) => same(p.len(), &|i| p[i].normal == p[i - 1].normal && p[i].ends == p[i - 1].ends),
    }
}

/// Lowers the degree of developable faces and thins out their knots: each ruled developable face becomes strips from
/// cubic splines within the tolerance at its rulings. Faces that are not ruled developables are named as skipped.
///
/// # Errors
/// See [`ElementFitError`].
pub fn fit_faces(
    faces: &[Face],
    skipped: &[Skipped],
    options: &ElementFitOptions,
    control: &Control,
) -> Result<Answer, ElementFitError> {
    let mut left = skipped.to_vec();
    let before = left.len();
    let mut rows = Vec::new();
    for (i, face) in faces.iter().enumerate() {
        let name = if face.name.is_empty() { format!("F{:02}", i + 1) } else { face.name.clone() };
        match GivenFace::of(face, &name, options.rulings_of_face.max(FEWEST), options.tolerance) {
            Ok(mut given) => {
                let estimates = vec![std::mem::take(&mut given.row)];
                rows.push(Row { name, estimates, face: Some(given) });
            }
            Err(reason) => left.push(left_face(face, format!("{name}: {reason}"))),
        }
    }
    if rows.is_empty() {
        let reason = left.get(before).map_or("no faces".into(), Skipped::words);
        return Err(ElementFitError::NoFace { count: faces.len(), reason });
    }
    let mut out = run(rows, left.clone(), Sort::Rulings, options, control)?;
    out.claims.extend(left_out(&left));
    Ok(out)
}

/// What is fitted at once: estimates of the same elements, and the face that they come from.
struct Row {
    name: String,
    estimates: Vec<Vec<ContactElement>>,
    face: Option<GivenFace>,
}

/// Smallest region of a ruling as a share of its length; without extent planes are not compared at all.
const THIN: f64 = 1e-4;

/// Rulings in order with their planes, estimated in several ways: for ends that lie on smooth curves, for ends that do
/// not, and for noisy rulings, whose planes say little beside them.
fn of_rulings(rulings: &[[Vec3; 2]], tolerance: f64) -> Result<Vec<Vec<ContactElement>>, ElementFitError> {
    for (index, r) in rulings.iter().enumerate() {
        if !r.iter().flat_map(|p| p.iter()).all(|x| x.is_finite()) || r[0] == r[1] {
            return Err(EstimateError::Ruling { index }.into());
        }
    }
    let row = ordered(rulings);
    let (from, to): (Vec<_>, Vec<_>) = row.iter().map(|r| (r[0], r[1])).unzip();
    // A ruling speaks for the surface half way to its neighbours.
    let middle = |i: usize| 0.5 * (row[i][0] + row[i][1]);
    let last = row.len() - 1;
    let radius = |i: usize| 0.5 * (middle((i + 1).min(last)) - middle(i.saturating_sub(1))).norm();
    let elements = |normals: &[Vec3], wide: bool| -> Vec<ContactElement> {
        let element = |(i, normal): (usize, &Vec3)| {
            let length = (row[i][1] - row[i][0]).norm();
            let radius = if wide { NARROW * length } else { radius(i).max(THIN * length) };
            ContactElement { normal: *normal, ends: row[i], radius, weight: 1.0 }
        };
        normals.iter().enumerate().map(element).collect()
    };
    let neighbours = planes_of_rulings(&from, &to, Ends::Extrapolated);
    let mut out: Vec<Vec<ContactElement>> = Vec::new();
    out.extend(planes_of_smooth_rulings(&from, &to).ok().map(|n| elements(&n, true)));
    out.extend(planes_of_noisy_rulings(&from, &to, 0.5 * tolerance).ok().map(|n| elements(&n, true)));
    match neighbours {
        Ok(n) => out.extend([elements(&n, true), elements(&n, false)]),
        Err(e) if out.is_empty() => return Err(e.into()),
        Err(_) => {}
    }
    Ok(out)
}

/// Turns the normals of rulings square to them: a plane that is kept must hold its ruling.
fn square(elements: &mut [ContactElement]) {
    for e in elements.iter_mut().filter(|e| e.has_ruling()) {
        let d = (e.ends[1] - e.ends[0]).normalize();
        e.normal = (e.normal - d * d.dot(&e.normal)).try_normalize(0.0).unwrap_or(e.normal);
    }
}

/// Strips for one row.
struct Attempt {
    strips: Vec<Strip>,
    /// The elements that each strip was fitted to.
    ranges: Vec<std::ops::Range<usize>>,
    /// Stretches without a strip: the elements, and why torses that were found give none.
    missed: Vec<(std::ops::Range<usize>, Option<String>)>,
    /// Whether there is nothing because of what is asked of the regression curve.
    kept_off: bool,
    certificate: ElementCertificate,
}

impl Attempt {
    /// Elements beyond the tolerance and regression curves out of bounds, strips, worst bound: less is better.
    fn rank(&self, options: &ElementFitOptions) -> (usize, usize, f64) {
        let broken = self.strips.iter().filter(|s| !regression::keeps(s, options.limits.as_ref())).count();
        (self.certificate.beyond(options.tolerance) + broken, self.strips.len(), self.certificate.worst_bound().value())
    }
}

/// Room for a regression curve that makes fits regular: a share of the mean length of the rulings, mm.
fn room(elements: &[ContactElement]) -> f64 {
    const SHARE: f64 = 0.05;
    let length = |e: &ContactElement| (e.ends[1] - e.ends[0]).norm().max(2.0 * e.radius);
    SHARE * elements.iter().map(length).sum::<f64>() / elements.len().max(1) as f64
}

/// Strips for a row at one aim and with limits of the regression curve.
fn attempt(
    elements: &[ContactElement],
    most: usize,
    aim: f64,
    limits: Option<RegressionLimits>,
    options: &ElementFitOptions,
    control: &Control,
) -> Attempt {
    let wanted = options.fits(aim * options.tolerance, most, limits);
    let mut strips: Vec<Strip> = Vec::new();
    let (mut ranges, mut missed) = (Vec::new(), Vec::new());
    let pieces = row(elements, &wanted);
    let kept_off = pieces.iter().all(|p| p.kept_off);
    for piece in pieces {
        let own = &elements[piece.range.clone()];
        match nearest("A", &piece, own, options) {
            Ok(s) => {
                strips.push(s);
                ranges.push(piece.range);
            }
            Err(reason) => missed.push((piece.range, reason)),
        }
    }
    let certificate = certified(&strips, elements, control);
    Attempt { strips, ranges, missed, kept_off, certificate }
}

/// The best of several aims, and of several estimates of the same elements (which one is told).
fn best(
    estimates: &[Vec<ContactElement>],
    most: usize,
    options: &ElementFitOptions,
    control: &Control,
) -> Option<(usize, Attempt)> {
    let mut best: Option<(usize, Attempt)> = None;
    for aim in AIMS {
        for (k, elements) in estimates.iter().enumerate() {
            if control.stopped() && best.is_some() {
                return best;
            }
            // Limits that leave nothing of one estimate leave nothing of the others, which differ little.
            if best.as_ref().is_some_and(|b| b.1.kept_off) {
                return best;
            }
            let mut found = attempt(elements, most, aim, options.limits.clone(), options, control);
            if options.limits.is_none() && !found.missed.is_empty() {
                // Fits without strips mostly come with a regression curve too near: some room makes them regular.
                let room = Some(RegressionLimits { clearance: room(elements), zones: Vec::new() });
                let kept = attempt(elements, most, aim, room, options, control);
                if kept.rank(options) < found.rank(options) {
                    found = kept;
                }
            }
            let (a, b) = (found.rank(options), best.as_ref().map(|b| b.1.rank(options)));
            let done = a.0 == 0 && a.1 == 1;
            let better = b.is_none_or(|b| (a.0, a.1) < (b.0, b.1) || ((a.0, a.1) == (b.0, b.1) && a.2 < b.2));
            if better {
                best = Some((k, found));
            }
            if done {
                return best;
            }
        }
        // Finer aims cost strips; they are for the last elements that are not proven yet, not for hopeless rows.
        const HOPELESS: f64 = 5.0;
        let (beyond, worst) = best
            .as_ref()
            .map_or((0, 0.0), |(_, b)| (b.certificate.beyond(options.tolerance), b.certificate.worst_bound().value()));
        let many = estimates.first().is_some_and(|e| 2 * beyond > e.len());
        if beyond == 0 || (many && worst > HOPELESS * options.tolerance) {
            break;
        }
    }
    best
}

/// What is given.
#[derive(Clone, Copy)]
enum Sort {
    Rulings,
    Planes,
}

impl Sort {
    fn one(self) -> &'static str {
        match self {
            Self::Rulings => "ruling",
            Self::Planes => "plane",
        }
    }

    fn many(self) -> &'static str {
        match self {
            Self::Rulings => "rulings",
            Self::Planes => "planes",
        }
    }

    fn counted(self) -> Counted {
        match self {
            Self::Rulings => Counted::Rulings,
            Self::Planes => Counted::TangentPlanes,
        }
    }
}

/// Diagonal of the box around all that rows hold, regions of interest included, mm.
fn extent(rows: &[Row]) -> f64 {
    let mut b = BBox::empty();
    for e in rows.iter().flat_map(|r| r.estimates.iter().flatten()) {
        for p in e.ends {
            b.include(&p.add_scalar(e.radius));
            b.include(&p.add_scalar(-e.radius));
        }
    }
    b.diagonal()
}

fn run(
    rows: Vec<Row>,
    mut skipped: Vec<Skipped>,
    sort: Sort,
    options: &ElementFitOptions,
    control: &Control,
) -> Result<Answer, ElementFitError> {
    let clock = std::time::Instant::now();
    let what = sort.many();
    if !(options.tolerance > 0.0 && options.tolerance.is_finite()) {
        return Err(ElementFitError::Tolerance(options.tolerance));
    }
    if let Some(fault) = options.limits.as_ref().and_then(regression::fault) {
        return Err(ElementFitError::Limits(fault));
    }
    Loose::check(extent(&rows), options.tolerance)?;
    let mut strips: Vec<Strip> = Vec::new();
    let mut all: Vec<ContactElement> = Vec::new();
    let mut became_of = Vec::new();
    for (k, Row { name, mut estimates, face }) in rows.into_iter().enumerate() {
        for elements in &mut estimates {
            if let Some(index) = elements.iter().position(|e| !e.is_usable()) {
                return Err(ElementFitError::Element { index });
            }
            let largest = elements.iter().flat_map(|e| e.ends).map(|x| x.amax()).fold(0.0, f64::max);
            if let Some(fault) = Coarse::of(largest, options.tolerance) {
                return Err(fault.into());
            }
            orient(elements);
            if options.fix_ends {
                square(elements);
            }
        }
        control.report("fitting", k as f64, name.clone());
        let left = options.max_strips.saturating_sub(strips.len());
        let mut own: Vec<Strip> = Vec::new();
        let given = face.as_ref().and_then(|f| f.strip.as_ref());
        let given = given.filter(|s| left > 0 && regression::keeps(s, options.limits.as_ref()));
        let mut missed = Vec::new();
        let wanted = options.fits(options.tolerance, 1, options.limits.clone());
        let simple = given.is_some_and(is_simplest);
        // Most rows are followed by one strip over few spans; the search for these is also the fastest.
        if let Some(elements) = estimates.first().filter(|_| !simple && left > 0 && options.limits.is_none()) {
            own.extend(simplest(&name, elements, &wanted, control));
        }
        let found = match given {
            _ if simple || !own.is_empty() => None,
            _ => best(&estimates, left, options, control),
        };
        let which = found.as_ref().map_or(0, |f| f.0);
        if let Some((which, found)) = found {
            for (range, reason) in found.missed {
                let reason = reason.unwrap_or_else(|| unfollowed(&estimates[which][range.clone()], options));
                let of = if name == what { String::new() } else { format!("{name}: ") };
                missed.push(format!("{of}{what} {} to {}: {reason}", range.start, range.end - 1));
            }
            for (strip, range) in found.strips.into_iter().zip(found.ranges) {
                let elements = &estimates[which][range];
                own.push(fewest(strip, elements, &wanted, control));
            }
        }
        let mut kept = false;
        if let Some(strip) = given {
            let beyond = certified(&own, &estimates[which], control).beyond(options.tolerance);
            if own.is_empty() || beyond > 0 || no_simpler(&own, strip) {
                kept = true;
                own = vec![strip.clone()];
                missed.clear();
            }
        }
        for (i, strip) in own.iter_mut().enumerate() {
            strip.name = format!("A-{:02}", strips.len() + i + 1);
        }
        if let Some(face) = &face {
            let became = match own.first() {
                Some(only) if kept => Became::Itself(only.name.clone()),
                Some(_) => Became::Strips(reached(&own)),
                None => Became::Nothing,
            };
            became_of.push(FaceNote { face: name, given: face.size, became });
        }
        skipped.extend(missed.into_iter().map(Skipped::from));
        strips.append(&mut own);
        all.append(&mut estimates[which]);
    }
    control.report("proving", 0.7, format!("{} {what}", all.len()));
    let certificate = certified(&strips, &all, control);
    let chains: Vec<Part> = (strips.iter().enumerate())
        .map(|(i, s)| Part { name: s.name.clone(), first: i, count: 1, missing: String::new() })
        .collect();
    let (parts, patterns) =
        cut(&strips, &chains, &StripOptions { drawn: options.drawn, ..StripOptions::new(0.1 * options.tolerance) });
    let flat_proof = judged(&strips, &parts, &patterns, options.tolerance);
    let beyond = certificate.beyond(options.tolerance);
    let broken = regression::broken(&strips, options.limits.as_ref());
    let worst = certificate.worst_bound();
    let reason = match certificate.worst() {
        _ if strips.is_empty() => format!("no developable strip follows the {what}"),
        _ if control.stopped() => format!("stopped before all {what} were judged"),
        None => String::new(),
        Some(i) => {
            let c = all[i].centre();
            format!(
                "{beyond} of {} {what} are not within {} mm; the worst is number {i} around ({:.3}, {:.3}, {:.3}), {:.3} mm away",
                all.len(),
                options.tolerance,
                c.x,
                c.y,
                c.z,
                worst.value()
            )
        }
    };
    let whole = Subject::Whole;
    let mut claims = vec![
        Claim::count(sort.counted(), whole, all.len()),
        Claim::at_most(What::ElementDistance, whole, worst).within(options.tolerance).because(reason),
        Claim::count(Counted::Beyond, whole, beyond),
    ];
    if control.stopped() {
        claims.push(Claim::objection(whole, format!("stopped before all {what} were judged")));
    }
    if worst.value() <= options.tolerance {
        claims.extend(broken.iter().map(|b| Claim::objection(whole, beyond_limits(b))));
    }
    claims.extend(lengths(&patterns, &flat_proof));
    let refused = refused(&parts, &patterns, &flat_proof, options.tolerance);
    claims.extend(refused.into_iter().map(|reason| Claim::objection(whole, reason)));
    claims.extend(claims_of_strips(&strips, &certificate));
    let mut notes: Vec<Note> = options.limits.iter().cloned().map(Note::Limits).collect();
    notes.extend(became_of.into_iter().map(FitNote::Face).map(Note::Fit));
    notes.extend(broken.into_iter().map(Note::Broken));
    notes.push(Note::Fit(FitNote::At(sort.counted())));
    notes.extend((strips.len() > 1).then_some(Note::Unjoined));
    Ok(Answer {
        claims,
        fields: fields(&strips, &certificate),
        meaning: FieldMeaning { name: "deviation".into(), unit: "mm".into(), limit: options.tolerance },
        parts,
        patterns,
        flat: flat_proof,
        notes,
        skipped,
        seconds: clock.elapsed().as_secs_f64(),
        patchwork: Patchwork::of_strips(strips),
        ..Answer::new(Job::Fit, &options.input, options.tolerance)
    })
}

/// The strip with the smallest proven distance from its elements, among those whose regression curve keeps to the
/// limits if there are any.
///
/// # Errors
/// Why torses give no strip; nothing where there are none.
fn nearest(
    name: &str,
    piece: &RowPiece,
    own: &[ContactElement],
    options: &ElementFitOptions,
) -> Result<Strip, Option<String>> {
    let mut best: Option<(bool, f64, Strip)> = None;
    let mut reason = None;
    for fit in &piece.fits {
        match strip(name, fit, own) {
            Ok(s) => {
                let worst = certified(std::slice::from_ref(&s), own, &Control::default()).worst_bound().value();
                let broken = !regression::keeps(&s, options.limits.as_ref());
                if best.as_ref().is_none_or(|b| (broken, worst) < (b.0, b.1)) {
                    best = Some((broken, worst, s));
                }
            }
            Err(e) => reason = Some(format!("the {} found gives no strip ({e})", fit.kind.name())),
        }
    }
    best.map(|b| b.2).ok_or(reason)
}

/// Why no developable follows elements: too far from any, or none keeps to the limits and then how near one comes.
fn unfollowed(own: &[ContactElement], options: &ElementFitOptions) -> String {
    // Tolerances looked at for the reason, in multiples of the one asked for.
    const WIDER: [f64; 4] = [3.0, 10.0, 100.0, 1e4];
    let mut plain = format!("no developable strip follows them within {} mm", options.tolerance);
    if options.fix_ends {
        plain += " and keeps the first and the last as they are";
    }
    if let Some(weight) = options.smoothing {
        plain += &format!(", smoothed with the weight {weight}; a smaller one comes nearer");
    }
    let Some(limits) = &options.limits else { return plain };
    let one = |tolerance: f64, limits: Option<RegressionLimits>| {
        torses(own, &options.fits(tolerance, 1, limits)).into_iter().next().map(|f| f.error)
    };
    if one(options.tolerance, None).is_none() {
        return plain;
    }
    let wider = WIDER.iter().find_map(|w| one(w * options.tolerance, Some(limits.clone())));
    plain + &regression::kept_off(wider.unwrap_or(f64::INFINITY))
}

fn claims_of_strips(strips: &[Strip], c: &ElementCertificate) -> Vec<Claim> {
    let claims = |(k, strip): (usize, &Strip)| {
        let subject = Subject::Panel(k);
        let count = c.places().iter().filter(|p| p.0 as usize == k).count();
        let rail = strip.rail(0);
        [
            Claim::count(Counted::Elements, subject, count),
            Claim::at_most(What::ElementDistance, subject, c.worst_bound_on(k)),
            Claim::count(Counted::Degree, subject, rail.knots.degree()),
            Claim::count(Counted::ControlPoints, subject, rail.control.len()),
            regression::claim(k, strip),
        ]
    };
    strips.iter().enumerate().flat_map(claims).collect()
}

/// The bounds along the strips, the same on all of a ruling.
fn fields(strips: &[Strip], c: &ElementCertificate) -> Vec<PanelField> {
    const ALONG: usize = 48;
    strips
        .iter()
        .enumerate()
        .map(|(k, s)| {
            let (a, b) = s.domain();
            let mut found: Vec<(f64, f64)> = (c.places().iter().zip(c.bounds()))
                .filter(|(p, b)| p.0 as usize == k && b.is_finite())
                .map(|(p, b)| (p.1, *b))
                .collect();
            found.sort_by(|p, q| p.0.total_cmp(&q.0));
            let at = |u: f64| -> f64 {
                let i = found.partition_point(|p| p.0 < u);
                let around = [i.checked_sub(1), Some(i)].into_iter().flatten().filter_map(|i| found.get(i));
                around.min_by(|p, q| (p.0 - u).abs().total_cmp(&(q.0 - u).abs())).map_or(0.0, |p| p.1)
            };
            let u: Vec<f64> = (0..=ALONG).map(|i| a + (b - a) * i as f64 / ALONG as f64).collect();
            let values = u.iter().flat_map(|&u| [at(u); 2]).collect();
            PanelField { u, v: vec![0.0, 1.0], values }
        })
        .collect()
}
