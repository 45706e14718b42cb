//! Lines of WordNet's index and data files (wndb(5WN)).

/// Set of synonyms: the part of it that kinship needs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Synset {
    /// Number of the lexicographer file: the domain of the meaning.
    lexicographer_file: u8,
    /// Offsets of the synsets directly above.
    pub(super) hypernyms: Vec<u64>,
}

/// Lexicographer files of physical objects: animal, artifact, body, food, object, plant, substance.
/// lexnames(5WN).
const PHYSICAL_FILES: [u8; 7] = [5, 6, 8, 13, 17, 20, 27];

/// Most pointers of a synset that are read.
const POINTERS_MAX: usize = 4096;

impl Synset {
    /// Synset of a line of `data.noun`. None if the line is damaged or belongs to another offset.
    pub(super) fn parse(line: &str, offset: u64) -> Option<Self> {
        let mut fields = line.split(' ');
        let has_offset = fields.next()?.parse() == Ok(offset);
        let lexicographer_file = fields.next()?.parse().ok()?;
        let is_noun = fields.next()? == "n";
        let n_words = usize::from_str_radix(fields.next()?, 16).ok()?;
        if !has_offset || !is_noun {
            return None;
        }
        // Each word is followed by its number in the lexicographer file.
        let mut fields = fields.skip(2 * n_words);
        let n_pointers: usize = fields.next()?.parse().ok()?;
        let mut hypernyms = Vec::new();
        for _ in 0..n_pointers.min(POINTERS_MAX) {
            let (symbol, target) = (fields.next()?, fields.next()?);
            let (part_of_speech, _source_and_target) = (fields.next()?, fields.next()?);
            if symbol == "@" && part_of_speech == "n" {
                hypernyms.push(target.parse().ok()?);
            }
        }
        Some(Self {
            lexicographer_file,
            hypernyms,
        })
    }

    /// True for a thing that can stand on a table, or a kind of it.
    pub(super) fn is_physical(&self) -> bool {
        PHYSICAL_FILES.contains(&self.lexicographer_file)
    }
}

/// Offsets of the synsets of a line of `index.noun`, most frequent first; none if it is damaged.
pub(super) fn sense_offsets(line: &str) -> Vec<u64> {
    let mut fields = line.split_ascii_whitespace().skip(2);
    let n_senses: usize = fields.next().and_then(|n| n.parse().ok()).unwrap_or(0);
    let n_pointers: usize = fields.next().and_then(|n| n.parse().ok()).unwrap_or(0);
    // Pointer symbols, the number of senses again, and the number of tagged senses.
    let offsets = fields.skip(n_pointers.saturating_add(2)).take(n_senses);
    offsets.map_while(|offset| offset.parse().ok()).collect()
}
