//! ROS 2 message `sensor_msgs/msg/PointCloud2` with its CDR serialisation.

use crate::cdr::{CdrReader, CdrWriter};

/// Datatype code of `FLOAT32` in `sensor_msgs/msg/PointField`.
const FLOAT32: u8 = 7;
/// Datatype code of `UINT32` in `sensor_msgs/msg/PointField`.
const UINT32: u8 = 6;
/// Upper bound of a message's size without its data, bytes.
const MAX_OTHER_BYTES: usize = 256;
/// Size of a point, bytes.
const POINT_BYTES: u32 = 16;

/// Point cloud message; the fields are those of the ROS definition.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PointCloud2 {
    pub stamp_s: i32,
    pub stamp_ns: u32,
    pub frame_id: String,
    pub height: u32,
    pub width: u32,
    pub fields: Vec<PointField>,
    pub is_bigendian: bool,
    pub point_step: u32,
    pub row_step: u32,
    pub data: Vec<u8>,
    pub is_dense: bool,
}

/// Description of one field of a point (`sensor_msgs/msg/PointField`).
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PointField {
    pub name: String,
    pub offset: u32,
    pub datatype: u8,
    pub count: u32,
}

impl PointCloud2 {
    /// Unorganised cloud of x, y, z and colour with `n_bytes` of zero data.
    pub fn with_data_bytes(n_bytes: usize) -> Self {
        let field = |(name, datatype), offset| PointField {
            name: String::from(name),
            offset,
            datatype,
            count: 1,
        };
        let named = [("x", FLOAT32), ("y", FLOAT32), ("z", FLOAT32)];
        let named = named.into_iter().chain([("rgba", UINT32)]);
        Self {
            frame_id: String::from("camera_depth_optical_frame"),
            height: 1,
            width: n_bytes as u32 / POINT_BYTES,
            fields: named
                .zip((0..).step_by(4))
                .map(|(n, o)| field(n, o))
                .collect(),
            point_step: POINT_BYTES,
            row_step: n_bytes as u32,
            data: vec![0; n_bytes],
            ..Self::default()
        }
    }

    /// Sets the time stamp from nanoseconds.
    pub fn set_stamp(&mut self, stamp_ns: u64) {
        self.stamp_s = (stamp_ns / 1_000_000_000) as i32;
        self.stamp_ns = (stamp_ns % 1_000_000_000) as u32;
    }

    /// Time stamp, nanoseconds.
    pub fn stamp(&self) -> u64 {
        self.stamp_s as u64 * 1_000_000_000 + u64::from(self.stamp_ns)
    }

    /// Serialises into a new buffer, as a middleware does: all data is copied.
    pub fn serialize(&self) -> Vec<u8> {
        let mut writer = CdrWriter::with_capacity(self.data.len() + MAX_OTHER_BYTES);
        writer.unsigned(self.stamp_s.cast_unsigned());
        writer.unsigned(self.stamp_ns);
        writer.text(&self.frame_id);
        writer.unsigned(self.height);
        writer.unsigned(self.width);
        writer.unsigned(self.fields.len() as u32);
        for field in &self.fields {
            writer.text(&field.name);
            writer.unsigned(field.offset);
            writer.octet(field.datatype);
            writer.unsigned(field.count);
        }
        writer.octet(u8::from(self.is_bigendian));
        writer.unsigned(self.point_step);
        writer.unsigned(self.row_step);
        writer.octets(&self.data);
        writer.octet(u8::from(self.is_dense));
        writer.finish()
    }

    /// Deserialises into a new message; `None` if the bytes are truncated or invalid.
    pub fn deserialize(bytes: &[u8]) -> Option<Self> {
        let mut reader = CdrReader::new(bytes)?;
        Some(Self {
            stamp_s: reader.unsigned()?.cast_signed(),
            stamp_ns: reader.unsigned()?,
            frame_id: reader.text()?.to_owned(),
            height: reader.unsigned()?,
            width: reader.unsigned()?,
            fields: read_fields(&mut reader)?,
            is_bigendian: reader.octet()? != 0,
            point_step: reader.unsigned()?,
            row_step: reader.unsigned()?,
            data: reader.octets()?.to_vec(),
            is_dense: reader.octet()? != 0,
        })
    }
}

/// Reads the sequence of point fields.
fn read_fields(reader: &mut CdrReader<'_>) -> Option<Vec<PointField>> {
    let n_fields = reader.unsigned()?;
    // Collected one by one: a wrong count hits the end of the bytes before it exhausts memory.
    let field = |_| {
        Some(PointField {
            name: reader.text()?.to_owned(),
            offset: reader.unsigned()?,
            datatype: reader.octet()?,
            count: reader.unsigned()?,
        })
    };
    (0..n_fields).map(field).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn serialisation_round_trips() {
        for n_bytes in [0, 64, 65_536] {
            let mut message = PointCloud2::with_data_bytes(n_bytes);
            message.set_stamp(12_345_678_901_234);
            for (i, byte) in message.data.iter_mut().enumerate() {
                *byte = i as u8;
            }
            message.is_dense = true;
            let read = PointCloud2::deserialize(&message.serialize()).unwrap();
            assert_eq!(read, message);
            assert_eq!(read.stamp(), 12_345_678_901_234);
        }
    }

    #[test]
    fn truncated_message_is_rejected() {
        let bytes = PointCloud2::with_data_bytes(64).serialize();
        for n_bytes in 0..bytes.len() {
            assert_eq!(PointCloud2::deserialize(&bytes[..n_bytes]), None);
        }
    }

    #[test]
    fn wrong_number_of_fields_is_rejected() {
        let mut message = PointCloud2::with_data_bytes(0);
        message.frame_id.clear();
        let mut bytes = message.serialize();
        let n_fields_at = 4 + 8 + 8 + 8;
        assert_eq!(bytes[n_fields_at], 4);
        bytes[n_fields_at..][..4].fill(255);
        assert_eq!(PointCloud2::deserialize(&bytes), None);
    }
}
