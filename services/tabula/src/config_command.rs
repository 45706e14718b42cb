//! `tabula config`: check, show, explain and reload the configuration.

mod explain;
mod reload;
mod show;

use crate::arguments::{ConfigVerb, RunArguments};
use crate::daemon::checked_processes;
use crate::sensor::Sensor;
use crate::supervision::{self, ProcessCommand, SupervisionConfig};
use command_line::Output;
use message::ProcessKind;
use serde::Serialize;
use service::{CommonArguments, Configuration, Failure};
use std::process::ExitCode;

/// JSON document of `tabula config check`.
#[derive(Serialize)]
struct CheckDocument {
    /// Files of the configuration, the later ones win; empty for the defaults.
    files: Vec<String>,
}

/// Runs `tabula config`.
pub(crate) fn run(
    common: &CommonArguments,
    verb: &ConfigVerb,
    output: &Output,
) -> Result<ExitCode, Failure> {
    match verb {
        ConfigVerb::Check => check(common, output),
        ConfigVerb::Show => show::run(common, output),
        ConfigVerb::Explain { key } => explain::run(common, key, output),
        ConfigVerb::Reload => reload::run(common, output),
    }
}

/// Checks all sections, each by its process.
fn check(common: &CommonArguments, output: &Output) -> Result<ExitCode, Failure> {
    let found = find(common)?;
    SupervisionConfig::new(&found)?;
    checked_processes(common, &RunArguments::default())?;
    if found.is_of_services() && Sensor::is_camera_of_services(&found)? {
        let arguments = supervision::common_arguments(common);
        supervision::check(&ProcessCommand::new(ProcessKind::CAMERA, arguments))?;
    }
    let document = CheckDocument {
        files: files(&found),
    };
    output.answer(&document, || match document.files.as_slice() {
        [] => "there is no configuration file; the defaults are in order".to_owned(),
        files => format!("the configuration is in order: {}", files.join(", ")),
    });
    Ok(ExitCode::SUCCESS)
}

fn find(common: &CommonArguments) -> Result<Configuration, Failure> {
    let found = Configuration::find(common.config.as_deref(), common.home().path());
    found.map_err(Failure::from)
}

fn files(found: &Configuration) -> Vec<String> {
    found
        .files()
        .map(|file| file.display().to_string())
        .collect()
}
