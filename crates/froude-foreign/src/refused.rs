//! Formats that are not read: by the ending of a file's name or its first bytes, what they are and what to do.

/// A format that is not read.
struct Refused {
    /// Endings of names that only this format has.
    endings: &'static [&'static str],
    /// What its files begin with; empty if nothing tells them.
    magic: &'static [u8],
    what: &'static str,
    instead: &'static str,
}

const fn row(
    endings: &'static [&'static str],
    magic: &'static [u8],
    what: &'static str,
    instead: &'static str,
) -> Refused {
    Refused { endings, magic, what, instead }
}

const FORMATS: [Refused; 23] = [
    row(
        &["outb"],
        b"",
        "binary output of OpenFAST",
        "set OutFileFmt to 1 in the .fst file for text (.out), or convert it with openfast_toolbox (PyPI): FASTOutputFile(\"run.outb\").toDataFrame().to_csv(\"run.csv\", index=False)",
    ),
    row(
        &["db3"],
        b"SQLite format 3\0",
        "a ROS 2 bag in SQLite",
        "convert it to MCAP: mcap convert run.db3 run.mcap (github.com/foxglove/mcap), or rosbags-convert (PyPI rosbags)",
    ),
    row(
        &["bag"],
        b"#ROSBAG V",
        "a ROS 1 bag",
        "convert it to MCAP: mcap convert run.bag run.mcap (github.com/foxglove/mcap)",
    ),
    row(
        &["dxd", "dxz", "d7d", "d7z"],
        b"",
        "a data file of Dewesoft",
        "export it in Dewesoft X (Export, Text/CSV or MATLAB), or by its free reader dwdatareader (PyPI)",
    ),
    row(
        &["mf4", "mdf"],
        b"MDF     ",
        "an ASAM measurement file (MDF)",
        "convert it with asammdf (PyPI): asammdf.MDF(\"run.mf4\").export(\"csv\", \"run.csv\")",
    ),
    row(
        &["blf"],
        b"LOGG",
        "a CAN log of Vector",
        "decode it with its DBC file: python-can and cantools (PyPI), and write a CSV",
    ),
    row(&["tdm", "tdx"], b"", "a data file of DIAdem", "save it as TDMS in DIAdem, or in LabVIEW with Storage/Convert"),
    row(&["rsp", "rpc"], b"", "a time history of MTS (RPC III)", "export it as text in RPC, or as MATLAB"),
    row(&["sie"], b"", "a data file of HBM eDAQ", "export it as CSV in InField or nCode"),
    row(
        &["bin"],
        b"\xa3\x95",
        "a log of ArduPilot",
        "convert it with pymavlink (PyPI): mavlogdump.py --format csv --types CTUN run.bin",
    ),
    row(
        &["tlog"],
        b"",
        "a telemetry log of MAVLink",
        "convert it with pymavlink (PyPI): mavlogdump.py --format csv --types ATTITUDE run.tlog",
    ),
    row(
        &["sim"],
        b"",
        "a simulation of OrcaFlex",
        "export its results: Values in the Results form, saved as .csv or .xlsx",
    ),
    row(
        &["npy", "npz"],
        b"\x93NUMPY",
        "an array of NumPy",
        "write it as CSV with the names of its columns: numpy.savetxt(\"run.csv\", a, delimiter=\",\", header=\"time [s],f_x [N]\", comments=\"\")",
    ),
    row(
        &["pkl", "pickle"],
        b"",
        "a pickle of Python, which runs code when it is read",
        "write a table: df.to_csv(\"run.csv\", index=False)",
    ),
    row(
        &["c3d"],
        b"",
        "a file of motion capture",
        "export it as CSV or TSV in the capture software, or with ezc3d (PyPI)",
    ),
    row(
        &["feather", "arrow"],
        b"ARROW1",
        "an Arrow file",
        "write it as Parquet: pandas.read_feather(\"run.feather\").to_parquet(\"run.parquet\")",
    ),
    row(
        &["zip", "7z", "gz", "rar", "zst", "xz", "tar", "tgz", "bz2"],
        b"",
        "a compressed file",
        "unpack it, and name the file in it",
    ),
    row(&["pdf"], b"%PDF-", "a document", "save the table itself as CSV"),
    row(&["doc", "docx", "odt", "rtf"], b"", "a document", "copy the table into a spreadsheet, and save that as .xlsx"),
    row(&["html", "htm"], b"<!DOCTYPE html", "a web page", "copy the table into a spreadsheet, and save that as .xlsx"),
    row(
        &["mp4", "avi", "mov", "mkv", "wmv"],
        b"",
        "a video",
        "track the motion in it, for example with Tracker (physlets.org) or Kinovea, and export the track as CSV",
    ),
    row(&["wav", "flac", "mp3"], b"", "a recording of sound", "write its samples as CSV, with their times"),
    row(
        &["png", "jpg", "jpeg", "tif", "tiff"],
        b"\x89PNG",
        "a picture",
        "a table or a log is needed; digitise a published curve by hand and state its uncertainty",
    ),
];

/// Why a file is not read, and what to do, by the ending of its name (without the dot) and its first bytes; `None` if it is none of these formats.
#[must_use]
pub fn refusal_for(ending: &str, first_bytes: &[u8]) -> Option<String> {
    let begins = |format: &&Refused| !format.magic.is_empty() && first_bytes.starts_with(format.magic);
    // Where the first bytes tell a format, they must: another program may use its ending.
    let ends = |format: &&Refused| {
        let is_known = format.endings.iter().any(|known| ending.eq_ignore_ascii_case(known));
        is_known && (format.magic.is_empty() || first_bytes.is_empty())
    };
    let found = FORMATS.iter().find(begins).or_else(|| FORMATS.iter().find(ends)).or_else(|| {
        // Several kinds of picture, and of arrays, share a row.
        let has_many = |format: &&Refused| {
            format.endings.len() > 1 && format.endings.iter().any(|known| ending.eq_ignore_ascii_case(known))
        };
        FORMATS.iter().find(has_many)
    })?;
    Some(format!("it is {}, which is not read; {}", found.what, found.instead))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_format_is_told_by_its_first_bytes_or_else_by_its_ending() {
        for (ending, bytes, what) in [
            ("outb", &b"\x04\x00"[..], "binary output of OpenFAST"),
            ("db3", b"SQLite format 3\0rest", "a ROS 2 bag in SQLite"),
            ("dat", b"MDF     4.10", "an ASAM measurement file (MDF)"),
            ("DXD", b"", "a data file of Dewesoft"),
            ("d7d", b"\x00\x01", "a data file of Dewesoft"),
            ("bin", b"\xa3\x95\x80", "a log of ArduPilot"),
            ("npz", b"PK\x03\x04", "an array of NumPy"),
            ("jpg", b"\xff\xd8\xff", "a picture"),
        ] {
            let found = refusal_for(ending, bytes).unwrap();
            assert!(found.starts_with(&format!("it is {what}, which is not read; ")), "{ending}: {found}");
        }
        // What only looks like one is not refused by this table.
        for (ending, bytes) in [
            ("bin", &b"12 3"[..]),
            ("csv", b"time,f_x\n"),
            ("out", b"\nPredictions"),
            ("db3", b"time,f_x\n"),
            ("", b""),
        ] {
            assert_eq!(refusal_for(ending, bytes), None, "{ending}");
        }
    }

    #[test]
    fn every_format_has_a_row_and_says_what_to_do() {
        for format in &FORMATS {
            assert!(
                !format.endings.is_empty() && format.what.len() > 5 && format.instead.len() > 10,
                "{}",
                format.what
            );
            for ending in format.endings {
                assert_eq!(FORMATS.iter().filter(|other| other.endings.contains(ending)).count(), 1, "{ending}");
            }
        }
    }
}
