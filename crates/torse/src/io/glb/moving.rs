//! Animated models: meshes that pass through stages, as morph targets with weights over time (glTF 2.0, sections 3.7.2.2
//! and 3.11). Formats only.

use super::{File, GlbError, ARRAY_BUFFER, FLOAT};
use crate::draw::colour;
use crate::draw::scene::Scene;
use crate::geom::mesh::Mesh;
use crate::geom::Vec3;
use serde_json::{json, Value};

/// Seconds from one stage to the next.
const STEP: f64 = 0.25;

/// The bytes of a GLB file, with a name for its animation, whose panels move through the stages and back; all stages have the same panels with the
/// same triangles. The model stands in the first stage where animations are not shown.
///
/// # Errors
/// Vertices that are not finite; stages that do not fit the first one; more than 4 GB.
pub fn write(name: &str, stages: &[Scene]) -> Result<Vec<u8>, GlbError> {
    let mut file = File::default();
    let mut nodes = Vec::new();
    let mut moving = Vec::new();
    let targets = stages.len().saturating_sub(1);
    for (i, panel) in stages.first().map_or(&[][..], |s| &s.panels).iter().enumerate() {
        let Some(attributes) = file.attributes(&panel.name, &panel.mesh)? else { continue };
        let mut changes: Vec<Value> = Vec::with_capacity(targets);
        for stage in stages.iter().skip(1) {
            let other =
                stage.panels.get(i).map(|p| &p.mesh).filter(|m| m.positions.len() == panel.mesh.positions.len());
            let index = panel.mesh.positions.len();
            let other = other.ok_or_else(|| GlbError::Stage { name: panel.name.clone() })?;
            let moved = differences(other, &panel.mesh, |m| &m.positions);
            let mut target = json!({ "POSITION": file.positions(&panel.name, &moved)? });
            let turned = differences(other, &panel.mesh, |m| &m.normals);
            if attributes.vertex.contains_key("NORMAL") && turned.len() == index {
                let data: Vec<u8> = turned.iter().flatten().flat_map(|&x| (x as f32).to_le_bytes()).collect();
                target["NORMAL"] = file.accessor(&data, index, (FLOAT, "VEC3"), Some(ARRAY_BUFFER), json!({})).into();
            }
            changes.push(target);
        }
        let title = panel.title();
        let material = file.material(&title, colour::shown(i, panel.marked));
        let node = file.moving_node(&title, &attributes, material, json!({ "unit": "mm" }), changes);
        if targets > 0 {
            moving.push(node);
        }
        nodes.push(node);
    }
    if !moving.is_empty() {
        let accessors = times_and_weights(&mut file, targets);
        file.animations.push(&animation(name, accessors, &moving));
    }
    let root = file.root(name, &nodes, None);
    file.finish(&json!([{ "name": name, "nodes": [root] }]), 0.0)
}

fn differences(a: &Mesh, b: &Mesh, of: impl Fn(&Mesh) -> &Vec<Vec3>) -> Vec<Vec3> {
    of(a).iter().zip(of(b)).map(|(p, q)| p - q).collect()
}

/// Accessors of the times and of the weights: there and back, each stage alone at its time.
fn times_and_weights(file: &mut File, targets: usize) -> [usize; 2] {
    let frames: Vec<usize> = (0..=targets).chain((0..targets).rev()).collect();
    let times: Vec<f64> = (0..frames.len()).map(|k| STEP * k as f64).collect();
    let data: Vec<u8> = times.iter().flat_map(|&t| (t as f32).to_le_bytes()).collect();
    let bounds = json!({ "min": [0.0], "max": [times.last().map_or(0.0, |t| *t as f32)] });
    let time = file.accessor(&data, times.len(), (FLOAT, "SCALAR"), None, bounds);
    let data: Vec<u8> = frames
        .iter()
        .flat_map(|&f| (1..=targets).flat_map(move |t| (if t == f { 1.0_f32 } else { 0.0 }).to_le_bytes()))
        .collect();
    let weights = file.accessor(&data, frames.len() * targets, (FLOAT, "SCALAR"), None, json!({}));
    [time, weights]
}

fn animation(name: &str, accessors: [usize; 2], nodes: &[usize]) -> Value {
    let channels: Vec<Value> =
        nodes.iter().map(|n| json!({ "sampler": 0, "target": { "node": n, "path": "weights" } })).collect();
    json!({
        "name": name,
        "samplers": [{ "input": accessors[0], "output": accessors[1], "interpolation": "LINEAR" }],
        "channels": channels,
    })
}

#[cfg(test)]
mod tests {
    use super::super::tests::open;
    use super::*;
    use crate::draw::scene::PanelShape;

    fn stage(height: f64) -> Scene {
        let mesh = Mesh {
            positions: vec![Vec3::zeros(), Vec3::x(), Vec3::new(1.0, 1.0, height)],
            normals: vec![Vec3::z(); 3],
            triangles: vec![[0, 1, 2]],
            values: Vec::new(),
        };
        Scene { panels: vec![PanelShape { name: "A".into(), mesh, ..PanelShape::default() }], ..Scene::default() }
    }

    #[test]
    fn stages_become_targets_and_weights_select_them_in_turn() {
        let bytes = write("moves", &[stage(0.0), stage(0.5), stage(2.0)]).expect("a file");
        let (document, data) = open(&bytes);
        let mesh = &document["meshes"][0];
        assert_eq!(mesh["primitives"][0]["targets"].as_array().map(Vec::len), Some(2));
        let sampler = &document["animations"][0]["samplers"][0];
        let accessor = |v: &Value| document["accessors"][v.as_u64().expect("an index") as usize].clone();
        let (times, weights) = (accessor(&sampler["input"]), accessor(&sampler["output"]));
        assert_eq!((times["count"].as_u64(), weights["count"].as_u64()), (Some(5), Some(10)));
        assert_eq!(times["max"][0].as_f64(), Some(1.0));
        let start = |a: &Value| {
            let view = &document["bufferViews"][a["bufferView"].as_u64().expect("a view") as usize];
            view["byteOffset"].as_u64().expect("an offset") as usize
        };
        let number = |at: usize| f32::from_le_bytes([data[at], data[at + 1], data[at + 2], data[at + 3]]);
        let list: Vec<f32> = (0..10).map(|k| number(start(&weights) + 4 * k)).collect();
        assert_eq!(list.iter().map(|w| *w as u8).collect::<Vec<_>>(), [0, 0, 1, 0, 0, 1, 1, 0, 0, 0]);
        // The second target lifts the last corner by 2.
        let target = accessor(&mesh["primitives"][0]["targets"][1]["POSITION"]);
        assert!((number(start(&target) + 4 * 8) - 2.0).abs() < 1e-6);
        assert!(document["animations"][0]["channels"][0]["target"]["node"].is_u64());
        // Stages that do not fit are refused, a single one does not move.
        assert!(write("moves", &[stage(0.0), Scene::default()]).is_err());
        assert!(open(&write("moves", &[stage(0.0)]).expect("a file")).0["animations"].is_null());
    }
}
