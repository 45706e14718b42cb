//! Durable LevelDB: rusty-leveldb with real syncs, verified reads, reported errors, and readers
//! that recover the intact records of damaged files.
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
//!
//! The files are those of LevelDB, in both directions. The crate knows nothing of the content of
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
//! let found = database.reader()?.get(b"cup")?.ok_or("it was written")?;
//! assert_eq!(record::unseal::<String>(b"cup", &found)?, "on the table");
//! // The checksum covers the key too.
//! assert!(record::unseal::<String>(b"mug", &found).is_err());
//! database.close()?;
//! # Ok(())
//! # }
//! ```

mod crc32c;
mod database;
mod durable_env;
mod durable_file;
mod env_health;
mod error;
mod mutation_id;
mod raw_database;
mod raw_log;
mod raw_table;
mod read_retry;
mod store_folder;
mod verified_files;
mod volatile_copy;

pub mod record;

pub use database::{Database, Reader, WRITE_BUFFER_BYTES};
pub use durable_file::DurableFile;
pub use env_health::{FileOperation, Observer};
pub use error::{Error, StorageFailure};
pub use mutation_id::{MutationId, random_id};
pub use raw_database::RawDatabase;
pub use rusty_leveldb::WriteBatch;
pub use store_folder::{MAX_DAMAGED, StoreFolder};
pub use volatile_copy::VolatileCopy;
