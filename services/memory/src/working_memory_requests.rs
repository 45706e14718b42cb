//! Requests to the working memory: facts, events and tasks.

use crate::event_report::event;
use crate::working_memory::{WorkingMemory, now_ns};
use crate::world_report::{self as report, SceneFreshness};
use control_protocol::{
    MAX_EVENT_WAIT_MS, MAX_PAGE_EVENTS, MAX_PAGE_TASKS, Refusal, RefusalKind, Reply, WorldCommand,
    WorldReply,
};
use perceptual_memory::MutationId;
use scene_document::{EventsDocument, TaskDocument, TasksDocument};
use service::monotonic_ns;
use std::time::Duration;
use tokio::time::{Instant, timeout, timeout_at};
use working_memory::{NewTask, Task, TaskEnd, TaskRefusal, WorldModel};

/// Time limit for a task's start or end to be on disk; shorter than the time limit of
/// clients.
const ON_DISK: Duration = Duration::from_millis(1500);

impl WorkingMemory {
    /// Reply to a command; a refusal gives the reason.
    pub(crate) async fn answer(&self, command: WorldCommand) -> Result<Reply, Refusal> {
        let reply = match command {
            WorldCommand::Now => {
                let freshness = SceneFreshness::of(self.scene_time(), monotonic_ns());
                WorldReply::Now(Box::new(
                    self.with(|model| report::world(model, &freshness, now_ns())),
                ))
            }
            WorldCommand::Facts(filter) => {
                let query = report::query(filter)?;
                let page = self.with(|model| model.facts(&query));
                WorldReply::Facts(report::facts(&page))
            }
            WorldCommand::Events { since, wait_ms } => {
                WorldReply::Events(self.events_after(since, wait_ms).await)
            }
            WorldCommand::Tasks { before, limit } => {
                let n_most = (limit as usize).clamp(1, MAX_PAGE_TASKS);
                WorldReply::Tasks(self.with(|model| tasks(model, before, n_most)))
            }
            WorldCommand::StartTask {
                id,
                kind,
                parameters,
                author,
            } => {
                let new = NewTask {
                    id: MutationId(id.0),
                    kind,
                    parameters,
                    author,
                };
                WorldReply::Task(
                    self.note_task(|model| model.start_task(&new, now_ns()))
                        .await?,
                )
            }
            WorldCommand::EndTask {
                id,
                task_id,
                outcome,
                reason,
            } => {
                let end = TaskEnd {
                    id: MutationId(id.0),
                    task: task_id,
                    outcome: report::outcome(outcome),
                    reason,
                };
                WorldReply::Task(
                    self.note_task(|model| model.end_task(&end, now_ns()))
                        .await?,
                )
            }
        };
        Ok(Reply::World(reply))
    }

    /// Long poll: the events after a sequence number, or none after the time limit.
    async fn events_after(&self, since: u64, wait_ms: u64) -> EventsDocument {
        let deadline = Instant::now() + Duration::from_millis(wait_ms.min(MAX_EVENT_WAIT_MS));
        let mut news = self.events();
        loop {
            news.mark_unchanged();
            let answer = self.with(|model| events(model, since));
            let is_restarted = answer.newest < since;
            if !answer.events.is_empty() || is_restarted {
                return answer;
            }
            if !matches!(timeout_at(deadline, news.changed()).await, Ok(Ok(()))) {
                return answer;
            }
        }
    }

    /// Records the start or end of a task; answered when it is on disk.
    async fn note_task(
        &self,
        note: impl FnOnce(&mut WorldModel) -> Result<&Task, TaskRefusal>,
    ) -> Result<TaskDocument, Refusal> {
        let (noted, version) = self.with(|model| {
            let noted = note(model).map(report::task);
            (noted, model.version())
        });
        let task = noted.map_err(|refusal| report::task_refusal(&refusal))?;
        let mut written = self.written();
        match timeout(ON_DISK, written.wait_for(|written| *written >= version)).await {
            Ok(Ok(_)) => Ok(task),
            _ => Err(Refusal::new(
                RefusalKind::Unavailable,
                format!(
                    "task {} is noted but not on disk yet; send the same request again, with the \
                     same id, and see the daemon's log if that goes on",
                    task.task_id
                ),
            )),
        }
    }
}

fn events(model: &WorldModel, since: u64) -> EventsDocument {
    let events = model.events_since(since).take(MAX_PAGE_EVENTS);
    EventsDocument {
        events: events.map(event).collect(),
        newest: model.newest_event(),
    }
}

fn tasks(model: &WorldModel, before: Option<u64>, n_most: usize) -> TasksDocument {
    let mut known = model.tasks_before(before.unwrap_or(u64::MAX));
    let tasks: Vec<TaskDocument> = known.by_ref().take(n_most).map(report::task).collect();
    let has_more = known.next().is_some();
    let next = tasks.last().map(|task| task.task_id).filter(|_| has_more);
    TasksDocument { tasks, next }
}
