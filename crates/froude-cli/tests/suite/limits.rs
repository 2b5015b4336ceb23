//! The limits of the book, at the verb that reads the file: what is within is read, what is beyond is refused in a sentence, at once.

use std::fs::File;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;

use parquet::basic::{Repetition, Type as Physical};
use parquet::data_type::DoubleType;
use parquet::file::metadata::{FileMetaData, ParquetMetaDataBuilder, ParquetMetaDataWriter};
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

/// Exit code, standard output and standard error, in a process that may take 1.5 GiB of memory: what is refused is refused before it is
/// unpacked.
fn froude(folder: &Path, args: &[&str]) -> (Option<i32>, String, String) {
    let out = Command::new("sh")
        .args(["-c", "ulimit -v 1572864; exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_froude")])
        .args(args)
        .env("RAYON_NUM_THREADS", "2")
        .current_dir(folder)
        .output()
        .unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim_end().to_owned();
    (out.status.code(), text(&out.stdout), text(&out.stderr))
}

fn written(name: &str, bytes: impl AsRef<[u8]>) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(name), bytes).unwrap();
    folder
}

/// Asserts that it is read: 0, or a message that is of something else.
fn reads(name: &str, bytes: impl AsRef<[u8]>, args: &[&str]) {
    let folder = written(name, bytes);
    let (code, _, told) = froude(folder.path(), args);
    assert_eq!(code, Some(0), "{told}");
}

fn refuses(name: &str, bytes: impl AsRef<[u8]>, args: &[&str], message: &str) {
    let folder = written(name, bytes);
    let (code, _, told) = froude(folder.path(), args);
    assert_eq!((code, told.as_str()), (Some(2), message));
}

const ROWS: &str = "0.1,-0.5,a\n0.2,-2.0,a\n0.3,-4.4,b\n0.4,-8.1,b\n";

#[test]
fn a_header_or_a_cell_of_text_has_a_thousand_bytes() {
    let header = |n: usize| format!("speed [m/s],f_x [N],{}\n{ROWS}", "x".repeat(n));
    let cell = |n: usize| format!("speed [m/s],f_x [N],note\n{ROWS}0.5,-12.4,{}\n", "é".repeat(n / 2));
    for verb in ["inspect", "identify"] {
        for n in [999, 1000] {
            reads("t.csv", header(n), &[verb, "t.csv"]);
            reads("t.csv", cell(n), &[verb, "t.csv"]);
        }
        for n in [1001, 1_000_000] {
            let told = format!(
                "froude: t.csv:1: the header of column 3 (\"{}…\") has {n} bytes; at most 1000 are read",
                "x".repeat(40)
            );
            refuses("t.csv", header(n), &[verb, "t.csv"], &told);
        }
        let told =
            format!("froude: t.csv:6: a cell (\"{}…\") has 1002 bytes of text; at most 1000 are read", "é".repeat(40));
        refuses("t.csv", cell(1002), &[verb, "t.csv"], &told);
    }
}

#[test]
fn a_table_has_ten_thousand_columns() {
    let table = |n: usize| {
        let header: String = (0..n - 2).map(|j| format!(",c{j}")).collect();
        let cells = ",a".repeat(n - 2);
        format!("speed [m/s],f_x [N]{header}\n0.1,-0.5{cells}\n0.2,-2.1{cells}\n0.3,-4.4{cells}\n")
    };
    reads("t.csv", table(9_999), &["identify", "t.csv"]);
    reads("t.csv", table(10_000), &["identify", "t.csv"]);
    refuses("t.csv", table(10_001), &["identify", "t.csv"], "froude: t.csv:1: the row has more than 10000 cells");
}

#[test]
fn numbers_end_at_ten_to_the_fiftieth() {
    let table = |n: &str| format!("speed [m/s],f_x [N],u [N]\n0.1,-0.5,{n}\n0.2,-2.0,1\n0.3,-4.4,1\n");
    for n in ["9.9e49", "1e50", "-1e50"] {
        reads("t.csv", table(n), &["identify", "t.csv"]);
    }
    let told = "froude: t.csv:2: column `u [N]`: `1.1e50` exceeds the limit of 1e50 (SI); correct it or delete the row";
    refuses("t.csv", table("1.1e50"), &["identify", "t.csv"], told);
}

/// A file padded by a comment to so many bytes.
fn padded(text: &str, bytes: usize) -> String {
    format!("{text}#{}\n", "x".repeat(bytes - text.len() - 2))
}

#[test]
fn campaigns_and_body_files_have_their_sizes() {
    let example = |path: &str| {
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(path)).unwrap()
    };
    let body = ["added-mass", "body.toml", "--links", "1", "--check"];
    let campaign = ["run", "c.toml", "--check"];
    for (name, text, args, limit, what) in [
        ("body.toml", &example("mamba-necked/body.toml"), &body[..], 1 << 20, "a body"),
        ("c.toml", &example("towing-carriage/campaign.toml"), &campaign[..], 4 << 20, "a campaign"),
    ] {
        reads(name, padded(text, limit - 1), args);
        reads(name, padded(text, limit), args);
        let told = format!("froude: {name} has {} bytes; the limit for {what} is {limit}", limit + 1);
        refuses(name, padded(text, limit + 1), args, &told);
    }
}

/// Files that are larger than their kind are refused by their length; nothing of them is read.
#[test]
fn files_beyond_their_size_are_refused_unread() {
    for (name, limit, what) in [
        ("t.csv", 2_u64 << 30, "a table"),
        ("t.parquet", 2 << 30, "a Parquet table"),
        ("e.json", 64 << 20, "an estimate record"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        File::create(folder.path().join(name)).unwrap().set_len(limit + 1).unwrap();
        let (code, _, told) = froude(folder.path(), &["inspect", name]);
        let message = format!("froude: {name} has {} bytes; the limit for {what} is {limit}", limit + 1);
        assert_eq!((code, told), (Some(2), message));
    }
    let folder = tempfile::tempdir().unwrap();
    File::create(folder.path().join("m.stl")).unwrap().set_len((1 << 30) + 1).unwrap();
    let (code, _, told) = froude(folder.path(), &["added-mass", "m.stl", "--check"]);
    assert_eq!(
        (code, told.as_str()),
        (Some(2), "froude: m.stl has 1073741825 bytes; the limit for a mesh is 1073741824")
    );
}

#[test]
fn a_body_is_between_a_grain_and_a_kilometre() {
    let body = |x: &str| {
        format!(
            "schema = 1\nname = \"x\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n[body]\nshape = \"ellipsoid\"\nsemi_axis_x = \"{x}\"\n\
             semi_axis_y = \"{x}\"\nsemi_axis_z = \"{x}\"\n"
        )
    };
    let args = ["added-mass", "body.toml", "--check"];
    for length in ["0.01 mm", "1 m", "1 km", "999 m"] {
        reads("body.toml", body(length), &args);
    }
    let told = |m: &str| {
        format!(
            "froude: body.toml:7:15: `semi_axis_x` is {m} m; lengths of a body are from 0.00001 m to 1000 m: check its unit"
        )
    };
    refuses("body.toml", body("1e9 mm"), &args, &told("1000000"));
    refuses("body.toml", body("1001 m"), &args, &told("1001"));
    refuses("body.toml", body("9 um"), &args, &told("0.000009"));
}

#[test]
fn lists_of_a_plan_multiply_to_a_million_observations_and_ten_thousand_runs() {
    let campaign = |angles: &str| {
        format!(
            "schema = 1\nname = \"x\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n[[source]]\nname = \"s\"\nkind = \"tank\"\ntable = \"t.csv\"\n\
             [[source.plan]]\nspeed = {{ start = \"0.1 m/s\", stop = \"1 m/s\", step = \"0.1 m/s\" }}\n\
             angle = {{ start = \"0 deg\", stop = \"{angles} deg\", step = \"0.001 deg\" }}\nrepeats = 4\n"
        )
    };
    // 10 speeds, 25,000 angles, 4 repeats; one angle more.
    reads("c.toml", campaign("24.999"), &["inspect", "c.toml"]);
    let told = "froude: c.toml:9:1: `configurations` (1) × `speed` (10) × `angle` (25001) × `pitch` (1) × `repeats` (4) is 1000040; at most 1000000 are made";
    refuses("c.toml", campaign("25"), &["inspect", "c.toml"], told);

    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/towing-carriage/campaign.toml");
    let example = std::fs::read_to_string(example).unwrap();
    let many = example.replace("repeats = 5  ", "repeats = 1667  ");
    let (code, _, told) = froude(written("c.toml", many).path(), &["run", "c.toml", "--check"]);
    assert_eq!(code, Some(2));
    assert!(told.ends_with("`speeds` (6) × `repeats` (1667) is 10002; at most 10000 are made"), "{told}");
    let long = example.replace(r#"still = "5 s""#, r#"still = "86401 s""#);
    let (code, _, told) = froude(written("c.toml", long).path(), &["run", "c.toml", "--check"]);
    assert_eq!(code, Some(2));
    assert!(told.ends_with("is 8.6401e4 s; nothing of a campaign takes longer than 86400 s"), "{told}");
}

/// Columns of one value, in a file of some kilobytes whose footer repeats its only row group.
fn parquet(columns: usize, groups: usize) -> Vec<u8> {
    const ROWS: usize = 10_000;
    let names = ["speed [m/s]".to_owned(), "f_x [N]".to_owned()].into_iter();
    let names: Vec<String> = names.chain((0..).map(|j| format!("u{j} [N]"))).take(columns).collect();
    let field = |name: &String| {
        let builder = Type::primitive_type_builder(name, Physical::DOUBLE).with_repetition(Repetition::REQUIRED);
        Arc::new(builder.build().unwrap())
    };
    let schema = Type::group_type_builder("t").with_fields(names.iter().map(field).collect()).build().unwrap();
    let mut bytes = Vec::new();
    let properties = Arc::new(WriterProperties::builder().build());
    let mut writer = SerializedFileWriter::new(&mut bytes, Arc::new(schema), properties).unwrap();
    let mut group = writer.next_row_group().unwrap();
    while let Some(mut column) = group.next_column().unwrap() {
        column.typed::<DoubleType>().write_batch(&vec![0.25; ROWS], None, None).unwrap();
        column.close().unwrap();
    }
    group.close().unwrap();
    writer.close().unwrap();

    let folder = written("one.parquet", &bytes);
    let reader = SerializedFileReader::new(File::open(folder.path().join("one.parquet")).unwrap()).unwrap();
    let one = reader.metadata();
    let file = one.file_metadata();
    let of_file = FileMetaData::new(
        file.version(),
        (ROWS * groups) as i64,
        file.created_by().map(str::to_owned),
        None,
        file.schema_descr_ptr(),
        file.column_orders().cloned(),
    );
    let many = ParquetMetaDataBuilder::new(of_file).set_row_groups(vec![one.row_group(0).clone(); groups]).build();
    let footer = u32::from_le_bytes(bytes[bytes.len() - 8..bytes.len() - 4].try_into().unwrap()) as usize;
    bytes.truncate(bytes.len() - 8 - footer);
    ParquetMetaDataWriter::new(&mut bytes, &many).finish().unwrap();
    bytes
}

/// 27 thousand bytes a group of ten thousand rows: the cells are counted before any is unpacked.
#[test]
fn a_small_parquet_file_cannot_stand_for_gigabytes() {
    let bomb = parquet(16, 5_000);
    assert!(bomb.len() < 10 << 20, "{} bytes for 6.4 GB of cells", bomb.len());
    let told = "froude: t.parquet has 6400000000 bytes; the limit for the cells of a table, unpacked is 2147483648";
    refuses("t.parquet", &bomb, &["identify", "t.parquet"], told);
    refuses("t.parquet", &bomb, &["inspect", "t.parquet"], told);
    // The same file with fewer groups is a table.
    reads("t.parquet", parquet(3, 20), &["inspect", "t.parquet"]);
}

/// An MCAP record.
fn record(opcode: u8, body: &[u8]) -> Vec<u8> {
    [&[opcode][..], &(body.len() as u64).to_le_bytes(), body].concat()
}

/// A run of so many chunks, each so many zeros when it is unpacked.
fn zeros(chunks: usize, bytes: usize) -> Vec<u8> {
    const MAGIC: &[u8] = b"\x89MCAP0\r\n";
    let packed = zstd::encode_all(&vec![0; bytes][..], 1).unwrap();
    let text = |t: &str| [&(t.len() as u32).to_le_bytes()[..], t.as_bytes()].concat();
    let chunk = [
        &[0; 16][..],
        &(bytes as u64).to_le_bytes(),
        &[0; 4],
        &text("zstd"),
        &(packed.len() as u64).to_le_bytes(),
        &packed,
    ]
    .concat();
    let mut out = MAGIC.to_vec();
    out.extend(record(0x01, &[text(""), text("")].concat()));
    for _ in 0..chunks {
        out.extend(record(0x06, &chunk));
    }
    out.extend(record(0x0f, &[0; 4]));
    out.extend(record(0x02, &[0; 20]));
    out.extend(MAGIC);
    out
}

#[test]
fn a_small_run_cannot_stand_for_gigabytes() {
    let bomb = zeros(300, 64 << 20);
    assert!(bomb.len() < 4 << 20, "{} bytes for 20 GB", bomb.len());
    let limit = (256_usize << 20).max(200 * bomb.len());
    let unpacked = (limit / (64 << 20) + 1) * (64 << 20);
    let told = format!(
        "froude: r.mcap has {unpacked} bytes; the limit for the chunks of a run of this size, unpacked is {limit}"
    );
    refuses("r.mcap", &bomb, &["inspect", "r.mcap"], &told);
    // Within it: damaged, and told as that.
    let folder = written("r.mcap", zeros(3, 64 << 20));
    let (code, said, told) = froude(folder.path(), &["inspect", "r.mcap"]);
    assert!(code != Some(1), "{said}{told}");
    assert!(!told.contains("unpacked is"), "{told}");
}

#[test]
fn three_hundred_estimates_are_compared_and_not_one_more() {
    let seed = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds/estimate_json/1.json");
    let mut record: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(seed).unwrap()).unwrap();
    let one = record["estimates"][0].clone();
    let of = |n: usize| {
        (0..n).map(|k| {
            let mut e = one.clone();
            e["id"] = format!("s{k}/m{k}").into();
            e["law"]["name"] = format!("m{k}").into();
            e["recommended"] = false.into();
            e
        })
    };
    record["estimates"] = of(300).collect();
    reads("e.json", record.to_string(), &["compare", "e.json"]);
    record["estimates"] = of(301).collect();
    let told = "froude: 301 estimates are not compared: at most 300 are; name fewer records, or fewer models in them";
    refuses("e.json", record.to_string(), &["compare", "e.json"], told);
}
