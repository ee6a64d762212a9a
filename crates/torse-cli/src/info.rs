//! `torse info`: what a STEP file holds.

use crate::args::Info;
use crate::failure::Failure;
use crate::input::contents;
use crate::wiring;
use std::fmt::Write as _;
use std::io::Write as _;
use torse::io::words;
use torse::pipeline::info::{measure, FaceInfo, Range};
use torse::Model;

/// Prints what the file holds; `Ok(true)` always.
pub fn run(arguments: &Info) -> Result<bool, Failure> {
    let name = arguments.file.display().to_string();
    let model = wiring::read(&name, &contents(&arguments.file)?)?;
    let faces = measure(&model.faces);
    let text = report(&name, &model, &faces);
    // A closed pipe (`| head`) is not an error.
    let _ = std::io::stdout().lock().write_all(text.as_bytes());
    Ok(true)
}

/// Share of the size of a face above which the distance of its trim from the file's edges is told; chords keep to a tenth
/// of this.
const TRIM_NOTED: f64 = 1e-4;

/// The whole answer.
fn report(name: &str, model: &Model, faces: &[FaceInfo]) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(text, "{name}");
    let _ = writeln!(text, "unit        {} (all lengths below in mm)", model.unit);
    let total = faces.iter().fold(None, |sum: Option<torse::geom::BBox>, f| match (sum, f.bbox_estimate) {
        (Some(mut a), b) => {
            a.include(&b.min);
            a.include(&b.max);
            Some(a)
        }
        (None, b) => Some(b),
    });
    if let Some(b) = total {
        let d = b.max - b.min;
        let _ = writeln!(text, "size        {} x {} x {}", number(d.x), number(d.y), number(d.z));
    }
    let area: f64 = faces.iter().map(|f| f.area_estimate).sum();
    let _ = writeln!(text, "faces       {}, area {} mm²", faces.len(), number(area));
    for (face, info) in model.faces.iter().zip(faces) {
        let label =
            [face.part.as_str(), face.name.as_str()].iter().filter(|s| !s.is_empty()).copied().collect::<Vec<_>>();
        let d = info.bbox_estimate.max - info.bbox_estimate.min;
        let _ = writeln!(text, "\n#{} {}  {}", face.entity, info.kind, label.join(" / "));
        let _ = writeln!(text, "  size      {} x {} x {}", number(d.x), number(d.y), number(d.z));
        let _ = writeln!(text, "  area      {} mm²", number(info.area_estimate));
        if info.holes > 0 {
            let _ = writeln!(text, "  holes     {}", info.holes);
        }
        if face.trim_deviation_estimate > TRIM_NOTED * info.bbox_estimate.diagonal() {
            let far = number(face.trim_deviation_estimate);
            let _ = writeln!(
                text,
                "  trim      up to about {far} mm from the file's edges, which miss each other or the surface"
            );
        }
        let _ = writeln!(
            text,
            "  curvature {} in 1/mm (smallest), {} (largest)",
            range(info.curvature_min),
            range(info.curvature_max)
        );
        let _ = writeln!(text, "  Gaussian  {} in 1/mm²: {}", range(info.gaussian), info.character());
        if let Some(radius) = info.smallest_radius() {
            let _ = writeln!(text, "  radius    at least about {} mm", number(radius));
        }
    }
    if !model.skipped.is_empty() {
        let _ = writeln!(text, "\nnot read    {}", model.skipped.len());
        for skipped in &model.skipped {
            let _ = writeln!(text, "  {}", words::left_out(skipped));
        }
    }
    for note in &model.notes {
        let _ = writeln!(text, "\nnote        {}", words::note(note));
    }
    text
}

/// A number to five significant digits without trailing zeros.
fn number(x: f64) -> String {
    if x == 0.0 {
        return "0".to_string();
    }
    if !x.is_finite() {
        return x.to_string();
    }
    let magnitude = x.abs().log10().floor();
    if !(-4.0..7.0).contains(&magnitude) {
        return format!("{x:.4e}");
    }
    let digits = (4.0 - magnitude).max(0.0) as usize;
    let text = format!("{x:.digits$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_string()
    } else {
        text
    }
}

fn range(r: Range) -> String {
    format!("{} to {}", number(r.min), number(r.max))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!(number(1234.5678), "1234.6");
        assert_eq!(number(0.5), "0.5");
        assert_eq!(number(-2.0), "-2");
        assert_eq!(number(1.5e-9), "1.5000e-9");
        assert_eq!(number(100.0), "100");
    }
}
