//! Names of categories: plural and singular, hyphens, and the head noun of a compound.

use std::collections::HashMap;

use crate::tokens::{SpokenWord, tokenize};

/// Plurals that no rule of spelling gives, with their singular.
const IRREGULAR: [(&str, &str); 22] = [
    ("knives", "knife"),
    ("leaves", "leaf"),
    ("loaves", "loaf"),
    ("shelves", "shelf"),
    ("halves", "half"),
    ("wolves", "wolf"),
    ("calves", "calf"),
    ("scarves", "scarf"),
    ("wives", "wife"),
    ("lives", "life"),
    ("thieves", "thief"),
    ("elves", "elf"),
    ("hooves", "hoof"),
    ("mice", "mouse"),
    ("geese", "goose"),
    ("feet", "foot"),
    ("teeth", "tooth"),
    ("men", "man"),
    ("women", "woman"),
    ("children", "child"),
    ("people", "person"),
    ("dice", "die"),
];

/// Words that end in s and name one thing.
const PLURAL_FORM_OF_ONE: [&str; 14] = [
    "scissors",
    "pliers",
    "glasses",
    "goggles",
    "tongs",
    "headphones",
    "earphones",
    "tweezers",
    "binoculars",
    "trousers",
    "jeans",
    "pants",
    "shorts",
    "gas",
];

/// Most words of a name that is looked up.
const NAME_WORDS_MAX: usize = 4;

/// Singular of a noun in lower case, by the rules of spelling.
pub(crate) fn singular(word: &str) -> String {
    if let Some((_, singular)) = IRREGULAR.iter().find(|(plural, _)| *plural == word) {
        return (*singular).to_owned();
    }
    let is_short = word.chars().count() <= 3;
    let keeps_s = ["ss", "us", "is"].iter().any(|end| word.ends_with(end));
    if is_short || keeps_s || !word.ends_with('s') {
        return word.to_owned();
    }
    if let Some(stem) = word.strip_suffix("ies")
        && stem.chars().count() > 2
    {
        return format!("{stem}y");
    }
    let drops_es = ["xes", "ches", "shes", "sses", "zzes", "oes"];
    let n_dropped = 1 + usize::from(drops_es.iter().any(|end| word.ends_with(end)));
    word[..word.len() - n_dropped].to_owned()
}

/// True if a word is the plural of another.
pub(crate) fn is_plural(word: &str) -> bool {
    singular(word) != word && !PLURAL_FORM_OF_ONE.contains(&word)
}

/// Key by which two spellings of a name are equal: without separators, the last word singular.
pub(crate) fn name_key(words: &[SpokenWord]) -> String {
    let Some((last, first)) = words.split_last() else {
        return String::new();
    };
    let mut key: String = first.iter().map(|token| token.word.as_str()).collect();
    key.push_str(&singular(&last.word));
    key
}

/// Index of the names that are known, by key.
#[derive(Debug, Default)]
pub(crate) struct NameIndex {
    /// Names by key, with true if the name is a plural as it was taught.
    names: HashMap<String, bool>,
}

impl NameIndex {
    pub(crate) fn new<'a>(names: impl IntoIterator<Item = &'a str>) -> Self {
        let entry = |name| {
            let words = tokenize(name);
            let is_plural = words.last().is_some_and(|last| is_plural(&last.word));
            (name_key(&words), is_plural)
        };
        let names = names.into_iter().map(entry);
        Self {
            names: names.filter(|(key, _)| !key.is_empty()).collect(),
        }
    }

    /// Number of words of the longest known name at the start of the words.
    pub(crate) fn longest_at_start(&self, words: &[SpokenWord]) -> Option<usize> {
        let most = words.len().min(NAME_WORDS_MAX);
        (1..=most).rev().find(|n| self.has(&words[..*n]))
    }

    pub(crate) fn has(&self, words: &[SpokenWord]) -> bool {
        self.names.contains_key(&name_key(words))
    }

    /// True if the words mean several objects: a plural that is not itself the name.
    pub(crate) fn is_plural(&self, words: &[SpokenWord]) -> bool {
        let is_name_plural = self.names.get(&name_key(words)).copied();
        let last = words.last();
        last.is_some_and(|last| is_plural(&last.word)) && is_name_plural != Some(true)
    }
}

/// Agreement of spoken words with the name of a category.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NameAgreement {
    /// The same name, number and hyphens aside.
    Same,
    /// The last word of a compound: "box" for "cereal-box".
    Head,
}

/// Agreement of spoken words with the words of a category's name.
pub(crate) fn agreement(spoken: &[SpokenWord], name: &[SpokenWord]) -> Option<NameAgreement> {
    let key = name_key(spoken);
    if key == name_key(name) {
        return Some(NameAgreement::Same);
    }
    let is_head = (1..name.len()).any(|first| name_key(&name[first..]) == key);
    is_head.then_some(NameAgreement::Head)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_have_a_singular() {
        for (plural, one) in [
            ("mugs", "mug"),
            ("boxes", "box"),
            ("knives", "knife"),
            ("batteries", "battery"),
            ("glass", "glass"),
            ("tomatoes", "tomato"),
            ("pies", "pie"),
            ("brushes", "brush"),
            ("vases", "vase"),
        ] {
            assert_eq!(singular(plural), one);
        }
        assert!(is_plural("mugs") && !is_plural("mug") && !is_plural("scissors"));
    }

    #[test]
    fn names_agree_without_hyphens_and_number() {
        let agree = |spoken, name| agreement(&tokenize(spoken), &tokenize(name));
        assert_eq!(
            agree("cereal boxes", "cereal-box"),
            Some(NameAgreement::Same)
        );
        assert_eq!(agree("tea pot", "teapot"), Some(NameAgreement::Same));
        assert_eq!(agree("box", "cereal-box"), Some(NameAgreement::Head));
        assert_eq!(agree("pop tart", "pop-tarts"), Some(NameAgreement::Same));
        assert_eq!(agree("cereal", "cereal-box"), None);
    }

    #[test]
    fn names_that_are_plural_as_taught_mean_one_object() {
        let index = NameIndex::new(["pop-tarts", "mug"]);
        assert!(!index.is_plural(&tokenize("pop tarts")));
        assert!(index.is_plural(&tokenize("mugs")));
        assert_eq!(
            index.longest_at_start(&tokenize("pop tarts left of")),
            Some(2)
        );
        assert_eq!(index.longest_at_start(&tokenize("shiny mug")), None);
    }
}
