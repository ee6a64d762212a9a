//! Developable surfaces as curves of planes: the dual representation \[PW99\], types (1), (2) and (3).
//!
//! A plane is `n·X = h` with coordinates `(n_x, n_y, n_z, h)`. A spline of planes is
//! - *general* (type 1): any coordinates, factors included;
//! - a *graph* (type 2): `n_z = 1`, so that planes are the graphs `z = u0 + u1 x + u2 y` with `(u0, u1, u2) = (h, −n_x, −n_y)`;
//! - *by slope* (type 3): in addition `u2(t) = t`; the parameter is the slope in y.
//!
//! Rulings are `U ∩ U'`, regression points `U ∩ U' ∩ U''`. Nothing here knows where the planes come from.

pub(crate) mod assemble;
pub mod inflection;
pub mod regression_curve;
pub(crate) mod tensor_product;
mod wedge;

pub use wedge::Plane;

use super::form::{DualTorse, Ruling};
use crate::geom::placement::Placement;
use crate::geom::{Frame, Vec3};
use crate::spline::curve::{bezier_pieces, Curve};
use crate::spline::knots::Knots;
use crate::spline::SplineError;

/// Which of the three types of \[PW99\] a curve of planes is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DualKind {
    /// Type (1): any coordinates.
    General,
    /// Type (2): `n_z = 1`.
    Graph,
    /// Type (3): `n_z = 1` and `n_y = −t`.
    Slope,
}

/// What a curve of planes cannot do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DualError {
    /// Not a spline.
    #[error(transparent)]
    Spline(#[from] SplineError),
    /// All coordinates of a control plane vanish.
    #[error("control plane {index} has no coordinates")]
    NoPlane {
        /// Its index.
        index: usize,
    },
    /// A plane parallel to the z-axis where graphs are needed.
    #[error(
        "plane {index} is parallel to the chosen z-axis (cosine {cosine:e}): choose another axis or split the data"
    )]
    Parallel {
        /// Its index.
        index: usize,
        /// Cosine of the angle between its normal and the axis.
        cosine: f64,
    },
    /// Plane and derivative coincide: an inflection ruling or a stretch of equal planes.
    #[error("the planes stand still at t = {t}: there is no ruling; split the surface there")]
    NoRuling {
        /// Parameter.
        t: f64,
    },
    /// The operation is for another type of curve.
    #[error("this needs a curve of planes of type {wanted:?}, not {kind:?}")]
    Kind {
        /// What is needed.
        wanted: DualKind,
        /// What is given.
        kind: DualKind,
    },
    /// The degree is too low.
    #[error("degree {degree} has no {what}: elevate it first")]
    Degree {
        /// Degree given.
        degree: usize,
        /// What was asked for.
        what: &'static str,
    },
    /// The curve is only continuous at a knot.
    #[error("the planes are only continuous at the knot {value} (multiplicity {multiplicity}): the surface has a planar facet there; split it")]
    Facet {
        /// Value of the knot.
        value: f64,
        /// Its multiplicity.
        multiplicity: usize,
    },
    /// A ruling is parallel to a boundary plane.
    #[error("the ruling near t = {t} is parallel to the boundary plane: choose another plane or split the surface")]
    RulingParallel {
        /// Parameter near which the weight vanishes.
        t: f64,
    },
    /// The map cannot be inverted.
    #[error("the map is not invertible")]
    Singular,
}

/// A developable surface given by its tangent planes as a B-spline curve of dual space.
#[derive(Clone, Debug, PartialEq)]
pub struct DualCurve {
    kind: DualKind,
    planes: Curve<4>,
}

impl DualCurve {
    /// Type (1): control planes with any factors.
    ///
    /// # Errors
    /// Knots that do not fit, coordinates that are not finite, control planes without coordinates.
    pub fn general(degree: usize, knots: Vec<f64>, control: Vec<Plane>) -> Result<Self, DualError> {
        let planes = Curve::new(degree, knots, control)?;
        if let Some(index) = planes.control.iter().position(|c| c.iter().all(|x| *x == 0.0)) {
            return Err(DualError::NoPlane { index });
        }
        Ok(Self { kind: DualKind::General, planes })
    }

    /// Type (2): control planes `z = u0 + u1 x + u2 y`.
    ///
    /// # Errors
    /// As [`DualCurve::general`].
    pub fn graph(degree: usize, knots: Vec<f64>, control: &[[f64; 3]]) -> Result<Self, DualError> {
        let control = control.iter().map(of_graph).collect();
        Ok(Self { kind: DualKind::Graph, planes: Curve::new(degree, knots, control)? })
    }

    /// Type (3): control values of `u0` and `u1`; `u2 = t`.
    ///
    /// # Errors
    /// As [`DualCurve::general`].
    pub fn slope(degree: usize, knots: Vec<f64>, control: &[[f64; 2]]) -> Result<Self, DualError> {
        let knots = Knots::new(degree, knots, control.len())?;
        let v = knots.values().to_vec();
        // The identity has the Greville abscissae as control values.
        let greville = |i: usize| v[i + 1..=i + degree].iter().sum::<f64>() / degree as f64;
        let control = control.iter().enumerate().map(|(i, c)| of_graph(&[c[0], c[1], greville(i)])).collect();
        Ok(Self { kind: DualKind::Slope, planes: Curve::new(degree, v, control)? })
    }

    /// The type.
    pub fn kind(&self) -> DualKind {
        self.kind
    }

    /// The spline of plane coordinates `(n_x, n_y, n_z, h)`.
    pub fn planes(&self) -> &Curve<4> {
        &self.planes
    }

    /// Knots and degree.
    pub fn knots(&self) -> &Knots {
        &self.planes.knots
    }

    /// Ends of the parameter domain.
    pub fn domain(&self) -> (f64, f64) {
        self.planes.domain()
    }

    /// The plane at `t` with its first two derivatives.
    pub fn jet(&self, t: f64) -> [Plane; 3] {
        self.planes.jet(t)
    }

    /// The spline of the graphs `(u0, u1, u2)`; of type (1), planes that are none say nothing.
    pub fn graphs(&self) -> Curve<3> {
        Curve { knots: self.planes.knots.clone(), control: self.planes.control.iter().map(graph_of).collect() }
    }

    /// The graph `(u0, u1, u2)` at `t` with its first two derivatives; see [`DualCurve::graphs`].
    pub fn graph_jet(&self, t: f64) -> [[f64; 3]; 3] {
        self.jet(t).map(|plane| graph_of(&plane))
    }

    /// Ruling and tangent plane at `t`; the point is the one nearest the origin. Does not depend on factors of the
    /// planes.
    ///
    /// # Errors
    /// The planes stand still at `t`.
    pub fn ruling(&self, t: f64) -> Result<Ruling, DualError> {
        // Share of the lengths below which the direction is rounding only.
        const STILL: f64 = 1e-14;
        let [plane, turning, _] = self.jet(t);
        let (n, m) = (normal_of(&plane), normal_of(&turning));
        let e = n.cross(&m);
        let size = e.norm();
        if size.is_nan() || size <= STILL * n.norm() * m.norm() {
            return Err(DualError::NoRuling { t });
        }
        let point = (m.cross(&e) * plane[3] + e.cross(&n) * turning[3]) / e.norm_squared();
        Ok(Ruling { point, direction: e.normalize(), normal: n.normalize() })
    }

    /// Regression point at `t` in homogeneous coordinates `(w x, w y, w z, w)`: the point common to `U`, `U'`, `U''`.
    /// `w = 0` for rulings of a cylinder; all zero at stationary planes.
    pub fn regression_point(&self, t: f64) -> [f64; 4] {
        let [u, d, s] = self.jet(t);
        wedge::point_of_planes(&u, &d, &s)
    }

    /// The same surface moved. Of type (1), since graphs over the xy-plane do not stay graphs.
    ///
    /// # Errors
    /// The map is not invertible.
    pub fn transformed(&self, map: &Placement) -> Result<Self, DualError> {
        let inverse = map.inverse().ok_or(DualError::Singular)?;
        // A plane is a linear form: composed with the inverse map.
        let moved = |c: &Plane| {
            let n = inverse.linear.transpose() * normal_of(c);
            [n.x, n.y, n.z, c[3] - normal_of(c).dot(&inverse.shift)]
        };
        let control = self.planes.control.iter().map(moved).collect();
        Ok(Self { kind: DualKind::General, planes: Curve { knots: self.planes.knots.clone(), control } })
    }

    /// The surface in world coordinates when this one is in the coordinates of `frame`.
    ///
    /// # Errors
    /// The frame has no inverse.
    pub fn to_world(&self, frame: &Frame) -> Result<Self, DualError> {
        self.transformed(&Placement::of_frame(frame))
    }

    /// The same surface with more knots.
    ///
    /// # Errors
    /// Values outside the domain or too often repeated.
    pub fn with_knots(&self, more: &[f64]) -> Result<Self, DualError> {
        Ok(Self { kind: self.kind, planes: self.planes.with_knots(more)? })
    }

    /// The same surface with planes of one degree more.
    ///
    /// # Errors
    /// The largest degree is reached.
    pub fn elevated(&self) -> Result<Self, DualError> {
        Ok(Self { kind: self.kind, planes: self.planes.elevated()? })
    }

    /// The part over `[a, b]`.
    ///
    /// # Errors
    /// `a < b` inside the domain is needed.
    pub fn restricted(&self, a: f64, b: f64) -> Result<Self, DualError> {
        Ok(Self { kind: self.kind, planes: self.planes.restricted(a, b)? })
    }

    /// As the dual form that the judge, the development and the files know.
    pub fn to_torse(&self) -> DualTorse {
        DualTorse { planes: self.planes.clone() }
    }

    /// Bézier pieces `(a, b, planes)` of the curve of planes.
    pub(crate) fn pieces(&self) -> Vec<(f64, f64, crate::spline::bezier::Bezier<4>)> {
        bezier_pieces(&self.planes).into_iter().map(|(a, b, c)| (a, b, crate::spline::bezier::Bezier::new(c))).collect()
    }
}

/// The plane that is the graph `z = u0 + u1 x + u2 y`.
fn of_graph([u0, u1, u2]: &[f64; 3]) -> Plane {
    [-u1, -u2, 1.0, *u0]
}

/// The graph of a plane with `n_z = 1`.
fn graph_of([x, y, _, h]: &Plane) -> [f64; 3] {
    [*h, -x, -y]
}

fn normal_of(plane: &Plane) -> Vec3 {
    Vec3::new(plane[0], plane[1], plane[2])
}

/// Coordinates of the plane through a point with a normal.
pub fn plane_through(point: &Vec3, normal: &Vec3) -> Plane {
    [normal.x, normal.y, normal.z, normal.dot(point)]
}

/// Coordinates `(u0, u1, u2)` of a plane as a graph over the xy-plane of `frame`. `index` is for the message.
///
/// # Errors
/// The plane is parallel to the z-axis of the frame, or not finite.
pub fn graph_in(frame: &Frame, plane: &Plane, index: usize) -> Result<[f64; 3], DualError> {
    // Steeper planes than this give coordinates that are rounding only.
    const STEEP: f64 = 1e-12;
    let n = normal_of(plane);
    let local = frame.vector_to_local(&n);
    let cosine = local.z / n.norm();
    if !(cosine.abs() > STEEP && plane[3].is_finite() && cosine.is_finite()) {
        return Err(DualError::Parallel { index, cosine });
    }
    let height = plane[3] - n.dot(&frame.origin);
    Ok([height / local.z, -local.x / local.z, -local.y / local.z])
}

#[cfg(test)]
mod tests;
