use super::*;
use crate::lock_file::LockFile;
use std::os::unix::fs::{PermissionsExt, chown, symlink};
use std::sync::Arc;

/// User id different from that of the test process.
const STRANGER: u32 = 54_321;

fn untrusted_kind<T>(outcome: Result<T, Error>) -> (&'static str, u32) {
    match outcome {
        Err(Error::Untrusted { kind, owner, .. }) => (kind, owner),
        Err(other) => panic!("another error: {other}"),
        Ok(_) => panic!("it was trusted"),
    }
}

fn mode_of(path: &Path) -> u32 {
    std::fs::metadata(path).unwrap().permissions().mode() & 0o777
}

fn assert_root() {
    assert!(
        rustix::process::geteuid().is_root(),
        "this test must be run as root, or skipped with --skip as_root_"
    );
}

#[test]
fn folder_is_created_private_and_opened_again() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("a/run");
    let folder = TrustedFolder::create(&path, 0o700).unwrap();
    assert_eq!(folder.path(), path);
    assert_eq!(mode_of(&path), 0o700);
    folder.create_subfolder("domain", 0o750).unwrap();
    assert!(TrustedFolder::create(&path, 0o700).is_ok());
    assert!(TrustedFolder::open(&path.join("domain")).is_ok());
}

#[test]
fn folder_that_is_a_symbolic_link_is_refused() {
    let place = tempfile::tempdir().unwrap();
    let elsewhere = tempfile::tempdir().unwrap();
    let path = place.path().join("run");
    symlink(elsewhere.path(), &path).unwrap();
    let (kind, owner) = untrusted_kind(TrustedFolder::create(&path, 0o700));
    assert_eq!((kind, owner), ("a symbolic link", own_uid()));
    let sentence = TrustedFolder::open(&path).unwrap_err().to_string();
    for word in [
        path.to_str().unwrap(),
        "symbolic link",
        "remove it",
        "XDG_RUNTIME_DIR",
    ] {
        assert!(sentence.contains(word), "{sentence}");
    }
    assert_eq!(std::fs::read_dir(elsewhere.path()).unwrap().count(), 0);
}

#[test]
fn subfolder_that_is_a_symbolic_link_is_refused() {
    let place = tempfile::tempdir().unwrap();
    symlink("/", place.path().join("domain")).unwrap();
    let folder = TrustedFolder::open(place.path()).unwrap();
    let (kind, _) = untrusted_kind(folder.create_subfolder("domain", 0o750));
    assert_eq!(kind, "a symbolic link");
}

#[test]
fn file_in_the_place_of_the_folder_is_refused() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("run");
    std::fs::write(&path, "x").unwrap();
    assert_eq!(
        untrusted_kind(TrustedFolder::create(&path, 0o700)).0,
        "a file"
    );
}

#[test]
fn folder_that_others_may_write_is_refused() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("run");
    for mode in [0o770, 0o707, 0o1777] {
        std::fs::create_dir(&path).unwrap();
        std::fs::set_permissions(&path, PermissionsExt::from_mode(mode)).unwrap();
        let (kind, _) = untrusted_kind(TrustedFolder::open(&path));
        assert_eq!(kind, "a folder that others may write");
        std::fs::remove_dir(&path).unwrap();
    }
}

#[test]
fn parent_that_others_may_write_needs_the_sticky_bit() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("run");
    let set_mode = |mode| {
        std::fs::set_permissions(place.path(), PermissionsExt::from_mode(mode)).unwrap();
    };
    set_mode(0o777);
    let (kind, _) = untrusted_kind(TrustedFolder::create(&path, 0o700));
    assert_eq!(kind, "a folder that others may write");
    set_mode(0o1777);
    assert!(TrustedFolder::create(&path, 0o700).is_ok());
}

#[test]
fn lock_file_that_is_a_symbolic_link_is_refused_and_its_target_kept() {
    let place = tempfile::tempdir().unwrap();
    let victim = place.path().join("victim");
    std::fs::write(&victim, "precious").unwrap();
    symlink(&victim, place.path().join("x.lock")).unwrap();
    symlink(
        place.path().join("missing"),
        place.path().join("dangling.lock"),
    )
    .unwrap();
    let folder = Arc::new(TrustedFolder::open(place.path()).unwrap());
    for name in ["x.lock", "dangling.lock"] {
        let (kind, _) = untrusted_kind(LockFile::try_exclusive(&folder, name));
        assert_eq!(kind, "a symbolic link");
        assert!(LockFile::shared(&folder, name).is_err());
        assert_eq!(LockFile::read_pid(&folder, name), None);
        assert!(!LockFile::is_held(&folder, name));
    }
    assert_eq!(std::fs::read_to_string(&victim).unwrap(), "precious");
    assert!(!place.path().join("missing").exists());
}

#[test]
fn lock_file_with_a_second_name_or_of_another_kind_is_refused() {
    let place = tempfile::tempdir().unwrap();
    let victim = place.path().join("victim");
    std::fs::write(&victim, "precious").unwrap();
    std::fs::hard_link(&victim, place.path().join("link.lock")).unwrap();
    std::fs::create_dir(place.path().join("folder.lock")).unwrap();
    let _socket = std::os::unix::net::UnixListener::bind(place.path().join("socket.lock")).unwrap();
    let folder = TrustedFolder::open(place.path()).unwrap();
    let kind = |name| untrusted_kind(folder.open_file(name, true)).0;
    assert_eq!(kind("link.lock"), "a file with several names");
    assert_eq!(kind("folder.lock"), "a folder");
    assert_eq!(kind("socket.lock"), "neither a folder nor a file");
    assert_eq!(std::fs::read_to_string(&victim).unwrap(), "precious");
}

#[test]
fn lock_file_is_private_and_never_truncated_when_opened() {
    let place = tempfile::tempdir().unwrap();
    let folder = TrustedFolder::open(place.path()).unwrap();
    let path = place.path().join("x.lock");
    drop(folder.open_file("x.lock", true).unwrap());
    assert_eq!(mode_of(&path), 0o600);
    std::fs::write(&path, "123").unwrap();
    drop(folder.open_file("x.lock", true).unwrap());
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "123");
}

#[test]
#[ignore = "needs root"]
fn as_root_folder_of_another_user_is_refused() {
    assert_root();
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("run");
    std::fs::create_dir(&path).unwrap();
    chown(&path, Some(STRANGER), None).unwrap();
    assert_eq!(
        untrusted_kind(TrustedFolder::create(&path, 0o700)),
        ("a folder", STRANGER)
    );
    chown(place.path(), Some(STRANGER), None).unwrap();
    chown(&path, Some(0), None).unwrap();
    let sentence = TrustedFolder::open(&path).unwrap_err().to_string();
    assert!(sentence.contains("of user 54321"), "{sentence}");
}

#[test]
#[ignore = "needs root"]
fn as_root_lock_file_of_another_user_is_refused() {
    assert_root();
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("x.lock");
    std::fs::write(&path, "123").unwrap();
    chown(&path, Some(STRANGER), None).unwrap();
    let folder = Arc::new(TrustedFolder::open(place.path()).unwrap());
    let refused = LockFile::try_exclusive(&folder, "x.lock");
    assert_eq!(untrusted_kind(refused), ("a file", STRANGER));
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "123");
}
