//! Byte encoding of a descriptor: `f32` values, little-endian.

use serde::{Deserialize, Serialize};

/// Descriptor as bytes: `f32` values, little-endian, in the order of the values.
///
/// The bytes are those of the wire, of the store and of the payload of
/// the topic of described views. Serialised as a byte string, as a
/// `Vec<u8>` field with `serde_bytes` is.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct DescriptorBytes(#[serde(with = "serde_bytes")] Vec<u8>);

/// Error of decoding a descriptor: the number of bytes is not a multiple of four.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a descriptor of {n_bytes} bytes is not a list of 32-bit numbers")]
pub struct InvalidDescriptor {
    n_bytes: usize,
}

impl DescriptorBytes {
    /// Encodes the values of a descriptor; bit-exact, NaN included.
    pub fn encode(values: &[f32]) -> Self {
        Self(
            values
                .iter()
                .flat_map(|value| value.to_le_bytes())
                .collect(),
        )
    }

    /// Decodes the descriptor values.
    ///
    /// # Errors
    /// When the number of bytes is not a multiple of four.
    pub fn decode(&self) -> Result<Vec<f32>, InvalidDescriptor> {
        Self::decode_slice(&self.0)
    }

    /// Decodes the values of a descriptor from borrowed bytes.
    ///
    /// # Errors
    /// When the number of bytes is not a multiple of four.
    pub fn decode_slice(bytes: &[u8]) -> Result<Vec<f32>, InvalidDescriptor> {
        let (values, rest) = bytes.as_chunks::<4>();
        if !rest.is_empty() {
            return Err(InvalidDescriptor {
                n_bytes: bytes.len(),
            });
        }
        Ok(values
            .iter()
            .map(|value| f32::from_le_bytes(*value))
            .collect())
    }

    /// Encoded descriptor as bytes.
    pub fn as_bytes(&self) -> &[u8] {
        &self.0
    }

    /// Bytes of the descriptor, without a copy.
    pub fn into_bytes(self) -> Vec<u8> {
        self.0
    }

    /// Size of the descriptor, bytes.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// True if the descriptor has no values.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl From<&[f32]> for DescriptorBytes {
    fn from(values: &[f32]) -> Self {
        Self::encode(values)
    }
}

impl From<Vec<u8>> for DescriptorBytes {
    /// Wraps descriptor bytes unchecked; [`decode`](DescriptorBytes::decode) checks them.
    fn from(bytes: Vec<u8>) -> Self {
        Self(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn values_survive_a_round_trip(bits in prop::collection::vec(any::<u32>(), 0..50)) {
            let values: Vec<f32> = bits.iter().copied().map(f32::from_bits).collect();
            let bytes = DescriptorBytes::encode(&values);
            prop_assert_eq!(bytes.len(), 4 * values.len());
            let decoded: Vec<u32> = bytes.decode().unwrap().into_iter().map(f32::to_bits).collect();
            prop_assert_eq!(decoded, bits);
        }

        #[test]
        fn bytes_survive_a_round_trip(bytes in any::<Vec<u8>>()) {
            match DescriptorBytes::from(bytes.clone()).decode() {
                Ok(values) => {
                    prop_assert_eq!(DescriptorBytes::encode(&values).into_bytes(), bytes);
                }
                Err(error) => {
                    prop_assert_ne!(bytes.len() % 4, 0);
                    prop_assert_eq!(error, InvalidDescriptor { n_bytes: bytes.len() });
                }
            }
        }
    }

    #[test]
    fn the_byte_order_is_little_endian() {
        let bytes = DescriptorBytes::from([1.0_f32, -2.5].as_slice());
        assert_eq!(bytes.as_bytes(), [0, 0, 0x80, 0x3f, 0, 0, 0x20, 0xc0]);
        assert!(!bytes.is_empty() && DescriptorBytes::default().is_empty());
    }

    /// CBOR compatibility with the fields that hold descriptors as `Vec<u8>`.
    #[test]
    fn the_serialised_form_is_a_byte_string() {
        let bytes = DescriptorBytes::encode(&[0.5, 0.25]);
        let plain = serde_bytes::ByteBuf::from(bytes.as_bytes());
        assert_eq!(cbor(&bytes), cbor(&plain));
        let read: DescriptorBytes = ciborium::from_reader(cbor(&plain).as_slice()).unwrap();
        assert_eq!(read, bytes);
    }

    fn cbor(value: &impl Serialize) -> Vec<u8> {
        let mut bytes = Vec::new();
        ciborium::into_writer(value, &mut bytes).unwrap();
        bytes
    }
}
