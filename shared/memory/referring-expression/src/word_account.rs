//! Account of the words of a query: the meaning of each, or that it was not understood.

use crate::answer::WordUse;
use crate::grounding::Notes;
use crate::parser::Parse;
use crate::spelling::Spelling;

/// Use of all words. Each word is either understood or not.
#[derive(Debug, Default)]
pub(crate) struct UseOfWords {
    pub(crate) understood: Vec<WordUse>,
    pub(crate) not_understood: Vec<String>,
    pub(crate) positions_not_understood: Vec<usize>,
}

/// Account of all words: their meanings, with the reading of those that were misspelt.
pub(crate) fn account(spelling: &Spelling, parse: &Parse, notes: &Notes) -> UseOfWords {
    let words = &spelling.words;
    let is_ignored = |position| notes.ignored.iter().any(|span| span.contains(position));
    let mut meanings: Vec<Option<(usize, &str)>> = vec![None; words.len()];
    for (number, (span, meaning)) in parse.uses.iter().chain(&notes.nouns).enumerate() {
        let covered = meanings.get_mut(span.start..span.end).unwrap_or_default();
        for word in covered {
            word.get_or_insert((number, meaning));
        }
    }
    let mut account = UseOfWords::default();
    let mut previous = None;
    for (position, word) in words.iter().enumerate() {
        let meaning = meanings[position].filter(|_| !is_ignored(position));
        match (meaning, account.understood.last_mut()) {
            (None, _) => {
                account.not_understood.push(word.text.clone());
                account.positions_not_understood.push(position);
            }
            (Some((number, _)), Some(last)) if previous == Some(number) => {
                last.words.push(' ');
                last.words.push_str(&word.text);
            }
            (Some((_, meaning)), _) => account.understood.push(WordUse {
                words: word.text.clone(),
                meaning: meaning.to_owned(),
            }),
        }
        if meaning.is_some()
            && spelling.corrected.contains(&position)
            && let Some(used) = account.understood.last_mut()
        {
            let reading = format!("; `{}` read as `{}`", word.text, word.word);
            used.meaning.push_str(&reading);
        }
        previous = meaning.map(|(number, _)| number);
    }
    account
}
