//! Paths that a file gives to other files of its folder.

/// Path below a folder, with `/` between its parts, for a name that a file in the subfolder `base`
/// gives; `None` for a name that leads out of the folder or is not a relative path. `\` counts as
/// `/`, as in files from Windows.
pub(crate) fn path_below(base: &str, name: &str) -> Option<String> {
    let name = name.replace('\\', "/");
    if name.is_empty() || name.starts_with('/') || name.contains([':', '\0']) {
        return None;
    }
    let mut parts: Vec<&str> = base.split('/').filter(|part| !part.is_empty()).collect();
    for part in name.split('/') {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop()?;
            }
            part => parts.push(part),
        }
    }
    (!parts.is_empty()).then(|| parts.join("/"))
}

/// Folder of a path below a folder: `a/b` for `a/b/c`.
pub(crate) fn parent(path: &str) -> &str {
    path.rsplit_once('/').map_or("", |(parent, _)| parent)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_stay_in_their_folder() {
        for (base, name, path) in [
            ("", "a b.png", Some("a b.png")),
            ("", "./maps//a.png", Some("maps/a.png")),
            ("", "maps\\a.png", Some("maps/a.png")),
            ("materials", "../maps/a.png", Some("maps/a.png")),
            ("materials", "a.png", Some("materials/a.png")),
            ("", "..", None),
            ("", "../a.png", None),
            ("", "a/../../b.png", None),
            ("materials", "../../a.png", None),
            ("", "/etc/passwd", None),
            ("", "\\etc\\passwd", None),
            ("", "C:\\a.png", None),
            ("", "C:a.png", None),
            ("", "file:///a.png", None),
            ("", "", None),
            ("a", "", None),
            ("", "a/..", None),
        ] {
            assert_eq!(path_below(base, name).as_deref(), path, "{base} {name}");
        }
        assert_eq!(parent("a/b/c"), "a/b");
        assert_eq!(parent("c"), "");
    }
}
