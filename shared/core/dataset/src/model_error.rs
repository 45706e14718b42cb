//! Errors of reading a model file: OBJ, STL, DAE or PLY.

use crate::{dae, mesh};
use file_access::FileError;
use std::path::PathBuf;

/// Error of reading a model file or its material libraries.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// Failed access to a model file or material library.
    #[error("{0}")]
    File(#[from] FileError),
    /// Invalid PLY file.
    #[error(transparent)]
    Ply(#[from] ply::Error),
    /// OBJ file without vertex lines.
    #[error("this is not an OBJ file with a mesh: no line \"v x y z\"; name another file")]
    NoVertices,
    /// Content that is neither binary nor text STL.
    #[error(
        "this is not an STL file: it neither begins with \"solid\" nor has the header of a binary \
         file; name another file"
    )]
    NotStl,
    /// DAE content that is not UTF-8 text.
    #[error("this is not a DAE file in UTF-8 text; name another file")]
    NotText,
    /// XML document of another kind than DAE.
    #[error("this is not a DAE file: its XML is no COLLADA document; name another file")]
    NotCollada,
    /// DAE document without a surface in its scene.
    #[error("the DAE file has no triangles or polygons in its scene; export it as a mesh")]
    NoTriangles,
    /// Text STL file that ends within a solid.
    #[error("the STL file ends before the line \"endsolid\"; copy it again")]
    EndOfText,
    /// Binary STL file with data after its last triangle.
    #[error("the STL file goes on behind its last triangle; its header announces too little")]
    TrailingData,
    /// Binary STL file shorter than its header announces.
    #[error("the STL file announces {announced} triangles and ends after {present}; copy it again")]
    Truncated {
        /// Number of triangles announced in the header.
        announced: u32,
        /// Number of complete triangles in the STL file.
        present: usize,
    },
    /// Invalid line of a text file or material library.
    #[error("line {line} of the {format} file is wrong: {problem}")]
    Line {
        /// Name of the format.
        format: &'static str,
        /// Line number, from 1; the first one of a continued line.
        line: usize,
        /// Reason why the content is invalid, as a clause.
        problem: String,
    },
    /// Invalid element of a DAE file.
    #[error("the element <{element}> in line {line} of the DAE file is wrong: {problem}")]
    Element {
        /// Name of the element.
        element: String,
        /// Line number of the element, from 1.
        line: u32,
        /// Reason why the content is invalid, as a clause.
        problem: String,
    },
    /// Triangle of a binary STL file with a coordinate that is not finite.
    #[error("triangle {triangle} of the STL file has a coordinate that is not finite; repair it")]
    NotFinite {
        /// Index of the triangle, from 0.
        triangle: usize,
    },
    /// DAE content that is not XML, or has a document type.
    #[error("the DAE file is not XML without a document type: {}; export it again", printable(.0))]
    Xml(#[from] roxmltree::Error),
    /// More vertices or triangles than the limits of a file.
    #[error(
        "the {0} file has more than {max_vertices} vertices or {max_triangles} triangles; make \
         the mesh coarser",
        max_vertices = mesh::MAX_VERTICES,
        max_triangles = mesh::MAX_TRIANGLES
    )]
    TooLarge(&'static str),
    /// More vertices or triangles than the limits of a DAE scene.
    #[error(
        "the scene of the DAE file has more than {max_triangles} triangles or vertices; make it \
         coarser",
        max_triangles = dae::MAX_TRIANGLES
    )]
    SceneTooLarge,
    /// More materials or material libraries than the limits.
    #[error("the OBJ file has more than 65536 materials or 64 libraries of them; split it")]
    TooManyMaterials,
    /// Invalid material library.
    #[error("the materials {} cannot be used: {source}", .path.display())]
    Library {
        /// Path of the material library.
        path: PathBuf,
        /// Error in the content of the material library.
        source: Box<ModelError>,
    },
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
