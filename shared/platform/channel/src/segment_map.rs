//! Lookup of the shared-memory segment of an address (`/proc/self/maps`).

use message::SegmentLocation;
use std::ops::Range;

/// Cache of this process's memory mappings, so that the kernel's table is read only
/// once per segment.
#[derive(Debug, Default)]
pub(crate) struct SegmentMap {
    mappings: Vec<SegmentMapping>,
}

#[derive(Debug, PartialEq, Eq)]
struct SegmentMapping {
    addresses: Range<usize>,
    file_offset: u64,
    inode: u64,
}

impl SegmentMap {
    /// Segment and offset of an address; the default when no mapping of `/dev/shm`
    /// contains it.
    #[inline]
    pub(crate) fn locate(&mut self, address: usize) -> SegmentLocation {
        if let Some(location) = self.find(address) {
            return location;
        }
        self.read_table();
        self.find(address).unwrap_or_default()
    }

    fn read_table(&mut self) {
        let table = std::fs::read_to_string("/proc/self/maps").unwrap_or_default();
        self.mappings = table.lines().filter_map(parse).collect();
    }

    /// Moves the mapping found to the front: mostly it is the next one, too.
    #[inline]
    fn find(&mut self, address: usize) -> Option<SegmentLocation> {
        let contains = |mapping: &SegmentMapping| mapping.addresses.contains(&address);
        let index = self.mappings.iter().position(contains)?;
        self.mappings.swap(0, index);
        let mapping = &self.mappings[0];
        let offset = (address - mapping.addresses.start) as u64;
        Some(SegmentLocation {
            inode: mapping.inode,
            offset_bytes: mapping.file_offset + offset,
        })
    }
}

/// Parses a line of the kernel's table that maps a file of `/dev/shm`.
fn parse(line: &str) -> Option<SegmentMapping> {
    let mut words = line.split_ascii_whitespace();
    let (start, end) = words.next()?.split_once('-')?;
    let file_offset = words.nth(1)?;
    let inode = words.nth(1)?;
    words.next()?.starts_with("/dev/shm/").then_some(())?;
    Some(SegmentMapping {
        addresses: usize::from_str_radix(start, 16).ok()?..usize::from_str_radix(end, 16).ok()?,
        file_offset: u64::from_str_radix(file_offset, 16).ok()?,
        inode: inode.parse().ok()?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_mappings_of_shared_memory_are_kept() {
        let shared = "7f0000000000-7f0000100000 rw-s 00002000 00:19 77   /dev/shm/tabula_x.data";
        let expected = SegmentMapping {
            addresses: 0x7f00_0000_0000..0x7f00_0010_0000,
            file_offset: 0x2000,
            inode: 77,
        };
        assert_eq!(parse(shared), Some(expected));
        assert_eq!(
            parse("7f0000000000-7f0000100000 rw-p 00000000 00:00 0 [heap]"),
            None
        );
        assert_eq!(parse("rubbish"), None);
    }
    #[test]
    fn addresses_are_found_in_any_order() {
        let mapping = |start: usize, inode| SegmentMapping {
            addresses: start..start + 100,
            file_offset: 7,
            inode,
        };
        let mappings = vec![mapping(1_000, 1), mapping(2_000, 2), mapping(3_000, 3)];
        let mut map = SegmentMap { mappings };
        for (address, inode) in [(3_001, 3), (1_001, 1), (1_001, 1), (2_001, 2), (3_001, 3)] {
            let location = SegmentLocation {
                inode,
                offset_bytes: 8,
            };
            assert_eq!(map.find(address), Some(location));
        }
        assert_eq!(map.find(999), None);
    }
}
