//! The project's own scene files, in TOML.
//!
//! The document is walked with its spans rather than through serde, so that every message names a line.

mod attach;
mod body;
mod lines;
mod materials;

pub(super) use attach::Attachments;
pub(super) use body::BodyProperties;

use crate::block::Point;
use crate::number::Number;
use crate::number_text::decimal;
use crate::scene::error::SceneProblem;
use crate::scene::raw::FeatureLines;
use crate::scene::tokens::Located;
use crate::simulation::Simulation;
use crate::tolerance_spec::{SpecError, ToleranceSpec};
use lines::{Allowed, Lines, Value};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A scene file.
pub(super) struct Document {
    pub(super) tolerances: Option<ToleranceSpec>,
    pub(super) planarity: Option<Number>,
    pub(super) entries: Vec<BlockEntry>,
    /// Without loads and points: those are in `attached` until the blocks are known.
    pub(super) simulation: Simulation,
    pub(super) attached: Attachments,
}

/// One `[[block]]`.
pub(super) struct BlockEntry {
    pub(super) name: Option<String>,
    pub(super) patch: BodyProperties,
    pub(super) planarity: Option<Number>,
    pub(super) content: ShapeSource,
    pub(super) line: usize,
}

/// Where the shape of a `[[block]]` comes from.
pub(super) enum ShapeSource {
    Mesh { vertices: Vec<Point>, faces: Vec<Vec<u32>>, lines: FeatureLines },
    File(String),
    Box { min: Point, max: Point },
}

/// What may stand in a scene.
const SCENE: [&str; 11] = [
    "simulation",
    "material",
    "joint",
    "tolerances",
    "planarity",
    "block",
    "set",
    "load",
    "fixed_point",
    "measured_point",
    "case",
];

/// Reads a scene.
pub(super) fn read(text: &str) -> Result<Document, Located> {
    let lines = Lines::new(text);
    let document = parse(text, &lines)?;
    let table = document.get_ref();
    lines.allow_only(table, "the scene", &SCENE)?;
    let tolerances = match table.get("tolerances") {
        Some(value) => Some(lines.tolerances(lines.table(value, "`tolerances`")?)?),
        None => None,
    };
    let planarity = table.get("planarity").map(|value| lines.planarity(value)).transpose()?;
    let simulation = lines.simulation(table)?;
    let blocks = lines.tables(table, "block")?;
    let entries = blocks.iter().map(|(value, block)| lines.entry(value, block, &simulation));
    let entries = entries.collect::<Result<Vec<_>, _>>()?;
    let attached = lines.attached(table, &simulation)?;
    Ok(Document { tolerances, planarity, entries, simulation, attached })
}

/// Reads tolerances: the table `[tolerances]` of a scene or of a file of its own, or a file that is that table.
pub(super) fn read_tolerances(text: &str) -> Result<ToleranceSpec, Located> {
    let lines = Lines::new(text);
    let document = parse(text, &lines)?;
    match document.get_ref().get("tolerances") {
        Some(value) => {
            // A tolerance beside the table would be given for nothing.
            lines.allow_only(document.get_ref(), "a file with `[tolerances]`", &SCENE)?;
            lines.tolerances(lines.table(value, "`tolerances`")?)
        }
        None => lines.tolerances(document.get_ref()),
    }
}

fn parse<'i>(text: &'i str, lines: &Lines) -> Result<Spanned<DeTable<'i>>, Located> {
    DeTable::parse(text).map_err(|error| {
        let line = error.span().map(|span| lines.of(&span));
        (line, SceneProblem::Toml { message: error.message().lines().collect::<Vec<_>>().join(", ") })
    })
}

impl Lines {
    fn planarity(&self, value: &Value<'_>) -> Result<Number, Located> {
        self.number_in(value, "`planarity`", Allowed::NotNegative)
    }

    fn tolerances(&self, table: &DeTable<'_>) -> Result<ToleranceSpec, Located> {
        let mut spec = ToleranceSpec::empty();
        for (first, second) in [("overlap_angle", "overlap_sine"), ("parallel_angle", "parallel_sine")] {
            if let (Some(_), Some(value)) = (table.get(first), table.get(second)) {
                return Err((Some(self.of(&value.span())), SpecError::GivenTwice { first, second }.into()));
            }
        }
        for (key, value) in table {
            let name = key.get_ref().as_ref();
            let set = match value.get_ref() {
                DeValue::String(text) => spec.set_text(name, text),
                // An unknown name matters more than what stands behind it.
                _ if !crate::tolerance_spec::NAMES.contains(&name) => spec.set_text(name, ""),
                _ => spec.set_number(name, self.number(value, &format!("tolerance `{name}`"))?),
            };
            set.map_err(|error| (Some(self.of(&key.span())), error.into()))?;
        }
        Ok(spec)
    }

    fn entry(&self, value: &Value<'_>, table: &DeTable<'_>, simulation: &Simulation) -> Result<BlockEntry, Located> {
        let line = self.of(&value.span());
        let shape = ["vertices", "faces", "file", "box"];
        let keys = ["name", "planarity"].into_iter().chain(body::KEYS).chain(shape);
        self.allow_only(table, "[[block]]", &keys.collect::<Vec<_>>())?;
        let name = table.get("name").map(|value| self.name(value, "`name`")).transpose()?;
        let planarity = table.get("planarity").map(|value| self.planarity(value)).transpose()?;
        let patch = self.patch(table, "[[block]]", simulation)?;
        let content = match shape.map(|key| table.get(key)) {
            [Some(vertices), Some(faces), None, None] => {
                let lines = FeatureLines {
                    vertices: self.each(self.array(vertices, "`vertices`")?),
                    faces: self.each(self.array(faces, "`faces`")?),
                };
                ShapeSource::Mesh { vertices: self.vertices(vertices)?, faces: self.faces(faces)?, lines }
            }
            [None, None, Some(file), None] => ShapeSource::File(self.text(file, "`file`")?.to_string()),
            [None, None, None, Some(corners)] => self.corners(corners)?,
            _ => {
                let given: Vec<&str> = shape.into_iter().filter(|key| table.get(*key).is_some()).collect();
                let found = if given.is_empty() { "a block without a shape".to_string() } else { given.join(" and ") };
                let expected = "`vertices` and `faces`, or `file`, or `box`".to_string();
                return Err((Some(line), SceneProblem::Unexpected { found, expected }));
            }
        };
        Ok(BlockEntry { name, patch, planarity, content, line })
    }

    fn corners(&self, value: &Value<'_>) -> Result<ShapeSource, Located> {
        let table = self.table(value, "`box`")?;
        self.allow_only(table, "`box`", &["min", "max"])?;
        let corner = |key: &str| match table.get(key) {
            Some(corner) => self.vector(corner, &format!("`{key}`"), "coordinate"),
            None => Err(self.unexpected(value, "`box` with `min` and `max`")),
        };
        let (min, max) = (corner("min")?, corner("max")?);
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let [low, high] = [&min, &max].map(|corner| corner.components()[axis]);
            if low >= high {
                let why = if low == high { "the box would be flat" } else { "min and max are exchanged" };
                let allowed = format!("below {name} of `max`, {}: {why}", decimal(high));
                return Err(self.not_allowed(value, &format!("{name} of `min` of `box`"), &decimal(low), allowed));
            }
        }
        Ok(ShapeSource::Box { min, max })
    }

    fn vertices(&self, value: &Value<'_>) -> Result<Vec<Point>, Located> {
        let vertices = self.array(value, "`vertices`")?;
        vertices
            .iter()
            .enumerate()
            .map(|(i, vertex)| self.vector(vertex, &format!("vertex {i}"), "coordinate"))
            .collect()
    }

    fn faces(&self, value: &Value<'_>) -> Result<Vec<Vec<u32>>, Located> {
        let faces = self.array(value, "`faces`")?;
        let index = |(face, value): (usize, &Value<'_>)| {
            let digits = value.get_ref().as_integer().filter(|integer| integer.radix() == 10);
            digits.and_then(|integer| integer.as_str().parse::<u32>().ok()).ok_or_else(|| {
                self.unexpected(value, &format!("a vertex number of face {face}, a whole number from 0"))
            })
        };
        let boundary = |(face, value): (usize, &Value<'_>)| {
            let vertices = self.array(value, &format!("face {face}"))?;
            vertices.iter().map(|v| index((face, v))).collect::<Result<Vec<u32>, _>>()
        };
        faces.iter().enumerate().map(boundary).collect()
    }
}
