//! Arguments of `tabula view` and `tabula grasp`.

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
