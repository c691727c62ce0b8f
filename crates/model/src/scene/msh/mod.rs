//! Gmsh's meshes, in ASCII and binary, versions 2.2 and 4.1. Every tetrahedron, hexahedron, prism and pyramid is a block; of a mesh of triangles and
//! quadrangles alone, every set of them joined by edges within a physical group, or without groups within the file; beside such cells, every set with a
//! node that no cell has, since the others are boundaries of cells.
//!
//! `mshio` reads version 4.1 alone, panics at types of numbers that it does not know, and gives errors without a line.

mod input;

use crate::block::Point;
use crate::number::Number;
use crate::number_text::shown;
use crate::scene::cells::{CellKind, HEXAHEDRON, PYRAMID, TETRAHEDRON, WEDGE};
use crate::scene::error::SceneProblem;
use crate::scene::mesh::{Face, blocks, components, weld, weld_block};
use crate::scene::raw::{FeatureLines, RawBlock, Winding};
use crate::scene::tokens::Located;
use input::{Input, InputPosition};
use std::collections::{BTreeSet, HashMap, HashSet};

/// What is kept of an element.
enum Element {
    /// A point or a line.
    Skipped,
    Polygon,
    Cell(CellKind),
}

/// The element of one of Gmsh's types, and its number of nodes.
fn element_of(kind: usize) -> Option<(Element, usize)> {
    let cell = |kind: CellKind| Some((kind.corners, Element::Cell(kind)));
    let (nodes, element) = match kind {
        1 => (2, Element::Skipped),
        8 => (3, Element::Skipped),
        15 => (1, Element::Skipped),
        2 => (3, Element::Polygon),
        3 => (4, Element::Polygon),
        4 => cell(TETRAHEDRON)?,
        5 => cell(HEXAHEDRON)?,
        6 => cell(WEDGE)?,
        7 => cell(PYRAMID)?,
        _ => return None,
    };
    Some((element, nodes))
}

#[derive(Default)]
struct Mesh {
    points: Vec<Point>,
    /// Of the points of a text.
    lines: Vec<usize>,
    /// Where each node is in `points`.
    places: HashMap<i64, u32>,
    /// Of physical surfaces.
    names: HashMap<i64, String>,
    /// The physical group of each surface of version 4.
    groups: HashMap<i64, i64>,
    /// Polygons by physical group, 0 for none, in the order of the file.
    polygons: Vec<(i64, Vec<Face>)>,
    /// Where each group is in `polygons`.
    group_places: HashMap<i64, usize>,
    cells: Vec<RawBlock>,
    /// The points of the cells.
    cell_points: HashSet<u32>,
}

pub(super) fn read(bytes: &[u8], distance: Option<&Number>) -> Result<Vec<RawBlock>, Located> {
    let mut input = Input::new(bytes)?;
    let input = &mut input;
    input.keyword("$MeshFormat")?;
    let is_version_4 = version(input)?;
    input.keyword("$EndMeshFormat")?;
    let mut mesh = Mesh::default();
    while let Some(name) = input.section()? {
        match (name, is_version_4) {
            ("PhysicalNames", _) => mesh.read_names(input)?,
            ("Entities", true) => mesh.read_entities(input)?,
            ("Nodes", true) => mesh.read_nodes_4(input)?,
            ("Nodes", false) => mesh.read_nodes_2(input)?,
            ("Elements", true) => mesh.read_elements_4(input)?,
            ("Elements", false) if input.is_binary() => mesh.read_element_lists(input)?,
            ("Elements", false) => mesh.read_elements_2(input)?,
            _ => input.skip(name)?,
        }
        input.keyword(&format!("$End{name}"))?;
    }
    Ok(mesh.blocks(distance))
}

/// Whether the version is 4.1, not 2.2.
fn version(input: &mut Input<'_>) -> Result<bool, Located> {
    let position = input.position();
    let version = input.word("the version")?;
    let refuse = |what: String, allowed: &str| {
        Err((position.line(), SceneProblem::Unsupported { what, allowed: allowed.to_owned() }))
    };
    let is_version_4 = match version.text {
        "2.2" | "2" | "2.1" => false,
        "4.1" => true,
        other => {
            let allowed = "versions 2.2 and 4.1 can (in Gmsh: Mesh.MshFileVersion)";
            return refuse(format!("version {}", shown(other)), allowed);
        }
    };
    let kind = input.word("the kind of file")?;
    if !matches!(kind.text, "0" | "1") {
        return refuse(format!("a file of kind {}", shown(kind.text)), "kinds 0 (ASCII) and 1 (binary) can");
    }
    let size = input.word("the size of a number")?;
    if input.is_binary() {
        let width = match (size.text, is_version_4) {
            ("8", _) => 8,
            ("4", true) => 4,
            (other, _) => return refuse(format!("a binary file of numbers of size {}", shown(other)), "8 can"),
        };
        input.begin_binary(width)?;
    }
    Ok(is_version_4)
}

impl Mesh {
    fn read_names(&mut self, input: &mut Input<'_>) -> Result<(), Located> {
        for _ in 0..input.plain_count("the number of physical groups")? {
            let dimension = input.plain_count("the dimension of a physical group")?;
            let group = input.plain_integer("the number of a physical group")?;
            let name = input.name()?;
            if dimension == 2 && !name.is_empty() {
                self.names.insert(group, name);
            }
        }
        Ok(())
    }

    /// Of version 4: which physical group each surface is in; the first, where it is in several.
    fn read_entities(&mut self, input: &mut Input<'_>) -> Result<(), Located> {
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = input.count("the number of entities")?;
        }
        for (dimension, count) in counts.into_iter().enumerate() {
            for _ in 0..count {
                let tag = input.integer("the number of an entity")?;
                for _ in 0..if dimension == 0 { 3 } else { 6 } {
                    input.number("a coordinate of an entity")?;
                }
                let groups = input.count("the number of physical groups of an entity")?;
                for number in 0..groups {
                    let group = input.integer("a physical group of an entity")?;
                    if dimension == 2 && number == 0 {
                        // A negative one turns the surface round for Gmsh's own use.
                        self.groups.insert(tag, group.saturating_abs());
                    }
                }
                if dimension > 0 {
                    for _ in 0..input.count("the number of entities at a boundary")? {
                        input.integer("an entity at a boundary")?;
                    }
                }
            }
        }
        Ok(())
    }

    /// `position` is that of the node's number, `line` that of its coordinates, in a text.
    fn add_node(
        &mut self,
        tag: i64,
        position: InputPosition,
        (at, line): (Point, Option<usize>),
    ) -> Result<(), Located> {
        let number = self.points.len() as u32;
        if self.places.insert(tag, number).is_some() {
            let what = position.name(&format!("node {tag}"));
            let allowed = "a number that no other has".to_owned();
            return Err((position.line(), SceneProblem::NotAllowed { what, found: "there twice".to_owned(), allowed }));
        }
        self.points.push(at);
        self.lines.extend(line);
        Ok(())
    }

    fn read_nodes_2(&mut self, input: &mut Input<'_>) -> Result<(), Located> {
        for _ in 0..input.plain_count("the number of nodes")? {
            let position = input.position();
            let tag = input.integer("the number of a node")?;
            let at = input.point("a coordinate of a node")?;
            self.add_node(tag, position, (at, position.line()))?;
        }
        Ok(())
    }

    fn read_nodes_4(&mut self, input: &mut Input<'_>) -> Result<(), Located> {
        let entities = input.count("the number of entities with nodes")?;
        for what in ["the number of nodes", "the least number of a node", "the greatest number of a node"] {
            input.tag(what)?;
        }
        for _ in 0..entities {
            let dimension = input.index("the dimension of an entity", 4)?;
            input.integer("the number of an entity")?;
            let parameters = dimension * input.index("whether nodes have parameters", 2)?;
            let mut tags = Vec::new();
            for _ in 0..input.count("the number of nodes of an entity")? {
                let position = input.position();
                tags.push((input.tag("the number of a node")?, position));
            }
            for (tag, position) in tags {
                let line = input.position().line();
                let at = input.point("a coordinate of a node")?;
                for _ in 0..parameters {
                    input.number("a parameter of a node")?;
                }
                self.add_node(tag, position, (at, line))?;
            }
        }
        Ok(())
    }

    /// Version 2 in ASCII: each element with its type and tags.
    fn read_elements_2(&mut self, input: &mut Input<'_>) -> Result<(), Located> {
        for _ in 0..input.plain_count("the number of elements")? {
            let tag = input.integer("the number of an element")?;
            let position = input.position();
            let kind = input.plain_count("the type of an element")?;
            let group = first_of(input, "the number of tags of an element")?;
            let element = NamedElement { tag, kind, position, group };
            self.read_element(input, &element, Input::integer)?;
        }
        Ok(())
    }

    /// Version 2, binary: lists of elements of one type.
    fn read_element_lists(&mut self, input: &mut Input<'_>) -> Result<(), Located> {
        let all = input.plain_count("the number of elements")?;
        let mut read = 0;
        while read < all {
            let position = input.position();
            let kind = input.small_count("the type of elements")?;
            let count = input.index("the number of elements of a list", all - read + 1)?;
            let tags = input.small_count("the number of tags of an element")?;
            if count == 0 {
                let what = position.name("the number of elements of a list");
                let allowed = format!("1 to {}", all - read);
                return Err((None, SceneProblem::NotAllowed { what, found: "0".to_owned(), allowed }));
            }
            for _ in 0..count {
                let tag = input.integer("the number of an element")?;
                let group = first_of_some(input, tags)?;
                self.read_element(input, &NamedElement { tag, kind, position, group }, Input::integer)?;
            }
            read += count;
        }
        Ok(())
    }

    fn read_elements_4(&mut self, input: &mut Input<'_>) -> Result<(), Located> {
        let entities = input.count("the number of entities with elements")?;
        for what in ["the number of elements", "the least number of an element", "the greatest number of an element"] {
            input.tag(what)?;
        }
        for _ in 0..entities {
            let dimension = input.index("the dimension of an entity", 4)?;
            let entity = input.integer("the number of an entity")?;
            let position = input.position();
            let kind = input.small_count("the type of elements")?;
            let group = self.groups.get(&entity).copied().filter(|_| dimension == 2).unwrap_or(0);
            for _ in 0..input.count("the number of elements of an entity")? {
                let tag = input.tag("the number of an element")?;
                self.read_element(input, &NamedElement { tag, kind, position, group }, Input::tag)?;
            }
        }
        Ok(())
    }

    /// Reads the nodes of an element, each by `node`.
    fn read_element<'a>(
        &mut self,
        input: &mut Input<'a>,
        element: &NamedElement,
        node: fn(&mut Input<'a>, &str) -> Result<i64, Located>,
    ) -> Result<(), Located> {
        let &NamedElement { tag, kind, mut position, group } = element;
        let Some((element, count)) = element_of(kind) else {
            let what = position.name(&format!("element {tag} of type {kind}"));
            let allowed = "types that can are 2 (triangle), 3 (quadrangle), 4 (tetrahedron), 5 (hexahedron), 6 (prism) and 7 (pyramid), and \
                 1, 8 and 15 are skipped; in Gmsh: Mesh.ElementOrder = 1";
            return Err((position.line(), SceneProblem::Unsupported { what, allowed: allowed.to_owned() }));
        };
        let mut corners = Vec::with_capacity(count);
        for _ in 0..count {
            let what = format!("a node of element {tag}");
            position = input.position();
            let node = node(input, &what)?;
            let known = self.places.get(&node).copied();
            corners.push(known.ok_or_else(|| {
                let allowed = "the number of a node above it".to_owned();
                let what = position.name(&what);
                (position.line(), SceneProblem::NotAllowed { what, found: node.to_string(), allowed })
            })?);
        }
        let line = position.line();
        match element {
            Element::Skipped => {}
            Element::Polygon => {
                let face = Face { vertices: corners, line };
                let next = self.polygons.len();
                let position = *self.group_places.entry(group).or_insert(next);
                if position == next {
                    self.polygons.push((group, Vec::new()));
                }
                self.polygons[position].1.push(face);
            }
            Element::Cell(kind) => self.add_cell(&kind, &corners, line),
        }
        Ok(())
    }

    fn add_cell(&mut self, kind: &CellKind, corners: &[u32], line: Option<usize>) {
        // A node named twice is one vertex, and the cell then no block.
        let used: BTreeSet<u32> = corners.iter().copied().collect();
        self.cell_points.extend(&used);
        let position: HashMap<u32, u32> = used.iter().zip(0..).map(|(&v, i)| (v, i)).collect();
        let corners: Vec<u32> = corners.iter().map(|corner| position[corner]).collect();
        self.cells.push(RawBlock {
            vertices: used.iter().map(|&v| self.points[v as usize].clone()).collect(),
            faces: kind.faces_on(&corners),
            line,
            lines: FeatureLines {
                vertices: used.iter().filter_map(|&v| self.lines.get(v as usize).copied()).collect(),
                faces: Vec::new(),
            },
            winding: Winding::Any,
            ..RawBlock::default()
        });
    }

    fn blocks(mut self, distance: Option<&Number>) -> Vec<RawBlock> {
        let cells = std::mem::take(&mut self.cells).into_iter();
        let mut all: Vec<RawBlock> = match distance {
            Some(distance) => cells.map(|cell| weld_block(cell, distance)).collect(),
            None => cells.collect(),
        };
        for (group, faces) in &mut self.polygons {
            if !self.cell_points.is_empty() {
                *faces = beyond(faces, &self.cell_points);
            }
            if let Some(distance) = distance {
                weld(faces, &self.points, distance);
            }
            all.extend(blocks(self.names.get(group).map(String::as_str), faces, &self.points, &self.lines));
        }
        all
    }
}

/// The faces that are no boundary of cells: of surfaces joined by edges, those with a point that no cell has.
fn beyond(faces: &[Face], of_cells: &HashSet<u32>) -> Vec<Face> {
    let is_beyond = |face: &usize| faces[*face].vertices.iter().any(|point| !of_cells.contains(point));
    let mut kept: Vec<usize> =
        components(faces).into_iter().filter(|set| set.iter().any(is_beyond)).flatten().collect();
    kept.sort_unstable();
    kept.into_iter().map(|face| faces[face].clone()).collect()
}

/// An element whose nodes follow.
struct NamedElement {
    tag: i64,
    kind: usize,
    /// Where its type stands.
    position: InputPosition,
    /// Its physical group, 0 for none.
    group: i64,
}

/// The first of the tags that follow after their number; 0 where there is none.
fn first_of(input: &mut Input<'_>, what: &str) -> Result<i64, Located> {
    let count = input.plain_count(what)?;
    first_of_some(input, count)
}

fn first_of_some(input: &mut Input<'_>, count: usize) -> Result<i64, Located> {
    let mut first = 0;
    for number in 0..count {
        let tag = input.integer("a tag of an element")?;
        if number == 0 {
            first = tag;
        }
    }
    Ok(first)
}
