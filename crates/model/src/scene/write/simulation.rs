//! What makes blocks move, as TOML.

use super::{push, toml_number};
use crate::number::Number;
use crate::simulation::{Body, JointProperties, Joints, Simulation, Skips, Solver};
use crate::vector::Vec3;

/// `[simulation]`, `[[material]]` and `[[joint]]`, whole.
pub(super) fn write_simulation(out: &mut String, simulation: &Simulation) {
    let control = &simulation.control;
    out.push_str("[simulation]\n");
    push(out, format_args!("gravity = {}\n", vector(&simulation.gravity)));
    number(out, "time_step", &control.time_step);
    if let Some(steps) = control.steps {
        push(out, format_args!("steps = {steps}\n"));
    }
    if let Some(duration) = &control.duration {
        number(out, "time", duration);
    }
    number(out, "dynamic", &control.dynamic);
    if !control.damping.is_zero() {
        number(out, "damping", &control.damping);
    }
    push(out, format_args!("settle = {}\n", control.settle));
    push(out, format_args!("kinematics = \"{}\"\n", control.kinematics.name()));
    push(out, format_args!("unconverged = \"{}\"\n", control.unconverged.name()));
    if control.solver != Solver::Auto {
        push(out, format_args!("solver = \"{}\"\n", control.solver.name()));
    }
    if control.skips != Skips::ALL {
        let names: Vec<String> = control.skips.names().map(|name| format!("\"{name}\"")).collect();
        push(out, format_args!("skips = [{}]\n", names.join(", ")));
    }
    let names: Vec<String> = simulation.joints.names.iter().map(|name| text(name)).collect();
    push(out, format_args!("joint_materials = [{}]\n\n", names.join(", ")));
    for material in &simulation.materials {
        push(out, format_args!("[[material]]\nname = {}\n", text(&material.name)));
        number(out, "density", &material.density);
        number(out, "young", &material.young);
        number(out, "poisson", &material.poisson);
        out.push('\n');
    }
    joints(out, &simulation.joints);
}

fn joints(out: &mut String, joints: &Joints) {
    for pair in &joints.pairs {
        let [one, other] = [pair.one, pair.other].map(|place| text(&joints.names[place]));
        push(out, format_args!("[[joint]]\nbetween = [{one}, {other}]\n"));
        properties(out, &pair.properties);
    }
    out.push_str("[[joint]]\n");
    properties(out, &joints.other);
}

fn properties(out: &mut String, properties: &JointProperties) {
    number(out, "friction", &properties.friction);
    number(out, "cohesion", &properties.cohesion);
    number(out, "tension", &properties.tension);
    if let Some(stiffness) = &properties.normal_stiffness {
        number(out, "normal_stiffness", stiffness);
    }
    number(out, "shear_ratio", &properties.shear_ratio);
    out.push('\n');
}

/// The keys of a block that differ from the default.
pub(super) fn body(out: &mut String, body: &Body, simulation: &Simulation) {
    let default = Body::default();
    if body.is_fixed() {
        out.push_str("fixed = true\n");
    } else if body.motion != default.motion {
        push(out, format_args!("motion = \"{}\"\n", body.motion.name()));
    }
    if body.material != default.material {
        push(out, format_args!("material = {}\n", text(&simulation.materials[body.material].name)));
    }
    if body.joint != default.joint {
        push(out, format_args!("joint = {}\n", text(&simulation.joints.names[body.joint])));
    }
    for (key, value, rest) in [("velocity", &body.velocity, &default.velocity), ("spin", &body.spin, &default.spin)] {
        if value != rest {
            push(out, format_args!("{key} = {}\n", vector(value)));
        }
    }
    if body.stress != default.stress {
        let components = body.stress.each_ref().map(toml_number);
        push(out, format_args!("stress = [{}]\n", components.join(", ")));
    }
}

/// Loads and points; blocks by number, since names need not be unique.
pub(super) fn attached(out: &mut String, simulation: &Simulation) {
    for load in &simulation.loads {
        push(out, format_args!("\n[[load]]\nblock = {}\nat = {}\n", load.block, vector(&load.at)));
        match load.table.as_slice() {
            [(time, force)] if time.is_zero() => push(out, format_args!("force = {}\n", vector(force))),
            table => {
                let row = |(t, f): &(Number, Vec3<Number>)| {
                    let [x, y, z] = f.components().map(toml_number);
                    format!("[{}, {x}, {y}, {z}]", toml_number(t))
                };
                push(out, format_args!("table = [{}]\n", table.iter().map(row).collect::<Vec<_>>().join(", ")));
            }
        }
    }
    for point in &simulation.fixed_points {
        push(out, format_args!("\n[[fixed_point]]\nblock = {}\nat = {}\n", point.block, vector(&point.at)));
        if let Some(stiffness) = &point.stiffness {
            number(out, "stiffness", stiffness);
        }
    }
    for point in &simulation.measured_points {
        push(out, format_args!("\n[[measured_point]]\nname = {}\n", text(&point.name)));
        push(out, format_args!("block = {}\nat = {}\n", point.block, vector(&point.at)));
    }
}

fn number(out: &mut String, key: &str, value: &Number) {
    push(out, format_args!("{key} = {}\n", toml_number(value)));
}

fn vector(v: &Vec3<Number>) -> String {
    format!("[{}]", v.components().map(toml_number).join(", "))
}

fn text(name: &str) -> String {
    toml::Value::from(name).to_string()
}
