//! All files of an answer.

use super::cloud::ply;
use super::glb::{self, GlbError};
use super::html::{self, Page};
use super::json::Report;
use super::pictures::Pictures;
use super::png::{self, PngError};
use super::step::write::{self as step, Header, Shell};
use super::{bend_table, bends, dxf, iges, marks, parts, shop_tables, svg, threedm};
use crate::answer::cone_panels;
use crate::answer::presentation::Presentation;
use crate::answer::shop::OffsetFile;
use crate::answer::Answer;
use crate::develop::shop::offsets::OffsetPanel;
use crate::draw::drawing::Drawing;
use crate::draw::scene::{titled, Scene};
use crate::draw::sequence::sequence;
use crate::geom::Vec3;
use crate::num::parallel;
use crate::patchwork::panel::Patchwork;
use crate::torse::cone::part::ConeBody;
use std::collections::HashSet;
use std::io::{self, Write};

/// A file to be: its name, with `/` between folder and file, and its contents.
pub type File = (String, Vec<u8>);

/// Why a file could not be made.
#[derive(Debug, thiserror::Error)]
pub enum BundleError {
    /// A number that is not finite, or an index out of range, in a drawing or model.
    #[error("cannot write {file}: {source}")]
    Write {
        /// Name of the file.
        file: String,
        /// What went wrong.
        source: std::io::Error,
    },
    /// Model for viewers.
    #[error(transparent)]
    Glb(#[from] GlbError),
    /// Picture.
    #[error(transparent)]
    Png(#[from] PngError),
}

/// Name of the file of panels for CAD.
pub(crate) const PANELS: &str = "panels.step";
/// Names of copies of the panels in other formats.
pub(crate) const IGES: &str = "panels.igs";
/// See [`IGES`].
pub(crate) const THREEDM: &str = "panels.3dm";
/// How names of drawings of single parts begin.
pub const PART_FILE: &str = "part-";
/// Name of the file of exact cones, cylinders and planes for CAD.
pub const CONES: &str = "cones.step";

/// Least uncertainty written into STEP headers, mm: below it CAD systems take edges for open.
const LEAST_UNCERTAINTY: f64 = 1e-6;

/// Makes every file, on all cores: those of [`geometry`] and of `reports`.
///
/// # Errors
/// Data that a format cannot hold.
pub fn files(answer: &Answer, shown: &Presentation, time: &str) -> Result<Vec<File>, BundleError> {
    let mut out = geometry(answer, shown, time)?;
    reports(answer, shown, &mut |name, contents| {
        out.push(file(name, contents)?);
        Ok::<(), BundleError>(())
    })?;
    Ok(out)
}

/// The files that hold geometry: panels for CAD, drawings for the cutter. `time` stamps the STEP header:
/// `2026-11-21T14:30:00`.
///
/// # Errors
/// As [`files`].
pub fn geometry(answer: &Answer, shown: &Presentation, time: &str) -> Result<Vec<File>, BundleError> {
    each_geometry(answer, shown, time, &file)
}

/// What writes the contents of a file.
pub type Contents<'a> = &'a mut dyn FnMut(&mut dyn Write) -> io::Result<()>;

/// A file in memory.
pub(crate) fn file(name: &str, contents: Contents) -> Result<File, BundleError> {
    let mut bytes = Vec::new();
    contents(&mut bytes).map_err(|source| BundleError::Write { file: name.to_owned(), source })?;
    Ok((name.to_owned(), bytes))
}

/// What `take` makes of each file of [`geometry`], of its name and what writes it, in their order; it is called from several
/// threads.
///
/// # Errors
/// Those of `take`.
pub(crate) fn each_geometry<T: Send, E: Send>(
    answer: &Answer,
    shown: &Presentation,
    time: &str,
    take: &(dyn Fn(&str, Contents) -> Result<T, E> + Sync),
) -> Result<Vec<T>, E> {
    let gap = answer.certificate.as_ref().map(|c| c.seam_gap_bound);
    let header = Header {
        name: marks::product(&answer.input, &shown.marks),
        time: time.to_owned(),
        uncertainty: match gap {
            Some(gap) if !gap.is_finite() => answer.tolerance,
            gap => gap.unwrap_or(0.0).max(LEAST_UNCERTAINTY),
        },
    };
    let outlined = answer.cones.as_ref().map(|c| cone_panels::outlined(&answer.patchwork, c));
    let copied = outlined.as_ref().unwrap_or(&answer.patchwork);
    let marked = &shown.marks.panels;
    let mut kinds = vec![match &answer.cones {
        Some(cones) => (CONES.to_owned(), Geometry::Cones(&cones.bodies)),
        None => (PANELS.to_owned(), Geometry::Panels),
    }];
    // Nothing of some strips lies flat.
    if answer.lays_flat() {
        kinds.push(("patterns.dxf".into(), Geometry::Dxf(&shown.drawing)));
        kinds.push(("patterns.svg".into(), Geometry::Svg));
    }
    kinds.extend(answer.cut.iges.then(|| (IGES.into(), Geometry::Iges(copied))));
    kinds.extend(answer.cut.threedm.then(|| (THREEDM.into(), Geometry::ThreeDm(copied))));
    kinds.extend(answer.shop.offsets.iter().map(|o| (o.side.file().into(), Geometry::Offsets(o))));
    let names = part_files(shown.alone.iter().map(|(part, _)| part.as_str()));
    kinds.extend(names.into_iter().zip(&shown.alone).map(|(name, (_, drawing))| (name, Geometry::Dxf(drawing))));
    let written = |kind: &Geometry, out: &mut dyn Write| match kind {
        Geometry::Cones(bodies) => out.write_all(&exact(&answer.input, bodies, shown.marks.any(), time)?),
        Geometry::Panels => out.write_all(&step::panels(&header, &answer.patchwork, marked)?),
        Geometry::Dxf(drawing) => dxf::write_to(drawing, out),
        Geometry::Svg => svg::write(&shown.drawing, out),
        Geometry::Iges(panels) => out.write_all(&iges::write::panels(&header, panels, marked)),
        Geometry::ThreeDm(panels) => out.write_all(&threedm::write::panels(&header, panels, marked)?),
        Geometry::Offsets(offsets) => out.write_all(&offset_surface(offsets, marked, &header)?),
    };
    let made = |(name, kind): (String, Geometry)| take(&name, &mut |out| written(&kind, out));
    parallel::map(kinds, made).into_iter().collect()
}

/// A file that holds geometry.
enum Geometry<'a> {
    /// Exact cones for CAD.
    Cones(&'a [ConeBody]),
    /// Panels for CAD.
    Panels,
    /// The drawing of all parts, or of one alone.
    Dxf(&'a Drawing),
    Svg,
    /// The panels in further formats: copies of [`PANELS`], or of [`CONES`] as splines.
    Iges(&'a Patchwork),
    ThreeDm(&'a Patchwork),
    /// A surface of the sheet beside the panels.
    Offsets(&'a OffsetFile),
}

/// A surface of the sheet beside the panels, as a file.
fn offset_surface(offsets: &OffsetFile, marked: &[bool], header: &Header) -> io::Result<Vec<u8>> {
    let off = offsets.panels.iter().map(|p| p.edge_error).fold(LEAST_UNCERTAINTY, f64::max);
    let header = Header { uncertainty: off, ..header.clone() };
    let shell = |p: &OffsetPanel| {
        let shell = Shell::of_offset(p);
        if marked.get(p.panel).copied().unwrap_or(true) {
            shell.marked()
        } else {
            shell
        }
    };
    let shells: Vec<Shell> = offsets.panels.iter().map(shell).collect();
    step::shells(&header, &shells)
}

/// Names of the drawings of parts, one each: what names of files cannot hold is replaced, and names that would be the same then,
/// or where capitals count for nothing, are numbered.
pub(crate) fn part_files<'a>(parts: impl Iterator<Item = &'a str>) -> Vec<String> {
    let plain = |c: char| if c.is_alphanumeric() || "-_.+".contains(c) { c } else { '_' };
    let mut used = HashSet::new();
    let mut named = |part: &str| {
        let base: String = part.chars().map(plain).collect();
        let numbered = (2..).map(|k| format!("{base}-{k}"));
        let free = std::iter::once(base.clone()).chain(numbered).find(|name| used.insert(name.to_lowercase()));
        format!("{PART_FILE}{}.dxf", free.unwrap_or(base))
    };
    parts.map(&mut named).collect()
}

/// Hands over bend table, list of parts, pictures, model, points and reports, one by one.
///
/// # Errors
/// As [`files`], and those of `take`.
pub(crate) fn reports<E: From<BundleError>>(
    answer: &Answer,
    shown: &Presentation,
    take: &mut dyn FnMut(&str, Contents) -> Result<(), E>,
) -> Result<(), E> {
    let report = Report::of(answer, shown);
    let pictures = Pictures::of(answer, shown, &report).map_err(BundleError::from)?;
    let limit = answer.colour_limit();
    let mut put = |(name, bytes): File| take(&name, &mut |out| out.write_all(&bytes));
    put(("model.glb".into(), glb::write(&shown.scene, limit).map_err(BundleError::from)?))?;
    if shown.stages.len() > 1 {
        motion("moves", &shown.stages, &shown.direction)?.into_iter().try_for_each(&mut put)?;
    }
    if !answer.points.places.is_empty() {
        let (places, values) = (&answer.points.places, &answer.points.values);
        put(("deviation.ply".into(), ply::with_values(places, values, &answer.meaning.name)))?;
    }
    let unit = answer.cut.unit;
    let tables = [
        ("bends.csv", bends::csv(&answer.patterns, unit)),
        ("bend_table.csv", bend_table::csv(answer, unit)),
        ("roll_table.csv", shop_tables::roll(answer, unit)),
        ("facets.csv", shop_tables::facets(answer, unit)),
        ("bevels.csv", shop_tables::bevels(answer, unit)),
        ("joints.csv", shop_tables::joints(answer, unit)),
        ("parts.csv", parts::csv(&report, &answer.patterns, unit)),
    ];
    for (name, table) in tables {
        table.map_or(Ok(()), |bytes| put((name.into(), bytes)))?;
    }
    let page = Page { report: &report, job: answer.job, meaning: &answer.meaning, limit, shown, pictures: &pictures };
    take("report.html", &mut |out| html::write(&page, out))?;
    take("report.json", &mut |out| report.write(out))?;
    pictures.files().into_iter().try_for_each(|(name, bytes)| take(&name, &mut |out| out.write_all(&bytes)))
}

/// bending.glb, an animation, and bending.png, a strip of pictures, from stages with their captions; `eye` points
/// from the model to the eye.
///
/// # Errors
/// Data that a format cannot hold.
pub fn bending(stages: &[(String, Scene)], eye: &Vec3) -> Result<Vec<File>, BundleError> {
    motion("bending", stages, eye)
}

/// An animation and a strip of pictures of one name.
fn motion(name: &str, stages: &[(String, Scene)], eye: &Vec3) -> Result<Vec<File>, BundleError> {
    /// Pictures in the strip.
    const PICTURES: usize = 6;
    let scenes: Vec<Scene> = stages.iter().map(|s| s.1.clone()).collect();
    let last = stages.len().saturating_sub(1);
    let chosen: Vec<(String, Scene)> =
        (0..PICTURES).filter_map(|k| stages.get(last * k / (PICTURES - 1)).cloned()).collect();
    Ok(vec![
        (format!("{name}.glb"), glb::moving::write(name, &scenes)?),
        (format!("{name}.png"), png::write(&sequence(&chosen, eye))?),
    ])
}

/// thickness.step and thickness.glb: the surfaces of sheets with thickness.
///
/// # Errors
/// Data that a format cannot hold.
pub fn thickness(name: &str, surfaces: &[ConeBody], scene: &Scene, time: &str) -> Result<Vec<File>, BundleError> {
    let marked = scene.panels.iter().any(|p| p.marked);
    let step = file("thickness.step", &mut |out| out.write_all(&exact(name, surfaces, marked, time)?))?;
    Ok(vec![step, ("thickness.glb".into(), glb::write(scene, 1.0)?)])
}

/// A file of exact cones, cylinders and planes for CAD; `marked` if they must not be cut.
///
/// # Errors
/// Those of the writer.
pub fn exact(name: &str, bodies: &[ConeBody], marked: bool, time: &str) -> io::Result<Vec<u8>> {
    let header = Header { name: titled(name, marked), time: time.to_owned(), uncertainty: LEAST_UNCERTAINTY };
    let bodies: Vec<Shell> = bodies
        .iter()
        .map(|b| match &b.part {
            Some(part) => Shell::of_cone_part(&b.name, part),
            None => Shell::of_cones(&b.name, &b.spline),
        })
        .map(|s| if marked { s.marked() } else { s })
        .collect();
    step::shells(&header, &bodies)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::answer::note::{Note, ReaderNote};
    use crate::answer::presentation::present;
    use crate::answer::{Guide, Job, PointMap};
    use crate::certify::claim::{Claim, Subject, What};
    use crate::develop::strip::{pattern, StripOptions};
    use crate::draw::field::{FieldMeaning, PanelField};
    use crate::geom::Vec3;
    use crate::patchwork::panel::Patchwork;
    use crate::patchwork::part::Part;
    use crate::reason::{JobReason, StripReason};
    use crate::torse::form::PanelKind;
    use crate::torse::strip::Strip;

    /// One plane quadrilateral and one triangle on it.
    pub(crate) fn sample() -> Answer {
        let x = |x: f64, y: f64, z: f64| Vec3::new(x, y, z);
        let strips = vec![
            Strip::quad("A-01", PanelKind::Plane, [x(0., 0., 0.), x(0., 50., 0.)], [x(90., 0., 0.), x(80., 50., 0.)])
                .expect("strip"),
            Strip::quad(
                "A-02",
                PanelKind::Plane,
                [x(90., 0., 0.), x(80., 50., 0.)],
                [x(120., 0., 40.), x(80., 50., 0.)],
            )
            .expect("strip"),
        ];
        let patterns = vec![pattern(&[&strips[0], &strips[1]], 0, "A", &StripOptions::new(0.01)).expect("pattern")];
        Answer {
            claims: vec![
                Claim::measured(What::RegressionClearance, Subject::Whole, f64::INFINITY),
                Claim::measured(What::Twist, Subject::Panel(0), 1e-9),
                Claim::measured(What::Twist, Subject::Panel(1), 1e-9),
            ],
            fields: vec![PanelField { u: vec![0.0, 1.0], v: vec![0.0, 1.0], values: vec![0.0, 0.1, 0.2, -0.1] }; 2],
            points: PointMap {
                places: vec![x(20., 20., 0.1), x(40., 20., 9.)],
                values: vec![0.1, 9.0],
                worst: Some(1),
            },
            meaning: FieldMeaning { name: "deviation".into(), unit: "mm".into(), limit: 0.2 },
            parts: vec![Part { name: "A".into(), first: 0, count: 2, missing: None }],
            patterns,
            guides: vec![Guide { name: "rail".into(), points: vec![x(0., 0., 0.), x(90., 0., 0.)] }],
            notes: vec![Note::Input(ReaderNote::NotFinite { item: "a & b".into() })],
            patchwork: Patchwork::of_strips(strips),
            ..Answer::new(Job::Loft, "plate <1>", 0.1)
        }
    }

    /// Triangles with a common corner: a discrete cone.
    fn fan(count: usize) -> Vec<Strip> {
        let at = |k: usize| {
            let (s, c) = (0.2 * k as f64).sin_cos();
            [Vec3::new(100.0 * c, 80.0 * s, 0.0), Vec3::new(0.0, 0.0, 90.0)]
        };
        (0..count)
            .map(|k| Strip::quad(&format!("F-{}", k + 1), PanelKind::Plane, at(k), at(k + 1)).expect("strip"))
            .collect()
    }

    #[test]
    fn all_files_are_made_and_the_report_says_the_same_as_the_data() {
        let answer = sample();
        let all = files(&answer, &present(&answer), "2026-11-21T14:30:00").expect("files");
        let names: Vec<&str> = all.iter().map(|f| f.0.as_str()).collect();
        for name in
            "panels.step patterns.dxf patterns.svg model.glb panels.png field.png points.png layout.png bends.csv parts.csv deviation.ply report.html report.json"
                .split(' ')
        {
            assert!(names.contains(&name), "{name}");
        }
        let json = &all.iter().find(|f| f.0 == "report.json").expect("json").1;
        let report: Report = serde_json::from_slice(json).expect("a report");
        assert_eq!(report, Report::of(&answer, &present(&answer)));
        assert!(report.figures[0].value.is_none() && report.parts[0].panels == ["A-01", "A-02"]);
        let step = String::from_utf8_lossy(&all[0].1).into_owned();
        assert_eq!(step.matches("ADVANCED_FACE").count(), 2);
        // The triangle has three edges, the quadrilateral four.
        assert_eq!(step.matches("EDGE_CURVE").count(), 7);
    }

    #[test]
    fn every_file_of_an_uncertified_result_says_so() {
        let count = |files: &[File], name: &str, words: &str| {
            let bytes = &files.iter().find(|f| f.0 == name).expect(name).1;
            String::from_utf8_lossy(bytes).matches(words).count()
        };
        let mut answer = sample();
        let made = |s: &Answer| files(s, &present(s), "2026-11-21T14:30:00").expect("files");
        answer.claims.push(Claim::left_out(StripReason::NoHull));
        let good = made(&answer);
        for name in ["panels.step", "patterns.svg", "model.glb"] {
            assert_eq!(count(&good, name, "NOT CERTIFIED"), 0, "{name}");
        }
        assert_eq!(count(&good, "report.html", "class=\"stop\""), 1);
        answer.claims.push(Claim::objection(Subject::Whole, JobReason::Stopped));
        let bad = made(&answer);
        // Product, its representations and shapes carry it, and so do nodes.
        assert!(count(&bad, "panels.step", "A-01 NOT CERTIFIED") >= 3);
        assert!(count(&bad, "panels.step", "PRODUCT('plate <1> NOT CERTIFIED'") == 1);
        assert!(count(&bad, "model.glb", "A-02 NOT CERTIFIED") >= 2);
        assert_eq!(count(&bad, "patterns.dxf", "\nCUT_OUTER\n"), 1, "the table of layers alone");
        assert!(count(&bad, "patterns.dxf", "\nNOT_CERTIFIED\n") > 3);
        assert!(count(&bad, "patterns.svg", "not-certified") > 0 && count(&bad, "patterns.svg", "cut-outer") == 0);
        assert_eq!(count(&bad, "report.html", "<p class=\"stop\" role=\"alert\">Not certified: do not cut A.</p>"), 1);
        assert_eq!(count(&bad, "report.json", "\"certified\": false"), 3);
        for name in ["panels.png", "field.png", "points.png", "layout.png"] {
            let of = |files: &[File]| files.iter().find(|f| f.0 == name).expect(name).1.clone();
            assert!(of(&good) != of(&bad), "{name}");
        }
    }

    #[test]
    fn the_shapes_of_parts_are_told() {
        let mut answer = sample();
        answer.patchwork = Patchwork::of_strips(fan(8));
        answer.parts[0].count = 8;
        let report = Report::of(&answer, &present(&answer));
        assert_eq!((report.shapes[0].shape.as_str(), report.shapes[0].last.as_str()), ("cone", "F-8"));
    }

    #[test]
    fn the_page_of_strips_is_filled_and_names_cannot_become_markup() {
        let answer = sample();
        let all = files(&answer, &present(&answer), "2026-11-21T14:30:00").expect("files");
        let page = &all.iter().find(|f| f.0 == "report.html").expect("a page").1;
        let text = String::from_utf8_lossy(page);
        assert!(!text.contains("{{") && !text.contains("plate <1>") && text.contains("plate &lt;1&gt;"));
        assert!(text.contains("a &amp; b") && text.contains("A-02"));
        assert!(text.contains("point 1 at (40, 20, 9), 9&nbsp;mm away."));
        for unwanted in ["src=\"http", "href=\"http", "url(", "@import"] {
            assert!(!text.contains(unwanted), "{unwanted}");
        }
    }

    #[test]
    fn no_two_parts_have_one_file() {
        let names = part_files(["A 1", "A_1", "a_1", "B", "A_1-2"].into_iter());
        assert_eq!(names, ["part-A_1.dxf", "part-A_1-2.dxf", "part-a_1-3.dxf", "part-B.dxf", "part-A_1-2-2.dxf"]);
    }
}
