//! Consistency check of a process's section with the key reference, for the tests of the processes.

use super::key_value_check::{KeyBound, ValueKind};
use super::{Configuration, KeyDescription, KeyReference, SECTIONS, Setting, as_number};
use std::fmt::Debug;
use std::path::PathBuf;
use std::sync::Arc;
use toml::Value;

/// Checks that the key reference and a process agree on a section: on its keys, on its defaults,
/// and on the bounds of its numbers, and that NaN is refused. `read` is the process's reading of
/// the section.
///
/// # Errors
/// A sentence with the first key on which they do not agree.
pub fn check_section_reference<C: Debug, E: Debug>(
    section: &str,
    read: impl Fn(&Configuration) -> Result<C, E>,
) -> Result<(), String> {
    let Some(section) = SECTIONS.into_iter().find(|known| *known == section) else {
        return Err(format!("there is no section {section}"));
    };
    let with = |settings: &[(&str, Value)]| {
        let mut configuration = Configuration::default();
        for (key, value) in settings {
            let setting = Setting {
                value: value.clone(),
                file: Arc::new(PathBuf::from("reference")),
                line: 1,
            };
            configuration.set(section, (*key).to_owned(), setting);
        }
        read(&configuration).map(|config| format!("{config:?}"))
    };
    let reference = KeyReference::get();
    let defaults = reference
        .section(section)
        .filter_map(|one| Some((one.key, one.default.clone()?)));
    let defaults: Vec<_> = defaults.collect();
    let (built_in, written) = (with(&[]), with(&defaults));
    let (Ok(built_in), Ok(written)) = (&built_in, &written) else {
        return Err(format!(
            "the defaults are refused: {built_in:?} {written:?}"
        ));
    };
    if built_in != written {
        return Err(format!(
            "the defaults differ: built in {built_in}, in the reference {written}"
        ));
    }
    check_unknown_key(&with)?;
    for one in reference.section(section) {
        // Keys whose range begins at this one are at their end meanwhile.
        let others = reference.section(section).filter_map(|other| {
            let range = other.range.as_ref()?;
            let is_dependent = range.least == KeyBound::Key(one.key);
            Some((
                other.key,
                Value::Float(range.most.filter(|_| is_dependent)?),
            ))
        });
        let others: Vec<_> = others.collect();
        check_bounds(one, |value| {
            let mut settings = others.clone();
            settings.push((one.key, value));
            with(&settings).is_ok()
        })?;
    }
    Ok(())
}

/// Checks that the process refuses an unknown key, and that it names no key that is missing in the
/// reference.
fn check_unknown_key<E: Debug>(
    with: &impl Fn(&[(&str, Value)]) -> Result<String, E>,
) -> Result<(), String> {
    // The reference leaves the keys of test programs to the process, which lists its own.
    const UNKNOWN: &str = "fault_no_such_key";
    let Err(error) = with(&[(UNKNOWN, Value::Boolean(true))]) else {
        return Err("an unknown key is accepted".to_owned());
    };
    // The sentence lists the known keys in back quotes.
    let sentence = format!("{error:?}");
    let known = sentence.split('`').skip(1).step_by(2);
    let reference = KeyReference::get();
    let is_missing =
        |key: &&str| *key != UNKNOWN && !reference.keys().iter().any(|one| one.key == *key);
    let mut missing = known.filter(is_missing);
    match missing.next() {
        None => Ok(()),
        Some(key) => Err(format!("the reference does not have the key {key}")),
    }
}

/// Checks that the bounds of a number are accepted, and that what is just beyond them is not.
fn check_bounds(one: &KeyDescription, is_accepted: impl Fn(Value) -> bool) -> Result<(), String> {
    let Some(range) = &one.range else {
        return Ok(());
    };
    let value = |number: f64| match one.kind {
        ValueKind::Integer => Value::Integer(number as i64),
        _ => Value::Float(number),
    };
    let step = match one.kind {
        ValueKind::Integer => 1.0,
        _ => 1e-6,
    };
    let agree = |number: f64, is_expected: bool| {
        if is_accepted(value(number)) == is_expected {
            return Ok(());
        }
        let found = if is_expected { "refused" } else { "accepted" };
        Err(format!("{} = {number} is {found}", one.full_name()))
    };
    let least = match &range.least {
        KeyBound::Number(number) => Some(*number),
        KeyBound::Key(key) => KeyReference::get()
            .key(one.section, key)
            .and_then(|other| as_number(other.default.as_ref()?)),
    };
    if let Some(least) = least {
        agree(least - step, false)?;
        agree(least, true)?;
    }
    if let Some(most) = range.most {
        agree(most, true)?;
        agree(most + step, false)?;
    }
    if one.kind == ValueKind::Float {
        agree(f64::NAN, false)?;
    }
    Ok(())
}
