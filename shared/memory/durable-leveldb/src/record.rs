//! Record format of the database: version, checksum, CBOR.
//!
//! `[version: u8][crc32: u32 little-endian][CBOR]`. The checksum covers key, version and CBOR, so
//! that a record under a wrong key counts as damaged too.

use serde::Serialize;
use serde::de::DeserializeOwned;

/// Version of the record format. Records whose fields change get a table of their own, so that
/// the digests of the others stay.
pub const VERSION: u8 = 2;
const HEADER_BYTES: usize = 5;

/// Serialises a value as the record under `key`.
///
/// # Panics
///
/// When the value refuses to be serialised, which plain data never does.
pub fn seal<T: Serialize>(key: &[u8], value: &T) -> Vec<u8> {
    let mut record = vec![0; HEADER_BYTES];
    #[expect(
        clippy::expect_used,
        reason = "writing plain data to a Vec cannot fail"
    )]
    ciborium::into_writer(value, &mut record).expect("CBOR written to memory");
    let checksum = checksum(key, VERSION, &record[HEADER_BYTES..]);
    record[0] = VERSION;
    record[1..HEADER_BYTES].copy_from_slice(&checksum.to_le_bytes());
    record
}

/// Deserialises the record under `key`.
///
/// # Errors
///
/// A phrase that says why the record is invalid.
pub fn unseal<T: DeserializeOwned>(key: &[u8], record: &[u8]) -> Result<T, &'static str> {
    read(payload(key, record)?)
}

/// Deserialises a record of any schema; returns its version too.
///
/// # Errors
///
/// A phrase that says why the record is invalid.
pub fn unseal_any<T: DeserializeOwned>(key: &[u8], record: &[u8]) -> Result<(u8, T), &'static str> {
    let (version, payload) = versioned_payload(key, record)?;
    Ok((version, read(payload)?))
}

/// CBOR payload of a record with a valid checksum.
fn payload<'a>(key: &[u8], record: &'a [u8]) -> Result<&'a [u8], &'static str> {
    match versioned_payload(key, record)? {
        (VERSION, payload) => Ok(payload),
        _ => Err("its version is not known"),
    }
}

/// Version of a record with a valid checksum.
pub(crate) fn version(key: &[u8], record: &[u8]) -> Option<u8> {
    versioned_payload(key, record)
        .ok()
        .map(|(version, _)| version)
}

fn read<T: DeserializeOwned>(payload: &[u8]) -> Result<T, &'static str> {
    ciborium::from_reader(payload).map_err(|_| "its fields cannot be read")
}

fn versioned_payload<'a>(key: &[u8], record: &'a [u8]) -> Result<(u8, &'a [u8]), &'static str> {
    let Some((&[version, a, b, c, d], payload)) = record.split_first_chunk::<HEADER_BYTES>() else {
        return Err("it is too short");
    };
    if checksum(key, version, payload) != u32::from_le_bytes([a, b, c, d]) {
        return Err("its checksum is wrong");
    }
    Ok((version, payload))
}

fn checksum(key: &[u8], version: u8, payload: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(key);
    hasher.update(&[version]);
    hasher.update(payload);
    hasher.finalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn record_is_valid_only_whole_and_under_its_key() {
        let value = (7_u64, "mug".to_owned(), vec![0.5_f32, -0.0]);
        let record = seal(b"key", &value);
        assert_eq!(
            unseal::<(u64, String, Vec<f32>)>(b"key", &record),
            Ok(value)
        );
        assert!(payload(b"kez", &record).is_err());
        for i in 0..record.len() {
            for bit in 0..8 {
                let mut damaged = record.clone();
                damaged[i] ^= 1 << bit;
                assert!(payload(b"key", &damaged).is_err(), "byte {i}, bit {bit}");
            }
            assert!(payload(b"key", &record[..i]).is_err(), "cut to {i}");
        }
    }
}
