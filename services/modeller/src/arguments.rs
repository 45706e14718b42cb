//! Command-line arguments of `tabula-modeller`.

mod grasp;
mod place;
mod plan;

pub(crate) use grasp::GraspArguments;
pub(crate) use place::PlaceArguments;
pub(crate) use plan::PlanArguments;

use clap::{Args, Parser, Subcommand};
use control_client::TrackReference;
use model_construction::{Config, PoseSigma};
use sensor_noise::DepthNoise;
use service::CommonArguments;

/// Builds the full model of an object from the views of a moving camera, and plans the next best
/// view, grasps and transports.
#[derive(Debug, Parser)]
#[command(name = "tabula-modeller", version, propagate_version = true)]
pub(crate) struct ModellerArguments {
    #[command(flatten)]
    pub(crate) common: CommonArguments,

    /// Print one JSON document instead of text
    #[arg(long, global = true, help_heading = "Common options")]
    pub(crate) json: bool,

    #[command(subcommand)]
    pub(crate) verb: ModellerVerb,
}

/// Subcommands of `tabula-modeller`.
#[derive(Debug, Subcommand)]
pub(crate) enum ModellerVerb {
    /// Build the model of a tracked object while the camera moves around it, until Ctrl-C
    Build(BuildArguments),
    /// Plan the next best view of the objects that the camera sees
    Plan(PlanArguments),
    /// Plan grasps of an object that the camera sees
    Grasp(GraspArguments),
    /// Plan the transport of an object to a place
    Place(PlaceArguments),
    /// List the places of the configuration
    Places,
}

/// Options of the construction of a model.
#[derive(Debug, Clone, Args)]
pub(crate) struct BuildArguments {
    /// Object: its track-id, or words that mean exactly one, such as its label [default: the
    /// object nearest to the middle of the image]
    #[arg(value_name = "TRACK")]
    pub(crate) track: Option<TrackReference>,
    /// Name of the model [default: the label of the object, or track-ID]
    #[arg(long, value_name = "NAME")]
    pub(crate) name: Option<String>,
    /// Give the model this name even if the object is recognised as something else, or an earlier
    /// model of the name has another size
    #[arg(long)]
    pub(crate) anyway: bool,
    /// End after this time, seconds
    #[arg(long, value_name = "S", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) seconds: Option<u64>,
    /// End when the views have led around the object
    #[arg(long)]
    pub(crate) until_closed: bool,
    /// Angle between two views that are fused, degrees
    #[arg(long, value_name = "DEG", default_value_t = 6.0, value_parser = view_step)]
    pub(crate) step_deg: f64,
    /// Side of the voxels of the surface, millimetres
    #[arg(long, value_name = "MM", default_value_t = 2.0, value_parser = voxel_side)]
    pub(crate) voxel_mm: f32,
    /// Uncertainty of the place of the camera, millimetres along each axis
    #[arg(long, value_name = "MM", default_value_t = 10.0, value_parser = sigma)]
    pub(crate) pose_mm: f64,
    /// Uncertainty of the orientation of the camera, degrees about each axis
    #[arg(long, value_name = "DEG", default_value_t = 3.0, value_parser = sigma)]
    pub(crate) pose_deg: f64,
    /// Nice value at which views are added, 0 to 19: with 19 the frames of the daemon go before,
    /// with a smaller one the model is ready sooner
    #[arg(long, value_name = "N", default_value_t = 19, value_parser = clap::value_parser!(u8).range(0..=19))]
    pub(crate) niceness: u8,
    /// Angle by which the object is turned each time, counter-clockwise from above, degrees; for
    /// objects whose shape and colours do not tell it
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = turn)]
    pub(crate) turn_deg: Option<f64>,
    /// Author of the model in the history [default: the user]
    #[arg(long, value_name = "NAME")]
    pub(crate) author: Option<String>,
}

impl BuildArguments {
    /// Configuration of the construction, with the depth noise of the camera.
    pub(crate) fn config(&self, depth_noise: DepthNoise) -> Config {
        Config {
            depth_noise,
            voxel_m: 1e-3 * self.voxel_mm,
            step_min_rad: self.step_deg.to_radians(),
            turn_rad: self.turn_deg.map(f64::to_radians),
            ..Config::default()
        }
    }

    /// Uncertainty of a reported camera pose.
    pub(crate) fn pose_sigma(&self) -> PoseSigma {
        PoseSigma {
            rotation_rad: self.pose_deg.to_radians(),
            translation_m: 1e-3 * self.pose_mm,
        }
    }
}

fn view_step(text: &str) -> Result<f64, String> {
    number_between(text, 1.0, 45.0)
}

fn turn(text: &str) -> Result<f64, String> {
    number_between(text, -90.0, 90.0)
}

fn voxel_side(text: &str) -> Result<f32, String> {
    number_between(text, 0.5, 20.0).map(|number| number as f32)
}

fn sigma(text: &str) -> Result<f64, String> {
    number_between(text, 0.0, 1000.0)
}

fn number_between(text: &str, low: f64, high: f64) -> Result<f64, String> {
    let number = text.parse().ok();
    let number = number.filter(|number| (low..=high).contains(number));
    number.ok_or_else(|| format!("choose from {low} to {high}"))
}
