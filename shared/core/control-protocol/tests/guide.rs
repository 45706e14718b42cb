//! The guide's table of owners and roles is that of the requests.

use control_protocol::request::ROWS;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Words of a command on the wire: its variants in snake case, from the outermost inwards.
fn words(command: &str) -> String {
    let variants = command.split("::").skip(1).map(|part| {
        let end = part.find(|c: char| !c.is_alphanumeric());
        &part[..end.unwrap_or(part.len())]
    });
    let mut words = String::new();
    for variant in variants {
        if !words.is_empty() {
            words.push(' ');
        }
        for (i, c) in variant.char_indices() {
            if c.is_uppercase() && i > 0 {
                words.push('_');
            }
            words.push(c.to_ascii_lowercase());
        }
    }
    words
}

#[test]
fn guide_has_the_table_of_owners_and_roles() {
    let guide = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../../docs/guides/control-protocol.md"
    );
    let guide = std::fs::read_to_string(guide).unwrap();
    let mut commands = BTreeMap::<_, Vec<String>>::new();
    for (command, access) in ROWS {
        let words = format!("`{}`", words(command));
        let group = (access.owner.word(), access.role);
        commands.entry(group).or_default().push(words);
    }
    let mut table = String::from("| owner | role | commands |\n|---|---|---|\n");
    for ((owner, role), commands) in commands {
        let (role, commands) = (role.name(), commands.join(", "));
        writeln!(table, "| {owner} | {role} | {commands} |").unwrap();
    }
    assert!(
        guide.contains(&table),
        "the guide needs this table:\n{table}"
    );
}
