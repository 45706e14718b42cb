//! Camera service: the capture thread and the end of a recording.

use crate::config::Config;
use crate::fakenect_restart;
use crate::source::{self, Source, SourceError, SourceSpec};
use ::capture::{CaptureEnd, CaptureLoop, Outage};
use channel::topic::MAX_FRAME_POINTS;
use channel::{DomainName, check_shared_memory};
use message::ProcessState;
use point_cloud::Point;
use service::{Context, Failure};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use tokio::runtime::Handle;
use tokio::sync::oneshot;

/// Request to start the program again after a graceful stop.
#[derive(Debug, Clone, Default)]
pub struct ReplayRequest(Arc<AtomicBool>);

impl ReplayRequest {
    /// Starts the program again if requested, which does not return; otherwise passes the
    /// exit code on.
    pub fn or(&self, code: ExitCode) -> ExitCode {
        if !self.0.load(Ordering::Relaxed) {
            return code;
        }
        let failure = fakenect_restart::play_again();
        tracing::error!("{failure}");
        ExitCode::from(failure.code)
    }
}

/// Publishes frames until shutdown; at the end of a recording the service stays, idle.
///
/// # Errors
/// When the source cannot be used.
pub async fn run(context: Context, config: Config, again: ReplayRequest) -> Result<(), Failure> {
    let shutdown = context.shutdown.clone();
    let health = context.health.clone();
    match capture(context, &config).await? {
        CaptureEnd::Stopped => return Ok(()),
        CaptureEnd::EndOfRecording if config.playback.looped => {
            again.0.store(
                matches!(config.source, SourceSpec::Fakenect(_)),
                Ordering::Relaxed,
            );
            return Ok(());
        }
        CaptureEnd::EndOfRecording => {}
    }
    let n_frames = health.frames.load(Ordering::Relaxed);
    tracing::info!("the recording has ended after {n_frames} frames");
    health.set_state(ProcessState::Idle, "the recording has ended");
    loop {
        health.record_progress();
        tokio::select! {
            () = shutdown.requested() => return Ok(()),
            () = tokio::time::sleep(Duration::from_millis(500)) => {}
        }
    }
}

/// Checks that the source exists, that a frame of it can be played, and that the memory that a
/// domain with frames of this size and so many guest places needs is free.
///
/// # Errors
/// When the source cannot be played, or the memory is not free. A device may be connected later
/// and is not checked.
pub fn check_source(config: &Config, domain: &DomainName, places: u32) -> Result<(), Failure> {
    let max_points = match &config.source {
        SourceSpec::Fakenect(folder) => freenect::check_recording(folder)
            .map(|_| MAX_FRAME_POINTS)
            .map_err(|error| error.to_string()),
        SourceSpec::Kinect => Ok(MAX_FRAME_POINTS),
        _ => source::open(&config.source, &config.playback, None)
            .and_then(|mut source| {
                first_frame(&mut *source)?;
                Ok(source.max_points())
            })
            .map_err(|e| e.to_string()),
    };
    let max_points = max_points.map_err(Failure::usage)?;
    Ok(check_shared_memory(domain, max_points, places)?)
}

/// Reads frames until one of them is usable.
fn first_frame(source: &mut dyn Source) -> Result<(), SourceError> {
    let mut points = Vec::new();
    loop {
        let filled = source.prepare().and_then(|size| {
            let size = size.ok_or(SourceError::EndOfRecording)?;
            points.resize(size.n_points(), Point::default());
            source.fill(&mut points)
        });
        match filled {
            Ok(_) => return Ok(()),
            Err(SourceError::Frame { .. }) => {}
            Err(error) => return Err(error),
        }
    }
}

/// Captures on a dedicated thread: devices block, and a Kinect stays on the thread that
/// opened it.
async fn capture(context: Context, config: &Config) -> Result<CaptureEnd, Failure> {
    let (sender, ended) = oneshot::channel();
    let (config, runtime) = (config.clone(), Handle::current());
    let spawned = std::thread::Builder::new()
        .name("capture".into())
        .spawn(move || {
            let _ = sender.send(play(context, &config, runtime));
        });
    spawned.map_err(|error| {
        Failure::general(format!("could not start the capture thread: {error}"))
    })?;
    ended
        .await
        .map_err(|_| Failure::general("the capture thread has panicked"))?
}

fn play(context: Context, config: &Config, runtime: Handle) -> Result<CaptureEnd, Failure> {
    let Some(source) = open_source(&context, config)? else {
        return Ok(CaptureEnd::Stopped);
    };
    let rate = match source.rate_hz() {
        _ if config.pace.is_lockstep() => "in lockstep".into(),
        _ if matches!(config.source, SourceSpec::Recording(_))
            && config.playback.rate_hz.is_none() =>
        {
            "at its recorded pace".into()
        }
        Some(rate_hz) => format!("at {rate_hz} Hz"),
        None => "at its own rate".into(),
    };
    tracing::info!("playing {} {rate}", source.name());
    CaptureLoop::new(context, source, config.pace.clone(), runtime)?.run()
}

/// Opens the source; `None` when shutdown was requested before it could be opened. A source
/// that was usable when the daemon was started is tried again until it is back.
fn open_source(context: &Context, config: &Config) -> Result<Option<Box<dyn Source>>, Failure> {
    let mut outage = Outage::new(context.health.clone(), context.shutdown.clone());
    while !context.shutdown.is_requested() {
        match source::open(&config.source, &config.playback, Some(&context.domain)) {
            Ok(source) => {
                outage.end(source.name());
                return Ok(Some(source));
            }
            Err(error) if config.is_source_awaited => outage.wait(&error.to_string()),
            Err(error) => return Err(Failure::usage(error)),
        }
    }
    Ok(None)
}
