//! Files that are no archives, old ones, cut and damaged ones.

use super::super::{free_curves, meshes, ReadError};
use super::read;
use super::specimens::*;
use crate::io::words;
use crate::io::words::left_out;

fn specimen() -> Vec<u8> {
    let v = [[0., 0.], [4., 0.], [4., 3.], [0., 3.]];
    let face = plane_face(70, &v, &[Ring { corners: &[0, 1, 2, 3], outer: true }], false, false);
    let items = vec![
        Item { name: "a", ..Item::new(BREP_TYPE, BREP, face) },
        Item { name: "b", ..Item::new(SURFACE_TYPE, NURBS_SURFACE, quarter_cylinder(70, 1.0, 1.0)) },
    ];
    Specimen::new(70, items).bytes()
}

#[test]
fn what_is_no_archive_is_named() {
    assert_eq!(read(b" \n").map(|_| ()), Err(ReadError::Empty));
    for (bytes, word) in [
        (b"ISO-10303-21;HEADER;".to_vec(), "STEP"),
        (b"PK\x03\x04".to_vec(), "ZIP"),
        (b"3D Geometry File Format ".to_vec(), "cut off"),
        (b"hello".to_vec(), "does not begin"),
        (b"3D Geometry File Format       xx".to_vec(), "no number"),
    ] {
        let error = read(&bytes).expect_err("refused");
        assert!(matches!(error, ReadError::NotThreeDm(_)) && error.to_string().contains(word), "{error}");
    }
    let versioned = |v: &str| [b"3D Geometry File Format ".to_vec(), format!("{v:>8}").into_bytes()].concat();
    assert_eq!(read(&versioned("1")).map(|_| ()), Err(ReadError::TooOld(1)));
    for unknown in [6, 9, 61, 90, 99] {
        assert_eq!(read(&versioned(&unknown.to_string())).map(|_| ()), Err(ReadError::TooNew(unknown)));
    }
    assert!(matches!(read(&versioned("70")), Err(ReadError::Damaged { .. })));
    assert!(matches!(read(&Specimen::new(70, Vec::new()).bytes()), Err(ReadError::NoFaces { objects: 0, .. })));
}

#[test]
fn a_cut_file_is_refused() {
    let whole = specimen();
    assert_eq!(read(&whole).expect("a model").faces.len(), 2);
    for n in (0..whole.len()).step_by(7) {
        assert!(read(&whole[..n]).is_err(), "{n} bytes");
    }
}

#[test]
fn no_changed_byte_is_a_panic_and_no_shape_is_lost_in_silence() {
    let whole = specimen();
    let mut damaged = 0;
    for at in 32..whole.len() {
        for change in [0x01, 0x80, 0xFF] {
            let mut bytes = whole.clone();
            bytes[at] ^= change;
            let _ = (free_curves::curves(&bytes), meshes::read(&bytes));
            let Ok(m) = read(&bytes) else { continue };
            let words = m.skipped.iter().map(left_out).collect::<Vec<_>>().join("; ");
            damaged += usize::from(words.contains("checksum"));
            let hidden = m.notes.iter().any(|n| words::note(n).contains("hidden"));
            let complete = m.faces.len() == 2 || !words.is_empty() || hidden;
            assert!(complete, "byte {at} ^ {change:#x}: {} faces, {:?}", m.faces.len(), m.notes);
        }
    }
    // Most changes hit numbers of shapes, and show.
    assert!(damaged > whole.len() / 2, "{damaged} of {}", 3 * whole.len());
}

#[test]
fn lengths_that_lie_are_refused() {
    let whole = specimen();
    for at in (32..whole.len() - 8).step_by(3) {
        for value in [i64::MAX, -1, 1 << 40, i64::from(i32::MAX)] {
            let mut bytes = whole.clone();
            bytes[at..at + 8].copy_from_slice(&value.to_le_bytes());
            let _ = (read(&bytes), free_curves::curves(&bytes), meshes::read(&bytes));
        }
    }
}
