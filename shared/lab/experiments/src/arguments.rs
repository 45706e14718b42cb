//! Command-line arguments of the experiments.

mod demo;
mod grasping;
mod next_best_view;
mod object_model;
mod recognition;
mod transport;

pub use demo::{DemoArguments, DemoVariant, DemoVerb};
pub use grasping::{GraspJudge, GraspingArguments, ModelHalf};
pub use next_best_view::NextBestViewArguments;
pub use object_model::ModelArguments;
pub use recognition::{
    AblationArguments, AblationVariant, CrossValidationArguments, DescriptionArguments,
    DescriptorVariant, FoldProtocol, LearnArguments, LessonArguments, OpenEndedArguments, UpAxis,
    ViewProtocol,
};
pub use transport::TransportArguments;

use clap::{Args, Subcommand, ValueEnum, ValueHint};
use perceptual_memory::{HistoryLimits, RetentionLimits};
use simulated_world::{Lighting, ModelImport, ModelSource, ModelUnit};
use std::ops::RangeInclusive;
use std::path::PathBuf;

/// Subcommands of `tabula-lab simulate`.
#[derive(Debug, Subcommand)]
pub enum SimulateVerb {
    /// Record an RGB-D sequence of a scene: colour, depth, poses, masks and ground truth
    Scene(SceneArguments),
    /// Render views of single objects for learning, in the layout of the Washington dataset
    Views(ViewsArguments),
    /// Plot the depth noise of the simulated Kinect against the published noise model
    Sensor {
        /// Folder for the table and the plot
        #[arg(long, value_name = "DIR")]
        out: PathBuf,
    },
    /// List the generated categories
    Categories,
}

/// Arguments of `simulate scene`.
#[derive(Debug, Args)]
pub struct SceneArguments {
    /// Scene file to simulate (TOML)
    pub(crate) file: Option<PathBuf>,
    /// isolated, pile, bin, set-table, clutter, shelf or tray [default: isolated]
    #[arg(long, value_name = "KIND")]
    pub(crate) kind: Option<String>,
    /// Number of objects [default: the usual number of the scene]
    #[arg(long, value_name = "N")]
    pub(crate) objects: Option<usize>,
    /// Folder of PLY, OBJ, STL and DAE models, or `generated` [default: generated]
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) models: Option<ModelSource>,
    /// Random seed; the same seed gives the same files [default: 1, or the file's]
    #[arg(long, value_name = "S")]
    pub(crate) seed: Option<u64>,
    /// Number of frames to record
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub(crate) frames: u64,
    /// Frames per second of the recording
    #[arg(long, value_name = "HZ", default_value_t = 30.0)]
    pub(crate) rate: f64,
    /// Output folder for the RGB-D sequence
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
}

/// Arguments of `simulate views`.
#[derive(Debug, Args)]
pub struct ViewsArguments {
    /// Folder of PLY, OBJ, STL and DAE models, or `generated`
    #[arg(long, value_name = "DIR", default_value = "generated", value_hint = ValueHint::DirPath)]
    pub(crate) models: ModelSource,
    /// Unit of the models [default: that of the file (DAE), or guessed from the size of each, and
    /// told]
    #[arg(long, value_name = "UNIT", value_enum)]
    pub(crate) unit: Option<UnitName>,
    /// Upward axis of the models [default: that of the file (DAE), or z; y for an OBJ model that
    /// clearly stands along it, and told]
    #[arg(long, value_name = "AXIS", value_enum)]
    pub(crate) up: Option<ModelAxis>,
    /// Views of each object, spread over three heights
    #[arg(long, value_name = "N", default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) views: u32,
    /// Number of objects of each generated category
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u64).range(1..=1000))]
    pub(crate) instances: u64,
    /// Only this category; may be given more than once [default: all]
    #[arg(long, value_name = "NAME")]
    pub(crate) category: Vec<String>,
    /// Lamps and walls: white, dawn, tungsten, mixed, red-walls, green-walls or blue-walls
    /// [default: lamps that are drawn for every view]
    #[arg(long, value_name = "NAME")]
    pub(crate) lighting: Option<Lighting>,
    /// Random seed; the same seed gives the same files
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Output folder for the views
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
}

/// Trained model of perception.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum TrainedModel {
    /// Network that rates the edges between neighbouring cells as boundaries of objects
    EdgeNetwork,
    /// Trees that decide whether adjacent regions are one object
    RegionMerging,
    /// Metric in which descriptors are compared
    LearnedMetric,
}

/// Arguments of `examples`.
#[derive(Debug, Args)]
pub struct ExamplesArguments {
    /// Model that learns from the examples
    pub(crate) model: TrainedModel,
    /// Folders of labelled scenes, as for `evaluate detection`; of views for the learned metric
    #[arg(required = true, value_name = "DATASET")]
    pub(crate) datasets: Vec<PathBuf>,
    /// NPY file for the examples: a row of features, and the class, for each
    #[arg(long, value_name = "FILE")]
    pub(crate) out: PathBuf,
}

/// Subcommands of `tabula-lab evaluate`.
#[derive(Debug, Subcommand)]
pub enum EvaluateVerb {
    /// Score detection against labelled scenes, and time it on one thread
    Detection(DetectionArguments),
    /// Track the objects of simulated scenes or a recording, and score the tracks against the
    /// ground truth
    Tracking(TrackingArguments),
    /// Open-ended learning: a simulated teacher introduces categories, asks and corrects
    OpenEnded(OpenEndedArguments),
    /// Ablation study: the open-ended protocol for several descriptor variants
    Ablation(AblationArguments),
    /// k-fold cross-validation of recognition
    CrossValidation(CrossValidationArguments),
    /// Recognition under other lamps and beside other tables than those of the lessons
    Lighting(LightingArguments),
    /// One picture played again and again, as it is and with other noise: tracks and labels that
    /// change
    StillPictures(StillPicturesArguments),
    /// Queries in words over the tracked objects of simulated scenes
    Find(FindArguments),
    /// Registration of two views of an object from poses that are far off
    Registration(RegistrationArguments),
    /// Models of objects from simulated views with noisy camera poses, against the true surface
    Model(ModelArguments),
    /// Next best view: entropy against detection, its prediction, and views chosen until the
    /// objects in a bin are found
    NextBestView(NextBestViewArguments),
    /// Grasps of single objects from one view, carried out by the simulated arm
    Grasping(GraspingArguments),
    /// Carry objects of simulated scenes to a place, past what stands there
    Transport(TransportArguments),
}

/// Arguments of `evaluate registration`.
#[derive(Debug, Args)]
pub struct RegistrationArguments {
    /// Folder of pairs of views: files `NAME_src.f32` and `NAME_tgt.f32`, three little-endian
    /// single-precision numbers for each point, metres, both in one frame
    #[arg(value_name = "PAIRS", conflicts_with = "models")]
    pub(crate) pairs: Option<PathBuf>,
    /// In place of pairs: folder of models, or `generated`, of which views are simulated
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) models: Option<ModelSource>,
    /// Number of models, spread over the categories
    #[arg(long, value_name = "N", default_value_t = 20, requires = "models", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(crate) objects: u32,
    /// Angle between the two simulated views, degrees
    #[arg(long, value_name = "DEG", default_value_t = 30.0, requires = "models", value_parser = within(0.0..=180.0))]
    pub(crate) angle: f64,
    /// Random directions of each rotation with each translation
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) starts: u32,
    /// Random seed; the same seed gives the same figures, but for the times
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Folder for the figures and the page [default: none are written]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}

/// Arguments of `evaluate find`.
#[derive(Debug, Args)]
pub struct FindArguments {
    /// Number of simulated scenes
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u64).range(1..=10_000))]
    pub(crate) scenes: u64,
    /// Number of generated queries about each scene
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(0..=1000))]
    pub(crate) queries_per_scene: u32,
    /// Query file (TOML) about these scenes [default: that of the project, which belongs to seed 1]
    #[arg(long, value_name = "FILE")]
    pub(crate) queries: Option<PathBuf>,
    /// Folder of WordNet; without it there are no synonyms
    #[arg(long, value_name = "DIR", default_value = "/usr/share/wordnet")]
    pub(crate) wordnet: PathBuf,
    /// Random seed of the scenes
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Folder for the figures, the page and the pictures
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
}

/// Arguments of `evaluate lighting`.
#[derive(Debug, Args)]
pub struct LightingArguments {
    /// Folder of models of objects with colours, or `generated`
    #[arg(long, value_name = "DIR", default_value = "generated", value_hint = ValueHint::DirPath)]
    pub(crate) models: ModelSource,
    /// Number of objects, spread over the categories
    #[arg(long, value_name = "N", default_value_t = 60, value_parser = clap::value_parser!(u32).range(2..=10_000))]
    pub(crate) objects: u32,
    /// Views of each object under each lighting
    #[arg(long, value_name = "N", default_value_t = 9, value_parser = clap::value_parser!(u32).range(3..=1000))]
    pub(crate) views: u32,
    /// Random seed; the same seed gives the same figures
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Folder for the figures and the page
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
}

/// Arguments of an evaluation on a data set: scenes and output folder.
#[derive(Debug, Args)]
pub struct DetectionArguments {
    /// Folder of labelled PCD scenes or of a simulated sequence, or a folder of such folders
    pub(crate) dataset: PathBuf,
    /// Folder for the figures, the page and the pictures
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Folder for results and ground truth as raw label images
    #[arg(long, value_name = "DIR")]
    pub(crate) labels: Option<PathBuf>,
    /// Score each scene N more times with noise drawn anew, and N times shifted by a few pixels
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=30))]
    pub(crate) draws: u32,
    /// Repetitions of the detection timing on each scene
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(crate) repeats: u32,
}

/// Arguments of an evaluation on a data set: scenes and output folder.
#[derive(Debug, Args)]
pub struct TrackingArguments {
    /// A scene file (TOML), a folder of them, a recorded sequence with poses, or a kind of
    /// simulated scene: everyday, set-table, clutter … [default: the scenes of this program]
    pub(crate) dataset: Option<PathBuf>,
    /// Folder for the figures, the page and the pictures
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Number of seeds to run for each scene
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u64).range(1..=10_000))]
    pub(crate) seeds: u64,
    /// Seed of the first run
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Only the scene of this name; can be given several times
    #[arg(long, value_name = "NAME")]
    pub(crate) scene: Vec<String>,
    /// Labels of the tracks of a recording without ground truth: lines of `track_id,object-name`
    #[arg(long, value_name = "FILE")]
    pub(crate) labels: Option<PathBuf>,
    /// Hand-made ground truth of a recording (TOML): objects at rest, their places and when they
    /// are in view [default: resting-objects.toml of the recording, if it exists]
    #[arg(long, value_name = "FILE")]
    pub(crate) truth: Option<PathBuf>,
    /// Hide the poses of people from tracking, as with a camera alone
    #[arg(long)]
    pub(crate) hidden_people: bool,
}

/// Arguments of the still-picture test.
#[derive(Debug, Args)]
pub struct StillPicturesArguments {
    /// Folder of PCD scenes, an RGB-D sequence or registered images, or a folder of such folders
    pub(crate) dataset: PathBuf,
    /// Folder for the figures and the page
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Number of times that each picture is played
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(21..=10_000))]
    pub(crate) frames: u32,
    /// Use only each N-th picture of a sequence
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) every: u32,
    /// Seed of the noise
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
}

impl ViewsArguments {
    /// Unit and upward axis of the models.
    pub(crate) fn import(&self) -> ModelImport {
        ModelImport {
            unit: self.unit.map(ModelUnit::from),
            up: self.up.map(|up| match up {
                ModelAxis::X => dataset::UpAxis::X,
                ModelAxis::Y => dataset::UpAxis::Y,
                ModelAxis::Z => dataset::UpAxis::Z,
            }),
        }
    }
}

/// Parser of a number in a range.
fn within(range: RangeInclusive<f64>) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| {
        let number = text.parse().ok().filter(|number| range.contains(number));
        number.ok_or_else(|| format!("choose from {} to {}", range.start(), range.end()))
    }
}

/// Unit of files of models or views on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum UnitName {
    /// Metres
    M,
    /// Centimetres
    Cm,
    /// Millimetres
    Mm,
    /// Inches
    In,
}

impl From<UnitName> for ModelUnit {
    fn from(name: UnitName) -> Self {
        match name {
            UnitName::M => Self::Metre,
            UnitName::Cm => Self::Centimetre,
            UnitName::Mm => Self::Millimetre,
            UnitName::In => Self::Inch,
        }
    }
}

/// Upward axis of model files on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ModelAxis {
    /// The x axis
    X,
    /// The y axis
    Y,
    /// The z axis
    Z,
}

/// Evaluation whose scores a sweep compares.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SweepScore {
    /// Detection on labelled scenes
    Detection,
    /// Tracking in simulated scenes
    Tracking,
    /// Cross-validation of recognition
    Recognition,
}

/// Constants of a sweep, the evaluation, and the folder of the results.
#[derive(Debug, Args)]
pub struct SweepArguments {
    /// Constant or default setting of a source file, or all constants of a file
    #[arg(required = true, value_name = "FILE[:NAME]")]
    pub constants: Vec<String>,
    /// Evaluation whose scores are compared
    #[arg(long, value_enum, default_value_t = SweepScore::Detection)]
    pub score: SweepScore,
    /// Data set that the evaluation uses
    #[arg(long, value_name = "DIR")]
    pub dataset: Option<PathBuf>,
    /// Factors to multiply the constants by, one after the other
    #[arg(long, value_name = "F", value_delimiter = ',', default_values_t = [0.5, 2.0])]
    pub factors: Vec<f64>,
    /// Output folder for the table
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

/// Arguments of `age-memory`.
#[derive(Debug, Args)]
pub struct AgeMemoryArguments {
    /// Numbers of changes at which the opening is measured
    #[arg(long, value_name = "N", value_delimiter = ',', default_values_t = [100_000, 1_000_000])]
    pub(crate) changes: Vec<u64>,
    /// Number of categories that are taught
    #[arg(long, value_name = "N", default_value_t = 180, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) categories: u32,
    /// Retention limit of the views of a category
    #[arg(long, value_name = "N", default_value_t = 1000)]
    pub(crate) views_per_category: usize,
    /// Retention limit of the unlabelled views
    #[arg(long, value_name = "N", default_value_t = 20_000)]
    pub(crate) unnamed_views: usize,
    /// Seed of the changes; the same seed gives the same changes
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Folder of the aged store, which must not exist [default: `store` in the output folder]
    #[arg(long, value_name = "DIR")]
    pub(crate) store: Option<PathBuf>,
    /// Output folder for the figures and the table
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Only open the store in this folder and print the cost
    #[arg(long, value_name = "DIR", hide = true)]
    pub(crate) measure_opening: Option<PathBuf>,
    /// Time of that opening, nanoseconds since 1970
    #[arg(long, value_name = "NS", hide = true, default_value_t = 0)]
    pub(crate) clock_ns: u64,
}

impl AgeMemoryArguments {
    /// Retention limits of the aged store; those of the history as configured by default.
    pub(crate) fn limits(&self) -> RetentionLimits {
        RetentionLimits {
            max_views_per_category: self.views_per_category,
            max_unnamed_views: self.unnamed_views,
            history: HistoryLimits::CONFIGURED,
        }
    }
}
