//! What a step may leave out.

/// What a step leaves out where nothing can have changed. Nothing of it changes a bit of any result, so all is on unless a run says
/// otherwise: it is no part of what identifies a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Skips {
    /// Blocks whose vertices the last step left as they were are not prepared again, nor are their moments.
    pub blocks: bool,
    /// The contacts of two such blocks, one of which may be fixed, are not looked for again while the same ones are kept: classification
    /// depends on nothing else.
    pub pairs: bool,
    /// Islands to which the last step gave back their own state, in one solve, are not solved again at the same Δt: what would be solved is
    /// the same system.
    pub islands: bool,
    /// Pairs of features that cannot be in a contact while two blocks have moved little since they were last looked at are not looked at.
    pub features: bool,
}

impl Skips {
    /// All of it.
    pub const ALL: Skips = Skips { blocks: true, pairs: true, islands: true, features: true };
    /// None of it.
    pub const NONE: Skips = Skips { blocks: false, pairs: false, islands: false, features: false };
    /// What there is, by the names that files and the command line use.
    pub const NAMES: [&'static str; 4] = ["blocks", "pairs", "islands", "features"];

    /// The names of what is left out.
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        let Skips { blocks, pairs, islands, features } = self;
        Skips::NAMES.into_iter().zip([blocks, pairs, islands, features]).filter(|(_, on)| *on).map(|(name, _)| name)
    }

    /// The same with what is called `name` left out too; none if nothing is called so.
    #[must_use]
    pub fn and(self, name: &str) -> Option<Skips> {
        match name {
            "blocks" => Some(Skips { blocks: true, ..self }),
            "pairs" => Some(Skips { pairs: true, ..self }),
            "islands" => Some(Skips { islands: true, ..self }),
            "features" => Some(Skips { features: true, ..self }),
            _ => None,
        }
    }
}

impl Default for Skips {
    /// All of it.
    fn default() -> Skips {
        Skips::ALL
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_make_what_they_name() {
        let of = |names: &[&str]| names.iter().try_fold(Skips::NONE, |skips, name| skips.and(name));
        assert_eq!(of(&Skips::NAMES), Some(Skips::ALL));
        assert_eq!(Skips::NONE.names().count(), 0);
        for name in Skips::NAMES {
            let one = of(&[name]).unwrap();
            assert_eq!(one.names().collect::<Vec<_>>(), [name]);
            assert_ne!(one, Skips::NONE);
        }
        assert_eq!(of(&["islands", "contacts"]), None);
    }
}
