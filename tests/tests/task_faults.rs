//! Faults of tasks, in lockstep: whatever happens in whatever phase, nothing collides, nothing is dropped,
//! and the task goes on or ends with a sentence and its record.

mod rehearsal;

use crate::daemon::Sandbox;
use crate::documents::random_id;
use control_protocol::{Labelling, TaskKind, TaskOrder, TaskReport, request};
use message::ProcessKind;
use random::Random;
use rehearsal::{ENDS, Rehearsal};
use rustix::process::Signal;

/// Can to be fetched, and a carton beside it that must stay where it is. The camera looks at the arm
/// from the other side of the table.
const SCENE: &str = "
seed = 3
[arm]
position_m = [0.0, -0.50, 0.70]
yaw_deg = 90.0
[camera]
azimuth_deg = 180.0
elevation_deg = 50.0
distance_m = 1.1
look_at_m = [0.0, -0.1, 0.74]
[[object]]
category = 'soda-can'
position_m = [-0.06, -0.12]
[[object]]
category = 'milk-carton'
position_m = [0.14, -0.10]
";
/// Place of what is fetched.
const PLACES: &str = "
[places.hand-over]
outline = [[-0.50, -0.36], [-0.26, -0.36], [-0.26, -0.06], [-0.50, -0.06]]
";
/// The same, too small for anything.
const TINY_PLACE: &str = "
[places.hand-over]
outline = [[-0.34, -0.26], [-0.31, -0.26], [-0.31, -0.23], [-0.34, -0.23]]
";
/// Person who takes the can away during the approach.
const THIEF: &str = "
[person]
[[person.action]]
at_s = 8.5
do = 'remove'
object = 1
";
/// Person who holds a hand over the table, with the carton in it, while the arm works.
const BYSTANDER: &str = "
[person]
[[person.action]]
at_s = 9.0
do = 'lift'
object = 2
for_s = 6.0
";
/// Phases in which something happens.
const PHASES: [&str; 12] = [
    "look",
    "plan",
    "reach",
    "approach",
    "close",
    "lift",
    "check_lift",
    "carry",
    "lower",
    "retreat",
    "leave",
    "check_place",
];
/// Number of frames until the objects are known.
const FIRST_FRAMES: u64 = 60;
/// Number of frames of a task at most: five minutes.
const TASK_FRAMES: u64 = 9000;
/// Number of frames of a pause, or until a person lets the robot go on.
const PAUSE_FRAMES: u64 = 45;
/// Number of faults that the tests of each day draw from all.
const N_DRAWN: usize = 12;
/// Number of tests between which they are divided.
const N_PARTS: usize = 4;

/// Fault during a task.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum TaskFault {
    Cancel,
    Pause,
    Stop,
    Kill(ProcessKind),
    Relabel,
    SecondOrder,
    AbsentObject,
    FullPlace,
    Theft,
    HandInTheWay,
}

/// Fault with the phase in which it happens.
type Trial = (TaskFault, Option<&'static str>);

/// All faults in all phases.
fn all_trials() -> Vec<Trial> {
    let anywhere = [
        TaskFault::Cancel,
        TaskFault::Pause,
        TaskFault::Stop,
        TaskFault::Kill(ProcessKind::EXECUTIVE),
        TaskFault::Kill(ProcessKind::PERCEPTION),
        TaskFault::Kill(ProcessKind::MEMORY),
        TaskFault::Relabel,
        TaskFault::SecondOrder,
    ];
    let anywhere = anywhere
        .iter()
        .flat_map(|fault| PHASES.map(|phase| (*fault, Some(phase))));
    let once = [
        TaskFault::AbsentObject,
        TaskFault::FullPlace,
        TaskFault::Theft,
        TaskFault::HandInTheWay,
    ];
    anywhere.chain(once.map(|fault| (fault, None))).collect()
}

/// Trials of one part of those that are drawn: of all by a seed.
fn drawn(part: usize) -> Vec<Trial> {
    let seed = std::env::var("TABULA_FAULT_SEED").map_or(1, |seed| seed.parse().unwrap());
    let mut trials = all_trials();
    Random::from_seed(seed).shuffle(&mut trials);
    trials.truncate(N_DRAWN);
    trials.into_iter().skip(part).step_by(N_PARTS).collect()
}

fn order(category: &str) -> TaskOrder {
    TaskOrder {
        kind: TaskKind::Fetch,
        category: Some(category.to_owned()),
        ..TaskOrder::default()
    }
}

/// Teaches the name of the can, by either verb.
fn name_the_can(rehearsal: &mut Rehearsal<'_>, name: &str, is_correction: bool) -> u64 {
    let scene = rehearsal.ask(&request::objects()).unwrap();
    let can = scene.objects.iter();
    let can = can
        .min_by(|a, b| a.position_m[0].total_cmp(&b.position_m[0]))
        .unwrap();
    let labelling = Labelling {
        id: random_id(),
        author: "tests".to_owned(),
        track_id: can.track_id,
        category: name.to_owned(),
        is_new: false,
    };
    let lesson = if is_correction {
        request::correct(labelling)
    } else {
        request::teach(labelling)
    };
    rehearsal.ask(&lesson).unwrap();
    can.track_id
}

/// Rehearses one fault; returns what went wrong.
fn rehearse((fault, phase): Trial) -> Vec<String> {
    let sandbox = Sandbox::new();
    sandbox.configure(if fault == TaskFault::FullPlace {
        TINY_PLACE
    } else {
        PLACES
    });
    let person = match fault {
        TaskFault::Theft => THIEF,
        TaskFault::HandInTheWay => BYSTANDER,
        _ => "",
    };
    let mut rehearsal = Rehearsal::start(&sandbox, &format!("{SCENE}{person}"));
    rehearsal.wait(FIRST_FRAMES);
    rehearsal.frame(|it| name_the_can(it, "can", false));
    rehearsal.wait(10);
    let wanted = if fault == TaskFault::AbsentObject {
        "spoon"
    } else {
        "can"
    };
    rehearsal.frame(|it| {
        let order = request::order_task(random_id(), "tests".to_owned(), order(wanted));
        it.ask(&order).unwrap()
    });
    if let Some(phase) = phase {
        let reached = rehearsal.until(&[&[phase], &ENDS[..]].concat(), TASK_FRAMES);
        // An attempt that fails before the phase is another rehearsal's.
        if reached.phase == phase {
            inject(&mut rehearsal, fault, reached.task_id.unwrap());
        }
    }
    let end = rehearsal.until(&ENDS, TASK_FRAMES);
    rehearsal.wait(PAUSE_FRAMES);
    check_end(&mut rehearsal, fault, &end);
    rehearsal.stop()
}

/// Lets a fault happen in the present phase.
fn inject(rehearsal: &mut Rehearsal<'_>, fault: TaskFault, task: u64) {
    match fault {
        TaskFault::Cancel => {
            // A task that ended in this frame refuses it.
            let _ = rehearsal.frame(|it| it.ask(&request::cancel_task(task)));
        }
        TaskFault::Pause => {
            rehearsal
                .frame(|it| it.ask(&request::pause_task(task)))
                .unwrap();
            rehearsal.wait(PAUSE_FRAMES);
            let paused = rehearsal.task();
            if !paused.is_paused {
                rehearsal
                    .faults
                    .push(format!("the task is not paused: {paused:?}"));
            }
            rehearsal
                .frame(|it| it.ask(&request::resume_task(task)))
                .unwrap();
        }
        TaskFault::Stop => {
            rehearsal.frame(|it| it.daemon.ask(&["arm", "stop"]));
            rehearsal.wait(PAUSE_FRAMES);
            // Where the arm had nothing to do, the task has not noticed.
            let _ = rehearsal.frame(|it| it.ask(&request::resume_task(task)));
        }
        TaskFault::Kill(process) => {
            rehearsal.frame(|it| it.daemon.signal(process, Signal::KILL));
        }
        TaskFault::Relabel => {
            rehearsal.frame(|it| name_the_can(it, "tin", true));
        }
        TaskFault::SecondOrder => {
            let order = request::order_task(random_id(), "tests".to_owned(), order("can"));
            let answer = rehearsal.frame(|it| it.ask(&order));
            if !answer.is_err_and(|sentence| sentence.contains("runs")) {
                rehearsal.faults.push("a second order was taken".to_owned());
            }
        }
        TaskFault::AbsentObject
        | TaskFault::FullPlace
        | TaskFault::Theft
        | TaskFault::HandInTheWay => {}
    }
}

/// Notes what is wrong at the end of a task.
fn check_end(rehearsal: &mut Rehearsal<'_>, fault: TaskFault, end: &TaskReport) {
    println!(
        "{fault:?}: {} after {} frames: {}",
        end.phase, rehearsal.n_frames, end.sentence
    );
    let mut wrong = Vec::new();
    if end.sentence.is_empty() {
        wrong.push("the task ends without a sentence".to_owned());
    }
    let may_succeed = !matches!(
        fault,
        TaskFault::AbsentObject | TaskFault::FullPlace | TaskFault::Theft
    );
    if !may_succeed && end.phase != "failed" {
        wrong.push(format!("the task ends as {}", end.phase));
    }
    let arm = rehearsal.ask(&request::arm()).unwrap();
    if arm.is_holding && !end.sentence.contains("hand") {
        wrong.push("the hand holds something, and the task does not tell".to_owned());
    }
    let task = end.task_id.unwrap();
    let record = rehearsal.ask(&request::task(task)).unwrap();
    if record.state != end.phase {
        wrong.push(format!("the record says {}", record.state));
    }
    rehearsal.faults.extend(wrong);
    if fault != TaskFault::HandInTheWay {
        rehearsal.check_unmoved("milk-carton");
    }
}

/// Rehearses some faults, and tells of all that went wrong.
fn check(trials: &[Trial]) {
    let mut wrong = Vec::new();
    for trial in trials {
        let faults = rehearse(*trial);
        println!("{trial:?}: {faults:?}");
        wrong.extend(
            faults
                .into_iter()
                .map(|fault| format!("{trial:?}: {fault}")),
        );
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn task_faults_of_the_first_part_are_told_and_do_no_harm() {
    check(&drawn(0));
}

#[test]
fn task_faults_of_the_second_part_are_told_and_do_no_harm() {
    check(&drawn(1));
}

#[test]
fn task_faults_of_the_third_part_are_told_and_do_no_harm() {
    check(&drawn(2));
}

#[test]
fn task_faults_of_the_fourth_part_are_told_and_do_no_harm() {
    check(&drawn(3));
}

#[test]
#[ignore = "long"]
fn long_all_task_faults_are_told_and_do_no_harm() {
    check(&all_trials());
}
