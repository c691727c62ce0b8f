//! The tables `[simulation]`, `[[material]]` and `[[joint]]`.

use super::lines::{Allowed, Lines, Value};
use crate::number::Number;
use crate::number_text::shown;
use crate::scene::error::SceneProblem;
use crate::scene::tokens::Located;
use crate::simulation::{
    Control, JointPair, JointProperties, Joints, Kinematics, Material, Simulation, Skips, Solver, Unconverged,
    tangent_of_degrees,
};
use toml::de::DeTable;

const CONTROL: [&str; 12] = [
    "gravity",
    "time_step",
    "steps",
    "time",
    "dynamic",
    "damping",
    "settle",
    "kinematics",
    "unconverged",
    "joint_materials",
    "skips",
    "solver",
];
const MATERIAL: [&str; 4] = ["name", "density", "young", "poisson"];
const JOINT: [&str; 8] = [
    "between",
    "friction",
    "friction_angle",
    "cohesion",
    "tension",
    "normal_stiffness",
    "shear_stiffness",
    "shear_ratio",
];

impl Lines {
    /// All but loads and points, which need the blocks.
    pub(super) fn simulation(&self, document: &DeTable<'_>) -> Result<Simulation, Located> {
        let mut simulation = Simulation::default();
        let mut names = None;
        if let Some(value) = document.get("simulation") {
            let table = self.table(value, "`simulation`")?;
            self.allow_only(table, "[simulation]", &CONTROL)?;
            if let Some(value) = table.get("gravity") {
                simulation.gravity = self.vector(value, "`gravity`", "component")?;
            }
            simulation.control = self.control(table)?;
            names = table.get("joint_materials").map(|value| self.joint_names(value)).transpose()?;
        }
        let materials = self.tables(document, "material")?;
        if !materials.is_empty() {
            simulation.materials.clear();
            for (value, table) in materials {
                let material = self.material(value, table, &simulation.materials)?;
                simulation.materials.push(material);
            }
        }
        simulation.joints = self.joints(document, names)?;
        Ok(simulation)
    }

    fn control(&self, table: &DeTable<'_>) -> Result<Control, Located> {
        let place = "[simulation]";
        let default = Control::default();
        self.one_of(table, place, ["steps", "time"])?;
        let whole = |key: &str, least, most| {
            table.get(key).map(|value| self.whole(value, &format!("`{key}` of {place}"), least, most)).transpose()
        };
        let word = |key: &str| table.get(key).map(|value| (value, format!("`{key}` of {place}")));
        let kinematics = word("kinematics")
            .map(|(value, what)| self.word(value, &what, Kinematics::from_name, "\"linear\" or \"cayley\""));
        let unconverged = word("unconverged")
            .map(|(value, what)| self.word(value, &what, Unconverged::from_name, "\"stop\" or \"accept\""));
        let solvers = Solver::ALL.map(|solver| format!("\"{}\"", solver.name())).join(", ");
        let solver = word("solver").map(|(value, what)| self.word(value, &what, Solver::from_name, &solvers));
        let settle = whole("settle", 0, u64::from(u32::MAX))?.and_then(|steps| u32::try_from(steps).ok());
        Ok(Control {
            time_step: self.optional(table, "time_step", place, Allowed::Positive)?.unwrap_or(default.time_step),
            dynamic: self.optional(table, "dynamic", place, Allowed::Share)?.unwrap_or(default.dynamic),
            damping: self.optional(table, "damping", place, Allowed::NotNegative)?.unwrap_or(default.damping),
            settle: settle.unwrap_or(default.settle),
            kinematics: kinematics.transpose()?.unwrap_or(default.kinematics),
            unconverged: unconverged.transpose()?.unwrap_or(default.unconverged),
            steps: whole("steps", 1, i64::MAX as u64)?,
            duration: self.optional(table, "time", place, Allowed::Positive)?,
            skips: table.get("skips").map(|value| self.skips(value)).transpose()?.unwrap_or(default.skips),
            solver: solver.transpose()?.unwrap_or(default.solver),
        })
    }

    /// What steps leave out, by name.
    fn skips(&self, value: &Value<'_>) -> Result<Skips, Located> {
        let allowed = format!("\"{}\"", Skips::NAMES.join("\", \""));
        let mut skips = Skips::NONE;
        for value in self.array(value, "`skips` of [simulation]")? {
            skips = self.word(value, "a name of `skips`", |name| skips.and(name), &allowed)?;
        }
        Ok(skips)
    }

    fn material(&self, value: &Value<'_>, table: &DeTable<'_>, earlier: &[Material]) -> Result<Material, Located> {
        let place = "[[material]]";
        self.allow_only(table, place, &MATERIAL)?;
        let name_value = self.required(value, table, place, "name")?;
        let name = self.name(name_value, "`name` of [[material]]")?;
        if earlier.iter().any(|material| material.name == name) {
            let found = format!("\"{}\"", shown(&name));
            return Err(self.not_allowed(name_value, "`name` of [[material]]", &found, another_name()));
        }
        let default = Material::default();
        let number = |key: &str, allowed| self.optional(table, key, place, allowed);
        Ok(Material {
            name,
            density: number("density", Allowed::Positive)?.unwrap_or(default.density),
            young: number("young", Allowed::Positive)?.unwrap_or(default.young),
            poisson: number("poisson", Allowed::Poisson)?.unwrap_or(default.poisson),
        })
    }

    /// Names of joint materials, in the order in which bodies count them.
    fn joint_names(&self, value: &Value<'_>) -> Result<Vec<String>, Located> {
        let what = "`joint_materials`";
        let mut names = Vec::new();
        for value in self.array(value, what)? {
            let name = self.name(value, "a name of `joint_materials`")?;
            if names.contains(&name) {
                let found = format!("\"{}\"", shown(&name));
                return Err(self.not_allowed(value, "a name of `joint_materials`", &found, another_name()));
            }
            names.push(name);
        }
        if names.is_empty() {
            return Err(self.unexpected(value, "`joint_materials`, one name or more"));
        }
        Ok(names)
    }

    /// `names` is the list the scene gives; without one, the names that `between` mentions are all there are.
    fn joints(&self, document: &DeTable<'_>, names: Option<Vec<String>>) -> Result<Joints, Located> {
        let place = "[[joint]]";
        let is_open = names.is_none();
        let mut joints = Joints { names: names.unwrap_or_default(), ..Joints::default() };
        let mut other = None;
        for (value, table) in self.tables(document, "joint")? {
            self.allow_only(table, place, &JOINT)?;
            let properties = self.joint_properties(table)?;
            let Some(between) = table.get("between") else {
                if other.replace(properties).is_some() {
                    let found = "a second [[joint]] without `between`".to_string();
                    let expected = "`between`: one [[joint]] says what holds for all other pairs".to_string();
                    return Err((Some(self.of(&value.span())), SceneProblem::Unexpected { found, expected }));
                }
                continue;
            };
            let what = "`between` of [[joint]]";
            let [one, second] = self.array(between, what)? else {
                return Err(self.unexpected(between, &format!("{what}, two names of joint materials")));
            };
            let mut place_of = |value: &Value<'_>| {
                let name = self.name(value, what)?;
                if is_open && !joints.names.contains(&name) {
                    joints.names.push(name);
                }
                self.known(value, what, &joints.names)
            };
            let (one, second) = (place_of(one)?, place_of(second)?);
            let same = |pair: &JointPair| {
                (pair.one.min(pair.other), pair.one.max(pair.other)) == (one.min(second), one.max(second))
            };
            if joints.pairs.iter().any(same) {
                let found = format!("\"{}\" and \"{}\"", shown(&joints.names[one]), shown(&joints.names[second]));
                return Err(self.not_allowed(
                    between,
                    what,
                    &found,
                    "a pair that no [[joint]] above names".to_string(),
                ));
            }
            joints.pairs.push(JointPair { one, other: second, properties });
        }
        joints.other = other.unwrap_or_default();
        if joints.names.is_empty() {
            joints.names = Joints::default().names;
        }
        Ok(joints)
    }

    fn joint_properties(&self, table: &DeTable<'_>) -> Result<JointProperties, Located> {
        let place = "[[joint]]";
        let default = JointProperties::default();
        self.one_of(table, place, ["friction", "friction_angle"])?;
        self.one_of(table, place, ["shear_stiffness", "shear_ratio"])?;
        let number = |key: &str, allowed| self.optional(table, key, place, allowed);
        let angle = number("friction_angle", Allowed::Angle)?.map(|degrees| tangent_of_degrees(&degrees));
        let normal_stiffness = number("normal_stiffness", Allowed::Positive)?;
        let shear_stiffness = number("shear_stiffness", Allowed::NotNegative)?;
        let ratio = match (&normal_stiffness, shear_stiffness, table.get("shear_stiffness")) {
            (Some(normal), Some(shear), _) => Some(Number::from_rational(shear.to_rational() / normal.to_rational())),
            (None, Some(_), Some(value)) => {
                let expected = "`shear_ratio`, or `normal_stiffness` beside it".to_string();
                let found = "`shear_stiffness` alone".to_string();
                return Err((Some(self.of(&value.span())), SceneProblem::Unexpected { found, expected }));
            }
            _ => number("shear_ratio", Allowed::NotNegative)?,
        };
        Ok(JointProperties {
            friction: number("friction", Allowed::NotNegative)?.or(angle).unwrap_or(default.friction),
            cohesion: number("cohesion", Allowed::NotNegative)?.unwrap_or(default.cohesion),
            tension: number("tension", Allowed::NotNegative)?.unwrap_or(default.tension),
            normal_stiffness,
            shear_ratio: ratio.unwrap_or(default.shear_ratio),
        })
    }
}

fn another_name() -> String {
    "a name that is not taken".to_string()
}
