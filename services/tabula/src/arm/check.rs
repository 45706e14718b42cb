//! `tabula arm check`: conformance of an arm and its driver, measured from outside.
//!
//! Each check asks the daemon, looks at the published states, and says in a sentence what it saw.

mod arm_record;
mod arm_under_test;
mod gripper_checks;
mod lease_keeper;
mod motion_checks;
mod request_checks;
mod state_checks;

use arm_under_test::ArmUnderTest;
use command_line::Output;
use serde::Serialize;
use service::{CommonArguments, Failure, exit_code};
use std::process::ExitCode;

/// Outcome of a check: what was seen, or what is wrong.
type Outcome = Result<String, String>;

/// Check by its name.
type Check = (&'static str, fn(&mut ArmUnderTest) -> Outcome);

/// All checks in their order: those that move the arm come last.
const CHECKS: [Check; 13] = [
    ("states", state_checks::states),
    ("content", state_checks::content),
    ("lease", request_checks::lease),
    ("one commander", request_checks::one_commander),
    ("joint limits", request_checks::joint_limits),
    ("numbers", request_checks::numbers),
    ("motion", motion_checks::motion),
    ("silence", motion_checks::silence),
    ("release", motion_checks::release),
    ("stop word", motion_checks::stop_word),
    ("stop request", motion_checks::stop_request),
    ("resumption", motion_checks::resumption),
    ("gripper", gripper_checks::gripper),
];

/// Result of one check.
#[derive(Debug, Serialize)]
struct CheckResult {
    check: &'static str,
    /// `ok` or `failed`.
    verdict: &'static str,
    sentence: String,
}

/// JSON document of all checks.
#[derive(Debug, Serialize)]
struct CheckDocument {
    checks: Vec<CheckResult>,
    n_failed: usize,
}

/// Checks the arm of a daemon, and moves it for that.
///
/// # Errors
/// When the person has not agreed, no daemon with an arm answers, or somebody else commands it.
pub(super) fn run(
    common: &CommonArguments,
    is_agreed: bool,
    output: &Output,
) -> Result<ExitCode, Failure> {
    if !is_agreed {
        return Err(Failure::usage(
            "this check moves the arm: it turns the last joint by up to 70 degrees, and closes and \
             opens the fingers; see that nothing is near the hand, keep the emergency switch at \
             hand, and say --yes",
        ));
    }
    let mut arm = ArmUnderTest::new(common)?;
    let mut checks = Vec::with_capacity(CHECKS.len());
    for (check, examine) in CHECKS {
        let (verdict, sentence) = match examine(&mut arm) {
            Ok(sentence) => ("ok", sentence),
            Err(sentence) => ("failed", sentence),
        };
        output.print_text(&format!("{verdict:<6}  {check}: {sentence}"));
        checks.push(CheckResult {
            check,
            verdict,
            sentence,
        });
    }
    let n_failed = checks.iter().filter(|one| one.verdict == "failed").count();
    let document = CheckDocument { checks, n_failed };
    output.answer(&document, || summary(n_failed));
    Ok(ExitCode::from(if n_failed == 0 {
        0
    } else {
        exit_code::FAILURE
    }))
}

fn summary(n_failed: usize) -> String {
    match n_failed {
        0 => format!("the arm has passed all {} checks", CHECKS.len()),
        n => format!(
            "the arm has failed {n} of {} checks; do not let it run tasks near people",
            CHECKS.len()
        ),
    }
}
