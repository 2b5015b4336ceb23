//! Exports come into place with the record, or nothing does.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use froude::identify::method::Export;
use froude::records::estimate::EstimateFile;
use froude::results::write;

#[test]
fn an_export_that_cannot_be_written_leaves_the_old_results_as_they_were() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("results");
    let export = |name: &str, content: &str| Export { name: name.to_owned(), content: content.as_bytes().to_vec() };
    let write = |exports: &[Export], page: &str| write(&out, &EstimateFile::of(Vec::new()), &[], &[], exports, page);
    write(&[export("a.csv", "old")], "old").unwrap();
    let refused = write(&[export("a.csv", "new"), export("no/folder/b.csv", "new")], "new").unwrap_err();
    assert!(!refused.is_bad_input() && refused.to_string().contains("no/folder/b.csv"), "{refused}");
    for name in ["a.csv", "report.html"] {
        assert_eq!(std::fs::read_to_string(out.join(name)).unwrap(), "old", "{name}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing of it is left");
    let written = write(&[export("a.csv", "new")], "new").unwrap();
    assert_eq!(std::fs::read_to_string(&written.exports[0]).unwrap(), "new");
}
