//! Simulated person at the far side of the table: actions and body.
//!
//! A person puts an object down, moves it, lifts it, partly hides it or takes it away, by a
//! script or at random. The body is a chain of capsules; only the hand moves objects.

mod action_execution;
mod person_body;
mod random_actions;

pub(crate) use action_execution::{ActionExecution, GRIP_M, HandEvent};
pub(crate) use person_body::PersonBody;
pub(crate) use random_actions::RandomActions;

use crate::action::{Action, PersonPlan};
use crate::world::World;
use nalgebra::Point3;

/// Simulated person in the running world.
#[derive(Debug, Clone)]
pub(crate) struct Person {
    plan: PersonPlan,
    next_in_script: usize,
    random_actions: Option<RandomActions>,
    execution: Option<ActionExecution>,
    hand: Point3<f64>,
}

impl Person {
    pub(crate) fn new(plan: PersonPlan, seed: u64) -> Self {
        let random_actions = plan
            .random_pause_s
            .map(|every_s| RandomActions::new(every_s, seed));
        Self {
            plan,
            next_in_script: 0,
            random_actions,
            execution: None,
            hand: person_body::RESTING_HAND,
        }
    }

    /// Current body of the person.
    pub(crate) fn body(&self) -> PersonBody {
        PersonBody::reaching(self.hand)
    }

    /// Position of the hand, world frame, metres.
    pub(crate) fn hand(&self) -> Point3<f64> {
        self.hand
    }

    /// True if an action is being performed.
    pub(crate) fn is_busy(&self) -> bool {
        self.execution.is_some()
    }

    /// Advances the person by one step of `dt_s` seconds and returns the hand's event on an
    /// object.
    pub(crate) fn step(&mut self, time_s: f64, dt_s: f64, world: &World) -> Option<HandEvent> {
        if self.execution.is_none() {
            let is_script = self.next_in_script < self.plan.script.len();
            let action = self.due(time_s, world)?;
            self.execution = ActionExecution::new(&action, self.hand, world);
            if self.execution.is_none() && is_script {
                return Some(HandEvent::Impossible(action));
            }
        }
        let execution = self.execution.as_mut()?;
        let event = execution.step(dt_s, self.plan.pace, &mut self.hand);
        if execution.has_ended() {
            self.execution = None;
            if let Some(random_actions) = &mut self.random_actions {
                random_actions.rest_from(time_s);
            }
        }
        event
    }

    fn due(&mut self, time_s: f64, world: &World) -> Option<Action> {
        if let Some(next) = self.plan.script.get(self.next_in_script) {
            if next.at_s > time_s {
                return None;
            }
            self.next_in_script += 1;
            return Some(next.action.clone());
        }
        self.random_actions.as_mut()?.due(time_s, world)
    }
}
