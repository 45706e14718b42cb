//! Integration test of the wrapper with Debian's fakenect playing a generated folder.
//!
//! Fakenect may end its process and takes its folder from the environment, so each test plays in
//! a child: this test program, restarted for the one test, in which [`play_in_child`] runs the
//! test's body.

use freenect::{
    Error, FOLDER_VARIABLE, Kinect, Library, LibraryKind, N_PIXELS, Selector, check_recording,
};
use std::fmt::Write as _;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::time::{Duration, Instant};
use std::{env, fs, thread};

/// Environment variable that marks the child process.
const CHILD_VARIABLE: &str = "FREENECT_TEST_CHILD";
/// Output of a child whose body has completed.
const CHILD_DONE: &str = "the child is done";
/// Time-out after which a child counts as hung.
const WATCHDOG: Duration = Duration::from_secs(60);
const TIMEOUT: Duration = Duration::from_secs(5);

/// Depth of pixel `i` of frame `n`: all 11-bit patterns occur.
fn depth_value(n: usize, i: usize) -> u16 {
    ((i * 7 + n * 13) % 2048) as u16
}

/// Colour byte `i` of frame `n`: all byte values occur, including line ends.
fn video_value(n: usize, i: usize) -> u8 {
    (i + n * 31) as u8
}

/// Recording of `n` pairs, 40 ms apart, each followed by an accelerometer reading.
struct Folder {
    folder: tempfile::TempDir,
    index: String,
}

impl Folder {
    fn new(n_pairs: usize) -> Self {
        let mut new = Self {
            folder: tempfile::tempdir().expect("a temporary folder"),
            index: String::new(),
        };
        for n in 0..n_pairs {
            let seconds = 1_300_000_000.0 + n as f64 * 0.04;
            // The counter wraps within the recording.
            let stamp = (u32::MAX - 1_000_000).wrapping_add(n as u32 * 2_400_000);
            new.add_pair(n, seconds, stamp);
        }
        fs::write(new.path().join("INDEX.txt"), &new.index).expect("the index is written");
        new
    }

    fn add_pair(&mut self, n: usize, seconds: f64, stamp: u32) {
        let mut depth = b"P5 640 480 65535\n".to_vec();
        depth.extend((0..N_PIXELS).flat_map(|i| depth_value(n, i).to_le_bytes()));
        self.add(&format!("d-{seconds:.6}-{stamp}.pgm"), &depth);
        let mut video = b"P6 640 480 255\n".to_vec();
        video.extend((0..3 * N_PIXELS).map(|i| video_value(n, i)));
        let (seconds, stamp) = (seconds + 0.005, stamp.wrapping_add(300_000));
        self.add(&format!("r-{seconds:.6}-{stamp}.ppm"), &video);
        let tilt: Vec<u8> = [n as i16, 819, -5]
            .iter()
            .flat_map(|v| v.to_le_bytes())
            .collect();
        let tilt = [tilt.as_slice(), &[0; 6]].concat();
        self.add(&format!("a-{seconds:.6}-{stamp}.dump"), &tilt);
    }

    fn add(&mut self, name: &str, bytes: &[u8]) {
        fs::write(self.path().join(name), bytes).expect("a file is written");
        writeln!(self.index, "{name}").expect("a string takes any text");
    }

    fn path(&self) -> &Path {
        self.folder.path()
    }
}

/// Runs `body` in a child process with `folder` in its environment. In the child, where the same
/// test is entered again, only the body runs.
#[expect(
    clippy::print_stdout,
    reason = "how the child tells that it came to its end"
)]
fn play_in_child(test: &str, folder: impl FnOnce() -> Option<Folder>, body: fn()) {
    if env::var_os(CHILD_VARIABLE).is_some() {
        body();
        println!("{CHILD_DONE}");
        return;
    }
    let folder = folder();
    let mut command = Command::new(env::current_exe().expect("a test has a file"));
    command.args(["--exact", test, "--include-ignored", "--nocapture"]);
    command
        .env(CHILD_VARIABLE, "1")
        .env_remove(FOLDER_VARIABLE)
        .stdout(Stdio::piped());
    if let Some(folder) = &folder {
        command.env(FOLDER_VARIABLE, folder.path());
    }
    let output = output_of(command.spawn().expect("the test starts again"));
    assert!(
        output.contains(CHILD_DONE),
        "the child of {test} ended early:\n{output}"
    );
}

/// Standard output of a child process, which is killed when it exceeds [`WATCHDOG`].
fn output_of(mut child: Child) -> String {
    let start = Instant::now();
    while child.try_wait().expect("the child is ours").is_none() {
        if start.elapsed() > WATCHDOG {
            child.kill().expect("the child is ours");
        }
        thread::sleep(Duration::from_millis(5));
    }
    String::from_utf8_lossy(&child.wait_with_output().expect("output is text").stdout).into_owned()
}

fn load() -> Arc<Library> {
    Arc::new(Library::load(LibraryKind::Fake).expect("fakenect is installed"))
}

fn open() -> Kinect {
    Kinect::open(load(), &Selector::Index(0)).expect("fakenect opens")
}

/// Checks that the next pair is number `n` of the recording, byte by byte.
fn check_pair(kinect: &mut Kinect, n: usize) {
    let frame = kinect
        .next_frame(TIMEOUT)
        .expect("no error")
        .expect("a pair");
    assert!(
        frame
            .depth
            .pixels
            .iter()
            .enumerate()
            .all(|(i, v)| *v == depth_value(n, i))
    );
    assert!(
        frame
            .video
            .pixels
            .iter()
            .enumerate()
            .all(|(i, v)| *v == video_value(n, i))
    );
    let stamp = (u32::MAX - 1_000_000).wrapping_add(n as u32 * 2_400_000);
    assert_eq!(frame.depth.stamp_ticks, stamp);
    assert_eq!(frame.video.stamp_ticks, stamp.wrapping_add(300_000));
}

#[test]
#[ignore = "needs libfreenect0.5"]
fn recording_plays_byte_for_byte_and_ends() {
    play_in_child(
        "recording_plays_byte_for_byte_and_ends",
        || Some(Folder::new(5)),
        || {
            let mut kinect = open();
            assert_eq!(kinect.acceleration().unwrap(), None);
            for n in 0..5 {
                check_pair(&mut kinect, n);
            }
            for _ in 0..2 {
                assert!(matches!(kinect.next_frame(TIMEOUT), Err(Error::Ended)));
            }
            let reading = kinect
                .acceleration()
                .unwrap()
                .expect("readings were played");
            assert!((reading.x_mps2 - 4.0 / 819.0 * 9.80665).abs() < 1e-12);
            assert_eq!(kinect.statistics().n_pairs, 5);
        },
    );
}

#[test]
#[ignore = "needs libfreenect0.5"]
fn recording_plays_no_faster_than_recorded() {
    play_in_child(
        "recording_plays_no_faster_than_recorded",
        || Some(Folder::new(4)),
        || {
            let mut kinect = open();
            check_pair(&mut kinect, 0);
            let start = Instant::now();
            for n in 1..4 {
                check_pair(&mut kinect, n);
            }
            // Three steps of 40 ms, less the rounding of fakenect's clock.
            assert!(
                start.elapsed() > Duration::from_millis(115),
                "{:?}",
                start.elapsed()
            );
        },
    );
}

#[test]
#[ignore = "needs libfreenect0.5"]
fn recording_restarts_when_the_library_is_reloaded() {
    play_in_child(
        "recording_restarts_when_the_library_is_reloaded",
        || Some(Folder::new(2)),
        || {
            let library = load();
            let mut kinect = Kinect::open(Arc::clone(&library), &Selector::Index(0)).unwrap();
            check_pair(&mut kinect, 0);
            drop(kinect);
            // The same library continues at its position, and stays at the end.
            let mut kinect = Kinect::open(library, &Selector::Index(0)).unwrap();
            check_pair(&mut kinect, 1);
            assert!(matches!(kinect.next_frame(TIMEOUT), Err(Error::Ended)));
            drop(kinect);
            for _ in 0..3 {
                let mut kinect = open();
                check_pair(&mut kinect, 0);
                check_pair(&mut kinect, 1);
                assert!(matches!(kinect.next_frame(TIMEOUT), Err(Error::Ended)));
            }
        },
    );
}

#[test]
#[ignore = "needs libfreenect0.5"]
fn recording_with_a_fault_never_reaches_the_library() {
    let folder = || {
        let folder = Folder::new(2);
        let name = folder.index.lines().nth(3).unwrap();
        fs::remove_file(folder.path().join(name)).unwrap();
        Some(folder)
    };
    play_in_child(
        "recording_with_a_fault_never_reaches_the_library",
        folder,
        || {
            let error = Kinect::open(load(), &Selector::Index(0)).unwrap_err();
            assert!(matches!(error, Error::Recording(_)), "{error}");
            assert!(error.to_string().contains(".pgm cannot be read"), "{error}");
        },
    );
}

#[test]
#[ignore = "needs libfreenect0.5"]
fn recording_missing_in_the_environment_is_an_error() {
    play_in_child(
        "recording_missing_in_the_environment_is_an_error",
        || None,
        || {
            let error = Kinect::open(load(), &Selector::Index(0)).unwrap_err();
            assert!(matches!(error, Error::NoRecording), "{error}");
        },
    );
}

#[test]
#[ignore = "needs libfreenect0.5"]
fn recording_playback_is_exclusive() {
    play_in_child(
        "recording_playback_is_exclusive",
        || Some(Folder::new(1)),
        || {
            let first = open();
            let error = Kinect::open(load(), &Selector::Index(0)).unwrap_err();
            assert!(matches!(error, Error::FakeInUse), "{error}");
            drop(first);
            check_pair(&mut open(), 0);
        },
    );
}

#[test]
#[ignore = "needs libfreenect0.5"]
fn library_kinds_are_distinguished_in_one_process() {
    play_in_child(
        "library_kinds_are_distinguished_in_one_process",
        || None,
        || {
            let has =
                |library: &Library, symbol| library.optional_symbols().contains(&(symbol, true));
            let fake = Library::load(LibraryKind::Fake).unwrap();
            let real = Library::load(LibraryKind::Real).unwrap();
            assert!(has(&real, "freenect_set_flag") && !has(&fake, "freenect_set_flag"));
            for library in [&fake, &real] {
                assert_eq!(library.version(), Some("0.5.3"), "{library:?}");
            }
            assert_ne!(fake.file(), real.file());
        },
    );
}

#[test]
#[ignore = "needs libfreenect0.5"]
fn library_without_a_kinect_names_the_remedy() {
    play_in_child(
        "library_without_a_kinect_names_the_remedy",
        || None,
        || {
            for _ in 0..20 {
                let library = Arc::new(Library::load(LibraryKind::Real).unwrap());
                match Kinect::open(library, &Selector::Index(0)) {
                    // A machine with a Kinect is fine, too.
                    Ok(_) => {}
                    Err(error) => {
                        let sentence = error.to_string();
                        assert!(sentence.contains("USB"), "{sentence}");
                        assert!(!matches!(error, Error::LibraryMissing { .. }), "{sentence}");
                    }
                }
            }
        },
    );
}

#[test]
fn recording_generated_by_the_tests_is_valid() {
    let summary = check_recording(Folder::new(3).path()).unwrap();
    assert_eq!(
        (summary.n_depth, summary.n_video, summary.n_acceleration),
        (3, 3, 3)
    );
    assert!(
        (summary.duration.as_secs_f64() - 0.085).abs() < 1e-5,
        "{summary:?}"
    );
}
