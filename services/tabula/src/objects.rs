//! `tabula objects` and `ask`: tracked objects.

use command_line::{Output, StopSignal, format_table};
use control_client::{TrackReference, TrackScope, ask as ask_daemon, connect};
use control_protocol::{QuestionsReport, request};
use daemon_client::DaemonClient;
use message::TrackState;
use scene_document::{CategoryAnswer, ObjectDocument, RejectedDocument, SceneDocument};
use service::{CommonArguments, Failure};
use std::process::ExitCode;
use std::time::Duration;

/// Redraw period of the watched table. Chosen.
const REDRAW_PERIOD: Duration = Duration::from_millis(200);

/// Runs `tabula objects`.
pub(crate) fn objects(
    common: &CommonArguments,
    watch: bool,
    output: &Output,
) -> Result<ExitCode, Failure> {
    if watch {
        return self::watch(common, output);
    }
    let mut client = connect(common)?;
    let report = ask_objects(&mut client)?;
    output.answer(&report, || objects_text(&report));
    Ok(ExitCode::SUCCESS)
}

fn ask_objects(client: &mut DaemonClient) -> Result<SceneDocument, Failure> {
    ask_daemon(client, &request::objects())
}

/// Redraws the table until Ctrl-C, or until nobody reads it; with `--json` prints one document for each line. Reconnects to a
/// daemon that restarts.
fn watch(common: &CommonArguments, output: &Output) -> Result<ExitCode, Failure> {
    let stop = StopSignal::install_for_reader()?;
    let mut client = Some(connect(common)?);
    while !stop.is_raised() && output.is_open() {
        let report = match &mut client {
            Some(connected) => ask_objects(connected),
            None => connect(common).and_then(|mut fresh| {
                let report = ask_objects(&mut fresh);
                client = Some(fresh);
                report
            }),
        };
        match report {
            Ok(report) if output.is_json() => output.answer(&report, String::new),
            Ok(report) => output.redraw(&objects_text(&report)),
            Err(failure) => {
                client = None;
                if !output.is_json() {
                    output.redraw(&format!("{failure}"));
                }
            }
        }
        stop.sleep(REDRAW_PERIOD);
    }
    Ok(ExitCode::SUCCESS)
}

const HEADING: [&str; 12] = [
    "id",
    "label",
    "sure %",
    "distance",
    "position m",
    "± mm",
    "m/s",
    "size m",
    "age s",
    "points",
    "key views",
    "state",
];

fn objects_text(report: &SceneDocument) -> String {
    let rows: Vec<_> = report.objects.iter().map(row).collect();
    let objects = match rows.as_slice() {
        [] if report.scene_age_s.is_none() => return report.note.clone(),
        [] if !report.ignored.is_empty() => "no objects".into(),
        [] if report.has_table => "no objects: the table is empty".into(),
        [] => "no objects: no table is seen".into(),
        rows => format_table(&HEADING, rows),
    };
    let more = match report.n_more {
        0 => String::new(),
        n_more => format!("\nand {n_more} more"),
    };
    let frame = if report.has_world_pose {
        "world"
    } else {
        "camera frame"
    };
    let mut lines = vec![format!("{objects}{more}")];
    lines.extend(report.is_stale.then(|| format!("STALE: {}", report.note)));
    lines.extend(report.ignored.iter().map(ignored_line));
    if report.n_more_ignored > 0 {
        lines.push(format!("ignored: {} more", report.n_more_ignored));
    }
    let assumptions = report.assumptions.iter();
    lines.extend(assumptions.map(|assumption| format!("assumed: {}", assumption.sentence)));
    lines.push(format!("candidate rule: {}", report.rule));
    lines.push(format!(
        "frame {} of {}, {} old, positions in the {frame}",
        report.frame_sequence,
        report.source_name,
        age_text(report.scene_age_s)
    ));
    lines.join("\n")
}

/// Age of a scene with its unit.
fn age_text(scene_age_s: Option<f64>) -> String {
    scene_age_s.map_or_else(|| "?".into(), |age_s| format!("{age_s:.1} s"))
}

fn ignored_line(ignored: &RejectedDocument) -> String {
    let why = match ignored.why.as_slice() {
        [] => "no reason is available".to_owned(),
        why => why.join("; "),
    };
    format!(
        "ignored at ({}), {} points: {why}",
        metres(ignored.position_m),
        ignored.n_points
    )
}

pub(crate) fn metres(values: [f64; 3]) -> String {
    values.map(|value| format!("{value:.3}")).join(" ")
}

/// Root mean square of the position's standard deviations along the axes, millimetres.
fn deviation_mm(object: &ObjectDocument) -> Option<f64> {
    let [xx, _, _, yy, _, zz] = object.covariance.as_ref()?.position_m2;
    Some(1e3 * ((xx + yy + zz) / 3.0).sqrt())
}

fn speed_m_s(object: &ObjectDocument) -> Option<f64> {
    let [x, y, z] = object.velocity_m_s?;
    Some((x * x + y * y + z * z).sqrt())
}

fn row(object: &ObjectDocument) -> Vec<String> {
    vec![
        object.track_id.to_string(),
        object.answer.shown(object.label.as_deref()),
        object
            .probability
            .map_or_else(|| "-".into(), |p| format!("{:.0}", 100.0 * p)),
        object
            .distance
            .map_or_else(|| "-".into(), |distance| format!("{distance:.3}")),
        metres(object.position_m),
        deviation_mm(object).map_or_else(|| "-".into(), |mm| format!("{mm:.1}")),
        speed_m_s(object).map_or_else(|| "-".into(), |speed| format!("{speed:.2}")),
        metres(object.size_m),
        format!("{:.1}", object.age_s),
        object.n_points.to_string(),
        object.n_key_views.to_string(),
        object.state.clone(),
    ]
}

/// Number of most probable categories that an answer names.
const N_BEST: usize = 3;

/// Runs `tabula ask`.
pub(crate) fn ask(
    common: &CommonArguments,
    track: &TrackReference,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let track_id = track.resolve(common, TrackScope::LOOK, None)?;
    let object = ask_daemon(&mut connect(common)?, &request::ask(track_id))?;
    output.answer(&object, || answer_text(&object));
    Ok(ExitCode::SUCCESS)
}

/// Prints the question about the object whose name would teach most.
pub(crate) fn question(common: &CommonArguments, output: &Output) -> Result<ExitCode, Failure> {
    let mut client = connect(common)?;
    let report = ask_daemon(&mut client, &request::question())?;
    output.answer(&report, || question_text(&report));
    Ok(ExitCode::SUCCESS)
}

fn question_text(report: &QuestionsReport) -> String {
    match &report.question {
        Some(question) => {
            let track_id = question.track_id;
            format!(
                "{}\nanswer with: tabula teach {track_id} NAME, or tabula correct {track_id} NAME",
                question.sentence
            )
        }
        None => "no question: each object in full view and at rest is known".to_owned(),
    }
}

fn answer_text(object: &ObjectDocument) -> String {
    let answer = label_text(object);
    if object.state == TrackState::STALE_WORD {
        let age = age_text(object.scene_age_s);
        return format!(
            "{answer}\nSTALE: no frame was processed for {age}; it may be elsewhere now"
        );
    }
    answer
}

fn label_text(object: &ObjectDocument) -> String {
    let track_id = object.track_id;
    let probable: Vec<String> = object
        .categories
        .iter()
        .take(N_BEST)
        .map(|near| format!("{} {:.0} %", near.label, 100.0 * near.probability))
        .collect();
    let Some(distance) = object.distance else {
        return match &object.label {
            Some(label) => format!("track {track_id} is {label}"),
            None => format!("track {track_id} is unknown; nothing has been taught yet"),
        };
    };
    let sides = match object.n_sides {
        0 | 1 => String::new(),
        n => format!("from {n} sides, "),
    };
    match &object.label {
        Some(label) => {
            let sure = object.probability;
            let sure = sure.map_or_else(String::new, |p| format!("{:.0} % sure, ", 100.0 * p));
            let others = match probable.get(1..) {
                Some(others @ [_, ..]) => format!("; then {}", others.join(", ")),
                _ => String::new(),
            };
            let is = match object.answer {
                CategoryAnswer::Probably => "is probably",
                CategoryAnswer::Is | CategoryAnswer::Unknown => "is",
            };
            format!("track {track_id} {is} {label} ({sure}{sides}distance {distance:.3}{others})")
        }
        None => format!(
            "track {track_id} is unknown ({sides}perhaps {})",
            probable.join(", ")
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report() -> SceneDocument {
        let ignored = RejectedDocument {
            position_m: [0.1, -0.25, 0.8],
            orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
            size_m: [0.1; 3],
            n_points: 320,
            verdict: "false".into(),
            why: vec!["it is the robot's arm (87 % of its points within 3 cm of a link)".into()],
            findings: vec![],
        };
        SceneDocument {
            scene_age_s: Some(0.04),
            frame_sequence: 7,
            source_name: "simulation".into(),
            has_table: true,
            has_world_pose: true,
            rule: "C_table".into(),
            ignored: vec![ignored],
            ..SceneDocument::default()
        }
    }

    #[test]
    fn text_tells_the_age_of_the_scene_and_that_it_is_stale() {
        let fresh = objects_text(&report());
        assert!(
            fresh.contains("frame 7 of simulation, 0.0 s old"),
            "{fresh}"
        );
        assert!(!fresh.contains("STALE"), "{fresh}");
        let stale = objects_text(&SceneDocument {
            scene_age_s: Some(12.34),
            is_stale: true,
            note: "no frame was processed for 12.3 s".into(),
            ..report()
        });
        assert!(
            stale.contains("STALE: no frame was processed for 12.3 s"),
            "{stale}"
        );
        assert!(stale.contains("12.3 s old"), "{stale}");
    }

    #[test]
    fn text_before_the_first_frame_is_the_reason() {
        let starting = SceneDocument {
            is_stale: true,
            note: "perception is starting: it waits for the memory".into(),
            ..SceneDocument::default()
        };
        assert_eq!(objects_text(&starting), starting.note);
    }

    #[test]
    fn text_names_rejected_candidates_with_their_reasons() {
        let text = objects_text(&report());
        let line = "ignored at (0.100 -0.250 0.800), 320 points: it is the robot's arm (87 % of \
                    its points within 3 cm of a link)";
        assert!(text.lines().any(|found| found == line), "{text}");
        assert!(text.contains("candidate rule: C_table"), "{text}");
        assert!(!text.contains("the table is empty"), "{text}");
    }
}
