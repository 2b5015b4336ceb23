//! Fields in the binary files of OpenFOAM: text with lists of numbers in it.
//!
//! Values stand behind `uniform` as text, and behind `nonuniform` as a list of binary numbers of a length that is said; so text is searched, never numbers.

/// What a value stands behind; `nonuniform` ends so too.
pub(crate) const MARK: &[u8] = b"uniform ";

/// `List<vector> 22400 (`, numbers, `)`.
pub(crate) struct List<'a> {
    /// As far as the numbers.
    pub head: &'a [u8],
    /// Numbers of an entry.
    pub width: usize,
    /// The numbers.
    pub numbers: &'a [[u8; 8]],
    /// What follows.
    pub rest: &'a [u8],
}

impl<'a> List<'a> {
    /// Reads what stands behind `nonuniform`.
    pub fn read(value: &'a [u8]) -> Result<Self, String> {
        let open = value.iter().position(|byte| *byte == b'(').ok_or("a list does not begin")?;
        let (head, numbers) = value.split_at(open + 1);
        let head_text = String::from_utf8_lossy(head);
        let (kind, count) = head_text.trim_end_matches('(').split_once('>').ok_or("a list has no kind")?;
        let width = match kind {
            "List<scalar" => 1,
            "List<vector" => 3,
            other => return Err(format!("a list is of the kind {other}>; expected scalar or vector")),
        };
        let count: usize = count.trim().parse().map_err(|_| format!("a list has the length {:?}", count.trim()))?;
        let bytes = count.checked_mul(width * 8).and_then(|bytes| numbers.get(..bytes));
        let bytes = bytes.ok_or_else(|| format!("a list of {count} ends before its numbers do"))?;
        let rest = numbers[bytes.len()..].strip_prefix(b")");
        let rest = rest.ok_or_else(|| format!("a list of {count} does not end where its numbers do"))?;
        Ok(Self { head, width, numbers: bytes.as_chunks::<8>().0, rest })
    }
}

/// A field's file as far as its `internalField`, and from there on.
pub(crate) fn split(content: &[u8]) -> Result<(&[u8], &[u8]), String> {
    let start = find(content, b"internalField").ok_or("it has no internalField")?;
    let (head, rest) = content.split_at(start);
    if find(head, b"binary").is_none() || find(head, b"MSB").is_some() || find(head, b"scalar=32").is_some() {
        return Err("it is not written in binary numbers of 64 bits, the lowest byte first".to_owned());
    }
    Ok((head, rest))
}

/// Values of a field in all cells, `W` numbers each.
pub(crate) fn of_cells<const W: usize>(content: &[u8], cells: usize) -> Result<Vec<[f64; W]>, String> {
    let (_, rest) = split(content)?;
    let at = find(rest, MARK).ok_or("its internalField has no value")?;
    let value = &rest[at + MARK.len()..];
    let of_kind = |width| if width == W { Ok(()) } else { Err(format!("an entry has {width} numbers; expected {W}")) };
    if !value.starts_with(b"List<") {
        let end = value.iter().position(|byte| *byte == b';').ok_or("a value does not end")?;
        let numbers = numbers_of(&String::from_utf8_lossy(&value[..end]))?;
        of_kind(numbers.len())?;
        return Ok(vec![std::array::from_fn(|k| numbers[k]); cells]);
    }
    let list = List::read(value)?;
    of_kind(list.width)?;
    let entries = list.numbers.as_chunks::<W>().0;
    if entries.len() != cells {
        return Err(format!("it has {} entries for {cells} cells", entries.len()));
    }
    Ok(entries.iter().map(|entry| entry.map(f64::from_le_bytes)).collect())
}

/// Of `1e-06` or `(0.4 0 0)`.
pub(crate) fn numbers_of(text: &str) -> Result<Vec<f64>, String> {
    let inner = text.trim().trim_start_matches('(').trim_end_matches(')');
    inner.split_whitespace().map(|word| word.parse().map_err(|_| format!("{word:?} is no number"))).collect()
}

pub(crate) fn find(content: &[u8], what: &[u8]) -> Option<usize> {
    content.windows(what.len()).position(|part| part == what)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const HEAD: &[u8] = b"FoamFile\n{\nformat binary;\narch \"LSB;label=32;scalar=64\";\n}\ninternalField   ";

    fn field() -> Vec<u8> {
        let numbers = [1.0_f64, 2.0, -3.0, 0.5, 0.0, 1e-300].map(f64::to_le_bytes).concat();
        [HEAD, b"nonuniform List<vector> \n2\n(", &numbers, b")\n;\n\nboundaryField\n{\n}\n"].concat()
    }

    #[test]
    fn cells_have_their_entries_and_a_uniform_value_is_that_of_all() {
        assert_eq!(of_cells(&field(), 2).unwrap(), [[1.0, 2.0, -3.0], [0.5, 0.0, 1e-300]]);
        assert_eq!(of_cells(&[HEAD, b"uniform 1e-06;\n"].concat(), 3).unwrap(), [[1e-6]; 3]);
        assert_eq!(of_cells(&[HEAD, b"uniform (0.4 0 -1);\n"].concat(), 1).unwrap(), [[0.4, 0.0, -1.0]]);
    }

    #[test]
    fn fields_of_other_cells_or_kinds_are_refused() {
        assert_eq!(of_cells::<3>(&field(), 5).unwrap_err(), "it has 2 entries for 5 cells");
        assert_eq!(of_cells::<1>(&field(), 2).unwrap_err(), "an entry has 3 numbers; expected 1");
        assert_eq!(of_cells::<1>(HEAD, 2).unwrap_err(), "its internalField has no value");
    }

    proptest! {
        #[test]
        fn no_bytes_bring_the_reader_down(cut in 0..300_usize, at in 0..300_usize, with in any::<Vec<u8>>()) {
            let content = field();
            let _ = of_cells::<3>(&content[..cut.min(content.len())], 2);
            let at = at.min(content.len() - 1);
            let mut edited = content.clone();
            edited.splice(at..=at, with);
            let _ = of_cells::<3>(&edited, 2);
            let _ = of_cells::<1>(&edited, 2);
        }
    }
}
