//! `tabula-lab simulate`: recordings and single-object views of the simulated table.

mod record_scene;
mod record_views;
mod sensor_plot;
pub(crate) mod turntable;

use crate::arguments::SimulateVerb;
use command_line::Output;
use serde::Serialize;
use service::Failure;
use std::process::ExitCode;

/// Runs a subcommand of `tabula-lab simulate`.
///
/// # Errors
/// When the scene or a model is invalid, or a file cannot be written.
pub fn run(verb: &SimulateVerb, output: &Output) -> Result<ExitCode, Failure> {
    match verb {
        SimulateVerb::Scene(arguments) => record_scene::run(arguments, output),
        SimulateVerb::Views(arguments) => record_views::run(arguments, output),
        SimulateVerb::Sensor { out } => sensor_plot::run(out, output),
        SimulateVerb::Categories => {
            categories(output);
            Ok(ExitCode::SUCCESS)
        }
    }
}

#[derive(Serialize)]
struct CategoriesDocument {
    categories: Vec<&'static str>,
}

fn categories(output: &Output) {
    let document = CategoriesDocument {
        categories: simulated_world::category_names(),
    };
    output.answer(&document, || document.categories.join("\n"));
}
