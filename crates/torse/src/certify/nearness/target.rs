//! The distance between strips and a target, both ways \[MKC09\].

use super::ground::Ground;
use super::piece::Piece;
use super::{farthest, Nearness};
use crate::brep::face::Face;
use crate::certify::claim::UpperBound;
use crate::certify::points::points;
use crate::certify::trimmed::polygon;
use crate::control::Control;
use crate::geom::cloud::Cloud;
use crate::geom::{BBox, Vec3};
use crate::patchwork::panel::Panel;
use crate::spline::surface::Surface;
use crate::torse::strip::Strip;

/// What strips should be near.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Target<'a> {
    /// Faces inside their trims.
    Faces(&'a [Face]),
    /// Triangles; or points, where there are none.
    Cloud(&'a Cloud),
}

/// What is known of the distance between strips and a target.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TargetDistance {
    /// No point of the strips is farther from the target, mm.
    pub there: UpperBound,
    /// No point of the target is farther from the strips, mm.
    pub back: UpperBound,
    /// The greatest distance that was seen, mm, either way.
    pub seen: f64,
    /// Where it was.
    pub place: Vec3,
    /// Why nothing is known of the way there, if that is not for want of time.
    pub open: Option<Open>,
}

/// Why the distance of strips from a target has no bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Open {
    /// Between points without triangles there is nothing to be near.
    Points,
}

/// Bounds the distance between strips and a target; `tolerance` (mm) says how sharp the bounds should be.
///
/// *Guaranteed*: for every point of the strips as they are given, and for every point of the faces inside their trims (with
/// what these are proven to keep from the file's edges), of the triangles, or of the points. Nothing that is cut away counts as
/// near. *Not guaranteed*: anything about the way to points without triangles; it stays unknown.
pub(crate) fn distance_from(strips: &[&Strip], target: Target, tolerance: f64, control: &Control) -> TargetDistance {
    let bbox =
        BBox::of(strips.iter().flat_map(|s| [s.patch.bbox().min, s.patch.bbox().max]).collect::<Vec<_>>().iter());
    let origin: [f64; 3] = bbox.center().into();
    match target {
        Target::Faces(faces) => {
            let own: Vec<Surfaces> = strips.iter().map(|s| (&s.patch, &[][..])).collect();
            from_faces(&own, faces, origin, tolerance, control)
        }
        Target::Cloud(cloud) => match Ground::mesh(cloud, origin) {
            Some(mesh) => {
                let corner = |i: u32| cloud.points[i as usize];
                let pieces: Vec<Piece> =
                    cloud.triangles.iter().map(|t| Piece::triangle(t.map(corner), origin, None)).collect();
                let own: Vec<Piece> = strips.iter().map(|s| Piece::surface(&s.patch, origin, &[])).collect();
                let there = farthest(&own, &mesh, tolerance, control);
                let ground = Ground::surfaces(strips.iter().map(|s| &s.patch).collect(), origin);
                both(Some(there), farthest(&pieces, &ground, tolerance, control), None)
            }
            None => {
                let strips: Vec<Strip> = strips.iter().map(|s| (*s).clone()).collect();
                let found = points(&strips, &cloud.points, control);
                let worst = found.worst();
                let seen = worst.map_or(0.0, |i| found.bounds()[i]);
                let place = worst.map_or_else(Vec3::zeros, |i| cloud.points[i]);
                both(None, Nearness { bound: found.worst_bound(), seen, place }, Some(Open::Points))
            }
        },
    }
}

/// A surface and what counts of it: closed polygons of its parameter plane, or all of it.
type Surfaces<'a> = (&'a Surface, &'a [Vec<[f64; 2]>]);

/// As [`distance_from`], between panels, what lies inside their outlines, and faces inside their trims. `None` for panels whose
/// outlines are no polygons of their parameter planes.
pub(crate) fn panels_from_faces(
    panels: &[&Panel],
    faces: &[Face],
    tolerance: f64,
    control: &Control,
) -> Option<TargetDistance> {
    let polygons: Vec<Vec<Vec<[f64; 2]>>> =
        panels.iter().map(|p| p.loops().iter().map(|l| polygon(l)).collect()).collect::<Option<_>>()?;
    let own: Vec<Surfaces> = panels.iter().zip(&polygons).map(|(p, l)| (&p.strip.patch, &l[..])).collect();
    let corners = panels.iter().flat_map(|p| [p.strip.patch.bbox().min, p.strip.patch.bbox().max]);
    let origin = BBox::of(corners.collect::<Vec<_>>().iter()).center().into();
    Some(from_faces(&own, faces, origin, tolerance, control))
}

fn from_faces(own: &[Surfaces], faces: &[Face], origin: [f64; 3], tolerance: f64, control: &Control) -> TargetDistance {
    let polygons: Vec<Vec<Vec<[f64; 2]>>> = faces
        .iter()
        .map(|f| if is_whole(f) { Vec::new() } else { f.loops.iter().map(|l| l.points.clone()).collect() })
        .collect();
    let each = || faces.iter().zip(&polygons).map(|(f, p)| (&f.surface, &p[..]));
    let mine: Vec<Piece> = own.iter().map(|(s, p)| Piece::surface(s, origin, p)).collect();
    let mut there = farthest(&mine, &Ground::faces(each(), origin), tolerance, control);
    let pieces: Vec<Piece> = each().map(|(s, p)| Piece::surface(s, origin, p)).collect();
    let mut back = farthest(&pieces, &Ground::faces(own.iter().copied(), origin), tolerance, control);
    let trims = faces.iter().map(|f| f.trim_bound() + f.joint_bound()).fold(0.0, f64::max);
    let trims = UpperBound::shown(trims);
    back.bound = back.bound.plus(trims);
    there.bound = there.bound.plus(trims);
    both(Some(there), back, None)
}

fn both(there: Option<Nearness>, back: Nearness, open: Option<Open>) -> TargetDistance {
    let farther = there.filter(|t| t.seen > back.seen).unwrap_or(back);
    TargetDistance {
        there: there.map_or(UpperBound::UNKNOWN, |t| t.bound),
        back: back.bound,
        seen: farther.seen,
        place: farther.place,
        open,
    }
}

/// Whether a face is all of its surface: one loop along the border of the domain, around its corners.
fn is_whole(face: &Face) -> bool {
    let ((u0, u1), (v0, v1)) = face.surface.domain();
    let [outer] = &face.loops[..] else { return false };
    let has = |u: f64, v: f64| outer.points.iter().any(|p| p[0] == u && p[1] == v);
    let n = outer.points.len();
    // A side is on the border if both of its ends are on one line of it.
    let along = |k: usize| {
        let (p, q) = (outer.points[k], outer.points[(k + 1) % n]);
        [(0, u0), (0, u1), (1, v0), (1, v1)].iter().any(|&(d, x)| p[d] == x && q[d] == x)
    };
    (0..n).all(along) && has(u0, v0) && has(u1, v0) && has(u1, v1) && has(u0, v1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::face::TrimLoop;
    use crate::patchwork::panel::{Border, Coedge};
    use crate::spline::curve::Curve;
    use crate::spline::knots::Knots;
    use crate::torse::form::PanelKind;

    fn face(height: f64, width: f64) -> Face {
        let knots = || Knots::clamped(1, &[0.0, 1.0]).expect("knots");
        let at = |x: f64, y: f64| Vec3::new(width * x, 30.0 * y, height);
        let corners = [at(0.0, 0.0), at(0.0, 1.0), at(1.0, 0.0), at(1.0, 1.0)];
        Face::untrimmed(Surface::new(knots(), knots(), &corners, None).expect("a plane"))
    }

    /// A plane strip of 50 by 30 that rises by `rise`.
    fn strip(rise: f64) -> Strip {
        let side = |y: f64| {
            let ends = vec![[0.0, y, 0.0], [50.0, y, rise]];
            Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], ends).expect("a curve")
        };
        Strip::polynomial("s", PanelKind::Plane, &side(0.0), &side(30.0)).expect("a strip")
    }

    fn found(strip: &Strip, target: Target) -> TargetDistance {
        distance_from(&[strip], target, 0.1, &Control::default())
    }

    #[test]
    fn both_ways_are_bounded_and_differ_where_one_goes_on() {
        let faces = [face(2.0, 80.0)];
        let flat = found(&strip(0.0), Target::Faces(&faces));
        assert!(flat.there.value() >= 2.0 && flat.there.value() < 2.07, "{flat:?}");
        // The face goes on by 30 beyond the strip.
        let far = 904f64.sqrt();
        assert!(flat.back.value() >= far && flat.back.value() < 1.04 * far && flat.open.is_none(), "{flat:?}");
        assert!((flat.place.x - 80.0).abs() < 2.0, "{flat:?}");
    }

    #[test]
    fn what_is_cut_away_is_not_near() {
        let mut cut = [face(2.0, 50.0)];
        cut[0].loops[0].points = vec![[0.0, 0.0], [0.5, 0.0], [0.5, 1.0], [0.0, 1.0]];
        let found = found(&strip(8.0), Target::Faces(&cut));
        // The end of the strip is 25 beyond the border, and 6 above the face.
        let far = 661f64.sqrt();
        assert!(found.there.value() >= far && found.there.value() < 1.04 * far, "{found:?}");
        // Up to the middle the strip is at most 2 away; at the far end it is 6.
        assert!(found.back.value() >= 1.9 && found.back.value() < 2.2, "{found:?}");
    }

    #[test]
    fn a_hole_is_as_far_as_its_middle_from_its_rim() {
        let mut holed = [face(0.25, 50.0)];
        let hole = |k: usize| {
            let a = -f64::from(k as u32) * std::f64::consts::TAU / 32.0;
            [0.4 + 6.0 * a.cos() / 50.0, 0.5 + 6.0 * a.sin() / 30.0]
        };
        let mut rim = holed[0].loops[0].clone();
        rim.points = (0..32).map(hole).collect();
        holed[0].loops.push(rim);
        let found = found(&strip(0.0), Target::Faces(&holed));
        // The rim's sides are a little inside its circle.
        let far = (36.0 * (std::f64::consts::PI / 32.0).cos().powi(2) + 0.0625).sqrt();
        assert!(found.there.value() >= far && found.there.value() < 1.04 * far, "{found:?} {far}");
        assert!(found.back.value() >= 0.25 && found.back.value() < 0.27, "{found:?}");
    }

    #[test]
    fn a_face_cut_to_the_strip_is_near_all_along_its_border() {
        // A larger face, cut along slanting lines that the strip's border follows nearly.
        let mut cut = [face(0.05, 200.0)];
        cut[0].loops[0].points = vec![[0.001, 0.002], [0.249, 0.001], [0.2495, 0.998], [0.0005, 0.999]];
        let found = found(&strip(0.0), Target::Faces(&cut));
        assert!(found.there.value() >= 0.2 && found.there.value() < 0.5, "{found:?}");
        assert!(found.back.value() >= 0.05 && found.back.value() < 0.06, "{found:?}");
    }

    #[test]
    fn long_borders_along_each_other_are_bounded_sharply() {
        let mut cut = [face(0.05, 5000.0)];
        let hole = |k: u32| (f64::from(k) * -std::f64::consts::TAU / 64.0).sin_cos();
        let ring: Vec<[f64; 2]> = (0..64).map(hole).map(|(s, c)| [0.5 + 0.1 * c, 0.5 + 0.3 * s]).collect();
        let polygons = [vec![[0.01, 0.02], [0.97, 0.05], [0.99, 0.98], [0.02, 0.9]], ring];
        let outline = polygons.iter().map(|corners| {
            let control: Vec<[f64; 2]> = corners.iter().chain(corners.first()).copied().collect();
            let at: Vec<f64> = (0..control.len()).map(|k| k as f64 / (control.len() - 1) as f64).collect();
            let knots = Knots::clamped(1, &at).expect("knots");
            let edge = control.iter().map(|q| [5000.0 * q[0], 30.0 * q[1], 0.0]).collect();
            vec![Coedge {
                border: Border::Trim { edge: 0 },
                vertices: Vec::new(),
                parameters: Vec::new(),
                edge: Curve { knots: knots.clone(), control: edge },
                trim: Curve { knots, control },
            }]
        });
        let side = |y: f64| {
            let ends = vec![[0.0, y, 0.0], [5000.0, y, 0.0]];
            Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], ends).expect("a curve")
        };
        let strip = Strip::polynomial("s", PanelKind::Plane, &side(0.0), &side(30.0)).expect("a strip");
        let panel = Panel { outline: outline.collect(), ..Panel::from(strip) };
        cut[0].loops[0].points.clone_from(&polygons[0]);
        cut[0].loops.push(TrimLoop { points: polygons[1].clone(), edge: vec![1; 64] });
        let found = |faces: &[Face]| panels_from_faces(&[&panel], faces, 0.1, &Control::default()).expect("polygons");
        let along = found(&cut);
        assert!(along.there.value() >= 0.05 && along.there.value() < 0.08, "{along:?}");
        assert!(along.back.value() >= 0.05 && along.back.value() < 0.08, "{along:?}");
        // A larger hole in the face: the panel reaches into it by 5 at its sides.
        cut[0].loops[1].points.iter_mut().for_each(|p| p[0] = 0.5 + 1.01 * (p[0] - 0.5));
        let reach = found(&cut);
        assert!(reach.there.value() > 1.0 && reach.back.value() < 0.08, "{reach:?}");
    }

    #[test]
    fn meshes_count_both_ways_and_points_one_way() {
        let corners = [[0.0, 0.0], [50.0, 0.0], [50.0, 30.0], [0.0, 30.0]];
        let points = corners.map(|[x, y]| Vec3::new(x, y, -3.0)).to_vec();
        let mut cloud = Cloud { points, triangles: vec![[0, 1, 2], [0, 2, 3]] };
        let mesh = found(&strip(0.0), Target::Cloud(&cloud));
        assert!(mesh.there.value() >= 3.0 && mesh.there.value() < 3.1 && mesh.back.value() < 3.1, "{mesh:?}");
        cloud.triangles.clear();
        let only = found(&strip(0.0), Target::Cloud(&cloud));
        assert_eq!((only.there, only.open), (UpperBound::UNKNOWN, Some(Open::Points)));
        assert!(only.back.value() >= 3.0 && only.back.value() < 3.001, "{only:?}");
    }
}
