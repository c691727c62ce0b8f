//! What a scene says of blocks: how they move, what they are made of, and by which number or name they are meant.

use super::lines::{Lines, Value, listed};
use crate::number::Number;
use crate::number_text::shown;
use crate::scene::SceneBlock;
use crate::scene::error::SceneProblem;
use crate::scene::tokens::Located;
use crate::simulation::{Body, Motion, Simulation};
use crate::vector::Vec3;
use toml::de::{DeTable, DeValue};

/// Keys of a [`BodyProperties`].
pub(super) const KEYS: [&str; 7] = ["motion", "fixed", "material", "joint", "velocity", "spin", "stress"];

/// Properties of bodies, of which a table may give any.
#[derive(Clone, Default)]
pub(in crate::scene) struct BodyProperties {
    motion: Option<Motion>,
    material: Option<usize>,
    joint: Option<usize>,
    velocity: Option<Vec3<Number>>,
    spin: Option<Vec3<Number>>,
    stress: Option<[Number; 6]>,
}

impl BodyProperties {
    /// Changes what is given.
    pub(in crate::scene) fn apply(&self, body: &mut Body) {
        fn set<T: Clone>(to: &mut T, from: &Option<T>) {
            if let Some(value) = from {
                to.clone_from(value);
            }
        }
        set(&mut body.motion, &self.motion);
        set(&mut body.material, &self.material);
        set(&mut body.joint, &self.joint);
        set(&mut body.velocity, &self.velocity);
        set(&mut body.spin, &self.spin);
        set(&mut body.stress, &self.stress);
    }
}

/// A block as a table names it.
pub(in crate::scene) struct BlockReference {
    block: Named,
    /// The key, for messages.
    what: String,
    line: usize,
}

enum Named {
    Number(String),
    Name(String),
}

impl BlockReference {
    /// The place of the block meant.
    pub(in crate::scene) fn resolve(&self, blocks: &[SceneBlock]) -> Result<usize, Located> {
        let refuse = |found: String, allowed: String| {
            (Some(self.line), SceneProblem::NotAllowed { what: self.what.clone(), found, allowed })
        };
        match &self.block {
            Named::Number(digits) => match digits.parse::<usize>() {
                Ok(number) if number < blocks.len() => Ok(number),
                _ => Err(refuse(shown(digits), numbers_and_names(blocks))),
            },
            Named::Name(name) => {
                let mut places = blocks.iter().enumerate().filter(|(_, block)| block.name == *name).map(|(i, _)| i);
                match (places.next(), places.next()) {
                    (Some(place), None) => Ok(place),
                    (None, _) => Err(refuse(format!("\"{}\"", shown(name)), numbers_and_names(blocks))),
                    (Some(one), Some(other)) => {
                        let allowed = format!("a number: blocks {one} and {other} both have this name");
                        Err(refuse(format!("\"{}\"", shown(name)), allowed))
                    }
                }
            }
        }
    }
}

fn numbers_and_names(blocks: &[SceneBlock]) -> String {
    let names: Vec<String> = blocks.iter().map(|block| block.name.clone()).collect();
    format!("a block's number, 0 to {}, or its name: {}", blocks.len().saturating_sub(1), listed(&names))
}

impl Lines {
    pub(super) fn patch(
        &self,
        table: &DeTable<'_>,
        place: &str,
        simulation: &Simulation,
    ) -> Result<BodyProperties, Located> {
        let what = |key: &str| format!("`{key}` of {place}");
        let names: Vec<String> = simulation.materials.iter().map(|material| material.name.clone()).collect();
        let vector = |key: &str| table.get(key).map(|value| self.vector(value, &what(key), "component")).transpose();
        Ok(BodyProperties {
            motion: self.motion(table, place)?,
            material: table.get("material").map(|v| self.known(v, &what("material"), &names)).transpose()?,
            joint: table.get("joint").map(|v| self.known(v, &what("joint"), &simulation.joints.names)).transpose()?,
            velocity: vector("velocity")?,
            spin: vector("spin")?,
            stress: table.get("stress").map(|v| self.numbers(v, &what("stress"), "component")).transpose()?,
        })
    }

    /// `motion`, or `fixed`, which is older and shorter.
    fn motion(&self, table: &DeTable<'_>, place: &str) -> Result<Option<Motion>, Located> {
        self.one_of(table, place, ["motion", "fixed"])?;
        if let Some(value) = table.get("fixed") {
            let is_fixed = self.flag(value, "`fixed`")?;
            return Ok(Some(if is_fixed { Motion::Fixed } else { Motion::default() }));
        }
        let allowed = "\"deformable\", \"rigid\" or \"fixed\"";
        let what = format!("`motion` of {place}");
        table.get("motion").map(|value| self.word(value, &what, Motion::from_name, allowed)).transpose()
    }

    /// A block's number or name.
    pub(super) fn reference(&self, value: &Value<'_>, what: &str) -> Result<BlockReference, Located> {
        let block = match value.get_ref() {
            DeValue::Integer(integer) if integer.radix() == 10 => Named::Number(integer.as_str().to_string()),
            DeValue::String(name) => Named::Name(name.to_string()),
            _ => return Err(self.unexpected(value, &format!("{what}, a block's number or name"))),
        };
        Ok(BlockReference { block, what: what.to_string(), line: self.of(&value.span()) })
    }
}
