//! The fewest ruled strips over one piece of a face: families of curves for rulings and sorts of strip boundaries are
//! looked at through the chords that they make, those that promise the fewest strips are tried, each with more strips until
//! samples keep to the tolerance \[W15, 2C\].

use super::left_out::LeftOut;
use super::region::FacePiece;
use crate::control::Control;
use crate::fit::panels::boundary::ruled::AssignedStrip;
use crate::fit::panels::boundary::{Borders, BoundaryOptions};
use crate::fit::panels::chains;
use crate::fit::ruled::chart::{across, Across, Boundaries, Chart};
use crate::fit::ruled::directions::{samples, Family, Sample};
use crate::fit::ruled::solve::{solve, SolveOptions, Strips};
use crate::fit::ruled::strip_map::{strip, RuledStrip};
use crate::geom::inside::Inside;
use crate::geom::{Vec2, Vec3};
use crate::num::parallel;
use crate::patchwork::panel::{Coedge, Panel, PanelForm, Patchwork};
use crate::patchwork::partition::{edges, Partition};

/// What is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct RuledOptions {
    /// Distance allowed between face and strips, both ways, mm.
    pub tolerance: f64,
    /// Greatest length of rulings, which is the width of strips, mm; default none.
    pub width: Option<f64>,
    /// Whether the rulings of each strip are to be parallel to a plane; default no.
    pub conoidal: bool,
}

/// Strips of one piece.
pub(super) struct Found {
    pub patchwork: Patchwork,
    /// See [`super::RuledFace::directing`].
    pub directing: Vec<Option<Vec3>>,
    /// Greatest distance of samples from the face and of borders from where they belong, mm; infinite where samples show
    /// that nothing can be proven.
    pub distance_estimate: f64,
    /// Number of strips, those that fall apart counted once.
    pub count: usize,
}

/// Most strips that are tried on a piece that can still be cut, and on one that cannot.
const MOST_STRIPS: [usize; 2] = [24, 60];
/// Coordinates that are tried, those first that promise the fewest strips.
const TRIED: usize = 3;
/// Chords may be this many times as far from the face as strips: these are placed between both sides of it, and bend.
const LIKELY: f64 = 8.0;
/// Places along strip boundaries at which chords are looked at.
const CHORDS: usize = 24;
/// Places on chords: in the middle, and where third powers are greatest.
const ON_CHORD: [f64; 3] = [0.5, 0.21, 0.79];
/// Growth of the number of strips whose chords are looked at.
const GROWTH: f64 = 1.1;
/// Spans of boundary curves tried, fewest first.
const SPANS: [usize; 4] = [6, 12, 24, 48];
/// Spans times strips at most: systems of more take seconds.
const MOST_SPANS: usize = 480;
/// Weight of smooth joins, and those that are tried where strips keep to the tolerance, the greatest first.
const SMOOTH: f64 = 2.0;
/// See [`SMOOTH`].
const SMOOTHER: [f64; 2] = [64.0, 16.0];
/// More spans are tried while they leave less than this share of the distance.
const BETTER: f64 = 0.85;
/// Charts whose rulings keep less than this angle (sine) to strip boundaries are not tried.
const LEAST_SINE: f64 = 0.2;
/// Charts whose level lines turn more than this from the straightest directions are not tried, rad.
const MOST_ANGLE: f64 = 0.35;
/// Room beyond the outermost strip boundaries, share of a strip's width: these slide a little along rulings.
const ROOM: f64 = 0.08;
/// Share of the tolerance that trimming curves may keep from the border, and edges in space from these.
const TRIM_SHARE: [f64; 2] = [1.0 / 250.0, 1.0 / 2500.0];
/// Distance of the maps of strips from feet, share of the tolerance.
const MAP: f64 = 0.05;
/// Places across and along strips at which their distance is looked at.
const LOOKS: [usize; 2] = [60, 8];
/// Trimming curves may seem to leave their patch by this share of a ruling.
const ROUNDING: f64 = 1e-12;
/// See [`directing_normal`].
const TRACE: f64 = 1e-3;
/// How far conoidal strips overlap, and from how far beyond them samples are taken, shares of their width.
const OVERLAP: (f64, f64) = (0.01, 0.3);

/// One way to lay strips over a piece.
struct Layout {
    /// Values of the strip boundaries' function.
    levels: Vec<f64>,
    /// Strips with common boundary curves, in coordinates: one row of all strips, or one row for each.
    rows: Vec<(Chart, Strips)>,
    /// Greatest distance of samples, mm.
    distance_estimate: f64,
}

/// Coordinates for strips of a piece.
struct Plan {
    chart: Chart,
    samples: Vec<Sample>,
    asymptotic: bool,
}

/// A piece and what is asked of its strips.
pub(super) struct PlannedPiece<'a> {
    piece: &'a FacePiece,
    outline: Outline,
    options: &'a RuledOptions,
    /// Whether rulings may follow parameter lines.
    any: bool,
    plans: Vec<Plan>,
    /// Fewer strips than this were not enough for a looser goal, plan by plan.
    least: Vec<usize>,
}

impl<'a> PlannedPiece<'a> {
    /// Coordinates for strips: both families of asymptotic curves and three sorts of boundaries; parameter lines too if
    /// `any` may do, or where they are nearly straight all over the piece.
    ///
    /// # Errors
    /// No coordinates.
    pub fn new(piece: &'a FacePiece, options: &'a RuledOptions, any: bool, control: &Control) -> Result<Self, LeftOut> {
        let outline = Outline::of_piece(&piece.partition);
        let plans = plans(piece, control);
        let mut out = Self { piece, outline, options, any, plans, least: Vec::new() };
        let straight = |p: &Plan| out.chords(&p.chart, &out.levels(p, 1)).0 <= options.tolerance;
        let keep: Vec<bool> = out.plans.iter().map(|p| any || p.asymptotic || straight(p)).collect();
        let mut keep = keep.into_iter();
        out.plans.retain(|_| keep.next().unwrap_or(false));
        out.least = vec![1; out.plans.len()];
        if out.plans.is_empty() {
            let around = piece.around();
            return Err(if control.stopped() { LeftOut::Stopped { around } } else { LeftOut::NoNet { around } });
        }
        Ok(out)
    }

    /// Strips whose samples keep to `goal` (mm), as panels.
    ///
    /// # Errors
    /// Why there are none.
    pub fn strips(&mut self, goal: f64, tolerance: f64, control: &Control) -> Result<Found, LeftOut> {
        let hopes: Vec<Option<usize>> = self.plans.iter().map(|p| self.likely(p, goal)).collect();
        // Asymptotic curves first where as many strips do: neighbours meet smoothly along them.
        let mut order: Vec<usize> = (0..self.plans.len()).filter(|&k| hopes[k].is_some()).collect();
        order.sort_by_key(|&k| (hopes[k], !self.plans[k].asymptotic));
        let around = self.piece.around();
        let mut reason = LeftOut::Many { around, most: self.most() };
        let mut best: Option<Found> = None;
        order.truncate(TRIED);
        for k in order {
            // Another way must need fewer strips than one that is good.
            let good = best.as_ref().filter(|b| b.distance_estimate <= tolerance);
            let most = good.map_or(self.most(), |b| b.count - 1);
            let count = hopes[k].unwrap_or(1).max(self.least[k]);
            let layout = self.fewest(&self.plans[k], [count, most], goal, control);
            self.least[k] = layout.as_ref().map_or_else(|count| *count, |l| l.levels.len() - 1);
            match layout.ok().map(|l| self.build(&l, tolerance)) {
                Some(Ok(found)) => {
                    let better = |b: &Found| found.distance_estimate < b.distance_estimate || good.is_some();
                    if best.as_ref().is_none_or(better) {
                        best = Some(found);
                    }
                }
                Some(Err(e)) => reason = e,
                None => {}
            }
        }
        if control.stopped() {
            reason = LeftOut::Stopped { around };
        }
        best.ok_or(reason)
    }

    /// Most strips that are tried.
    fn most(&self) -> usize {
        MOST_STRIPS[usize::from(self.any)]
    }

    /// Values of the boundaries of so many strips.
    fn levels(&self, plan: &Plan, count: usize) -> Vec<f64> {
        let (lo, hi) = plan.chart.reach(&plan.samples);
        let room = ROOM * (hi - lo) / count as f64;
        (0..=count).map(|k| lo - room + (hi - lo + 2.0 * room) * k as f64 / count as f64).collect()
    }

    /// How far chords between boundaries on the face are from it, and the longest of them, mm.
    fn chords(&self, chart: &Chart, levels: &[f64]) -> (f64, f64) {
        let surface = &self.piece.face.surface;
        let (lo, hi) = chart.places.knots_s.domain();
        let (mut far, mut longest) = (0.0f64, 0.0f64);
        for i in 0..=CHORDS {
            let s = lo + (hi - lo) * i as f64 / CHORDS as f64;
            let uv = |b: f64| chart.places.jet(s, b).p;
            for w in levels.windows(2) {
                let at = |t: f64| uv(w[0] + t * (w[1] - w[0]));
                let inner = ON_CHORD.map(at);
                if !inner.iter().any(|p| self.outline.contains(*p)) {
                    continue;
                }
                let ends = [at(0.0), at(1.0)].map(|p| surface.extended_jet(p[0], p[1]).p);
                for (t, p) in ON_CHORD.iter().zip(&inner).filter(|p| self.outline.contains(*p.1)) {
                    let j = surface.extended_jet(p[0], p[1]);
                    let n = j.normal().try_normalize(0.0).unwrap_or_default();
                    far = far.max(n.dot(&(ends[0] * (1.0 - t) + ends[1] * *t - j.p)).abs());
                }
                longest = longest.max((ends[1] - ends[0]).norm());
            }
        }
        (far, longest)
    }

    /// The least number of strips that chords promise; `None` if it is too large.
    fn likely(&self, plan: &Plan, goal: f64) -> Option<usize> {
        let width = self.options.width.unwrap_or(f64::INFINITY);
        let mut count = 1;
        while count <= self.most() {
            let (far, longest) = self.chords(&plan.chart, &self.levels(plan, count));
            if far <= LIKELY * goal && longest <= width {
                return Some(count);
            }
            count = (count + 1).max((count as f64 * GROWTH) as usize);
        }
        None
    }

    /// The fewest strips in given coordinates, so many at least and at most; else how many are left to be tried.
    fn fewest(
        &self,
        plan: &Plan,
        [mut count, most]: [usize; 2],
        goal: f64,
        control: &Control,
    ) -> Result<Layout, usize> {
        let Plan { chart, samples, .. } = plan;
        while count <= most && !control.stopped() {
            let levels = self.levels(plan, count);
            let rows: Option<Vec<(Chart, Strips)>> = if self.options.conoidal {
                let conoid = |w: &[f64]| self.conoid(chart, samples, [w[0], w[1]], goal);
                parallel::map(levels.windows(2), conoid).into_iter().collect()
            } else {
                self.smoothest(chart, &levels, goal).map(|s| vec![(chart.clone(), s)])
            };
            let distance = rows.as_ref().map(|r| r.iter().fold(0.0, |m, r| r.1.distance_estimate.max(m)));
            if let (Some(rows), Some(distance_estimate)) = (rows, distance.filter(|d| *d <= goal)) {
                return Ok(Layout { levels, rows, distance_estimate });
            }
            // The distance falls with the third power of the width, for conoids with the second.
            let share = distance.map(|d| d / goal);
            let more = share.map_or(2.0, |s| if self.options.conoidal { s.sqrt() } else { s.cbrt() }).min(2.0);
            count = ((count as f64 * more.max(GROWTH)) as usize).max(count + 1);
        }
        Err(count)
    }

    /// Strips between levels, with as few spans as do, and among these the smoothest that keep to the goal.
    fn smoothest(&self, chart: &Chart, levels: &[f64], goal: f64) -> Option<Strips> {
        let found = self.nearest(chart, levels, goal)?;
        if levels.len() < 3 || found.distance_estimate > goal {
            return Some(found);
        }
        let inside = |p: [f64; 2]| self.outline.contains(p);
        let spans = found.curves[0].knots.breaks().len() - 1;
        let smoother = |smooth: f64| {
            let border = self.outline.points().collect();
            let asked = SolveOptions { levels: levels.to_vec(), spans, border, smooth };
            solve(&self.piece.face.surface, chart, &inside, &asked).filter(|s| s.distance_estimate <= goal)
        };
        Some(SMOOTHER.into_iter().find_map(smoother).unwrap_or(found))
    }

    /// Strips between levels, with as few spans as do.
    fn nearest(&self, chart: &Chart, levels: &[f64], goal: f64) -> Option<Strips> {
        let inside = |p: [f64; 2]| self.outline.contains(p);
        let mut best: Option<Strips> = None;
        let count = levels.len() - 1;
        for spans in SPANS.into_iter().filter(|s| *s == SPANS[0] || s * count <= MOST_SPANS) {
            let border = self.outline.points().collect();
            let asked = SolveOptions { levels: levels.to_vec(), spans, border, smooth: SMOOTH };
            let Some(found) = solve(&self.piece.face.surface, chart, &inside, &asked) else { break };
            let better = best.as_ref().is_none_or(|b| found.distance_estimate < BETTER * b.distance_estimate);
            let good = found.distance_estimate <= goal;
            if better {
                best = Some(found);
            }
            if good || !better {
                break;
            }
        }
        best
    }

    /// The conoidal strip between two levels.
    fn conoid(&self, chart: &Chart, samples: &[Sample], [lo, hi]: [f64; 2], goal: f64) -> Option<(Chart, Strips)> {
        let (overlap, far) = (OVERLAP.0 * (hi - lo), OVERLAP.1 * (hi - lo));
        let near = |s: &&Sample| {
            let b = chart.along.value(s.uv);
            b >= lo - far && b <= hi + far
        };
        let samples: Vec<Sample> = samples.iter().filter(near).copied().collect();
        let parallel = chart.parallel(&samples, directing_normal(&samples)?)?;
        let strips = self.smoothest(&parallel, &[lo - overlap, hi + overlap], goal)?;
        Some((parallel, strips))
    }

    /// Panels of strips.
    fn build(&self, layout: &Layout, tolerance: f64) -> Result<Found, LeftOut> {
        let piece = self.piece;
        let around = piece.around();
        let mut partition = piece.partition.clone();
        let count = layout.levels.len() - 1;
        let along = &layout.rows[0].0.along;
        for k in 1..count {
            partition.cut(k as u32 - 1, k as u32, |p| along.value(p) - layout.levels[k]);
        }
        let mut of_label: Vec<(u32, usize)> = Vec::new();
        for k in 0..count {
            if !partition.region(k as u32).is_empty() {
                of_label.extend(partition.split_components(k as u32).into_iter().map(|l| (l, k)));
            }
        }
        let alone = layout.rows.len() == count && count > 1;
        let inside = |p: [f64; 2]| self.outline.contains(p);
        let made: Option<Vec<RuledStrip>> = parallel::map(0..count, |k| {
            let (chart, strips) = &layout.rows[if alone { k } else { 0 }];
            let own = if alone { 0 } else { k };
            strip(&piece.face.surface, chart, (strips, own), &inside, MAP * tolerance)
        })
        .into_iter()
        .collect();
        let made = made.ok_or(LeftOut::NoMap { around })?;
        let trim_edge = |a: u32, b: u32| partition.trim_edges.get(&(a, b)).copied().unwrap_or(0);
        let borders = Borders::new(&piece.face, &partition, &trim_edge, 0);
        let assigned: Vec<AssignedStrip> = of_label
            .iter()
            .map(|&(label, k)| AssignedStrip { label, strip: &made[k], row: (!alone).then_some((0, k)) })
            .collect();
        let [trim_tolerance, edge_tolerance] = TRIM_SHARE.map(|s| s * tolerance);
        let panels = borders.ruled_panels(0, &assigned, &BoundaryOptions { trim_tolerance, edge_tolerance });
        let panels: Result<Vec<_>, _> = panels.into_iter().collect();
        let panels = panels.map_err(|source| LeftOut::Border { around, source })?;
        let seam_count = borders.seam_count;
        drop(borders);
        let directing = of_label.iter().map(|&(_, k)| match layout.rows[if alone { k } else { 0 }].0.across {
            Across::Height(m) => Some(m),
            Across::Level(_) => None,
        });
        let directing = directing.collect();
        let patchwork = Patchwork {
            faces: vec![piece.face.clone()],
            partitions: vec![partition],
            panels,
            seam_count,
            joint_count: 0,
        };
        let distance_estimate = farthest(&patchwork).max(layout.distance_estimate);
        Ok(Found { patchwork, directing, distance_estimate, count })
    }
}

/// The greatest distance of many places of panels from their faces, with what borders are off where they belong, mm;
/// infinite where a border leaves its panel or a map to the face folds over.
fn farthest(patchwork: &Patchwork) -> f64 {
    let of = |panel: &Panel| {
        let (Some(trim), Some(face), Some(partition)) =
            (&panel.trim, patchwork.face_of(panel), patchwork.partition_of(panel))
        else {
            return f64::INFINITY;
        };
        let PanelForm::Ruled(map) = &trim.form else { return f64::INFINITY };
        let at = |uv: [f64; 2]| face.surface.extended_jet(uv[0], uv[1]).p;
        let far = |[s, t]: [f64; 2]| (at(map.jet(s, t).p) - panel.strip.patch.point(s, t)).norm();
        let mut off = 0.0f64;
        for run in trim.loops.iter().flatten() {
            for (v, s) in run.vertices.iter().zip(&run.parameters) {
                let [x, y] = run.trim.point(*s);
                off = off.max((at(map.jet(x, y).p) - at(partition.vertices[*v as usize])).norm());
            }
        }
        let points =
            |run: &Coedge| (0..LOOKS[0]).map(|k| run.trim.point(k as f64 / LOOKS[0] as f64)).collect::<Vec<_>>();
        let loops: Vec<Vec<[f64; 2]>> = trim.loops.iter().map(|l| l.iter().flat_map(points).collect()).collect();
        let (a, b) = panel.strip.domain();
        if loops.iter().flatten().any(|p| (p[1] - 0.5).abs() > 0.5 + ROUNDING || p[0] < a || p[0] > b) {
            return f64::INFINITY;
        }
        let outline = Outline::of(loops);
        let places = (1..LOOKS[0]).flat_map(|i| (1..LOOKS[1]).map(move |j| (i, j)));
        let places = places.map(|(i, j)| [a + (b - a) * i as f64 / LOOKS[0] as f64, j as f64 / LOOKS[1] as f64]);
        let inner: Vec<[f64; 2]> = places.filter(|p| outline.contains(*p)).collect();
        let turn = |p: &[f64; 2]| {
            let j = map.jet(p[0], p[1]);
            (j.ds[0] * j.dt[1] - j.ds[1] * j.dt[0]).signum()
        };
        let all = || inner.iter().chain(outline.loops.iter().flatten());
        if all().any(|p| turn(p) != turn(&outline.loops[0][0])) {
            return f64::INFINITY;
        }
        off + all().map(|p| far(*p)).fold(0.0, f64::max)
    };
    parallel::map(patchwork.panels.iter(), of).into_iter().fold(0.0, f64::max)
}

/// Coordinates for strips along all families of curves, with three sorts of boundaries.
fn plans(piece: &FacePiece, control: &Control) -> Vec<Plan> {
    let places: Vec<_> = piece.partition.vertices.iter().copied().zip(piece.jets.iter().copied()).collect();
    let mut pairs: Vec<[usize; 2]> = piece
        .partition
        .triangles
        .iter()
        .flat_map(|t| edges(*t))
        .map(|(a, b)| [a.min(b) as usize, a.max(b) as usize])
        .collect();
    pairs.sort_unstable();
    pairs.dedup();
    parallel::map([Family::Left, Family::Right, Family::AlongU, Family::AlongV], |family| {
        let samples = samples(&places, &pairs, family).unwrap_or_default();
        let level = if control.stopped() { None } else { across(&samples) };
        let asymptotic = family.is_asymptotic();
        let of = move |b| {
            let chart = Chart::new(&samples, Across::Level(level.clone()?), b)?;
            let clear = chart.least_angle_sine > LEAST_SINE && chart.angle_estimate < MOST_ANGLE;
            clear.then(|| Plan { chart, samples: samples.clone(), asymptotic })
        };
        let sorts = [Boundaries::AlongU, Boundaries::AlongV, Boundaries::Square];
        sorts.into_iter().filter_map(of).collect::<Vec<_>>()
    })
    .into_iter()
    .flatten()
    .collect()
}

/// Unit normal of the plane to which the rulings at samples are most nearly parallel, against the directions across
/// them: the least eigenvector of `Σ d dᵀ` relative to `Σ n nᵀ`.
fn directing_normal(samples: &[Sample]) -> Option<Vec3> {
    let sum = |axis: usize| {
        samples.iter().map(|s| s.axes[axis] * s.axes[axis].transpose() * s.weight).sum::<nalgebra::Matrix3<f64>>()
    };
    let (along, across) = (sum(0), sum(1));
    // Directions square to all n are no normals; a trace of the identity keeps the second matrix regular.
    let root = (across + nalgebra::Matrix3::identity() * (TRACE * across.trace())).cholesky()?;
    let inverse = root.l().try_inverse()?;
    let eigen = (inverse * along * inverse.transpose()).symmetric_eigen();
    let least = eigen.eigenvalues.imin();
    (inverse.transpose() * eigen.eigenvectors.column(least)).try_normalize(0.0)
}

/// The border of a piece, or of a strip, in its parameter plane.
struct Outline {
    loops: Vec<Vec<[f64; 2]>>,
    inside: Inside,
}

impl Outline {
    fn of_piece(partition: &Partition) -> Self {
        let corners = |l: Vec<u32>| l.iter().map(|v| partition.vertices[*v as usize]).collect();
        Self::of(chains::loops(partition, 0).into_iter().map(corners).collect())
    }

    fn of(loops: Vec<Vec<[f64; 2]>>) -> Self {
        let flat: Vec<Vec<Vec2>> = loops.iter().map(|l| l.iter().map(|p| Vec2::from(*p)).collect()).collect();
        Self { inside: Inside::of(&flat), loops }
    }

    /// Its corners.
    fn points(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.loops.iter().flatten().copied()
    }

    /// By the even-odd rule.
    fn contains(&self, p: [f64; 2]) -> bool {
        self.inside.holds(&Vec2::from(p))
    }
}
