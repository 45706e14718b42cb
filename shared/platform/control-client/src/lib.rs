//! Client of the control protocol, for command-line programs.
//!
//! [`connect`] reaches a daemon through its control socket and [`call`] turns a
//! refusal into a failure with its exit code. [`MemoryAccess`] asks the memory of a
//! running daemon, or, without one, a child process that opens the stored memory.
//!
//! Invariants: this crate never opens a database itself and never names one.

mod authorship;
mod connection;
mod import;
mod memory_access;

pub use authorship::{author_or_user, mutation_id};
pub use connection::{call, connect, refused, unexpected};
pub use import::{ImportRequest, import};
pub use memory_access::{MemoryAccess, daemon, local_folder};
