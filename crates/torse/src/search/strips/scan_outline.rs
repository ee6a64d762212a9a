//! Scanned strips, and their flat patterns, cut back to the border of the points \[EKS83\], where these lie on the judged
//! strips; and what the judge says of that.

use super::given_outline::{cut as cut_given, Cut, GivenBorder};
use crate::certify;
use crate::certify::claim::{Claim, Subject, UpperBound, What};
use crate::certify::flat::outlined_parts;
use crate::certify::points::{on_strip, PointCertificate};
use crate::certify::trimmed::{trimmed, Measured, TrimmedCertificate};
use crate::control::Control;
use crate::develop::map::Development;
use crate::develop::mesh_border;
use crate::develop::scanned::{cut_back, outline, sharp, CarriedLoop, ScanOutline, Shown};
use crate::geom::cloud::Cloud;
use crate::geom::{Vec2, Vec3};
use crate::patchwork::panel::Panel;
use crate::patchwork::pattern::{Contour, Pattern};
use crate::reason::{Item, Reason, StripReason};
use crate::search::strips::cut::Laid;
use crate::torse::strip::Strip;
use std::collections::{BTreeSet, HashMap};

/// Outlines that follow measured points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outlines {
    /// Spacing of the points, mm.
    pub spacing: f64,
    /// Holes that are cut out.
    pub holes: usize,
    /// Holes of a few spacings that are not.
    pub closed: usize,
    /// Points that lie apart.
    pub stray: usize,
}

/// Strips as panels, and what is known of where they end.
#[derive(Clone, Debug)]
pub(crate) struct Ended {
    /// The panels.
    pub panels: Vec<Panel>,
    /// Of each what its outline keeps to: no point farther outside, no place inside farther from the points, mm; none of
    /// panels that are whole strips.
    pub keeps: Vec<Option<[f64; 2]>>,
    /// What is known of outlines that follow points; `None` if there are none.
    pub outlines: Option<Outlines>,
    /// Names of the parts that are whole and should not be.
    pub whole: Vec<String>,
}

impl Ended {
    /// Whole strips.
    pub fn whole(strips: Vec<Strip>) -> Self {
        let (keeps, whole) = (vec![None; strips.len()], strips.iter().map(|s| s.name.clone()).collect());
        Self { panels: strips.into_iter().map(Panel::from).collect(), keeps, outlines: None, whole }
    }
}

/// Share of the tolerance by which chords of outlines may lie beside the strips.
const CHORD: f64 = 0.02;
/// The same where rulings or faces are given: their borders are longer curves than those of points.
pub(crate) const GIVEN_CHORD: f64 = 0.05;

/// What outlines follow.
#[derive(Clone, Copy)]
pub(crate) enum Followed<'a> {
    /// Points within a distance (mm) of strips, where these were judged.
    Points(&'a PointCertificate, f64),
    /// Facets of a coarse mesh, for each strip, with the distance (mm) that these may lie off a smooth sheet through their corners.
    Facets(&'a Cloud, &'a [Vec<u32>], f64),
    /// What each strip should end at; `None` where that is nothing, and the strip stays whole.
    Given(&'a [Option<GivenBorder>]),
}

/// Cuts strips and their flat patterns back to the border of what they follow, and has the patterns
/// proven anew. `laid` has one part for each strip; `side` and `tolerance` (mm) are those it was made with.
pub(crate) fn outlined(
    strips: Vec<Strip>,
    laid: &mut Laid,
    followed: Followed,
    side: f64,
    tolerance: f64,
    control: &Control,
) -> Ended {
    let chord = tolerance * if matches!(followed, Followed::Given(_)) { GIVEN_CHORD } else { CHORD };
    let mut loops: Vec<Option<Vec<CarriedLoop>>> = vec![None; strips.len()];
    let mut found: Vec<Option<ScanOutline>> = vec![None; strips.len()];
    let mut there: Vec<Option<[f64; 2]>> = vec![None; strips.len()];
    for pattern in &laid.patterns {
        let k = laid.parts.get(pattern.panel).map_or(usize::MAX, |p| p.first);
        let Some((strip, development)) = strips.get(k).and_then(|s| Some((s, Development::new(&s.patch, side).ok()?)))
        else {
            continue;
        };
        // Patterns are seen from outside or from inside: mirrored where that is the other side.
        let Some(mirrored) = mirrored(pattern, &development) else { continue };
        let shown = Shown { development: &development, patch: &strip.patch, mirrored, chord };
        let cut = match followed {
            Followed::Points(certificate, near) => cut(&shown, k as u32, certificate, near),
            Followed::Facets(cloud, facets, bulge) => {
                facets.get(k).and_then(|f| cut_mesh(&shown, strip, (cloud, &f[..]), bulge, control))
            }
            Followed::Given(borders) => {
                let border = borders.get(k).and_then(Option::as_ref);
                border.and_then(|b| cut_given(&shown, strip, b, tolerance, control))
            }
        };
        if let Some(Cut::Whole(keeps)) = &cut {
            there[k] = Some(*keeps);
        }
        if let Some(Cut::At(outline, carried)) = cut {
            (found[k], loops[k]) = (Some(outline), Some(carried));
        } else {
            // A file holds trimmed panels or whole strips: beside trimmed ones these end where their patches do.
            loops[k] = border(&shown, strip);
        }
    }
    if found.iter().all(Option::is_none) || loops.iter().any(Option::is_none) {
        let (keeps, mut ended) = (there, Ended::whole(strips));
        ended.whole.retain(|name| !ended.panels.iter().zip(&keeps).any(|(p, k)| k.is_some() && p.strip.name == *name));
        return Ended { keeps, ..ended };
    }
    let mut panels: Vec<Panel> = strips.into_iter().map(Panel::from).collect();
    let mut drawn: Vec<Vec<Contour>> = Vec::new();
    for (panel, carried) in panels.iter_mut().zip(loops) {
        let carried = carried.unwrap_or_default();
        panel.outline = carried.iter().map(|l| l.runs.clone()).collect();
        drawn.push(carried.into_iter().map(|l| Contour { vertices: l.contour }).collect());
    }
    let mut anew = Vec::new();
    for pattern in &mut laid.patterns {
        let k = laid.parts.get(pattern.panel).map_or(usize::MAX, |p| p.first);
        if found.get(k).is_some_and(Option::is_some) {
            *pattern = cut_back(pattern, std::mem::take(&mut drawn[k]), chord);
            anew.push(pattern.clone());
        }
    }
    laid.prove_anew(outlined_parts(panels.clone(), &anew, tolerance, control));
    let all = || found.iter().flatten();
    Ended {
        outlines: Some(Outlines {
            spacing: all().map(|f| f.spacing).fold(0.0, f64::max),
            holes: all().map(|f| f.loops.len() - 1).sum(),
            closed: all().map(|f| f.closed).sum(),
            stray: all().map(|f| f.stray).sum(),
        }),
        whole: (panels.iter().zip(&found).zip(&there))
            .filter(|((_, found), there)| found.is_none() && there.is_none())
            .map(|((p, _), _)| p.strip.name.clone())
            .collect(),
        keeps: found.iter().zip(there).map(|(f, there)| f.as_ref().map(|f| f.keeps).or(there)).collect(),
        panels,
    }
}

/// The outline of the points that lie on a strip, in the plane and on its patch.
fn cut(shown: &Shown, strip: u32, certificate: &PointCertificate, near: f64) -> Option<Cut> {
    let own = certificate.places().iter().zip(certificate.bounds()).filter(|(p, b)| p.0 == strip && **b <= near);
    let places: Vec<[f64; 2]> = own.map(|((_, u, v), _)| [f64::from(*u), f64::from(*v)]).collect();
    let points: Vec<Vec2> = places.iter().map(|q| shown.flat(q)).collect();
    let found = outline(&points)?;
    let key = |p: &Vec2| [p.x, p.y].map(|x| (x + 0.0).to_bits());
    let at: HashMap<[u64; 2], [f64; 2]> = points.iter().map(key).zip(places).collect();
    let carried = found.loops.iter().map(|l| {
        let places = l.iter().map(|p| at.get(&key(p)).copied()).collect::<Option<Vec<_>>>()?;
        shown.carried(&places.into_iter().zip(sharp(l)).collect::<Vec<_>>(), true)
    });
    let carried = carried.collect::<Option<Vec<_>>>()?;
    Some(Cut::At(found, carried))
}

/// The border of facets, in the plane and on the patch of their strip. `None` where they are no sheet with one border there.
fn cut_mesh(
    shown: &Shown,
    strip: &Strip,
    (cloud, facets): (&Cloud, &[u32]),
    bulge: f64,
    control: &Control,
) -> Option<Cut> {
    let triangles: Vec<[u32; 3]> = facets.iter().map(|&f| cloud.triangles[f as usize]).collect();
    let corners: Vec<u32> = triangles.iter().flatten().copied().collect::<BTreeSet<u32>>().into_iter().collect();
    let points: Vec<Vec3> = corners.iter().map(|&c| cloud.points[c as usize]).collect();
    let on = certify::points::points(std::slice::from_ref(strip), &points, control);
    let place = |(_, u, v): &(u32, f32, f32)| [f64::from(*u), f64::from(*v)];
    let places: HashMap<u32, [f64; 2]> = corners.iter().copied().zip(on.places().iter().map(place)).collect();
    let flat: HashMap<u32, Vec2> = places.iter().map(|(c, q)| (*c, shown.flat(q))).collect();
    let loops = mesh_border::border(&triangles, &flat)?;
    let drawn: Vec<Vec<Vec2>> = loops.iter().map(|l| l.iter().map(|c| flat[c]).collect()).collect();
    let carried = loops
        .iter()
        .zip(&drawn)
        .map(|(l, drawn)| shown.carried(&l.iter().map(|c| places[c]).zip(sharp(drawn)).collect::<Vec<_>>(), true));
    let carried = carried.collect::<Option<Vec<_>>>()?;
    let outline = ScanOutline { loops: drawn, spacing: 0.0, keeps: [0.0, bulge], closed: 0, stray: 0 };
    Some(Cut::At(outline, carried))
}

/// The border of a whole strip; `None` where a rail is a point.
fn border(shown: &Shown, strip: &Strip) -> Option<Vec<CarriedLoop>> {
    if strip.is_point(0) || strip.is_point(1) {
        return None;
    }
    let (a, b) = strip.domain();
    let corners = [[a, 0.0], [b, 0.0], [b, 1.0], [a, 1.0]].map(|q| (q, true));
    Some(vec![shown.carried(&corners, false)?])
}

/// The panels before their judge. Of a coarse mesh a panel is judged by the corners of its own `facets`, and those of facets
/// without a panel where they are nearest: other panels may lie under its corners, too, and end elsewhere.
fn proofs(
    ended: &Ended,
    cloud: &Cloud,
    certificate: &PointCertificate,
    facets: Option<&[Vec<u32>]>,
    tolerance: f64,
    control: &Control,
) -> Vec<TrimmedCertificate> {
    let (points, between) = (&cloud.points, &[][..]);
    let Some(facets) = facets else {
        let measured = Measured { points, triangles: &[], between, places: certificate };
        return trimmed(&ended.panels, &measured, tolerance, control);
    };
    let corners = |f: &u32| cloud.triangles.get(*f as usize).copied().unwrap_or_default();
    let held: BTreeSet<u32> = facets.iter().flatten().flat_map(corners).collect();
    let one = |(k, panel): (usize, &Panel)| {
        let of_panel = facets.get(k).into_iter().flatten().flat_map(corners);
        let nearest = (0..).zip(certificate.places()).filter(|(c, p)| p.0 as usize == k && !held.contains(c));
        let own: BTreeSet<u32> = of_panel.chain(nearest.map(|n| n.0)).collect();
        let places = on_strip(&panel.strip, points, &own, control);
        let measured = Measured { points, triangles: &cloud.triangles, between, places: &places };
        trimmed(std::slice::from_ref(panel), &measured, tolerance, control)
    };
    ended.panels.iter().enumerate().flat_map(one).collect()
}

/// What the judge says of where panels end; `facets` are those of each panel where the points are the corners of a coarse mesh.
pub(crate) fn claims_of_ends(
    ended: &Ended,
    cloud: &Cloud,
    certificate: &PointCertificate,
    facets: Option<&[Vec<u32>]>,
    tolerance: f64,
    control: &Control,
) -> Vec<Claim> {
    let proofs = proofs(ended, cloud, certificate, facets, tolerance, control);
    let mut out = Vec::new();
    if proofs.is_empty() {
        return out;
    }
    let whole = Subject::Whole;
    let most = |bound: fn(&TrimmedCertificate) -> UpperBound| UpperBound::largest(proofs.iter().map(bound));
    if ended.outlines.is_some() {
        out.push(Claim::at_most(What::BeyondOutline, whole, most(TrimmedCertificate::beyond_bound)));
        out.push(Claim::at_most(What::EdgeDistance, whole, most(TrimmedCertificate::edge_bound)).within(tolerance));
    }
    out.push(Claim::at_most(What::FromMeasured, whole, most(TrimmedCertificate::reach_bound)));
    for (k, proof) in proofs.iter().enumerate() {
        let (subject, name) = (Subject::Panel(k), &ended.panels[k].strip.name);
        let told = |reason: StripReason| Reason::of(Item::Named(name.clone()), reason);
        if let Some((fault, at)) = proof.fault() {
            out.push(Claim::objection(subject, told(StripReason::Outline(fault, at))));
        }
        let beyond = Claim::at_most(What::BeyondOutline, subject, proof.beyond_bound());
        let reach = Claim::at_most(What::FromMeasured, subject, proof.reach_bound());
        let Some([outside, inside]) = ended.keeps[k] else {
            out.push(reach);
            continue;
        };
        let worst = proof.worst().and_then(|i| Some((i, *cloud.points.get(i)?)));
        let [outside, inside] = [outside, inside].map(|x| x + near_points(tolerance));
        let far = told(StripReason::PointOutside { within: outside, worst });
        out.push(beyond.within(outside).because(far));
        let far = told(StripReason::OutlineOutside { within: inside, at: proof.farthest() });
        out.push(reach.within(inside).because(far));
    }
    out
}

/// How far points may lie off a strip and still be on it, mm.
fn near_points(tolerance: f64) -> f64 {
    super::scan::NEAR * tolerance
}

/// Whether a pattern is mirrored against the development that it was drawn from: told by the marks along both rails,
/// whose directions along the strip and across it are not parallel. `None` without such marks.
fn mirrored(pattern: &Pattern, development: &Development) -> Option<bool> {
    let rail = |letter: char| -> Vec<Vec2> {
        pattern.marks.iter().filter(|m| m.label.starts_with(letter)).map(|m| m.point).collect()
    };
    let (a, b) = (rail('A'), rail('B'));
    let middle = |l: &[Vec2]| l.iter().sum::<Vec2>() / l.len() as f64;
    let drawn = [a.last()? - a.first()?, middle(&b) - middle(&a)];
    if b.is_empty() || a.len() < 2 {
        return None;
    }
    let (u0, u1) = development.domain();
    let at = |v: f64| [0.25, 0.5, 0.75].map(|s| development.map(u0 + s * (u1 - u0), v));
    let (c, d) = (at(0.0), at(1.0));
    let made = [c[2] - c[0], middle(&d) - middle(&c)];
    let alike = |flip: f64| -> f64 {
        let pair = |(x, y): (&Vec2, &Vec2)| {
            let y = Vec2::new(flip * y.x, y.y);
            x.dot(&y) / (x.norm() * y.norm()).max(f64::MIN_POSITIVE)
        };
        drawn.iter().zip(&made).map(pair).sum()
    };
    Some(alike(-1.0) > alike(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certify::points::points;
    use crate::patchwork::panel::{Border, Coedge};
    use crate::spline::curve::Curve;
    use crate::spline::knots::Knots;
    use crate::torse::form::PanelKind;

    /// A plane strip of 40 by 10 that ends at two places `x`.
    fn panel(x: [f64; 2]) -> Panel {
        let rail = |y: f64| {
            let ends = vec![[0.0, y, 0.0], [40.0, y, 0.0]];
            Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], ends).expect("a rail")
        };
        let strip = Strip::polynomial("A", PanelKind::Plane, &rail(0.0), &rail(10.0)).expect("a strip");
        let [a, b] = x.map(|x| x / 40.0);
        let control = vec![[a, 0.0], [b, 0.0], [b, 1.0], [a, 1.0], [a, 0.0]];
        let knots = Knots::clamped(1, &[0.0, 0.25, 0.5, 0.75, 1.0]).expect("knots");
        let edge = control.iter().map(|q| strip.patch.point(q[0], q[1])).map(|p| [p.x, p.y, p.z]).collect();
        let run = Coedge {
            border: Border::Trim { edge: 0 },
            vertices: Vec::new(),
            parameters: Vec::new(),
            edge: Curve { knots: knots.clone(), control: edge },
            trim: Curve { knots, control },
        };
        Panel { outline: vec![vec![run]], ..Panel::from(strip) }
    }

    #[test]
    fn corners_of_meshes_are_judged_on_the_panels_of_their_facets() {
        let corners = [0.0, 20.0, 40.0].into_iter().flat_map(|x| [Vec3::new(x, 0.0, 0.0), Vec3::new(x, 10.0, 0.0)]);
        let cloud = Cloud { points: corners.collect(), triangles: vec![[0, 2, 1], [1, 2, 3], [2, 4, 3], [3, 4, 5]] };
        let panels = vec![panel([0.0, 20.0]), panel([20.0, 40.0])];
        let strips: Vec<Strip> = panels.iter().map(|p| p.strip.clone()).collect();
        let ended = Ended { keeps: vec![Some([0.0, 0.5]); 2], panels, ..Ended::whole(strips.clone()) };
        let control = Control::default();
        let certificate = points(&strips, &cloud.points, &control);
        let judged = |facets: &[Vec<u32>]| -> Vec<f64> {
            let proofs = proofs(&ended, &cloud, &certificate, Some(facets), 0.1, &control);
            proofs.iter().map(|p| p.beyond_bound().value()).collect()
        };
        // Both whole strips hold all corners.
        assert!(judged(&[vec![0, 1], vec![2, 3]]).iter().all(|b| *b < 1e-6));
        // Corners of facets without a panel count where they are nearest; those of another panel's facets are missed.
        assert!(judged(&[vec![0, 1], vec![]])[0] > 19.0);
        assert!(judged(&[vec![0, 1, 2, 3], vec![]])[0] > 19.0);
        let claims = claims_of_ends(&ended, &cloud, &certificate, Some(&[vec![0, 1, 2, 3], vec![]]), 0.1, &control);
        let told = format!("{claims:?}");
        assert!(told.contains("PointOutside { within: 0.3"), "{told}");
    }
}
