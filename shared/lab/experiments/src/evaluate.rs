//! `tabula-lab evaluate`: accuracy and speed of the kernels on recorded and simulated data.

mod ablation;
mod arm_motion;
mod cross_validation;
mod detection;
mod find;
mod grasping;
mod isolated_scene;
mod lighting;
mod metric_examples;
mod next_best_view;
mod object_model;
mod open_ended;
mod open_set;
mod perturbation;
mod recognition;
mod registration;
mod report_parts;
mod scene_views;
mod still_pictures;
pub(crate) mod tabular_report;
mod tracking;
mod transport;
mod view_selection;
mod view_table;
mod world_view;

pub(crate) use metric_examples::MetricExamples;

use crate::arguments::EvaluateVerb;
use command_line::Output;
use service::Failure;
use std::process::ExitCode;

/// Runs an evaluation and prints its report.
///
/// # Errors
/// When the data set cannot be read or a result cannot be written.
pub fn run(verb: &EvaluateVerb, output: &Output) -> Result<ExitCode, Failure> {
    match verb {
        EvaluateVerb::Detection(arguments) => detection::run(arguments, output),
        EvaluateVerb::Tracking(arguments) => tracking::run(arguments, output),
        EvaluateVerb::OpenEnded(arguments) => open_ended::run(arguments, output),
        EvaluateVerb::Ablation(arguments) => ablation::run(arguments, output),
        EvaluateVerb::CrossValidation(arguments) => cross_validation::run(arguments, output),
        EvaluateVerb::Grasping(arguments) => grasping::run(arguments, output),
        EvaluateVerb::Transport(arguments) => transport::run(arguments, output),
        EvaluateVerb::Find(arguments) => find::run(arguments, output),
        EvaluateVerb::Lighting(arguments) => lighting::run(arguments, output),
        EvaluateVerb::StillPictures(arguments) => still_pictures::run(arguments, output),
        EvaluateVerb::Registration(arguments) => registration::run(arguments, output),
        EvaluateVerb::Model(arguments) => object_model::run(arguments, output),
        EvaluateVerb::NextBestView(arguments) => next_best_view::run(arguments, output),
    }
}
