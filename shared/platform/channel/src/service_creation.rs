//! Creation of iceoryx2 services: one process of a domain at a time.
//!
//! A service is a file that announces it, and then its state in shared memory. A process that is
//! killed in between leaves an announced service for whose state all others wait in vain. Here
//! services are created under a file lock, which the kernel releases however its holder ends:
//! the holder knows that the creator of an unfinished service is dead, and begins it anew.

use crate::domain::{Domain, Service};
use crate::lock_file::LockFile;
use iceoryx2::prelude::{MessagingPattern, ServiceName};
use iceoryx2::service::service_hash::ServiceHash;
use std::path::PathBuf;
use std::thread;
use std::time::{Duration, Instant};

/// Lock file of the process that creates a service.
const LOCK: &str = "services.lock";
/// Longest wait for the lock. A service takes milliseconds; a process that was stopped while it
/// created one does not keep the others from those that exist.
const MAX_WAIT: Duration = Duration::from_secs(2);
const RETRY: Duration = Duration::from_millis(2);

/// Opens or creates a service by `open`. If it hangs in its creation, by `hangs`, its remains are
/// removed and it is created again.
pub(crate) fn open_or_create<S, E>(
    domain: &Domain,
    name: &ServiceName,
    pattern: MessagingPattern,
    open: impl Fn() -> Result<S, E>,
    hangs: impl Fn(&E) -> bool,
) -> Result<S, E> {
    let lock = take_lock(domain);
    let opened = open();
    if lock.is_none() || !opened.as_ref().is_err_and(hangs) {
        return opened;
    }
    let file = announcement(domain, name, pattern);
    match std::fs::remove_file(&file) {
        Ok(()) => tracing::warn!(
            "removed the service {} that a process had left unfinished when it was killed",
            name.as_str()
        ),
        Err(error) => tracing::warn!("cannot remove {}: {error}", file.display()),
    }
    open()
}

/// Lock of the creator of services; `None` when another process keeps it for too long.
fn take_lock(domain: &Domain) -> Option<LockFile> {
    let end = Instant::now() + MAX_WAIT;
    loop {
        match LockFile::try_exclusive(domain.locks(), LOCK) {
            Ok(Some(lock)) => return Some(lock),
            Ok(None) if Instant::now() < end => thread::sleep(RETRY),
            Ok(None) | Err(_) => return None,
        }
    }
}

/// File by which iceoryx2 announces a service.
fn announcement(domain: &Domain, name: &ServiceName, pattern: MessagingPattern) -> PathBuf {
    type Hasher = <Service as iceoryx2::service::Service>::ServiceNameHasher;
    let global = &domain.node().config().global;
    let file = format!(
        "{}{}{}",
        global.prefix,
        ServiceHash::new::<Hasher>(name, pattern).as_str(),
        global.service.static_config_storage_suffix
    );
    PathBuf::from(global.service_dir().to_string()).join(file)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::topic_service::open_service;
    use crate::wake_event::WakeNotifier;
    use crate::{DomainName, Role, RunFolder, topic};
    use message::service_name;
    use std::fs::{self, Permissions};
    use std::os::unix::fs::PermissionsExt;

    fn domain(test: &str) -> (tempfile::TempDir, Domain) {
        let folder = tempfile::tempdir().unwrap();
        let name: DomainName = format!("{test}-{}", std::process::id()).parse().unwrap();
        let domain =
            Domain::join(&name, &RunFolder::at(folder.path().to_owned()), Role::Guest).unwrap();
        (folder, domain)
    }

    /// Leaves a service as its creator does when it is killed: announced, or only begun.
    fn leave(domain: &Domain, pattern: MessagingPattern, content: Option<&[u8]>) {
        let name = ServiceName::new(service_name::HEALTH).unwrap();
        let file = announcement(domain, &name, pattern);
        let mode = if content.is_some() { 0o400 } else { 0o600 };
        fs::write(&file, content.unwrap_or_default()).unwrap();
        fs::set_permissions(&file, Permissions::from_mode(mode)).unwrap();
    }

    fn open(domain: &Domain, pattern: MessagingPattern) {
        match pattern {
            MessagingPattern::Event => {
                drop(WakeNotifier::new(domain, service_name::HEALTH).unwrap());
            }
            _ => drop(open_service::<topic::ProcessHealth>(domain).unwrap()),
        }
    }

    #[test]
    fn service_of_a_creator_that_was_killed_is_created_anew() {
        let (_folder, domain) = domain("killed");
        for pattern in [MessagingPattern::PublishSubscribe, MessagingPattern::Event] {
            let name = ServiceName::new(service_name::HEALTH).unwrap();
            let announced = {
                let _service = open_service::<topic::ProcessHealth>(&domain).unwrap();
                let _event = WakeNotifier::new(&domain, service_name::HEALTH).unwrap();
                fs::read(announcement(&domain, &name, pattern)).unwrap()
            };
            for content in [None, Some(&announced[..])] {
                leave(&domain, pattern, content);
                open(&domain, pattern);
            }
        }
    }

    #[test]
    fn stopped_creator_does_not_keep_others_from_services_that_exist() {
        let (_folder, domain) = domain("stopped");
        let _service = open_service::<topic::ProcessHealth>(&domain).unwrap();
        let _stopped = LockFile::try_exclusive(domain.locks(), LOCK)
            .unwrap()
            .unwrap();
        open(&domain, MessagingPattern::PublishSubscribe);
    }
}
