//! Good files of every kind, as small as may be: written by the program's own writers, or by hand where it has none.

use crate::parts;
use crate::random::Random;
use std::sync::OnceLock;
use torse::answer::presentation::present;
use torse::geom::Vec3;
use torse::io::json::Report;
use torse::io::step::read::read;
use torse::io::{bend_table, bends, bundle, cloud};
use torse::pipeline::approximate::{approximate, Options};
use torse::{unroll, Control, UnrollOptions};

/// Files that the same readers read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    Ply,
    Table,
    Obj,
    Stl,
    Dxf,
    Net,
    Report,
    DrawnDxf,
    DrawnSvg,
    Step,
    Panels,
    Strips,
    Iges,
    ThreeDm,
    Job,
    Materials,
    Bends,
    BendTable,
}

/// All good files.
pub struct Stock {
    pub all: Vec<(Kind, Vec<u8>)>,
}

const MODELS: [&[u8]; 7] = [
    include_bytes!("../../../../data/cone_holes.step"),
    include_bytes!("../../../../data/cylinder_holes.step"),
    include_bytes!("../../../../data/fuselage.step"),
    include_bytes!("../../../../data/half_bowl.step"),
    include_bytes!("../../../../data/hull.step"),
    include_bytes!("../../../../data/torus_piece.step"),
    include_bytes!("../../../../data/wavy_roof.step"),
];

/// Tolerance (mm) at which a torus of half a metre is one panel or two.
const COARSE: f64 = 40.0;
/// Tolerance (mm) of parts laid flat.
const FINE: f64 = 0.05;

impl Stock {
    /// Makes them.
    ///
    /// # Errors
    /// What went wrong, in words.
    pub fn new() -> Result<Self, String> {
        let mut all: Vec<(Kind, Vec<u8>)> = Vec::new();
        all.extend(MODELS.map(|m| (Kind::Strips, m.to_vec())));
        all.extend(parts::all().into_iter().map(|t| (Kind::Step, t.into_bytes())));
        all.extend(tables().into_iter().map(|t| (Kind::Table, t.into_bytes())));
        all.extend(clouds());
        all.extend(meshes());
        all.extend(drawings().into_iter().map(|t| (Kind::Dxf, t.into_bytes())));
        all.push((Kind::Net, include_bytes!("../../../../data/keel_net.json").to_vec()));
        all.push((
            Kind::Net,
            b"{\"unit\":\"cm\",\"degree\":2,\"knots\":[0,0,2,4,4],\"points\":[[0,0,0],[1,2,0],[2,2,1],[4,0,1,1.0]],\
              \"m_star\":8,\"lambda_star\":10}"
                .to_vec(),
        ));
        all.extend([&include_bytes!("../../../../data/pulled_hull.json")[..], JOB].map(|b| (Kind::Job, b.to_vec())));
        all.extend(
            [&include_bytes!("../../src/io/materials.csv")[..], MATERIALS].map(|b| (Kind::Materials, b.to_vec())),
        );
        all.extend(answers()?);
        for (name, kind) in [("bends.csv", Kind::Bends), ("bend_table.csv", Kind::BendTable)] {
            let table = result().iter().find(|f| f.0 == name).ok_or(format!("the result has no {name}"))?;
            all.push((kind, table.1.clone()));
        }
        Ok(Self { all })
    }

    /// One of these kinds.
    pub fn any(&self, random: &mut Random, kinds: &[Kind]) -> &[u8] {
        let kind = kinds[random.below(kinds.len())];
        let there: Vec<&[u8]> = self.all.iter().filter(|(k, _)| *k == kind).map(|(_, b)| b.as_slice()).collect();
        there[random.below(there.len())]
    }

    /// Any.
    pub fn other(&self, random: &mut Random) -> &[u8] {
        &self.all[random.below(self.all.len())].1
    }
}

/// What the main job writes.
fn answers() -> Result<Vec<(Kind, Vec<u8>)>, String> {
    let torus = include_bytes!("../../../../data/torus_piece.step");
    let model = read(torus).map_err(|e| e.to_string())?;
    let mut answer = approximate(&model, &Options::new(COARSE)).map_err(|e| format!("no answer: {e}"))?;
    (answer.cut.iges, answer.cut.threedm) = (true, true);
    let shown = present(&answer);
    let report = Report::of(&answer, &shown).to_json().map_err(|e| e.to_string())?;
    let mut all = vec![(Kind::Report, report.into_bytes())];
    let files = bundle::geometry(&answer, &shown, "2026-01-01T00:00:00").map_err(|e| e.to_string())?;
    for (name, bytes) in files {
        let kind = match name.rsplit('.').next() {
            Some("step") => Kind::Panels,
            Some("dxf") => Kind::DrawnDxf,
            Some("svg") => Kind::DrawnSvg,
            Some("igs") => Kind::Iges,
            Some("3dm") => Kind::ThreeDm,
            _ => continue,
        };
        all.push((kind, bytes));
    }
    Ok(all)
}

/// A job of `torse shape` with what the other one has not.
const JOB: &[u8] = br#"{ "unit": "cm",
  "curves": [
    { "name": "a", "through": [[0, 0, 0], [5, 0, 1], [10, 0, 0]], "spans": 4 },
    { "name": "b", "degree": 1, "knots": [0, 0, 1, 1], "points": [[0, 5, 0], [10, 5, 0]], "fixed": true } ],
  "strips": [ { "name": "s", "sides": ["a", "b"] } ],
  "joins": [ { "ruling": ["s", "s"], "smoothness": "G2" } ],
  "handles": [ { "curve": "a", "u": 0.5, "point": [5, 0, 2] } ],
  "lengths": [ { "between": [ { "curve": "a", "u": 0 }, { "curve": "b", "u": 1 } ], "length": 11 } ],
  "moves": [ { "handle": 0, "point": [5, 0, 3] } ] }"#;

/// Materials in another order of columns.
const MATERIALS: &[u8] =
    b"k,material,least_radius,density,note\ndin,\"sheet, grey\",1.5t,7850,ours\n0.44,card,4mm,700,\n";

/// The files of a result with bend lines and a bend table, made once.
pub fn result() -> &'static [(String, Vec<u8>)] {
    static FILES: OnceLock<Vec<(String, Vec<u8>)>> = OnceLock::new();
    FILES.get_or_init(|| bracket().unwrap_or_default())
}

/// A bracket laid flat.
fn bracket() -> Result<Vec<(String, Vec<u8>)>, String> {
    let model = read(include_bytes!("../../../../data/bracket.step")).map_err(|e| e.to_string())?;
    let answer = unroll(&model, &UnrollOptions::new(FINE), &Control::default()).map_err(|e| e.to_string())?;
    let shown = present(&answer);
    let mut all = bundle::geometry(&answer, &shown, "2026-01-01T00:00:00").map_err(|e| e.to_string())?;
    all.extend(bends::csv(answer.patterns(), answer.cut.unit).map(|b| ("bends.csv".into(), b)));
    all.extend(bend_table::csv(&answer, answer.cut.unit).map(|b| ("bend_table.csv".into(), b)));
    let report = Report::of(&answer, &shown).to_json().map_err(|e| e.to_string())?;
    all.push(("report.json".into(), report.into_bytes()));
    Ok(all)
}

/// Points of an arc that rises.
fn arc(n: usize) -> Vec<[f64; 3]> {
    let at = |k: usize| 0.3 * k as f64;
    (0..n).map(|k| [100.0 * at(k).cos(), 100.0 * at(k).sin(), 7.5 * k as f64]).collect()
}

/// Points, curves, elements and strips as tables.
fn tables() -> Vec<String> {
    let rows = |points: &[[f64; 3]], by: &str| -> String {
        points.iter().map(|p| format!("{}{by}{}{by}{}\n", p[0], p[1], p[2])).collect()
    };
    let (p, q) = (arc(9), arc(8));
    let bare = rows(&p, ",");
    let named = p.iter().map(|p| format!("{};1;{};{}\n", p[2], p[0], p[1]).replace('.', ",")).collect::<String>();
    let rungs: Vec<String> =
        p.iter().map(|p| p.map(|x| x.to_string()).join(",")).map(|a| format!("{a},{}\n", "0,0,250")).collect();
    let planes: String = q
        .iter()
        .enumerate()
        .map(|(k, p)| format!("{k},{},{},0.1,100,{},{},{},20,1\n", p[0], p[1], p[0], p[1], p[2]))
        .collect();
    let normals: String = q
        .iter()
        .enumerate()
        .map(|(k, p)| format!("{k};{};{};{};0;0;300;{};{};0\n", p[0], p[1], p[2], -p[1], p[0]))
        .collect();
    vec![
        bare.clone(),
        format!("x [m],y [m],z [m]\n{bare}"),
        format!("# a scan\nz;name;x;y\n{named}"),
        format!("{}\n{}", p.len(), rows(&p, " ")),
        format!("2\n{}\n", "1.5 2.5 3.5 -120 255 0 17\n".repeat(2)),
        format!("x\ty\tz\n{}", rows(&p, "\t")),
        format!("{bare}\n{}", rows(&p.iter().map(|p| [p[0], p[1], p[2] + 40.0]).collect::<Vec<_>>(), ",")),
        format!("ax,ay,az,bx,by,bz\n{}", rungs.concat()),
        format!("px [in],py [in],pz [in],qx [in],qy [in],qz [in]\n{}", rungs.concat()),
        format!("t,a,b,c,d,x,y,z,r,w\n{planes}"),
        format!("t;px;py;pz;qx;qy;qz;nx;ny;nz\n{normals}"),
        String::from("a;b;c;d;w\n0;0;2;4;3\n0;1;2;5;1\n"),
        include_str!("../../../../data/chine_high.csv").into(),
        include_str!("../../../../data/hood_strip.csv").into(),
    ]
}

/// Points as PLY: binary in both byte orders, text, with other elements around.
fn clouds() -> Vec<(Kind, Vec<u8>)> {
    let points: Vec<Vec3> = arc(7).into_iter().map(Vec3::from).collect();
    let little = cloud::ply::with_values(&points, &[0.5; 7], "deviation");
    let head = little.windows(11).position(|w| w == b"end_header\n").map_or(0, |k| k + 11);
    let mut big = String::from_utf8_lossy(&little[..head]).replace("little", "big").into_bytes();
    little[head..].chunks(4).for_each(|c| big.extend(c.iter().rev()));
    let doubles = "ply\nformat binary_little_endian 1.0\nelement camera 1\nproperty uchar k\nelement vertex 7\n\
                   property double x\nproperty uchar red\nproperty double y\nproperty double z\nelement face 2\n\
                   property list uchar int vertex_indices\nend_header\n";
    let mut wide = doubles.as_bytes().to_vec();
    wide.push(7);
    for p in &points {
        wide.extend(p.x.to_le_bytes());
        wide.push(9);
        wide.extend(p.y.to_le_bytes());
        wide.extend(p.z.to_le_bytes());
    }
    wide.extend([3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0]);
    let rows: String = points.iter().map(|p| format!("{} 9 {} {}\n", p.z, p.x, p.y)).collect();
    let text = format!(
        "ply\nformat ascii 1.0\ncomment made here\nelement camera 1\nproperty float k\nelement vertex 7\n\
         property float z\nproperty uchar r\nproperty float x\nproperty float y\nelement face 2\n\
         property list uchar int vertex_indices\nelement edge 1\nproperty int vertex1\nend_header\n1\n{rows}3 0 1 2\n\
         3 0 2 3\n0\n"
    );
    [little, big, wide, text.into_bytes()].map(|b| (Kind::Ply, b)).into()
}

/// Meshes as OBJ and STL.
fn meshes() -> Vec<(Kind, Vec<u8>)> {
    let line = |p: [f64; 3]| format!("v {} {} {}\n", p[0], p[1], p[2]);
    let (low, high): (Vec<_>, Vec<_>) = arc(5).into_iter().map(|p| (p, [p[0], p[1], p[2] + 90.0])).unzip();
    let vertices: String = low.iter().chain(&high).map(|p| line(*p)).collect();
    let strip: String = (1..5).map(|k| format!("f {k}/1 {}/2 {} {}//3\n", k + 1, k + 6, k + 5)).collect();
    let triangles: String =
        (1..5).map(|k| format!("f {k} {} {}\nf -{k} -{} -{}\n", k + 1, k + 5, k + 1, k + 5)).collect();
    let facet = |k: usize| [low[k], low[k + 1], high[k]];
    let text: String = (0..4)
        .map(|k| {
            let corners: String = facet(k).iter().map(|p| line(*p).replace('v', "vertex")).collect();
            format!("facet normal 0 0 1\nouter loop\n{corners}endloop\nendfacet\n")
        })
        .collect();
    let mut binary = vec![b' '; 80];
    binary.extend(4u32.to_le_bytes());
    for k in 0..4 {
        binary.extend([0; 12]);
        facet(k).as_flattened().iter().for_each(|x| binary.extend((*x as f32).to_le_bytes()));
        binary.extend([0; 2]);
    }
    vec![
        (Kind::Obj, format!("o strip\n{vertices}vn 0 0 1\n{strip}").into_bytes()),
        (Kind::Obj, format!("# a scan\n{vertices}{triangles}").into_bytes()),
        (Kind::Stl, format!("solid arc\n{text}endsolid arc\n").into_bytes()),
        (Kind::Stl, binary),
    ]
}

/// Curves as drawings: every entity that is read, and some that are not.
fn drawings() -> Vec<String> {
    let entities = [
        "0\nLINE\n5\nA1\n8\nrail\n10\n0\n20\n0\n30\n0\n11\n10\n21\n0\n31\n0\n0\nARC\n5\nA2\n8\nrail\n10\n10\n20\n10\n30\n0\n40\n10\n\
         50\n270\n51\n0\n",
        "0\nLWPOLYLINE\n5\nB\n8\n0\n90\n3\n70\n0\n38\n2\n10\n0\n20\n0\n42\n1\n10\n2\n20\n0\n10\n4\n20\n0\n",
        "0\nSPLINE\n5\nC\n8\n0\n70\n8\n71\n2\n72\n6\n73\n3\n40\n0\n40\n0\n40\n0\n40\n1\n40\n1\n40\n1\n10\n0\n20\n0\n30\n0\n10\n1\n20\n2\n\
         30\n0\n10\n2\n20\n0\n30\n1\n41\n1\n41\n0.5\n41\n1\n",
        "0\nSPLINE\n5\nS\n70\n8\n71\n3\n74\n4\n12\n1\n22\n0\n32\n0\n11\n0\n21\n0\n31\n0\n11\n3\n21\n1\n31\n0\n11\n5\n21\n3\n31\n0\n11\n9\n21\n3\n31\n1\n",
        "0\nSPLINE\n5\nT\n70\n11\n71\n3\n74\n5\n11\n0\n21\n0\n31\n0\n11\n3\n21\n1\n31\n0\n11\n5\n21\n3\n31\n0\n11\n1\n21\n4\n31\n1\n11\n0\n21\n0\n31\n0\n",
        "0\nELLIPSE\n5\nE\n8\n0\n10\n1\n20\n2\n30\n0\n11\n4\n21\n0\n31\n0\n210\n0\n220\n0\n230\n1\n40\n0.5\n41\n0\n42\n4\n",
        "0\nCIRCLE\n5\nK\n8\n0\n10\n5\n20\n-5\n30\n0\n40\n7.25\n210\n0\n220\n0.6\n230\n0.8\n",
        "0\nPOLYLINE\n5\nP\n70\n1\n0\nVERTEX\n10\n0\n20\n0\n30\n0\n42\n0.4\n0\nVERTEX\n10\n4\n20\n0\n30\n0\n0\nVERTEX\n10\n4\n20\n5\n30\n0\n0\nSEQEND\n",
        "0\nPOLYLINE\n5\nP\n70\n8\n0\nVERTEX\n10\n0\n20\n0\n30\n1\n70\n32\n0\nVERTEX\n10\n4\n20\n0\n30\n0\n70\n32\n0\nSEQEND\n",
        "0\nLINE\n5\nL1\n10\n0\n20\n0\n30\n0\n11\n0\n21\n9\n31\n1\n0\nLINE\n5\nL2\n10\n5\n20\n0\n30\n0\n11\n5\n21\n9\n31\n0\n0\nTEXT\n1\nhello\n\
         0\nINSERT\n2\nblock\n0\nLINE\n5\nL3\n10\n9\n20\n0\n30\n0\n11\n9\n21\n9\n31\n0\n",
    ];
    let mut all: Vec<String> = entities
        .iter()
        .enumerate()
        .map(|(k, e)| {
            let unit = [1, 4, 5, 6][k % 4];
            format!(
                "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n{unit}\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{e}0\nENDSEC\n0\nEOF\n"
            )
        })
        .collect();
    all.push(include_str!("../../../../data/duct_round.dxf").into());
    all.push(include_str!("../../../../data/duct_square.dxf").into());
    all
}
