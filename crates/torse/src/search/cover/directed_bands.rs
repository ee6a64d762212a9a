//! Strip potentials whose bands follow what a user asks for, and rings (B2, B3): see `layout`.

use super::job::Job;
use super::layout::DirectionField;
use super::state::State;
use crate::fit::strip_potential::{directed_strip_potentials, StripPotential, StripPotentialOptions};
use crate::geom::Vec3;
use crate::patchwork::partition::edges;
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
    pub(super) fn rings(&self, state: &mut State, label: u32) -> Option<(Vec3, Vec<u32>)> {
        if self.single(state, label, None).accepted.is_some() {
            return None;
        }
        let centre = state.middle(label)?;
        let (_, axes) = state.axes_of_region(label);
        let surface = &self.face.surface;
        let fresh = state.partition.fresh_label();
        state.cut(label, fresh, |p| axes[0].dot(&(surface.point(p[0], p[1]) - centre)));
        let mut parts = state.partition.split_components(label);
        parts.extend(state.partition.split_components(fresh));
        parts.retain(|p| state.partition.labels.contains(p));
        Some((centre, parts))
    }

    /// Strip potentials whose bands follow a direction field, from so many samples, with so many spans.
    pub(super) fn directed_strip_potentials(
        &self,
        directions: &DirectionField,
        state: &State,
        label: u32,
        (samples, spans): (usize, usize),
    ) -> Vec<StripPotential> {
        let forms = state.forms(label, samples);
        let along: Vec<[f64; 2]> = forms.iter().map(|f| pulled_back(&self.face.surface, f.uv, directions)).collect();
        let options =
            StripPotentialOptions { spans, control: self.control.clone(), ..StripPotentialOptions::default() };
        directed_strip_potentials(&forms, &along, &state.places(label), &options)
    }
}

/// Vertices that are compared with the border for [`State::middle`].
const TRIED: usize = 400;

impl State {
    /// The vertex that is farthest from the region's border.
    fn middle(&self, label: u32) -> Option<Vec3> {
        let around = self.partition.adjacency();
        let border: Vec<Vec3> = self
            .partition
            .region(label)
            .into_iter()
            .flat_map(|t| edges(self.partition.triangles[t]))
            .filter(|&(a, b)| around.get(&(b, a)).is_none_or(|&t| self.partition.labels[t as usize] != label))
            .map(|(a, _)| self.jets[a as usize].jet.p)
            .collect();
        let vertices = self.partition.region_vertices(label);
        let step = vertices.len().div_ceil(TRIED).max(1);
        let distance = |x: &Vec3| border.iter().map(|b| (b - x).norm_squared()).fold(f64::INFINITY, f64::min);
        vertices
            .into_iter()
            .step_by(step)
            .map(|v| self.jets[v as usize].jet.p)
            .map(|x: Vec3| (distance(&x), x))
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .map(|m| m.1)
    }
}
