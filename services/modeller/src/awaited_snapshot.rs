//! First snapshot of a running daemon with the points of its objects.

use command_line::StopSignal;
use scene_client::{Snapshot, SnapshotReceiver};
use service::{Failure, exit_code};
use std::time::{Duration, Instant};

/// Polling period of the topics.
pub(crate) const POLL_PERIOD: Duration = Duration::from_millis(2);
/// Time for which a frame with its scene is awaited.
const FRAME_PATIENCE: Duration = Duration::from_secs(5);
/// Time for which the points of all objects are awaited, and objects that are not confirmed yet.
const POINTS_PATIENCE: Duration = Duration::from_millis(1500);

/// First snapshot with the points of all objects; after a while one with those that have come.
/// `None` when the stop signal is raised.
pub(crate) fn awaited_snapshot(
    receiver: &mut SnapshotReceiver,
    stop: &StopSignal,
) -> Result<Option<Snapshot>, Failure> {
    let begun = Instant::now();
    let mut first_scene = None;
    while !stop.is_raised() {
        if receiver.receive()? {
            let first = *first_scene.get_or_insert_with(Instant::now);
            let is_late = first.elapsed() > POINTS_PATIENCE;
            if (is_late || receiver.is_complete())
                && let Some(snapshot) = receiver.snapshot()
            {
                return Ok(Some(snapshot));
            }
        }
        if begun.elapsed() > FRAME_PATIENCE + POINTS_PATIENCE
            || (begun.elapsed() > FRAME_PATIENCE && first_scene.is_none())
        {
            let sentence = if receiver.has_frame() {
                "frames come, but no scene of them within 5 s; see `tabula status`"
            } else {
                "no frame came within 5 s; see `tabula status`, and whether the recording has ended"
            };
            return Err(Failure::new(exit_code::TIMED_OUT, sentence));
        }
        stop.sleep(POLL_PERIOD);
    }
    Ok(None)
}
