//! Whole files or nothing.

use std::io::Write as _;
use std::path::Path;

use froude_records::hash::sha256_of_file;
use froude_records::write::{write_atomically, write_with};

fn names(folder: &Path) -> Vec<String> {
    std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect()
}

#[test]
fn a_writer_that_fails_half_way_leaves_the_old_file_and_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("estimate.json");
    write_atomically(&path, b"old").unwrap();
    let failed = write_with(&path, |file| {
        file.write_all(&vec![b'x'; 1 << 20])?;
        Err(std::io::Error::from(std::io::ErrorKind::StorageFull))
    });
    assert_eq!(
        failed.unwrap_err().to_string(),
        format!("cannot write {}: the disk is full; nothing was changed", path.display())
    );
    assert_eq!(std::fs::read(&path).unwrap(), b"old");
    assert_eq!(names(folder.path()), ["estimate.json"]);
}

/// The system's own "disk full", from the device that always is.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_called_full() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("estimate.json");
    let failed = write_with(&path, |_| {
        let mut full = std::fs::OpenOptions::new().write(true).open("/dev/full")?;
        full.write_all(b"x")
    });
    assert_eq!(
        failed.unwrap_err().to_string(),
        format!("cannot write {}: the disk is full; nothing was changed", path.display())
    );
    assert!(names(folder.path()).is_empty());
}

#[test]
fn folders_that_cannot_be_written_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("no/estimate.json");
    assert_eq!(
        write_atomically(&missing, b"x").unwrap_err().to_string(),
        format!("cannot write {}: its folder does not exist; nothing was changed", missing.display())
    );
    std::fs::write(folder.path().join("file"), b"").unwrap();
    let inside = folder.path().join("file/estimate.json");
    assert_eq!(
        write_atomically(&inside, b"x").unwrap_err().to_string(),
        format!("cannot write {}: its folder is not a folder; nothing was changed", inside.display())
    );
    assert_eq!(
        write_atomically(folder.path(), b"x").unwrap_err().to_string(),
        format!("cannot write {}: it is a folder; nothing was changed", folder.path().display())
    );
}

/// No one may write below /proc, not even the administrator, so this holds for every user.
#[cfg(target_os = "linux")]
#[test]
fn a_folder_without_permission_changes_nothing() {
    let path = Path::new("/proc/estimate.json");
    let message = write_atomically(path, b"x").unwrap_err().to_string();
    assert!(message.starts_with("cannot write /proc/estimate.json: "), "{message}");
    assert!(message.ends_with("; nothing was changed"), "{message}");
}

#[cfg(unix)]
#[test]
fn a_file_that_is_replaced_keeps_its_permissions_and_a_new_one_follows_the_umask() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = tempfile::tempdir().unwrap();
    let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode() & 0o777;
    let (plain, ours) = (folder.path().join("plain"), folder.path().join("ours"));
    std::fs::write(&plain, b"").unwrap();
    write_atomically(&ours, b"").unwrap();
    assert_eq!(mode(&ours), mode(&plain));
    std::fs::set_permissions(&ours, std::fs::Permissions::from_mode(0o640)).unwrap();
    write_atomically(&ours, b"new").unwrap();
    assert_eq!(mode(&ours), 0o640);
}

/// FIPS 180-2, appendix B.1: the digest of "abc".
#[test]
fn fingerprints_are_sha_256() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("abc");
    std::fs::write(&path, b"abc").unwrap();
    assert_eq!(sha256_of_file(&path).unwrap(), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

#[test]
fn a_negative_zero_is_written_as_zero() {
    use froude_records::table::{Column, ColumnData, Table};
    use froude_records::units::{Dimension, Unit};
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.csv");
    let data = ColumnData::Number { unit: Unit::one(), dimension: Dimension::ONE, si: vec![-0.0, -1.5] };
    let columns = vec![Column { name: "x".to_owned(), data }];
    froude_records::table_file::prepare_table(&Table::of(path.clone(), columns, vec![2, 3]), &path)
        .unwrap()
        .take_place()
        .unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "x [1]\n0\n-1.5\n");
}
