//! Benchmark interface of an actor system: a group of actors that add numbers.

/// Mailbox capacity of each actor, in messages, for systems with bounded mailboxes.
pub const MAILBOX_CAPACITY: usize = 4;

/// Group of actors, each of which adds the numbers it receives and replies with its total.
#[allow(async_fn_in_trait, reason = "one thread runs everything")]
pub trait AdderGroup: Sized {
    /// Name of the actor system in reports.
    const NAME: &'static str;

    /// Spawns `n` actors, without waiting until they run.
    fn spawn(n: usize) -> Self;

    /// Request-reply round: sends 1 to each actor, awaits all replies and returns their sum.
    async fn round(&mut self) -> u64;

    /// Stops all actors and awaits their termination.
    async fn stop(self);
}
