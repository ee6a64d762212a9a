//! Strips that meet: the strips of a covered face are changed, and their borders moved, until neighbours end on common edges, as
//! far as that can be certified.
//!
//! First all strips in one program, without those that are refused; then strips as they are, with the borders that are still
//! open where they intersect. The best panels are kept, and those of the cover if nothing better can be proven.

use super::intersection::{pair, Intersections};
use super::seams::{self, SharedSeam};
use crate::certify::flat::flat;
use crate::certify::{Known, PanelCertificate, SeamCertificate, SeamStatus};
use crate::control::Control;
use crate::fit::near::samples::Fit;
use crate::fit::panels::boundary::Borders;
use crate::geom::Vec3;
use crate::num::hash::HashMap;
use crate::num::parallel;
use crate::patchwork::panel::{Coedge, Panel};
use crate::patchwork::redraw::NewBorder;
use crate::search::build::{build_on, limits_missed, Built, Joined};
use crate::search::cover::{Cover, CoverOptions, Job, Limits, Recount};
use crate::search::joint::{self, Asked, BorderCounts, Further, JoinedLine, Joint, Meeting};
use crate::torse::form::{PanelKind, Torse};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, OnceLock};

/// Shares of their regularity that strips keep in the program, in turn until all seams are closed. Alone the first closes 7 of 7
/// on the hull at 5 mm and 8 of 9 on the monkey saddle at 10 mm, the second 5 and 9.
const REGULAR: [f64; 2] = [1.0, 0.9];
/// Times that the program over all strips is solved with other places where panels were too far away, at most.
const REFINEMENTS: usize = 2;
/// Times that it is solved without strips that were refused, at most.
const EXCLUSIONS: usize = 4;
/// Where a larger share of the strips is refused, only the worst is left out.
const REFUSED_SHARE: f64 = 1.0 / 3.0;
/// Places where less than the reciprocal of this share of the tolerance is left are lost to trimming curves, not to distance.
const MOST_COUNTED: f64 = 3.0;
/// Places that count more than this have lost part of the tolerance to ends of panels.
const ENDS: f64 = 1.02;
/// See [`Attempts::most`], of another number of strips than the cover has: nine strips of the half bowl at 1 mm end at 0.990 and are
/// proven, where ends of panels cost more the proof finds some percent more.
const NEAR_ENOUGH: f64 = 0.995;
/// See [`Attempts::most`], of strips that are to meet those of other faces: of places where distances count more some may be
/// too far away, and cost no more than an edge.
const LOW_ENOUGH: f64 = 1.15;
/// Gaps (tolerances) up to which strips are laid end to end: their borders move by little.
const END_TO_END: f64 = 0.01;
/// Rounds of moving borders to edges, without those that were refused.
const INTERSECTIONS: usize = 8;

/// A face whose strips are to meet.
struct Attempts<'a> {
    index: usize,
    /// Its cover.
    cover: &'a Cover,
    tolerance: f64,
    /// Limits of sheet and material, seams that must stay.
    wanted: &'a CoverOptions,
    control: &'a Control,
    /// What was proven on the way.
    known: Known,
    /// Labels whose flat patterns are not proven without common edges either, once they are asked for.
    unproven: OnceLock<BTreeSet<u32>>,
    /// Largest distance (tolerances) of a sample with which strips of the program are worth being built.
    most: f64,
    /// What distances count on the border of the face.
    borders: Option<&'a BorderCounts<'a>>,
    /// The best so far.
    best: Built,
}

/// Panels that cannot be proven.
#[derive(Default)]
struct Refused {
    labels: Vec<u32>,
    /// Where they are too far from the face, if that is why, and it is worth another try.
    too_far: Vec<Further>,
}

/// A face whose strips are to meet those of others.
pub(crate) struct Side<'a> {
    /// Its number.
    pub index: usize,
    /// Its cover.
    pub cover: &'a Cover,
    /// Its panels.
    pub built: &'a Built,
    /// What was asked for.
    pub wanted: &'a CoverOptions,
    /// What distances count on its border.
    pub borders: &'a BorderCounts<'a>,
}

/// How borders come under edges.
#[derive(Clone, Copy)]
enum Moving<'a> {
    /// They are there.
    Done,
    /// Regions are cut along edges.
    Cut,
    /// Regions of strips that were accepted are cut where these intersect.
    Accepted(&'a Built),
}

/// The same panels, with the labels of those whose flat patterns are not proven, laid anew so that neighbours meet, as far as that
/// can be certified; as they are where it cannot. Asked for are what covers are, and what other numbers of strips may be tried.
pub(crate) fn met(
    index: usize,
    cover: &Cover,
    (built, unproven): (Built, BTreeSet<u32>),
    (wanted, recounts): (&CoverOptions, &[Recount]),
    control: &Control,
) -> Built {
    let tolerance = built.certificate.tolerance;
    let base = cover.as_built(&built);
    let mut attempts = Attempts {
        index,
        cover,
        tolerance,
        wanted,
        control,
        known: Known::default(),
        unproven: OnceLock::from(unproven),
        most: f64::INFINITY,
        borders: None,
        best: built,
    };
    // Strips that are laid end to end need edges, and nothing else.
    if attempts.is_end_to_end() {
        attempts.intersect(cover);
    }
    if recounts.contains(&Recount::Less) && attempts.recounted(Recount::Less) {
        return attempts.best;
    }
    // Borders that the program has left open are moved at once, which may spare its next solution; those of the cover only where
    // it has brought nothing.
    let moved = base.as_ref().is_some_and(|b| attempts.changed_together(b, &REGULAR));
    if !moved {
        attempts.intersect(cover);
    }
    if recounts.contains(&Recount::More) {
        attempts.recounted(Recount::More);
    }
    attempts.best
}

/// What panels of one face come to: none where it stays as it is.
type Placed = Option<Result<Built, Refused>>;

/// The panels of faces, none for those that stay as they are, laid anew so that they meet at places between faces; `None` for
/// those that cannot be proven, or whose panels would meet in fewer edges.
pub(crate) fn met_together(sides: Vec<Option<Side>>, meetings: &[Meeting], control: &Control) -> Vec<Option<Built>> {
    let attempts: Vec<Option<(Attempts, Cover)>> = sides.into_iter().map(|s| attempted(s?, control)).collect();
    let asked = attempts.iter().map(|a| {
        let (a, _) = a.as_ref()?;
        Some(move |labels: [u32; 2]| a.is_asked_for(&a.best, pair(labels)))
    });
    let held: Vec<_> = asked.collect();
    let without = BTreeSet::new();
    let asked: Vec<Option<Asked>> = attempts
        .iter()
        .zip(&held)
        .map(|(a, held)| {
            let &Attempts { tolerance, borders, most, .. } = &a.as_ref()?.0;
            Some(Asked { held: held.as_ref()?, without: &without, regular: REGULAR[0], tolerance, borders, most })
        })
        .collect();
    let given = attempts.iter().zip(&asked).map(|(a, asked)| {
        let (_, base) = a.as_ref()?;
        Some((base, base.borders().seam_chains(), asked.as_ref()?))
    });
    let mut joint = Joint::of_faces(given.collect(), meetings);
    for refinement in 0..=REFINEMENTS {
        let joined = joint.joined_all(control);
        if control.stopped() {
            break;
        }
        let placed = |(a, joined): (&Option<(Attempts, Cover)>, Option<joint::Joined>)| {
            let ((a, base), joined) = (a.as_ref()?, joined?);
            if refinement == 0 && a.is_too_far(&joined) {
                return None;
            }
            Some(a.placed(base, joined, refinement == REFINEMENTS))
        };
        let placed: Vec<Placed> = parallel::map(attempts.iter().zip(joined), placed);
        let mut again = false;
        for (face, p) in placed.iter().enumerate() {
            if let Some(Err(refused)) = p {
                again |= refused.counted(&mut joint, face);
            }
        }
        if !again {
            let good = |(a, p): (&Option<(Attempts, Cover)>, Placed)| {
                let (a, next) = (&a.as_ref()?.0, p?.ok()?);
                a.is_no_worse(&next).then_some(next)
            };
            return attempts.iter().zip(placed).map(good).collect();
        }
    }
    attempts.iter().map(|_| None).collect()
}

/// A face that is to meet others, and its panels as a cover.
fn attempted<'a>(side: Side<'a>, control: &'a Control) -> Option<(Attempts<'a>, Cover)> {
    let Side { index, cover, built, wanted, borders } = side;
    let base = cover.as_built(built)?;
    let attempts = Attempts {
        index,
        cover,
        tolerance: built.certificate.tolerance,
        wanted,
        control,
        known: Known::default(),
        unproven: OnceLock::new(),
        most: LOW_ENOUGH,
        borders: Some(borders),
        best: built.clone(),
    };
    Some((attempts, base))
}

impl Refused {
    /// Lets places that were too far away count in the program over strips; whether there are any.
    fn counted(&self, joint: &mut Joint, face: usize) -> bool {
        if self.too_far.is_empty() {
            return false;
        }
        // Where too little is left at ends of panels, they count everywhere.
        if self.too_far.iter().any(|f| f.counts > ENDS) {
            joint.count_ends(face);
        }
        joint.count(face, &self.too_far);
        true
    }
}

impl Attempts<'_> {
    /// Whether panels meet as they did, and no more limits are missed.
    fn is_no_worse(&self, next: &Built) -> bool {
        self.exact(next) >= self.exact(&self.best)
            && openness(next) <= openness(&self.best)
            && self.missed(next) <= self.missed(&self.best)
    }

    /// Limits of sheet and material that are missed.
    fn missed(&self, b: &Built) -> usize {
        limits_missed(&b.patchwork, &b.certificate, &b.patterns, &self.wanted.limits).reasons.len()
    }

    /// Seams at which panels have one edge.
    fn exact(&self, b: &Built) -> usize {
        b.certificate.seams.iter().filter(|s| s.status == SeamStatus::Exact).count()
    }

    /// Whether strips are equally high along all their borders.
    fn is_end_to_end(&self) -> bool {
        let torses = torses(&self.best);
        let intersections = Intersections::new(&self.cover.face, &torses);
        let largest = self.cover.as_built(&self.best).and_then(|s| intersections.largest_gap(&s));
        largest.is_some_and(|gap| gap <= END_TO_END * self.tolerance)
    }

    /// Whether something is left to be done, and time for it.
    fn is_open(&self) -> bool {
        openness(&self.best) > 0.0 && !self.control.stopped()
    }

    /// Strips of one program in place of those at hand, with one share of their regularity after the other until all seams are
    /// closed; whether that brought anything.
    fn changed_together(&mut self, base: &Cover, shares: &[f64]) -> bool {
        let mut moved = false;
        for &regular in shares {
            if self.is_open() && self.joined(base, regular).is_some_and(|next| self.keep(next)) {
                self.intersect(self.cover);
                moved = true;
            }
        }
        moved
    }

    /// Tries another number of strips, where no limits or seams are asked for; whether all of them meet then.
    fn recounted(&mut self, recount: Recount) -> bool {
        let layout = &self.wanted.layout;
        let free = self.wanted.limits == Limits::default() && layout.seams.is_empty() && layout.curves.is_empty();
        if !free || !self.is_open() {
            return false;
        }
        let job = Job::new(&self.cover.face, self.wanted, self.control);
        let Some(next) = job.recounted(self.cover, recount) else { return false };
        let next = next.with_smooth_borders(self.tolerance, |_| true);
        // Labels are others, and no flat pattern is given up.
        let unproven = std::mem::replace(&mut self.unproven, OnceLock::from(BTreeSet::new()));
        let most = std::mem::replace(&mut self.most, NEAR_ENOUGH);
        let before = self.joined(&next, REGULAR[0]).map(|first| std::mem::replace(&mut self.best, first));
        if before.is_some() {
            self.intersect(&next);
        }
        (self.unproven, self.most) = (unproven, most);
        let all_meet = before.is_some() && openness(&self.best) == 0.0;
        if let Some(before) = before.filter(|_| !all_meet) {
            self.best = before;
        }
        all_meet
    }

    /// Moves borders that are still open to where the strips of the best panels intersect.
    fn intersect(&mut self, cover: &Cover) {
        if self.is_open() {
            if let Some(next) = self.intersecting(&self.best, cover) {
                self.keep(next);
            }
        }
    }

    /// Takes panels that are nearer to meeting and miss no more limits; whether it did.
    fn keep(&mut self, next: Built) -> bool {
        let is_nearer = openness(&next) < openness(&self.best) && self.exact(&next) >= self.exact(&self.best);
        let is_better = is_nearer && self.missed(&next) <= self.missed(&self.best);
        if is_better {
            self.best = next;
        }
        is_better
    }

    /// The panels with their borders where they intersect, in place of those along which they do not meet. `None` where
    /// that is not possible, or cannot be proven.
    fn intersecting(&self, built: &Built, cover: &Cover) -> Option<Built> {
        let torses = torses(built);
        let intersections = Intersections::new(&self.cover.face, &torses);
        let base = cover.as_built(built)?;
        let wanted: Vec<[u32; 2]> = open(built).into_iter().filter(|p| !self.is_asked_for(built, *p)).collect();
        self.bordered_at(&intersections, &base, wanted, Moving::Accepted(built)).ok()
    }

    /// Strips of the program over all of them, with their borders under their edges; strips that are refused all the same
    /// stay as they are, with their borders.
    fn joined(&self, base: &Cover, regular: f64) -> Option<Built> {
        let stays = |labels: [u32; 2]| self.is_asked_for(&self.best, pair(labels));
        let mut without = BTreeSet::new();
        for _ in 0..=EXCLUSIONS {
            let &Self { tolerance, borders: on_border, most, .. } = self;
            let asked = Asked { held: &stays, without: &without, regular, tolerance, borders: on_border, most };
            let mut joint = Joint::new(base, base.borders().seam_chains(), &asked)?;
            match self.refined(base, &mut joint) {
                Ok(found) => return Some(found),
                Err(labels) if labels.iter().all(|l| without.contains(l)) => return None,
                Err(labels) => without.extend(labels),
            }
        }
        None
    }

    /// Panels of strips that were changed together. Places where they are too far away count the next time. Errors are the
    /// labels to do without.
    fn refined(&self, base: &Cover, joint: &mut Joint) -> Result<Built, Vec<u32>> {
        for refinement in 0..=REFINEMENTS {
            let joined = joint.joined(self.control).filter(|_| !self.control.stopped()).ok_or_else(Vec::new)?;
            if refinement == 0 && self.is_too_far(&joined) {
                return Err(Vec::new());
            }
            match self.placed(base, joined, refinement == REFINEMENTS) {
                Ok(found) => return Ok(found),
                Err(refused) if refused.counted(joint, 0) => {}
                Err(refused) => return Err(refused.labels),
            }
        }
        Err(Vec::new())
    }

    /// Where many strips are too far away all are as near as they get: no proof will find them nearer.
    fn is_too_far(&self, joined: &joint::Joined) -> bool {
        if self.most.is_finite() {
            return joined.distances.iter().any(|d| *d > self.most);
        }
        let far = joined.distances.iter().filter(|d| **d > 1.0).count();
        far as f64 > REFUSED_SHARE * joined.distances.len() as f64
    }

    /// Panels of strips that were changed together. The `last` time a few strips that are refused are laid anew each for itself.
    /// Errors are the labels to do without, or places that should count the next time.
    fn placed(&self, base: &Cover, joined: joint::Joined, last: bool) -> Result<Built, Refused> {
        let without = |labels: Vec<u32>| Refused { labels, too_far: Vec::new() };
        let worst = joined.torses.iter().zip(&joined.distances).max_by(|a, b| a.1.total_cmp(b.1)).map(|w| w.0 .0);
        let mut next = base.clone();
        for (label, torse) in joined.torses {
            let fit = next.panels.get(&label).ok_or_else(Refused::default)?;
            let fit = Fit { torse, kind: PanelKind::Torse, ..(**fit).clone() };
            next.panels.insert(label, Arc::new(fit));
        }
        if joined.lines.is_empty() {
            // A strip that has no neighbours in its face.
            let (built, labels) = self.built_on(&next, &[]);
            let too_far = if last { Vec::new() } else { places_too_far(&built) };
            return if labels.is_empty() { Ok(built) } else { Err(Refused { labels, too_far }) };
        }
        let along_lines = next.redrawn(&joined.lines);
        if let Some(crossing) = along_lines.as_ref().err().filter(|c| !c.is_empty()) {
            // Lines cross where a strip has become nothing: the smaller of both.
            let smaller = |[a, b]: &[u32; 2]| if base.region(*a).area() < base.region(*b).area() { *a } else { *b };
            return Err(without(crossing.iter().map(smaller).collect()));
        }
        let along_lines = along_lines.ok();
        let edges: Vec<_> = joined.lines.into_iter().filter_map(|l| Some((pair(l.labels), l.edge?))).collect();
        let wanted: Vec<[u32; 2]> = edges.iter().map(|e| e.0).collect();
        let vertices = joined.vertices.into_iter().map(|v| (v.labels, v.place)).collect();
        let intersections = Intersections::new(&next.face, &next.torses()).with_known_edges(edges, vertices);
        let moved = |cover: &Cover, wanted: &[[u32; 2]], how: Moving| {
            self.bordered_at(&intersections, &intersections.with_vertices(cover), wanted.to_vec(), how)
        };
        let mut refused = match along_lines.as_ref().map(|s| moved(s, &wanted, Moving::Done)) {
            Some(Ok(found)) => return Ok(found),
            Some(Err(refused)) => refused,
            None => Refused::default(),
        };
        let at_first = refused.labels.clone();
        if refused.too_far.is_empty() {
            // Borders may be at fault; cut out of the old ones they are others.
            match moved(&next, &wanted, Moving::Cut) {
                Ok(found) => return Ok(found),
                Err(other) if refused.labels.is_empty() || other.labels.len() < refused.labels.len() => refused = other,
                Err(_) => {}
            }
        }
        if !last && !refused.too_far.is_empty() {
            return Err(refused);
        }
        if let Some(mended) = along_lines.and_then(|s| self.mended(s, base, &at_first)) {
            let others = |p: &[u32; 2]| !p.iter().any(|l| at_first.contains(l));
            let wanted: Vec<_> = wanted.into_iter().filter(others).collect();
            if let Ok(found) = moved(&mended, &wanted, Moving::Done) {
                return Ok(found);
            }
        }
        let few = refused.labels.len() as f64 <= REFUSED_SHARE * next.panels.len() as f64;
        let is_kept = few || refused.labels.is_empty();
        Err(without(if is_kept { refused.labels } else { worst.into_iter().collect() }))
    }

    /// The cover with a few strips that were refused laid anew on their regions, each for itself.
    fn mended(&self, mut cover: Cover, base: &Cover, labels: &[u32]) -> Option<Cover> {
        if labels.is_empty() || labels.len() as f64 > REFUSED_SHARE * cover.panels.len() as f64 {
            return None;
        }
        for label in labels {
            let fits = [base, &cover].map(|s| s.panels.get(label).cloned());
            let found = Job::new(&self.cover.face, self.wanted, self.control)
                .laid_anew(cover.region(*label), fits.iter().flatten())?;
            cover.panels.insert(*label, found);
        }
        Some(cover)
    }

    /// The panels of a cover with borders where strips intersect, and the edges that panels share already. Errors where that
    /// is not possible, or cannot be proven. Panels that are refused keep their borders if they were accepted before; else
    /// nothing more is tried.
    fn bordered_at(
        &self,
        intersections: &Intersections,
        base: &Cover,
        mut wanted: Vec<[u32; 2]>,
        how: Moving,
    ) -> Result<Built, Refused> {
        let built = match how {
            Moving::Accepted(built) => Some(built),
            _ => None,
        };
        for _ in 0..INTERSECTIONS {
            if self.control.stopped() {
                break;
            }
            let (now, moved) = match how {
                Moving::Done => (base.clone(), wanted),
                _ => intersections.cut(base, &wanted),
            };
            if moved.is_empty() {
                break;
            }
            wanted = moved;
            // Borders with edges that are kept stay as they are.
            let moves = |p: [u32; 2]| built.is_none() || wanted.contains(&p);
            let now = intersections.settled(&now.with_smooth_borders(self.tolerance, moves), &wanted);
            let borders = now.borders();
            let (mut edges, spoilt) = intersections.edges(&now, &borders, &wanted);
            if !spoilt.is_empty() {
                wanted.retain(|p| !spoilt.contains(p));
                continue;
            }
            edges.extend(built.into_iter().flat_map(|b| seams::kept(&b.patchwork, &borders)));
            let clashing = clashing(&edges, &borders);
            let before = wanted.len();
            wanted.retain(|p| !clashing.contains(p));
            if wanted.len() < before {
                continue;
            }
            let (next, bad) = self.built_on(&now, &edges);
            let missed = missed(&next);
            if bad.is_empty() && missed.is_empty() {
                return Ok(next);
            }
            if built.is_none() && !bad.is_empty() {
                return Err(Refused { labels: bad, too_far: places_too_far(&next) });
            }
            wanted.retain(|p| !missed.contains(p) && !p.iter().any(|l| bad.contains(l)));
            if wanted.len() == before {
                break;
            }
        }
        Err(Refused::default())
    }

    /// Panels with common edges, and the labels of those that are refused: also for a flat pattern that is not proven, but is
    /// without these edges.
    fn built_on(&self, cover: &Cover, edges: &[SharedSeam]) -> (Built, Vec<u32>) {
        let joined = Joined { edges, known: &self.known };
        let (next, mut bad) = build_on(self.index, cover, (self.tolerance, self.control), joined);
        if bad.is_empty() {
            bad = unproven(&next, self.control);
            if !bad.is_empty() {
                let before = self.unproven.get_or_init(|| unproven(&self.best, self.control).into_iter().collect());
                bad.retain(|l| !before.contains(l));
            }
        }
        (next, bad)
    }

    /// Whether the border between two labels lies in a plane or on a line in which a seam must run: such borders stay.
    fn is_asked_for(&self, built: &Built, labels: [u32; 2]) -> bool {
        let (planes, lines) = (&self.wanted.layout.seams, &self.cover.seam_lines);
        let any = !planes.is_empty() || !lines.is_empty();
        let Some(partition) = built.patchwork.partitions.first().filter(|_| any) else { return false };
        let seams = built.patchwork.seams();
        let mut runs =
            seams.iter().filter(|s| both(s.sides.map(|s| s.of.label())) == Some(labels)).map(|s| s.sides[0].run);
        let place = |v: &u32| {
            let [a, b] = partition.vertices[*v as usize];
            self.cover.face.surface.point(a, b)
        };
        let along = |r: &Coedge, height: &dyn Fn(&Vec3) -> f64| {
            r.vertices.iter().all(|v| height(&place(v)).abs() <= self.tolerance)
        };
        runs.any(|r| {
            planes.iter().any(|p| along(r, &|x| p.height(x))) || lines.iter().any(|l| along(r, &|x| l.height(x)))
        })
    }
}

/// Labels of panels whose flat patterns are not proven.
pub(crate) fn unproven(built: &Built, control: &Control) -> Vec<u32> {
    let proofs = flat(&built.patchwork, &built.patterns, built.certificate.tolerance, control);
    let open = proofs.iter().filter(|p| !p.holds());
    open.filter_map(|p| built.patchwork.panels.get(p.panel())?.label()).collect()
}

/// Torses of panels by their labels.
fn torses(built: &Built) -> BTreeMap<u32, &Torse> {
    let trims = built.patchwork.panels.iter().filter_map(|p| p.trim.as_ref());
    trims.filter_map(|t| Some((t.label, t.form.torse()?))).collect()
}

/// How far panels are from meeting: a gap of the tolerance counts one, every seam that is not exact a little besides.
pub(crate) fn openness(built: &Built) -> f64 {
    const EACH: f64 = 0.1;
    let open = built.certificate.seams.iter().filter(|s| s.status != SeamStatus::Exact);
    open.map(|s| EACH + s.gap_bound / built.certificate.tolerance).sum()
}

/// Labels on both sides of seams that are not one edge.
fn open(built: &Built) -> Vec<[u32; 2]> {
    let seams = built.certificate.seams.iter().filter(|s| s.status != SeamStatus::Exact);
    seams.filter_map(|s| labels(built, s)).collect()
}

/// Labels on both sides of edges that end in one vertex of the borders, but in different points.
pub(super) fn clashing(edges: &[SharedSeam], borders: &Borders) -> Vec<[u32; 2]> {
    let chains = borders.seam_chains();
    // By vertex: the point, bit by bit, and the labels.
    type End = ([u64; 3], [u32; 2]);
    let mut ends: HashMap<u32, Vec<End>> = HashMap::default();
    for e in edges {
        let Some(chain) = chains.iter().find(|c| c.chain == e.chain) else { continue };
        let points = [e.edge.control.first(), e.edge.control.last()];
        for (v, x) in [chain.vertices.first(), chain.vertices.last()].into_iter().zip(points) {
            if let (Some(v), Some(x)) = (v, x) {
                ends.entry(*v).or_default().push((x.map(f64::to_bits), pair(e.labels)));
            }
        }
    }
    let differ = ends.into_values().filter(|e| e.iter().any(|x| x.0 != e[0].0));
    differ.flatten().map(|e| e.1).collect()
}

/// Where panels are farther from the face than the proof leaves room for.
fn places_too_far(built: &Built) -> Vec<Further> {
    let panels = built.patchwork.panels.iter().zip(&built.certificate.panels);
    let place = |(panel, proof): (&Panel, &PanelCertificate)| {
        let (uv, left) = proof.too_far?;
        let counts = built.certificate.tolerance / left;
        (counts < MOST_COUNTED).then_some(Further { label: panel.label()?, uv, counts })
    };
    panels.filter_map(place).collect()
}

/// Labels on both sides of edges that their panels miss.
fn missed(built: &Built) -> Vec<[u32; 2]> {
    let seams = built.patchwork.seams().into_iter().zip(&built.certificate.seams);
    let missed = seams.filter(|(s, c)| s.is_shared() && c.status != SeamStatus::Exact);
    missed.filter_map(|(_, c)| labels(built, c)).collect()
}

fn labels(built: &Built, seam: &SeamCertificate) -> Option<[u32; 2]> {
    both(seam.panels.map(|k| built.patchwork.panels[k].label()))
}

/// Two labels in order, if both panels have one.
fn both(labels: [Option<u32>; 2]) -> Option<[u32; 2]> {
    Some(pair([labels[0]?, labels[1]?]))
}

impl Cover {
    /// The cover with its borders along lines. The errors of [`Partition::redrawn`](crate::patchwork::partition::Partition::redrawn).
    fn redrawn(&self, lines: &[JoinedLine]) -> Result<Cover, Vec<[u32; 2]>> {
        let lines: Vec<NewBorder> = lines.iter().map(|l| NewBorder { labels: l.labels, uv: &l.uv }).collect();
        let (u, v) = (self.face.surface.knots_u.breaks(), self.face.surface.knots_v.breaks());
        Ok(self.with_partition(self.partition.redrawn(&lines, [&u, &v])?))
    }

    /// The cover of panels that may have other labels than this one.
    pub(crate) fn of_panels(&self, built: &Built) -> Option<Cover> {
        let mut out = self.with_partition(built.patchwork.partitions.first()?.clone());
        out.bands.clear();
        let fit = |p: &Panel| {
            let (trim, kind, error) = (p.trim.as_ref()?, p.strip.kind, built.certificate.tolerance);
            Some((trim.label, Arc::new(Fit { torse: trim.form.torse()?.clone(), kind, error, worst: 0 })))
        };
        out.panels = built.patchwork.panels.iter().map(fit).collect::<Option<_>>()?;
        Some(out)
    }

    /// The cover with the torses and the partition of panels.
    fn as_built(&self, built: &Built) -> Option<Cover> {
        let mut out = self.with_partition(built.patchwork.partitions.first()?.clone());
        for p in &built.patchwork.panels {
            let trim = p.trim.as_ref()?;
            let fit = Fit {
                torse: trim.form.torse()?.clone(),
                kind: p.strip.kind,
                ..(**out.panels.get(&trim.label)?).clone()
            };
            out.panels.insert(trim.label, Arc::new(fit));
        }
        Some(out)
    }
}
