//! Names of categories: plural and singular, hyphens, and the index of known names.

use std::collections::{HashMap, HashSet};

use crate::compound::{canonical_words, head_word, part_keys};
use crate::tokens::{SpokenWord, tokenize};

/// Plurals that no rule of spelling gives, with their singular.
const IRREGULAR: [(&str, &str); 25] = [
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
    ("shoes", "shoe"),
    ("horseshoes", "horseshoe"),
    ("canoes", "canoe"),
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
const NAME_WORDS_MAX: usize = 5;

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

/// Regular plural of a noun in the singular.
pub(crate) fn plural(word: &str) -> String {
    let takes_es = ["x", "ch", "sh", "s", "z"]
        .iter()
        .any(|end| word.ends_with(end));
    format!("{word}{}", if takes_es { "es" } else { "s" })
}

/// True if a word is the plural of another.
pub(crate) fn is_plural(word: &str) -> bool {
    singular(word) != word && !PLURAL_FORM_OF_ONE.contains(&word)
}

/// Key by which two spellings of a name are equal: without separators, the head singular.
pub(crate) fn name_key(words: &[SpokenWord]) -> String {
    canonical_words(words).concat()
}

/// Index of the names that are known, by key.
#[derive(Debug, Default)]
pub(crate) struct NameIndex {
    /// Names by key, with true if the name is a plural as it was taught.
    names: HashMap<String, bool>,
    /// Keys of the last words of compounds.
    heads: HashSet<String>,
    /// Keys of the other parts of compounds.
    parts: HashSet<String>,
    /// Names with their words, in any order.
    words: Vec<Vec<SpokenWord>>,
}

impl NameIndex {
    pub(crate) fn new<'a>(names: impl IntoIterator<Item = &'a str>) -> Self {
        let distinct: std::collections::BTreeSet<&str> = names.into_iter().collect();
        let tokens = distinct.into_iter().map(tokenize);
        let words: Vec<Vec<SpokenWord>> = tokens.filter(|words| !words.is_empty()).collect();
        let entry = |words: &Vec<SpokenWord>| {
            let is_plural = head_word(words).is_some_and(|head| is_plural(&head.word));
            (name_key(words), is_plural)
        };
        let (mut heads, mut parts) = (HashSet::new(), HashSet::new());
        for (of_head, others) in words.iter().map(|name| part_keys(name)) {
            heads.extend(of_head);
            parts.extend(others);
        }
        Self {
            names: words.iter().map(entry).collect(),
            heads,
            parts,
            words,
        }
    }

    /// Words of all names.
    pub(crate) fn words(&self) -> impl Iterator<Item = &[SpokenWord]> {
        self.words.iter().map(Vec::as_slice)
    }

    /// Number of words of the longest known name at the start of the words.
    ///
    /// A name does not end inside of a group that hyphens join and that begins within the name:
    /// "green tea-box" does not begin with the name "green tea".
    pub(crate) fn longest_at_start(&self, words: &[SpokenWord]) -> Option<usize> {
        let most = words.len().min(NAME_WORDS_MAX);
        let ends_in_group = |n: usize| {
            let is_joined = |position: usize| words.get(position).is_some_and(|w| w.is_joined);
            is_joined(n) && (1..n).any(|start| !is_joined(start) && (start + 1..=n).all(is_joined))
        };
        (1..=most)
            .rev()
            .find(|n| self.has(&words[..*n]) && !ends_in_group(*n))
    }

    pub(crate) fn has(&self, words: &[SpokenWord]) -> bool {
        self.names.contains_key(&name_key(words))
    }

    /// True if the words are the last ones of a known compound.
    pub(crate) fn has_head(&self, words: &[SpokenWord]) -> bool {
        self.heads.contains(&name_key(words))
    }

    /// True if the words are a known name or a part of one.
    pub(crate) fn has_part(&self, words: &[SpokenWord]) -> bool {
        let key = name_key(words);
        self.names.contains_key(&key) || self.heads.contains(&key) || self.parts.contains(&key)
    }

    /// True if the words mean several objects: a plural that is not itself the name.
    pub(crate) fn is_plural(&self, words: &[SpokenWord]) -> bool {
        let is_name_plural = self.names.get(&name_key(words)).copied();
        let head = head_word(words);
        head.is_some_and(|head| is_plural(&head.word)) && is_name_plural != Some(true)
    }
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
            ("shoes", "shoe"),
        ] {
            assert_eq!(singular(plural), one);
        }
        assert!(is_plural("mugs") && !is_plural("mug") && !is_plural("scissors"));
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
