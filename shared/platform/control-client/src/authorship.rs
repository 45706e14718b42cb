//! Author and idempotency key of a change.

use control_protocol::MutationId;
use service::Failure;

/// Author of a change: the given name, else the user's name, else the user id.
pub fn author_or_user(author: Option<&str>) -> String {
    let user = || std::env::var("USER").ok().filter(|name| !name.is_empty());
    let uid = || format!("uid {}", rustix::process::getuid().as_raw());
    author.map(str::to_owned).or_else(user).unwrap_or_else(uid)
}

/// Random 128-bit idempotency key of a change.
///
/// # Errors
/// If the operating system provides no random numbers.
pub fn mutation_id() -> Result<MutationId, Failure> {
    MutationId::random().map_err(Failure::general)
}
