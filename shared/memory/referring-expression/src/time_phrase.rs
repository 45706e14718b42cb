//! Time phrases: "yesterday", "two minutes ago", "on Monday", as windows of the wall clock.

/// Unit of "N units ago".
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TimeUnit {
    Second,
    Minute,
    Hour,
    Day,
    Week,
    Month,
}

/// Time in relation to the present.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum TimePhrase {
    /// "just now"
    JustNow,
    /// "two minutes ago"
    Ago(f64, TimeUnit),
    /// "in the last two minutes"
    Within(f64, TimeUnit),
    /// Hours of a day that lies some days back; the end may be after midnight.
    Hours {
        days_back: i64,
        from_h: i64,
        to_h: i64,
    },
    /// The last such day before today, or today; 0 is Monday.
    Weekday(i64),
    /// "last week": Monday to Sunday, some weeks back.
    Week { weeks_back: i64 },
}

/// Window of the wall clock with soft borders.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct TimeWindow {
    from_ns: i64,
    to_ns: i64,
    /// Distance from a border at which the score has fallen to 0.
    soft_ns: i64,
}

const SECOND_NS: i64 = 1_000_000_000;
const HOUR_S: i64 = 3600;
const DAY_S: i64 = 24 * HOUR_S;

/// Tolerance of a day's part: "this morning" may be a little after noon. Chosen.
const DAY_PART_SOFT_S: i64 = HOUR_S;

/// "Just now" in seconds. Chosen.
const JUST_NOW_S: i64 = 600;

impl TimeUnit {
    fn seconds(self) -> i64 {
        match self {
            Self::Second => 1,
            Self::Minute => 60,
            Self::Hour => HOUR_S,
            Self::Day => DAY_S,
            Self::Week => 7 * DAY_S,
            Self::Month => 30 * DAY_S,
        }
    }
}

impl TimePhrase {
    /// Window of the phrase, for the present and the offset of local time.
    pub(crate) fn window(self, now_ns: i64, utc_offset_s: i32) -> TimeWindow {
        let now_s = now_ns.div_euclid(SECOND_NS);
        // The present second belongs to what ends now.
        let end_s = now_s + 1;
        let offset_s = i64::from(utc_offset_s);
        let midnight_s = (now_s + offset_s).div_euclid(DAY_S) * DAY_S - offset_s;
        // The first of January 1970 was a Thursday, which is 3.
        let weekday = ((now_s + offset_s).div_euclid(DAY_S) + 3).rem_euclid(7);
        let days = |from_days: i64, n_days: i64| {
            let from_s = midnight_s + from_days * DAY_S;
            seconds(from_s, from_s + n_days * DAY_S, 0)
        };
        match self {
            Self::JustNow => seconds(now_s - JUST_NOW_S, end_s, 2 * JUST_NOW_S),
            Self::Ago(number, unit) => ago(now_s, number, unit),
            Self::Within(number, unit) => {
                let length_s = (number.clamp(0.0, 1e6) * unit.seconds() as f64) as i64;
                seconds(now_s - length_s, end_s, length_s / 10)
            }
            Self::Hours {
                days_back,
                from_h,
                to_h,
            } => {
                let day_s = midnight_s - days_back * DAY_S;
                let is_whole_day = from_h == 0 && to_h == 24;
                let soft_s = if is_whole_day { 0 } else { DAY_PART_SOFT_S };
                seconds(day_s + from_h * HOUR_S, day_s + to_h * HOUR_S, soft_s)
            }
            Self::Weekday(day) => days(-(weekday - day).rem_euclid(7), 1),
            Self::Week { weeks_back } => days(-weekday - 7 * weeks_back, 7),
        }
    }
}

/// Window around a distance from the present: people round, and count days by the calendar.
fn ago(now_s: i64, number: f64, unit: TimeUnit) -> TimeWindow {
    let unit_s = unit.seconds() as f64;
    let distance_s = number.clamp(0.0, 1e6) * unit_s;
    let half_s = 0.5 * unit_s + 0.15 * distance_s;
    let centre_s = now_s.saturating_sub(distance_s as i64);
    let soft_s = (unit_s + 0.3 * distance_s) as i64;
    seconds(centre_s - half_s as i64, centre_s + half_s as i64, soft_s)
}

fn seconds(from_s: i64, to_s: i64, soft_s: i64) -> TimeWindow {
    TimeWindow {
        from_ns: from_s.saturating_mul(SECOND_NS),
        to_ns: to_s.saturating_mul(SECOND_NS),
        soft_ns: soft_s.saturating_mul(SECOND_NS),
    }
}

impl TimeWindow {
    /// Score of an instant: 1 inside, falling to 0 beyond the borders.
    pub(crate) fn score(self, instant_ns: i64) -> f64 {
        self.score_of_interval(instant_ns, instant_ns)
    }

    /// Score of an interval by its instant that fits best.
    pub(crate) fn score_of_interval(self, from_ns: i64, to_ns: i64) -> f64 {
        let before = self.from_ns.saturating_sub(to_ns);
        let after = from_ns.saturating_sub(self.to_ns);
        let outside_ns = before.max(after);
        if outside_ns <= 0 {
            return 1.0;
        }
        let soft_ns = self.soft_ns.max(1) as f64;
        (1.0 - outside_ns as f64 / soft_ns).max(0.0)
    }
}

/// Duration in words, rounded to its largest unit: "35 s", "4 min", "3 h", "2 days".
pub(crate) fn duration_text(duration_ns: i64) -> String {
    let seconds = duration_ns.max(0) / SECOND_NS;
    match seconds {
        0..120 => format!("{seconds} s"),
        120..7200 => format!("{} min", seconds / 60),
        7200..172_800 => format!("{} h", seconds / HOUR_S),
        _ => format!("{} days", seconds / DAY_S),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Wednesday, 15 November 2023, 10:00 UTC.
    const NOW_S: i64 = 1_700_042_400;

    fn score(phrase: TimePhrase, before_now_s: i64) -> f64 {
        let window = phrase.window(NOW_S * SECOND_NS, 0);
        window.score((NOW_S - before_now_s) * SECOND_NS)
    }

    #[test]
    fn time_phrase_yesterday_is_a_calendar_day() {
        let yesterday = TimePhrase::Hours {
            days_back: 1,
            from_h: 0,
            to_h: 24,
        };
        assert_eq!(score(yesterday, 9 * HOUR_S), 0.0);
        assert_eq!(score(yesterday, 11 * HOUR_S), 1.0);
        assert_eq!(score(yesterday, 33 * HOUR_S), 1.0);
        assert_eq!(score(yesterday, 35 * HOUR_S), 0.0);
        // In Auckland, it is already 23:00.
        let window = yesterday.window(NOW_S * SECOND_NS, 13 * 3600);
        assert_eq!(window.score((NOW_S - 22 * HOUR_S) * SECOND_NS), 0.0);
        assert_eq!(window.score((NOW_S - 24 * HOUR_S) * SECOND_NS), 1.0);
    }

    #[test]
    fn time_phrase_monday_is_the_last_one() {
        assert_eq!(score(TimePhrase::Weekday(0), 2 * DAY_S), 1.0);
        assert_eq!(score(TimePhrase::Weekday(0), DAY_S), 0.0);
        assert_eq!(score(TimePhrase::Weekday(3), 6 * DAY_S), 1.0);
        assert_eq!(score(TimePhrase::Week { weeks_back: 1 }, 3 * DAY_S), 1.0);
        assert_eq!(score(TimePhrase::Week { weeks_back: 1 }, 2 * DAY_S), 0.0);
    }

    #[test]
    fn time_phrase_ago_is_soft() {
        let two_minutes = TimePhrase::Ago(2.0, TimeUnit::Minute);
        assert_eq!(score(two_minutes, 130), 1.0);
        let close = score(two_minutes, 190);
        assert!(close > 0.0 && close < 1.0);
        assert_eq!(score(two_minutes, 600), 0.0);
        assert!(score(TimePhrase::Ago(1e30, TimeUnit::Month), 0) <= 1.0);
    }

    #[test]
    fn time_phrase_accepts_any_instant() {
        for now_ns in [i64::MIN, 0, i64::MAX] {
            let window = TimePhrase::JustNow.window(now_ns, i32::MIN);
            assert!(window.score(i64::MAX) <= 1.0 && window.score(i64::MIN) >= 0.0);
        }
    }

    #[test]
    fn time_phrase_just_now_ends_with_the_present_second() {
        let now_ns = NOW_S * SECOND_NS + SECOND_NS / 2;
        for phrase in [
            TimePhrase::JustNow,
            TimePhrase::Within(2.0, TimeUnit::Minute),
        ] {
            let window = phrase.window(now_ns, 0);
            assert_eq!(window.score(now_ns), 1.0, "{phrase:?}");
        }
    }
}
