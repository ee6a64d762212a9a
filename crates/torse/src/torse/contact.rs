//! Tangent planes of a developable as somebody gives them: in order along the surface, each with its region of interest
//! (\[PW99, 4.1–4.3\]).

use crate::geom::Vec3;

/// One given tangent plane, with the ruling in it if that is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactElement {
    /// Unit normal; neighbours are oriented alike.
    pub normal: Vec3,
    /// Ends of the ruling, mm; for a plane without ruling both are the centre of its region of interest.
    pub ends: [Vec3; 2],
    /// Radius of the region of interest around the ruling or centre, mm.
    pub radius: f64,
    /// Weight in fits; 1 for elements that are as good as any other. Proofs do not know it.
    pub weight: f64,
}

impl ContactElement {
    /// Whether the ruling is known.
    pub fn has_ruling(&self) -> bool {
        self.ends[0] != self.ends[1]
    }

    /// Middle of the ruling, or centre of the region, mm.
    pub fn centre(&self) -> Vec3 {
        0.5 * (self.ends[0] + self.ends[1])
    }

    /// Whether all numbers are finite, the normal has a direction, the region an extent and the weight is positive.
    pub fn is_usable(&self) -> bool {
        let finite = self.normal.iter().chain(&self.ends[0]).chain(&self.ends[1]).all(|x| x.is_finite());
        let positive = |x: f64| x > 0.0 && x.is_finite();
        finite && self.normal.norm() > 0.0 && positive(self.radius) && positive(self.weight)
    }
}

/// Turns normals so that neighbours are oriented alike.
pub(crate) fn orient(row: &mut [ContactElement]) {
    for i in 1..row.len() {
        if row[i].normal.dot(&row[i - 1].normal) < 0.0 {
            row[i].normal = -row[i].normal;
        }
    }
}

/// What a file gives of a developable besides points.
#[derive(Clone, Debug, PartialEq)]
pub enum Given {
    /// Rulings in order along the surface, by their ends, mm; tangent planes are not known.
    Rulings(Vec<[Vec3; 2]>),
    /// Tangent planes in order along the surface, with or without rulings.
    Planes(Vec<ContactElement>),
}

impl Given {
    /// Number of elements.
    pub fn len(&self) -> usize {
        match self {
            Self::Rulings(r) => r.len(),
            Self::Planes(p) => p.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
