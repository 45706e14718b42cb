//! What the disk under both is: its file system, and what it takes to sync.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;
use std::time::Instant;

const APPENDED_BYTES: usize = 4096;

/// The type of the file system a folder lies in.
pub fn file_system(folder: &Path) -> io::Result<String> {
    let folder = folder.canonicalize()?;
    let mounts = fs::read_to_string("/proc/self/mounts")?;
    let fields = mounts.lines().filter_map(|line| {
        let mut fields = line.split(' ').skip(1);
        Some((fields.next()?, fields.next()?))
    });
    let over = fields.filter(|(place, _)| folder.starts_with(place));
    // Of mounts over one another the last one counts.
    let nearest = over.max_by_key(|(place, _)| place.len());
    Ok(nearest.map_or_else(|| "unknown".to_owned(), |(_, kind)| kind.to_owned()))
}

/// Milliseconds of so many small appends, each with `fdatasync`.
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
