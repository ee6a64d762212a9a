//! `report.html` of jobs that make strips: the same page, style and 3-D view as the main job's.

use super::tables::{self, exponent};
use super::words::plain;
use super::{escape, fill, framed, image, Frame, HtmlError};
use crate::answer::sheets::FieldMeaning;
use crate::draw::colour;
use crate::draw::flat::FlatPiece;
use crate::draw::scene::{titled, Scene};
use crate::geom::Vec3;
use crate::io::sheets::{FigureRecord, Report, UNKNOWN};
use crate::torse::form::PanelKind;
use std::fmt::Write;

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
    /// PNG file: strips with rulings.
    pub panels_png: &'a [u8],
    /// What the colours mean, and the PNG file of them, if there are any.
    pub field: Option<(&'a FieldMeaning, &'a [u8])>,
    /// PNG file: measured points coloured by their values, with the number of points outside it, if there are any.
    pub points: Option<(&'a [u8], usize)>,
    /// PNG file: strips coloured by shape, if shapes are known.
    pub shapes_png: Option<&'a [u8]>,
    /// End of the colour scale.
    pub limit: f64,
}

const PAGE: &str = include_str!("sheets.html");

/// The text of `report.html`.
///
/// # Errors
/// None in practice: the geometry's description always has a JSON form.
pub fn write(page: &Page) -> Result<String, HtmlError> {
    let report = page.report;
    let field = page.field.map(|(m, png)| {
        let mean = if page.points.is_some() { "Mean " } else { "" };
        format!(
            "<section class=\"card\" id=\"field\"><h2>{mean}{name}</h2><img src=\"{}\" alt=\"Map: {name}\"></section>",
            image(png),
            name = escape(&m.name),
        )
    });
    let points = page.points.map(|p| points(report, p, page.limit));
    let meaning = page.field.map(|f| f.0);
    let main = fill(PAGE, |name| match name {
        "words" => words(report),
        "strip_heads" => heads(report),
        "strip_rows" => report.strips.iter().enumerate().map(|(i, _)| row(i, report)).collect(),
        "strip_count" => match report.strips.len() {
            1 => "1 strip".into(),
            n => format!("{n} strips"),
        },
        "part_rows" => parts(report),
        "shapes" => shapes(report, page.shapes_png.map(image)),
        "layout" => tables::layout(page.layout),
        "points" => points.clone().unwrap_or_default(),
        "field" => field.clone().unwrap_or_default(),
        _ => String::new(),
    });
    framed(&Frame {
        title: &report.input,
        first: report.do_not_cut(usize::MAX).map_or_else(String::new, |w| format!("Not certified: {w}.")),
        things: ["strips", "Strips"],
        kicker: format!("Developable strips: {}", report.job),
        badge: badge(report),
        figures: report.figures.iter().map(tile).collect(),
        surface: false,
        borders: "Borders",
        field: meaning.map(|m| m.name.as_str()),
        limit: format!("{}&nbsp;{}", plain(page.limit, 4), meaning.map_or_else(String::new, |m| escape(&m.unit))),
        main,
        version: &report.version,
        picture: page.panels_png,
        view: (page.scene, &page.direction, page.limit),
    })
}

/// Map of the measured points, with the worst of them in words.
fn points(report: &Report, (png, outside): (&[u8], usize), limit: f64) -> String {
    let mut words = format!(
        "Every measured point with its own distance from the strips; points beyond {}&nbsp;mm are larger and magenta.",
        plain(limit, 4)
    );
    if let Some(w) = &report.worst_point {
        let place = w.place.map(|x| plain(x, 7)).join(", ");
        let far = w.deviation.map_or_else(|| "infinitely".into(), |d| format!("{}&nbsp;mm", plain(d.abs(), 4)));
        let _ = write!(words, " The farthest is point {} at ({place}), {far} away.", w.index);
    }
    if outside > 0 {
        let (s, lie) = if outside == 1 { ("", "lies") } else { ("s", "lie") };
        let _ = write!(words, " {outside} point{s} {lie} outside the picture.");
    }
    format!(
        "<section class=\"card\" id=\"points\"><h2>Measured points</h2><p class=\"quiet\">{words} All values are in \
         <code>deviation.ply</code>.</p><img src=\"{}\" alt=\"Map of the measured points\"></section>",
        image(png)
    )
}

fn badge(report: &Report) -> String {
    let (class, sign, words) =
        if report.certified() { ("good", "\u{2713}", "Certified") } else { ("bad", "!", "Not certified") };
    format!("<span class=\"badge {class}\"><span aria-hidden=\"true\">{sign}</span> {words}</span>")
}

/// A number for people, with powers of ten where it is tiny.
fn number(f: &FigureRecord) -> String {
    match f.value {
        None if f.basis == UNKNOWN => "unknown".into(),
        None => "\u{221e}".into(),
        Some(x) if x != 0.0 && x.abs() < 1e-3 => {
            if x < 0.0 {
                format!("\u{2212}{}", exponent(-x))
            } else {
                exponent(x)
            }
        }
        Some(x) => plain(x, 6),
    }
}

fn tile(f: &FigureRecord) -> String {
    let unit = if f.unit.is_empty() { String::new() } else { format!("&nbsp;{}", escape(&f.unit)) };
    let note = if f.basis == "given" { "" } else { f.basis.as_str() };
    format!("<div><dt>{}</dt><dd>{}{unit}<small>{note}</small></dd></div>", escape(&f.name), number(f))
}

fn words(report: &Report) -> String {
    let mut out = String::new();
    if report.certified() {
        let _ = write!(
            out,
            "<p class=\"lead\">The result meets the tolerance of {}&nbsp;mm. Figures marked <i>proven</i> hold for every \
             point, those marked <i>measured</i> for samples.</p>",
            plain(report.tolerance, 4)
        );
    } else {
        let _ = write!(
            out,
            "<p class=\"lead\">This result is <b>not certified</b>: {}. The files were written so that you can look.</p>",
            escape(report.reason.trim_end_matches('.'))
        );
    }
    let list = |title: &str, items: &[String]| {
        if items.is_empty() {
            return String::new();
        }
        let items: String = items.iter().map(|i| format!("<li>{}</li>", escape(i))).collect();
        format!("<h3>{title}</h3><ul>{items}</ul>")
    };
    out + &list("Notes", &report.notes) + &list("Left out", &report.skipped)
}

fn heads(report: &Report) -> String {
    let figures = report.strips.first().map_or(&[][..], |s| &s.figures[..]);
    figures
        .iter()
        .map(|f| {
            let unit = if f.unit.is_empty() { String::new() } else { format!(" ({})", escape(&f.unit)) };
            format!("<th><button type=\"button\" title=\"{}\">{}{unit}</button></th>", f.basis, escape(&f.name))
        })
        .collect()
}

fn row(index: usize, report: &Report) -> String {
    let strip = &report.strips[index];
    let mut row = format!("<tr id=\"panel-{index}\" data-panel=\"{index}\" tabindex=\"0\">");
    let swatch = colour::hex(colour::shown(index, !strip.certified));
    let name = escape(&titled(&strip.name, !strip.certified));
    let _ = write!(
        row,
        "<td class=\"name\" data-value=\"{name}\"><i style=\"background:{swatch}\"></i>{name}</td>\
         <td data-value=\"{kind}\">{kind}</td>",
        kind = escape(&strip.kind)
    );
    for f in &strip.figures {
        let key = f.value.map_or_else(|| "Infinity".to_string(), |x| format!("{x:e}"));
        let _ = write!(row, "<td class=\"number\" data-value=\"{key}\">{}</td>", number(f));
    }
    row + "</tr>"
}

/// Picture and table of the shapes along each part; nothing if there are none.
fn shapes(report: &Report, picture: Option<String>) -> String {
    if report.shapes.is_empty() {
        return String::new();
    }
    let swatch = |name: &str| {
        let kind = match name {
            "plane" => PanelKind::Plane,
            "cylinder" => PanelKind::Cylinder,
            "cone" => PanelKind::Cone,
            _ => PanelKind::Torse,
        };
        colour::hex(colour::kind(kind))
    };
    let mut rows = String::new();
    for s in &report.shapes {
        let vector = s.vector.map_or_else(|| "\u{2014}".to_string(), |v| v.map(|x| plain(x, 5)).join(", "));
        let doubt = if s.ambiguous { "noise may hide another" } else { "" };
        let strips = if s.first == s.last {
            escape(&s.first)
        } else {
            format!("{}&nbsp;… {}", escape(&s.first), escape(&s.last))
        };
        let _ = write!(
            rows,
            "<tr><td>{}</td><td class=\"name\"><i style=\"background:{}\"></i>{}</td><td>{strips}</td>\
             <td class=\"number\">{}</td><td class=\"number\">{vector}</td><td class=\"number\">{}</td><td>{doubt}</td></tr>",
            escape(&s.part),
            swatch(&s.shape),
            escape(&s.shape),
            plain(s.turn, 4),
            exponent(s.residual),
        );
    }
    let picture = picture.map_or_else(String::new, |p| format!("<img src=\"{p}\" alt=\"Strips coloured by shape\">"));
    format!(
        "<section class=\"card\" id=\"shapes\"><h2>Shapes</h2><p class=\"quiet\">What each part consists of, told from its \
         tangent planes (measured). The vector is the normal of a plane, the direction of a cylinder, the apex of a cone in \
         mm.</p>{picture}<div class=\"scroll\"><table><thead><tr><th>Part</th><th>Shape</th><th>Strips</th>\
         <th class=\"number\">Turn (°)</th><th class=\"number\">Vector</th><th class=\"number\">Residual</th><th>Doubt</th></tr></thead>\
         <tbody>{rows}</tbody></table></div></section>"
    )
}

fn parts(report: &Report) -> String {
    let cell = |x: Option<f64>, unit: f64| x.map_or_else(|| "\u{2014}".to_string(), |x| plain(x * unit, 6));
    report
        .parts
        .iter()
        .map(|p| {
            let error = p.isometry_error.map_or_else(|| "\u{2014}".into(), exponent);
            format!(
                "<tr><td>{}</td><td>{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td>\
                 <td class=\"number\">{}</td><td class=\"number\">{}</td><td class=\"number\">{error}</td>\
                 <td class=\"number\">{}</td><td>{}</td></tr>",
                escape(&titled(&p.name, !p.certified)),
                p.strips.len(),
                cell(p.length, 1.0),
                cell(p.width, 1.0),
                cell(p.flat_area, 1e-6),
                cell(p.area, 1e-6),
                cell(p.contour_error, 1.0),
                escape(&p.missing),
            )
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answer::presentation::present_sheets;
    use crate::io::sheets::tests::sample;

    #[test]
    fn the_page_is_filled_and_names_cannot_become_markup() {
        let sheets = sample();
        let shown = present_sheets(&sheets);
        let page = Page {
            report: &Report::of(&sheets, &shown),
            scene: &shown.scene,
            direction: shown.direction,
            layout: &shown.pieces,
            panels_png: &[1],
            field: Some((&sheets.meaning, &[2])),
            points: Some((&[4], 1)),
            shapes_png: Some(&[3]),
            limit: 0.2,
        };
        let text = write(&page).expect("a page");
        assert!(!text.contains("{{") && !text.contains("plate <1>") && text.contains("plate &lt;1&gt;"));
        assert!(text.contains("a &amp; b") && text.contains("A-02"));
        assert!(text.contains("point 1 at (40, 20, 9), 9&nbsp;mm away. 1 point lies outside"), "{text}");
        for unwanted in ["src=\"http", "href=\"http", "url(", "@import"] {
            assert!(!text.contains(unwanted), "{unwanted}");
        }
    }
}
