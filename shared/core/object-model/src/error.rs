//! Errors of object models, as sentences that say what to do next.

use crate::document::VERSION;

/// Error of an object model.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Bytes that are no list of version and content.
    #[error(
        "this is no object model: it does not begin with a version and a content; name a document \
         that tabula wrote"
    )]
    NotAModel,
    /// Model of another version of the encoding.
    #[error(
        "the object model has version {found} of its encoding, and this program reads version \
         {VERSION}; use the tabula that wrote it"
    )]
    Version {
        /// Version of the encoding.
        found: u64,
    },
    /// Bytes that are cut or damaged.
    #[error("the object model is cut or damaged: {0}; build it again, or undo what replaced it")]
    Damaged(&'static str),
    /// Values that no model can have.
    #[error("the object model is invalid: {0}; build it again")]
    Invalid(String),
    /// Mesh that cannot be written as PLY.
    #[error(transparent)]
    Ply(#[from] ply::Error),
}
