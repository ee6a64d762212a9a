//! Strip potentials whose bands follow what a user asks for, and rings (B2, B3): see `layout`.

use super::covered_face::Cover;
use super::job::Job;
use super::layout::DirectionField;
use super::region::Region;
use crate::fit::strip_potential::{directed_strip_potentials, StripPotential, StripPotentialOptions};
use crate::geom::Vec3;
use crate::spline::surface::Surface;

/// Directions that are nearly square to the surface say nothing about strips: below this sine they are left out.
const STEEP: f64 = 0.1;

/// Parameter direction of the part of `d` that is tangent to the surface; zero where that says nothing.
fn pulled_back(surface: &Surface, uv: [f64; 2], directions: &DirectionField) -> [f64; 2] {
    let jet = surface.jet(uv[0], uv[1]);
    let normal = jet.normal();
    let area = normal.norm_squared();
    let Some(d) = directions.at(&jet.p, &(normal / area.sqrt())) else { return [0.0; 2] };
    let (a, b) = (d.dot(&jet.du), d.dot(&jet.dv));
    let (e, f, g) = (jet.du.norm_squared(), jet.du.dot(&jet.dv), jet.dv.norm_squared());
    let along = [(g * a - f * b) / area, (e * b - f * a) / area];
    let tangent = jet.du * along[0] + jet.dv * along[1];
    if tangent.norm() > STEEP * d.norm() && along.iter().all(|x| x.is_finite()) {
        along
    } else {
        [0.0; 2]
    }
}

impl Job<'_> {
    /// Cuts a region through the point that rings run around; the point, and all parts. `None` where one panel is enough.
    pub(super) fn rings(&self, cover: &mut Cover, label: u32) -> Option<(Vec3, Vec<u32>)> {
        if self.single(cover.region(label), None).accepted.is_some() {
            return None;
        }
        let centre = cover.region(label).middle()?;
        let (_, axes) = cover.region(label).axes();
        let surface = &self.face.surface;
        Some((centre, cover.parts(label, |p| axes[0].dot(&(surface.point(p[0], p[1]) - centre)))))
    }

    /// Strip potentials whose bands follow a direction field, from so many samples, with so many spans.
    pub(super) fn directed_strip_potentials(
        &self,
        directions: &DirectionField,
        region: Region,
        (samples, spans): (usize, usize),
    ) -> Vec<StripPotential> {
        let forms = region.forms(samples);
        let along: Vec<[f64; 2]> = forms.iter().map(|f| pulled_back(&self.face.surface, f.uv, directions)).collect();
        let options =
            StripPotentialOptions { spans, control: self.control.clone(), ..StripPotentialOptions::default() };
        directed_strip_potentials(&forms, &along, &region.places(), &options)
    }
}

/// Vertices that are compared with the border for [`Region::middle`].
const TRIED: usize = 400;

impl Region<'_> {
    /// The vertex that is farthest from the border.
    fn middle(&self) -> Option<Vec3> {
        let border: Vec<Vec3> = self.border().into_iter().map(|(a, _)| self.cover.point(a)).collect();
        let points = self.points();
        let step = points.len().div_ceil(TRIED).max(1);
        let distance = |x: &Vec3| border.iter().map(|b| (b - x).norm_squared()).fold(f64::INFINITY, f64::min);
        points
            .into_iter()
            .step_by(step)
            .map(|x: Vec3| (distance(&x), x))
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .map(|m| m.1)
    }
}
