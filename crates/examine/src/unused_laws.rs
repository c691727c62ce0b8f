//! Laws of joints that apply to no two blocks of a scene.

use rockproof_model::simulation::JointProperties;
use rockproof_model::text::{EXCERPT_LENGTH, excerpt};
use rockproof_model::{Number, Scene};
use std::collections::HashSet;

/// The most laws named.
const MAX_NAMED: usize = 3;

/// The `[[joint]]` of a scene that apply to no two of its blocks, and what holds instead; `None` where all do, and where there are no two blocks.
pub fn unused_laws(scene: &Scene) -> Option<String> {
    let joints = &scene.simulation.joints;
    let present = scene.joint_pairs();
    if present.is_empty() {
        return None;
    }
    let name = |joint: usize| format!("\"{}\"", excerpt(&joints.names[joint], EXCERPT_LENGTH));
    let named: Vec<[usize; 2]> =
        joints.pairs.iter().map(|pair| [pair.one.min(pair.other), pair.one.max(pair.other)]).collect();
    let are_named: HashSet<[usize; 2]> = named.iter().copied().collect();
    let are_present: HashSet<[usize; 2]> = present.iter().copied().collect();
    let unnamed = present.iter().find(|pair| !are_named.contains(*pair));
    let unused: Vec<[usize; 2]> = named.iter().filter(|pair| !are_present.contains(*pair)).copied().collect();
    let is_given = joints.other != JointProperties::default();
    if unused.is_empty() {
        let is_idle = is_given && unnamed.is_none();
        return is_idle.then(|| {
            "the [[joint]] without `between` applies to no two blocks: each pair of their joint materials has one of its own".to_owned()
        });
    }
    let laws = unused.iter().take(MAX_NAMED).map(|&[one, other]| {
        let is_lacking = |joint: &usize| scene.blocks.iter().all(|block| block.body.joint != *joint);
        let why = match [one, other].into_iter().find(is_lacking) {
            Some(joint) => format!("no block has the joint material {}", name(joint)),
            None => format!("only one block has the joint material {}", name(one)),
        };
        format!("between {} and {} ({why})", name(one), name(other))
    });
    let laws = laws.collect::<Vec<_>>().join("; ");
    let more = unused.len().saturating_sub(MAX_NAMED);
    let more = if more > 0 { format!("; and {more} more") } else { String::new() };
    let instead = match unnamed {
        None => "each pair of their joint materials has one of its own".to_owned(),
        Some(&[one, other]) => {
            let whose = if is_given { "the [[joint]] without `between` holds" } else { "the defaults hold" };
            format!("between {} and {} {whose}: {}", name(one), name(other), values(&joints.other))
        }
    };
    Some(format!("a [[joint]] applies to no two blocks: {laws}{more}; {instead}"))
}

/// The properties of a law in a line.
fn values(law: &JointProperties) -> String {
    let [friction, cohesion, tension, shear] =
        [&law.friction, &law.cohesion, &law.tension, &law.shear_ratio].map(Number::approximate);
    let stiffness = match &law.normal_stiffness {
        Some(stiffness) => format!("{:e} N/m", stiffness.approximate()),
        None => "derived".to_owned(),
    };
    format!(
        "friction {friction}, cohesion {cohesion} Pa, tension {tension} Pa, normal_stiffness {stiffness}, shear_ratio {shear}"
    )
}
