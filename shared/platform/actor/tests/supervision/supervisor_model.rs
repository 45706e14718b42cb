//! Model-based test of the supervisor in virtual time: random spawns, dismissals,
//! messages, failures and voluntary stops.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use crate::adder_fixture::{Adder, AdderCounters, Order, config, count, soon};
use actor::{
    Address, Config, LifecycleEvent, Placement, Restart, RestartPolicy, StopReason, Supervisor,
};
use proptest::prelude::*;
use tokio::runtime::{Builder, Handle};
use tokio::time::{Instant, sleep_until};

/// Time grain: every action begins at a multiple of this plus its number, so that
/// unrelated actions never coincide.
const GRAIN_MS: u64 = 64;

#[derive(Debug, Clone, Copy)]
enum Action {
    Spawn,
    Dismiss,
    Add,
    Panic,
    Finish,
}

#[derive(Debug, Clone)]
struct Case {
    restart: Restart,
    max_restarts: u32,
    window_ms: u64,
    backoff_min_ms: u64,
    backoff_max_ms: u64,
    /// Actions of the case: delay in grains, actor, action.
    deeds: Vec<(u64, u64, Action)>,
}

fn case() -> impl Strategy<Value = Case> {
    let restart = prop_oneof![
        3 => Just(Restart::Permanent),
        2 => Just(Restart::Transient),
        1 => Just(Restart::Temporary)
    ];
    let action = prop_oneof![
        4 => Just(Action::Spawn),
        1 => Just(Action::Dismiss),
        3 => Just(Action::Add),
        3 => Just(Action::Panic),
        1 => Just(Action::Finish)
    ];
    let deeds = prop::collection::vec((0_u64..30, 0_u64..4, action), 1..GRAIN_MS as usize);
    let policy = (0_u32..10, 1_u64..300, 1_u64..6, 0_u64..30);
    (restart, policy, deeds).prop_map(|(restart, policy, deeds)| Case {
        restart,
        max_restarts: policy.0,
        window_ms: policy.1 * GRAIN_MS,
        backoff_min_ms: policy.2 * GRAIN_MS,
        backoff_max_ms: (policy.2 + policy.3) * GRAIN_MS,
        deeds,
    })
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ObservedEvent {
    Started(u64),
    Restarting(u64, u64),
    Stopped(u64),
    Finished(u64),
    Failed(u64),
    Escalated(u64),
}

/// Test model of a supervised actor.
struct Member {
    /// Time of its restart; `None` while it is running.
    due_ms: Option<u64>,
    total: u64,
    /// Messages queued until the actor starts.
    waiting: Vec<Action>,
    /// Times of the actor's restarts, milliseconds.
    restarts_ms: Vec<u64>,
}

struct Model<'a> {
    case: &'a Case,
    now_ms: u64,
    members: BTreeMap<u64, Member>,
    restarts_ms: Vec<u64>,
    seen: Vec<(u64, ObservedEvent)>,
    has_ended: bool,
}

impl Model<'_> {
    fn see(&mut self, seen: ObservedEvent) {
        self.seen.push((self.now_ms, seen));
    }

    fn member(&mut self, id: u64) -> &mut Member {
        self.members.get_mut(&id).expect("it is there")
    }

    fn advance(&mut self, until_ms: u64) {
        loop {
            let due = self
                .members
                .iter()
                .filter_map(|(id, m)| Some((m.due_ms?, *id)));
            let Some((at_ms, id)) = due.min().filter(|(at_ms, _)| *at_ms <= until_ms) else {
                break;
            };
            self.now_ms = at_ms;
            self.start(id);
        }
        self.now_ms = until_ms;
    }

    /// Starts an actor, which handles its queued messages until it fails.
    fn start(&mut self, id: u64) {
        self.see(ObservedEvent::Started(id));
        let member = self.member(id);
        member.due_ms = None;
        let mut waiting = std::mem::take(&mut member.waiting).into_iter();
        while let Some(action) = waiting.next() {
            self.handle(id, action);
            match self.members.get_mut(&id) {
                Some(member) if member.due_ms.is_some() => {
                    member.waiting = waiting.collect();
                    return;
                }
                Some(_) => {}
                None => return,
            }
        }
    }

    fn handle(&mut self, id: u64, action: Action) {
        match action {
            Action::Panic if self.case.restart == Restart::Temporary => {
                self.end(id, ObservedEvent::Failed(id));
            }
            Action::Panic => self.fail(id),
            Action::Finish => {
                self.member(id).total += 1;
                if self.case.restart == Restart::Permanent {
                    self.fail(id);
                } else {
                    self.end(id, ObservedEvent::Finished(id));
                }
            }
            _ => self.member(id).total += 1,
        }
    }

    fn end(&mut self, id: u64, seen: ObservedEvent) {
        self.see(seen);
        self.members.remove(&id);
    }

    fn fail(&mut self, id: u64) {
        let (case, now_ms) = (self.case, self.now_ms);
        let n_recent = |list: &[u64]| {
            list.iter()
                .filter(|at| now_ms - **at < case.window_ms)
                .count()
        };
        if n_recent(&self.restarts_ms) >= case.max_restarts as usize {
            self.end(id, ObservedEvent::Failed(id));
            for other in std::mem::take(&mut self.members).into_keys() {
                self.see(ObservedEvent::Stopped(other));
            }
            self.see(ObservedEvent::Escalated(id));
            self.has_ended = true;
            return;
        }
        self.restarts_ms.push(now_ms);
        let member = self.member(id);
        let n_own = n_recent(&member.restarts_ms);
        let after_ms = (case.backoff_min_ms << n_own).min(case.backoff_max_ms);
        member.restarts_ms.push(now_ms);
        member.due_ms = Some(now_ms + after_ms);
        self.see(ObservedEvent::Restarting(id, after_ms));
    }

    /// Applies an action to the model; `true` when it should succeed.
    fn apply(&mut self, id: u64, action: Action) -> bool {
        let is_there = self.members.contains_key(&id);
        match action {
            Action::Spawn if !is_there => {
                let member = Member {
                    due_ms: Some(self.now_ms),
                    total: 0,
                    waiting: Vec::new(),
                    restarts_ms: Vec::new(),
                };
                self.members.insert(id, member);
                true
            }
            Action::Spawn => false,
            _ if !is_there => false,
            Action::Dismiss => {
                self.end(id, ObservedEvent::Stopped(id));
                true
            }
            action => {
                let member = self.member(id);
                if member.due_ms.is_some() {
                    member.waiting.push(action);
                } else {
                    self.handle(id, action);
                }
                true
            }
        }
    }
}

fn seen(event: &LifecycleEvent<u64>) -> ObservedEvent {
    match event {
        LifecycleEvent::Started { id } => ObservedEvent::Started(*id),
        LifecycleEvent::Restarting { id, after, .. } => {
            ObservedEvent::Restarting(*id, after.as_millis() as u64)
        }
        LifecycleEvent::Stopped { id, reason } => match reason {
            StopReason::Requested => ObservedEvent::Stopped(*id),
            StopReason::Finished => ObservedEvent::Finished(*id),
            _ => ObservedEvent::Failed(*id),
        },
        LifecycleEvent::Escalated(escalation) => ObservedEvent::Escalated(escalation.id),
        other => unreachable!("nothing hangs here: {other}"),
    }
}

type Adders = Supervisor<u64, Adder>;

fn apply(supervisor: &Adders, id: u64, action: Action) -> bool {
    let tell = |order| {
        let address: Option<Address<Adder>> = supervisor.address(&id);
        address.is_some_and(|address| address.tell(0, order).is_ok())
    };
    match action {
        Action::Spawn => supervisor.spawn(id, 0).is_ok(),
        Action::Dismiss => supervisor.request_stop(&id),
        Action::Add => tell(Order::Add(1)),
        Action::Panic => tell(Order::Panic(100)),
        Action::Finish => tell(Order::Finish(1)),
    }
}

fn settings(case: &Case) -> Config {
    let ms = Duration::from_millis;
    let policy = RestartPolicy::new(
        case.max_restarts,
        ms(case.window_ms),
        ms(case.backoff_min_ms),
        ms(case.backoff_max_ms),
    );
    Config {
        policy: policy.expect("the strategy makes valid policies"),
        mailbox_capacity: count(100),
        ..config(case.restart, Placement::Inline)
    }
}

/// Runs all tasks that are ready at this moment.
async fn settle() {
    for _ in 0..100 {
        tokio::task::yield_now().await;
    }
}

async fn check(case: Case) -> Result<(), TestCaseError> {
    let shared = Arc::new(AdderCounters::default());
    let (supervisor, mut events) = Adders::new(settings(&case), shared, Handle::current());
    let begin = Instant::now();
    let watching = tokio::spawn(async move {
        let mut log = Vec::new();
        while let Some(event) = events.recv().await {
            log.push((begin.elapsed().as_millis() as u64, seen(&event)));
        }
        log
    });
    let mut model = Model {
        case: &case,
        now_ms: 0,
        members: BTreeMap::new(),
        restarts_ms: Vec::new(),
        seen: Vec::new(),
        has_ended: false,
    };
    let mut grains = 0;
    for (number, (gap, id, action)) in (1..).zip(&case.deeds) {
        grains += gap;
        let at_ms = grains * GRAIN_MS + number;
        sleep_until(begin + Duration::from_millis(at_ms)).await;
        settle().await;
        model.advance(at_ms);
        if model.has_ended {
            break;
        }
        prop_assert_eq!(apply(&supervisor, *id, *action), model.apply(*id, *action));
        settle().await;
        // A new actor starts at the same moment.
        model.advance(at_ms);
        prop_assert_eq!(supervisor.n_actors(), model.members.len());
    }
    for (id, member) in &model.members {
        if member.due_ms.is_none() {
            let address = supervisor.address(id).expect("it is up");
            let total = soon(address.ask(0, Order::Add(0)).expect("it is up")).await;
            prop_assert_eq!(total, Ok(member.total));
        }
    }
    prop_assert_eq!(supervisor.spawn(99, 0).is_err(), model.has_ended);
    drop(supervisor);
    let mut log = watching.await.expect("it does not panic");
    // Drop of the supervisor at the end of the test.
    log.truncate(model.seen.len());
    prop_assert_eq!(log, model.seen);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]
    #[test]
    fn supervisor_agrees_with_the_model(case in case()) {
        let runtime = Builder::new_current_thread().enable_time().start_paused(true).build();
        runtime.expect("a runtime").block_on(check(case))?;
    }
}
