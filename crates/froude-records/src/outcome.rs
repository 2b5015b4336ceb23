//! What a verb returns: its blocks, what its checks found, and the files that it writes.
//!
//! A verb builds it once. Terminal, page, JSON and the writer of files know no verb.

use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::block::{Block, Schema, Tree, tree};
use crate::estimate::EstimateFile;
use crate::finding::Finding;
use crate::folder_lock::FolderLock;
use crate::page::Report;
use crate::table::Table;

/// What a verb returns.
#[derive(Debug, Default)]
pub struct Outcome {
    /// In order.
    pub blocks: Vec<Block>,
    /// Records that it made, which programs read instead of the blocks.
    pub records: Vec<EstimateFile>,
    /// The report on a record.
    pub report: Option<Box<Report>>,
    /// What its checks found; `None` for a verb that checks nothing.
    pub findings: Option<Vec<Finding>>,
    /// Files, in the order in which a person is told of them.
    pub files: Vec<OutputFile>,
    /// What the files were made from, piece by piece.
    pub scratch: Option<Scratch>,
    /// How the verb ended.
    pub exit: Exit,
}

/// How a verb ended that has an outcome.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Exit {
    /// As it was asked to.
    #[default]
    Done,
    /// With a part of its work undone, and why.
    Failed(String),
    /// It does not do what was asked, and why.
    Refused(String),
    /// It was stopped, and how it goes on.
    Stopped(String),
}

/// A folder with the pieces of a long work, which another start goes on from. It goes away when the files that they become are written.
#[derive(Debug)]
pub struct Scratch {
    /// The folder.
    pub folder: PathBuf,
    /// Held until then.
    pub lock: FolderLock,
}

/// A file that a verb writes.
#[derive(Debug, Clone, PartialEq)]
pub struct OutputFile {
    /// What it is, in a word: its name in JSON, and what people read before its path.
    pub key: &'static str,
    /// Where it lies.
    pub path: PathBuf,
    /// What is in it.
    pub content: Content,
}

/// What is in a file.
#[derive(Debug, Clone, PartialEq)]
pub enum Content {
    /// The blocks as one self-contained HTML file.
    Page(Head),
    /// The blocks as JSON.
    Result,
    /// The record.
    Record,
    /// The report as one self-contained HTML file.
    Report,
    /// A table, as the name of its file has it.
    Table(Table),
    /// A folder with each figure of the report, else of the blocks, as SVG.
    Figures,
    /// Bytes of a format of its own.
    Bytes(Vec<u8>),
}

/// The head of a page.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Head {
    /// What sort of page, above the title.
    pub sort: String,
    /// Title.
    pub title: String,
    /// Second line.
    pub subtitle: String,
    /// Heading of what stands before the first section.
    pub summary: String,
    /// Date as text.
    pub date: Option<String>,
}

/// Names of the files of a folder of figures.
#[must_use]
pub fn names_of_figures(blocks: &[Block]) -> Vec<String> {
    let of = |block: &Block| match block {
        Block::Chart(chart) => vec![format!("{}.svg", chart.name)],
        Block::Map(map) => vec![format!("{}.svg", map.name)],
        Block::Field(field) => vec![format!("{}.svg", field.name)],
        Block::Section(section) => names_of_figures(&section.blocks),
        Block::Text { .. } | Block::Table(_) | Block::Estimates(_) => Vec::new(),
    };
    blocks.iter().flat_map(of).collect()
}

/// An outcome as programs read it.
#[derive(Debug, Serialize)]
#[serde(untagged)]
pub enum Document<'a> {
    /// The record that it made.
    Record(&'a EstimateFile),
    /// Several.
    Records(&'a [EstimateFile]),
    /// Its blocks.
    Blocks(Tree<'a>),
}

impl Outcome {
    /// As a JSON document: its records where it made any, else its blocks.
    #[must_use]
    pub fn json(&self) -> Document<'_> {
        match &self.records[..] {
            [] => Document::Blocks(tree(self)),
            [one] => Document::Record(one),
            several => Document::Records(several),
        }
    }

    /// Its blocks as a JSON document.
    #[must_use]
    pub fn result(&self) -> Tree<'_> {
        tree(self)
    }

    /// The JSON Schema of its blocks.
    #[must_use]
    pub fn schema(&self) -> Schema {
        Schema::of(&tree(self))
    }

    /// The first file of a kind.
    #[must_use]
    pub fn path(&self, key: &str) -> Option<&Path> {
        self.files.iter().find(|file| file.key.trim_end_matches("[]") == key).map(|file| file.path.as_path())
    }
}
