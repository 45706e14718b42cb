//! `tabula-perception-faulty`: the perception service with fault injection, for tests of
//! the supervision.

use std::process::ExitCode;

fn main() -> ExitCode {
    perception::main()
}
