//! Capture loop: loan, fill, wait for the scheduled time, send.

use crate::image_publisher::{ImagePublisher, LoanedImages};
use crate::lead_time::LeadTime;
use crate::lockstep::{FramePace, Lockstep, LockstepOutcome};
use crate::outage::Outage;
use crate::schedule::Schedule;
use crate::source::{FrameInfo, FrameSize, IdleUpdate, Source};
use crate::source_error::SourceError;
use channel::topic::CameraCloud;
use channel::{Loan, Publisher};
use message::{
    CloudPoint, FrameHeader, ProcessState, Stage, Text, WireTransform, frame_flag, points,
    points_mut,
};
use service::{
    Context, Failure, Stopwatch, TracePublisher, is_service, monotonic_ns, wall_clock_offset_ns,
};
use std::collections::BTreeSet;
use std::sync::atomic::Ordering;
use std::time::Duration;
use tokio::runtime::Handle;

/// Longest sleep between two checks of the shutdown request.
const NAP: Duration = Duration::from_millis(50);
/// Longest time for which the opening of a device counts as progress. Chosen: a Kinect whose
/// firmware is loaded again takes some seconds.
const OPENING_LIMIT: Duration = Duration::from_secs(20);
/// Capture time of the first frame in lockstep, nanoseconds; lockstep has its own
/// clock.
const LOCKSTEP_START_NS: u64 = 1_000_000_000;

/// Reason for the end of the loop without a failure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CaptureEnd {
    /// Capture ended because shutdown was requested.
    Stopped,
    /// Capture ended at the end of the recording.
    EndOfRecording,
}

/// Frame that is filled and not sent yet.
struct FilledFrame {
    cloud: Loan<CameraCloud>,
    /// Raw images, while somebody subscribes to them.
    images: Option<LoanedImages>,
    info: FrameInfo,
}

/// Capture loop of one source; runs on a separate thread.
pub struct CaptureLoop {
    source: Box<dyn Source>,
    publisher: Publisher<CameraCloud>,
    images: ImagePublisher,
    trace: TracePublisher,
    schedule: Option<Schedule>,
    lead_time: LeadTime,
    lockstep: Option<Lockstep>,
    session: u64,
    sequence: u64,
    is_ready: bool,
    outage: Outage,
    /// Log sentences already written about unusable frames.
    reported: BTreeSet<String>,
    context: Context,
    runtime: Handle,
}

impl CaptureLoop {
    /// Creates a loop that plays `source`; in lockstep each frame waits for its
    /// followers.
    ///
    /// # Errors
    /// When the topic of the clouds cannot be opened, or its shared memory is not free.
    pub fn new(
        context: Context,
        source: Box<dyn Source>,
        pace: FramePace,
        runtime: Handle,
    ) -> Result<Self, Failure> {
        let publisher = Publisher::for_items(&context.domain, source.max_points())?;
        let images = ImagePublisher::new(&context.domain, source.max_points())?;
        let trace = TracePublisher::new(&context.domain, context.process)?;
        context.health.shared_memory_bytes.store(
            publisher.reservation().bytes() + images.reserved_bytes() + trace.reserved_bytes(),
            Ordering::Relaxed,
        );
        let start_ns = if pace.is_lockstep() {
            LOCKSTEP_START_NS
        } else {
            monotonic_ns()
        };
        let entered = runtime.enter();
        let lockstep = Lockstep::new(&context.domain, pace)?;
        drop(entered);
        Ok(Self {
            schedule: source
                .rate_hz()
                .map(|rate_hz| Schedule::new(start_ns, rate_hz)),
            lead_time: LeadTime::UNKNOWN,
            source,
            publisher,
            images,
            trace,
            lockstep,
            session: random_session(),
            sequence: 0,
            is_ready: false,
            outage: Outage::new(context.health.clone(), context.shutdown.clone()),
            reported: BTreeSet::new(),
            context,
            runtime,
        })
    }

    /// Runs until the end of the source, shutdown, or a failure.
    ///
    /// # Errors
    /// When the source cannot be used for the first frame. Later failures are an outage, and all of
    /// those of a service.
    pub fn run(mut self) -> Result<CaptureEnd, Failure> {
        if self.lockstep.is_some() {
            self.wait_for_subscriber();
        }
        while !self.context.shutdown.is_requested() {
            self.context.health.record_progress();
            match self.capture_frame() {
                Ok(true) => self.outage.end(self.source.name()),
                Ok(false) | Err(SourceError::EndOfRecording) => {
                    return Ok(CaptureEnd::EndOfRecording);
                }
                Err(SourceError::Unusable(sentence)) if !self.is_ready && !is_service() => {
                    return Err(Failure::usage(sentence));
                }
                Err(error @ SourceError::Frame { .. }) => self.leave_out(&error),
                Err(SourceError::Unusable(sentence) | SourceError::Unavailable(sentence)) => {
                    self.wait_out(&sentence);
                }
            }
        }
        Ok(CaptureEnd::Stopped)
    }

    /// Counts an unusable frame, and logs it once: a looped recording repeats its bad frames
    /// in every round.
    fn leave_out(&mut self, error: &SourceError) {
        let sentence = error.to_string();
        if !self.reported.contains(&sentence) {
            tracing::warn!("{sentence}");
            self.reported.insert(sentence);
        }
        let n_dropped = &self.context.health.frames_dropped;
        n_dropped.fetch_add(1, Ordering::Relaxed);
    }

    /// Waits before the next attempt of a source or of shared memory that has failed. In
    /// lockstep the clock of the frames stands still meanwhile.
    fn wait_out(&mut self, sentence: &str) {
        self.outage.wait(sentence);
        if let (Some(schedule), None) = (&mut self.schedule, &self.lockstep) {
            schedule.restart(monotonic_ns());
        }
    }

    /// Captures and sends the next frame; `false` at the end of the recording.
    fn capture_frame(&mut self) -> Result<bool, SourceError> {
        let mut watch = Stopwatch::start();
        let Some(size) = self.prepare()? else {
            return Ok(false);
        };
        let preparing = watch.lap(Stage::Preparing, 0);
        self.wait_for_lead_time()?;
        let making_wait = watch.lap(Stage::GenerationWait, 0);
        let mut frame = self.loan_filled(size)?;
        self.become_ready();
        let making = watch.lap(Stage::Generation, 0);
        self.lead_time.record(making.duration_ns());
        let sent = if self.lockstep.is_some() {
            self.send_in_lockstep(frame)
        } else {
            self.wait_until_due(&mut frame)?;
            let release_wait = watch.lap(Stage::ReleaseWait, 0);
            let FilledFrame {
                cloud,
                images,
                info,
            } = frame;
            self.send(cloud, images, &info).map(|header| {
                let sending = watch.lap(Stage::Sending, 0);
                let spans = [preparing, making_wait, making, release_wait, sending];
                self.trace.send(&header, &spans);
            })
        };
        // A frame of which it is not known whether it was sent keeps its number.
        self.sequence += 1;
        sent.map(|()| true)
    }

    /// Prepares the next frame. After an outage that may mean to open a device.
    fn prepare(&mut self) -> Result<Option<FrameSize>, SourceError> {
        let prepared = if self.outage.is_ongoing() {
            let health = &self.context.health;
            health.record_progress_during(OPENING_LIMIT, || self.source.prepare())
        } else {
            self.source.prepare()
        };
        if let (Some(schedule), Ok(_)) = (&mut self.schedule, &prepared) {
            schedule.set_frame_time(self.source.frame_time_ns());
        }
        prepared
    }

    fn loan_filled(&mut self, size: FrameSize) -> Result<FilledFrame, SourceError> {
        let mut cloud = self.publisher.loan(size.n_points())?;
        let points = points_mut(cloud.items_mut());
        let info = self.source.fill(points)?;
        let images = self.images.loan_filled(&*self.source, &info, points);
        Ok(FilledFrame {
            cloud,
            images,
            info,
        })
    }

    /// Sends a cloud, and the images of its frame behind it, so that they never delay it.
    fn send(
        &mut self,
        mut loan: Loan<CameraCloud>,
        images: Option<LoanedImages>,
        info: &FrameInfo,
    ) -> Result<FrameHeader, SourceError> {
        let now_ns = monotonic_ns();
        let due_ns = self.schedule.map(|schedule| schedule.due_ns());
        let location = self.publisher.location(&loan);
        let mut header = FrameHeader {
            session: self.session,
            sequence: self.sequence,
            capture_stamp_ns: info.captured_ns.or(due_ns).unwrap_or(now_ns),
            scheduled_stamp_ns: due_ns.or(info.captured_ns).unwrap_or(now_ns),
            published_stamp_ns: now_ns,
            location,
            ..header(info, self.source.name(), self.lockstep.is_some())
        };
        self.source.complete_header(&mut header);
        *loan.header_mut() = header;
        self.source.before_send(&header)?;
        self.publisher.send(loan)?;
        if let Some(images) = images {
            self.images.send(images, &header);
        }
        self.source.after_send(&header)?;
        // In lockstep no frame is late: the followers set the pace.
        let released_ns = due_ns.filter(|_| self.lockstep.is_some()).unwrap_or(now_ns);
        let was_late = self
            .schedule
            .as_mut()
            .is_some_and(|schedule| schedule.release(released_ns));
        let health = &self.context.health;
        health.frames.fetch_add(1, Ordering::Relaxed);
        if was_late {
            health.frames_late.fetch_add(1, Ordering::Relaxed);
        }
        Ok(header)
    }

    /// Sends the frame repeatedly until all followers have finished it. A repeated
    /// frame is identical to the bit, so that repeating it changes no result.
    fn send_in_lockstep(&mut self, frame: FilledFrame) -> Result<(), SourceError> {
        let FilledFrame {
            mut cloud,
            images,
            info,
        } = frame;
        let copy = cloud.items_mut().to_vec();
        let schedule = self.schedule;
        let mut sent = self.send_and_wait(cloud, images, &info);
        loop {
            match sent {
                Ok(LockstepOutcome::Finished | LockstepOutcome::Stop) => return Ok(()),
                Ok(LockstepOutcome::TimedOut) => {
                    tracing::warn!("no report on frame {}; sending it again", self.sequence);
                }
                Err(SourceError::Unavailable(sentence)) => self.wait_out(&sentence),
                Err(error) => return Err(error),
            }
            if self.context.shutdown.is_requested() {
                return Ok(());
            }
            self.context.health.record_progress();
            self.schedule = schedule;
            sent = self
                .loan_copy(&copy)
                .and_then(|loan| self.send_and_wait(loan, None, &info));
        }
    }

    fn loan_copy(&self, points: &[CloudPoint]) -> Result<Loan<CameraCloud>, SourceError> {
        let mut loan = self.publisher.loan(points.len())?;
        loan.items_mut().copy_from_slice(points);
        Ok(loan)
    }

    /// Sends the frame and waits until its followers have finished it.
    fn send_and_wait(
        &mut self,
        loan: Loan<CameraCloud>,
        images: Option<LoanedImages>,
        info: &FrameInfo,
    ) -> Result<LockstepOutcome, SourceError> {
        self.send(loan, images, info)?;
        let Some(lockstep) = &mut self.lockstep else {
            return Ok(LockstepOutcome::Finished);
        };
        let Context {
            shutdown, health, ..
        } = &self.context;
        let finished = lockstep.finished((self.session, self.sequence), shutdown, health);
        Ok(self.runtime.block_on(finished)?)
    }

    /// Waits for the latest safe time to make the prepared frame.
    fn wait_for_lead_time(&mut self) -> Result<(), SourceError> {
        let (Some(schedule), Some(lead_ns)) = (self.schedule, self.lead_time.lead_ns()) else {
            return Ok(());
        };
        if self.lockstep.is_some() {
            return Ok(());
        }
        let due_ns = schedule.due_ns();
        self.wait_until(due_ns.saturating_sub(lead_ns), |source| {
            source.while_waiting(due_ns, None)
        })
    }

    fn wait_until_due(&mut self, frame: &mut FilledFrame) -> Result<(), SourceError> {
        let Some(due_ns) = self.schedule.map(|schedule| schedule.due_ns()) else {
            return Ok(());
        };
        let FilledFrame {
            cloud,
            images,
            info,
        } = frame;
        let mut is_rewritten = false;
        self.wait_until(due_ns, |source| {
            let points = points_mut(cloud.items_mut());
            let mut waiting = source.while_waiting(due_ns, Some(points))?;
            if let Some(rewritten) = waiting.rewritten.take() {
                (*info, is_rewritten) = (rewritten, true);
            }
            Ok(waiting)
        })?;
        if is_rewritten {
            // The old loan is returned first: there is one.
            *images = None;
            *images = self
                .images
                .loan_filled(&*self.source, info, points(cloud.items_mut()));
        }
        Ok(())
    }

    /// Waits for a monotonic time; the source may do small work meanwhile.
    fn wait_until(
        &mut self,
        end_ns: u64,
        mut while_waiting: impl FnMut(&mut dyn Source) -> Result<IdleUpdate, SourceError>,
    ) -> Result<(), SourceError> {
        while !self.context.shutdown.is_requested() {
            let waiting = while_waiting(&mut *self.source)?;
            let until_ns = end_ns.min(waiting.next_call_ns.unwrap_or(end_ns));
            let left = Duration::from_nanos(until_ns.saturating_sub(monotonic_ns()));
            if monotonic_ns() >= end_ns {
                return Ok(());
            }
            // A source may be woken by unparking this thread.
            std::thread::park_timeout(left.min(NAP));
            self.context.health.record_progress();
        }
        Ok(())
    }

    fn wait_for_subscriber(&self) {
        while !self.publisher.has_subscribers() && !self.context.shutdown.is_requested() {
            std::thread::sleep(NAP);
            self.context.health.record_progress();
        }
    }

    /// Reports readiness with the first frame: a source without any usable frame never was
    /// ready, so that its failure is one of the start.
    fn become_ready(&mut self) {
        if !std::mem::replace(&mut self.is_ready, true) {
            self.context.health.set_state(ProcessState::Ready, "");
        }
    }
}

/// Header fields that the frame itself determines.
fn header(info: &FrameInfo, source_name: &str, is_lockstep: bool) -> FrameHeader {
    let flag = |is_set: bool, bit: u32| if is_set { bit } else { 0 };
    let mut header = FrameHeader {
        flags: flag(is_lockstep, frame_flag::LOCKSTEP)
            | flag(info.world_from_camera.is_some(), frame_flag::HAS_WORLD_POSE)
            | flag(info.up_in_camera.is_some(), frame_flag::HAS_UP)
            | flag(info.is_calibrated, frame_flag::CALIBRATED),
        source_frame: info.source_frame as u64,
        wall_clock_offset_ns: wall_clock_offset_ns(),
        source_name: Text::truncated(source_name),
        ..FrameHeader::default()
    };
    header.set_camera(&info.camera);
    if let Some(pose) = &info.world_from_camera {
        header.world_from_camera = WireTransform::from(pose);
    }
    if let Some(up) = info.up_in_camera {
        header.up_in_camera = up.into_inner().into();
    }
    header
}

/// Random session id: sessions must differ between runs; without randomness the clock
/// must do.
fn random_session() -> u64 {
    getrandom::u64().unwrap_or_else(|_| monotonic_ns())
}
