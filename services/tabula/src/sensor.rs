//! Which process gives the frames: the camera or the simulator.

use crate::arguments::RunArguments;
use message::ProcessKind;
use serde::Deserialize;
use service::{CommonArguments, ConfigFile, Failure, exit_code};

/// The word for the simulator among the sources.
const SIMULATION: &str = "simulation";

/// The process that gives the frames.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Sensor {
    /// `tabula-camera`.
    Camera,
    /// `tabula-simulator`, with the scene named behind `simulation:`.
    Simulator {
        /// The scene; `None` for what the configuration says.
        scene: Option<String>,
    },
}

/// What is read here of the section `[camera]`.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct RawCamera {
    source: Option<String>,
}

impl Sensor {
    /// The sensor of the arguments, else of the configuration, else the simulator.
    ///
    /// # Errors
    /// When the configuration can not be read.
    pub(crate) fn choose(common: &CommonArguments, run: &RunArguments) -> Result<Self, Failure> {
        if let Some(source) = run.source() {
            return Self::named(source);
        }
        let home = common.home();
        let file = ConfigFile::find(common.config.as_deref(), home.path())?;
        let camera: RawCamera = file.section("camera")?;
        Self::named(camera.source.as_deref().unwrap_or(SIMULATION))
    }

    fn named(source: &str) -> Result<Self, Failure> {
        match source.split_once(':') {
            Some((SIMULATION, "")) => Err(Failure::new(
                exit_code::USAGE,
                "simulation: needs a scene, for example simulation:pile, or no colon",
            )),
            Some((SIMULATION, scene)) => Ok(Self::Simulator {
                scene: Some(scene.to_owned()),
            }),
            None if source == SIMULATION => Ok(Self::Simulator { scene: None }),
            _ => Ok(Self::Camera),
        }
    }

    /// Its process.
    pub(crate) fn process(&self) -> ProcessKind {
        match self {
            Self::Camera => ProcessKind::Camera,
            Self::Simulator { .. } => ProcessKind::Simulator,
        }
    }

    /// The daemon's processes in the order they are started.
    pub(crate) fn processes(&self) -> Vec<ProcessKind> {
        let all = ProcessKind::ALL.into_iter();
        all.filter(|process| *process != self.other()).collect()
    }

    /// The process that is not started.
    fn other(&self) -> ProcessKind {
        match self {
            Self::Camera => ProcessKind::Simulator,
            Self::Simulator { .. } => ProcessKind::Camera,
        }
    }

    /// The process that is not started, with arguments with which its section of
    /// the configuration is checked all the same.
    pub(crate) fn idle(&self) -> (ProcessKind, &'static [&'static str]) {
        match self {
            Self::Camera => (self.other(), &[]),
            // Its source is not needed, and may be named as the simulation.
            Self::Simulator { .. } => (self.other(), &["--source=synthetic"]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_source_names_the_process() {
        let named = |source| Sensor::named(source).unwrap();
        assert_eq!(named("kinect"), Sensor::Camera);
        assert_eq!(named("./simulation"), Sensor::Camera);
        assert_eq!(named("simulation"), Sensor::Simulator { scene: None });
        let bin = Some("bin".to_owned());
        assert_eq!(named("simulation:bin"), Sensor::Simulator { scene: bin });
        assert!(Sensor::named("simulation:").is_err());
    }

    #[test]
    fn of_camera_and_simulator_one_runs() {
        let simulated = Sensor::Simulator { scene: None }.processes();
        assert_eq!(
            simulated,
            [
                ProcessKind::Memory,
                ProcessKind::Perception,
                ProcessKind::Simulator
            ]
        );
        assert!(!Sensor::Camera.processes().contains(&ProcessKind::Simulator));
    }
}
