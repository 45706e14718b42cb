//! Canonical stream of events of a replay, with a digest: two replays are equal when their
//! digests are.

use message::{SceneObject, SceneSummary, document};
use scene_document::{
    ActorStampsDocument, AssumptionDocument, ObjectDocument, RejectedDocument, SceneDocument,
    SurfaceDocument,
};
use serde::Serialize;
use std::collections::BTreeMap;

/// Kinds of events, in the order of their names.
const ENDED: &str = "ended";
const LABEL: &str = "label";
const OBJECT: &str = "object";
const SCENE: &str = "scene";
const STARTED: &str = "started";

/// Event as it is written: one JSON object a line. Stage stamps and the session, which differ
/// from run to run, are left out.
#[derive(Debug, Serialize)]
struct ReplayEvent<T> {
    frame: u64,
    track_id: u64,
    kind: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    content: Option<T>,
}

/// Deterministic part of a scene without its objects.
#[derive(Debug, Serialize)]
struct SceneContent {
    capture_stamp_ns: Option<u64>,
    frames_dropped: u64,
    n_late: u32,
    has_table: bool,
    surfaces: Vec<SurfaceDocument>,
    assumptions: Vec<AssumptionDocument>,
    ignored: Vec<RejectedDocument>,
    n_more_ignored: u32,
}

/// Digest of an event stream.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct EventDigest {
    /// BLAKE3 digest of all lines with their line feeds, hexadecimal.
    pub blake3: String,
    /// Number of scenes.
    pub n_frames: u64,
    /// Number of events.
    pub n_events: u64,
}

/// Converter of scenes into events in the order of frame, track-id and kind.
#[derive(Debug, Default)]
pub struct EventStream {
    hasher: blake3::Hasher,
    /// Labels of the live tracks.
    labels: BTreeMap<u64, Option<String>>,
    n_frames: u64,
    n_events: u64,
}

impl EventStream {
    /// Stream before the first scene.
    pub fn new() -> Self {
        Self::default()
    }

    /// Events of the next scene: lines of JSON, each with a line feed.
    ///
    /// # Errors
    /// When an event cannot be written as JSON.
    pub fn add(
        &mut self,
        scene: &SceneSummary,
        objects: &[SceneObject],
    ) -> Result<String, serde_json::Error> {
        // At the beginning of the clock no scene has an age yet, so that the time of processing does
        // not count.
        let document = document::scene(scene, objects, 0);
        let mut lines = self.lines(document)?;
        lines.sort_by_key(|(key, _)| *key);
        let mut text = String::new();
        for (_, line) in &lines {
            text.push_str(line);
            text.push('\n');
        }
        self.hasher.update(text.as_bytes());
        self.n_frames += 1;
        self.n_events += lines.len() as u64;
        Ok(text)
    }

    /// Digest of all events so far.
    pub fn digest(&self) -> EventDigest {
        EventDigest {
            blake3: self.hasher.finalize().to_hex().to_string(),
            n_frames: self.n_frames,
            n_events: self.n_events,
        }
    }

    /// Lines of a scene, each with its track-id and kind.
    fn lines(&mut self, scene: SceneDocument) -> Result<Vec<EventLine>, serde_json::Error> {
        let frame = scene.frame_sequence;
        let mut lines = Vec::new();
        let before = std::mem::take(&mut self.labels);
        for object in scene.objects {
            let (track_id, label) = (object.track_id, object.label.clone());
            let old_label = before.get(&track_id);
            if old_label.is_none() {
                lines.push(line::<()>(frame, track_id, STARTED, None)?);
            }
            if old_label.unwrap_or(&None) != &label {
                lines.push(line(frame, track_id, LABEL, Some(&label))?);
            }
            lines.push(line::<ObjectDocument>(
                frame,
                track_id,
                OBJECT,
                Some(ObjectDocument {
                    stamps: ActorStampsDocument::default(),
                    ..object
                }),
            )?);
            self.labels.insert(track_id, label);
        }
        for &track_id in before.keys().filter(|id| !self.labels.contains_key(id)) {
            lines.push(line::<()>(frame, track_id, ENDED, None)?);
        }
        let content = SceneContent {
            capture_stamp_ns: scene.capture_stamp_ns,
            frames_dropped: scene.frames_dropped,
            n_late: scene.n_late,
            has_table: scene.has_table,
            surfaces: scene.surfaces,
            assumptions: scene.assumptions,
            ignored: scene.ignored,
            n_more_ignored: scene.n_more_ignored,
        };
        lines.push(line(frame, 0, SCENE, Some(content))?);
        Ok(lines)
    }
}

/// Track-id and kind of an event, and its line.
type EventLine = ((u64, &'static str), String);

fn line<T: Serialize>(
    frame: u64,
    track_id: u64,
    kind: &'static str,
    content: Option<T>,
) -> Result<EventLine, serde_json::Error> {
    let event = ReplayEvent {
        frame,
        track_id,
        kind,
        content,
    };
    Ok(((track_id, kind), serde_json::to_string(&event)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use message::{StageStamps, Text};

    fn object(track_id: u64, label: &str) -> SceneObject {
        SceneObject {
            track_id,
            is_labelled: u32::from(!label.is_empty()),
            label: Text::truncated(label),
            ..SceneObject::default()
        }
    }

    fn scene(sequence: u64, received_ns: u64) -> SceneSummary {
        SceneSummary {
            sequence,
            session: received_ns,
            stamps: StageStamps {
                received_ns,
                ..StageStamps::default()
            },
            ..SceneSummary::default()
        }
    }

    fn kinds(text: &str) -> Vec<(u64, String)> {
        let parse = |line: &str| {
            let event: serde_json::Value = serde_json::from_str(line).unwrap();
            (
                event["track_id"].as_u64().unwrap(),
                event["kind"].as_str().unwrap().to_owned(),
            )
        };
        text.lines().map(parse).collect()
    }

    #[test]
    fn events_are_in_the_order_of_track_and_kind() {
        let mut stream = EventStream::new();
        let first = stream
            .add(&scene(0, 1), &[object(2, ""), object(1, "mug")])
            .unwrap();
        let expected = [
            (0, "scene"),
            (1, "label"),
            (1, "object"),
            (1, "started"),
            (2, "object"),
            (2, "started"),
        ];
        assert_eq!(
            kinds(&first),
            expected.map(|(id, kind)| (id, kind.to_owned()))
        );
        let second = stream.add(&scene(1, 2), &[object(2, "jar")]).unwrap();
        let expected = [(0, "scene"), (1, "ended"), (2, "label"), (2, "object")];
        assert_eq!(
            kinds(&second),
            expected.map(|(id, kind)| (id, kind.to_owned()))
        );
        let digest = stream.digest();
        assert_eq!((digest.n_frames, digest.n_events), (2, 10));
    }

    #[test]
    fn digest_depends_on_content_and_not_on_stage_stamps() {
        let digest = |received_ns, label| {
            let mut stream = EventStream::new();
            stream
                .add(&scene(0, received_ns), &[object(1, label)])
                .unwrap();
            stream.digest()
        };
        assert_eq!(digest(1, "mug"), digest(2, "mug"));
        assert_ne!(digest(1, "mug"), digest(1, "jar"));
    }
}
