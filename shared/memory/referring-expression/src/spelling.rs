//! Spelling correction: words that are not known, read as the nearest one by edit distance.

use std::collections::BTreeSet;

use strsim::damerau_levenshtein;

use crate::lexicon::{Lexicon, is_everyday_word};
use crate::names::{NameIndex, name_key, plural, singular};
use crate::tokens::SpokenWord;
use crate::vocabulary::{self, GENERIC_NOUNS, TEACHING_VERBS};

/// Number of letters from which on two errors are allowed. Chosen.
const LONG_WORD_LETTERS: usize = 6;

/// Least number of letters with which any error is allowed. In shorter words letters may be
/// swapped; with a lexicon, which knows short words, letters after the first may be wrong. Chosen.
const SHORT_WORD_LETTERS: usize = 4;

/// Most words of a query that are looked up, so that its time is bounded.
const LOOKUPS_MAX: usize = 16;

/// Pronouns before the verb of a clause.
const SUBJECTS: [&str; 9] = [
    "i", "you", "we", "they", "he", "she", "who", "somebody", "someone",
];

/// Verbs before the subject of a request: "can you find".
const MODALS: [&str; 8] = [
    "can", "could", "would", "will", "do", "did", "have", "should",
];

/// Words of a query as they are read.
#[derive(Debug)]
pub(crate) struct Spelling {
    /// Words, the misspelt ones in their right form; their text is as it was written.
    pub(crate) words: Vec<SpokenWord>,
    /// Positions of the words that were corrected.
    pub(crate) corrected: Vec<usize>,
    /// Sentences about words that were corrected, or could not be, with their position.
    pub(crate) remarks: Vec<(usize, String)>,
}

/// Words that a query may contain.
struct Dictionary<'a> {
    names: &'a NameIndex,
    /// Words of names with their plurals, and the spellings of compounds as one word.
    name_words: BTreeSet<String>,
    lexicon: Option<&'a dyn Lexicon>,
}

/// Reads misspelt words as the nearest word of a name or of the vocabulary.
///
/// The distance is that of Damerau (1964) and Levenshtein (1966): letters that are inserted,
/// missing, replaced or swapped with a neighbour. Of several words at the least distance, those
/// with the same first letter are nearer, since typists rarely miss it (Pollock and Zamora, 1984).
/// If several are equally near, the word stays as it is, and a remark names them.
pub(crate) fn corrected(
    words: &[SpokenWord],
    names: &NameIndex,
    people: &[&str],
    lexicon: Option<&dyn Lexicon>,
) -> Spelling {
    let mut spelling = Spelling {
        words: words.to_vec(),
        corrected: Vec::new(),
        remarks: Vec::new(),
    };
    let dictionary = Dictionary::new(names, lexicon);
    let is_unknown = |(position, token): &(usize, &SpokenWord)| {
        !dictionary.is_meant(token)
            && !is_person(words, *position, people)
            && !is_verb(words, *position)
    };
    let unknown = words.iter().enumerate().filter(is_unknown);
    for (position, token) in unknown.take(LOOKUPS_MAX) {
        let text = &token.text;
        let mut nearest = dictionary.missing_word(&spelling.words, position);
        let is_understood =
            dictionary.is_noun(token) && !dictionary.is_before_noun(words, position);
        if nearest.is_empty() && !is_understood {
            nearest = dictionary.nearest(&token.word);
        }
        match nearest.as_slice() {
            [] => {}
            [one] => {
                spelling.words[position].word.clone_from(one);
                spelling.corrected.push(position);
                spelling
                    .remarks
                    .push((position, format!("`{text}` was read as `{one}`")));
            }
            several => {
                let readings = several.join("` or `");
                let remark = format!("`{text}` may mean `{readings}`; say which");
                spelling.remarks.push((position, remark));
            }
        }
    }
    spelling
}

/// True if a word is a person's name: one of the authors, or a word before "taught".
fn is_person(words: &[SpokenWord], position: usize, people: &[&str]) -> bool {
    let word = &words[position].word;
    let is_known = people.iter().any(|person| person.to_lowercase() == *word);
    let after = words.get(position + 1..).unwrap_or_default();
    let next = after.first().map_or("", |next| next.word.as_str());
    let is_author = vocabulary::longest(&TEACHING_VERBS, after).is_some()
        || matches!(next, "has" | "had" | "just" | "already");
    let follows_by = position > 0 && words[position - 1].word == "by";
    is_known || is_author || follows_by
}

/// True if a word is a verb of a clause that is not understood: "bought" after "I". A verb of
/// teaching may be misspelt there.
fn is_verb(words: &[SpokenWord], position: usize) -> bool {
    let subject = position
        .checked_sub(1)
        .map_or("", |before| words[before].word.as_str());
    let before = position
        .checked_sub(2)
        .map_or("can", |before| words[before].word.as_str());
    let has_subject = SUBJECTS.contains(&subject) && !MODALS.contains(&before);
    let word = words[position].word.as_str();
    let verbs = TEACHING_VERBS.iter().flat_map(|(verb, ())| verb.split(' '));
    let mut verbs = verbs
        .chain(["know", "seen", "want"])
        .filter(|verb| verb.len() >= SHORT_WORD_LETTERS);
    has_subject && !verbs.any(|verb| errors(word, verb, false).is_some())
}

impl<'a> Dictionary<'a> {
    fn new(names: &'a NameIndex, lexicon: Option<&'a dyn Lexicon>) -> Self {
        let mut name_words = BTreeSet::new();
        for name in names.words() {
            for token in name {
                name_words.insert(token.word.clone());
            }
            let key = name_key(name);
            let last = name.last().map_or("", |last| &last.word);
            name_words.extend([plural(last), plural(&key), singular(last), key]);
        }
        Self {
            names,
            name_words,
            lexicon,
        }
    }

    /// True if a word has a meaning for a query, or none by its nature.
    fn is_meant(&self, token: &SpokenWord) -> bool {
        let word = token.word.as_str();
        let has_digit = word.chars().any(|character| character.is_ascii_digit());
        has_digit
            || vocabulary::is_word(word)
            || vocabulary::is_ordinary(word)
            || self.name_words.contains(word)
            || self.names.has_part(std::slice::from_ref(token))
            || is_everyday_word(&singular(word))
    }

    fn is_noun(&self, token: &SpokenWord) -> bool {
        let mut lexicon = self.lexicon.iter();
        lexicon.any(|lexicon| lexicon.is_noun(&token.word))
    }

    /// True if a known name or "thing" follows a word that makes no compound with it: there a noun
    /// such as "bleu" has no meaning.
    fn is_before_noun(&self, words: &[SpokenWord], position: usize) -> bool {
        let after = words.get(position + 1..).unwrap_or_default();
        let Some(next) = after.first() else {
            return false;
        };
        let compound = format!("{} {}", words[position].word, next.word);
        let is_compound = self
            .lexicon
            .is_some_and(|lexicon| lexicon.is_noun(&compound));
        let has_name = self.names.longest_at_start(after).is_some()
            || self.names.has_head(&after[..1])
            || vocabulary::longest(&GENERIC_NOUNS, after).is_some();
        has_name && !is_compound
    }

    /// True if a word has no meaning, and one error makes it another.
    fn is_misspelt(&self, token: &SpokenWord, other: &SpokenWord) -> bool {
        !self.is_meant(token) && damerau_levenshtein(&token.word, &other.word) == 1
    }

    /// Words that complete a known compound with the words around them: "orange" for "orang juice".
    fn missing_word(&self, words: &[SpokenWord], position: usize) -> Vec<String> {
        let mut found: Vec<String> = Vec::new();
        for name in self.names.words().filter(|name| name.len() > 1) {
            for (place, missing) in name.iter().enumerate() {
                let around = position
                    .checked_sub(place)
                    .and_then(|start| words.get(start..start + name.len()));
                let fits_around = around.is_some_and(|around| {
                    let mut pairs = around.iter().zip(name).enumerate();
                    pairs.all(|(i, (word, part))| {
                        let is_same = singular(&word.word) == singular(&part.word);
                        i == place || is_same || self.is_misspelt(word, part)
                    })
                });
                let is_near = damerau_levenshtein(&words[position].word, &missing.word) == 1;
                if fits_around && is_near && !found.contains(&missing.word) {
                    found.push(missing.word.clone());
                }
            }
        }
        found
    }

    /// Nearest words, of several forms of one noun the one of the same number.
    fn nearest(&self, word: &str) -> Vec<String> {
        let of_names = self.name_words.iter().map(String::as_str);
        let of_vocabulary = vocabulary::words().map(|word: &str| word);
        let mut nearest: Vec<String> = Vec::new();
        let mut least = (usize::MAX, true);
        for candidate in of_names.chain(of_vocabulary) {
            let Some(errors) = errors(word, candidate, self.lexicon.is_some()) else {
                continue;
            };
            if errors < least {
                nearest.clear();
                least = errors;
            }
            if errors == least && !nearest.iter().any(|near| near == candidate) {
                nearest.push(candidate.to_owned());
            }
        }
        one_form_of_each(nearest, word)
    }
}

/// Number of errors of a word, and true if one is in the first letter; None if there are too many.
fn errors(word: &str, candidate: &str, has_lexicon: bool) -> Option<(usize, bool)> {
    let n_letters = word.chars().count();
    let n_candidate = candidate.chars().count();
    let (shorter, longer) = (n_letters.min(n_candidate), n_letters.max(n_candidate));
    if shorter < 3 || longer - shorter > 2 {
        return None;
    }
    let is_first_wrong = word.chars().next() != candidate.chars().next();
    let is_long = longer >= LONG_WORD_LETTERS && shorter >= LONG_WORD_LETTERS - 1;
    let n_most = if is_long && !is_first_wrong { 2 } else { 1 };
    let n_errors = damerau_levenshtein(word, candidate);
    let is_allowed = n_errors <= n_most
        && (longer >= SHORT_WORD_LETTERS
            || has_lexicon && !is_first_wrong
            || has_same_letters(word, candidate));
    is_allowed.then_some((n_errors, is_first_wrong))
}

fn has_same_letters(one: &str, other: &str) -> bool {
    let sorted = |word: &str| {
        let mut letters: Vec<char> = word.chars().collect();
        letters.sort_unstable();
        letters
    };
    sorted(one) == sorted(other)
}

/// Keeps one of "mug" and "mugs": the plural of a word that ends in s, otherwise the singular.
fn one_form_of_each(words: Vec<String>, written: &str) -> Vec<String> {
    let wants_plural = written.ends_with('s');
    let mut kept: Vec<String> = Vec::new();
    for word in words {
        let same = kept
            .iter_mut()
            .find(|other| singular(other) == singular(&word));
        match same {
            None => kept.push(word),
            Some(other) if word.ends_with('s') == wants_plural => *other = word,
            Some(_) => {}
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tokens::tokenize;

    fn read(text: &str) -> (String, String) {
        let names = NameIndex::new(["wine-bottle", "bowl", "mug", "orange-juice"]);
        let spelling = corrected(&tokenize(text), &names, &["Anna"], None);
        let words = spelling.words.iter().map(|token| token.word.as_str());
        let remarks: Vec<_> = spelling
            .remarks
            .iter()
            .map(|(_, text)| text.clone())
            .collect();
        (words.collect::<Vec<_>>().join(" "), remarks.join("; "))
    }

    #[test]
    fn spelling_is_corrected_to_the_nearest_word() {
        for (written, right) in [
            ("the bottel", "the bottle"),
            ("teh bleu mgu", "the blue mug"),
            ("the ornage jiuce", "the orange juice"),
            ("the botltes", "the bottles"),
            ("the yelow bolw", "the yellow bowl"),
            ("the bowls behnid the mgus", "the bowls behind the mugs"),
        ] {
            let (words, remarks) = read(written);
            assert_eq!(words, right);
            assert!(remarks.contains("was read as"), "{remarks}");
        }
    }

    #[test]
    fn spelling_of_other_words_is_left_alone() {
        for text in [
            "the round wooden cold mug",
            "the mug that ana taught you",
            "anna xqzt 123 bug",
            "the flurble",
        ] {
            assert_eq!(read(text), (text.to_owned(), String::new()));
        }
    }

    #[test]
    fn spelling_names_words_that_are_equally_near() {
        let names = NameIndex::new(["book", "boot"]);
        let spelling = corrected(&tokenize("the boo"), &names, &[], None);
        assert_eq!(spelling.words[1].word, "boo");
        assert_eq!(
            spelling.remarks,
            [(1, "`boo` may mean `book` or `boot`; say which".to_owned())]
        );
    }

    #[test]
    fn spelling_completes_a_compound() {
        let names = NameIndex::new(["orange-juice", "green-tea", "wine-bottle"]);
        for (written, right) in [
            ("the orang juice", "orange"),
            ("the green tee", "tea"),
            ("the gren tae", "tea"),
            ("the wine battle", "bottle"),
        ] {
            let spelling = corrected(&tokenize(written), &names, &[], None);
            let mut words = spelling.words.iter();
            assert!(words.any(|token| token.word == right), "{written}");
        }
    }

    #[test]
    fn spelling_allows_two_errors_in_long_words() {
        assert_eq!(errors("handle", "hand", false), None);
        assert_eq!(errors("tenisbal", "tennisball", false), Some((2, false)));
        assert_eq!(errors("botel", "bottle", false), Some((2, false)));
        assert_eq!(errors("golden", "wooden", false), None);
        assert_eq!(errors("bug", "mug", false), None);
        assert_eq!(errors("mgu", "mug", false), Some((1, false)));
        assert_eq!(errors("rwd", "red", false), None);
        assert_eq!(errors("rwd", "red", true), Some((1, false)));
    }
}
