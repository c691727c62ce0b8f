//! Enums whose variants have names in files and tables.

/// An enum without fields whose variants have names, each written once beside its variant, with its `ALL` and `name`; where asked for
/// after the enum's name, `from_name` and [`Display`](std::fmt::Display) as well.
#[macro_export]
macro_rules! named_enum {
    (
        $(#[$about:meta])*
        $vis:vis enum $Enum:ident $(: $($more:ident),+)? {
            $($(#[$what:meta])* $Variant:ident = $name:literal,)+
        }
    ) => {
        $(#[$about])*
        $vis enum $Enum {
            $($(#[$what])* $Variant,)+
        }

        impl $Enum {
            /// Every variant, in order.
            $vis const ALL: [$Enum; [$($name),+].len()] = [$($Enum::$Variant),+];

            /// The name in files and tables.
            $vis fn name(self) -> &'static str {
                match self {
                    $($Enum::$Variant => $name,)+
                }
            }
        }

        $($($crate::named_enum!(@$more $vis $Enum);)+)?
    };
    (@from_name $vis:vis $Enum:ident) => {
        impl $Enum {
            /// The variant written `name`, if there is one.
            $vis fn from_name(name: &str) -> Option<$Enum> {
                Self::ALL.into_iter().find(|variant| variant.name() == name)
            }
        }
    };
    (@Display $vis:vis $Enum:ident) => {
        impl std::fmt::Display for $Enum {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.name())
            }
        }
    };
}

#[cfg(test)]
mod tests {
    named_enum! {
        /// How a brick lies.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        enum Lie: from_name, Display {
            /// On its face.
            Flat = "flat",
            /// On its edge.
            OnEdge = "on-edge",
        }
    }

    #[test]
    fn names_are_found_padded_and_in_order() {
        assert_eq!(Lie::ALL.map(Lie::name), ["flat", "on-edge"]);
        assert_eq!((Lie::from_name("on-edge"), Lie::from_name("On-Edge")), (Some(Lie::OnEdge), None));
        assert_eq!(format!("{:>8}", Lie::Flat), "    flat");
    }
}
