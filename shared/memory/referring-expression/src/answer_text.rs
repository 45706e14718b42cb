//! Answer in plain words.

use crate::comprehension::Selection;

/// Most tracks that a sentence names.
const TRACKS_NAMED_MAX: usize = 12;

/// Sentences that answer all phrases of a query.
pub(crate) fn sentence(
    selections: &[Selection],
    general_doubts: &[String],
    is_alternative: bool,
) -> String {
    let is_found = |selection: &&Selection| !selection.matches.is_empty();
    let is_enough = is_alternative && selections.iter().any(|s| is_found(&s));
    let sentences = selections
        .iter()
        .filter(|selection| !is_enough || is_found(selection))
        .map(|selection| selection_sentence(selection, general_doubts));
    sentences.collect::<Vec<_>>().join(" ")
}

/// "track 3", "tracks 3, 5 and 7".
pub(crate) fn tracks(track_ids: &[u64]) -> String {
    let named: Vec<String> = track_ids
        .iter()
        .take(TRACKS_NAMED_MAX)
        .map(u64::to_string)
        .collect();
    let n_more = track_ids.len() - named.len();
    let more = if n_more > 0 {
        format!(" and {n_more} more")
    } else {
        String::new()
    };
    match named.as_slice() {
        [] => "no track".to_owned(),
        [one] => format!("track {one}"),
        [first @ .., last] if n_more == 0 => format!("tracks {} and {last}", first.join(", ")),
        all => format!("tracks {}{more}", all.join(", ")),
    }
}

fn selection_sentence(selection: &Selection, general_doubts: &[String]) -> String {
    let Selection {
        text,
        matches,
        wants_one,
        ..
    } = selection;
    let ids: Vec<u64> = matches.iter().map(|found| found.track_id).collect();
    let head = match (ids.as_slice(), *wants_one) {
        ([], _) => return nothing_sentence(selection, general_doubts),
        ([one], true) => format!("`{text}` is track {one}"),
        (several, true) => {
            let listed = tracks(several).replace(" and ", " or ");
            format!("`{text}` is ambiguous: {listed}")
        }
        (all, false) => format!("`{text}`: {}", tracks(all)),
    };
    let n_others = selection.n_fitting - matches.len();
    let others = match n_others {
        0 => String::new(),
        1 => " (one other fits to some degree)".to_owned(),
        n => format!(" ({n} others fit to some degree)"),
    };
    let doubts = distinct_doubts(selection);
    let end = if doubts.is_empty() {
        ".".to_owned()
    } else {
        format!("; but {}.", doubts.join("; "))
    };
    format!("{head}{others}{end}")
}

fn nothing_sentence(selection: &Selection, general_doubts: &[String]) -> String {
    let reason = selection.reason.as_ref();
    let reason = reason.map_or(String::new(), |reason| format!("; {reason}"));
    let nothing = format!("Nothing here fits `{}`{reason}", selection.text);
    let parts = std::iter::once(nothing.as_str()).chain(general_doubts.iter().map(String::as_str));
    let sentence = format!("{}.", parts.collect::<Vec<_>>().join("; "));
    match &selection.advice {
        Some(advice) => format!("{sentence} {advice}"),
        None => sentence,
    }
}

/// Doubts of all matches, each once.
fn distinct_doubts(selection: &Selection) -> Vec<&str> {
    let mut doubts: Vec<&str> = Vec::new();
    for doubt in selection.matches.iter().flat_map(|found| &found.doubts) {
        if !doubts.contains(&doubt.as_str()) {
            doubts.push(doubt);
        }
    }
    doubts
}
