//! Retry of failed reads: an error of the medium may pass, and a rebuild of the database is dear.

use std::io;
use std::time::Duration;

/// Pauses before the second and each later attempt.
const PAUSES: [Duration; 3] = [
    Duration::from_millis(5),
    Duration::from_millis(50),
    Duration::from_millis(500),
];

/// Linux error code of a medium that could not be read.
const EIO: i32 = 5;

/// Calls `read` again while it fails for the medium; it opens the file anew each time.
pub(crate) fn retried<T>(mut read: impl FnMut() -> io::Result<T>) -> io::Result<T> {
    let mut result = read();
    for pause in PAUSES {
        match &result {
            Err(error) if error.raw_os_error() == Some(EIO) => {
                std::thread::sleep(pause);
                result = read();
            }
            _ => break,
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Linux error code of a file that does not exist.
    const ENOENT: i32 = 2;

    #[test]
    fn read_is_retried_only_after_an_error_of_the_medium() {
        let attempts = |n_failures: u32, code: i32| {
            let mut n = 0;
            let read = retried(|| {
                n += 1;
                if n > n_failures {
                    Ok(())
                } else {
                    Err(io::Error::from_raw_os_error(code))
                }
            });
            (n, read.is_ok())
        };
        assert_eq!(attempts(0, EIO), (1, true));
        assert_eq!(attempts(3, EIO), (4, true));
        assert_eq!(attempts(9, EIO), (4, false));
        assert_eq!(attempts(1, ENOENT), (1, false));
    }
}
