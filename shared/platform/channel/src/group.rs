//! Group look-up in `/etc/group`.

use rustix::fs::Gid;
use std::path::Path;

/// Group whose members may use the control socket; `None` where it does not exist.
pub(crate) fn socket_group() -> Option<Gid> {
    group_id("tabula").map(Gid::from_raw)
}

/// Id of a group, by its name or its number; `None` where it does not exist.
pub(crate) fn group_id(name: &str) -> Option<u32> {
    name.parse().ok().or_else(|| {
        let groups = std::fs::read_to_string(Path::new("/etc/group")).ok()?;
        find(&groups, name)
    })
}

fn find(groups: &str, name: &str) -> Option<u32> {
    let fields = groups.lines().map(|line| line.split(':'));
    fields
        .filter_map(|mut fields| Some((fields.next()?, fields.nth(1)?)))
        .find(|(found, _)| *found == name)
        .and_then(|(_, number)| number.parse().ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn group_is_found_by_its_whole_name() {
        let groups = "root:x:0:\ntabula-admin:x:991:anna\ntabula:x:990:anna,ben\nbroken\n";
        assert_eq!(find(groups, "tabula"), Some(990));
        assert_eq!(find(groups, "tabula-admin"), Some(991));
        assert_eq!(find(groups, "tab"), None);
        assert_eq!(find(groups, "broken"), None);
    }

    #[test]
    fn group_may_be_a_number() {
        assert_eq!(group_id("1234"), Some(1234));
    }
}
