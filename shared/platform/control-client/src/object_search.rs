//! Query in words for objects: the `find` request of a person.

use crate::authorship::author_or_user;
use crate::connection::ask;
use control_protocol::{FindQuery, FindReport, request};
use daemon_client::DaemonClient;
use service::Failure;

/// Asks the daemon for objects by English words. "I" is the author, else the user, and days are
/// those of the local time.
///
/// # Errors
/// If the query is refused, or the daemon does not answer in time.
pub fn find_objects(
    client: &mut DaemonClient,
    words: &str,
    author: Option<&str>,
) -> Result<FindReport, Failure> {
    let query = FindQuery {
        words: words.to_owned(),
        speaker: Some(author_or_user(author)),
        utc_offset_s: jiff::ZonedDateTime::now().offset().seconds(),
    };
    ask(client, &request::find(query))
}
