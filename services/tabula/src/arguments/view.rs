//! Arguments of `tabula view`, `tabula grasp` and `tabula place`.

use super::LabArguments;
use clap::Subcommand;

/// Subcommands of `tabula view`.
#[derive(Debug, Subcommand)]
pub(crate) enum ViewVerb {
    /// Plan the next best view of the objects that the camera sees; see `tabula view plan --help`
    #[command(disable_help_flag = true)]
    Plan(LabArguments),
}

/// Subcommands of `tabula grasp`.
#[derive(Debug, Subcommand)]
pub(crate) enum GraspVerb {
    /// Plan grasps of an object that the camera sees; see `tabula grasp plan --help`
    #[command(disable_help_flag = true)]
    Plan(LabArguments),
}

/// Subcommands of `tabula place`.
#[derive(Debug, Subcommand)]
pub(crate) enum PlaceVerb {
    /// Plan the transport of an object to a place; see `tabula place plan --help`
    #[command(disable_help_flag = true)]
    Plan(LabArguments),
    /// List the places of the configuration, and how much of each the arm reaches
    #[command(disable_help_flag = true)]
    List(LabArguments),
}

impl ViewVerb {
    /// Verb of `tabula-modeller`, with its arguments.
    pub(crate) fn modeller(&self) -> (&'static str, &LabArguments) {
        match self {
            Self::Plan(plan) => ("plan", plan),
        }
    }
}

impl GraspVerb {
    /// Verb of `tabula-modeller`, with its arguments.
    pub(crate) fn modeller(&self) -> (&'static str, &LabArguments) {
        match self {
            Self::Plan(plan) => ("grasp", plan),
        }
    }
}

impl PlaceVerb {
    /// Verb of `tabula-modeller`, with its arguments.
    pub(crate) fn modeller(&self) -> (&'static str, &LabArguments) {
        match self {
            Self::Plan(plan) => ("place", plan),
            Self::List(list) => ("places", list),
        }
    }
}
