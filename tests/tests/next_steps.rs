//! Next steps in refusals: candidates, swapped arguments, nearest names, what a daemon lacks.

use crate::daemon::Sandbox;

/// Exit codes of wrong usage, a daemon that is not there, and a refusal.
const USAGE: i32 = 2;

#[test]
fn unknown_source_is_told_with_the_sources_that_there_are() {
    let sandbox = Sandbox::new();
    for (source, part) in [
        (
            "realsense",
            "nor a folder of this name; the sources are simulation[:SCENE], kinect, ",
        ),
        ("kinct", "; kinect may be meant; the sources are "),
        ("/nowhere", "there is no folder /nowhere; the sources are "),
    ] {
        let output = sandbox.tabula(&["run", "--source", source]);
        let sentence = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(USAGE), "{sentence}");
        assert!(sentence.contains(part), "{source}: {sentence}");
    }
}
