//! Exports come into place with the record, or nothing does.

use froude::records::estimate::EstimateFile;
use froude::records::outcome::{Content, Outcome, OutputFile};
use froude::report::write::{WriteError, write_folder};

#[test]
fn an_export_that_cannot_be_written_leaves_the_old_results_as_they_were() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("results");
    let write = |files: &[(&str, &str)]| {
        let file = |(name, text): &(&str, &str)| OutputFile {
            key: "exports[]",
            path: out.join(name),
            content: Content::Bytes(text.as_bytes().to_vec()),
        };
        let record = OutputFile { key: "estimates", path: out.join("estimate.json"), content: Content::Record };
        let files = std::iter::once(record).chain(files.iter().map(file)).collect();
        write_folder(&Outcome { records: vec![EstimateFile::of(Vec::new())], files, ..Outcome::default() }, &out)
    };
    write(&[("a.csv", "old"), ("b.csv", "old")]).unwrap();
    let refused = write(&[("a.csv", "new"), ("no/folder/b.csv", "new")]).unwrap_err();
    let WriteError::Record(refused) = refused else { panic!("{refused}") };
    assert!(refused.is_output() && refused.to_string().contains("no/folder/b.csv"), "{refused}");
    for name in ["a.csv", "b.csv"] {
        assert_eq!(std::fs::read_to_string(out.join(name)).unwrap(), "old", "{name}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing of it is left");
    write(&[("a.csv", "new")]).unwrap();
    assert_eq!(std::fs::read_to_string(out.join("a.csv")).unwrap(), "new");
}
