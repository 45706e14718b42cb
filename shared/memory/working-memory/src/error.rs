//! Errors of the working memory, as sentences that say what to do next.

pub use durable_leveldb::Error as StorageError;

/// Error of a working-memory operation.
#[derive(Debug, Clone, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Error of the database and its folder.
    #[error(transparent)]
    Storage(#[from] StorageError),
    /// Error of a writer thread that has ended.
    #[error("the store has stopped; start it and send this again")]
    Stopped,
}
