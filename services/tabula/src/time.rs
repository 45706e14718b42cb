//! Formatting of UTC timestamps as text.

const NS_PER_S: u64 = 1_000_000_000;
const S_PER_DAY: u64 = 24 * 3600;

/// UTC date and time of nanoseconds since 1970: `2026-11-22 10:30:00Z`; `-` for zero, an unknown
/// time.
pub(crate) fn utc(wall_ns: u64) -> String {
    if wall_ns == 0 {
        return "-".to_owned();
    }
    let seconds = wall_ns / NS_PER_S;
    let (year, month, day) = civil(seconds / S_PER_DAY);
    let (hour, minute, second) = (
        seconds % S_PER_DAY / 3600,
        seconds % 3600 / 60,
        seconds % 60,
    );
    format!("{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02}Z")
}

/// Year, month and day of a number of days since 1970 (Hinnant, "chrono-compatible
/// low-level date algorithms", `civil_from_days`).
fn civil(days: u64) -> (u64, u64, u64) {
    // Counted from the first of March of the year 0, so that leap days come last.
    let days = days + 719_468;
    let era = days / 146_097;
    let day_of_era = days % 146_097;
    let year_of_era =
        (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 {
        month_from_march + 3
    } else {
        month_from_march - 9
    };
    (year_of_era + era * 400 + u64::from(month <= 2), month, day)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn utc_matches_the_calendar() {
        for (seconds, text) in [
            (1, "1970-01-01 00:00:01Z"),
            (951_782_400, "2000-02-29 00:00:00Z"),
            (1_700_000_000, "2023-11-14 22:13:20Z"),
            (4_102_444_799, "2099-12-31 23:59:59Z"),
        ] {
            assert_eq!(utc(seconds * NS_PER_S), text);
        }
        assert_eq!(utc(0), "-");
    }
}
