//! `report.html`: one self-contained page that opens offline, with pictures, tables and a 3-D view.
//!
//! The page loads nothing: style, script, pictures and geometry are inside, and its content policy forbids the rest.
//! All words and numbers come from [`Report`], the record that is also written as `report.json`.

mod geometry;
mod layout;
mod numbers;
mod tables;
mod words;

use super::json::Report;
use super::markup::escape;
use super::pictures::Pictures;
use super::words::{counted, thing};
use crate::answer::presentation::Presentation;
use crate::answer::Job;
use crate::draw::field::FieldMeaning;
use base64::prelude::{Engine, BASE64_STANDARD};
use base64::write::EncoderWriter;
use std::io::{self, Write};

/// Everything the page shows.
#[derive(Clone, Copy)]
pub struct Page<'a> {
    /// Words and numbers.
    pub report: &'a Report,
    /// The job.
    pub job: Job,
    /// What the colours mean, where panels show values.
    pub meaning: &'a FieldMeaning,
    /// End of the colour scale.
    pub limit: f64,
    /// Geometry of the 3-D view, its first direction, flat patterns.
    pub shown: &'a Presentation,
    /// PNG files.
    pub pictures: &'a Pictures,
}

const FRAME: &str = include_str!("frame.html");
const PAGE: &str = include_str!("page.html");
const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("viewer.js");

/// Writes the text of `report.html`.
///
/// # Errors
/// Those of `out`.
pub fn write(page: &Page, out: &mut dyn Write) -> io::Result<()> {
    let Page { report, shown, pictures, .. } = *page;
    let covers = report.covers_faces();
    let thing = thing(page.job);
    let plural = format!("{thing}s");
    let capital = capitalised(&plural);
    let main = |name: &str| match name {
        "result" => if covers { "Certificate" } else { "Result" }.into(),
        "certificate" if covers => {
            words::certificate(report) + &tables::seams(report) + &tables::panels_along_curves(report)
        }
        "certificate" => words::result(report),
        "warnings" => words::warnings(report),
        "panel_count" => counted(report.panels.len(), thing),
        "panel_words" if covers => {
            format!("Bounds are proven and rounded to the safe side; lengths in mm.{}", tables::kinds(report))
        }
        "panel_words" => tables::kinds(report),
        "thing" => thing.into(),
        "Things" => capital.clone(),
        "face_head" if covers => "<th><button type=\"button\">Face</button></th>".into(),
        "figure_heads" => tables::figure_heads(report),
        "panel_rows" => tables::panels(report),
        "joins" => tables::joins(report),
        "shapes" => tables::shapes(report, pictures.shapes.as_deref().map(image)),
        "layout" => layout::layout(&shown.pieces) + &tables::sheet_bends(report) + &tables::facets(report),
        "part_rows" => tables::parts(report),
        "joints" => tables::joints(report),
        "points" => tables::points(report, pictures.points.as_ref().map(|p| (image(&p.0), p.1)), page.limit),
        "field" => maps(page),
        "faces" => {
            if covers {
                tables::faces(report)
            } else {
                String::new()
            }
        }
        _ => String::new(),
    };
    let field = if covers { "Deviation" } else { page.meaning.name.as_str() };
    let coloured = covers || pictures.field.is_some();
    let unit = if page.meaning.unit.is_empty() { "mm" } else { &page.meaning.unit };
    let (header, blob) = geometry::pack(&shown.scene, &shown.direction, page.limit);
    let header = serde_json::to_string(&header)?;
    let hidden = |there: bool| if there { "" } else { "hidden" };
    let first = words::first_line(report);
    let frame = |name: &str| match name {
        "first" if first.is_empty() => String::new(),
        "first" => format!("<p class=\"stop\" role=\"alert\">{}</p>", escape(&first)),
        "title" => escape(&report.input),
        "things" => plural.clone(),
        "Things" => capital.clone(),
        "kicker" => escape(&format!("Developable {plural}: {}", report.job)),
        "style" => STYLE.to_string(),
        "script" => SCRIPT.to_string(),
        "badge" => words::badge(report),
        "figures" if covers => words::cover_figures(report),
        "figures" => words::figures(report),
        "surface_hidden" => hidden(covers).into(),
        "borders" => if covers { "Seams" } else { "Borders" }.into(),
        "field_hidden" => hidden(coloured).into(),
        "curvature_hidden" => hidden(shown.scene.curvature.iter().flatten().any(|c| !c.is_empty())).into(),
        "joints_hidden" => hidden(!shown.scene.joints.is_empty()).into(),
        "witnesses_hidden" => hidden(!shown.scene.witnesses.is_empty()).into(),
        "field_name" => escape(field),
        "limit" => format!("{}&nbsp;{}", numbers::number(page.limit), escape(unit)),
        "version" => escape(&report.version),
        "panels_png" => image(&pictures.panels),
        "scene" => header.replace('<', "\\u003c"),
        _ => String::new(),
    };
    fill(FRAME, out, &mut |name, out| match name {
        "main" => fill(PAGE, out, &mut |name, out| out.write_all(main(name).as_bytes())),
        "geometry" => {
            let mut encoded = EncoderWriter::new(out, &BASE64_STANDARD);
            encoded.write_all(&blob)?;
            encoded.finish().map(drop)
        }
        name => out.write_all(frame(name).as_bytes()),
    })
}

/// Maps of deviations and values.
fn maps(page: &Page) -> String {
    let card = |id: &str, title: &str, about: &str, png: &[u8]| {
        let (title, about, png) = (escape(title), escape(about), image(png));
        format!("<section class=\"card\" id=\"{id}\"><h2>{title}</h2><img src=\"{png}\" alt=\"{about}\"></section>")
    };
    let mut out = String::new();
    if let Some(png) = &page.pictures.deviation {
        let about = "Map of the signed distance between panels and surface";
        out += &card("deviation", "Distance from the surface", about, png);
    }
    if let Some(png) = &page.pictures.field {
        let mean = if page.pictures.points.is_some() { "mean " } else { "" };
        let title = capitalised(&format!("{mean}{}", page.meaning.name));
        out += &card("field", &title, &format!("Map: {}", page.meaning.name), png);
    }
    out
}

/// The same words with a capital letter.
fn capitalised(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |c| c.to_uppercase().chain(letters).collect())
}

/// A PNG file as the address of a picture.
fn image(bytes: &[u8]) -> String {
    format!("data:image/png;base64,{}", BASE64_STANDARD.encode(bytes))
}

/// Replaces each `{{name}}` of a template once; what is put in is not looked at again.
fn fill(
    template: &str,
    out: &mut dyn Write,
    value: &mut dyn FnMut(&str, &mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let mut parts = template.split("{{");
    out.write_all(parts.next().unwrap_or_default().as_bytes())?;
    for part in parts {
        match part.split_once("}}") {
            Some((name, rest)) => {
                value(name, out)?;
                out.write_all(rest.as_bytes())?;
            }
            None => out.write_all(part.as_bytes())?,
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answer::marks::Marks;
    use crate::certify::claim::What;
    use crate::draw::drawing::Drawing;
    use crate::draw::flat::FlatPiece;
    use crate::draw::scene::{PanelShape, Scene};
    use crate::geom::mesh::Mesh;
    use crate::geom::Vec3;
    use crate::io::json::tests::{sample, set};

    fn page(report: &Report) -> String {
        let mesh = Mesh {
            positions: vec![Vec3::zeros(), Vec3::x(), Vec3::y()],
            normals: vec![Vec3::z(); 3],
            triangles: vec![[0, 1, 2]],
            values: vec![0.1, 0.2, -0.3],
        };
        let panel = |name: &str| PanelShape { name: name.into(), mesh: mesh.clone(), ..PanelShape::default() };
        let scene =
            Scene { panels: vec![panel("A-01"), panel("A-02")], surfaces: vec![mesh.clone()], ..Scene::default() };
        let flat = FlatPiece { name: "A-01".into(), ..FlatPiece::default() };
        let shown = Presentation {
            marks: Marks::default(),
            scene,
            stages: Vec::new(),
            direction: Vec3::new(1.0, -1.0, 1.0),
            drawing: Drawing::default(),
            alone: Vec::new(),
            pieces: vec![flat],
            shapes: Vec::new(),
            shape_patches: Vec::new(),
            orders: Vec::new(),
        };
        let pictures = Pictures {
            panels: vec![1, 2],
            layout: Some(vec![]),
            deviation: Some(vec![3]),
            field: None,
            points: Some((vec![4], 1)),
            shapes: None,
        };
        let meaning = FieldMeaning::default();
        let page =
            Page { report, job: Job::Approximate, meaning: &meaning, limit: 1.0, shown: &shown, pictures: &pictures };
        let mut out = Vec::new();
        write(&page, &mut out).expect("a page");
        String::from_utf8(out).expect("text")
    }

    #[test]
    fn every_place_of_the_template_is_filled_and_nothing_is_fetched() {
        let text = page(&sample());
        assert!(!text.contains("{{"));
        for unwanted in ["src=\"http", "href=\"http", "url(", "@import"] {
            assert!(!text.contains(unwanted), "{unwanted}");
        }
        assert!(text.contains("0.988"), "the bound, rounded up");
        // An unknown name in the template would leave an empty place.
        let known = &mut |name: &str, _: &mut dyn Write| {
            let known = "result certificate warnings panel_count panel_words thing Things face_head figure_heads \
                         panel_rows joins shapes layout part_rows joints points field faces";
            assert!(known.split_whitespace().any(|k| k == name), "{name}");
            Ok(())
        };
        fill(PAGE, &mut Vec::new(), known).expect("filled");
    }

    /// Parts that are only laid flat name their faces too, but no faces are listed there.
    #[test]
    fn rows_of_panels_have_a_cell_under_every_heading() {
        let flat = Report { faces: Vec::new(), ..sample() };
        assert!(flat.panels.iter().all(|p| p.face.is_some()));
        for report in [sample(), flat] {
            let text = page(&report);
            let table = &text[text.find("<table id=\"table\">").expect("a table")..];
            let (head, body) = table.split_once("</thead>").expect("a head");
            let row = body.split("</tr>").next().expect("a row");
            assert_eq!(head.matches("<th").count() - head.matches("<thead").count(), row.matches("<td").count());
        }
    }

    #[test]
    fn names_from_the_file_cannot_become_markup() {
        let mut report = sample();
        report.input = "</title><script>alert(1)</script>".into();
        report.faces[0].name = "<b onclick='x'>".into();
        report.panels[0].name = "\"><img src=x>".into();
        let text = page(&report);
        for markup in ["<script>alert", "<b onclick", "<img src=x"] {
            assert!(!text.contains(markup), "{markup}");
        }
    }

    #[test]
    fn an_uncertified_report_says_so_and_shows_the_witness() {
        let mut report = sample();
        report.status = "uncertified".into();
        report.reason = "the tolerance is exceeded".into();
        report.objections = vec!["the tolerance is exceeded".into(), "panel A-01: distance 1.7 mm".into()];
        report.beside_panels = vec!["the tolerance is exceeded".into()];
        (report.panels[0].certified, report.parts[0].certified) = (false, false);
        report.panels[0].reason = "distance 1.7 mm".into();
        set(&mut report.panels[0].figures, What::Deviation, None);
        report.panels[0].witness = Some(crate::io::json::WitnessRecord { uv: [0.25, 0.75], distance: Some(1.7) });
        let text = page(&report);
        for words in ["Not certified", "the tolerance is exceeded", "on face side: distance 1.7 mm"] {
            assert!(text.contains(words), "{words}");
        }
        // Places are told in the coordinates of the model.
        assert!(!text.contains("badge good") && !text.contains("u = "));
        let body = text.split_once("<body>").map_or("", |b| b.1.trim_start());
        assert!(body.starts_with("<p class=\"stop\" role=\"alert\">Not certified: do not cut A-01"), "{}", &body[..80]);
    }
}
