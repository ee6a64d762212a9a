//! Bytes of chunks, with their checksums.

use super::super::bytes::{summed, ANONYMOUS, SHORT, SUMMED};
use crate::geom::Vec3;

/// The body of a chunk while it is written.
#[derive(Clone, Debug)]
pub(super) struct Body {
    pub bytes: Vec<u8>,
    /// State of the checksum over all bytes but chunks inside.
    sum: u32,
}

impl Default for Body {
    fn default() -> Self {
        Self { bytes: Vec::new(), sum: !0 }
    }
}

impl Body {
    pub fn put(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
        self.sum = summed(self.sum, bytes);
    }

    pub fn u8(&mut self, x: u8) {
        self.put(&[x]);
    }

    pub fn int(&mut self, x: usize) {
        // No archive of panels comes near the limit.
        self.put(&i32::try_from(x).unwrap_or(i32::MAX).to_le_bytes());
    }

    pub fn i32(&mut self, x: i32) {
        self.put(&x.to_le_bytes());
    }

    pub fn numbers(&mut self, all: impl IntoIterator<Item = f64>) {
        for x in all {
            self.put(&x.to_le_bytes());
        }
    }

    pub fn point(&mut self, p: &Vec3) {
        self.numbers(p.iter().copied());
    }

    /// A counted list of integers.
    pub fn ints(&mut self, all: &[usize]) {
        self.int(all.len());
        for &x in all {
            self.int(x);
        }
    }

    /// A text, counted with a final zero; an empty one is a count of none.
    pub fn text(&mut self, text: &str) {
        let units: Vec<u16> = text.encode_utf16().chain([0]).collect();
        let count = if text.is_empty() { 0 } else { units.len() };
        self.int(count);
        for u in &units[..count] {
            self.put(&u.to_le_bytes());
        }
    }

    /// An identifier as a number in the order in which it is printed.
    pub fn uuid(&mut self, id: u128) {
        let b = id.to_be_bytes();
        self.put(&[b[3], b[2], b[1], b[0], b[5], b[4], b[7], b[6]]);
        self.put(&b[8..]);
    }

    /// A chunk inside.
    pub fn chunk(&mut self, code: u32, fill: impl FnOnce(&mut Self)) {
        let mut inner = Self::default();
        fill(&mut inner);
        self.nested(code, inner);
    }

    /// A chunk inside whose body is there already.
    pub fn nested(&mut self, code: u32, mut inner: Self) {
        if code & SUMMED != 0 {
            inner.bytes.extend_from_slice(&(!inner.sum).to_le_bytes());
        }
        self.bytes.extend_from_slice(&code.to_le_bytes());
        self.bytes.extend_from_slice(&(inner.bytes.len() as u64).to_le_bytes());
        self.bytes.append(&mut inner.bytes);
    }

    /// A chunk of a value alone.
    pub fn short(&mut self, code: u32, value: u64) {
        self.bytes.extend_from_slice(&(code | SHORT).to_le_bytes());
        self.bytes.extend_from_slice(&value.to_le_bytes());
    }

    /// An object of a class.
    pub fn object(&mut self, class: u128, fill: impl FnOnce(&mut Self)) {
        self.chunk(0x0002_7FFA, |c| {
            c.chunk(0x0002_FFFB, |id| id.uuid(class));
            c.chunk(0x0002_FFFC, fill);
            c.short(0x8002_7FFF, 0);
        });
    }

    /// A table of a polysurface: its version, its count, its entries.
    pub fn table(&mut self, count: usize, fill: impl FnOnce(&mut Self)) {
        self.chunk(ANONYMOUS, |t| {
            t.u8(0x10);
            t.int(count);
            fill(t);
        });
    }
}
