//! Polysurfaces as version 2 of the program wrote them: faces, loops and trims one inside the other, curves and surfaces
//! without frames of their own.

use super::super::bytes::{fault, Cursor, Reading};
use super::super::{curves, surfaces};
use super::tables::{Brep, Edge, Face, Loop, Trim, OUTER, SINGULAR};

/// Kind of a trim that bounds its face.
const BOUNDARY: i32 = 1;
/// Kinds of inner loops, and of those that run there and back.
const INNER: i32 = 2;
const SLIT: i32 = 3;
/// Bytes of a trim at least.
const TRIM: usize = 41;

/// Reads the tables after their version; `scale` is the length of the file's unit in mm.
pub(super) fn read(mut c: Cursor, scale: f64) -> Reading<Brep> {
    let counts = [c.i32()?, c.i32()?, c.i32()?, c.i32()?];
    let [faces, edges, _, trims] = counts;
    if counts.iter().any(|&n| n < 1) {
        return fault(format!("a polysurface has the counts {counts:?}"));
    }
    c.skip(4)?;
    c.skip_box()?;
    let mut out = Brep::default();
    for _ in 0..trims {
        out.plane_curves.push(Ok(curves::inline(&mut c, 1.0)?));
    }
    for curve in 0..edges {
        let found = curves::inline(&mut c, scale)?;
        let part = found.domain();
        out.curves.push(Ok(found));
        out.edges.push(Edge { curve, reversed: false, part, ends: [-1; 2], tolerance: 0.0 });
    }
    for _ in 0..faces {
        out.surfaces.push(Ok(surfaces::inline(&mut c, scale)?));
    }
    for surface in 0..faces {
        face(&mut c, surface, &mut out)?;
    }
    Ok(out)
}

fn face(c: &mut Cursor, surface: i32, out: &mut Brep) -> Reading<()> {
    // Its number and a material.
    c.skip(8)?;
    let reversed = c.i32()? != 0;
    c.skip(4)?;
    c.skip_box()?;
    let mut loops = Vec::new();
    for _ in 0..c.count(TRIM)? {
        c.skip(4)?;
        let kind = match c.i32()? {
            0 => OUTER,
            1 => INNER,
            _ => SLIT,
        };
        // A box in the parameter plane.
        c.skip(32)?;
        let mut trims = Vec::new();
        for _ in 0..c.count(TRIM)? {
            trims.push(out.trims.len() as i32);
            let trim = trim(c, out)?;
            out.trims.push(trim);
        }
        loops.push(out.loops.len() as i32);
        out.loops.push(Loop { trims, kind });
    }
    out.faces.push(Face { loops, surface, reversed });
    Ok(())
}

fn trim(c: &mut Cursor, out: &Brep) -> Reading<Trim> {
    // Its number, its twin, which of both owns the edge.
    c.skip(4 + 4 + 1)?;
    let (edge, reversed) = (c.i32()?, c.i32()? != 0);
    // Flags, and tolerances that later versions do not know.
    c.skip(8 + 16)?;
    let index = out.trims.len();
    let Some(Ok(own)) = out.plane_curves.get(index) else { return fault("a polysurface has more trims than it says") };
    let kind = if edge < 0 { SINGULAR } else { BOUNDARY };
    Ok(Trim { curve: index as i32, part: own.domain(), backwards: false, edge, reversed, kind })
}
