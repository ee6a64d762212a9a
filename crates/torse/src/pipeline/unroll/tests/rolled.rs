//! Roll radii and kinks of rolled faces beside others, of closed ones and of the neutral fibre, against closed forms.

use super::given::wave;
use super::model_of;
use super::sections::{near, worked, PLACE, TOLERANCE};
use crate::answer::note::{Note, ShopNote};
use crate::develop::bends::Facets;
use crate::develop::shop::thickness::{Sheet, SheetSide};
use crate::develop::unfold::allowance::KFactor;
use crate::develop::unfold::specimens::{quarter, rectangle, round_surface};
use crate::geom::Vec3;
use crate::io::model::Model;
use crate::pipeline::unroll::UnrollOptions;
use crate::pipeline::workshop::WorkshopOptions;
use std::f64::consts::{FRAC_PI_2, TAU};

/// A quarter of a cylinder of radius 50 mm that goes on into a plane.
fn flanged() -> Model {
    let flange = rectangle(Vec3::new(50.0, -20.0, 0.0), 20.0 * Vec3::y(), 30.0 * Vec3::z());
    model_of(vec![flange, quarter(Vec3::zeros(), Vec3::z(), 50.0 * Vec3::x(), 30.0)])
}

#[test]
fn rolled_faces_have_rows_and_kinks_of_their_own() {
    let count = 6;
    let sheet = Sheet { thickness: 4.0, side: SheetSide::Outside, k: KFactor::Ansi(0.42) };
    let made = |model: &Model, sheet: Option<Sheet>| {
        let thickness = sheet.as_ref().map(|s| s.thickness);
        let k = sheet.as_ref().map(|s| s.k.clone());
        let side = sheet.as_ref().map_or(SheetSide::Middle, |s| s.side);
        let facets = Some(Facets::Count(count));
        let options = UnrollOptions { surfaces: true, sheet, facets, ..UnrollOptions::new(TOLERANCE) };
        worked(model, options, WorkshopOptions { thickness, side, k, kinked: true, ..WorkshopOptions::default() })
    };
    let (plain, fibre) = (made(&flanged(), None), made(&flanged(), Some(sheet.clone())));
    let neutral = 50.0 - (1.0 - 0.42) * 4.0;
    for (answer, radius) in [(&plain, 50.0), (&fibre, neutral)] {
        let work = &answer.shop.work[0];
        let cylinder = work.roll[0].panel;
        assert!(work.roll.len() == 25 && work.roll.iter().all(|s| s.panel == cylinder), "{:?}", work.roll);
        work.roll.iter().flat_map(|s| s.radii).for_each(|r| near(r, 50.0, PLACE));
        near(work.roll[24].position, radius * FRAC_PI_2, 1e-3);
        near(work.roll[24].turn.abs(), FRAC_PI_2, PLACE);
        let faceted = work.faceted.as_ref().expect("kinks");
        let mut orders: Vec<usize> = faceted.kinks.iter().map(|k| k.order).collect();
        orders.sort_unstable();
        assert_eq!(orders, (1..=count).collect::<Vec<_>>());
        assert!(faceted.kinks.iter().all(|k| k.panel() == cylinder));
        let step = radius * FRAC_PI_2 / count as f64;
        faceted.kinks[1..].iter().for_each(|k| near(k.from_last, step, PLACE));
        near(faceted.kinks[0].from_last, 0.5 * step, PLACE);
    }
    // Kinked in the same way, the fibre is as far off as its radius is smaller.
    let off = [&plain, &fibre].map(|a| a.shop.work[0].faceted.as_ref().map_or(f64::NAN, |f| f.displacement_estimate));
    near(off[1] / off[0], neutral / 50.0, 0.02);
    // A pipe is kinked all around.
    let pipe = made(&model_of(vec![round_surface(50.0, 0.0, (0.0, 100.0))]), None);
    let faceted = pipe.shop.work[0].faceted.as_ref().expect("kinks");
    assert_eq!(faceted.kinks.len(), count);
    faceted.kinks.iter().for_each(|k| near(k.bend.angle, TAU / count as f64, PLACE));
    near(pipe.shop.work[0].roll[24].turn.abs(), TAU, PLACE);
    near(pipe.shop.work[0].roll[24].position, TAU * 50.0, PLACE);
    assert!(faceted.displacement_estimate > 1.0 && faceted.displacement_estimate < 10.0, "{faceted:?}");
    // Where K changes with the radius the fibre is at no one distance: kinks are known, how far they are off is not, and said so.
    let varying = Sheet { k: KFactor::Table(vec![[0.0, 0.3], [200.0, 0.5]]), thickness: 2.0, ..sheet };
    let answer = made(&wave(), Some(varying));
    assert!(answer.shop.work[0]
        .faceted
        .as_ref()
        .is_some_and(|f| f.displacement_estimate.is_nan() && !f.kinks.is_empty()));
    assert!(answer.notes.iter().any(|n| matches!(n, Note::Shop(ShopNote::KinkedFibre { .. }))));
}
