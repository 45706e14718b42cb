//! Disk probe: type of the file system and latency of `fdatasync`.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;
use std::time::Instant;

/// Size of one append, bytes.
const APPENDED_BYTES: usize = 4096;

/// File-system type of a folder, from the mount table; "unknown" without an entry.
pub fn file_system(folder: &Path) -> io::Result<String> {
    let folder = folder.canonicalize()?;
    let mounts = fs::read_to_string("/proc/self/mounts")?;
    let fields = mounts.lines().filter_map(|line| {
        let mut fields = line.split(' ').skip(1);
        Some((fields.next()?, fields.next()?))
    });
    let over = fields.filter(|(place, _)| folder.starts_with(place));
    // The last of several mounts on one path is the visible one.
    let nearest = over.max_by_key(|(place, _)| place.len());
    Ok(nearest.map_or_else(|| "unknown".to_owned(), |(_, kind)| kind.to_owned()))
}

/// Latencies of `n_appended` appends of 4 kB with `fdatasync`, milliseconds.
pub fn sync_ms(folder: &Path, n_appended: usize) -> io::Result<Vec<f64>> {
    let path = folder.join("appended");
    let mut file = File::create(&path)?;
    let mut times_ms = Vec::with_capacity(n_appended);
    for _ in 0..n_appended {
        let begin = Instant::now();
        file.write_all(&[1; APPENDED_BYTES])?;
        file.sync_data()?;
        times_ms.push(begin.elapsed().as_secs_f64() * 1e3);
    }
    fs::remove_file(path)?;
    Ok(times_ms)
}
