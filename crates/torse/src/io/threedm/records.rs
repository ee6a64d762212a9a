//! Records of the tables of an archive: objects with their attributes, layers, block definitions, units.

use super::bytes::{fault, Cursor, Reading, Uuid};
use super::classes::Class;
use crate::geom::unit as lengths;

const CLASS: u32 = 0x0002_7FFA;
const CLASS_UUID: u32 = 0x0002_FFFB;
const CLASS_DATA: u32 = 0x0002_FFFC;
const OBJECT_TYPE: u32 = 0x8200_0071;
const OBJECT_ATTRIBUTES: u32 = 0x0200_8072;
const COMPONENT: u32 = 0x4000_8002;
/// Writers from this date on store the parent of a layer.
const LAYERS_HAVE_PARENTS: u32 = 200_505_111;

/// An object of a class, not yet read.
#[derive(Clone, Debug)]
pub(super) struct Object<'a> {
    pub class: Class,
    pub data: Cursor<'a>,
}

/// The object that comes next.
pub(super) fn object<'a>(c: &mut Cursor<'a>) -> Reading<Object<'a>> {
    wrapped(c.expect(CLASS)?)
}

fn wrapped<'a>(mut body: Cursor<'a>) -> Reading<Object<'a>> {
    let mut id = body.expect(CLASS_UUID)?;
    let class = Class::of(id.uuid()?);
    id.check()?;
    Ok(Object { class, data: body.expect(CLASS_DATA)? })
}

/// An object of the object table.
#[derive(Clone, Debug)]
pub(super) struct Record<'a> {
    /// What the table calls its type: a flag.
    pub kind: u32,
    pub object: Reading<Object<'a>>,
    pub attributes: Attributes,
}

/// What is said of an object beside its shape.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Attributes {
    pub id: Uuid,
    pub name: String,
    pub layer: i32,
    pub hidden: bool,
    /// Whether it belongs to the definition of a block and stands nowhere by itself.
    pub in_block: bool,
}

/// An object of the object table. Faults of the object stay inside it.
pub(super) fn record<'a>(mut body: Cursor<'a>) -> Reading<Record<'a>> {
    let mut out = Record { kind: 0, object: fault("it has no geometry"), attributes: Attributes::default() };
    while body.left() > 0 {
        let chunk = body.chunk()?;
        match chunk.code {
            OBJECT_TYPE => out.kind = chunk.value as u32,
            CLASS => out.object = wrapped(chunk.body),
            OBJECT_ATTRIBUTES => out.attributes = attributes(chunk.body)?,
            _ => {}
        }
    }
    Ok(out)
}

/// The low bits of an object's mode.
fn of_mode(mode: u8, a: &mut Attributes) {
    match mode & 15 {
        1 => a.hidden = true,
        3 => a.in_block = true,
        _ => {}
    }
}

fn attributes(mut c: Cursor) -> Reading<Attributes> {
    let (major, minor) = c.version()?;
    let mut a = Attributes { id: c.uuid()?, layer: c.i32()?, ..Attributes::default() };
    if major >= 2 {
        tagged(&mut c, &mut a)?;
        return Ok(a);
    }
    // Material, colour, style of line, thickness, scale, density of wires.
    c.skip(4 + 4 + 2 + 2 + 8 + 8 + 4)?;
    of_mode(c.u8()?, &mut a);
    c.skip(3)?;
    a.name = c.name()?;
    let _url = c.text()?;
    if minor >= 1 {
        c.integers()?;
    }
    if minor >= 2 {
        a.hidden |= !c.bool()?;
    }
    Ok(a)
}

/// Attributes that differ from their defaults, by growing numbers; what comes after the last that matters is left.
fn tagged(c: &mut Cursor, a: &mut Attributes) -> Reading<()> {
    loop {
        match c.u8()? {
            1 => a.name = c.name()?,
            2 => drop(c.text()?),
            3 | 4 | 6 | 7 | 10 => c.skip(4)?,
            5 => drop(c.chunk()?),
            8 => c.skip(8)?,
            9 => c.skip(1)?,
            11 => a.hidden |= !c.bool()?,
            12 => of_mode(c.u8()?, a),
            _ => return Ok(()),
        }
    }
}

/// A layer.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Layer {
    pub index: i32,
    pub id: Uuid,
    pub parent: Uuid,
    pub name: String,
    pub hidden: bool,
}

/// A layer of the layer table.
pub(super) fn layer(mut body: Cursor) -> Reading<Layer> {
    let mut c = object(&mut body)?.data;
    let (_, minor) = c.version()?;
    let mode = c.i32()?;
    let mut l = Layer { index: c.i32()?, ..Layer::default() };
    // Level, materials, colour, style of line, thickness, scale.
    c.skip(4 + 4 + 4 + 4 + 2 + 2 + 8 + 8)?;
    l.name = c.name()?;
    l.hidden = if minor >= 1 { !c.bool()? } else { mode == 1 };
    if minor >= 2 {
        c.skip(4)?;
    }
    if minor >= 3 {
        c.skip(4 + 8)?;
    }
    if minor >= 4 {
        c.skip(1)?;
    }
    if minor >= 5 {
        l.id = c.uuid()?;
    }
    if minor >= 6 && c.format.writer >= LAYERS_HAVE_PARENTS {
        l.parent = c.uuid()?;
    }
    Ok(l)
}

/// The definition of a block.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Definition {
    pub id: Uuid,
    pub name: String,
    pub members: Vec<Uuid>,
    /// Whether its members are in another file.
    pub linked: bool,
}

/// Sort of block whose members are in another file.
const LINKED: u32 = 3;

/// A definition of the table of blocks.
pub(super) fn definition(mut body: Cursor) -> Reading<Definition> {
    let mut c = object(&mut body)?.data;
    let mut d = Definition::default();
    // The older form begins with a version of one byte, the newer with a chunk.
    if c.clone().u8()? >> 4 == 1 {
        c.skip(1)?;
        (d.id, d.members, d.name) = (c.uuid()?, c.uuids()?, c.name()?);
        let _texts = (c.text()?, c.text()?, c.text()?);
        c.skip_box()?;
        d.linked = c.u32()? == LINKED;
        return Ok(d);
    }
    let mut c = c.anonymous()?;
    c.skip(8)?;
    let mut component = c.expect(COMPONENT)?;
    (d.id, d.name) = identity(&mut component)?;
    d.linked = c.u32()? == LINKED;
    c.anonymous()?;
    let _texts = (c.text()?, c.text()?, c.text()?);
    c.skip_box()?;
    if c.bool()? {
        d.members = c.uuids()?;
    }
    Ok(d)
}

/// Identifier and name of a component of the model: each part stands only where a flag before it is 1.
fn identity(c: &mut Cursor) -> Reading<(Uuid, String)> {
    c.skip(8)?;
    if c.u8()? == 1 {
        c.skip(12)?;
    }
    let id = if c.u8()? == 1 { c.uuid()? } else { Uuid::default() };
    for _ in 0..2 {
        if c.u8()? == 1 {
            c.skip(4)?;
        }
    }
    let name = if c.u8()? == 1 { c.name()? } else { String::new() };
    Ok((id, name))
}

/// A use of a block: which, and the rows of the matrix that places it.
pub(super) fn reference(mut c: Cursor) -> Reading<(Uuid, [[f64; 4]; 4])> {
    c.version()?;
    let id = c.uuid()?;
    let mut rows = [[0.0; 4]; 4];
    for x in rows.iter_mut().flatten() {
        *x = c.f64()?;
    }
    c.skip_box()?;
    c.check()?;
    Ok((id, rows))
}

/// The unit of length.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Unit {
    /// Length of one unit, mm.
    pub length: f64,
    /// Name in lower case; empty if the file names none.
    pub name: String,
    /// Distance below which the file calls points the same, mm; 0 if it does not say.
    pub tolerance: f64,
}

impl Default for Unit {
    fn default() -> Self {
        Self { length: 1.0, name: String::new(), tolerance: 0.0 }
    }
}

/// Name of each unit, by its number in files; the first is none.
const UNITS: [&str; 26] = [
    "",
    "micrometre",
    "millimetre",
    "centimetre",
    "metre",
    "kilometre",
    "microinch",
    "mil",
    "inch",
    "foot",
    "mile",
    "custom unit",
    "angstrom",
    "nanometre",
    "decimetre",
    "dekametre",
    "hectometre",
    "megametre",
    "gigametre",
    "yard",
    "printer point",
    "printer pica",
    "nautical mile",
    "astronomical unit",
    "light year",
    "parsec",
];
/// Millimetres of a metre.
const MILLIMETRES: f64 = 1e3;
/// Number of the unit that the file defines itself.
const CUSTOM: usize = 11;
/// Number that stands for no unit.
const UNSET: usize = 255;

/// The units and tolerances of the settings.
pub(super) fn unit(mut c: Cursor) -> Reading<Unit> {
    let version = c.i32()?;
    let number = c.i32()?;
    let tolerance = c.f64()?;
    let known = usize::try_from(number).ok().map(|n| if n == UNSET { 0 } else { n });
    let Some((n, name)) = known.and_then(|n| Some((n, *UNITS.get(n)?))) else {
        return fault(format!("the unit of length has the unknown number {number}"));
    };
    let mut length = lengths::named(name).map_or(1.0, |u| u.mm);
    let mut name = name.to_string();
    if n == CUSTOM {
        if version < 102 {
            return fault("the file has a unit of its own but does not say how long it is");
        }
        c.skip(8 + 8 + 4 + 4)?;
        let metres = c.f64()?;
        if metres <= 0.0 {
            return fault(format!("the file's own unit of length is {metres} m"));
        }
        length = metres * MILLIMETRES;
        name = Some(c.name()?.trim().to_lowercase()).filter(|n| !n.is_empty()).unwrap_or(name);
    }
    c.check()?;
    Ok(Unit { length, name, tolerance: (tolerance * length).max(0.0) })
}
