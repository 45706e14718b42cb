//! Times of lessons and views, and the verbs of teaching.

use crate::time_phrase::{TimePhrase, TimeUnit};

const fn hours(days_back: i64, from_h: i64, to_h: i64) -> TimePhrase {
    TimePhrase::Hours {
        days_back,
        from_h,
        to_h,
    }
}

/// Times without a number.
pub(crate) const TIMES: [(&str, TimePhrase); 42] = [
    ("just now", TimePhrase::JustNow),
    ("a moment ago", TimePhrase::JustNow),
    ("right now", TimePhrase::JustNow),
    ("recently", TimePhrase::Within(1.0, TimeUnit::Day)),
    ("today", hours(0, 0, 24)),
    ("earlier today", hours(0, 0, 24)),
    ("this morning", hours(0, 4, 12)),
    ("this noon", hours(0, 11, 14)),
    ("at noon", hours(0, 11, 14)),
    ("this afternoon", hours(0, 12, 18)),
    ("this evening", hours(0, 17, 24)),
    ("tonight", hours(0, 18, 28)),
    ("last night", hours(1, 18, 28)),
    ("yesterday", hours(1, 0, 24)),
    ("yesterday morning", hours(1, 4, 12)),
    ("yesterday afternoon", hours(1, 12, 18)),
    ("yesterday evening", hours(1, 17, 24)),
    ("yesterday night", hours(1, 18, 28)),
    ("the day before yesterday", hours(2, 0, 24)),
    ("this week", TimePhrase::Week { weeks_back: 0 }),
    ("last week", TimePhrase::Week { weeks_back: 1 }),
    ("on monday", TimePhrase::Weekday(0)),
    ("on tuesday", TimePhrase::Weekday(1)),
    ("on wednesday", TimePhrase::Weekday(2)),
    ("on thursday", TimePhrase::Weekday(3)),
    ("on friday", TimePhrase::Weekday(4)),
    ("on saturday", TimePhrase::Weekday(5)),
    ("on sunday", TimePhrase::Weekday(6)),
    ("last monday", TimePhrase::Weekday(0)),
    ("last tuesday", TimePhrase::Weekday(1)),
    ("last wednesday", TimePhrase::Weekday(2)),
    ("last thursday", TimePhrase::Weekday(3)),
    ("last friday", TimePhrase::Weekday(4)),
    ("last saturday", TimePhrase::Weekday(5)),
    ("last sunday", TimePhrase::Weekday(6)),
    ("monday", TimePhrase::Weekday(0)),
    ("tuesday", TimePhrase::Weekday(1)),
    ("wednesday", TimePhrase::Weekday(2)),
    ("thursday", TimePhrase::Weekday(3)),
    ("friday", TimePhrase::Weekday(4)),
    ("saturday", TimePhrase::Weekday(5)),
    ("sunday", TimePhrase::Weekday(6)),
];

/// Openings of "in the last two minutes".
pub(crate) const WITHIN: [(&str, ()); 5] = [
    ("in the last", ()),
    ("in the past", ()),
    ("within the last", ()),
    ("during the last", ()),
    ("the last", ()),
];

/// Numbers of time units that are no numerals.
pub(crate) const COUNTED_TIMES: [(&str, f64); 6] = [
    ("a", 1.0),
    ("an", 1.0),
    ("half an", 0.5),
    ("a few", 3.0),
    ("some", 3.0),
    ("a couple of", 2.0),
];

/// Units of time.
pub(crate) const TIME_UNITS: [(&str, TimeUnit); 16] = [
    ("second", TimeUnit::Second),
    ("seconds", TimeUnit::Second),
    ("s", TimeUnit::Second),
    ("minute", TimeUnit::Minute),
    ("minutes", TimeUnit::Minute),
    ("min", TimeUnit::Minute),
    ("mins", TimeUnit::Minute),
    ("hour", TimeUnit::Hour),
    ("hours", TimeUnit::Hour),
    ("h", TimeUnit::Hour),
    ("day", TimeUnit::Day),
    ("days", TimeUnit::Day),
    ("week", TimeUnit::Week),
    ("weeks", TimeUnit::Week),
    ("month", TimeUnit::Month),
    ("months", TimeUnit::Month),
];

/// Verbs of teaching, after the author.
pub(crate) const TEACHING_VERBS: [(&str, ()); 18] = [
    ("taught", ()),
    ("taught you", ()),
    ("teach", ()),
    ("teach you", ()),
    ("showed", ()),
    ("showed you", ()),
    ("showed to you", ()),
    ("shown", ()),
    ("shown you", ()),
    ("show you", ()),
    ("told you", ()),
    ("told you about", ()),
    ("taught you about", ()),
    ("explained", ()),
    ("explained to you", ()),
    ("introduced", ()),
    ("introduced to you", ()),
    ("labelled", ()),
];
