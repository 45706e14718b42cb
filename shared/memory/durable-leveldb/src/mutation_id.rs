//! Random ids from the kernel: idempotency keys, and ids of stores.

use crate::error::Error;

/// Idempotency key: a random number that the client repeats when it retries a mutation, so that the
/// retry is answered and not applied again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MutationId(pub u128);

impl MutationId {
    /// Random id, unique for all practical purposes.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] when the kernel gives no random numbers.
    pub fn random() -> Result<Self, Error> {
        Ok(Self(u128::from_be_bytes(random_id()?)))
    }
}

/// Random 128-bit id from the kernel.
///
/// # Errors
///
/// [`Error::Io`] when the kernel gives no random numbers.
pub fn random_id() -> Result<[u8; 16], Error> {
    let mut id = [0; 16];
    getrandom::fill(&mut id)
        .map_err(|error| std::io::Error::other(error.to_string()))
        .map_err(Error::io("drawing an id from", "the kernel"))?;
    Ok(id)
}
