//! `tabula-perception-faulty`: the same, with actors that panic when told to, for
//! tests of the supervision.

use std::process::ExitCode;

fn main() -> ExitCode {
    perception::main()
}
