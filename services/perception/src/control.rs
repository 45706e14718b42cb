//! Request handler of the perception service.

use crate::latest_scene::LatestScene;
use crate::memory_replica::{HistoryPosition, SyncBarrier};
use channel::control::{AnswerFuture, Handler};
use message::control::{Command, Refusal, RefusalKind, Reply};
use std::sync::Arc;
use std::time::Duration;

/// Time limit for labels to include what the memory has acknowledged. The gateway waits
/// longer.
const CATCH_UP: Duration = Duration::from_secs(3);

/// Request handler that answers from the latest scene.
pub(crate) fn handler(scene: Arc<LatestScene>, barrier: SyncBarrier) -> Handler {
    Arc::new(move |command, _| -> AnswerFuture {
        let (scene, barrier) = (scene.clone(), barrier.clone());
        Box::pin(async move {
            let Command::ReadAfter {
                store_id,
                sequence,
                command,
            } = command
            else {
                return answer(&scene, &command);
            };
            let position = HistoryPosition {
                store_id: Some(store_id),
                sequence,
            };
            match labelled_after(&scene, position, barrier.wait(), CATCH_UP).await {
                Ok(()) => answer(&scene, &command),
                Err(refusal) => Reply::Refused(refusal),
            }
        })
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

fn answer(scene: &LatestScene, command: &Command) -> Reply {
    match command {
        Command::Objects => Reply::Objects(scene.objects()),
        Command::DepthNoise => Reply::DepthNoise(scene.depth_noise()),
        Command::Ask { track_id } => match scene.object(*track_id) {
            Some(object) => Reply::Object(Box::new(object)),
            None => Reply::Refused(no_such_track(scene, *track_id)),
        },
        other => Reply::Refused(Refusal::new(
            RefusalKind::Internal,
            format!("tabula-perception does not answer {other:?}"),
        )),
    }
}

fn no_such_track(scene: &LatestScene, track_id: u64) -> Refusal {
    let ids: Vec<String> = scene
        .objects()
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
        let scene = LatestScene::default();
        let ask = |track_id| answer(&scene, &Command::Ask { track_id });
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
            scene.outdated().await;
            scene.update(at(5), |_| ());
        };
        let long = Duration::from_secs(60);
        let (waited, ()) = tokio::join!(labelled_after(&scene, at(5), ready(), long), relabel);
        assert!(waited.is_ok());
    }
}
