//! `tabula-recorder`: records a running daemon, describes, recovers and replays recordings.

mod arguments;
mod counting_writer;
mod events_file;
mod file_closer;
mod foxglove_view;
mod info;
mod losses;
mod message_queue;
mod queued_message;
mod record;
mod recording_folder;
mod recording_thread;
mod recover;
mod replay;
mod replay_events;
mod split_writer;
mod status_lines;
mod topic_receiver;

use arguments::{RecorderArguments, RecorderVerb};
use command_line::Output;
use service::{Failure, set_private_umask};
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: RecorderArguments = service::parse_arguments();
    let output = Output::new(arguments.json);
    // Recordings show what the camera sees: they are for their user only.
    set_private_umask();
    output.exit_code(execute(&arguments, &output))
}

fn execute(arguments: &RecorderArguments, output: &Output) -> Result<ExitCode, Failure> {
    arguments.common.check_use(arguments.verb.option_use())?;
    match &arguments.verb {
        RecorderVerb::Record(record) => match (&record.recover, &record.info) {
            (Some(damaged), _) => recover::run(damaged, record.out.as_deref(), output),
            (None, Some(file)) => info::run(file, output),
            (None, None) => record::run(&arguments.common, record, output),
        },
        RecorderVerb::Replay(replay) => replay::run(&arguments.common, replay, output),
    }
}
