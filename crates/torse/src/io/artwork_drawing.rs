//! Artwork that was carried over as a DXF drawing (AC1009): polylines, points and texts on their layers, in their colours, with the name
//! of their part as data of this program behind each.

use crate::develop::refold::artwork::{Placed, PlacedShape, Style, Words};
use crate::geom::Vec3;
use crate::io::curves::frame_of;
use std::fmt::Write as _;

/// How drawings begin, before the number that tells whether they are as they were written.
const BEGINS: &str = "999\nwritten by torse map, ";
/// What follows that number.
const HEADER: &str =
    "\n0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n9\n$DWGCODEPAGE\n3\nANSI_1252\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n";
/// Digits of coordinates after the point.
const DIGITS: usize = 9;
/// Digits of normals after the point: texts are held at places in frames that these tell.
const NORMAL_DIGITS: usize = 15;
/// Name by which data of this program are known.
const PROGRAM: &str = "TORSE";
/// Layer of things without one.
const NO_LAYER: &str = "0";

/// What was carried over as a drawing in mm; `flat` for drawings of the plane. `layers` are those of the file that it came from, with the
/// numbers of their colours.
pub fn dxf(placed: &[Placed], layers: &[(String, i32)], flat: bool) -> Vec<u8> {
    let mut out = String::from(HEADER);
    tables(&mut out, layers);
    out.push_str("0\nSECTION\n2\nENTITIES\n");
    for one in placed {
        let part = &one.part;
        match &one.shape {
            PlacedShape::Line { points, closed } => {
                let flags = if flat { 0 } else { 8 } + i32::from(*closed);
                begin(&mut out, "POLYLINE", &one.style);
                // Writing to a string cannot fail.
                _ = write!(out, "66\n1\n70\n{flags}\n10\n0.0\n20\n0.0\n30\n0.0\n");
                belongs(&mut out, part);
                for p in points {
                    begin(&mut out, "VERTEX", &one.style);
                    coordinates(&mut out, 10, p);
                    if !flat {
                        out.push_str("70\n32\n");
                    }
                }
                begin(&mut out, "SEQEND", &one.style);
            }
            PlacedShape::Point(p) => {
                begin(&mut out, "POINT", &one.style);
                coordinates(&mut out, 10, p);
                belongs(&mut out, part);
            }
            PlacedShape::Words(words) => {
                begin(&mut out, "TEXT", &one.style);
                text(&mut out, words);
                belongs(&mut out, part);
            }
        }
    }
    out.push_str("0\nENDSEC\n0\nEOF\n");
    let out = format!("{BEGINS}{:016x}{out}", fingerprint(&out));
    // Letters beyond the 256 of the code page are written in ASCII.
    out.chars().map(|c| u8::try_from(c).unwrap_or(b'?')).collect()
}

/// Whether a drawing is to the last letter as [`dxf`] wrote it.
pub(super) fn is_drawing_as_written(bytes: &[u8]) -> bool {
    let text: String = bytes.iter().map(|b| char::from(*b)).collect();
    let number = |rest: &str| -> Option<bool> {
        let (number, rest) = rest.split_at_checked(16)?;
        Some(number == format!("{:016x}", fingerprint(rest)))
    };
    text.strip_prefix(BEGINS).and_then(number) == Some(true)
}

/// From here on letters have the same number in the code page and in Unicode.
const LATIN: u8 = 0xa0;

/// A number that changes with every letter of a text (Fowler, Noll and Vo, 64 bits).
fn fingerprint(text: &str) -> u64 {
    const START: u64 = 0xcbf2_9ce4_8422_2325;
    const PRIME: u64 = 0x0100_0000_01b3;
    text.bytes().fold(START, |hash, b| (hash ^ u64::from(b)).wrapping_mul(PRIME))
}

fn tables(out: &mut String, layers: &[(String, i32)]) {
    _ = write!(out, "0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLAYER\n70\n{}\n", layers.len());
    for (name, colour) in layers {
        _ = write!(out, "0\nLAYER\n2\n{}\n70\n0\n62\n{colour}\n6\nCONTINUOUS\n", escaped(name));
    }
    _ = write!(out, "0\nENDTAB\n0\nTABLE\n2\nAPPID\n70\n1\n0\nAPPID\n2\n{PROGRAM}\n70\n0\n0\nENDTAB\n0\nENDSEC\n");
}

fn begin(out: &mut String, kind: &str, style: &Style) {
    let layer = if style.layer.is_empty() { NO_LAYER.to_owned() } else { escaped(&style.layer) };
    _ = write!(out, "0\n{kind}\n8\n{layer}\n");
    if let Some(colour) = style.colour {
        _ = write!(out, "62\n{colour}\n");
    }
}

/// The part that something lies on.
fn belongs(out: &mut String, part: &str) {
    _ = write!(out, "1001\n{PROGRAM}\n1000\n{}\n", escaped(part));
}

fn coordinates(out: &mut String, code: u32, p: &Vec3) {
    for (d, x) in p.iter().enumerate() {
        _ = write!(out, "{}\n{x:.DIGITS$}\n", code + 10 * d as u32);
    }
}

/// A text in the frame that its normal tells, after what every entity begins with.
fn text(out: &mut String, words: &Words) {
    let frame = frame_of(&words.normal);
    let (at, way) = (frame.vector_to_local(&words.at), frame.vector_to_local(&words.way));
    coordinates(out, 10, &at);
    _ = write!(out, "40\n{:.DIGITS$}\n1\n{}\n", words.height, escaped(&words.text));
    _ = write!(out, "50\n{:.DIGITS$}\n", way.y.atan2(way.x).to_degrees());
    _ = write!(out, "41\n{:.DIGITS$}\n51\n{:.DIGITS$}\n", words.stretch, words.slant);
    if words.held != [0; 2] {
        _ = write!(out, "72\n{}\n73\n{}\n", words.held[0], words.held[1]);
        coordinates(out, 11, &at);
    }
    for (d, x) in words.normal.iter().enumerate() {
        _ = write!(out, "{}\n{x:.NORMAL_DIGITS$}\n", 210 + 10 * d);
    }
}

/// A string in letters of the code page, others as \U+ and four digits; without ends of lines.
fn escaped(text: &str) -> String {
    let mut out = String::new();
    for unit in text.encode_utf16() {
        match u8::try_from(unit) {
            Ok(b) if b.is_ascii_control() => out.push(' '),
            Ok(b) if b.is_ascii() || b >= LATIN => out.push(char::from(b)),
            _ => _ = write!(out, "\\U+{unit:04X}"),
        }
    }
    out
}
