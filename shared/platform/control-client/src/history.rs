//! Paging of the memory's history.

use crate::memory_client::MemoryClient;
use control_protocol::{HistoryReport, request};
use service::Failure;

impl MemoryClient {
    /// History entries, oldest first, with the last sequence number of the history; see
    /// [`read_history`].
    ///
    /// # Errors
    /// If a query is refused or the connection ends.
    pub fn history(
        &mut self,
        from: Option<u64>,
        count: u64,
    ) -> Result<(Vec<HistoryReport>, u64), Failure> {
        read_history(from, count, |from, max| {
            self.ask(&request::history(from, max))
        })
    }
}

/// Reads history entries page by page: up to `count` from sequence number `from` on, or
/// those among the last `count` sequence numbers. Returns them with the last sequence
/// number of the history.
///
/// `ask` sends one [`history`](request::history) query with a first sequence number and a
/// maximum number of entries, and returns the entries of the answer with its last sequence
/// number. The answer may hold fewer entries than asked for.
///
/// # Errors
/// Those of `ask`.
pub fn read_history<E>(
    from: Option<u64>,
    count: u64,
    mut ask: impl FnMut(Option<u64>, u32) -> Result<(Vec<HistoryReport>, u64), E>,
) -> Result<(Vec<HistoryReport>, u64), E> {
    let mut next = match from {
        Some(from) => from.max(1),
        None => ask(None, 1)?
            .1
            .saturating_add(1)
            .saturating_sub(count)
            .max(1),
    };
    let mut all = Vec::new();
    loop {
        let n_left = count - (all.len() as u64).min(count);
        let max = n_left.clamp(1, u64::from(u32::MAX)) as u32;
        let (page, last_sequence) = ask(Some(next), max)?;
        let last_read = page.last().map(|entry| entry.sequence);
        all.extend(page.into_iter().take(n_left as usize));
        match last_read {
            Some(last) if last < last_sequence && (all.len() as u64) < count => next = last + 1,
            _ => return Ok((all, last_sequence)),
        }
    }
}
