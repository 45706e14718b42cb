//! Export job: writes the memory in the export format, streamed through a bounded buffer.

use crate::job_context::{JobContext, Progress};
use control_protocol::{ExportReport, JobOutcome, MAX_MESSAGE_BYTES};
use perceptual_memory::{Error, PerceptualMemory, PortableCounts, PortableWriter};
use std::io::{self, Write};
use std::sync::atomic::Ordering;

/// Maximum number of bytes in one reply.
const READ_BYTES: usize = MAX_MESSAGE_BYTES / 2;
/// Capacity of the export buffer, bytes.
const BUFFER_BYTES: usize = 8 << 20;

/// Exports a checkpoint of the store.
pub(crate) fn run(context: &JobContext, progress: &Progress) -> Result<JobOutcome, String> {
    let failed = |error: Error| error.to_string();
    let checkpoint = context.store.read_and_wait(PerceptualMemory::checkpoint);
    let mut reader = checkpoint
        .and_then(perceptual_memory::Checkpoint::open)
        .map_err(failed)?;
    let sequence = reader.position().sequence;
    let total = reader.n_views() as u64;
    progress.set(0, total);
    let pipe = ExportPipe {
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
    reader: &mut perceptual_memory::CheckpointReader,
    mut pipe: ExportPipe<'_>,
    progress: &Progress,
    total: u64,
) -> io::Result<(PortableCounts, u64)> {
    /// Error of the store or of the writer.
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

/// Writer side of the export buffer; blocks while the buffer is full.
struct ExportPipe<'a> {
    progress: &'a Progress,
    n_bytes: u64,
}

impl Write for ExportPipe<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut buffer = self.progress.bytes.lock();
        while buffer.bytes.len() > BUFFER_BYTES {
            if self.progress.is_abandoned() {
                return Err(io::Error::other("the export is no longer being read"));
            }
            self.progress.bytes_moved.wait(&mut buffer);
        }
        buffer.bytes.extend(bytes);
        self.n_bytes += bytes.len() as u64;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Bytes from `offset` on; earlier ones are dropped. A repeated request gets the same bytes.
pub(crate) fn read(progress: &Progress, offset: u64) -> Vec<u8> {
    let mut buffer = progress.bytes.lock();
    let n_read = offset.saturating_sub(buffer.offset) as usize;
    let n_read = n_read.min(buffer.bytes.len());
    buffer.bytes.drain(..n_read);
    buffer.offset += n_read as u64;
    let bytes: Vec<u8> = buffer.bytes.iter().take(READ_BYTES).copied().collect();
    let n_read = buffer.offset + bytes.len() as u64;
    progress.n_read.fetch_max(n_read, Ordering::Relaxed);
    drop(buffer);
    progress.bytes_moved.notify_all();
    bytes
}
