//! HDF5 files, those of MATLAB's `-v7.3` included, by the crate hdf5-pure.
//!
//! | in the file | here |
//! |---|---|
//! | datasets of numbers with one or two dimensions | columns; whole numbers above 2⁵³ are rounded to 53 bits |
//! | datasets of texts | columns of texts |
//! | the attributes `units`, `unit`, `Units`, `Unit` | the unit of the column |
//! | numbers equal to the attribute `_FillValue` or `missing_value`, or outside of `valid_range`, `valid_min` and `valid_max` | NaN |
//! | groups, compound datasets, structures of MATLAB | tables of their own, by their path: `run.force` |
//! | a frame of pandas, format "fixed" | a table with its columns |
//! | complex numbers, references, objects, packed numbers, three dimensions | left out, with what to do |
//!
//! Not covered: soft and external links, which the crate does not list.
//!
//! # Source
//!
//! MATLAB's conventions are not published; they are those of files that it wrote, as SciPy's and h5py's users describe them: the attribute
//! `MATLAB_class`, reversed dimensions, texts as numbers of 16 bits, references from arrays of structures into `#refs#`.

use std::collections::BTreeSet;

use hdf5_pure::{AttrValue, Dataset, Datatype, Error, File, Group, Object, is_hdf5_bytes};

use crate::compound;
use crate::guard::guarded;
use crate::mat5::object;
use crate::variables::{Value, contents};
use crate::{Contents, ForeignError, MAX_BYTES, MAX_CELLS};

/// Most groups inside of each other: a group may hold itself.
const MAX_DEPTH: usize = 32;
/// Most groups and datasets.
const MAX_OBJECTS: usize = 100_000;
/// Most bytes of a dataset or chunk.
const MAX_DATASET_BYTES: u64 = 8 * MAX_CELLS as u64 + (64 << 20);

/// Whether a file begins as HDF5 files do, directly or behind the header of MATLAB.
#[must_use]
pub fn is_hdf5(bytes: &[u8]) -> bool {
    is_hdf5_bytes(bytes)
}

/// Reads an HDF5 file.
///
/// # Errors
///
/// If it is damaged or too large, or if nothing in it is read.
pub fn read(bytes: Vec<u8>) -> Result<Contents, ForeignError> {
    if bytes.len() as u64 > MAX_BYTES {
        return Err(ForeignError(format!(
            "has {} MiB; HDF5 files of at most {} MiB are read",
            bytes.len() >> 20,
            MAX_BYTES >> 20
        )));
    }
    let is_matlab = bytes.starts_with(b"MATLAB");
    guarded("the HDF5 file", || {
        let file = File::from_bytes(bytes).map_err(|e| damaged("", &e))?;
        let mut walk = Walk { is_matlab, n_cells: 0, n_objects: 0 };
        let variables = walk.group("", &file.root(), 0)?;
        contents(variables)
    })
}

fn damaged(path: &str, error: &Error) -> ForeignError {
    let place = if path.is_empty() { String::new() } else { format!(" at {path:?}") };
    // The address that a soft link has in groups of the old kind.
    if error.to_string().contains("18446744073709551615") {
        let group = if path.is_empty() { "/" } else { path };
        return ForeignError(format!(
            "the group {group:?} has soft links, which are not read; in Python, open the file with h5py.File(\"FILE\", \"a\") and delete \
             them, del file[\"NAME\"]"
        ));
    }
    ForeignError(format!("the HDF5 file is damaged{place}, or was not closed by the program that wrote it: {error}"))
}

/// What the crate does not read: storage of HDF5 before 1.6.3, filters of plugins, damaged chunks.
fn unreadable(error: &Error) -> String {
    format!("cannot be read: {error}; if another program reads it, rewrite the file with h5repack -f GZIP=4 FILE NEW")
}

type Fields = Vec<(String, Value)>;

struct Walk {
    is_matlab: bool,
    n_cells: usize,
    n_objects: usize,
}

impl Walk {
    /// Members of a group.
    fn group(&mut self, path: &str, group: &Group, depth: usize) -> Result<Fields, ForeignError> {
        if depth > MAX_DEPTH {
            return Err(ForeignError(format!("groups lie more than {MAX_DEPTH} deep in each other: {path:?}")));
        }
        let mut fields = Vec::new();
        for (name, dataset) in group.iter_datasets().map_err(|e| damaged(path, &e))? {
            if !self.is_hidden(&name) {
                let value = self.dataset(&format!("{path}/{name}"), &name, &dataset, depth)?;
                fields.push((name, value));
            }
        }
        for (name, group) in group.iter_groups().map_err(|e| damaged(path, &e))? {
            if !self.is_hidden(&name) {
                let value = self.subgroup(&format!("{path}/{name}"), &name, &group, depth)?;
                fields.push((name, value));
            }
        }
        Ok(fields)
    }

    /// Where MATLAB keeps what variables refer to.
    fn is_hidden(&self, name: &str) -> bool {
        self.is_matlab && name.starts_with('#')
    }

    fn count(&mut self, path: &str) -> Result<(), ForeignError> {
        self.n_objects += 1;
        if self.n_objects > MAX_OBJECTS {
            return Err(ForeignError(format!(
                "has more than {MAX_OBJECTS} groups and datasets, the most that are read: {path:?}"
            )));
        }
        Ok(())
    }

    fn subgroup(&mut self, path: &str, name: &str, group: &Group, depth: usize) -> Result<Value, ForeignError> {
        self.count(path)?;
        let attributes = Attributes::of(group.attrs().map_err(|e| damaged(path, &e))?);
        if attributes.number("MATLAB_sparse").is_some() {
            return Ok(Value::Unread(format!("is sparse; save full({name})")));
        }
        let pandas = attributes.text("pandas_type");
        if let Some(kind) = pandas.as_deref().filter(|kind| *kind != "frame") {
            return Ok(Value::Unread(format!(
                "is a {kind} of pandas, whose columns Python alone can name; in Python, pandas.read_hdf(\"FILE\", \"{}\").to_csv(\"{name}.csv\")",
                path.trim_start_matches('/')
            )));
        }
        let fields = self.group(path, group, depth + 1)?;
        if pandas.is_some() {
            return Ok(frame(fields));
        }
        // Fields of an array of structures are datasets of references, one for each element.
        if attributes.text("MATLAB_class").as_deref() == Some("struct") {
            return Ok(elements(fields));
        }
        Ok(Value::Fields(fields))
    }

    fn dataset(&mut self, path: &str, name: &str, dataset: &Dataset, depth: usize) -> Result<Value, ForeignError> {
        self.count(path)?;
        let attributes = Attributes::of(dataset.attrs().map_err(|e| damaged(path, &e))?);
        let class = attributes.text("MATLAB_class").unwrap_or_default();
        let unread = |reason: String| Ok(Value::Unread(reason));
        if attributes.number("MATLAB_empty").is_some_and(|empty| empty != 0.0) {
            return unread("is empty".to_owned());
        }
        if attributes.number("MATLAB_object_decode").is_some() {
            return unread(object(&class, name));
        }
        if attributes.text("NAME").is_some_and(|name| name.starts_with("This is a netCDF dimension but not")) {
            return unread("is the length of a dimension and has no numbers".to_owned());
        }
        if ["scale_factor", "add_offset"].iter().any(|key| attributes.number(key).is_some()) {
            return unread(format!(
                "is packed: its attributes scale_factor and add_offset turn its numbers into values; unpack it, in Python with \
                 xarray.open_dataset(\"FILE\")[\"{name}\"].to_dataframe().to_csv(\"{name}.csv\")"
            ));
        }
        let datatype = match dataset.datatype() {
            Ok(datatype) => datatype,
            Err(error) => return unread(format!("has a type that is not read: {error}")),
        };
        if let Some(reason) = attributes.doubt(matches!(datatype, Datatype::FixedPoint { .. })) {
            return unread(reason);
        }
        let (shape, chunk) = match (dataset.shape(), dataset.chunk_shape()) {
            (Ok(shape), Ok(chunk)) => (shape, chunk.unwrap_or_default()),
            (Err(error), _) | (_, Err(error)) => return unread(unreadable(&error)),
        };
        let volume = |shape: &[u64]| shape.iter().fold(1_u64, |n, side| n.saturating_mul(*side));
        let n = volume(&shape);
        self.n_cells = self.n_cells.saturating_add(usize::try_from(n).unwrap_or(usize::MAX));
        let element = u64::from(datatype.type_size());
        let largest = n.max(volume(&chunk)).saturating_mul(element);
        if self.n_cells > MAX_CELLS || largest > MAX_DATASET_BYTES {
            return Err(ForeignError(format!(
                "dataset {path:?} with {shape:?} elements of {element} bytes: with it the file has more than {} million numbers, the most that \
                 are read; write the datasets that are needed to a file of their own",
                MAX_CELLS / 1_000_000
            )));
        }
        let mut shape: Vec<usize> = shape.iter().map(|side| *side as usize).collect();
        while shape.len() > 2 && shape.last() == Some(&1) {
            shape.pop();
        }
        while self.is_matlab && shape.len() > 2 && shape.first() == Some(&1) {
            shape.remove(0);
        }
        if shape.len() > 2 {
            return unread(format!("has {} dimensions; write its slices as datasets of their own", shape.len()));
        }
        let n = n as usize;
        let value = match (&*class, &datatype) {
            ("char", _) => dataset.read_u16().map(|units| Value::Texts(matlab_texts(&units, &shape))),
            ("cell", _) | (_, Datatype::Reference { .. }) => return self.references(path, name, dataset, depth),
            ("", Datatype::FloatingPoint { size: 2, .. } | Datatype::BitField { .. }) => {
                dataset.read_raw().map(|bytes| match compound::value(&datatype, &bytes, n) {
                    Value::Numbers { data, .. } => self.numbers(data, &shape, &attributes),
                    value => value,
                })
            }
            ("" | "logical" | "single" | "double", Datatype::FixedPoint { .. } | Datatype::FloatingPoint { .. }) => {
                dataset.read_f64().map(|data| self.numbers(data, &shape, &attributes))
            }
            (class, Datatype::FixedPoint { .. }) if class.starts_with("int") || class.starts_with("uint") => {
                dataset.read_f64().map(|data| self.numbers(data, &shape, &attributes))
            }
            ("", Datatype::String { .. } | Datatype::VariableLength { is_string: true, .. }) => {
                dataset.read_string().map(|texts| {
                    Value::Texts(texts.into_iter().map(|text| text.trim_end_matches('\0').to_owned()).collect())
                })
            }
            (_, Datatype::Compound { members, .. }) if compound::is_complex(members) => {
                return unread("is complex; write its real and its imaginary part as datasets of their own".to_owned());
            }
            ("", Datatype::Compound { .. } | Datatype::Enumeration { .. }) if shape.len() < 2 => {
                dataset.read_raw().map(|bytes| compound::value(&datatype, &bytes, n))
            }
            ("", _) => {
                return unread(format!(
                    "has elements of the type {datatype}, which is not read; write them as numbers of 8 bytes"
                ));
            }
            (class, _) => return unread(object(class, name)),
        };
        Ok(value.unwrap_or_else(|error| Value::Unread(unreadable(&error))))
    }

    /// Numbers column by column. MATLAB stores them so, with its dimensions reversed; others row by row.
    fn numbers(&self, mut data: Vec<f64>, shape: &[usize], attributes: &Attributes) -> Value {
        for key in ["_FillValue", "missing_value"] {
            if let Some(fill) = attributes.number(key) {
                // A fill value is written in double where the numbers are single.
                let single = f64::from(fill as f32);
                data.iter_mut().filter(|x| **x == fill || **x == single).for_each(|x| *x = f64::NAN);
            }
        }
        if let Some([low, high]) = attributes.valid() {
            data.iter_mut().filter(|x| **x < low || **x > high).for_each(|x| *x = f64::NAN);
        }
        let unit = attributes.units().next().unwrap_or_default();
        let (outer, inner) = (shape.first().copied().unwrap_or(1), shape.get(1).copied().unwrap_or(1));
        if self.is_matlab && shape.len() == 2 {
            return Value::Numbers { rows: inner, columns: outer, data, unit };
        }
        if outer > 1 && inner > 1 {
            data = (0..inner).flat_map(|i| data.iter().skip(i).step_by(inner).copied().collect::<Vec<_>>()).collect();
        }
        Value::Numbers { rows: outer, columns: inner, data, unit }
    }

    /// A cell array, or the elements of a field of an array of structures.
    fn references(&mut self, path: &str, name: &str, dataset: &Dataset, depth: usize) -> Result<Value, ForeignError> {
        if depth > MAX_DEPTH {
            return Err(ForeignError(format!("references lie more than {MAX_DEPTH} deep in each other: {path:?}")));
        }
        let class = Attributes::of(dataset.attrs().map_err(|e| damaged(path, &e))?).text("MATLAB_class");
        let objects = match dataset.dereference() {
            Ok(objects) if self.is_matlab => objects,
            Ok(_) => {
                return Ok(Value::Unread("has references to other datasets; write their numbers instead".to_owned()));
            }
            Err(error) => return Ok(Value::Unread(format!("has references that lead nowhere: {error}"))),
        };
        let mut values = Vec::new();
        for (i, object) in objects.iter().enumerate() {
            let path = format!("{path}({})", i + 1);
            values.push(match object {
                Object::Group(group) => self.subgroup(&path, name, group, depth + 1)?,
                Object::Dataset(dataset) => self.dataset(&path, name, dataset, depth + 1)?,
                _ => Value::Unread("refers to what is neither a group nor a dataset".to_owned()),
            });
        }
        if class.is_none() {
            // Unnamed, so that `elements` knows them.
            return Ok(Value::Elements(values.into_iter().map(|value| vec![(String::new(), value)]).collect()));
        }
        let texts = values.into_iter().map(|value| match value {
            Value::Texts(texts) if texts.len() == 1 => texts.into_iter().next(),
            Value::Unread(reason) if reason == "is empty" => Some(String::new()),
            _ => None,
        });
        Ok(texts.collect::<Option<_>>().map_or_else(
            || {
                Value::Unread(format!(
                    "is a cell array; save a matrix of it, cell2mat({name}), or a file of it, writetable(cell2table({name}), \"{name}.csv\")"
                ))
            },
            Value::Texts,
        ))
    }
}

/// A structure, or an array of them if its fields are lists of references.
fn elements(fields: Fields) -> Value {
    let length =
        fields.first().map_or(0, |(_, value)| if let Value::Elements(elements) = value { elements.len() } else { 0 });
    let is_array =
        |(_, value): &(String, Value)| matches!(value, Value::Elements(elements) if elements.len() == length);
    if length == 0 || !fields.iter().all(is_array) {
        return Value::Fields(fields);
    }
    let mut out = vec![Vec::new(); length];
    for (name, value) in fields {
        if let Value::Elements(elements) = value {
            for (element, field) in out.iter_mut().zip(elements) {
                element.extend(field.into_iter().map(|(_, value)| (name.clone(), value)));
            }
        }
    }
    Value::Elements(out)
}

/// A frame of pandas: blocks of columns of one type, each with the names of its columns, and the index.
fn frame(fields: Fields) -> Value {
    let field = |name: &str| fields.iter().find(|(own, _)| own == name).map(|(_, value)| value);
    let mut out = Vec::new();
    if let Some(index @ Value::Numbers { .. }) = field("axis1") {
        out.push(("index".to_owned(), index.clone()));
    }
    for i in 0.. {
        let (Some(values), Some(names)) = (field(&format!("block{i}_values")), field(&format!("block{i}_items")))
        else {
            break;
        };
        let (Value::Numbers { rows, columns, data, .. }, Value::Texts(names)) = (values, names) else {
            return Value::Unread(
                "is a frame of pandas with columns that are not numbers; in Python, pandas.read_hdf(\"FILE\").to_csv(\"FILE.csv\")".to_owned(),
            );
        };
        if *columns != names.len() {
            return Value::Unread("is a frame of pandas whose names and columns differ in number".to_owned());
        }
        for (name, column) in names.iter().zip(data.chunks(*rows)) {
            let numbers = Value::Numbers { rows: *rows, columns: 1, data: column.to_vec(), unit: String::new() };
            out.push((name.clone(), numbers));
        }
    }
    Value::Fields(out)
}

/// Texts of a `char` array: units of UTF-16, the dimensions reversed, so that each row of the text is a column here.
fn matlab_texts(units: &[u16], shape: &[usize]) -> Vec<String> {
    let rows = shape.get(1).copied().unwrap_or(1).max(1);
    let row = |i: usize| {
        let units: Vec<u16> = units.iter().skip(i).step_by(rows).copied().collect();
        String::from_utf16_lossy(&units).trim_end().to_owned()
    };
    (0..rows.min(units.len().max(1))).map(row).collect()
}

/// Attributes that state a unit.
const UNITS: [&str; 4] = ["units", "unit", "Units", "Unit"];
/// Attributes by which programs turn whole numbers into values, in small letters.
const RAW: [&str; 9] =
    ["scale", "scaling", "offset", "gain", "slope", "factor", "sensitivity", "calibration", "conversion_factor"];

/// Attributes by which programs turn any numbers into values: NWB and others.
const FACTORS: [&str; 3] = ["conversion", "conversion_factor", "multiplier"];

/// Attributes of a group or dataset.
struct Attributes(Vec<(String, AttrValue)>);

impl Attributes {
    fn of(attributes: impl IntoIterator<Item = (String, AttrValue)>) -> Self {
        Self(attributes.into_iter().collect())
    }

    fn get(&self, name: &str) -> Option<&AttrValue> {
        self.0.iter().find(|(own, _)| own == name).map(|(_, value)| value)
    }

    fn text(&self, name: &str) -> Option<String> {
        match self.get(name)? {
            AttrValue::String(text) | AttrValue::AsciiString(text) | AttrValue::VarLenString(text) => {
                Some(text.clone())
            }
            AttrValue::StringSized { value, .. } | AttrValue::AsciiStringSized { value, .. } => Some(value.clone()),
            AttrValue::StringArray(texts)
            | AttrValue::AsciiStringArray(texts)
            | AttrValue::VarLenStringArray(texts)
            | AttrValue::VarLenAsciiStringArray(texts)
                if texts.len() == 1 =>
            {
                texts.first().cloned()
            }
            _ => None,
        }
    }

    /// What units the attributes state.
    fn units(&self) -> impl Iterator<Item = String> {
        UNITS.iter().filter_map(|key| self.text(key))
    }

    /// Why numbers with these attributes are not what they stand for, or can be two things.
    fn doubt(&self, is_whole: bool) -> Option<String> {
        let units: BTreeSet<String> = self.units().map(|unit| unit.trim().to_owned()).collect();
        let is_unsigned = |text: String| text.eq_ignore_ascii_case("true");
        let of_raw = |name: &&String| RAW.contains(&name.to_lowercase().as_str());
        if units.len() > 1 {
            let units: Vec<String> = units.into_iter().collect();
            return Some(format!("states two units, {}; delete the attribute that is wrong", units.join(" and ")));
        }
        if self.text("_Unsigned").is_some_and(is_unsigned) {
            return Some(
                "holds unsigned numbers in a signed type (attribute _Unsigned); write them in an unsigned one"
                    .to_owned(),
            );
        }
        let factor = FACTORS.iter().find(|name| self.number(name).is_some_and(|factor| factor != 1.0));
        if let Some(factor) = factor {
            return Some(format!(
                "has the attribute {factor}, which may be a factor still to be applied to its numbers; store the converted values"
            ));
        }
        let raw = self.0.iter().map(|(name, _)| name).find(of_raw).filter(|_| is_whole)?;
        Some(format!("has whole numbers with the attribute {raw}, which may turn them into values; write the values"))
    }

    /// The range that numbers of netCDF are valid in: `valid_range`, `valid_min`, `valid_max`.
    fn valid(&self) -> Option<[f64; 2]> {
        if let Ok(both) = <[f64; 2]>::try_from(self.numbers("valid_range")) {
            return Some(both);
        }
        let [low, high] = ["valid_min", "valid_max"].map(|key| self.number(key));
        (low.is_some() || high.is_some()).then(|| [low.unwrap_or(f64::NEG_INFINITY), high.unwrap_or(f64::INFINITY)])
    }

    fn number(&self, name: &str) -> Option<f64> {
        <[f64; 1]>::try_from(self.numbers(name)).ok().map(|[x]| x)
    }

    fn numbers(&self, name: &str) -> Vec<f64> {
        fn all<T: Copy>(many: &[T], of: impl Fn(T) -> f64) -> Vec<f64> {
            many.iter().map(|x| of(*x)).collect()
        }
        match self.get(name) {
            Some(AttrValue::F64(x)) => vec![*x],
            Some(AttrValue::F32(x)) => vec![f64::from(*x)],
            Some(AttrValue::I8(i)) => vec![f64::from(*i)],
            Some(AttrValue::I16(i)) => vec![f64::from(*i)],
            Some(AttrValue::I32(i)) => vec![f64::from(*i)],
            Some(AttrValue::I64(i)) => vec![*i as f64],
            Some(AttrValue::U8(i)) => vec![f64::from(*i)],
            Some(AttrValue::U16(i)) => vec![f64::from(*i)],
            Some(AttrValue::U32(i)) => vec![f64::from(*i)],
            Some(AttrValue::U64(i)) => vec![*i as f64],
            Some(AttrValue::F64Array(many)) => many.clone(),
            Some(AttrValue::F32Array(many)) => all(many, f64::from),
            Some(AttrValue::I8Array(many)) => all(many, f64::from),
            Some(AttrValue::I16Array(many)) => all(many, f64::from),
            Some(AttrValue::I32Array(many)) => all(many, f64::from),
            Some(AttrValue::I64Array(many)) => all(many, |i| i as f64),
            Some(AttrValue::U8Array(many)) => all(many, f64::from),
            Some(AttrValue::U16Array(many)) => all(many, f64::from),
            Some(AttrValue::U32Array(many)) => all(many, f64::from),
            Some(AttrValue::U64Array(many)) => all(many, |i| i as f64),
            _ => Vec::new(),
        }
    }
}
