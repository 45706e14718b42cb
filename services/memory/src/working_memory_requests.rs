//! Requests to the working memory: facts, events and tasks.

use crate::event_report::event;
use crate::task_report;
use crate::working_memory::{WorkingMemory, now_ns};
use crate::world_report::{self as report, SceneFreshness};
use control_protocol::{
    MAX_EVENT_WAIT_MS, MAX_PAGE_EVENTS, MAX_PAGE_TASKS, Refusal, RefusalKind, Reply, WorldCommand,
    WorldReply,
};
use perceptual_memory::MutationId;
use scene_document::EventsDocument;
use service::monotonic_ns;
use std::time::Duration;
use tokio::time::{Instant, timeout, timeout_at};
use working_memory::{NewTask, Task, TaskEnd, TaskRefusal, WorldModel};

/// Time limit for a task's start, step or end to be on disk; shorter than the time limit of
/// clients.
const ON_DISK: Duration = Duration::from_millis(1500);

impl WorkingMemory {
    /// Reply to a command; a refusal gives the reason.
    pub(crate) async fn answer(&self, command: WorldCommand) -> Result<Reply, Refusal> {
        let reply = match command {
            WorldCommand::Now => self.now(),
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
                WorldReply::Tasks(self.with(|model| task_report::tasks(model, before, n_most)))
            }
            WorldCommand::Task { task_id } => {
                let task = self.with(|model| task_report::whole_task(model, task_id));
                WorldReply::Task(Box::new(task?))
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
                self.noted(|model| model.start_task(&new, now_ns())).await?
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
                    outcome: task_report::outcome(outcome),
                    reason,
                };
                self.noted(|model| model.end_task(&end, now_ns())).await?
            }
            WorldCommand::RecordStep { task_id, step } => {
                let content = task_report::content(step)?;
                self.noted(|model| model.record_step(task_id, content, now_ns()))
                    .await?
            }
        };
        Ok(Reply::World(reply))
    }

    /// Report of the present.
    fn now(&self) -> WorldReply {
        let freshness = SceneFreshness::of(self.scene_time(), monotonic_ns());
        let report = self.with(|model| report::world(model, &freshness, now_ns()));
        WorldReply::Now(Box::new(report))
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

    /// Records the start, a step or the end of a task; answered when it is on disk.
    async fn noted(
        &self,
        note: impl FnOnce(&mut WorldModel) -> Result<&Task, TaskRefusal>,
    ) -> Result<WorldReply, Refusal> {
        let (noted, version) = self.with(|model| {
            let noted = note(model).map(task_report::task_of_page);
            (noted, model.version())
        });
        let task = noted.map_err(|refusal| task_report::refusal(&refusal))?;
        let mut written = self.written();
        match timeout(ON_DISK, written.wait_for(|written| *written >= version)).await {
            Ok(Ok(_)) => Ok(WorldReply::Task(Box::new(task))),
            _ => Err(Refusal::new(
                RefusalKind::Unavailable,
                format!(
                    "task {} is noted but not on disk yet; send the same request again, \
                     unchanged, and see the daemon's log if that goes on",
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
