//! Integration test of the wrapper against a test double that simulates rare faults of a Kinect.

#![expect(unsafe_code, reason = "the library under test is one of our own")]

use freenect::{Error, Kinect, Library, LibraryKind, LogLevel, PairingStatistics, Selector};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

const SHORT: Duration = Duration::from_millis(20);

/// Test double, which `cargo test` builds as an example next to this test.
fn double() -> Arc<Library> {
    let this_test = std::env::current_exe().expect("a test has a file");
    let profile = this_test
        .parent()
        .and_then(|deps| deps.parent())
        .expect("target/profile/deps");
    let file: PathBuf = profile.join("examples/libsensor_double.so");
    assert!(
        file.exists(),
        "{} is missing: build it with --examples",
        file.display()
    );
    // SAFETY: the double has the functions of libfreenect 0.5.
    let library = unsafe { Library::load_from(&file, LibraryKind::Real) };
    Arc::new(library.expect("the double loads"))
}

fn open(serial: &str) -> Result<Kinect, Error> {
    Kinect::open(double(), &Selector::Serial(serial.to_owned()))
}

/// Number with which the double filled a whole pair of images.
fn number_of(kinect: &mut Kinect) -> u16 {
    let frame = kinect
        .next_frame(SHORT)
        .expect("no error")
        .expect("a frame");
    let number = frame.depth.pixels[0];
    assert_eq!(
        (frame.depth.pixels.len(), frame.video.pixels.len()),
        (640 * 480, 3 * 640 * 480)
    );
    assert!(frame.depth.pixels.iter().all(|pixel| *pixel == number));
    assert!(
        frame
            .video
            .pixels
            .iter()
            .all(|pixel| *pixel == number as u8)
    );
    assert_eq!(
        frame.depth.stamp_ticks,
        u32::from(number).wrapping_mul(2_000_000)
    );
    assert_eq!(
        frame.video.stamp_ticks,
        frame.depth.stamp_ticks.wrapping_add(100_000)
    );
    assert!(frame.depth.arrived <= frame.video.arrived);
    number
}

#[test]
fn pairs_arrive_once_and_whole_across_the_clock_wrap() {
    let mut kinect = open("steady").unwrap();
    // The stamp wraps after 2147 frames.
    for expected in 1..=2500 {
        assert_eq!(number_of(&mut kinect), expected);
    }
    assert_eq!(
        kinect.statistics(),
        PairingStatistics {
            n_pairs: 2500,
            ..PairingStatistics::default()
        }
    );
}

#[test]
fn camera_unplugged_is_gone_and_can_be_reopened() {
    for _ in 0..3 {
        let mut kinect = open("unplugged").unwrap();
        for expected in 1..=3 {
            assert_eq!(number_of(&mut kinect), expected);
        }
        for _ in 0..2 {
            let error = kinect.next_frame(SHORT).unwrap_err();
            assert!(matches!(error, Error::Gone { code: -1, .. }), "{error}");
            assert!(
                error
                    .to_string()
                    .contains("it says: USB camera marked dead"),
                "{error}"
            );
        }
    }
}

#[test]
fn signal_loses_no_frame() {
    let mut kinect = open("interrupted").unwrap();
    for expected in 1..=4 {
        assert_eq!(number_of(&mut kinect), expected);
    }
}

#[test]
fn pairs_superseded_by_newer_ones_are_counted() {
    let mut kinect = open("burst").unwrap();
    assert_eq!(number_of(&mut kinect), 3);
    assert_eq!(number_of(&mut kinect), 6);
    assert_eq!(
        (
            kinect.statistics().n_pairs,
            kinect.statistics().n_superseded
        ),
        (6, 4)
    );
}

#[test]
fn depth_without_colour_is_counted_but_not_returned() {
    let mut kinect = open("colourless").unwrap();
    assert!(kinect.next_frame(SHORT).unwrap().is_none());
    let statistics = kinect.statistics();
    assert_eq!(statistics.n_pairs, 0);
    assert!(statistics.n_unpaired_depth > 0);
}

#[test]
fn camera_without_frames_times_out() {
    let mut kinect = open("silent").unwrap();
    assert!(kinect.next_frame(Duration::ZERO).unwrap().is_none());
    assert!(kinect.next_frame(SHORT).unwrap().is_none());
}

#[test]
fn frames_in_foreign_memory_are_refused() {
    let mut kinect = open("misplaced").unwrap();
    let error = kinect.next_frame(SHORT).unwrap_err();
    assert!(matches!(error, Error::Misbehaved), "{error}");
}

#[test]
fn stream_start_failure_closes_the_camera() {
    let error = open("no video").unwrap_err().to_string();
    assert!(error.contains("freenect_start_video failed"), "{error}");
    assert!(error.contains("send_cmd failed"), "{error}");
}

#[test]
fn camera_not_found_lists_those_present() {
    let error = open("A00364").unwrap_err().to_string();
    for part in [
        "serial A00364",
        "Could not open camera: -3",
        "steady, silent",
        "USB",
    ] {
        assert!(error.contains(part), "{error}");
    }
    let error = Kinect::open(double(), &Selector::Index(3))
        .unwrap_err()
        .to_string();
    assert!(error.contains("index 3"), "{error}");
    assert!(open("a\0b").is_err());
}

#[test]
fn accelerometer_is_read_if_present() {
    let mut kinect = open("steady").unwrap();
    let reading = kinect.acceleration().unwrap().unwrap();
    assert_eq!(
        (reading.x_mps2, reading.y_mps2, reading.z_mps2),
        (0.0, 9.80665, -9.80665)
    );
    let mut kinect = open("no motor").unwrap();
    assert_eq!(kinect.acceleration().unwrap(), None);
    let said = kinect.take_messages();
    assert_eq!(said[0].level, LogLevel::Error);
    assert_eq!(number_of(&mut kinect), 1);
}

#[test]
fn accelerometer_reading_keeps_a_frame_that_arrives() {
    let mut kinect = open("frame during tilt").unwrap();
    kinect.acceleration().unwrap();
    assert_eq!(number_of(&mut kinect), 1);
}

#[test]
fn colour_automatics_can_be_switched() {
    assert!(open("steady").unwrap().set_automatic_colors(false).unwrap());
    assert!(open("silent").unwrap().set_automatic_colors(false).is_err());
}

#[test]
fn cameras_on_one_and_two_threads_are_independent() {
    let mut first = open("steady").unwrap();
    let mut second = open("burst").unwrap();
    assert_eq!((number_of(&mut first), number_of(&mut second)), (1, 3));
    drop(first);
    let other = std::thread::spawn(|| number_of(&mut open("steady").unwrap()));
    assert_eq!((number_of(&mut second), other.join().unwrap()), (6, 1));
}
