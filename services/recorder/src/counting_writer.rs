//! Buffered file that counts its bytes.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Size of the buffer before the file.
const BUFFER_BYTES: usize = 1 << 18;

/// File that counts the bytes written to it.
pub(crate) struct CountingWriter {
    file: BufWriter<File>,
    n_bytes: Arc<AtomicU64>,
}

impl CountingWriter {
    /// Writer of a new file, and its counter.
    pub(crate) fn new(file: File) -> (Self, Arc<AtomicU64>) {
        let n_bytes = Arc::new(AtomicU64::new(0));
        let writer = Self {
            file: BufWriter::with_capacity(BUFFER_BYTES, file),
            n_bytes: n_bytes.clone(),
        };
        (writer, n_bytes)
    }
}

impl Write for CountingWriter {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let n = self.file.write(bytes)?;
        self.n_bytes.fetch_add(n as u64, Ordering::Relaxed);
        Ok(n)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.file.flush()
    }
}
