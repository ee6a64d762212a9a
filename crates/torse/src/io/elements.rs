//! Tangent planes and rulings from files: tables whose first line names the columns, and the lines of a DXF drawing.
//! The tables carry no unit: the caller gives it.

use super::cloud::CloudReadError;
use super::curves::CurveError;
use super::table::{self, Fault, Table};
use crate::answer::note::reader::ReaderNote;
use crate::geom::Vec3;
use crate::io::words::note::reader_note;
use crate::torse::contact::{ContactElement, Given};

/// Columns of a ruling from p to q.
const RULING: [&str; 6] = ["px", "py", "pz", "qx", "qy", "qz"];
/// The same from a to b, as strips of quadrilaterals have them.
const RUNG: [&str; 6] = ["ax", "ay", "az", "bx", "by", "bz"];
/// Columns of the plane `a x + b y + c z = d`.
const PLANE: [&str; 4] = ["a", "b", "c", "d"];
/// Columns of a region of interest: centre and radius.
const REGION: [&str; 4] = ["x", "y", "z", "r"];
/// Columns of the normal of a ruling's tangent plane.
const NORMAL: [&str; 3] = ["nx", "ny", "nz"];

/// Greatest coordinate, mm: a million kilometres, as for curves; squares and cubes of larger ones leave the numbers.
const FARTHEST: f64 = 1e12;

/// Whether a file gives planes or rulings: a DXF drawing, or a table whose headings say so.
pub fn holds_elements(name: &str, bytes: &[u8]) -> bool {
    let ending = name.rsplit('.').next().unwrap_or("").to_ascii_lowercase();
    match ending.as_str() {
        "dxf" => true,
        "csv" | "txt" => {
            let Ok(text) = table::text(&bytes[..bytes.len().min(4096)]) else { return false };
            // The start of a file may end in the midst of a row; headings come before.
            let head = text.split(['\n', '\r']).map(str::trim).find(|l| table::is_row(l)).unwrap_or_default();
            let Ok(head) = table::table(head) else { return false };
            let names = |all: &[&str]| all.iter().all(|c| !matches!(head.column(c), Ok(None)));
            names(&PLANE) || names(&RULING) || names(&RUNG)
        }
        _ => false,
    }
}

/// Planes or rulings of a file. `unit` is the length of the file's unit in mm; where none is given, it is what the
/// drawing or the headings say, else mm. `region` (centre and radius, in the unit of the file) is that of planes which
/// come without. Returned with notes of what was not read of a drawing.
///
/// Tables: `px,py,pz,qx,qy,qz` (or `ax` to `bz`) are rulings, with `nx,ny,nz` their tangent planes; `a,b,c,d` are planes
/// `a x + b y + c z = d`, with `x,y,z,r` their regions of interest. A column `t` in either must increase: it says
/// that the rows are in order. `w` are weights of planes and of rulings with planes in fits. Other columns are passed
/// over; see `io::table` for separators and decimal commas.
///
/// # Errors
/// See [`CloudReadError`].
///
/// # Example
/// ```
/// let table = b"px,py,pz,qx,qy,qz\n0,0,0,0,100,0\n30,0,5,30,100,5\n60,0,20,60,100,20\n90,0,45,90,100,45\n";
/// let (given, notes) = torse::io::elements::read("rulings.csv", table, Some(1.0), None)?;
/// assert!(given.len() == 4 && notes.is_empty());
/// let options = torse::ElementFitOptions::new(0.5, "gutter");
/// let answer = torse::fit_elements(&given, &options, &torse::Control::default())?;
/// assert_eq!(answer.patchwork().panels.len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read(
    name: &str,
    bytes: &[u8],
    unit: Option<f64>,
    region: Option<[f64; 4]>,
) -> Result<(Given, Vec<ReaderNote>), CloudReadError> {
    if name.to_ascii_lowercase().ends_with(".dxf") {
        let (lines, notes) = super::curves::lines(bytes, name, unit).map_err(|e| match e {
            CurveError::Unit { .. } | CurveError::NoUnit(_) => CloudReadError::Drawing(e.to_string()),
            e => CloudReadError::Format { format: "DXF", reason: e.to_string() },
        })?;
        if lines.is_empty() {
            let more = notes.first().map_or(String::new(), |n| format!(" ({})", reader_note(n)));
            let reason = format!("it holds no LINE: draw the rulings as lines{more}");
            return Err(CloudReadError::Format { format: "DXF", reason });
        }
        return Ok((Given::Rulings(lines), notes));
    }
    let (given, guessed) = table(bytes, unit, region)?;
    Ok((given, guessed.then(|| super::cloud::unit_note(name)).into_iter().collect()))
}

/// Columns of a table of planes or rulings.
struct Columns {
    /// Both ends of rulings; else planes.
    rulings: Option<Vec<usize>>,
    planes: Option<Vec<usize>>,
    normals: Option<Vec<usize>>,
    regions: Option<Vec<usize>>,
    order: Option<usize>,
    weights: Option<usize>,
}

impl Columns {
    /// The columns that a table names.
    ///
    /// # Errors
    /// Rulings and planes in one table, columns of which some are missing or that are named twice.
    fn of(table: &Table) -> Result<Self, Fault> {
        let all = |names: &[&str]| names.iter().map(|n| table.column(n)).collect::<Result<Option<Vec<_>>, _>>();
        let rulings = all(&RULING)?.map_or_else(|| all(&RUNG), |r| Ok(Some(r)))?;
        let planes = all(&PLANE)?;
        if rulings.is_some() && planes.is_some() {
            let reason = "columns of rulings and of planes in one table: leave out either".into();
            return Err(Fault { line: 1, reason });
        }
        Ok(Self {
            normals: if rulings.is_some() { table.group(&NORMAL)? } else { None },
            regions: if planes.is_some() { table.group(&REGION)? } else { None },
            rulings,
            planes,
            order: table.column("t")?,
            weights: table.column("w")?,
        })
    }

    /// Those that hold lengths.
    fn lengths(&self) -> Vec<usize> {
        let planes = self.planes.iter().flat_map(|p| p.last());
        let all = self.rulings.iter().chain(&self.regions).flatten().chain(planes);
        all.copied().collect()
    }

    /// Those that are read.
    fn read(&self) -> Vec<usize> {
        let groups = [&self.rulings, &self.planes, &self.normals, &self.regions];
        let mut all: Vec<usize> = groups.into_iter().flatten().flatten().copied().collect();
        all.extend(self.order.iter().chain(&self.weights));
        all
    }
}

/// What a table holds, and whether its unit is a guess.
fn table(bytes: &[u8], given: Option<f64>, region: Option<[f64; 4]>) -> Result<(Given, bool), CloudReadError> {
    let told = |f: Fault| CloudReadError::Line { format: "CSV", line: f.line, reason: f.reason };
    let text = table::text(bytes).map_err(told)?;
    let table = table::table(&text).map_err(told)?;
    let columns = Columns::of(&table).map_err(told)?;
    let unit = table.unit_or(&columns.lengths(), given).map_err(told)?;
    let (guessed, unit) = (unit.is_none(), unit.unwrap_or(1.0));
    let region = region.map(|r| r.map(|x| x * unit));
    let Columns { rulings, planes, normals, regions, order, weights } = &columns;
    let read = columns.read();
    let (mut numbers, mut values) = (Vec::new(), vec![0.0; table.width()]);
    let mut found: Vec<(f64, ContactElement)> = Vec::new();
    for row in &table.rows {
        let fault = |reason: String| CloudReadError::Line { format: "CSV", line: row.line, reason };
        table.numbers(row, &read, &mut numbers).map_err(told)?;
        for (k, value) in read.iter().zip(&numbers) {
            if !value.is_finite() {
                return Err(fault(format!("column {} holds {value}, which is not a finite number", k + 1)));
            }
            values[*k] = *value;
        }
        let vector = |at: &[usize]| Vec3::new(values[at[0]], values[at[1]], values[at[2]]);
        let t = order.map_or(found.len() as f64, |k| values[k]);
        if let Some((before, ..)) = found.last() {
            if t == *before {
                return Err(fault(format!("the parameter t = {t} repeats the line before: remove one of them")));
            }
            if t < *before {
                return Err(fault(format!("the parameter t = {t} comes after {before}: sort the rows by t")));
            }
        }
        let weight = weights.map_or(1.0, |k| values[k]);
        if weight <= 0.0 {
            return Err(fault(format!("the weight {weight} is not positive")));
        }
        if let Some(at) = rulings {
            let ends = [vector(&at[..3]) * unit, vector(&at[3..]) * unit];
            let normal = normals.as_ref().map(|n| vector(n));
            found.push((t, ruling(ends, normal, weight).map_err(fault)?));
        } else if let Some(at) = planes {
            let n = vector(&at[..3]);
            // Squares of very large or small numbers are none: first the numbers by the largest of them.
            let (largest, d) = (n.amax(), values[at[3]] * unit);
            if largest <= 0.0 {
                return Err(fault("the plane has no normal: a, b and c are zero".into()));
            }
            let n = n / largest;
            let (normal, d) = (n.normalize(), d / largest / n.norm());
            let ([x, y, z, r], own) =
                match (regions, region) {
                    (Some(k), _) => ([values[k[0]], values[k[1]], values[k[2]], values[k[3]]], unit),
                    (None, Some(r)) => (r, 1.0),
                    (None, None) => return Err(fault(
                        "planes need a region of interest: columns x, y, z, r (centre and radius), or --region X,Y,Z,R"
                            .into(),
                    )),
                };
            if r <= 0.0 {
                return Err(fault(format!("the radius {r} of the region of interest is not positive")));
            }
            let centre = Vec3::new(x, y, z) * own;
            // Regions are discs in their planes.
            near([d, r * own].iter().chain(&centre)).map_err(&fault)?;
            let centre = centre - normal * (normal.dot(&centre) - d);
            found.push((t, ContactElement { normal, ends: [centre; 2], radius: r * own, weight }));
        }
    }
    if found.is_empty() {
        return Err(CloudReadError::Empty);
    }
    if rulings.is_some() && normals.is_none() {
        return Ok((Given::Rulings(found.into_iter().map(|f| f.1.ends).collect()), guessed));
    }
    Ok((Given::Planes(found.into_iter().map(|f| f.1).collect()), guessed))
}

/// A ruling with the normal of its plane, zero where none is given.
fn ruling(ends: [Vec3; 2], normal: Option<Vec3>, weight: f64) -> Result<ContactElement, String> {
    near(ends.iter().flatten())?;
    if let Some(normal) = normal {
        let size = normal.norm();
        if !(size > 0.0 && size.is_finite()) {
            return Err(format!("the normal has the length {size:e}; any between 1e-150 and 1e150 will do"));
        }
        square(&normal, &ends)?;
    }
    // Rulings are compared on themselves; their planes in a narrow region around.
    const NARROW: f64 = 0.1;
    let radius = NARROW * (ends[1] - ends[0]).norm();
    Ok(ContactElement { normal: normal.unwrap_or_else(Vec3::zeros), ends, radius, weight })
}

/// Degrees by which a normal may be off square to its ruling: rounded and measured ones are, by less.
const OBLIQUE_DEG: f64 = 5.0;

/// Refuses normals of planes that do not hold their ruling.
fn square(normal: &Vec3, ends: &[Vec3; 2]) -> Result<(), String> {
    let d = ends[1] - ends[0];
    // Along the largest of their numbers, so that squares stay numbers.
    let (n, d) = (normal / normal.amax(), d / d.amax());
    let off = (n.dot(&d).abs() / (n.norm() * d.norm())).min(1.0).asin().to_degrees();
    if off > OBLIQUE_DEG {
        return Err(format!(
            "the normal is {off:.1}° off square to the ruling: the plane does not hold it; give the normal of the tangent \
             plane, or leave out nx, ny, nz"
        ));
    }
    Ok(())
}

/// Refuses lengths (mm) that are too great to be reckoned with.
fn near<'a>(lengths: impl IntoIterator<Item = &'a f64>) -> Result<(), String> {
    let far = lengths.into_iter().find(|x| x.is_nan() || x.abs() > FARTHEST);
    far.map_or(Ok(()), |x| Err(format!("a length of {x:e} mm is more than {FARTHEST:e} mm: is its unit right?")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_and_rulings_are_told_by_their_headings() {
        let rulings = b"t,px,py,pz,qx,qy,qz\n1,0,0,0,1,0,0\n2,0,1,0,1,1,0\n";
        assert!(holds_elements("a.csv", rulings));
        assert_eq!(
            read("a.csv", rulings, Some(10.0), None).expect("rulings"),
            (
                Given::Rulings(vec![
                    [Vec3::zeros(), Vec3::new(10.0, 0.0, 0.0)],
                    [Vec3::new(0.0, 10.0, 0.0), Vec3::new(10.0, 10.0, 0.0)]
                ]),
                Vec::new()
            )
        );
        let planes = b"a;b;c;d;w\n0;0;2;4;3\n";
        let (Given::Planes(p), _) = read("a.csv", planes, None, Some([1.0, 1.0, 0.0, 5.0])).expect("planes") else {
            panic!("planes")
        };
        assert_eq!((p[0].centre(), p[0].radius, p[0].weight), (Vec3::new(1.0, 1.0, 2.0), 5.0, 3.0));
        assert!(!holds_elements("a.csv", b"x,y,z\n1,2,3\n") && !holds_elements("a.csv", b"1,2,3\n"));
    }

    #[test]
    fn faults_name_their_line() {
        let text = |b: &[u8]| read("a.csv", b, None, None).expect_err("a fault").to_string();
        assert!(text(b"a,b,c,d\n0,0,1,0\n").contains("--region"));
        assert!(text(b"px,py,pz,qx,qy,qz\n0,0,0,1,0,NaN\n").contains("line 2"));
        assert!(text(b"px,py,pz,qx,qy,qz\n0,0,0,1,0\n").contains("5 numbers"));
        assert!(text(b"t,a,b,c,d,x,y,z,r\n1,0,0,1,0,0,0,0,1\n1,0,1,1,0,0,0,0,1\n")
            .contains("line 3: the parameter t = 1 repeats"));
        assert!(text(b"t,a,b,c,d,x,y,z,r\n2,0,0,1,0,0,0,0,1\n1,0,1,1,0,0,0,0,1\n").contains("sort the rows by t"));
        assert!(text(b"a,b,c,d,x,y,z,r,w\n0,0,1,1,0,0,0,1,0\n").contains("weight 0"));
        let oblique = text(b"px,py,pz,qx,qy,qz,nx,ny,nz\n0,0,0,1,0,0,0,0,1\n0,1,0,1,1,0,0.1,0,1\n");
        assert!(oblique.contains("line 3: the normal is 5.7\u{b0} off square"), "{oblique}");
        assert!(text(b"a,b,c,d,x,y,z,r\n0,0,0,1,0,0,0,1\n").contains("no normal"));
        assert!(text(b"px [in],py [in],pz [in],qx [in],qy [in],qz [in]\n0,0,0,1,0,0\n1e308,0,0,1,0,9\n")
            .contains("line 3: a length of inf mm"));
        assert!(text(b"a,b,c,d,x,y,z,r\n0,0,1e-300,1e10,0,0,0,1\n").contains("line 2: a length of inf mm"));
    }

    #[test]
    fn drawings_in_another_unit_are_drawings() {
        let metres = b"0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n6\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n0\nLINE\n10\n0\n20\n0\n30\n0\n\
            11\n1\n21\n0\n31\n0\n0\nENDSEC\n0\nEOF\n";
        assert!(read("a.dxf", metres, None, None).is_ok());
        let told = read("a.dxf", metres, Some(1.0), None).expect_err("a fault").to_string();
        assert!(told.starts_with("the unit of a.dxf is the") && told.contains("--unit says otherwise"), "{told}");
    }

    #[test]
    fn equations_of_planes_may_have_numbers_of_any_size() {
        for scale in ["e-200", "e0", "e200"] {
            let text = format!("a,b,c,d,x,y,z,r\n0,3{scale},4{scale},10{scale},1,2,3,5\n");
            let (Given::Planes(p), _) = read("a.csv", text.as_bytes(), None, None).expect("a plane") else {
                panic!("planes")
            };
            assert!((p[0].normal - Vec3::new(0.0, 0.6, 0.8)).norm() < 1e-15, "{scale}: {:?}", p[0]);
            assert!((p[0].centre() - Vec3::new(1.0, 1.04, 1.72)).norm() < 1e-14, "{scale}: {:?}", p[0]);
        }
    }
}
