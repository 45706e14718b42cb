//! Command-line support: answers as text or JSON, tables, progress bars, stop
//! signals.
//!
//! A program prints through one [`Output`] only: answers on standard output, status
//! messages where they disturb no script. What cannot be written is a failure of the program.
//!
//! ```
//! let rows = [vec!["7".to_owned(), "mug".to_owned()]];
//! let text = command_line::format_table(&["id", "label"], &rows);
//! assert_eq!(text, "id  label\n7   mug");
//! ```

mod output;
mod progress;
mod reader_watch;
mod stop_signal;
mod table;

pub use output::Output;
pub use progress::progress_bar;
pub use stop_signal::{HangUps, StopSignal};
pub use table::format_table;
