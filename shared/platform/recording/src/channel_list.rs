//! Channels of a recording: topic, schema and encoding of each.

use scene_document::{Document, schema};

/// Encoding of a channel's messages, as named in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MessageEncoding {
    /// Frames of this format.
    Frame,
    /// JSON documents with a JSON schema.
    Json,
    /// Protocol buffers with a file descriptor set.
    Protobuf,
}

impl MessageEncoding {
    /// Names of the message encoding and of the schema encoding in the file.
    fn names(self) -> [&'static str; 2] {
        match self {
            Self::Frame => ["tabula-frame", "text/markdown"],
            Self::Json => ["json", "jsonschema"],
            Self::Protobuf => ["protobuf", "protobuf"],
        }
    }

    /// Name of the message encoding in the file.
    pub fn message_name(self) -> &'static str {
        self.names()[0]
    }

    /// Name of the schema encoding in the file.
    pub fn schema_name(self) -> &'static str {
        self.names()[1]
    }
}

/// Definition of a channel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChannelSpec {
    /// Topic of the channel.
    pub topic: String,
    /// Name of the schema.
    pub schema_name: String,
    /// Schema in its encoding.
    pub schema: Vec<u8>,
    /// Encoding of messages and schema.
    pub encoding: MessageEncoding,
}

impl ChannelSpec {
    /// Channel of JSON documents.
    pub fn json<D: Document>(topic: &str) -> Self {
        Self {
            topic: topic.to_owned(),
            schema_name: D::NAME.to_owned(),
            schema: schema::<D>().as_value().to_string().into_bytes(),
            encoding: MessageEncoding::Json,
        }
    }

    /// Channel of protocol buffers with a serialised file descriptor set.
    pub fn protobuf(topic: &str, schema_name: &str, descriptor_set: Vec<u8>) -> Self {
        Self {
            topic: topic.to_owned(),
            schema_name: schema_name.to_owned(),
            schema: descriptor_set,
            encoding: MessageEncoding::Protobuf,
        }
    }
}

/// Layout of a frame, for readers of the file.
const FRAME_LAYOUT: &str = "\
Frame of an organised point cloud. Numbers are little-endian.

u32 version = 1
u32 flags: 1 lockstep, 2 world_from_camera is valid, 4 up_in_camera is valid, 8 calibrated
u64 session, sequence, source_frame
u64 capture_stamp_ns, scheduled_stamp_ns, published_stamp_ns
i64 wall_clock_offset_ns
f64[4] fx, fy, cx, cy in pixels
f64[12] world_from_camera, 3 x 4, row by row, metres
f64[3] up_in_camera
u32 width, height
u32 length of source_name, then its bytes in UTF-8
u32 planes: 1 planes of x follow, 2 planes of y follow, 4 depth is a table
Then sequences of n = width * height 32-bit words, row by row. Planes are a sequence as its n
lowest bytes, the n bytes above these, and so on up to the n highest ones.
Depth z (IEEE 754, metres; NaN without depth): as planes; or with bit 4 a table and indices: u32
length, that many words, and the planes of n 16-bit indices into it.
Colour argb (alpha in the highest byte): planes, each byte of which is the difference, modulo 256,
from the byte before it in its plane.
x and y, if announced: planes. As 32-bit floats x and y are ((column - cx) / fx) * z and
((row - cy) / fy) * z, the quotient computed in 64 bits and rounded to 32; when z is not finite
they have the bits of z. The words of the planes are the exclusive or of their bits with these.
";

/// Channel of the frames.
pub fn frame_channel() -> ChannelSpec {
    ChannelSpec {
        topic: message::service_name::CAMERA_CLOUD.to_owned(),
        schema_name: "tabula.Frame".to_owned(),
        schema: FRAME_LAYOUT.as_bytes().to_vec(),
        encoding: MessageEncoding::Frame,
    }
}
