//! Handles and lengths that a shape does not meet.

use crate::answer::note::Note;
use crate::design::composite::{Hold, Place, Session, Strength};
use crate::geom::Vec3;
use crate::reason::{Item, JobReason, Reason};

/// How far a condition is from being met.
struct Off {
    item: Item,
    /// How far, mm.
    far: f64,
    /// Whether it may give way.
    gives_way: bool,
    /// Whether a curve runs against the direction that it is held to.
    backwards: bool,
}

/// How far handles and lengths are from what they ask for.
fn off(session: &Session) -> Vec<Off> {
    let mut out = Vec::new();
    for (k, h) in session.composite().handles.iter().enumerate() {
        let Some(curve) = session.composite().curve(&h.place.curve).and_then(|c| session.curve(c)) else { continue };
        let [p, d, _] = curve.jet(h.place.u).map(Vec3::from);
        let mut backwards = false;
        let far = match h.hold {
            Hold::Point(target) => (p - target).norm(),
            Hold::Plane { point, normal } => normal.normalize().dot(&(p - point)).abs(),
            // Over the length of the control polygon's side there, a direction is off by so much.
            Hold::Tangent(t) => {
                backwards = d.dot(&t) < 0.0;
                let off = if backwards { 2.0 * d.norm() } else { d.cross(&t.normalize()).norm() };
                off / curve.knots.degree() as f64
            }
        };
        let item = Item::Handle(k, h.place.curve.clone());
        out.push(Off { item, far, gives_way: h.strength != Strength::Exact, backwards });
    }
    for (k, l) in session.composite().lengths.iter().enumerate() {
        let place = |p: &Place| {
            let curve = session.composite().curve(&p.curve).and_then(|c| session.curve(c))?;
            Some(Vec3::from(curve.point(p.u)))
        };
        let [Some(a), Some(b)] = l.between.each_ref().map(place) else { continue };
        let far = ((b - a).norm() - l.length).abs();
        out.push(Off { item: Item::Length(k), far, gives_way: false, backwards: false });
    }
    out
}

/// What is said of conditions that are not met within the tolerance (mm): notes on those that may give way, and what stands
/// against the status.
pub(super) fn unmet(session: &Session, tolerance: f64) -> (Vec<Note>, Vec<Reason>) {
    let (mut notes, mut missing) = (Vec::new(), Vec::new());
    for Off { item, far, gives_way, backwards } in off(session) {
        match (gives_way, backwards) {
            _ if far <= tolerance => {}
            (true, _) => notes.push(Note::GaveWay { handle: item, off: far }),
            (false, true) => missing.push(JobReason::Backwards(item).into()),
            (false, false) => missing.push(JobReason::Off(item, far).into()),
        }
    }
    (notes, missing)
}
