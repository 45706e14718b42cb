//! Help of `tabula`: its commands in groups.

use crate::arguments::Verb;
use clap::{Command, Subcommand};
use std::fmt::Write;

/// Groups of the commands, in the order of the help.
const GROUPS: [(&str, &[&str]); 6] = [
    ("Daemon", &["run", "status", "doctor", "config"]),
    ("Objects", &["objects", "ask", "find", "world"]),
    (
        "Teaching",
        &[
            "teach",
            "correct",
            "forget",
            "rename",
            "merge",
            "undo",
            "redo",
            "categories",
            "learn",
        ],
    ),
    ("Memory", &["memory", "knowledge", "model"]),
    ("Robot", &["view", "grasp", "place", "arm", "task"]),
    (
        "Recordings and measurements",
        &[
            "record", "replay", "simulate", "evaluate", "demo", "latency",
        ],
    ),
];

/// Template of clap for the help of the whole program. Headings are bold and underlined, as clap's
/// own, where the output is a terminal.
pub(crate) fn help_template() -> String {
    let commands = Verb::augment_subcommands(Command::new("tabula"));
    let mut text = String::from("{about-with-newline}\n{usage-heading} {usage}\n");
    for (group, names) in GROUPS {
        add_heading(&mut text, group);
        for name in names {
            let about = commands
                .find_subcommand(name)
                .and_then(Command::get_about)
                .map(ToString::to_string)
                .unwrap_or_default();
            let _ = writeln!(text, "  \u{1b}[1m{name:<10}\u{1b}[0m  {about}");
        }
    }
    add_heading(&mut text, "Options");
    text += "{options}\n\n`tabula help COMMAND` has the options of a command.\n";
    text
}

fn add_heading(text: &mut String, heading: &str) {
    let _ = writeln!(text, "\n\u{1b}[1m\u{1b}[4m{heading}:\u{1b}[0m");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_have_each_command_once() {
        let commands = Verb::augment_subcommands(Command::new("tabula"));
        let mut known: Vec<&str> = commands.get_subcommands().map(Command::get_name).collect();
        let mut grouped: Vec<&str> = GROUPS
            .iter()
            .flat_map(|(_, names)| *names)
            .copied()
            .collect();
        known.sort_unstable();
        grouped.sort_unstable();
        assert_eq!(grouped, known);
    }
}
