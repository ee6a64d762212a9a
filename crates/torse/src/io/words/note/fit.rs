//! Sentences on fits.

use super::super::counted_name;
use super::super::numbers::{length, place};
use crate::answer::note::{Became, FaceNote, FitNote, Outlines, SplineSize};
use crate::geom::Vec3;

pub(super) fn words(note: &FitNote) -> String {
    match note {
        FitNote::Ends { outlines, whole, mesh } => {
            let why = if *mesh { "the mesh has no single border there" } else { "the points have no single border there" };
            let apart = (!whole.is_empty()).then(|| {
                let names = whole.join(", ");
                format!("Whole strips, not cut back to what was measured ({why}), are {names}: how far they reach is proven.")
            });
            let told: fn(&Outlines) -> String = if *mesh { of_mesh } else { outlined };
            outlines.iter().map(told).chain(apart).collect::<Vec<_>>().join(" ")
        }
        FitNote::Given { faces, whole } => given(*faces, whole),
        FitNote::Gap { apart, usual, at, count, bulge_estimate } => gap([*apart, *usual], at, *count, *bulge_estimate),
        FitNote::NoStrip { count, at, off } => {
            let (stretches, one) = match count {
                1 => ("One stretch between neighbouring rulings has".into(), "its"),
                n => (format!("{n} stretches between neighbouring rulings have"), "the farthest one's"),
            };
            format!("{stretches} no strip: {one} middle, at {}, is up to {} from the strips as they are cut.", place(at), length(*off))
        }
        FitNote::OpenRing { apart, at } => format!(
            "The rulings go around a ring that stays open for {} around {}, between the last and the first of them: there is no \
             strip there. Where it is closed, give the first ruling once more as the last.",
            length(*apart),
            place(at)
        ),
        FitNote::Lonely { count } => {
            format!("{count} points lie too far from others to belong to a surface; they are judged all the same.")
        }
        FitNote::CoarseMesh { corners, triangles, between } => format!(
            "The file is a coarse mesh. Judged are the {corners} corners of its {triangles} triangles. The triangles are \
             chords: between corners strips follow a smooth sheet through these, which is estimated to lie up to {} off the \
             triangles; triangles lie up to {} from the strips (sampled at {} places).",
            length(between.bulge_estimate),
            length(between.off_estimate),
            between.places
        ),
        FitNote::Unused { count, kept: false } => format!(
            "{count} points of the mesh are corners of none of its triangles; they are left out, and nothing is said of them."
        ),
        FitNote::Unused { count, kept: true } => {
            format!("{count} points, most of all, are corners of no triangle; they count as measured, like the others.")
        }
        FitNote::Shortened { count, by, of } => format!(
            "Of the planes left out {count} stand at the ends of the row: the strips end before them, by {} of its {}.",
            length(*by),
            length(*of)
        ),
        FitNote::Face(note) => face(note),
        FitNote::At(what) => format!("Distances are proven at the {}, not between them.", counted_name(*what)),
    }
}

fn given(faces: bool, whole: &[String]) -> String {
    let (ends, proven) = match faces {
        true => (
            "at the border of the given faces, holes included",
            "that no place of a strip as it is cut is farther from its face than told, and no place of the face from the strip",
        ),
        false => (
            "where the given rulings end: through their ends along a curve where these lie on one, else straight when laid flat",
            "how far ends of rulings are from the strips as they are cut, and how far any place of these is from the straight \
             stretches between neighbouring rulings, from which a bent sheet bulges",
        ),
    };
    let names = whole.join(", ");
    let whole = if whole.is_empty() {
        String::new()
    } else {
        format!(" Not cut, because that is no single border on the strip, and to be trimmed by hand: {names}.")
    };
    format!("Strips and flat patterns end {ends}. Proven is {proven}.{whole}")
}

fn gap([apart, usual]: [f64; 2], at: &[Vec3; 2], count: usize, bulge: Option<f64>) -> String {
    let others = match count {
        0 | 1 => String::new(),
        2 => " There is another such stretch.".into(),
        n => format!(" There are {} other such stretches.", n - 1),
    };
    let across = bulge.map_or_else(
        || "No strip lies there".into(),
        |b| {
            format!("The strip goes on across them, {} beside the straight stretch between both (estimated)", length(b))
        },
    );
    format!(
        "Two neighbouring rulings are {} apart, around {} and {}; usual are {}. {across}: nothing is given there. Rulings of two \
         sheets belong in two files.{others}",
        length(apart),
        place(&at[0]),
        place(&at[1]),
        length(usual)
    )
}

fn of_mesh(found: &Outlines) -> String {
    format!(
        "Strips and flat patterns end at the border of the mesh, straight from corner to corner of its facets when laid flat. \
         Proven are the distance of every corner from the strips with these outlines, and that of every place of the strips \
         from the mesh. Holes cut out: {}.",
        found.holes
    )
}

fn outlined(found: &Outlines) -> String {
    format!(
        "Strips and flat patterns end at the border of the measured points, and the sheet may go on beyond by their spacing, \
         about {}. Proven are the distance of every point from the strips with these outlines, and that of every place of \
         the strips from the nearest point. Holes cut out: {}; holes of a few spacings that are not: {}; points that lie \
         apart: {}.",
        length(found.spacing),
        found.holes,
        found.closed,
        found.stray
    )
}

fn face(FaceNote { face, given: SplineSize { degree, control }, became }: &FaceNote) -> String {
    let given = format!(
        "{face} was given with degrees {} and {} and {} × {} control points",
        degree[0], degree[1], control[0], control[1]
    );
    let one = |(name, size): &(String, SplineSize)| {
        format!("{name} of degree {} with {} × {}", size.degree[0], size.control[0], size.control[1])
    };
    match became {
        Became::Nothing => format!("{given}."),
        Became::Itself(name) => format!("{given}; nothing simpler was found, it is {name} as it was."),
        Became::Strips(strips) => {
            format!("{given}; now: {} control points.", strips.iter().map(one).collect::<Vec<_>>().join(", "))
        }
    }
}
