//! Panels over the tolerance: ours, the estimate of theory, and the counts published with the method of \[SE06\] for a bowl
//! of the same kind. Writes `counts.png` and prints the table.

use std::io::Write;
use torse::control::Control;
use torse::draw::chart::{chart, Chart, Series};
use torse::io::png;
use torse::io::step::read::read;
use torse::pipeline::approximate::Options;
use torse::pipeline::sweep::sweep;

const BOWL: &[u8] = include_bytes!("../../../../data/half_bowl.step");

/// Tolerances in mm; the bowl is 1 m wide.
const TOLERANCES: [f64; 5] = [10.0, 3.0, 1.0, 0.3, 0.1];

/// Published: tolerance over size in thousandths, and panels. The control points of that bowl are not published.
const PUBLISHED: [[f64; 2]; 2] = [[10.0, 11.0], [1.0, 27.0]];

/// Draws them into a folder.
pub fn draw(folder: &std::path::Path) -> Result<(), Box<dyn std::error::Error>> {
    let options = Options { input: "half bowl".into(), smooth_angle: 0.0, ..Options::new(TOLERANCES[0]) };
    let rows = sweep(&read(BOWL)?.faces, &[], &TOLERANCES, &options, &Control::default())?;
    let mut out = std::io::stdout().lock();
    for r in &rows {
        let estimate = r.theory_estimate.map_or("-".into(), |l| format!("{l:.2}"));
        writeln!(
            out,
            "{:>6} mm {:>4} panels, estimate of theory {estimate:>6}, certified: {}, {:.1} s",
            r.tolerance, r.panels, r.certified, r.seconds
        )?;
    }
    let series = |name: &str, measured: bool, points: Vec<[f64; 2]>| Series { name: name.to_owned(), measured, points };
    let picture = chart(&Chart {
        title: "Half a bowl of 1 m".into(),
        x: "tolerance, mm".into(),
        y: "panels".into(),
        series: vec![
            series("panels, certified", true, rows.iter().map(|r| [r.tolerance, r.panels as f64]).collect()),
            series(
                "estimate of theory",
                false,
                rows.iter().filter_map(|r| Some([r.tolerance, r.theory_estimate?])).collect(),
            ),
            series("published for a bowl of this kind", true, PUBLISHED.to_vec()),
        ],
    })
    .ok_or("nothing to draw")?;
    std::fs::write(folder.join("counts.png"), png::write(&picture)?)?;
    Ok(())
}
