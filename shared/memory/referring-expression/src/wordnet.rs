//! WordNet: synonyms and hypernyms of nouns, read from the files of Debian's `wordnet-base`.
//!
//! Fellbaum (1998); the format is that of wndb(5WN). A word is found by binary search in the sorted
//! index, which is held in memory (5 MB), and its synsets by their offset in the data file. What
//! was read of that is kept in caches of bounded size. A damaged line counts as no match.

mod synset;
mod text_files;

use std::collections::HashMap;
use std::hash::Hash;
use std::path::Path;
use std::sync::Arc;

use parking_lot::Mutex;

use crate::error::Error;
use crate::lexicon::{Kinship, Lexicon};
use crate::names::singular;
use synset::{Synset, sense_offsets};
use text_files::{LineFile, SortedLines};

/// Reader of WordNet's nouns.
#[derive(Debug)]
pub struct WordNet {
    index: SortedLines,
    data: LineFile,
    /// Irregular plurals.
    exceptions: SortedLines,
    /// Kin of a word, by the word.
    kin: Mutex<HashMap<String, Arc<Kin>>>,
    /// Synsets by their offset; those above the words are common to many of them.
    synsets: Mutex<HashMap<u64, Synset>>,
}

/// Synsets of a word and above, each with its least number of steps from the word.
#[derive(Debug, Default)]
struct Kin {
    levels: HashMap<u64, u8>,
    /// True if they are those of the head noun only, since the compound has no entry.
    is_of_head: bool,
}

/// Most words whose kin is kept; the cache is emptied when it is full. Half a kilobyte each.
const CACHED_WORDS_MAX: usize = 1 << 14;

/// Most synsets that are kept; the cache is emptied when it is full. 0.1 kB each.
const CACHED_SYNSETS_MAX: usize = 1 << 14;

/// Senses of a word that are used, most frequent first.
const SENSES_MAX: usize = 4;

/// Senses of a word among which those of physical objects are looked for.
const SENSES_READ_MAX: usize = 12;

/// Most steps from a word up to a more general one.
const LEVELS_MAX: u8 = 4;

/// Most steps up to a name from a more special word.
const NARROWER_LEVELS_MAX: u8 = 2;

/// Most synsets above a word; a guard against damaged files.
const KIN_MAX: usize = 256;

impl WordNet {
    /// Opens `index.noun`, `data.noun` and `noun.exc` of a folder such as `/usr/share/wordnet`.
    ///
    /// # Errors
    ///
    /// If a file cannot be read, or is not a file of WordNet.
    pub fn open(folder: &Path) -> Result<Self, Error> {
        let wordnet = Self {
            index: SortedLines::read(&folder.join("index.noun"))?,
            data: LineFile::open(&folder.join("data.noun"))?,
            exceptions: SortedLines::read(&folder.join("noun.exc"))?,
            kin: Mutex::default(),
            synsets: Mutex::default(),
        };
        // The licence at the top is indented by two spaces.
        let data_line = wordnet.data.line_at(0).unwrap_or_default();
        let first_lines = [
            (wordnet.index.first_line(), "index.noun"),
            (data_line.as_bytes(), "data.noun"),
        ];
        for (line, name) in first_lines {
            if !line.starts_with(b"  ") {
                return Err(Error::ForeignFile {
                    path: folder.join(name),
                });
            }
        }
        Ok(wordnet)
    }

    /// Offsets of all senses of a phrase, which may be a compound.
    fn senses(&self, words: &str) -> Vec<u64> {
        let parts: Vec<&str> = words.split(['-', '_', ' ']).collect();
        let spellings = [parts.join("_"), parts.join("-"), parts.concat()];
        let n_spellings = if parts.len() < 2 { 1 } else { spellings.len() };
        let mut senses = spellings[..n_spellings]
            .iter()
            .map(|lemma| self.senses_of_lemma(lemma));
        senses.find(|found| !found.is_empty()).unwrap_or_default()
    }

    /// Offsets of all senses of the head noun of a compound.
    fn senses_of_head(&self, words: &str) -> Vec<u64> {
        let head = words.rsplit(['-', '_', ' ']).next();
        head.map_or(Vec::new(), |head| self.senses_of_lemma(head))
    }

    /// Offsets of the senses of a lemma, in the singular or, failing that, in the plural.
    fn senses_of_lemma(&self, lemma: &str) -> Vec<u64> {
        let lemma = lemma.to_lowercase();
        let exception = self.exceptions.find(&lemma);
        let irregular = exception.and_then(|line| line.split(' ').nth(1));
        let forms = [
            Some(lemma.clone()),
            irregular.map(str::to_owned),
            Some(singular(&lemma)),
        ];
        for form in forms.into_iter().flatten() {
            let line = self.index.find(&form);
            let offsets = line.map(sense_offsets).unwrap_or_default();
            if !offsets.is_empty() {
                return offsets;
            }
        }
        Vec::new()
    }

    /// Synset at an offset, from the cache or the file.
    fn synset(&self, offset: u64) -> Option<Synset> {
        if let Some(synset) = self.synsets.lock().get(&offset) {
            return Some(synset.clone());
        }
        let synset = Synset::parse(&self.data.line_at(offset)?, offset)?;
        keep(&self.synsets, CACHED_SYNSETS_MAX, offset, synset.clone());
        Some(synset)
    }

    /// Kin of a word, from the cache or the files.
    fn kin(&self, words: &str) -> Arc<Kin> {
        if let Some(kin) = self.kin.lock().get(words) {
            return Arc::clone(kin);
        }
        let kin = Arc::new(self.read_kin(words));
        let (words, kept) = (words.to_owned(), Arc::clone(&kin));
        keep(&self.kin, CACHED_WORDS_MAX, words, kept);
        kin
    }

    /// Breadth-first search from the senses of a word up to its hypernyms.
    fn read_kin(&self, words: &str) -> Kin {
        let mut offsets = self.senses(words);
        let is_of_head = offsets.is_empty();
        if is_of_head {
            offsets = self.senses_of_head(words);
        }
        let read = offsets.iter().take(SENSES_READ_MAX);
        let senses: Vec<(u64, Synset)> = read
            .filter_map(|offset| Some((*offset, self.synset(*offset)?)))
            .collect();
        let has_physical = senses.iter().any(|(_, synset)| synset.is_physical());
        let mut frontier: Vec<(u64, Synset)> = senses
            .into_iter()
            .filter(|(_, synset)| synset.is_physical() || !has_physical)
            .take(SENSES_MAX)
            .collect();
        let mut kin = Kin {
            is_of_head,
            ..Kin::default()
        };
        for level in 0..=LEVELS_MAX {
            frontier.retain(|(offset, _)| {
                let is_new = kin.levels.len() < KIN_MAX && !kin.levels.contains_key(offset);
                if is_new {
                    kin.levels.insert(*offset, level);
                }
                is_new
            });
            if level == LEVELS_MAX {
                break;
            }
            let above = frontier.iter().flat_map(|(_, synset)| &synset.hypernyms);
            frontier = above
                .filter_map(|offset| Some((*offset, self.synset(*offset)?)))
                .collect();
        }
        kin
    }
}

/// Inserts an entry into a cache, which is emptied first if it is full.
fn keep<K: Eq + Hash, V>(cache: &Mutex<HashMap<K, V>>, n_max: usize, key: K, value: V) {
    let mut cache = cache.lock();
    if cache.len() >= n_max {
        cache.clear();
    }
    cache.insert(key, value);
}

impl Kin {
    fn at(&self, level: u8) -> impl Iterator<Item = u64> {
        let levels = self.levels.iter();
        levels.filter_map(move |(offset, at)| (*at == level).then_some(*offset))
    }

    /// Least steps from this word up to a sense of another.
    fn steps_up_to(&self, other: &Self) -> Option<u8> {
        let steps = |offset| self.levels.get(&offset).copied();
        other.at(0).filter_map(steps).min()
    }
}

impl Lexicon for WordNet {
    fn kinship(&self, words: &str, name: &str) -> Option<Kinship> {
        let (spoken, named) = (self.kin(words), self.kin(name));
        if spoken.is_of_head {
            return None;
        }
        match named.steps_up_to(&spoken) {
            Some(0) => return Some(Kinship::Synonym),
            Some(n_levels) => return Some(Kinship::Broader { n_levels }),
            None => {}
        }
        if let Some(n_levels) = spoken.steps_up_to(&named)
            && n_levels <= NARROWER_LEVELS_MAX
        {
            return Some(Kinship::Narrower { n_levels });
        }
        let is_sister = spoken
            .at(1)
            .any(|offset| named.levels.get(&offset) == Some(&1));
        is_sister.then_some(Kinship::Sister)
    }

    fn is_noun(&self, words: &str) -> bool {
        let kin = self.kin(words);
        !kin.is_of_head && !kin.levels.is_empty()
    }
}

#[cfg(test)]
mod tests;
