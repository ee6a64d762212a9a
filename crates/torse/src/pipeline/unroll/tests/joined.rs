//! Parts that share edges carry the same marks on both sides, and the angle along the edge is told.

use super::{model_of, over_parabola, rectangle, tangent_flap};
use crate::answer::Answer;
use crate::brep::face::Face;
use crate::certify::claim::Status;
use crate::control::Control;
use crate::develop::refold::drawn::polygon;
use crate::develop::unfold::tree::Joins;
use crate::geom::polygon::inside;
use crate::geom::{Vec2, Vec3};
use crate::patchwork::pattern::{Contour, Mark, Pattern};
use crate::pipeline::unroll::{unroll, UnrollOptions};
use crate::pipeline::workshop::{prepare, WorkshopOptions};

const TOLERANCE: f64 = 0.01;

/// Every face a part, with its work.
fn apart(faces: Vec<Face>, surfaces: bool) -> Answer {
    let options = UnrollOptions { surfaces, joins: Joins::None, ..UnrollOptions::new(TOLERANCE) };
    let mut answer = unroll(&model_of(faces), &options, &Control::default()).expect("an answer");
    prepare(&mut answer, &WorkshopOptions::default()).expect("its work");
    answer
}

/// Distance of a place from the lines and arcs of an outline.
fn off_outline(pattern: &Pattern, at: &Vec2) -> f64 {
    let mut least = f64::INFINITY;
    for c in &pattern.contours {
        for (k, a) in c.vertices.iter().enumerate() {
            let (b, chord) =
                (&c.vertices[(k + 1) % c.vertices.len()], c.vertices[(k + 1) % c.vertices.len()].point - a.point);
            let off = if a.bulge == 0.0 {
                let s = ((at - a.point).dot(&chord) / chord.norm_squared()).clamp(0.0, 1.0);
                (at - a.point - chord * s).norm()
            } else {
                let centre =
                    (a.point + b.point) * 0.5 + Vec2::new(-chord.y, chord.x) * ((1.0 / a.bulge - a.bulge) * 0.25);
                ((at - centre).norm() - (a.point - centre).norm()).abs()
            };
            least = least.min(off);
        }
    }
    least
}

/// The marks of all parts in pairs of one label, with the numbers of their patterns; each on its outline and into its part.
fn pairs(answer: &Answer) -> Vec<[(usize, Mark); 2]> {
    let mut all: Vec<(usize, Mark)> =
        answer.patterns.iter().enumerate().flat_map(|(k, p)| p.marks.iter().map(move |m| (k, m.clone()))).collect();
    for (k, mark) in &all {
        let pattern = &answer.patterns[*k];
        let off = off_outline(pattern, &mark.point);
        assert!(off <= TOLERANCE && (mark.inward.norm() - 1.0).abs() < 1e-12, "{off} {mark:?}");
        let polygon = |c: &Contour| {
            let joints: Vec<(Vec2, f64)> = c.vertices.iter().map(|v| (v.point, v.bulge)).collect();
            polygon(&joints, pattern.length)
        };
        let loops: Vec<Vec<Vec2>> = pattern.contours.iter().map(polygon).collect();
        let beside = |x: f64| inside(&loops, &(mark.point + mark.inward * x));
        assert!(beside(2.0 * TOLERANCE) && !beside(-2.0 * TOLERANCE), "{mark:?}");
    }
    all.sort_by(|a, b| a.1.label.cmp(&b.1.label));
    let pair = |w: &[(usize, Mark)]| {
        assert_eq!(w[0].1.label, w[1].1.label);
        [w[0].clone(), w[1].clone()]
    };
    assert_eq!(all.len() % 2, 0);
    all.chunks(2).map(pair).collect()
}

#[test]
fn both_sides_of_a_shared_edge_have_its_marks_its_length_and_its_angle() {
    let slope = 0.7_f64;
    let flat = rectangle(Vec3::zeros(), -80.0 * Vec3::x(), 60.0 * Vec3::y());
    let mut signs = Vec::new();
    for sign in [1.0, -1.0] {
        let way = Vec3::new(slope.cos(), 0.0, sign * slope.sin()) * 50.0;
        let roof = rectangle(Vec3::zeros(), way, 60.0 * Vec3::y());
        let mut faces = vec![flat.clone(), roof];
        faces.iter_mut().for_each(|f| f.body = 7);
        let answer = apart(faces, true);
        assert_eq!((answer.status(), answer.patterns.len()), (Status::Certified, 2));
        let found = pairs(&answer);
        // One joint, marked more than once, and both patterns carry it.
        assert!(
            found.len() > 1 && found.iter().all(|p| p[0].0 != p[1].0 && p[0].1.label.starts_with("J1.")),
            "{found:?}"
        );
        let [joint] = answer.joints.as_slice() else { panic!("{:?}", answer.joints) };
        assert!(joint.lengths.iter().all(|l| (l - 60.0).abs() < 1e-9), "{joint:?}");
        let names: Vec<String> = answer.parts.iter().map(|p| p.name.clone()).collect();
        let [bevel] = answer.shop.bevels.as_slice() else { panic!("bevels") };
        assert_eq!((bevel.name.as_str(), bevel.between.clone().to_vec()), ("J1", names));
        let kinks: Vec<f64> = bevel.stations.iter().map(|s| s.kink).collect();
        assert!(kinks.iter().all(|k| (k.abs() - slope).abs() < 1e-9 && k * kinks[0] > 0.0), "{kinks:?}");
        signs.push(kinks[0].signum());
    }
    // Of one orientation, what goes up on one side is a valley and what goes down a ridge.
    assert_eq!(signs[0], -signs[1]);
}

#[test]
fn marks_of_neighbours_are_at_the_same_place_in_space() {
    for faces in [tangent_flap([0.5, 1.5]).to_vec(), bent()] {
        let answer = apart(faces, true);
        assert_eq!(answer.status(), Status::Certified, "{:?}", answer.claims);
        let found = pairs(&answer);
        assert!(!found.is_empty());
        for [(_, a), (_, b)] in &found {
            assert!(a.apart < 1e-6 && a.apart == b.apart);
        }
        let [joint] = answer.joints.as_slice() else { panic!("{:?}", answer.joints) };
        assert!((joint.lengths[0] - joint.lengths[1]).abs() < 1e-6, "{joint:?}");
    }
}

/// A general cylinder and the same reflected: they meet along a plane curve.
fn bent() -> Vec<Face> {
    let face = |z: f64| {
        let mut face = over_parabola(|p| p + Vec3::new(0.0, -80.0, z));
        face.body = 7;
        face
    };
    [-60.0, 60.0].map(face).to_vec()
}

#[test]
fn a_sheet_in_pieces_has_bevels_of_its_own_thickness() {
    let model = crate::read(include_bytes!("../../../../../../data/bracket.step")).expect("a bracket");
    let whole = unroll(&model, &UnrollOptions::new(TOLERANCE), &Control::default()).expect("an answer");
    assert!(whole.joints.is_empty() && whole.patterns.iter().all(|p| p.marks.is_empty()));
    let answer = apart(model.faces, false);
    assert!(answer.patterns.len() > 1 && answer.joints.len() >= answer.patterns.len() - 1);
    assert!(!pairs(&answer).is_empty());
    let thickness = answer.sheets[0].thickness;
    assert!(answer.shop.bevels.iter().all(|b| b.thickness == Some(thickness)));
    // Bends go on smoothly into their flanges.
    assert!(answer.shop.bevels.iter().flat_map(|b| &b.stations).all(|s| s.kink.abs() < 1e-3));
}
