//! Manual pages and shell completions, generated from the command-line definition.

use clap::Command;
use clap_complete::{Shell, generate_to};
use clap_mangen::Man;
use message::ProcessKind;
use std::fs::{File, create_dir_all};
use std::io;
use std::path::Path;

/// Shells for which completions are written.
const SHELLS: [Shell; 3] = [Shell::Bash, Shell::Zsh, Shell::Fish];
/// Writes the pages of a program and of its subcommands into `folder/man`, and its completions
/// into a folder for each shell, such as `folder/bash`.
///
/// # Errors
/// When a file cannot be written.
pub(crate) fn write(program: Command, folder: &Path) -> io::Result<()> {
    let name = program.get_name().to_owned();
    for shell in SHELLS {
        let completions = folder.join(shell.to_string());
        create_dir_all(&completions)?;
        generate_to(shell, &mut program.clone(), &name, &completions)?;
    }
    let pages = folder.join("man");
    create_dir_all(&pages)?;
    // Programs that the service manager starts, and programs for everybody.
    let is_daemon = ProcessKind::all().any(|process| process.program() == name);
    let section = if is_daemon { "8" } else { "1" };
    write_pages(built(program), section, &pages)
}

/// Command with all generated parts, such as the usage of its subcommands.
fn built(mut command: Command) -> Command {
    command = command.disable_help_subcommand(true);
    command.build();
    command
}

fn write_pages(command: Command, section: &str, folder: &Path) -> io::Result<()> {
    for subcommand in command.get_subcommands() {
        // Without a help of its own: another program parses its arguments, and has the page.
        if !subcommand.is_disable_help_flag_set() && !subcommand.is_hide_set() {
            write_pages(subcommand.clone(), section, folder)?;
        }
    }
    let name = command
        .get_display_name()
        .unwrap_or(command.get_name())
        .to_owned();
    let mut file = File::create(folder.join(format!("{name}.{section}")))?;
    Man::new(command)
        .title(name.to_uppercase())
        .section(section)
        .render(&mut file)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Arg;

    #[test]
    fn each_subcommand_has_a_page_and_each_shell_its_completions() {
        let folder = tempfile::tempdir().unwrap();
        let program = Command::new("tabula").subcommand(
            Command::new("memory")
                .about("Inspect the memory")
                .subcommand(Command::new("export").arg(Arg::new("file").help("File to write"))),
        );
        write(
            program.subcommand(Command::new("latency").disable_help_flag(true)),
            folder.path(),
        )
        .unwrap();
        let files = |part: &str| {
            let entries = std::fs::read_dir(folder.path().join(part)).unwrap();
            let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
            let mut names: Vec<_> = names.collect();
            names.sort();
            names
        };
        assert_eq!(
            files("man"),
            ["tabula-memory-export.1", "tabula-memory.1", "tabula.1"]
        );
        assert_eq!(files("bash"), ["tabula.bash"]);
        assert_eq!(files("zsh"), ["_tabula"]);
        assert_eq!(files("fish"), ["tabula.fish"]);
        let page = folder.path().join("man/tabula-memory-export.1");
        assert!(
            std::fs::read_to_string(page)
                .unwrap()
                .contains("File to write")
        );
    }

    #[test]
    fn pages_of_the_daemons_programs_are_in_section_8() {
        let folder = tempfile::tempdir().unwrap();
        write(Command::new("tabula-camera"), folder.path()).unwrap();
        assert!(folder.path().join("man/tabula-camera.8").exists());
    }
}
