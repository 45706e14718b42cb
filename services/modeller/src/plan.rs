//! `tabula view plan`: the next best view of the objects, once or again and again.

mod motion;
mod picture;
mod plan_document;
mod plan_text;
mod pose_file;
mod publication;
mod remarks;
mod trigger;
mod view_planning;

use crate::arguments::PlanArguments;
use crate::awaited_snapshot::{POLL_PERIOD, awaited_snapshot};
use crate::presence::{is_running, require_daemon};
use channel::{Domain, Role, RunFolder};
use command_line::{Output, StopSignal};
use plan_document::PlanDocument;
use scene_client::{Snapshot, SnapshotReceiver};
use service::{CommonArguments, Failure, exit_code};
use std::process::ExitCode;
use std::time::{Duration, Instant};
use trigger::PlanTrigger;
use view_planning::ViewPlanning;

/// Period of the checks of the daemon, and of the delivery of plans to new subscribers.
const CHECK_PERIOD: Duration = Duration::from_secs(1);

/// Plans the next best view.
pub(crate) fn run(
    common: &CommonArguments,
    arguments: &PlanArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let stop = if arguments.watch {
        StopSignal::install_for_reader()?
    } else {
        StopSignal::install()?
    };
    let mut planning = ViewPlanning::new(common, arguments)?;
    require_daemon(&common.domain)?;
    let domain = Domain::join(&common.domain, &RunFolder::of_user(), Role::Guest)?;
    if let Err(error) = planning.join(&domain) {
        output.print_status(&format!("the plans are not published: {error}"));
    }
    let mut receiver = SnapshotReceiver::new(&domain)?;
    let Some(snapshot) = awaited_snapshot(&mut receiver, &stop)? else {
        return Ok(ExitCode::SUCCESS);
    };
    if arguments.watch {
        watch(&mut planning, &mut receiver, snapshot, (&stop, output))?;
    } else {
        print(&planning.plan(&snapshot)?, arguments, output);
    }
    Ok(ExitCode::SUCCESS)
}

/// Plans anew whenever it is due, until nobody reads the plans.
fn watch(
    planning: &mut ViewPlanning<'_>,
    receiver: &mut SnapshotReceiver,
    first: Snapshot,
    (stop, output): (&StopSignal, &Output),
) -> Result<(), Failure> {
    let mut trigger = PlanTrigger::default();
    let mut first = Some(first);
    let mut next_check = Instant::now() + CHECK_PERIOD;
    let mut told = String::new();
    while !stop.is_raised() && output.is_open() {
        let is_new = receiver.receive()?;
        let is_due = (is_new || first.is_some())
            && receiver.objects().is_some_and(|objects| {
                trigger.note(receiver.world_from_camera(), objects, Instant::now())
            });
        // The frame of a scene may be gone already; the next scene comes soon.
        if is_due && let Some(snapshot) = first.take().or_else(|| receiver.snapshot()) {
            match planning.plan(&snapshot) {
                Ok(document) => print(&document, planning.arguments(), output),
                // Another place or other objects may have a plan again.
                Err(failure) if failure.sentence != told => {
                    output.print_status(&failure.sentence);
                    told = failure.sentence;
                }
                Err(_) => (),
            }
            trigger.planned();
            output.print_status("waiting for another view or other objects; Ctrl-C ends");
        }
        if Instant::now() >= next_check {
            next_check = Instant::now() + CHECK_PERIOD;
            planning.greet()?;
            if !is_running(planning.domain_name()) {
                let sentence = format!(
                    "the daemon of the domain {} has ended; start it with `tabula run`",
                    planning.domain_name()
                );
                return Err(Failure::new(exit_code::NO_DAEMON, sentence));
            }
        }
        stop.sleep(POLL_PERIOD);
    }
    Ok(())
}

fn print(document: &PlanDocument, arguments: &PlanArguments, output: &Output) {
    output.answer(document, || {
        plan_text::text(document, arguments.picture.is_some())
    });
}
