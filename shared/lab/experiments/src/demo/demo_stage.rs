//! Stage of a demonstration: a daemon of its own in lockstep, as a program sees it.

use super::demo_table::DemoTable;
use crate::output_files::write;
use capture::{FollowedFrame, Follower, FrameFollower};
use channel::topic::{ArmStates, CameraCloud, Scene};
use channel::{Domain, DomainName, Received, Role, RunFolder, SharedMessage, Subscriber};
use command_line::StopSignal;
use control_client::SpawnedDaemon;
use control_protocol::TypedRequest;
use daemon_client::{DaemonLink, Unanswered};
use message::{ArmActivity, ProcessKind, SceneObject};
use service::Failure;
use simulated_world::ModelSource;
use std::process::Stdio;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Time limit of a request.
const CALL_DEADLINE: Duration = Duration::from_secs(10);
/// Period of the looks for a finished frame.
const POLL_PERIOD: Duration = Duration::from_micros(300);
/// Time without a frame after which the daemon is given up: the setting up of a scene is shorter.
const FRAME_PATIENCE: Duration = Duration::from_secs(120);

/// Running daemon of a demonstration. Each frame waits until it was followed and answered.
pub(super) struct DemoStage {
    pub(super) link: DaemonLink,
    follower: FrameFollower,
    scenes: Subscriber<Scene>,
    clouds: Subscriber<CameraCloud>,
    arm: Subscriber<ArmStates>,
    /// Objects of the newest scene.
    pub(super) objects: Vec<SceneObject>,
    /// Capture time of the newest scene, nanoseconds of the source's clock.
    pub(super) captured_ns: u64,
    /// Newest frame of the camera.
    pub(super) cloud: Option<SharedMessage<CameraCloud>>,
    /// Activity and note of the arm's newest state.
    arm_state: (u32, String),
    /// Notes of the motions that have failed, in their order.
    pub(super) arm_failures: Vec<String>,
    daemon: SpawnedDaemon,
    domain: Domain,
    stop: StopSignal,
}

impl DemoStage {
    /// Starts the daemon of a table.
    ///
    /// # Errors
    /// When it cannot be started, or shared memory fails.
    pub(super) fn start(
        table: &DemoTable,
        models: &ModelSource,
        stop: &StopSignal,
    ) -> Result<Self, Failure> {
        let name = format!("demo-{}-{}", std::process::id(), table.seed);
        let name = name.parse::<DomainName>().map_err(Failure::general)?;
        // A guest before the daemon starts, so that no frame is missed.
        let domain = Domain::join(&name, &RunFolder::of_user(), Role::Guest)?;
        let folder = TempDir::with_prefix("tabula-demo-").map_err(Failure::general)?;
        let path = |name: &str| folder.path().join(name);
        let (scene, config) = (path("scene.toml"), path("demo.toml"));
        write(&scene, table.scene_toml().as_bytes())?;
        let mut parts = vec![table.configuration_toml()];
        if let ModelSource::Folder(folder) = models {
            let models = std::path::absolute(folder).map_err(Failure::general)?;
            let models = models.display().to_string();
            parts.push(format!("[simulator]\nmodels = {models:?}\n"));
        }
        write(&config, parts.concat().as_bytes())?;
        let arguments = [
            format!("--source=simulation:{}", scene.display()),
            format!("--config={}", config.display()),
            "--lockstep".to_owned(),
            "--lockstep-observer".to_owned(),
        ];
        let before = [
            ProcessKind::PERCEPTION,
            ProcessKind::MEMORY,
            ProcessKind::EXECUTIVE,
        ];
        Ok(Self {
            link: DaemonLink::new(name.clone(), RunFolder::of_user(), CALL_DEADLINE),
            follower: FrameFollower::polled(&domain, Follower::Observer, &before)?,
            scenes: Subscriber::polled(&domain)?,
            clouds: Subscriber::polled(&domain)?,
            arm: Subscriber::polled(&domain)?,
            objects: Vec::new(),
            captured_ns: 0,
            cloud: None,
            arm_state: (ArmActivity::Idle.code(), String::new()),
            arm_failures: Vec::new(),
            daemon: SpawnedDaemon::start(&name, folder, &arguments, Stdio::null())?,
            domain,
            stop: stop.clone(),
        })
    }

    /// Domain of the daemon.
    pub(super) fn domain(&self) -> &Domain {
        &self.domain
    }

    /// Waits for the next frame that perception, memory and executive have finished.
    ///
    /// # Errors
    /// When the demonstration is stopped, the daemon has ended, or shared memory fails.
    pub(super) fn next_frame(&mut self) -> Result<FollowedFrame, Failure> {
        let begun = Instant::now();
        loop {
            self.receive()?;
            if let Some(frame) = self.follower.next_frame()? {
                self.receive()?;
                return Ok(frame);
            }
            if self.stop.is_raised() {
                return Err(Failure::general(
                    "the demonstration was stopped; the same command goes on with this table",
                ));
            }
            let has_ended = !matches!(self.daemon.exit_status(), Ok(None));
            if has_ended || begun.elapsed() > FRAME_PATIENCE {
                let log = self.daemon.log_end();
                let what = if has_ended {
                    "has ended"
                } else {
                    "sends no frame"
                };
                return Err(Failure::general(format!(
                    "the daemon of the demonstration {what}; the end of its log:\n{log}"
                )));
            }
            std::thread::sleep(POLL_PERIOD);
        }
    }

    /// Lets the source send the next frame.
    ///
    /// # Errors
    /// When shared memory fails.
    pub(super) fn finish(&mut self, frame: FollowedFrame) -> Result<(), Failure> {
        Ok(self.follower.report(frame)?)
    }

    /// Answer of the daemon, which must come: in lockstep nothing else is done meanwhile.
    ///
    /// # Errors
    /// When nobody answers; a refusal is in the answer.
    pub(super) fn ask<T>(
        &mut self,
        request: &TypedRequest<T>,
    ) -> Result<Result<T, String>, Failure> {
        match self.link.ask(request) {
            Ok(answer) => Ok(Ok(answer)),
            Err(Unanswered::Refused(refusal)) => Ok(Err(refusal.sentence)),
            Err(Unanswered::NoAnswer(sentence)) => Err(Failure::general(sentence)),
        }
    }

    fn receive(&mut self) -> Result<(), Failure> {
        if let Some(scene) = self.scenes.latest()? {
            self.objects = scene.items().to_vec();
            self.captured_ns = scene.header().stamps.capture_ns;
        }
        if let Some(cloud) = self.clouds.latest()? {
            self.cloud = Some(cloud);
        }
        while let Received::Message(state) = self.arm.receive()? {
            let header = state.header();
            let note = header.note.as_str().unwrap_or_default().to_owned();
            let now = (header.activity, note);
            if now != self.arm_state && now.0 == ArmActivity::Failed.code() {
                self.arm_failures.push(now.1.clone());
            }
            self.arm_state = now;
        }
        Ok(())
    }
}
