//! Watch of the reader of standard output, by epoll.

use mio::unix::SourceFd;
use mio::{Events, Interest, Poll, Token};
use std::io::{self, ErrorKind};
use std::os::fd::{AsRawFd, RawFd};

/// Calls `on_end` when the reader of standard output, a pipe or a socket, has gone. A file has no
/// reader.
///
/// # Errors
/// When the system has no file or thread left.
pub(crate) fn watch_reader(on_end: impl FnOnce() + Send + 'static) -> io::Result<()> {
    watch(io::stdout().as_raw_fd(), on_end)
}

fn watch(output: RawFd, on_end: impl FnOnce() + Send + 'static) -> io::Result<()> {
    let poll = Poll::new()?;
    let mut source = SourceFd(&output);
    match poll
        .registry()
        .register(&mut source, Token(0), Interest::WRITABLE)
    {
        // A file on a disk is always ready, and cannot be registered.
        Err(error) if error.kind() == ErrorKind::PermissionDenied => return Ok(()),
        registered => registered?,
    }
    std::thread::Builder::new()
        .name("reader".into())
        .spawn(move || {
            if wait_for_end(poll).is_ok() {
                on_end();
            }
        })?;
    Ok(())
}

/// Returns when the reader has gone. Each event is told once, so that room to write wakes nobody
/// for long.
fn wait_for_end(mut poll: Poll) -> io::Result<()> {
    let mut events = Events::with_capacity(1);
    loop {
        match poll.poll(&mut events, None) {
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            polled => polled?,
        }
        if events
            .iter()
            .any(|event| event.is_error() || event.is_write_closed())
        {
            return Ok(());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::net::UnixStream;
    use std::sync::mpsc::{TryRecvError, channel};
    use std::time::Duration;

    const WATCHDOG: Duration = Duration::from_secs(60);

    /// Watches `output`, whose other end is `reader`.
    fn check(output: &impl AsRawFd, reader: impl Sized) {
        let (sender, ended) = channel();
        watch(output.as_raw_fd(), move || sender.send(()).unwrap()).unwrap();
        assert_eq!(ended.try_recv(), Err(TryRecvError::Empty));
        drop(reader);
        ended.recv_timeout(WATCHDOG).unwrap();
    }

    #[test]
    fn reader_that_goes_is_noticed_although_nothing_is_written() {
        let (reader, writer) = io::pipe().unwrap();
        check(&writer, reader);
        let (reader, writer) = UnixStream::pair().unwrap();
        check(&writer, reader);
    }

    #[test]
    fn file_has_no_reader() {
        let file = std::fs::File::open(std::env::current_exe().unwrap()).unwrap();
        let (sender, ended) = channel();
        watch(file.as_raw_fd(), move || sender.send(()).unwrap()).unwrap();
        assert_eq!(ended.try_recv(), Err(TryRecvError::Disconnected));
    }
}
