//! A shell as a polysurface.

use super::super::bytes::ANONYMOUS;
use super::body::Body;
use super::seams;
use super::trims::{domain, invalid, trims_of, Trim};
use crate::geom::Vec3;
use crate::io::step::write::{Shell, ShellCurve, ShellFace, ShellSurface};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use std::io;

const NURBS_CURVE: u128 = 0x4ED7_D4DD_E947_11D3_BFE5_0010_8301_22F0;
const LINE_CURVE: u128 = 0x4ED7_D4DB_E947_11D3_BFE5_0010_8301_22F0;
const NURBS_SURFACE: u128 = 0x4ED7_D4DE_E947_11D3_BFE5_0010_8301_22F0;
const PLANE_SURFACE: u128 = 0x4ED7_D4DF_E947_11D3_BFE5_0010_8301_22F0;
/// Kinds of trims.
const MATED: i32 = 2;
const SEAM: i32 = 3;

/// Writes the data of a polysurface; `tolerance` (mm) is how near its parts meet.
pub(super) fn write(out: &mut Body, s: &Shell, tolerance: f64) -> io::Result<()> {
    let s = &seams::joined(&seams::closed(s))?;
    let (mut trims, mut loops) = (Vec::new(), Vec::new());
    for (k, f) in s.faces.iter().enumerate() {
        for (i, uses) in f.loops.iter().enumerate() {
            let own = trims_of(s, f, uses, loops.len())?;
            loops.push((trims.len()..trims.len() + own.len(), i == 0, k));
            trims.extend(own);
        }
    }
    let of_edge = |e: usize| -> Vec<usize> { (0..trims.len()).filter(|&t| trims[t].edge == Some(e)).collect() };
    let users: Vec<Vec<usize>> = (0..s.edges.len()).map(of_edge).collect();
    for uses in users.iter().filter(|u| u.len() > 1) {
        let faces: Vec<usize> = uses.iter().map(|&t| loops[trims[t].in_loop].2).collect();
        let kind = if faces.windows(2).all(|w| w[0] == w[1]) { SEAM } else { MATED };
        uses.iter().for_each(|&t| trims[t].kind = kind);
    }
    out.u8(0x32);
    out.table(trims.len(), |t| trims.iter().for_each(|x| listed(t, |t| plane_curve(t, &x.curve))));
    let mut curves = Vec::with_capacity(s.edges.len());
    for e in &s.edges {
        let ends = s.vertices.get(e.start).zip(s.vertices.get(e.end)).ok_or_else(|| invalid(s, "lacks a vertex"))?;
        curves.push(space_curve(s, &e.curve, ends)?);
    }
    out.table(curves.len(), |t| {
        for (_, c) in &curves {
            t.int(1);
            t.bytes.extend_from_slice(&c.bytes);
        }
    });
    let mut surfaces = Vec::with_capacity(s.faces.len());
    for f in &s.faces {
        surfaces.push(surface(s, f)?);
    }
    out.table(surfaces.len(), |t| {
        for c in &surfaces {
            t.int(1);
            t.bytes.extend_from_slice(&c.bytes);
        }
    });
    vertices(out, s, tolerance);
    edges(out, s, &curves, &users, tolerance);
    out.table(trims.len(), |t| trims.iter().enumerate().for_each(|(k, x)| trim(t, k, x, tolerance)));
    out.table(loops.len(), |t| {
        for (k, (range, outer, face)) in loops.iter().enumerate() {
            t.int(k);
            t.ints(&range.clone().collect::<Vec<_>>());
            t.i32(if *outer { 1 } else { 2 });
            t.int(*face);
        }
    });
    out.table(s.faces.len(), |t| {
        for (k, f) in s.faces.iter().enumerate() {
            t.int(k);
            t.ints(&(0..loops.len()).filter(|&l| loops[l].2 == k).collect::<Vec<_>>());
            t.int(k);
            t.i32(i32::from(f.reversed));
            t.i32(0);
        }
    });
    let b = crate::geom::BBox::of(&s.vertices);
    out.point(&b.min);
    out.point(&b.max);
    // No meshes for the screen and for analysis; whether it is a solid is not said.
    for _ in 0..2 {
        out.chunk(ANONYMOUS, |c| s.faces.iter().for_each(|_| c.u8(0)));
    }
    out.i32(0);
    Ok(())
}

/// An object of a table of objects.
fn listed(t: &mut Body, fill: impl FnOnce(&mut Body)) {
    t.int(1);
    fill(t);
}

fn vertices(out: &mut Body, s: &Shell, tolerance: f64) {
    out.table(s.vertices.len(), |t| {
        for (k, p) in s.vertices.iter().enumerate() {
            t.int(k);
            t.point(p);
            // A closed edge ends where it begins.
            let ends = s.edges.iter().enumerate().flat_map(|(i, e)| [(i, e.start), (i, e.end)]);
            t.ints(&ends.filter(|e| e.1 == k).map(|e| e.0).collect::<Vec<_>>());
            t.numbers([tolerance]);
        }
    });
}

fn edges(out: &mut Body, s: &Shell, curves: &[([f64; 2], Body)], users: &[Vec<usize>], tolerance: f64) {
    out.table(s.edges.len(), |t| {
        for (k, e) in s.edges.iter().enumerate() {
            t.int(k);
            t.int(k);
            t.i32(0);
            t.numbers(curves[k].0);
            t.int(e.start);
            t.int(e.end);
            t.ints(&users[k]);
            t.numbers([tolerance]);
            t.numbers(curves[k].0);
        }
    });
}

fn trim(t: &mut Body, index: usize, x: &Trim, tolerance: f64) {
    let (a, b) = x.curve.domain();
    t.int(index);
    t.int(index);
    t.numbers([a, b]);
    t.i32(x.edge.map_or(-1, |e| e as i32));
    t.int(x.vertices[0]);
    t.int(x.vertices[1]);
    t.i32(i32::from(x.reversed));
    t.i32(x.kind);
    t.i32(x.side);
    t.int(x.in_loop);
    t.numbers([0.0, 0.0, a, b]);
    t.put(&[0; 32]);
    t.numbers([tolerance, tolerance]);
}

/// Knots as the format wants them: without the first and the last.
fn knots(c: &mut Body, k: &Knots) {
    let inner = &k.values()[1..k.values().len() - 1];
    c.int(inner.len());
    c.numbers(inner.iter().copied());
}

/// The beginning of a spline curve: dimension, whether it is rational, order, count, reserve, a void box.
fn spline_head(c: &mut Body, dimension: usize, rational: bool, k: &Knots) {
    c.u8(0x10);
    for x in [dimension, usize::from(rational), k.degree() + 1, k.control_count(), 0, 0] {
        c.int(x);
    }
    c.numbers([0.0; 6]);
    knots(c, k);
    c.int(k.control_count());
}

fn plane_curve(t: &mut Body, curve: &Curve<2>) {
    t.object(NURBS_CURVE, |c| {
        spline_head(c, 2, false, &curve.knots);
        c.numbers(curve.control.iter().flatten().copied());
    });
}

/// The curve of an edge with its domain.
fn space_curve(s: &Shell, curve: &ShellCurve, (p, q): (&Vec3, &Vec3)) -> io::Result<([f64; 2], Body)> {
    let mut out = Body::default();
    let domain = match curve {
        ShellCurve::Line => {
            out.object(LINE_CURVE, |c| {
                c.u8(0x10);
                c.point(p);
                c.point(q);
                c.numbers([0.0, 1.0]);
                c.i32(3);
            });
            (0.0, 1.0)
        }
        ShellCurve::Spline(k) => {
            out.object(NURBS_CURVE, |c| {
                spline_head(c, 3, false, &k.knots);
                c.numbers(k.control.iter().flatten().copied());
            });
            k.domain()
        }
        ShellCurve::Rational(k) => {
            out.object(NURBS_CURVE, |c| {
                spline_head(c, 3, true, &k.knots);
                c.numbers(k.control.iter().flatten().copied());
            });
            k.domain()
        }
        ShellCurve::Circle { .. } => return Err(invalid(s, "has a circle as edge, which is not written")),
    };
    Ok(([domain.0, domain.1], out))
}

fn surface(s: &Shell, f: &ShellFace) -> io::Result<Body> {
    let domain = domain(s, f)?;
    let mut out = Body::default();
    match &f.surface {
        ShellSurface::Spline { surface, .. } => out.object(NURBS_SURFACE, |c| spline_surface(c, surface)),
        ShellSurface::Plane(frame) => out.object(PLANE_SURFACE, |c| {
            c.u8(0x11);
            for v in [&frame.origin, &frame.x, &frame.y, &frame.z, &frame.z] {
                c.point(v);
            }
            c.numbers([-frame.z.dot(&frame.origin)]);
            // The parameters are lengths.
            for _ in 0..2 {
                c.numbers(domain.iter().flatten().copied());
            }
        }),
        _ => {}
    }
    Ok(out)
}

fn spline_surface(c: &mut Body, s: &Surface) {
    c.u8(0x10);
    let (ku, kv) = (&s.knots_u, &s.knots_v);
    let counts = [ku.control_count(), kv.control_count()];
    for x in [3, usize::from(s.rational), ku.degree() + 1, kv.degree() + 1, counts[0], counts[1], 0, 0] {
        c.int(x);
    }
    c.numbers([0.0; 6]);
    knots(c, ku);
    knots(c, kv);
    c.int(counts[0] * counts[1]);
    let width = if s.rational { 4 } else { 3 };
    c.numbers(s.control.iter().flat_map(|h| h[..width].iter().copied()));
}
