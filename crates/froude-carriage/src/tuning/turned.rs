//! A table that people read turned.

use froude_records::block::{Block, ResultColumn, ResultTable, TableBuilder};

/// For people a row for each column of `table` and a column for each of its rows, which its first column names; for programs the table itself.
pub(super) fn turned(first: &str, mut table: ResultTable) -> [Block; 2] {
    let Some((names, quantities)) = table.columns.split_first() else { return [table.clone().into(), table.into()] };
    let t = TableBuilder::new("", table.caption.clone(), quantities);
    let name = |c: &ResultColumn| {
        let unit = c.unit.as_ref().map_or_else(String::new, |unit| format!(" [{unit}]"));
        format!("{}{unit}", c.head)
    };
    let column = |row: usize| t.text("", &names.text(row).unwrap_or_default(), move |c| c.text(row));
    let columns = std::iter::once(t.text("", first, name)).chain((0..table.n_rows).map(column));
    let shown = t.build(columns.collect());
    table.columns.iter_mut().for_each(|column| column.head.clear());
    [shown.into(), table.into()]
}

#[cfg(test)]
mod tests {
    use froude_records::block::laid_out;

    use super::*;

    #[test]
    fn people_read_columns_as_rows_and_programs_rows() {
        let rows = [("a", Some(0.5)), ("b", None)];
        let t = TableBuilder::new("modes", "", &rows);
        let columns = vec![
            t.text("body", "body", |(name, _)| (*name).to_owned()),
            t.number("delay_s", "delay [ms]", |(_, delay)| *delay).plain(3),
        ];
        let [Block::Table(shown), Block::Table(table)] = turned("mode", t.build(columns)) else { panic!("tables") };
        let text = laid_out(&shown).unwrap();
        assert_eq!(
            (text.head, text.rows),
            (
                ["mode", "a", "b"].map(str::to_owned).to_vec(),
                vec![["delay [ms]", "500", "—"].map(str::to_owned).to_vec()]
            )
        );
        assert_eq!((laid_out(&table), table.columns[1].key.as_str()), (None, "delay_s"));
    }
}
