//! Parts of an extreme of place: "(on the) far left (side)", "furthest (to the) back".

use crate::expression::RankingKey;

/// Openings before a degree or a side.
pub(crate) const EXTREME_OPENINGS: [(&str, ()); 9] = [
    ("on the", ()),
    ("at the", ()),
    ("to the", ()),
    ("in the", ()),
    ("on", ()),
    ("at", ()),
    ("to", ()),
    ("towards the", ()),
    ("in", ()),
];

/// Degrees that make a side an extreme.
pub(crate) const EXTREME_DEGREES: [(&str, ()); 13] = [
    ("far", ()),
    ("very", ()),
    ("extreme", ()),
    ("furthest", ()),
    ("farthest", ()),
    ("further most", ()),
    ("furthermost", ()),
    ("outermost", ()),
    ("all the way", ()),
    ("most", ()),
    ("most far", ()),
    ("closest", ()),
    ("nearest", ()),
];

/// Sides of the table.
pub(crate) const EXTREME_SIDES: [(&str, RankingKey); 11] = [
    ("left", RankingKey::Leftmost),
    ("left hand", RankingKey::Leftmost),
    ("right", RankingKey::Rightmost),
    ("right hand", RankingKey::Rightmost),
    ("back", RankingKey::Rearmost),
    ("rear", RankingKey::Rearmost),
    ("background", RankingKey::Rearmost),
    ("backward", RankingKey::Rearmost),
    ("front", RankingKey::Frontmost),
    ("foreground", RankingKey::Frontmost),
    ("forward", RankingKey::Frontmost),
];

/// Ends of a phrase that add nothing.
pub(crate) const EXTREME_ENDS: [(&str, ()); 3] = [("side", ()), ("end", ()), ("edge", ())];
