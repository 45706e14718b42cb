//! Errors of a query and of WordNet's files, as sentences that say what to do next.

use std::path::PathBuf;

/// Error of a query or of the WordNet reader.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Query without a word.
    #[error("the query has no word; say which object you mean, for example \"the red mug\"")]
    EmptyQuery,
    /// Query that is longer than [`QUERY_CHARACTERS_MAX`](crate::QUERY_CHARACTERS_MAX).
    #[error("the query has {n_characters} characters; say it with at most {n_most}")]
    LongQuery {
        /// Characters of the query.
        n_characters: usize,
        /// Most characters of a query.
        n_most: usize,
    },
    /// File of WordNet that cannot be read.
    #[error("cannot read WordNet's {}; reinstall it (apt-get install --reinstall wordnet-base)", path.display())]
    UnreadableFile {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// File that does not begin as a file of WordNet.
    #[error("{} is not a file of WordNet; reinstall it (apt-get install --reinstall wordnet-base)", path.display())]
    ForeignFile {
        /// The file.
        path: PathBuf,
    },
}
