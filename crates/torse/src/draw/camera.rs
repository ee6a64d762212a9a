//! Where to look from: a perspective camera with z upwards, and the choice of a telling direction.

use crate::geom::mesh::Mesh;
use crate::geom::{BBox, Vec3};

/// Distance of the eye from the centre in units of the model's half diagonal: a mild perspective, about 23°.
const EYE_DISTANCE: f64 = 5.0;

/// A rectangle of the picture, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// Left edge.
    pub x: f64,
    /// Upper edge.
    pub y: f64,
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
}

/// A perspective camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Axes of the view: right, up, towards the eye.
    pub axes: [Vec3; 3],
    /// The point looked at, mm.
    pub centre: Vec3,
    /// Distance of the eye from `centre`, mm.
    pub distance: f64,
    /// Pixels per mm in the plane through `centre`.
    pub scale: f64,
    /// Pixel of `centre`.
    pub origin: [f64; 2],
}

impl Camera {
    /// The camera at `direction` (from the model to the eye, any length) that shows all `points` as large as fits
    /// into `rect`.
    pub fn fitting<'a>(points: impl Iterator<Item = &'a Vec3> + Clone, direction: &Vec3, rect: Rect) -> Self {
        let bbox = BBox::of(points.clone());
        let radius = (0.5 * bbox.diagonal()).max(f64::MIN_POSITIVE);
        let centre =
            if bbox.diagonal() > 0.0 { bbox.center() } else { points.clone().next().copied().unwrap_or_default() };
        let distance = EYE_DISTANCE * radius;
        let mut camera = Self { axes: axes(direction), centre, distance, scale: 1.0, origin: [0.0; 2] };
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for p in points {
            let q = camera.project(p);
            for k in 0..2 {
                low[k] = low[k].min(q[k]);
                high[k] = high[k].max(q[k]);
            }
        }
        let extent = [high[0] - low[0], high[1] - low[1]];
        camera.scale = (rect.width / extent[0]).min(rect.height / extent[1]);
        if !camera.scale.is_finite() {
            camera.scale = 1.0;
            (low, high) = ([0.0; 2], [0.0; 2]);
        }
        camera.origin = [
            rect.x + 0.5 * rect.width - 0.5 * camera.scale * (low[0] + high[0]),
            rect.y + 0.5 * rect.height - 0.5 * camera.scale * (low[1] + high[1]),
        ];
        camera
    }

    /// Pixel and depth (inverse distance in units of the eye's distance) of a point.
    pub fn project(&self, p: &Vec3) -> [f64; 3] {
        self.project_towards_eye(p, 0.0)
    }

    /// As `project`, with the depth of a point moved towards the eye by `lift` mm: lines drawn on a surface.
    pub fn project_towards_eye(&self, p: &Vec3, lift: f64) -> [f64; 3] {
        let q = p - self.centre;
        let near = self.distance - q.dot(&self.axes[2]);
        let f = self.scale * self.distance / near;
        let depth = self.distance / (near - lift);
        [self.origin[0] + f * q.dot(&self.axes[0]), self.origin[1] - f * q.dot(&self.axes[1]), depth]
    }

    /// A direction of space in view coordinates.
    pub fn to_view(&self, v: &Vec3) -> Vec3 {
        Vec3::new(self.axes[0].dot(v), self.axes[1].dot(v), self.axes[2].dot(v))
    }
}

/// Right, up and towards the eye for a direction of view, with z upwards in the picture.
fn axes(direction: &Vec3) -> [Vec3; 3] {
    // Closer to the vertical than this, the horizontal axis would be noise.
    const VERTICAL: f64 = 1e-6;
    let toward = direction.try_normalize(0.0).unwrap_or_else(Vec3::z);
    let right = Vec3::z().cross(&toward).try_normalize(VERTICAL).unwrap_or_else(Vec3::x);
    [right, toward.cross(&right), toward]
}

/// The direction (from the model to the eye) from which most of the meshes is seen, among some forty views from
/// slightly above. What hides behind other parts does not count; grazing views of large areas count less.
pub(crate) fn telling_direction<'a>(meshes: impl Iterator<Item = &'a Mesh> + Clone) -> Vec3 {
    // A view from between the axes looks better than one along them, and one from 30° better than others.
    const VIEWS: [(f64, f64); 4] = [(20.0, 0.94), (32.0, 1.0), (46.0, 0.95), (62.0, 0.80)];
    const AZIMUTH_STEP_DEG: usize = 15;
    // Front views (from −y, the convention of CAD) win ties.
    const FRONT: f64 = 0.02;
    const AXIS_PENALTY: f64 = 0.06;
    let mut best = (f64::NEG_INFINITY, Vec3::new(-0.5, -0.75, 0.5));
    for (elevation_deg, preference) in VIEWS {
        for azimuth_deg in (0..360).step_by(AZIMUTH_STEP_DEG) {
            let (e, a) = (elevation_deg.to_radians(), (azimuth_deg as f64).to_radians());
            let direction = Vec3::new(e.cos() * a.cos(), e.cos() * a.sin(), e.sin());
            let oblique = (2.0 * a).sin().abs();
            let taste = preference * (1.0 - AXIS_PENALTY * (1.0 - oblique)) * (1.0 - FRONT * a.sin());
            let score = taste * visible(meshes.clone(), &direction);
            if score > best.0 {
                best = (score, direction);
            }
        }
    }
    best.1
}

/// Area (mm²) of the meshes seen from a direction, weighted by the root of the cosine of the angle of view, and by
/// how well the view fills a picture of landscape format.
fn visible<'a>(meshes: impl Iterator<Item = &'a Mesh> + Clone, direction: &Vec3) -> f64 {
    const CELLS: usize = 56;
    // Beyond this many triangles only a part of them is looked at; the holes hardly change the order of views.
    const TRIANGLES: usize = 12_000;
    const GRAZING: f64 = 0.08;
    const LANDSCAPE: f64 = 1.6;
    let camera = axes(direction);
    let local = |p: &Vec3| Vec3::new(camera[0].dot(p), camera[1].dot(p), camera[2].dot(p));
    let finite = |p: &Vec3| p.iter().all(|x| x.is_finite());
    let points: Vec<Vec3> = meshes.clone().flat_map(|m| &m.positions).filter(|p| finite(p)).map(local).collect();
    let bbox = BBox::of(&points);
    let extent = bbox.max - bbox.min;
    let cell = extent.x.max(extent.y) / CELLS as f64;
    if !(cell > 0.0 && cell.is_finite()) {
        return 0.0;
    }
    let count: usize = meshes.clone().map(|m| m.triangles.len()).sum();
    let stride = count.div_ceil(TRIANGLES).max(1);
    let mut buffer = vec![(f64::NEG_INFINITY, 0.0f64); (CELLS + 1) * (CELLS + 1)];
    let corners = |mesh: &'a Mesh| {
        mesh.triangles.iter().filter_map(move |t| {
            let mut c = [Vec3::zeros(); 3];
            for k in 0..3 {
                c[k] = *mesh.positions.get(t[k] as usize)?;
            }
            Some(c)
        })
    };
    for t in meshes.flat_map(corners).step_by(stride) {
        let [a, b, c] = t.map(|p| (local(&p) - bbox.min) / cell);
        let n = (b - a).cross(&(c - a));
        let cosine = n.z.abs() / n.norm();
        if n.z == 0.0 || !cosine.is_finite() {
            continue;
        }
        let (low, high) = (a.inf(&b).inf(&c), a.sup(&b).sup(&c));
        for y in (low.y.floor() as usize)..=(high.y.floor() as usize).min(CELLS) {
            for x in (low.x.floor() as usize)..=(high.x.floor() as usize).min(CELLS) {
                let p = Vec3::new(x as f64 + 0.5, y as f64 + 0.5, 0.0);
                let side = |u: &Vec3, v: &Vec3| ((v.x - u.x) * (p.y - u.y) - (v.y - u.y) * (p.x - u.x)) * n.z.signum();
                let inside = side(&a, &b) >= 0.0 && side(&b, &c) >= 0.0 && side(&c, &a) >= 0.0;
                let z = a.z - (n.x * (p.x - a.x) + n.y * (p.y - a.y)) / n.z;
                let slot = &mut buffer[y * (CELLS + 1) + x];
                if inside && z > slot.0 {
                    *slot = (z, cosine.max(GRAZING).powf(-0.5));
                }
            }
        }
    }
    let seen = buffer.iter().map(|&(_, w)| w).sum::<f64>() * cell * cell;
    let paper = LANDSCAPE * (extent.x / LANDSCAPE).max(extent.y).powi(2);
    seen * (seen / paper).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plate(x: Vec3, y: Vec3) -> Mesh {
        let n = 12;
        let mut mesh = Mesh::default();
        for i in 0..=n {
            for j in 0..=n {
                mesh.positions.push(x * (i as f64 / n as f64) + y * (j as f64 / n as f64));
            }
        }
        for i in 0..n {
            for j in 0..n {
                let k = (i * (n + 1) + j) as u32;
                let row = n as u32 + 1;
                mesh.triangles.extend([[k, k + row, k + 1], [k + 1, k + row, k + row + 1]]);
            }
        }
        mesh
    }

    #[test]
    fn all_points_fall_inside_the_rectangle_and_touch_it() {
        let points: Vec<Vec3> =
            (0..50).map(|i| Vec3::new((i * 7 % 11) as f64, (i * 5 % 13) as f64, (i % 6) as f64)).collect();
        let rect = Rect { x: 30.0, y: 20.0, width: 400.0, height: 300.0 };
        let camera = Camera::fitting(points.iter(), &Vec3::new(1.0, -2.0, 1.0), rect);
        let seen: Vec<[f64; 3]> = points.iter().map(|p| camera.project(p)).collect();
        let extent = |k: usize| {
            let low = seen.iter().map(|q| q[k]).fold(f64::INFINITY, f64::min);
            let high = seen.iter().map(|q| q[k]).fold(f64::NEG_INFINITY, f64::max);
            (low, high)
        };
        let ((x0, x1), (y0, y1)) = (extent(0), extent(1));
        assert!(x0 > 29.999 && x1 < 430.001 && y0 > 19.999 && y1 < 320.001);
        assert!((x1 - x0 - 400.0).abs() < 1e-6 || (y1 - y0 - 300.0).abs() < 1e-6);
    }

    #[test]
    fn a_standing_plate_is_seen_from_one_of_its_sides_and_a_lying_one_from_above() {
        let wall = plate(Vec3::new(10.0, 0.0, 0.0), Vec3::new(0.0, 0.0, 6.0));
        assert!(telling_direction(std::iter::once(&wall)).y.abs() > 0.6);
        let floor = plate(Vec3::new(10.0, 0.0, 0.0), Vec3::new(0.0, 6.0, 0.0));
        assert!(telling_direction(std::iter::once(&floor)).z > 0.6);
    }

    #[test]
    fn empty_and_single_point_models_are_no_trouble() {
        let rect = Rect { x: 0.0, y: 0.0, width: 10.0, height: 10.0 };
        let one = [Vec3::new(5.0, 5.0, 5.0)];
        let q = Camera::fitting(one.iter(), &Vec3::z(), rect).project(&one[0]);
        assert!((q[0] - 5.0).abs() < 1e-9 && (q[1] - 5.0).abs() < 1e-9);
        assert!(telling_direction(std::iter::empty()).norm() > 0.5);
    }
}
