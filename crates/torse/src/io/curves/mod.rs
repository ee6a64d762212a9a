//! Curves from files, as rails: STEP edges, IGES curves, DXF entities, tables of points. Formats only; the geometry of joining is
//! [`Rail`]'s.

mod blocks;
mod csv;
mod dxf;
mod mtext;
mod options;
mod sketch;

use crate::answer::note::reader::ReaderNote;
use crate::io::iges::read as iges;
use crate::io::step::read as step;
use crate::io::step::read::edges::{self, EdgeCurve};
use crate::io::threedm;
use crate::io::words::note::reader_note;
use crate::spline::curve::Curve;
use crate::torse::rail::{Rail, RailError};
pub(in crate::io) use dxf::frame_of;
use options::Found;
pub use options::{CurveError, CurveOptions};
pub(in crate::io) use sketch::sketch;
pub use sketch::Sketch;

/// Curves of a file with what was not read of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Curves {
    /// The curves, each as long as it goes on.
    pub rails: Vec<Rail>,
    /// What was not read; empty if nothing.
    pub notes: Vec<ReaderNote>,
}

/// Reads one rail. The format is told by the contents: STEP by its header, DXF by its group codes, else a table. Returns
/// the rail with notes of what was not read.
///
/// # Errors
/// See [`CurveError`]; curves that do not join, unless one is selected.
///
/// # Example
/// ```
/// let table = "0,0,0\n10,2,0\n20,3,1\n30,3,3\n";
/// let options = torse::io::curves::CurveOptions { unit: Some(1.0), ..torse::io::curves::CurveOptions::new("keel") };
/// let (rail, notes) = torse::read_curve(table.as_bytes(), &options)?;
/// assert!(rail.length() > 30.0 && notes.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read(bytes: &[u8], options: &CurveOptions) -> Result<(Rail, Vec<ReaderNote>), CurveError> {
    match source(bytes, options)? {
        Source::Points(points) => Ok((points_rail(&points, options)?, Vec::new())),
        Source::Curves(all, notes) => Ok((chosen(all, options)?, notes)),
    }
}

/// Reads all curves of a drawing or a table: those that join end to end are one rail. Of a STEP file, which holds the
/// edges of a whole model, one must be selected.
///
/// # Errors
/// See [`CurveError`].
pub fn read_all(bytes: &[u8], options: &CurveOptions) -> Result<Curves, CurveError> {
    match source(bytes, options)? {
        Source::Points(points) => Ok(Curves { rails: vec![points_rail(&points, options)?], notes: Vec::new() }),
        Source::Curves(all, notes) if step::recognises(bytes) => {
            Ok(Curves { rails: vec![chosen(all, options)?], notes })
        }
        Source::Curves(all, notes) => {
            let all = selected(all, options)?;
            let groups = Rail::chains(&all.into_iter().flat_map(|f| f.curves).collect::<Vec<_>>());
            let name = |k: usize| match groups.len() {
                1 => options.name.clone(),
                _ => format!("{} curve {}", options.name, k + 1),
            };
            let rails = groups.iter().enumerate().map(|(k, g)| Rail::new(&name(k), g)).collect::<Result<_, _>>()?;
            Ok(Curves { rails, notes })
        }
    }
}

/// What a file holds.
enum Source {
    Points(Vec<crate::geom::Vec3>),
    Curves(Vec<Found>, Vec<ReaderNote>),
}

fn points_rail(points: &[crate::geom::Vec3], options: &CurveOptions) -> Result<Rail, RailError> {
    if options.polyline {
        Rail::polyline(&options.name, points)
    } else {
        Rail::through(&options.name, points)
    }
}

/// What may stand before the first word of a file.
const BLANK: [char; 5] = ['\u{feff}', ' ', '\r', '\n', '\t'];

fn source(bytes: &[u8], options: &CurveOptions) -> Result<Source, CurveError> {
    let damaged = |reason: &str| CurveError::Damaged { name: options.name.clone(), reason: reason.into() };
    if step::recognises(bytes) {
        let all = edges::curves(bytes).map_err(|source| CurveError::Step { name: options.name.clone(), source })?;
        return labelled(all, options);
    }
    if iges::recognises(bytes) {
        let all =
            iges::free::curves(bytes).map_err(|source| CurveError::Iges { name: options.name.clone(), source })?;
        return labelled(all, options);
    }
    if threedm::recognises(bytes) {
        let (all, notes) = threedm::free_curves::curves(bytes)
            .map_err(|source| CurveError::ThreeDm { name: options.name.clone(), source })?;
        let found = all.into_iter().map(|c| Found { label: c.label, curves: c.curves }).collect();
        return Ok(Source::Curves(found, notes));
    }
    let text = String::from_utf8_lossy(bytes);
    if is_dxf(text.trim_start_matches(BLANK)) {
        let drawing = dxf::read(&text, options)?;
        let mut notes: Vec<ReaderNote> = not_read(&options.name, &drawing.unread).into_iter().collect();
        if drawing.found.is_empty() {
            return Err(CurveError::Nothing { name: options.name.clone(), unread: notes.first().map(reader_note) });
        }
        let (found, twice) = drawn_once(drawing.found, &options.select);
        let more = twice.len().saturating_sub(1);
        if let Some((again, first)) = twice.into_iter().next() {
            notes.push(ReaderNote::DrawnTwice { file: options.name.clone(), again, first, more });
        }
        return Ok(Source::Curves(found, notes));
    }
    let file = options.name.split('#').next().unwrap_or("").to_ascii_lowercase();
    if bytes.starts_with(b"AutoCAD Binary DXF") {
        return Err(damaged("it is a binary DXF drawing; save it as ASCII DXF"));
    }
    if file.ends_with(".dxf") {
        return Err(damaged("it is no ASCII DXF drawing, whatever its name says"));
    }
    if [".step", ".stp"].iter().any(|e| file.ends_with(e)) {
        return Err(damaged("it is no STEP file, whatever its name says"));
    }
    if [".igs", ".iges"].iter().any(|e| file.ends_with(e)) {
        return Err(damaged("it is no IGES file, whatever its name says"));
    }
    if file.ends_with(".3dm") {
        return Err(damaged("it is no 3DM file, whatever its name says"));
    }
    csv::read(bytes, options).map(Source::Points)
}

/// Share of the largest coordinate by which curves of a drawing that lie on each other may differ.
const SAME_CURVE: f64 = 1e-9;

/// Curves of a drawing (those named, if any are) without copies that lie on an earlier one, either way round, and the names
/// of these copies with those of the earlier ones.
fn drawn_once(all: Vec<Found>, select: &str) -> (Vec<Found>, Vec<(String, String)>) {
    let taken = |f: &Found| select.is_empty() || f.label.eq_ignore_ascii_case(select);
    let largest = all.iter().flat_map(|f| &f.curves).flat_map(|c| c.control.iter().flatten());
    let hair = SAME_CURVE * largest.fold(0.0, |m: f64, x| m.max(x.abs()));
    let near = |a: &Curve<4>, b: &Curve<4>| {
        let place = |(p, q): (&[f64; 4], &[f64; 4])| p.iter().zip(q).all(|(x, y)| (x - y).abs() <= hair);
        let knot = |(x, y): (&f64, &f64)| (x - y).abs() <= SAME_CURVE * x.abs().max(1.0);
        let (s, t) = (a.knots.values(), b.knots.values());
        a.control.len() == b.control.len()
            && s.len() == t.len()
            && a.control.iter().zip(&b.control).all(place)
            && s.iter().zip(t).all(knot)
    };
    let same = |a: &Found, b: &Found| {
        a.curves.len() == b.curves.len()
            && (a.curves.iter().zip(&b.curves).all(|(p, q)| near(p, q))
                || a.curves.iter().zip(b.curves.iter().rev()).all(|(p, q)| near(p, &q.reversed())))
    };
    let (mut kept, mut twice): (Vec<Found>, Vec<(String, String)>) = (Vec::new(), Vec::new());
    for f in all {
        match kept.iter().find(|k| taken(k) && taken(&f) && same(k, &f)) {
            Some(first) => twice.push((f.label, first.label.clone())),
            None => kept.push(f),
        }
    }
    (kept, twice)
}

/// Curves by their numbers.
fn labelled(all: Vec<EdgeCurve>, options: &CurveOptions) -> Result<Source, CurveError> {
    if all.is_empty() {
        return Err(CurveError::Nothing { name: options.name.clone(), unread: None });
    }
    let label = |e: &EdgeCurve| if e.copy > 1 { format!("{}/{}", e.entity, e.copy) } else { e.entity.to_string() };
    let select = options.select.trim_start_matches('#');
    let places = all.iter().filter(|e| e.entity.to_string() == select).count();
    let several = || ReaderNote::SeveralPlaces { file: options.name.clone(), edge: select.into(), places };
    let note = (places > 1).then(several);
    let found = all.into_iter().map(|e| Found { label: label(&e), curves: e.curves }).collect();
    Ok(Source::Curves(found, note.into_iter().collect()))
}

/// Entities of a drawing that were not read.
fn not_read(name: &str, unread: &[(String, usize)]) -> Option<ReaderNote> {
    (!unread.is_empty()).then(|| ReaderNote::NotRead { file: name.into(), kinds: unread.to_vec() })
}

/// Straight lines of a DXF drawing by their ends, in the order of the file, mm, with notes of what else it holds. `unit`
/// is the length of a unit of the drawing in mm; where none is given, what the drawing says, else 1.
///
/// # Errors
/// See [`CurveError`].
pub(crate) fn lines(
    bytes: &[u8],
    name: &str,
    unit: Option<f64>,
) -> Result<(Vec<[crate::geom::Vec3; 2]>, Vec<ReaderNote>), CurveError> {
    let text = String::from_utf8_lossy(bytes);
    if !is_dxf(text.trim_start_matches(BLANK)) {
        return Err(CurveError::Damaged { name: name.into(), reason: "it is no ASCII DXF drawing".into() });
    }
    let named = CurveOptions { name: name.into(), unit, ..CurveOptions::default() };
    let mut guess = None;
    let drawing = match dxf::read(&text, &named) {
        Err(CurveError::NoUnit(_)) => {
            guess = Some(crate::io::cloud::unit_note(name));
            dxf::read(&text, &CurveOptions { unit: Some(1.0), ..named })?
        }
        other => other?,
    };
    let point = |c: &[f64; 4]| crate::geom::Vec3::new(c[0], c[1], c[2]) / c[3];
    let mut notes: Vec<ReaderNote> = not_read(name, &drawing.unread).into_iter().chain(guess).collect();
    let mut out = Vec::new();
    let mut others = 0;
    for f in &drawing.found {
        match &f.curves[..] {
            [one] if one.control.len() == 2 => out.push([point(&one.control[0]), point(&one.control[1])]),
            _ => others += 1,
        }
    }
    if others > 0 {
        notes.push(ReaderNote::NoLines { file: name.into(), curves: others });
    }
    Ok((out, notes))
}

/// DXF files begin with a group code 0 and SECTION, or with comments (code 999).
fn is_dxf(start: &str) -> bool {
    let mut lines = start.lines().map(str::trim);
    matches!((lines.next(), lines.next()), (Some("0"), Some("SECTION")) | (Some("999"), Some(_)))
}

/// The first few names of curves.
fn list(all: &[Found]) -> String {
    const MOST_LISTED: usize = 8;
    let some: Vec<String> = all.iter().take(MOST_LISTED).map(|f| format!("#{}", f.label)).collect();
    if all.is_empty() {
        "no curve".to_owned()
    } else if all.len() > some.len() {
        format!("{} …", some.join(", "))
    } else {
        some.join(", ")
    }
}

/// The curves asked for; all if none is.
fn selected(mut all: Vec<Found>, options: &CurveOptions) -> Result<Vec<Found>, CurveError> {
    let known = list(&all);
    if !options.select.is_empty() {
        all.retain(|f| f.label.eq_ignore_ascii_case(&options.select));
    }
    if all.is_empty() {
        return Err(CurveError::Missing { name: options.name.clone(), select: options.select.clone(), list: known });
    }
    Ok(all)
}

/// The curve asked for, or all of them if they join to one.
fn chosen(all: Vec<Found>, options: &CurveOptions) -> Result<Rail, CurveError> {
    let all = selected(all, options)?;
    if let [one] = &all[..] {
        return Ok(Rail::new(&options.name, &one.curves)?);
    }
    let joined: Vec<_> = all.iter().flat_map(|f| f.curves.iter().cloned()).collect();
    match Rail::new(&options.name, &Rail::chain(&joined)) {
        Err(RailError::Gap { .. }) => Err(CurveError::Several {
            name: options.name.clone(),
            count: all.len(),
            list: list(&all),
            first: all[0].label.clone(),
        }),
        other => Ok(other?),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;

    fn read(bytes: &[u8], options: &CurveOptions) -> Result<Rail, CurveError> {
        super::read(bytes, options).map(|r| r.0)
    }

    fn options() -> CurveOptions {
        CurveOptions { name: "rail".into(), unit: Some(1.0), ..CurveOptions::default() }
    }

    #[test]
    fn tables_need_a_unit_and_numbers() {
        let text = "x,y,z\n0,0,0\n1,2,3\n4,5,6\n";
        let rail = read(text.as_bytes(), &options()).expect("rail");
        assert!((rail.point(1.0) - Vec3::new(4.0, 5.0, 6.0)).norm() < 1e-12);
        let e = read(text.as_bytes(), &CurveOptions { unit: None, ..options() }).expect_err("no unit");
        assert!(e.to_string().contains("--unit"));
        let e = read(b"0 0 0\n1 nan 2\n", &options()).expect_err("nan");
        assert!(e.to_string().contains("line 2"), "{e}");
        let e = read(b"0 0 0\n1 2\n", &options()).expect_err("two numbers");
        assert!(e.to_string().contains("line 2"), "{e}");
        assert!(matches!(read(b"", &options()), Err(CurveError::Rail(RailError::Empty { .. }))));
    }

    #[test]
    fn drawings_give_lines_arcs_polylines_and_splines_in_their_unit() {
        let header = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n5\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n";
        let end = "0\nENDSEC\n0\nEOF\n";
        let o = CurveOptions { unit: None, ..options() };
        let line = "0\nLINE\n5\nA1\n8\nrail\n10\n0\n20\n0\n30\n0\n11\n1\n21\n0\n31\n0\n";
        let arc = "0\nARC\n5\nA2\n8\nrail\n10\n1\n20\n1\n30\n0\n40\n1\n50\n270\n51\n0\n";
        let rail = read(format!("{header}{line}{arc}{end}").as_bytes(), &o).expect("rail");
        // Centimetres; line and arc join with a common tangent.
        assert!((rail.length() - 10.0 * (1.0 + std::f64::consts::FRAC_PI_2)).abs() < 1e-6);
        let poly = "0\nLWPOLYLINE\n5\nB\n8\n0\n90\n3\n70\n0\n38\n2\n10\n0\n20\n0\n42\n1\n10\n2\n20\n0\n10\n4\n20\n0\n";
        let rail = read(format!("{header}{poly}{end}").as_bytes(), &o).expect("rail");
        assert!(
            (rail.length() - 10.0 * (std::f64::consts::PI + 2.0)).abs() < 1e-6
                && (rail.point(0.0).z - 20.0).abs() < 1e-12
        );
        let spline = "0\nSPLINE\n5\nC\n8\n0\n70\n8\n71\n2\n72\n6\n73\n3\n40\n0\n40\n0\n40\n0\n40\n1\n40\n1\n40\n1\n\
                      10\n0\n20\n0\n30\n0\n10\n1\n20\n2\n30\n0\n10\n2\n20\n0\n30\n1\n";
        let rail = read(format!("{header}{spline}{end}").as_bytes(), &o).expect("rail");
        assert!((rail.point(0.5) - Vec3::new(10.0, 10.0, 2.5)).norm() < 1e-9);
        let far = "0\nLINE\n5\nA3\n8\nx\n10\n50\n20\n0\n30\n0\n11\n60\n21\n0\n31\n0\n";
        let e = read(format!("{header}{line}{far}{end}").as_bytes(), &o).expect_err("two curves");
        assert!(matches!(e, CurveError::Several { count: 2, .. }), "{e}");
        let one = CurveOptions { select: "a3".into(), ..o };
        assert!(
            (read(format!("{header}{line}{far}{end}").as_bytes(), &one).expect("rail").length() - 100.0).abs() < 1e-9
        );
    }

    /// A drawing in mm of these entities.
    fn drawing(entities: &str) -> String {
        let header = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n";
        format!("{header}{entities}0\nENDSEC\n0\nEOF\n")
    }

    #[test]
    fn splines_of_fit_points_are_interpolated_and_ellipses_are_read() {
        let o = CurveOptions { unit: None, ..options() };
        let fit = |more: &str, points: &[[f64; 2]]| {
            let points: String = points.iter().map(|p| format!("11\n{}\n21\n{}\n31\n0\n", p[0], p[1])).collect();
            let n = points.matches("11\n").count();
            drawing(&format!("0\nSPLINE\n5\nF\n70\n8\n71\n3\n72\n0\n73\n0\n74\n{n}\n{more}{points}"))
        };
        let row = [[0.0, 0.0], [3.0, 4.0], [8.0, 4.0]];
        let rail = read(fit("", &row).as_bytes(), &o).expect("rail");
        assert!((rail.point(0.5) - Vec3::new(3.0, 4.0, 0.0)).norm() < 1e-9, "{}", rail.point(0.5));
        let rail = read(fit("12\n0\n22\n2\n32\n0\n", &row).as_bytes(), &o).expect("rail");
        let start = rail.point(1e-6) - rail.point(0.0);
        assert!(start.x.abs() < 1e-4 * start.y, "{start}");
        let ellipse = drawing(
            "0\nELLIPSE\n5\nE\n10\n1\n20\n0\n30\n0\n11\n0\n21\n4\n31\n0\n40\n0.5\n41\n0\n42\n3.141592653589793\n",
        );
        let rail = read(ellipse.as_bytes(), &o).expect("rail");
        for (s, x) in [(0.0, [1.0, 4.0]), (0.5, [-1.0, 0.0]), (1.0, [1.0, -4.0])] {
            let p = rail.point(s * rail.pieces.len() as f64);
            assert!((p - Vec3::new(x[0], x[1], 0.0)).norm() < 1e-6, "{p}");
        }
    }

    #[test]
    fn all_curves_of_a_drawing_are_read_and_the_rest_is_named() {
        let o = CurveOptions { unit: None, ..options() };
        let line = |x: f64, y: f64| format!("0\nLINE\n5\nA\n8\nr\n10\n{x}\n20\n0\n11\n{y}\n21\n0\n");
        let text = "0\nTEXT\n1\nhello\n0\nINSERT\n2\nblock\n";
        let all = drawing(&[line(0.0, 1.0), line(5.0, 6.0), text.into(), line(2.0, 1.0)].concat());
        let found = read_all(all.as_bytes(), &o).expect("curves");
        let lengths: Vec<f64> = found.rails.iter().map(Rail::length).collect();
        assert!(
            lengths.len() == 2 && (lengths[0] - 2.0).abs() < 1e-9 && (lengths[1] - 1.0).abs() < 1e-9,
            "{lengths:?}"
        );
        assert!(reader_note(&found.notes[0]).contains("1 TEXT, 1 INSERT; explode blocks"), "{:?}", found.notes);
        let (lines, notes) = lines(all.as_bytes(), "d.dxf", None).expect("lines");
        assert_eq!((lines.len(), notes.len()), (3, 1));
        // Vertices of the frame of a polyline that is smoothed are not on it.
        let vertex = |x: f64, y: f64, flag: i32| format!("0\nVERTEX\n10\n{x}\n20\n{y}\n70\n{flag}\n");
        let smooth = [vertex(0.0, 0.0, 16), vertex(0.0, 0.0, 8), vertex(1.0, 9.0, 16), vertex(4.0, 0.0, 8)].concat();
        let smooth = drawing(&format!("0\nPOLYLINE\n5\nP\n70\n4\n{smooth}0\nSEQEND\n"));
        assert!((read(smooth.as_bytes(), &o).expect("rail").length() - 4.0).abs() < 1e-9);
        // What programs add to a polyline for themselves (groups above 1000) is none of its vertices.
        let own = "1001\nACAD\n1010\n7\n1020\n8\n1030\n9\n1042\n5\n";
        let marked =
            format!("0\nPOLYLINE\n5\nP\n70\n0\n{own}{}{}0\nSEQEND\n", vertex(0.0, 0.0, 0), vertex(3.0, 4.0, 0));
        assert!((read(drawing(&marked).as_bytes(), &o).expect("rail").length() - 5.0).abs() < 1e-9);
        for (entity, reason) in [
            ("0\nLINE\n5\nA\n10\n0\n20\nabc\n11\n1\n21\n0\n", "LINE A: group 20 is 'abc'"),
            ("0\nLINE\n5\nA\n10\n0\n20\n0\n", "group 11 is missing"),
            ("0\nARC\n5\nA\n10\n0\n20\n0\n40\n1\n50\n0\n", "group 51 is missing"),
            ("0\nSPLINE\n5\nS\n71\n3\n74\n3\n11\n0\n21\n0\n31\n0\n", "fit points: 1 of 3"),
            ("0\nSPLINE\n5\nS\n71\n3\n", "too few for a spline"),
            ("0\nCIRCLE\n5\nC\n10\n0\n20\n0\n40\n-5\n", "group 40 is -5; it must be greater"),
        ] {
            let told = read(drawing(entity).as_bytes(), &o).expect_err(reason).to_string();
            assert!(told.contains(reason), "{told}");
        }
        let cut = all.split("0\nENDSEC\n0\nEOF").next().expect("a part");
        assert!(read(&all.as_bytes()[..cut.len()], &o).expect_err("cut").to_string().contains("cut off"));
        let named =
            |name: &str| read(b"", &CurveOptions { name: name.into(), ..options() }).expect_err(name).to_string();
        assert!(named("a.dxf").contains("no ASCII DXF") && named("a.STEP#3").contains("no STEP file"));
    }

    /// A line that is drawn twice, also backwards, joins as if it were drawn once; the copy is named.
    #[test]
    fn what_is_drawn_twice_counts_once() {
        let o = CurveOptions { unit: None, ..options() };
        let line = |handle: &str, p: [f64; 2], q: [f64; 2]| {
            format!("0\nLINE\n5\n{handle}\n8\nr\n10\n{}\n20\n{}\n11\n{}\n21\n{}\n", p[0], p[1], q[0], q[1])
        };
        let corner = [line("A", [0.0, 0.0], [3.0, 0.0]), line("B", [3.0, 0.0], [3.0, 4.0])].concat();
        for copy in [line("C", [3.0, 0.0], [3.0, 4.0]), line("C", [3.0, 4.0], [3.0, 0.0])] {
            let all = drawing(&(corner.clone() + &copy));
            let (rail, notes) = super::read(all.as_bytes(), &o).expect("rail");
            assert!(
                (rail.length() - 7.0).abs() < 1e-9 && reader_note(&notes[0]).contains("#C is drawn over #B"),
                "{notes:?}"
            );
            let one = CurveOptions { select: "C".into(), ..o.clone() };
            assert!((read(all.as_bytes(), &one).expect("rail").length() - 4.0).abs() < 1e-9);
        }
        // A longer one is another line.
        let longer = drawing(&(corner + &line("C", [3.0, 0.0], [3.0, 5.0])));
        assert!(matches!(read(longer.as_bytes(), &o), Err(CurveError::Several { count: 3, .. } | CurveError::Rail(_))));
    }

    #[test]
    fn edges_of_step_files_are_found_by_number() {
        let data = include_bytes!("../../../../../data/cylinder_holes.step");
        let e = read(data, &options()).expect_err("many edges");
        let CurveError::Several { first, .. } = e else { panic!("{e}") };
        let rail = read(data, &CurveOptions { select: first, ..options() }).expect("rail");
        assert!(rail.length() > 1.0);
        let e = read(data, &CurveOptions { select: "999999".into(), ..options() }).expect_err("missing");
        assert!(matches!(e, CurveError::Missing { .. }));
    }
}
