//! Where the unknowns of a network stand in its program.

use super::line::{End, Line, SLIDES};

/// Largest changes in one step: of strips, tolerances; of slides and vertices, in their unit.
const LIMITS: (f64, f64) = (3.0, 2.0);

/// Columns of all unknowns of a face: a group holds a strip, the slides of lines on whose left it is, and vertices at these.
pub(super) struct Columns {
    pub strips: Vec<usize>,
    pub slides: Vec<usize>,
    pub vertices: Vec<usize>,
    /// Sizes of groups.
    pub groups: Vec<usize>,
    pub limits: Vec<f64>,
}

impl Columns {
    /// Limits of slides and vertices, a multiple of those that they start with.
    pub fn slide_limits(&self, reach: f64, limits: &mut [f64]) {
        self.slides.iter().for_each(|&c| limits[c..c + SLIDES].fill(reach * LIMITS.1));
        // Where all lines at a vertex stay it has no columns.
        let vertices = self.vertices.iter().filter(|c| **c != usize::MAX);
        vertices.for_each(|&c| limits[c..c + 2].fill(reach * LIMITS.1));
    }

    /// Columns for strips with so many unknowns each, lines between them, and so many vertices, from `first` on.
    pub fn of(unknowns: &[usize], lines: &[Line], vertices: usize, first: usize) -> Self {
        let mut out = Self {
            strips: Vec::new(),
            slides: vec![0; lines.len()],
            vertices: vec![usize::MAX; vertices],
            groups: Vec::new(),
            limits: Vec::new(),
        };
        for (k, &count) in unknowns.iter().enumerate() {
            let before = out.limits.len();
            out.strips.push(first + before);
            out.limits.extend(std::iter::repeat_n(LIMITS.0, count));
            for (l, line) in lines.iter().enumerate().filter(|(_, l)| l.strips[0] == k) {
                out.slides[l] = first + out.limits.len();
                out.limits.extend([LIMITS.1; SLIDES]);
                for end in line.ends {
                    if let End::Vertex(v) = end {
                        if out.vertices[v] == usize::MAX {
                            out.vertices[v] = first + out.limits.len();
                            out.limits.extend([LIMITS.1; 2]);
                        }
                    }
                }
            }
            out.groups.push(out.limits.len() - before);
        }
        out
    }
}
