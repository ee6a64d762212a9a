//! Models for viewers: binary glTF 2.0 (Khronos specification). Formats only.
//!
//! Vertices are millimetres with Z up, as in the model; every root node carries the matrix to glTF's metres with Y
//! up. Surface, panels and deviation lie within the tolerance of each other and would flicker through each other, so
//! they are three scenes: "panels" (shown first) with rulings and borders, "deviation" with vertex colours,
//! "surface". The signed deviation in mm is also the vertex attribute `_DEVIATION` of the panels.

pub(crate) mod moving;

use crate::draw::colour::{self, Rgb};
use crate::draw::scene::Scene;
use crate::geom::mesh::Mesh;
use crate::geom::Vec3;
use serde_json::{json, Map, Value};
use std::fmt::Write as _;

/// A scene that cannot be written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GlbError {
    /// A vertex that is not finite in single precision.
    #[error("{name}: vertex {index} is not a finite number; its mesh has to be made again")]
    NotFinite {
        /// Mesh or lines.
        name: String,
        /// Index of the vertex.
        index: usize,
    },
    /// A stage of an animation whose panels are not those of the first stage.
    #[error("{name}: a stage of the animation has other vertices than the first stage; make all stages alike")]
    Stage {
        /// Mesh.
        name: String,
    },
    /// A triangle with a corner that does not exist.
    #[error("{name}: triangle {index} refers to a vertex that does not exist")]
    Triangle {
        /// Mesh.
        name: String,
        /// Index of the triangle.
        index: usize,
    },
    /// The format counts bytes with 32 bits.
    #[error("the model needs {0} bytes, more than the 4 GB that a GLB file can hold; use a coarser mesh")]
    TooLarge(usize),
}

/// From millimetres with Z up to metres with Y up, by columns.
const TO_METRES: [f64; 16] = [1e-3, 0.0, 0.0, 0.0, 0.0, 0.0, -1e-3, 0.0, 0.0, 1e-3, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
/// Normals must have unit length; by this they may differ, several times the rounding to single precision.
const UNIT_LENGTH: f64 = 1e-6;
const SURFACE: Rgb = [0.80, 0.82, 0.85];
const RULING: Rgb = [0.25, 0.27, 0.31];
const BORDER: Rgb = [0.08, 0.09, 0.12];
const GUIDE: Rgb = [0.78, 0.16, 0.12];

// Numbers of the specification.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const UNSIGNED_BYTE: u32 = 5121;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const LINES: u32 = 1;
const TRIANGLES: u32 = 4;

/// The bytes of a GLB file. Deviations are coloured from −`tolerance` to `tolerance` (mm).
///
/// # Errors
/// Vertices that are not finite, triangles with missing corners, more than 4 GB.
pub(crate) fn write(scene: &Scene, tolerance: f64) -> Result<Vec<u8>, GlbError> {
    let mut file = File::default();
    let grey = file.material("surface", SURFACE);
    let white = file.material("deviation", [1.0; 3]);
    let (dark, black) = (file.material("rulings", RULING), file.material("borders", BORDER));
    let red = file.material("guides", GUIDE);

    let mut surfaces = Vec::new();
    for (i, mesh) in scene.surfaces.iter().enumerate() {
        let name = format!("face {}", i + 1);
        if let Some(attributes) = file.attributes(&name, mesh)? {
            surfaces.push(file.mesh_node(&name, &attributes, grey, json!({})));
        }
    }
    let (mut panels, mut deviations) = (Vec::new(), Vec::new());
    for (i, panel) in scene.panels.iter().enumerate() {
        let Some(mut attributes) = file.attributes(&panel.name, &panel.mesh)? else { continue };
        let values = &panel.mesh.values;
        let mut extras = json!({ "unit": "mm" });
        if values.len() == panel.mesh.positions.len() && values.iter().all(|v| v.is_finite()) {
            let (least, most) =
                values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &v| (a.min(v), b.max(v)));
            extras = json!({ "unit": "mm", "sampled_deviation": [least, most] });
            let bytes: Vec<u8> = values.iter().flat_map(|&v| (v as f32).to_le_bytes()).collect();
            let accessor = file.accessor(&bytes, values.len(), (FLOAT, "SCALAR"), Some(ARRAY_BUFFER), json!({}));
            attributes.vertex.insert("_DEVIATION".into(), accessor.into());
        }
        let title = panel.title();
        let material = file.material(&title, colour::shown(i, panel.marked));
        panels.push(file.mesh_node(&title, &attributes, material, extras.clone()));
        if attributes.vertex.contains_key("_DEVIATION") {
            let bytes: Vec<u8> = values
                .iter()
                .flat_map(|v| {
                    let [r, g, b] = colour::bytes(linear(colour::deviation(v / tolerance)));
                    [r, g, b, u8::MAX]
                })
                .collect();
            let fixed = json!({ "normalized": true });
            let accessor = file.accessor(&bytes, values.len(), (UNSIGNED_BYTE, "VEC4"), Some(ARRAY_BUFFER), fixed);
            attributes.vertex.insert("COLOR_0".into(), accessor.into());
            deviations.push(file.mesh_node(&title, &attributes, white, extras));
        }
    }
    let rulings: Vec<Vec3> = scene.panels.iter().flat_map(|p| p.rulings.iter().flatten().copied()).collect();
    let borders: Vec<Vec3> = scene
        .panels
        .iter()
        .flat_map(|p| p.borders.iter().flat_map(|b| b.windows(2).flat_map(|w| [w[0], w[1]])))
        .collect();

    let guides: Vec<Vec3> = scene.guides.iter().flat_map(|g| g.windows(2).flat_map(|w| [w[0], w[1]])).collect();

    let mut first = vec![file.root("panels", &panels, None)];
    for (name, points, material) in [("rulings", rulings, dark), ("borders", borders, black), ("guides", guides, red)] {
        if name == "guides" && points.is_empty() {
            continue;
        }
        let mesh = file.lines(name, &points, material)?;
        first.push(file.root(name, &[], mesh));
    }
    let second = file.root("deviation", &deviations, None);
    let third = file.root("surface", &surfaces, None);
    let scenes = json!([
        { "name": "panels", "nodes": first },
        { "name": "deviation", "nodes": [second] },
        { "name": "surface", "nodes": [third] },
    ]);
    file.finish(&scenes, tolerance)
}

/// Accessors of a mesh.
struct Attributes {
    vertex: Map<String, Value>,
    indices: usize,
}

/// Members of an array, as text: models of many panels have hundreds of thousands.
#[derive(Default)]
struct Members {
    text: String,
    count: usize,
}

impl Members {
    /// Appends one; answers its index.
    fn push(&mut self, member: &Value) -> usize {
        if self.count > 0 {
            self.text.push(',');
        }
        // Writing to a string cannot fail.
        _ = write!(self.text, "{member}");
        self.count += 1;
        self.count - 1
    }
}

/// A file in the making.
#[derive(Default)]
struct File {
    bytes: Vec<u8>,
    views: Members,
    accessors: Members,
    materials: Members,
    meshes: Members,
    nodes: Members,
    animations: Members,
}

impl File {
    /// Appends data as a view and an accessor of its own; `more` holds further members of the accessor.
    fn accessor(
        &mut self,
        data: &[u8],
        count: usize,
        (component, shape): (u32, &str),
        target: Option<u32>,
        mut more: Value,
    ) -> usize {
        // Every kind of component used here is aligned when views start at multiples of four.
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": data.len() });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.bytes.extend_from_slice(data);
        more["bufferView"] = self.views.push(&view).into();
        more["componentType"] = component.into();
        more["count"] = count.into();
        more["type"] = shape.into();
        self.accessors.push(&more)
    }

    /// Positions with their least and greatest coordinates, which the specification asks for.
    fn positions(&mut self, name: &str, points: &[Vec3]) -> Result<usize, GlbError> {
        let (mut least, mut most) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        let mut data = Vec::with_capacity(12 * points.len());
        for (index, p) in points.iter().enumerate() {
            for k in 0..3 {
                let x = p[k] as f32;
                if !x.is_finite() {
                    return Err(GlbError::NotFinite { name: name.to_owned(), index });
                }
                (least[k], most[k]) = (least[k].min(x), most[k].max(x));
                data.extend_from_slice(&x.to_le_bytes());
            }
        }
        let bounds = json!({ "min": least, "max": most });
        Ok(self.accessor(&data, points.len(), (FLOAT, "VEC3"), Some(ARRAY_BUFFER), bounds))
    }

    /// Positions, normals and triangles; `None` for a mesh without triangles.
    fn attributes(&mut self, name: &str, mesh: &Mesh) -> Result<Option<Attributes>, GlbError> {
        let n = mesh.positions.len();
        if mesh.triangles.is_empty() {
            return Ok(None);
        }
        if let Some(index) = mesh.triangles.iter().position(|t| t.iter().any(|&k| k as usize >= n)) {
            return Err(GlbError::Triangle { name: name.to_owned(), index });
        }
        let mut vertex = Map::new();
        vertex.insert("POSITION".into(), self.positions(name, &mesh.positions)?.into());
        // Without normals, viewers draw the triangles flat.
        let unit = |v: &Vec3| (v.norm() - 1.0).abs() < UNIT_LENGTH;
        if mesh.normals.len() == n && mesh.normals.iter().all(unit) {
            let data: Vec<u8> = mesh.normals.iter().flatten().flat_map(|&x| (x as f32).to_le_bytes()).collect();
            let accessor = self.accessor(&data, n, (FLOAT, "VEC3"), Some(ARRAY_BUFFER), json!({}));
            vertex.insert("NORMAL".into(), accessor.into());
        }
        let data: Vec<u8> = mesh.triangles.iter().flatten().flat_map(|k| k.to_le_bytes()).collect();
        let count = 3 * mesh.triangles.len();
        let indices = self.accessor(&data, count, (UNSIGNED_INT, "SCALAR"), Some(ELEMENT_ARRAY_BUFFER), json!({}));
        Ok(Some(Attributes { vertex, indices }))
    }

    fn material(&mut self, name: &str, colour: Rgb) -> usize {
        let [r, g, b] = linear(colour);
        self.materials.push(&json!({
            "name": name,
            "doubleSided": true,
            "pbrMetallicRoughness": { "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.8 },
        }))
    }

    fn mesh_node(&mut self, name: &str, attributes: &Attributes, material: usize, extras: Value) -> usize {
        self.moving_node(name, attributes, material, extras, Vec::new())
    }

    /// A mesh with what its vertices move by from stage to stage, and its node.
    fn moving_node(
        &mut self,
        name: &str,
        attributes: &Attributes,
        material: usize,
        extras: Value,
        targets: Vec<Value>,
    ) -> usize {
        let mut primitive = json!({
            "attributes": attributes.vertex, "indices": attributes.indices, "material": material, "mode": TRIANGLES,
        });
        let mut mesh = json!({ "name": name, "extras": extras });
        if !targets.is_empty() {
            mesh["weights"] = vec![0.0; targets.len()].into();
            primitive["targets"] = targets.into();
        }
        mesh["primitives"] = json!([primitive]);
        let mesh = self.meshes.push(&mesh);
        self.nodes.push(&json!({ "name": name, "mesh": mesh }))
    }

    /// Separate lines between consecutive pairs of points; `None` for no points.
    fn lines(&mut self, name: &str, points: &[Vec3], material: usize) -> Result<Option<usize>, GlbError> {
        if points.is_empty() {
            return Ok(None);
        }
        let positions = self.positions(name, points)?;
        let primitive = json!({ "attributes": { "POSITION": positions }, "material": material, "mode": LINES });
        Ok(Some(self.meshes.push(&json!({ "name": name, "primitives": [primitive] }))))
    }

    /// A node with the change of units.
    fn root(&mut self, name: &str, children: &[usize], mesh: Option<usize>) -> usize {
        let mut node = json!({ "name": name, "matrix": TO_METRES });
        if !children.is_empty() {
            node["children"] = children.into();
        }
        if let Some(mesh) = mesh {
            node["mesh"] = mesh.into();
        }
        self.nodes.push(&node)
    }

    /// Header, JSON chunk, binary chunk.
    fn finish(mut self, scenes: &Value, tolerance: f64) -> Result<Vec<u8>, GlbError> {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let asset = json!({
            "version": "2.0",
            "generator": concat!("torse ", env!("CARGO_PKG_VERSION")),
            "extras": { "vertex_unit": "mm", "tolerance": tolerance },
        });
        let mut text = format!("{{\"asset\":{asset},\"scene\":0,\"scenes\":{scenes}");
        if !self.bytes.is_empty() {
            // Writing to a string cannot fail.
            _ = write!(text, ",\"buffers\":[{{\"byteLength\":{}}}]", self.bytes.len());
        }
        for (name, members) in [
            ("nodes", self.nodes),
            ("materials", self.materials),
            ("meshes", self.meshes),
            ("accessors", self.accessors),
            ("bufferViews", self.views),
            ("animations", self.animations),
        ] {
            // The specification has no empty arrays.
            if members.count > 0 {
                _ = write!(text, ",\"{name}\":[{}]", members.text);
            }
        }
        text.push('}');
        let mut text = text.into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut chunks: Vec<(&[u8; 4], &[u8])> = vec![(b"JSON", &text)];
        if !self.bytes.is_empty() {
            chunks.push((b"BIN\0", &self.bytes));
        }
        let total = 12 + chunks.iter().map(|c| 8 + c.1.len()).sum::<usize>();
        let length = |n: usize| u32::try_from(n).map_err(|_| GlbError::TooLarge(total));
        let mut out = Vec::with_capacity(total);
        out.extend_from_slice(b"glTF");
        out.extend_from_slice(&2u32.to_le_bytes());
        out.extend_from_slice(&length(total)?.to_le_bytes());
        for (kind, data) in chunks {
            out.extend_from_slice(&length(data.len())?.to_le_bytes());
            out.extend_from_slice(kind);
            out.extend_from_slice(data);
        }
        Ok(out)
    }
}

/// sRGB to the linear light that glTF asks for.
fn linear(c: Rgb) -> Rgb {
    c.map(|x| if x <= 0.040_45 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::draw::scene::PanelShape;

    fn square() -> Mesh {
        Mesh {
            positions: vec![Vec3::zeros(), Vec3::x() * 1000.0, Vec3::new(1000.0, 0.0, 0.1), Vec3::z() * -250.0],
            normals: vec![-Vec3::y(); 4],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            values: vec![0.0, 2.0, -1.0, 0.5],
        }
    }

    fn scene() -> Scene {
        let panel = PanelShape {
            name: "A-01".into(),
            mesh: square(),
            rulings: vec![[Vec3::zeros(), Vec3::x()]],
            borders: vec![vec![Vec3::zeros(), Vec3::x(), Vec3::z()]],
            marked: false,
        };
        Scene {
            panels: vec![panel.clone(), PanelShape { name: "A-02".into(), ..panel }],
            surfaces: vec![square()],
            ..Scene::default()
        }
    }

    fn word(bytes: &[u8], at: usize) -> usize {
        u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]) as usize
    }

    /// The document and the binary chunk, with the framing checked on the way.
    pub(crate) fn open(bytes: &[u8]) -> (Value, &[u8]) {
        assert_eq!((&bytes[..4], word(bytes, 4), word(bytes, 8)), (&b"glTF"[..], 2, bytes.len()));
        let n = word(bytes, 12);
        assert_eq!((&bytes[16..20], n % 4), (&b"JSON"[..], 0));
        let document = serde_json::from_slice(&bytes[20..20 + n]).expect("a document");
        let rest = &bytes[20 + n..];
        if !rest.is_empty() {
            assert_eq!((&rest[4..8], word(rest, 0)), (&b"BIN\0"[..], rest.len() - 8));
        }
        (document, rest.get(8..).unwrap_or(&[]))
    }

    fn index(v: &Value) -> usize {
        v.as_u64().expect("an index") as usize
    }

    #[test]
    fn accessors_lie_in_the_buffer_aligned_and_with_true_bounds() {
        let bytes = write(&scene(), 2.0).expect("a file");
        let (document, data) = open(&bytes);
        let accessors = document["accessors"].as_array().expect("accessors");
        let mut bounded = 0;
        for a in accessors {
            let view = &document["bufferViews"][index(&a["bufferView"])];
            let (start, length) = (index(&view["byteOffset"]), index(&view["byteLength"]));
            let parts = match a["type"].as_str() {
                Some("SCALAR") => 1,
                Some("VEC3") => 3,
                _ => 4,
            };
            let size = if index(&a["componentType"]) == UNSIGNED_BYTE as usize { 1 } else { 4 };
            assert_eq!((start % 4, length), (0, parts * size * index(&a["count"])));
            assert!(start + length <= data.len() && data.len() == index(&document["buffers"][0]["byteLength"]));
            if a["min"].is_null() {
                continue;
            }
            bounded += 1;
            for k in 0..3 {
                let column = (0..index(&a["count"])).map(|i| f32::from_bits(word(data, start + 12 * i + 4 * k) as u32));
                let (least, most) = column.fold((f32::MAX, f32::MIN), |(a, b), x| (a.min(x), b.max(x)));
                let stated = [&a["min"][k], &a["max"][k]].map(|v| v.as_f64().expect("a bound") as f32);
                assert_eq!(stated.map(f32::to_bits), [least, most].map(f32::to_bits));
            }
        }
        // Three meshes, rulings and borders; the deviation shares the positions of the panels.
        assert_eq!(bounded, 5);
    }

    #[test]
    fn millimetres_with_z_up_become_metres_with_y_up() {
        let m = nalgebra::Matrix4::from_column_slice(&TO_METRES);
        let p = m * nalgebra::Vector4::new(1000.0, 2000.0, 3000.0, 1.0);
        assert!((p - nalgebra::Vector4::new(1.0, 3.0, -2.0, 1.0)).norm() < 1e-12);
        assert!(m.fixed_view::<3, 3>(0, 0).determinant() > 0.0);
        let bytes = write(&scene(), 2.0).expect("a file");
        let (document, _) = open(&bytes);
        let nodes = |scene: usize| document["scenes"][scene]["nodes"].as_array().expect("nodes").clone();
        let mut names = Vec::new();
        for k in (0..3).flat_map(nodes) {
            let node = &document["nodes"][index(&k)];
            assert_eq!(node["matrix"].as_array().map(Vec::len), Some(16));
            names.push(node["name"].as_str().expect("a name").to_owned());
        }
        assert_eq!(names, ["panels", "rulings", "borders", "deviation", "surface"]);
        assert!(nodes(0).len() == 3 && index(&document["scene"]) == 0);
    }

    #[test]
    fn panels_differ_in_colour_and_carry_their_deviation() {
        let bytes = write(&scene(), 2.0).expect("a file");
        let (document, data) = open(&bytes);
        let mesh = |name: &str, colours: bool| {
            let all = document["meshes"].as_array().expect("meshes");
            let found = all
                .iter()
                .find(|m| m["name"] == name && m["primitives"][0]["attributes"]["COLOR_0"].is_null() != colours);
            found.expect("a mesh")["primitives"][0].clone()
        };
        let factor = |m: &Value| document["materials"][index(&m["material"])]["pbrMetallicRoughness"].clone();
        assert_ne!(factor(&mesh("A-01", false)), factor(&mesh("A-02", false)));
        let a = &document["accessors"][index(&mesh("A-02", true)["attributes"]["COLOR_0"])];
        let start = index(&document["bufferViews"][index(&a["bufferView"])]["byteOffset"]);
        let rgba = &data[start..start + 16];
        // Nothing at the first vertex, most outwards at the second, inwards at the third.
        assert!(rgba[..3].iter().all(|&c| c > 200) && rgba[4] > rgba[6] && rgba[8] < rgba[10]);
        assert_eq!(document["meshes"][1]["extras"]["sampled_deviation"], json!([-1.0, 2.0]));
    }

    #[test]
    fn what_viewers_cannot_load_is_refused_or_left_out() {
        let (document, data) = {
            let bytes = write(&Scene::default(), 1.0).expect("an empty file");
            let (d, b) = open(&bytes);
            (d, b.len())
        };
        assert!(document["meshes"].is_null() && data == 0);
        let mut bad = scene();
        bad.panels[1].mesh.positions[2].y = 1e300;
        assert_eq!(write(&bad, 1.0), Err(GlbError::NotFinite { name: "A-02".into(), index: 2 }));
        let mut bad = scene();
        bad.surfaces[0].triangles[1][0] = 4;
        assert_eq!(write(&bad, 1.0), Err(GlbError::Triangle { name: "face 1".into(), index: 1 }));
        let mut plain = scene();
        plain.panels[0].mesh.values.clear();
        plain.panels[0].mesh.normals[3] = Vec3::zeros();
        let bytes = write(&plain, 1.0).expect("a file");
        let attributes = open(&bytes).0["meshes"][1]["primitives"][0]["attributes"].clone();
        assert_eq!(attributes.as_object().map(Map::len), Some(1), "neither normals nor deviation: {attributes}");
    }
}
