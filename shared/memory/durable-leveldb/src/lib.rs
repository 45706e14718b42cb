//! Durable LevelDB: a log with real syncs, verified reads and reported errors over rusty-leveldb,
//! which works in a thread of its own, and readers that recover the intact records of damaged files.
//!
//! Invariants:
//!
//! - A synced batch is on disk when [`Database::write`] returns, whole or not at all, also after a
//!   power cut.
//! - Corruption is never returned as data, nor as a missing key: every block and every log record
//!   is verified while it is read, and the corruption is reported.
//! - After a failed write or a detected corruption nothing in the folder is changed any more.
//! - One failed read is no damage: it is tried again through another descriptor.
//! - A damaged database is renamed, and a rebuilt copy replaces it atomically. The two newest
//!   damaged ones are kept.
//! - A [`StoreFolder`] is open in one process at a time.
//! - Neither a write nor a read waits for the making of tables and their compaction, unless a writer
//!   is faster than these for long.
//!
//! The files are those of LevelDB, in both directions, but for the log: its format is LevelDB's, its
//! name is not, and a database that is [closed](Database::close) has none. The crate knows nothing of the content of
//! the records except their [framing](record). It reads no clock and writes no log.
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let folder = tempfile::tempdir()?;
//! use durable_leveldb::{StoreFolder, WriteBatch, record};
//!
//! let folder = StoreFolder::hold(folder.path())?;
//! let mut database = folder.open_database()?;
//! database.accept()?; // Nothing is damaged.
//!
//! let mut batch = WriteBatch::default();
//! batch.put(b"cup", &record::seal(b"cup", &"on the table"));
//! database.write(batch, true)?;
//!
//! let found = database.reader().get(b"cup")?.ok_or("it was written")?;
//! assert_eq!(record::unseal::<String>(b"cup", &found)?, "on the table");
//! // The checksum covers the key too.
//! assert!(record::unseal::<String>(b"mug", &found).is_err());
//! database.close()?;
//! # Ok(())
//! # }
//! ```

mod block;
mod crc32c;
mod database;
mod durable_env;
mod durable_file;
mod engine;
mod env_health;
mod error;
mod log_file;
mod manifest;
mod memtable;
mod mutation_id;
mod raw_database;
mod raw_log;
mod raw_table;
mod read_retry;
mod reader;
mod store_folder;
mod synced_file;
mod table;
mod table_cursor;
mod verified_files;
mod write_batch;

pub mod record;

pub use database::{Database, WRITE_BUFFER_BYTES};
pub use durable_file::DurableFile;
pub use env_health::{FileOperation, Observer};
pub use error::{Error, StorageFailure};
pub use mutation_id::{MutationId, random_id};
pub use raw_database::RawDatabase;
pub use reader::Reader;
pub use store_folder::{MAX_DAMAGED, StoreFolder};
pub use write_batch::WriteBatch;
