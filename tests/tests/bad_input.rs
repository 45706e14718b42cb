//! Invalid input: refused with a sentence and an exit code, while the daemon continues.

use crate::daemon::{Daemon, Sandbox, WATCHDOG, eventually, run_to_end, with_mounts};
use crate::skeleton::{id, wait_for_all};
use camera::synthetic::SyntheticTable;
use dataset::pcd;
use message::ProcessKind;
use point_cloud::Point;
use serde_json::{Value, json};
use std::ffi::OsStr;
use std::io::{Read, Write};
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::{FileTypeExt, symlink};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

const FAILURE: i32 = 1;
const USAGE: i32 = 2;
const NO_DAEMON: i32 = 3;
const REFUSED: i32 = 4;
const ALREADY_RUNNING: i32 = 6;

/// The synthetic table at a low rate, since several daemons share the cores.
const TABLE: [&str; 4] = ["--source", "synthetic:0", "--rate", "10"];

/// Asserts that `tabula run` ends with this exit code and a sentence with these words,
/// and leaves nothing behind.
fn check_refused_start(sandbox: &Sandbox, arguments: &[&str], code: i32, words: &[&str]) {
    let output = run_to_end(
        sandbox.command("tabula").arg("run").args(arguments),
        WATCHDOG,
    );
    let sentence = String::from_utf8(output.stderr).unwrap();
    assert_eq!(
        output.status.code(),
        Some(code),
        "{arguments:?}: {sentence}"
    );
    for word in words {
        assert!(
            sentence.contains(word),
            "{arguments:?}: no {word:?} in {sentence}"
        );
    }
    assert!(!sentence.contains("panicked"), "{arguments:?}: {sentence}");
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(
        !printed.contains("tabula is running"),
        "{arguments:?}: {printed}"
    );
    eventually("all processes have ended", || sandbox.is_deserted());
    assert_eq!(sandbox.shared_memory_files(), Vec::<String>::new());
}

/// One scene of the synthetic table as a PCD file.
pub(crate) fn good_scene() -> Vec<u8> {
    let table = SyntheticTable::new(0);
    let camera = table.camera();
    let (width, height) = (camera.width as usize, camera.height as usize);
    let mut points = vec![Point::default(); width * height];
    table.fill(0, &mut points);
    scene(&points, width, height)
}

fn scene(points: &[Point], width: usize, height: usize) -> Vec<u8> {
    let viewpoint = SyntheticTable::new(0).world_from_camera();
    let view = pcd::PcdView {
        points,
        labels: None,
        width,
        height,
        viewpoint,
    };
    pcd::write(view, pcd::Encoding::BinaryCompressed).unwrap()
}

/// Malformed PCD files, by name.
fn hostile_scenes() -> Vec<(&'static str, Vec<u8>)> {
    let good = good_scene();
    let truncated = good[..good.len() / 2].to_vec();
    let header_only = good[..good.len().min(200)].to_vec();
    let text = |width: &str, height: &str, points: &str, data: &str| {
        let header = format!(
            "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {width}\n\
             HEIGHT {height}\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {points}\nDATA {data}\n"
        );
        header.into_bytes()
    };
    let unorganised = scene(&vec![Point::default(); 5000], 5000, 1);
    vec![
        ("b-truncated.pcd", truncated),
        ("c-cut-header.pcd", header_only),
        (
            "d-huge.pcd",
            text("4294967295", "4294967295", "18446744065119617025", "binary"),
        ),
        (
            "e-overflow.pcd",
            text("18446744073709551616", "2", "4", "ascii"),
        ),
        ("f-negative.pcd", text("-640", "-480", "307200", "binary")),
        (
            "g-large.pcd",
            text("100000", "100000", "10000000000", "binary_compressed"),
        ),
        (
            "h-garbage.pcd",
            (0..5000u32)
                .map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8)
                .collect(),
        ),
        ("i-unorganised.pcd", unorganised),
        ("j-empty.pcd", Vec::new()),
        ("k-no-numbers.pcd", text("4", "2", "8", "ascii")),
    ]
}

#[test]
fn unusable_sources_are_refused_at_the_start() {
    let sandbox = Sandbox::new();
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let check = |name: &str, words: &[&str]| {
        let source = path(name);
        for arguments in [&["--check-config"][..], &[]] {
            let arguments = [&["--source", &source], arguments].concat();
            check_refused_start(&sandbox, &arguments, USAGE, words);
        }
    };
    check("missing", &["missing"]);
    std::fs::create_dir(path("empty")).unwrap();
    check("empty", &["empty"]);
    std::fs::write(path("file"), "text").unwrap();
    check("file", &["is not a folder"]);
    std::fs::create_dir(path("other")).unwrap();
    std::fs::write(path("other/readme.txt"), "text").unwrap();
    check("other", &["other"]);
    std::fs::create_dir(path("truncated")).unwrap();
    let good = good_scene();
    std::fs::write(path("truncated/scene.pcd"), &good[..good.len() / 2]).unwrap();
    check("truncated", &["none of the 1 frames", "scene.pcd"]);
    std::fs::create_dir(path("one")).unwrap();
    std::fs::write(path("one/scene.pcd"), &good).unwrap();
    let from_behind = ["--source", &path("one"), "--from", "1"];
    check_refused_start(&sandbox, &from_behind, USAGE, &["1 frames"]);
    let fakenect = format!("fakenect:{}", path("missing"));
    check_refused_start(&sandbox, &["--source", &fakenect], USAGE, &["missing"]);
}

#[test]
fn hostile_scenes_are_skipped_and_the_others_are_played() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for name in ["a-good.pcd", "z-good.pcd"] {
        std::fs::write(path(name), good_scene()).unwrap();
    }
    let mut names = vec!["l-pipe.pcd", "m-endless.pcd", "n-nowhere.pcd"];
    for (name, bytes) in &hostile_scenes() {
        std::fs::write(path(name), bytes).unwrap();
        names.push(name);
    }
    let fifo = Command::new("mkfifo")
        .arg(path("l-pipe.pcd"))
        .status()
        .unwrap();
    assert!(fifo.success());
    symlink("/dev/zero", path("m-endless.pcd")).unwrap();
    symlink("nowhere", path("n-nowhere.pcd")).unwrap();

    let sandbox = Sandbox::new();
    let source = folder.path().to_str().unwrap();
    let daemon = sandbox.start(&["--source", source, "--loop", "--rate", "20"]);
    wait_for_all(&daemon, 0);
    let camera = daemon.pid(ProcessKind::CAMERA).unwrap();
    let count = |what: &str| -> u64 {
        daemon
            .health("camera")
            .and_then(|health| health[what].as_u64())
            .unwrap_or(0)
    };
    eventually("the folder is played twice", || count("frames") >= 4);
    assert!(count("frames_dropped") >= names.len() as u64);
    let log = daemon.log();
    for name in names {
        let reported = log.lines().find(|line| line.contains(name));
        let reported = reported.unwrap_or_else(|| panic!("{name} is not in the log:\n{log}"));
        assert!(reported.contains("is left out: "), "{reported}");
    }
    assert_eq!(
        daemon.pid(ProcessKind::CAMERA),
        Some(camera),
        "the camera was not restarted"
    );
    daemon.stop();
}

/// Depth image of 4 x 3 pixels, 1 m everywhere.
const DEPTH_PNG: &[u8] = b"\x89\x50\x4e\x47\x0d\x0a\x1a\x0a\x00\x00\x00\x0d\x49\x48\x44\x52\
    \x00\x00\x00\x04\x00\x00\x00\x03\x10\x00\x00\x00\x00\xc1\x0f\x2d\x59\x00\x00\x00\x0f\x49\
    \x44\x41\x54\x78\xda\x63\x60\x7e\x01\x81\x0c\x18\x0c\x00\x8f\x73\x0b\x05\x2c\xe8\x5b\x85\
    \x00\x00\x00\x00\x49\x45\x4e\x44\xae\x42\x60\x82";

#[test]
fn intrinsics_that_are_invalid_are_refused_with_their_file() {
    let sandbox = Sandbox::new();
    let folder = tempfile::tempdir().unwrap();
    let intrinsics = folder.path().join("camera-intrinsics.txt");
    std::fs::write(folder.path().join("frame-000000.depth.png"), DEPTH_PNG).unwrap();
    std::fs::write(folder.path().join("frame-000000.color.jpg"), "no image").unwrap();
    let arguments = ["--source", folder.path().to_str().unwrap()];
    let check = || check_refused_start(&sandbox, &arguments, USAGE, &["camera-intrinsics.txt"]);
    check();
    for wrong in [
        "",
        "a camera",
        "585 0 320 0 585 240 0 0",
        "585 0 320 0 585 240 0 0 1 1",
        "-585 0 2 0 585 1.5 0 0 1",
        "0 0 2 0 0 1.5 0 0 1",
        "NaN 0 2 0 585 1.5 0 0 1",
        "inf 0 2 0 585 1.5 0 0 1",
        "585 3 2 0 585 1.5 0 0 1",
        "585 0 2 0 585 1.5 0 0 7",
    ] {
        std::fs::write(&intrinsics, wrong).unwrap();
        check();
    }
    // With a right one it is the image that is wrong, and all of them are.
    std::fs::write(&intrinsics, "5 0 2 0 5 1.5 0 0 1").unwrap();
    check_refused_start(&sandbox, &arguments, USAGE, &["frame-000000"]);
}

#[test]
fn configuration_errors_are_refused_with_their_key() {
    let sandbox = Sandbox::new();
    let path = sandbox.home().join("tabula.toml");
    let check = |text: &str, word: &str| {
        std::fs::write(&path, text).unwrap();
        for arguments in [&[][..], &["--check-config"]] {
            check_refused_start(&sandbox, arguments, USAGE, &[word, "tabula.toml"]);
        }
    };
    check("[camera]\nraet_hz = 5.0", "raet_hz");
    check("[perception]\nworker = 2", "worker");
    check("[memory]\nqueue = 2", "queue");
    check("[kamera]\nrate_hz = 5.0", "[kamera]");
    check("rate_hz = 5.0", "rate_hz");
    check("[camera]\nsource = \"synthetic:x\"", "synthetic");
    check("[camera]\nrate_hz = \"fast\"", "rate_hz");
    check("[perception]\nworkers = 0", "workers");
    check("[perception]\nworkers = -1", "workers");
    check(
        "[perception]\nknown_probability_min = nan",
        "known_probability_min",
    );
    check("[perception]\nrange_min_m = nan", "range_min_m");
    check("[perception]\nactor_deadline_ms = 0", "actor_deadline_ms");
    check("[memory]\nqueue_requests = 0", "queue_requests");
    check("[camera", "TOML");
    check("\u{0}", "TOML");
    std::fs::write(&path, [0xff, 0xfe]).unwrap();
    check_refused_start(&sandbox, &[], USAGE, &["tabula.toml"]);
    let elsewhere = ["--config", "/nowhere/tabula.toml"];
    check_refused_start(&sandbox, &elsewhere, USAGE, &["/nowhere/tabula.toml"]);
}

#[test]
fn option_values_out_of_range_are_refused_with_their_rule() {
    let sandbox = Sandbox::new();
    let check = |arguments: &[&str], word: &str| {
        check_refused_start(&sandbox, arguments, USAGE, &[word]);
        let checked = [arguments, &["--check-config"]].concat();
        check_refused_start(&sandbox, &checked, USAGE, &[word]);
    };
    for rate in ["0", "-1", "NaN", "inf", "1e9", "fast", ""] {
        check(&["--rate", rate], "--rate");
    }
    let synthetic = |options: &[&str], word: &str| {
        check(&[&["--source", "synthetic"], options].concat(), word);
    };
    synthetic(&["--from", "5", "--to", "5"], "plays nothing");
    synthetic(&["--from", "5", "--to", "2"], "plays nothing");
    synthetic(&["--to", "0"], "plays nothing");
    synthetic(&["--from", "-1"], "--from");
    for (option, value) in [("--rate", "5"), ("--from", "1"), ("--to", "2")] {
        check(&["--source", "fakenect:/nowhere", option, value], option);
        check(&["--source", "kinect", option, value], option);
    }
    check(&["--source", ""], "source");
    check(&["--source", "synthetic:-1"], "synthetic");
    check(&["--source", "fakenect"], "fakenect:FOLDER");
    check(&["--domain", "../else"], "a-z");
    check(&["--domain", ""], "--domain");
    check(&["--unknown"], "--unknown");
}

#[test]
fn check_config_accepts_a_valid_configuration_and_creates_nothing() {
    let sandbox = Sandbox::new();
    std::fs::write(
        sandbox.home().join("tabula.toml"),
        "[camera]\nrate_hz = 5.0\n",
    )
    .unwrap();
    let output = sandbox.tabula(&["run", "--check-config"]);
    assert!(output.status.success(), "{output:?}");
    assert!(
        String::from_utf8(output.stdout)
            .unwrap()
            .contains("in order")
    );
    assert_eq!(sandbox.shared_memory_files(), Vec::<String>::new());
    assert!(!sandbox.run_folder().domain_folder(&sandbox.domain).exists());
    let files: Vec<_> = std::fs::read_dir(sandbox.home()).unwrap().collect();
    assert_eq!(files.len(), 1, "only the configuration: {files:?}");
}

#[test]
fn second_daemon_in_the_domain_is_refused_and_the_first_is_undisturbed() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    let objects = wait_for_all(&daemon, 0);
    daemon.ask(&["teach", &id(&objects[0]), "thing"]);
    let before = daemon.pids();
    for _ in 0..3 {
        let mut second = sandbox.command("tabula");
        second.args(["run", "--json"]).args(TABLE);
        let output = run_to_end(&mut second, WATCHDOG);
        let sentence = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(ALREADY_RUNNING), "{sentence}");
        assert!(sentence.contains("is running in the domain"), "{sentence}");
        assert!(sentence.contains("--domain NAME"), "{sentence}");
        // Scripts take the first document for the start.
        let printed: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(printed["exit_code"], json!(ALREADY_RUNNING), "{printed}");
    }
    assert_eq!(daemon.pids(), before);
    let expected = daemon.ask(&["status"])["expected"].clone();
    assert_eq!(expected.as_array().map(Vec::len), Some(4), "{expected}");
    let later = wait_for_all(&daemon, 0);
    assert_eq!(ids(&later), ids(&objects), "the tracks go on");
    assert_eq!(
        daemon.ask(&["categories"])["categories"][0]["category"],
        "thing"
    );
    daemon.stop();
}

fn ids(objects: &[Value]) -> Vec<String> {
    objects.iter().map(id).collect()
}

/// Asserts that a command is refused with this exit code and a sentence with this word.
fn check_refused(daemon: &Daemon<'_>, arguments: &[&str], code: i32, word: &str) {
    let (given, sentence) = daemon.refused(arguments);
    assert_eq!(given, code, "{arguments:?}: {sentence}");
    assert!(
        sentence.contains(word),
        "{arguments:?}: no {word:?} in {sentence}"
    );
}

#[test]
fn category_names_that_are_invalid_are_refused_and_change_nothing() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    let track = id(&wait_for_all(&daemon, 0)[0]);
    let long = "x".repeat(300);
    let very_long = "x".repeat(100_000);
    for label in [
        "",
        " ",
        "mu\u{7}g",
        "two\nlines",
        "\u{1b}[2J",
        &long,
        &very_long,
    ] {
        for verb in ["teach", "correct"] {
            check_refused(&daemon, &[verb, &track, label], REFUSED, "tabula: ");
        }
        check_refused(&daemon, &["forget", label], REFUSED, "tabula: ");
    }
    let by_whom = ["teach", &track, "mug", "--author", &very_long];
    check_refused(&daemon, &by_whom, REFUSED, "author");
    let not_text = OsStr::from_bytes(b"\xff\xfe");
    let mut teach = sandbox.command("tabula");
    let output = teach
        .args(["teach", &track])
        .arg(not_text)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(USAGE), "{output:?}");
    let nothing = json!({"categories": []});
    assert_eq!(daemon.ask(&["categories"]), nothing, "nothing was learned");
    daemon.stop();
}

#[test]
fn requests_for_unknown_tracks_are_refused_and_change_nothing() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    let track = id(&wait_for_all(&daemon, 0)[0]);
    let largest = u64::MAX.to_string();
    for verb in ["teach", "correct"] {
        for unknown in ["999999", &largest] {
            let sentence = format!("there is no track {unknown}; the tracks are");
            check_refused(&daemon, &[verb, unknown, "mug"], REFUSED, &sentence);
        }
        let too_large = "18446744073709551616";
        check_refused(&daemon, &[verb, too_large, "mug"], USAGE, too_large);
        check_refused(&daemon, &[verb, "-1", "mug"], USAGE, "-1");
        check_refused(&daemon, &[verb, "three", "mug"], REFUSED, "track-id");
        check_refused(&daemon, &[verb, &track], USAGE, "CATEGORY");
    }
    check_refused(
        &daemon,
        &["ask", "999999"],
        REFUSED,
        "there is no track 999999",
    );
    check_refused(&daemon, &["forget", "unicorn"], REFUSED, "unicorn");
    let nothing = json!({"categories": []});
    assert_eq!(daemon.ask(&["categories"]), nothing, "nothing was learned");

    daemon.ask(&["teach", &track, "mug"]);
    check_refused(&daemon, &["teach", &track, "bowl"], REFUSED, "mug");
    assert_eq!(
        daemon.ask(&["categories"])["categories"][0]["category"],
        "mug"
    );
    daemon.stop();
}

#[test]
fn output_under_the_name_of_a_pipe_or_link_is_refused_and_the_name_stays() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    wait_for_all(&daemon, 0);
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let made = Command::new("mkfifo").arg(path("pipe")).status();
    assert!(made.unwrap().success());
    symlink("nowhere", path("link")).unwrap();
    for (name, word) in [("pipe", "named pipe"), ("link", "symbolic link to nowhere")] {
        let target = path(name);
        let target = target.to_str().unwrap();
        check_refused(&daemon, &["memory", "export", target], USAGE, word);
        let model = ["model", "export", "none", "--out", target];
        check_refused(&daemon, &model, USAGE, word);
        check_refused(&daemon, &["view", "plan", "--picture", target], USAGE, word);
    }
    let kind = |name| path(name).symlink_metadata().unwrap().file_type();
    assert!(kind("pipe").is_fifo() && kind("link").is_symlink());
    assert_eq!(folder.path().read_dir().unwrap().count(), 2);
    daemon.stop();
}

#[test]
fn commands_without_a_daemon_tell_how_to_start_one() {
    let sandbox = Sandbox::new();
    for arguments in [
        &["objects"][..],
        &["objects", "--watch"],
        &["ask", "1"],
        &["teach", "1", "mug"],
        &["correct", "1", "mug"],
        &["forget", "mug"],
        &["categories"],
        &["status"],
    ] {
        let output = run_to_end(sandbox.command("tabula").args(arguments), WATCHDOG);
        let sentence = String::from_utf8(output.stderr).unwrap();
        assert_eq!(
            output.status.code(),
            Some(NO_DAEMON),
            "{arguments:?}: {sentence}"
        );
        let domain = &sandbox.domain;
        let expected = format!(
            "no daemon is running in the domain \"{domain}\"; start it with: tabula run --domain {domain}"
        );
        assert!(sentence.contains(&expected), "{arguments:?}: {sentence}");
    }
    let output = sandbox
        .command("tabula")
        .env_remove("TABULA_DOMAIN")
        .arg("--help")
        .output()
        .unwrap();
    assert!(output.status.success());
}

/// Request in the socket's framing: length, little-endian, then CBOR.
pub(crate) fn framed(body: &[u8]) -> Vec<u8> {
    let mut message = (body.len() as u32).to_le_bytes().to_vec();
    message.extend_from_slice(body);
    message
}

/// Protocol version that the daemon speaks.
const OURS: u8 = control_protocol::PROTOCOL_VERSION as u8;

/// CBOR of `{"protocol": version, "command": …}`, version below 24.
fn request(version: u8, command: &[u8]) -> Vec<u8> {
    [b"\xa2\x68protocol", &[version][..], b"\x67command", command].concat()
}

/// Sends bytes and returns the answer until either side closes the connection.
fn say(socket: &Path, bytes: &[u8]) -> Vec<u8> {
    let mut stream = UnixStream::connect(socket).unwrap();
    stream.set_read_timeout(Some(WATCHDOG)).unwrap();
    // The daemon may hang up before it has read everything.
    let _ = stream.write_all(bytes);
    let _ = stream.shutdown(std::net::Shutdown::Write);
    let mut answer = Vec::new();
    let _ = stream.read_to_end(&mut answer);
    answer
}

#[test]
fn control_socket_survives_hostile_bytes() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    let objects = wait_for_all(&daemon, 0);
    daemon.ask(&["teach", &id(&objects[0]), "thing"]);
    let before = daemon.pids();
    let socket = sandbox.run_folder().control_socket(&sandbox.domain);
    let is_refused = |bytes: &[u8], word: &str| {
        let answer = say(&socket, bytes);
        let text = String::from_utf8_lossy(&answer);
        assert!(
            text.contains("refused") && text.contains(word),
            "no {word:?} in {text}"
        );
    };
    let health = b"\x66health";
    assert!(
        String::from_utf8_lossy(&say(&socket, &framed(&request(OURS, health)))).contains("camera")
    );

    is_refused(&framed(&request(9, health)), "protocol version 9");
    is_refused(&framed(b""), "not understood");
    is_refused(&framed(&[0xff; 1000]), "not understood");
    is_refused(&framed(&request(OURS, b"\x67unknown")), "not understood");
    // Depth, and lengths that are not there.
    is_refused(&framed(&vec![0x81; 500_000]), "not understood");
    is_refused(
        &framed(b"\x7b\xff\xff\xff\xff\xff\xff\xff\xff"),
        "not understood",
    );
    is_refused(
        &framed(b"\x9b\x7f\xff\xff\xff\xff\xff\xff\xff"),
        "not understood",
    );
    is_refused(&u32::MAX.to_le_bytes(), "at most");
    // Commands that only the daemon's own processes may send.
    let snapshot = b"\xa1\x68snapshot\xa1\x65after\xf6";
    is_refused(&framed(&request(OURS, snapshot)), "own processes");
    // Cut off in the middle: no answer, and no harm.
    assert_eq!(say(&socket, &[1]), b"");
    assert_eq!(say(&socket, &framed(&request(OURS, health))[..9]), b"");

    // Silent connections, and one that asks and never listens.
    let _silent: Vec<_> = (0..20)
        .map(|_| UnixStream::connect(&socket).unwrap())
        .collect();
    let mut deaf = UnixStream::connect(&socket).unwrap();
    deaf.set_write_timeout(Some(Duration::from_millis(200)))
        .unwrap();
    let many = framed(&request(OURS, health)).repeat(100);
    while deaf.write_all(&many).is_ok() {}

    assert_eq!(daemon.pids(), before);
    assert_eq!(ids(&wait_for_all(&daemon, 0)), ids(&objects));
    assert_eq!(
        daemon.ask(&["categories"])["categories"][0]["category"],
        "thing"
    );
    daemon.stop();
}

/// Needs root: the daemon runs with other mounts.
#[test]
#[ignore = "needs root"]
fn as_root_shared_memory_that_is_too_small_is_refused_with_a_sentence() {
    let sandbox = Sandbox::new();
    for mounts in [
        "mount -t tmpfs -o size=16m tmpfs /dev/shm",
        "mount -t tmpfs -o size=300m tmpfs /dev/shm && fallocate -l 290M /dev/shm/full",
    ] {
        let mut command = with_mounts(sandbox.command("tabula").arg("run").args(TABLE), mounts);
        let output = run_to_end(&mut command, WATCHDOG);
        let sentence = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(FAILURE), "{mounts}: {sentence}");
        for word in ["shared memory", "MB of /dev/shm are free", "--shm-size"] {
            assert!(
                sentence.contains(word),
                "{mounts}: no {word:?} in {sentence}"
            );
        }
        assert!(sandbox.is_deserted());
    }
}
