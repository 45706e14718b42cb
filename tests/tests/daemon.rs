//! Test sandbox: a daemon with its own domain, home and run folder, checked for leftovers
//! at the end.

use channel::{Domain, DomainName, DomainState, Role, RunFolder};
use message::ProcessKind;
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use std::io::{BufRead, BufReader, ErrorKind, Seek, Write};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::UnixDatagram;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, ExitStatus, Output, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, LazyLock};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Watchdog time limit: a test that hangs fails after it. No test depends on speed.
pub(crate) const WATCHDOG: Duration = Duration::from_secs(180);
const POLL_PERIOD: Duration = Duration::from_millis(20);

/// Example that drives an arm which is not there.
const ARM_SKELETON: &str = "arm_skeleton";

/// Folder of the programs, built once for all tests.
static PROGRAMS: LazyLock<PathBuf> = LazyLock::new(|| {
    let test = std::env::current_exe().unwrap();
    let folder = test.parent().unwrap().parent().unwrap().to_owned();
    once_a_run(&folder, "programs", || {
        build(&folder, &["--bins", "--example", ARM_SKELETON]);
    });
    folder
});

/// Folder of the programs with fault injection in perception (`fault_panic_every_ms`).
/// Hard links, since a program looks for the others in its own folder.
pub(crate) static FAULTY_PROGRAMS: LazyLock<PathBuf> = LazyLock::new(|| {
    const FAULTY: &str = "tabula-perception-faulty";
    let folder = PROGRAMS.join("with-faulty-perception");
    once_a_run(&PROGRAMS, "faulty-programs", || {
        let feature = "perception/fault-injection";
        build(&PROGRAMS, &["--features", feature, "--bin", FAULTY]);
        std::fs::create_dir_all(&folder).unwrap();
        for (from, to) in [
            ("tabula", "tabula"),
            ("tabula-gateway", "tabula-gateway"),
            ("tabula-camera", "tabula-camera"),
            ("tabula-memory", "tabula-memory"),
            // `tabula run` checks the configuration of the process that does not run, too.
            ("tabula-simulator", "tabula-simulator"),
            (FAULTY, "tabula-perception"),
        ] {
            let link = folder.join(to);
            let _ = std::fs::remove_file(&link);
            std::fs::hard_link(PROGRAMS.join(from), link).unwrap();
        }
    });
    folder
});

/// Builds programs into a folder of the target folder, with the features that they have for the
/// tests, so that no crate is compiled twice.
fn build(folder: &Path, selection: &[&str]) {
    let mut build = Command::new(env!("CARGO"));
    build.args(["build", "--workspace", "--quiet", "--test", "daemon"]);
    build.args(selection);
    if folder.ends_with("release") {
        build.arg("--release");
    }
    let status = build.status().unwrap();
    assert!(status.success(), "{selection:?} could not be built");
}

/// Runs a step once for all test processes of a run of cargo-nextest, which starts a process for
/// each test, and once a process otherwise.
fn once_a_run(folder: &Path, name: &str, step: impl FnOnce()) {
    let Ok(run) = std::env::var("NEXTEST_RUN_ID") else {
        return step();
    };
    let mut done = std::fs::File::options()
        .create(true)
        .truncate(false)
        .read(true)
        .write(true)
        .open(folder.join(format!(".{name}-of-test-run")))
        .unwrap();
    done.lock().unwrap();
    if std::io::read_to_string(&done).unwrap() != run {
        step();
        done.set_len(0).unwrap();
        done.rewind().unwrap();
        done.write_all(run.as_bytes()).unwrap();
    }
}

/// Processes of a daemon with a camera, in the order of their start.
pub(crate) const WITH_CAMERA: [ProcessKind; 4] = [
    ProcessKind::GATEWAY,
    ProcessKind::MEMORY,
    ProcessKind::PERCEPTION,
    ProcessKind::CAMERA,
];

/// Path of the example that drives an arm.
pub(crate) fn arm_skeleton() -> PathBuf {
    PROGRAMS.join("examples").join(ARM_SKELETON)
}

/// Path of a built program.
pub(crate) fn program(name: &str) -> PathBuf {
    PROGRAMS.join(name)
}

static N_PLACES: AtomicU32 = AtomicU32::new(0);

/// Domain, home and run folder of one test. Outlives the daemons in it.
pub(crate) struct Sandbox {
    pub(crate) domain: DomainName,
    runtime_dir: Arc<TempDir>,
    home: TempDir,
    programs: PathBuf,
    /// Folder of programs of this sandbox only, removed with it.
    own_programs_guard: Option<TempDir>,
    /// Shell commands that mount what the daemon sees differently.
    mounts: Option<String>,
}

/// Child process that is killed on drop.
pub(crate) struct KilledOnDrop(pub(crate) Child);

impl Drop for KilledOnDrop {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Sandbox {
    pub(crate) fn new() -> Self {
        let number = N_PLACES.fetch_add(1, Ordering::Relaxed);
        Self {
            domain: format!("it-{}-{number}", std::process::id())
                .parse()
                .unwrap(),
            runtime_dir: Arc::new(tempfile::tempdir_in("/dev/shm").unwrap()),
            home: tempfile::tempdir().unwrap(),
            programs: PROGRAMS.clone(),
            own_programs_guard: None,
            mounts: None,
        }
    }

    /// Sandbox in which a shell script stands in for a program of the daemon. In the script `$0`
    /// is its own path, and `$REAL` that of the program. It is asked to check its arguments with
    /// `--check-config` before it is started.
    pub(crate) fn with_script(process: ProcessKind, script: &str) -> Self {
        let folder = tempfile::tempdir_in(&*PROGRAMS).unwrap();
        let name = "tabula";
        // `tabula` looks for the others in its own folder, where no symbolic link leads.
        std::fs::hard_link(PROGRAMS.join(name), folder.path().join(name)).unwrap();
        for other in ProcessKind::all().filter(|other| *other != process) {
            let name = other.program();
            std::os::unix::fs::symlink(PROGRAMS.join(&name), folder.path().join(&name)).unwrap();
        }
        let path = folder.path().join(process.program());
        let real = PROGRAMS.join(process.program());
        let text = format!("#!/bin/sh\nREAL='{}'\n{script}\n", real.display());
        std::fs::write(&path, text).unwrap();
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
        let mut sandbox = Self::new();
        folder.path().clone_into(&mut sandbox.programs);
        sandbox.own_programs_guard = Some(folder);
        sandbox
    }

    /// Writes the configuration file of the daemons in this sandbox.
    pub(crate) fn configure(&self, toml: &str) {
        std::fs::write(self.home().join("tabula.toml"), toml).unwrap();
    }

    /// Sandbox for daemons with fault injection.
    pub(crate) fn with_faulty_perception() -> Self {
        let mut sandbox = Self::new();
        sandbox.programs = FAULTY_PROGRAMS.clone();
        sandbox
    }

    /// Sandbox whose daemons see a group `tabula` with this id, and whose run folder others may
    /// enter. Needs root.
    pub(crate) fn with_group(group: u32) -> Self {
        let mut sandbox = Self::new();
        sandbox.open_to_all();
        let known = std::fs::read_to_string("/etc/group").unwrap();
        let others = known.lines().filter(|line| !line.starts_with("tabula"));
        let others: Vec<_> = others.collect();
        let groups = sandbox.home().join("group");
        std::fs::write(
            &groups,
            format!("{}\ntabula:x:{group}:\n", others.join("\n")),
        )
        .unwrap();
        sandbox.mounts = Some(format!("mount --bind {} /etc/group", groups.display()));
        sandbox
    }

    /// Sandbox whose daemons have their data folder on a small disk of its own. Needs root.
    pub(crate) fn on_own_disk(configuration: &str) -> Self {
        Self::new().with_own_disk(96, configuration)
    }

    /// This sandbox with a disk of `size_mb` for the home folder, and its configuration file.
    pub(crate) fn with_own_disk(mut self, size_mb: u32, configuration: &str) -> Self {
        self.configure(configuration);
        let home = self.home().display().to_string();
        let file = self.home().join("tabula.toml");
        let kept = self.runtime_dir.path().join("tabula.toml");
        std::fs::copy(&file, &kept).unwrap();
        self.mounts = Some(format!(
            "mount -t tmpfs -o size={size_mb}m none {home} && cp {} {}",
            kept.display(),
            file.display()
        ));
        self
    }

    /// Another domain in the same run folder; its name has this one's as a prefix.
    pub(crate) fn neighbour(&self) -> Self {
        Self {
            domain: format!("{}-b", self.domain).parse().unwrap(),
            runtime_dir: self.runtime_dir.clone(),
            home: tempfile::tempdir().unwrap(),
            programs: self.programs.clone(),
            own_programs_guard: None,
            mounts: None,
        }
    }

    /// Permits other accounts to enter the run folder, as `/run` does.
    pub(crate) fn open_to_all(&self) {
        let mode = std::fs::Permissions::from_mode(0o755);
        std::fs::set_permissions(self.runtime_dir.path(), mode).unwrap();
    }

    pub(crate) fn home(&self) -> &Path {
        self.home.path()
    }

    /// File on memory-backed storage that test and daemon share.
    pub(crate) fn shared_file(&self, name: &str) -> PathBuf {
        self.runtime_dir.path().join(name)
    }

    /// Run folder of the daemons in this sandbox.
    pub(crate) fn run_folder(&self) -> RunFolder {
        RunFolder::at(self.runtime_dir.path().join("tabula"))
    }

    /// Program with the environment of this sandbox.
    pub(crate) fn command(&self, name: &str) -> Command {
        let mut command = Command::new(self.programs.join(name));
        command
            .env("XDG_RUNTIME_DIR", self.runtime_dir.path())
            .env("TABULA_DOMAIN", self.domain.to_string())
            .env("TABULA_HOME", self.home.path())
            .env_remove("RUST_LOG")
            .stdin(Stdio::null());
        command
    }

    /// Starts a program of the daemon alone, without `tabula run`; its log is that of the sandbox.
    pub(crate) fn start_program(&self, name: &str) -> KilledOnDrop {
        let log = std::fs::File::options()
            .create(true)
            .append(true)
            .open(self.log())
            .unwrap();
        let mut command = self.command(name);
        command.stdout(Stdio::null()).stderr(log);
        KilledOnDrop(command.spawn().unwrap())
    }

    /// Runs `tabula` with arguments to its end.
    pub(crate) fn tabula(&self, arguments: &[&str]) -> Output {
        self.command("tabula").args(arguments).output().unwrap()
    }

    /// Files of the domain in shared memory.
    pub(crate) fn shared_memory_files(&self) -> Vec<String> {
        let prefix = format!(
            "tabula_{}_{}_",
            rustix::process::getuid().as_raw(),
            self.domain
        );
        std::fs::read_dir("/dev/shm")
            .unwrap()
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .filter(|name| name.starts_with(&prefix))
            .collect()
    }

    /// Ids of the living processes of this domain.
    pub(crate) fn processes(&self) -> Vec<u32> {
        let argument = format!("--domain={}", self.domain);
        let is_ours = |pid: &u32| {
            let words = std::fs::read(format!("/proc/{pid}/cmdline")).unwrap_or_default();
            words
                .split(|byte| *byte == 0)
                .any(|word| word == argument.as_bytes())
        };
        let all = std::fs::read_dir("/proc").unwrap();
        all.filter_map(|entry| entry.unwrap().file_name().to_str()?.parse().ok())
            .filter(is_ours)
            .collect()
    }

    /// True if no process is left. A process that is being killed has no command line any
    /// more, and holds its locks a little longer.
    pub(crate) fn is_deserted(&self) -> bool {
        let state = DomainState::inspect(&self.domain, &self.run_folder());
        self.processes().is_empty() && !state.is_alive && state.running.is_empty()
    }

    /// Log file of the daemons in this sandbox.
    pub(crate) fn log(&self) -> PathBuf {
        self.home.path().join("log.txt")
    }

    /// Starts `tabula run` without waiting for readiness.
    pub(crate) fn launch(&self, arguments: &[&str]) -> Child {
        let log = std::fs::File::options()
            .create(true)
            .append(true)
            .open(self.log())
            .unwrap();
        let mut command = self.command("tabula");
        command.args(["run", "--json"]).args(arguments);
        if let Some(mounts) = &self.mounts {
            command = with_mounts(&command, mounts);
        }
        command.stdout(Stdio::piped()).stderr(log).spawn().unwrap()
    }

    /// Starts the daemon and waits until it reports that it runs.
    pub(crate) fn start(&self, arguments: &[&str]) -> Daemon<'_> {
        let log = self.log();
        let mut child = self.launch(arguments);
        let mut stdout = BufReader::new(child.stdout.take().unwrap());
        let mut line = String::new();
        stdout.read_line(&mut line).unwrap();
        let started = serde_json::from_str(&line).unwrap_or_else(|_| {
            panic!(
                "the daemon did not start; its log:\n{}",
                std::fs::read_to_string(&log).unwrap()
            )
        });
        Daemon {
            sandbox: self,
            child,
            _stdout: stdout,
            started,
            log,
            is_stopped: false,
        }
    }
}

impl Drop for Sandbox {
    /// Removes the shared memory of killed processes, as the only member of the domain.
    fn drop(&mut self) {
        if !self.shared_memory_files().is_empty() {
            let _ = Domain::join(&self.domain, &self.run_folder(), Role::Guest);
        }
    }
}

/// Running daemon in a sandbox.
pub(crate) struct Daemon<'a> {
    pub(crate) sandbox: &'a Sandbox,
    child: Child,
    _stdout: BufReader<ChildStdout>,
    /// Start document of `tabula run --json`.
    pub(crate) started: Value,
    log: PathBuf,
    is_stopped: bool,
}

impl Daemon<'_> {
    /// JSON document of `tabula --json` with arguments.
    pub(crate) fn ask(&self, arguments: &[&str]) -> Value {
        let output = self.sandbox.tabula(&[&["--json"], arguments].concat());
        assert!(output.status.success(), "{arguments:?}: {output:?}");
        serde_json::from_slice(&output.stdout).unwrap()
    }

    /// Exit code and sentence of `tabula` with arguments that must be refused.
    pub(crate) fn refused(&self, arguments: &[&str]) -> (i32, String) {
        let output = self.sandbox.tabula(arguments);
        assert!(!output.status.success(), "{arguments:?}: {output:?}");
        (
            output.status.code().unwrap(),
            String::from_utf8(output.stderr).unwrap(),
        )
    }

    /// Tracked objects as JSON documents.
    pub(crate) fn objects(&self) -> Vec<Value> {
        self.ask(&["objects"])["objects"]
            .as_array()
            .unwrap()
            .clone()
    }

    /// Waits for a condition on the objects, and returns them.
    pub(crate) fn wait_for(&self, what: &str, is_so: impl Fn(&[Value]) -> bool) -> Vec<Value> {
        let deadline = Instant::now() + WATCHDOG;
        loop {
            let objects = self.sandbox.tabula(&["objects", "--json"]);
            let objects: Value = serde_json::from_slice(&objects.stdout).unwrap_or_default();
            let objects = objects["objects"].as_array().cloned().unwrap_or_default();
            if is_so(&objects) {
                return objects;
            }
            assert!(
                Instant::now() < deadline,
                "timed out waiting: {what}; {objects:#?}\n{}",
                self.log()
            );
            std::thread::sleep(POLL_PERIOD);
        }
    }

    /// Changes in the history of the memory, without the views that perception stores by itself
    /// whenever it confirms a track.
    pub(crate) fn changes(&self) -> Vec<Value> {
        let history = self.ask(&["memory", "history"]);
        let entries = history["entries"].as_array().unwrap();
        let is_asked_for = |entry: &&Value| entry["operation"] != "store_views";
        entries.iter().filter(is_asked_for).cloned().collect()
    }

    /// Health document of a process.
    pub(crate) fn health(&self, process: &str) -> Option<Value> {
        let output = self.sandbox.tabula(&["status", "--json"]);
        let document: Value = serde_json::from_slice(&output.stdout).ok()?;
        let processes = document["processes"].as_array()?;
        processes
            .iter()
            .find(|report| report["process"] == process)
            .cloned()
    }

    /// Process id in the newest health report.
    pub(crate) fn pid(&self, process: ProcessKind) -> Option<u32> {
        u32::try_from(self.health(process.word())?["pid"].as_u64()?).ok()
    }

    /// Process ids; the same before and after when nothing was restarted.
    pub(crate) fn pids(&self) -> Vec<Option<u32>> {
        let mut pids = Vec::new();
        eventually("all processes report", || {
            pids = WITH_CAMERA.map(|process| self.pid(process)).to_vec();
            pids.iter().all(Option::is_some)
        });
        pids
    }

    /// Sends a signal to one of the daemon's processes.
    pub(crate) fn signal(&self, process: ProcessKind, signal: Signal) {
        let pid = self.pid(process).expect("the process reports its id");
        send_signal(pid, signal).unwrap();
    }

    /// Process id of `tabula run`.
    pub(crate) fn parent_id(&self) -> u32 {
        self.child.id()
    }

    /// Log text of the daemon.
    pub(crate) fn log(&self) -> String {
        std::fs::read_to_string(&self.log).unwrap_or_default()
    }

    /// Stops the daemon with SIGINT, as Ctrl-C does, and asserts that nothing is left:
    /// processes, shared memory, run folder.
    pub(crate) fn stop(mut self) {
        self.signal_parent(Signal::INT);
        let status = self.wait(WATCHDOG);
        assert!(status.success(), "{status}\n{}", self.log());
        self.is_stopped = true;
        let left = self.sandbox.shared_memory_files();
        assert!(left.is_empty(), "left in shared memory: {left:?}");
        let folder = self
            .sandbox
            .run_folder()
            .domain_folder(&self.sandbox.domain);
        assert!(!folder.exists(), "the run folder is left");
        let alive = self.sandbox.processes();
        assert!(alive.is_empty(), "processes are left: {alive:?}");
    }

    /// Waits until `tabula run` has ended by itself, and returns its exit status.
    pub(crate) fn wait(&mut self, watchdog: Duration) -> ExitStatus {
        let status = wait_for_end(&mut self.child, watchdog);
        self.is_stopped = status.is_some();
        status.unwrap_or_else(|| panic!("the daemon does not stop\n{}", self.log()))
    }

    /// Sends a signal to `tabula run` itself.
    pub(crate) fn signal_parent(&self, signal: Signal) {
        send_signal(self.child.id(), signal).unwrap();
    }
}

impl Drop for Daemon<'_> {
    /// Stops the daemon of a failed test; the children follow their parent.
    fn drop(&mut self) {
        if !self.is_stopped {
            self.signal_parent(Signal::TERM);
            let deadline = Instant::now() + WATCHDOG;
            while self.child.try_wait().unwrap().is_none() {
                if Instant::now() > deadline {
                    let _ = self.child.kill();
                }
                std::thread::sleep(POLL_PERIOD);
            }
        }
    }
}

/// Next notification at a socket in the place of systemd's: lines of assignments. A read with a time
/// limit is interrupted when a signal comes, such as that of a child's end.
pub(crate) fn notification(socket: &UnixDatagram) -> String {
    let mut bytes = [0; 4096];
    loop {
        match socket.recv(&mut bytes) {
            Ok(n_bytes) => return String::from_utf8(bytes[..n_bytes].to_vec()).unwrap(),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => panic!("a notification: {error}"),
        }
    }
}

/// Waits until a process has ended; `None` when it has not.
pub(crate) fn wait_for_end(child: &mut Child, watchdog: Duration) -> Option<ExitStatus> {
    let deadline = Instant::now() + watchdog;
    while Instant::now() < deadline {
        if let Some(status) = child.try_wait().unwrap() {
            return Some(status);
        }
        std::thread::sleep(POLL_PERIOD);
    }
    None
}

/// Runs a command to its end; one that does not end is stopped and fails the test.
pub(crate) fn run_to_end(command: &mut Command, watchdog: Duration) -> Output {
    let child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let pid = Pid::from_child(&child);
    let (sender, ended) = std::sync::mpsc::channel();
    std::thread::spawn(move || sender.send(child.wait_with_output()));
    if let Ok(output) = ended.recv_timeout(watchdog) {
        return output.unwrap();
    }
    let _ = kill_process(pid, Signal::TERM);
    panic!("{command:?} does not end by itself");
}

/// Command in its own mount namespace with other mounts; `mounts` is a shell command.
/// Needs root.
pub(crate) fn with_mounts(command: &Command, mounts: &str) -> Command {
    let is_root = rustix::process::getuid().is_root();
    assert!(
        is_root,
        "this test must be run as root, or skipped with --skip as_root_"
    );
    let mut wrapped = Command::new("unshare");
    wrapped
        .args([
            "--mount",
            "sh",
            "-c",
            &format!("{mounts} && exec \"$@\""),
            "sh",
        ])
        .arg(command.get_program())
        .args(command.get_args())
        .stdin(Stdio::null());
    for (name, value) in command.get_envs() {
        match value {
            Some(value) => wrapped.env(name, value),
            None => wrapped.env_remove(name),
        };
    }
    wrapped
}

/// Sends a signal to a process.
///
/// # Errors
/// When the process has ended.
pub(crate) fn send_signal(pid: u32, signal: Signal) -> rustix::io::Result<()> {
    kill_process(Pid::from_raw(pid.cast_signed()).unwrap(), signal)
}

/// Suspends a process with SIGSTOP. Waits until all of its threads are stopped: on a busy
/// computer the others run on until one of them has received the signal.
pub(crate) fn suspend(pid: u32) {
    send_signal(pid, Signal::STOP).unwrap();
    let is_stopped = |stat: String| {
        let state = stat
            .rsplit_once(") ")
            .map(|(_, fields)| fields.as_bytes()[0]);
        matches!(state, Some(b'T' | b'Z'))
    };
    eventually("all threads are stopped", || {
        let threads = std::fs::read_dir(format!("/proc/{pid}/task")).unwrap();
        let stats =
            threads.map(|thread| std::fs::read_to_string(thread.unwrap().path().join("stat")));
        // A thread that has ended meanwhile has no file.
        stats.flatten().all(is_stopped)
    });
}

/// Polls until a condition holds, or the watchdog time is over.
pub(crate) fn eventually(what: &str, mut is_so: impl FnMut() -> bool) {
    let deadline = Instant::now() + WATCHDOG;
    while !is_so() {
        assert!(Instant::now() < deadline, "timed out waiting: {what}");
        std::thread::sleep(POLL_PERIOD);
    }
}

/// Object nearest to a position, metres; the objects must not be empty.
pub(crate) fn nearest(objects: &[Value], position_m: [f64; 3]) -> &Value {
    let distance2 = |object: &Value| -> f64 {
        let position = object["position_m"].as_array().unwrap();
        let axis = |i: usize| position[i].as_f64().unwrap() - position_m[i];
        (0..3).map(|i| axis(i) * axis(i)).sum()
    };
    let by_distance = |a: &&Value, b: &&Value| distance2(a).total_cmp(&distance2(b));
    objects
        .iter()
        .min_by(by_distance)
        .expect("there are objects")
}
