//! What is measured of every actor system: a crew of adders.

/// So many messages wait for one actor, where the system has a bound.
pub const MAILBOX: usize = 4;

/// A number of actors that add up what they are sent and answer the total.
#[allow(async_fn_in_trait, reason = "one thread runs everything")]
pub trait Crew: Sized {
    const NAME: &'static str;

    /// Begins so many actors; they need not have run yet.
    fn spawn(n: usize) -> Self;

    /// Asks each to add one, then awaits all answers; returns their sum.
    async fn round(&mut self) -> u64;

    /// Tells all to stop, then waits until each has ended.
    async fn stop(self);
}
