//! File of a loaded function, from `/proc/self/maps`.

use std::fs;
use std::path::PathBuf;

/// File mapped at `address` in this process, links resolved. `None` if the kernel does not report
/// it.
pub(crate) fn mapped_file(address: usize) -> Option<PathBuf> {
    find_in_maps(&fs::read_to_string("/proc/self/maps").ok()?, address)
}

/// Finds the mapping of `address` in the text of `/proc/self/maps`, whose lines read `from-to
/// rights offset device inode   path`.
fn find_in_maps(maps: &str, address: usize) -> Option<PathBuf> {
    let line = maps
        .lines()
        .find(|line| range_contains(line, address) == Some(true))?;
    let path = line.splitn(6, ' ').nth(5)?.trim_start();
    path.starts_with('/').then(|| PathBuf::from(path))
}

fn range_contains(line: &str, address: usize) -> Option<bool> {
    let (from, to) = line.split(' ').next()?.split_once('-')?;
    let hexadecimal = |digits| usize::from_str_radix(digits, 16).ok();
    Some((hexadecimal(from)?..hexadecimal(to)?).contains(&address))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    const MAPS: &str = "\
5581-5590 r--p 00000000 fe:01 1234                       /usr/bin/a name with spaces
55a0-55b0 rw-p 00000000 00:00 0                          [heap]
7f00-7f20 r-xp 00002000 fe:01 5678                       /usr/lib/fakenect/libfreenect.so.0.5.3
";

    #[test]
    fn address_is_resolved_to_its_file() {
        let check = |address, expected: Option<&str>| {
            assert_eq!(
                find_in_maps(MAPS, address).as_deref(),
                expected.map(Path::new)
            );
        };
        check(0x5581, Some("/usr/bin/a name with spaces"));
        check(0x7f1f, Some("/usr/lib/fakenect/libfreenect.so.0.5.3"));
        check(0x7f20, None);
        check(0x55a1, None);
    }

    #[test]
    fn malformed_maps_have_no_mapping() {
        for text in ["", "x", "7-", "zz-zz r", "0-ffff", "0-ffff r x x x"] {
            assert_eq!(find_in_maps(text, 0x10), None);
        }
    }

    #[test]
    fn own_function_is_resolved_to_this_program() {
        let address = mapped_file as *const () as usize;
        assert_eq!(
            mapped_file(address),
            std::env::current_exe().unwrap().canonicalize().ok()
        );
    }
}
