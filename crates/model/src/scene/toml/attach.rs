//! What a scene attaches to blocks: `[[set]]`, `[[load]]`, `[[fixed_point]]` and `[[measured_point]]`. Which blocks are
//! meant is known only when all of them are read.

use super::body::{BlockReference, BodyProperties, KEYS};
use super::lines::{Allowed, Lines, Value};
use crate::block::Point;
use crate::number::Number;
use crate::number_text::{decimal, shown};
use crate::scene::SceneBlock;
use crate::scene::error::SceneProblem;
use crate::scene::tokens::Located;
use crate::simulation::{FixedPoint, MeasuredPoint, PointLoad, Simulation};
use crate::vector::Vec3;
use toml::de::{DeTable, DeValue};

/// As read; blocks not yet looked up.
pub(in crate::scene) struct Attachments {
    sets: Vec<(SetMembers, BodyProperties)>,
    loads: Vec<(BlockPoint, LoadTable)>,
    fixed: Vec<(BlockPoint, Option<Number>)>,
    measured: Vec<(BlockPoint, String)>,
}

/// Times and forces of a load.
type LoadTable = Vec<(Number, Vec3<Number>)>;

/// The blocks of a `[[set]]`.
enum SetMembers {
    All,
    These(Vec<BlockReference>),
}

/// A point of a block.
struct BlockPoint {
    block: BlockReference,
    at: Point,
    what: String,
    line: usize,
}

impl BlockPoint {
    /// The block; the point must be no further outside the block's box than the box is long.
    fn resolve(&self, blocks: &[SceneBlock]) -> Result<usize, Located> {
        let block = self.block.resolve(blocks)?;
        let bounds = blocks[block].block.bounds();
        let axes = [
            (&self.at.x, bounds.min.x, bounds.max.x),
            (&self.at.y, bounds.min.y, bounds.max.y),
            (&self.at.z, bounds.min.z, bounds.max.z),
        ];
        let Some(size) = axes.iter().map(|(_, min, max)| max.plus(&min.negated())).max() else { return Ok(block) };
        let is_near = axes.iter().all(|(c, min, max)| **c >= min.plus(&size.negated()) && **c <= max.plus(&size));
        if is_near {
            return Ok(block);
        }
        let near = |v: &Vec3<&Number>| format!("({}, {}, {})", v.x.approximate(), v.y.approximate(), v.z.approximate());
        let found = shown(&near(&Vec3::new(&self.at.x, &self.at.y, &self.at.z)));
        let allowed = format!(
            "within {} m, the longest side of its box, of block {block} \"{}\", which is {} to {}",
            size.approximate(),
            shown(&blocks[block].name),
            near(&bounds.min),
            near(&bounds.max)
        );
        Err((Some(self.line), SceneProblem::NotAllowed { what: self.what.clone(), found, allowed }))
    }
}

impl Attachments {
    /// Changes the blocks of the sets, in order, and gives loads and points to the simulation.
    pub(in crate::scene) fn attach(
        self,
        blocks: &mut [SceneBlock],
        simulation: &mut Simulation,
    ) -> Result<(), Located> {
        for (meant, patch) in &self.sets {
            let places = match meant {
                SetMembers::All => (0..blocks.len()).collect(),
                SetMembers::These(references) => {
                    references.iter().map(|r| r.resolve(blocks)).collect::<Result<Vec<_>, _>>()?
                }
            };
            for place in places {
                patch.apply(&mut blocks[place].body);
            }
        }
        for (spot, table) in self.loads {
            simulation.loads.push(PointLoad { block: spot.resolve(blocks)?, at: spot.at, table });
        }
        for (spot, stiffness) in self.fixed {
            simulation.fixed_points.push(FixedPoint { block: spot.resolve(blocks)?, at: spot.at, stiffness });
        }
        for (spot, name) in self.measured {
            simulation.measured_points.push(MeasuredPoint { name, block: spot.resolve(blocks)?, at: spot.at });
        }
        Ok(())
    }
}

impl Lines {
    pub(super) fn attached(&self, document: &DeTable<'_>, simulation: &Simulation) -> Result<Attachments, Located> {
        let mut attached = Attachments { sets: Vec::new(), loads: Vec::new(), fixed: Vec::new(), measured: Vec::new() };
        for (value, table) in self.tables(document, "set")? {
            let keys: Vec<&str> = ["blocks"].into_iter().chain(KEYS).collect();
            self.allow_only(table, "[[set]]", &keys)?;
            let blocks = self.meant(self.required(value, table, "[[set]]", "blocks")?)?;
            attached.sets.push((blocks, self.patch(table, "[[set]]", simulation)?));
        }
        for (value, table) in self.tables(document, "load")? {
            self.allow_only(table, "[[load]]", &["block", "at", "force", "table"])?;
            attached.loads.push((self.spot(value, table, "[[load]]")?, self.load_table(value, table)?));
        }
        for (value, table) in self.tables(document, "fixed_point")? {
            let place = "[[fixed_point]]";
            self.allow_only(table, place, &["block", "at", "stiffness"])?;
            let stiffness = self.optional(table, "stiffness", place, Allowed::Positive)?;
            attached.fixed.push((self.spot(value, table, place)?, stiffness));
        }
        for (number, (value, table)) in self.tables(document, "measured_point")?.into_iter().enumerate() {
            let place = "[[measured_point]]";
            self.allow_only(table, place, &["name", "block", "at"])?;
            let given = table.get("name").map(|name| self.name(name, "`name` of [[measured_point]]")).transpose()?;
            let name = given.unwrap_or_else(|| format!("point_{number}"));
            if attached.measured.iter().any(|(_, earlier)| *earlier == name) {
                let taken = "a name that is not taken".to_string();
                let found = format!("\"{}\"", shown(&name));
                return Err(self.not_allowed(value, "`name` of [[measured_point]]", &found, taken));
            }
            attached.measured.push((self.spot(value, table, place)?, name));
        }
        Ok(attached)
    }

    fn meant(&self, value: &Value<'_>) -> Result<SetMembers, Located> {
        match value.get_ref() {
            DeValue::String(word) if word == "all" => Ok(SetMembers::All),
            DeValue::Array(blocks) if blocks.is_empty() => {
                let allowed = "numbers and names of blocks, or \"all\"".to_owned();
                Err(self.not_allowed(value, "`blocks` of [[set]]", "[]", allowed))
            }
            DeValue::Array(blocks) => {
                let references = blocks.iter().map(|block| self.reference(block, "a block of [[set]]"));
                Ok(SetMembers::These(references.collect::<Result<_, _>>()?))
            }
            _ => Err(self.unexpected(value, "`blocks` of [[set]], an array of numbers and names, or \"all\"")),
        }
    }

    fn spot(&self, value: &Value<'_>, table: &DeTable<'_>, place: &str) -> Result<BlockPoint, Located> {
        let block = self.reference(self.required(value, table, place, "block")?, &format!("`block` of {place}"))?;
        let at = self.required(value, table, place, "at")?;
        let what = format!("`at` of {place}");
        Ok(BlockPoint { block, at: self.vector(at, &what, "coordinate")?, what, line: self.of(&at.span()) })
    }

    fn load_table(&self, value: &Value<'_>, load: &DeTable<'_>) -> Result<LoadTable, Located> {
        self.one_of(load, "[[load]]", ["force", "table"])?;
        if let Some(force) = load.get("force") {
            return Ok(vec![(Number::ZERO, self.vector(force, "`force` of [[load]]", "component")?)]);
        }
        let what = "`table` of [[load]]";
        let Some(rows) = load.get("table") else {
            let problem = SceneProblem::Unexpected {
                found: "no `force`".to_string(),
                expected: "a [[load]] with `force` or `table`".to_string(),
            };
            return Err((Some(self.of(&value.span())), problem));
        };
        let mut table: LoadTable = Vec::new();
        for row in self.array(rows, what)? {
            let [time, x, y, z] = self.numbers(row, &format!("a row of {what}"), "number")?;
            if let Some((before, _)) = table.last().filter(|(before, _)| *before >= time) {
                let (found, before) = (decimal(&time), decimal(before));
                let allowed = format!("more than the time before it, {before}");
                return Err(self.not_allowed(row, &format!("a time in {what}"), &found, allowed));
            }
            table.push((time, Vec3::new(x, y, z)));
        }
        if table.is_empty() {
            return Err(self.unexpected(rows, &format!("{what}, one row [time, fx, fy, fz] or more")));
        }
        Ok(table)
    }
}
