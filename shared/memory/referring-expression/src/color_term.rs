//! Basic colour terms of Berlin and Kay, and shades that are mapped to them.

use ColorTerm::{Black, Blue, Brown, Green, Grey, Orange, Pink, Purple, Red, White, Yellow};

/// Basic colour term of English (Berlin and Kay, 1969).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ColorTerm {
    /// Black.
    Black,
    /// White.
    White,
    /// Grey.
    Grey,
    /// Red.
    Red,
    /// Green.
    Green,
    /// Yellow.
    Yellow,
    /// Blue.
    Blue,
    /// Brown.
    Brown,
    /// Orange.
    Orange,
    /// Pink.
    Pink,
    /// Purple.
    Purple,
}

impl ColorTerm {
    /// All terms, in the order of [`WorldObject::color_shares`](crate::WorldObject::color_shares).
    pub const ALL: [Self; 11] = [
        Black, White, Grey, Red, Green, Yellow, Blue, Brown, Orange, Pink, Purple,
    ];

    /// English word, in lower case and British spelling.
    pub fn word(self) -> &'static str {
        match self {
            Black => "black",
            White => "white",
            Grey => "grey",
            Red => "red",
            Green => "green",
            Yellow => "yellow",
            Blue => "blue",
            Brown => "brown",
            Orange => "orange",
            Pink => "pink",
            Purple => "purple",
        }
    }
}

/// Colour word with the terms that it may stand for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Shade {
    /// Terms of which one has to fit.
    pub(crate) terms: &'static [ColorTerm],
    /// False for a basic term itself; true for a word that is only mapped to terms.
    pub(crate) is_mapped: bool,
}

/// Shades beside the basic terms.
const SHADES: [(&str, &[ColorTerm]); 56] = [
    ("crimson", &[Red]),
    ("scarlet", &[Red]),
    ("ruby", &[Red]),
    ("cherry", &[Red]),
    ("maroon", &[Red, Brown]),
    ("burgundy", &[Red, Purple]),
    ("coral", &[Pink, Orange]),
    ("salmon", &[Pink, Orange]),
    ("peach", &[Orange, Pink]),
    ("rose", &[Pink, Red]),
    ("magenta", &[Pink, Purple]),
    ("fuchsia", &[Pink, Purple]),
    ("violet", &[Purple]),
    ("lilac", &[Purple]),
    ("lavender", &[Purple]),
    ("mauve", &[Purple, Pink]),
    ("indigo", &[Blue, Purple]),
    ("navy", &[Blue]),
    ("azure", &[Blue]),
    ("cobalt", &[Blue]),
    ("sky", &[Blue]),
    ("cyan", &[Blue, Green]),
    ("teal", &[Green, Blue]),
    ("turquoise", &[Green, Blue]),
    ("aqua", &[Blue, Green]),
    ("mint", &[Green]),
    ("lime", &[Green, Yellow]),
    ("olive", &[Green, Brown]),
    ("khaki", &[Green, Brown]),
    ("emerald", &[Green]),
    ("beige", &[White, Brown]),
    ("cream", &[White, Yellow]),
    ("ivory", &[White]),
    ("tan", &[Brown]),
    ("bronze", &[Brown]),
    ("copper", &[Brown, Orange]),
    ("chocolate", &[Brown]),
    ("amber", &[Orange, Yellow]),
    ("gold", &[Yellow]),
    ("golden", &[Yellow]),
    ("mustard", &[Yellow]),
    ("blond", &[Yellow]),
    ("silver", &[Grey]),
    ("silvery", &[Grey]),
    ("charcoal", &[Grey, Black]),
    ("reddish", &[Red]),
    ("greenish", &[Green]),
    ("yellowish", &[Yellow]),
    ("bluish", &[Blue]),
    ("blueish", &[Blue]),
    ("brownish", &[Brown]),
    ("pinkish", &[Pink]),
    ("purplish", &[Purple]),
    ("greyish", &[Grey]),
    ("whitish", &[White]),
    ("blackish", &[Black]),
];

/// Shade that a word in lower case names.
pub(crate) fn shade(word: &str) -> Option<Shade> {
    let is_word = |term: &&ColorTerm| term.word() == word;
    if let Some(term) = ColorTerm::ALL.iter().find(is_word) {
        return Some(Shade {
            terms: std::slice::from_ref(term),
            is_mapped: false,
        });
    }
    let (_, terms) = SHADES.iter().find(|(shade, _)| *shade == word)?;
    Some(Shade {
        terms,
        is_mapped: true,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn color_term_maps_shades_to_basic_terms() {
        assert_eq!(shade("red").unwrap().terms, [Red]);
        assert!(!shade("red").unwrap().is_mapped);
        assert_eq!(shade("teal").unwrap().terms, [Green, Blue]);
        assert!(shade("teal").unwrap().is_mapped);
        assert_eq!(shade("shiny"), None);
    }
}
