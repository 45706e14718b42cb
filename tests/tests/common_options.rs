//! Options of every command: each command uses them, or refuses them.

use crate::daemon::{Sandbox, WATCHDOG, run_to_end};
use std::collections::BTreeSet;
use std::path::Path;

const USAGE: i32 = 2;
/// Configuration that does not exist: no command that reads one can succeed.
const NO_CONFIG: &str = "/nowhere/tabula.toml";
const REFUSAL: &str = "has no meaning for this command";

/// Commands that ask a daemon or its memory, and read no configuration.
const OF_DAEMON: [&str; 57] = [
    "tabula objects",
    "tabula ask 1",
    "tabula find mug",
    "tabula teach 1 mug",
    "tabula correct 1 mug",
    "tabula forget mug",
    "tabula rename a b",
    "tabula merge a b",
    "tabula undo",
    "tabula redo",
    "tabula categories",
    "tabula memory stats",
    "tabula memory verify",
    "tabula memory repair",
    "tabula memory inspect",
    "tabula memory history",
    "tabula memory compact",
    "tabula memory export a",
    "tabula memory import a",
    "tabula knowledge list",
    "tabula knowledge get a",
    "tabula knowledge put a",
    "tabula knowledge remove a",
    "tabula model list",
    "tabula model show a",
    "tabula model export a",
    "tabula model forget a",
    "tabula world",
    "tabula world history",
    "tabula world events",
    "tabula world tasks",
    "tabula arm state",
    "tabula arm move 0 0 1",
    "tabula arm home",
    "tabula arm open",
    "tabula arm close",
    "tabula arm stop",
    "tabula arm check --yes",
    "tabula task preview clear-table",
    "tabula task preview fetch 1",
    "tabula task start clear-table",
    "tabula task start fetch 1",
    "tabula task state",
    "tabula task list",
    "tabula task show",
    "tabula task watch",
    "tabula task pause",
    "tabula task resume",
    "tabula task cancel",
    "tabula config reload",
    "tabula status",
    "tabula-lab learn a",
    "tabula learn a",
    "tabula view plan",
    "tabula-recorder record",
    "tabula-modeller build",
    "tabula-modeller plan",
];

/// Commands that need neither a daemon nor a configuration.
const ALONE: [&str; 35] = [
    "tabula-latency stop",
    "tabula-lab simulate scene --out o",
    "tabula-lab simulate views --out o",
    "tabula-lab simulate sensor --out o",
    "tabula-lab simulate categories",
    "tabula-lab evaluate detection a --out o",
    "tabula-lab evaluate tracking --out o",
    "tabula-lab evaluate open-ended a --out o",
    "tabula-lab evaluate ablation a --out o",
    "tabula-lab evaluate cross-validation a --out o",
    "tabula-lab evaluate lighting --out o",
    "tabula-lab evaluate still-pictures a --out o",
    "tabula-lab evaluate find --out o",
    "tabula-lab evaluate registration a",
    "tabula-lab evaluate model --out o",
    "tabula-lab evaluate next-best-view --out o",
    "tabula-lab evaluate grasping --out o",
    "tabula-lab evaluate transport --out o",
    "tabula-lab demo clear-table --out o",
    "tabula-lab demo fetch --out o",
    "tabula-lab examples edge-network a --out o",
    "tabula-lab examples region-merging a --out o",
    "tabula-lab sweep a --out o",
    "tabula-lab age-memory --out o",
    "tabula-latency machine --short",
    "tabula-latency peers --short",
    "tabula-latency compare a b",
    "tabula-latency merge a",
    "tabula-recorder record --info a.mcap",
    "tabula-recorder record --recover a.mcap",
    "tabula simulate categories",
    "tabula evaluate detection a --out o",
    "tabula demo clear-table --out o",
    "tabula record --info a.mcap",
    "tabula task graph clear-table",
];

/// Commands that start a daemon of their own, with a configuration.
const OWN_DAEMON: [&str; 4] = [
    "tabula-latency --source synthetic:0",
    "tabula-latency soak",
    "tabula-latency sweep rate",
    "tabula-recorder replay a.mcap --lockstep --events e",
];

/// Commands of a daemon and its configuration.
const OF_BOTH: [&str; 13] = [
    "tabula run",
    "tabula doctor",
    "tabula config check",
    "tabula config show",
    "tabula config explain camera.rate_hz",
    "tabula-latency",
    "tabula-recorder replay a.mcap",
    "tabula grasp plan 1",
    "tabula-modeller grasp 1",
    "tabula place plan 1",
    "tabula place list",
    "tabula-modeller place 1",
    "tabula-modeller places",
];

/// Exit code, and all that a command prints, with an option before and behind its words.
fn outcomes(sandbox: &Sandbox, words: &str, option: [&str; 2]) -> [(Option<i32>, String); 2] {
    let mut words = words.split_ascii_whitespace();
    let program = words.next().unwrap();
    let words: Vec<&str> = words.collect();
    [
        [&option[..], &words].concat(),
        [&words[..], &option].concat(),
    ]
    .map(|arguments| {
        let mut command = sandbox.command(program);
        let done = run_to_end(
            command.args(arguments).current_dir(sandbox.home()),
            WATCHDOG,
        );
        let printed = [done.stdout, done.stderr].concat();
        (
            done.status.code(),
            String::from_utf8_lossy(&printed).into_owned(),
        )
    })
}

fn check_refused(sandbox: &Sandbox, words: &str, option: [&str; 2]) {
    for (code, printed) in outcomes(sandbox, words, option) {
        let sentence = format!("{} {REFUSAL}", option[0]);
        assert!(printed.contains(&sentence), "{words} {option:?}: {printed}");
        assert_eq!(code, Some(USAGE), "{words} {option:?}: {printed}");
    }
}

/// Commands with a manual page of their own in a folder, whose names are `program-verb-verb`.
fn pages(sandbox: &Sandbox, program: &str, folder: &Path) -> BTreeSet<String> {
    let mut command = sandbox.command(program);
    let written = command.arg("--write-manuals").arg(folder).output().unwrap();
    assert!(written.status.success(), "{written:?}");
    let pages = folder.join("man").read_dir().unwrap();
    let name = |page: std::io::Result<std::fs::DirEntry>| {
        let page = page.unwrap().file_name().into_string().unwrap();
        page.strip_suffix(".1").unwrap().to_owned()
    };
    pages.map(name).collect()
}

#[test]
fn common_options_are_refused_by_the_commands_that_do_not_use_them() {
    let sandbox = Sandbox::new();
    std::fs::write(sandbox.home().join("a.mcap"), "").unwrap();
    let (domain, home, config) = (
        ["--domain", "other"],
        ["--home", "/nowhere"],
        ["--config", NO_CONFIG],
    );
    for words in OF_DAEMON {
        check_refused(&sandbox, words, config);
    }
    for words in ALONE {
        for option in [domain, home, config] {
            check_refused(&sandbox, words, option);
        }
    }
    for words in OWN_DAEMON {
        check_refused(&sandbox, words, domain);
        check_refused(&sandbox, words, home);
    }
    for words in OWN_DAEMON.into_iter().chain(OF_BOTH) {
        for (_, printed) in outcomes(&sandbox, words, config) {
            assert!(printed.contains(NO_CONFIG), "{words}: {printed}");
            assert!(!printed.contains(REFUSAL), "{words}: {printed}");
        }
    }
    // A daemon is chosen by both.
    for option in [domain, home] {
        for (code, printed) in outcomes(&sandbox, "tabula objects", option) {
            assert_eq!(code, Some(3), "{printed}");
        }
    }
}

#[test]
fn common_options_have_a_known_use_in_every_command() {
    let sandbox = Sandbox::new();
    let known = [&OF_DAEMON[..], &ALONE, &OWN_DAEMON, &OF_BOTH].concat();
    let known: Vec<String> = known.iter().map(|words| words.replace(' ', "-")).collect();
    for program in [
        "tabula",
        "tabula-lab",
        "tabula-latency",
        "tabula-recorder",
        "tabula-modeller",
    ] {
        let folder = tempfile::tempdir().unwrap();
        let pages = pages(&sandbox, program, folder.path());
        let is_group = |page: &str| {
            let verbs = format!("{page}-");
            pages.iter().any(|other| other.starts_with(&verbs))
        };
        for page in pages.iter().filter(|page| !is_group(page)) {
            let words = format!("{page}-");
            let is_known = |known: &String| known == page || known.starts_with(&words);
            assert!(
                known.iter().any(is_known),
                "{page}: say which options of every command it uses"
            );
        }
    }
}

#[test]
fn common_options_of_a_running_daemon_do_not_change_its_configuration() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    let config = sandbox.home().join("other.toml");
    std::fs::write(&config, "").unwrap();
    let (code, sentence) = daemon.refused(&["latency", "--config", config.to_str().unwrap()]);
    assert_eq!(code, USAGE, "{sentence}");
    assert!(sentence.contains("running daemon"), "{sentence}");
    daemon.stop();
}
