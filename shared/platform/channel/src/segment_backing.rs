//! Backing of shared-memory segments: all memory of a port is allocated when it is made.
//!
//! A file of tmpfs is sparse. Its pages are allocated when they are first touched, and a
//! process that touches one when no memory is left is killed by SIGBUS. A segment that is
//! backed fails when it is made, with a sentence, or never.

use crate::shared_memory::files_of;
use crate::{DomainName, Error};
use rustix::fs::{FallocateFlags, Mode, OFlags, fallocate, fstat, open};
use rustix::io::{Errno, retry_on_intr};
use std::path::PathBuf;

/// Allocates all memory of the data segment of a port, named by its id.
///
/// # Errors
/// When there is not enough free memory, or the segment cannot be opened.
pub(crate) fn back_segment(
    domain: &DomainName,
    service: &'static str,
    port_id: u128,
) -> Result<(), Error> {
    let path = segment_path(domain, port_id).ok_or_else(|| {
        Error::transport("find the segment of", service, "it has no file in /dev/shm")
    })?;
    let failed = |source: Errno| Error::Backing {
        service,
        path: path.clone(),
        source: source.into(),
    };
    let flags = OFlags::RDWR | OFlags::CLOEXEC | OFlags::NOFOLLOW;
    let segment = open(&path, flags, Mode::empty()).map_err(failed)?;
    let n_bytes = fstat(&segment).map_err(failed)?.st_size.unsigned_abs();
    let allocate = || fallocate(&segment, FallocateFlags::KEEP_SIZE, 0, n_bytes);
    retry_on_intr(allocate).map_err(failed)
}

/// File of a port's data segment: iceoryx2 gives it a name that ends in the port's id.
fn segment_path(domain: &DomainName, port_id: u128) -> Option<PathBuf> {
    let end = format!("_{port_id}.data");
    let is_segment = |path: &PathBuf| path.to_string_lossy().ends_with(&end);
    files_of(domain).into_iter().find(is_segment)
}
