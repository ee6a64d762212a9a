//! What the items of a representation hold: shells, solids, sets of surfaces, and copies of other representations.

use super::beside::POINT;
use super::records::{as_reference, Args, Fault, Record};
use super::token::Value;
use super::topology::may_be_face;
use super::units;
use super::walk::{Here, Occurrence, Walk, DEEPEST_ASSEMBLY, MOST_OCCURRENCES, MOST_STEPS};
use crate::answer::note::reader::ReaderNote;
use crate::geom::placement::Placement;

impl<'r, 'a> Walk<'r, 'a> {
    /// An item of a representation, a shell, or a member of one.
    pub(super) fn item(&mut self, id: u64, here: Here) {
        self.steps += 1;
        let full = self.steps > MOST_STEPS || self.out.occurrences.len() > MOST_OCCURRENCES;
        if here.depth > DEEPEST_ASSEMBLY || full {
            self.out.faults.push(Fault::new(id, format!("#{id} contains itself or too much")));
            return;
        }
        if let Err(fault) = self.try_item(id, here) {
            self.out.faults.push(fault);
        }
    }

    fn try_item(&mut self, id: u64, here: Here) -> Result<(), Fault> {
        let record = self.records.get(id)?;
        let a = self.records.simple(id)?;
        match record.name() {
            "ADVANCED_FACE" | "FACE_SURFACE" | "ORIENTED_FACE" | "FACE" | "SUBFACE" => self.face(id, &a, here),
            "CLOSED_SHELL"
            | "OPEN_SHELL"
            | "CONNECTED_FACE_SET"
            | "CONNECTED_FACE_SUB_SET"
            | "SURFACED_OPEN_SHELL"
            | "SHELL_BASED_SURFACE_MODEL"
            | "FACE_BASED_SURFACE_MODEL" => {
                self.members(a.references(1)?, Here { of_faces: true, ..here });
                Ok(())
            }
            "GEOMETRIC_SET" | "GEOMETRIC_CURVE_SET" => {
                let (curves, others) = a.references(1)?.into_iter().partition(|m| self.is_curve(*m));
                self.members(others, here);
                for curve in curves {
                    self.lies_beside(curve, here);
                }
                Ok(())
            }
            "SHELL_BASED_WIREFRAME_MODEL" => {
                self.members(a.references(1)?, here);
                Ok(())
            }
            "ORIENTED_CLOSED_SHELL" | "ORIENTED_OPEN_SHELL" => {
                let flipped = here.flipped == a.logical(3, true);
                self.members(vec![a.reference(2)?], Here { flipped, of_faces: true, ..here });
                Ok(())
            }
            // Written in parts, a solid ends with another keyword.
            name if is_solid(name) || record.parts.iter().any(|p| is_solid(p.name)) => {
                let shells = shells(id, record, &a)?;
                self.in_own_body(|w| w.members(shells, Here { of_faces: true, ..here }));
                Ok(())
            }
            "MAPPED_ITEM" => self.mapped(&a, here),
            "EXTRUDED_FACE_SOLID" => {
                // Its base is one of the faces that it becomes.
                self.visited.insert(a.reference(1)?);
                self.in_own_body(|w| w.occurs(id, here));
                Ok(())
            }
            name if may_be_face(name) || record.part("B_SPLINE_SURFACE").is_some() => {
                self.visited.insert(id);
                self.occurs(id, here);
                Ok(())
            }
            name if here.of_faces || self.is_loss(id, record, &a) => {
                Err(Fault::new(id, format!("an item of kind {name} is not read")))
            }
            "TRIANGULATED_SURFACE_SET" | "COMPLEX_TRIANGULATED_SURFACE_SET" => {
                self.out.notes.push(ReaderNote::Triangles { entity: id });
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// One use of a face, or of what becomes faces.
    pub(super) fn occurs(&mut self, face: u64, here: Here) {
        let Here { flipped, units, placement, part, .. } = here;
        let (part, placement, body) = (part.to_string(), *placement, self.body);
        self.out.occurrences.push(Occurrence { face, flipped, units, part, placement, body });
    }

    /// Whether a member of a set is a curve or a point.
    fn is_curve(&self, id: u64) -> bool {
        let Ok(record) = self.records.get(id) else { return false };
        let name = record.name();
        name == POINT || CURVES.contains(&name) || name.ends_with("_CURVE") || record.part("B_SPLINE_CURVE").is_some()
    }

    /// One use of a curve or a point of a set.
    fn lies_beside(&mut self, curve: u64, here: Here) {
        let Here { flipped, units, placement, part, .. } = here;
        let (part, placement, body) = (part.to_string(), *placement, self.body);
        if self.out.beside.len() < MOST_OCCURRENCES {
            self.out.beside.push(Occurrence { face: curve, flipped, units, part, placement, body });
        }
    }

    /// A face of topology.
    fn face(&mut self, id: u64, a: &Args, here: Here) -> Result<(), Fault> {
        let is_new = self.visited.insert(id);
        let places = self.shown.entry(id).or_default();
        let again = !is_new && (self.copies == 0 || places.iter().any(|p| p.is_nearly(here.placement)));
        if again && !self.repeats_count {
            return Ok(());
        }
        places.push(*here.placement);
        if self.records.name(id) == "ORIENTED_FACE" {
            self.visited.insert(a.reference(2)?);
        }
        self.occurs(id, here);
        Ok(())
    }

    /// Members of a shell, a solid or a set.
    fn members(&mut self, members: Vec<u64>, here: Here) {
        for m in members {
            self.item(m, Here { depth: here.depth + 1, ..here });
        }
    }

    /// Does something in a body of its own.
    fn in_own_body(&mut self, walk: impl FnOnce(&mut Self)) {
        let outer = self.body;
        self.begin_body();
        walk(self);
        self.body = outer;
    }

    /// A copy of another representation.
    fn mapped(&mut self, a: &Args<'r, 'a>, here: Here) -> Result<(), Fault> {
        let map = self.records.args(a.reference(1)?, "REPRESENTATION_MAP")?;
        let (origin, source) = (map.reference(0)?, map.reference(1)?);
        if self.is_drawing(source) {
            return Ok(());
        }
        let inner = self.units_index(source);
        let from = self.geometry(inner).placement(origin)?;
        // The target belongs to the representation that holds the copy, with its units.
        let to = self.geometry(here.units).placement(a.reference(2)?)?;
        let back = from
            .inverse()
            .ok_or_else(|| Fault::new(a.id, format!("the origin of the mapping #{} cannot be inverted", a.id)))?;
        self.copies += 1;
        self.walk(self.find(source), &here.placement.after(&to.after(&back)), here.part, here.depth + 1);
        self.copies -= 1;
        Ok(())
    }

    /// Whether an item of a representation that is not read is a loss. Solids of other kinds hold faces that would be missed, and so
    /// does what is made of faces or bounded by loops, whatever it is called; points, curves, axes and annotations do not. Triangles
    /// beside the exact shape that they name are no loss; on their own they are the shape.
    fn is_loss(&self, id: u64, record: &Record, a: &Args) -> bool {
        match record.name() {
            "TESSELLATED_SOLID" | "TESSELLATED_SHELL" => {
                let beside = a.values.last().and_then(as_reference).is_some();
                let faces = a.references(1).unwrap_or_default();
                !beside && (faces.is_empty() || faces.iter().any(|f| !self.shows_a_face(*f)))
            }
            "TRIANGULATED_FACE" | "COMPLEX_TRIANGULATED_FACE" => !self.shows_a_face(id),
            name if PRIMITIVES.contains(&name) => true,
            name => {
                let starts = ["SOLID_", "BOOLEAN", "CSG"].iter().any(|s| name.starts_with(s));
                starts || name.ends_with("_SOLID") || self.is_made_of_faces(record)
            }
        }
    }

    /// Whether a record, which does not only give a colour, refers to faces, to what holds them, or to their bounds.
    fn is_made_of_faces(&self, record: &Record) -> bool {
        if record.name().ends_with("STYLED_ITEM") {
            return false;
        }
        let mut named = record.parts.iter().flat_map(|p| &p.args).flat_map(references);
        named.any(|r| self.records.get(r).is_ok_and(|r| FACES.contains(&r.name())))
    }

    /// Whether a face of triangles names the exact face that it shows.
    fn shows_a_face(&self, id: u64) -> bool {
        let Ok(record) = self.records.get(id) else { return false };
        let mut named = record.parts.iter().flat_map(|p| &p.args).filter_map(as_reference);
        named.any(|r| matches!(self.records.name(r), "ADVANCED_FACE" | "FACE_SURFACE" | "ORIENTED_FACE"))
    }

    /// Faces that no representation leads to: used where there is nothing else, else named.
    pub(super) fn strays(&mut self) {
        let faces = self.records.all(&["ADVANCED_FACE", "FACE_SURFACE", "CURVE_BOUNDED_SURFACE"]);
        let strays: Vec<u64> = faces.into_iter().filter(|f| !self.visited.contains(f)).collect();
        if strays.is_empty() {
            return;
        }
        if !self.out.occurrences.is_empty() {
            let fault = |face| Fault::new(face, "no shape representation leads to this face");
            self.out.faults.extend(strays.into_iter().map(fault));
            return;
        }
        self.out.unplaced = true;
        self.out.notes.push(ReaderNote::Strays { faces: strays.len() });
        let context = self.records.all(&["GLOBAL_UNIT_ASSIGNED_CONTEXT"]).first().copied().unwrap_or(0);
        let units = self.out.units.len();
        self.out.units.push(units::of_context(self.records, context));
        self.body = 0;
        let placement = Placement::identity();
        for face in strays {
            self.occurs(
                face,
                Here { flipped: false, units, placement: &placement, part: "", depth: 0, of_faces: false },
            );
        }
    }
}

/// The shells of a solid, the outer one first. Complex instances hold it in the part of the solid.
fn shells(id: u64, record: &Record, a: &Args) -> Result<Vec<u64>, Fault> {
    let outer = match record.part("MANIFOLD_SOLID_BREP") {
        Some(p) => p.args.iter().find_map(as_reference),
        None => a.values.iter().find_map(as_reference),
    };
    let mut shells = vec![outer.ok_or_else(|| Fault::new(id, format!("the solid #{id} names no shell")))?];
    let voids = record.part("BREP_WITH_VOIDS").into_iter().flat_map(|p| &p.args);
    for v in voids {
        if let Value::List(l) = v {
            shells.extend(l.iter().filter_map(as_reference));
        }
    }
    Ok(shells)
}

/// Curves whose names do not end so.
const CURVES: [&str; 5] = ["LINE", "CIRCLE", "ELLIPSE", "POLYLINE", "B_SPLINE_CURVE_WITH_KNOTS"];

/// Solids of constructive geometry.
const PRIMITIVES: [&str; 11] = [
    "BLOCK",
    "SPHERE",
    "TORUS",
    "RIGHT_CIRCULAR_CYLINDER",
    "RIGHT_CIRCULAR_CONE",
    "RIGHT_ANGULAR_WEDGE",
    "ELLIPSOID",
    "ECCENTRIC_CONE",
    "CONVEX_HEXAHEDRON",
    "TETRAHEDRON",
    "RECTANGULAR_PYRAMID",
];

/// Faces, what holds them, and their bounds.
const FACES: [&str; 9] = [
    "ADVANCED_FACE",
    "FACE_SURFACE",
    "ORIENTED_FACE",
    "CLOSED_SHELL",
    "OPEN_SHELL",
    "ORIENTED_CLOSED_SHELL",
    "ORIENTED_OPEN_SHELL",
    "FACE_BOUND",
    "FACE_OUTER_BOUND",
];

/// What a value refers to, in lists too.
fn references(value: &Value) -> Vec<u64> {
    match value {
        Value::List(list) => list.iter().filter_map(as_reference).collect(),
        other => as_reference(other).into_iter().collect(),
    }
}

fn is_solid(name: &str) -> bool {
    matches!(name, "MANIFOLD_SOLID_BREP" | "FACETED_BREP" | "BREP_WITH_VOIDS")
}
