//! Arguments of the recognition experiments.

use super::{UnitName, within};
use clap::{Args, ValueEnum};
use learning::Metric;
use nalgebra::{UnitVector3, Vector3};
use std::path::PathBuf;

coded_enum::coded_enum! {
    /// Descriptor and classifier
    #[derive(ValueEnum)]
    pub enum DescriptorVariant {
        /// GOOD as published, in the frame of its published program
        Published, "published";
        /// GOOD as in the authors' evaluations, in the same frame
        Workspace, "workspace";
        /// Shape, size and colour, in all axis hypotheses of the object
        Ours, "ours";
    }
}

/// Upward axis of the files of a data set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum UpAxis {
    /// Unknown upward axis
    Unknown,
    /// x axis points up
    X,
    /// y axis points up
    Y,
    /// z axis points up
    Z,
    /// Negative y axis points up, as in the frame of a level camera
    MinusY,
}

coded_enum::coded_enum! {
    /// Split of the views into training and test views
    #[derive(ValueEnum)]
    pub enum ViewProtocol {
        /// Training and test views of the same objects
        View, "view";
        /// Test views of other objects than the training views
        InstanceDisjoint, "instance-disjoint";
    }
}

/// Split of the views of a cross-validation into training and test views
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FoldProtocol {
    /// Training and test views of the same objects
    View,
    /// Test views of other objects than the training views
    InstanceDisjoint,
    /// Test views of other sides of the objects of the training views
    OtherSide,
}

/// Options of description and comparison.
#[derive(Debug, Args)]
pub struct DescriptionArguments {
    /// Descriptor and classifier
    #[arg(long, value_name = "NAME", value_enum, default_value_t = DescriptorVariant::Ours)]
    pub(crate) variant: DescriptorVariant,
    /// Metric of the comparison [default: half-chi-squared-root for published, manhattan for
    /// workspace, euclidean for ours]
    #[arg(long, value_name = "NAME")]
    pub(crate) distance: Option<Metric>,
    /// Compare without colour; only `ours` has any
    #[arg(long)]
    pub(crate) shape_only: bool,
    /// Upward axis in the frame of the points, for `ours` [default: that of the data set]
    #[arg(long, value_name = "AXIS", value_enum)]
    pub(crate) up: Option<UpAxis>,
    /// Number of bins of GOOD along each side
    #[arg(long, value_name = "N", default_value_t = 15, value_parser = bins)]
    pub(crate) bins: usize,
    /// Distance of the nearest view above which an object is unknown [default: none]
    #[arg(long, value_name = "D", value_parser = threshold)]
    pub(crate) threshold: Option<f32>,
    /// Maximum number of views of each category, spread evenly over those available [default: all]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) views_max: Option<u32>,
}

/// Arguments of `tabula-lab learn`.
#[derive(Debug, Args)]
pub struct LearnArguments {
    /// Folder of views in the layout of the Washington dataset, or with a folder of PCD files for
    /// each category
    pub(crate) folder: PathBuf,
    /// Upward axis in the frame of the points [default: that of the data set]
    #[arg(long, value_name = "AXIS", value_enum)]
    pub(crate) up: Option<UpAxis>,
    /// Unit of the points [default: metres in the layout of the Washington dataset; otherwise
    /// guessed from the sizes of the views of each category, and told]
    #[arg(long, value_name = "UNIT", value_enum)]
    pub(crate) unit: Option<UnitName>,
    /// Make new categories, even beside ones whose names look alike
    #[arg(long = "new")]
    pub(crate) is_new: bool,
    /// Author of the labels [default: the user's name]
    #[arg(long, value_name = "NAME")]
    pub(crate) author: Option<String>,
}

/// Options of open-ended learning.
#[derive(Debug, Args)]
pub struct LessonArguments {
    /// Folder of views in the layout of the Washington dataset, or with a folder of PCD files for
    /// each category
    pub(crate) dataset: PathBuf,
    /// Folder for the figures and the page
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Seed of the first run; the next run has the next seed
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Accuracy at which a category is learned
    #[arg(long, value_name = "A", default_value_t = 0.67)]
    pub(crate) tau: f64,
    /// Split of the views into training and test views [default: instance-disjoint where at least
    /// half of the categories have two objects that are known]
    #[arg(long, value_name = "NAME", value_enum)]
    pub(crate) protocol: Option<ViewProtocol>,
}

/// Arguments of `evaluate open-ended`.
#[derive(Debug, Args)]
pub struct OpenEndedArguments {
    #[command(flatten)]
    pub(crate) lessons: LessonArguments,
    #[command(flatten)]
    pub(crate) description: DescriptionArguments,
    /// Number of runs with different seeds
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u64).range(1..=10_000))]
    pub(crate) runs: u64,
    /// Share of the questions that show a category which was not taught yet, 0 to 0.9
    #[arg(long, value_name = "P", default_value_t = 0.0)]
    pub(crate) open_set_share: f64,
    /// CSV file for all questions and answers
    #[arg(long, value_name = "FILE")]
    pub(crate) log: Option<PathBuf>,
}

coded_enum::coded_enum! {
    /// Descriptor variant of an ablation study.
    #[derive(ValueEnum)]
    pub enum AblationVariant {
        /// GOOD as published, in the frame of its published program
        Published, "published";
        /// GOOD as in the authors' evaluations, in the same frame
        Workspace, "workspace";
        /// Shape, size and colour, in all axis hypotheses of the object
        Ours, "ours";
        /// Our descriptor without colour
        OursShapeOnly, "ours-shape-only";
        /// Our descriptor without object size
        OursNoSize, "ours-no-size";
        /// Our descriptor without the metric projections
        OursNoShape, "ours-no-shape";
        /// Our descriptor without the box profile
        OursNoProfile, "ours-no-profile";
        /// Our descriptor without size, colour and box profile: the projections only
        OursProjectionsOnly, "ours-projections-only";
        /// Our descriptor; the nearest view decides instead of the local ridge regression
        OursNearestView, "ours-nearest-view";
        /// Our descriptor, comparing only the first axis hypothesis
        OursSingleReading, "ours-single-reading";
        /// Our descriptor without a known upward axis
        OursPrincipal, "ours-principal";
    }
}

/// Arguments of `evaluate ablation`.
#[derive(Debug, Args)]
pub struct AblationArguments {
    #[command(flatten)]
    pub(crate) lessons: LessonArguments,
    /// Variants [default: all]; `ours` is always among them
    #[arg(long, value_name = "NAMES", value_enum, value_delimiter = ',')]
    pub(crate) variants: Vec<AblationVariant>,
    /// Number of runs of each variant
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u64).range(2..=10_000))]
    pub(crate) runs: u64,
    /// Number of bins of GOOD along each side
    #[arg(long, value_name = "N", default_value_t = 15, value_parser = bins)]
    pub(crate) bins: usize,
    /// Maximum number of views of each category, spread evenly over those available [default: all]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) views_max: Option<u32>,
}

/// Arguments of `evaluate cross-validation`.
#[derive(Debug, Args)]
pub struct CrossValidationArguments {
    /// Folder of views in the layout of the Washington dataset, or with a folder of PCD files for
    /// each category
    #[arg(required_unless_present = "scenes")]
    pub(crate) dataset: Option<PathBuf>,
    /// Number of scenes to simulate, instead of a data set; uses the objects that detection finds [default: 360]
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "360",
        conflicts_with_all = ["dataset", "views_max", "protocol", "contiguous", "open_set_share"],
        value_parser = clap::value_parser!(u32).range(12..=100_000))]
    pub(crate) scenes: Option<u32>,
    #[command(flatten)]
    pub(crate) description: DescriptionArguments,
    /// Folder for the figures, the page and the confusion matrix
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Number of cross-validation folds
    #[arg(long, value_name = "K", default_value_t = 10, value_parser = clap::value_parser!(u32).range(2..=1000))]
    pub(crate) folds: u32,
    /// Random seed of the folds
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Split: any views, the views of an object in one fold, or those of a side of it [default:
    /// instance-disjoint where objects are known]
    #[arg(long, value_name = "NAME", value_enum, conflicts_with = "contiguous")]
    pub(crate) protocol: Option<FoldProtocol>,
    /// Share of the categories that each fold withholds from training and asks about, 0 to 0.9
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = within(0.0..=0.9))]
    pub(crate) open_set_share: f64,
    /// Number of views of different sides of an object that are asked together, as from a track
    #[arg(long, value_name = "N", default_value_t = 1, conflicts_with = "scenes",
        value_parser = clap::value_parser!(u32).range(1..=100))]
    pub(crate) sides: u32,
    /// Contiguous slices of the listed views, not shuffled
    #[arg(long)]
    pub(crate) contiguous: bool,
    /// CSV file for all questions and answers
    #[arg(long, value_name = "FILE")]
    pub(crate) log: Option<PathBuf>,
}

impl UpAxis {
    /// Unit vector; `None` for an unknown axis.
    pub(crate) fn direction(self) -> Option<UnitVector3<f64>> {
        match self {
            Self::Unknown => None,
            Self::X => Some(Vector3::x_axis()),
            Self::Y => Some(Vector3::y_axis()),
            Self::Z => Some(Vector3::z_axis()),
            Self::MinusY => Some(-Vector3::y_axis()),
        }
    }
}

impl DescriptionArguments {
    /// Given metric, else the default of the descriptor.
    pub(crate) fn metric(&self) -> Metric {
        self.distance.unwrap_or(match self.variant {
            DescriptorVariant::Published => Metric::HalfChiSquaredRoot,
            DescriptorVariant::Workspace => Metric::Manhattan,
            DescriptorVariant::Ours => Metric::Euclidean,
        })
    }
}

fn bins(text: &str) -> Result<usize, String> {
    let number = text.parse().ok().filter(|n| (2..=64).contains(n));
    number.ok_or_else(|| "choose from 2 to 64, 15 usually".to_owned())
}

fn threshold(text: &str) -> Result<f32, String> {
    let number = text.parse().ok();
    let number = number.filter(|number: &f32| number.is_finite() && *number >= 0.0);
    number.ok_or_else(|| "choose a distance of 0 or more".to_owned())
}
