//! Flat patterns of scanned strips cut back to the border of the points \[EKS83\], where these lie on the judged strips.

use crate::certify::points::PointCertificate;
use crate::develop::map::Development;
use crate::develop::scanned::{cut_back, outline};
use crate::geom::Vec2;
use crate::patchwork::part::Part;
use crate::patchwork::pattern::Pattern;
use crate::torse::strip::Strip;

/// Outlines that follow measured points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outlines {
    /// Largest distance of a place on them from a point, mm.
    pub off_estimate: f64,
    /// Spacing of the points, mm.
    pub spacing: f64,
    /// Holes that are cut out.
    pub holes: usize,
    /// Holes of a few spacings that are not.
    pub closed: usize,
    /// Points that lie apart.
    pub stray: usize,
}

/// Cuts flat patterns back to the border of the points within `near` (mm) of their strips. Answers what is known of the
/// new outlines, if there are any, and the names of the parts that keep theirs.
pub(crate) fn outlined(
    strips: &[Strip],
    parts: &[Part],
    patterns: &mut [Pattern],
    (certificate, near): (&PointCertificate, f64),
    side: f64,
) -> (Option<Outlines>, Vec<String>) {
    let mut whole: Vec<String> = Vec::new();
    let (mut off, mut spacing, mut closed, mut stray, mut holes) = (0.0_f64, 0.0_f64, 0, 0, 0);
    for pattern in patterns.iter_mut() {
        let Some(part) = parts.get(pattern.panel) else { continue };
        let development = strips.get(part.first).and_then(|s| Development::new(&s.patch, side).ok());
        // Patterns are seen from outside or from inside: mirrored where that is the other side.
        let found = development.and_then(|d| {
            let of = |((k, u, v), b): (&(u32, f32, f32), &f64)| {
                (*k as usize == part.first && *b <= near).then(|| d.map(f64::from(*u), f64::from(*v)))
            };
            let mut points: Vec<Vec2> = certificate.places().iter().zip(certificate.bounds()).filter_map(of).collect();
            let is_mirrored = mirrored(pattern, &d)?;
            points.iter_mut().filter(|_| is_mirrored).for_each(|p| p.x = -p.x);
            outline(&points)
        });
        let Some(found) = found else {
            whole.push(part.name.clone());
            continue;
        };
        *pattern = cut_back(pattern, &found);
        (off, spacing) = (off.max(found.distance_estimate), spacing.max(found.spacing));
        (closed, stray, holes) = (closed + found.closed, stray + found.stray, holes + found.loops.len() - 1);
    }
    let outlines =
        (whole.len() < patterns.len()).then_some(Outlines { off_estimate: off, spacing, holes, closed, stray });
    (outlines, whole)
}

/// Whether a pattern is mirrored against the development that it was drawn from: told by the marks along both rails,
/// whose directions along the strip and across it are not parallel. `None` without such marks.
fn mirrored(pattern: &Pattern, development: &Development) -> Option<bool> {
    let rail = |letter: char| -> Vec<Vec2> {
        pattern.marks.iter().filter(|m| m.label.starts_with(letter)).map(|m| m.point).collect()
    };
    let (a, b) = (rail('A'), rail('B'));
    let middle = |l: &[Vec2]| l.iter().sum::<Vec2>() / l.len() as f64;
    let drawn = [a.last()? - a.first()?, middle(&b) - middle(&a)];
    if b.is_empty() || a.len() < 2 {
        return None;
    }
    let (u0, u1) = development.domain();
    let at = |v: f64| [0.25, 0.5, 0.75].map(|s| development.map(u0 + s * (u1 - u0), v));
    let (c, d) = (at(0.0), at(1.0));
    let made = [c[2] - c[0], middle(&d) - middle(&c)];
    let alike = |flip: f64| -> f64 {
        let pair = |(x, y): (&Vec2, &Vec2)| {
            let y = Vec2::new(flip * y.x, y.y);
            x.dot(&y) / (x.norm() * y.norm()).max(f64::MIN_POSITIVE)
        };
        drawn.iter().zip(&made).map(pair).sum()
    };
    Some(alike(-1.0) > alike(1.0))
}
