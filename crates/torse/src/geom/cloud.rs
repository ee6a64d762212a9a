//! Measured points.

use super::Vec3;
use std::borrow::Cow;

/// Points as measured, in no order, perhaps joined to a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cloud {
    /// Positions, mm.
    pub points: Vec<Vec3>,
    /// Corners of the flat triangles between them, if the file has any.
    pub triangles: Vec<[u32; 3]>,
}

impl Cloud {
    /// The mesh without points that no triangle uses, and how many points these are; without triangles all points count.
    ///
    /// Programs that cut holes into meshes leave the corners of what they delete in their files: nothing was measured there.
    /// Where most points are in no triangle, what is given are the points, and they stay.
    pub fn used(&self) -> (Cow<'_, Self>, usize) {
        let mut used = vec![self.triangles.is_empty(); self.points.len()];
        for &k in self.triangles.iter().flatten() {
            if let Some(u) = used.get_mut(k as usize) {
                *u = true;
            }
        }
        let unused = used.iter().filter(|u| !**u).count();
        if unused == 0 || 2 * unused > self.points.len() {
            return (Cow::Borrowed(self), unused);
        }
        let mut number = 0;
        let numbers: Vec<u32> = used
            .iter()
            .map(|u| {
                number += u32::from(*u);
                number.saturating_sub(1)
            })
            .collect();
        // A corner that is not there stays one that is not there.
        let renamed = |k: u32| numbers.get(k as usize).copied().unwrap_or(k);
        let points = self.points.iter().zip(&used).filter(|p| *p.1).map(|p| *p.0).collect();
        let triangles = self.triangles.iter().map(|t| t.map(renamed)).collect();
        (Cow::Owned(Self { points, triangles }), unused)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_no_triangle_are_left_out_of_meshes_only() {
        let points: Vec<Vec3> = (0..6).map(|k| Vec3::new(f64::from(k), 0.0, 0.0)).collect();
        let scan = Cloud { points, ..Cloud::default() };
        assert_eq!(scan.used().1, 0);
        let mesh = Cloud { triangles: vec![[1, 2, 5], [5, 2, 4]], ..scan };
        let (used, unused) = mesh.used();
        assert_eq!((used.points.len(), unused), (4, 2));
        assert_eq!(used.triangles, [[0, 1, 3], [3, 1, 2]]);
        assert_eq!(used.points[3], mesh.points[5]);
        // Points with a triangle or two among them are points.
        let scan = Cloud { triangles: vec![[1, 2, 1]], ..mesh };
        assert_eq!((scan.used().0.points.len(), scan.used().1), (6, 4));
    }
}
