//! Compound nouns: order of their words, and agreement of spoken words with a part of them.

use crate::names::singular;
use crate::tokens::SpokenWord;
use crate::vocabulary::NUMERALS;

/// Containers: a compound with one as its head is called by what is in it, too ("the wine").
const CONTAINERS: [&str; 24] = [
    "bag",
    "bottle",
    "bowl",
    "box",
    "can",
    "canister",
    "carton",
    "container",
    "crate",
    "cup",
    "flask",
    "glass",
    "jar",
    "jug",
    "keg",
    "mug",
    "pack",
    "package",
    "packet",
    "pot",
    "pouch",
    "sachet",
    "tin",
    "tube",
];

/// Words that join the parts of a compound and name nothing.
const CONNECTIVES: [&str; 7] = ["and", "of", "the", "a", "an", "n", "with"];

/// Agreement of spoken words with the name of a category.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NameAgreement {
    /// The same name, number and hyphens aside.
    Same,
    /// The last words of a compound: "box" for "cereal-box".
    Head,
    /// The contents of a container: "wine" for "wine-bottle".
    Contents,
    /// Another part of a compound: "tennis" for "tennis-ball".
    Part,
}

/// True if a word names a container, in the singular or plural.
pub(crate) fn is_container(word: &str) -> bool {
    CONTAINERS.contains(&singular(word).as_str())
}

/// Words of a compound in the order of "tea box" for "boxes of tea", all of them singular.
pub(crate) fn canonical_words(words: &[SpokenWord]) -> Vec<String> {
    let (head, contents) = split_at_of(words).unwrap_or((words, &[]));
    let words = contents.iter().chain(head);
    words
        .map(|token| singular(in_letters(&token.word)))
        .collect()
}

/// Number in letters for one in digits: "seven" for "7".
fn in_letters(word: &str) -> &str {
    let count = word.parse::<usize>().ok();
    let mut numerals = NUMERALS.iter();
    let numeral = numerals.find(|(_, number)| Some(*number) == count);
    numeral.map_or(word, |(letters, _)| letters)
}

/// Word that carries the number of a compound: the last one, or the last before "of".
pub(crate) fn head_word(words: &[SpokenWord]) -> Option<&SpokenWord> {
    split_at_of(words).map_or(words, |(head, _)| head).last()
}

fn split_at_of(words: &[SpokenWord]) -> Option<(&[SpokenWord], &[SpokenWord])> {
    let position = words.iter().position(|token| token.word == "of")?;
    let (head, after) = (words.get(..position)?, words.get(position + 1..)?);
    (!head.is_empty() && !after.is_empty()).then_some((head, after))
}

/// Agreement of spoken words with the words of a category's name.
pub(crate) fn agreement(spoken: &[SpokenWord], name: &[SpokenWord]) -> Option<NameAgreement> {
    let key = canonical_words(spoken).concat();
    let name = canonical_words(name);
    if key.is_empty() || CONNECTIVES.contains(&key.as_str()) {
        return None;
    }
    if key == name.concat() {
        return Some(NameAgreement::Same);
    }
    if (1..name.len()).any(|first| name[first..].concat() == key) {
        return Some(NameAgreement::Head);
    }
    let is_contained = (0..name.len())
        .any(|first| (first + 1..name.len()).any(|end| name[first..end].concat() == key));
    let has_container = name.last().is_some_and(|head| is_container(head));
    is_contained.then_some(if has_container {
        NameAgreement::Contents
    } else {
        NameAgreement::Part
    })
}

/// Keys of the last words of a compound, and of its other parts.
pub(crate) fn part_keys(name: &[SpokenWord]) -> (Vec<String>, Vec<String>) {
    let name = canonical_words(name);
    let heads = (1..name.len()).map(|first| name[first..].concat());
    let others = (0..name.len())
        .flat_map(|first| (first + 1..name.len()).map(move |end| (first, end)))
        .map(|(first, end)| name[first..end].concat());
    let names_something = |key: &String| !CONNECTIVES.contains(&key.as_str());
    (
        heads.filter(names_something).collect(),
        others.filter(names_something).collect(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tokens::tokenize;

    fn agree(spoken: &str, name: &str) -> Option<NameAgreement> {
        agreement(&tokenize(spoken), &tokenize(name))
    }

    #[test]
    fn compound_agrees_without_hyphens_and_number() {
        for (spoken, name) in [
            ("cereal boxes", "cereal-box"),
            ("tea pot", "teapot"),
            ("pop tart", "pop-tarts"),
            ("cereals box", "cereal-box"),
            ("boxes of tea", "box-of-tea"),
            ("tea box", "box-of-tea"),
            ("7 up", "seven-up"),
            ("bottle of wine", "wine-bottle"),
        ] {
            assert_eq!(agree(spoken, name), Some(NameAgreement::Same), "{spoken}");
        }
    }

    #[test]
    fn compound_agrees_with_its_parts() {
        assert_eq!(agree("box", "cereal-box"), Some(NameAgreement::Head));
        assert_eq!(agree("box", "box-of-tea"), Some(NameAgreement::Head));
        assert_eq!(
            agree("cereals", "cereal-box"),
            Some(NameAgreement::Contents)
        );
        assert_eq!(agree("tennis", "tennis-ball"), Some(NameAgreement::Part));
        assert_eq!(agree("salt", "salt-and-pepper"), Some(NameAgreement::Part));
        assert_eq!(agree("and", "salt-and-pepper"), None);
        assert_eq!(agree("cat", "cereal-box"), None);
    }
}
