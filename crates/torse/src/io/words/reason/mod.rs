//! Sentences of reasons, the same in every report and on the terminal.

mod face;
mod flat;
mod items;
mod proof;
mod strip;

pub(super) use items::name;
pub(super) use strip::out_of_bounds;

use crate::answer::skipped::Skipped;
use crate::reason::Reason;

/// A reason in words.
pub fn why(reason: &Reason) -> String {
    match reason {
        Reason::Input(words) | Reason::Error(words) => words.clone(),
        Reason::Of(item, reason) => format!("{}: {}", name(item), why(reason)),
        Reason::Several(all) => all.iter().map(why).collect::<Vec<_>>().join("; "),
        Reason::Proof(fault) => proof::words(fault),
        Reason::Flat(fault) => flat::words(*fault),
        Reason::Written(fault) => flat::written(fault),
        Reason::Face(reason) => face::words(reason, why),
        Reason::Strip(reason) => strip::words(reason, why),
        Reason::Job(reason) => strip::of_job(reason, why),
        Reason::Unlaid(reason) => face::unlaid(reason),
    }
}

/// What is left out, with its number in front of the reason where it has one.
pub fn left_out(skipped: &Skipped) -> String {
    items::numbered(skipped.entity, &why(&skipped.reason))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reason::{FaceReason, FlatFault, Item, JobReason, Sort, StripReason};

    #[test]
    fn reasons_of_things_name_them_and_several_follow_each_other() {
        let both = Reason::all(vec![FlatFault::Mark.into(), FlatFault::Drawing(0.012_345_678).into()]).expect("two");
        assert_eq!(
            why(&Reason::of(Item::Part("A-03".into()), both)),
            "part A-03: a mark has no partner on the neighbour, or is not on a seam; the drawing is only proven to be within \
             0.0124 mm"
        );
        let rows = Item::Elements { row: Some("keel".into()), sort: Sort::Rulings, range: 3..9 };
        let near = StripReason::NotFollowed { tolerance: 0.5, fixed_ends: true, smoothing: None, kept_off: Some(2.0) };
        assert_eq!(
            why(&Reason::of(rows, near)),
            "keel: rulings 3 to 8: no developable strip follows them within 0.5 mm and keeps the first and the last as they \
             are with its regression curve in bounds (the nearest found is 2 mm away); raise the tolerance, or ask for \
             less of the regression curve"
        );
        let off = JobReason::Off(Item::Handle(2, "rail".into()), 0.25);
        assert!(why(&off.into()).starts_with("handle 2 on rail is 0.25 mm from what it should be"));
    }

    #[test]
    fn what_is_left_out_is_told_with_its_area_and_the_first_of_it() {
        let first = Box::new(Reason::from(FaceReason::OutOfTime));
        let told = |count: usize, area_estimate: f64, unknown: usize| {
            let entity = Some(17);
            why(&FaceReason::LeftOut { count, area_estimate, unknown, entity, first: first.clone() }.into())
        };
        let rest = "#17: time was up before it was covered";
        assert_eq!(told(1, 12.5, 0), format!("1 face or item of the file is left out (about 12.5 mm²): {rest}"));
        assert_eq!(
            told(3, 1e6, 1),
            format!(
                "3 faces or items of the file are left out (about 1 m², 1 of them of unknown area), the first: {rest}"
            )
        );
        assert!(told(2, 0.0, 2).contains("(of unknown area)"));
    }
}
