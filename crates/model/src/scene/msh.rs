//! Gmsh's meshes in ASCII, versions 2.2 and 4.1. Every tetrahedron, hexahedron, prism and pyramid is a block; of a mesh of triangles and
//! quadrangles alone, every set of them joined by edges within a physical group, or without groups within the file.
//!
//! `mshio` reads version 4.1 alone, panics at types of numbers that it does not know, and gives errors without a line.

use crate::block::Point;
use crate::number::Number;
use crate::number_text::shown;
use crate::scene::cells::{CellKind, HEXAHEDRON, PYRAMID, TETRAHEDRON, WEDGE};
use crate::scene::error::SceneProblem;
use crate::scene::mesh::{Face, blocks, weld, weld_block};
use crate::scene::raw::RawBlock;
use crate::scene::tokens::{Located, Token, Tokens, unexpected};
use std::collections::{BTreeSet, HashMap};

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
}

pub(super) fn read(text: &str, distance: Option<&Number>) -> Result<Vec<RawBlock>, Located> {
    let mut tokens = Tokens::new(text, 1);
    let tokens = &mut tokens;
    tokens.keyword("$MeshFormat")?;
    let is_version_4 = version(tokens)?;
    tokens.keyword("$EndMeshFormat")?;
    let mut mesh = Mesh::default();
    while tokens.peek().is_some() {
        let heading = tokens.next("a section")?;
        let Some(name) = heading.text.strip_prefix('$') else {
            return Err(unexpected(heading, "a section, which begins with $"));
        };
        match (name, is_version_4) {
            ("PhysicalNames", _) => mesh.read_names(tokens)?,
            ("Entities", true) => mesh.read_entities(tokens)?,
            ("Nodes", true) => mesh.read_nodes_4(tokens)?,
            ("Nodes", false) => mesh.read_nodes_2(tokens)?,
            ("Elements", true) => mesh.read_elements_4(tokens)?,
            ("Elements", false) => mesh.read_elements_2(tokens)?,
            _ => {
                let end = format!("$End{name}");
                while tokens.peek().is_some_and(|token| token.text != end) {
                    tokens.next("an entry of a section")?;
                }
            }
        }
        tokens.keyword(&format!("$End{name}"))?;
    }
    Ok(mesh.blocks(distance))
}

/// Whether the version is 4.1, not 2.2.
fn version(tokens: &mut Tokens<'_>) -> Result<bool, Located> {
    let version = tokens.next("the version")?;
    let kind = tokens.next("the kind of file")?;
    tokens.next("the size of a number")?;
    let refuse = |what: String, allowed: &str| {
        Err((Some(version.line), SceneProblem::Unsupported { what, allowed: allowed.to_owned() }))
    };
    if kind.text != "0" {
        return refuse("a binary file".to_owned(), "write it as ASCII (in Gmsh: Mesh.Binary = 0)");
    }
    match version.text {
        "2.2" | "2" | "2.1" => Ok(false),
        "4.1" => Ok(true),
        other => refuse(format!("version {}", shown(other)), "versions 2.2 and 4.1 can (in Gmsh: Mesh.MshFileVersion)"),
    }
}

/// A whole number, which may be negative.
fn integer(tokens: &mut Tokens<'_>, what: &str) -> Result<i64, Located> {
    let token = tokens.next(what)?;
    token.text.parse().map_err(|_| unexpected(token, &format!("{what}, a whole number")))
}

impl Mesh {
    fn read_names(&mut self, tokens: &mut Tokens<'_>) -> Result<(), Located> {
        for _ in 0..tokens.count("the number of physical groups")? {
            let dimension = tokens.count("the dimension of a physical group")?;
            let group = integer(tokens, "the number of a physical group")?;
            let first = tokens.next("the name of a physical group")?;
            let mut words = vec![first.text];
            // A name may have spaces, and stands in quotes.
            while words.len() == 1 && first.text == "\"" || !words.last().is_some_and(|word| word.ends_with('"')) {
                match tokens.peek().filter(|token| token.line == first.line) {
                    Some(_) => words.push(tokens.next("the name of a physical group")?.text),
                    None => return Err(unexpected(first, "a name in quotes")),
                }
            }
            let name = words.join(" ");
            let name = name.trim_matches('"');
            if name.chars().any(char::is_control) {
                return Err(unexpected(Token { text: name, line: first.line }, "a name without control characters"));
            }
            if dimension == 2 && !name.is_empty() {
                self.names.insert(group, name.to_owned());
            }
        }
        Ok(())
    }

    /// Of version 4: which physical group each surface is in; the first, where it is in several.
    fn read_entities(&mut self, tokens: &mut Tokens<'_>) -> Result<(), Located> {
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = tokens.count("the number of entities")?;
        }
        for (dimension, count) in counts.into_iter().enumerate() {
            for _ in 0..count {
                let tag = integer(tokens, "the number of an entity")?;
                for _ in 0..if dimension == 0 { 3 } else { 6 } {
                    tokens.number("a coordinate of an entity")?;
                }
                let groups = tokens.count("the number of physical groups of an entity")?;
                for number in 0..groups {
                    let group = integer(tokens, "a physical group of an entity")?;
                    if dimension == 2 && number == 0 {
                        // A negative one turns the surface round for Gmsh's own use.
                        self.groups.insert(tag, group.saturating_abs());
                    }
                }
                if dimension > 0 {
                    for _ in 0..tokens.count("the number of entities at a boundary")? {
                        integer(tokens, "an entity at a boundary")?;
                    }
                }
            }
        }
        Ok(())
    }

    fn add_node(&mut self, tag: i64, at: Point, line: usize) -> Result<(), Located> {
        let place = self.points.len() as u32;
        if self.places.insert(tag, place).is_some() {
            let what = format!("node {tag}");
            let allowed = "a number that no other has".to_owned();
            return Err((Some(line), SceneProblem::NotAllowed { what, found: "there twice".to_owned(), allowed }));
        }
        self.points.push(at);
        Ok(())
    }

    fn read_nodes_2(&mut self, tokens: &mut Tokens<'_>) -> Result<(), Located> {
        for _ in 0..tokens.count("the number of nodes")? {
            let line = tokens.peek().map_or(0, |token| token.line);
            let tag = integer(tokens, "the number of a node")?;
            let at = tokens.point("a coordinate of a node")?;
            self.add_node(tag, at, line)?;
        }
        Ok(())
    }

    fn read_nodes_4(&mut self, tokens: &mut Tokens<'_>) -> Result<(), Located> {
        let entities = tokens.count("the number of entities with nodes")?;
        for what in ["the number of nodes", "the least number of a node", "the greatest number of a node"] {
            integer(tokens, what)?;
        }
        for _ in 0..entities {
            let dimension = tokens.index("the dimension of an entity", 4)?;
            integer(tokens, "the number of an entity")?;
            let parameters = dimension * tokens.index("whether nodes have parameters", 2)?;
            let mut tags = Vec::new();
            for _ in 0..tokens.count("the number of nodes of an entity")? {
                let line = tokens.peek().map_or(0, |token| token.line);
                tags.push((integer(tokens, "the number of a node")?, line));
            }
            for (tag, line) in tags {
                let at = tokens.point("a coordinate of a node")?;
                for _ in 0..parameters {
                    tokens.number("a parameter of a node")?;
                }
                self.add_node(tag, at, line)?;
            }
        }
        Ok(())
    }

    fn read_elements_2(&mut self, tokens: &mut Tokens<'_>) -> Result<(), Located> {
        for _ in 0..tokens.count("the number of elements")? {
            let tag = integer(tokens, "the number of an element")?;
            let kind = tokens.next("the type of an element")?;
            let mut tags = Vec::new();
            for _ in 0..tokens.count("the number of tags of an element")? {
                tags.push(integer(tokens, "a tag of an element")?);
            }
            self.read_element(tokens, tag, kind, tags.first().copied().unwrap_or(0))?;
        }
        Ok(())
    }

    fn read_elements_4(&mut self, tokens: &mut Tokens<'_>) -> Result<(), Located> {
        let entities = tokens.count("the number of entities with elements")?;
        for what in ["the number of elements", "the least number of an element", "the greatest number of an element"] {
            integer(tokens, what)?;
        }
        for _ in 0..entities {
            let dimension = tokens.index("the dimension of an entity", 4)?;
            let entity = integer(tokens, "the number of an entity")?;
            let kind = tokens.next("the type of elements")?;
            let group = self.groups.get(&entity).copied().filter(|_| dimension == 2).unwrap_or(0);
            for _ in 0..tokens.count("the number of elements of an entity")? {
                let tag = integer(tokens, "the number of an element")?;
                self.read_element(tokens, tag, kind, group)?;
            }
        }
        Ok(())
    }

    fn read_element(&mut self, tokens: &mut Tokens<'_>, tag: i64, kind: Token<'_>, group: i64) -> Result<(), Located> {
        let number = crate::scene::tokens::whole(kind, "the type of an element")?;
        let Some((element, count)) = element_of(number) else {
            let what = format!("element {tag} of type {number}");
            let allowed = "types that can are 2 (triangle), 3 (quadrangle), 4 (tetrahedron), 5 (hexahedron), 6 (prism) and 7 (pyramid), and \
                 1, 8 and 15 are skipped; in Gmsh: Mesh.ElementOrder = 1";
            return Err((Some(kind.line), SceneProblem::Unsupported { what, allowed: allowed.to_owned() }));
        };
        let mut corners = Vec::with_capacity(count);
        let mut line = kind.line;
        for _ in 0..count {
            let what = format!("a node of element {tag}");
            line = tokens.peek().map_or(line, |token| token.line);
            let node = integer(tokens, &what)?;
            let place = self.places.get(&node).copied();
            corners.push(place.ok_or_else(|| {
                let allowed = "the number of a node above it".to_owned();
                (Some(line), SceneProblem::NotAllowed { what, found: node.to_string(), allowed })
            })?);
        }
        match element {
            Element::Skipped => {}
            Element::Polygon => {
                let face = Face { vertices: corners, line: Some(line) };
                let next = self.polygons.len();
                let place = *self.group_places.entry(group).or_insert(next);
                if place == next {
                    self.polygons.push((group, Vec::new()));
                }
                self.polygons[place].1.push(face);
            }
            Element::Cell(kind) => self.add_cell(&kind, &corners, line),
        }
        Ok(())
    }

    fn add_cell(&mut self, kind: &CellKind, corners: &[u32], line: usize) {
        // A node named twice is one vertex, and the cell then no block.
        let used: BTreeSet<u32> = corners.iter().copied().collect();
        let place: HashMap<u32, u32> = used.iter().zip(0..).map(|(&v, i)| (v, i)).collect();
        let corners: Vec<u32> = corners.iter().map(|corner| place[corner]).collect();
        self.cells.push(RawBlock {
            vertices: used.iter().map(|&v| self.points[v as usize].clone()).collect(),
            faces: kind.faces_on(&corners),
            line: Some(line),
            is_cell: true,
            ..RawBlock::default()
        });
    }

    fn blocks(mut self, distance: Option<&Number>) -> Vec<RawBlock> {
        if !self.cells.is_empty() {
            // The polygons are the boundary of the cells, or of some of them.
            return match distance {
                Some(distance) => self.cells.into_iter().map(|cell| weld_block(cell, distance)).collect(),
                None => self.cells,
            };
        }
        let mut all = Vec::new();
        for (group, faces) in &mut self.polygons {
            if let Some(distance) = distance {
                weld(faces, &self.points, distance);
            }
            all.extend(blocks(self.names.get(group).map(String::as_str), faces, &self.points));
        }
        all
    }
}
