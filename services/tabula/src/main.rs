//! `tabula`: command-line tool that runs the daemon, shows its objects, and teaches names.

mod arguments;
mod arm;
mod command_groups;
mod config_command;
mod daemon;
mod daemon_reload;
mod doctor;
mod find;
mod knowledge;
mod lab_program;
mod learn;
mod memory;
mod missing_document;
mod model;
mod objects;
mod sensor;
mod status;
mod supervision;
mod task;
mod time;
mod track_or_name;
mod world;

use arguments::{CliArguments, Verb};
use command_line::Output;
use control_protocol::RevisionChange;
use service::Failure;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: CliArguments = service::parse_arguments();
    let output = Output::new(arguments.json);
    output.exit_code(execute(&arguments, &output))
}

fn execute(arguments: &CliArguments, output: &Output) -> Result<ExitCode, Failure> {
    arguments.common.check_use(arguments.verb.option_use())?;
    match &arguments.verb {
        Verb::Run(run) => daemon::run(&arguments.common, run, output),
        Verb::Doctor => Ok(doctor::run(&arguments.common, output)),
        Verb::Objects { watch } => objects::objects(&arguments.common, *watch, output),
        Verb::Ask(asked) => match &asked.track {
            Some(track) => objects::ask(&arguments.common, track, output),
            None => objects::question(&arguments.common, output),
        },
        Verb::Find(query) => find::run(&arguments.common, query, output),
        Verb::Config { verb } => config_command::run(&arguments.common, verb, output),
        Verb::Status => status::run(&arguments.common, output),
        Verb::Teach(label) => learn::teach(&arguments.common, label, output),
        Verb::Correct(label) => learn::correct(&arguments.common, label, output),
        Verb::Forget(forget) => learn::forget(&arguments.common, forget, output),
        Verb::Rename {
            from,
            to,
            is_new,
            author,
        } => {
            let (from, to, is_new) = (from.clone(), to.clone(), *is_new);
            let change = RevisionChange::Rename { from, to, is_new };
            learn::revise(&arguments.common, change, author.as_deref(), output)
        }
        Verb::Merge { from, into, author } => {
            let (from, into) = (from.clone(), into.clone());
            let change = RevisionChange::Merge { from, into };
            learn::revise(&arguments.common, change, author.as_deref(), output)
        }
        Verb::Undo { entry, author } => {
            let change = RevisionChange::Undo { sequence: *entry };
            learn::revise(&arguments.common, change, author.as_deref(), output)
        }
        Verb::Redo { author } => {
            let change = RevisionChange::Redo;
            learn::revise(&arguments.common, change, author.as_deref(), output)
        }
        Verb::Learn(lab) => lab_program::become_lab(arguments, "learn", &lab.words),
        Verb::Categories => learn::categories(&arguments.common, output),
        Verb::Memory { verb } => memory::run(&arguments.common, verb, output),
        Verb::Knowledge { verb } => knowledge::run(&arguments.common, verb, output),
        Verb::Model { verb } => model::run(arguments, verb, output),
        Verb::View { verb } => lab_program::become_modeller(arguments, verb.modeller()),
        Verb::Grasp { verb } => lab_program::become_modeller(arguments, verb.modeller()),
        Verb::Place { verb } => lab_program::become_modeller(arguments, verb.modeller()),
        Verb::Simulate(lab) => lab_program::become_lab(arguments, "simulate", &lab.words),
        Verb::Demo(lab) => lab_program::become_lab(arguments, "demo", &lab.words),
        Verb::Evaluate(lab) => lab_program::become_lab(arguments, "evaluate", &lab.words),
        Verb::World(world) => world::run(&arguments.common, world.verb.as_ref(), output),
        Verb::Latency(lab) => lab_program::become_latency(arguments, &lab.words),
        Verb::Record(words) => lab_program::become_recorder(arguments, "record", &words.words),
        Verb::Replay(words) => lab_program::become_recorder(arguments, "replay", &words.words),
        Verb::Arm { verb } => arm::run(&arguments.common, verb, output),
        Verb::Task { verb } => task::run(&arguments.common, verb, output),
    }
}
