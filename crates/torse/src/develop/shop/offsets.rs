//! Surfaces at a constant distance from panels: the sides of a sheet and its neutral surface (docs/algorithms/shop.md, "Offsets").
//!
//! *Method*. The offset of a developable is the same developable with its tangent planes moved, so it is told by the panel and a
//! distance; of planes, circular cylinders and circular cones it is of their own kind. Edges are carried along the normals: cubics
//! through such places with their tangents, over the parameters of the panel's trimming curves. Along a ruling the radius of
//! curvature grows evenly, so that it is least at the border, where it is looked at.
//! *Measured, not proven*: how far edges are off, and that no radius is less than the distance.

use crate::brep::recognised_surface::RecognisedSurface;
use crate::geom::{Frame, Vec3};
use crate::patchwork::panel::{Coedge, Panel};
use crate::patchwork::shell_surface::ShellSurface;
use crate::spline::curve::Curve;
use crate::spline::surface::Surface;
use crate::torse::strip::Strip;

/// A run of a border, carried to the offset.
#[derive(Clone, Debug, PartialEq)]
pub struct OffsetRun {
    /// In the parameter plane of the panel's patch.
    pub trim: Curve<2>,
    /// In space, over the same parameter.
    pub edge: Curve<3>,
}

/// The offset of a panel.
#[derive(Clone, Debug)]
pub struct OffsetPanel {
    /// Name of the panel, and its index in the patchwork.
    pub name: String,
    /// See `name`.
    pub panel: usize,
    /// Whether the outer loop runs clockwise in its parameter plane.
    pub mirrored: bool,
    /// What its offset is.
    pub surface: ShellSurface,
    /// Whether the normal of that is the opposite of the patch's.
    pub turned: bool,
    /// Whether the face that is covered has its normal turned over.
    pub reversed: bool,
    /// Border, outer loop first.
    pub loops: Vec<Vec<OffsetRun>>,
    /// Largest distance (mm) of an edge from where it belongs, measured.
    pub edge_error: f64,
}

/// A place where an offset is not regular: the sheet has no room in the bend, or reaches to an apex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoOffset {
    /// Place on the panel, mm.
    pub at: Vec3,
    /// Radius of the panel there (mm), on the side of the offset.
    pub radius: f64,
}

/// Share of the size of a panel within which its edges are carried.
const EDGE: f64 = 1e-9;
/// Parts of a span of a trimming curve at most, and in the beginning.
const MOST_PARTS: usize = 64;
/// See [`MOST_PARTS`].
const PARTS: usize = 4;
/// Share of a part of a run by which tangents are taken.
const STEP: f64 = 1e-4;
/// Offsets keep at least this share of the lengths across the rulings.
const LEAST_SHARE: f64 = 1e-3;

/// The panel at a distance (mm) along the normal of its patch, on the side of ∂u × ∂v; `recognised` is known where the panel is a whole
/// face of that surface.
///
/// # Errors
/// A place where the offset is not regular, or where the panel has no normal.
pub(crate) fn offset(
    panel: &Panel,
    distance: f64,
    recognised: Option<&RecognisedSurface>,
) -> Result<OffsetPanel, NoOffset> {
    let patch = &panel.strip.patch;
    let mut edge_error = 0.0_f64;
    let mut loops = Vec::new();
    for trims in trims(panel) {
        let mut runs = Vec::with_capacity(trims.len());
        for trim in trims {
            let (edge, off) = carried(patch, &trim, distance)?;
            edge_error = edge_error.max(off);
            runs.push(OffsetRun { trim, edge });
        }
        loops.push(runs);
    }
    let middle = loops.first().and_then(|l| l.first()).map_or([0.0; 2], |r| r.trim.point(0.5));
    let (surface, turned) = surface(&panel.strip, middle, distance, recognised);
    Ok(OffsetPanel {
        name: panel.strip.name.clone(),
        panel: 0,
        mirrored: !panel.loops().is_empty() && panel.mirrored(),
        surface,
        turned,
        reversed: false,
        loops,
        edge_error,
    })
}

/// A loop of a panel as trimming curves.
fn of_loop(runs: &[Coedge]) -> Vec<Curve<2>> {
    runs.iter().filter(|r| !r.is_point()).map(|r| r.trim.clone()).collect()
}

/// The trimming curves of a panel; of one that ends where its patch does the sides of that.
fn trims(panel: &Panel) -> Vec<Vec<Curve<2>>> {
    if !panel.loops().is_empty() {
        return panel.loops().iter().map(|l| of_loop(l)).collect();
    }
    let patch = &panel.strip.patch;
    let ((u0, u1), (v0, v1)) = patch.domain();
    let corners = [[u0, v0], [u1, v0], [u1, v1], [u0, v1]];
    let breaks = patch.knots_u.breaks();
    let side = |k: usize| {
        let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
        // Rails have the knots of the patch, beyond which they are not smooth.
        let inner: Vec<f64> = match k % 2 {
            0 => breaks[1..breaks.len() - 1].iter().map(|t| (t - a[0]) / (b[0] - a[0])).collect(),
            _ => Vec::new(),
        };
        let mut shares: Vec<f64> = [0.0].into_iter().chain(inner).chain([1.0]).collect();
        shares.sort_by(f64::total_cmp);
        let at = |s: &f64| [a[0] + (b[0] - a[0]) * s, a[1] + (b[1] - a[1]) * s];
        let control = shares.iter().map(at).collect();
        let knots = [0.0].into_iter().chain(shares.iter().copied()).chain([1.0]).collect();
        Curve::new(1, knots, control).ok()
    };
    vec![(0..corners.len()).filter_map(side).collect()]
}

/// The place at a distance along the normal.
fn moved(patch: &Surface, [u, v]: [f64; 2], distance: f64) -> Result<Vec3, NoOffset> {
    let j = patch.jet(u, v);
    let none = |radius: f64| NoOffset { at: j.p, radius };
    let n = j.normal().try_normalize(0.0).ok_or_else(|| none(0.0))?;
    let along = j.dv.try_normalize(0.0).ok_or_else(|| none(0.0))?;
    let across = j.du - along * along.dot(&j.du);
    // Positive where the panel bends towards its normal.
    let curvature = n.dot(&j.duu) / across.norm_squared();
    let kept = 1.0 - distance * curvature;
    if kept.is_nan() || kept <= LEAST_SHARE {
        return Err(none(curvature.abs().recip()));
    }
    Ok(j.p + n * distance)
}

/// A trimming curve carried to the offset, with the largest distance between.
fn carried(patch: &Surface, trim: &Curve<2>, distance: f64) -> Result<(Curve<3>, f64), NoOffset> {
    let near = EDGE * patch.bbox().diagonal();
    let at = |s: f64| moved(patch, trim.point(s), distance);
    let mut parts = PARTS;
    loop {
        let made = through(&trim.knots.breaks(), parts, &at)?;
        let mut off = 0.0_f64;
        for w in made.knots.breaks().windows(2) {
            for share in [0.25, 0.5, 0.75] {
                let s = w[0] + (w[1] - w[0]) * share;
                off = off.max((Vec3::from(made.point(s)) - at(s)?).norm());
            }
        }
        if off <= near || parts >= MOST_PARTS {
            return Ok((made, off));
        }
        parts *= 2;
    }
}

/// The cubics through places of a curve with its tangents, so many to every span.
fn through(breaks: &[f64], parts: usize, at: &dyn Fn(f64) -> Result<Vec3, NoOffset>) -> Result<Curve<3>, NoOffset> {
    let first = at(breaks[0])?;
    let (mut knots, mut control) = (vec![breaks[0]; 4], vec![first]);
    let count = (breaks.len() - 1) * parts;
    for (span, w) in breaks.windows(2).enumerate() {
        for k in 0..parts {
            let place = |k: usize| w[0] + (w[1] - w[0]) * k as f64 / parts as f64;
            let (a, b) = (place(k), if k + 1 == parts { w[1] } else { place(k + 1) });
            let h = (b - a) * STEP;
            let (p, q) = (at(a)?, at(b)?);
            // One-sided, of second order: spans may meet in corners of their derivatives.
            let start = (at(a + h)? * 4.0 - at(a + 2.0 * h)? - p * 3.0) / (2.0 * h);
            let end = (q * 3.0 + at(b - 2.0 * h)? - at(b - h)? * 4.0) / (2.0 * h);
            control.extend([p + start * ((b - a) / 3.0), q - end * ((b - a) / 3.0), q]);
            knots.extend([b; 3]);
            if span * parts + k + 1 == count {
                knots.push(b);
            }
        }
    }
    let control = control.iter().map(|p| [p.x, p.y, p.z]).collect();
    Curve::new(3, knots, control).map_err(|_| NoOffset { at: first, radius: f64::NAN })
}

/// What the offset of a panel is, and whether the normal of that is the opposite of the patch's; `at` is a place of the panel.
fn surface(strip: &Strip, at: [f64; 2], distance: f64, recognised: Option<&RecognisedSurface>) -> (ShellSurface, bool) {
    let (patch, form) = (strip.patch.clone(), strip.kind.into());
    let beside = if distance == 0.0 {
        (ShellSurface::Spline { surface: patch, form }, false)
    } else {
        (ShellSurface::Offset { surface: patch, form, distance }, false)
    };
    let j = strip.patch.jet(at[0], at[1]);
    let Some(normal) = j.normal().try_normalize(0.0) else { return beside };
    match recognised {
        Some(RecognisedSurface::Plane(frame)) => {
            let side = frame.z.dot(&normal).signum();
            let origin = frame.origin + frame.z * (side * distance);
            (ShellSurface::Plane(Frame { origin, ..*frame }), side < 0.0)
        }
        Some(RecognisedSurface::Cylinder { frame, radius }) => {
            let side = radial(frame, &j.p).dot(&normal).signum();
            (ShellSurface::Cylinder { frame: *frame, radius: radius + side * distance }, side < 0.0)
        }
        Some(RecognisedSurface::Cone { frame, half_angle }) => {
            let side = radial(frame, &j.p).dot(&normal).signum();
            // The apex goes back by what the ruling goes out.
            let back = side * distance / half_angle.sin();
            let height = frame.to_local(&j.p).z;
            let origin = frame.origin + frame.z * height;
            let radius = (height + back) * half_angle.tan();
            (ShellSurface::Cone { frame: Frame { origin, ..*frame }, radius, half_angle: *half_angle }, side < 0.0)
        }
        _ => beside,
    }
}

/// Unit vector from the axis of a frame to a point.
fn radial(frame: &Frame, p: &Vec3) -> Vec3 {
    let q = frame.to_local(p);
    frame.vector_to_world(&Vec3::new(q.x, q.y, 0.0)).try_normalize(0.0).unwrap_or(frame.x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::torse::form::PanelKind;

    /// A strip over an arc of radius 50 about the y axis, as a spline, and rulings of 30.
    fn arc() -> Panel {
        let rail = |y: f64| {
            let at = |k: i32| {
                let (s, c) = (0.02 * f64::from(k)).sin_cos();
                Vec3::new(50.0 * s, y, 50.0 * c)
            };
            let points: Vec<Vec3> = (0..=50).map(at).collect();
            let knots = crate::spline::knots::Knots::clamped(3, &[0.0, 0.25, 0.5, 0.75, 1.0]).expect("knots");
            crate::spline::through::on_knots(&points, &knots, 400).expect("a rail")
        };
        let curve = |y: f64| {
            let c = rail(y);
            Curve { control: c.control.iter().map(|p| [p[0], p[1], p[2], 1.0]).collect(), knots: c.knots }
        };
        Strip::between("arc", PanelKind::Cylinder, &curve(0.0), &curve(30.0)).expect("a strip").into()
    }

    #[test]
    fn edges_are_carried_along_the_normals_and_bends_without_room_refused() {
        let panel = arc();
        let normal = panel.strip.patch.jet(0.5, 0.5).normal();
        let out = normal.z.signum();
        for (distance, radius) in [(4.0, 54.0), (-4.0, 46.0)] {
            let made = offset(&panel, out * distance, None).expect("an offset");
            let ShellSurface::Offset { distance: beside, .. } = made.surface else { panic!("beside the patch") };
            assert_eq!(beside, out * distance);
            assert!(made.edge_error < 1e-6, "{}", made.edge_error);
            for s in [0.1, 0.37, 0.8] {
                let p = Vec3::from(made.loops[0][0].edge.point(s));
                assert!((p.x.hypot(p.z) - radius).abs() < 1e-3, "{p:?}");
            }
            // The border is closed.
            let runs = &made.loops[0];
            for k in 0..4 {
                let (a, b) = (runs[k].edge.point(1.0), runs[(k + 1) % 4].edge.point(0.0));
                assert!((Vec3::from(a) - Vec3::from(b)).norm() < 1e-9);
            }
        }
        let none = offset(&panel, -out * 60.0, None).expect_err("no room");
        assert!((none.radius - 50.0).abs() < 0.5 && (none.at.x.hypot(none.at.z) - 50.0).abs() < 0.01, "{none:?}");
    }

    #[test]
    fn offsets_of_cylinders_and_cones_are_their_own_kind() {
        let frame = Frame { origin: Vec3::zeros(), x: Vec3::z(), y: Vec3::x(), z: Vec3::y() };
        let panel = arc();
        let j = panel.strip.patch.jet(0.5, 0.5);
        let out = j.normal().dot(&Vec3::new(j.p.x, 0.0, j.p.z)).signum();
        let made = offset(&panel, 3.0, Some(&RecognisedSurface::Cylinder { frame, radius: 50.0 })).expect("an offset");
        let ShellSurface::Cylinder { frame: own, radius } = made.surface else { panic!("a cylinder") };
        assert_eq!((own, radius), (frame, 50.0 + 3.0 * out));
        assert_eq!(made.turned, out < 0.0);
        // A cone of half angle 0.5 with its apex in the origin: the offset surface is square to it by the distance.
        let (a, distance) = (0.5_f64, 2.0 * out);
        let half_angle = a;
        let (made, _) =
            surface(&panel.strip, [0.5, 0.5], distance, Some(&RecognisedSurface::Cone { frame, half_angle }));
        let ShellSurface::Cone { frame: own, radius, .. } = made else { panic!("a cone") };
        let height = own.origin.y;
        // Distance of the point (radius, height) of the half plane from the line through the apex.
        assert!((radius * a.cos() - height * a.sin() - 2.0).abs() < 1e-12, "{radius} {height}");
    }
}
