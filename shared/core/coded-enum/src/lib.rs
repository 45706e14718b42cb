//! Macro for enums whose variants have a word for people and scripts, and perhaps a code on the
//! wire or on disk.
//!
//! ```
//! coded_enum::coded_enum! {
//!     /// State of a door.
//!     #[derive(Hash)]
//!     pub enum Door: u32 {
//!         /// Nobody can pass.
//!         Closed = 1, "closed";
//!         /// Everybody can pass.
//!         Open = 2, "open";
//!     }
//! }
//!
//! assert_eq!(Door::ALL, [Door::Closed, Door::Open]);
//! assert_eq!((Door::Open.word(), Door::Open.code()), ("open", 2));
//! assert_eq!((Door::from_code(1), Door::from_code(3)), (Some(Door::Closed), None));
//! ```
//!
//! Invariants: word and code of a variant stand beside it, once.

/// Declares an enum without fields: each variant with its word, and its code if the enum has a
/// type of codes.
///
/// The enum derives `Debug`, `Clone`, `Copy`, `PartialEq` and `Eq`, has the constant `ALL` in the
/// order of declaration, and the method `word`; with a type of codes also `code` and `from_code`.
#[macro_export]
macro_rules! coded_enum {
    ($(#[$meta:meta])* $vis:vis enum $name:ident: $code:ty { $($body:tt)+ }) => {
        $crate::coded_enum! { $(#[$meta])* $vis enum $name { $($body)+ } }

        impl $name {
            /// Code of the variant on the wire and on disk.
            $vis fn code(self) -> $code {
                self as $code
            }

            /// Variant of a code; `None` for an unknown code.
            $vis fn from_code(code: $code) -> Option<Self> {
                Self::ALL.into_iter().find(|one| one.code() == code)
            }
        }
    };
    ($(#[$meta:meta])* $vis:vis enum $name:ident {
        $($(#[$doc:meta])* $variant:ident $(= $value:literal)?, $word:literal;)+
    }) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        $vis enum $name {
            $($(#[$doc])* $variant $(= $value)?,)+
        }

        impl $name {
            /// All variants in the order of their declaration.
            $vis const ALL: [Self; [$($word),+].len()] = [$(Self::$variant),+];

            /// Word of the variant, for people and scripts.
            $vis fn word(self) -> &'static str {
                match self {
                    $(Self::$variant => $word,)+
                }
            }
        }

        // The list of a private enum need not be used.
        const _: usize = $name::ALL.len();
    };
}
