//! Rulings as a table and as lines in space for CAD: what beams and wires are cut and set by.

use crate::geom::unit::LengthUnit;
use crate::geom::Vec3;
use std::fmt::Write as _;

/// A ruling of a strip, between the strip's borders.
#[derive(Clone, Debug, PartialEq)]
pub struct StripRuling {
    /// Name of the strip.
    pub strip: String,
    /// Number in the strip, from 1.
    pub number: usize,
    /// Ends, mm.
    pub ends: [Vec3; 2],
    /// Unit normal of the plane that all rulings of the strip are parallel to, if there is one.
    pub parallel_to: Option<Vec3>,
}

/// `rulings.csv`: strip, number, both ends and length in a unit; of conoidal strips the normal of the plane.
pub fn csv(rulings: &[StripRuling], unit: LengthUnit) -> Vec<u8> {
    let sign = unit.sign();
    let ends = ["px", "py", "pz", "qx", "qy", "qz", "length"].map(|c| format!("{c}_{sign}")).join(",");
    let mut out = format!("strip,ruling,{ends},mx,my,mz\n");
    for r in rulings {
        // Writing to a string cannot fail.
        _ = write!(out, "\"{}\",{}", r.strip.replace('"', "\"\""), r.number);
        let [p, q] = &r.ends;
        for x in p.iter().chain(q).chain([&(q - p).norm()]) {
            _ = write!(out, ",{:.6}", unit.of(*x));
        }
        let normal = r.parallel_to.map(|m| format!("{:.12},{:.12},{:.12}", m.x, m.y, m.z));
        _ = writeln!(out, ",{}", normal.as_deref().unwrap_or(",,"));
    }
    out.into_bytes()
}

/// `rulings.dxf`: one LINE in space for each ruling, on a layer with the name of its strip. The oldest form of DXF that is
/// still read everywhere (R12).
pub fn dxf(rulings: &[StripRuling], unit: LengthUnit) -> Vec<u8> {
    let number = match unit {
        LengthUnit::Millimetre => 4,
        LengthUnit::Inch => 1,
    };
    let mut out = format!("0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n9\n$INSUNITS\n70\n{number}\n0\nENDSEC\n");
    let mut layers: Vec<String> = rulings.iter().map(|r| layer(&r.strip)).collect();
    layers.dedup();
    _ = write!(out, "0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLAYER\n70\n{}\n", layers.len());
    for (k, name) in layers.iter().enumerate() {
        // Colours 1 to 6 are the distinct ones.
        _ = write!(out, "0\nLAYER\n2\n{name}\n70\n0\n62\n{}\n6\nCONTINUOUS\n", k % 6 + 1);
    }
    out.push_str("0\nENDTAB\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n");
    for r in rulings {
        _ = write!(out, "0\nLINE\n8\n{}\n", layer(&r.strip));
        for (x, group) in r.ends.iter().flat_map(|p| p.iter()).zip([10, 20, 30, 11, 21, 31]) {
            _ = write!(out, "{group}\n{:.6}\n", unit.of(*x));
        }
    }
    out.push_str("0\nENDSEC\n0\nEOF\n");
    out.into_bytes()
}

/// What names of layers may hold.
fn layer(name: &str) -> String {
    name.chars()
        .map(|c| if c.is_ascii_alphanumeric() || "-_$".contains(c) { c.to_ascii_uppercase() } else { '_' })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_files_hold_every_ruling() {
        let ruling = |number: usize| StripRuling {
            strip: "A-01".into(),
            number,
            ends: [Vec3::new(0.0, number as f64, 0.0), Vec3::new(3.0, number as f64, 4.0)],
            parallel_to: (number == 2).then(Vec3::x),
        };
        let all = [ruling(1), ruling(2)];
        let table = String::from_utf8(csv(&all, LengthUnit::Millimetre)).expect("text");
        assert_eq!(table.lines().count(), 3);
        assert!(table.ends_with("4.000000,5.000000,1.000000000000,0.000000000000,0.000000000000\n"), "{table}");
        let drawing = String::from_utf8(dxf(&all, LengthUnit::Millimetre)).expect("text");
        assert_eq!(drawing.matches("\nLINE\n").count(), 2);
        assert!(drawing.contains("8\nA-01\n") && drawing.ends_with("EOF\n"));
        assert_eq!(layer("a b/é"), "A_B__");
        let inches = String::from_utf8(csv(&all, LengthUnit::Inch)).expect("text");
        assert!(inches.starts_with("strip,ruling,px_in,py_in,") && inches.contains(",0.196850,"), "{inches}");
        assert!(String::from_utf8(dxf(&all, LengthUnit::Inch)).expect("text").contains("$INSUNITS\n70\n1\n"));
    }
}
