//! Bounded reading and atomic writing of files.
//!
//! A regular file is read up to the limit of its format ([`read_file`]). Files are written
//! atomically ([`OutputFile`], [`write_atomic`]), and replace only regular files: the writer of
//! all files that a user names, for every program.
//!
//! This crate never reserves memory that a file does not account for, and never writes to a file
//! outside the path it was given.

mod bounded_file;
mod natural_order;
mod number_type;
mod output_file;

pub use bounded_file::{FileError, file_names, folder_names, open_file, read_file};
pub use natural_order::natural_order;
pub use number_type::{ByteOrder, NumberType, as_u32, excerpt, read_bits};
pub use output_file::{OutputFile, check_output, create_folder, write_atomic};
