//! What things and their sorts are called in reasons.

use crate::reason::{Item, Sort};

/// What a thing is called.
pub(in crate::io::words) fn name(item: &Item) -> String {
    match item {
        Item::Named(name) => name.clone(),
        Item::Panel(name) => format!("panel {name}"),
        Item::Strip(name) => format!("strip {name}"),
        Item::Pattern(name) => format!("pattern {name}"),
        Item::Part(name) => format!("part {name}"),
        Item::Record(entity, of) => format!("#{entity}, {}", name(of)),
        Item::Handle(k, curve) => format!("handle {k} on {curve}"),
        Item::Length(k) => format!("length {k}"),
        Item::Elements { row, sort, range } => {
            let of = row.as_ref().map_or(String::new(), |row| format!("{row}: "));
            format!("{of}{} {} to {}", many(*sort), range.start, range.end.saturating_sub(1))
        }
    }
}

pub(super) fn one(sort: Sort) -> &'static str {
    match sort {
        Sort::Points => "point",
        Sort::Rulings => "ruling",
        Sort::Planes => "plane",
    }
}

pub(super) fn many(sort: Sort) -> &'static str {
    match sort {
        Sort::Points => "points",
        Sort::Rulings => "rulings",
        Sort::Planes => "planes",
    }
}

/// A reason in words, with the number of what is left out in front where it has one.
pub(super) fn numbered(entity: Option<u64>, why: &str) -> String {
    match entity {
        Some(entity) => format!("#{entity}: {why}"),
        None => why.into(),
    }
}
