//! Storage engine: a durable, verified LevelDB with its folder, record format and recovery
//! readers. Depends on nothing else in this crate.

pub(crate) mod crc32c;
pub(crate) mod database;
pub(crate) mod durable_env;
pub(crate) mod env_health;
pub(crate) mod raw_database;
pub(crate) mod raw_log;
pub(crate) mod raw_table;
pub(crate) mod record;
pub(crate) mod storage_error;
pub(crate) mod store_folder;
pub(crate) mod verified_files;
