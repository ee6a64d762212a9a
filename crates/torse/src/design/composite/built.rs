//! A system with the meaning of its unknowns and blocks \[W15\].

use super::check::{facet_item, handle_item, strip_item};
use super::Composite;
use crate::constraint::proximity::Scale;
use crate::num::gauss_newton::System;

/// What a block is about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Item {
    Ruling { strip: usize, u: f64 },
    Plane { strip: usize },
    Facet(usize),
    Join(usize),
    Handle(usize),
    Length(usize),
    Target(usize),
    Fairness,
}

/// Where a handle's numbers are among the unknowns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum HandleAt {
    /// A control point that is the handle's place itself.
    Control(u32),
    /// A frozen point or direction.
    Vector(u32),
    /// A frozen point and a normal.
    Plane(u32, u32),
}

/// A system with the meaning of its unknowns and blocks.
pub(super) struct Built {
    pub system: System,
    pub start: Vec<f64>,
    /// First unknown of every control point, by curve.
    pub points: Vec<Vec<u32>>,
    pub handles: Vec<HandleAt>,
    pub items: Vec<Item>,
    pub scale: Scale,
}

/// What an item is called.
pub(super) fn describe(c: &Composite, item: Item) -> String {
    match item {
        Item::Ruling { strip, u } => format!("{}, ruling u = {u:.4}", strip_item(c, strip)),
        Item::Plane { strip } => strip_item(c, strip).to_string(),
        Item::Facet(k) => facet_item(c, k).to_string(),
        Item::Join(k) => format!("join {k}"),
        Item::Handle(k) => c.handles.get(k).map_or(String::new(), |h| handle_item(k, h).to_string()),
        Item::Length(k) => format!("length {k}"),
        Item::Target(k) => format!("target {k}"),
        Item::Fairness => "fairness".into(),
    }
}
