//! Errors of reading and writing PCD files.

use super::{MAX_BYTES, MAX_POINTS};
use crate::{FileError, lzf};

/// Error of reading or writing a PCD file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Failed access to the PCD file.
    #[error("{0}")]
    File(#[from] FileError),
    /// PCD header without a `DATA` line.
    #[error(
        "this is not a PCD file: no line \"DATA …\" within the first 64 KiB; name another file"
    )]
    NoData,
    /// PCD header without a required line.
    #[error("the PCD header has no line \"{0} …\"; write the file as version 0.7")]
    MissingLine(&'static str),
    /// Invalid line of the PCD header.
    #[error("line {line} of the PCD header is wrong: {problem}")]
    HeaderLine {
        /// Line number in the PCD file, from 1.
        line: usize,
        /// Reason why the content is invalid, as a clause.
        problem: String,
    },
    /// Field list that does not describe points.
    #[error("the fields of the PCD file are wrong: {0}")]
    Fields(&'static str),
    /// More points or bytes than the limits.
    #[error(
        "the PCD file announces more than {max_points} points or {max_bytes} bytes; \
         make the cloud smaller",
        max_points = MAX_POINTS,
        max_bytes = MAX_BYTES
    )]
    TooLarge,
    /// PCD file shorter than its header announces.
    #[error(
        "the PCD file is cut off: its header needs at least {needed} bytes of data, \
         and {present} are there; copy the file again"
    )]
    Truncated {
        /// Minimum size of the point data, bytes.
        needed: usize,
        /// Actual size of the point data, bytes.
        present: usize,
    },
    /// Decompressed size stated before the compressed data that contradicts the header.
    #[error(
        "the compressed PCD data announces {announced} bytes where the header needs \
         {needed}; the file is damaged"
    )]
    CompressedSize {
        /// Announced size of the decompressed data, bytes.
        announced: usize,
        /// Size of the decompressed data that follows from the header, bytes.
        needed: usize,
    },
    /// Damaged compressed data of a PCD file.
    #[error("the PCD file cannot be expanded: {0}")]
    Compression(#[source] lzf::Error),
    /// Invalid line of ASCII points.
    #[error("line {line} of the PCD file's points is wrong: {problem}")]
    PointLine {
        /// Line number within the data, from 1.
        line: usize,
        /// Reason why the content is invalid, as a clause.
        problem: String,
    },
    /// Label that is not an integer from 0 to 2^32 - 1.
    #[error(
        "the label of point {point_idx} in the PCD file is {value}; labels are whole \
         numbers from 0 to 4294967295"
    )]
    Label {
        /// Index of the point, from 0.
        point_idx: usize,
        /// Invalid label value.
        value: f64,
    },
    /// Slice of the caller whose length is not the number of points.
    #[error("the PCD file's size needs {needed} {what}, and {given} were given; pass as many")]
    SizeMismatch {
        /// Name of the slice of the caller.
        what: &'static str,
        /// Length of the slice given by the caller.
        given: usize,
        /// Number of points, which the slice length must equal.
        needed: usize,
    },
    /// Request for labels of a file without labels.
    #[error("the PCD file has no labels; ask for its points only")]
    NoLabels,
}
