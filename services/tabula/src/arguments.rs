//! The command line.

mod memory;
mod recognition;
mod world;

pub(crate) use memory::{
    CompactArguments, EntriesArguments, ForgetArguments, ImportArguments, InspectArguments,
    KnowledgeVerb, MemoryVerb, PutArguments,
};
pub(crate) use recognition::{
    AblationArguments, AblationVariant, CrossValidationArguments, DescriptionArguments,
    LearnArguments, OpenEndedArguments, Up, Variant, ViewProtocol,
};

pub(crate) use world::{EventsArguments, HistoryArguments, Point, Time, WorldArguments, WorldVerb};

use crate::sensor::Sensor;
use clap::{Args, Parser, Subcommand};
use service::{CommonArguments, Failure, exit_code};
use simulated_world::ModelSource;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// The perception daemon of a service robot: finds the objects on a table,
/// follows them, and learns their names from people.
#[derive(Debug, Parser)]
#[command(name = "tabula", version, propagate_version = true)]
pub(crate) struct Arguments {
    #[command(flatten)]
    pub(crate) common: CommonArguments,

    /// Print one JSON document instead of text
    #[arg(long, global = true)]
    pub(crate) json: bool,

    #[command(subcommand)]
    pub(crate) verb: Verb,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Verb {
    /// Start the daemon and keep it running until Ctrl-C
    Run(RunArguments),
    /// Show the tracked objects
    Objects {
        /// Show them again and again until Ctrl-C
        #[arg(long)]
        watch: bool,
    },
    /// Ask what a tracked object is
    Ask {
        /// The track
        track_id: u64,
    },
    /// Teach the name of a tracked object
    Teach(LabelArguments),
    /// Correct the name of a tracked object
    Correct(LabelArguments),
    /// Forget a category, whose views then stay without a name; or a track, or a view
    Forget(ForgetArguments),
    /// Give a category another name
    Rename {
        /// Its name
        from: String,
        /// Its new name
        to: String,
        /// Who asks [default: the user's name]
        #[arg(long, value_name = "NAME")]
        author: Option<String>,
    },
    /// Give all views of a category the name of another
    Merge {
        /// The category that will be no more
        from: String,
        /// The one that gets its views
        into: String,
        /// Who asks [default: the user's name]
        #[arg(long, value_name = "NAME")]
        author: Option<String>,
    },
    /// Take back the last lesson, or an entry of the history
    Undo {
        /// The entry's number [default: the last lesson of the author that still holds]
        entry: Option<u64>,
        /// Whose lesson [default: the user's name]
        #[arg(long, value_name = "NAME")]
        author: Option<String>,
    },
    /// Learn a folder of labelled views
    Learn(LearnArguments),
    /// List the learned categories
    Categories,
    /// Look into the memory, verify and repair it, export and import it; with or without a daemon
    Memory {
        /// What to do
        #[command(subcommand)]
        verb: MemoryVerb,
    },
    /// What tasks need to know: named texts and files
    Knowledge {
        /// What to do
        #[command(subcommand)]
        verb: KnowledgeVerb,
    },
    /// Show what is and was known of the world: objects, robot, events, tasks
    World(WorldArguments),
    /// Move the arm, or say how it is
    Arm {
        /// What it is to do
        #[command(subcommand)]
        verb: ArmVerb,
    },
    /// Write recordings and views of the simulated table; needs no daemon
    Simulate {
        /// What to write
        #[command(subcommand)]
        verb: SimulateVerb,
    },
    /// Measure how good and how fast the kernels are; needs no daemon
    Evaluate {
        /// What to measure
        #[command(subcommand)]
        verb: EvaluateVerb,
    },
    /// Measure where the time of frames goes; see `tabula latency --help`
    #[command(disable_help_flag = true)]
    Latency {
        /// What tabula-latency understands
        #[arg(
            trailing_var_arg = true,
            allow_hyphen_values = true,
            value_name = "ARGUMENTS"
        )]
        arguments: Vec<OsString>,
    },
    /// Show how the daemon's processes are
    Status,
    /// Check this machine and explain what is wrong
    Doctor,
}

/// What is written of the simulated table.
#[derive(Debug, Subcommand)]
pub(crate) enum SimulateVerb {
    /// A sequence of a scene: colour, depth, poses, masks and ground truth
    Scene(SceneArguments),
    /// Views of single objects for learning, in the layout of the Washington dataset
    Views(ViewsArguments),
    /// Plot the simulated Kinect's depth noise beside the published law
    Sensor {
        /// Folder for the table and the plot
        #[arg(long, value_name = "DIR")]
        out: PathBuf,
    },
    /// List the generated categories
    Categories,
}

/// Which scene, and where it goes.
#[derive(Debug, Args)]
pub(crate) struct SceneArguments {
    /// A scene file (TOML)
    pub(crate) file: Option<PathBuf>,
    /// isolated, pile, bin or set-table [default: isolated]
    #[arg(long, value_name = "KIND")]
    pub(crate) kind: Option<String>,
    /// Number of objects [default: what the kind of scene usually has]
    #[arg(long, value_name = "N")]
    pub(crate) objects: Option<usize>,
    /// Folder of PLY and OBJ models, or `generated` [default: generated]
    #[arg(long, value_name = "DIR")]
    pub(crate) models: Option<PathBuf>,
    /// The same seed gives the same files [default: 1, or the file's]
    #[arg(long, value_name = "S")]
    pub(crate) seed: Option<u64>,
    /// Number of frames
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub(crate) frames: u64,
    /// Frames per second
    #[arg(long, value_name = "HZ", default_value_t = 30.0)]
    pub(crate) rate: f64,
    /// Folder for the sequence
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
}

/// Which objects, how many views, and where they go.
#[derive(Debug, Args)]
pub(crate) struct ViewsArguments {
    /// Folder of PLY and OBJ models, or `generated`
    #[arg(long, value_name = "DIR", default_value = "generated")]
    pub(crate) models: PathBuf,
    /// Views of each object, spread over three heights
    #[arg(long, value_name = "N", default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) views: u32,
    /// Objects of each generated category
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u64).range(1..=1000))]
    pub(crate) instances: u64,
    /// Only this category; may be given more than once [default: all]
    #[arg(long, value_name = "NAME")]
    pub(crate) category: Vec<String>,
    /// The same seed gives the same files
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Folder for the views
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
}

/// What is measured.
#[derive(Debug, Subcommand)]
pub(crate) enum EvaluateVerb {
    /// Compare what detection finds with labelled scenes, and time it on one thread
    Detection(DetectionArguments),
    /// Track the objects of simulated scenes and compare with the truth
    Tracking(TrackingArguments),
    /// Let a simulated teacher introduce categories, ask and correct
    OpenEnded(OpenEndedArguments),
    /// Let the simulated teacher compare variants on the same questions
    Ablation(AblationArguments),
    /// Recognise each part of the views by the others
    CrossValidation(CrossValidationArguments),
}

/// Which scenes, and where the results go.
#[derive(Debug, Args)]
pub(crate) struct DetectionArguments {
    /// Folder of labelled PCD scenes or of a simulated sequence, or a folder of such folders
    pub(crate) dataset: PathBuf,
    /// Folder for the figures, the page and the pictures
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Folder for result and truth as raw images of labels
    #[arg(long, value_name = "DIR")]
    pub(crate) labels: Option<PathBuf>,
    /// Seed of detection; the same seed gives the same result
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// How often detection is timed on each scene
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(crate) repeats: u32,
}

/// Which scenes, and where the results go.
#[derive(Debug, Args)]
pub(crate) struct TrackingArguments {
    /// A scene file (TOML), a folder of them, or a recorded sequence with poses [default: the
    /// scenes of this program]
    pub(crate) dataset: Option<PathBuf>,
    /// Folder for the figures, the page and the pictures
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// How many seeds each scene is played from
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u64).range(1..=10_000))]
    pub(crate) seeds: u64,
    /// The first seed
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Only the scene of this name; can be given several times
    #[arg(long, value_name = "NAME")]
    pub(crate) scene: Vec<String>,
    /// What the tracks of a recording without truth are: lines of `track_id,object-name`
    #[arg(long, value_name = "FILE")]
    pub(crate) labels: Option<PathBuf>,
}

impl SceneArguments {
    /// Where the models come from.
    pub(crate) fn models(&self) -> ModelSource {
        self.models
            .as_deref()
            .map_or(ModelSource::Generated, model_source)
    }
}

impl ViewsArguments {
    /// Where the models come from.
    pub(crate) fn models(&self) -> ModelSource {
        model_source(&self.models)
    }
}

fn model_source(path: &Path) -> ModelSource {
    if path == Path::new("generated") {
        ModelSource::Generated
    } else {
        ModelSource::Folder(path.to_owned())
    }
}

/// What the arm is to do. Each waits until it is done, unless told not to.
#[derive(Debug, Subcommand)]
pub(crate) enum ArmVerb {
    /// Say how it is
    State,
    /// Move the gripper to a pose
    Move(ArmMove),
    /// Fold away, out of the camera's view
    Home(ArmWait),
    /// Open the fingers and let go
    Open(ArmWait),
    /// Close the fingers until they hold something
    Close(ArmWait),
    /// Stop at once
    Stop,
}

/// A pose for the gripper.
#[derive(Debug, Args)]
pub(crate) struct ArmMove {
    /// Position of the point between the fingers, world frame, metres
    #[arg(allow_negative_numbers = true)]
    pub(crate) x: f64,
    /// To the far side
    #[arg(allow_negative_numbers = true)]
    pub(crate) y: f64,
    /// Upwards, from the floor
    #[arg(allow_negative_numbers = true)]
    pub(crate) z: f64,
    /// Tilt of the fingers from pointing straight down towards pointing ahead, degrees
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
    /// Follow a straight line
    #[arg(long)]
    pub(crate) straight: bool,
    #[command(flatten)]
    pub(crate) wait: ArmWait,
}

/// Whether to wait.
#[derive(Debug, Args)]
pub(crate) struct ArmWait {
    /// Do not wait until it is done
    #[arg(long)]
    pub(crate) no_wait: bool,
}

/// A name for a track.
#[derive(Debug, Args)]
pub(crate) struct LabelArguments {
    /// The track
    pub(crate) track_id: u64,
    /// The name
    pub(crate) category: String,
    /// Who teaches [default: the user's name]
    #[arg(long, value_name = "NAME")]
    pub(crate) author: Option<String>,
}

/// Which camera or simulation, and how it is played; handed to tabula-camera or
/// tabula-simulator, which check it.
#[derive(Debug, Args)]
pub(crate) struct RunArguments {
    /// simulation[:SCENE], kinect, fakenect:FOLDER, synthetic[:N], crowd:N, parade:N, or a folder of PCD scenes or
    /// of an RGB-D sequence; SCENE is everyday, isolated, pile, bin, set-table or a TOML file
    /// [default: simulation]
    #[arg(long, value_name = "SOURCE")]
    source: Option<String>,
    /// Frames per second of a recording or a simulation [default: 30]
    #[arg(long, value_name = "HZ", allow_hyphen_values = true)]
    rate: Option<String>,
    /// Objects of a simulated scene
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    objects: Option<String>,
    /// Seed of a simulated scene [default: 1]
    #[arg(long, value_name = "S", allow_hyphen_values = true)]
    seed: Option<String>,
    /// Begin again when the recording ends
    #[arg(long = "loop")]
    looped: bool,
    /// First frame of the recording, in natural name order, counted from 0
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    from: Option<String>,
    /// Frame before which the recording ends
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    to: Option<String>,
    /// Send a frame only when perception and memory have finished the one before
    #[arg(long)]
    lockstep: bool,
    /// Check the configuration and the arguments of all processes, and do nothing else
    #[arg(long)]
    pub(crate) check_config: bool,
    /// Stop when the process that started this one, and has this id, ends
    #[arg(long, value_name = "PID")]
    pub(crate) follow_parent: Option<u32>,
}

impl RunArguments {
    /// The source that is named here.
    pub(crate) fn source(&self) -> Option<&str> {
        self.source.as_deref()
    }

    /// As arguments of tabula-camera or tabula-simulator.
    ///
    /// # Errors
    /// When one is given that the process has no use for.
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
                return Err(Failure::new(exit_code::USAGE, sentence));
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
        let flags = [("--loop", self.looped), ("--lockstep", self.lockstep)];
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
