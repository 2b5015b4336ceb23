//! Damaged and hostile files: no reader panics, and none takes memory that the size of its file does not justify.
#![allow(clippy::unwrap_used, reason = "a test")]
#![allow(unsafe_code, reason = "counts what is allocated")]

mod python;

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::{Cursor, Read, Write};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use froude_foreign::sheet::Workbook;
use froude_foreign::{ForeignError, hdf5, mat5};
use python::python;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Bytes that are allocated now, and the most that were.
static NOW: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

struct Counting;

// SAFETY: all calls are those of the system's allocator, with the arguments that it was given.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        PEAK.fetch_max(NOW.fetch_add(layout.size(), Relaxed) + layout.size(), Relaxed);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        NOW.fetch_sub(layout.size(), Relaxed);
        unsafe { System.dealloc(at, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Memory that reading a file of some kilobytes may take; a sheet announces up to a few hundred MB of cells before it has any.
const MAX_PEAK_BYTES: usize = 1 << 30;
/// Mutants of each file.
const N_MUTANTS: usize = 2000;

/// Changes some bytes, or repeats, swaps or cuts off a part.
fn mutate(bytes: &mut Vec<u8>, random: &mut Pcg64Mcg) {
    for _ in 0..random.random_range(1..=4) {
        if bytes.is_empty() {
            return;
        }
        let at = random.random_range(0..bytes.len());
        match random.random_range(0..10) {
            0 => bytes.truncate(at),
            1 => {
                let end = (at + random.random_range(1..64)).min(bytes.len());
                let part = bytes[at..end].to_vec();
                let to = random.random_range(0..=bytes.len());
                bytes.splice(to..to, part);
            }
            2 => bytes[at] = [0, 1, 0x7F, 0x80, 0xFF][random.random_range(0..5)],
            3 => {
                let value: u32 = [0, 1, 0xFFFF, 0x7FFF_FFFF, u32::MAX][random.random_range(0..5)];
                for (byte, new) in bytes[at..].iter_mut().zip(value.to_le_bytes()) {
                    *byte = new;
                }
            }
            4 if bytes[at].is_ascii_digit() => {
                bytes.splice(at..at, *b"9999999");
            }
            _ => bytes[at] ^= 1 << random.random_range(0..8),
        }
    }
}

/// Reads mutants of a file, and asserts that no error is an empty one and that memory stays bounded.
fn attack(
    name: &str,
    bytes: &[u8],
    mutate: impl Fn(&[u8], &mut Pcg64Mcg) -> Vec<u8>,
    read: impl Fn(&[u8]) -> Result<(), ForeignError>,
) {
    assert_eq!(read(bytes), Ok(()), "{name} as it was written");
    let mut random = Pcg64Mcg::seed_from_u64(46);
    let mut n_errors = 0;
    for i in 0..N_MUTANTS {
        let mutant = mutate(bytes, &mut random);
        PEAK.store(NOW.load(Relaxed), Relaxed);
        let before = NOW.load(Relaxed);
        if let Err(error) = read(&mutant) {
            n_errors += 1;
            assert!(error.0.len() > 20, "{name}, mutant {i}: {error}");
        }
        let peak = PEAK.load(Relaxed).saturating_sub(before);
        assert!(peak < MAX_PEAK_BYTES, "{name}, mutant {i}: {} MB", peak >> 20);
    }
    println!("{name}: {n_errors} of {N_MUTANTS} mutants are rejected");
}

/// A mutant of a file as it is.
fn plain(bytes: &[u8], random: &mut Pcg64Mcg) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    mutate(&mut bytes, random);
    bytes
}

/// A zip file with a mutant of one of its parts, so that the mutation is not found out by a checksum.
fn inside(bytes: &[u8], random: &mut Pcg64Mcg) -> Vec<u8> {
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
    let chosen = random.random_range(0..archive.len());
    let mut out = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for index in 0..archive.len() {
        let mut part = archive.by_index(index).unwrap();
        let mut text = Vec::new();
        part.read_to_end(&mut text).unwrap();
        if index == chosen {
            mutate(&mut text, random);
        }
        let name = part.name().unwrap().into_owned();
        out.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        out.write_all(&text).unwrap();
    }
    out.finish().unwrap().into_inner()
}

fn read_workbook(bytes: &[u8]) -> Result<(), ForeignError> {
    let mut book = Workbook::open(bytes)?;
    let names: Vec<String> = book.sheets().iter().map(|sheet| sheet.name.clone()).collect();
    names.iter().try_for_each(|name| book.sheet(name, None).map(drop))
}

fn written(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap()
}

#[test]
fn mutated_files_neither_panic_nor_fill_the_memory() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    python(folder, include_str!("seeds.py"));
    for name in ["t.xlsx", "small.xlsx", "t.ods"] {
        attack(name, &written(folder, name), plain, read_workbook);
        attack(&format!("{name}, inside"), &written(folder, name), inside, read_workbook);
    }
    for name in ["t.xls", "small.xls"] {
        attack(name, &written(folder, name), plain, read_workbook);
    }
    for name in ["t.mat", "packed.mat", "small-packed.mat"] {
        attack(name, &written(folder, name), plain, |bytes| mat5::read(bytes).map(drop));
    }
    for name in ["old.h5", "new.h5", "small.h5", "matlab.h5"] {
        attack(name, &written(folder, name), plain, |bytes| hdf5::read(bytes.to_vec()).map(drop));
    }
}
