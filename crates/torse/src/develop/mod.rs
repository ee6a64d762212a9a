//! Floor 5: development, the isometric map of a panel to the plane.
