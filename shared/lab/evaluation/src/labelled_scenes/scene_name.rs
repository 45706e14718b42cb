//! Group and half of a scene, parsed from its file name.

/// Kinds of the mOSD scenes (Richtsfeld et al. 2012) by last scene number, inclusive.
const LEARN_KINDS: [(u64, &str); 4] = [
    (16, "boxes"),
    (24, "stacked"),
    (32, "occluded"),
    (44, "cylindric"),
];
const TEST_KINDS: [(u64, &str); 6] = [
    (15, "boxes"),
    (23, "stacked"),
    (30, "occluded"),
    (42, "cylindric"),
    (54, "mixed"),
    (65, "complex"),
];

/// Kind of an mOSD scene; `None` for other names.
pub(super) fn mosd_kind(stem: &str) -> Option<&'static str> {
    let learn = stem
        .strip_prefix("learn")
        .map(|number| (number, &LEARN_KINDS[..]));
    let (number, kinds) = learn.or_else(|| {
        stem.strip_prefix("test")
            .map(|number| (number, &TEST_KINDS[..]))
    })?;
    // `parse` alone would accept a sign.
    let is_number = number.bytes().all(|byte| byte.is_ascii_digit());
    let number: u64 = is_number.then_some(number)?.parse().ok()?;
    let kind = kinds.iter().find(|(last, _)| number <= *last);
    kind.map(|(_, name)| *name)
}

/// `Some(true)` if the number at the end of a name is odd; `None` without a number.
pub(super) fn ends_odd(stem: &str) -> Option<bool> {
    let last = stem.bytes().next_back().filter(u8::is_ascii_digit)?;
    Some(last % 2 == 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mosd_kind_follows_from_the_scene_number() {
        for (stem, kind) in [
            ("learn0", Some("boxes")),
            ("learn16", Some("boxes")),
            ("learn17", Some("stacked")),
            ("learn25", Some("occluded")),
            ("learn33", Some("cylindric")),
            ("learn44", Some("cylindric")),
            ("learn45", None),
            ("test15", Some("boxes")),
            ("test16", Some("stacked")),
            ("test24", Some("occluded")),
            ("test31", Some("cylindric")),
            ("test43", Some("mixed")),
            ("test55", Some("complex")),
            ("test65", Some("complex")),
            ("test66", None),
            ("learn", None),
            ("learn+3", None),
            ("scene3", None),
        ] {
            assert_eq!(mosd_kind(stem), kind, "{stem}");
        }
    }

    #[test]
    fn last_digit_selects_the_half() {
        for (stem, is_odd) in [
            ("learn10", Some(false)),
            ("frame-000007", Some(true)),
            ("table", None),
            ("", None),
        ] {
            assert_eq!(ends_odd(stem), is_odd, "{stem}");
        }
    }
}
