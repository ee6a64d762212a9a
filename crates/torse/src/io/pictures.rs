//! The pictures of an answer as PNG files.

use super::json::Report;
use super::png::{self, PngError};
use super::{marks, words};
use crate::answer::presentation::Presentation;
use crate::answer::Answer;
use crate::certify::claim::{Subject, What};
use crate::draw::picture::{self, Caption};
use crate::num::parallel;

/// PNG files.
pub struct Pictures {
    /// Panels with rulings.
    pub panels: Vec<u8>,
    /// Flat patterns, of jobs that make them.
    pub layout: Option<Vec<u8>>,
    /// Distance of the panels from the faces, where they cover any.
    pub deviation: Option<Vec<u8>>,
    /// Values of panels, where there are some.
    pub field: Option<Vec<u8>>,
    /// Measured points, where there are some, and how many lie outside the picture.
    pub points: Option<(Vec<u8>, usize)>,
    /// Panels coloured by shape, where shapes are known.
    pub shapes: Option<Vec<u8>>,
}

impl Pictures {
    /// Draws them, on all cores.
    ///
    /// # Errors
    /// A picture that cannot be encoded.
    pub fn of(answer: &Answer, shown: &Presentation, report: &Report) -> Result<Self, PngError> {
        let (scene, eye, limit) = (&shown.scene, &shown.direction, answer.colour_limit());
        let warning = report.do_not_cut(marks::MOST_NAMED).map_or_else(String::new, |w| format!("; {w}"));
        let caption =
            |note: String| Caption { title: answer.input.clone(), note: note + &warning, ..Caption::default() };
        let what = words::counted(answer.patchwork.panels.len(), words::thing(answer.job));
        let all = caption(format!("{what}, {}", certainty(answer, report)));
        let flat = format!("{}, flat, 1:1 in patterns.dxf", words::counted(answer.patterns.len(), "part"));
        let lays_flat = answer.lays_flat();
        let unit = format!("{}, {}", answer.meaning.name, answer.meaning.unit);
        let deviation = || {
            let words = caption("distance of the panels from the surface, mm".to_owned());
            answer.covers_faces().then(|| png::write(&picture::deviation(scene, eye, answer.tolerance, &words)))
        };
        let field = || {
            let words = caption(answer.meaning.name.clone());
            (!answer.fields.is_empty()).then(|| png::write(&picture::values(scene, eye, limit, &unit, &words)))
        };
        let points = || {
            let words = caption(format!("{} of every point", answer.meaning.name));
            let map = (&answer.points.places[..], &answer.points.values[..]);
            (!map.0.is_empty()).then(|| {
                let (image, outside) = picture::points(scene, map, eye, limit, &unit, &words);
                png::write(&image).map(|png| (png, outside))
            })
        };
        let shapes = || {
            let words = caption("planes, cylinders, cones and tangent surfaces".into());
            (!shown.shapes.is_empty()).then(|| png::write(&picture::shapes(scene, &shown.shape_patches, eye, &words)))
        };
        let ((panels, layout), ((deviation, field), (points, shapes))) = parallel::join(
            || {
                parallel::join(
                    || png::write(&picture::panels(scene, eye, &all)),
                    || lays_flat.then(|| png::write(&picture::layout(&shown.pieces, &caption(flat)))),
                )
            },
            || parallel::join(|| parallel::join(deviation, field), || parallel::join(points, shapes)),
        );
        Ok(Self {
            panels: panels?,
            layout: layout.transpose()?,
            deviation: deviation.transpose()?,
            field: field.transpose()?,
            points: points.transpose()?,
            shapes: shapes.transpose()?,
        })
    }

    /// The files by name.
    pub fn files(self) -> Vec<(String, Vec<u8>)> {
        let all = [
            ("panels.png", Some(self.panels)),
            ("deviation.png", self.deviation),
            ("field.png", self.field),
            ("points.png", self.points.map(|p| p.0)),
            ("shapes.png", self.shapes),
            ("layout.png", self.layout),
        ];
        all.into_iter().filter_map(|(name, png)| Some((name.to_owned(), png?))).collect()
    }
}

/// How certain the result is, in a caption.
fn certainty(answer: &Answer, report: &Report) -> String {
    let bound = answer.claims_of(Subject::Whole).find(|c| c.what() == What::Deviation).map(|c| c.value());
    match bound {
        _ if !report.certified() => "not certified".into(),
        Some(bound) if answer.covers_faces() => {
            let each = if answer.patchwork.panels.len() == 1 { "" } else { "each " };
            format!("{each}within {} of the surface, certified", words::numbers::length_bound(bound))
        }
        _ => "certified".into(),
    }
}
