//! Free curves of an IGES file, in millimetres, for jobs that start from curves.

use super::beside::pieces;
use super::curves::{is_curve, Geometry};
use super::records::{Fault, Records};
use super::sections::Sections;
use super::walk::is_model_curve;
use super::{records, walk, ReadError};
use crate::io::step::read::edges::EdgeCurve;
use std::collections::HashMap;

/// Types of entities that only gather others.
const GATHERING: [u32; 5] = [308, 320, 402, 408, 420];
/// All curves of an IGES file that nothing is made of; where there are none, the edges of its faces. Curves in parts
/// that are copied are read once, as they stand.
///
/// # Errors
/// Not an IGES file, no entities; no curve that can be read.
pub fn curves(bytes: &[u8]) -> Result<Vec<EdgeCurve>, ReadError> {
    let sections = Sections::of(bytes);
    let records = records(bytes, &sections)?;
    let geometry = Geometry { records: &records };
    let users = walk::users(&records);
    let mut ids = loose(&records, &users);
    if ids.is_empty() {
        ids = edges(&records);
    }
    let mut fault: Option<Fault> = None;
    let mut out = Vec::new();
    for id in &ids {
        match pieces(&geometry, *id) {
            Ok(curves) => out.push(EdgeCurve { entity: *id, copy: 1, curves }),
            Err(f) => {
                fault.get_or_insert(f);
            }
        }
    }
    match (out.is_empty(), fault) {
        (true, Some(f)) => Err(ReadError::NoUsableFaces { count: ids.len(), entity: f.entity, reason: f.reason }),
        (true, None) => {
            let reason = "it holds no curves either".to_string();
            Err(ReadError::NoFaces { entities: records.order.len(), reason })
        }
        _ => Ok(out),
    }
}

/// Curves that stand for themselves.
fn loose(records: &Records, users: &HashMap<u64, Vec<u32>>) -> Vec<u64> {
    records
        .all()
        .filter(|e| is_model_curve(e))
        .filter(|e| users.get(&e.number).is_none_or(|u| u.iter().all(|k| GATHERING.contains(k))))
        .map(|e| e.number)
        .collect()
}

/// Curves in space that bound faces, each once; chains by their pieces.
fn edges(records: &Records) -> Vec<u64> {
    let mut out = Vec::new();
    for e in records.all() {
        let found: Vec<u64> = match e.kind {
            142 => e.optional(4).into_iter().collect(),
            141 => walk::children(e).unwrap_or_default().into_iter().skip(1).take(1).collect(),
            504 => walk::children(e).unwrap_or_default().into_iter().filter(|c| is_curve(records.kind(*c))).collect(),
            _ => Vec::new(),
        };
        for id in found.into_iter().filter(|id| *id != 0) {
            let chain = records.get(id).ok().filter(|c| c.kind == 102);
            match chain.and_then(|c| walk::children(c).ok()) {
                Some(pieces) => out.extend(pieces),
                None => out.push(id),
            }
        }
    }
    let mut met = std::collections::HashSet::new();
    out.retain(|id| met.insert(*id));
    out
}
