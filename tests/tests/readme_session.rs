//! Session of the README: its commands run as they are written, and begin their answers with the
//! words that stand there.

use crate::daemon::{Sandbox, WATCHDOG, program, wait_for_end};
use crate::language::root;
use rustix::process::{Pid, Signal, kill_process};
use std::process::{Command, Stdio};
use std::time::Duration;

/// Commands that go on until Ctrl-C, by how they begin.
const UNTIL_CTRL_C: [&str; 2] = ["tabula objects --watch", "tabula model build"];
/// Time until a test presses Ctrl-C.
const BEFORE_CTRL_C: Duration = Duration::from_secs(5);
/// Number of words of an answer that are compared, numbers apart.
const N_COMPARED: usize = 3;

/// Command of a session and the first line of its answer; empty without one.
pub(crate) struct SessionStep {
    pub(crate) command: String,
    pub(crate) answer: String,
}

/// Steps of the README's session, in order.
fn steps() -> Vec<SessionStep> {
    let readme = std::fs::read_to_string(root().join("README.md")).unwrap();
    let session = readme.split_once("## Five minutes").unwrap().1;
    let session = session.split_once("\n## ").unwrap().0;
    let blocks = session.split("```\n").skip(1).step_by(2);
    let mut steps = Vec::new();
    for block in blocks {
        for step in block.split("$ ").skip(1) {
            let (command, answer) = step.split_once('\n').unwrap();
            steps.push(SessionStep {
                command: command.to_owned(),
                answer: answer.lines().next().unwrap_or_default().to_owned(),
            });
        }
    }
    steps
}

/// First words of a line, with a mark in place of each number.
pub(crate) fn beginning(line: &str) -> Vec<String> {
    let is_number = |word: &str| word.contains(|letter: char| letter.is_ascii_digit());
    let words = line.split_whitespace().take(N_COMPARED);
    words
        .map(|word| if is_number(word) { "#" } else { word }.to_owned())
        .collect()
}

/// Shell command with the programs in its path, in the folder of the sandbox.
pub(crate) fn shell(sandbox: &Sandbox, command: &str) -> Command {
    let programs = program("tabula").parent().unwrap().display().to_string();
    let path = std::env::var("PATH").unwrap_or_default();
    let mut shell = Command::new("sh");
    // Without a shell between, so that Ctrl-C reaches the command.
    shell.args(["-c", &format!("exec {command}")]);
    for (name, value) in sandbox.command("tabula").get_envs() {
        match value {
            Some(value) => shell.env(name, value),
            None => shell.env_remove(name),
        };
    }
    shell
        .env("PATH", format!("{programs}:{path}"))
        .current_dir(sandbox.home())
        .stdin(Stdio::null());
    shell
}

/// Runs a step, and compares the beginning of its answer.
fn run(sandbox: &Sandbox, step: &SessionStep) {
    let SessionStep { command, answer } = step;
    let out = sandbox.home().join("answer.txt");
    let file = std::fs::File::create(&out).unwrap();
    let mut shell = shell(sandbox, command);
    shell.stderr(file.try_clone().unwrap()).stdout(file);
    let mut child = shell.spawn().unwrap();
    if UNTIL_CTRL_C
        .iter()
        .any(|goes_on| command.starts_with(goes_on))
    {
        std::thread::sleep(BEFORE_CTRL_C);
        let pid = Pid::from_raw(i32::try_from(child.id()).unwrap()).unwrap();
        kill_process(pid, Signal::INT).unwrap();
    }
    let status = wait_for_end(&mut child, WATCHDOG);
    let said = std::fs::read_to_string(&out).unwrap();
    let status = status.unwrap_or_else(|| panic!("{command} does not end: {said}"));
    let is_interrupted = command.starts_with("tabula objects --watch");
    assert!(
        status.success() || is_interrupted,
        "{command}: {status}: {said}"
    );
    let first = said.lines().next().unwrap_or_default();
    if !answer.is_empty() {
        assert_eq!(beginning(first), beginning(answer), "{command}: {said}");
    }
}

#[test]
fn session_of_the_readme_runs_as_it_is_written() {
    let mut steps = steps();
    assert!(steps.len() > 20, "{} steps", steps.len());
    let start = steps.remove(0);
    assert_eq!(start.command, "scripts/run");
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&[]);
    daemon.wait_for("five objects", |objects| objects.len() >= 5);
    for step in &steps {
        run(&sandbox, step);
    }
    daemon.stop();
}
