//! Arguments of `tabula task`.

use clap::{Args, Subcommand};
use control_client::TrackReference;

/// Actions on the tasks of the robot.
#[derive(Debug, Subcommand)]
pub(crate) enum TaskVerb {
    /// Tell what a task would do with the table as it is
    Preview {
        /// Task
        #[command(subcommand)]
        task: TaskChoice,
    },
    /// Start a task
    Start(StartArguments),
    /// Show the running task, or the last one
    State,
    /// Show the robot's tasks, newest first
    List {
        /// Maximum number of tasks
        #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..))]
        limit: u32,
    },
    /// Show a task with its steps
    Show(TaskArgument),
    /// Follow the running task to its end
    Watch,
    /// Let the arm rest and the task wait
    Pause(TaskArgument),
    /// Let a task go on after a pause, or after a stop of the arm
    Resume(TaskArgument),
    /// Cancel a task, which sets down what the hand holds
    Cancel(TaskArgument),
    /// Print the state machine of a task as a Mermaid diagram
    Graph {
        /// Kind of the task
        #[arg(value_name = "TASK", value_parser = ["clear-table", "fetch"])]
        task: String,
    },
}

/// Arguments of `tabula task start`.
#[derive(Debug, Args)]
pub(crate) struct StartArguments {
    /// Task
    #[command(subcommand)]
    pub(crate) task: TaskChoice,
    /// Follow the task to its end; its outcome is the exit code
    #[arg(long, global = true)]
    pub(crate) wait: bool,
    /// Author of the task [default: the user's name]
    #[arg(long, value_name = "NAME", global = true)]
    pub(crate) author: Option<String>,
}

/// Task with its parameters.
#[derive(Debug, Subcommand)]
pub(crate) enum TaskChoice {
    /// Carry every object to the place of its category
    ClearTable,
    /// Carry one object to a place
    Fetch(FetchArguments),
}

/// Arguments of a fetch.
#[derive(Debug, Args)]
pub(crate) struct FetchArguments {
    /// Object: its track-id, or words that mean exactly one, such as its label
    #[arg(
        value_name = "TRACK",
        required_unless_present = "category",
        conflicts_with = "category"
    )]
    pub(crate) track: Option<TrackReference>,
    /// Any object of this category, the nearest one first
    #[arg(long, value_name = "NAME")]
    pub(crate) category: Option<String>,
    /// Place to which it is carried [default: hand-over]
    #[arg(long, value_name = "PLACE")]
    pub(crate) to: Option<String>,
}

/// Number of a task.
#[derive(Debug, Args)]
pub(crate) struct TaskArgument {
    /// Number of the task [default: the running one, or the last]
    #[arg(value_name = "ID")]
    pub(crate) task_id: Option<u64>,
}
