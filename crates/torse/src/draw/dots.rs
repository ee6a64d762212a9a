//! Measured points in a finished picture: one dot each, coloured by its value, the nearest to the eye on top.

use super::camera::Camera;
use super::colour;
use super::raster::Image;
use crate::geom::Vec3;

/// Radii of dots, px: half the mean distance of points spread over the picture, within these.
const SMALLEST: f64 = 1.2;
const LARGEST: f64 = 4.0;
/// By how much dots beyond the limit are larger, so that single outliers can be seen.
const BEYOND: f64 = 2.0;

/// Puts dots on an image. Values are shares of the limit; beyond ±1, and where they are no numbers, dots are larger and
/// lie above all others. Points outside the image are left out. The count of the points drawn is returned.
pub fn dots(image: &mut Image, camera: &Camera, points: &[Vec3], shares: &[f64]) -> usize {
    let (width, height) = (image.width, image.height);
    let normal = (0.5 * ((width * height) as f64 / points.len().max(1) as f64).sqrt()).clamp(SMALLEST, LARGEST);
    let mut depths = vec![f64::NEG_INFINITY; width * height];
    let mut drawn = 0;
    let mut dot = |p: &Vec3, share: f64, beyond: bool| {
        let [x, y, depth] = camera.project(p);
        let inside = x >= 0.0 && y >= 0.0 && x < width as f64 && y < height as f64;
        if !inside || !depth.is_finite() {
            return 0;
        }
        let (radius, depth) = if beyond { (normal + BEYOND, f64::INFINITY) } else { (normal, depth) };
        let colour = colour::bytes(colour::deviation(share));
        let range = |c: f64, n: usize| ((c - radius).max(0.0) as usize)..=((c + radius) as usize).min(n - 1);
        for j in range(y, height) {
            for i in range(x, width) {
                let (dx, dy) = (i as f64 + 0.5 - x, j as f64 + 0.5 - y);
                let k = j * width + i;
                if dx * dx + dy * dy <= radius * radius && depth >= depths[k] {
                    depths[k] = depth;
                    image.pixels[k] = colour;
                }
            }
        }
        1
    };
    let is_beyond = |share: f64| share.is_nan() || share.abs() > 1.0;
    for beyond in [false, true] {
        for (p, &s) in points.iter().zip(shares).filter(|(_, s)| is_beyond(**s) == beyond) {
            drawn += dot(p, s, beyond);
        }
    }
    drawn
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::camera::Rect;

    #[test]
    fn the_nearest_dot_hides_others_and_outliers_hide_all() {
        let mut image = Image { width: 40, height: 40, pixels: vec![[255; 3]; 1600] };
        let points = [Vec3::zeros(), Vec3::new(0.0, 0.0, 1.0), Vec3::new(9.0, 9.0, 0.0), Vec3::new(900.0, 0.0, 0.0)];
        let frame = [Vec3::new(-10.0, -10.0, 0.0), Vec3::new(10.0, 10.0, 0.0)];
        let rect = Rect { x: 0.0, y: 0.0, width: 40.0, height: 40.0 };
        let camera = Camera::fitting(frame.iter(), &Vec3::z(), rect);
        assert_eq!(dots(&mut image, &camera, &points, &[1.0, -1.0, f64::NAN, 0.0]), 3);
        let at = |p: &Vec3, image: &Image| {
            let [x, y, _] = camera.project(p);
            image.pixels[y as usize * 40 + x as usize]
        };
        assert_eq!(at(&points[0], &image), colour::bytes(colour::deviation(-1.0)));
        assert_eq!(at(&points[2], &image), colour::bytes(colour::deviation(f64::NAN)));
        dots(&mut image, &camera, &points[..1], &[7.0]);
        assert_eq!(at(&points[0], &image), colour::bytes(colour::deviation(7.0)));
    }
}
