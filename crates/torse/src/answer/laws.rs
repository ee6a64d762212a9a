//! Laws of answers: what stands against something never makes it better, and orders and joints count everything once.

use super::joints::joints;
use super::marks::Marks;
use super::orders::orders;
use super::skipped::{left_out, Skipped};
use super::{Answer, Job};
use crate::certify::claim::{Claim, Status, Subject, UpperBound, What};
use crate::geom::generated::flat_vector;
use crate::geom::Vec2;
use crate::patchwork::part::Part;
use crate::patchwork::pattern::{Contour, ContourVertex, Mark, MarkPlace, Pattern, Placement};
use crate::reason::{JobReason, StripReason, Unlaid};
use proptest::prelude::*;

const PARTS: usize = 4;

/// A claim about the whole, a part or a panel: proven, not shown, measured or given.
fn claim() -> impl Strategy<Value = Claim> {
    (0usize..10, 0usize..8).prop_map(|(about, kind)| {
        let subject = match about {
            0 | 1 => Subject::Whole,
            2..=6 => Subject::Part((about - 2) % PARTS),
            _ => Subject::Panel((about - 7) % (PARTS + 1)),
        };
        let bound = |b| Claim::at_most(What::MapSurfaceDistance, subject, b).within(0.1);
        match kind {
            0..=3 => bound(UpperBound::nothing()),
            4 => bound(UpperBound::UNKNOWN),
            5 => Claim::measured(What::Deviation, subject, 0.05),
            6 => Claim::given(What::Deviation, subject, 0.05).within(0.1),
            _ => Claim::measured(What::Deviation, subject, 0.05).within(0.1),
        }
    })
}

/// An answer of parts of one panel each, of which something is claimed.
fn answer(claims: Vec<Claim>) -> Answer {
    let mut out = Answer::new(Job::Unroll, "parts", 0.1);
    out.parts = (0..PARTS).map(|k| Part::new(format!("P{k}"), k, 1)).collect();
    out.patterns = (0..PARTS).map(|panel| Pattern { panel, ..Pattern::default() }).collect();
    out.claims = claims;
    out
}

fn all(marks: &Marks) -> Vec<bool> {
    [&marks.panels, &marks.patterns, &marks.parts].into_iter().flatten().copied().collect()
}

fn is_certified(answer: &Answer) -> bool {
    answer.status() == Status::Certified
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]
    #[test]
    fn what_is_broken_makes_nothing_better(
        claims in proptest::collection::vec(claim(), 0..10), more in claim(), at in any::<prop::sample::Index>(),
    ) {
        let before = answer(claims.clone());
        let mut longer = claims.clone();
        longer.insert(at.index(claims.len() + 1), more.clone());
        let after = answer(longer);
        if more.is_broken() {
            prop_assert!(!is_certified(&after));
            // Marks are none where nothing is claimed of parts one by one; the first such claim begins that.
            let by_parts = |a: &Answer| a.claims.iter().any(|c| matches!(c.subject(), Subject::Part(_)));
            if by_parts(&before) == by_parts(&after) {
                prop_assert!(all(&Marks::of(&before)).iter().zip(all(&Marks::of(&after))).all(|(b, a)| !b || a));
            }
        } else if is_certified(&before) {
            prop_assert!(is_certified(&after));
        }
        // Something wrong with the whole leaves nothing to cut.
        let mut refused = before;
        refused.object(JobReason::Stopped);
        prop_assert!(!is_certified(&refused) && all(&Marks::of(&refused)).iter().all(|m| *m));
    }

    #[test]
    fn the_order_of_claims_says_nothing(
        (claims, other) in proptest::collection::vec(claim(), 0..10)
            .prop_flat_map(|c| (Just(c.clone()), Just(c).prop_shuffle())),
    ) {
        let (a, b) = (answer(claims), answer(other));
        prop_assert_eq!(a.status(), b.status());
        prop_assert_eq!(Marks::of(&a), Marks::of(&b));
    }

    #[test]
    fn what_is_only_left_out_certifies_nothing_and_marks_nothing(
        claims in proptest::collection::vec(claim(), 0..10),
        areas in proptest::collection::vec(proptest::option::of(0.1..9.0f64), 1..5),
    ) {
        let skipped: Vec<Skipped> =
            areas.iter().map(|a| Skipped { area_estimate: *a, ..Unlaid::Panel.into() }).collect();
        let before = answer(claims.clone());
        let after = answer(claims.into_iter().chain(left_out(&skipped)).collect());
        prop_assert!(!is_certified(&after));
        let by_parts = before.claims.iter().any(|c| matches!(c.subject(), Subject::Part(_)));
        prop_assert!(!by_parts || Marks::of(&before) == Marks::of(&after));
        prop_assert!(left_out(&[]).is_none());
        let none = answer(vec![Claim::left_out(StripReason::NoHull)]);
        prop_assert!(!Marks::of(&none).any());
    }
}

/// A polygon with unequal sides, at a place.
fn part(sides: usize, size: f64, placement: &Placement, mirrored: bool) -> Pattern {
    let corner = |k: usize| {
        let (s, c) = (std::f64::consts::TAU * k as f64 / sides as f64).sin_cos();
        let radius = size * (1.0 + 0.3 * (k as f64 * 1.7).sin());
        Vec2::new(radius * c, radius * s)
    };
    let vertex = |k: usize| ContourVertex { point: placement.apply(&corner(k)), bulge: 0.0, corner: true };
    let vertices: Vec<ContourVertex> = (0..sides).map(vertex).collect();
    let area = 0.5 * (0..sides).map(|k| corner(k).perp(&corner((k + 1) % sides))).sum::<f64>();
    let pattern = Pattern {
        contours: vec![Contour { vertices }],
        area,
        length: 2.0 * size,
        width: 1.5 * size,
        ..Pattern::default()
    };
    if mirrored {
        pattern.turned_over()
    } else {
        pattern
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn orders_count_every_part_once(
        made in proptest::collection::vec((3usize..6, 0usize..2, -3.0..3.0f64, flat_vector(), any::<bool>()), 1..12),
    ) {
        let mut whole = Answer::new(Job::Unroll, "parts", 0.1);
        whole.patterns = made.iter().map(|(sides, size, angle, by, mirrored)| {
            part(*sides, 100.0 + 20.0 * *size as f64, &Placement { angle: *angle, offset: by * 1000.0 }, *mirrored)
        }).collect();
        let found = orders(&whole);
        let quantity: usize = found.iter().map(|o| o.quantity.as_drawn + o.quantity.turned_over).sum();
        prop_assert_eq!(quantity, made.len());
        for (k, o) in found.iter().enumerate() {
            let kind = |k: usize| (made[k].0, made[k].1);
            // Two parts are one drawing exactly where they are of one kind, lying as they are or turned over.
            let first = (0..k).find(|j| kind(*j) == kind(k));
            prop_assert_eq!(o.same.map(|s| s.pattern), first);
            prop_assert!(o.same.is_none_or(|s| s.mirrored == (made[s.pattern].4 != made[k].4)));
            let c = &whole.patterns[k].contours[0].vertices;
            let around: f64 = (0..c.len()).map(|i| (c[(i + 1) % c.len()].point - c[i].point).norm()).sum();
            prop_assert!((o.cut_length - around).abs() < 1e-9 * around && o.pierces == 1);
        }
    }

    #[test]
    fn joints_are_the_same_in_any_order_of_marks(
        marks in proptest::collection::vec((0usize..4, 1usize..12, 1usize..5, 0.0..1.0f64, any::<bool>()), 0..30),
        turn in 0usize..30,
    ) {
        let patterns = |marks: &[(usize, usize, usize, f64, bool)]| {
            let mut out = vec![Pattern::default(); 4];
            for (on, joint, number, apart, is_joint) in marks {
                let (kind, on_what) = if *is_joint { ("J", MarkPlace::Joint) } else { ("S", MarkPlace::Seam) };
                out[*on].marks.push(Mark {
                    point: Vec2::zeros(),
                    inward: Vec2::x(),
                    label: format!("{kind}{joint}.{number}"),
                    on: on_what,
                    apart: *apart,
                });
            }
            out
        };
        let mut other = marks.clone();
        other.rotate_left(turn.min(marks.len()));
        let found = joints(&patterns(&marks));
        prop_assert_eq!(&found, &joints(&patterns(&other)));
        let of = |joint: usize| marks.iter().filter(move |m| m.4 && m.1 == joint);
        let mut told: Vec<usize> = (1..12).filter(|j| of(*j).next().is_some()).collect();
        told.sort_unstable();
        let names: Vec<String> = found.iter().map(|j| j.name.clone()).collect();
        prop_assert_eq!(names, told.iter().map(|j| format!("J{j}")).collect::<Vec<_>>());
        for (j, number) in found.iter().zip(told) {
            prop_assert_eq!(j.marks, of(number).count().div_ceil(2));
            prop_assert_eq!(j.gap_estimate, of(number).map(|m| m.3).fold(0.0, f64::max));
            let on = || of(number).map(|m| m.0);
            prop_assert_eq!(j.between, [on().min().unwrap_or(9), on().max().unwrap_or(9)]);
        }
    }
}
