//! Macro for enumerations of the allowed names of a key.

/// Defines an enumeration whose variants have names in case files; the first variant is the default.
macro_rules! named_enum {
    ($(#[$doc:meta])* $name:ident {
        $(#[$first_doc:meta])* $first:ident = $first_name:literal
        $(, $(#[$other_doc:meta])* $other:ident = $other_name:literal)*
    }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub enum $name {
            #[default]
            $(#[$first_doc])* $first,
            $($(#[$other_doc])* $other),*
        }

        impl $name {
            /// All variants, the default first.
            pub const ALL: &[Self] = &[Self::$first $(, Self::$other)*];

            /// Returns the name of the variant in case files.
            pub const fn name(self) -> &'static str {
                match self {
                    Self::$first => $first_name,
                    $(Self::$other => $other_name),*
                }
            }
        }
    };
}

pub(crate) use named_enum;
