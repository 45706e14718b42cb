//! Fuzz target: arbitrary bytes as the index of a fakenect recording.
#![no_main]

use dataset::fakenect_folder::parse_index;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    match parse_index(bytes) {
        Ok(entries) => {
            let lines = bytes.split(|byte| *byte == b'\n');
            for (entry, line) in entries.iter().zip(lines) {
                assert_eq!(entry.file_name.as_bytes(), line);
                assert!(!entry.file_name.contains('/') && !entry.file_name.contains(".."));
            }
        }
        Err(error) => assert!(error.to_string().contains(' ')),
    }
});
