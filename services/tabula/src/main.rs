//! The command line: starts the daemon, shows its objects, teaches and asks.

fn main() {}
