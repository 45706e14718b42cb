//! Nearest names of a misspelt one, by edit distance (Levenshtein, 1966).

use strsim::levenshtein;

/// Most names that are suggested.
const MAX_NAMES: usize = 3;
/// Longest name that is compared, characters.
const MAX_CHARS: usize = 128;

/// Names that are nearest to a name that is not among them: those that contain it or that it
/// contains, and otherwise those with the least edit distance; three at most.
pub fn nearest_names<'a>(name: &str, names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let text: String = name.chars().take(MAX_CHARS).collect();
    let score = |other: &str| {
        let is_part = !text.is_empty() && (other.contains(&text) || text.contains(other));
        if is_part {
            0
        } else {
            levenshtein(&text, other)
        }
    };
    let mut scored: Vec<_> = names.map(|other| (score(other), other)).collect();
    scored.sort_unstable();
    scored.dedup();
    let least = scored.first().map_or(0, |(distance, _)| *distance);
    scored
        .into_iter()
        .take_while(|(distance, _)| *distance == least)
        .take(MAX_NAMES)
        .map(|(_, other)| other)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edit_distance_counts_the_changed_characters() {
        for (a, b, expected) in [
            ("", "", 0),
            ("", "abc", 3),
            ("kitten", "sitting", 3),
            ("abc", "abc", 0),
            ("tür", "tor", 1),
        ] {
            assert_eq!(levenshtein(a, b), expected, "{a} {b}");
            assert_eq!(levenshtein(b, a), expected, "{b} {a}");
        }
    }

    #[test]
    fn nearest_names_are_parts_or_misspellings() {
        let names = ["workers", "range_min_m", "range_max_m", "rate_hz"];
        let nearest = |name| nearest_names(name, names.into_iter());
        assert_eq!(nearest("worker"), ["workers"]);
        assert_eq!(nearest("wrokers"), ["workers"]);
        assert_eq!(nearest("range"), ["range_max_m", "range_min_m"]);
        assert_eq!(nearest("raet_hz"), ["rate_hz"]);
        assert_eq!(nearest_names("x", std::iter::empty()), Vec::<&str>::new());
    }
}
