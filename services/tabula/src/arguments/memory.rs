//! What is said about the memory.

use clap::{Args, Subcommand};
use std::path::PathBuf;

/// What is to be forgotten.
#[derive(Debug, Args)]
#[group(id = "what", required = true, multiple = true)]
pub(crate) struct ForgetArguments {
    /// The category
    #[arg(group = "what", conflicts_with_all = ["track", "view"])]
    pub(crate) category: Option<String>,
    /// A track: its views are neither recognised nor taught any more
    #[arg(long, value_name = "TRACK", group = "what")]
    pub(crate) track: Option<u64>,
    /// With --track: only this view of it
    #[arg(long, value_name = "VIEW", requires = "track")]
    pub(crate) view: Option<u32>,
    /// Who asks [default: the user's name]
    #[arg(long, value_name = "NAME")]
    pub(crate) author: Option<String>,
}

/// What is done with the memory. A running daemon is asked; without one the store is
/// opened here.
#[derive(Debug, Subcommand)]
pub(crate) enum MemoryVerb {
    /// How much there is
    Stats,
    /// Read everything and say what is wrong; changes nothing
    Verify,
    /// Verify, and if anything is wrong make the store anew from what is whole
    Repair,
    /// List stored views, and who taught them
    Inspect(InspectArguments),
    /// What was changed, when, and by whom
    History(EntriesArguments),
    /// Remove for good what was forgotten, and give room back
    Compact(CompactArguments),
    /// Write everything into one file
    Export {
        /// The file; one that is there is replaced when all is written
        file: PathBuf,
    },
    /// Take over what another memory knows
    Import(ImportArguments),
}

/// Which views.
#[derive(Debug, Args)]
pub(crate) struct InspectArguments {
    /// Only those of a category
    #[arg(long, value_name = "NAME", conflicts_with = "track")]
    pub(crate) category: Option<String>,
    /// Only those of a track
    #[arg(long, value_name = "TRACK")]
    pub(crate) track: Option<u64>,
}

/// Which entries.
#[derive(Debug, Args)]
pub(crate) struct EntriesArguments {
    /// First entry [default: so that the last ones are shown]
    #[arg(long, value_name = "ENTRY")]
    pub(crate) from: Option<u64>,
    /// How many
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) count: u32,
}

/// What may go.
#[derive(Debug, Args)]
pub(crate) struct CompactArguments {
    /// Remove for good what was forgotten this many days ago
    #[arg(long, value_name = "DAYS", default_value_t = 30)]
    pub(crate) forgotten_days: u32,
}

/// What is imported, and under which names.
#[derive(Debug, Args)]
pub(crate) struct ImportArguments {
    /// The file, written by `tabula memory export`
    pub(crate) file: PathBuf,
    /// Call a category otherwise here; can be given several times
    #[arg(long, value_name = "FROM=TO")]
    pub(crate) rename: Vec<String>,
    /// Put this before every other category, so that equal names stay apart
    #[arg(long, value_name = "TEXT", default_value = "")]
    pub(crate) prefix: String,
    /// Who asks [default: the user's name]
    #[arg(long, value_name = "NAME")]
    pub(crate) author: Option<String>,
}

/// What is done with task knowledge.
#[derive(Debug, Subcommand)]
pub(crate) enum KnowledgeVerb {
    /// List it
    List,
    /// Write it to standard output
    Get {
        /// Its name
        name: String,
    },
    /// Store it, instead of what has this name
    Put(PutArguments),
    /// Remove it
    Remove {
        /// Its name
        name: String,
        /// Who asks [default: the user's name]
        #[arg(long, value_name = "NAME")]
        author: Option<String>,
    },
}

/// What is stored.
#[derive(Debug, Args)]
pub(crate) struct PutArguments {
    /// Its name
    pub(crate) name: String,
    /// A file [default: standard input]
    pub(crate) file: Option<PathBuf>,
    /// How to read it
    #[arg(long = "type", value_name = "MEDIA/TYPE", default_value = "text/plain")]
    pub(crate) media_type: String,
    /// Who asks [default: the user's name]
    #[arg(long, value_name = "NAME")]
    pub(crate) author: Option<String>,
}
