//! Tests of reading, merging and checking the configuration.

use super::config_layer::ConfigLayer;
use super::*;
use proptest::prelude::*;
use serde::Deserialize;

#[derive(Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Camera {
    rate_hz: f64,
    #[serde(rename = "loop")]
    looped: bool,
}

/// Configuration of texts, the last one wins, named `0.toml`, `1.toml` and so on.
fn merged(texts: &[&str]) -> Result<Configuration, ConfigError> {
    let layer = |(number, text): (usize, &&str)| ConfigLayer {
        path: PathBuf::from(format!("{number}.toml")),
        text: (*text).to_owned(),
    };
    let merged = Configuration::merge(texts.iter().enumerate().map(layer).collect())?;
    merged.check()?;
    Ok(merged)
}

fn camera_of(texts: &[&str]) -> Result<Camera, String> {
    let read = merged(texts).and_then(|configuration| configuration.section("camera"));
    read.map_err(|error| error.to_string())
}

#[test]
fn section_is_read_and_defaults_fill_the_rest() {
    let fast = Camera {
        rate_hz: 5.0,
        looped: false,
    };
    assert_eq!(camera_of(&["[camera]\nrate_hz = 5.0"]), Ok(fast));
    assert_eq!(camera_of(&["[memory]\n"]), Ok(Camera::default()));
    assert_eq!(camera_of(&[]), Ok(Camera::default()));
}

#[test]
fn later_files_win_key_by_key() {
    let texts = [
        "[camera]\nrate_hz = 5.0\nloop = true\n",
        "[memory]\nqueue_requests = 3\n",
        "# more\n[camera]\nrate_hz = 6\n",
    ];
    let configuration = merged(&texts).unwrap();
    let camera = Camera {
        rate_hz: 6.0,
        looped: true,
    };
    assert_eq!(configuration.section::<Camera>("camera").unwrap(), camera);
    let place = |key| {
        let setting = configuration.setting("camera", key).unwrap();
        (setting.file.to_str().unwrap().to_owned(), setting.line)
    };
    assert_eq!(place("rate_hz"), ("2.toml".to_owned(), 3));
    assert_eq!(place("loop"), ("0.toml".to_owned(), 3));
    assert_eq!(configuration.files().count(), 3);
}

#[test]
fn effective_value_is_that_of_a_file_or_the_default() {
    let configuration = merged(&["[camera]\nrate_hz = 5.0"]).unwrap();
    let effective = |section, key| configuration.effective(section, key).map(Value::to_string);
    assert_eq!(effective("camera", "rate_hz").unwrap(), "5.0");
    assert_eq!(effective("memory", "queue_requests").unwrap(), "1024");
    assert_eq!(effective("camera", "source"), None);
}

#[test]
fn errors_name_the_file_that_set_the_value_and_the_line() {
    let check = |texts: &[&str], words: &[&str]| {
        let sentence = camera_of(texts).unwrap_err();
        for word in words {
            assert!(sentence.contains(word), "{word}: {sentence}");
        }
        assert_eq!(sentence.lines().count(), 1, "{sentence}");
    };
    let good = "[camera]\nrate_hz = 5.0\n";
    check(
        &[good, "[camera]\nrate = 5.0"],
        &["1.toml", "line 2", "rate_hz"],
    );
    check(
        &["[camera]\n\nrate_hz = \"fast\"\n", "[camera]\nloop = true"],
        &["0.toml", "line 3", "rate_hz", "float", "fast"],
    );
    check(
        &[good, "[memory]\nqueue_requests = 0"],
        &["1.toml", "line 2", "1000000 requests"],
    );
    check(&["[kamera]\n"], &["[kamera]"]);
}

#[test]
fn bound_by_another_key_is_checked_across_files() {
    let sentence = |texts: &[&str]| merged(texts).unwrap_err().to_string();
    let low = "[run]\nstartup_watchdog_s = 100.0";
    let found = sentence(&[low, "[run]\nwatchdog_s = 200.0"]);
    for word in ["0.toml", "line 2", "startup_watchdog_s", "watchdog_s (200)"] {
        assert!(found.contains(word), "{word}: {found}");
    }
    assert!(merged(&[low]).is_ok());
    // Here the default of the other key is too small.
    let found = sentence(&["[run]\n\nwatchdog_s = 200.0"]);
    for word in ["0.toml", "line 3", "startup_watchdog_s", "not 120.0"] {
        assert!(found.contains(word), "{word}: {found}");
    }
}

#[test]
fn errors_of_a_process_name_the_place_of_the_key() {
    let configuration = merged(&["[camera]\nrate_hz = 5.0\n", "[camera]\nsource = \"x\""]).unwrap();
    let sentence = |keys: &[&str]| configuration.wrong("camera", keys, "is odd").to_string();
    assert_eq!(
        sentence(&["lockstep", "source"]),
        "the configuration 1.toml is wrong in line 2: [camera] is odd"
    );
    assert_eq!(
        sentence(&["lockstep"]),
        "the configuration 0.toml is wrong: [camera] is odd"
    );
}

#[test]
fn keys_of_test_programs_are_left_to_them() {
    assert!(merged(&["[perception]\nfault_panic_every_ms = 5"]).is_ok());
}

#[test]
fn hostile_text_stays_one_short_line() {
    let long = format!("[run]\n\"\\u001b[2J{}\" = 1", "x".repeat(10_000));
    let sentence = camera_of(&[&long]).unwrap_err();
    assert!(sentence.len() < 1000, "{}", sentence.len());
    assert!(!sentence.chars().any(char::is_control), "{sentence:?}");
}

/// Any text is a configuration or is refused with a sentence.
#[test]
fn fuzz_configuration_files() {
    let seeds = [
        b"[camera]\nrate_hz = 5.0\n[memory]\nqueue_requests = 3\n".to_vec(),
        b"[run]\n\n[camera]\nrate_hz = 1e3 # fast\n".to_vec(),
        b"perception.candidate_rule = 'C_table' # rule\n[camera]\nloop = true\n".to_vec(),
    ];
    mutation_fuzzing::fuzz(&seeds, |bytes| {
        let text = String::from_utf8_lossy(bytes).into_owned();
        let outcome = merged(&[&text, "[camera]\nloop = false"]);
        match outcome {
            Ok(read) => {
                assert!(toml::from_str::<Table>(&text).is_ok());
                assert_eq!(read.setting("camera", "loop").unwrap().line, 2);
                if let Err(error) = read.section::<Camera>("camera") {
                    mutation_fuzzing::assert_sentence(&error);
                }
            }
            Err(error) => mutation_fuzzing::assert_sentence(&error),
        }
    });
}

/// A setting by chance: a key of the reference with its example, or with another valid number.
fn setting() -> impl Strategy<Value = (&'static str, &'static str, String)> {
    let keys = KeyReference::get().keys();
    (0..keys.len(), prop::bool::ANY).prop_map(move |(index, is_example)| {
        let key = &keys[index];
        let value = match (&key.example, is_example) {
            (Value::Boolean(value), false) => (!value).to_string(),
            (Value::Integer(value), false) => {
                let more = Value::Integer(value + 1);
                let is_valid = key.check(&more, |_| None).is_ok();
                (if is_valid { value + 1 } else { value - 1 }).to_string()
            }
            (example, _) => example.to_string(),
        };
        (key.section, key.key, value)
    })
}

/// Text of settings, of which the last one of a key counts.
fn text_of(settings: &[(&str, &str, String)]) -> String {
    let mut sections: BTreeMap<&str, BTreeMap<&str, &str>> = BTreeMap::new();
    for (section, key, value) in settings {
        sections.entry(section).or_default().insert(key, value);
    }
    let lines = sections.into_iter().flat_map(|(section, keys)| {
        let keys = keys
            .into_iter()
            .map(|(key, value)| format!("{key} = {value}\n"));
        std::iter::once(format!("[{section}]\n")).chain(keys)
    });
    lines.collect()
}

proptest! {
    /// Drop-ins give the same values as one file with the same keys.
    #[test]
    fn drop_ins_equal_one_file_with_the_same_keys(
        layers in prop::collection::vec(prop::collection::vec(setting(), 0..8), 0..6)
    ) {
        let texts: Vec<String> = layers.iter().map(|layer| text_of(layer)).collect();
        let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
        let all: Vec<_> = layers.iter().flatten().cloned().collect();
        let (dropped_in, one) = (merged(&texts).unwrap(), merged(&[&text_of(&all)]).unwrap());
        for key in KeyReference::get().keys() {
            prop_assert_eq!(
                dropped_in.effective(key.section, key.key),
                one.effective(key.section, key.key)
            );
            let last = layers.iter().rposition(|layer| {
                layer.iter().any(|(section, name, _)| (*section, *name) == (key.section, key.key))
            });
            let file = dropped_in.setting(key.section, key.key).map(|setting| setting.file.clone());
            prop_assert_eq!(file, last.map(|last| Arc::new(PathBuf::from(format!("{last}.toml")))));
        }
    }
}
