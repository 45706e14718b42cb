//! Making one file of everything, and handing it on as it is made.

use crate::jobs::{Progress, Surroundings, lock};
use message::control::{ExportReport, JobOutcome, MAX_MESSAGE_BYTES};
use std::collections::VecDeque;
use std::io::{self, Write};
use store::{Error, PortableCounts, PortableWriter};

/// Bytes in one answer.
const READ_BYTES: usize = MAX_MESSAGE_BYTES / 2;
/// Bytes that may wait to be read.
const BUFFER_BYTES: usize = 8 << 20;

/// The bytes of the file that were made and not yet read.
#[derive(Default)]
pub(crate) struct Buffer {
    bytes: VecDeque<u8>,
    /// Of the first of them, in the file.
    offset: u64,
}

/// Exports a checkpoint of the store.
pub(crate) fn run(surroundings: &Surroundings, progress: &Progress) -> Result<JobOutcome, String> {
    let failed = |error: Error| error.to_string();
    let checkpoint = surroundings
        .store
        .read_and_wait(|memory| memory.checkpoint());
    let mut reader = checkpoint
        .and_then(store::Checkpoint::open)
        .map_err(failed)?;
    let sequence = reader.position().sequence;
    let total = reader.n_views() as u64;
    progress.set(0, total);
    let pipe = Pipe {
        progress,
        n_bytes: 0,
    };
    let counts = write(&mut reader, pipe, progress, total).map_err(|error| error.to_string())?;
    let PortableCounts {
        n_views,
        n_forgotten,
        n_documents,
    } = counts.0;
    Ok(JobOutcome::Exported(ExportReport {
        bytes: counts.1,
        n_views,
        n_forgotten,
        n_documents,
        sequence,
    }))
}

fn write(
    reader: &mut store::CheckpointReader,
    mut pipe: Pipe<'_>,
    progress: &Progress,
    total: u64,
) -> io::Result<(PortableCounts, u64)> {
    /// An error of either side.
    struct Failed(io::Error);
    impl From<Error> for Failed {
        fn from(error: Error) -> Self {
            Self(io::Error::other(error))
        }
    }
    let writer = std::cell::RefCell::new(PortableWriter::new(&mut pipe)?);
    let mut done = 0;
    let exported = reader.export(
        |view| {
            done += 1;
            progress.set(done, total.max(done));
            writer.borrow_mut().view(&view).map_err(Failed)
        },
        |document| writer.borrow_mut().document(&document).map_err(Failed),
    );
    exported.map_err(|Failed(error)| error)?;
    let counts = writer.into_inner().end()?;
    Ok((counts, pipe.n_bytes))
}

/// Hands bytes on to whoever reads them, and waits when there are many.
struct Pipe<'a> {
    progress: &'a Progress,
    n_bytes: u64,
}

impl Write for Pipe<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut buffer = lock(&self.progress.bytes);
        while buffer.bytes.len() > BUFFER_BYTES {
            if self.progress.is_given_up() {
                return Err(io::Error::other("nobody reads the export any more"));
            }
            let waited = self.progress.bytes_moved.wait(buffer);
            buffer = waited.unwrap_or_else(std::sync::PoisonError::into_inner);
        }
        buffer.bytes.extend(bytes);
        self.n_bytes += bytes.len() as u64;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// The bytes from `offset` on; those before it are no more needed. Asking again for
/// the same is answered the same.
pub(crate) fn read(progress: &Progress, offset: u64) -> Vec<u8> {
    let mut buffer = lock(&progress.bytes);
    let n_read = offset.saturating_sub(buffer.offset) as usize;
    let n_read = n_read.min(buffer.bytes.len());
    buffer.bytes.drain(..n_read);
    buffer.offset += n_read as u64;
    let bytes = buffer.bytes.iter().take(READ_BYTES).copied().collect();
    drop(buffer);
    progress.bytes_moved.notify_all();
    bytes
}
