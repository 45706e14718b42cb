//! Commands in the code blocks of README and guides: each command exists, and has the options that
//! stand there. Those of the README's session run besides (`readme_session`).

use crate::daemon::program;
use crate::language::root;
use std::collections::HashMap;
use std::path::Path;
use std::process::Command;

/// Greatest number of words that name a command, such as `memory export`.
const N_NAMES: usize = 2;

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

/// Code blocks of a document, in which lines that begin with `$ ` are commands and the others
/// their answers; without such lines all are commands.
fn commands(text: &str) -> Vec<String> {
    let blocks = text.split("```").skip(1).step_by(2);
    let mut commands = Vec::new();
    for block in blocks {
        let lines = || block.lines().map(str::trim_start);
        let prompted: Vec<&str> = lines().filter_map(|line| line.strip_prefix("$ ")).collect();
        let lines = if prompted.is_empty() {
            lines().collect()
        } else {
            prompted
        };
        for line in lines {
            let parts = line.split(['#', ';', '|', '&']).map(str::trim);
            let ours = parts.filter_map(|part| part.strip_prefix("tabula "));
            commands.extend(ours.map(str::to_owned));
        }
    }
    commands
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
    let guides = std::fs::read_dir(root().join("docs/guides")).unwrap();
    let guides = guides.map(|entry| entry.unwrap().path());
    let is_document = |path: &Path| path.extension().is_some_and(|kind| kind == "md");
    let readme = root().join("README.md");
    let mut helps = Helps::default();
    let (mut n_commands, mut wrong) = (0, Vec::new());
    for document in guides.chain([readme]).filter(|path| is_document(path)) {
        let text = std::fs::read_to_string(&document).unwrap();
        for command in commands(&text) {
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
