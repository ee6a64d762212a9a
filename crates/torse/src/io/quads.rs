//! Strips of quadrilaterals from files: tables of rulings, tables of two polylines, meshes of quadrilaterals in Wavefront OBJ and in
//! Rhino archives. Formats and the order of faces only.

mod error;
mod mesh;
pub(super) mod obj;
mod table;

use super::cad::{self, Format};
use super::threedm;
use crate::torse::quad_strip::QuadStrip;
pub use error::QuadReadError;

/// Most rulings of a file; beyond it the file is no strip.
const MOST_RULINGS: usize = 1 << 18;

/// Reads a strip. Rhino archives are told by what they hold, OBJ by the ending of `name`; `unit` is the length of one unit of the
/// file in mm: where none is given, what headings say, else mm.
///
/// Tables: one ruling per line as `ax, ay, az, bx, by, bz` (or `px` to `qz`); or one point per line as `x, y, z`, the two
/// polylines separated by an empty line. Columns that the first line names may stand in any order among others; see
/// `io::table` for separators. Meshes (OBJ, 3DM): all faces quadrilaterals that form one open strip, in any order; archives
/// know their unit.
///
/// # Errors
/// See [`QuadReadError`].
///
/// # Example
/// ```
/// let table = b"ax,ay,az,bx,by,bz\n0,0,0,0,100,0\n30,0,0,30,100,1\n60,0,20,60,100,22\n";
/// let strip = torse::io::quads::read("hood.csv", table, Some(1.0))?;
/// assert!(strip.quads() == 2 && strip.largest_warp() > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read(name: &str, bytes: &[u8], unit: Option<f64>) -> Result<QuadStrip, QuadReadError> {
    let is_obj = std::path::Path::new(name).extension().is_some_and(|e| e.eq_ignore_ascii_case("obj"));
    let [a, b] = if let Some(format) = cad::recognised(bytes) {
        match format {
            Format::ThreeDm => mesh::rulings(&threedm::meshes::read(bytes)?)?,
            Format::Step | Format::Iges => return Err(QuadReadError::Surfaces),
        }
    } else if is_obj {
        let text = std::str::from_utf8(bytes).map_err(|_| QuadReadError::NotText)?;
        let unit = unit.unwrap_or(1.0);
        obj::rulings(text)?.map(|side| side.into_iter().map(|p| p * unit).collect())
    } else {
        table::rulings(bytes, unit)?
    };
    if a.is_empty() && b.is_empty() {
        return Err(QuadReadError::Empty);
    }
    if a.len().max(b.len()) > MOST_RULINGS {
        return Err(QuadReadError::NoStrip(format!("more than {MOST_RULINGS} rulings")));
    }
    Ok(QuadStrip::new(a, b)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;

    fn read_as(name: &str, text: &str) -> Result<QuadStrip, QuadReadError> {
        read(name, text.as_bytes(), Some(10.0))
    }

    #[test]
    fn rulings_and_polylines_give_the_same_strip() {
        let rulings = "\u{feff}ax;ay;az;bx;by;bz\n# first\n0;0;0;0;1;0\n1;0;0;1;1;0.5 # second\n\n2;0;0;2;1;0\n";
        let lines = "z,y,x\n0,0,0\n0,0,1\n0, 0,2\n\n\n0,1,0\n0.5,1,1\n0,1,2\n\n";
        let s = read_as("s.csv", rulings).expect("a strip");
        assert_eq!(s, read_as("s.txt", lines).expect("a strip"));
        assert_eq!((s.quads(), s.b()[1]), (2, Vec3::new(10.0, 10.0, 5.0)));
    }

    #[test]
    fn faces_of_an_obj_file_are_put_in_order() {
        let obj = "o strip\nv 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0.1\nv 0 1 0\nv 1 1 0\nv 2 1 0.1\nv 3 1 0\n\
                   f 2/1 3/2 7/3 6/4\nf 5 6 2 1\nf -1//1 -5//1 -6//1 -2//1\n";
        let s = read_as("s.OBJ", obj).expect("a strip");
        assert_eq!(s.quads(), 3);
        let sides = [s.a().to_vec(), s.b().to_vec()];
        let expected: Vec<Vec3> =
            (0..4).map(|k| Vec3::new(10.0 * f64::from(k), 0.0, if k == 3 { 1.0 } else { 0.0 })).collect();
        let backwards: Vec<Vec3> = expected.iter().rev().copied().collect();
        assert!(sides.contains(&expected) || sides.contains(&backwards), "{sides:?}");
        let one = read_as("s.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n").expect("a strip");
        assert_eq!(one.quads(), 1);
    }

    #[test]
    fn meshes_of_archives_are_strips_where_they_are_quadrilaterals() {
        let points = |list: &[[f64; 3]]| list.iter().map(|p| Vec3::from(*p)).collect();
        // Neighbours have corners of their own, one of them a zero of the other sign.
        let mut meshes = threedm::meshes::Meshes {
            points: points(&[
                [0.0, 0.0, 0.0],
                [0.0, 9.0, 0.0],
                [5.0, 9.0, 0.0],
                [5.0, 0.0, 0.0],
                [5.0, -0.0, 0.0],
                [5.0, 9.0, -0.0],
                [9.0, 9.0, 2.0],
                [9.0, 0.0, 2.0],
            ]),
            faces: vec![[0, 1, 2, 3], [4, 5, 6, 7]],
            ..Default::default()
        };
        let [a, b] = mesh::rulings(&meshes).expect("a strip");
        assert_eq!(a.len().max(b.len()), 3);
        assert!([&a, &b].iter().any(|side| side.iter().all(|p| p.y == 9.0)), "{a:?} {b:?}");
        meshes.faces[1] = [4, 5, 6, 6];
        assert!(mesh::rulings(&meshes).expect_err("a triangle").to_string().contains("face 1"));
    }

    #[test]
    fn surfaces_are_no_strip_whatever_their_file_is_called() {
        let step = include_bytes!("../../../../data/bracket.step");
        assert_eq!(read("strip.csv", step, None), Err(QuadReadError::Surfaces));
        let iges = format!("{:72}S{:7}\n", "a hull", 1);
        assert_eq!(read("strip.obj", iges.as_bytes(), None), Err(QuadReadError::Surfaces));
    }

    #[test]
    fn what_is_no_strip_is_refused_with_the_reason() {
        let message = |name: &str, text: &str| read_as(name, text).expect_err("refused").to_string();
        assert!(message("s.csv", "").contains("no rulings"));
        assert!(message("s.csv", "0 0 0 0 1 0\n1 0 0 1 1\n").contains("line 2"));
        assert!(message("s.csv", "0 0 0 0 1 0\n1 0 0 1 1 x\n").contains("'x' is not a number"));
        assert!(message("s.csv", "0 0 0 0 1 0\n1 0 0 1 1 inf\n").contains("finite"));
        assert!(message("s.csv", "0 0 0 0 1 0\n1 0 0 1 1e300 0\n").starts_with("line 2: a coordinate, 1e300,"));
        assert!(message("s.csv", "0 0 0\n1 0 0\n").contains("empty line"));
        assert!(message("s.csv", "0 0 0\n1 0 0\n\n0 1 0\n").contains("as many on both sides"));
        assert!(message("s.csv", "0 0 0\n1 0 0\n\n0 1 0\n1 1 0\n\n2 2 2\n").contains("third"));
        assert!(message("s.csv", "0 0 0 0 1 0\n1 0 0\n").contains("line 2"));
        assert_eq!(read("s.obj", &[0xff, 0xfe, 0x00], None), Err(QuadReadError::NotText));
        let v = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n";
        assert!(message("s.obj", &format!("{v}f 1 2 3\n")).contains("3 corners"));
        assert!(message("s.obj", &format!("{v}f 1 2 3 9\n")).contains("vertex 9"));
        assert!(message("s.obj", &format!("{v}f 1 2 3 3\n")).contains("twice"));
        assert!(message("s.obj", v).contains("no faces"));
        assert!(message("s.obj", &format!("{v}f 1 2 3 4\nf 1 2 3 4\n")).contains("closed"));
        let corner = format!("{v}v 0 2 0\nv 1 2 0\nf 1 2 3 4\nf 2 5 6 3\nf 4 3 8 7\n");
        assert!(message("s.obj", &corner).contains("turns"));
        let apart = format!("{v}v 9 0 0\nv 10 0 0\nv 10 1 0\nv 9 1 0\nf 1 2 3 4\nf 7 8 9 10\n");
        assert!(message("s.obj", &apart).contains("pieces"));
    }
}
