//! Arguments of `tabula forget`, `tabula memory` and `tabula knowledge`.

use clap::{Args, Subcommand};
use control_client::TrackReference;
use std::path::PathBuf;

/// Arguments of `tabula forget`.
#[derive(Debug, Args)]
#[group(id = "what", required = true, multiple = true)]
pub(crate) struct ForgetArguments {
    /// Category to forget
    #[arg(group = "what", conflicts_with_all = ["track", "view"])]
    pub(crate) category: Option<String>,
    /// Track to forget, by its track-id, or words that mean exactly one object: its views are
    /// excluded from recognition and teaching
    #[arg(long, value_name = "TRACK", group = "what")]
    pub(crate) track: Option<TrackReference>,
    /// With --track: forget only this view
    #[arg(long, value_name = "VIEW", requires = "track")]
    pub(crate) view: Option<u32>,
    /// Author of the change [default: the user's name]
    #[arg(long, value_name = "NAME")]
    pub(crate) author: Option<String>,
}

/// Subcommands of `tabula memory`. They query a running daemon; without one a child process opens
/// the store.
#[derive(Debug, Subcommand)]
pub(crate) enum MemoryVerb {
    /// Show sizes and counts of the perceptual memory
    Stats,
    /// Read all records and report damage; changes nothing
    Verify,
    /// Verify, and if anything is damaged rebuild the store from the intact records
    Repair,
    /// List stored views with the authors of their labels
    Inspect(InspectArguments),
    /// Show the history of changes with times and authors
    History(EntriesArguments),
    /// Delete forgotten views permanently and free disk space
    Compact(CompactArguments),
    /// Export the whole memory to one file
    Export {
        /// File to write; an existing file is replaced atomically when the export is complete
        file: PathBuf,
    },
    /// Import the export file of another memory
    Import(ImportArguments),
}

/// Filter options of `tabula memory inspect`.
#[derive(Debug, Args)]
pub(crate) struct InspectArguments {
    /// Only views of this category
    #[arg(long, value_name = "NAME", conflicts_with = "track")]
    pub(crate) category: Option<String>,
    /// Only views of this track: its track-id, or words that mean exactly one object
    #[arg(long, value_name = "TRACK")]
    pub(crate) track: Option<TrackReference>,
}

/// Entry range of `tabula memory history`.
#[derive(Debug, Args)]
pub(crate) struct EntriesArguments {
    /// Number of the first entry [default: such that the last entries are shown]
    #[arg(long, value_name = "ENTRY")]
    pub(crate) from: Option<u64>,
    /// Maximum number of entries
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) count: u32,
}

/// Arguments of `tabula memory compact`.
#[derive(Debug, Args)]
pub(crate) struct CompactArguments {
    /// Delete views permanently that were forgotten at least this many days ago
    #[arg(long, value_name = "DAYS", default_value_t = 30)]
    pub(crate) forgotten_days: u32,
}

/// Arguments of `tabula memory import`.
#[derive(Debug, Args)]
pub(crate) struct ImportArguments {
    /// Export file written by `tabula memory export`
    pub(crate) file: PathBuf,
    /// Rename a category on import; can be given several times
    #[arg(long, value_name = "FROM=TO")]
    pub(crate) rename: Vec<String>,
    /// Prefix for every other category, so that equal names stay separate
    #[arg(long, value_name = "TEXT", default_value = "")]
    pub(crate) prefix: String,
    /// Make new categories, even beside ones whose names look alike
    #[arg(long = "new")]
    pub(crate) is_new: bool,
    /// Give decisions from more than a day ahead of this robot's clock the present time [default:
    /// they are left out, and told]
    #[arg(long)]
    pub(crate) restamp: bool,
    /// Author of the change [default: the user's name]
    #[arg(long, value_name = "NAME")]
    pub(crate) author: Option<String>,
}

/// Subcommands of `tabula knowledge`.
#[derive(Debug, Subcommand)]
pub(crate) enum KnowledgeVerb {
    /// List the stored documents
    List,
    /// Write a document to standard output
    Get {
        /// Name of the document
        name: String,
    },
    /// Store a document; replaces one of the same name
    Put(PutArguments),
    /// Remove a document
    Remove {
        /// Name of the document
        name: String,
        /// Author of the change [default: the user's name]
        #[arg(long, value_name = "NAME")]
        author: Option<String>,
    },
}

/// Arguments of `tabula knowledge put`.
#[derive(Debug, Args)]
pub(crate) struct PutArguments {
    /// Name of the document
    pub(crate) name: String,
    /// File with the content [default: standard input]
    pub(crate) file: Option<PathBuf>,
    /// Media type of the document
    #[arg(long = "type", value_name = "MEDIA/TYPE", default_value = "text/plain")]
    pub(crate) media_type: String,
    /// Author of the change [default: the user's name]
    #[arg(long, value_name = "NAME")]
    pub(crate) author: Option<String>,
}
