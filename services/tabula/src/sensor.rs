//! Sensor process: camera or simulator.

use message::{Duty, ProcessKind};
use serde::Deserialize;
use service::{CommonArguments, Configuration, Failure};

/// Source name of the simulator.
const SIMULATION: &str = "simulation";

/// Kind of sensor process: camera or simulator.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Sensor {
    /// Camera process `tabula-camera`.
    Camera,
    /// `tabula-simulator`, with the scene named behind `simulation:`.
    Simulator {
        /// Scene name; `None` for the configured scene.
        scene: Option<String>,
    },
}

/// Fields of the section `[camera]` that select the sensor.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct RawCamera {
    source: Option<String>,
}

impl Sensor {
    /// Sensor of the `source` argument, else of the configuration, else the simulator.
    ///
    /// # Errors
    /// When the configuration cannot be read.
    pub(crate) fn choose(common: &CommonArguments, source: Option<&str>) -> Result<Self, Failure> {
        if let Some(source) = source {
            return Self::named(source);
        }
        let home = common.home();
        let found = Configuration::find(common.config.as_deref(), home.path())?;
        let camera: RawCamera = found.section("camera")?;
        Self::named(camera.source.as_deref().unwrap_or(SIMULATION))
            .map_err(|failure| found.wrong("camera", &["source"], failure).into())
    }

    /// `true` when the unit of the camera can use the configured source: without one it takes a
    /// Kinect, where `tabula run` simulates.
    ///
    /// # Errors
    /// When the section cannot be read.
    pub(crate) fn is_camera_of_services(found: &Configuration) -> Result<bool, Failure> {
        let camera: RawCamera = found.section("camera")?;
        let source = camera.source.as_deref();
        Ok(source.is_none_or(|source| Self::named(source) == Ok(Self::Camera)))
    }

    fn named(source: &str) -> Result<Self, Failure> {
        match source.split_once(':') {
            Some((SIMULATION, "")) => Err(Failure::usage(
                "simulation: needs a scene, for example simulation:pile, or no colon",
            )),
            Some((SIMULATION, scene)) => Ok(Self::Simulator {
                scene: Some(scene.to_owned()),
            }),
            None if source == SIMULATION => Ok(Self::Simulator { scene: None }),
            _ => Ok(Self::Camera),
        }
    }

    /// Process kind of the sensor.
    pub(crate) fn process(&self) -> ProcessKind {
        match self {
            Self::Camera => ProcessKind::CAMERA,
            Self::Simulator { .. } => ProcessKind::SIMULATOR,
        }
    }

    /// Processes of the daemon in the order of their start, of which the driver of an arm is one or
    /// is not.
    pub(crate) fn processes(&self, has_driver: bool) -> Vec<ProcessKind> {
        let has_arm = has_driver || self.has_arm();
        let is_absent = |process: &ProcessKind| {
            *process == self.other()
                || (process.has(Duty::Driver) && !has_driver)
                || (process.has(Duty::Commander) && !has_arm)
        };
        let all = ProcessKind::all();
        all.filter(|process| !is_absent(process)).collect()
    }

    /// True if the sensor may drive an arm.
    pub(crate) fn has_arm(&self) -> bool {
        match self {
            Self::Camera => false,
            Self::Simulator { .. } => true,
        }
    }

    /// The other sensor process, which is not started.
    fn other(&self) -> ProcessKind {
        match self {
            Self::Camera => ProcessKind::SIMULATOR,
            Self::Simulator { .. } => ProcessKind::CAMERA,
        }
    }

    /// Process that is not started, with the arguments that validate its section of the
    /// configuration nevertheless.
    pub(crate) fn idle(&self) -> (ProcessKind, &'static [&'static str]) {
        match self {
            Self::Camera => (self.other(), &[]),
            // The configured source may name the simulation, which tabula-camera rejects.
            Self::Simulator { .. } => (self.other(), &["--source=synthetic"]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn source_selects_the_process() {
        let named = |source| Sensor::named(source).unwrap();
        assert_eq!(named("kinect"), Sensor::Camera);
        assert_eq!(named("./simulation"), Sensor::Camera);
        assert_eq!(named("simulation"), Sensor::Simulator { scene: None });
        let bin = Some("bin".to_owned());
        assert_eq!(named("simulation:bin"), Sensor::Simulator { scene: bin });
        assert!(Sensor::named("simulation:").is_err());
    }

    #[test]
    fn either_camera_or_simulator_runs() {
        let simulated = Sensor::Simulator { scene: None }.processes(false);
        assert_eq!(
            simulated,
            [
                ProcessKind::GATEWAY,
                ProcessKind::MEMORY,
                ProcessKind::PERCEPTION,
                ProcessKind::SIMULATOR,
                ProcessKind::EXECUTIVE
            ]
        );
        let of_camera = Sensor::Camera.processes(false);
        assert!(!of_camera.contains(&ProcessKind::SIMULATOR));
        assert!(!of_camera.contains(&ProcessKind::EXECUTIVE));
        assert!(!of_camera.contains(&ProcessKind::ARM));
        let with_driver = Sensor::Camera.processes(true);
        let last_two = [ProcessKind::ARM, ProcessKind::EXECUTIVE];
        assert!(with_driver.ends_with(&last_two), "{with_driver:?}");
    }
}
