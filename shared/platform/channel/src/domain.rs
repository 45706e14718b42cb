//! Membership of a process in a domain: role lock, domain lock, iceoryx2 node.

use crate::guest_places::{self, GUEST_PLACES};
use crate::lock_file::LockFile;
use crate::shared_memory::{check_shared_memory, refuse_foreign_files, remove_leftovers};
use crate::topic::MAX_FRAME_POINTS;
use crate::trusted_folder::TrustedFolder;
use crate::{DomainName, RunFolder};
use crate::{Error, log_bridge};
use iceoryx2::prelude::{
    Config, FileName, Node, NodeBuilder, Path as IoxPath, SemanticString, SignalHandlingMode,
    ipc_threadsafe,
};
use message::ProcessKind;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

pub(crate) type Service = ipc_threadsafe::Service;

/// Repeated attempts to take a role: a process that inspects the domain holds each
/// lock for an instant, so a role counts as taken only when it stays taken.
const N_SECOND_LOOKS: u32 = 3;
const SECOND_LOOK: Duration = Duration::from_millis(5);

/// Name of the lock file that every member of a domain holds.
pub(crate) const DOMAIN_LOCK: &str = "domain.lock";

/// Attempts to enter a run folder that its last member may be removing.
const MAX_ATTEMPTS: u32 = 20;

/// Role of a process in its domain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role<'a> {
    /// Exclusive role with this program name: `tabula-camera`.
    Only(&'a str),
    /// Guest: one of any number of tools and tests.
    Guest,
}

/// Membership of this process in a domain; ports keep it alive.
///
/// The first member removes the remains of a crashed domain, the last one removes
/// everything. Both know that they are alone by a file lock, which the kernel
/// releases even after `kill -9`.
#[derive(Debug, Clone)]
pub struct Domain(Arc<Membership>);

#[derive(Debug)]
struct Membership {
    name: DomainName,
    folder: PathBuf,
    run_folder: RunFolder,
    guest_places: u32,
    /// Folder of the domain, for the locks of guests.
    locks: Arc<TrustedFolder>,
    /// Node of iceoryx2; `None` only while joining and during drop.
    node: Option<Node<Service>>,
    /// Lock file of the exclusive role.
    _role: Option<LockFile>,
    presence: LockFile,
}

impl Domain {
    /// Joins a domain; creates it, with the default number of guest places, when it has no
    /// members.
    ///
    /// # Errors
    /// When the run folder cannot be written or is under another user's control, the
    /// role is taken, the domain's limits do not fit into the free shared memory, or
    /// iceoryx2 fails.
    pub fn join(name: &DomainName, run_folder: &RunFolder, role: Role<'_>) -> Result<Self, Error> {
        Self::join_with(name, run_folder, role, GUEST_PLACES)
    }

    /// Joins a domain; creates it, with this number of guest places, when it has no members.
    ///
    /// # Errors
    /// As [`join`](Self::join).
    pub fn join_with(
        name: &DomainName,
        run_folder: &RunFolder,
        role: Role<'_>,
        guest_places: u32,
    ) -> Result<Self, Error> {
        log_bridge::install();
        let (folder, role, presence) = enter_folder(name, run_folder, role, guest_places)?;
        let guest_places = guest_places::of_domain(&folder);
        // A membership from here on, so that a failed start removes what it has made.
        let mut membership = Membership {
            name: name.clone(),
            folder: folder.path().to_owned(),
            run_folder: run_folder.clone(),
            guest_places,
            locks: folder.clone(),
            node: None,
            _role: role,
            presence,
        };
        check_shared_memory(name, MAX_FRAME_POINTS, guest_places)?;
        membership.node = Some(make_node(name, &folder)?);
        Ok(Self(Arc::new(membership)))
    }

    /// Name of the joined domain.
    pub fn name(&self) -> &DomainName {
        &self.0.name
    }

    /// Run folder of the domain.
    pub fn folder(&self) -> &Path {
        &self.0.folder
    }

    /// Path of the domain's control socket.
    pub fn control_socket(&self) -> PathBuf {
        self.0.run_folder.control_socket(&self.0.name)
    }

    /// Path of the socket on which a process serves the requests that it owns.
    pub fn request_socket(&self, process: ProcessKind) -> PathBuf {
        self.0.folder.join(format!("{}.sock", process.word()))
    }

    /// Number of guest places of each topic with large messages.
    pub fn guest_places(&self) -> u32 {
        self.0.guest_places
    }

    pub(crate) fn locks(&self) -> &Arc<TrustedFolder> {
        &self.0.locks
    }

    /// Removes the iceoryx2 resources of crashed processes, whose death is not
    /// noticed otherwise. To be called about once a second.
    pub fn sweep_dead_nodes(&self) {
        let state = self.node().try_cleanup_dead_nodes();
        if state.cleanups > 0 {
            tracing::info!("cleaned up after {} dead process(es)", state.cleanups);
        }
    }

    #[expect(clippy::expect_used, reason = "a joined domain has a node until drop")]
    pub(crate) fn node(&self) -> &Node<Service> {
        self.0.node.as_ref().expect("the node exists until drop")
    }
}

impl Drop for Membership {
    fn drop(&mut self) {
        self.node = None;
        if self.presence.become_exclusive() {
            remove_leftovers(&self.name, &self.folder);
            let _ = std::fs::remove_dir_all(&self.folder);
            // Succeeds only when the folder holds no other domain.
            if self.run_folder.path().starts_with("/dev/shm") {
                let _ = std::fs::remove_dir(self.run_folder.path());
            }
        }
    }
}

/// Opens the domain's folder and takes the role and the domain's lock in it. Retries
/// all of it while the last member of the domain removes the folder.
fn enter_folder(
    name: &DomainName,
    run_folder: &RunFolder,
    role: Role<'_>,
    guest_places: u32,
) -> Result<(Arc<TrustedFolder>, Option<LockFile>, LockFile), Error> {
    let enter = || {
        let folder = Arc::new(open_folder(name, run_folder)?);
        let role = take_role(name, &folder, role)?;
        let presence = enter(name, &folder, guest_places)?;
        Ok((folder, role, presence))
    };
    for _ in 1..MAX_ATTEMPTS {
        match enter() {
            Ok((_, Some(role), _)) if !role.is_current() => {}
            Err(Error::RunFolder { source, .. }) if source.kind() == ErrorKind::NotFound => {}
            entered_or_failed => return entered_or_failed,
        }
        std::thread::sleep(SECOND_LOOK);
    }
    enter()
}

/// Opens or creates the domain's folder. Members of the group tabula reach the
/// control socket in it; without that group only the same user does.
fn open_folder(name: &DomainName, run_folder: &RunFolder) -> Result<TrustedFolder, Error> {
    let is_in_shared_place = run_folder.is_in_shared_place();
    let mode = if is_in_shared_place { 0o700 } else { 0o755 };
    let all_domains = TrustedFolder::create(run_folder.path(), mode)?;
    if is_in_shared_place {
        let is_shared = all_domains.share_with_group();
        all_domains.set_mode(if is_shared { 0o710 } else { 0o700 });
    }
    let folder = all_domains.create_subfolder(&name.to_string(), 0o700)?;
    if folder.share_with_group() {
        folder.set_mode(0o750);
    }
    Ok(folder)
}

fn take_role(
    name: &DomainName,
    folder: &Arc<TrustedFolder>,
    role: Role<'_>,
) -> Result<Option<LockFile>, Error> {
    let Role::Only(role) = role else {
        return Ok(None);
    };
    let file = format!("{role}.lock");
    let mut lock = LockFile::try_exclusive(folder, &file)?;
    for _ in 0..N_SECOND_LOOKS {
        if lock.is_none() {
            std::thread::sleep(SECOND_LOOK);
            lock = LockFile::try_exclusive(folder, &file)?;
        }
    }
    match lock {
        Some(mut lock) => {
            lock.write_pid()?;
            Ok(Some(lock))
        }
        None => Err(Error::RoleTaken {
            role: role.to_owned(),
            domain: name.to_string(),
            pid: LockFile::read_pid(folder, &file),
        }),
    }
}

/// Takes the domain's lock together with the other members; removes the remains of a
/// crash, and decides the number of guest places, when there are none.
fn enter(
    name: &DomainName,
    folder: &Arc<TrustedFolder>,
    guest_places: u32,
) -> Result<LockFile, Error> {
    let Some(lock) = LockFile::try_exclusive(folder, DOMAIN_LOCK)? else {
        refuse_foreign_files(name)?;
        return LockFile::shared(folder, DOMAIN_LOCK);
    };
    if let Err(error) = refuse_foreign_files(name) {
        // Alone in the folder: a start that fails leaves none behind.
        let _ = std::fs::remove_dir_all(folder.path());
        return Err(error);
    }
    let n_files = remove_leftovers(name, folder.path());
    if n_files > 0 {
        tracing::info!("removed {n_files} shared memory files of an earlier run that had crashed");
    }
    guest_places::decide(folder, guest_places)?;
    lock.share()?;
    Ok(lock)
}

fn make_node(name: &DomainName, folder: &TrustedFolder) -> Result<Node<Service>, Error> {
    let root = folder.create_subfolder("iox2", 0o700)?;
    // iceoryx2 requires folders writable by their owner only, whatever the umask.
    root.set_mode(0o700);
    let root = root.path();
    let failed = |cause: &dyn std::fmt::Debug| Error::transport("join", "the domain", cause);
    let root = IoxPath::new(root.as_os_str().as_encoded_bytes()).map_err(|e| failed(&e))?;
    let mut config = Config::default();
    config.global.set_root_path(&root);
    config.global.prefix =
        FileName::new(name.shared_memory_prefix().as_bytes()).map_err(|e| failed(&e))?;
    // The periodic sweep looks for dead nodes; looking also while all members leave
    // at the same moment makes each wait for the others.
    config.global.node.cleanup_dead_nodes_on_destruction = false;
    // A held service costs 0.5 MB of heap at the default of 128.
    config
        .defaults
        .publish_subscribe
        .subscriber_expired_connection_buffer = 4;
    NodeBuilder::new()
        .config(&config)
        .signal_handling_mode(SignalHandlingMode::Disabled)
        .create::<Service>()
        .map_err(|e| failed(&e))
}
