//! Subdivision of discrete torses: cubic B-spline refinement of both polylines, then planarisation, level by level.
//! Sections 1A and 3A of \[W15\]; the refinement is knot insertion for uniform cubic splines \[PT97\].

use super::planarise::{planarise, DiscreteError, Hold, PlanariseOptions, PlanariseStatus, Planarised};
use crate::control::Control;
use crate::geom::Vec3;
use crate::torse::quad_strip::QuadStrip;

/// How [`subdivide`] works.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SubdivideOptions {
    /// Number of levels; each doubles the number of quadrilaterals. Default 3.
    pub levels: usize,
    /// Planarisation of every level.
    pub planarise: PlanariseOptions,
}

impl Default for SubdivideOptions {
    fn default() -> Self {
        Self { levels: 3, planarise: PlanariseOptions::default() }
    }
}

/// What one level did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelReport {
    /// Number of quadrilaterals.
    pub quads: usize,
    /// How planarisation ended.
    pub status: PlanariseStatus,
    /// Steps of planarisation.
    pub steps: usize,
    /// Largest warp after refinement, before planarisation.
    pub warp_before: f64,
    /// Largest warp after planarisation.
    pub warp: f64,
    /// Largest displacement by planarisation, mm.
    pub largest_move: f64,
    /// Largest jump between successive bends by their mean; see [`QuadStrip::bend_jump`].
    pub bend_jump: f64,
}

impl LevelReport {
    fn of(p: &Planarised) -> Self {
        Self {
            quads: p.strip.quads(),
            status: p.status,
            steps: p.steps,
            warp_before: p.warp_before,
            warp: p.warp,
            largest_move: p.largest_move,
            bend_jump: p.strip.bend_jump(),
        }
    }
}

/// A strip after subdivision.
#[derive(Clone, Debug, PartialEq)]
pub struct Subdivided {
    /// The strip of the last level.
    pub strip: QuadStrip,
    /// The level given (planarised), then every further one.
    pub levels: Vec<LevelReport>,
}

impl Subdivided {
    /// Whether every level became plane.
    pub fn plane(&self) -> bool {
        self.levels.iter().all(|l| l.status == PlanariseStatus::Plane)
    }
}

/// Most quadrilaterals of a result.
const MOST_QUADS: usize = 1 << 18;

/// Planarises a strip, then refines and planarises it again, level by level.
///
/// *Method.* Each level replaces both polylines by their [`lane_riesenfeld`] refinement, which would converge to cubic
/// splines with continuous curvature, and restores planarity by the least smooth displacement ([`planarise`]). Since
/// displacements shrink faster than the squared mesh width, bends of successive rulings differ by ever smaller shares:
/// the limit is curvature continuous (measured, not proven). With held polylines, refined points are held as they are
/// after refinement.
///
/// *Guarantee.* Every level tells its warp. A level that could not be planarised does not stop the later ones.
///
/// # Errors
/// A warp that is not positive, more than 2¹⁸ quadrilaterals.
pub fn subdivide(
    strip: &QuadStrip,
    options: &SubdivideOptions,
    control: &Control,
) -> Result<Subdivided, DiscreteError> {
    let quads = strip.quads();
    let fits = u32::try_from(options.levels).ok().and_then(|l| 1usize.checked_shl(l));
    if fits.and_then(|f| f.checked_mul(quads)).is_none_or(|q| q > MOST_QUADS) {
        return Err(DiscreteError::Levels { levels: options.levels, quads, most: MOST_QUADS });
    }
    let mut current = planarise(strip, &options.planarise, control)?;
    let mut levels = vec![LevelReport::of(&current)];
    for _ in 0..options.levels {
        if control.stopped() {
            break;
        }
        current = planarise(&refined(&current.strip)?, &options.planarise, control)?;
        levels.push(LevelReport::of(&current));
    }
    Ok(Subdivided { strip: current.strip, levels })
}

/// Both polylines refined once.
///
/// # Errors
/// Refined rulings without length.
pub(crate) fn refined(strip: &QuadStrip) -> Result<QuadStrip, DiscreteError> {
    Ok(QuadStrip::new(lane_riesenfeld(strip.a()), lane_riesenfeld(strip.b()))?)
}

/// One step of Lane–Riesenfeld refinement of degree 3: inner points become `(p₋ + 6p + p₊)/8`, edges get their middle,
/// end points stay. `n` points become `2n − 1`.
pub fn lane_riesenfeld(points: &[Vec3]) -> Vec<Vec3> {
    let n = points.len();
    let mut out = Vec::with_capacity((2 * n).saturating_sub(1));
    for (i, p) in points.iter().enumerate() {
        if i > 0 {
            out.push((points[i - 1] + p) * 0.5);
        }
        let inner = i > 0 && i + 1 < n;
        out.push(if inner { (points[i - 1] + points[i + 1]) * 0.125 + p * 0.75 } else { *p });
    }
    out
}

/// The options with other points held.
impl SubdivideOptions {
    /// Levels and held points, the rest by default.
    pub fn new(levels: usize, hold: Hold) -> Self {
        Self { levels, planarise: PlanariseOptions { hold, ..PlanariseOptions::default() } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The strip of the test file: a circle's polygon and a tilted, smaller one above it.
    fn twisted() -> QuadStrip {
        let a = (0..6).map(|k| 0.4 * f64::from(k)).map(|t| Vec3::new(t.cos(), t.sin(), 0.0)).collect();
        let b = [
            [1.4700998667618626, 0.158935464636049, 1.0],
            [1.2380034223645173, 0.4517139787160284, 1.08],
            [0.8104534588022096, 0.6731767878463173, 1.16],
            [0.2549507143503612, 0.7883597839907682, 1.24],
            [-0.3408031420396307, 0.7790781047025561, 1.32],
            [-0.8827516758830187, 0.6467971230556722, 1.4],
        ];
        QuadStrip::new(a, b.map(Vec3::from).to_vec()).expect("a strip")
    }

    #[test]
    fn lane_riesenfeld_refines_cubic_splines() {
        let p = [[0., 0., 0.], [8., 0., 0.], [8., 8., 0.], [0., 8., 8.]].map(Vec3::from);
        let expected =
            [[0., 0., 0.], [4., 0., 0.], [7., 1., 0.], [8., 4., 0.], [7., 7., 1.], [4., 8., 4.], [0., 8., 8.]];
        let got = lane_riesenfeld(&p);
        assert_eq!(got, expected.map(Vec3::from).to_vec());
        assert!(lane_riesenfeld(&[]).is_empty());
        assert_eq!(lane_riesenfeld(&p[..1]), p[..1].to_vec());
    }

    #[test]
    fn subdivision_keeps_planarity_and_its_limit_bends_without_jumps() {
        let options = SubdivideOptions::new(4, Hold::Nothing);
        let s = subdivide(&twisted(), &options, &Control::default()).expect("levels");
        assert!(s.plane() && s.strip.quads() == 80 && s.levels.len() == 5);
        for l in &s.levels {
            assert!(l.warp <= 1e-12 && l.steps <= 25, "{l:?}");
        }
        for w in s.levels[2..].windows(2) {
            assert!(w[1].bend_jump <= 0.75 * w[0].bend_jump, "{} after {}", w[1].bend_jump, w[0].bend_jump);
            assert!(w[1].largest_move < 0.5 * w[0].largest_move);
        }
        assert!(s.strip.crossing().is_none());
    }

    #[test]
    fn held_points_stay() {
        let strip = twisted();
        for hold in [Hold::First, Hold::Second, Hold::Ends] {
            let options = PlanariseOptions { hold, ..PlanariseOptions::default() };
            let p = planarise(&strip, &options, &Control::default()).expect("an answer");
            assert_eq!(p.status, PlanariseStatus::Plane, "{hold:?}");
            let same = |x: &[Vec3], y: &[Vec3]| x.iter().zip(y).all(|(p, q)| (p - q).norm() < 1e-14);
            let n = strip.rulings() - 1;
            match hold {
                Hold::First => assert!(same(p.strip.a(), strip.a())),
                Hold::Second => assert!(same(p.strip.b(), strip.b())),
                _ => {
                    assert!(same(&p.strip.ruling(0), &strip.ruling(0)));
                    assert!(same(&p.strip.ruling(n), &strip.ruling(n)));
                }
            }
        }
    }

    #[test]
    fn plane_strips_are_left_alone_and_motions_and_scales_commute() {
        let strip = twisted();
        let p = planarise(&strip, &PlanariseOptions::default(), &Control::default()).expect("plane");
        let again = planarise(&p.strip, &PlanariseOptions::default(), &Control::default()).expect("plane");
        assert_eq!((again.steps, again.largest_move), (0, 0.0));
        let turn = nalgebra::Rotation3::from_euler_angles(0.3, -1.1, 2.0);
        let moved = |v: &Vec3| turn * v * 1e3 + Vec3::new(500.0, -2e3, 70.0);
        let map = |s: &QuadStrip| {
            QuadStrip::new(s.a().iter().map(moved).collect(), s.b().iter().map(moved).collect()).expect("a strip")
        };
        let q = planarise(&map(&strip), &PlanariseOptions::default(), &Control::default()).expect("plane");
        let expected = map(&p.strip);
        let off = q.strip.a().iter().zip(expected.a()).map(|(x, y)| (x - y).norm()).fold(0.0, f64::max);
        // Linear gaps are left at a millionth of what they were: size 2700 mm.
        assert!(off < 1e-5, "{off}");
    }

    #[test]
    fn too_many_levels_and_no_warp_are_refused() {
        let strip = twisted();
        let with = |levels| subdivide(&strip, &SubdivideOptions::new(levels, Hold::Nothing), &Control::default());
        for levels in [16, 64, 1000] {
            assert!(matches!(with(levels), Err(DiscreteError::Levels { .. })));
        }
        let options = PlanariseOptions { warp: f64::NAN, ..PlanariseOptions::default() };
        assert!(matches!(planarise(&strip, &options, &Control::default()), Err(DiscreteError::Warp(_))));
    }
}
