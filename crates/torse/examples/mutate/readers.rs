//! Every reader of files, called as the program calls it.

use crate::specimen::{result, Kind};
use torse::geom::{Vec2, Vec3};
use torse::io::artwork::{self, Artwork};
use torse::io::curves::{self, CurveOptions};
use torse::io::json::Report;
use torse::io::step::read as step;
use torse::io::{cloud, drawings, elements, materials, net, quads, result_folder, shape};
use torse::patchwork::written::WrittenPiece;
use torse::pipeline::map_artwork::Shape;
use torse::torse::contact::Given;
use torse::torse::rail::Rail;

/// A reader: its name in the table, what it reads, and the call, which answers whether what was read is sound.
pub struct Reader {
    pub name: &'static str,
    pub kinds: &'static [Kind],
    pub read: fn(&[u8]) -> Result<bool, String>,
}

const fn reader(name: &'static str, kinds: &'static [Kind], read: fn(&[u8]) -> Result<bool, String>) -> Reader {
    Reader { name, kinds, read }
}

/// All of them.
pub const READERS: [Reader; 32] = [
    reader("points: PLY", &[Kind::Ply], |b| points("a.ply", b)),
    reader("points: tables", &[Kind::Table], |b| points("a.csv", b)),
    reader("points: PTS", &[Kind::Table], |b| points("a.pts", b)),
    reader("points: OBJ", &[Kind::Obj], |b| points("a.obj", b)),
    reader("points: STL", &[Kind::Stl], |b| points("a.stl", b)),
    reader("curves: tables", &[Kind::Table], |b| one_curve(b, "a.csv", Some(10.0), false)),
    reader("curves: tables as polylines", &[Kind::Table], |b| one_curve(b, "a.csv", Some(1.0), true)),
    reader("curves: DXF", &[Kind::Dxf], |b| one_curve(b, "a.dxf", None, false)),
    reader("curves: all of a DXF", &[Kind::Dxf, Kind::DrawnDxf], |b| all_curves(b, "a.dxf", None)),
    reader("curves: all of a file in inches", &[Kind::Dxf, Kind::Table], |b| all_curves(b, "a", Some(25.4))),
    reader("curves: STEP", &[Kind::Step, Kind::Strips], edge),
    reader("curves: IGES", &[Kind::Iges], |b| all_curves(b, "a.igs", None)),
    reader("curves: 3DM", &[Kind::ThreeDm], |b| all_curves(b, "a.3dm", None)),
    reader("elements: tables", &[Kind::Table], |b| given("a.csv", b)),
    reader("elements: DXF", &[Kind::Dxf], |b| given("a.dxf", b)),
    reader("quadrilaterals: tables", &[Kind::Table], |b| strip("a.csv", b)),
    reader("quadrilaterals: OBJ", &[Kind::Obj], |b| strip("a.obj", b)),
    reader("control nets: JSON", &[Kind::Net], control_net),
    reader("reports: JSON", &[Kind::Report], report),
    reader("drawings: DXF", &[Kind::DrawnDxf], |b| drawings::dxf(b).map(|p| pieces(&p))),
    reader("drawings: SVG", &[Kind::DrawnSvg], |b| drawings::svg(b).map(|p| pieces(&p))),
    reader("STEP: faces", &[Kind::Step, Kind::Step, Kind::Strips], faces),
    reader("IGES: faces", &[Kind::Iges], faces),
    reader("3DM: faces", &[Kind::ThreeDm], faces),
    reader("STEP: panels written here", &[Kind::Panels], |b| step::own::faces(b).map(|f| own_faces(&f))),
    reader("artwork: tables", &[Kind::Table], |b| drawn("a.csv", b)),
    reader("artwork: DXF", &[Kind::Dxf, Kind::DrawnDxf], |b| drawn("a.dxf", b)),
    reader("jobs of shapes: JSON", &[Kind::Job], job),
    reader("materials: tables", &[Kind::Materials], cards),
    reader("results: bend lines", &[Kind::Bends], |b| folder("bends.csv", b)),
    reader("results: bend tables", &[Kind::BendTable], |b| folder("bend_table.csv", b)),
    reader("STEP: strips written here", &[Kind::Strips], |b| step::own::strips(b).map(|_| true)),
];

fn finite(all: &[Vec3]) -> bool {
    all.iter().flatten().all(|x| x.is_finite())
}

fn points(name: &str, bytes: &[u8]) -> Result<bool, String> {
    let (cloud, _) = cloud::read_noted(name, bytes, None).map_err(|e| e.to_string())?;
    let corners = cloud.triangles.iter().flatten().all(|k| (*k as usize) < cloud.points.len());
    Ok(finite(&cloud.points) && corners)
}

fn sound(rail: &Rail) -> bool {
    rail.pieces.iter().flat_map(|p| &p.control).flatten().all(|x| x.is_finite())
        && rail.pieces.iter().flat_map(|p| p.knots.values()).all(|x| x.is_finite())
}

fn options(name: &str, unit: Option<f64>, polyline: bool) -> CurveOptions {
    CurveOptions { name: name.into(), select: String::new(), unit, polyline }
}

fn one_curve(bytes: &[u8], name: &str, unit: Option<f64>, polyline: bool) -> Result<bool, String> {
    curves::read(bytes, &options(name, unit, polyline)).map(|(r, _)| sound(&r)).map_err(|e| e.to_string())
}

fn all_curves(bytes: &[u8], name: &str, unit: Option<f64>) -> Result<bool, String> {
    let found = curves::read_all(bytes, &options(name, unit, false)).map_err(|e| e.to_string())?;
    Ok(found.rails.iter().all(sound))
}

/// The edges of a STEP file, then the first of them by its number, as a user names it.
fn edge(bytes: &[u8]) -> Result<bool, String> {
    let edges = step::edges::curves(bytes).map_err(|e| e.to_string())?;
    let Some(first) = edges.first() else { return Err("no edges, and no word of it".into()) };
    let select = first.entity.to_string();
    let named = CurveOptions { select, ..options("a.step", None, false) };
    curves::read_all(bytes, &named).map(|c| c.rails.iter().all(sound)).map_err(|e| e.to_string())
}

fn given(name: &str, bytes: &[u8]) -> Result<bool, String> {
    // The program reads other files as points.
    if !elements::holds_elements(name, bytes) {
        return Err("it holds no elements".into());
    }
    let region = Some([0.0, 0.0, 0.0, 100.0]);
    let (given, _) = elements::read(name, bytes, None, region).map_err(|e| e.to_string())?;
    Ok(match given {
        Given::Rulings(r) => finite(r.as_flattened()),
        Given::Planes(p) => p.iter().all(|p| finite(&p.ends) && finite(&[p.normal]) && p.radius.is_finite()),
    })
}

fn strip(name: &str, bytes: &[u8]) -> Result<bool, String> {
    quads::read(name, bytes, None).map(|s| finite(s.a()) && finite(s.b())).map_err(|e| e.to_string())
}

fn control_net(bytes: &[u8]) -> Result<bool, String> {
    if !net::is_net(bytes) {
        return Err("it is a file of curves".into());
    }
    let file = net::read(bytes, "a.json", None).map_err(|e| e.to_string())?;
    let rulings: Vec<Vec3> = file.first_ruling.into_iter().chain(file.last_ruling).collect();
    let numbers = file.stars.iter().chain(&file.shape).flatten().all(|x| x.is_finite());
    Ok(sound(&file.curve) && finite(&rulings) && numbers)
}

fn report(bytes: &[u8]) -> Result<bool, String> {
    let text = std::str::from_utf8(bytes).map_err(|e| e.to_string())?;
    Report::from_json(text).map(|_| true).map_err(|e| e.to_string())
}

fn drawn(name: &str, bytes: &[u8]) -> Result<bool, String> {
    Ok(match artwork::read(name, bytes, 1.0).map_err(|e| e.to_string())? {
        Artwork::Points(points, _) => points.iter().all(|(_, p)| finite(&[*p])),
        Artwork::Drawing(sketch, _) => sketch.items.iter().all(|i| match &i.shape {
            Shape::Curves(all) => all.iter().flat_map(|c| &c.control).flatten().all(|x| x.is_finite()),
            Shape::Point(p) => finite(&[*p]),
            Shape::Words(w) => finite(&[w.at, w.way, w.normal]) && w.height > 0.0,
        }),
    })
}

fn job(bytes: &[u8]) -> Result<bool, String> {
    let job = shape::read(bytes, "job", None).map_err(|e| e.to_string())?;
    Ok(job.unit.is_finite() && job.curves.iter().flat_map(|c| &c.1.control).flatten().all(|x| x.is_finite()))
}

fn cards(bytes: &[u8]) -> Result<bool, String> {
    let text = std::str::from_utf8(bytes).map_err(|e| e.to_string())?;
    let all = materials::read("a.csv", text).map_err(|e| e.to_string())?;
    Ok(all.iter().all(|m| m.density.is_finite() && m.density > 0.0))
}

/// A good result with one of its files exchanged. Radii and lengths that are not said are infinite or no numbers.
fn folder(name: &str, bytes: &[u8]) -> Result<bool, String> {
    let of_result = |wanted: &str| match wanted == name {
        true => Some(bytes.to_vec()),
        false => result().iter().find(|f| f.0 == wanted).map(|f| f.1.clone()),
    };
    let found = result_folder::read(&of_result).map_err(|e| e.to_string())?;
    let numbers = |p: &result_folder::ResultPart| {
        p.lines.iter().all(|(_, l)| l.length.is_finite()) && p.bends.iter().all(|b| b.angle.is_finite())
    };
    Ok(found.parts.iter().all(numbers) && found.left.iter().all(|l| !l.1.is_empty()))
}

fn pieces(all: &[WrittenPiece]) -> bool {
    let fine = |p: &Vec2| p.iter().all(|x| x.is_finite());
    all.iter().all(|p| p.points().all(fine))
}

fn faces(bytes: &[u8]) -> Result<bool, String> {
    let model = torse::read(bytes).map_err(|e| e.to_string())?;
    Ok(!model.faces.is_empty()
        && model.faces.iter().all(|f| {
            f.surface.control.iter().flatten().all(|x| x.is_finite())
                && f.loops.iter().flat_map(|l| &l.points).flatten().all(|x| x.is_finite())
        }))
}

fn own_faces(all: &[torse::patchwork::written::WrittenFace]) -> bool {
    all.iter().all(|f| f.surface.points.iter().flatten().all(|x| x.is_finite()))
}
