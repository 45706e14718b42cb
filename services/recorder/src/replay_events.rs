//! Events of a lockstep replay, written in canonical form, with their digest.

use crate::arguments::ReplayArguments;
use capture::RECORDER_CODE;
use channel::topic::{FinishedFrames, ProcessHealth, Scene};
use channel::{Domain, DomainName, Publisher, Received, Role, RunFolder, Subscriber};
use command_line::{Output, StopSignal};
use control_client::SpawnedDaemon;
use message::{FrameDone, PlainHeader, ProcessKind, ProcessState};
use recording::{EventDigest, EventStream};
use service::{CommonArguments, Failure};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::process::{ExitCode, Stdio};
use std::time::Duration;
use tempfile::TempDir;

/// Polling period of scenes. The camera waits for the report on each.
const POLL_PERIOD: Duration = Duration::from_micros(500);

/// Replays a recording to its end and writes its events.
pub(crate) fn run(
    common: &CommonArguments,
    arguments: &ReplayArguments,
    out: &Path,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let not_written = |error: std::io::Error| {
        Failure::general(format!("{} could not be written: {error}", out.display()))
    };
    let file = File::create(out).map_err(not_written)?;
    let stop = StopSignal::install()?;
    let name = format!("rep-{}", std::process::id());
    let name = name.parse::<DomainName>().map_err(Failure::general)?;
    // A guest before the daemon starts, so that no scene is missed.
    let domain = Domain::join(&name, &RunFolder::of_user(), Role::Guest)?;
    let mut collector = EventCollector {
        scenes: Subscriber::polled(&domain)?,
        health: Subscriber::polled(&domain)?,
        finished: Subscriber::polled(&domain)?,
        reports: Publisher::new(&domain)?,
        stream: EventStream::new(),
        file: BufWriter::new(file),
        session: None,
    };
    let config = common.config.as_deref();
    let mut run_arguments = arguments.run_arguments();
    run_arguments.push("--lockstep-recorder".into());
    run_arguments.extend(config.map(|path| format!("--config={}", path.display())));
    let folder = TempDir::with_prefix("tabula-replay-").map_err(Failure::general)?;
    // Not waited for: the first scenes come before all processes have reported that they work.
    let mut daemon = SpawnedDaemon::start(&name, folder, &run_arguments, Stdio::null())?;
    while !collector.receive().map_err(not_written_events(out))? {
        if stop.is_raised() {
            return Err(Failure::general("the replay was stopped before its end"));
        }
        if !matches!(daemon.exit_status(), Ok(None)) {
            let log = daemon.log_end();
            return Err(Failure::general(format!(
                "the daemon has ended; its log:\n{log}"
            )));
        }
        stop.sleep(POLL_PERIOD);
    }
    let digest = collector.finish().map_err(not_written)?;
    // The guest leaves first: the last member of a domain removes its files.
    drop(domain);
    drop(daemon);
    output.answer(&digest, || text(&digest, out));
    Ok(ExitCode::SUCCESS)
}

fn scene_lost() -> Failure {
    Failure::general("a scene was overwritten before it was read; this computer is too busy")
}

fn not_written_events(out: &Path) -> impl Fn(Failure) -> Failure + '_ {
    move |failure| {
        let sentence = format!(
            "the events in {} are not complete: {failure}",
            out.display()
        );
        Failure::new(failure.code, sentence)
    }
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

/// Collector of scenes until the camera is idle.
struct EventCollector {
    scenes: Subscriber<Scene>,
    health: Subscriber<ProcessHealth>,
    finished: Subscriber<FinishedFrames>,
    /// Reports of the frames whose scene was taken, for which the camera waits.
    reports: Publisher<FinishedFrames>,
    stream: EventStream,
    file: BufWriter<File>,
    /// Session of the scenes.
    session: Option<u64>,
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
        while let Received::Message(finished) = self.finished.receive()? {
            for done in finished.items() {
                if done.process == u64::from(ProcessKind::Perception.code()) {
                    self.receive_scenes()?;
                    let report = FrameDone {
                        process: RECORDER_CODE,
                        ..*done
                    };
                    self.reports.send_copy(PlainHeader::default(), &[report])?;
                }
            }
        }
        Ok(())
    }

    fn receive_scenes(&mut self) -> Result<(), Failure> {
        while let Received::Message(scene) = self.scenes.receive()? {
            let session = scene.header().session;
            if self.session.is_none() && scene.header().sent > 1 {
                return Err(scene_lost());
            }
            if *self.session.get_or_insert(session) != session {
                return Err(Failure::general(
                    "the camera was restarted during the replay",
                ));
            }
            let events = self.stream.add(scene.header(), scene.items());
            let events = events.map_err(Failure::general)?;
            self.file
                .write_all(events.as_bytes())
                .map_err(Failure::general)?;
        }
        if self.scenes.n_lost() > 0 {
            return Err(scene_lost());
        }
        Ok(())
    }

    fn is_camera_idle(&mut self) -> Result<bool, Failure> {
        let mut is_idle = false;
        while let Received::Message(reports) = self.health.receive()? {
            is_idle |= reports.items().iter().any(|health| {
                health.process == ProcessKind::Camera.code()
                    && health.state == ProcessState::Idle.code()
            });
        }
        Ok(is_idle)
    }

    fn finish(mut self) -> std::io::Result<EventDigest> {
        self.file.flush()?;
        Ok(self.stream.digest())
    }
}
