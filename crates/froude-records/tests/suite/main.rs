//! Files that are read and written: tests of every format.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)]

mod bad_tables;
mod campaigns;
#[path = "../common/mod.rs"]
mod common;
#[cfg(unix)]
mod crash;
mod estimates;
mod foreign_tables;
mod imported_logs;
mod joined_logs;
mod laws;
mod official_reader;
mod parquet_tables;
mod parquet_types;
mod runs;
mod unit_spellings;
mod writing;
