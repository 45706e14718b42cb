//! `tabula memory`: inspection, maintenance, export and import of the perceptual memory.

mod exchange;
mod inspect;
mod upkeep;

use crate::arguments::MemoryVerb;
use command_line::Output;
use service::{CommonArguments, Failure};
use std::process::ExitCode;

/// Runs a subcommand of `tabula memory`.
pub(crate) fn run(
    common: &CommonArguments,
    verb: &MemoryVerb,
    output: &Output,
) -> Result<ExitCode, Failure> {
    match verb {
        MemoryVerb::Stats => inspect::stats(common, output),
        MemoryVerb::Inspect(arguments) => inspect::views(common, arguments, output),
        MemoryVerb::History(arguments) => inspect::history(common, arguments, output),
        MemoryVerb::Verify => upkeep::verify(common, output),
        MemoryVerb::Repair => upkeep::repair(common, output),
        MemoryVerb::Compact(arguments) => upkeep::compact(common, arguments, output),
        MemoryVerb::Export { file } => exchange::export(common, file, output),
        MemoryVerb::Import(arguments) => exchange::import(common, arguments, output),
    }
}
