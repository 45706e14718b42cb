//! Durable counter of track-ids: which values leasing can reach, and recovery of the
//! counter when it was lost or raised beyond them.
//!
//! A program before this one raised the counter to any track-id that a request stored
//! a view under, so that one request could make all later leases impossible. Such a
//! counter counts as damage: it is recovered when the store is opened or repaired.

/// Largest plausible value of the counter: a thousand tracks a second reach it after
/// 8900 years.
const MAX_COUNTER: u64 = 1 << 48;

/// Track-ids left out above the highest one in use when nothing plausible is recorded:
/// a perception process may hold leased ids that no view shows. It leases 64 at a time.
const RECOVERY_MARGIN: u64 = 1 << 12;

/// `true` when leasing can have brought the counter to this value.
pub(crate) fn is_plausible(next_track_id: u64) -> bool {
    (1..=MAX_COUNTER).contains(&next_track_id)
}

/// First track-id to lease in a store that is made again: the greatest plausible
/// recorded counter, or else one above the plausible ids in use.
pub(crate) fn recovered(
    recorded: impl IntoIterator<Item = u64>,
    used: impl IntoIterator<Item = u64>,
) -> u64 {
    let used = used.into_iter().filter(|id| *id < MAX_COUNTER);
    let above_used = used.max().map_or(1, |last| last + 1);
    let recorded = recorded.into_iter().filter(|next| is_plausible(*next));
    match recorded.max() {
        Some(next_track_id) => next_track_id.max(above_used),
        None => above_used + RECOVERY_MARGIN,
    }
}

#[cfg(test)]
mod tests;
