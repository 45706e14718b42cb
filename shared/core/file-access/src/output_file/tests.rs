use super::*;
use std::os::unix::fs::symlink;
use std::os::unix::net::UnixListener;
use std::process::Command;

fn n_entries(folder: &Path) -> usize {
    folder.read_dir().unwrap().count()
}

/// Sentence with which every way of writing refuses a target.
fn refusal(target: &Path) -> String {
    let sentence = write_atomic(target, "new").unwrap_err().to_string();
    for begin in [OutputFile::create, OutputFile::create_private] {
        assert_eq!(begin(target).unwrap_err().to_string(), sentence);
    }
    assert!(
        sentence.contains(&target.display().to_string()),
        "{sentence}"
    );
    sentence
}

#[test]
fn no_temporary_file_remains() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file.png");
    for content in ["first", "2"] {
        write_atomic(&path, content).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), content);
    }
    let mut file = OutputFile::create_private(&path).unwrap();
    file.write_all(b"third").unwrap();
    file.finish().unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "third");
    assert_eq!(path.metadata().unwrap().permissions().mode() & 0o777, 0o600);
    assert_eq!(n_entries(folder.path()), 1);
}

#[test]
fn unfinished_file_leaves_the_target_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.ply");
    std::fs::write(&path, "before").unwrap();
    let mut file = OutputFile::create(&path).unwrap();
    file.write_all(b"half").unwrap();
    drop(file);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "before");
    assert_eq!(n_entries(folder.path()), 1);
}

#[test]
fn a_missing_folder_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let error = write_atomic(&folder.path().join("missing/file"), "").unwrap_err();
    assert!(error.to_string().contains("missing/file"), "{error}");
}

#[test]
fn pipe_socket_and_folder_are_refused_and_stay() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let made = Command::new("mkfifo").arg(path("pipe")).status().unwrap();
    assert!(made.success());
    let _listener = UnixListener::bind(path("socket")).unwrap();
    create_folder(&path("folder")).unwrap();
    for (name, kind) in [
        ("pipe", "named pipe"),
        ("socket", "socket"),
        ("folder", "folder"),
    ] {
        let before = path(name).symlink_metadata().unwrap().file_type();
        assert!(refusal(&path(name)).contains(kind));
        let after = path(name).symlink_metadata().unwrap().file_type();
        assert_eq!(after, before);
    }
    assert!(refusal(Path::new("/dev/null")).contains("device"));
    assert_eq!(n_entries(folder.path()), 3);
}

#[test]
fn link_is_refused_and_named_with_its_end() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("file"), "before").unwrap();
    for end in ["file", "missing"] {
        let link = path(&format!("link-to-{end}"));
        symlink(end, &link).unwrap();
        assert!(refusal(&link).contains(&format!("a symbolic link to {end}")));
        assert_eq!(link.read_link().unwrap(), Path::new(end));
    }
    assert_eq!(std::fs::read_to_string(path("file")).unwrap(), "before");
    assert!(!path("missing").exists());
}

#[test]
fn target_that_becomes_a_link_while_the_file_is_written_stays() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("target");
    let file = OutputFile::create(&target).unwrap();
    symlink("elsewhere", &target).unwrap();
    let error = file.finish().unwrap_err();
    assert!(matches!(error, FileError::OutputIsLink { .. }), "{error}");
    assert_eq!(target.read_link().unwrap(), Path::new("elsewhere"));
    assert_eq!(n_entries(folder.path()), 1);
}

#[test]
fn as_root_device_is_refused_and_stays() {
    let folder = tempfile::tempdir().unwrap();
    let node = folder.path().join("null");
    let arguments = ["c", "1", "3"];
    let made = Command::new("mknod").arg(&node).args(arguments).status();
    assert!(made.unwrap().success(), "this test needs root");
    assert!(refusal(&node).contains("device"));
    let kind = node.symlink_metadata().unwrap().file_type();
    assert!(kind.is_char_device());
}
