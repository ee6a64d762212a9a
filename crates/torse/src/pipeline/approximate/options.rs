//! What the main job is asked for.

use crate::develop::view::Drawn;
use crate::search::cover::{Layout, Limits};

/// What the main job is asked for.
///
/// # Example
/// ```
/// let model = torse::read(include_bytes!("../../../../../data/cylinder_holes.step"))?;
/// let mut options = torse::Approximate::new(0.5);
/// options.limits.min_bend_radius = Some(50.0);
/// options.input = "plate".into();
/// let answer = torse::approximate(&model, &options)?;
/// assert!(answer.input == "plate" && answer.beyond_limits.is_empty());
/// assert!(answer.patterns()[0].bends.iter().flat_map(|b| b.radii).all(|r| r >= 50.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Options {
    /// Deviation bound to reach between model and panels, mm.
    pub tolerance: f64,
    /// Largest number of panels on any face; default none.
    pub max_panels: Option<usize>,
    /// Name of the input for reports, without folder; default "model".
    pub input: String,
    /// What sheet and material allow; default anything.
    pub limits: Limits,
    /// Where strips and seams run; default where fewest are needed.
    pub layout: Layout,
    /// Whether neighbouring strips are to meet in common edges where that can be certified; default they are.
    pub meet: bool,
    /// Greatest angle (rad) between faces along a common edge across which they are covered as one surface; 0 covers
    /// each face for itself; default [`SMOOTH_ANGLE_DEG`]. See `brep::join`.
    pub smooth_angle: f64,
    /// How flat patterns are drawn; default seen from outside, lines every 5°.
    pub drawn: Drawn,
}

impl Options {
    /// Defaults with a tolerance (mm).
    pub fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            max_panels: None,
            input: "model".into(),
            limits: Limits::default(),
            layout: Layout::default(),
            meet: true,
            smooth_angle: SMOOTH_ANGLE_DEG.to_radians(),
            drawn: Drawn::default(),
        }
    }
}

/// Angle between faces (degrees) up to which they are covered as one unless something else is asked for. Modelling
/// programs join surfaces smoothly within a tenth of a degree, most exported files within half of one.
pub const SMOOTH_ANGLE_DEG: f64 = 0.5;
