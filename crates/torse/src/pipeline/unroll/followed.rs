//! One curve, point or text of the model on all parts.

use crate::answer::note::OffFaces;
use crate::brep::free_curve::{FreeCurve, FreeShape};
use crate::develop::carried::{Carried, CarryOptions, Path, Skin, Target};
use crate::draw::stroke_font::strokes;
use crate::geom::{Vec2, Vec3};
use crate::patchwork::pattern::MarkLine;

/// Share of the tolerance for chords that follow curves, and as much for the lines and arcs that are drawn for them.
const DRAWN: f64 = 0.25;
/// Way along the base line of a text, against its height, by which its direction on the part is found.
const AHEAD: f64 = 0.1;
/// Points of a curve off the faces at which its distance is measured at most.
const LOOKS: usize = 64;

/// What is known of a curve after it was carried over.
#[derive(Default)]
pub(super) struct Found {
    /// Parts and skins with what is drawn there, without labels.
    pub lines: Vec<(usize, Skin, MarkLine)>,
    /// Whether some of it runs along outlines, which are cut.
    pub along_edge: bool,
    /// Greatest distance (mm) from the faces, or from the panels that cover them.
    pub distance: f64,
    /// Greatest distance (mm) of the lines from its image.
    pub deviation: f64,
    /// What of it lies on no part.
    pub off: Option<OffFaces>,
}

/// A curve on all parts.
pub(super) fn one(curve: &FreeCurve, targets: &[Option<Target>], tolerance: f64) -> Found {
    let mut out = Found::default();
    // Of every part the skin that is laid flat, of sheet the other one too.
    let skins = |target: &Target| match target.is_sheet() {
        true => &[Skin::Laid, Skin::Other][..],
        false => &[Skin::Laid],
    };
    let all = targets.iter().enumerate().filter_map(|(k, t)| t.as_ref().map(|t| (k, t)));
    let all = all.flat_map(|(k, t)| skins(t).iter().map(move |skin| (k, t, *skin)));
    match &curve.shape {
        FreeShape::Point(x) => {
            let all = all.filter_map(|(k, target, skin)| Some((k, skin, target.cross(x, tolerance, skin)?)));
            out.mark(all, (curve, x), targets);
        }
        FreeShape::Text { at, along, up } => {
            let words = strokes(&curve.name, up.norm());
            let way = along.try_normalize(0.0).unwrap_or_else(Vec3::x);
            let step = way * (AHEAD * up.norm());
            let all = all
                .filter_map(|(k, target, skin)| Some((k, skin, target.text((at, &step), &words, (tolerance, skin))?)));
            out.mark(all, (curve, at), targets);
        }
        FreeShape::Curve(pieces) => {
            let path = Path::new(pieces);
            let points = path.points();
            let mut on = vec![false; points.len()];
            for (k, target, skin) in all {
                let options = CarryOptions { within: tolerance, chord: DRAWN * tolerance, skin };
                let Carried { lines, along_edge, distance, deviation, on: own } = target.carried(&path, &options);
                out.lines.extend(lines.into_iter().map(|l| (k, skin, l)));
                out.along_edge |= along_edge;
                out.distance = out.distance.max(distance);
                out.deviation = out.deviation.max(deviation);
                on.iter_mut().zip(own).for_each(|(on, own)| *on |= own);
            }
            out.off = off_faces(curve, (&points, &on), targets);
        }
    }
    out
}

impl Found {
    /// Lines about a place: parts and skins with lines and the distance (mm) of the place from the part.
    fn mark(
        &mut self,
        all: impl Iterator<Item = (usize, Skin, (Vec<Vec<Vec2>>, f64))>,
        (curve, at): (&FreeCurve, &Vec3),
        targets: &[Option<Target>],
    ) {
        let mut found = false;
        for (k, skin, (lines, off)) in all {
            found = true;
            self.lines.extend(lines.iter().map(|l| (k, skin, MarkLine::straight("", l))));
            self.distance = self.distance.max(off);
        }
        if !found {
            let farthest = nearest(targets, at);
            self.off = Some(OffFaces { curve: curve.called(), off: 0.0, length: 0.0, farthest });
        }
    }
}

/// What of a curve lies on no part.
fn off_faces(curve: &FreeCurve, (points, on): (&[Vec3], &[bool]), targets: &[Option<Target>]) -> Option<OffFaces> {
    let lost: Vec<&Vec3> = points.iter().zip(on).filter(|(_, on)| !**on).map(|(x, _)| x).collect();
    let every = lost.len() / LOOKS + 1;
    let looked = lost.iter().step_by(every).chain(lost.last());
    let farthest = looked.map(|x| nearest(targets, x)).reduce(f64::max)?;
    let chords = || points.windows(2).zip(on.windows(2)).map(|(w, on)| ((w[1] - w[0]).norm(), on[0] && on[1]));
    let length = chords().map(|c| c.0).sum();
    let off = chords().filter(|c| !c.1).map(|c| c.0).sum();
    Some(OffFaces { curve: curve.called(), off, length, farthest })
}

/// Distance (mm) of a point from the nearest part.
fn nearest(targets: &[Option<Target>], x: &Vec3) -> f64 {
    let mut order: Vec<(f64, &Target)> = targets.iter().flatten().map(|t| (t.away(x), t)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best = f64::INFINITY;
    for (least, target) in order {
        if best <= least {
            break;
        }
        best = best.min(target.distance(x));
    }
    best
}
