//! `sensor_msgs/msg/PointCloud2` of ROS 2, field by field.

use crate::cdr::{Reader, Writer};

/// Number of `FLOAT32` and `UINT32` in `sensor_msgs/msg/PointField`.
const FLOAT32: u8 = 7;
const UINT32: u8 = 6;
/// Bytes of a message beside its data, with room.
const MOST_OTHER_BYTES: usize = 256;
const POINT_BYTES: u32 = 16;

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

#[derive(Debug, Clone, Default, PartialEq)]
pub struct PointField {
    pub name: String,
    pub offset: u32,
    pub datatype: u8,
    pub count: u32,
}

impl PointCloud2 {
    /// A row of points of x, y, z and colour, with all data zero.
    pub fn of_bytes(n_bytes: usize) -> Self {
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

    pub fn set_stamp(&mut self, stamp_ns: u64) {
        self.stamp_s = (stamp_ns / 1_000_000_000) as i32;
        self.stamp_ns = (stamp_ns % 1_000_000_000) as u32;
    }

    /// The stamp in nanoseconds.
    pub fn stamp(&self) -> u64 {
        self.stamp_s as u64 * 1_000_000_000 + u64::from(self.stamp_ns)
    }

    /// Into new bytes, as a middleware serialises: everything is copied.
    pub fn serialised(&self) -> Vec<u8> {
        let mut writer = Writer::with_capacity(self.data.len() + MOST_OTHER_BYTES);
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

    /// A new message of what was serialised; `None` when it is not whole.
    pub fn deserialised(bytes: &[u8]) -> Option<Self> {
        let mut reader = Reader::new(bytes)?;
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

fn read_fields(reader: &mut Reader<'_>) -> Option<Vec<PointField>> {
    let n_fields = reader.unsigned()?;
    // Collected one by one: a wrong number ends with the bytes, not with the memory.
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
    fn a_message_comes_back_as_it_was() {
        for n_bytes in [0, 64, 65_536] {
            let mut message = PointCloud2::of_bytes(n_bytes);
            message.set_stamp(12_345_678_901_234);
            for (i, byte) in message.data.iter_mut().enumerate() {
                *byte = i as u8;
            }
            message.is_dense = true;
            let read = PointCloud2::deserialised(&message.serialised()).unwrap();
            assert_eq!(read, message);
            assert_eq!(read.stamp(), 12_345_678_901_234);
        }
    }

    #[test]
    fn a_cut_message_is_none() {
        let bytes = PointCloud2::of_bytes(64).serialised();
        for n_bytes in 0..bytes.len() {
            assert_eq!(PointCloud2::deserialised(&bytes[..n_bytes]), None);
        }
    }

    #[test]
    fn a_wrong_number_of_fields_is_none() {
        let mut message = PointCloud2::of_bytes(0);
        message.frame_id.clear();
        let mut bytes = message.serialised();
        let n_fields_at = 4 + 8 + 8 + 8;
        assert_eq!(bytes[n_fields_at], 4);
        bytes[n_fields_at..][..4].fill(255);
        assert_eq!(PointCloud2::deserialised(&bytes), None);
    }
}
