//! Reference to a track on a command line: its track-id, or words that mean exactly one object.

use crate::connection::{ask, connect};
use crate::memory_client::print_aside;
use crate::object_search::find_objects;
use control_protocol::{FindReport, FoundObjectReport, request};
use scene_document::ObjectDocument;
use service::{CommonArguments, Failure, exit_code};
use std::str::FromStr;

/// State of an object that is not on the table any more, as in
/// [`FoundObjectReport::state`](control_protocol::FoundObjectReport::state).
const GONE: &str = "gone";
/// Most objects that a sentence names.
const N_NAMED_MAX: usize = 12;
/// Words that leave open which of several objects is meant. Whoever names one means that one.
const INDEFINITE: [&str; 5] = ["a", "an", "any", "some", "one"];

/// Reference to a track. Digits alone are a track-id, even where a category has such a name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TrackReference {
    /// Track-id.
    Id(u64),
    /// Label of the object, or an English description of it.
    Words(String),
}

/// Text that refers to no track.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidTrackReference {
    /// Text without a letter.
    #[error("name an object: give its track-id, its label, or words such as \"the red mug\"")]
    Empty,
    /// Number beyond all track-ids.
    #[error("no track-id is that large; `tabula objects` shows those there are")]
    TooLarge,
}

/// Objects that words may mean for a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TrackScope {
    /// True if an object may be meant that is not on the table any more.
    pub has_gone_objects: bool,
    /// True if a doubtful match is taken, and its doubts are told; else it is refused with them.
    pub has_doubtful_matches: bool,
}

impl TrackScope {
    /// Look at an object on the table.
    pub const LOOK: Self = Self {
        has_gone_objects: false,
        has_doubtful_matches: true,
    };
    /// Change about an object on the table.
    pub const CHANGE: Self = Self {
        has_gone_objects: false,
        has_doubtful_matches: false,
    };
    /// Look at the past of an object.
    pub const RECALL: Self = Self {
        has_gone_objects: true,
        has_doubtful_matches: true,
    };
    /// Change about the stored views of an object.
    pub const FORGET: Self = Self {
        has_gone_objects: true,
        has_doubtful_matches: false,
    };
}

/// `true` for text that is a track-id on a command line: digits alone.
pub fn is_track_id(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

impl FromStr for TrackReference {
    type Err = InvalidTrackReference;

    fn from_str(text: &str) -> Result<Self, InvalidTrackReference> {
        let text = text.trim();
        if is_track_id(text) {
            let id = text.parse().map_err(|_| InvalidTrackReference::TooLarge)?;
            return Ok(Self::Id(id));
        }
        if text.is_empty() {
            return Err(InvalidTrackReference::Empty);
        }
        Ok(Self::Words(text.to_owned()))
    }
}

impl TrackReference {
    /// Track-id of the reference. Words are looked for among the labels of the live objects, then
    /// by the daemon's [`find`](request::find). `author` is whom "I" means.
    ///
    /// # Errors
    /// If words mean no object or several: with the candidates, and what to say instead. If a
    /// running daemon is needed for them and there is none.
    pub fn resolve(
        &self,
        common: &CommonArguments,
        scope: TrackScope,
        author: Option<&str>,
    ) -> Result<u64, Failure> {
        let words = match self {
            Self::Id(track_id) => return Ok(*track_id),
            Self::Words(words) => words,
        };
        let mut client = connect(common)?;
        let live = ask(&mut client, &request::objects())?.objects;
        if let Some(outcome) = labelled(words, &live) {
            return outcome.map_err(refused);
        }
        let found = find_objects(&mut client, &definite(words), author)?;
        let chosen = described(words, &found, &live, scope).map_err(refused)?;
        if !chosen.doubts.is_empty() {
            print_aside(&found.sentence);
        }
        Ok(chosen.track_id)
    }
}

fn refused(sentence: String) -> Failure {
    Failure::new(exit_code::REFUSED, sentence)
}

/// Words for one definite object: "a mug" would be any of several.
fn definite(words: &str) -> String {
    match words.split_once(char::is_whitespace) {
        Some((first, rest)) if INDEFINITE.contains(&first.to_lowercase().as_str()) => {
            format!("the {rest}")
        }
        _ => words.to_owned(),
    }
}

/// Live object with this label, in this case if there is one; `None` when no object has it.
fn labelled(words: &str, live: &[ObjectDocument]) -> Option<Result<u64, String>> {
    let with = |is_label: &dyn Fn(&str) -> bool| -> Vec<&ObjectDocument> {
        let has_label = |object: &&ObjectDocument| object.label.as_deref().is_some_and(is_label);
        live.iter().filter(has_label).collect()
    };
    let exact = with(&|label| label == words);
    let found = if exact.is_empty() {
        with(&|label| label.to_lowercase() == words.to_lowercase())
    } else {
        exact
    };
    match found.as_slice() {
        [] => None,
        [one] => Some(Ok(one.track_id)),
        several => Some(Err(ambiguous(
            words,
            several.iter().map(|o| NamedTrack::of_live(o)),
        ))),
    }
}

/// Match of a description; a sentence when there is none, several, or too doubtful a one.
fn described<'a>(
    words: &str,
    found: &'a FindReport,
    live: &[ObjectDocument],
    scope: TrackScope,
) -> Result<&'a FoundObjectReport, String> {
    let is_meant = |one: &&FoundObjectReport| scope.has_gone_objects || one.state != GONE;
    let meant: Vec<&FoundObjectReport> = found.matches.iter().filter(is_meant).collect();
    match meant.as_slice() {
        [one] if one.doubts.is_empty() || scope.has_doubtful_matches => Ok(one),
        [one] => {
            let named = NamedTrack::of_found(one).in_words();
            let (doubts, track_id) = (one.doubts.join("; "), one.track_id);
            Err(format!(
                "`{words}` may be {named}, but {doubts}; if it is the one you mean, give its \
                 track-id, {track_id}, in place of the words"
            ))
        }
        [] => Err(nothing(found, live)),
        several => Err(ambiguous(
            words,
            several.iter().map(|o| NamedTrack::of_found(o)),
        )),
    }
}

/// Object that may be meant.
struct NamedTrack<'a> {
    track_id: u64,
    /// Label as it is shown.
    label: String,
    state: &'a str,
}

impl<'a> NamedTrack<'a> {
    fn of_live(object: &'a ObjectDocument) -> Self {
        Self {
            track_id: object.track_id,
            label: object.answer.shown(object.label.as_deref()),
            state: &object.state,
        }
    }

    fn of_found(object: &'a FoundObjectReport) -> Self {
        Self {
            track_id: object.track_id,
            label: object.answer.shown(object.label.as_deref()),
            state: &object.state,
        }
    }

    fn in_words(&self) -> String {
        let label = &self.label;
        let state = match self.state {
            "tracked" => String::new(),
            state => format!(", {state}"),
        };
        format!("track {} ({label}{state})", self.track_id)
    }
}

fn list<'a>(candidates: impl Iterator<Item = NamedTrack<'a>>) -> String {
    let mut named: Vec<String> = candidates.map(|one| one.in_words()).collect();
    let n_more = named.len().saturating_sub(N_NAMED_MAX);
    if n_more > 0 {
        named.truncate(N_NAMED_MAX);
        named.push(format!("{n_more} more"));
    }
    named.join(", ")
}

fn ambiguous<'a>(words: &str, candidates: impl Iterator<Item = NamedTrack<'a>>) -> String {
    format!(
        "`{words}` may be {}; give the track-id of the one you mean, or say more of it, such as \
         its colour or its place",
        list(candidates)
    )
}

fn nothing(found: &FindReport, live: &[ObjectDocument]) -> String {
    // Without a live match the sentence is about objects that are gone.
    let answer = found.sentence.trim_end_matches('.');
    let gone = if found.matches.is_empty() {
        ""
    } else {
        ", which is gone"
    };
    if live.is_empty() {
        return format!("{answer}{gone}; nothing is tracked now, see `tabula objects`");
    }
    format!(
        "{answer}{gone}; the objects are {}: give the track-id of the one you mean",
        list(live.iter().map(NamedTrack::of_live))
    )
}

#[cfg(test)]
mod tests;
