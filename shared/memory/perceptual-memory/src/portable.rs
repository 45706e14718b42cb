//! Export file format: a memory as one file, for backup and exchange between robots.
//!
//! ```text
//! "TABULA MEMORY 1\n"
//! frames: kind, one byte; length of the body, u32; CRC-32 of kind, length and body, u32; body, CBOR
//!     V  view: metadata, descriptor, point cloud, label status, decision stamp
//!     F  forgotten view: content digest, decision stamp
//!     D  document
//!     E  end: number of frames of each kind, and the digest of all preceding bytes
//! ```
//!
//! Numbers are little-endian. Frames are ordered by content digest and document key, so that equal
//! memories give equal files.

use std::io::{self, Read, Write};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_bytes::ByteBuf;

use crate::digest::{Digest, Hasher};
use crate::document::MemoryDocument;
use crate::document_key::DocumentKey;
use crate::exchange::{ForeignDocument, ForeignView};
use crate::label_status::{DecisionStamp, LabelStatus};
use crate::mutation::{MAX_BATCH_BYTES, MAX_BATCH_VIEWS};
use crate::view_record::{ViewMetadata, ViewParts};

const MAGIC: &[u8; 16] = b"TABULA MEMORY 1\n";
/// Common prefix of all versions of the format.
const MAGIC_OF_ALL: &[u8; 14] = b"TABULA MEMORY ";
const FRAME_HEADER_BYTES: usize = 9;
/// Maximum length of a frame body, bytes; larger than any view or document.
const MAX_BODY_BYTES: usize = 40 << 20;

const VIEW: u8 = b'V';
const FORGOTTEN: u8 = b'F';
const DOCUMENT: u8 = b'D';
const END: u8 = b'E';

#[derive(Serialize, Deserialize)]
struct ViewBody {
    #[serde(rename = "facts")]
    metadata: ViewMetadata,
    descriptor: ByteBuf,
    points: Option<ByteBuf>,
    standing: LabelStatus,
    decided: Option<DecisionStamp>,
}

#[derive(Serialize, Deserialize)]
struct ForgottenBody {
    identity: Digest,
    decided: DecisionStamp,
}

#[derive(Serialize, Deserialize)]
struct DocumentBody {
    key: DocumentKey,
    media_type: Option<String>,
    content: Option<ByteBuf>,
    decided: DecisionStamp,
}

/// Number of frames of each kind in an export file.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PortableCounts {
    /// Number of exported views with content.
    pub n_views: u64,
    /// Number of forgotten views, of which only the digest is known.
    pub n_forgotten: u64,
    /// Number of exported documents, including removed ones.
    pub n_documents: u64,
}

#[derive(Serialize, Deserialize)]
struct EndBody {
    counts: PortableCounts,
    digest: Digest,
}

/// Error of reading an exported memory.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PortableError {
    /// Failed read or write of the operating system.
    #[error("{0}")]
    Io(io::Error),
    /// File that is not an export of tabula.
    #[error("it is no exported memory; export one with: tabula memory export FILE")]
    NotAnExport,
    /// Export file of a newer format version.
    #[error("it was exported by a newer version of this program; update this one")]
    Newer,
    /// Truncated or corrupted export file.
    #[error("it is damaged at byte {offset}: {reason}; nothing was imported, export it again")]
    Damaged {
        /// Offset of the corruption, bytes from the beginning.
        offset: u64,
        /// Format rule that the export file violates.
        reason: &'static str,
    },
}

impl From<io::Error> for PortableError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

/// Writer of an export file.
pub struct PortableWriter<W> {
    to: W,
    hasher: Hasher,
    counts: PortableCounts,
}

impl<W: Write> PortableWriter<W> {
    /// Writes the header of the export file.
    ///
    /// # Errors
    ///
    /// When it cannot be written.
    pub fn new(to: W) -> io::Result<Self> {
        let mut writer = Self {
            to,
            hasher: Hasher::new(b""),
            counts: PortableCounts::default(),
        };
        writer.write(MAGIC)?;
        Ok(writer)
    }

    /// Writes a view as a frame of the export file.
    ///
    /// # Errors
    ///
    /// When it cannot be written.
    pub fn view(&mut self, view: &ForeignView) -> io::Result<()> {
        match view {
            ForeignView::Present {
                view,
                origin,
                standing,
                decided,
            } => {
                let parts = ViewParts::of(view, *origin);
                let body = ViewBody {
                    metadata: parts.metadata,
                    descriptor: ByteBuf::from(parts.descriptor),
                    points: parts.points.map(ByteBuf::from),
                    standing: standing.clone(),
                    decided: decided.clone(),
                };
                self.counts.n_views += 1;
                self.frame(VIEW, &body)
            }
            ForeignView::Forgotten { identity, decided } => {
                let body = ForgottenBody {
                    identity: *identity,
                    decided: decided.clone(),
                };
                self.counts.n_forgotten += 1;
                self.frame(FORGOTTEN, &body)
            }
        }
    }

    /// Writes a document as a frame of the export file.
    ///
    /// # Errors
    ///
    /// When it cannot be written.
    pub fn document(&mut self, document: &ForeignDocument) -> io::Result<()> {
        let ForeignDocument {
            key,
            document,
            decided,
        } = document;
        let content = document.as_ref();
        let body = DocumentBody {
            key: key.clone(),
            media_type: content.map(|document| document.media_type.clone()),
            content: content.map(|document| ByteBuf::from(document.content.clone())),
            decided: decided.clone(),
        };
        self.counts.n_documents += 1;
        self.frame(DOCUMENT, &body)
    }

    /// Writes the end frame, without which the file is invalid.
    ///
    /// # Errors
    ///
    /// When it cannot be written.
    pub fn end(mut self) -> io::Result<PortableCounts> {
        let body = EndBody {
            counts: self.counts,
            digest: self.hasher.finish(),
        };
        self.frame(END, &body)?;
        self.to.flush()?;
        Ok(self.counts)
    }

    fn frame<T: Serialize>(&mut self, kind: u8, body: &T) -> io::Result<()> {
        let mut bytes = Vec::new();
        ciborium::into_writer(body, &mut bytes).map_err(io::Error::other)?;
        let mut header = [kind; FRAME_HEADER_BYTES];
        header[1..5].copy_from_slice(&(bytes.len() as u32).to_le_bytes());
        let checksum = checksum(&header[..5], &bytes);
        header[5..].copy_from_slice(&checksum.to_le_bytes());
        self.write(&header)?;
        self.write(&bytes)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.hasher.add(bytes);
        self.to.write_all(bytes)
    }
}

fn checksum(header: &[u8], body: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(header);
    hasher.update(body);
    hasher.finalize()
}

/// Views and documents that fit into one import mutation.
#[derive(Debug, Default, PartialEq)]
pub struct PortableBatch {
    /// Views of the batch.
    pub views: Vec<ForeignView>,
    /// Documents of the batch.
    pub documents: Vec<ForeignDocument>,
}

/// Reader of an export file. Frames before the end frame may belong to a damaged file: read the
/// file completely once before importing any of it.
pub struct PortableReader<R> {
    from: R,
    hasher: Hasher,
    offset: u64,
    counts: PortableCounts,
    is_ended: bool,
}

enum PortableItem {
    View(ForeignView),
    Document(ForeignDocument),
}

impl<R: Read> PortableReader<R> {
    /// Reads the header of the export file.
    ///
    /// # Errors
    ///
    /// When it is that of no exported memory.
    pub fn new(mut from: R) -> Result<Self, PortableError> {
        let mut magic = [0; MAGIC.len()];
        let is_whole = read_whole(&mut from, &mut magic)?;
        if !is_whole || &magic != MAGIC {
            let is_any = magic.starts_with(MAGIC_OF_ALL);
            return Err(if is_any {
                PortableError::Newer
            } else {
                PortableError::NotAnExport
            });
        }
        let mut hasher = Hasher::new(b"");
        hasher.add(&magic);
        Ok(Self {
            from,
            hasher,
            offset: MAGIC.len() as u64,
            counts: PortableCounts::default(),
            is_ended: false,
        })
    }

    /// Number of bytes read from the export file.
    pub fn n_bytes_read(&self) -> u64 {
        self.offset
    }

    /// Number of frames read from the export file, by kind.
    pub fn counts(&self) -> PortableCounts {
        self.counts
    }

    /// Next batch of views and documents; `None` at the end.
    ///
    /// # Errors
    ///
    /// When the file is damaged or cannot be read.
    pub fn batch(&mut self) -> Result<Option<PortableBatch>, PortableError> {
        let mut batch = PortableBatch::default();
        let mut n_bytes = 0;
        while batch.views.len() + batch.documents.len() < MAX_BATCH_VIEWS
            && n_bytes < MAX_BATCH_BYTES / 4
        {
            match self.item()? {
                Some(PortableItem::View(view)) => {
                    n_bytes += view.n_large_bytes();
                    batch.views.push(view);
                }
                Some(PortableItem::Document(document)) => {
                    n_bytes += document.n_bytes();
                    batch.documents.push(document);
                }
                None => break,
            }
        }
        Ok((batch != PortableBatch::default()).then_some(batch))
    }

    fn item(&mut self) -> Result<Option<PortableItem>, PortableError> {
        if self.is_ended {
            return Ok(None);
        }
        let start = self.offset;
        let damaged = |reason| PortableError::Damaged {
            offset: start,
            reason,
        };
        let digest = self.hasher.finish();
        let (kind, body) = self.frame()?;
        match kind {
            VIEW => {
                self.counts.n_views += 1;
                let view = view_of(decode(&body).map_err(damaged)?).map_err(damaged)?;
                Ok(Some(PortableItem::View(view)))
            }
            FORGOTTEN => {
                self.counts.n_forgotten += 1;
                let ForgottenBody { identity, decided } = decode(&body).map_err(damaged)?;
                Ok(Some(PortableItem::View(ForeignView::Forgotten {
                    identity,
                    decided,
                })))
            }
            DOCUMENT => {
                self.counts.n_documents += 1;
                let document = document_of(decode(&body).map_err(damaged)?).map_err(damaged)?;
                Ok(Some(PortableItem::Document(document)))
            }
            END => {
                let end: EndBody = decode(&body).map_err(damaged)?;
                if end.digest != digest || end.counts != self.counts {
                    return Err(damaged("a part of it is missing or was put in"));
                }
                let mut one = [0];
                if read_whole(&mut self.from, &mut one)? {
                    return Err(damaged("something follows its end"));
                }
                self.is_ended = true;
                Ok(None)
            }
            _ => Err(damaged("it has a part of an unknown kind")),
        }
    }

    /// Kind and body of the next frame.
    fn frame(&mut self) -> Result<(u8, Vec<u8>), PortableError> {
        let start = self.offset;
        let damaged = |reason| PortableError::Damaged {
            offset: start,
            reason,
        };
        let mut header = [0; FRAME_HEADER_BYTES];
        if !read_whole(&mut self.from, &mut header)? {
            return Err(damaged("it ends too early"));
        }
        let [kind, a, b, c, d, e, f, g, h] = header;
        let n_bytes = u32::from_le_bytes([a, b, c, d]) as usize;
        if n_bytes > MAX_BODY_BYTES {
            return Err(damaged("a part of it is longer than any can be"));
        }
        // Grows with the available bytes, whatever length the file claims.
        let mut body = Vec::new();
        (&mut self.from)
            .take(n_bytes as u64)
            .read_to_end(&mut body)?;
        if body.len() != n_bytes {
            return Err(damaged("it ends too early"));
        }
        if checksum(&header[..5], &body) != u32::from_le_bytes([e, f, g, h]) {
            return Err(damaged("a checksum is wrong"));
        }
        self.hasher.add(&header);
        self.hasher.add(&body);
        self.offset += (FRAME_HEADER_BYTES + n_bytes) as u64;
        Ok((kind, body))
    }
}

/// Fills `bytes` from the file; `false` at its end.
fn read_whole(from: &mut impl Read, bytes: &mut [u8]) -> io::Result<bool> {
    match from.read_exact(bytes) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => Ok(false),
        Err(error) => Err(error),
    }
}

fn decode<T: DeserializeOwned>(body: &[u8]) -> Result<T, &'static str> {
    ciborium::from_reader(body).map_err(|_| "its fields cannot be read")
}

fn view_of(body: ViewBody) -> Result<ForeignView, &'static str> {
    let parts = ViewParts {
        metadata: body.metadata,
        descriptor: body.descriptor.into_vec(),
        points: body.points.map(ByteBuf::into_vec),
    };
    if !parts.is_what_it_says() || !parts.descriptor.len().is_multiple_of(size_of::<f32>()) {
        return Err("the content of a view does not match its digest");
    }
    if body.standing == LabelStatus::Forgotten {
        return Err("a forgotten view has content");
    }
    let origin = parts.metadata.origin();
    let view = parts.into_view(origin.view);
    view.check()
        .map_err(|_| "a view has values that none can have")?;
    Ok(ForeignView::Present {
        view: Box::new(view),
        origin,
        standing: body.standing,
        decided: body.decided,
    })
}

fn document_of(body: DocumentBody) -> Result<ForeignDocument, &'static str> {
    let DocumentBody {
        key,
        media_type,
        content,
        decided,
    } = body;
    let document = match (media_type, content) {
        (Some(media_type), Some(content)) => Some(MemoryDocument {
            key: key.clone(),
            media_type,
            content: content.into_vec(),
        }),
        (None, None) => None,
        _ => return Err("a document has a type and no content, or the other way round"),
    };
    let foreign = ForeignDocument {
        key,
        document,
        decided,
    };
    // The time stamp is compared with the clock by the import.
    foreign
        .check(foreign.decided.stamp_ns)
        .map_err(|_| "a document has values that none can have")?;
    Ok(foreign)
}
