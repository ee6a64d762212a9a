//! Chunks of bytes: the framing of archives. Every length is checked against what is left before anything is taken.

use crate::geom::Vec3;

/// What is wrong with a part of a file, in words.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fault(pub String);

/// The outcome of reading a part.
pub(super) type Reading<T> = Result<T, Fault>;

/// A fault in words.
pub(super) fn fault<T>(words: impl Into<String>) -> Reading<T> {
    Err(Fault(words.into()))
}

/// What decides about the layout of an archive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Format {
    /// Version of the archive: 4, 50, 60, ….
    pub version: u32,
    /// Date of the library that wrote it, as a number; 0 if it does not say.
    pub writer: u32,
}

/// Letters of a name at most.
pub(super) const LONGEST_NAME: usize = 200;
/// Archives from this version on have lengths of 8 bytes.
const FIRST_WIDE: u32 = 50;
/// Flag of chunks without a body.
pub(super) const SHORT: u32 = 0x8000_0000;
/// Flag of chunks that end with a checksum.
pub(super) const SUMMED: u32 = 0x0000_8000;
/// Chunk without a meaning of its own.
pub(super) const ANONYMOUS: u32 = 0x4000_8000;

/// A place in a body of bytes.
#[derive(Clone, Debug)]
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Layout of the archive.
    pub format: Format,
    /// Chunks inside, which the checksum leaves out.
    nested: Vec<(usize, usize)>,
    sum: Option<u32>,
}

/// A chunk.
#[derive(Clone, Debug)]
pub(super) struct Chunk<'a> {
    /// What it is.
    pub code: u32,
    /// The value of a chunk without a body.
    pub value: i64,
    /// Its body; empty for chunks without one.
    pub body: Cursor<'a>,
}

impl<'a> Cursor<'a> {
    /// The beginning of `bytes`.
    pub fn new(bytes: &'a [u8], format: Format) -> Self {
        Self { bytes, at: 0, format, nested: Vec::new(), sum: None }
    }

    /// Number of bytes that are left.
    pub fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// The next `n` bytes.
    pub fn take(&mut self, n: usize) -> Reading<&'a [u8]> {
        match self.bytes.get(self.at..).and_then(|rest| rest.get(..n)) {
            Some(taken) => {
                self.at += n;
                Ok(taken)
            }
            None => fault(format!("{n} bytes are asked for where {} are left", self.left())),
        }
    }

    /// Passes `n` bytes over.
    pub fn skip(&mut self, n: usize) -> Reading<()> {
        self.take(n).map(|_| ())
    }

    /// All bytes that are left.
    pub fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    fn array<const N: usize>(&mut self) -> Reading<[u8; N]> {
        let mut out = [0; N];
        out.copy_from_slice(self.take(N)?);
        Ok(out)
    }

    /// A byte.
    pub fn u8(&mut self) -> Reading<u8> {
        Ok(self.array::<1>()?[0])
    }

    /// A truth value of one byte.
    pub fn bool(&mut self) -> Reading<bool> {
        Ok(self.u8()? != 0)
    }

    /// A signed integer of 4 bytes.
    pub fn i32(&mut self) -> Reading<i32> {
        Ok(i32::from_le_bytes(self.array()?))
    }

    /// An unsigned integer of 4 bytes.
    pub fn u32(&mut self) -> Reading<u32> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    /// A number.
    pub fn f64(&mut self) -> Reading<f64> {
        let x = f64::from_le_bytes(self.array()?);
        if x.is_finite() {
            Ok(x)
        } else {
            fault("a number is not finite")
        }
    }

    /// Three numbers.
    pub fn vector(&mut self) -> Reading<Vec3> {
        Ok(Vec3::new(self.f64()?, self.f64()?, self.f64()?))
    }

    /// Two numbers.
    pub fn interval(&mut self) -> Reading<[f64; 2]> {
        Ok([self.f64()?, self.f64()?])
    }

    /// Two numbers that increase.
    pub fn increasing(&mut self) -> Reading<[f64; 2]> {
        let [a, b] = self.interval()?;
        if a < b {
            Ok([a, b])
        } else {
            fault(format!("the interval from {a} to {b} is empty"))
        }
    }

    /// A count of things that take at least `each` bytes.
    pub fn count(&mut self, each: usize) -> Reading<usize> {
        let n = self.i32()?;
        match usize::try_from(n).ok().and_then(|n| Some((n, n.checked_mul(each)?))) {
            Some((n, bytes)) if bytes <= self.left() => Ok(n),
            _ => fault(format!("a list claims {n} entries where {} bytes are left", self.left())),
        }
    }

    /// A counted list of numbers.
    pub fn numbers(&mut self) -> Reading<Vec<f64>> {
        let n = self.count(8)?;
        (0..n).map(|_| self.f64()).collect()
    }

    /// A counted list of integers.
    pub fn integers(&mut self) -> Reading<Vec<i32>> {
        let n = self.count(4)?;
        (0..n).map(|_| self.i32()).collect()
    }

    /// A text of 16-bit units that are counted with the final zero.
    pub fn text(&mut self) -> Reading<String> {
        let n = self.count(2)?;
        let units = self.take(2 * n)?.chunks_exact(2).map(|b| u16::from_le_bytes([b[0], b[1]]));
        let units: Vec<u16> = units.take_while(|&u| u != 0).collect();
        Ok(String::from_utf16_lossy(&units))
    }

    /// A text that names something, cut where it is longer than any name: every face has a copy.
    pub fn name(&mut self) -> Reading<String> {
        Ok(self.text()?.chars().take(LONGEST_NAME).collect())
    }

    /// An identifier.
    pub fn uuid(&mut self) -> Reading<Uuid> {
        let b: [u8; 16] = self.array()?;
        Ok(Uuid([b[3], b[2], b[1], b[0], b[5], b[4], b[7], b[6], b[8], b[9], b[10], b[11], b[12], b[13], b[14], b[15]]))
    }

    /// A counted list of identifiers.
    pub fn uuids(&mut self) -> Reading<Vec<Uuid>> {
        let n = self.count(16)?;
        (0..n).map(|_| self.uuid()).collect()
    }

    /// Major and minor version in one byte.
    pub fn version(&mut self) -> Reading<(u8, u8)> {
        let b = self.u8()?;
        Ok((b >> 4, b & 15))
    }

    /// Passes a box of two points over, which may be void.
    pub fn skip_box(&mut self) -> Reading<()> {
        self.skip(48)
    }

    /// The next chunk.
    pub fn chunk(&mut self) -> Reading<Chunk<'a>> {
        let start = self.at;
        let code = self.u32()?;
        let value = if self.format.version >= FIRST_WIDE {
            i64::from_le_bytes(self.array()?)
        } else {
            i64::from(i32::from_le_bytes(self.array()?))
        };
        let mut body = Self::new(&[], self.format);
        if code & SHORT == 0 {
            let Some(length) = usize::try_from(value).ok().filter(|&n| n <= self.left()) else {
                return fault(format!("a part claims {value} bytes where {} are left", self.left()));
            };
            body.bytes = self.take(length)?;
            if code & SUMMED != 0 {
                let Some((inner, sum)) = body.bytes.split_last_chunk::<4>() else {
                    return fault("a part has no room for its checksum");
                };
                (body.bytes, body.sum) = (inner, Some(u32::from_le_bytes(*sum)));
            }
        }
        self.nested.push((start, self.at));
        Ok(Chunk { code, value, body })
    }

    /// The body of the next chunk, which must be anonymous.
    pub fn anonymous(&mut self) -> Reading<Self> {
        self.expect(ANONYMOUS)
    }

    /// The body of the next chunk, which must be of one kind.
    pub fn expect(&mut self, code: u32) -> Reading<Self> {
        let chunk = self.chunk()?;
        if chunk.code == code {
            Ok(chunk.body)
        } else {
            fault(format!("a part of kind {:#010x} stands where one of kind {code:#010x} is needed", chunk.code))
        }
    }

    /// Compares the checksum with all bytes that do not belong to chunks inside; those not read yet must be no chunks.
    pub fn check(&self) -> Reading<()> {
        let Some(sum) = self.sum else { return Ok(()) };
        let (mut state, mut from) = (!0, 0);
        for &(start, end) in &self.nested {
            state = summed(state, &self.bytes[from..start]);
            from = end;
        }
        if !summed(state, &self.bytes[from..]) == sum {
            Ok(())
        } else {
            fault("its checksum is wrong: the file is damaged there")
        }
    }
}

/// The checksum of CRC-32 over a whole buffer.
pub(super) fn checksum(bytes: &[u8]) -> u32 {
    !summed(!0, bytes)
}

/// Remainders of single bytes under the reversed polynomial of CRC-32.
const REMAINDERS: [u32; 256] = {
    let mut table = [0; 256];
    let mut i = 0;
    while i < 256 {
        let mut r = i as u32;
        let mut bit = 0;
        while bit < 8 {
            r = if r & 1 == 1 { (r >> 1) ^ 0xEDB8_8320 } else { r >> 1 };
            bit += 1;
        }
        table[i] = r;
        i += 1;
    }
    table
};

pub(super) fn summed(state: u32, bytes: &[u8]) -> u32 {
    bytes.iter().fold(state, |s, &b| REMAINDERS[usize::from(b ^ s as u8)] ^ (s >> 8))
}

/// An identifier of 16 bytes, in the order in which it is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Uuid(pub [u8; 16]);

impl Uuid {
    /// The identifier with the digits of `number`.
    pub const fn of(number: u128) -> Self {
        Self(number.to_be_bytes())
    }

    /// Whether it identifies nothing.
    pub fn is_nil(self) -> bool {
        self == Self::default()
    }
}

impl std::fmt::Display for Uuid {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (i, b) in self.0.iter().enumerate() {
            if matches!(i, 4 | 6 | 8 | 10) {
                write!(f, "-")?;
            }
            write!(f, "{b:02x}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_read_as_they_are_printed() {
        let bytes = [0xDD, 0xD4, 0xD7, 0x4E, 0x47, 0xE9, 0xD3, 0x11, 0xBF, 0xE5, 0x00, 0x10, 0x83, 0x01, 0x22, 0xF0];
        let id = Cursor::new(&bytes, Format::default()).uuid().expect("an identifier");
        assert_eq!(id, Uuid::of(0x4ED7_D4DD_E947_11D3_BFE5_0010_8301_22F0));
        assert_eq!(id.to_string(), "4ed7d4dd-e947-11d3-bfe5-0010830122f0");
    }

    #[test]
    fn the_checksum_is_that_of_the_field() {
        // The value that every description of CRC-32 gives for these nine digits.
        assert_eq!(checksum(b"123456789"), 0xCBF4_3926);
    }

    #[test]
    fn lengths_beyond_the_end_are_refused() {
        let format = Format { version: 70, writer: 0 };
        for length in [-1_i64, 1, i64::MAX] {
            let bytes = [0x13_u32.to_le_bytes().to_vec(), length.to_le_bytes().to_vec()].concat();
            assert!(Cursor::new(&bytes, format).chunk().is_err(), "{length}");
        }
        let many = i32::MAX.to_le_bytes();
        assert!(Cursor::new(&many, format).numbers().is_err());
    }

    #[test]
    fn checksums_leave_chunks_inside_out() {
        let format = Format { version: 4, writer: 0 };
        let inner = [7_u32.to_le_bytes(), 4_i32.to_le_bytes(), [9; 4]].concat();
        let direct = [5_u8; 6];
        let body = [&direct[..2], &inner, &direct[2..], &checksum(&direct).to_le_bytes()].concat();
        let head = [ANONYMOUS.to_le_bytes(), (body.len() as i32).to_le_bytes()].concat();
        let mut bytes = [head, body].concat();
        let read = |bytes: &[u8]| -> Reading<()> {
            let mut outer = Cursor::new(bytes, format).anonymous()?;
            outer.skip(2)?;
            assert_eq!(outer.chunk()?.code, 7);
            outer.check()
        };
        assert_eq!(read(&bytes), Ok(()));
        bytes[9] ^= 1;
        assert!(read(&bytes).is_err());
    }
}
