//! Events of a lockstep replay, written in canonical form, with their digest.

use crate::arguments::ReplayArguments;
use crate::events_file::EventsFile;
use capture::{Follower, FrameFollower};
use channel::topic::{ProcessHealth, Scene};
use channel::{Domain, DomainName, Received, Role, RunFolder, Subscriber};
use command_line::{Output, StopSignal};
use control_client::SpawnedDaemon;
use message::{ProcessKind, ProcessState, SceneSummary};
use recording::{EventDigest, EventStream};
use service::{CommonArguments, Failure};
use std::path::Path;
use std::process::{ExitCode, Stdio};
use std::time::Duration;
use tempfile::TempDir;

/// Next step after a replay that failed.
const AGAIN: &str = "no events were written; replay the recording again";

/// Polling period of scenes. The camera waits for the report on each.
const POLL_PERIOD: Duration = Duration::from_micros(500);

/// Replays a recording to its end and writes its events.
pub(crate) fn run(
    common: &CommonArguments,
    arguments: &ReplayArguments,
    out: &Path,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let file = EventsFile::create(out, &arguments.file)?;
    let stop = StopSignal::install()?;
    let name = format!("rep-{}", std::process::id());
    let name = name.parse::<DomainName>().map_err(Failure::general)?;
    // A guest before the daemon starts, so that no scene is missed.
    let domain = Domain::join(&name, &RunFolder::of_user(), Role::Guest)?;
    let mut collector = EventCollector {
        scenes: Subscriber::polled(&domain)?,
        health: Subscriber::polled(&domain)?,
        follower: FrameFollower::polled(&domain, Follower::Observer, &[ProcessKind::PERCEPTION])?,
        stream: EventStream::new(),
        file,
        order: SceneOrder::default(),
    };
    let config = common.config.as_deref();
    let mut run_arguments = arguments.run_arguments();
    run_arguments.push("--lockstep-observer".into());
    run_arguments.extend(config.map(|path| format!("--config={}", path.display())));
    let folder = TempDir::with_prefix("tabula-replay-").map_err(|error| {
        let place = std::env::temp_dir();
        Failure::general(format!(
            "could not create a folder for the replay in {}: {error}; name another place with \
             TMPDIR",
            place.display()
        ))
    })?;
    // Not waited for: the first scenes come before all processes have reported that they work.
    let mut daemon = SpawnedDaemon::start(&name, folder, &run_arguments, Stdio::null())?;
    while !collector.receive()? {
        if stop.is_raised() {
            return Err(Failure::general(format!(
                "the replay of {} was stopped before its end; {AGAIN}",
                arguments.file.display()
            )));
        }
        if !matches!(daemon.exit_status(), Ok(None)) {
            let log = daemon.log_end();
            return Err(Failure::general(format!(
                "the daemon that replays {} has ended; {AGAIN} when the reason in its log is \
                 removed:\n{log}",
                arguments.file.display()
            )));
        }
        stop.sleep(POLL_PERIOD);
    }
    let digest = collector.finish()?;
    // The guest leaves first: the last member of a domain removes its files.
    drop(domain);
    drop(daemon);
    output.answer(&digest, || text(&digest, out));
    Ok(ExitCode::SUCCESS)
}

fn text(digest: &EventDigest, out: &Path) -> String {
    let EventDigest {
        blake3,
        n_frames,
        n_events,
    } = digest;
    format!(
        "{n_events} events of {n_frames} frames in {}\nblake3 {blake3}",
        out.display()
    )
}

/// Check that the scenes of a replay are all there, and all of one run of camera and perception.
#[derive(Debug, Default)]
struct SceneOrder {
    session: Option<u64>,
    /// Number of the newest scene among those of its publisher.
    sent: u64,
}

impl SceneOrder {
    /// Takes the next scene.
    ///
    /// # Errors
    /// When a process was restarted before it, or a scene is missing.
    fn check(&mut self, scene: &SceneSummary) -> Result<(), Failure> {
        let sent = std::mem::replace(&mut self.sent, scene.sent);
        let session = *self.session.get_or_insert(scene.session);
        let problem = if session != scene.session {
            "the camera was restarted during the replay"
        } else if scene.sent <= sent {
            "perception was restarted during the replay"
        } else if scene.sent > sent.saturating_add(1) {
            "a scene was overwritten before it was read, because this computer is too busy"
        } else {
            return Ok(());
        };
        Err(Failure::general(format!("{problem}; {AGAIN}")))
    }
}

/// Collector of scenes until the camera is idle.
struct EventCollector {
    scenes: Subscriber<Scene>,
    health: Subscriber<ProcessHealth>,
    /// Follower of the frames whose scene was taken, for which the camera waits.
    follower: FrameFollower,
    stream: EventStream,
    file: EventsFile,
    order: SceneOrder,
}

impl EventCollector {
    /// Takes all waiting messages; true at the end of the replay.
    fn receive(&mut self) -> Result<bool, Failure> {
        let is_idle = self.is_camera_idle()?;
        // In lockstep the camera is idle after the scene of its last frame was taken.
        self.receive_finished()?;
        Ok(is_idle)
    }

    /// Takes the scene of each frame that perception has finished, and reports that. A frame that
    /// perception cannot use has none.
    fn receive_finished(&mut self) -> Result<(), Failure> {
        while let Some(frame) = self.follower.next_frame()? {
            self.receive_scenes()?;
            self.follower.report(frame)?;
        }
        Ok(())
    }

    fn receive_scenes(&mut self) -> Result<(), Failure> {
        while let Received::Message(scene) = self.scenes.receive()? {
            self.order.check(scene.header())?;
            let events = self.stream.add(scene.header(), scene.items());
            let events = events.map_err(|error| {
                Failure::general(format!(
                    "a scene could not be written as JSON: {error}; {AGAIN}"
                ))
            })?;
            self.file.append(&events)?;
        }
        Ok(())
    }

    fn is_camera_idle(&mut self) -> Result<bool, Failure> {
        let mut is_idle = false;
        while let Received::Message(reports) = self.health.receive()? {
            is_idle |= reports.items().iter().any(|health| {
                health.process == ProcessKind::CAMERA.code()
                    && health.state == ProcessState::Idle.code()
            });
        }
        Ok(is_idle)
    }

    fn finish(self) -> Result<EventDigest, Failure> {
        self.file.finish()?;
        Ok(self.stream.digest())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replay_with_a_restart_or_a_lost_scene_fails() {
        let outcome = |scenes: &[(u64, u64)]| {
            let mut order = SceneOrder::default();
            let check = |&(session, sent): &(u64, u64)| {
                order.check(&SceneSummary {
                    session,
                    sent,
                    ..SceneSummary::default()
                })
            };
            let outcome: Result<(), Failure> = scenes.iter().try_for_each(check);
            outcome.err().map(|failure| failure.sentence)
        };
        assert_eq!(outcome(&[(7, 1), (7, 2), (7, 3)]), None);
        for (scenes, problem) in [
            (&[(7, 2)][..], "overwritten"),
            (&[(7, 1), (7, 3)], "overwritten"),
            (&[(7, 1), (7, 2), (7, 1)], "perception was restarted"),
            (&[(7, 1), (7, 1)], "perception was restarted"),
            (&[(7, 1), (8, 2)], "camera was restarted"),
        ] {
            let sentence = outcome(scenes).unwrap();
            assert!(sentence.contains(problem), "{sentence}");
        }
    }
}
