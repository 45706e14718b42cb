//! Errors of reading DAE files.

use super::MAX_TRIANGLES;
use file_access::FileError;

/// Error of reading a DAE file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Failed access to the DAE file.
    #[error("{0}")]
    File(#[from] FileError),
    /// Content that is not UTF-8 text.
    #[error("this is not a DAE file in UTF-8 text; name another file")]
    NotText,
    /// Content that is not XML, or has a document type.
    #[error("the DAE file is not XML without a document type: {}; export it again", printable(.0))]
    Xml(#[from] roxmltree::Error),
    /// XML document of another kind.
    #[error("this is not a DAE file: its XML is no COLLADA document; name another file")]
    NotCollada,
    /// Document without a surface in its scene.
    #[error("the DAE file has no triangles or polygons in its scene; export it as a mesh")]
    NoTriangles,
    /// Invalid element.
    #[error("the element <{element}> in line {line} of the DAE file is wrong: {problem}")]
    Element {
        /// Name of the element.
        element: String,
        /// Line number of the element, from 1.
        line: u32,
        /// Reason why the content is invalid, as a clause.
        problem: String,
    },
    /// More triangles or vertices than the limit.
    #[error(
        "the scene of the DAE file has more than {max_triangles} triangles or vertices; make it \
         coarser",
        max_triangles = MAX_TRIANGLES
    )]
    TooLarge,
}

/// Message of the XML parser, shortened and without the control characters of the file.
fn printable(error: &roxmltree::Error) -> String {
    const MAX_CHARACTERS: usize = 200;
    let text = error.to_string();
    let characters = text.chars().take(MAX_CHARACTERS);
    let shown = |c: char| {
        if c.is_control() {
            char::REPLACEMENT_CHARACTER
        } else {
            c
        }
    };
    characters.map(shown).collect()
}
