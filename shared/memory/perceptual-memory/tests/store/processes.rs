//! Lock tests: one process per store.

use std::io::{BufRead, BufReader, Write};
use std::process::{Command, Stdio};

use perceptual_memory::{Error, PerceptualMemory, StorageError};

use crate::builders::{apply, folder, open, store, view};

const FOLDER: &str = "TABULA_STORE_HOLD_TEST_FOLDER";

#[test]
#[ignore = "works only as the child of the test below"]
fn child_holds_the_lock_until_killed() {
    let Ok(folder) = std::env::var(FOLDER) else {
        return;
    };
    let (mut memory, _) = PerceptualMemory::open(folder.as_ref(), 1).unwrap();
    apply(&mut memory, &[store(1, vec![view(1, 0, 0)])]);
    println!("holding");
    std::io::stdout().flush().unwrap();
    // Until it is killed, or until the parent is gone.
    let mut line = String::new();
    let _ = std::io::stdin().read_line(&mut line);
}

#[test]
fn lock_excludes_a_second_process_and_ends_with_a_killed_one() {
    let folder = folder();
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "processes::child_holds_the_lock_until_killed"])
        .args(["--ignored", "--nocapture"])
        .env(FOLDER, folder.path())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let lines = BufReader::new(child.stdout.take().unwrap()).lines();
    assert!(
        lines
            .map_while(Result::ok)
            .any(|line| line.ends_with("holding"))
    );
    let refused = PerceptualMemory::open(folder.path(), 1)
        .map(|_| ())
        .unwrap_err();
    assert!(
        matches!(refused, Error::Storage(StorageError::InUse { .. })),
        "{refused}"
    );
    assert!(refused.to_string().contains("another process"), "{refused}");
    child.kill().unwrap();
    child.wait().unwrap();
    let (mut memory, report) = open(&folder);
    assert!(!report.is_loss(), "{report}");
    assert_eq!(memory.views_of_track(1).unwrap().len(), 1);
}

#[test]
fn lock_excludes_a_second_opening_in_the_same_process() {
    let folder = folder();
    let (memory, _) = open(&folder);
    let refused = PerceptualMemory::open(folder.path(), 1)
        .map(|_| ())
        .unwrap_err();
    assert!(
        matches!(refused, Error::Storage(StorageError::InUse { .. })),
        "{refused}"
    );
    drop(memory);
    open(&folder);
}
