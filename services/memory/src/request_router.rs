//! Request router: answers from the stores, or forwards to the owning process.

use crate::absent_arm::arm_refusal;
use crate::event_report;
use crate::find_request::{KnownWorld, Synonyms};
use crate::process_table::ProcessTable;
use crate::working_memory::{WorkingMemory, now_ns};
use channel::Domain;
use channel::control::{Client, Peer};
use memory_requests::MemoryRequestHandler;
use message::ProcessKind;
use message::control::{
    Command, FindQuery, QuestionReport, QuestionsReport, Refusal, RefusalKind, Reply, UserRole,
};
use perceptual_memory::{Position, Requester};
use scene_document::SceneDocument;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::watch;

/// Time limit for the answer of another process; a client waits for 5 s.
const DEADLINE: Duration = Duration::from_secs(4);

/// Router of all control requests, the gateway for clients.
pub(crate) struct RequestRouter {
    pub(crate) domain: Domain,
    pub(crate) handler: Arc<MemoryRequestHandler>,
    pub(crate) perception: Client,
    pub(crate) arm: Client,
    pub(crate) processes: Arc<ProcessTable>,
    pub(crate) world: Arc<WorkingMemory>,
    pub(crate) synonyms: Arc<Synonyms>,
    /// Newest acknowledged position of the history.
    pub(crate) position: watch::Receiver<Position>,
}

impl RequestRouter {
    /// Reply to a command of a user; a refusal gives the reason.
    pub(crate) async fn answer(&self, command: Command, peer: Peer) -> Reply {
        self.try_answer(command, peer)
            .await
            .unwrap_or_else(Reply::Refused)
    }

    async fn try_answer(&self, command: Command, peer: Peer) -> Result<Reply, Refusal> {
        match command.owner() {
            ProcessKind::Perception => {
                let command = read_after(*self.position.borrow(), command);
                return ask(&self.perception, command).await;
            }
            ProcessKind::Simulator => {
                let reply = self.arm.call(command, DEADLINE).await;
                return reply.map_err(|error| arm_refusal(&error, &self.processes));
            }
            ProcessKind::Memory | ProcessKind::Camera => {}
        }
        match command {
            Command::Health => Ok(Reply::Health(self.processes.reports())),
            Command::ReloadConfiguration => {
                let reports = service::reload_processes(&self.domain, DEADLINE).await;
                Ok(Reply::Reloaded(reports))
            }
            Command::World(command) => self.world.answer(command).await,
            Command::Find(query) => self.find(query, peer).await,
            Command::Question => self.question().await,
            command => self.answer_from_memory(command, peer).await,
        }
    }

    /// Scene with the newest labels.
    async fn scene(&self) -> Result<SceneDocument, Refusal> {
        let objects = read_after(*self.position.borrow(), Command::Objects);
        match ask(&self.perception, objects).await? {
            Reply::Objects(scene) => Ok(*scene),
            Reply::Refused(refusal) => Err(refusal),
            other => Err(unexpected(&other)),
        }
    }

    /// Question about the object whose name would teach most.
    async fn question(&self) -> Result<Reply, Refusal> {
        let scene = self.scene().await?;
        let question = QuestionReport::most_useful(&scene.objects);
        Ok(Reply::Question(QuestionsReport { question }))
    }

    /// Reply to a query in words, with the newest labels.
    async fn find(&self, query: FindQuery, peer: Peer) -> Result<Reply, Refusal> {
        let scene = self.scene().await?;
        let categories = match self.answer_from_memory(Command::Categories, peer).await? {
            Reply::Categories(categories) => categories,
            other => return Err(unexpected(&other)),
        };
        let world = KnownWorld::new(scene, categories, &self.world);
        let synonyms = self.synonyms.clone();
        let answer = tokio::task::spawn_blocking(move || world.answer(&query, &synonyms)).await;
        let report = answer.map_err(|error| {
            let sentence = format!("the query failed: {error}; say it in other words");
            Refusal::new(RefusalKind::Internal, sentence)
        })??;
        Ok(Reply::Found(Box::new(report)))
    }

    /// Reply of the perceptual memory; a change of labels is also recorded as a world
    /// event.
    async fn answer_from_memory(&self, command: Command, peer: Peer) -> Result<Reply, Refusal> {
        let lesson = event_report::lesson(&command);
        let labelled = labelled_track(&command);
        let answer = self.handler.answer(command, requester(peer)).await;
        let answer = answer.unwrap_or_else(|| {
            let sentence = "tabula-memory does not answer this command".to_owned();
            Err(Refusal::new(RefusalKind::Internal, sentence))
        });
        if let (Some(lesson), Ok(Reply::Learned(report))) = (lesson, &answer)
            && report.n_views_changed > 0
        {
            let learned = lesson(report);
            self.world
                .with(|model| model.record_teaching(learned, now_ns()));
        }
        match (labelled, answer) {
            (Some(track_id), Err(refusal)) if refusal.kind == RefusalKind::NotFound => {
                Err(self.unknown_track(track_id).await.unwrap_or(refusal))
            }
            (_, answer) => answer,
        }
    }

    /// Refusal by perception of a track that is not live; `None` when it is live, or
    /// perception does not answer.
    async fn unknown_track(&self, track_id: u64) -> Option<Refusal> {
        match self
            .perception
            .call(Command::Ask { track_id }, DEADLINE)
            .await
        {
            Ok(Reply::Refused(refusal)) if refusal.kind == RefusalKind::NotFound => Some(refusal),
            _ => None,
        }
    }
}

/// Refusal for a reply that does not belong to its command.
fn unexpected(reply: &Reply) -> Refusal {
    Refusal::new(RefusalKind::Internal, format!("unexpected reply {reply:?}"))
}

/// Requester of a change, with its right to undo those of others.
pub(crate) fn requester(peer: Peer) -> Requester {
    Requester {
        uid: Some(peer.uid),
        may_undo_others: peer.role >= UserRole::Administrator,
    }
}

/// Track that a command labels. The store alone cannot tell a live track without key
/// views from an unknown one.
fn labelled_track(command: &Command) -> Option<u64> {
    match command {
        Command::Teach(label) | Command::Correct(label) => Some(label.track_id),
        _ => None,
    }
}

/// Stamps a read with the newest acknowledged position of the history (read-your-writes
/// consistency).
fn read_after(position: Position, command: Command) -> Command {
    Command::ReadAfter {
        store_id: position.store_id.0,
        sequence: position.sequence,
        command: Box::new(command),
    }
}

/// Forwards a command to the process that owns its answer.
async fn ask(owner: &Client, command: Command) -> Result<Reply, Refusal> {
    let unavailable = |error| Refusal::new(RefusalKind::Unavailable, format!("{error}"));
    owner.call(command, DEADLINE).await.map_err(unavailable)
}

#[cfg(test)]
mod tests {
    use super::*;
    use perceptual_memory::StoreId;

    #[test]
    fn reads_are_stamped_with_the_newest_acknowledged_position() {
        let position = Position {
            store_id: StoreId(7),
            sequence: 9,
        };
        let stamped = read_after(position, Command::Objects);
        assert_eq!(stamped.owner(), ProcessKind::Perception);
        assert!(stamped.is_internal());
        let expected = Command::ReadAfter {
            store_id: 7,
            sequence: 9,
            command: Box::new(Command::Objects),
        };
        assert_eq!(stamped, expected);
    }
}
