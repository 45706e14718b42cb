//! Record of a task's steps: which step may be recorded, and its times.

use crate::task::{Task, TaskEnd};
use crate::task_step::{
    MAX_STEP_REASON_BYTES, MAX_TASK_PLAN_BYTES, MAX_TASK_STEPS, StepContent, StepRefusal,
    StepState, TaskStep,
};

/// Reason of a step that its task left open without a reason of its own.
const LEFT_OPEN: &str = "the task ended before the step";

impl Task {
    /// Step with this number.
    pub fn step(&self, number: u64) -> Option<&TaskStep> {
        let index = usize::try_from(number.checked_sub(1)?).ok()?;
        self.steps.get(index)
    }

    /// Newest step while it has not ended.
    pub fn open_step(&self) -> Option<&TaskStep> {
        let newest = self.steps.last();
        newest.filter(|step| !step.content.state.is_ended())
    }

    /// True if the step is recorded with this very content.
    pub(crate) fn has_step(&self, content: &StepContent) -> bool {
        let known = self.step(content.number);
        known.is_some_and(|step| step.content == *content)
    }

    /// Checks that a step may be recorded: the newest one while it is open, or the next one after
    /// its end.
    pub(crate) fn check_step(&self, content: &StepContent) -> Result<(), StepRefusal> {
        let (task, number) = (self.number, content.number);
        let next = self.steps.len() as u64 + 1;
        let open = self.open_step().map(|step| step.content.number);
        if number == 0 || number > next {
            return Err(StepRefusal::Number { task, number, next });
        }
        if number < next && open != Some(number) {
            return Err(StepRefusal::HasEnded { task, number });
        }
        if number == next {
            if let Some(open) = open {
                return Err(StepRefusal::IsOpen { task, open });
            }
            if self.steps.len() >= MAX_TASK_STEPS {
                return Err(StepRefusal::TooMany { task });
            }
        }
        content.check()?;
        let others = self.steps.iter().map(|step| &step.content);
        let others = others.filter(|other| other.number != number);
        let n_bytes = others.map(|other| other.plan.len()).sum::<usize>() + content.plan.len();
        if n_bytes > MAX_TASK_PLAN_BYTES {
            return Err(StepRefusal::Plans { task, n_bytes });
        }
        Ok(())
    }

    /// Records a step that was checked.
    pub(crate) fn put_step(&mut self, content: StepContent, now_ns: u64) {
        let known = self.open_step().map(|step| step.started_ns);
        if known.is_some() {
            self.steps.pop();
        }
        let started_ns = known.unwrap_or(now_ns);
        let is_ended = content.state.is_ended();
        self.steps.push(TaskStep {
            content,
            started_ns,
            ended_ns: is_ended.then(|| now_ns.max(started_ns)),
        });
    }

    /// Ends an open step without success, with the reason for the end of the task.
    pub(crate) fn fail_open_step(&mut self, end: &TaskEnd, now_ns: u64) {
        let Some(open) = self.open_step() else {
            return;
        };
        let reason = match end.reason.as_str() {
            "" => LEFT_OPEN,
            reason => beginning(reason),
        };
        let content = StepContent {
            state: StepState::Failed,
            reason: reason.to_owned(),
            ..open.content.clone()
        };
        self.put_step(content, now_ns);
    }

    /// Size of all steps in memory, bytes; an estimate.
    pub(crate) fn n_step_bytes(&self) -> usize {
        let sizes = self.steps.iter().map(|step| step.content.n_bytes());
        sizes.sum()
    }
}

/// Beginning of a text that is not too long for the reason of a step.
fn beginning(text: &str) -> &str {
    let mut ends = (0..=text.len().min(MAX_STEP_REASON_BYTES)).rev();
    let end = ends.find(|end| text.is_char_boundary(*end));
    &text[..end.unwrap_or(0)]
}
