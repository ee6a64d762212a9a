//! `report.html`: one self-contained page that opens offline, with pictures, tables and a 3-D view.
//!
//! The page loads nothing: style, script, pictures and geometry are inside, and its content policy forbids the rest.
//! All words and numbers come from [`Report`], the record that is also written as `report.json`.

mod geometry;
pub mod sheets;
mod tables;
mod words;

use super::json::Report;
use crate::draw::flat::FlatPiece;
use crate::draw::scene::Scene;
use crate::geom::Vec3;
use base64::prelude::{Engine, BASE64_STANDARD};

/// Everything the page shows.
#[derive(Clone, Copy, Debug)]
pub struct Page<'a> {
    /// Words and numbers.
    pub report: &'a Report,
    /// Geometry of the 3-D view.
    pub scene: &'a Scene,
    /// Direction (towards the eye) in which the 3-D view opens.
    pub direction: Vec3,
    /// Flat patterns on the sheet.
    pub layout: &'a [FlatPiece],
    /// PNG file: panels with rulings.
    pub panels_png: &'a [u8],
    /// PNG file: deviation map.
    pub deviation_png: &'a [u8],
}

/// The page could not be written.
#[derive(Debug, thiserror::Error)]
#[error("report.html: {0}")]
pub struct HtmlError(#[from] serde_json::Error);

const FRAME: &str = include_str!("frame.html");
const PAGE: &str = include_str!("page.html");
const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("viewer.js");

/// The text of `report.html`.
///
/// # Errors
/// None in practice: the geometry's description always has a JSON form.
pub fn write(page: &Page) -> Result<String, HtmlError> {
    let report = page.report;
    let main = fill(PAGE, |name| match name {
        "certificate" => words::certificate(report) + &tables::seams(report) + &tables::along(report),
        "warnings" => words::warnings(report),
        "panel_rows" => tables::panels(report),
        "face_rows" => tables::faces(report),
        "skipped" => tables::skipped(report),
        "layout" => tables::layout(page.layout),
        "panel_count" => report.panels.len().to_string(),
        "deviation_png" => image(page.deviation_png),
        _ => String::new(),
    });
    framed(&Frame {
        title: &report.input,
        first: words::first_line(report),
        things: ["panels", "Panels"],
        kicker: "Developable panels".into(),
        badge: words::badge(report),
        figures: words::figures(report),
        surface: true,
        borders: "Seams",
        field: Some("Deviation"),
        limit: words::millimetres(report.tolerance),
        main,
        version: &report.version,
        picture: page.panels_png,
        view: (page.scene, &page.direction, report.tolerance),
    })
}

/// What surrounds the sections of any report: head, figures, 3-D view, foot.
struct Frame<'a> {
    title: &'a str,
    /// What must not be cut, and what is missing, as text; empty if nothing.
    first: String,
    /// What the 3-D view shows: in running text, and as a label.
    things: [&'a str; 2],
    kicker: String,
    /// Of HTML, as are `figures`, `limit` and `main`.
    badge: String,
    figures: String,
    /// Whether there is a surface to compare with.
    surface: bool,
    borders: &'a str,
    /// Name of what the colours mean, if there are any.
    field: Option<&'a str>,
    limit: String,
    main: String,
    version: &'a str,
    /// PNG file for readers without a 3-D view.
    picture: &'a [u8],
    /// Geometry, direction in which it opens, end of the colour scale.
    view: (&'a Scene, &'a Vec3, f64),
}

fn framed(f: &Frame) -> Result<String, HtmlError> {
    let (header, blob) = geometry::pack(f.view.0, f.view.1, f.view.2);
    let header = serde_json::to_string(&header)?;
    let hidden = |there: bool| if there { "" } else { "hidden" };
    Ok(fill(FRAME, |name| match name {
        "first" if f.first.is_empty() => String::new(),
        "first" => format!("<p class=\"stop\" role=\"alert\">{}</p>", escape(&f.first)),
        "title" => escape(f.title),
        "things" => f.things[0].into(),
        "Things" => f.things[1].into(),
        "kicker" => escape(&f.kicker),
        "style" => STYLE.to_string(),
        "script" => SCRIPT.to_string(),
        "badge" => f.badge.clone(),
        "figures" => f.figures.clone(),
        "surface_hidden" => hidden(f.surface).into(),
        "borders" => f.borders.into(),
        "field_hidden" => hidden(f.field.is_some()).into(),
        "field_name" => escape(f.field.unwrap_or("Values")),
        "limit" => f.limit.clone(),
        "main" => f.main.clone(),
        "version" => escape(f.version),
        "panels_png" => image(f.picture),
        "scene" => header.replace('<', "\\u003c"),
        "geometry" => BASE64_STANDARD.encode(&blob),
        _ => String::new(),
    }))
}

/// A PNG file as the address of a picture.
fn image(bytes: &[u8]) -> String {
    format!("data:image/png;base64,{}", BASE64_STANDARD.encode(bytes))
}

/// Replaces each `{{name}}` of a template once; what is put in is not looked at again.
fn fill(template: &str, value: impl Fn(&str) -> String) -> String {
    let mut parts = template.split("{{");
    let mut out = parts.next().unwrap_or_default().to_string();
    for part in parts {
        match part.split_once("}}") {
            Some((name, rest)) => {
                out.push_str(&value(name));
                out.push_str(rest);
            }
            None => out.push_str(part),
        }
    }
    out
}

/// Text for HTML contents and attribute values.
pub(super) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::scene::PanelShape;
    use crate::geom::mesh::Mesh;
    use crate::io::json::tests::sample;

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
        let direction = Vec3::new(1.0, -1.0, 1.0);
        let page = Page { report, scene: &scene, direction, layout: &[], panels_png: &[1, 2], deviation_png: &[3] };
        write(&page).expect("a page")
    }

    #[test]
    fn every_place_of_the_template_is_filled_and_nothing_is_fetched() {
        let text = page(&sample());
        assert!(!text.contains("{{"));
        for unwanted in ["src=\"http", "href=\"http", "url(", "@import"] {
            assert!(!text.contains(unwanted), "{unwanted}");
        }
        assert!(text.contains("0.9877"), "the bound, rounded up");
        // An unknown name in the template would leave an empty place.
        fill(PAGE, |name| {
            let known = "title style script badge figures certificate warnings panel_rows face_rows skipped layout \
                         tolerance panel_count version panels_png deviation_png scene geometry";
            assert!(known.split_whitespace().any(|k| k == name), "{name}");
            String::new()
        });
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
        report.missing = vec!["panel A-01 exceeds the tolerance".into()];
        report.panels[0].certified = false;
        report.panels[0].reason = "distance 1.7 mm".into();
        report.panels[0].deviation_bound = None;
        report.panels[0].witness = Some(crate::io::json::WitnessRecord { uv: [0.25, 0.75], distance: Some(1.7) });
        let text = page(&report);
        for words in ["Not certified", "the tolerance is exceeded", "panel A-01 exceeds", "0.25", "1.7"] {
            assert!(text.contains(words), "{words}");
        }
        assert!(!text.contains("badge good"));
        let body = text.split_once("<body>").map_or("", |b| b.1.trim_start());
        assert!(body.starts_with("<p class=\"stop\" role=\"alert\">Not certified: do not cut A-01"), "{}", &body[..80]);
    }
}
