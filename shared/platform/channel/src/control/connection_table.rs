//! Connection table of the control socket: limits per user, and eviction of silent connections.

use control_protocol::{Peer, Refusal, RefusalKind};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use tokio::sync::{OwnedSemaphorePermit, Semaphore, oneshot};

/// Limits of the control socket.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// Connections of all users.
    pub(super) connections: usize,
    /// Connections of one user.
    pub(super) connections_of_user: usize,
    /// Requests of one user that are carried out at the same time.
    pub(super) requests_of_user: usize,
    /// Requests of one user that wait for an event at the same time.
    pub(super) waits_of_user: usize,
    /// Time for which a request waits for others of its user.
    pub(super) patience: Duration,
}

/// Table of the open connections. A connection is always let in; when there are too many, the
/// one whose user has said nothing on it for the longest time is closed.
#[derive(Debug)]
pub(super) struct ConnectionTable {
    limits: Limits,
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    users: HashMap<u32, User>,
    /// Counts connections and requests: the time of the table.
    now: u64,
}

#[derive(Debug)]
struct User {
    connections: HashMap<u64, Entry>,
    requests: Arc<Semaphore>,
    waits: Arc<Semaphore>,
}

#[derive(Debug)]
struct Entry {
    last_heard: u64,
    is_answered: bool,
    /// Dropped to end the connection.
    _keeps_open: oneshot::Sender<()>,
}

/// Open connection; leaves the table on drop.
#[derive(Debug)]
pub(super) struct Connection {
    table: Arc<ConnectionTable>,
    peer: Peer,
    id: u64,
}

/// Place of a request that is carried out; while it is held its connection is not closed.
#[derive(Debug)]
pub(super) struct Place<'a> {
    connection: &'a Connection,
    _permit: OwnedSemaphorePermit,
}

impl ConnectionTable {
    pub(super) fn new(limits: Limits) -> Arc<Self> {
        Arc::new(Self {
            limits,
            state: Mutex::default(),
        })
    }

    /// Lets a connection in. The receiver ends when it has to be closed for newer ones.
    pub(super) fn enter(self: &Arc<Self>, peer: Peer) -> (Connection, oneshot::Receiver<()>) {
        let (keeps_open, evicted) = oneshot::channel();
        let mut state = self.lock();
        state.now += 1;
        let id = state.now;
        let limits = &self.limits;
        let user = state.users.entry(peer.uid).or_insert_with(|| User {
            connections: HashMap::new(),
            requests: Arc::new(Semaphore::new(limits.requests_of_user)),
            waits: Arc::new(Semaphore::new(limits.waits_of_user)),
        });
        let entry = Entry {
            last_heard: id,
            is_answered: false,
            _keeps_open: keeps_open,
        };
        user.connections.insert(id, entry);
        let is_too_many = user.connections.len() > limits.connections_of_user;
        if is_too_many {
            state.evict(peer.uid);
        } else if state.n_connections() > limits.connections {
            let crowded = state
                .users
                .iter()
                .max_by_key(|user| user.1.connections.len());
            if let Some(uid) = crowded.map(|(uid, _)| *uid) {
                state.evict(uid);
            }
        }
        let connection = Connection {
            table: Arc::clone(self),
            peer,
            id,
        };
        (connection, evicted)
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn n_connections(&self) -> usize {
        self.users.values().map(|user| user.connections.len()).sum()
    }

    /// Closes a user's connection on which nothing has been said for the longest time.
    fn evict(&mut self, uid: u32) {
        let Some(user) = self.users.get_mut(&uid) else {
            return;
        };
        let silent = user
            .connections
            .iter()
            .filter(|(_, entry)| !entry.is_answered);
        let longest = silent.min_by_key(|(_, entry)| entry.last_heard);
        if let Some(id) = longest.map(|(id, _)| *id) {
            self.remove(uid, id);
        }
    }

    fn remove(&mut self, uid: u32, id: u64) {
        let Some(user) = self.users.get_mut(&uid) else {
            return;
        };
        user.connections.remove(&id);
        if user.connections.is_empty() {
            self.users.remove(&uid);
        }
    }
}

impl Connection {
    /// User of the connection.
    pub(super) fn peer(&self) -> Peer {
        self.peer
    }

    /// Notes that the user has said something on the connection.
    pub(super) fn heard(&self) {
        self.set_answered(false);
    }

    /// Takes a place for a request, after other requests of the same user.
    ///
    /// # Errors
    /// When none becomes free in time.
    pub(super) async fn request_place(&self) -> Result<Place<'_>, Refusal> {
        let limits = &self.table.limits;
        let requests = self.of_user(|user| user.requests.clone())?;
        let permit = tokio::time::timeout(limits.patience, requests.acquire_owned()).await;
        match permit {
            Ok(Ok(permit)) => Ok(self.place(permit)),
            _ => Err(busy(&format!(
                "this user has {} requests in progress, and none ended within {} s; try again",
                limits.requests_of_user,
                limits.patience.as_secs_f64()
            ))),
        }
    }

    /// Takes a place for a request that waits for an event.
    ///
    /// # Errors
    /// When too many requests of this user wait.
    pub(super) fn waiting_place(&self) -> Result<Place<'_>, Refusal> {
        let waits = self.of_user(|user| user.waits.clone())?;
        match waits.try_acquire_owned() {
            Ok(permit) => Ok(self.place(permit)),
            Err(_) => Err(busy(&format!(
                "{} requests of this user wait for events already; end one of them first",
                self.table.limits.waits_of_user
            ))),
        }
    }

    fn place(&self, permit: OwnedSemaphorePermit) -> Place<'_> {
        self.set_answered(true);
        Place {
            connection: self,
            _permit: permit,
        }
    }

    fn of_user<T>(&self, get: impl FnOnce(&User) -> T) -> Result<T, Refusal> {
        let state = self.table.lock();
        let user = state.users.get(&self.peer.uid);
        user.map(get)
            .ok_or_else(|| busy("the connection was closed for newer ones"))
    }

    fn set_answered(&self, is_answered: bool) {
        let mut state = self.table.lock();
        state.now += 1;
        let now = state.now;
        let user = state.users.get_mut(&self.peer.uid);
        if let Some(entry) = user.and_then(|user| user.connections.get_mut(&self.id)) {
            entry.is_answered = is_answered;
            entry.last_heard = now;
        }
    }
}

fn busy(sentence: &str) -> Refusal {
    Refusal::new(RefusalKind::Unavailable, sentence)
}

impl Drop for Connection {
    fn drop(&mut self) {
        self.table.lock().remove(self.peer.uid, self.id);
    }
}

impl Drop for Place<'_> {
    fn drop(&mut self) {
        self.connection.set_answered(false);
    }
}

#[cfg(test)]
mod tests;
