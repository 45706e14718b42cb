//! Lexicon: kinship of words by meaning, and everyday synonyms that need no lexicon.

/// Source of kinship between words.
pub trait Lexicon {
    /// Kinship of spoken words ("tin can", in lower case) to the name of a category; `None` for a
    /// spoken compound without an entry of its own.
    fn kinship(&self, words: &str, name: &str) -> Option<Kinship>;

    /// True if the words are a noun of the language, or a compound with an entry of its own.
    fn is_noun(&self, words: &str) -> bool;
}

/// Kinship of a word to a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kinship {
    /// The same meaning.
    Synonym,
    /// The word is more general: "fruit" for apple.
    Broader {
        /// Steps from the name up to the word, from 1.
        n_levels: u8,
    },
    /// The word is more special: "stein" for mug.
    Narrower {
        /// Steps from the word up to the name, from 1.
        n_levels: u8,
    },
    /// Both are of one kind: "plum" for apple.
    Sister,
}

/// Words that people use for one another at the table, although a dictionary separates them.
const EVERYDAY_SYNONYMS: [&[&str]; 12] = [
    &["cup", "mug", "coffee mug", "coffee cup", "teacup"],
    &["can", "tin", "tin can", "food can", "soda can"],
    &["cell phone", "cellphone", "mobile phone", "mobile", "phone"],
    &["torch", "flashlight"],
    &["sponge", "scrubber"],
    &["box", "carton", "package"],
    &["kleenex", "tissue", "tissues"],
    &["marker", "felt pen"],
    &["bottle", "flask"],
    &["cap", "hat"],
    &["bag", "sack"],
    &["bowl", "dish"],
];

/// True if a word in the singular belongs to an everyday synonym.
pub(crate) fn is_everyday_word(word: &str) -> bool {
    let phrases = EVERYDAY_SYNONYMS.iter().flat_map(|group| group.iter());
    phrases
        .flat_map(|phrase| phrase.split(' '))
        .any(|part| part == word)
}

/// True if two phrases in the singular are everyday synonyms.
pub(crate) fn are_everyday_synonyms(one: &str, other: &str) -> bool {
    let holds_both = |group: &&&[&str]| group.contains(&one) && group.contains(&other);
    one != other && EVERYDAY_SYNONYMS.iter().any(|group| holds_both(&group))
}
