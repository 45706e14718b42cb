//! Commands in the code blocks of README and guides: each command exists, and has the options that
//! stand there. Those of the README's session run besides (`readme_session`), and of the guides'
//! those that are cheap and need neither a daemon nor hardware.

use crate::daemon::{Sandbox, WATCHDOG, program, run_to_end};
use crate::language::root;
use crate::readme_session::{SessionStep, beginning, shell};
use crate::skeleton::{id, wait_for_all};
use std::collections::HashMap;
use std::path::PathBuf;
use std::process::Command;

/// Greatest number of words that name a command, such as `memory export`.
const N_NAMES: usize = 2;
/// Commands of the guides that need neither a daemon nor hardware, in the order in which they run.
const WITHOUT_A_DAEMON: [&str; 12] = [
    "config check",
    "config explain range_max_m",
    "undo",
    "redo",
    "knowledge put where-cups-go shelf.txt",
    "memory history",
    "memory verify",
    "memory verify --json",
    "memory export anna.tabula",
    "objects --domain nobody",
    "simulate scene --kind pile --frames 10 --rate 2 --out sim/pile",
    "evaluate detection sim --out result --labels result/labels",
];

/// Texts of `tabula COMMAND --help` by the words of the command; `None` for no command.
#[derive(Default)]
struct Helps(HashMap<Vec<String>, Option<String>>);

impl Helps {
    fn of(&mut self, names: &[String]) -> Option<&str> {
        let help = self.0.entry(names.to_vec()).or_insert_with(|| {
            let mut tabula = Command::new(program("tabula"));
            let output = tabula.args(names).arg("--help").output().unwrap();
            let printed = String::from_utf8(output.stdout).unwrap();
            output.status.success().then_some(printed)
        });
        help.as_deref()
    }
}

/// Guides by path.
fn guides() -> Vec<(PathBuf, String)> {
    let entries = std::fs::read_dir(root().join("docs/guides")).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let guides = paths.filter(|path| path.extension().is_some_and(|kind| kind == "md"));
    guides.map(read).collect()
}

fn read(path: PathBuf) -> (PathBuf, String) {
    let text = std::fs::read_to_string(&path).unwrap();
    (path, text)
}

/// Commands in the code blocks of a document, with the first lines of their answers.
fn steps(text: &str) -> Vec<SessionStep> {
    let blocks = text.split("```").skip(1).step_by(2);
    blocks.flat_map(block_steps).collect()
}

/// Commands of a code block: the lines that begin with `$ `, the others being their answers;
/// without such lines all.
fn block_steps(block: &str) -> Vec<SessionStep> {
    let lines: Vec<&str> = block.lines().map(str::trim_start).collect();
    let is_session = lines.iter().any(|line| line.starts_with("$ "));
    let mut steps = Vec::new();
    for (index, line) in lines.iter().enumerate() {
        let Some(typed) = line.strip_prefix("$ ").or((!is_session).then_some(line)) else {
            continue;
        };
        let next = lines.get(index + 1).copied().unwrap_or_default();
        let is_answer = is_session && !next.starts_with("$ ");
        let parts = typed.split(['#', ';', '|', '&']).map(str::trim);
        let ours = parts.filter_map(|part| part.strip_prefix("tabula "));
        steps.extend(ours.map(|command| SessionStep {
            command: command.to_owned(),
            answer: if is_answer { next } else { "" }.to_owned(),
        }));
    }
    steps
}

/// True for a word that may name a command.
fn is_name(word: &str) -> bool {
    word.chars()
        .all(|letter| letter.is_ascii_lowercase() || letter == '-')
        && !word.starts_with('-')
}

/// Options of a command that its help does not have, or the command itself.
fn unknown_parts(helps: &mut Helps, command: &str) -> Vec<String> {
    let words: Vec<&str> = command.split_whitespace().collect();
    let named = words.iter().take_while(|word| is_name(word));
    let names: Vec<String> = named.take(N_NAMES).map(|&name| name.to_owned()).collect();
    let Some(help) = helps.of(&names) else {
        return vec![format!("tabula {}", names.join(" "))];
    };
    let options = words.iter().filter(|word| word.starts_with("--"));
    let options = options.filter_map(|option| option.split('=').next());
    options
        .filter(|option| !help.contains(option))
        .map(str::to_owned)
        .collect()
}

#[test]
fn documented_commands_exist_with_their_options() {
    let mut helps = Helps::default();
    let (mut n_commands, mut wrong) = (0, Vec::new());
    let readme = read(root().join("README.md"));
    for (document, text) in guides().into_iter().chain([readme]) {
        for SessionStep { command, .. } in steps(&text) {
            n_commands += 1;
            let unknown = unknown_parts(&mut helps, &command);
            if !unknown.is_empty() {
                wrong.push(format!(
                    "{}: tabula {command}: {unknown:?}",
                    document.display()
                ));
            }
        }
    }
    assert!(n_commands > 100, "{n_commands}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Makes what the commands read: a configuration, a file, and a memory with a renamed category.
fn prepare(sandbox: &Sandbox) {
    sandbox.configure("[perception]\nrange_max_m = 3.0\n");
    std::fs::write(sandbox.home().join("shelf.txt"), "cups go to the shelf").unwrap();
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    let objects = wait_for_all(&daemon, 0);
    daemon.ask(&["teach", &id(&objects[0]), "mug"]);
    daemon.ask(&["rename", "mug", "cup"]);
    daemon.stop();
}

/// Beginning of an answer: the first words, or of a JSON document the first key.
fn opening(line: &str) -> Vec<String> {
    match line.split_once(':') {
        Some((key, _)) if line.starts_with('{') => vec![key.to_owned()],
        _ => beginning(line),
    }
}

/// Runs a command, and compares the beginnings of its answer and of the documented ones; it must
/// be refused if these are refusals.
fn run_as_documented(sandbox: &Sandbox, command: &str, answers: &[&str]) {
    let output = run_to_end(&mut shell(sandbox, &format!("tabula {command}")), WATCHDOG);
    let is_refused = answers.iter().any(|answer| answer.starts_with("tabula: "));
    assert_eq!(
        output.status.success(),
        !is_refused,
        "{command}: {output:?}"
    );
    let said = if is_refused {
        output.stderr
    } else {
        output.stdout
    };
    let said = String::from_utf8(said).unwrap();
    let first = opening(said.lines().next().unwrap_or_default());
    for answer in answers.iter().filter(|answer| !answer.is_empty()) {
        assert_eq!(first, opening(answer), "{command}: {said}");
    }
}

#[test]
fn documented_commands_without_a_daemon_run() {
    let guides = guides();
    let documented: Vec<SessionStep> = guides.iter().flat_map(|(_, text)| steps(text)).collect();
    let sandbox = Sandbox::new();
    prepare(&sandbox);
    for command in WITHOUT_A_DAEMON {
        let same = documented.iter().filter(|step| step.command == command);
        let answers: Vec<&str> = same.map(|step| step.answer.as_str()).collect();
        assert!(!answers.is_empty(), "no guide has `tabula {command}`");
        run_as_documented(&sandbox, command, &answers);
    }
}
