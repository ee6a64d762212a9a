//! The certificate in plain words: what is proven, what is only measured, what needs care.

use super::numbers::{bound_with_unit, given, least_with_unit, millimetres, number, percent, upper};
use super::tables;
use crate::certify::claim::What;
use crate::geom::unit::SQUARE_METRES;
use crate::io::json::{value, FigureRecord, PanelRecord, PartRecord, Report};
use crate::io::markup::escape;
use crate::io::words;
use crate::io::words::numbers::is_endless;
use std::collections::{HashMap, HashSet};
use std::fmt::Write;

/// Bends tighter than this share of the panel's width deserve a look: the sheet turns by more than a radian or so
/// across the panel, and thickness begins to matter.
const TIGHT_BEND: f64 = 0.5;
/// Regression curves nearer than this share of the panel's length: curvature grows quickly towards them.
const NEAR_REGRESSION: f64 = 0.05;
/// Relative length errors of flat patterns above this are worth a warning.
const ISOMETRY_LIMIT: f64 = 1e-6;

/// The first line of the page: what must not be cut, and what is missing; empty if nothing.
pub(super) fn first_line(report: &Report) -> String {
    let mut out = report.do_not_cut(usize::MAX).map_or_else(String::new, |w| format!("Not certified: {w}."));
    if report.panels.iter().all(|p| p.certified) && !report.certified() {
        out += &format!(" Missing: {}.", report.reason.trim_end_matches('.'));
    } else if report.skipped.iter().any(|s| s.entity.is_some()) {
        let items: Vec<String> = report.skipped.iter().filter_map(|s| s.entity).map(|e| format!("#{e}")).collect();
        out += &format!(" Left out of the file, without panels: {}.", items.join(", "));
    }
    out.trim_start().to_owned()
}

/// The status in large letters.
pub(super) fn badge(report: &Report) -> String {
    if report.certified() {
        "<span class=\"badge good\"><span aria-hidden=\"true\">\u{2713}</span> Certified</span>".into()
    } else {
        "<span class=\"badge bad\"><span aria-hidden=\"true\">!</span> Not certified</span>".into()
    }
}

/// The figures of the whole, one by one.
pub(super) fn figures(report: &Report) -> String {
    let group = |f: &FigureRecord| words::join_group(&f.what, f.limit.is_some());
    let mut told = HashSet::new();
    let tile = |f: &FigureRecord| {
        // Of several joins, the worst stand for all.
        let (f, name) = match group(f) {
            None => (f, f.name.clone()),
            Some(like) if !told.insert(like) => return String::new(),
            Some(like) => {
                let all: Vec<&FigureRecord> = report.figures.iter().filter(|o| group(o) == Some(like)).collect();
                let value = |f: &FigureRecord| f.value.unwrap_or(f64::INFINITY);
                let worst = all.iter().copied().max_by(|a, b| value(a).total_cmp(&value(b))).unwrap_or(f);
                (worst, words::joins_name(like, all.len(), &worst.name))
            }
        };
        let unit =
            if f.unit.is_empty() || f.value.is_none() { String::new() } else { format!("&nbsp;{}", escape(&f.unit)) };
        let note = if f.basis == "given" { "" } else { f.basis.as_str() };
        format!("<div><dt>{}</dt><dd>{}{unit}<small>{note}</small></dd></div>", escape(&name), tables::number(f))
    };
    report.figures.iter().map(tile).collect()
}

/// The figures of a cover.
pub(super) fn cover_figures(report: &Report) -> String {
    let mut out = String::new();
    let mut item = |name: &str, value: String, note: String| {
        let _ = write!(out, "<div><dt>{name}</dt><dd>{value}<small>{note}</small></dd></div>");
    };
    let bound = value(&report.figures, What::Deviation);
    let above = bound.is_none_or(|b| b > report.tolerance);
    let distance = bound_with_unit(bound);
    item(
        "Largest distance",
        if above { format!("<span class=\"no\">{distance}</span>") } else { distance },
        format!("tolerance {}", given(report.tolerance)),
    );
    let faces = match report.faces.len() {
        1 => "1 face".into(),
        n => format!("{n} faces"),
    };
    item("Panels", report.panels.len().to_string(), format!("on {faces}"));
    let (share, of) = match report.skipped.iter().any(|s| s.area_estimate.is_none()) {
        true => (format!("&lt;&nbsp;{}", percent(coverage(report))), "of the area of the faces; some are unknown"),
        false => (percent(coverage(report)), "of the area of the faces"),
    };
    item("Covered", share, of.into());
    let gap = value(&report.figures, What::SeamGap);
    if !(report.seams.is_empty() && gap == Some(0.0)) {
        item("Seam gap", bound_with_unit(gap), "at most, between neighbours".into());
    }
    let radius = least(report, |p| value(&p.figures, What::BendRadius)).filter(|(r, _)| !is_endless(*r));
    item(
        "Tightest bend",
        radius.map_or_else(|| "\u{2014}".into(), |(r, _)| least_with_unit(r)),
        radius.map_or_else(|| "all panels plane".into(), |(_, p)| format!("radius, panel {}", escape(&p.name))),
    );
    let flat: f64 = report.parts.iter().filter_map(|p| p.flat_area).sum();
    item(
        "Sheet",
        format!("{}&nbsp;m\u{b2}", number(flat * SQUARE_METRES)),
        format!("net; made in {} s", number(report.seconds)),
    );
    out
}

/// The certificate as paragraphs and lists.
pub(super) fn certificate(report: &Report) -> String {
    let mut out = String::new();
    let tolerance = given(report.tolerance);
    if report.certified() {
        let _ = write!(
            out,
            "<p class=\"lead\">Every point of every face lies within <b>{bound}</b> of the panels, and every point of \
             the panels lies within <b>{bound}</b> of the surface. You asked for {tolerance}. This is proven, not \
             sampled.</p>",
            bound = bound_with_unit(value(&report.figures, What::Deviation)),
        );
    } else {
        let _ = write!(
            out,
            "<p class=\"lead\">This result is <b>not certified</b> for the tolerance of {tolerance}: {}. The files were \
             written so that you can look; do not rely on the tolerance.</p>",
            escape(report.reason.trim_end_matches('.')),
        );
    }
    let _ = write!(out, "<div class=\"columns\">{}{}</div>", proven(report), unproven(report));
    out
}

/// What interval arithmetic has shown.
fn proven(report: &Report) -> String {
    let mut items = Vec::new();
    let bad = report.panels.iter().filter(|p| !p.certified).count();
    let good = report.panels.len() - bad;
    if let Some(bound) = value(&report.figures, What::Deviation) {
        let within = if bound <= report.tolerance { "within the tolerance" } else { "<b>above the tolerance</b>" };
        items.push(format!(
            "<b>Distance</b> between the trimmed faces and the panels as written to <code>panels.step</code>, in both \
             directions, rounding included: at most {}, {within}.",
            bound_with_unit(Some(bound)),
        ));
    }
    if bad > 0 {
        items.push(format!("<b>{good} of {} panels</b> are certified one by one; see the table.", report.panels.len()));
    }
    // Of panels that are not certified these numbers may be unknown.
    let scope = if bad > 0 { "of the certified panels: " } else { "" };
    if let Some((angle, panel)) = most(report, |p| value(&p.figures, What::Twist).filter(|_| p.certified)) {
        items.push(format!(
            "<b>Developability:</b> {scope}along no ruling does the tangent plane turn by more than {}\u{b0} (panel \
             {}); an exactly developable surface has 0.",
            upper(Some(angle)),
            escape(&panel.name),
        ));
    }
    let clearance =
        |p: &PanelRecord| value(&p.figures, What::RegressionClearance).filter(|x| p.certified && !is_endless(*x));
    match least(report, clearance) {
        Some((clearance, panel)) => items.push(format!(
            "<b>Regularity:</b> {scope}none comes nearer than {}, measured along its rulings, to its curve of \
             regression, where a developable surface has a sharp edge (nearest: panel {}).",
            least_with_unit(clearance),
            escape(&panel.name),
        )),
        None if bad == 0 && good > 0 => {
            items.push("<b>Regularity:</b> no panel has a curve of regression (planes and cylinders only).".into());
        }
        None => {}
    }
    // Without seams there is nothing to say of them.
    if let Some(gap) = value(&report.figures, What::SeamGap).filter(|_| !report.seams.is_empty()) {
        items.push(format!(
            "<b>Seams:</b> the two sides of a seam are nowhere more than {} apart; {} of {} seams are exact, with \
             one common edge.",
            bound_with_unit(Some(gap)),
            report.seams.iter().filter(|s| s.joint == "exact").count(),
            report.seams.len(),
        ));
    }
    if coverage(report) >= 1.0 {
        items.push("<b>Coverage:</b> the regions of the panels add up to the faces, without holes or overlaps.".into());
    }
    if let (Some(strain), Some(off)) = (flat(report, |p| p.strain_bound), flat(report, |p| p.drawing_bound)) {
        items.push(format!(
            "<b>Flat patterns:</b> no length on a flat part differs from that on its panel by more than {} of it; outlines, rulings and marks as drawn are nowhere more than {} from where they belong.",
            upper(Some(strain)),
            bound_with_unit(Some(off)),
        ));
    }
    if !report.written.is_empty() && report.written.iter().all(|w| w.written_bound.is_some()) {
        let names: Vec<String> = report.written.iter().map(|w| format!("<code>{}</code>", escape(&w.file))).collect();
        let most = report.written.iter().filter_map(|w| w.written_bound).fold(0.0, f64::max);
        items.push(format!(
            "<b>Files:</b> {} were read back; they hold what was judged, to {}.",
            names.join(", "),
            bound_with_unit(Some(most)),
        ));
    }
    let trims: Option<Vec<f64>> = report.faces.iter().map(|f| f.trim_bound).collect();
    if let Some(trim) = trims.and_then(|t| t.into_iter().reduce(f64::max)) {
        items.push(format!(
            "<b>Edges of the file:</b> the trims that were used keep to them within {}, which is part of the distance.",
            bound_with_unit(Some(trim)),
        ));
    }
    if items.is_empty() {
        items.push("Nothing.".into());
    }
    format!("<div>{}</div>", list("Proven for every point", "proven", &items))
}

/// The largest of a proven number of flat parts, if there are parts and every one has it.
fn flat(report: &Report, value: impl Fn(&PartRecord) -> Option<f64>) -> Option<f64> {
    let all: Option<Vec<f64>> = report.parts.iter().map(value).collect();
    all?.into_iter().reduce(f64::max)
}

/// The largest of a measured number of flat parts that have no proof.
fn unproven_flat(report: &Report, value: impl Fn(&PartRecord) -> Option<f64>) -> Option<f64> {
    let parts = report.parts.iter().filter(|p| p.strain_bound.is_none() || p.drawing_bound.is_none());
    parts.filter_map(value).reduce(f64::max)
}

/// Share of the faces that is covered.
fn coverage(report: &Report) -> f64 {
    report.coverage.unwrap_or(0.0)
}

/// What is missing, and what was only measured.
fn unproven(report: &Report) -> String {
    // What panels say of themselves follows one by one.
    let mut missing: Vec<String> = report.beside_panels.iter().map(|o| escape(o)).collect();
    for panel in report.panels.iter().filter(|p| !p.certified) {
        // The reason tells the place.
        let face = panel.face.map(|f| tables::face_name(report, f)).filter(|name| !name.is_empty());
        let on = face.map_or_else(String::new, |name| format!(" on face {}", escape(&name)));
        missing.push(format!("Panel {}{on}: {}", link(panel, report), escape(&panel.reason)));
    }
    if coverage(report) < 1.0 {
        missing.push(format!("The panels cover {} of the area of the faces.", percent(coverage(report))));
    }
    if !report.skipped.is_empty() {
        missing.push(format!(
            "{} of the file left out, see <a href=\"#faces\">Faces</a>.",
            match report.skipped.len() {
                1 => "1 face or item is".to_string(),
                n => format!("{n} faces or items are"),
            }
        ));
    }
    let mut measured = Vec::new();
    if let Some(error) = unproven_flat(report, |p| p.isometry_error) {
        measured.push(format!("Flat patterns keep lengths to {} (largest relative error measured).", number(error)));
    }
    if let Some(error) = unproven_flat(report, |p| p.contour_error) {
        measured
            .push(format!("Lines and arcs of the flat outlines follow the exact outlines to {}.", millimetres(error)));
    }
    let replaced = || report.faces.iter().filter(|f| f.surface_deviation_estimate.is_none_or(|seen| seen > 0.0));
    let surface = replaced().filter_map(|f| f.surface_bound).fold(0.0, f64::max);
    if surface > 0.0 {
        measured.push(format!(
            "Surfaces of the file were replaced by splines; how far these are from them, at most {} (proven), is part of every bound.",
            millimetres(surface),
        ));
    }
    let seen = replaced().filter(|f| f.surface_bound.is_none()).filter_map(|f| f.surface_deviation_estimate);
    if let Some(seen) = seen.reduce(f64::max) {
        measured.push(format!(
            "Surfaces of the file were replaced by splines of which nothing is proven; at samples they agree to {}.",
            millimetres(seen),
        ));
    }
    let joined: usize = report.faces.iter().map(|f| f.joined.len()).sum();
    if joined > 0 {
        let moved = report.faces.iter().map(|f| f.joint_bound).fold(0.0, f64::max);
        measured.push(format!(
            "{joined} faces of the file go on smoothly across common edges (angles measured at samples) and were covered as {}; \
             what joining moved, at most {}, is part of every bound.",
            report.faces.iter().filter(|f| !f.joined.is_empty()).count(),
            bound_with_unit(Some(moved)),
        ));
    }
    measured.push("Thickness, spring-back and cutting width of the real sheet are not part of this report.".into());
    let mut out = String::from("<div>");
    if !missing.is_empty() {
        out.push_str(&list("Not proven", "missing", &missing));
    }
    out.push_str(&list("Measured, not proven", "", &measured));
    out + "</div>"
}

/// Things to look at before cutting.
pub(super) fn warnings(report: &Report) -> String {
    const MOST_NAMED: usize = 12;
    let mut items = Vec::new();
    let mut warn = |found: Vec<String>, words: &str| {
        let more =
            if found.len() > MOST_NAMED { format!(" and {} more", found.len() - MOST_NAMED) } else { String::new() };
        if !found.is_empty() {
            items.push(format!("{words}: {}{more}.", found[..found.len().min(MOST_NAMED)].join(", ")));
        }
    };
    let of: HashMap<&str, &PartRecord> =
        report.parts.iter().flat_map(|part| part.panels.iter().map(move |name| (name.as_str(), part))).collect();
    let panels = |test: &dyn Fn(&PanelRecord, &PartRecord) -> Option<bool>| -> Vec<String> {
        let bad =
            |panel: &&PanelRecord| of.get(panel.name.as_str()).and_then(|part| test(panel, part)).unwrap_or(false);
        report.panels.iter().filter(bad).map(|p| link(p, report)).collect()
    };
    let parts = |test: &dyn Fn(&PartRecord) -> Option<bool>| -> Vec<String> {
        report.parts.iter().filter(|p| test(p).unwrap_or(false)).map(|p| escape(&p.name)).collect()
    };
    warn(
        panels(&|panel, part| Some(value(&panel.figures, What::BendRadius)? < TIGHT_BEND * part.width?)),
        "Tight bends (radius below half the part's width); check them against sheet thickness",
    );
    warn(
        panels(&|panel, part| Some(value(&panel.figures, What::RegressionClearance)? < NEAR_REGRESSION * part.length?)),
        "Close to the curve of regression, where bending becomes sharp",
    );
    warn(
        parts(&|p| Some(p.isometry_error? > ISOMETRY_LIMIT)),
        "Flat pattern with a relative length error above one in a million",
    );
    warn(parts(&|p| Some(p.flat_area.is_none())), "Without flat pattern");
    if items.is_empty() {
        return String::new();
    }
    format!("<section class=\"card warn\"><h2>Before you cut</h2><ul>{}</ul></section>", bullets(&items))
}

/// The result of a job that covers no faces, in words.
pub(super) fn result(report: &Report) -> String {
    let lead = if report.certified() {
        format!(
            "The result meets the tolerance of {}. Figures marked <i>proven</i> hold for every point, those marked \
             <i>measured</i> for samples.",
            given(report.tolerance)
        )
    } else {
        format!(
            "This result is <b>not certified</b>: {}. The files were written so that you can look.",
            escape(report.reason.trim_end_matches('.'))
        )
    };
    format!("<p class=\"lead\">{lead}</p>") + &tables::skipped(report) + &tables::notes(report)
}

fn link(panel: &PanelRecord, report: &Report) -> String {
    let index = report.panels.iter().position(|p| std::ptr::eq(p, panel)).unwrap_or(0);
    format!("<a href=\"#panel-{index}\" data-pick=\"{index}\">{}</a>", escape(&panel.name))
}

fn most(report: &Report, value: impl Fn(&PanelRecord) -> Option<f64>) -> Option<(f64, &PanelRecord)> {
    report.panels.iter().filter_map(|p| Some((value(p)?, p))).max_by(|a, b| a.0.total_cmp(&b.0))
}

fn least(report: &Report, value: impl Fn(&PanelRecord) -> Option<f64>) -> Option<(f64, &PanelRecord)> {
    report.panels.iter().filter_map(|p| Some((value(p)?, p))).min_by(|a, b| a.0.total_cmp(&b.0))
}

fn list(title: &str, class: &str, items: &[String]) -> String {
    format!("<h3>{title}</h3><ul class=\"{class}\">{}</ul>", bullets(items))
}

fn bullets(items: &[String]) -> String {
    items.iter().map(|i| format!("<li>{i}</li>")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::json::tests::{sample, set};

    #[test]
    fn of_several_joins_the_worst_stand_for_all() {
        let mut report = sample();
        let figure = report.figures[0].clone();
        let join = |what: &str, k: usize, value: Option<f64>, limit: Option<f64>| FigureRecord {
            what: what.into(),
            name: format!("{what} {k}"),
            value,
            limit,
            ..figure.clone()
        };
        report.figures = (0..3).map(|k| join("join_gap", k, Some(0.25 * k as f64), Some(1.0))).collect();
        report.figures.push(join("join_angle", 0, Some(2.5), None));
        report.figures.push(join("join_angle", 1, Some(0.01), Some(0.1)));
        let shown = figures(&report);
        assert_eq!(shown.matches("<dt>").count(), 3, "{shown}");
        assert!(shown.contains("largest gap, 3 joins</dt><dd>0.5") && shown.contains("join_angle 1"), "{shown}");
        // What is not known is the worst.
        report.figures[0].value = None;
        assert!(!figures(&report).contains("0.5"));
    }

    #[test]
    fn warnings_name_the_panels_concerned_and_only_those() {
        let mut report = sample();
        assert_eq!(warnings(&report), "");
        set(&mut report.panels[1].figures, What::BendRadius, Some(12.0));
        let text = warnings(&report);
        assert!(text.contains("A-02") && !text.contains("A-01"));
    }

    #[test]
    fn nothing_is_claimed_for_panels_that_are_not_certified() {
        let mut report = sample();
        report.panels[1].certified = false;
        set(&mut report.panels[1].figures, What::Twist, None);
        set(&mut report.panels[1].figures, What::RegressionClearance, None);
        let text = proven(&report);
        assert_eq!(text.matches("of the certified panels").count(), 2);
        report.panels[0].certified = false;
        assert!(!proven(&report).contains("Regularity"));
    }

    #[test]
    fn seams_are_told_of_where_there_are_some() {
        let mut report = sample();
        assert!(proven(&report).contains("Seams") && cover_figures(&report).contains("Seam gap"));
        report.seams.clear();
        set(&mut report.figures, What::SeamGap, Some(0.0));
        assert!(!proven(&report).contains("Seams") && !cover_figures(&report).contains("Seam gap"));
        // That a gap is not known is told all the same.
        set(&mut report.figures, What::SeamGap, None);
        assert!(cover_figures(&report).contains("Seam gap"));
    }

    #[test]
    fn nothing_is_claimed_of_flat_parts_that_are_not_there() {
        let mut report = sample();
        assert!(proven(&report).contains("Flat patterns"));
        report.parts[0].strain_bound = None;
        assert!(!proven(&report).contains("Flat patterns"));
        report.parts.clear();
        assert!(!proven(&report).contains("Flat patterns"));
    }

    #[test]
    fn a_bound_above_the_tolerance_is_called_so() {
        let mut report = sample();
        report.status = "uncertified".into();
        set(&mut report.figures, What::Deviation, Some(1.5));
        let text = certificate(&report);
        assert!(text.contains("above the tolerance") && !text.contains("This is proven"));
    }
}
