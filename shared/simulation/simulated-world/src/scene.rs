//! What stands where: the description a world is made from.

use crate::arm::ArmMount;
use crate::person::PersonPlan;
use geometry::RigidTransform;
use nalgebra::{Matrix3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use rendering::kinect::SensorModel;
use std::path::PathBuf;

/// A generator of scenes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SceneKind {
    /// Objects apart from each other, standing as they are used.
    #[default]
    Isolated,
    /// Objects thrown onto one heap in the middle of the table.
    Pile,
    /// Objects thrown into a box with walls (Kasaei et al. 2018, synthetic dataset).
    Bin,
    /// Covers, glasses and bowls as for a meal.
    SetTable,
}

impl SceneKind {
    /// All generators.
    pub const ALL: [Self; 4] = [Self::Isolated, Self::Pile, Self::Bin, Self::SetTable];

    /// The word for people and files.
    pub fn word(self) -> &'static str {
        match self {
            Self::Isolated => "isolated",
            Self::Pile => "pile",
            Self::Bin => "bin",
            Self::SetTable => "set-table",
        }
    }

    /// How many objects a scene has when nobody says it; 20 in a bin as in the paper.
    pub fn usual_number(self) -> usize {
        match self {
            Self::Isolated => 6,
            Self::Pile => 8,
            Self::Bin => 20,
            Self::SetTable => 14,
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

/// Where models come from.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum ModelSource {
    /// Generated household objects.
    #[default]
    Generated,
    /// PLY and OBJ files of a folder.
    Folder(PathBuf),
}

/// One object of a scene.
#[derive(Debug, Clone, PartialEq)]
pub enum ModelChoice {
    /// A generated object.
    Generated {
        /// Category.
        category: String,
        /// Which of its instances.
        instance: u64,
    },
    /// A PLY or OBJ file.
    File(PathBuf),
}

impl ModelChoice {
    /// Its category; a model file is its own, by its name.
    pub fn category(&self) -> String {
        match self {
            Self::Generated { category, .. } => category.clone(),
            Self::File(path) => crate::model_file::names(path).0,
        }
    }
}

/// How an object comes to its place.
#[derive(Debug, Clone, PartialEq)]
pub enum Placing {
    /// Put down as it naturally stands.
    Upright {
        /// Place on the table, world x and y, metres.
        position_m: [f64; 2],
        /// Turn around the vertical, radians.
        yaw_rad: f64,
    },
    /// Let go in the air.
    Dropped {
        /// Pose in the world.
        world_from_object: RigidTransform,
    },
}

/// An object and its place.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectPlan {
    /// Which object.
    pub model: ModelChoice,
    /// Where.
    pub placing: Placing,
}

/// The table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Table {
    /// Sides along world x and y, metres.
    pub size_m: [f64; 2],
    /// Height of its surface, metres.
    pub height_m: f64,
}

impl Default for Table {
    fn default() -> Self {
        Self {
            size_m: [1.3, 0.8],
            height_m: 0.72,
        }
    }
}

impl Table {
    /// Middle of the surface, world frame.
    pub fn middle(&self) -> Point3<f64> {
        Point3::new(0.0, 0.0, self.height_m)
    }
}

/// A box without a lid in the middle of the table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bin {
    /// Inner sides along world x, y and z, metres.
    pub inner_size_m: [f64; 3],
}

impl Default for Bin {
    fn default() -> Self {
        Self {
            inner_size_m: [0.42, 0.34, 0.14],
        }
    }
}

/// Where the camera stands: on a sphere around the point it looks at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraMount {
    /// The point it looks at, world frame, metres.
    pub look_at_m: [f64; 3],
    /// Distance from that point, metres.
    pub distance_m: f64,
    /// How steeply it looks down, degrees over the horizon, -89 to 89.
    pub elevation_deg: f64,
    /// Where it stands around the point, degrees: 0 at the near side (-y), 90 at +x.
    pub azimuth_deg: f64,
    /// How fast it goes around, degrees a second.
    pub orbit_deg_s: f64,
}

impl Default for CameraMount {
    fn default() -> Self {
        Self {
            look_at_m: [0.0, -0.02, 0.74],
            distance_m: 1.0,
            elevation_deg: 43.0,
            azimuth_deg: 4.0,
            orbit_deg_s: 0.0,
        }
    }
}

impl CameraMount {
    /// Pose of the camera (x right, y down, z forward) after `time_s`.
    pub fn world_from_camera(&self, time_s: f64) -> RigidTransform {
        let elevation = self.elevation_deg.to_radians();
        let azimuth = (self.azimuth_deg + self.orbit_deg_s * time_s).to_radians();
        let (sin_e, cos_e) = elevation.sin_cos();
        let (sin_a, cos_a) = azimuth.sin_cos();
        let outward = Vector3::new(cos_e * sin_a, -cos_e * cos_a, sin_e);
        let forward = -outward;
        let right = Vector3::new(cos_a, sin_a, 0.0);
        let down = forward.cross(&right);
        let rotation =
            Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[right, down, forward]));
        let position = Vector3::from(self.look_at_m) + outward * self.distance_m;
        RigidTransform::from_parts(
            Translation3::from(position),
            UnitQuaternion::from_rotation_matrix(&rotation),
        )
    }
}

/// Everything a world is made from.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Seed of whatever happens by chance.
    pub seed: u64,
    /// The table.
    pub table: Table,
    /// A box on it.
    pub bin: Option<Bin>,
    /// The camera's place.
    pub camera: CameraMount,
    /// The objects, in the order they are put down.
    pub objects: Vec<ObjectPlan>,
    /// Where an arm stands; `None` without one.
    pub arm: Option<ArmMount>,
    /// What a person does; `None` without one.
    pub person: Option<PersonPlan>,
    /// Errors of the simulated Kinect.
    pub sensor: SensorModel,
    /// How long its story is, seconds; `None` when nobody says.
    pub duration_s: Option<f64>,
}

impl Default for Scene {
    /// An empty table.
    fn default() -> Self {
        Self {
            seed: 1,
            table: Table::default(),
            bin: None,
            camera: CameraMount::default(),
            objects: Vec::new(),
            arm: None,
            person: None,
            sensor: SensorModel::KINECT_V1,
            duration_s: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_camera_looks_at_its_point_from_its_distance_with_the_horizon_level() {
        for azimuth_deg in [0.0, 35.0, 200.0] {
            let mount = CameraMount {
                azimuth_deg,
                ..CameraMount::default()
            };
            let camera_from_world = mount.world_from_camera(0.0).inverse();
            let target = camera_from_world * Point3::from(mount.look_at_m);
            assert!((target - Point3::new(0.0, 0.0, mount.distance_m)).norm() < 1e-12);
            let up = camera_from_world * Vector3::z();
            assert!(up.x.abs() < 1e-12 && up.y < 0.0, "{up}");
        }
    }

    #[test]
    fn an_orbit_turns_the_camera() {
        let mount = CameraMount {
            orbit_deg_s: 10.0,
            ..CameraMount::default()
        };
        let around = |time_s: f64| {
            let seen =
                mount.world_from_camera(time_s).translation.vector - Vector3::from(mount.look_at_m);
            seen.y.atan2(seen.x).to_degrees()
        };
        assert!((around(3.0) - around(0.0) - 30.0).abs() < 1e-9);
    }
}
