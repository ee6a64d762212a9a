//! What readers say of their files: damage, what was assumed, what was not read.

use crate::answer::skipped::Skipped;

/// Something that the reader of a file says of it.
#[derive(Clone, Debug, PartialEq)]
pub enum ReaderNote {
    /// The mark that ends a file is missing; nothing is known to be.
    NoEnd(EndMark),
    /// Text of a STEP file that is no record.
    NoRecords {
        /// Stretches of it.
        stretches: usize,
        /// Line of the first.
        line: usize,
    },
    /// Lines of an IGES file that belong to no section.
    NoSection {
        /// How many.
        lines: usize,
        /// The first.
        line: usize,
    },
    /// Numbers that different records have.
    Repeated {
        /// How many.
        count: usize,
        /// The first.
        first: u64,
    },
    /// Lines of an IGES directory without the other half of their entry.
    HalfEntries {
        /// How many.
        lines: usize,
    },
    /// Entities of an IGES file whose data do not end.
    OpenData {
        /// How many.
        entities: usize,
    },
    /// An entry of a table of a Rhino archive that cannot be read.
    Entry {
        /// Which table.
        table: ArchiveTable,
        /// Its number, from 1.
        number: usize,
        /// What the reader says.
        reason: String,
    },
    /// An object of a Rhino archive that cannot be read.
    Object {
        /// What it is called.
        name: String,
        /// What the reader says.
        reason: String,
    },
    /// Something is left out where only notes are told.
    LeftOut(Skipped),
    /// Of its unit of length.
    Unit(UnitNote),
    /// Nothing says where a part goes in its assembly: it is read where it was drawn.
    Unplaced {
        /// Its name, if it has one.
        part: Option<String>,
    },
    /// Every part of an assembly is placed in another.
    NoTop,
    /// Faces that no shape representation leads to are read without placements.
    Strays {
        /// How many.
        faces: usize,
    },
    /// Surfaces that are marked as parts of others, though nothing refers to them, are read as faces.
    Orphans {
        /// How many.
        count: usize,
    },
    /// Hidden faces that are read all the same.
    HiddenFaces {
        /// How many.
        count: usize,
    },
    /// Objects that are not shown are left out.
    HiddenObjects {
        /// How many.
        count: usize,
    },
    /// Copies of parts that are both shifted and turned.
    ShiftedAndTurned {
        /// Entity number of the first.
        first: u64,
        /// How many.
        count: usize,
    },
    /// Triangles that are not read, since annotations are drawn so.
    Triangles {
        /// Entity number.
        entity: u64,
    },
    /// A curve is not finite where it is put.
    NotFinite {
        /// What the file calls it.
        item: String,
    },
    /// A curve beside the faces that cannot be read.
    FreeCurve {
        /// What the reader says.
        reason: String,
    },
    /// Copies of curves that are left out, since they are too many.
    TooManyCopies,
    /// Corners of meshes are endlessly far away.
    EndlessMeshes,
    /// Annotations that are not carried to flat patterns: kinds and how many of each.
    Annotations(Vec<(AnnotationKind, usize)>),
    /// Annotations that are not read.
    AnnotationsNotRead {
        /// How many.
        count: usize,
    },
    /// Entities of a drawing that are not read.
    NotRead {
        /// The drawing.
        file: String,
        /// Their keywords and how many there are of each.
        kinds: Vec<(String, usize)>,
    },
    /// Curves of a drawing where single straight lines are wanted.
    NoLines {
        /// The drawing.
        file: String,
        /// How many.
        curves: usize,
    },
    /// Curves of a drawing without length, which are left out.
    NoLength {
        /// The drawing.
        file: String,
        /// How many.
        curves: usize,
    },
    /// Blocks of a drawing that are taken apart.
    TakenApart {
        /// The drawing.
        file: String,
        /// How often they are inserted.
        insertions: usize,
    },
    /// A curve of a drawing that lies on an earlier one counts once.
    DrawnTwice {
        /// The drawing.
        file: String,
        /// Its name.
        again: String,
        /// Name of the earlier one.
        first: String,
        /// How many more there are.
        more: usize,
    },
    /// An edge that lies at several places, of which the first is taken.
    SeveralPlaces {
        /// Its file.
        file: String,
        /// Its number.
        edge: String,
        /// How many places.
        places: usize,
    },
}

/// What a reader says of the unit of length of its file.
#[derive(Clone, Debug, PartialEq)]
pub enum UnitNote {
    /// None is stated: millimetres are assumed.
    Missing,
    /// None is stated, which means inches by the standard.
    Inches,
    /// Its name is not known: millimetres are assumed.
    Unknown {
        /// The name.
        name: String,
    },
    /// Flag and name differ; the flag is used.
    Differ {
        /// Name of what the flag says.
        flag: String,
        /// The name.
        name: String,
    },
    /// Parts have different units.
    Mixed,
    /// Settings of units are missing.
    NoSettings,
    /// A drawing at a scale.
    Scale {
        /// The scale.
        scale: f64,
        /// Length of a number of the file, mm.
        millimetres: f64,
    },
    /// A table, mesh or drawing that says none: its numbers are taken as mm.
    Guessed {
        /// The file.
        file: String,
    },
}

/// What ends a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EndMark {
    /// ENDSEC of a STEP file.
    Endsec,
    /// The last line (T) of an IGES file.
    LastLine,
}

/// A table of a Rhino archive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArchiveTable {
    /// Layers.
    Layer,
    /// Definitions of blocks.
    Block,
}

/// A kind of annotation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AnnotationKind {
    /// Letters.
    Text,
    /// Drawn in triangles or lines.
    Drawn,
    /// The line from a text to what it is about.
    LeaderLine,
    /// The line along what a dimension measures.
    DimensionLine,
    /// A symbol.
    Symbol,
    /// A hatched or coloured area.
    FilledArea,
    /// Any other line.
    Line,
    /// A dimension as a whole.
    Dimension,
    /// A label.
    Label,
    /// A note.
    Note,
}
