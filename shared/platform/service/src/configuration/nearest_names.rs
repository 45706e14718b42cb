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
    let mut scored: Vec<_> = names
        .map(|other| (difference(&text, other), other))
        .collect();
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

/// Spelling suggestion: the name that a misspelt one probably means, in whatever case. It contains
/// it, is contained in it, or differs in a third of its letters at most; `None` when no name does.
pub fn probable_name<'a>(name: &str, names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let text: String = name.chars().take(MAX_CHARS).collect();
    let text = text.to_lowercase();
    let scored = names.map(|other| (difference(&text, &other.to_lowercase()), other));
    let (difference, near) = scored.min()?;
    (3 * difference <= near.chars().count()).then_some(near)
}

/// Edit distance of two names; 0 where one contains the other.
fn difference(text: &str, other: &str) -> usize {
    let is_part = !text.is_empty() && (other.contains(text) || text.contains(other));
    if is_part { 0 } else { levenshtein(text, other) }
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
    #[test]
    fn probable_name_is_no_other_word() {
        let names = ["simulation", "kinect", "soda can"];
        for (name, expected) in [
            ("kinct", Some("kinect")),
            ("KINECT", Some("kinect")),
            ("simulator", Some("simulation")),
            ("can", Some("soda can")),
            ("realsense", None),
            ("", None),
        ] {
            let probable = probable_name(name, names.into_iter());
            assert_eq!(probable, expected, "{name}");
        }
        assert_eq!(probable_name("x", std::iter::empty()), None);
    }
}
