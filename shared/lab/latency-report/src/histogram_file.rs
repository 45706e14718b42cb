//! Mergeable histogram files: the interval log of `HdrHistogram` (version 1.3), one tag per
//! stage, readable by its tools in other languages. Values are nanoseconds.

use crate::duration_percentiles::DurationPercentiles;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use hdrhistogram::Histogram;
use hdrhistogram::serialization::interval_log::{
    IntervalLogHistogram, IntervalLogIterator, IntervalLogWriterBuilder, LogEntry, Tag,
};
use hdrhistogram::serialization::{Deserializer, V2DeflateSerializer};
use std::collections::BTreeMap;
use std::time::Duration;

/// Significant digits of the recorded values.
const DIGITS: u8 = 3;

/// Tag of the end-to-end histogram in a histogram file.
const END_TO_END: &str = "end_to_end";

/// Duration histograms by stage name.
#[derive(Debug, Clone, Default)]
pub struct Histograms(BTreeMap<String, Histogram<u64>>);

/// Error of writing or reading a histogram file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("no histogram file: {0}")]
pub struct HistogramFileError(String);

fn failed(cause: impl std::fmt::Debug) -> HistogramFileError {
    HistogramFileError(format!("{cause:?}"))
}

impl Histograms {
    /// Adds durations to the histogram of a stage.
    ///
    /// # Errors
    /// If a histogram cannot be created.
    pub fn add(&mut self, word: &str, durations_ns: &[u64]) -> Result<(), HistogramFileError> {
        let histogram = self.of(word)?;
        for duration_ns in durations_ns {
            histogram.record((*duration_ns).max(1)).map_err(failed)?;
        }
        Ok(())
    }

    /// Adds end-to-end latencies to the histogram.
    ///
    /// # Errors
    /// As [`add`](Self::add).
    pub fn add_end_to_end(&mut self, durations_ns: &[u64]) -> Result<(), HistogramFileError> {
        self.add(END_TO_END, durations_ns)
    }

    fn of(&mut self, word: &str) -> Result<&mut Histogram<u64>, HistogramFileError> {
        if !self.0.contains_key(word) {
            let histogram = Histogram::new(DIGITS).map_err(failed)?;
            self.0.insert(word.to_owned(), histogram);
        }
        self.0.get_mut(word).ok_or_else(|| failed(word))
    }

    /// Adds all histograms of another file.
    ///
    /// # Errors
    /// If two histograms are incompatible.
    pub fn merge(&mut self, other: &Self) -> Result<(), HistogramFileError> {
        for (word, histogram) in &other.0 {
            self.of(word)?.add(histogram).map_err(failed)?;
        }
        Ok(())
    }

    /// Stage name, number of durations and percentiles of each histogram.
    pub fn iter(&self) -> impl Iterator<Item = (&str, u64, DurationPercentiles)> {
        self.0.iter().map(|(word, histogram)| {
            let at = |share: f64| histogram.value_at_quantile(share);
            let ms = DurationPercentiles::of_quantiles(at);
            (word.as_str(), histogram.len(), ms)
        })
    }

    /// Text of a histogram file; `seconds` is the length of the measurement.
    ///
    /// # Errors
    /// If a histogram cannot be serialised.
    pub fn to_text(&self, seconds: f64) -> Result<String, HistogramFileError> {
        let mut text = Vec::new();
        let mut serializer = V2DeflateSerializer::new();
        let mut builder = IntervalLogWriterBuilder::new();
        let mut writer = builder
            .add_comment("durations in nanoseconds, one tag a stage")
            .begin_log_with(&mut text, &mut serializer)
            .map_err(failed)?;
        let length = Duration::from_secs_f64(seconds.max(0.0));
        for (word, histogram) in &self.0 {
            let tag = Tag::new(word).ok_or_else(|| failed(word))?;
            writer
                .write_histogram(histogram, Duration::ZERO, length, Some(tag))
                .map_err(failed)?;
        }
        String::from_utf8(text).map_err(failed)
    }

    /// Parses a histogram file. Several histograms of one stage are added.
    ///
    /// # Errors
    /// If the text is not a histogram file or is damaged.
    pub fn parse(text: &str) -> Result<Self, HistogramFileError> {
        let mut histograms = Self::default();
        for entry in IntervalLogIterator::new(text.as_bytes()) {
            if let LogEntry::Interval(interval) = entry.map_err(failed)? {
                histograms.take(&interval)?;
            }
        }
        if histograms.0.is_empty() {
            return Err(HistogramFileError("there is no histogram in it".into()));
        }
        Ok(histograms)
    }

    fn take(&mut self, interval: &IntervalLogHistogram<'_>) -> Result<(), HistogramFileError> {
        let word = interval.tag().map_or(END_TO_END, |tag| tag.as_str());
        let bytes = STANDARD
            .decode(interval.encoded_histogram())
            .map_err(failed)?;
        let histogram: Histogram<u64> = Deserializer::new()
            .deserialize(&mut bytes.as_slice())
            .map_err(failed)?;
        self.of(word)?.add(&histogram).map_err(failed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn histograms(n: u64) -> Histograms {
        let mut histograms = Histograms::default();
        let durations: Vec<u64> = (1..=n).map(|i| i * 10_000).collect();
        histograms.add("detection", &durations).unwrap();
        histograms.add_end_to_end(&durations).unwrap();
        histograms
    }

    fn median_ns(histograms: &Histograms, word: &str) -> u64 {
        let found = histograms.iter().find(|(name, ..)| *name == word);
        found
            .map(|(_, _, ms)| (ms.p50 * 1e6).round() as u64)
            .unwrap()
    }

    #[test]
    fn histograms_survive_a_round_trip_to_three_digits() {
        let written = histograms(1000);
        let read = Histograms::parse(&written.to_text(33.0).unwrap()).unwrap();
        let names: Vec<_> = read
            .iter()
            .map(|(word, n, _)| (word.to_owned(), n))
            .collect();
        assert_eq!(
            names,
            [("detection".into(), 1000), ("end_to_end".into(), 1000)]
        );
        let median = median_ns(&read, "detection") as f64;
        assert!((median / 5_000_000.0 - 1.0).abs() < 0.002, "{median}");
    }

    #[test]
    fn merged_files_hold_all() {
        let mut merged = histograms(1000);
        merged.merge(&histograms(3000)).unwrap();
        merged.add("recognition", &[7]).unwrap();
        let counts: Vec<u64> = merged.iter().map(|(_, n, _)| n).collect();
        assert_eq!(counts, [4000, 4000, 1]);
    }

    #[test]
    fn malformed_files_are_refused() {
        for text in [
            "",
            "rubbish",
            "Tag=a,0.1,1.0,2.0,notbase64!",
            "0.1,1.0,2.0,AAAA",
        ] {
            assert!(Histograms::parse(text).is_err(), "{text}");
        }
    }

    proptest! {
        #[test]
        fn damaged_files_never_panic(at in 0_usize..2000, byte in any::<u8>()) {
            let mut bytes = histograms(50).to_text(1.0).unwrap().into_bytes();
            let place = at % bytes.len();
            bytes[place] = byte;
            let _ = Histograms::parse(&String::from_utf8_lossy(&bytes));
        }
    }
}
