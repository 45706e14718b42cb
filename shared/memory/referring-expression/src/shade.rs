//! Shades that are mapped to the basic colour terms.

use point_cloud::ColorTerm::{
    self, Black, Blue, Brown, Green, Grey, Orange, Pink, Purple, Red, White, Yellow,
};

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

/// Words that name a shade.
pub(crate) fn shade_words() -> impl Iterator<Item = &'static str> {
    let terms = ColorTerm::ALL.into_iter().map(ColorTerm::word);
    terms.chain(SHADES.iter().map(|(word, _)| *word))
}

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
    fn shade_maps_words_to_basic_terms() {
        assert_eq!(shade("red").unwrap().terms, [Red]);
        assert!(!shade("red").unwrap().is_mapped);
        assert_eq!(shade("teal").unwrap().terms, [Green, Blue]);
        assert!(shade("teal").unwrap().is_mapped);
        assert_eq!(shade("shiny"), None);
    }
}
