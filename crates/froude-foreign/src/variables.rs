//! Named arrays and structures, as MAT and HDF5 files hold them, as tables.

use crate::{Cells, Column, Contents, ForeignError, LeftOut, Part};

/// Most variables that an error names.
const MAX_REASONS: usize = 5;

/// What a variable, a field or a dataset holds.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Value {
    /// A vector or matrix, column by column.
    Numbers {
        /// Its rows.
        rows: usize,
        /// Its columns.
        columns: usize,
        /// Its numbers.
        data: Vec<f64>,
        /// Its unit, as the file states it.
        unit: String,
    },
    /// Texts.
    Texts(Vec<String>),
    /// A structure, or a group.
    Fields(Vec<(String, Value)>),
    /// An array of structures.
    Elements(Vec<Vec<(String, Value)>>),
    /// What is not read, and what to do.
    Unread(String),
}

/// Tables of variables: vectors of one length side by side, a matrix as one column for each of its own, each structure by itself.
///
/// # Errors
///
/// If none of them can be read; the error names the first of them.
pub(crate) fn contents(variables: Vec<(String, Value)>) -> Result<Contents, ForeignError> {
    let mut contents = Contents::default();
    collect("", variables, &mut contents);
    if contents.parts.is_empty() {
        let first = contents.left_out.iter().take(MAX_REASONS).map(|out| format!("{:?} {}", out.name, out.reason));
        let reasons = first.collect::<Vec<_>>().join("; ");
        return Err(ForeignError(match contents.left_out.len() {
            0 => "is empty: it has no variable or dataset".to_owned(),
            n if n > MAX_REASONS => format!("has nothing that is read: {reasons}; and {} more", n - MAX_REASONS),
            _ => format!("has nothing that is read: {reasons}"),
        }));
    }
    Ok(contents)
}

fn collect(path: &str, fields: Vec<(String, Value)>, out: &mut Contents) {
    let fields = match simulink(fields) {
        Ok(columns) => {
            out.parts.push(Part { name: path.to_owned(), columns });
            return;
        }
        Err(fields) => fields,
    };
    let lengths: Vec<usize> = fields.iter().filter_map(|(_, value)| vector_length(value)).filter(|n| *n > 1).collect();
    let lies = |value: &Value, n: usize, is_row: bool| match value {
        Value::Numbers { rows, columns, .. } => {
            (*rows == 1) == is_row && *rows.max(columns) == n && *rows.min(columns) == 1
        }
        _ => false,
    };
    let has = |n: usize, is_row: bool| n > 1 && fields.iter().any(|(_, value)| lies(value, n, is_row));
    let [in_rows, in_columns]: [Vec<usize>; 2] =
        [true, false].map(|is_row| lengths.iter().copied().filter(|n| has(*n, is_row)).collect());
    // Tables by their length, in the order of the file.
    let mut tables: Vec<(usize, Vec<Column>)> = Vec::new();
    let mut inner = Vec::new();
    for (name, value) in fields {
        match value {
            Value::Numbers { rows, columns, data, unit } => {
                // A square matrix lies as the vectors of its length do.
                let is_square = rows == columns && rows > 1 && in_rows.contains(&rows);
                if is_square && in_columns.contains(&rows) {
                    let reason = "is square beside rows and columns of its length; save its columns by name".to_owned();
                    out.left_out.push(LeftOut { name: joined(path, &name), reason });
                    continue;
                }
                let is_across =
                    rows == 1 || is_square || (columns > 1 && !lengths.contains(&rows) && lengths.contains(&columns));
                let length = if is_across { columns } else { rows };
                if data.is_empty() || length == 0 {
                    let name = joined(path, &name);
                    out.left_out.push(LeftOut { name, reason: "is empty".to_owned() });
                    continue;
                }
                let columns = split(&name, &unit, data, rows, length, is_across);
                table(&mut tables, length).extend(columns);
            }
            Value::Texts(texts) => {
                let column = Column { name, unit: String::new(), cells: Cells::Texts(texts) };
                table(&mut tables, column.cells.len()).push(column);
            }
            value => inner.push((joined(path, &name), value)),
        }
    }
    let n_long = tables.iter().filter(|(length, _)| *length > 1).count();
    for (length, columns) in tables {
        let is_main = n_long == 0 || (n_long == 1 && length > 1);
        let plural = if length == 1 { "" } else { "s" };
        let name = if is_main { path.to_owned() } else { format!("{path} ({length} row{plural})").trim().to_owned() };
        out.parts.push(Part { name, columns });
    }
    for (path, value) in inner {
        match value {
            Value::Fields(fields) => collect(&path, fields, out),
            Value::Elements(elements) if elements.is_empty() => {
                out.left_out.push(LeftOut { name: path, reason: "is empty".to_owned() });
            }
            Value::Elements(elements) => match rows_of(&elements) {
                Some(columns) => out.parts.push(Part { name: path, columns }),
                None => {
                    for (i, element) in elements.into_iter().enumerate() {
                        collect(&format!("{path}({})", i + 1), element, out);
                    }
                }
            },
            Value::Unread(reason) => out.left_out.push(LeftOut { name: path, reason }),
            Value::Numbers { .. } | Value::Texts(_) => {}
        }
    }
}

fn joined(path: &str, name: &str) -> String {
    if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") }
}

/// Length of what is a single column.
fn vector_length(value: &Value) -> Option<usize> {
    match value {
        Value::Numbers { rows, columns, .. } if *rows == 1 || *columns == 1 => Some(*rows.max(columns)),
        Value::Texts(texts) => Some(texts.len()),
        _ => None,
    }
}

fn table(tables: &mut Vec<(usize, Vec<Column>)>, length: usize) -> &mut Vec<Column> {
    let index = tables.iter().position(|(own, _)| *own == length).unwrap_or(tables.len());
    if index == tables.len() {
        tables.push((length, Vec::new()));
    }
    &mut tables[index].1
}

/// The columns of a matrix, `name_1` and so on; a vector keeps its name.
fn split(name: &str, unit: &str, data: Vec<f64>, rows: usize, length: usize, is_across: bool) -> Vec<Column> {
    let n = data.len() / length;
    let column = |name: String, numbers| Column { name, unit: unit.to_owned(), cells: Cells::Numbers(numbers) };
    if n == 1 {
        return vec![column(name.to_owned(), data)];
    }
    let (step, start) = if is_across { (rows, 1) } else { (1, length) };
    let numbers = |i: usize| data.iter().skip(i * start).step_by(step).take(length).copied().collect();
    (0..n).map(|i| column(format!("{name}_{}", i + 1), numbers(i))).collect()
}

/// An array of structures whose fields are single numbers or texts: one row for each element.
fn rows_of(elements: &[Vec<(String, Value)>]) -> Option<Vec<Column>> {
    let names = elements.first()?.iter().map(|(name, _)| name.clone());
    let columns = names.enumerate().map(|(i, name)| {
        let values = || elements.iter().map(move |element| element.get(i).map(|(_, value)| value));
        let numbers = values().map(|value| match value {
            Some(Value::Numbers { data, .. }) if data.len() == 1 => data.first().copied(),
            _ => None,
        });
        let texts = values().map(|value| match value {
            Some(Value::Texts(texts)) if texts.len() == 1 => texts.first().cloned(),
            _ => None,
        });
        let cells = numbers
            .collect::<Option<Vec<f64>>>()
            .map(Cells::Numbers)
            .or_else(|| texts.collect::<Option<Vec<String>>>().map(Cells::Texts));
        Some(Column { name, unit: String::new(), cells: cells? })
    });
    columns.collect()
}

/// What Simulink's "To Workspace" writes as "Structure With Time": `time`, and `signals` with `values` and `label` each.
fn simulink(fields: Vec<(String, Value)>) -> Result<Vec<Column>, Vec<(String, Value)>> {
    let field = |name: &str| fields.iter().find(|(own, _)| own == name).map(|(_, value)| value);
    let (Some(Value::Numbers { data: time, .. }), Some(signals)) = (field("time"), field("signals")) else {
        return Err(fields);
    };
    let signals = match signals {
        Value::Fields(signal) => std::slice::from_ref(signal),
        Value::Elements(signals) => &signals[..],
        _ => return Err(fields),
    };
    let n = time.len();
    let mut columns =
        vec![Column { name: "time".to_owned(), unit: "s".to_owned(), cells: Cells::Numbers(time.clone()) }];
    for (i, signal) in signals.iter().enumerate() {
        let of = |name: &str| signal.iter().find(|(own, _)| own == name).map(|(_, value)| value);
        let label = match of("label") {
            Some(Value::Texts(texts)) => texts.first().filter(|text| !text.is_empty()).cloned(),
            _ => None,
        };
        let name = label.unwrap_or_else(|| format!("signal_{}", i + 1));
        match of("values") {
            Some(Value::Numbers { rows, columns: k, data, unit }) if n > 1 && *rows == n && data.len() == n * k => {
                columns.extend(split(&name, unit, data.clone(), n, n, false));
            }
            _ => return Err(fields),
        }
    }
    Ok(columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(rows: usize, columns: usize) -> Value {
        let data = (0..rows * columns).map(|i| i as f64).collect();
        Value::Numbers { rows, columns, data, unit: String::new() }
    }

    fn shape(contents: &Contents) -> Vec<(String, Vec<String>)> {
        let names = |part: &Part| part.columns.iter().map(|column| column.name.clone()).collect();
        contents.parts.iter().map(|part| (part.name.clone(), names(part))).collect()
    }

    fn read(variables: Vec<(&str, Value)>) -> Result<Contents, ForeignError> {
        contents(variables.into_iter().map(|(name, value)| (name.to_owned(), value)).collect())
    }

    #[test]
    fn vectors_of_one_length_are_one_table_whichever_way_they_lie() {
        let read = read(vec![("t", numbers(1, 4)), ("f", numbers(4, 1)), ("fs", numbers(1, 1))]).unwrap();
        assert_eq!(
            shape(&read),
            [(String::new(), vec!["t".into(), "f".into()]), ("(1 row)".into(), vec!["fs".into()])]
        );
    }

    #[test]
    fn a_matrix_lies_as_the_vector_beside_it() {
        let along = read(vec![("t", numbers(4, 1)), ("f", numbers(4, 2))]).unwrap();
        let across = read(vec![("t", numbers(4, 1)), ("f", numbers(2, 4))]).unwrap();
        assert_eq!(along.parts[0].columns[2].cells, Cells::Numbers(vec![4.0, 5.0, 6.0, 7.0]));
        assert_eq!(across.parts[0].columns[2].cells, Cells::Numbers(vec![1.0, 3.0, 5.0, 7.0]));
        assert_eq!(shape(&across), [(String::new(), vec!["t".into(), "f_1".into(), "f_2".into()])]);
    }

    #[test]
    fn an_array_of_structures_with_single_values_is_a_table() {
        let run = |i: f64| {
            let speed = Value::Numbers { rows: 1, columns: 1, data: vec![i], unit: String::new() };
            vec![("speed".to_owned(), speed), ("note".to_owned(), Value::Texts(vec!["wet".into()]))]
        };
        let table = read(vec![("runs", Value::Elements(vec![run(1.0), run(2.0)]))]).unwrap();
        assert_eq!(table.parts[0].name, "runs");
        assert_eq!(table.parts[0].columns[0].cells, Cells::Numbers(vec![1.0, 2.0]));
        let log = |n| vec![("t".to_owned(), numbers(n, 1))];
        let logs = read(vec![("runs", Value::Elements(vec![log(3), log(4)]))]).unwrap();
        assert_eq!(shape(&logs), [("runs(1)".into(), vec!["t".into()]), ("runs(2)".into(), vec!["t".into()])]);
    }

    #[test]
    fn a_structure_with_time_of_simulink_is_one_table() {
        let signal = |label: &str, columns| {
            let label = ("label".to_owned(), Value::Texts(vec![label.to_owned()]));
            vec![("values".to_owned(), numbers(4, columns)), ("dimensions".to_owned(), numbers(1, 1)), label]
        };
        let signals = Value::Elements(vec![signal("force", 2), signal("", 1)]);
        let run = |n| Value::Fields(vec![("time".to_owned(), numbers(n, 1)), ("signals".to_owned(), signals.clone())]);
        let names = ["time", "force_1", "force_2", "signal_2"].map(str::to_owned).to_vec();
        assert_eq!(shape(&read(vec![("run", run(4))]).unwrap()), [("run".into(), names)]);
        // Another length: nothing is put side by side.
        assert_eq!(read(vec![("run", run(3))]).unwrap().parts.len(), 5);
    }

    #[test]
    fn what_is_not_read_is_named() {
        let unread = || Value::Unread("is complex".to_owned());
        let some = read(vec![("z", unread()), ("t", numbers(4, 1)), ("none", numbers(0, 0))]).unwrap();
        let named: Vec<_> = some.left_out.iter().map(|out| format!("{} {}", out.name, out.reason)).collect();
        assert_eq!(named, ["none is empty", "z is complex"]);
        assert_eq!(read(vec![("z", unread())]).unwrap_err().0, "has nothing that is read: \"z\" is complex");
    }
}
