use super::*;
use mutation_fuzzing::{assert_sentence, corruption};
use proptest::prelude::*;
use std::fs;
use std::path::Path;
use std::time::Duration;

const START: Duration = Duration::from_secs(1_290_000_000);
const N_PIXELS: usize = WIDTH * HEIGHT;

const TILT: Tilt = Tilt {
    acceleration: [1, -819, 300],
    half_degrees: -20,
    motor: TiltMotor::Moving,
};

fn at(milliseconds: u64) -> Duration {
    START + Duration::from_millis(milliseconds)
}

fn record(folder: &Path) {
    let depth: Vec<u16> = (0..N_PIXELS).map(|pixel| (pixel % 2048) as u16).collect();
    let rgb: Vec<u8> = (0..3 * N_PIXELS).map(|value| value as u8).collect();
    let mut writer = FakenectWriter::create(folder).unwrap();
    writer.write_tilt(TILT, at(0), 7).unwrap();
    writer.write_depth(&depth, at(33), u32::MAX).unwrap();
    writer.write_color(&rgb, at(20), 0).unwrap();
    writer.write_depth(&depth, at(66), 2_000_000).unwrap();
}

#[test]
fn a_recording_passes_its_own_check() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("new/recording");
    record(&path);
    let recording = FakenectFolder::open(&path).unwrap();
    let kinds: Vec<FrameKind> = recording.entries().iter().map(|entry| entry.kind).collect();
    assert_eq!(
        kinds,
        [
            FrameKind::Tilt,
            FrameKind::Depth,
            FrameKind::Color,
            FrameKind::Depth
        ]
    );
    assert_eq!(recording.entries()[1].stamp, u32::MAX);
    assert_eq!(recording.entries()[1].unix_time, at(33));
    // Forward 33 ms and 46 ms; the step back takes no time.
    assert_eq!(recording.duration(), Duration::from_millis(79));
    let depth = fs::read(path.join("d-1290000000.033000-4294967295.pgm")).unwrap();
    assert_eq!(depth[..17], *b"P5 640 480 65535\n");
    assert_eq!(depth[17 + 2 * 2047..][..4], [0xff, 0x07, 0, 0]);
    let color = fs::read(path.join("r-1290000000.020000-0.ppm")).unwrap();
    assert_eq!(color[..18], *b"P6 640 480 255\n\x00\x01\x02");
    let tilt = fs::read(path.join("a-1290000000.000000-7.dump")).unwrap();
    assert_eq!(tilt, [1, 0, 0xcd, 0xfc, 0x2c, 1, 0xec, 0, 4, 0, 0, 0]);
}

#[test]
fn a_recording_is_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path());
    assert_sentence(&FakenectWriter::create(folder.path()).unwrap_err());
}

/// Records, damages the recording, and expects validation to fail with the reason.
#[track_caller]
fn check_refusal(reason: &str, spoil: impl FnOnce(&Path)) {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path());
    spoil(folder.path());
    let error = FakenectFolder::open(folder.path()).unwrap_err();
    assert_sentence(&error);
    assert!(error.to_string().contains(reason), "{error} / {reason}");
}

#[test]
fn recordings_that_would_harm_the_player_are_refused() {
    let depth = "d-1290000000.066000-2000000.pgm";
    let color = "r-1290000000.020000-0.ppm";
    let tilt = "a-1290000000.000000-7.dump";
    let resize = |folder: &Path, name: &str, n_bytes: u64| {
        let file = fs::OpenOptions::new()
            .write(true)
            .open(folder.join(name))
            .unwrap();
        file.set_len(n_bytes).unwrap();
    };
    check_refusal("could not read", |folder| {
        fs::remove_file(folder.join(depth)).unwrap();
    });
    check_refusal("614416 bytes", |folder| resize(folder, depth, 614_416));
    check_refusal("must have 921615", |folder| resize(folder, color, 921_616));
    check_refusal("must have 12", |folder| resize(folder, tilt, 11));
    check_refusal("P6 640 480 255", |folder| {
        fs::write(folder.join(color), vec![b'P'; 921_615]).unwrap();
    });
    check_refusal("P6 640 480 255", |folder| {
        fs::write(folder.join(color), b"P6").unwrap();
    });
    check_refusal("not a regular file", |folder| {
        fs::remove_file(folder.join(depth)).unwrap();
        fs::create_dir(folder.join(depth)).unwrap();
    });
    check_refusal("no depth frame", |folder| {
        fs::write(folder.join("INDEX.txt"), color).unwrap();
    });
}

#[test]
fn a_wrong_index_is_refused_with_its_line() {
    let good = "d-1290000000.5-1.pgm";
    for wrong in [
        "",
        "\n",
        "d-1290000000.5-1.pgm\r",
        "../d-1290000000.5-1.pgm",
        "d-1290000000.5-1.ppm",
        "x-1290000000.5-1.pgm",
        "d-1290000000.5-4294967296.pgm",
        "d-1290000000.5-+1.pgm",
        "d-99999999999.5-1.pgm",
        "d--1.5-1.pgm",
        "d-nan-1.pgm",
        "d-1290000000.5-1-2.pgm",
        "d-1290000000.0000000000-1.pgm",
        "d-1290000000.-1.pgm",
        "d-1290000060.6-1.pgm",
        "d-1290000000.5-\u{661}.pgm",
    ] {
        let error = parse_index(format!("{good}\n{wrong}\n{good}\n").as_bytes()).unwrap_err();
        assert_sentence(&error);
        assert!(matches!(error, Error::IndexLine { line: 2, .. }), "{error}");
    }
    assert!(parse_index(b"").is_err());
}

#[test]
fn frames_that_cannot_be_played_are_not_recorded() {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = FakenectWriter::create(folder.path()).unwrap();
    let depth = vec![2047; N_PIXELS];
    writer.write_depth(&depth, at(0), 1).unwrap();
    let mut wild = depth.clone();
    wild[N_PIXELS - 1] = 2048;
    for error in [
        writer.write_depth(&depth[1..], at(1), 2).unwrap_err(),
        writer.write_depth(&wild, at(1), 2).unwrap_err(),
        writer.write_color(&[0; 3], at(1), 2).unwrap_err(),
        writer.write_tilt(TILT, at(60_001), 2).unwrap_err(),
    ] {
        assert_sentence(&error);
    }
    assert_eq!(
        FakenectFolder::open(folder.path()).unwrap().entries().len(),
        1
    );
}

proptest! {
    #[test]
    fn names_are_read_as_written(
        frames in prop::collection::vec((0..3_usize, 0..60_000_000_u64, any::<u32>()), 1..20),
    ) {
        let kinds = [FrameKind::Depth, FrameKind::Color, FrameKind::Tilt];
        let frames: Vec<_> = frames
            .into_iter()
            .map(|(kind, micros, stamp)| (kinds[kind], START + Duration::from_micros(micros), stamp))
            .collect();
        let names = frames.iter().map(|(kind, time, stamp)| index::file_name(*kind, *time, *stamp) + "\n");
        let text: String = names.collect();
        let entries = parse_index(text.as_bytes()).unwrap();
        let read: Vec<_> = entries.iter().map(|entry| (entry.kind, entry.unix_time, entry.stamp)).collect();
        prop_assert_eq!(read, frames);
    }

    #[test]
    fn a_damaged_index_is_read_or_explained(corruption in corruption(), bytes in any::<Vec<u8>>()) {
        let index = b"d-1290000000.5-1.pgm\nr-1290000000.6-2.ppm\na-1290000000.6-2.dump\n";
        for index in [corruption.apply(index), bytes] {
            match parse_index(&index) {
                Ok(entries) => {
                    for entry in entries {
                        let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '.';
                        prop_assert!(entry.file_name.chars().all(is_plain));
                    }
                }
                Err(error) => assert_sentence(&error),
            }
        }
    }
}
