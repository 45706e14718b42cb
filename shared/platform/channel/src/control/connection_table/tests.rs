use super::*;
use control_protocol::UserRole;
use tokio::sync::oneshot::error::TryRecvError;

const LIMITS: Limits = Limits {
    connections: 6,
    connections_of_user: 4,
    requests_of_user: 2,
    waits_of_user: 1,
    patience: Duration::from_millis(20),
};

fn user(uid: u32) -> Peer {
    Peer {
        uid,
        role: UserRole::Teacher,
    }
}

fn is_closed(evicted: &mut oneshot::Receiver<()>) -> bool {
    evicted.try_recv() == Err(TryRecvError::Closed)
}

#[test]
fn user_with_too_many_connections_loses_the_one_that_was_silent_longest() {
    let table = ConnectionTable::new(LIMITS);
    let (_other, mut of_other) = table.enter(user(9));
    let mut open: Vec<_> = (0..4).map(|_| table.enter(user(1))).collect();
    open[0].0.heard();
    let (_newest, mut of_newest) = table.enter(user(1));
    let closed: Vec<bool> = open.iter_mut().map(|(_, end)| is_closed(end)).collect();
    assert_eq!(closed, [false, true, false, false]);
    assert!(!is_closed(&mut of_newest) && !is_closed(&mut of_other));
}

#[tokio::test]
async fn connection_with_a_request_in_progress_is_not_closed() {
    let table = ConnectionTable::new(LIMITS);
    let (busy, mut of_busy) = table.enter(user(1));
    let place = busy.request_place().await.unwrap();
    let mut open: Vec<_> = (0..4).map(|_| table.enter(user(1))).collect();
    assert!(!is_closed(&mut of_busy) && is_closed(&mut open[0].1));
    drop(place);
    for _ in 0..4 {
        open.push(table.enter(user(1)));
    }
    assert!(is_closed(&mut of_busy));
}

#[test]
fn full_socket_closes_a_connection_of_the_user_with_the_most() {
    let table = ConnectionTable::new(LIMITS);
    let mut many: Vec<_> = (0..4).map(|_| table.enter(user(1))).collect();
    let mut few: Vec<_> = (0..3).map(|uid| table.enter(user(10 + uid))).collect();
    assert!(is_closed(&mut many[0].1));
    assert!(!few.iter_mut().any(|(_, end)| is_closed(end)));
}

#[tokio::test]
async fn requests_and_waits_are_limited_for_each_user() {
    let table = ConnectionTable::new(LIMITS);
    let (first, _open) = table.enter(user(1));
    let (second, _open) = table.enter(user(1));
    let (other, _open) = table.enter(user(2));
    let place = first.request_place().await.unwrap();
    let _second_place = second.request_place().await.unwrap();
    let refusal = second.request_place().await.unwrap_err();
    assert!(refusal.sentence.contains("2 requests"), "{refusal}");
    assert!(other.request_place().await.is_ok());
    let _waiting = first.waiting_place().unwrap();
    let refusal = second.waiting_place().unwrap_err();
    assert!(refusal.sentence.contains("wait for events"), "{refusal}");
    drop(place);
    assert!(second.request_place().await.is_ok());
}

#[test]
fn table_forgets_users_who_have_left() {
    let table = ConnectionTable::new(LIMITS);
    drop(table.enter(user(1)));
    let state = table.lock();
    assert_eq!((state.users.len(), state.n_connections()), (0, 0));
}
