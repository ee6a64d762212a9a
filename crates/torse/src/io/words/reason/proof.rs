//! What proofs of panels that cover faces miss, in words.

use crate::geom::{place_in_words, Vec3};
use crate::io::words::numbers::{angle_bound, length, length_bound};
use crate::reason::{CoverFault, LoopFault, Obstruction, PanelFault, ProofFault, SeamFault};

pub(super) fn words(fault: &ProofFault) -> String {
    match fault {
        ProofFault::Precision { tolerance, least } => format!(
            "everything: a tolerance of {tolerance:e} mm cannot be certified in double precision at this size; \
             at least {} is needed",
            length_bound(*least)
        ),
        ProofFault::Joined { face, by } => format!("face {face}: joining moved it by {by} mm, which is no bound"),
        ProofFault::Trimmed { face, by } => {
            format!("face {face}: its trim is {by} mm from the file's edges, which is no bound")
        }
        ProofFault::Cover { face: Some(face), fault } => format!("coverage of face {face}: {}", cover(fault)),
        ProofFault::Cover { face: None, fault } => format!("coverage: {}", cover(fault)),
        ProofFault::Seams { seam, fault } => format!("seams: {}", of_seam(*seam, *fault)),
        ProofFault::Panel(fault) => panel(fault),
        ProofFault::MorePanels(count) => format!("{count} more panels"),
        ProofFault::Another => "the patchwork is not what was proven".into(),
        ProofFault::Larger => "a part was proven for a larger tolerance only".into(),
        ProofFault::SomePanel => "not every panel could be proven".into(),
    }
}

fn panel(fault: &PanelFault) -> String {
    match fault {
        PanelFault::NoTorse => {
            "the torse is not a C¹ spline of degree at most 3, or the patch is not ruled with positive weights".into()
        }
        PanelFault::NotRuled => "the patch is not ruled with positive weights".into(),
        PanelFault::NoMap => "the map to the face is no spline of finite numbers".into(),
        PanelFault::NoFace => "the panel covers no face".into(),
        PanelFault::NoRegion => "the panel has no region".into(),
        PanelFault::Cover(fault) => cover(fault),
        PanelFault::OffFace => {
            "the regions of its face do not make up that face, so how far it is from the face is not known".into()
        }
        PanelFault::Edge(at) => {
            format!("the edge that begins at {} cannot be compared with its trimming curve", place_in_words(at))
        }
        PanelFault::OtherFoot(at) => format!("a trimming curve belongs to another foot at {}", place_in_words(at)),
        PanelFault::TooLarge(bound) => format!("the bound {} exceeds the tolerance", length_bound(*bound)),
        PanelFault::OffTorse => "the patch cannot be compared with the exact torse".into(),
        PanelFault::Twisted(angle, at) => format!(
            "tangent planes along the ruling through {} may differ by {}",
            place_in_words(at),
            angle_bound(*angle)
        ),
        PanelFault::Regression(at) => {
            format!("the regression curve may lie inside the patch, on the ruling through {}", place_in_words(at))
        }
        PanelFault::Trim(fault) => of_loops(*fault).into(),
        PanelFault::TrimAt(fault, at) => format!("{} at {}", of_loops(*fault), place_in_words(at)),
        PanelFault::UsedUp => "rounding and trimming curves use up the tolerance".into(),
        PanelFault::TooFar { away, at, left } => too_far(*away, at, *left),
        PanelFault::Obstructed(obstruction, at) => {
            format!("{} at {}", of_obstruction(*obstruction), place_in_words(at))
        }
        PanelFault::Folds(at) => format!("the map to the face folds over at {}", place_in_words(at)),
        PanelFault::MayFold(at) => {
            format!("it could not be shown that the map to the face does not fold over at {}", place_in_words(at))
        }
        PanelFault::WrongSide => "the trimming loops run about the wrong side".into(),
        PanelFault::Only(bound, at) => {
            format!("{} is all that is proven; farthest at {}", length_bound(*bound), place_in_words(at))
        }
    }
}

fn too_far(away: f64, at: &Vec3, left: Option<f64>) -> String {
    let place = format!("the face is {} away at {}", length(away), place_in_words(at));
    match left {
        None => place,
        Some(left) => format!("{place}; rounding and trimming curves leave {}", length(left)),
    }
}

/// What an obstruction means.
fn of_obstruction(obstruction: Obstruction) -> &'static str {
    match obstruction {
        Obstruction::Foot => "no unique regular foot on the torse could be shown",
        Obstruction::Fold => "the foot map may fold over",
        Obstruction::Degenerate => "the surface's parametrisation degenerates, or a triangle crosses a knot line",
        Obstruction::Bound => "the bound stays above the tolerance",
        Obstruction::Budget => "too many triangles were needed",
        Obstruction::Stopped => "the proof was stopped",
    }
}

pub(super) fn of_loops(fault: LoopFault) -> &'static str {
    match fault {
        LoopFault::Leaves => "a trimming curve leaves the patch",
        LoopFault::NotCubic => "a trimming curve is not a clamped cubic",
        LoopFault::Malformed => "a trimming curve is not a clamped cubic over [0, 1] with increasing vertex parameters",
        LoopFault::Empty => "a trimming curve is empty",
        LoopFault::NoVertex => "a run names a vertex that does not exist",
        LoopFault::KnotLine => "a side of the region crosses a knot line of the surface",
        LoopFault::TooFar => "a trimming curve is farther than the tolerance from the region's boundary",
        LoopFault::Strays => "a trimming curve strays from the region's boundary",
        LoopFault::Apart => "trimming curves of a loop do not join",
        LoopFault::None => "the panel has no trimming curves",
        LoopFault::NoExtent => "a trimming loop has no extent",
        LoopFault::PolygonNoExtent => "a polygon has no extent",
        LoopFault::NoSides => "a polygon has no sides",
        LoopFault::Meets => "a trimming loop meets itself or another, or comes too close to tell",
        LoopFault::HoleSense => "a hole turns in the same sense as the outer loop",
        LoopFault::HoleOutside => "a hole lies outside the outer loop",
        LoopFault::HoleInHole => "a hole lies inside another",
        LoopFault::NotRuled => "the patch is not ruled",
        LoopFault::OutlineEdge => "an edge could not be compared with its outline",
        LoopFault::OutlineOpen => "an outline is no closed polygon",
        LoopFault::OutlineLeaves => "an outline leaves its patch",
        LoopFault::OutlineMeets => "an outline could not be shown not to meet itself",
        LoopFault::Stopped => "the proof was stopped",
    }
}

fn cover(fault: &CoverFault) -> String {
    match fault {
        CoverFault::Partitions => "faces and partitions differ in number".into(),
        CoverFault::Labels => "triangles and labels differ in number".into(),
        CoverFault::NoVertex(i) => format!("triangle {i} names a vertex that does not exist"),
        CoverFault::Orientation(i, [u, v]) => format!("triangle {i} at ({u}, {v}) is not positively oriented"),
        CoverFault::Repeats(i) => format!("triangle {i} repeats an edge of another"),
        CoverFault::SamePlace => "two vertices of the partition are at the same place".into(),
        CoverFault::NoCorner(i, l) => format!("corner {i} of loop {l} is not a vertex of the partition"),
        CoverFault::Ends(i, l) => format!("the partition's boundary ends at side {i} of loop {l}"),
        CoverFault::Leaves(i, l) => format!("the partition's boundary leaves side {i} of loop {l}"),
        CoverFault::Open(count) => format!("{count} boundary edges of the partition lie on no trimming loop"),
        CoverFault::NoFace(name) => format!("panel {name} belongs to a face that does not exist"),
        CoverFault::Shared(name) => format!("panel {name} shares its region with another"),
        CoverFault::NoPanel(i, face) => format!("triangle {i} of face {face} belongs to no panel"),
        CoverFault::NoTriangles => "the panel has no triangles".into(),
        CoverFault::NotClosed { of, run } => format!("loop {of} is not closed after run {run}"),
        CoverFault::RunLeaves { of, run } => {
            format!("run {run} of loop {of} leaves the boundary of the panel's triangles")
        }
        CoverFault::Miscalled { of, run, seam } => {
            let (said, is) =
                if *seam { ("a seam", "the face's border") } else { ("the face's border", "another panel") };
            format!("run {run} of loop {of} is called {said}, but {is} is beyond")
        }
        CoverFault::NoRun(count) => format!("{count} boundary edges of the panel's triangles belong to no run"),
    }
}

fn of_seam(seam: usize, fault: SeamFault) -> String {
    match fault {
        SeamFault::Uncounted => format!("seam {seam} is not counted"),
        SeamFault::Sides(count) => format!("seam {seam} has {count} sides"),
        SeamFault::NotMirrored => format!("the two sides of seam {seam} do not mirror each other"),
        SeamFault::Faces => format!("seam {seam} lies between different faces"),
        SeamFault::NoPatch => format!("seam {seam} has a side without a patch"),
        SeamFault::Leaves => format!("seam {seam} leaves a patch"),
    }
}
