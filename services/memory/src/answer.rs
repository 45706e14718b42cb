//! What the memory process answers to each command.

use crate::event_report;
use crate::process_table::ProcessTable;
use crate::world::{World, now_ns};
use channel::control::Client;
use memory_requests::MemoryDesk;
use message::ProcessKind;
use message::control::{Command, Refusal, RefusalKind, Reply};
use std::sync::Arc;
use std::time::Duration;

/// How long another process may take to answer.
const DEADLINE: Duration = Duration::from_secs(2);

/// Answers every command: its own from the store, others by asking their owner.
pub(crate) struct Answerer {
    pub(crate) desk: MemoryDesk,
    pub(crate) perception: Client,
    pub(crate) arm: Client,
    pub(crate) processes: Arc<ProcessTable>,
    pub(crate) world: Arc<World>,
}

impl Answerer {
    /// The answer, or the refusal that says why there is none.
    pub(crate) async fn answer(&self, command: Command) -> Reply {
        self.try_answer(command)
            .await
            .unwrap_or_else(Reply::Refused)
    }

    async fn try_answer(&self, command: Command) -> Result<Reply, Refusal> {
        match command.owner() {
            ProcessKind::Perception => return ask(&self.perception, command).await,
            ProcessKind::Simulator => return ask(&self.arm, command).await,
            ProcessKind::Memory | ProcessKind::Camera => {}
        }
        match command {
            Command::Health => Ok(Reply::Health(self.processes.reports())),
            Command::World(command) => self.world.answer(command).await,
            command => self.answer_from_memory(command).await,
        }
    }

    /// The desk's answer; a lesson is an event of the world, too.
    async fn answer_from_memory(&self, command: Command) -> Result<Reply, Refusal> {
        let lesson = event_report::lesson(&command);
        let answer = self.desk.answer(command).await.unwrap_or_else(|| {
            let sentence = "tabula-memory does not answer this command".to_owned();
            Err(Refusal::new(RefusalKind::Internal, sentence))
        });
        if let (Some(lesson), Ok(Reply::Learned(report))) = (lesson, &answer)
            && report.n_views_changed > 0
        {
            let learned = lesson(report);
            self.world
                .with(|model| model.note_lesson(learned, now_ns()));
        }
        answer
    }
}

/// Passes a command on to the process that owns the answer.
async fn ask(owner: &Client, command: Command) -> Result<Reply, Refusal> {
    let unavailable = |error| Refusal::new(RefusalKind::Unavailable, format!("{error}"));
    owner.call(command, DEADLINE).await.map_err(unavailable)
}
