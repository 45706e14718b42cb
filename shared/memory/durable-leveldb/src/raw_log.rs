//! Low-level reader of LevelDB log files that resumes after damaged parts. Format: LevelDB's
//! `doc/log_format.md`.

use crate::raw_table::RawRecord;
use crate::verified_files::{LOG_FIRST, LOG_FULL, LOG_LAST, log_pieces, take_varint};

/// Length of a batch header: sequence number of the first record, and number of records.
const BATCH_HEADER_BYTES: usize = 12;

/// Visits every record of the intact batches.
pub(crate) fn visit_log(log: &[u8], mut visit: impl FnMut(RawRecord<'_>)) {
    visit_log_records(log, |batch| {
        // The records up to the first invalid one.
        let _ = visit_batch(batch, &mut visit);
    });
}

/// Visits every intact log record: a batch, or an edit of a manifest.
pub(crate) fn visit_log_records(log: &[u8], mut visit: impl FnMut(&[u8])) {
    let mut record = Vec::new();
    let mut is_begun = false;
    let mut next_offset = 0;
    for piece in log_pieces(log) {
        // After a damaged part the pending record is incomplete.
        let is_next = piece.offset == next_offset;
        next_offset = piece.next_offset;
        if piece.kind == LOG_FULL || piece.kind == LOG_FIRST {
            record.clear();
            is_begun = true;
        }
        is_begun &= is_next || piece.kind == LOG_FULL || piece.kind == LOG_FIRST;
        if !is_begun {
            continue;
        }
        record.extend_from_slice(piece.data);
        if piece.kind == LOG_FULL || piece.kind == LOG_LAST {
            visit(&record);
            is_begun = false;
        }
    }
}

fn visit_batch(batch: &[u8], visit: &mut impl FnMut(RawRecord<'_>)) -> Option<()> {
    let (header, mut rest) = batch.split_first_chunk::<BATCH_HEADER_BYTES>()?;
    let mut sequence = u64::from_le_bytes(*header.first_chunk()?);
    while let Some((&kind, behind)) = rest.split_first() {
        rest = behind;
        let key = take_slice(&mut rest)?;
        let value = match kind {
            1 => Some(take_slice(&mut rest)?),
            0 => None,
            _ => return None,
        };
        visit(RawRecord {
            key,
            sequence,
            value,
        });
        sequence = sequence.wrapping_add(1);
    }
    Some(())
}

/// Takes a slice with its length before it, and advances.
pub(crate) fn take_slice<'a>(rest: &mut &'a [u8]) -> Option<&'a [u8]> {
    let n_bytes = usize::try_from(take_varint(rest)?).ok()?;
    let (slice, behind) = rest.split_at_checked(n_bytes)?;
    *rest = behind;
    Some(slice)
}
