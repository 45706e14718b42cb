//! `tabula-perception`.

use std::process::ExitCode;

fn main() -> ExitCode {
    perception::main()
}
