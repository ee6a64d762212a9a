//! What is wrong with a composite, by name of the item.

use super::handle::{Handle, Hold, Place, Strength};
use super::{Composite, Join, Smoothness, StripShape};
use crate::constraint::developability::freedom_per_interval;
use crate::geom::{BBox, Vec3};
use crate::num::gauss_newton::system::SystemError;
use crate::spline::SplineError;
use std::fmt;

/// An item of a composite: words for people, and the place for whoever must find it.
#[derive(Clone, Debug, PartialEq)]
pub struct At {
    /// Name of the list that holds it: curves, strips, facets, joins, handles, lengths, targets.
    pub list: &'static str,
    /// Index in the list, from 0.
    pub index: usize,
    /// What of it is meant; empty for all.
    pub field: &'static str,
    words: String,
}

impl At {
    /// The item as a path from the root of a document: `$.handles[2].curve`.
    pub fn path(&self) -> String {
        let dot = if self.field.is_empty() { "" } else { "." };
        format!("$.{}[{}]{dot}{}", self.list, self.index, self.field)
    }

    fn of(mut self: Box<Self>, field: &'static str) -> Box<Self> {
        self.field = field;
        self
    }
}

impl fmt::Display for At {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.words)
    }
}

/// A composite that cannot be set up. Indices count from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CompositeError {
    /// There are no strips.
    #[error("there are no strips; name two curves for the sides of one, or take strips over from an earlier result")]
    Empty,
    /// Two items with one name; planar pieces count as strips.
    #[error("two {kind}s are called '{name}'; every name must be used once")]
    TwoOfAName {
        /// Curve or strip.
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// A name that nothing has.
    #[error("{item} names the {kind} '{name}', which does not exist{}", if .there.is_empty() { String::new() } else { format!("; there are {}", .there.join(", ")) })]
    Unknown {
        /// The item that names it.
        item: Box<At>,
        /// Curve or strip.
        kind: &'static str,
        /// The name.
        name: String,
        /// Names that exist, the first few.
        there: Vec<String>,
    },
    /// A number that is not usable.
    #[error("{item}: {what} is {value}; {needed}")]
    Number {
        /// The item.
        item: Box<At>,
        /// The number's name.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What is needed.
        needed: &'static str,
    },
    /// Sides of a strip that do not fit together.
    #[error("{item}: '{}' and '{}' have different degrees or knots; give both the same, for example by knot insertion", .sides[0], .sides[1])]
    Knots {
        /// The strip.
        item: Box<At>,
        /// Names of its sides.
        sides: [String; 2],
    },
    /// Knots with which developability asks for more than control points can give.
    #[error("{item}: degree {degree} with knots of multiplicity {multiplicity} has fewer control points than developability has conditions; repeat interior knots (degree 3: twice, degree 5: three times) or use degree 2")]
    Stiff {
        /// The strip.
        item: Box<At>,
        /// Degree.
        degree: usize,
        /// Least multiplicity of an interior knot.
        multiplicity: usize,
    },
    /// Knots that do not end at the ends of the curve.
    #[error("{item}: the knots are not clamped; repeat the first and the last one degree + 1 times")]
    Unclamped {
        /// The curve.
        item: Box<At>,
    },
    /// Curves that lie on each other.
    #[error("{item}: '{}' and '{}' coincide, so there is nothing between them", .sides[0], .sides[1])]
    Coinciding {
        /// The strip.
        item: Box<At>,
        /// Names of its sides.
        sides: [String; 2],
    },
    /// A handle on a curve that is no part of a strip, or beyond its ends.
    #[error("{item} holds nothing: {reason}")]
    Nothing {
        /// The handle.
        item: Box<At>,
        /// Why.
        reason: String,
    },
    /// Demands that cannot both be met.
    #[error("{first} and {second} contradict each other: they hold one point to places {distance:.6} mm apart")]
    Contradiction {
        /// One item.
        first: Box<At>,
        /// The other.
        second: String,
        /// Distance of the places, mm.
        distance: f64,
    },
    /// A length between places that are held at another distance.
    #[error("{item} asks for {length} mm between two places that are held {distance:.6} mm apart; let one of them go, or change the length")]
    HeldApart {
        /// The length.
        item: Box<At>,
        /// What it asks for, mm.
        length: f64,
        /// What is held, mm.
        distance: f64,
    },
    /// A curve that is not shared by two strips.
    #[error("{item} needs a curve between two strips, but '{curve}' belongs to {count}")]
    NotShared {
        /// The join.
        item: Box<At>,
        /// The curve.
        curve: String,
        /// Number of strips that it bounds.
        count: usize,
    },
    /// More equations than unknowns.
    #[error("{item} asks for more than there is, {conditions} conditions for {free} free coordinates in all: {help}")]
    OverDetermined {
        /// The item with which it becomes too much.
        item: Box<At>,
        /// Conditions.
        conditions: usize,
        /// Free coordinates.
        free: usize,
        /// What would help.
        help: &'static str,
    },
    /// A planar piece with the wrong number of corners.
    #[error("{item} has {count} corners; give 3 or 4, and a distance only to one with 3")]
    Corners {
        /// The piece.
        item: Box<At>,
        /// Number of corners.
        count: usize,
    },
    /// Equal curvature of strips of which nothing is asked.
    #[error("{item}: equal curvature (G2) is for developables, not for '{strip}'; ask for G1 or C1")]
    Skew {
        /// The join.
        item: Box<At>,
        /// The ruled strip, or the curve that ends.
        strip: String,
    },
    /// A place that must be an end of its curve.
    #[error("{item}: u = {u} of '{curve}' is no end of it; its ends are {} and {}", .ends.0, .ends.1)]
    NoEnd {
        /// The item.
        item: Box<At>,
        /// The curve.
        curve: String,
        /// The parameter.
        u: f64,
        /// Parameters of both ends.
        ends: (f64, f64),
    },
    /// A handle index that does not exist, or another kind of hold than at the beginning.
    #[error("there is no handle {index} that holds a {kind}")]
    NoHandle {
        /// Index.
        index: usize,
        /// What it should hold.
        kind: &'static str,
    },
    /// Splines that cannot be made.
    #[error("{item}: {source}")]
    Spline {
        /// The item.
        item: Box<At>,
        /// Why.
        source: SplineError,
    },
    /// The system could not be set up.
    #[error(transparent)]
    System(#[from] SystemError),
}

impl CompositeError {
    /// The item that is meant, if it is one.
    pub fn at(&self) -> Option<&At> {
        match self {
            Self::Unknown { item, .. }
            | Self::Number { item, .. }
            | Self::Knots { item, .. }
            | Self::Stiff { item, .. }
            | Self::Unclamped { item }
            | Self::Coinciding { item, .. }
            | Self::Nothing { item, .. }
            | Self::Contradiction { first: item, .. }
            | Self::HeldApart { item, .. }
            | Self::OverDetermined { item, .. }
            | Self::Corners { item, .. }
            | Self::Skew { item, .. }
            | Self::NoEnd { item, .. }
            | Self::Spline { item, .. }
            | Self::NotShared { item, .. } => Some(item),
            _ => None,
        }
    }
}

/// Share of the size within which points coincide.
pub(super) const SAME: f64 = 1e-9;

/// Names for messages.
pub(super) fn strip_item(c: &Composite, k: usize) -> Box<At> {
    Box::new(At { list: "strips", index: k, field: "", words: format!("strip {k} '{}'", c.strips[k].name) })
}

/// A curve for messages.
pub(super) fn curve_item(c: &Composite, k: usize, kind: &str) -> Box<At> {
    Box::new(At { list: "curves", index: k, field: "", words: format!("{kind} {k} '{}'", c.curves[k].name) })
}

/// A planar piece for messages.
pub(super) fn facet_item(c: &Composite, k: usize) -> Box<At> {
    Box::new(At { list: "facets", index: k, field: "", words: format!("planar piece {k} '{}'", c.facets[k].name) })
}

/// An item without a name for messages.
pub(super) fn other_item(list: &'static str, word: &str, index: usize) -> Box<At> {
    Box::new(At { list, index, field: "", words: format!("{word} {index}") })
}

/// A handle for messages.
pub(super) fn handle_item(k: usize, h: &Handle) -> Box<At> {
    let words = format!("handle {k} ({} at u = {} of '{}')", h.hold.name(), h.place.u, h.place.curve);
    Box::new(At { list: "handles", index: k, field: h.hold.name(), words })
}

/// Size of all curves, mm.
pub(super) fn size(c: &Composite) -> f64 {
    let points: Vec<Vec3> = c.curves.iter().flat_map(|c| c.curve.control.iter().map(|p| Vec3::from(*p))).collect();
    BBox::of(&points).diagonal()
}

/// Index of a curve or strip that must exist.
pub(super) fn found<'a>(
    item: &dyn Fn() -> Box<At>,
    kind: &'static str,
    name: &str,
    names: impl Iterator<Item = &'a str> + Clone,
) -> Result<usize, CompositeError> {
    const SHOWN: usize = 6;
    names.clone().position(|n| n == name).ok_or_else(|| CompositeError::Unknown {
        item: item(),
        kind,
        name: name.into(),
        there: names.take(SHOWN).map(|n| format!("'{n}'")).collect(),
    })
}

/// Checks what can be checked before unknowns are set up.
pub(super) fn check(c: &Composite) -> Result<(), CompositeError> {
    if c.strips.is_empty() {
        return Err(CompositeError::Empty);
    }
    unique("curve", c.curves.iter().map(|c| &c.name))?;
    unique("strip", c.strips.iter().map(|s| &s.name).chain(c.facets.iter().map(|f| &f.name)))?;
    let size = size(c);
    for (k, b) in c.curves.iter().enumerate() {
        let item = || curve_item(c, k, "curve");
        let knots = &b.curve.knots;
        if b.curve.control.iter().flatten().any(|x| !x.is_finite()) {
            let needed = "all must be finite";
            return Err(CompositeError::Number {
                item: item().of("points"),
                what: "a coordinate",
                value: f64::NAN,
                needed,
            });
        }
        let (first, last) = knots.domain();
        let end = knots.degree() + 1;
        let ends = knots.distinct();
        let clamped = |e: Option<&(f64, usize)>, t: f64| e.is_some_and(|e| e.0 == t && e.1 == end);
        if !clamped(ends.first(), first) || !clamped(ends.last(), last) {
            return Err(CompositeError::Unclamped { item: item().of("knots") });
        }
    }
    for k in 0..c.strips.len() {
        strip(c, k, size)?;
    }
    (0..c.facets.len()).try_for_each(|k| facet(c, k))?;
    (0..c.joins.len()).try_for_each(|k| join(c, k))?;
    c.handles.iter().enumerate().try_for_each(|(k, h)| handle(c, k, h))?;
    for (k, l) in c.lengths.iter().enumerate() {
        let item = other_item("lengths", "length", k);
        l.between.iter().try_for_each(|p| place(c, &item.clone().of("between"), p))?;
        if !(l.length > 0.0 && l.length.is_finite()) {
            return Err(CompositeError::Number {
                item,
                what: "the length",
                value: l.length,
                needed: "it must be positive",
            });
        }
        let [a, b] = l.between.each_ref().map(|p| held(c, p));
        let distance = a.zip(b).map(|(a, b)| (a - b).norm());
        if let Some(distance) = distance.filter(|d| (d - l.length).abs() > SAME * size) {
            return Err(CompositeError::HeldApart { item: item.of("length"), length: l.length, distance });
        }
    }
    for (k, t) in c.targets.iter().enumerate() {
        let item = |field| move || other_item("targets", "target", k).of(field);
        for name in &t.strips {
            found(&item("strips"), "strip", name, c.strips.iter().map(|s| &s.name[..]))?;
        }
        if !(t.weight >= 0.0 && t.weight.is_finite()) {
            let needed = "it must not be negative";
            return Err(CompositeError::Number { item: item("weight")(), what: "the weight", value: t.weight, needed });
        }
    }
    Ok(())
}

/// Where a place is held: by a handle that holds it exactly, or on a fixed curve.
fn held(c: &Composite, place: &Place) -> Option<Vec3> {
    let exact = |h: &&Handle| h.place == *place && h.strength == Strength::Exact;
    let by_handle = c.handles.iter().filter(exact).find_map(|h| match h.hold {
        Hold::Point(p) => Some(p),
        _ => None,
    });
    let curve = &c.curves[c.curve(&place.curve)?];
    by_handle.or_else(|| curve.fixed.then(|| Vec3::from(curve.curve.point(place.u))))
}

fn unique<'a>(kind: &'static str, names: impl Iterator<Item = &'a String>) -> Result<(), CompositeError> {
    let mut all: Vec<&String> = names.collect();
    all.sort();
    match all.windows(2).find(|w| w[0] == w[1]) {
        Some(w) => Err(CompositeError::TwoOfAName { kind, name: w[0].clone() }),
        None => Ok(()),
    }
}

fn strip(c: &Composite, k: usize, size: f64) -> Result<(), CompositeError> {
    let s = &c.strips[k];
    let item = || strip_item(c, k);
    let mut sides = [0; 2];
    for (at, name) in sides.iter_mut().zip(&s.sides) {
        *at = found(&|| item().of("sides"), "curve", name, c.curves.iter().map(|b| &b.name[..]))?;
    }
    let [a, b] = sides.map(|k| &c.curves[k].curve);
    if a.knots != b.knots {
        return Err(CompositeError::Knots { item: item().of("sides"), sides: s.sides.clone() });
    }
    let apart = |(p, q): (&[f64; 3], &[f64; 3])| (Vec3::from(*p) - Vec3::from(*q)).norm() > SAME * size;
    if !a.control.iter().zip(&b.control).any(apart) {
        return Err(CompositeError::Coinciding { item: item().of("sides"), sides: s.sides.clone() });
    }
    if let StripShape::Developable { margin } = s.shape {
        if !(margin >= 0.0 && margin.is_finite()) {
            let needed = "it must not be negative";
            return Err(CompositeError::Number {
                item: item().of("margin"),
                what: "the margin",
                value: margin,
                needed,
            });
        }
        let degree = a.knots.degree();
        let inner = a.knots.distinct();
        let least = inner.iter().skip(1).rev().skip(1).map(|k| k.1).min();
        if let Some(multiplicity) = least.filter(|m| freedom_per_interval(degree, *m) < 0) {
            return Err(CompositeError::Stiff { item: item().of("sides"), degree, multiplicity });
        }
    }
    Ok(())
}

fn join(c: &Composite, k: usize) -> Result<(), CompositeError> {
    let item = |field| move || other_item("joins", "join", k).of(field);
    let ratio = |s: &Smoothness| match s {
        Smoothness::C1 { ratio } if !(*ratio > 0.0 && ratio.is_finite()) => {
            let needed = "it must be positive";
            Err(CompositeError::Number { item: item("ratio")(), what: "the ratio", value: *ratio, needed })
        }
        _ => Ok(()),
    };
    match &c.joins[k] {
        Join::Ruling { first, second, smoothness } => {
            for name in [first, second] {
                let k = found(&item("ruling"), "strip", name, c.strips.iter().map(|s| &s.name[..]))?;
                if *smoothness == Smoothness::G2 && c.strips[k].shape == StripShape::Ruled {
                    return Err(CompositeError::Skew { item: item("smoothness")(), strip: name.clone() });
                }
            }
            ratio(smoothness)
        }
        Join::Curve { curve, .. } => {
            found(&item("curve"), "curve", curve, c.curves.iter().map(|s| &s.name[..]))?;
            let count = c.strips.iter().filter(|s| s.sides.contains(curve)).count();
            match count {
                2 => Ok(()),
                _ => Err(CompositeError::NotShared { item: item("curve")(), curve: curve.clone(), count }),
            }
        }
        Join::Ends { smoothness: Smoothness::G2, ends } => {
            Err(CompositeError::Skew { item: item("smoothness")(), strip: ends[0].curve.clone() })
        }
        Join::Ends { ends, smoothness } => {
            ends.iter().try_for_each(|p| at_end(c, &item("ends")(), p))?;
            ratio(smoothness)
        }
    }
}

fn facet(c: &Composite, k: usize) -> Result<(), CompositeError> {
    let f = &c.facets[k];
    let item = facet_item(c, k);
    let count = f.corners.len();
    if !(3..=4).contains(&count) || (f.alpha.is_some() && count != 3) {
        return Err(CompositeError::Corners { item: item.of("corners"), count });
    }
    f.corners.iter().try_for_each(|p| at_end(c, &item.clone().of("corners"), p))?;
    match f.alpha {
        Some(value) if !(value > 0.0 && value.is_finite()) => {
            let needed = "it must be positive";
            Err(CompositeError::Number { item: item.of("alpha"), what: "the distance", value, needed })
        }
        _ => Ok(()),
    }
}

/// Checks that a place is an end of a curve of a strip.
fn at_end(c: &Composite, item: &At, p: &Place) -> Result<(), CompositeError> {
    place(c, item, p)?;
    let ends = c.curve(&p.curve).map_or((0.0, 0.0), |k| c.curves[k].curve.domain());
    if p.u == ends.0 || p.u == ends.1 {
        return Ok(());
    }
    Err(CompositeError::NoEnd { item: Box::new(item.clone()), curve: p.curve.clone(), u: p.u, ends })
}

fn place(c: &Composite, item: &At, p: &Place) -> Result<(), CompositeError> {
    let k = found(&|| Box::new(item.clone()), "curve", &p.curve, c.curves.iter().map(|b| &b.name[..]))?;
    let (a, b) = c.curves[k].curve.domain();
    if !(p.u >= a && p.u <= b) {
        let reason = format!("the parameter of '{}' runs from {a} to {b}", p.curve);
        return Err(CompositeError::Nothing { item: Box::new(item.clone()), reason });
    }
    if !c.strips.iter().any(|s| s.sides.contains(&p.curve)) {
        let reason = format!("'{}' bounds no strip", p.curve);
        return Err(CompositeError::Nothing { item: Box::new(item.clone()), reason });
    }
    Ok(())
}

fn handle(c: &Composite, k: usize, h: &Handle) -> Result<(), CompositeError> {
    let item = handle_item(k, h);
    let (a, b) = c.curve(&h.place.curve).map_or((0.0, 0.0), |k| c.curves[k].curve.domain());
    let inside = h.place.u >= a && h.place.u <= b;
    let field = if c.curve(&h.place.curve).is_some() && !inside { "u" } else { "curve" };
    place(c, &item.clone().of(field), &h.place)?;
    hold(&item, &h.hold)?;
    if let Strength::Pull(weight) = h.strength {
        if !(weight > 0.0 && weight.is_finite()) {
            let needed = "it must be positive";
            return Err(CompositeError::Number { item: item.of("pull"), what: "the weight", value: weight, needed });
        }
    }
    Ok(())
}

/// Checks what a handle holds to.
pub(super) fn hold(item: &At, hold: &Hold) -> Result<(), CompositeError> {
    let vectors = match hold {
        Hold::Point(p) => [Some(("a coordinate", *p, false)), None],
        Hold::Tangent(t) => [Some(("the length of the direction", *t, true)), None],
        Hold::Plane { point, normal } => {
            [Some(("a coordinate", *point, false)), Some(("the length of the normal", *normal, true))]
        }
    };
    for (what, v, direction) in vectors.into_iter().flatten() {
        let n = v.norm();
        if !n.is_finite() || (direction && n == 0.0) {
            let needed = if direction { "it must be positive" } else { "it must be finite" };
            return Err(CompositeError::Number { item: Box::new(item.clone()), what, value: n, needed });
        }
    }
    Ok(())
}
