//! Request router: answers from the perceptual and the working memory.

use crate::event_report;
use crate::find_request::{KnownWorld, Synonyms};
use crate::working_memory::{WorkingMemory, now_ns};
use channel::control::Client;
use control_protocol::{Command, FindQuery, Peer, Refusal, RefusalKind, Reply, UserRole, request};
use daemon_client::CallError;
use memory_requests::MemoryRequestHandler;
use perceptual_memory::{Position, Requester};
use scene_document::SceneDocument;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::watch;

/// Time limit for the answer of perception; the gateway waits for 4 s.
const DEADLINE: Duration = Duration::from_secs(3);
/// Time limit of the announcement of a change, after which it is acknowledged without. Chosen.
const ANNOUNCEMENT: Duration = Duration::from_secs(1);

/// Router of all requests that the memory owns.
pub(crate) struct RequestRouter {
    pub(crate) handler: Arc<MemoryRequestHandler>,
    pub(crate) perception: Client,
    pub(crate) world: Arc<WorkingMemory>,
    pub(crate) synonyms: Arc<Synonyms>,
    /// Newest acknowledged position of the history.
    pub(crate) position: watch::Receiver<Position>,
    /// Newest position that was announced to the other processes.
    pub(crate) announced: watch::Receiver<Position>,
}

impl RequestRouter {
    /// Reply to a command of a user; a refusal gives the reason.
    pub(crate) async fn answer(&self, command: Command, peer: Peer) -> Reply {
        self.try_answer(command, peer)
            .await
            .unwrap_or_else(Reply::Refused)
    }

    async fn try_answer(&self, command: Command, peer: Peer) -> Result<Reply, Refusal> {
        match command {
            Command::World(command) => self.world.answer(command).await,
            Command::Find(query) => self.find(query, peer).await,
            command => self.answer_from_memory(command, peer).await,
        }
    }

    /// Scene with the newest labels.
    async fn scene(&self) -> Result<SceneDocument, Refusal> {
        let Position { store_id, sequence } = *self.position.borrow();
        let objects = Command::Objects.read_after(store_id.0, sequence);
        let reply = self.perception.call(objects, DEADLINE).await;
        request::objects().read(reply.map_err(|error| unavailable(&error))?)
    }

    /// Reply to a query in words, with the newest labels.
    async fn find(&self, query: FindQuery, peer: Peer) -> Result<Reply, Refusal> {
        let scene = self.scene().await?;
        let categories = request::categories();
        let asked = categories.command().clone();
        let categories = categories.read(self.answer_from_memory(asked, peer).await?)?;
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
        self.announce().await;
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

    /// Waits until the newest position is announced: whoever reads after an acknowledgement, reads
    /// what it acknowledges.
    async fn announce(&self) {
        let position = *self.position.borrow();
        let mut announced = self.announced.clone();
        let caught_up = announced.wait_for(|announced| {
            announced.store_id == position.store_id && announced.sequence >= position.sequence
        });
        let _ = tokio::time::timeout(ANNOUNCEMENT, caught_up).await;
    }

    /// Refusal by perception of a track that is not live; `None` when it is live, or
    /// perception does not answer.
    async fn unknown_track(&self, track_id: u64) -> Option<Refusal> {
        match self.perception.ask(&request::ask(track_id), DEADLINE).await {
            Err(CallError::Refusal(refusal)) if refusal.kind == RefusalKind::NotFound => {
                Some(refusal)
            }
            _ => None,
        }
    }
}

fn unavailable(error: &CallError) -> Refusal {
    Refusal::new(RefusalKind::Unavailable, error.to_string())
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
