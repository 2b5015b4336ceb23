//! What lies in files: units, campaigns, tables and estimates.
//!
//! One module per format. Every number in a file carries its unit; every error
//! names file, line, what was found and what was expected. No physics here.
//!
//! | file            | module                                     |
//! |-----------------|--------------------------------------------|
//! | campaign (TOML) | [`campaign`], read by [`campaign_file`]; sections of methods and of the carriage are read by the crates that use them |
//! | table           | [`table`], read and written by [`table_file`] |
//! | table (CSV)     | [`csv_table`], in memory; [`chunks`], some rows at a time |
//! | table (Parquet) | [`parquet_table`]                          |
//! | sidecar (TOML)  | [`sidecar`]                                |
//! | run (MCAP)      | [`run`]                                    |
//! | estimate (JSON) | [`mod@estimate`], [`json`], [`schema`]     |
//! | list of results (JSON) | [`manifest`]                            |
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod arrow_schema;
mod assemble;
pub mod block;
pub mod body;
mod body_axis;
pub mod campaign;
pub mod campaign_file;
pub mod campaign_keys;
mod checksum;
pub mod chunks;
pub mod comparison;
mod container_table;
pub mod convert;
pub mod csv_table;
pub mod declare;
pub mod document;
mod error;
pub mod estimate;
mod fast_csv;
pub mod file_words;
pub mod finding;
pub mod folder;
pub mod folder_lock;
mod foreign_names;
pub mod given_option;
pub mod guard;
pub mod hash;
mod heading;
pub mod join_keys;
pub mod json;
pub mod keep;
pub mod kind;
pub mod known_columns;
mod label_rows;
pub mod manifest;
pub mod measured;
pub mod memory;
pub mod nearest;
pub mod number;
mod obstacles;
pub mod outcome;
pub mod output;
pub mod page;
mod parquet_cells;
mod parquet_columns;
mod parquet_sums;
pub mod parquet_table;
mod parquet_types;
mod parquet_write;
pub mod plausible;
mod prior_record;
pub mod proposal;
pub mod question;
mod raw_column;
pub mod read;
mod reading;
mod records;
pub mod results;
pub mod run;
pub mod scale;
pub mod schema;
pub mod section;
pub mod section_values;
pub mod settle;
mod sheet_table;
pub mod sidecar;
pub mod sidecar_file;
pub mod starter;
pub mod table;
pub mod table_file;
pub mod text;
pub mod texts;
mod toml_text;
pub mod unfinished;
pub mod units;
pub mod write;

pub use error::{Place, Position, RecordError};
