//! The command line and JSON output that the examples share.
