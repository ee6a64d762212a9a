//! GLB writer: pictures in space as binary glTF 2.0.
//!
//! Vertices stay in millimetres, relative to the model's centre so that single precision suffices; a root node with a
//! matrix turns them into glTF's metres with y up. Three scenes share the data: `panels` (shown first; panels in
//! distinct colours, with rulings), `deviation` (the same panels coloured by their deviation) and `surface` (the
//! input). Deviations in mm ride along as the vertex attribute `_DEVIATION`; units and tolerance stand in `extras`.

use std::io;

use serde_json::{json, Value};

use crate::geom::mesh::Mesh;
use crate::geom::Vec3;
use crate::tessellate::colour::{self, Rgb};
use crate::tessellate::scene::Scene;

// Component types and targets of the glTF specification, section 3.6.2 and 3.6.1.
const UNSIGNED_BYTE: u32 = 5121;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;
/// Primitive mode of separate line segments.
const LINES: u32 = 1;
/// Metres per millimetre.
const SCALE: f64 = 1e-3;
/// Colour of the input surface.
const SURFACE_COLOUR: Rgb = [0.72, 0.74, 0.77];
/// Colour of the rulings.
const RULING_COLOUR: Rgb = [0.10, 0.12, 0.15];

/// Writes a scene. `tolerance` (mm) is the end of the deviation scale.
///
/// # Errors
/// Those of `out`; a mesh with coordinates that are not finite, corners that do not exist or lists of different
/// lengths ([`io::ErrorKind::InvalidData`]).
pub fn write(out: &mut dyn io::Write, scene: &Scene, name: &str, tolerance: f64) -> io::Result<()> {
    let box_of_all = scene.bbox();
    let centre = if box_of_all.min.x <= box_of_all.max.x { box_of_all.center() } else { Vec3::zeros() };
    let mut g = Gltf { centre, ..Gltf::default() };

    let grey = g.material("surface", SURFACE_COLOUR);
    let white = g.material("deviation", [1.0; 3]);
    let mut surfaces = Vec::new();
    for (i, mesh) in scene.surfaces.iter().enumerate() {
        if let Some(p) = g.triangles(mesh, &format!("surface {i}"))? {
            let extras = json!({ "face": i });
            surfaces.push(g.mesh_node(&format!("surface {i}"), primitive(&p, p.plain(), grey), extras));
        }
    }
    let (mut panels, mut coloured) = (Vec::new(), Vec::new());
    for (i, panel) in scene.panels.iter().enumerate() {
        let Some(p) = g.triangles(&panel.mesh, &panel.name)? else { continue };
        let extras = deviations(&panel.mesh.values);
        let own = g.material(&panel.name, colour::panel(i));
        panels.push(g.mesh_node(&panel.name, primitive(&p, p.plain(), own), extras.clone()));
        let mut attributes = p.plain();
        if !panel.mesh.values.is_empty() {
            attributes["COLOR_0"] = json!(g.colours(&panel.mesh.values, tolerance));
            attributes["_DEVIATION"] = json!(g.values(&panel.mesh.values));
        }
        coloured.push(g.mesh_node(&format!("{} deviation", panel.name), primitive(&p, attributes, white), extras));
    }
    let rulings: Vec<Vec3> = scene.panels.iter().flat_map(|p| p.rulings.iter().flatten().copied()).collect();
    let lines = g.lines("rulings", &rulings)?;

    let panels = g.group("panels", panels);
    let coloured = g.group("deviation", coloured);
    let surfaces = g.group("surface", surfaces);
    let first: Vec<usize> = [panels, lines].into_iter().flatten().collect();
    let scenes =
        [("panels", first), ("deviation", coloured.into_iter().collect()), ("surface", surfaces.into_iter().collect())];
    let scenes: Vec<Value> = scenes
        .into_iter()
        .filter(|(_, children)| !children.is_empty())
        .map(|(title, children)| json!({ "name": title, "nodes": [g.root(title, &children)] }))
        .collect();
    let extras = json!({ "name": name, "unit": "mm", "tolerance": tolerance, "metres_per_unit": SCALE });
    g.finish(out, scenes, extras)
}

/// A document while it grows: its parts as JSON and its block of bytes.
#[derive(Default)]
struct Gltf {
    centre: Vec3,
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    materials: Vec<Value>,
    meshes: Vec<Value>,
    nodes: Vec<Value>,
}

/// Accessors of a mesh.
struct Triangles {
    position: usize,
    normal: Option<usize>,
    index: usize,
}

impl Triangles {
    /// Attributes without colours.
    fn plain(&self) -> Value {
        let mut attributes = json!({ "POSITION": self.position });
        if let Some(normal) = self.normal {
            attributes["NORMAL"] = json!(normal);
        }
        attributes
    }
}

fn primitive(t: &Triangles, attributes: Value, material: usize) -> Value {
    json!({ "attributes": attributes, "indices": t.index, "material": material })
}

impl Gltf {
    /// A view of bytes appended to the block; everything here has a size that is a multiple of four.
    fn view(&mut self, bytes: impl Iterator<Item = u8>, target: u32) -> usize {
        let offset = self.bytes.len();
        self.bytes.extend(bytes);
        let length = self.bytes.len() - offset;
        self.views.push(json!({ "buffer": 0, "byteOffset": offset, "byteLength": length, "target": target }));
        self.views.len() - 1
    }

    fn accessor(&mut self, view: usize, component: u32, kind: &str, count: usize) -> usize {
        self.accessors.push(json!({ "bufferView": view, "componentType": component, "type": kind, "count": count }));
        self.accessors.len() - 1
    }

    /// Points relative to the centre, with the least and the greatest coordinates as rounded.
    fn positions(&mut self, points: &[Vec3]) -> usize {
        let rounded: Vec<[f32; 3]> = points.iter().map(|p| single(&(p - self.centre))).collect();
        let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for p in &rounded {
            for k in 0..3 {
                (low[k], high[k]) = (low[k].min(p[k]), high[k].max(p[k]));
            }
        }
        let view = self.view(rounded.iter().flatten().flat_map(|x| x.to_le_bytes()), VERTICES);
        let accessor = self.accessor(view, FLOAT, "VEC3", points.len());
        self.accessors[accessor]["min"] = json!(low);
        self.accessors[accessor]["max"] = json!(high);
        accessor
    }

    /// Accessors of a mesh; `None` if it is empty.
    fn triangles(&mut self, mesh: &Mesh, name: &str) -> io::Result<Option<Triangles>> {
        let n = mesh.positions.len();
        if n == 0 || mesh.triangles.is_empty() {
            return Ok(None);
        }
        let fits = |count: usize| count == 0 || count == n;
        if !fits(mesh.normals.len()) || !fits(mesh.values.len()) {
            return Err(invalid(name, "has normals or values for some of its vertices only"));
        }
        if mesh.triangles.iter().flatten().any(|&i| i as usize >= n) {
            return Err(invalid(name, "has triangles with corners that do not exist"));
        }
        if !mesh.positions.iter().all(finite) {
            return Err(invalid(name, "has coordinates that are not finite numbers"));
        }
        let position = self.positions(&mesh.positions);
        let normal = (!mesh.normals.is_empty()).then(|| {
            // The specification asks for unit vectors, also where a mesh has no answer.
            let unit = |v: &Vec3| single(&v.try_normalize(0.0).filter(finite).unwrap_or_else(Vec3::z));
            let view = self.view(mesh.normals.iter().flat_map(unit).flat_map(f32::to_le_bytes), VERTICES);
            self.accessor(view, FLOAT, "VEC3", n)
        });
        let corners = mesh.triangles.iter().flatten().flat_map(|i| i.to_le_bytes());
        let view = self.view(corners, INDICES);
        let index = self.accessor(view, UNSIGNED_INT, "SCALAR", 3 * mesh.triangles.len());
        Ok(Some(Triangles { position, normal, index }))
    }

    /// Deviations in mm, one per vertex. Those that are not numbers have no place in the format and become 0; their
    /// colour tells them.
    fn values(&mut self, values: &[f64]) -> usize {
        let plain = |&x: &f64| if x.is_finite() { x as f32 } else { 0.0 };
        let view = self.view(values.iter().map(plain).flat_map(f32::to_le_bytes), VERTICES);
        self.accessor(view, FLOAT, "SCALAR", values.len())
    }

    /// Colours of deviations, one per vertex.
    fn colours(&mut self, values: &[f64], tolerance: f64) -> usize {
        let bytes = values.iter().flat_map(|x| {
            let [r, g, b] = colour::bytes(linear(colour::deviation(x / tolerance)));
            [r, g, b, u8::MAX]
        });
        let view = self.view(bytes, VERTICES);
        let accessor = self.accessor(view, UNSIGNED_BYTE, "VEC4", values.len());
        self.accessors[accessor]["normalized"] = json!(true);
        accessor
    }

    fn material(&mut self, name: &str, c: Rgb) -> usize {
        let [r, g, b] = linear(c);
        self.materials.push(json!({
            "name": name,
            "doubleSided": true,
            "pbrMetallicRoughness": { "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.7 },
        }));
        self.materials.len() - 1
    }

    /// A node with a mesh of one primitive.
    fn mesh_node(&mut self, name: &str, primitive: Value, extras: Value) -> usize {
        self.meshes.push(json!({ "name": name, "primitives": [primitive] }));
        let mut node = json!({ "name": name, "mesh": self.meshes.len() - 1 });
        if !extras.is_null() {
            node["extras"] = extras;
        }
        self.nodes.push(node);
        self.nodes.len() - 1
    }

    /// A node with line segments between successive pairs of points; `None` without any.
    fn lines(&mut self, name: &str, points: &[Vec3]) -> io::Result<Option<usize>> {
        if points.is_empty() {
            return Ok(None);
        }
        if !points.iter().all(finite) {
            return Err(invalid(name, "have coordinates that are not finite numbers"));
        }
        let position = self.positions(points);
        let material = self.material(name, RULING_COLOUR);
        let primitive = json!({ "attributes": { "POSITION": position }, "mode": LINES, "material": material });
        Ok(Some(self.mesh_node(name, primitive, Value::Null)))
    }

    /// A node that holds others together; `None` without any.
    fn group(&mut self, name: &str, children: Vec<usize>) -> Option<usize> {
        if children.is_empty() {
            return None;
        }
        self.nodes.push(json!({ "name": name, "children": children }));
        Some(self.nodes.len() - 1)
    }

    /// The node that turns millimetres with z up into metres with y up: (x, y, z) becomes (x, z, −y).
    fn root(&mut self, title: &str, children: &[usize]) -> usize {
        let (s, c) = (SCALE, self.centre * SCALE);
        let columns = [[s, 0.0, 0.0, 0.0], [0.0, 0.0, -s, 0.0], [0.0, s, 0.0, 0.0], [c.x, c.z, -c.y, 1.0]];
        self.nodes
            .push(json!({ "name": format!("{title} in metres"), "children": children, "matrix": columns.concat() }));
        self.nodes.len() - 1
    }

    /// Header, JSON chunk, binary chunk (glTF 2.0 specification, section 4.4).
    fn finish(mut self, out: &mut dyn io::Write, scenes: Vec<Value>, extras: Value) -> io::Result<()> {
        let mut document = json!({
            "asset": { "version": "2.0", "generator": concat!("torse ", env!("CARGO_PKG_VERSION")), "extras": extras },
        });
        // Lists must not be empty.
        for (name, list) in [
            ("bufferViews", self.views),
            ("accessors", self.accessors),
            ("materials", self.materials),
            ("meshes", self.meshes),
            ("nodes", self.nodes),
            ("scenes", scenes),
        ] {
            if !list.is_empty() {
                document[name] = Value::Array(list);
            }
        }
        if document.get("scenes").is_some() {
            document["scene"] = json!(0);
        }
        if !self.bytes.is_empty() {
            document["buffers"] = json!([{ "byteLength": self.bytes.len() }]);
        }
        let mut text = document.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut chunks = vec![(b"JSON", &text)];
        if !self.bytes.is_empty() {
            chunks.push((b"BIN\0", &self.bytes));
        }
        let total = 12 + chunks.iter().map(|c| 8 + c.1.len()).sum::<usize>();
        out.write_all(b"glTF")?;
        out.write_all(&2u32.to_le_bytes())?;
        out.write_all(&size(total)?)?;
        for (kind, chunk) in chunks {
            out.write_all(&size(chunk.len())?)?;
            out.write_all(kind)?;
            out.write_all(chunk)?;
        }
        Ok(())
    }
}

/// A length as the format stores it.
fn size(n: usize) -> io::Result<[u8; 4]> {
    match u32::try_from(n) {
        Ok(n) => Ok(n.to_le_bytes()),
        Err(_) => Err(io::Error::new(io::ErrorKind::InvalidData, "the model needs more than 4 GB as GLB")),
    }
}

/// Range of the deviations of a mesh, mm.
fn deviations(values: &[f64]) -> Value {
    let finite = || values.iter().copied().filter(|x| x.is_finite());
    if finite().next().is_none() {
        return Value::Null;
    }
    json!({ "unit": "mm", "deviation_min": finite().fold(f64::INFINITY, f64::min), "deviation_max": finite().fold(f64::NEG_INFINITY, f64::max) })
}

fn finite(v: &Vec3) -> bool {
    v.iter().all(|x| x.is_finite())
}

fn single(v: &Vec3) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

/// sRGB to the linear colours of glTF.
fn linear(c: Rgb) -> Rgb {
    c.map(|x| if x <= 0.040_45 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) })
}

fn invalid(name: &str, what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, format!("{name} {what}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tessellate::scene::PanelShape;

    fn scene() -> Scene {
        let mesh = Mesh {
            positions: vec![Vec3::new(1e6, 0., 0.), Vec3::new(1e6 + 100., 0., 0.), Vec3::new(1e6, 200., 50.)],
            normals: vec![Vec3::z(), Vec3::zeros(), Vec3::y() * 2.0],
            triangles: vec![[0, 1, 2]],
            values: vec![-0.5, 0.0, 2.0],
        };
        let rulings = vec![[mesh.positions[0], mesh.positions[1]]];
        let panel = PanelShape { name: "A-01".into(), mesh: mesh.clone(), rulings, borders: Vec::new() };
        Scene { panels: vec![panel], surfaces: vec![mesh] }
    }

    fn chunks(bytes: &[u8]) -> (Value, &[u8]) {
        let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes")) as usize;
        assert_eq!((&bytes[..4], number(4), number(8)), (&b"glTF"[..], 2, bytes.len()));
        let n = number(12);
        assert_eq!(&bytes[16..20], b"JSON");
        let rest = &bytes[20 + n..];
        (serde_json::from_slice(&bytes[20..20 + n]).expect("JSON"), if rest.is_empty() { rest } else { &rest[8..] })
    }

    #[test]
    fn every_accessor_lies_in_the_block_with_true_limits() {
        let mut out = Vec::new();
        write(&mut out, &scene(), "test", 1.0).expect("written");
        let (doc, block) = chunks(&out);
        let list = |name: &str| doc[name].as_array().expect("a list").clone();
        let integer = |v: &Value| v.as_u64().expect("an integer") as usize;
        assert_eq!(integer(&doc["buffers"][0]["byteLength"]), block.len());
        for a in list("accessors") {
            let view = &doc["bufferViews"][integer(&a["bufferView"])];
            let components = match a["type"].as_str() {
                Some("VEC4") => 1, // of one byte each
                Some("VEC3") => 3,
                _ => 1,
            };
            assert_eq!(integer(&view["byteLength"]), 4 * components * integer(&a["count"]));
            let (from, length) = (integer(&view["byteOffset"]), integer(&view["byteLength"]));
            assert!(from % 4 == 0 && from + length <= block.len());
            let Some(min) = a["min"].as_array() else { continue };
            let floats: Vec<f32> = block[from..from + length]
                .chunks(4)
                .map(|b| f32::from_le_bytes(b.try_into().expect("four bytes")))
                .collect();
            for k in 0..3 {
                let least = floats[k..].iter().step_by(3).copied().fold(f32::INFINITY, f32::min);
                assert_eq!(min[k].as_f64(), Some(f64::from(least)));
            }
        }
        let names: Vec<String> = list("nodes").iter().map(|n| n["name"].as_str().expect("a name").into()).collect();
        for name in ["surface", "panels", "A-01", "rulings", "deviation"] {
            assert!(names.iter().any(|n| n == name), "{name}");
        }
        assert_eq!(doc["asset"]["extras"]["tolerance"], json!(1.0));
    }

    #[test]
    fn the_root_node_makes_metres_with_y_up() {
        let mut out = Vec::new();
        write(&mut out, &scene(), "test", 1.0).expect("written");
        let (doc, block) = chunks(&out);
        let matrix: Vec<f64> = doc["nodes"]
            .as_array()
            .and_then(|n| n.iter().find_map(|n| n["matrix"].as_array()))
            .map(|m| m.iter().filter_map(Value::as_f64).collect())
            .expect("a matrix");
        // Third vertex of the first mesh.
        let p: Vec<f64> = (6..9)
            .map(|k| f64::from(f32::from_le_bytes(block[4 * k..4 * k + 4].try_into().expect("four bytes"))))
            .collect();
        let image = |r: usize| (0..3).map(|k| matrix[4 * k + r] * p[k]).sum::<f64>() + matrix[12 + r];
        for (r, expected) in [(0, 1000.0), (1, 0.05), (2, -0.2)] {
            assert!((image(r) - expected).abs() < 1e-9, "{r}: {}", image(r));
        }
    }

    #[test]
    fn nothing_to_show_is_a_valid_file_and_broken_meshes_are_refused() {
        let mut out = Vec::new();
        write(&mut out, &Scene::default(), "empty", 1.0).expect("written");
        let (doc, block) = chunks(&out);
        assert!(block.is_empty() && doc.get("buffers").is_none() && doc.get("scene").is_none());
        for spoil in [
            |m: &mut Mesh| m.positions[0].x = f64::NAN,
            |m: &mut Mesh| m.triangles[0][1] = 3,
            |m: &mut Mesh| m.values.truncate(2),
        ] {
            let mut s = scene();
            spoil(&mut s.panels[0].mesh);
            assert!(write(&mut Vec::new(), &s, "bad", 1.0).expect_err("refused").to_string().contains("A-01"));
        }
    }
}
