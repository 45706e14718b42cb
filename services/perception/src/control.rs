//! Request handler of the perception service.

use crate::latest_scene::LatestScene;
use crate::memory_replica::{HistoryPosition, SyncBarrier};
use channel::control::{self, Handler};
use control_protocol::{Command, QuestionReport, QuestionsReport, Refusal, RefusalKind, Reply};
use message::ProcessState;
use scene_document::SceneDocument;
use service::{HealthCounters, monotonic_ns};
use std::sync::Arc;
use std::time::Duration;

/// Time limit for labels to include what the memory has acknowledged. The gateway waits
/// longer.
const CATCH_UP: Duration = Duration::from_secs(3);

/// Request handler that answers from the latest scene.
pub(crate) fn handler(
    scene: Arc<LatestScene>,
    barrier: SyncBarrier,
    health: Arc<HealthCounters>,
) -> Handler {
    control::handler(move |command, _| {
        let (scene, barrier, health) = (scene.clone(), barrier.clone(), health.clone());
        async move {
            let Command::ReadAfter {
                store_id,
                sequence,
                command,
            } = command
            else {
                return answer(&scene, &health, &command);
            };
            let position = HistoryPosition {
                store_id: Some(store_id),
                sequence,
            };
            let labelled = labelled_after(&scene, position, barrier.wait(), CATCH_UP);
            tokio::select! {
                biased;
                labelled = labelled => match labelled {
                    Ok(()) => answer(&scene, &health, &command),
                    Err(refusal) => Reply::Refused(refusal),
                },
                // The live scene is no business of the memory.
                () = barrier.memory_lost() => with_old_labels(answer(&scene, &health, &command)),
            }
        }
    })
}

/// Waits until the labels of the scene include a position of the memory's history:
/// first for the replica of the memory (`caught_up`), then for the labels.
async fn labelled_after(
    scene: &LatestScene,
    position: HistoryPosition,
    caught_up: impl Future<Output = ()>,
    deadline: Duration,
) -> Result<(), Refusal> {
    if scene.includes(position) {
        return Ok(());
    }
    let current = async {
        caught_up.await;
        scene.labelled_after(position).await;
    };
    tokio::time::timeout(deadline, current).await.map_err(|_| {
        let sentence = format!(
            "perception has not applied the memory's history up to {} within {} s; try again",
            position.sequence,
            deadline.as_secs_f64()
        );
        Refusal::new(RefusalKind::Unavailable, sentence)
    })
}

fn answer(scene: &LatestScene, health: &HealthCounters, command: &Command) -> Reply {
    let now_ns = monotonic_ns();
    match command {
        Command::Objects => Reply::Objects(Box::new(scene.objects(now_ns).unwrap_or_else(|| {
            SceneDocument {
                is_stale: true,
                note: no_scene(health),
                ..SceneDocument::default()
            }
        }))),
        Command::Question => {
            let scene = scene.objects(now_ns).unwrap_or_default();
            let question = QuestionReport::most_useful(&scene.objects);
            Reply::Question(QuestionsReport { question })
        }
        Command::DepthNoise => Reply::DepthNoise(scene.depth_noise()),
        Command::Ask { track_id } => match scene.object(*track_id, now_ns) {
            Some(object) => Reply::Object(Box::new(object)),
            None => Reply::Refused(no_such_track(scene, health, *track_id)),
        },
        other => Reply::Refused(Refusal::new(
            RefusalKind::Internal,
            format!("tabula-perception does not answer {other:?}"),
        )),
    }
}

/// Answer while the memory is away: its labels may lack the last changes, and it says so.
fn with_old_labels(mut reply: Reply) -> Reply {
    if let Reply::Objects(scene) = &mut reply
        && scene.note.is_empty()
    {
        "the memory does not answer: names may lack its last changes".clone_into(&mut scene.note);
    }
    reply
}

/// Reason why there is no scene yet.
fn no_scene(health: &HealthCounters) -> String {
    match health.state() {
        (ProcessState::Starting, _) => {
            "perception is starting: it waits for the memory; try again".to_owned()
        }
        _ => "no frame has come yet; see the camera in `tabula status`, and try again".to_owned(),
    }
}

fn no_such_track(scene: &LatestScene, health: &HealthCounters, track_id: u64) -> Refusal {
    let Some(report) = scene.objects(monotonic_ns()) else {
        return Refusal::new(RefusalKind::Unavailable, no_scene(health));
    };
    let ids: Vec<String> = report
        .objects
        .iter()
        .map(|object| object.track_id.to_string())
        .collect();
    let there = if ids.is_empty() {
        "nothing is tracked now".to_owned()
    } else {
        format!("the tracks are {}", ids.join(", "))
    };
    Refusal::new(
        RefusalKind::NotFound,
        format!("there is no track {track_id}; {there}"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use message::{SceneObject, SceneSummary};

    #[test]
    fn a_missing_track_is_refused_with_the_live_tracks() {
        let (scene, health) = (LatestScene::default(), HealthCounters::default());
        scene.set(&SceneSummary::default(), &[], HistoryPosition::default());
        let ask = |track_id| answer(&scene, &health, &Command::Ask { track_id });
        let Reply::Refused(refusal) = ask(3) else {
            panic!("track 3 is not there")
        };
        assert!(refusal.sentence.contains("nothing is tracked"), "{refusal}");
        let object = SceneObject {
            track_id: 8,
            ..SceneObject::default()
        };
        scene.set(
            &SceneSummary::default(),
            &[object],
            HistoryPosition::default(),
        );
        let Reply::Refused(refusal) = ask(3) else {
            panic!("track 3 is not there")
        };
        assert!(refusal.sentence.contains("the tracks are 8"), "{refusal}");
        assert!(matches!(ask(8), Reply::Object(_)));
    }

    #[test]
    fn answer_before_the_first_frame_says_what_is_waited_for() {
        let (scene, health) = (LatestScene::default(), HealthCounters::default());
        let note = || match answer(&scene, &health, &Command::Objects) {
            Reply::Objects(report) => {
                assert!(report.is_stale && report.scene_age_s.is_none());
                report.note
            }
            other => panic!("{other:?}"),
        };
        assert!(note().contains("perception is starting"));
        let Reply::Refused(refusal) = answer(&scene, &health, &Command::Ask { track_id: 1 }) else {
            panic!("there is no scene")
        };
        assert_eq!(refusal.kind, RefusalKind::Unavailable);
        assert!(refusal.sentence.contains("starting"), "{refusal}");
        health.set_state(ProcessState::Ready, "");
        assert!(note().contains("no frame has come yet"));
    }

    #[tokio::test]
    async fn an_answer_waits_until_the_labels_include_what_was_acknowledged() {
        let at = |sequence| HistoryPosition {
            store_id: Some(1),
            sequence,
        };
        let scene = LatestScene::default();
        scene.set(&SceneSummary::default(), &[], at(4));
        let ready = || std::future::ready(());
        let short = Duration::from_millis(1);
        assert!(
            labelled_after(&scene, at(4), std::future::pending(), short)
                .await
                .is_ok()
        );
        let late = labelled_after(&scene, at(5), ready(), short).await;
        let refusal = late.unwrap_err();
        assert_eq!(refusal.kind, RefusalKind::Unavailable);
        assert!(refusal.sentence.contains("history up to 5"), "{refusal}");
        let relabel = async {
            tokio::task::yield_now().await;
            scene.update(at(5), |_| ());
        };
        let long = Duration::from_secs(60);
        let (waited, ()) = tokio::join!(labelled_after(&scene, at(5), ready(), long), relabel);
        assert!(waited.is_ok());
    }
}
