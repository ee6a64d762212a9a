//! Prongs: narrow parts that reach far beyond the rest of a region. They bend where they should not when a panel is handled,
//! and are given to a neighbour where that can be proven.

use super::covered_face::Cover;
use super::job::Job;
use super::region::Region;
use crate::geom::segment::share;
use crate::geom::Vec3;
use std::sync::Arc;

/// How far, in widths, a narrow part reaches beyond the rest to be a prong: ends of wedges of more than about 10° are none.
const LONG: f64 = 6.0;

/// A narrow part of a region, by places in space.
pub(super) struct Prong {
    /// The nearest place that is not narrow.
    root: Vec3,
    /// The farthest place.
    tip: Vec3,
}

impl Prong {
    /// The longest part of a region that is narrower than `width` (mm), as fine as its triangles; `None` if none is long, or all
    /// of the region is narrow.
    pub(super) fn of(region: Region, width: f64) -> Option<Self> {
        let cover = region.cover;
        let border: Vec<[Vec3; 2]> = region.border().into_iter().map(|(a, b)| [a, b].map(|v| cover.point(v))).collect();
        let middles: Vec<Vec3> = region.cells().into_iter().map(|t| cover.middle(t)).collect();
        let is_inside = |x: &Vec3| border.iter().all(|s| squared_distance(x, s) >= 0.25 * width * width);
        let (core, narrow): (Vec<Vec3>, Vec<Vec3>) = middles.iter().partition(|x| is_inside(x));
        let from_core = |tip: &Vec3| {
            let apart = core.iter().map(|root| ((root - tip).norm_squared(), *root, *tip));
            apart.min_by(|a, b| a.0.total_cmp(&b.0))
        };
        let (far, root, tip) = narrow.iter().filter_map(from_core).max_by(|a, b| a.0.total_cmp(&b.0))?;
        (far > (LONG * width).powi(2)).then_some(Self { root, tip })
    }

    /// Cuts it off beside its root; its label. `None` if that separates nothing.
    fn cut_off(&self, cover: &mut Cover, label: u32, width: f64) -> Option<u32> {
        let axis = (self.tip - self.root).normalize();
        let face = Arc::clone(&cover.face);
        let height = |p: [f64; 2]| axis.dot(&(face.surface.point(p[0], p[1]) - self.root)) - 0.5 * width;
        let parts = cover.parted(label, height)?;
        let far = |t: usize| (cover.middle(t) - self.tip).norm();
        let all = 0..cover.partition.triangles.len();
        let there =
            all.filter(|t| parts.contains(&cover.partition.labels[*t])).min_by(|a, b| far(*a).total_cmp(&far(*b)))?;
        let prong = cover.partition.labels[there];
        // What else lies beyond the cut stays where it was.
        let fresh = cover.partition.fresh_label();
        let renamed = |l: u32| match l {
            l if l == prong => fresh,
            l if parts.contains(&l) => label,
            l => l,
        };
        cover.partition.labels.iter_mut().for_each(|l| *l = renamed(*l));
        (!cover.region(label).cells().is_empty()).then_some(fresh)
    }
}

/// Squared distance of a point from a segment.
fn squared_distance(x: &Vec3, [a, b]: &[Vec3; 2]) -> f64 {
    (x - a - (b - a) * share(a, b, x)).norm_squared()
}

impl Region<'_> {
    /// Whether a part that is narrower than `width` (mm) reaches far beyond the rest.
    pub(crate) fn has_prong(self, width: f64) -> bool {
        Prong::of(self, width).is_some()
    }
}

impl Job<'_> {
    /// The longest prong of a panel given to a neighbour whose torse is good for it. `None` if there is no prong, or none can
    /// have it.
    pub(crate) fn without_prong(&self, region: Region, width: f64) -> Option<Cover> {
        let prong = Prong::of(region, width)?;
        let mut cut = region.cover.clone();
        let part = prong.cut_off(&mut cut, region.label, width)?;
        self.absorbed(cut.region(part), Some(region.label))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::face::Face;
    use crate::spline::knots::Knots;

    /// A square of 1 m in cells of 20 mm, a region of which reaches with `height` (mm) along one side below another region.
    fn cover(height: f64) -> Cover {
        let line = Knots::clamped(1, &[0.0, 1.0]).expect("knots");
        let corner = |x: f64, y: f64| Vec3::new(1000.0 * x, 1000.0 * y, 0.0);
        let corners = [corner(0.0, 0.0), corner(0.0, 1.0), corner(1.0, 0.0), corner(1.0, 1.0)];
        let surface = crate::spline::surface::Surface::new(line.clone(), line, &corners, None).expect("a surface");
        let lines: Vec<f64> = (0..=50).map(|k| f64::from(k) / 50.0).collect();
        let face = Face::untrimmed(surface);
        let mut cover = Cover::on_lines(&face, lines.clone(), lines).expect("a cover");
        cover.cut(0, 1, |p| p[0] - 0.4);
        cover.cut(1, 2, |p| 0.001 * height - p[1]);
        cover.partition.labels.iter_mut().filter(|l| **l == 2).for_each(|l| *l = 0);
        cover
    }

    #[test]
    fn a_finger_is_cut_off_where_it_leaves_the_panel() {
        let mut cover = cover(40.0);
        let prong = Prong::of(cover.region(0), 60.0).expect("a prong");
        assert!((prong.tip.x - 1000.0).abs() < 20.0 && prong.tip.y < 40.0 && prong.root.x < 400.0, "{}", prong.tip);
        let part = prong.cut_off(&mut cover, 0, 60.0).expect("a part");
        let (own, rest) = (cover.region(part).area(), cover.region(0).area());
        assert!((own - 600.0 * 40.0).abs() < 0.1 * own, "{own}");
        assert!((own + rest - 400.0 * 1000.0 - 600.0 * 40.0).abs() < 1e-6);
        // What is left, and regions without narrow parts, have none.
        assert!(!cover.region(0).has_prong(60.0) && !cover.region(1).has_prong(60.0));
    }

    #[test]
    fn broad_parts_and_whole_slivers_are_no_prongs() {
        assert!(!cover(120.0).region(0).has_prong(60.0));
        let mut sliver = cover(40.0);
        sliver.cut(0, 3, |p| p[0] - 0.4);
        assert!(!sliver.region(3).has_prong(60.0));
    }
}
