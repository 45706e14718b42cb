//! Track-ids and names of categories, which a person may have given in each other's place.

use crate::arguments::LabelArguments;
use control_client::{TrackReference, TrackScope, ask, connect, is_track_id};
use control_protocol::request;
use service::{CommonArguments, Failure, probable_name};

/// Track-id of the object that gets a label by the command `verb`.
///
/// # Errors
/// If words mean no object or several, or the arguments are swapped: words in the place of the
/// object, and a number that is no category in the place of the name.
pub(crate) fn labelled_track(
    common: &CommonArguments,
    verb: &str,
    label: &LabelArguments,
) -> Result<u64, Failure> {
    let author = label.author.as_deref();
    let resolve = || label.track.resolve(common, TrackScope::CHANGE, author);
    let TrackReference::Words(words) = &label.track else {
        return resolve();
    };
    if !is_track_id(&label.category) {
        return resolve();
    }
    let suggestion = format!(
        "did you mean `tabula {verb} {} {}`?",
        label.category,
        as_argument(words)
    );
    if categories(common)?.contains(&label.category) {
        return resolve()
            .map_err(|failure| Failure::new(failure.code, format!("{failure}; or {suggestion}")));
    }
    Err(Failure::usage(format!(
        "the object comes first and its name second, and {:?} is no name that was taught; \
         {suggestion}",
        label.category
    )))
}

/// Failure of changing categories. If there is none of one of the names, the failure says what may
/// be meant: another category, or the track of a number.
pub(crate) fn with_meant(common: &CommonArguments, names: &[String], failure: Failure) -> Failure {
    if !failure.is_missing || names.is_empty() {
        return failure;
    }
    // Where the categories cannot be read, the reason of the refusal has to do.
    let Ok(categories) = categories(common) else {
        return failure;
    };
    match names.iter().find_map(|name| meant(name, &categories)) {
        Some(meant) => Failure::new(failure.code, format!("{failure}; {meant}")),
        None => failure,
    }
}

/// Phrase about what a name may mean that is no category.
fn meant(name: &str, categories: &[String]) -> Option<String> {
    if categories.iter().any(|category| category == name) {
        return None;
    }
    if is_track_id(name) {
        return Some(format!(
            "tabula forget --track {name} forgets the track {name}, and tabula correct {name} \
             NAME names it"
        ));
    }
    let probable = probable_name(name, categories.iter().map(String::as_str))?;
    Some(format!("{probable} may be meant"))
}

/// Names of the categories.
fn categories(common: &CommonArguments) -> Result<Vec<String>, Failure> {
    let all = ask(&mut connect(common)?, &request::categories())?;
    Ok(all.into_iter().map(|one| one.category).collect())
}

/// Words as one argument in a shell.
fn as_argument(words: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_.".contains(c);
    if words.chars().all(is_plain) {
        words.to_owned()
    } else {
        format!("'{}'", words.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn name_of_no_category_may_mean_a_track_or_another_category() {
        let categories = ["mug", "87"].map(str::to_owned);
        let meant = |name| meant(name, &categories);
        assert_eq!(
            (meant("mug"), meant("87"), meant("teapot")),
            (None, None, None)
        );
        assert_eq!(meant("mugg"), Some("mug may be meant".to_owned()));
        let track = "tabula forget --track 88 forgets the track 88, and tabula correct 88 NAME \
                     names it";
        assert_eq!(meant("88"), Some(track.to_owned()));
    }

    #[test]
    fn words_of_a_suggestion_are_one_argument() {
        for (words, argument) in [
            ("can", "can"),
            ("soda-can_2", "soda-can_2"),
            ("red mug", "'red mug'"),
            ("Anna's mug", r"'Anna'\''s mug'"),
        ] {
            assert_eq!(as_argument(words), argument);
        }
    }
}
