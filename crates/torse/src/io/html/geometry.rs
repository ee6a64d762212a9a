//! The geometry of the 3-D view as one block of bytes with a description, for typed arrays of JavaScript.

use crate::draw::colour;
use crate::draw::scene::Scene;
use crate::geom::mesh::Mesh;
use crate::geom::Vec3;
use serde::Serialize;

/// Steps of the deviation scale handed to the page.
const SCALE_STEPS: usize = 128;

/// What lies where in the block.
#[derive(Debug, Serialize)]
pub(super) struct Header {
    /// The point that the coordinates are relative to, mm.
    pub centre: [f64; 3],
    /// Half diagonal of the model, mm.
    pub radius: f64,
    /// Direction of the first view, towards the eye.
    pub direction: [f64; 3],
    /// Tolerance, mm: end of the deviation scale.
    pub tolerance: f64,
    /// Names of the panels.
    pub names: Vec<String>,
    /// Colours of the panels, `#rrggbb`.
    pub colours: Vec<String>,
    /// Colours of the deviation scale from −tolerance to +tolerance, 0..=255, then the colour beyond it.
    pub scale: Vec<[u8; 3]>,
    /// Triangles of the panels.
    pub panels: MeshPart,
    /// Triangles of the input surface.
    pub surface: MeshPart,
    /// Rulings.
    pub rulings: LinePart,
    /// Borders of the panels.
    pub borders: LinePart,
    /// Lines along which panels meet, coloured by their angle.
    pub joints: LinePart,
    /// Where what is asked is seen to be broken: lines without length.
    pub witnesses: LinePart,
    /// End of the scale of Gauss curvatures, 1/mm².
    pub curvature: f64,
    /// End of the scale of angles, degrees.
    pub angle: f64,
}

/// Byte offsets of a mesh.
#[derive(Debug, Default, Serialize)]
pub(super) struct MeshPart {
    /// Number of vertices.
    pub vertices: usize,
    /// Number of indices.
    pub indices: usize,
    /// 3 × f32 per vertex.
    pub position: usize,
    /// 4 × i16 per vertex, 32767 for 1, so that reflections are smooth; zero where unknown.
    pub normal: usize,
    /// f32 per vertex: deviation, mm.
    pub value: usize,
    /// 4 × u8 per vertex: red, green, blue, unused.
    pub colour: usize,
    /// u32 per vertex: index of the panel.
    pub panel: usize,
    /// f32 per vertex: Gauss curvature, 1/mm².
    pub curvature: usize,
    /// u32 per index.
    pub index: usize,
}

/// Byte offsets of line segments.
#[derive(Debug, Default, Serialize)]
pub(super) struct LinePart {
    /// Number of segments.
    pub segments: usize,
    /// 6 × f32 per segment: both ends.
    pub ends: usize,
    /// u32 per segment: index of the panel.
    pub panel: usize,
    /// f32 per segment: what it is coloured by.
    pub value: usize,
}

/// Description and bytes (little-endian, every array at a multiple of four) of a scene.
pub(super) fn pack(scene: &Scene, direction: &Vec3, tolerance: f64) -> (Header, Vec<u8>) {
    let bbox = scene.bbox();
    let diagonal = bbox.diagonal();
    let centre = if bbox.min.x <= bbox.max.x { bbox.center() } else { Vec3::zeros() };
    let mut block = Block { bytes: Vec::new(), centre };
    let colours: Vec<colour::Rgb> = scene.panels.iter().enumerate().map(|(i, p)| colour::shown(i, p.marked)).collect();
    let panels = scene.panels.iter().zip(&colours).enumerate();
    let none: &[f64] = &[];
    let bent = |kind: usize, i: usize| scene.curvature[kind].get(i).map_or(none, Vec::as_slice);
    let meshes: Vec<_> = panels.map(|(i, (p, c))| (&p.mesh, bent(0, i), i as u32, colour::bytes(*c))).collect();
    let surfaces: Vec<_> =
        scene.surfaces.iter().enumerate().map(|(i, m)| (m, bent(1, i), u32::MAX, [205, 209, 214])).collect();
    let rulings =
        || scene.panels.iter().enumerate().flat_map(|(i, p)| p.rulings.iter().map(move |r| (*r, i as u32, 0.0)));
    let joints = || scene.joints.iter().map(|(ends, angle)| (*ends, u32::MAX, angle.to_degrees()));
    // A line without length is drawn as a dot.
    let witnesses = || scene.witnesses.iter().map(|p| ([*p, *p], u32::MAX, 0.0));
    let angle = scene.joints.iter().map(|j| j.1.to_degrees()).fold(LEAST_ANGLE, f64::max);
    let borders = || {
        let polylines = scene.panels.iter().enumerate().flat_map(|(i, p)| p.borders.iter().map(move |b| (b, i)));
        let guides = scene.guides.iter().map(|g| (g, u32::MAX as usize));
        polylines.chain(guides).flat_map(|(b, i)| b.windows(2).map(move |w| ([w[0], w[1]], i as u32, 0.0)))
    };
    let share = |i: usize| 2.0 * i as f64 / (SCALE_STEPS - 1) as f64 - 1.0;
    let mut scale: Vec<[u8; 3]> = (0..SCALE_STEPS).map(|i| colour::bytes(colour::deviation(share(i)))).collect();
    scale.push(colour::bytes(colour::deviation(f64::INFINITY)));
    let header = Header {
        centre: centre.into(),
        radius: if diagonal > 0.0 { 0.5 * diagonal } else { 1.0 },
        direction: (*direction).into(),
        tolerance,
        names: scene.panels.iter().map(|p| p.title()).collect(),
        colours: colours.iter().map(|c| colour::hex(*c)).collect(),
        scale,
        panels: block.mesh(&meshes),
        surface: block.mesh(&surfaces),
        rulings: block.lines(rulings),
        borders: block.lines(borders),
        joints: block.lines(joints),
        witnesses: block.lines(witnesses),
        curvature: curvature_limit(scene, diagonal),
        angle,
    };
    (header, block.bytes)
}

/// Angle (degrees) that ends the scale at least: smaller ones are no edges.
const LEAST_ANGLE: f64 = 0.1;
/// Share of the vertices whose Gauss curvature is on the scale: near singular points it has no bounds.
const ON_SCALE: f64 = 0.95;
/// Gauss curvature that ends the scale at least, in terms of the size of the model: less is flat.
const LEAST_CURVATURE: f64 = 1e-3;

/// End of the scale of Gauss curvatures, 1/mm².
fn curvature_limit(scene: &Scene, diagonal: f64) -> f64 {
    let mut all: Vec<f64> = scene.curvature.iter().flatten().flatten().map(|k| k.abs()).collect();
    all.sort_by(f64::total_cmp);
    let at = (ON_SCALE * all.len().saturating_sub(1) as f64) as usize;
    let least = if diagonal > 0.0 { LEAST_CURVATURE / (diagonal * diagonal) } else { 1.0 };
    all.get(at).copied().unwrap_or(0.0).max(least)
}

struct Block {
    bytes: Vec<u8>,
    centre: Vec3,
}

impl Block {
    /// Appends an array of words of four bytes and returns where it starts.
    fn array(&mut self, words: impl Iterator<Item = [u8; 4]>) -> usize {
        let start = self.bytes.len();
        self.bytes.extend(words.flatten());
        start
    }

    fn coordinates(&self, p: &Vec3) -> [[u8; 4]; 3] {
        let q = p - self.centre;
        // The page needs finite numbers; a vertex without place is drawn at the centre.
        [q.x, q.y, q.z].map(|x| if x.is_finite() { (x as f32).to_le_bytes() } else { [0; 4] })
    }

    fn points<'a>(&mut self, points: impl Iterator<Item = &'a Vec3>) -> usize {
        let words: Vec<[u8; 4]> = points.flat_map(|p| self.coordinates(p)).collect();
        self.array(words.into_iter())
    }

    fn mesh(&mut self, meshes: &[(&Mesh, &[f64], u32, [u8; 3])]) -> MeshPart {
        let component = |x: f64| ((x * f64::from(i16::MAX)).round() as i16).to_le_bytes();
        let normal = |mesh: &Mesh, i: usize| match mesh.normals.get(i) {
            Some(n) if n.iter().all(|x| x.is_finite()) => {
                let [x, y, z] = [n.x, n.y, n.z].map(component);
                [[x[0], x[1], y[0], y[1]], [z[0], z[1], 0, 0]]
            }
            _ => [[0; 4]; 2],
        };
        let value = |mesh: &Mesh, i: usize| (mesh.values.get(i).copied().unwrap_or(0.0) as f32).to_le_bytes();
        let each = || meshes.iter().flat_map(|m| (0..m.0.positions.len()).map(move |i| (m, i)));
        let mut part = MeshPart { vertices: each().count(), ..MeshPart::default() };
        part.position = self.points(meshes.iter().flat_map(|m| &m.0.positions));
        part.normal = self.array(each().flat_map(|(m, i)| normal(m.0, i)));
        part.value = self.array(each().map(|(m, i)| value(m.0, i)));
        part.colour = self.array(each().map(|(m, _)| [m.3[0], m.3[1], m.3[2], 255]));
        part.panel = self.array(each().map(|(m, _)| m.2.to_le_bytes()));
        let bent = |m: &(&Mesh, &[f64], u32, [u8; 3]), i: usize| m.1.get(i).copied().unwrap_or(0.0) as f32;
        part.curvature = self.array(each().map(|(m, i)| bent(m, i).to_le_bytes()));
        let mut first = 0;
        let mut indices = Vec::new();
        for (mesh, ..) in meshes {
            let count = mesh.positions.len() as u32;
            let valid = mesh.triangles.iter().filter(|t| t.iter().all(|&k| k < count));
            indices.extend(valid.flatten().map(|k| k + first));
            first += count;
        }
        part.indices = indices.len();
        part.index = self.array(indices.iter().map(|k| k.to_le_bytes()));
        part
    }

    fn lines<I: Iterator<Item = ([Vec3; 2], u32, f64)>>(&mut self, segments: impl Fn() -> I) -> LinePart {
        let ends: Vec<Vec3> = segments().flat_map(|(s, ..)| s).collect();
        LinePart {
            segments: ends.len() / 2,
            ends: self.points(ends.iter()),
            panel: self.array(segments().map(|(_, panel, _)| panel.to_le_bytes())),
            value: self.array(segments().map(|(.., value)| (value as f32).to_le_bytes())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::scene::PanelShape;

    #[test]
    fn arrays_lie_where_the_header_says() {
        let mesh = |x: f64| Mesh {
            positions: vec![Vec3::new(x, 0.0, 0.0), Vec3::new(x + 2.0, 0.0, 0.0), Vec3::new(x, 2.0, 0.0)],
            normals: vec![Vec3::z(); 3],
            triangles: vec![[0, 1, 2], [0, 1, 9]],
            values: vec![0.5; 3],
        };
        let shape = |x: f64| PanelShape {
            mesh: mesh(x),
            rulings: vec![[Vec3::zeros(), Vec3::x()]],
            borders: vec![vec![Vec3::zeros(), Vec3::x(), Vec3::y()]],
            ..PanelShape::default()
        };
        let scene = Scene { panels: vec![shape(0.0), shape(4.0)], surfaces: vec![], ..Scene::default() };
        let (header, bytes) = pack(&scene, &Vec3::z(), 1.0);
        assert_eq!(header.centre, [3.0, 1.0, 0.0]);
        assert_eq!((header.panels.vertices, header.panels.indices), (6, 6));
        assert_eq!((header.rulings.segments, header.borders.segments), (2, 4));
        let f32_at = |at: usize| f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
        let u32_at = |at: usize| u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
        assert_eq!(f32_at(header.panels.position + 3 * 12), 1.0);
        assert_eq!(u32_at(header.panels.panel + 5 * 4), 1);
        assert_eq!(u32_at(header.panels.index + 3 * 4), 3);
        let z = header.panels.normal + 4;
        assert_eq!(i16::from_le_bytes([bytes[z], bytes[z + 1]]), i16::MAX);
        assert_eq!(header.borders.value + 4 * 4, header.joints.ends);
        // A curvature and a joint are where the header says, on scales that reach them.
        let scene = Scene {
            curvature: [vec![vec![0.25; 3], vec![-0.5; 3]], vec![]],
            joints: vec![([Vec3::zeros(), Vec3::x()], std::f64::consts::FRAC_PI_6)],
            ..scene
        };
        let (header, bytes) = pack(&scene, &Vec3::z(), 1.0);
        let f32_at = |at: usize| f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
        assert_eq!((f32_at(header.panels.curvature), f32_at(header.panels.curvature + 4 * 5)), (0.25, -0.5));
        assert!((f64::from(f32_at(header.joints.value)) - 30.0).abs() < 1e-5 && (header.angle - 30.0).abs() < 1e-9);
        assert_eq!(header.curvature, 0.5);
        assert_eq!(header.joints.value + 4, header.witnesses.ends);
        // A place is a line without length.
        let scene = Scene { witnesses: vec![Vec3::new(4.0, 1.0, 0.0)], ..scene };
        let (header, bytes) = pack(&scene, &Vec3::z(), 1.0);
        let f32_at = |at: usize| f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
        let ends: Vec<f32> = (0..6).map(|k| f32_at(header.witnesses.ends + 4 * k)).collect();
        assert_eq!((header.witnesses.segments, ends), (1, vec![1.0, 0.0, 0.0, 1.0, 0.0, 0.0]));
        assert_eq!(header.witnesses.value + 4, bytes.len());
    }
}
