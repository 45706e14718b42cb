//! `tabula find`: objects by words.

use crate::arguments::FindArguments;
use crate::objects::metres;
use command_line::Output;
use control_client::{connect, find_objects};
use control_protocol::{FindReport, FoundObjectReport};
use service::{CommonArguments, Failure, exit_code};
use std::process::ExitCode;

/// Asks for objects by words and prints the answer. The exit code is 1 when nothing fits.
pub(crate) fn run(
    common: &CommonArguments,
    arguments: &FindArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let mut client = connect(common)?;
    let words = arguments.words.join(" ");
    let report = find_objects(&mut client, &words, arguments.author.as_deref())?;
    output.answer(&report, || text(&report));
    Ok(if report.matches.is_empty() {
        ExitCode::from(exit_code::FAILURE)
    } else {
        ExitCode::SUCCESS
    })
}

fn text(report: &FindReport) -> String {
    let mut lines = vec![report.sentence.clone()];
    lines.extend(report.matches.iter().map(match_line));
    let used = report.understood.iter();
    let used: Vec<String> = used
        .map(|used| format!("{} ({})", used.words, used.meaning))
        .collect();
    lines.push(format!("understood: {}", used.join(", ")));
    if !report.not_understood.is_empty() {
        lines.push(format!(
            "not understood: {}",
            report.not_understood.join(", ")
        ));
    }
    lines.extend(report.remarks.iter().cloned());
    lines.join("\n")
}

fn match_line(found: &FoundObjectReport) -> String {
    let label = found.answer.shown(found.label.as_deref());
    let place = found.position_m.map_or_else(String::new, |position_m| {
        format!(" at ({})", metres(position_m))
    });
    let state = &found.state;
    let track_id = found.track_id;
    format!(
        "track {track_id}: {label}, {state}{place}, fits {:.0} %",
        100.0 * found.score
    )
}
