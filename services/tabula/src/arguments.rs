//! Command-line arguments of `tabula`.

mod config;
mod memory;
mod model;
mod task;
mod view;
mod world;

pub(crate) use config::ConfigVerb;

pub(crate) use memory::{
    CompactArguments, EntriesArguments, ForgetArguments, ImportArguments, InspectArguments,
    KnowledgeVerb, MemoryVerb, PutArguments,
};

pub(crate) use model::ModelVerb;

pub(crate) use task::{FetchArguments, StartArguments, TaskArgument, TaskChoice, TaskVerb};

use view::{GraspVerb, PlaceVerb, ViewVerb};

pub(crate) use world::{
    EventsArguments, HistoryArguments, TimeArgument, WorldArguments, WorldPoint, WorldVerb,
};

use crate::command_groups::help_template;
use crate::sensor::Sensor;
use clap::{Args, Parser, Subcommand};
use control_client::TrackReference;
use service::{CommonArguments, Failure, OptionUse};
use std::ffi::OsString;
use std::path::PathBuf;

/// The perception daemon of a service robot: detects and tracks the objects on a table,
/// and learns their categories from people.
#[derive(Debug, Parser)]
#[command(name = "tabula", version, propagate_version = true)]
#[command(help_template = help_template())]
pub(crate) struct CliArguments {
    #[command(flatten)]
    pub(crate) common: CommonArguments,

    /// Print one JSON document instead of text
    #[arg(long, global = true, help_heading = "Common options")]
    pub(crate) json: bool,

    #[command(subcommand)]
    pub(crate) verb: Verb,
}

/// Subcommands of `tabula`.
#[derive(Debug, Subcommand)]
pub(crate) enum Verb {
    /// Start the daemon and keep it running until Ctrl-C
    Run(RunArguments),
    /// Show the tracked objects
    Objects {
        /// Repeat five times a second until Ctrl-C, or until the reader has gone
        #[arg(long)]
        watch: bool,
    },
    /// Ask what a tracked object is, or about which one a lesson would help most
    Ask(AskArguments),
    /// Find objects by words: tabula find "the red mug left of the box"
    Find(FindArguments),
    /// Teach the label of a tracked object
    Teach(LabelArguments),
    /// Correct the label of a tracked object
    Correct(LabelArguments),
    /// Forget a category, whose views stay without a label; or a track; or a view
    Forget(ForgetArguments),
    /// Rename a category
    Rename {
        /// Category to rename
        from: String,
        /// New category name
        to: String,
        /// Accept the new name, even beside one that looks alike
        #[arg(long = "new")]
        is_new: bool,
        /// Author of the change [default: the user's name]
        #[arg(long, value_name = "NAME")]
        author: Option<String>,
    },
    /// Merge a category into another: all its views get the other label
    Merge {
        /// Category whose views move; it ceases to exist
        from: String,
        /// The category that receives the views
        into: String,
        /// Author of the change [default: the user's name]
        #[arg(long, value_name = "NAME")]
        author: Option<String>,
    },
    /// Undo the last change, or an entry of the history; repeated, it walks back
    Undo {
        /// Number of the history entry [default: the author's last change that is still in effect]
        entry: Option<u64>,
        /// Author of the undo, and of the last change [default: the user's name]
        #[arg(long, value_name = "NAME")]
        author: Option<String>,
    },
    /// Redo the change that was undone last; repeated, it walks forward
    Redo {
        /// Author of the redo, and of the undo [default: the user's name]
        #[arg(long, value_name = "NAME")]
        author: Option<String>,
    },
    /// Learn a folder of labelled views; see `tabula learn --help`
    #[command(disable_help_flag = true)]
    Learn(LabArguments),
    /// List the learned categories
    Categories,
    /// Inspect, verify, repair, export and import the memory; also without a daemon
    Memory {
        /// Action on the perceptual memory
        #[command(subcommand)]
        verb: MemoryVerb,
    },
    /// Store and read knowledge for tasks: named texts and files
    Knowledge {
        /// Action on the stored knowledge
        #[command(subcommand)]
        verb: KnowledgeVerb,
    },
    /// Build, list, show, export and forget the full models of objects
    Model {
        /// Action on the stored models
        #[command(subcommand)]
        verb: ModelVerb,
    },
    /// Plan the next best view of the objects
    View {
        /// Action on views
        #[command(subcommand)]
        verb: ViewVerb,
    },
    /// Plan grasps of an object
    Grasp {
        /// Action on grasps
        #[command(subcommand)]
        verb: GraspVerb,
    },
    /// Plan the transport of an object to a place, or list the places
    Place {
        /// Action on places
        #[command(subcommand)]
        verb: PlaceVerb,
    },
    /// Show the present and past of the world model: objects, robot, events, tasks
    World(WorldArguments),
    /// Command the arm, or show its state
    Arm {
        /// Arm command
        #[command(subcommand)]
        verb: ArmVerb,
    },
    /// Start, follow and end the tasks of the robot, such as clearing the table
    Task {
        /// Action on tasks
        #[command(subcommand)]
        verb: TaskVerb,
    },
    /// Write recordings and views of the simulated table; needs no daemon
    #[command(disable_help_flag = true, disable_help_subcommand = true)]
    Simulate(LabArguments),
    /// Evaluate accuracy and speed of the kernels; needs no daemon
    #[command(disable_help_flag = true, disable_help_subcommand = true)]
    Evaluate(LabArguments),
    /// Demonstrate the robot in simulated scenes, in a daemon of its own
    #[command(disable_help_flag = true, disable_help_subcommand = true)]
    Demo(LabArguments),
    /// Measure the end-to-end latency of frames; see `tabula latency --help`
    #[command(disable_help_flag = true)]
    Latency(LabArguments),
    /// Record the daemon to MCAP files, or recover a recording; see `tabula record --help`
    #[command(disable_help_flag = true)]
    Record(LabArguments),
    /// Replay a recording in a daemon; see `tabula replay --help`
    #[command(disable_help_flag = true)]
    Replay(LabArguments),
    /// Check, show, explain and reload the configuration
    Config {
        /// Action on the configuration
        #[command(subcommand)]
        verb: ConfigVerb,
    },
    /// Show the state of the daemon's processes
    Status,
    /// Diagnose this machine and its configuration
    Doctor,
}

impl Verb {
    /// Use of the options of every command. A command of another program checks them there.
    pub(crate) fn option_use(&self) -> OptionUse {
        match self {
            Self::Run(_)
            | Self::Doctor
            | Self::Learn(_)
            | Self::View { .. }
            | Self::Grasp { .. }
            | Self::Place { .. }
            | Self::Simulate(_)
            | Self::Evaluate(_)
            | Self::Demo(_)
            | Self::Latency(_)
            | Self::Record(_)
            | Self::Replay(_)
            | Self::Model {
                verb: ModelVerb::Build(_),
            }
            | Self::Config {
                verb: ConfigVerb::Check | ConfigVerb::Show | ConfigVerb::Explain { .. },
            } => OptionUse::Everything,
            Self::Task {
                verb: TaskVerb::Graph { .. },
            } => OptionUse::Nothing,
            // At a reload the daemon reads its own configuration again.
            Self::Config {
                verb: ConfigVerb::Reload,
            }
            | Self::Objects { .. }
            | Self::Ask(_)
            | Self::Find(_)
            | Self::Teach(_)
            | Self::Correct(_)
            | Self::Forget(_)
            | Self::Rename { .. }
            | Self::Merge { .. }
            | Self::Undo { .. }
            | Self::Redo { .. }
            | Self::Categories
            | Self::Memory { .. }
            | Self::Knowledge { .. }
            | Self::Model { .. }
            | Self::World(_)
            | Self::Arm { .. }
            | Self::Task { .. }
            | Self::Status => OptionUse::Daemon,
        }
    }
}

/// Arguments passed on to another program of the project, which parses them.
#[derive(Debug, Args)]
pub(crate) struct LabArguments {
    /// Arguments passed on to the other program
    #[arg(
        trailing_var_arg = true,
        allow_hyphen_values = true,
        value_name = "ARGUMENTS"
    )]
    pub(crate) words: Vec<OsString>,
}

/// Commands of the arm. Each holds the lease of the arm, and waits for the end of its motion.
#[derive(Debug, Subcommand)]
pub(crate) enum ArmVerb {
    /// Show the state of the arm
    State,
    /// Move the gripper to a pose
    Move(ArmMove),
    /// Fold the arm outside of the camera's view
    Home,
    /// Open the fingers and release the object
    Open {
        /// Distance between the fingers, millimetres [default: as far as they go]
        #[arg(long, value_name = "MM")]
        width_mm: Option<f64>,
    },
    /// Close the fingers until they grip an object
    Close,
    /// Stop the arm at once
    Stop,
    /// Check that the arm and its driver do what tabula counts on; moves the arm a little
    Check {
        /// Agree that the arm is moved: its last joint by up to 70 degrees, and its fingers
        #[arg(long)]
        yes: bool,
    },
}

/// Arguments of `tabula arm move`: pose of the gripper.
#[derive(Debug, Args)]
pub(crate) struct ArmMove {
    /// Position of the point between the fingers (world x), metres
    #[arg(allow_negative_numbers = true)]
    pub(crate) x: f64,
    /// Position towards the far side of the table (world y), metres
    #[arg(allow_negative_numbers = true)]
    pub(crate) y: f64,
    /// Height above the floor (world z), metres
    #[arg(allow_negative_numbers = true)]
    pub(crate) z: f64,
    /// Tilt of the fingers from straight down towards ahead, degrees
    #[arg(
        long,
        default_value_t = 0.0,
        value_name = "DEG",
        allow_hyphen_values = true
    )]
    pub(crate) tilt: f64,
    /// Turn around the vertical, degrees: at 0 the fingers close along world x
    #[arg(
        long,
        default_value_t = 0.0,
        value_name = "DEG",
        allow_hyphen_values = true
    )]
    pub(crate) yaw: f64,
    /// Move the gripper on a straight line
    #[arg(long)]
    pub(crate) straight: bool,
}

/// Arguments of `tabula ask`.
#[derive(Debug, Args)]
pub(crate) struct AskArguments {
    /// Object: its track-id, or words that mean exactly one, such as its label
    #[arg(
        value_name = "TRACK",
        required_unless_present = "teach_me",
        conflicts_with = "teach_me"
    )]
    pub(crate) track: Option<TrackReference>,
    /// Print the question about the object whose name would teach most
    #[arg(long)]
    pub(crate) teach_me: bool,
}

/// Arguments of `tabula find`.
#[derive(Debug, Args)]
pub(crate) struct FindArguments {
    /// Words for the objects, in English
    #[arg(required = true, value_name = "WORDS")]
    pub(crate) words: Vec<String>,
    /// Author name of the person who asks, whom "I" means [default: the user's name]
    #[arg(long, value_name = "NAME")]
    pub(crate) author: Option<String>,
}

/// Arguments of `tabula teach` and `tabula correct`.
#[derive(Debug, Args)]
pub(crate) struct LabelArguments {
    /// Object: its track-id, or words that mean exactly one, such as "the red mug"
    #[arg(value_name = "TRACK")]
    pub(crate) track: TrackReference,
    /// Category name
    pub(crate) category: String,
    /// Make a new category, even beside one whose name looks alike
    #[arg(long = "new")]
    pub(crate) is_new: bool,
    /// Author of the label [default: the user's name]
    #[arg(long, value_name = "NAME")]
    pub(crate) author: Option<String>,
}

/// Sensor options of `tabula run`; passed on to tabula-camera or tabula-simulator, which check
/// them.
#[derive(Debug, Clone, Default, Args)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a flag of the command line"
)]
pub(crate) struct RunArguments {
    /// simulation[:SCENE], kinect, fakenect:FOLDER, synthetic[:N], crowd:N, parade:N, a recording FILE.mcap, or a folder of PCD scenes, of
    /// an RGB-D sequence, or of colour and depth images with intrinsics; SCENE is everyday, isolated, pile, bin, set-table, clutter, shelf, tray or a TOML file
    /// [default: simulation]
    #[arg(long, value_name = "SOURCE")]
    source: Option<String>,
    /// Frames per second of a recording or a simulation [default: 30]
    #[arg(long, value_name = "HZ", allow_hyphen_values = true)]
    rate: Option<String>,
    /// Number of objects in a simulated scene
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    objects: Option<String>,
    /// Seed of a simulated scene [default: 1]
    #[arg(long, value_name = "S", allow_hyphen_values = true)]
    seed: Option<String>,
    /// Start the recording again when it ends
    #[arg(long = "loop")]
    looped: bool,
    /// First frame of the recording, in natural name order, counted from 0
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    from: Option<String>,
    /// Frame number before which the recording ends
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    to: Option<String>,
    /// Send a frame only when perception and memory have finished the previous one
    #[arg(long)]
    lockstep: bool,
    /// Program that drives an arm, which `tabula run` starts and supervises: see the guide Arm
    #[arg(long, value_name = "PROGRAM")]
    pub(crate) arm_driver: Option<PathBuf>,
    /// In lockstep, also wait for a program that reports each frame
    #[arg(long, hide = true, requires = "lockstep")]
    lockstep_observer: bool,
    /// Check the configuration and the arguments of all processes, and do nothing else
    #[arg(long)]
    pub(crate) check_config: bool,
    /// Stop when the parent process with this id ends
    #[arg(long, value_name = "PID")]
    pub(crate) follow_parent: Option<u32>,
}

impl RunArguments {
    /// Value of `--source`.
    pub(crate) fn source(&self) -> Option<&str> {
        self.source.as_deref()
    }

    /// Command-line arguments for tabula-camera or tabula-simulator.
    ///
    /// # Errors
    /// If an option is given that does not apply to the process.
    pub(crate) fn for_sensor(&self, sensor: &Sensor) -> Result<Vec<String>, Failure> {
        let (scene, camera_source) = match sensor {
            Sensor::Camera => (None, self.source.as_ref()),
            Sensor::Simulator { scene } => (scene.as_ref(), None),
        };
        let is_camera = matches!(sensor, Sensor::Camera);
        let for_other = |name: &str, is_given: bool, is_for_camera: bool| {
            let other = if is_camera {
                "a recording"
            } else {
                "a simulation"
            };
            if is_given && is_for_camera != is_camera {
                let sentence = format!("{name} has no meaning for {other}; leave it out");
                return Err(Failure::usage(sentence));
            }
            Ok(())
        };
        for_other("--objects", self.objects.is_some(), false)?;
        for_other("--seed", self.seed.is_some(), false)?;
        for_other("--loop", self.looped, true)?;
        for_other("--from", self.from.is_some(), true)?;
        for_other("--to", self.to.is_some(), true)?;
        let values = [
            ("--source", camera_source),
            ("--scene", scene),
            ("--rate", self.rate.as_ref()),
            ("--objects", self.objects.as_ref()),
            ("--seed", self.seed.as_ref()),
            ("--from", self.from.as_ref()),
            ("--to", self.to.as_ref()),
        ];
        let has_commander = sensor.has_arm() || self.arm_driver.is_some();
        let flags = [
            ("--loop", self.looped),
            ("--lockstep", self.lockstep),
            ("--lockstep-with=observer", self.lockstep_observer),
            (
                "--lockstep-with=executive",
                has_commander && (self.lockstep || sensor.has_arm()),
            ),
        ];
        let values = values
            .into_iter()
            .filter_map(|(name, value)| Some(format!("{name}={}", value?)));
        let flags = flags
            .into_iter()
            .filter(|(_, is_set)| *is_set)
            .map(|(name, _)| name.into());
        Ok(values.chain(flags).collect())
    }
}
