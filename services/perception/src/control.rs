//! What the perception answers.

use crate::world::World;
use channel::control::{AnswerFuture, Handler};
use message::control::{Command, Refusal, RefusalKind, Reply};
use std::sync::Arc;

/// Answers from the latest scene.
pub(crate) fn handler(world: Arc<World>) -> Handler {
    Arc::new(move |command| -> AnswerFuture {
        let reply = answer(&world, &command);
        Box::pin(std::future::ready(reply))
    })
}

fn answer(world: &World, command: &Command) -> Reply {
    match command {
        Command::Objects => Reply::Objects(world.objects()),
        Command::Ask { track_id } => match world.object(*track_id) {
            Some(object) => Reply::Object(Box::new(object)),
            None => Reply::Refused(no_such_track(world, *track_id)),
        },
        other => Reply::Refused(Refusal::new(
            RefusalKind::Internal,
            format!("tabula-perception does not answer {other:?}"),
        )),
    }
}

fn no_such_track(world: &World, track_id: u64) -> Refusal {
    let ids: Vec<String> = world
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
    fn who_asks_for_a_missing_track_is_told_which_there_are() {
        let world = World::default();
        let ask = |track_id| answer(&world, &Command::Ask { track_id });
        let Reply::Refused(refusal) = ask(3) else {
            panic!("track 3 is not there")
        };
        assert!(refusal.sentence.contains("nothing is tracked"), "{refusal}");
        let object = SceneObject {
            track_id: 8,
            ..SceneObject::default()
        };
        world.set(&SceneSummary::default(), &[object]);
        let Reply::Refused(refusal) = ask(3) else {
            panic!("track 3 is not there")
        };
        assert!(refusal.sentence.contains("the tracks are 8"), "{refusal}");
        assert!(matches!(ask(8), Reply::Object(_)));
    }
}
