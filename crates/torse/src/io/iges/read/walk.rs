//! The way through a file: from entities that no other refers to, down to the uses of faces.

use super::annotations::is_text;
use super::curves::is_curve;
use super::faces::is_face;
use super::placing;
use super::records::DEEPEST;
use super::records::{Entry, Fault, Records};
use crate::answer::note::reader::ReaderNote;
use crate::geom::placement::Placement;
use crate::geom::Vec3;
use std::collections::{HashMap, HashSet};

/// One use of a face.
#[derive(Clone, Debug)]
pub(super) struct Occurrence {
    /// Number of the face's entity.
    pub face: u64,
    /// Whether a shell turns it round.
    pub flipped: bool,
    /// Name of the part.
    pub part: String,
    /// Where it goes, in the numbers of the file.
    pub placement: Placement,
    /// Number of the body: a solid, a group, or what lies loose in one part.
    pub body: u32,
}

/// All uses of faces, and what was found wanting on the way.
#[derive(Debug, Default)]
pub(super) struct Census {
    /// In the order of the directory.
    pub occurrences: Vec<Occurrence>,
    /// Uses of curves, points and notes that nothing is made of.
    pub beside: Vec<Occurrence>,
    /// Entities that could not be followed.
    pub faults: Vec<Fault>,
    /// Remarks on the file as a whole.
    pub notes: Vec<ReaderNote>,
    /// Names of parts.
    pub parts: Vec<String>,
}

/// Uses of faces at most; a short file can ask for exponentially many.
const MOST_OCCURRENCES: usize = 200_000;
/// Share of its length within which a turned shift is the same.
const SAME_PLACE: f64 = 1e-9;
/// Steps along the assembly tree at most, for the same reason.
const MOST_STEPS: usize = 1_000_000;

/// Where the walk stands.
#[derive(Clone, Copy)]
struct Here<'p> {
    flipped: bool,
    placement: &'p Placement,
    part: &'p str,
    body: u32,
    depth: u32,
}

struct Walk<'r> {
    records: &'r Records,
    /// Where faces, groups and copies were met outside of copied parts: there, what is met again at a place is the same thing.
    met: HashMap<(u64, bool), Vec<Placement>>,
    bodies: u32,
    steps: usize,
    /// What parts are made of that are copied somewhere: it is where the copies are.
    copied: HashSet<u64>,
    /// Parts whose copies are being walked through.
    open: Vec<u64>,
    /// Copies that are shifted and turned.
    turned: Vec<u64>,
    out: Census,
}

/// Finds all uses of faces.
pub(super) fn census(records: &Records) -> Census {
    let referred = referred(records);
    let mut walk = Walk {
        records,
        met: HashMap::new(),
        bodies: 1,
        steps: 0,
        copied: copied(records),
        open: Vec::new(),
        turned: Vec::new(),
        out: Census::default(),
    };
    let place = Placement::identity();
    let top = records.global.product.clone();
    walk.out.parts.extend(Some(top.clone()).filter(|t| !t.is_empty()));
    for (number, _) in records.unlisted.iter().filter(|(_, kind)| may_hold_faces(*kind)) {
        walk.out.faults.push(Fault::new(*number, "its entry in the directory is lost"));
    }
    walk.out.faults.extend(lost_boundaries(records, &referred));
    let mut orphans = 0;
    let is_incomplete = !records.lost.is_empty() || records.all().any(|e| !is_known(e.kind));
    // Groups and copies first, so that their members belong to them.
    for groups in [true, false] {
        for e in records.all().filter(|e| !referred.contains(&e.number) && is_group(e) == groups) {
            let here = Here { flipped: false, placement: &place, part: &top, body: 1, depth: 0 };
            if is_face(e.kind) && e.dependent {
                if is_incomplete {
                    let what = "it is a part of something that is lost, so that its boundary is not known";
                    walk.out.faults.push(Fault::new(e.number, what));
                    continue;
                }
                orphans += 1;
            }
            walk.entity(e.number, here);
        }
    }
    if orphans > 0 {
        walk.out.notes.push(ReaderNote::Orphans { count: orphans });
    }
    let hidden: HashSet<u64> = walk.out.occurrences.iter().map(|o| o.face).collect();
    let hidden = hidden.iter().filter(|f| records.entry(**f).is_some_and(|e| e.blanked)).count();
    if hidden > 0 {
        walk.out.notes.push(ReaderNote::HiddenFaces { count: hidden });
    }
    if let Some(&first) = walk.turned.first() {
        walk.out.notes.push(ReaderNote::ShiftedAndTurned { first, count: walk.turned.len() });
    }
    walk.out
}

/// Purposes of curves that are none of the model: annotation, and parameter planes.
const NOT_MODEL: [u32; 2] = [1, 5];
/// Type of points.
pub(super) const POINT: u32 = 116;

/// Whether an entity is a curve of the model: points and marks of drawings are copious data too.
pub(super) fn is_model_curve(e: &Entry) -> bool {
    is_curve(e.kind) && !NOT_MODEL.contains(&e.purpose) && (e.kind != 106 || matches!(e.form, 11..=13 | 63))
}

/// Forms of associativities that are groups.
const GROUPS: [i64; 4] = [1, 7, 14, 15];

fn is_group(e: &Entry) -> bool {
    (e.kind == 402 && GROUPS.contains(&e.form)) || matches!(e.kind, 186 | 408 | 420 | 430 | 514)
}

/// Entities that others are made of. A curve on a surface that bounds nothing does not make a surface that stands for itself a part
/// of it.
fn referred(records: &Records) -> HashSet<u64> {
    let by = |e: &Entry| children(e).unwrap_or_default();
    let all: HashSet<u64> = records.all().flat_map(by).collect();
    let is_loose = |e: &Entry| e.kind == CURVE_ON_SURFACE && !all.contains(&e.number);
    let hidden = |e: &Entry, part: u64| !is_loose(e) || records.entry(part).is_none_or(|e| e.dependent);
    records.all().flat_map(|e| by(e).into_iter().filter(move |p| hidden(e, *p))).collect()
}

/// Curves on surfaces that are parts of something, though nothing refers to them, nor to their surfaces besides: of a face that is lost.
fn lost_boundaries(records: &Records, referred: &HashSet<u64>) -> Vec<Fault> {
    let is_loose = |e: &Entry| e.kind == CURVE_ON_SURFACE && !referred.contains(&e.number);
    let used: HashSet<u64> =
        records.all().filter(|e| !is_loose(e)).flat_map(|e| children(e).unwrap_or_default()).collect();
    let lost = |e: &&Entry| is_loose(e) && e.dependent && e.pointer(2).is_ok_and(|surface| !used.contains(&surface));
    records.all().filter(lost).map(|e| Fault::new(e.number, "it bounds something that is lost")).collect()
}

/// Type of curves on parametric surfaces.
const CURVE_ON_SURFACE: u32 = 142;

/// Types of parts that are copied, and of their copies.
const PARTS: [u32; 2] = [308, 320];
const COPIES: [u32; 2] = [408, 420];

/// What parts are made of that have copies.
fn copied(records: &Records) -> HashSet<u64> {
    let copies = records.all().filter(|e| COPIES.contains(&e.kind));
    let parts: HashSet<u64> = copies.filter_map(|e| e.pointer(1).ok()).collect();
    let parts = records.all().filter(|e| PARTS.contains(&e.kind) && parts.contains(&e.number));
    parts.flat_map(|e| children(e).unwrap_or_default()).collect()
}

/// Entities that an entity is made of.
pub(super) fn children(e: &Entry) -> Result<Vec<u64>, Fault> {
    let some = |fields: &[usize]| -> Result<Vec<u64>, Fault> { fields.iter().map(|k| e.optional(*k)).collect() };
    let mut out = match e.kind {
        102 => e.pointers(2, e.count(1)?)?,
        108 => some(&[5])?,
        118 | 120 => some(&[1, 2])?,
        122 | 130 => some(&[1])?,
        140 => some(&[5])?,
        141 => {
            let mut out = some(&[3])?;
            let mut at = 5;
            for _ in 0..e.count(4)? {
                let n = e.count(at + 2)?;
                out.push(e.optional(at)?);
                out.extend((0..n).map(|k| e.optional(at + 3 + k)).collect::<Result<Vec<_>, _>>()?);
                at += 3 + n;
            }
            out
        }
        142 => some(&[2, 3, 4])?,
        143 => [some(&[2])?, e.pointers(4, e.count(3)?)?].concat(),
        144 => {
            let inner = (0..e.count(3)?).map(|k| e.optional(5 + k)).collect::<Result<Vec<_>, _>>()?;
            [some(&[1, 4])?, inner].concat()
        }
        162 | 164 => some(&[1])?,
        // Operands are negative; what is positive is an operation.
        180 => {
            (0..e.count(1)?).filter_map(|k| e.integer(2 + k).ok().filter(|p| *p < 0).map(i64::unsigned_abs)).collect()
        }
        184 => e.pointers(2, e.count(1)?)?,
        186 => {
            let voids = (0..e.count(3)?).map(|k| e.optional(4 + 2 * k)).collect::<Result<Vec<_>, _>>()?;
            [some(&[1])?, voids].concat()
        }
        190 => some(&[1, 2, 3])?,
        192 => some(&[1, 2, 4])?,
        194 | 198 => some(&[1, 2, 5])?,
        196 => some(&[1, 3, 4])?,
        308 | 320 => e.pointers(4, e.count(3)?)?,
        402 if GROUPS.contains(&e.form) => e.pointers(2, e.count(1)?)?,
        408 | 412 | 414 | 420 | 430 => some(&[1])?,
        504 => {
            let n = e.count(1)?;
            (0..n).flat_map(|k| [2 + 5 * k, 3 + 5 * k, 5 + 5 * k]).map(|k| e.optional(k)).collect::<Result<_, _>>()?
        }
        508 => {
            let mut out = Vec::new();
            let mut at = 2;
            for _ in 0..e.count(1)? {
                let n = e.count(at + 4)?;
                out.push(e.optional(at + 1)?);
                out.extend((0..n).map(|k| e.optional(at + 6 + 2 * k)).collect::<Result<Vec<_>, _>>()?);
                at += 5 + 2 * n;
            }
            out
        }
        510 => [some(&[1])?, e.pointers(4, e.count(2)?)?].concat(),
        514 => (0..e.count(1)?).map(|k| e.optional(2 + 2 * k)).collect::<Result<_, _>>()?,
        _ => Vec::new(),
    };
    out.retain(|p| *p != 0);
    Ok(out)
}

/// Types of entities that IGES 5.3 has.
const KNOWN: [u32; 90] = [
    0, 100, 102, 104, 106, 108, 110, 112, 114, 116, 118, 120, 122, 123, 124, 125, 126, 128, 130, 132, 134, 136, 138,
    140, 141, 142, 143, 144, 146, 148, 150, 152, 154, 156, 158, 160, 161, 162, 164, 168, 180, 182, 184, 186, 190, 192,
    194, 196, 198, 202, 204, 206, 208, 210, 212, 213, 214, 216, 218, 220, 222, 228, 230, 302, 304, 306, 308, 310, 312,
    314, 316, 320, 322, 402, 404, 406, 408, 410, 412, 414, 416, 418, 420, 422, 430, 502, 504, 508, 510, 514,
];

fn is_known(kind: u32) -> bool {
    KNOWN.binary_search(&kind).is_ok()
}

/// Why an entity at the top of a file is a loss.
fn loss(kind: u32) -> Option<&'static str> {
    match kind {
        150 | 152 | 154 | 156 | 158 | 160 | 162 | 164 | 168 | 180 | 182 | 184 => {
            Some("solids of constructive geometry (CSG) are not read; export the surfaces or a boundary representation")
        }
        134 | 136 | 138 => Some("finite elements are not read; export surfaces"),
        412 | 414 => Some("arrays of copies are not read; explode them before export"),
        416 => Some("it refers to another file; export the model as one file"),
        kind if !is_known(kind) => Some("entities of this type are not known, and may hold faces"),
        _ => None,
    }
}

impl Walk<'_> {
    fn entity(&mut self, id: u64, here: Here) {
        self.steps += 1;
        let full = self.steps > MOST_STEPS || self.out.occurrences.len() + self.out.beside.len() > MOST_OCCURRENCES;
        if here.depth > DEEPEST || full {
            if self.out.faults.last().is_none_or(|f| f.entity != id) {
                self.out.faults.push(Fault::new(id, format!("D{id} contains itself or too much")));
            }
            return;
        }
        if let Err(fault) = self.try_entity(id, here) {
            self.out.faults.push(Fault { entity: id, reason: fault.reason });
        }
    }

    fn try_entity(&mut self, id: u64, here: Here) -> Result<(), Fault> {
        let kind = self.records.kind(id);
        let e = match self.records.get(id) {
            Ok(e) => e,
            // Whatever it was, what it held is lost.
            Err(fault) => return if kind == 0 || may_hold_faces(kind) { Err(fault) } else { Ok(()) },
        };
        let endless = matches!(e.kind, 190) || (e.kind == 108 && e.form == 0);
        let hole = e.kind == 108 && e.form < 0;
        if endless || hole {
            // Planes by themselves are construction geometry.
            return Ok(());
        }
        let placement = here.placement.after(&placing::of_entry(self.records, e)?);
        let below = Here { placement: &placement, depth: here.depth + 1, ..here };
        if is_face(e.kind) {
            if self.first_time(id, here) {
                let Here { flipped, part, body, .. } = here;
                self.out.occurrences.push(Occurrence { face: id, flipped, part: part.to_string(), placement, body });
            }
            return Ok(());
        }
        if is_model_curve(e) || (e.kind == POINT && e.purpose == 0) || is_text(e) {
            // Marks of drawings and helping lines are switched off.
            if !e.blanked && self.first_time(id, here) {
                let Here { flipped, part, body, .. } = here;
                // Curves are read with the transformation of their own.
                let (part, placement) = (part.to_string(), *here.placement);
                self.out.beside.push(Occurrence { face: id, flipped, part, placement, body });
            }
            return Ok(());
        }
        match e.kind {
            186 => {
                let body = self.body();
                let shells = (0..e.count(3)?).map(|k| (4 + 2 * k, 5 + 2 * k)).chain(std::iter::once((1, 2)));
                for (shell, sense) in shells.collect::<Vec<_>>() {
                    let flipped = here.flipped != (e.integer(sense)? == 0);
                    self.entity(e.pointer(shell)?, Here { flipped, body, ..below });
                }
                Ok(())
            }
            514 => {
                let body = if here.depth == 0 { self.body() } else { here.body };
                for k in 0..e.count(1)? {
                    let flipped = here.flipped != (e.integer(3 + 2 * k)? == 0);
                    self.entity(e.pointer(2 + 2 * k)?, Here { flipped, body, ..below });
                }
                Ok(())
            }
            402 if GROUPS.contains(&e.form) => {
                if self.first_time(id, here) {
                    let body = self.body();
                    // A group does not move its members.
                    let inside = Here { placement: here.placement, body, ..below };
                    let members = e.pointers(2, e.count(1)?)?;
                    for m in members {
                        if !self.is_copied(m) {
                            self.entity(m, inside);
                        }
                    }
                }
                Ok(())
            }
            408 | 420 if self.first_time(id, here) => self.copy(e, below),
            408 | 420 => Ok(()),
            430 => {
                self.entity(e.pointer(1)?, below);
                Ok(())
            }
            kind => loss(kind).map_or(Ok(()), |why| Err(Fault::new(id, format!("D{id} (type {kind}): {why}")))),
        }
    }

    /// A copy of a part.
    fn copy(&mut self, e: &Entry, here: Here) -> Result<(), Fault> {
        let part = self.records.get(e.pointer(1)?)?;
        if !PARTS.contains(&part.kind) {
            return Err(Fault::new(e.number, format!("D{} copies D{}, which is no part", e.number, part.number)));
        }
        if self.open.contains(&part.number) {
            return Err(Fault::new(e.number, format!("the part D{} contains itself", part.number)));
        }
        let shift = Vec3::new(e.number(2)?, e.number(3)?, e.number(4)?);
        let own = placing::of_entry(self.records, e)?.linear;
        if (own * shift - shift).norm() > SAME_PLACE * shift.norm() {
            self.turned.push(e.number);
        }
        let scale = if e.has(5) { e.number(5)? } else { 1.0 };
        // Those of networks have a scale for every axis.
        if e.kind == 420 && (6..8).any(|k| e.has(k) && e.number(k).is_ok_and(|s| s != scale)) {
            return Err(Fault::new(e.number, format!("the copy D{} is scaled otherwise along each axis", e.number)));
        }
        if !(scale > 0.0 && scale.is_finite()) {
            return Err(Fault::new(e.number, format!("the copy D{} has the scale {scale}", e.number)));
        }
        let mut placement = Placement { shift, ..Placement::identity() };
        placement.linear *= scale;
        let placement = here.placement.after(&placement).after(&placing::of_entry(self.records, part)?);
        let name = part.text(2).to_string();
        if !name.is_empty() && !self.out.parts.contains(&name) {
            self.out.parts.push(name.clone());
        }
        let body = self.body();
        let members = part.pointers(4, part.count(3)?)?;
        let copies = Here { placement: &placement, part: &name, body, ..here };
        self.open.push(part.number);
        members.into_iter().for_each(|m| self.entity(m, copies));
        self.open.pop();
        Ok(())
    }

    /// Whether a member of a group belongs to a part that brings it itself, where its copies are.
    fn is_copied(&self, id: u64) -> bool {
        match self.open.last() {
            Some(part) => self.records.get(*part).is_ok_and(|p| children(p).is_ok_and(|c| c.contains(&id))),
            None => self.copied.contains(&id),
        }
    }

    /// Whether something is to be walked through: inside of copies always, else once at every place.
    fn first_time(&mut self, id: u64, here: Here) -> bool {
        if !self.open.is_empty() {
            return true;
        }
        let places = self.met.entry((id, here.flipped)).or_default();
        let is_new = places.iter().all(|p| !p.is_nearly(here.placement));
        if is_new {
            places.push(*here.placement);
        }
        is_new
    }

    fn body(&mut self) -> u32 {
        self.bodies += 1;
        self.bodies
    }
}

/// Whether an entity of this type, with its data lost, may have held faces.
fn may_hold_faces(kind: u32) -> bool {
    is_face(kind) || matches!(kind, 186 | 308 | 320 | 402 | 408 | 420 | 430 | 514) || loss(kind).is_some()
}

/// How often each entity is used by others, by type of the user.
pub(super) fn users(records: &Records) -> HashMap<u64, Vec<u32>> {
    let mut out: HashMap<u64, Vec<u32>> = HashMap::new();
    for e in records.all() {
        for c in children(e).unwrap_or_default() {
            out.entry(c).or_default().push(e.kind);
        }
    }
    out
}
