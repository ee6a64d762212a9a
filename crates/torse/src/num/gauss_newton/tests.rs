//! Closed forms and small systems with known answers.

use super::*;
use crate::control::Control;

/// A row `c·x + d` and a row `|x|² − r²`, in three unknowns.
struct Sphere {
    unknowns: [u32; 3],
    radius: f64,
    plane: [f64; 4],
}

impl Block for Sphere {
    fn unknowns(&self) -> &[u32] {
        &self.unknowns
    }
    fn rows(&self) -> usize {
        2
    }
    fn evaluate(&self, x: &[f64], _: &[f64], residual: &mut [f64], jacobian: Option<&mut [f64]>) {
        let p = &self.plane;
        residual[0] = p[0] * x[0] + p[1] * x[1] + p[2] * x[2] + p[3];
        residual[1] = x[0] * x[0] + x[1] * x[1] + x[2] * x[2] - self.radius * self.radius;
        if let Some(j) = jacobian {
            j.copy_from_slice(&[p[0], p[1], p[2], 2.0 * x[0], 2.0 * x[1], 2.0 * x[2]]);
        }
    }
}

/// The row `x − value`.
struct Pull(u32, f64);

impl Block for Pull {
    fn unknowns(&self) -> &[u32] {
        std::slice::from_ref(&self.0)
    }
    fn rows(&self) -> usize {
        1
    }
    fn evaluate(&self, x: &[f64], _: &[f64], residual: &mut [f64], jacobian: Option<&mut [f64]>) {
        residual[0] = x[0] - self.1;
        if let Some(j) = jacobian {
            j[0] = 1.0;
        }
    }
}

/// `x = w²` with a private w: keeps x from becoming negative.
struct Positive(u32);

impl Block for Positive {
    fn unknowns(&self) -> &[u32] {
        std::slice::from_ref(&self.0)
    }
    fn rows(&self) -> usize {
        1
    }
    fn private(&self) -> usize {
        1
    }
    fn begin(&self, x: &[f64], own: &mut [f64]) {
        own[0] = x[0].max(0.01).sqrt();
    }
    fn evaluate(&self, x: &[f64], own: &[f64], residual: &mut [f64], jacobian: Option<&mut [f64]>) {
        residual[0] = x[0] - own[0] * own[0];
        if let Some(j) = jacobian {
            j.copy_from_slice(&[1.0, -2.0 * own[0]]);
        }
    }
}

fn sphere(offset: f64) -> System {
    let mut s = System::new(3);
    let class = s.class("circle");
    s.add(Sphere { unknowns: [0, 1, 2], radius: 1.0, plane: [0.0, 0.0, 1.0, -offset] }, Role::Hard, class);
    s
}

#[test]
fn a_point_is_pulled_along_a_circle() {
    let mut s = sphere(0.6);
    let pull = s.class("pull");
    s.add(Pull(0, 5.0), Role::Soft { weight: 0.3, fades: true }, pull);
    let mut solver = Solver::new(s, vec![0.1, 0.7, 0.5]).expect("a system");
    let done = solver.solve(&Schedule::gentle(1e-6), &Control::default());
    assert_eq!(done.status, Status::Converged, "{done:?} {:?}", solver.values());
    let x = solver.values();
    // The circle of radius 0.8 at height 0.6; the pull is along x.
    assert!((x[0] - 0.8).abs() < 1e-3 && x[1].abs() < 0.05 && (x[2] - 0.6).abs() < 1e-6, "{x:?}");
}

#[test]
fn a_plane_beside_the_sphere_stalls_and_says_so() {
    let mut s = sphere(1.5);
    let other = s.class("other");
    s.add(Pull(1, 0.0), Role::Hard, other);
    let mut solver = Solver::new(s, vec![0.3, 0.2, 0.5]).expect("a system");
    let done = solver.solve(&Schedule::cold(1e-9), &Control::default());
    assert_eq!(done.status, Status::Stalled);
    let worst = done.worst.expect("rows");
    assert_eq!(solver.class_name(worst.class), "circle");
    assert!(worst.max > 0.1);
}

#[test]
fn frozen_unknowns_are_given_numbers() {
    let mut s = sphere(0.0);
    s.freeze(0);
    assert_eq!((s.free(), s.conditions().sum::<usize>()), (2, 2));
    let mut solver = Solver::new(s, vec![0.28, 0.5, 0.1]).expect("a system");
    assert_eq!(solver.solve(&Schedule::cold(1e-10), &Control::default()).status, Status::Converged);
    assert!((solver.values()[1] - 0.96).abs() < 1e-9 && solver.values()[0] == 0.28);
    solver.set(0, 0.6);
    assert_eq!(solver.solve(&Schedule::warm(1e-10), &Control::default()).status, Status::Converged);
    assert!((solver.values()[1] - 0.8).abs() < 1e-9);
}

#[test]
fn private_unknowns_bound_shared_ones() {
    let mut s = System::new(1);
    let class = s.class("positive");
    s.add(Positive(0), Role::Hard, class);
    s.add(Pull(0, -1.0), Role::Soft { weight: 0.1, fades: false }, class);
    let mut solver = Solver::new(s, vec![0.5]).expect("a system");
    solver.solve(&Schedule { iterations: 200, ..Schedule::cold(1e-12) }, &Control::default());
    // The pull wins a little of the hard row: x = −0.01/1.01.
    assert!((solver.values()[0] + 0.01 / 1.01).abs() < 1e-3, "{:?}", solver.values());
}

#[test]
fn polish_takes_the_shortest_step() {
    let mut solver = Solver::new(sphere(0.6), vec![0.79, 0.02, 0.61]).expect("a system");
    let done = solver.polish(1e-15, 8, &Control::default());
    assert!(done.status == Status::Converged && done.residual <= 1e-15 && done.iterations <= 5, "{done:?}");
    // From a point beside the circle, the shortest step is along the radius: the angle in the plane stays.
    let x = solver.values();
    assert!((x[1] / x[0] - 0.02 / 0.79).abs() < 1e-6, "{x:?}");
}

#[test]
fn cancelled_and_wrong_systems_say_so() {
    let control = Control::default();
    control.cancel();
    let mut solver = Solver::new(sphere(0.6), vec![0.1, 0.7, 0.5]).expect("a system");
    assert_eq!(solver.solve(&Schedule::cold(1e-6), &control).status, Status::Cancelled);
    assert!(Solver::new(sphere(0.6), vec![0.1, f64::NAN, 0.5]).is_err());
    let mut s = System::new(2);
    let class = s.class("x");
    s.add(Pull(2, 0.0), Role::Hard, class);
    assert_eq!(
        Solver::new(s, vec![0.0; 2]).err(),
        Some(super::system::SystemError::Unknown { block: 0, unknown: 2, count: 2 })
    );
}
