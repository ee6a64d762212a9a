//! What pictures and the viewer show: meshes and lines of the input surface and the panels, in mm.

use crate::geom::mesh::Mesh;
use crate::geom::{BBox, Vec3};
use crate::torse::form::PanelKind;

/// Triangles and lines of one panel.
#[derive(Clone, Debug, Default)]
pub struct PanelShape {
    /// Name of the panel.
    pub name: String,
    /// Triangles of the panel; the values are signed deviations from the input surface, mm.
    pub mesh: Mesh,
    /// Rulings inside the panel.
    pub rulings: Vec<[Vec3; 2]>,
    /// Boundary of the panel as closed or open polylines.
    pub borders: Vec<Vec<Vec3>>,
    /// Whether the panel must not be cut: it is not certified.
    pub marked: bool,
}

impl PanelShape {
    /// Name with the words that warn of cutting, if it is marked.
    pub fn title(&self) -> String {
        titled(&self.name, self.marked)
    }
}

/// The words on everything that must not be cut, the same in every file and picture.
pub(crate) const NOT_CERTIFIED: &str = "NOT CERTIFIED";

/// A name, followed by [`NOT_CERTIFIED`] where that holds.
pub(crate) fn titled(name: &str, marked: bool) -> String {
    if marked {
        format!("{name} {NOT_CERTIFIED}")
    } else {
        name.to_owned()
    }
}

/// A name as [`titled`] leaves it without what is said of its certificate, and whether that was said.
pub(crate) fn untitled(name: &str) -> (&str, bool) {
    let bare = name.strip_suffix(NOT_CERTIFIED).map(str::trim_end).filter(|bare| !bare.is_empty());
    bare.map_or((name, false), |bare| (bare, true))
}

/// Triangles of a part of the model that is of one kind.
#[derive(Clone, Debug)]
pub struct ShapePatch {
    /// The kind, which decides the colour.
    pub kind: PanelKind,
    /// Triangles.
    pub mesh: Mesh,
}

/// The whole model.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// One shape per panel, in the patchwork's order.
    pub panels: Vec<PanelShape>,
    /// One mesh per input face.
    pub surfaces: Vec<Mesh>,
    /// Given curves to be seen with the panels, as polylines.
    pub guides: Vec<Vec<Vec3>>,
    /// Places where what is asked is seen to be broken, or resisted the proof.
    pub witnesses: Vec<Vec3>,
    /// Gauss curvature at the vertices of every panel and of every surface, 1/mm²; nothing where it is not known.
    pub curvature: [Vec<Vec<f64>>; 2],
    /// Pieces of the lines along which panels meet, with the angle between both there, rad.
    pub joints: Vec<([Vec3; 2], f64)>,
}

impl Scene {
    /// Box around all finite vertices of panels and surfaces.
    pub fn bbox(&self) -> BBox {
        let meshes = self.panels.iter().map(|p| &p.mesh).chain(&self.surfaces);
        BBox::of(meshes.flat_map(|m| &m.positions).filter(|p| p.iter().all(|x| x.is_finite())))
    }
}
