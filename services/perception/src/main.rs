//! `tabula-perception`: the perception service.

use std::process::ExitCode;

fn main() -> ExitCode {
    perception::main()
}
