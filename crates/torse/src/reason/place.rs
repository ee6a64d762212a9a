//! Where in space a reason has something to show.

use super::{FaceReason, JobReason, PanelFault, ProofFault, Reason, StripReason};
use crate::geom::Vec3;

impl Reason {
    /// A place where it can be seen, mm; of several reasons the first that is known. `None` for what is about no place.
    pub fn place(&self) -> Option<Vec3> {
        let place = match self {
            Self::Of(_, reason) => reason.place(),
            Self::Several(reasons) => reasons.iter().find_map(Self::place),
            Self::Proof(ProofFault::Panel(fault)) => of_panel(fault),
            Self::Face(reason) => of_face(reason),
            Self::Strip(reason) => of_strip(reason),
            Self::Job(reason) => of_job(reason),
            Self::Proof(_) | Self::Input(_) | Self::Error(_) | Self::Flat(_) | Self::Written(_) | Self::Unlaid(_) => {
                None
            }
        };
        place.filter(|p| p.iter().all(|x| x.is_finite()))
    }
}

fn of_panel(fault: &PanelFault) -> Option<Vec3> {
    match fault {
        PanelFault::Edge(at)
        | PanelFault::OtherFoot(at)
        | PanelFault::Twisted(_, at)
        | PanelFault::Regression(at)
        | PanelFault::TrimAt(_, at)
        | PanelFault::TooFar { at, .. }
        | PanelFault::Obstructed(_, at)
        | PanelFault::Folds(at)
        | PanelFault::MayFold(at)
        | PanelFault::Only(_, at) => Some(*at),
        _ => None,
    }
}

fn of_face(reason: &FaceReason) -> Option<Vec3> {
    match reason {
        FaceReason::SeamLost { at, .. } | FaceReason::Kinked { at, .. } | FaceReason::Tip(at) => Some(*at),
        FaceReason::NoPanel { at, error } => at.or_else(|| error.place()),
        FaceReason::Joined(why, _)
        | FaceReason::LeftOut { first: why, .. }
        | FaceReason::PanelsLeftOut { first: why, .. }
        | FaceReason::NoPattern { error: why, .. }
        | FaceReason::Unusable { error: why, .. } => why.place(),
        _ => None,
    }
}

fn of_strip(reason: &StripReason) -> Option<Vec3> {
    match reason {
        StripReason::NotTheHull { at, .. }
        | StripReason::Regression { at, .. }
        | StripReason::MayRegress { at, .. }
        | StripReason::OutOfBounds { at, .. }
        | StripReason::NetRegression { at, .. }
        | StripReason::TangentRuling { at, .. }
        | StripReason::PointsAround { at, .. } => Some(*at),
        StripReason::Stray { most, .. } | StripReason::OffRail { most, .. } | StripReason::Twist { most, .. } => {
            most.as_ref().map(|w| w.at)
        }
        StripReason::PointOutside { worst, .. } => worst.map(|w| w.1),
        StripReason::EndOutside { worst: at, .. }
        | StripReason::OutlineOutside { at, .. }
        | StripReason::Outline(_, at) => *at,
        StripReason::FromFace { seen, .. } => seen.map(|s| s.1),
        StripReason::NoStrip { error: why, .. } | StripReason::Blank(why) | StripReason::NoOutline(why) => why.place(),
        StripReason::Points(_, why) => why.as_ref().and_then(|why| why.place()),
        _ => None,
    }
}

fn of_job(reason: &JobReason) -> Option<Vec3> {
    match reason {
        JobReason::Beyond { at, .. }
        | JobReason::Before { at, .. }
        | JobReason::Bare(_, at)
        | JobReason::Target { at, .. } => Some(*at),
        JobReason::Panels(reasons) => reasons.iter().find_map(Reason::place),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reason::{Item, Unlaid};

    #[test]
    fn the_first_known_place_is_told_of_whatever_holds_it() {
        let at = Vec3::new(1.0, 2.0, 3.0);
        let far = Reason::from(PanelFault::TooFar { away: 2.0, at, left: None });
        let held = Reason::of(Item::Panel("A-01".into()), far.clone());
        let several = Reason::Several(vec![PanelFault::UsedUp.into(), held, PanelFault::Folds(Vec3::zeros()).into()]);
        let strip = Reason::from(StripReason::Blank(Box::new(several)));
        assert_eq!(strip.place(), Some(at));
        let none = FaceReason::NoPanel { error: Box::new(far), at: None };
        assert_eq!(Reason::from(none).place(), Some(at));
        assert_eq!(Reason::from(Unlaid::Panel).place(), None);
        assert_eq!(Reason::from(PanelFault::Folds(Vec3::repeat(f64::NAN))).place(), None);
    }
}
