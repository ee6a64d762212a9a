//! How much of the faces the panels cover, for reports. The proof that nothing is missing belongs to `certify`.

use crate::num::hash::HashSet;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::partition::Partition;
use crate::spline::surface::Surface;

/// Areas of a face (mm², by flat triangles): covered by panels, and whole.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coverage {
    /// Area of the triangles that belong to a panel.
    pub covered: f64,
    /// Area of all triangles.
    pub whole: f64,
    /// Whether every triangle belongs to a panel.
    pub complete: bool,
}

impl Coverage {
    /// The covered share, 1 exactly if and only if the cover is complete.
    pub fn share(&self) -> f64 {
        if self.complete {
            return 1.0;
        }
        let share = self.covered / self.whole;
        if share.is_finite() {
            share.clamp(0.0, 1.0 - f64::EPSILON)
        } else {
            0.0
        }
    }
}

impl Coverage {
    /// The same cover of more: of faces too that were left out, with their areas (mm²) as far as they are known.
    pub fn beside(mut self, left_out: &[Option<f64>]) -> Self {
        self.whole += left_out.iter().flatten().sum::<f64>();
        self.complete &= left_out.is_empty();
        self
    }
}

/// Coverage of each face.
pub fn faces(patchwork: &Patchwork) -> Vec<Coverage> {
    let trims = || patchwork.panels.iter().filter_map(|p| p.trim.as_ref());
    let label_sets = |face: usize| trims().filter(|t| t.face == face).map(|t| t.label).collect();
    let face = |(i, face): (usize, &crate::brep::face::Face)| {
        patchwork.partitions.get(i).map_or_else(Coverage::default, |p| of_face(&face.surface, p, &label_sets(i)))
    };
    patchwork.faces.iter().enumerate().map(face).collect()
}

/// Coverage of all faces together.
pub fn total(faces: &[Coverage]) -> Coverage {
    let sum = |value: fn(&Coverage) -> f64| faces.iter().map(value).sum();
    let complete = !faces.is_empty() && faces.iter().all(|c| c.complete);
    Coverage { covered: sum(|c| c.covered), whole: sum(|c| c.whole), complete }
}

fn of_face(surface: &Surface, partition: &Partition, labels: &HashSet<u32>) -> Coverage {
    let points: Vec<_> = partition.vertices.iter().map(|v| surface.point(v[0], v[1])).collect();
    let mut coverage = Coverage { covered: 0.0, whole: 0.0, complete: !partition.triangles.is_empty() };
    for (t, label) in partition.triangles.iter().zip(&partition.labels) {
        let [a, b, c] = t.map(|k| points[k as usize]);
        let area = 0.5 * (b - a).cross(&(c - a)).norm();
        coverage.whole += area;
        if labels.contains(label) {
            coverage.covered += area;
        } else {
            coverage.complete = false;
        }
    }
    coverage
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;
    use crate::patchwork::partition::UNASSIGNED;
    use crate::spline::knots::Knots;

    #[test]
    fn a_quarter_left_out_is_a_quarter_missing() {
        let knots = || Knots::clamped(1, &[0.0, 1.0]).expect("knots");
        let corners = [[0.0, 0.0], [0.0, 2.0], [4.0, 0.0], [4.0, 2.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
        let plate = Surface::new(knots(), knots(), &corners, None).expect("a plate");
        let mut partition = Partition {
            vertices: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5]],
            triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
            labels: vec![7, 7, 7, UNASSIGNED],
            ..Partition::default()
        };
        let labels = HashSet::from_iter([7]);
        let part = of_face(&plate, &partition, &labels);
        assert!((part.whole - 8.0).abs() < 1e-12 && (part.share() - 0.75).abs() < 1e-12);
        partition.labels[3] = 7;
        assert!(of_face(&plate, &partition, &labels).complete);
        assert!(!total(&[part, of_face(&plate, &partition, &labels)]).complete);
        assert!(total(&[]).share() < 1.0);
        // What was left out counts, and a face of unknown area keeps the share below 1.
        let all = of_face(&plate, &partition, &labels);
        assert!((all.beside(&[Some(24.0)]).share() - 0.25).abs() < 1e-12);
        assert!(all.beside(&[None]).share() < 1.0 && all.beside(&[]).complete);
    }
}
