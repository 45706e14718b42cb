use super::*;
use proptest::prelude::*;
use std::fmt::Write as _;

/// Valid folder with one file of each kind.
fn good_folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let depth = [b"P5 640 480 65535\n".as_slice(), &vec![0; DEPTH_BYTES]].concat();
    let video = [b"P6 640 480 255\n".as_slice(), &vec![0; VIDEO_BYTES]].concat();
    let files: [(&str, &[u8]); 3] = [
        ("a-10.0-7.dump", &[0; 12]),
        ("d-10.5-8.pgm", &depth),
        ("r-11.0-9.ppm", &video),
    ];
    let mut index = String::new();
    for (name, bytes) in files {
        fs::write(folder.path().join(name), bytes).unwrap();
        writeln!(index, "{name}").unwrap();
    }
    fs::write(folder.path().join("INDEX.txt"), index).unwrap();
    folder
}

/// Checks that a valid folder with one change is rejected with an error containing `part`.
fn check_refused(change: impl FnOnce(&Path), part: &str) {
    let folder = good_folder();
    change(folder.path());
    let sentence = check_recording(folder.path()).unwrap_err().to_string();
    assert!(sentence.contains(part), "{sentence}");
}

#[test]
fn valid_folder_is_summarised() {
    let summary = check_recording(good_folder().path()).unwrap();
    let duration = Duration::from_secs(1);
    assert_eq!(
        summary,
        RecordingSummary {
            n_depth: 1,
            n_video: 1,
            n_acceleration: 1,
            duration
        }
    );
}

#[test]
fn missing_files_are_refused() {
    check_refused(
        |folder| fs::remove_file(folder.join("INDEX.txt")).unwrap(),
        "INDEX.txt",
    );
    check_refused(
        |folder| fs::remove_file(folder.join("d-10.5-8.pgm")).unwrap(),
        "d-10.5-8.pgm",
    );
    check_refused(
        |folder| fs::remove_dir_all(folder).unwrap(),
        "there is no folder",
    );
    check_refused(
        |folder| fs::write(folder.join("d-10.5-8.pgm"), vec![0; 700_000]).unwrap(),
        "614400 bytes",
    );
}

#[test]
fn truncated_files_are_refused() {
    let shorten = |name: &'static str, by: u64| {
        move |folder: &Path| {
            let file = File::options().write(true).open(folder.join(name)).unwrap();
            file.set_len(file.metadata().unwrap().len() - by).unwrap();
        }
    };
    check_refused(shorten("d-10.5-8.pgm", 1), "614400 bytes");
    check_refused(shorten("r-11.0-9.ppm", 921_600), "921600 bytes");
    check_refused(shorten("r-11.0-9.ppm", 921_615), "921600 bytes");
    check_refused(shorten("a-10.0-7.dump", 1), "12 bytes");
}

#[test]
fn blocking_entries_are_refused() {
    let index = |text: &'static str| {
        move |folder: &Path| fs::write(folder.join("INDEX.txt"), text).unwrap()
    };
    check_refused(index("a-10.0-7.dump\n\nd-10.5-8.pgm\n"), "line 2");
    check_refused(index(""), "empty line");
    check_refused(
        |folder| {
            fs::copy(folder.join("a-10.0-7.dump"), folder.join("a-99.0-7.dump")).unwrap();
            fs::write(folder.join("INDEX.txt"), "a-10.0-7.dump\na-99.0-7.dump\n").unwrap();
        },
        "longer than 2 s",
    );
    check_refused(
        |folder| {
            fs::create_dir(folder.join("a-12.0-7.dump")).unwrap();
            fs::write(folder.join("INDEX.txt"), "a-12.0-7.dump\n").unwrap();
        },
        "not a regular file",
    );
}

#[test]
fn malformed_lines_are_refused_with_the_rule() {
    for (line, part) in [
        ("x-1.0-2.pgm", "must begin with"),
        ("d", "decimal number"),
        ("d-nan-2.pgm", "decimal number"),
        ("d-1e999-2.pgm", "decimal number"),
        ("d--1.0-2.pgm", "decimal number"),
        ("d-1.0", "stamp"),
        ("d-1.0-.pgm", "stamp"),
        ("d-1.0-4294967296.pgm", "stamp"),
        ("d-1.0-2/../../x", "slash"),
        ("d-1.0-2.pgm\r", "carriage return"),
    ] {
        let rule = parse_line(line).unwrap_err();
        assert!(rule.contains(part), "{line}: {rule}");
    }
}

#[test]
fn a_step_back_in_time_is_no_pause() {
    assert_eq!(pause_before(1.0, Some(900.0)), Ok(Duration::ZERO));
    assert!(pause_before(1e300, Some(0.0)).is_err());
}

proptest! {
    /// Fuzz test of the index parser: never panics, and accepted names are plain.
    #[test]
    fn any_line_is_taken_or_refused(line in "[dra]?-?[0-9.e-]{0,12}-?[0-9]{0,12}.{0,6}") {
        if let Ok(entry) = parse_line(&line) {
            prop_assert!(!entry.file_name.contains('/') && entry.seconds.is_finite());
        }
    }
}
