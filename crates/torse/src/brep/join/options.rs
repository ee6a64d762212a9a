//! What faces may be joined: the options of the join of \[R89\].

/// What may be joined.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JoinOptions {
    /// Greatest angle between the faces along a common edge, rad; 0 joins nothing.
    pub angle: f64,
    /// Greatest distance between control points of the two sides of a common edge, mm.
    pub mismatch: f64,
    /// Greatest angle through which the normal of a joined face may turn along a line of constant u or v, rad, at
    /// samples; infinite for no limit. Bodies that close around themselves fall into open ones.
    pub turn: f64,
}
