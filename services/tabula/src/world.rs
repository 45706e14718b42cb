//! `tabula world`: present state, history, events and tasks of the world model.

use crate::arguments::{EventsArguments, HistoryArguments, TimeArgument, WorldPoint, WorldVerb};
use crate::objects::metres;
use command_line::{Output, StopSignal, format_table};
use control_client::{TrackScope, ask, connect};
use control_protocol::{FactFilter, WorldRegion, request};
use daemon_client::DaemonClient;
use scene_document::{
    EventDocument, EventsDocument, FactDocument, FactsDocument, RobotDocument, TaskDocument,
    TaskStepDocument, TasksDocument, WorldDocument, WorldObjectDocument, WorldSurfaceDocument,
};
use service::{CommonArguments, Failure, wall_clock_ns};
use std::process::ExitCode;
use std::time::Duration;

/// Long-polling timeout of an event query, milliseconds; the maximum delay of Ctrl-C. Chosen.
const EVENT_WAIT_MS: u64 = 1000;
/// Delay before reconnecting to a daemon that has gone away. Chosen.
const RECONNECT_DELAY: Duration = Duration::from_millis(500);

/// Runs `tabula world` or one of its subcommands.
pub(crate) fn run(
    common: &CommonArguments,
    verb: Option<&WorldVerb>,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let mut client = connect(common)?;
    match verb {
        None => {
            let report = now(&mut client)?;
            output.answer(&report, || world_text(&report));
        }
        Some(WorldVerb::History(wanted)) => {
            let track = wanted.track.as_ref();
            let track = track.map(|track| track.resolve(common, TrackScope::RECALL, None));
            let report = history(&mut client, wanted, track.transpose()?)?;
            output.answer(&report, || history_text(&report, now_ns()));
        }
        Some(WorldVerb::Events(wanted)) if wanted.follow => {
            return follow(common, client, wanted.since, output);
        }
        Some(WorldVerb::Events(wanted)) => {
            let report = events(&mut client, wanted)?;
            output.answer(&report, || events_text(&report.events, now_ns()));
        }
        Some(WorldVerb::Tasks { limit }) => return list_tasks(common, *limit, output),
    }
    Ok(ExitCode::SUCCESS)
}

/// Prints the newest tasks with their newest steps.
pub(crate) fn list_tasks(
    common: &CommonArguments,
    limit: u32,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let report = tasks(&mut connect(common)?, limit)?;
    output.answer(&report, || tasks_text(&report, now_ns()));
    Ok(ExitCode::SUCCESS)
}

/// Task with all its steps, as text.
pub(crate) fn task_text(task: &TaskDocument) -> String {
    let page = TasksDocument {
        tasks: vec![task.clone()],
        next: None,
    };
    tasks_text(&page, now_ns())
}

fn now_ns() -> u64 {
    wall_clock_ns().max(0) as u64
}

fn now(client: &mut DaemonClient) -> Result<WorldDocument, Failure> {
    ask(client, &request::world())
}

/// Facts of the filter, read page by page up to the limit.
fn history(
    client: &mut DaemonClient,
    wanted: &HistoryArguments,
    track_id: Option<u64>,
) -> Result<FactsDocument, Failure> {
    let mut filter = filter(wanted, track_id, now_ns());
    let mut facts = Vec::new();
    loop {
        let page = ask(client, &request::facts(filter.clone()))?;
        facts.extend(page.facts);
        filter.before = page.next;
        filter.limit = wanted.limit - (facts.len() as u32).min(wanted.limit);
        if page.next.is_none() || filter.limit == 0 {
            let next = page.next;
            return Ok(FactsDocument { facts, next });
        }
    }
}

fn filter(wanted: &HistoryArguments, track_id: Option<u64>, now_ns: u64) -> FactFilter {
    let instant = |time: Option<TimeArgument>| time.map(|time| time.at(now_ns));
    let region = wanted.near.zip(wanted.radius);
    FactFilter {
        track_id,
        label: wanted.label.clone(),
        region: region
            .map(|(WorldPoint(centre_m), radius_m)| WorldRegion::Ball { centre_m, radius_m }),
        since_ns: instant(wanted.at.or(wanted.since)),
        until_ns: instant(wanted.at.or(wanted.until)),
        before: None,
        limit: wanted.limit,
    }
}

fn events_page(
    client: &mut DaemonClient,
    since: u64,
    wait_ms: u64,
) -> Result<EventsDocument, Failure> {
    ask(client, &request::events(since, wait_ms))
}

/// Prints events, read page by page.
fn events(client: &mut DaemonClient, wanted: &EventsArguments) -> Result<EventsDocument, Failure> {
    let mut since = wanted.since.unwrap_or(0);
    let mut events = Vec::new();
    loop {
        let page = events_page(client, since, 0)?;
        let last = page
            .events
            .last()
            .map_or(page.newest, |event| event.sequence);
        events.extend(page.events);
        if last >= page.newest {
            let newest = page.newest;
            return Ok(EventsDocument { events, newest });
        }
        since = last;
    }
}

/// Prints each event as it happens, until nobody reads them; with `--json` one document for each line. Reconnects to a
/// daemon that restarts.
fn follow(
    common: &CommonArguments,
    mut client: DaemonClient,
    since: Option<u64>,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let stop = StopSignal::install_for_reader()?;
    let mut since = match since {
        Some(since) => since,
        None => now(&mut client)?.newest_event,
    };
    let mut connected = Some(client);
    while !stop.is_raised() && output.is_open() {
        let page = match &mut connected {
            Some(client) => events_page(client, since, EVENT_WAIT_MS),
            None => connect(common).and_then(|mut fresh| {
                let page = events_page(&mut fresh, since, EVENT_WAIT_MS);
                connected = Some(fresh);
                page
            }),
        };
        let Ok(page) = page else {
            connected = None;
            stop.sleep(RECONNECT_DELAY);
            continue;
        };
        for event in &page.events {
            output.answer(event, || event_line(event, now_ns()));
        }
        // The sequence numbers of a new memory begin again.
        let last = page.events.last().map(|event| event.sequence);
        since = last.unwrap_or(if page.newest < since { 0 } else { since });
    }
    Ok(ExitCode::SUCCESS)
}

/// Tasks, read page by page up to the limit.
fn tasks(client: &mut DaemonClient, wanted: u32) -> Result<TasksDocument, Failure> {
    let mut tasks = Vec::new();
    let (mut before, mut limit) = (None, wanted);
    loop {
        let page = ask(client, &request::tasks(before, limit))?;
        tasks.extend(page.tasks);
        before = page.next;
        limit = wanted - (tasks.len() as u32).min(wanted);
        if before.is_none() || limit == 0 {
            return Ok(TasksDocument {
                tasks,
                next: before,
            });
        }
    }
}

fn world_text(report: &WorldDocument) -> String {
    let now_ns = report.now_ns;
    let row = |object: &WorldObjectDocument| {
        vec![
            object.track_id.to_string(),
            object.answer.shown(object.label.as_deref()),
            object
                .label_since_ns
                .map_or_else(|| "-".into(), |since_ns| ago(since_ns, now_ns)),
            metres(object.place.position_m),
            ago(object.place_since_ns, now_ns),
            metres(object.place.size_m),
            object.state.clone(),
            ago(object.state_since_ns, now_ns),
            ago(object.first_seen_ns, now_ns),
            ago(object.last_seen_ns, now_ns),
        ]
    };
    let heading = [
        "id",
        "label",
        "since",
        "position m",
        "since",
        "size m",
        "state",
        "since",
        "first seen",
        "last seen",
    ];
    let rows: Vec<_> = report.objects.iter().map(row).collect();
    let objects = match rows.as_slice() {
        [] => "no objects".into(),
        rows => format_table(&heading, rows),
    };
    let surfaces = report
        .surfaces
        .iter()
        .map(|surface| surface_line(surface, now_ns));
    let stale = report.is_stale.then(|| stale_line(report.scene_age_s));
    let robot = report.robot.as_ref().map(|robot| robot_line(robot, now_ns));
    let lines = std::iter::once(objects)
        .chain(surfaces)
        .chain(stale)
        .chain(robot);
    lines.collect::<Vec<_>>().join("\n")
}

fn surface_line(surface: &WorldSurfaceDocument, now_ns: u64) -> String {
    let carried: Vec<String> = surface.track_ids.iter().map(u64::to_string).collect();
    let carried = match carried.as_slice() {
        [] => "carries nothing".to_owned(),
        ids => format!("carries {}", ids.join(", ")),
    };
    let (id, kind, state) = (surface.surface_id, &surface.kind, &surface.state);
    let height = match surface.outline_m.as_slice() {
        [] => String::new(),
        corners => {
            let sum_m: f64 = corners.iter().map(|corner| corner[2]).sum();
            format!(" at {:.2} m", sum_m / corners.len() as f64)
        }
    };
    let (first, last) = (
        ago(surface.first_seen_ns, now_ns),
        ago(surface.last_seen_ns, now_ns),
    );
    format!("surface {id}: {kind}{height}, {carried}; {state}, first {first} ago, last {last} ago")
}

/// Line about a world that no longer shows the present.
fn stale_line(scene_age_s: Option<f64>) -> String {
    match scene_age_s {
        Some(age_s) => format!(
            "STALE: no scene has come for {age_s:.1} s; see perception and the camera in `tabula \
             status`"
        ),
        None => "STALE: no scene has come since the memory was started".to_owned(),
    }
}

fn robot_line(robot: &RobotDocument, now_ns: u64) -> String {
    let hand = if robot.is_holding {
        "holding something"
    } else {
        "empty"
    };
    if !robot.is_heard {
        let last = ago(robot.last_heard_ns, now_ns);
        return format!(
            "the arm says nothing since {last} ago; then it was {}",
            robot.activity
        );
    }
    let place = metres(robot.position_m);
    format!(
        "the arm is {}, {hand}, gripper at {place} m",
        robot.activity
    )
}

fn history_text(report: &FactsDocument, now_ns: u64) -> String {
    let row = |fact: &FactDocument| {
        let of = match fact.track_id.or(fact.task_id).or(fact.surface_id) {
            Some(id) => format!("{} {id}", fact.subject),
            None => fact.subject.clone(),
        };
        let end = fact
            .end_ns
            .map_or_else(|| "holds".into(), |end_ns| ago(end_ns, now_ns));
        vec![
            fact.fact.to_string(),
            of,
            fact.property.clone(),
            value_text(fact),
            ago(fact.start_ns, now_ns),
            end,
        ]
    };
    let rows: Vec<_> = report.facts.iter().map(row).collect();
    if rows.is_empty() {
        return "no such fact is known; `tabula world` shows the present".into();
    }
    let heading = ["fact", "of", "property", "value", "from (ago)", "to (ago)"];
    let more = report
        .next
        .map_or("", |_| "\nand older ones; --limit shows more");
    format!("{}{more}", format_table(&heading, &rows))
}

fn value_text(fact: &FactDocument) -> String {
    match (&fact.place, &fact.value) {
        (Some(place), _) => format!("({}) m", metres(place.position_m)),
        (None, Some(value)) => match fact.answer {
            Some(answer) => answer.shown(Some(value)),
            None => value.clone(),
        },
        (None, None) => "-".into(),
    }
}

fn events_text(events: &[EventDocument], now_ns: u64) -> String {
    if events.is_empty() {
        return "nothing happened; wait for the next event with --follow".into();
    }
    let lines = events.iter().map(|event| event_line(event, now_ns));
    lines.collect::<Vec<_>>().join("\n")
}

fn event_line(event: &EventDocument, now_ns: u64) -> String {
    let when = ago(event.wall_ns, now_ns);
    format!("{} {when} ago: {}", event.sequence, event.sentence)
}

fn tasks_text(report: &TasksDocument, now_ns: u64) -> String {
    let row = |task: &TaskDocument| {
        vec![
            task.task_id.to_string(),
            task.kind.clone(),
            task.state.clone(),
            ago(task.started_ns, now_ns),
            task.ended_ns
                .map_or_else(|| "-".into(), |end_ns| ago(end_ns, now_ns)),
            task.author.clone(),
            task.parameters.clone(),
            task.reason.clone(),
        ]
    };
    let rows: Vec<_> = report.tasks.iter().map(row).collect();
    if rows.is_empty() {
        return "no task is known; programs record theirs by the control protocol".into();
    }
    let heading = [
        "id",
        "kind",
        "state",
        "began (ago)",
        "ended (ago)",
        "by",
        "parameters",
        "reason",
    ];
    let table = format_table(&heading, &rows);
    let mut lines = table.lines().map(str::to_owned);
    let mut text: Vec<String> = lines.by_ref().take(1).collect();
    for (line, task) in lines.zip(&report.tasks) {
        text.push(line);
        text.extend(step_lines(&task.steps));
    }
    text.extend(
        report
            .next
            .map(|_| "and older ones; --limit shows more".to_owned()),
    );
    text.join("\n")
}

/// Indented lines of the steps of a task, after a line about those that are not shown.
fn step_lines(steps: &[TaskStepDocument]) -> Vec<String> {
    let n_earlier = steps
        .first()
        .map_or(0, |first| first.number.saturating_sub(1));
    let earlier = match n_earlier {
        0 => None,
        1 => Some("    1 earlier step".to_owned()),
        n => Some(format!("    {n} earlier steps")),
    };
    let lines = steps.iter().map(step_line);
    earlier.into_iter().chain(lines).collect()
}

fn step_line(step: &TaskStepDocument) -> String {
    let (number, state, track_id) = (step.number, &step.state, step.track_id);
    let label = step.label.as_ref();
    let label = label.map_or_else(String::new, |label| format!(" ({label})"));
    let place = step.place.as_ref();
    let place = place.map_or_else(String::new, |place| format!(" to {place}"));
    let attempt = match step.attempt {
        0 | 1 => String::new(),
        attempt => format!(", attempt {attempt}"),
    };
    let reason = match step.reason.as_str() {
        "" => String::new(),
        reason => format!(": {reason}"),
    };
    let primitive = &step.primitive;
    format!("    {number} {state}  {primitive} object {track_id}{label}{place}{attempt}{reason}")
}

/// Elapsed time in at most two units; zero for times in the future.
fn ago(then_ns: u64, now_ns: u64) -> String {
    let ns = now_ns.saturating_sub(then_ns);
    let s = ns / 1_000_000_000;
    match s {
        0..60 => format!("{:.1}s", ns as f64 * 1e-9),
        60..3600 => format!("{}m {:02}s", s / 60, s % 60),
        3600..86_400 => format!("{}h {:02}m", s / 3600, s / 60 % 60),
        _ => format!("{}d {:02}h", s / 86_400, s / 3600 % 24),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elapsed_time_has_at_most_two_units() {
        const SECOND: u64 = 1_000_000_000;
        let check = |seconds: u64, expected: &str| assert_eq!(ago(0, seconds * SECOND), expected);
        check(0, "0.0s");
        check(59, "59.0s");
        check(61, "1m 01s");
        check(3660, "1h 01m");
        check(90_000, "1d 01h");
        assert_eq!(ago(5, 3), "0.0s", "the clock stepped back");
    }

    #[test]
    fn text_tells_that_the_world_is_stale() {
        let report = |scene_age_s, is_stale| WorldDocument {
            now_ns: 0,
            scene_age_s,
            capture_stamp_ns: None,
            is_stale,
            objects: Vec::new(),
            surfaces: Vec::new(),
            robot: None,
            newest_event: 0,
        };
        assert_eq!(world_text(&report(Some(0.1), false)), "no objects");
        let stale = world_text(&report(Some(7.0), true));
        assert!(
            stale.contains("STALE: no scene has come for 7.0 s"),
            "{stale}"
        );
        assert!(world_text(&report(None, true)).contains("since the memory"));
    }

    #[test]
    fn text_of_tasks_has_their_steps_below_them() {
        let slipped = TaskStepDocument {
            number: 1,
            state: "failed".into(),
            primitive: "lift".into(),
            track_id: 7,
            label: Some("mug".into()),
            place: Some("shelf".into()),
            attempt: 1,
            reason: "it slipped".into(),
            ..TaskStepDocument::default()
        };
        let carried = TaskStepDocument {
            number: 2,
            state: "held".into(),
            primitive: "carry".into(),
            attempt: 2,
            reason: String::new(),
            ..slipped.clone()
        };
        let task = |task_id, steps| TaskDocument {
            task_id,
            kind: "clear".into(),
            state: "running".into(),
            steps,
            ..TaskDocument::default()
        };
        let report = |steps| TasksDocument {
            tasks: vec![task(2, steps), task(1, Vec::new())],
            next: Some(1),
        };
        let text = tasks_text(&report(vec![slipped, carried.clone()]), 0);
        let lines: Vec<&str> = text.lines().collect();
        assert!(
            lines[1].starts_with("2 ") && lines[4].starts_with("1 "),
            "{text}"
        );
        assert_eq!(
            lines[2],
            "    1 failed  lift object 7 (mug) to shelf: it slipped"
        );
        assert_eq!(
            lines[3],
            "    2 held  carry object 7 (mug) to shelf, attempt 2"
        );
        assert_eq!(lines[5], "and older ones; --limit shows more");
        let text = tasks_text(&report(vec![carried]), 0);
        assert!(text.contains("\n    1 earlier step\n    2 held"), "{text}");
    }

    #[test]
    fn filter_of_an_instant_begins_and_ends_there() {
        let wanted = HistoryArguments {
            track: None,
            label: None,
            near: Some(WorldPoint([0.1, 0.2, 0.3])),
            radius: Some(0.5),
            at: Some(TimeArgument::Ago(400)),
            since: None,
            until: None,
            limit: 7,
        };
        let filter = filter(&wanted, Some(3), 1000);
        assert_eq!((filter.since_ns, filter.until_ns), (Some(600), Some(600)));
        assert_eq!((filter.track_id, filter.limit), (Some(3), 7));
        let ball = WorldRegion::Ball {
            centre_m: [0.1, 0.2, 0.3],
            radius_m: 0.5,
        };
        assert_eq!(filter.region, Some(ball));
    }
}
