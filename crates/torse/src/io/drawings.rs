//! Cutting drawings of this program read back: DXF and SVG as their writers make them, number for number.

use crate::geom::unit::LengthUnit;
use crate::geom::Vec2;
use crate::patchwork::pattern::BendSense;
use crate::patchwork::written::{WrittenArc, WrittenContour, WrittenJoint, WrittenLine, WrittenPiece};

/// Pieces of a DXF drawing; an outer outline begins a piece.
///
/// # Errors
/// In plain words, with the entity's handle: what the writer would not write.
pub fn dxf(bytes: &[u8]) -> Result<Vec<WrittenPiece>, String> {
    let mut read = Dxf::default();
    read.take(bytes);
    read.end()
}

/// A DXF drawing that comes in stretches: files of many parts are long.
#[derive(Default)]
pub(crate) struct Dxf {
    entities: Entities,
    pieces: Vec<WrittenPiece>,
    fault: Option<String>,
}

impl Dxf {
    /// Reads the next stretch.
    pub fn take(&mut self, bytes: &[u8]) {
        self.read(bytes, false);
    }

    fn read(&mut self, bytes: &[u8], is_last: bool) {
        if self.fault.is_some() {
            return;
        }
        let pieces = &mut self.pieces;
        let one = &mut |e: &[Group]| {
            if is_beside(e) {
                return Ok(());
            }
            extruded(e)?;
            entity(e, pieces)
        };
        self.fault = self.entities.read(bytes, is_last, one).err();
    }

    /// The pieces of all stretches.
    ///
    /// # Errors
    /// As [`dxf`].
    pub fn end(mut self) -> Result<Vec<WrittenPiece>, String> {
        self.read(&[], true);
        let unit = match self.entities.unit.as_deref() {
            Some("4") => LengthUnit::Millimetre,
            Some("1") => LengthUnit::Inch,
            _ => return Err("the unit is neither the millimetre nor the inch".into()),
        };
        if let Some(fault) = self.fault {
            return Err(fault);
        }
        if self.entities.sections == 0 {
            return Err("there are no entities".into());
        }
        self.pieces.iter_mut().for_each(|p| p.unit = unit);
        Ok(self.pieces)
    }
}

/// The first entity of a DXF drawing that another program turned over or tilted: it has a direction of extrusion other than
/// +z, and its coordinates are not those of the drawing. In plain words, with the entity's handle.
pub(crate) fn turned_over(bytes: &[u8]) -> Option<String> {
    let mut found = None;
    let ask = &mut |e: &[Group]| {
        if !is_beside(e) {
            extruded(e).inspect_err(|told| found = Some(told.clone()))?;
        }
        Ok(())
    };
    // What is no drawing at all is told by `dxf`.
    let mut entities = Entities::default();
    _ = entities.read(bytes, false, ask).and_then(|()| entities.read(&[], true, ask));
    found
}

/// A stretch behind what was left of the one before.
fn behind<'a>(rest: &'a mut Vec<u8>, bytes: &'a [u8]) -> &'a [u8] {
    if rest.is_empty() {
        return bytes;
    }
    rest.extend_from_slice(bytes);
    rest
}

/// A group code and its value.
type Group<'a> = (u32, &'a str);
/// What is done with the groups of an entity.
type TakeEntity<'t> = &'t mut dyn FnMut(&[Group]) -> Result<(), String>;

/// The entities of a DXF file that comes in stretches.
#[derive(Default)]
struct Entities {
    /// Text behind the last entity that is known to be whole.
    rest: Vec<u8>,
    /// Value of the unit, if that is an integer.
    unit: Option<String>,
    /// Sections of entities so far.
    sections: usize,
    is_within: bool,
    has_ended: bool,
}

impl Entities {
    /// Hands over the groups, codes and values, of each entity that is whole now; of the last stretch all.
    fn read(&mut self, bytes: &[u8], is_last: bool, take: TakeEntity) -> Result<(), String> {
        let mut rest = std::mem::take(&mut self.rest);
        let all = behind(&mut rest, bytes);
        let whole = if is_last { all.len() } else { all.iter().rposition(|&b| b == b'\n').map_or(0, |k| k + 1) };
        let text = std::str::from_utf8(&all[..whole]).map_err(|e| e.to_string())?;
        let mut groups: Vec<Group> = Vec::new();
        let (mut begin, mut at) = (0, 0);
        let mut lines = text.split_inclusive('\n');
        while let Some(first) = lines.next() {
            let Some(second) = lines.next() else {
                if is_last {
                    return Err("the last group has no value".into());
                }
                break;
            };
            let (code, value) = (first.trim(), second.trim());
            let code = code.parse().map_err(|_| format!("'{code}' is not a group code"))?;
            if code == 0 {
                self.one(&groups, take)?;
                groups.clear();
                begin = at;
            }
            groups.push((code, value));
            at += first.len() + second.len();
        }
        if is_last {
            self.one(&groups, take)?;
            return if self.has_ended { Ok(()) } else { Err("it is cut short".into()) };
        }
        self.rest = all[begin..].to_vec();
        Ok(())
    }

    /// The groups from one zero to the next.
    fn one(&mut self, groups: &[Group], take: TakeEntity) -> Result<(), String> {
        let Some(&first) = groups.first() else { return Ok(()) };
        self.has_ended = groups == [(0, "EOF")] && !self.is_within;
        if self.unit.is_none() {
            let named = groups.iter().skip_while(|g| **g != (9, "$INSUNITS")).nth(1);
            self.unit = named.filter(|g| g.0 == 70).map(|g| g.1.to_owned());
        }
        match first {
            (0, "ENDSEC") => self.is_within = false,
            (0, "EOF") => {}
            (0, "SECTION") if !self.is_within && groups.get(1) == Some(&(2, "ENTITIES")) => {
                (self.is_within, self.sections) = (self.sections == 0, self.sections + 1);
            }
            _ if self.is_within => take(groups)?,
            _ => {}
        }
        Ok(())
    }
}

/// Whether an entity is no part of the pieces: words, and the square by which scales are checked.
fn is_beside(groups: &[Group]) -> bool {
    groups.iter().find(|g| g.0 == 8).is_some_and(|g| matches!(g.1, "TEXT" | "SCALE_CHECK"))
}

/// Refuses an entity whose direction of extrusion is not +z.
fn extruded(groups: &[Group]) -> Result<(), String> {
    let text = |code: u32| groups.iter().find(|g| g.0 == code).map(|g| g.1);
    let number = |code: u32, absent: f64| text(code).map_or(Some(absent), |t| t.parse::<f64>().ok());
    let way = [number(210, 0.0), number(220, 0.0), number(230, 1.0)];
    if matches!(way, [Some(0.0), Some(0.0), Some(z)] if z > 0.0) {
        return Ok(());
    }
    let said = [210, 220, 230].map(|c| text(c).unwrap_or(if c == 230 { "1" } else { "0" })).join(", ");
    Err(format!(
        "{} {} is turned over or tilted by another program: its direction of extrusion is ({said}), not (0, 0, 1); take the \
         drawing as it was written",
        groups[0].1,
        text(5).unwrap_or("")
    ))
}

fn entity(groups: &[Group], out: &mut Vec<WrittenPiece>) -> Result<(), String> {
    let text = |code: u32| groups.iter().find(|g| g.0 == code).map_or("", |g| g.1);
    let (kind, layer, handle) = (groups[0].1, text(8), text(5));
    let fault = |what: &str| format!("{kind} {handle}: {what}");
    let number = |s: &str| s.parse::<f64>().ok().filter(|x| x.is_finite()).ok_or_else(|| fault("a number is damaged"));
    match (kind, layer) {
        ("CIRCLE", "CUT_INNER" | "FORMED") => {
            let centre = Vec2::new(number(text(10))?, number(text(20))?);
            let circle = WrittenContour::Circle { centre, radius: number(text(40))? };
            let piece = out.last_mut().ok_or_else(|| fault("a hole comes before its outline"))?;
            if layer == "FORMED" { &mut piece.formed } else { &mut piece.contours }.push(circle);
            Ok(())
        }
        ("LWPOLYLINE", "CUT_OUTER" | "CUT_INNER" | "FORMED") => {
            let joints = joints(groups, &number, &fault)?;
            if text(70) != "1" || text(90) != joints.len().to_string() {
                return Err(fault("the outline is not closed, or its vertices are not counted"));
            }
            if layer == "CUT_OUTER" {
                out.push(WrittenPiece::default());
            }
            let piece = out.last_mut().ok_or_else(|| fault("a hole comes before its outline"))?;
            let contours = if layer == "FORMED" { &mut piece.formed } else { &mut piece.contours };
            contours.push(WrittenContour::Joints(joints));
            Ok(())
        }
        ("LWPOLYLINE" | "LINE" | "CIRCLE", "MARK_SECTION" | "MARK_CURVE") => {
            let at = |code: u32| -> Result<Vec2, String> { Ok(Vec2::new(number(text(code))?, number(text(code + 10))?)) };
            let joint = |point: Vec2| WrittenJoint { point, arc: WrittenArc::Bulge(0.0) };
            let (line, closed) = match kind {
                "CIRCLE" => (WrittenContour::Circle { centre: at(10)?, radius: number(text(40))? }, true),
                "LINE" => (WrittenContour::Joints(vec![joint(at(10)?), joint(at(11)?)]), false),
                _ => {
                    let joints = joints(groups, &number, &fault)?;
                    let bent = joints.last().is_some_and(|j| j.arc != WrittenArc::Bulge(0.0));
                    let closed = text(70) == "1";
                    if joints.len() < 2 || text(90) != joints.len().to_string() || (bent && !closed) {
                        return Err(fault("the marked line goes on behind its end, or its joints are not counted"));
                    }
                    (WrittenContour::Joints(joints), closed)
                }
            };
            let piece = out.last_mut().ok_or_else(|| fault("a marked line comes before its outline"))?;
            let lines = if layer == "MARK_CURVE" { &mut piece.curves } else { &mut piece.sections };
            lines.push(WrittenLine { line, closed });
            Ok(())
        }
        ("LINE", "BEND_UP" | "BEND_DOWN" | "RULING" | "BEND_EXTENT" | "MARK") => {
            let at =
                |code: u32| -> Result<Vec2, String> { Ok(Vec2::new(number(text(code))?, number(text(code + 10))?)) };
            let line = [at(10)?, at(11)?];
            let piece = out.last_mut().ok_or_else(|| fault("a line comes before its outline"))?;
            let sense = match layer {
                "BEND_UP" => BendSense::Up,
                "BEND_DOWN" => BendSense::Down,
                "RULING" => BendSense::Flat,
                "BEND_EXTENT" => {
                    piece.extents.push(line);
                    return Ok(());
                }
                _ => {
                    piece.marks.push(line);
                    return Ok(());
                }
            };
            piece.rulings.push(line);
            piece.senses.push(sense);
            Ok(())
        }
        _ => Err(fault(
            "there is no such entity in a cutting drawing; parts that are not certified lie on one layer, where outlines and \
             bend lines cannot be told apart",
        )),
    }
}

/// The joints of a polyline.
fn joints(
    groups: &[Group],
    number: &dyn Fn(&str) -> Result<f64, String>,
    fault: &dyn Fn(&str) -> String,
) -> Result<Vec<WrittenJoint>, String> {
    let mut joints: Vec<WrittenJoint> = Vec::new();
    for (code, value) in groups {
        match (code, joints.last_mut()) {
            (10, _) => {
                joints.push(WrittenJoint { point: Vec2::new(number(value)?, f64::NAN), arc: WrittenArc::Bulge(0.0) })
            }
            (20, Some(j)) => j.point.y = number(value)?,
            (42, Some(j)) => j.arc = WrittenArc::Bulge(number(value)?),
            _ => {}
        }
    }
    if joints.iter().any(|j| j.point.y.is_nan()) {
        return Err(fault("a vertex has no second coordinate"));
    }
    Ok(joints)
}

/// Pieces of an SVG drawing; a group whose name begins with `panel-` is a piece.
///
/// # Errors
/// In plain words: what the writer would not write.
pub fn svg(bytes: &[u8]) -> Result<Vec<WrittenPiece>, String> {
    let mut read = Svg::default();
    read.take(bytes);
    read.end()
}

/// An SVG drawing that comes in stretches: files of many parts are long.
#[derive(Default)]
pub(crate) struct Svg {
    /// Text from the last tag on, which may go on.
    rest: Vec<u8>,
    /// Class of the group that holds what comes.
    class: String,
    unit: LengthUnit,
    pieces: Vec<WrittenPiece>,
    has_ended: bool,
    fault: Option<String>,
}

impl Svg {
    /// Reads the next stretch.
    pub fn take(&mut self, bytes: &[u8]) {
        self.read(bytes, false);
    }

    /// The pieces of all stretches.
    ///
    /// # Errors
    /// As [`svg`].
    pub fn end(mut self) -> Result<Vec<WrittenPiece>, String> {
        self.read(&[], true);
        if let Some(fault) = self.fault {
            return Err(fault);
        }
        if !self.has_ended {
            return Err("it is cut short".into());
        }
        self.pieces.iter_mut().for_each(|p| p.unit = self.unit);
        Ok(self.pieces)
    }

    fn read(&mut self, bytes: &[u8], is_last: bool) {
        if self.fault.is_some() {
            return;
        }
        let mut rest = std::mem::take(&mut self.rest);
        let all = behind(&mut rest, bytes);
        // A tag is whole where the next one begins.
        let whole = if is_last { all.len() } else { all.iter().rposition(|&b| b == b'<').unwrap_or(0) };
        self.fault = match std::str::from_utf8(&all[..whole]) {
            Ok(text) => text.split('<').skip(1).try_for_each(|tag| self.tag(tag)).err(),
            Err(e) => Some(e.to_string()),
        };
        if !is_last {
            self.rest = all[whole..].to_vec();
        }
    }

    /// A tag, without the bracket that opens it.
    fn tag(&mut self, tag: &str) -> Result<(), String> {
        let attribute = |name: &str| {
            let rest = tag.split_once(&format!(" {name}=\""))?.1;
            rest.split_once('"').map(|x| x.0)
        };
        self.has_ended = tag.trim_end() == "/svg>";
        if tag.starts_with("svg ") {
            let (width, height, view) = (attribute("width"), attribute("height"), attribute("viewBox"));
            let (Some(w), Some(h), Some(v)) = (width, height, view) else { return Err("it has no size".into()) };
            let units = [LengthUnit::Millimetre, LengthUnit::Inch];
            let fits = |u: &LengthUnit| {
                let sizes = w.strip_suffix(u.sign()).zip(h.strip_suffix(u.sign()));
                sizes.is_some_and(|(w, h)| format!("0 0 {w} {h}") == v)
            };
            self.unit = units.into_iter().find(fits).ok_or("its unit is neither the millimetre nor the inch")?;
        } else if tag.starts_with("g ") {
            self.class = attribute("class").unwrap_or("").to_owned();
            if attribute("id").is_some_and(|id| tag.starts_with("g id=") && !id.is_empty()) {
                self.pieces.push(WrittenPiece::default());
            }
        } else if tag.starts_with("path ") && self.class != "scale-check" {
            let d = attribute("d").ok_or("a path is empty")?;
            let class = self.class.as_str();
            let piece = self.pieces.last_mut().ok_or("a path belongs to no panel")?;
            let line = || -> Result<[Vec2; 2], String> {
                match path(d)?.as_slice() {
                    [a, b] => Ok([a.point, b.point]),
                    _ => Err(format!("'{d}' is not one line")),
                }
            };
            match class {
                "cut-outer" | "cut-inner" => piece.contours.push(closed(path(d)?, d)?),
                "formed" => piece.formed.push(closed(path(d)?, d)?),
                "bend-extent" => piece.extents.push(line()?),
                "bend-up" | "bend-down" | "rulings" => {
                    piece.rulings.push(line()?);
                    piece.senses.push(match class {
                        "bend-up" => BendSense::Up,
                        "bend-down" => BendSense::Down,
                        _ => BendSense::Flat,
                    });
                }
                "mark-section" | "mark-curve" => {
                    let closed = d.ends_with('Z');
                    let line = if closed { self::closed(path(d)?, d)? } else { WrittenContour::Joints(path(d)?) };
                    if matches!(&line, WrittenContour::Joints(joints) if joints.len() < 2) {
                        return Err(format!("'{}' is not a line", d.chars().take(30).collect::<String>()));
                    }
                    let lines = if class == "mark-curve" { &mut piece.curves } else { &mut piece.sections };
                    lines.push(WrittenLine { line, closed });
                }
                "marks" => piece.marks.push(line()?),
                "text" => {}
                other => return Err(format!("there is no class '{other}' in a cutting drawing")),
            }
        }
        Ok(())
    }
}

/// Joints of a closed path: its last place may be the first again.
fn closed(mut joints: Vec<WrittenJoint>, d: &str) -> Result<WrittenContour, String> {
    if !d.ends_with('Z') || joints.len() < 2 {
        return Err(format!("the outline '{}' is not closed", d.chars().take(30).collect::<String>()));
    }
    if joints.last().map(|j| j.point) == joints.first().map(|j| j.point) {
        joints.pop();
    }
    Ok(WrittenContour::Joints(joints))
}

/// Joints of a path of M, L, A and Z, y turned upwards.
fn path(d: &str) -> Result<Vec<WrittenJoint>, String> {
    let fault = || format!("'{}' is not a path of lines and arcs", d.chars().take(30).collect::<String>());
    let mut out: Vec<WrittenJoint> = Vec::new();
    let mut rest = d.trim_end_matches('Z');
    while let Some(command) = rest.chars().next() {
        let body = &rest[command.len_utf8()..];
        let end = body.find(['M', 'L', 'A']).unwrap_or(body.len());
        let numbers: Vec<f64> =
            body[..end].split_whitespace().map(str::parse).collect::<Result<_, _>>().map_err(|_| fault())?;
        rest = &body[end..];
        let &[.., x, y] = numbers.as_slice() else { return Err(fault()) };
        let to = WrittenJoint { point: Vec2::new(x, -y), arc: WrittenArc::Bulge(0.0) };
        match (command, numbers.len(), out.last_mut()) {
            ('M', 2, None) | ('L', 2, Some(_)) => {}
            ('A', 7, Some(from)) if numbers[0].to_bits() == numbers[1].to_bits() => {
                from.arc =
                    WrittenArc::Radius { radius: numbers[0], large: numbers[3] > 0.5, clockwise: numbers[4] > 0.5 };
            }
            _ => return Err(fault()),
        }
        if numbers.iter().any(|n| !n.is_finite()) {
            return Err(fault());
        }
        out.push(to);
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::words::why;

    fn joints(pieces: &[WrittenPiece]) -> usize {
        match &pieces[0].contours[0] {
            WrittenContour::Joints(joints) => joints.len(),
            WrittenContour::Circle { .. } => 0,
        }
    }

    #[test]
    fn vertices_of_outlines_have_two_coordinates() {
        let drawing = |vertices: &str| {
            let outline = format!("0\nLWPOLYLINE\n5\n30\n8\nCUT_OUTER\n90\n2\n70\n1\n{vertices}");
            let head = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n";
            dxf(format!("{head}{outline}0\nENDSEC\n0\nEOF\n").as_bytes())
        };
        assert_eq!(drawing("10\n1\n20\n2\n10\n3\n20\n4\n").map(|p| joints(&p)), Ok(2));
        assert!(drawing("10\n1\n20\n2\n10\n3\n").expect_err("half a point").contains("no second coordinate"));
    }

    #[test]
    fn entities_that_were_turned_over_are_refused_by_name() {
        let drawing = |layer: &str, extrusion: &str| {
            let vertices = "90\n2\n70\n1\n10\n1\n20\n2\n10\n3\n20\n4\n";
            let outline = format!("0\nLWPOLYLINE\n5\n30\n8\nCUT_OUTER\n{vertices}");
            let other = format!("0\nLWPOLYLINE\n5\n3A\n8\n{layer}\n{vertices}{extrusion}");
            let head = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n";
            format!("{head}{outline}{other}0\nENDSEC\n0\nEOF\n").into_bytes()
        };
        let plain = drawing("CUT_INNER", "210\n0.0\n220\n0.0\n230\n1.0\n");
        assert!(dxf(&plain).is_ok() && turned_over(&plain).is_none());
        // Words may lie as they like.
        let words = drawing("TEXT", "230\n-1.0\n");
        assert!(dxf(&words).is_ok() && turned_over(&words).is_none());
        for (extrusion, told) in
            [("210\n0.0\n230\n-1.0\n", "(0.0, 0, -1.0)"), ("210\n1\n", "(1, 0, 1)"), ("230\nx\n", "x)")]
        {
            let bytes = drawing("CUT_INNER", extrusion);
            let fault = dxf(&bytes).expect_err("mirrored");
            assert!(fault.contains("LWPOLYLINE 3A") && fault.contains(told), "{fault}");
            assert_eq!(turned_over(&bytes), Some(fault));
        }
    }

    #[test]
    fn sections_are_read_back_and_moved_or_missing_ones_are_found() {
        use crate::certify::written::drawing as compared;
        use crate::draw::drawing::{drawing, DrawingOptions};
        use crate::io::{dxf as dxf_writer, svg as svg_writer};
        use crate::patchwork::pattern::{Contour, ContourVertex, MarkLine, Pattern};
        let corner = |x: f64, y: f64| ContourVertex { point: Vec2::new(x, y), bulge: 0.0, corner: true };
        let square = vec![corner(0., 0.), corner(200., 0.), corner(200., 90.), corner(0., 90.)];
        let line = [(50.0, 0.0), (60.0, 40.0), (55.0, 90.0)].map(|(x, y)| Vec2::new(x, y));
        let joint = |x: f64, y: f64, bulge: f64| ContourVertex { bulge, ..corner(x, y) };
        let marked = |joints: Vec<ContourVertex>, closed: bool| MarkLine { joints, closed, ..MarkLine::default() };
        let bent = MarkLine::straight("X 500", &line);
        let bent =
            MarkLine { joints: bent.joints.iter().map(|j| ContourVertex { bulge: 0.1, ..*j }).collect(), ..bent };
        let mut bent = bent;
        bent.joints[2].bulge = 0.0;
        let pattern = Pattern {
            name: "A".into(),
            contours: vec![Contour { vertices: square }],
            sections: vec![bent],
            curves: vec![
                MarkLine::straight("", &[Vec2::new(90.0, 10.0), Vec2::new(120.0, 20.0)]),
                marked(vec![joint(130.0, 20.0, 1.0), joint(140.0, 20.0, 1.0)], true),
                marked(vec![joint(150.0, 20.0, -0.3), joint(160.0, 25.0, 0.0), joint(150.0, 40.0, 0.2)], true),
            ],
            area: 18_000.0,
            length: 200.0,
            width: 90.0,
            ..Pattern::default()
        };
        let drawn = drawing(std::slice::from_ref(&pattern), &[], &[], &DrawingOptions::default());
        let a = dxf_writer::write(&drawn).expect("DXF");
        let mut b = Vec::new();
        svg_writer::write(&drawn, &mut b).expect("SVG");
        for pieces in [dxf(&a).expect("DXF"), svg(&b).expect("SVG")] {
            let found = compared(std::slice::from_ref(&pattern), &pieces);
            assert!(found.reason().is_none() && found.bound() < 1e-5, "{:?} {}", found.reason(), found.bound());
            let mut other = pattern.clone();
            other.sections[0].joints[1].point.x += 0.5;
            let off = compared(&[other.clone()], &pieces).bound();
            assert!((0.5..0.6).contains(&off), "{off}");
            let mut flatter = pattern.clone();
            flatter.sections[0].joints[0].bulge = 0.05;
            // Half of the chord times what the bulge is off.
            assert!((compared(&[flatter], &pieces).bound() - 0.5 * 0.05 * 10.0_f64.hypot(40.0)).abs() < 1e-4);
            let mut wider = pattern.clone();
            wider.curves[1].joints[1].point.x += 0.4;
            assert!(compared(&[wider], &pieces).bound() >= 0.2);
            let mut open = pattern.clone();
            open.curves[2].closed = false;
            assert!(compared(&[open], &pieces).reason().is_some());
            other.sections.clear();
            let cut = compared(&[other], &pieces);
            assert!(why(cut.reason().expect("a reason")).contains("sections"));
        }
        // Without its label the drawing has fewer strokes; a closed section is none.
        let bare = Pattern { sections: Vec::new(), ..pattern.clone() };
        let bare = drawing(&[bare], &[], &[], &DrawingOptions::default());
        assert!(bare.pieces[0].strokes().count() + 4 <= drawn.pieces[0].strokes().count());
        let text = String::from_utf8(a).expect("text");
        // A circle, a line, and polylines of lines and arcs; one that was closed by hand is another line.
        let entities =
            |kind: &str, layer: &str| text.split("  0\n").filter(|e| e.starts_with(kind) && e.contains(layer)).count();
        let counts = ["CIRCLE", "LINE", "LWPOLYLINE"].map(|k| entities(k, "MARK_CURVE"));
        assert_eq!((counts, entities("LWPOLYLINE", "MARK_SECTION")), ([1, 1, 1], 1));
        let at = text.rfind("MARK_SECTION").expect("a section");
        let closed = text[..at].to_owned() + &text[at..].replacen(" 70\n     0\n", " 70\n     1\n", 1);
        let closed = dxf(closed.as_bytes()).expect("a drawing");
        assert!(compared(std::slice::from_ref(&pattern), &closed).reason().is_some());
    }

    #[test]
    fn paths_hold_lines_and_arcs_of_finite_numbers() {
        let drawing = |d: &str| {
            let paths = format!("<g id=\"panel-A\">\n<g class=\"cut-outer\">\n<path d=\"{d}\"/>\n</g>\n</g>\n");
            svg(format!("<svg width=\"9mm\" height=\"9mm\" viewBox=\"0 0 9 9\">\n{paths}</svg>\n").as_bytes())
        };
        assert_eq!(drawing("M 1 2 A 3 3 0 0 1 4 5 L 6 7 Z").map(|p| joints(&p)), Ok(3));
        for bad in ["\u{e9} 1 2 L 6 7 Z", "M 1 2 A inf inf 0 0 1 4 5 L 6 7 Z", "M 1 nan L 6 7 Z"] {
            assert!(drawing(bad).expect_err(bad).contains("is not a path of lines and arcs"), "{bad}");
        }
    }
}
