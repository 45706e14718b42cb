//! Groups of the process behind a connection (`SO_PEERGROUPS`).
#![expect(unsafe_code, reason = "rustix has no call for this option of a socket")]

use libc::{SO_PEERGROUPS, SOL_SOCKET, c_void, getsockopt, gid_t, socklen_t};
use std::io;
use std::os::fd::{AsFd, AsRawFd};

/// Number of groups that the first attempt has room for.
const N_USUAL: usize = 64;

/// Supplementary groups of the peer when it connected. Its primary group is in its credentials.
///
/// # Errors
/// When the socket has no peer, or the kernel is older than Linux 4.13.
pub(super) fn peer_groups(socket: impl AsFd) -> io::Result<Vec<u32>> {
    let descriptor = socket.as_fd().as_raw_fd();
    let mut groups: Vec<gid_t> = vec![0; N_USUAL];
    loop {
        let mut n_bytes = size_of_val(groups.as_slice()) as socklen_t;
        let buffer = groups.as_mut_ptr().cast::<c_void>();
        // SAFETY: the descriptor is open while it is borrowed, and `n_bytes` is the length of the
        // buffer, which outlives the call.
        let result = unsafe {
            getsockopt(
                descriptor,
                SOL_SOCKET,
                SO_PEERGROUPS,
                buffer,
                &raw mut n_bytes,
            )
        };
        let n_groups = n_bytes as usize / size_of::<gid_t>();
        if result == 0 {
            groups.truncate(n_groups);
            return Ok(groups);
        }
        let error = io::Error::last_os_error();
        if error.raw_os_error() != Some(libc::ERANGE) || n_groups <= groups.len() {
            return Err(error);
        }
        groups.resize(n_groups, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::os::unix::net::UnixStream;

    #[test]
    fn peer_groups_are_those_of_the_connecting_process() {
        let (socket, _peer) = UnixStream::pair().unwrap();
        let found: BTreeSet<u32> = peer_groups(&socket).unwrap().into_iter().collect();
        let own = rustix::process::getgroups().unwrap();
        assert_eq!(found, own.iter().map(|group| group.as_raw()).collect());
    }

    #[test]
    fn peer_groups_of_a_file_are_refused() {
        let file = tempfile::tempfile().unwrap();
        assert!(peer_groups(&file).is_err());
    }
}
