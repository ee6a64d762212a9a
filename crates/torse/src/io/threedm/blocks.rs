//! Where objects stand in the model: once by themselves, or wherever blocks put them.

use super::archive::Archive;
use super::bytes::{fault, Reading, Uuid};
use super::classes::Class;
use super::records::{self, Attributes, Definition, Record};
use crate::answer::note::reader::ReaderNote;
use crate::answer::skipped::Skipped;
use crate::geom::placement::Placement;
use crate::geom::Vec3;
use crate::reason::Reason;
use nalgebra::Matrix3;
use std::collections::{HashMap, HashSet};

/// Levels of blocks at most; a deeper nesting is a circle.
const DEEPEST: u32 = 64;
/// Uses of objects at most; a short file can ask for exponentially many.
const MOST_USES: usize = 100_000;
/// Steps through definitions at most, for the same reason.
const MOST_STEPS: usize = 1_000_000;
/// Shifts above this many mm (a million kilometres) are damage.
const FARTHEST: f64 = 1e12;
/// Types of objects that have faces, or may have: surfaces, polysurfaces, meshes, blocks, SubD, extrusions.
const SHAPES: u32 = 0x0008 | 0x0010 | 0x0020 | 0x1000 | 0x4_0000 | 0x4000_0000;

/// Types of objects that are annotations: texts, dimensions, leaders.
const TEXTS: u32 = 0x0200;

/// What a job looks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Want {
    Faces,
    Curves,
    Meshes,
}

impl Want {
    /// Whether objects of a class have it.
    fn takes(self, class: Class) -> bool {
        match self {
            Self::Curves => class.is_curve(),
            Self::Meshes => class == Class::Mesh,
            Self::Faces => class.has_faces(),
        }
    }
}

/// One use of an object.
#[derive(Clone, Debug)]
pub(super) struct Occurrence {
    /// Index of the object in its table.
    pub object: usize,
    /// Where it goes.
    pub placement: Placement,
    /// The block or the layer that it belongs to.
    pub part: String,
}

/// All uses of objects with faces, and what was found wanting on the way.
#[derive(Debug, Default)]
pub(super) struct Uses {
    pub occurrences: Vec<Occurrence>,
    /// Uses of curves, points and text dots where faces are wanted.
    pub beside: Vec<Occurrence>,
    pub skipped: Vec<Skipped>,
    pub notes: Vec<ReaderNote>,
}

/// What an object is called in messages.
pub(super) fn label(index: usize, record: &Record) -> String {
    let what = record.object.as_ref().map_or("object", |o| o.class.name());
    let Attributes { id, name, .. } = &record.attributes;
    let quoted = if name.is_empty() { String::new() } else { format!(" '{name}'") };
    format!("object {} ({what}{quoted}, {id})", index + 1)
}

/// Follows the blocks of an archive. Objects that have not what is wanted are named only where they may have had faces
/// and these are wanted.
pub(super) fn uses(archive: &Archive, want: Want) -> Uses {
    let members: HashSet<Uuid> = archive.blocks.iter().flat_map(|b| b.members.iter().copied()).collect();
    let by_id = |(i, r): (usize, &Result<Record, String>)| Some((r.as_ref().ok()?.attributes.id, i));
    let mut walk = Walk {
        archive,
        want,
        layers: archive.named_layers(),
        blocks: archive.blocks.iter().map(|d| (d.id, d)).collect(),
        objects: archive.objects.iter().enumerate().filter_map(by_id).collect(),
        named: HashSet::new(),
        steps: 0,
        hidden: HashSet::new(),
        texts: HashSet::new(),
        out: Uses::default(),
    };
    for (i, record) in archive.objects.iter().enumerate() {
        match record {
            Ok(r) if r.attributes.in_block && members.contains(&r.attributes.id) => {}
            Ok(r) if r.attributes.in_block => {
                walk.lost(i, format!("{} belongs to a block that is not in the file", label(i, r)));
            }
            Ok(_) => walk.object(i, &Placement::identity(), "", 0),
            Err(words) => walk.lost(i, format!("object {}: {words}", i + 1)),
        }
    }
    if !walk.hidden.is_empty() {
        walk.out.notes.push(ReaderNote::HiddenObjects { count: walk.hidden.len() });
    }
    if !walk.texts.is_empty() {
        walk.out.notes.push(ReaderNote::AnnotationsNotRead { count: walk.texts.len() });
    }
    walk.out
}

struct Walk<'w, 'a> {
    archive: &'w Archive<'a>,
    want: Want,
    layers: HashMap<i32, (String, bool)>,
    blocks: HashMap<Uuid, &'w Definition>,
    objects: HashMap<Uuid, usize>,
    /// Objects whose loss is named already.
    named: HashSet<usize>,
    hidden: HashSet<usize>,
    /// Annotations where faces are wanted.
    texts: HashSet<usize>,
    steps: usize,
    out: Uses,
}

impl Walk<'_, '_> {
    fn lost(&mut self, object: usize, words: String) {
        if self.named.insert(object) {
            self.out.skipped.push(Reason::Input(words).into());
        }
    }

    /// One use of an object; `part` is the block that it belongs to, if any.
    fn object(&mut self, index: usize, placement: &Placement, part: &str, depth: u32) {
        let archive = self.archive;
        let Some(Ok(record)) = archive.objects.get(index) else { return };
        self.steps += 1;
        if depth > DEEPEST || self.steps > MOST_STEPS || self.out.occurrences.len() + self.out.beside.len() >= MOST_USES
        {
            return self.lost(index, format!("{} contains itself or too much", label(index, record)));
        }
        let (layer, shown) = self.layers.get(&record.attributes.layer).map_or(("", true), |l| (l.0.as_str(), l.1));
        if record.attributes.hidden || !shown {
            self.hidden.insert(index);
            return;
        }
        let part = if part.is_empty() { layer.to_string() } else { part.to_string() };
        let of_kind = record.kind == 0 || record.kind & SHAPES != 0;
        let why = match record.object.as_ref().map(|o| o.class) {
            Ok(class) if self.want.takes(class) => {
                return self.out.occurrences.push(Occurrence { object: index, placement: *placement, part });
            }
            Ok(Class::InstanceRef) => match self.block(record, placement, depth) {
                Ok(()) => return,
                Err(f) => f.0,
            },
            Err(f) if of_kind => f.0.clone(),
            _ if self.want != Want::Faces => return,
            Ok(Class::Mesh) => "meshes are not read as faces; torse fit reads them, or convert it to NURBS".into(),
            Ok(Class::SubD) => "SubD objects are not read; convert it to NURBS in Rhino (ToNURBS)".into(),
            Ok(class) if class.is_curve() || matches!(class, Class::Point | Class::Dot) => {
                return self.out.beside.push(Occurrence { object: index, placement: *placement, part });
            }
            _ if record.kind & TEXTS != 0 => {
                self.texts.insert(index);
                return;
            }
            Ok(Class::Other(id)) if of_kind => format!("objects of the unknown class {id} are not read"),
            _ => return,
        };
        self.lost(index, format!("{}: {why}", label(index, record)));
    }

    /// The members of a block where a use of it puts them.
    fn block(&mut self, record: &Record, placement: &Placement, depth: u32) -> Reading<()> {
        let Ok(object) = &record.object else { return Ok(()) };
        let (id, rows) = records::reference(object.data.clone())?;
        let Some(block) = self.blocks.get(&id).copied() else {
            return fault(format!("its block {id} is not defined in the file"));
        };
        if block.linked && block.members.is_empty() {
            let name = &block.name;
            return fault(format!("its block '{name}' is linked to another file; embed it in Rhino (BlockManager)"));
        }
        let inner = placement.after(&placed(&rows, self.archive.unit.length)?);
        let mut missing = 0;
        for member in &block.members {
            match self.objects.get(member).copied() {
                Some(i) => self.object(i, &inner, &block.name, depth + 1),
                None => missing += 1,
            }
        }
        match missing {
            0 => Ok(()),
            n => fault(format!("{n} members of its block '{}' are not in the file", block.name)),
        }
    }
}

/// The map of a matrix by rows; shifts become mm.
fn placed(rows: &[[f64; 4]; 4], scale: f64) -> Reading<Placement> {
    let linear = Matrix3::from_fn(|i, j| rows[i][j]);
    let shift = Vec3::new(rows[0][3], rows[1][3], rows[2][3]) * scale;
    let affine = rows[3][..3].iter().all(|x| x.abs() <= 0.0) && rows[3][3].to_bits() == 1f64.to_bits();
    if affine && linear.determinant().abs() > f64::MIN_POSITIVE && shift.amax() <= FARTHEST {
        Ok(Placement { linear, shift })
    } else {
        fault("its placement is flat, endless or no affine map")
    }
}

/// Whether lengths grow alike in all directions: then planes, cylinders and cones stay what they are.
pub(super) fn is_similarity(p: &Placement) -> bool {
    let square = p.linear.transpose() * p.linear;
    let size = square.trace() / 3.0;
    (square - Matrix3::identity() * size).amax() <= EVEN * size
}

/// Placements that stretch less than this share differently are even: what ten printed digits lose.
const EVEN: f64 = 1e-9;
