//! Scene description: furniture, camera, objects, arm and person.

use crate::action::PersonPlan;
use crate::arm_mount::ArmMount;
use crate::camera_mount::CameraMount;
use crate::furniture::{Bin, Shelf, TableDimensions, TableFinish, Tray};
use crate::lighting::Lighting;
use crate::model_choice::ModelChoice;
use geometry::RigidTransform;
use nalgebra::UnitQuaternion;
use rendering::kinect::SensorModel;

coded_enum::coded_enum! {
    /// Kind of generated scene.
    #[derive(Default)]
    pub enum SceneKind {
        /// Objects apart from each other in their upright poses.
        #[default]
        Isolated, "isolated";
        /// Objects dropped onto one heap in the middle of the table.
        Pile, "pile";
        /// Objects dropped into a bin (Kasaei et al. 2018, synthetic dataset).
        Bin, "bin";
        /// Table set for a meal: place settings, bottles and bowls.
        SetTable, "set-table";
        /// Crowded table top: stacks, bridges, filled containers, leaning and overhanging objects.
        Clutter, "clutter";
        /// Objects upright on the boards of a shelf.
        Shelf, "shelf";
        /// Objects upright on a tray and beside it.
        Tray, "tray";
    }
}

impl SceneKind {
    /// Default number of objects; 20 in a bin as in the paper.
    pub fn default_n_objects(self) -> usize {
        match self {
            Self::Isolated => 6,
            Self::Pile | Self::Tray => 8,
            Self::Bin => 20,
            Self::SetTable => 14,
            Self::Clutter => 18,
            Self::Shelf => 10,
        }
    }
}

impl std::str::FromStr for SceneKind {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        let known = Self::ALL.into_iter().find(|kind| kind.word() == word);
        known.ok_or_else(|| {
            let words: Vec<_> = Self::ALL.iter().map(|kind| kind.word()).collect();
            format!(
                "`{word}` is no kind of scene; there are {}",
                words.join(", ")
            )
        })
    }
}

/// Initial placement of an object.
#[derive(Debug, Clone, PartialEq)]
pub enum ObjectPlacement {
    /// Object placed upright on the table, on a board of the shelf or on the tray.
    Upright {
        /// Position on the table, world x and y, metres.
        position_m: [f64; 2],
        /// Yaw of the object about the vertical, radians.
        yaw_rad: f64,
        /// Height over the table of what carries it, metres.
        raised_m: f64,
    },
    /// Object dropped from the air.
    Dropped {
        /// Initial pose of the object, world frame.
        world_from_object: RigidTransform,
    },
    /// Object lowered onto what stands at its position, and released there.
    Lowered {
        /// Position on the table, world x and y, metres.
        position_m: [f64; 2],
        /// Initial orientation of the object, world frame.
        rotation: UnitQuaternion<f64>,
    },
}

/// Object of a scene with its placement.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectPlan {
    /// Model of the planned object.
    pub model: ModelChoice,
    /// Initial placement of the object.
    pub placement: ObjectPlacement,
}

/// Complete description of a simulated scene.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Seed of all random streams.
    pub seed: u64,
    /// Dimensions of the table.
    pub table: TableDimensions,
    /// Colour and pattern of the table.
    pub table_finish: TableFinish,
    /// Lamps and walls of the room.
    pub lighting: Lighting,
    /// Bin on the table, if any.
    pub bin: Option<Bin>,
    /// Boards over the table, which is then the lowest board of a shelf, if any.
    pub shelf: Option<Shelf>,
    /// Tray on the table, if any.
    pub tray: Option<Tray>,
    /// Mounting pose of the camera.
    pub camera: CameraMount,
    /// Objects, in the order in which they are put down.
    pub objects: Vec<ObjectPlan>,
    /// Mounting pose of the arm; `None` for no arm.
    pub arm: Option<ArmMount>,
    /// Behaviour of the person; `None` for no person.
    pub person: Option<PersonPlan>,
    /// Sensor model of the simulated Kinect.
    pub sensor: SensorModel,
    /// Duration of the scenario, seconds; `None` for unspecified.
    pub duration_s: Option<f64>,
}

impl Default for Scene {
    /// Scene with an empty table.
    fn default() -> Self {
        Self {
            seed: 1,
            table: TableDimensions::default(),
            table_finish: TableFinish::default(),
            lighting: Lighting::default(),
            bin: None,
            shelf: None,
            tray: None,
            camera: CameraMount::default(),
            objects: Vec::new(),
            arm: None,
            person: None,
            sensor: SensorModel::KINECT_V1,
            duration_s: None,
        }
    }
}
