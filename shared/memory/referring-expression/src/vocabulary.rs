//! Vocabulary: tables of phrases, in lower case and British spelling, with their meaning.
//!
//! The longest phrase of a table that begins at a word counts.

mod extremes;
mod requests;
mod sizes;
mod times;
mod words;

pub(crate) use extremes::{EXTREME_DEGREES, EXTREME_ENDS, EXTREME_OPENINGS, EXTREME_SIDES};
pub(crate) use requests::{ACKNOWLEDGEMENTS, JOINTS, WRAPPERS};
pub(crate) use sizes::{ADJECTIVES, BOUNDS, LENGTH_UNITS, MEASURED_DIMENSIONS};
pub(crate) use times::{COUNTED_TIMES, TEACHING_VERBS, TIME_UNITS, TIMES, WITHIN};
pub(crate) use words::{is_ordinary, is_word, words};

use crate::expression::{Quantity, RankingKey};
use crate::relation::{Relation, TablePlace};
use crate::size::{Degree, Dimension};
use crate::tokens::SpokenWord;

/// Number of words of a phrase at the start of the words, if it stands there.
fn match_length(phrase: &str, words: &[SpokenWord]) -> Option<usize> {
    let mut n_words = 0;
    for part in phrase.split(' ') {
        if words.get(n_words)?.word != part {
            return None;
        }
        n_words += 1;
    }
    Some(n_words)
}

/// Longest phrase of a table at the start of the words, with its number of words.
pub(crate) fn longest<'t, T>(
    table: &'t [(&'t str, T)],
    words: &[SpokenWord],
) -> Option<(&'t T, usize)> {
    table
        .iter()
        .filter_map(|(phrase, meaning)| Some((meaning, match_length(phrase, words)?)))
        .max_by_key(|(_, n_words)| *n_words)
}

/// Determiners.
pub(crate) const DETERMINERS: [(&str, Quantity); 25] = [
    ("the", Quantity::The),
    ("that", Quantity::The),
    ("this", Quantity::The),
    ("these", Quantity::All(None)),
    ("those", Quantity::All(None)),
    ("my", Quantity::The),
    ("our", Quantity::The),
    ("your", Quantity::The),
    ("a", Quantity::Any),
    ("an", Quantity::Any),
    ("any", Quantity::Any),
    ("some", Quantity::Any),
    ("one of the", Quantity::Any),
    ("one of", Quantity::Any),
    ("any of the", Quantity::Any),
    ("all", Quantity::All(None)),
    ("all the", Quantity::All(None)),
    ("all of the", Quantity::All(None)),
    ("every", Quantity::All(None)),
    ("each", Quantity::All(None)),
    ("both", Quantity::All(Some(2))),
    ("both the", Quantity::All(Some(2))),
    ("his", Quantity::The),
    ("her", Quantity::The),
    ("their", Quantity::The),
];

/// Possessives, of which the robot knows nothing.
pub(crate) const POSSESSIVES: [&str; 6] = ["my", "our", "your", "his", "her", "their"];

/// Cardinal numbers.
pub(crate) const NUMERALS: [(&str, usize); 15] = [
    ("one", 1),
    ("two", 2),
    ("three", 3),
    ("four", 4),
    ("five", 5),
    ("six", 6),
    ("seven", 7),
    ("eight", 8),
    ("nine", 9),
    ("ten", 10),
    ("a couple of", 2),
    ("a pair of", 2),
    ("couple of", 2),
    ("pair of", 2),
    ("a dozen", 12),
];

/// Ordinal numbers.
pub(crate) const ORDINALS: [(&str, usize); 20] = [
    ("first", 1),
    ("second", 2),
    ("third", 3),
    ("fourth", 4),
    ("fifth", 5),
    ("sixth", 6),
    ("seventh", 7),
    ("eighth", 8),
    ("ninth", 9),
    ("tenth", 10),
    ("1st", 1),
    ("2nd", 2),
    ("3rd", 3),
    ("4th", 4),
    ("5th", 5),
    ("6th", 6),
    ("7th", 7),
    ("8th", 8),
    ("9th", 9),
    ("10th", 10),
];

/// Nouns that every object matches, with true for a plural.
pub(crate) const GENERIC_NOUNS: [(&str, bool); 16] = [
    ("thing", false),
    ("object", false),
    ("item", false),
    ("one", false),
    ("something", false),
    ("anything", false),
    ("piece", false),
    ("stuff", true),
    ("everything", true),
    ("things", true),
    ("objects", true),
    ("items", true),
    ("ones", true),
    ("pieces", true),
    ("everything else", true),
    ("anything else", false),
];

/// Modifiers of colours that are accepted and not used.
pub(crate) const COLOR_MODIFIERS: [&str; 10] = [
    "light", "dark", "bright", "pale", "deep", "vivid", "pastel", "very", "mostly", "really",
];

/// Phrases for many colours.
pub(crate) const MANY_COLORS: [(&str, ()); 7] = [
    ("multicoloured", ()),
    ("multi coloured", ()),
    ("many coloured", ()),
    ("colourful", ()),
    ("rainbow coloured", ()),
    ("rainbow", ()),
    ("motley", ()),
];

/// Words around a colour that add nothing.
pub(crate) const COLOR_SUFFIXES: [(&str, ()); 3] =
    [("coloured", ()), ("in colour", ()), ("colour", ())];

/// Negations of the modifier that follows.
pub(crate) const NEGATIONS: [(&str, ()); 18] = [
    ("not", ()),
    ("non", ()),
    ("isn't", ()),
    ("aren't", ()),
    ("but not", ()),
    ("that is not", ()),
    ("that isn't", ()),
    ("that are not", ()),
    ("that aren't", ()),
    ("which is not", ()),
    ("which isn't", ()),
    ("neither", ()),
    ("are not", ()),
    ("is not", ()),
    ("which are not", ()),
    ("which aren't", ()),
    ("were not", ()),
    ("wasn't", ()),
];

/// Determiners of a noun after a negation.
pub(crate) const INDEFINITES: [(&str, ()); 5] = [
    ("a", ()),
    ("an", ()),
    ("any", ()),
    ("one of the", ()),
    ("any of the", ()),
];

/// Exceptions, before a noun phrase.
pub(crate) const EXCEPTIONS: [(&str, ()); 9] = [
    ("except", ()),
    ("except for", ()),
    ("other than", ()),
    ("apart from", ()),
    ("excluding", ()),
    ("but the", ()),
    ("but not the", ()),
    ("not the", ()),
    ("without the", ()),
];

/// Knowledge about the label, with false for "unknown".
pub(crate) const LABELS: [(&str, bool); 24] = [
    ("labelled", true),
    ("named", true),
    ("known", true),
    ("with a label", true),
    ("with label", true),
    ("with labels", true),
    ("with a name", true),
    ("unlabelled", false),
    ("unnamed", false),
    ("nameless", false),
    ("unknown", false),
    ("unfamiliar", false),
    ("without label", false),
    ("without labels", false),
    ("without a label", false),
    ("without name", false),
    ("without a name", false),
    ("with no label", false),
    ("with no name", false),
    ("non labelled", false),
    ("you do not know", false),
    ("you don't know", false),
    ("you know", true),
    ("you already know", true),
];

/// Visibility, with false for "out of view".
pub(crate) const VISIBILITY: [(&str, bool); 12] = [
    ("in view", true),
    ("visible", true),
    ("in sight", true),
    ("you see", true),
    ("you can see", true),
    ("you see now", true),
    ("out of view", false),
    ("out of sight", false),
    ("not in view", false),
    ("hidden", false),
    ("invisible", false),
    ("you cannot see", false),
];

/// Presence on the table: all of them mean an object that is gone.
pub(crate) const PRESENCES: [(&str, ()); 20] = [
    ("gone", ()),
    ("missing", ()),
    ("lost", ()),
    ("removed", ()),
    ("taken away", ()),
    ("disappeared", ()),
    ("vanished", ()),
    ("no longer here", ()),
    ("no longer there", ()),
    ("no longer present", ()),
    ("no longer on the table", ()),
    ("not on the table any more", ()),
    ("not on the table anymore", ()),
    ("not here any more", ()),
    ("not there any more", ()),
    ("not here anymore", ()),
    ("not there anymore", ()),
    ("used to be here", ()),
    ("used to be there", ()),
    ("was here before", ()),
];

/// Openings of a relation to two landmarks.
pub(crate) const BETWEEN: [(&str, ()); 8] = [
    ("between", ()),
    ("in between", ()),
    ("inbetween", ()),
    ("halfway between", ()),
    ("midway between", ()),
    ("in the middle between", ()),
    ("somewhere between", ()),
    ("right between", ()),
];

/// Relations to a landmark.
pub(crate) const RELATIONS: [(&str, Relation); 52] = [
    ("left of", Relation::LeftOf),
    ("to the left of", Relation::LeftOf),
    ("on the left of", Relation::LeftOf),
    ("on the left side of", Relation::LeftOf),
    ("on the left hand side of", Relation::LeftOf),
    ("at the left of", Relation::LeftOf),
    ("right of", Relation::RightOf),
    ("to the right of", Relation::RightOf),
    ("on the right of", Relation::RightOf),
    ("on the right side of", Relation::RightOf),
    ("on the right hand side of", Relation::RightOf),
    ("at the right of", Relation::RightOf),
    ("behind", Relation::Behind),
    ("in back of", Relation::Behind),
    ("at the back of", Relation::Behind),
    ("in front of", Relation::InFrontOf),
    ("infront of", Relation::InFrontOf),
    ("before", Relation::InFrontOf),
    ("at the front of", Relation::InFrontOf),
    ("next to", Relation::NextTo),
    ("nextto", Relation::NextTo),
    ("right next to", Relation::NextTo),
    ("beside", Relation::NextTo),
    ("near", Relation::NextTo),
    ("near to", Relation::NextTo),
    ("by", Relation::NextTo),
    ("close to", Relation::NextTo),
    ("close by", Relation::NextTo),
    ("adjacent to", Relation::NextTo),
    ("touching", Relation::NextTo),
    ("at the side of", Relation::NextTo),
    ("around", Relation::NextTo),
    ("far from", Relation::FarFrom),
    ("far away from", Relation::FarFrom),
    ("away from", Relation::FarFrom),
    ("on", Relation::On),
    ("on top of", Relation::On),
    ("ontop of", Relation::On),
    ("atop", Relation::On),
    ("upon", Relation::On),
    ("onto", Relation::On),
    ("under", Relation::Under),
    ("underneath", Relation::Under),
    ("below", Relation::Under),
    ("beneath", Relation::Under),
    ("above", Relation::Above),
    ("over", Relation::Above),
    ("in", Relation::In),
    ("inside", Relation::In),
    ("inside of", Relation::In),
    ("within", Relation::In),
    ("into", Relation::In),
];

/// Modifiers of a relation that are accepted and not used.
pub(crate) const RELATION_MODIFIERS: [(&str, ()); 19] = [
    ("directly", ()),
    ("right", ()),
    ("just", ()),
    ("immediately", ()),
    ("exactly", ()),
    ("straight", ()),
    ("precisely", ()),
    ("slightly", ()),
    ("somewhat", ()),
    ("a bit", ()),
    ("a little", ()),
    ("a little bit", ()),
    ("somewhere", ()),
    ("roughly", ()),
    ("well", ()),
    ("further", ()),
    ("farther", ()),
    ("partly", ()),
    ("really", ()),
];

/// Support on which everything stands, unless it is a name that was taught.
pub(crate) const SUPPORTS: [(&str, ()); 10] = [
    ("the table", ()),
    ("the tabletop", ()),
    ("the table top", ()),
    ("the desk", ()),
    ("the scene", ()),
    ("the image", ()),
    ("the view", ()),
    ("the picture", ()),
    ("table", ()),
    ("this table", ()),
];

/// Absolute places.
pub(crate) const PLACES: [(&str, TablePlace); 40] = [
    ("on the left", TablePlace::Left),
    ("at the left", TablePlace::Left),
    ("to the left", TablePlace::Left),
    ("on the left side", TablePlace::Left),
    ("on the left hand side", TablePlace::Left),
    ("on the far left", TablePlace::Left),
    ("left", TablePlace::Left),
    ("left hand", TablePlace::Left),
    ("on the right", TablePlace::Right),
    ("at the right", TablePlace::Right),
    ("to the right", TablePlace::Right),
    ("on the right side", TablePlace::Right),
    ("on the right hand side", TablePlace::Right),
    ("on the far right", TablePlace::Right),
    ("right", TablePlace::Right),
    ("right hand", TablePlace::Right),
    ("in the middle", TablePlace::Middle),
    ("in the centre", TablePlace::Middle),
    ("at the centre", TablePlace::Middle),
    ("middle", TablePlace::Middle),
    ("central", TablePlace::Middle),
    ("centre", TablePlace::Middle),
    ("at the back", TablePlace::Back),
    ("in the back", TablePlace::Back),
    ("at the far end", TablePlace::Back),
    ("in the background", TablePlace::Back),
    ("back", TablePlace::Back),
    ("rear", TablePlace::Back),
    ("at the rear", TablePlace::Back),
    ("at the front", TablePlace::Front),
    ("in the front", TablePlace::Front),
    ("in front", TablePlace::Front),
    ("in the foreground", TablePlace::Front),
    ("front", TablePlace::Front),
    ("in the middle of", TablePlace::Middle),
    ("in the centre of", TablePlace::Middle),
    ("on the table", TablePlace::Anywhere),
    ("on this table", TablePlace::Anywhere),
    ("from the table", TablePlace::Anywhere),
    ("on the desk", TablePlace::Anywhere),
];

/// Rankings by place and time.
pub(crate) const RANKINGS: [(&str, RankingKey); 44] = [
    ("leftmost", RankingKey::Leftmost),
    ("left most", RankingKey::Leftmost),
    ("furthest left", RankingKey::Leftmost),
    ("farthest left", RankingKey::Leftmost),
    ("furthest to the left", RankingKey::Leftmost),
    ("rightmost", RankingKey::Rightmost),
    ("right most", RankingKey::Rightmost),
    ("furthest right", RankingKey::Rightmost),
    ("farthest right", RankingKey::Rightmost),
    ("furthest to the right", RankingKey::Rightmost),
    ("nearest", RankingKey::Nearest),
    ("closest", RankingKey::Nearest),
    ("nearest to me", RankingKey::Nearest),
    ("closest to me", RankingKey::Nearest),
    ("nearest to you", RankingKey::Nearest),
    ("closest to you", RankingKey::Nearest),
    ("nearer", RankingKey::Nearest),
    ("closer", RankingKey::Nearest),
    ("front most", RankingKey::Frontmost),
    ("frontmost", RankingKey::Frontmost),
    ("farthest", RankingKey::Farthest),
    ("furthest", RankingKey::Farthest),
    ("farthest away", RankingKey::Farthest),
    ("furthest away", RankingKey::Farthest),
    ("most distant", RankingKey::Farthest),
    ("rearmost", RankingKey::Rearmost),
    ("backmost", RankingKey::Rearmost),
    ("back most", RankingKey::Rearmost),
    ("topmost", RankingKey::Topmost),
    ("uppermost", RankingKey::Topmost),
    ("lowest", RankingKey::Lowest),
    ("newest", RankingKey::Newest),
    ("last", RankingKey::Newest),
    ("latest", RankingKey::Newest),
    ("most recent", RankingKey::Newest),
    ("new", RankingKey::Newest),
    ("appeared last", RankingKey::Newest),
    ("came last", RankingKey::Newest),
    ("oldest", RankingKey::Oldest),
    ("appeared first", RankingKey::Oldest),
    ("last seen", RankingKey::LastSeen),
    ("seen last", RankingKey::LastSeen),
    ("you saw last", RankingKey::LastSeen),
    ("you last saw", RankingKey::LastSeen),
];

/// Sides from which an ordinal counts.
pub(crate) const COUNTING_SIDES: [(&str, RankingKey); 9] = [
    ("from the left", RankingKey::Leftmost),
    ("from left", RankingKey::Leftmost),
    ("from the right", RankingKey::Rightmost),
    ("from right", RankingKey::Rightmost),
    ("from the front", RankingKey::Frontmost),
    ("from the back", RankingKey::Rearmost),
    ("from the top", RankingKey::Topmost),
    ("from the bottom", RankingKey::Lowest),
    ("by size", RankingKey::Size(Dimension::Volume, Degree::More)),
];
