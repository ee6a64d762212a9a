//! The tables of an archive around its objects.

use super::super::archive::MAGIC;
use super::body::Body;
use crate::io::step::write::Header;

const END_OF_TABLE: u32 = 0xFFFF_FFFF;
const END_OF_FILE: u32 = 0x0000_7FFF;
/// Version of the archive, right-aligned in eight places.
const VERSION: &[u8; 8] = b"      60";
/// Release of the library whose layout is followed, as such files state it.
const WRITER: u64 = 0x8C00_5F94;
/// Number of the millimetre among units.
const MILLIMETRE: i32 = 2;
/// Tolerances of angles (rad) and of shares that new documents have: one degree, one per cent.
const ANGLE: f64 = std::f64::consts::PI / 180.0;
const SHARE: f64 = 0.01;
/// Identifier of layers.
const LAYER: u128 = 0x9580_9813_E985_11D3_BFE5_0010_8301_22F0;
const BREP: u128 = 0x60B5_DBC5_E660_11D3_BFE4_0010_8301_22F0;
/// Objects and layers are numbered behind this, which makes random identifiers unlikely.
const NUMBERED: u128 = 0x746F_7273_652D_4D33_8000_0000_0000_0000;

/// The archive of these polysurfaces, by names.
pub(super) fn archive(header: &Header, objects: Vec<(&str, Body)>) -> Vec<u8> {
    let mut all = Body::default();
    all.put(MAGIC);
    all.put(VERSION);
    all.chunk(1, |c| c.put(format!("torse {}: {}\n\x1a\0", env!("CARGO_PKG_VERSION"), header.name).as_bytes()));
    table(&mut all, 0x14, |t| t.short(0xA000_0026, WRITER));
    table(&mut all, 0x15, |t| t.chunk(0x2000_8031, |c| units(c, header.uncertainty)));
    for empty in [0x16, 0x25, 0x10, 0x23] {
        table(&mut all, empty, |_| {});
    }
    table(&mut all, 0x11, |t| t.chunk(0x2000_8050, layer));
    for empty in [0x18, 0x19, 0x20, 0x12, 0x22, 0x21] {
        table(&mut all, empty, |_| {});
    }
    table(&mut all, 0x13, |t| {
        for (k, (name, data)) in objects.into_iter().enumerate() {
            t.chunk(0x2000_8070, |r| record(r, k, name, data));
        }
    });
    table(&mut all, 0x26, |_| {});
    let size = all.bytes.len() + 4 + 8 + 8;
    all.chunk(END_OF_FILE, |c| c.put(&(size as u64).to_le_bytes()));
    all.bytes
}

fn table(all: &mut Body, number: u32, fill: impl FnOnce(&mut Body)) {
    all.chunk(0x1000_0000 | number, |t| {
        fill(t);
        t.short(END_OF_TABLE, 0);
    });
}

fn units(c: &mut Body, tolerance: f64) {
    c.i32(102);
    c.i32(MILLIMETRE);
    c.numbers([tolerance, ANGLE, SHARE]);
    // How lengths are shown: decimal, three digits.
    c.i32(0);
    c.i32(3);
    // A unit of its own has the file none.
    c.numbers([1.0]);
    c.text("");
}

fn layer(record: &mut Body) {
    record.object(LAYER, |c| {
        // Version 1.6: up to the parent.
        c.u8(0x16);
        for x in [0, 0, -1, -1, 0, 0] {
            c.i32(x);
        }
        c.put(&[0; 4]);
        c.numbers([0.0, 1.0]);
        c.text("Panels");
        c.u8(1);
        c.i32(-1);
        c.put(&[0; 4]);
        c.numbers([0.0]);
        c.u8(0);
        c.uuid(NUMBERED);
        c.uuid(0);
        c.u8(1);
    });
}

fn record(r: &mut Body, number: usize, name: &str, data: Body) {
    r.short(0x8200_0071, 0x10);
    r.chunk(0x0002_7FFA, |c| {
        c.chunk(0x0002_FFFB, |id| id.uuid(BREP));
        c.nested(0x0002_FFFC, data);
        c.short(0x8002_7FFF, 0);
    });
    r.chunk(0x0200_8072, |a| {
        a.u8(0x20);
        a.uuid(NUMBERED + 1 + number as u128);
        a.i32(0);
        if !name.is_empty() {
            a.u8(1);
            a.text(name);
        }
        a.u8(0);
    });
    r.short(0x8200_007F, 0);
}
