//! All pictures, by file name.

mod axonometric;
mod contact_types;
mod entrance;
mod shapes;
mod svg;
mod territories;

/// The file name and the text of every picture.
pub(crate) fn pictures() -> Vec<(&'static str, String)> {
    vec![
        ("contact-types.svg", contact_types::draw()),
        ("territories.svg", territories::draw()),
        ("entrance.svg", entrance::draw()),
    ]
}
