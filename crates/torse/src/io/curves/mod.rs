//! Curves from files, as rails: STEP edges, DXF entities, tables of points. Formats only; the geometry of joining is
//! [`Rail`]'s.

mod csv;
mod dxf;

use crate::io::step::read::{edges, ReadError};
use crate::torse::rail::{Rail, RailError};

/// What the reader is told besides the bytes.
#[derive(Clone, Debug, Default)]
pub struct CurveOptions {
    /// Name of the rail, for messages.
    pub name: String,
    /// Which curve of the file: entity number of a STEP file (`12/2` where an assembly has it a second time), layer or
    /// handle of a DXF file; empty if it has only one.
    pub select: String,
    /// Length of one unit of the file, mm, where the file does not say (CSV, some DXF); default none.
    pub unit: Option<f64>,
    /// Whether points of a table are corners of a polyline instead of points of a smooth curve; default false.
    pub polyline: bool,
}

/// Why there is no rail in a file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CurveError {
    /// The file has no unit and none was given.
    #[error("{0} does not say its unit; give it with --unit mm (or cm, m, in, ft)")]
    NoUnit(String),
    /// The file says another unit than the one given.
    #[error("{name} is in {file} but --unit says otherwise; leave --unit out")]
    Unit {
        /// Name.
        name: String,
        /// Unit of the file.
        file: String,
    },
    /// More than one curve, and none was named.
    #[error("{name} holds {count} curves that do not join: {list}; name one as FILE#{first}")]
    Several {
        /// Name.
        name: String,
        /// How many.
        count: usize,
        /// The first few.
        list: String,
        /// The first.
        first: String,
    },
    /// The curve named is not there.
    #[error("{name} has no curve #{select}; it has {list}")]
    Missing {
        /// Name.
        name: String,
        /// Asked for.
        select: String,
        /// The first few that there are.
        list: String,
    },
    /// A line of a table that is no point.
    #[error("{name}, line {line}: {reason}")]
    Line {
        /// Name.
        name: String,
        /// Line number from 1.
        line: usize,
        /// What is wrong.
        reason: String,
    },
    /// A damaged file.
    #[error("{name}: {reason}")]
    Damaged {
        /// Name.
        name: String,
        /// What is wrong.
        reason: String,
    },
    /// Curves that are no rail.
    #[error(transparent)]
    Rail(#[from] RailError),
    /// Not a readable STEP file.
    #[error("{name}: {source}")]
    Step {
        /// Name.
        name: String,
        /// What is wrong.
        source: ReadError,
    },
}

/// A curve of a file with the name by which it can be selected.
pub(super) struct Found {
    pub label: String,
    pub curves: Vec<crate::spline::curve::Curve<4>>,
}

/// Reads one rail. The format is told by the contents: STEP by its header, DXF by its group codes, else a table.
///
/// # Errors
/// See [`CurveError`].
pub fn read(bytes: &[u8], options: &CurveOptions) -> Result<Rail, CurveError> {
    let text = String::from_utf8_lossy(bytes);
    let start = text.trim_start_matches(['\u{feff}', ' ', '\r', '\n', '\t']);
    if start.starts_with("ISO-10303-21") {
        let all = edges::curves(bytes)
            .map_err(|source| CurveError::Step { name: options.name.clone(), source })?
            .into_iter()
            .map(|e| Found {
                label: if e.copy > 1 { format!("{}/{}", e.entity, e.copy) } else { e.entity.to_string() },
                curves: e.curves,
            })
            .collect();
        return chosen(all, options);
    }
    if is_dxf(start) {
        return chosen(dxf::read(&text, options)?, options);
    }
    let points = csv::read(&text, options)?;
    Ok(if options.polyline { Rail::polyline(&options.name, &points)? } else { Rail::through(&options.name, &points)? })
}

/// Straight lines of a DXF drawing by their ends, in the order of the file, mm. `unit` is the length of a unit of the
/// drawing in mm where it does not say.
///
/// # Errors
/// See [`CurveError`].
pub fn lines(bytes: &[u8], name: &str, unit: f64) -> Result<Vec<[crate::geom::Vec3; 2]>, CurveError> {
    let text = String::from_utf8_lossy(bytes);
    if !is_dxf(text.trim_start_matches(['\u{feff}', ' ', '\r', '\n', '\t'])) {
        return Err(CurveError::Damaged { name: name.into(), reason: "it is no ASCII DXF drawing".into() });
    }
    let named = CurveOptions { name: name.into(), ..CurveOptions::default() };
    let all = match dxf::read(&text, &named) {
        Err(CurveError::NoUnit(_)) => dxf::read(&text, &CurveOptions { unit: Some(unit), ..named })?,
        other => other?,
    };
    let point = |c: &[f64; 4]| crate::geom::Vec3::new(c[0], c[1], c[2]) / c[3];
    Ok(all
        .iter()
        .filter(|f| f.curves.len() == 1)
        .filter_map(|f| match &f.curves[0].control[..] {
            [p, q] => Some([point(p), point(q)]),
            _ => None,
        })
        .collect())
}

/// DXF files begin with a group code 0 and SECTION, or with comments (code 999).
fn is_dxf(start: &str) -> bool {
    let mut lines = start.lines().map(str::trim);
    matches!((lines.next(), lines.next()), (Some("0"), Some("SECTION")) | (Some("999"), Some(_)))
}

/// The curve asked for, or all of them if they join to one.
fn chosen(mut all: Vec<Found>, options: &CurveOptions) -> Result<Rail, CurveError> {
    let name = || options.name.clone();
    let list = |all: &[Found]| {
        let some: Vec<String> = all.iter().take(8).map(|f| format!("#{}", f.label)).collect();
        if all.is_empty() {
            "no curve".to_owned()
        } else if all.len() > some.len() {
            format!("{} …", some.join(", "))
        } else {
            some.join(", ")
        }
    };
    if !options.select.is_empty() {
        let known = list(&all);
        all.retain(|f| f.label.eq_ignore_ascii_case(&options.select));
        if all.is_empty() {
            return Err(CurveError::Missing { name: name(), select: options.select.clone(), list: known });
        }
    }
    match &all[..] {
        [] => Err(CurveError::Missing { name: name(), select: String::new(), list: list(&all) }),
        [one] => Ok(Rail::new(&options.name, &one.curves)?),
        several => {
            let joined: Vec<_> = several.iter().flat_map(|f| f.curves.iter().cloned()).collect();
            let chain = Rail::chain(&joined);
            match Rail::new(&options.name, &chain) {
                Err(RailError::Gap { .. }) => Err(CurveError::Several {
                    name: name(),
                    count: several.len(),
                    list: list(several),
                    first: several[0].label.clone(),
                }),
                other => Ok(other?),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;

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
