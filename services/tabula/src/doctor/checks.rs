//! Checks of `tabula doctor`: shared memory, descriptors, domain, processes, socket, depth
//! noise, disk, camera.

use super::{Finding, Severity, configuration, depth_noise, expected_processes};
use channel::topic::MAX_FRAME_POINTS;
use channel::{
    DomainState, GUEST_PLACES, RunFolder, SharedMemory, domain_bytes, domain_reservation,
    fitting_guest_places,
};
use control_protocol::request;
use daemon_client::{CallError, DaemonClient};
use freenect::{Library, LibraryKind, Presence};
use message::{Duty, ProcessKind};
use rustix::process::{Resource, getrlimit};
use scene_document::HealthDocument;
use service::{CommonArguments, Configuration, guest_places};
use std::path::Path;
use std::time::Duration;

/// Number of file descriptors needed by one process: about seven for each service it holds.
const DESCRIPTORS_NEEDED: u64 = 256;
/// Free bytes on the data disk below which a warning is given. Chosen.
const FREE_BYTES_MIN: u64 = 100_000_000;
/// Time limit of a connection to the daemon, and of each of its answers.
const DEADLINE: Duration = Duration::from_secs(2);

/// Health of the processes, or the error of asking for it; the outer error is that of connecting.
pub(super) type Asked = Result<Result<Vec<HealthDocument>, CallError>, CallError>;

/// Findings of all checks, in the order in which a new user meets the problems.
pub(crate) fn run_all(common: &CommonArguments) -> Vec<Finding> {
    let run_folder = RunFolder::of_user();
    let state = DomainState::inspect(&common.domain, &run_folder);
    let health = DaemonClient::connect(&common.domain, &RunFolder::candidates(), DEADLINE)
        .map(|mut client| client.ask(&request::health()));
    let places = guest_places_of(common);
    vec![
        shared_memory(common, places),
        reservations(places),
        descriptors(),
        domain(common, &run_folder, &state),
        crashed_run(&state),
        control_socket(&health, &state),
        expected_processes::finding(common, &health),
        configuration::finding(common),
        noise(common, &state),
        data_folder(common.home().path()),
        ports(),
        library("libfreenect", LibraryKind::Real),
        library("fakenect", LibraryKind::Fake),
        kinect(),
    ]
}

fn megabytes(bytes: u64) -> u64 {
    bytes.div_ceil(1_000_000)
}

fn shared_memory(common: &CommonArguments, places: u32) -> Finding {
    let name = "shared memory";
    let Some(state) = SharedMemory::of_domain(&common.domain, MAX_FRAME_POINTS, places) else {
        let sentence = "/dev/shm is not there; mount a tmpfs at /dev/shm";
        return Finding::new(name, Severity::Failure, sentence);
    };
    let (needed, available) = (megabytes(state.needed), state.available() / 1_000_000);
    let total = megabytes(state.total_bytes);
    if state.is_sufficient() {
        let sentence = format!(
            "the services will reserve up to {needed} MB with {places} places for guests; \
             {available} MB of {total} MB are free for them; {}",
            larger_images(places, state.available())
        );
        return Finding::new(name, Severity::Ok, sentence);
    }
    let sentence = format!(
        "the services will reserve up to {needed} MB and only {available} MB of {total} MB are free; \
         enlarge it (mount -o remount,size=512M /dev/shm; in a container --shm-size=512m){}",
        fitting_guest_places(MAX_FRAME_POINTS, places, state.available())
            .map_or_else(String::new, |fit| format!(
                "; {fit} places for guests would fit"
            ))
    );
    Finding::new(name, Severity::Failure, sentence)
}

/// Configured number of guest places; the default while the configuration is wrong.
fn guest_places_of(common: &CommonArguments) -> u32 {
    let found = Configuration::find(common.config.as_deref(), common.home().path());
    let places = found.and_then(|found| guest_places(&found));
    places.unwrap_or(GUEST_PLACES)
}

/// Need of cameras with larger images, and the number of guests that would fit beside each.
fn larger_images(places: u32, available: u64) -> String {
    let of_size = |(width, height): (usize, usize)| {
        let needed = megabytes(domain_bytes(width * height, places));
        let fit = match fitting_guest_places(width * height, places, available) {
            Some(fit) if fit == places => "free".to_owned(),
            Some(fit) => format!("{fit} guests would fit"),
            None => "too much".to_owned(),
        };
        format!("a camera of {width} x {height} needs {needed} MB ({fit})")
    };
    [(1280, 720), (1920, 1080)].map(of_size).join(", ")
}

fn reservations(places: u32) -> Finding {
    let mut all = domain_reservation(MAX_FRAME_POINTS, places);
    all.sort_by_key(|reservation| std::cmp::Reverse(reservation.bytes()));
    let largest: Vec<String> = all
        .iter()
        .take(4)
        .map(|r| {
            format!(
                "{} {} x {:.2} MB",
                r.service,
                r.slots,
                r.slot_bytes as f64 / 1e6
            )
        })
        .collect();
    Finding::new("largest services", Severity::Ok, largest.join(", "))
}

fn descriptors() -> Finding {
    let limit = getrlimit(Resource::Nofile);
    match limit.maximum {
        Some(most) if most < DESCRIPTORS_NEEDED => Finding::new(
            "open files",
            Severity::Failure,
            format!(
                "the hard limit is {most} and {DESCRIPTORS_NEEDED} are needed; raise it (ulimit -Hn)"
            ),
        ),
        most => Finding::new(
            "open files",
            Severity::Ok,
            format!(
                "the hard limit is {}; the processes raise their own soft limit to it",
                most.map_or("none".into(), |most| most.to_string())
            ),
        ),
    }
}

fn domain(common: &CommonArguments, run_folder: &RunFolder, state: &DomainState) -> Finding {
    let folder = run_folder.domain_folder(&common.domain);
    let sentence = match state.running.as_slice() {
        [] => format!(
            "nothing runs in the domain {} ({})",
            common.domain,
            folder.display()
        ),
        running => {
            let names: Vec<String> = running
                .iter()
                .map(|(role, pid)| pid.map_or(role.clone(), |pid| format!("{role} ({pid})")))
                .collect();
            format!("in the domain {} run {}", common.domain, names.join(", "))
        }
    };
    Finding::new("domain", Severity::Ok, sentence)
}

fn crashed_run(state: &DomainState) -> Finding {
    let name = "stale nodes";
    match state {
        DomainState {
            is_alive: false,
            n_files,
            ..
        } if *n_files > 0 => Finding::new(
            name,
            Severity::Warning,
            format!(
                "a crashed run has left {n_files} files in /dev/shm; the next start removes them"
            ),
        ),
        _ => Finding::new(name, Severity::Ok, "nothing is left of a crashed run"),
    }
}

fn control_socket(health: &Asked, state: &DomainState) -> Finding {
    let name = "control socket";
    match health {
        Ok(Ok(processes)) => all_processes(name, processes),
        Ok(Err(error)) => Finding::new(name, Severity::Failure, error.to_string()),
        Err(error) if state.is_alive => Finding::new(name, Severity::Warning, error.to_string()),
        Err(_) => Finding::new(name, Severity::Ok, "no daemon runs, so there is none"),
    }
}

/// Depth noise measured by a running daemon.
fn noise(common: &CommonArguments, state: &DomainState) -> Finding {
    let client = DaemonClient::connect(&common.domain, &RunFolder::candidates(), DEADLINE);
    match client.map(|mut client| client.ask(&request::depth_noise())) {
        Ok(Ok(report)) => depth_noise::finding(&report),
        Ok(Err(error)) => depth_noise::unknown(&error.to_string()),
        Err(error) if state.is_alive => depth_noise::unknown(&error.to_string()),
        Err(_) => depth_noise::without_daemon(),
    }
}

fn all_processes(name: &'static str, processes: &[HealthDocument]) -> Finding {
    let reports = |kind: ProcessKind| processes.iter().any(|one| one.process == kind.word());
    let has_driver = reports(ProcessKind::ARM);
    let has_arm = has_driver || reports(ProcessKind::SIMULATOR);
    // Either the camera or the simulator runs; a commander only where there is an arm.
    let is_expected = |process: &ProcessKind| {
        !process.has(Duty::Sensor)
            && (has_driver || !process.has(Duty::Driver))
            && (has_arm || !process.has(Duty::Commander))
    };
    let n_expected = ProcessKind::all().filter(is_expected).count() + 1;
    // One that was stopped a moment ago is still counted.
    let n_processes = processes.len().min(n_expected);
    let severity = if n_processes == n_expected {
        Severity::Ok
    } else {
        Severity::Warning
    };
    let sentence = format!("the daemon answers; {n_processes} of {n_expected} processes report");
    Finding::new(name, severity, sentence)
}

fn data_folder(folder: &Path) -> Finding {
    let name = "data folder";
    // The folder is created at the first start, so its nearest existing parent is checked.
    let Some(existing) = folder.ancestors().find(|path| path.exists()) else {
        let sentence = format!("{} has no existing parent", folder.display());
        return Finding::new(name, Severity::Failure, sentence);
    };
    if !existing.is_dir() {
        let sentence = format!(
            "{} is not a folder; choose another one with --home DIR",
            existing.display()
        );
        return Finding::new(name, Severity::Failure, sentence);
    }
    if rustix::fs::access(existing, rustix::fs::Access::WRITE_OK).is_err() {
        let sentence = format!(
            "{} cannot be written by this user; choose another one with --home DIR",
            existing.display()
        );
        return Finding::new(name, Severity::Failure, sentence);
    }
    let free = rustix::fs::statvfs(existing).map_or(0, |fs| fs.f_bavail * fs.f_frsize);
    let sentence = format!("{}, {} MB free", folder.display(), free / 1_000_000);
    let severity = if free < FREE_BYTES_MIN {
        Severity::Warning
    } else {
        Severity::Ok
    };
    Finding::new(name, severity, sentence)
}

fn ports() -> Finding {
    Finding::new(
        "ports",
        Severity::Ok,
        "the daemon listens on no network port, only on its socket",
    )
}

fn library(name: &'static str, kind: LibraryKind) -> Finding {
    match Library::load(kind) {
        Ok(library) => {
            let version = library.version().unwrap_or("unknown version");
            let missing: Vec<&str> = library
                .optional_symbols()
                .into_iter()
                .filter_map(|(symbol, is_there)| (!is_there).then_some(symbol))
                .collect();
            let without = match missing.as_slice() {
                [] => String::new(),
                missing => format!(", without {}", missing.join(", ")),
            };
            let file = library
                .file()
                .map_or("?".into(), |file| file.display().to_string());
            Finding::new(name, Severity::Ok, format!("{file}, {version}{without}"))
        }
        Err(error) => Finding::new(name, Severity::Warning, error.to_string()),
    }
}

fn kinect() -> Finding {
    let presence = Presence::scan();
    let severity = if presence.is_usable() {
        Severity::Ok
    } else {
        Severity::Warning
    };
    Finding::new("kinect", severity, presence.to_string())
}
