//! What proofs of flat patterns, and of files that were read back, miss, in words.

use crate::io::words::numbers::length_bound;
use crate::reason::{Differs, Drawn, FlatFault, Near, Of, WrittenFault};

pub(super) fn words(fault: FlatFault) -> String {
    match fault {
        FlatFault::NoMap => "no map to the plane could be shown to keep lengths".into(),
        FlatFault::Drawing(bound) => format!("the drawing is only proven to be within {}", length_bound(bound)),
        FlatFault::Lengths(bound) => format!("lengths are only proven to change by less than {}", length_bound(bound)),
        FlatFault::Stopped => "the proof was stopped".into(),
        FlatFault::NoPanel => "there is no such panel".into(),
        FlatFault::NotRuled => "the patch is not ruled".into(),
        FlatFault::Nothing => "nothing is drawn".into(),
        FlatFault::NotOneLine => "the outline drawn is not one closed line".into(),
        FlatFault::NoSides => "the outline drawn has no sides".into(),
        FlatFault::OtherSides => "the outline drawn does not have the sides of the panel".into(),
        FlatFault::OtherLoops => "the outline drawn does not have the loops of the part".into(),
        FlatFault::StrangeLoop => "a loop drawn is none of the part's".into(),
        FlatFault::Nowhere(Of::Panel) => "the outline drawn cannot be laid on the panel".into(),
        FlatFault::Nowhere(Of::Strips) => "the outline drawn cannot be laid on the strips".into(),
        FlatFault::Nowhere(Of::Pieces) => "the outline drawn cannot be laid on the pieces".into(),
        FlatFault::Outline(of) => format!("the outline drawn could not be shown to be near the {} border", whose(of)),
        FlatFault::Meets => "the outline drawn could not be shown not to meet itself".into(),
        FlatFault::Ruling(of) => format!("a ruling drawn is none of the {}", whose(of)),
        FlatFault::Mark => "a mark has no partner on the neighbour, or is not on a seam".into(),
        FlatFault::MarkOffRail => "a mark is not on a rail".into(),
        FlatFault::Marks => "marks on trimmed chains are not expected".into(),
        FlatFault::OtherWay => "the bends drawn go the other way on the side that the outline shows".into(),
        FlatFault::NoPieces => "the part has no pieces".into(),
        FlatFault::SeveralChains => "the pieces belong to several chains".into(),
        FlatFault::Incomplete => "the part does not have all its pieces".into(),
        FlatFault::Beside => "a piece cannot be laid beside the others".into(),
        FlatFault::Joint => "a joint is none of the pieces'".into(),
        FlatFault::Apart => "the pieces do not hang together".into(),
        FlatFault::Edges => "the edges of the pieces do not bound them".into(),
    }
}

fn whose(of: Of) -> &'static str {
    match of {
        Of::Panel => "panel's",
        Of::Strips => "strips'",
        Of::Pieces => "part's",
    }
}

pub(super) fn written(fault: &WrittenFault) -> String {
    match fault {
        WrittenFault::Unreadable(words) | WrittenFault::Piece(words) => words.clone(),
        WrittenFault::Number { found, wanted, of } => {
            let (written, judged) = match of {
                Near::Panels => ("faces", "panels"),
                Near::Strips => ("faces", "strips"),
                Near::Pieces => ("faces", "pieces"),
                Near::Patterns => ("pieces", "patterns"),
            };
            format!("{found} {written} for {wanted} {judged}")
        }
        WrittenFault::Faces(count) => format!("it has {count} faces"),
        WrittenFault::Name { entity, found, wanted } => format!("#{entity} is called {found} instead of {wanted}"),
        WrittenFault::Counted { what, found, wanted } => format!("{found} {} instead of {wanted}", drawn(*what)),
        WrittenFault::Differs(what) => differs(*what).into(),
        WrittenFault::Moved(by) => format!("it is {} from what was judged", length_bound(*by)),
        WrittenFault::SurfaceMoved(by) => format!("the surface is {} from what was judged", length_bound(*by)),
        WrittenFault::OtherPanels => "its panels were changed after the proof".into(),
        WrittenFault::EdgesMoved(by) => format!("its edges are {} from what was judged", length_bound(*by)),
    }
}

fn drawn(what: Drawn) -> &'static str {
    match what {
        Drawn::Contours => "contours",
        Drawn::Formed => "outlines of formed features",
        Drawn::Extents => "extents of bends",
        Drawn::Rulings => "rulings",
        Drawn::Marks => "marks",
        Drawn::Sections => "sections",
        Drawn::Curves => "curves of the model",
        Drawn::Joints => "joints of an outline",
        Drawn::Corners => "corners of a section",
    }
}

fn differs(what: Differs) -> &'static str {
    match what {
        Differs::Normal => "the normal is on the wrong side",
        Differs::Loops => "loops are missing",
        Differs::SeveralLoops => "the face has several loops",
        Differs::Edges => "edges are missing",
        Differs::NotRuled => "the patch is not ruled",
        Differs::Follows => "the edge does not begin where the one before ends",
        Differs::EdgeSense => "the edge runs the other way",
        Differs::Edge => "the edge is another one",
        Differs::EdgeOrTrim => "the edge or its trimming curve is another one",
        Differs::EdgeKind => "the edge is of another kind",
        Differs::NoEdge => "the edge is none",
        Differs::NoRuling => "the ruling is none",
        Differs::VertexOff => "a vertex is not at the end of its edges",
        Differs::Vertex => "a vertex is another one",
        Differs::Knots => "the knots of the surface are others",
        Differs::Weights => "the weights of the surface are others",
        Differs::ControlPoint => "a control point is not a finite number",
        Differs::Surface => "the surface is another one",
        Differs::Spline => "the surface is a spline",
        Differs::SurfaceKind => "the surface is neither a spline nor a plane",
        Differs::NoPlane => "the plane is none",
        Differs::NoPiece => "the piece is none",
        Differs::Turns => "the piece turns too far",
        Differs::OffOwnSurface => "the piece does not lie on its own support surface",
        Differs::Coordinate => "a coordinate is not a finite number",
        Differs::NoExtent => "the outline has no extent",
        Differs::NoCircle => "a hole is no circle",
        Differs::BendSense => "a bend line goes the other way",
        Differs::NoArc => "an arc is none",
    }
}
