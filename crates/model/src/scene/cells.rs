//! Cells of grids that are named by their corners: which faces they have.

/// A kind of cell, by VTK's number.
pub(super) struct CellKind {
    pub(super) number: i64,
    pub(super) name: &'static str,
    pub(super) corners: usize,
    /// Each by corners of the cell. Files do not agree on the order in which a cell's corners go round, so faces may be seen from inside.
    pub(super) faces: &'static [&'static [u32]],
}

/// VTK's number of polyhedra, whose faces the file names.
pub(super) const POLYHEDRON: i64 = 42;

pub(super) const TETRAHEDRON: CellKind =
    CellKind { number: 10, name: "tetrahedron", corners: 4, faces: &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]] };

pub(super) const HEXAHEDRON: CellKind = CellKind {
    number: 12,
    name: "hexahedron",
    corners: 8,
    faces: &[&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]],
};

pub(super) const WEDGE: CellKind = CellKind {
    number: 13,
    name: "wedge",
    corners: 6,
    faces: &[&[0, 2, 1], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]],
};

pub(super) const PYRAMID: CellKind = CellKind {
    number: 14,
    name: "pyramid",
    corners: 5,
    faces: &[&[0, 3, 2, 1], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]],
};

/// All kinds known.
pub(super) const KINDS: [CellKind; 7] = [
    TETRAHEDRON,
    CellKind {
        number: 11,
        name: "voxel",
        corners: 8,
        faces: &[&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 4, 6, 2], &[1, 3, 7, 5]],
    },
    HEXAHEDRON,
    WEDGE,
    PYRAMID,
    CellKind {
        number: 15,
        name: "pentagonal prism",
        corners: 10,
        faces: &[
            &[4, 3, 2, 1, 0],
            &[5, 6, 7, 8, 9],
            &[0, 1, 6, 5],
            &[1, 2, 7, 6],
            &[2, 3, 8, 7],
            &[3, 4, 9, 8],
            &[4, 0, 5, 9],
        ],
    },
    CellKind {
        number: 16,
        name: "hexagonal prism",
        corners: 12,
        faces: &[
            &[5, 4, 3, 2, 1, 0],
            &[6, 7, 8, 9, 10, 11],
            &[0, 1, 7, 6],
            &[1, 2, 8, 7],
            &[2, 3, 9, 8],
            &[3, 4, 10, 9],
            &[4, 5, 11, 10],
            &[5, 0, 6, 11],
        ],
    },
];

/// The kinds that can be read, for messages.
pub(super) fn known_kinds() -> String {
    let known: Vec<String> = KINDS.iter().map(|kind| format!("{} ({})", kind.number, kind.name)).collect();
    format!("types that can are {} and {POLYHEDRON} (polyhedron)", known.join(", "))
}

impl CellKind {
    /// The faces of a cell with these corners.
    pub(super) fn faces_on(&self, corners: &[u32]) -> Vec<Vec<u32>> {
        self.faces.iter().map(|face| face.iter().map(|&corner| corners[corner as usize]).collect()).collect()
    }
}
