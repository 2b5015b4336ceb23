//! ROS 2 messages: definitions (`.msg`) and their bytes (CDR).
//!
//! A number, or an array of up to [`MAX_ARRAY`] numbers, becomes columns, `header.stamp.sec` or `position_0`; texts, longer arrays
//! and sequences are passed over and named.
//!
//! Source: ROS 2 interface definition (docs.ros.org, "About internal ROS 2 interfaces"), OMG DDSI-RTPS 2.5, section 10 (CDR).

use std::collections::BTreeMap;

/// Most numbers of a message.
pub(super) const MAX_COLUMNS: usize = 10_000;

/// Longest array whose elements are columns.
pub(super) const MAX_ARRAY: usize = 16;

/// Definitions in definitions; ROS has some five at most.
const MAX_DEPTH: usize = 32;

/// Most parts of a message, those that are passed over included.
const MAX_PARTS: usize = 100_000;

/// A type of number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Number {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
    F32,
    F64,
}

impl Number {
    fn of(name: &str) -> Option<Self> {
        Some(match name {
            "bool" | "byte" | "char" | "uint8" => Self::U8,
            "int8" => Self::I8,
            "uint16" => Self::U16,
            "int16" => Self::I16,
            "uint32" => Self::U32,
            "int32" => Self::I32,
            "uint64" => Self::U64,
            "int64" => Self::I64,
            "float32" => Self::F32,
            "float64" => Self::F64,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }
}

/// A part of a message.
#[derive(Debug, Clone)]
enum Node {
    /// A number and its column, if it has one.
    Number(Number, Option<usize>),
    Text,
    All(Vec<Node>),
    /// The same so many times.
    Array(usize, Box<Node>),
    /// The same as often as the message says.
    Sequence(Box<Node>),
}

/// How the messages of a topic are laid out.
#[derive(Debug)]
pub(super) struct Message {
    root: Node,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// What is passed over, with the reason.
    pub skipped: Vec<String>,
}

impl Message {
    /// Reads a definition; `name` is that of the type, `package/msg/Type`.
    ///
    /// # Errors
    ///
    /// What is not understood, with its line.
    pub fn parse(name: &str, text: &str) -> Result<Self, String> {
        let definitions = definitions(name, text)?;
        let mut compiler = Compiler { definitions: &definitions, columns: Vec::new(), skipped: Vec::new(), n_parts: 0 };
        let root = compiler.named(&short(name), "", true, 0)?;
        if compiler.columns.len() > MAX_COLUMNS {
            return Err(format!("it has {} numbers; at most {MAX_COLUMNS} are read", compiler.columns.len()));
        }
        Ok(Self { root, columns: compiler.columns, skipped: compiler.skipped })
    }

    /// Reads a message into a row of the columns.
    ///
    /// # Errors
    ///
    /// A message that does not fit its definition.
    pub fn decode(&self, data: &[u8], row: &mut [f64]) -> Result<(), String> {
        let (kind, body) = match data {
            [0, kind, _, _, body @ ..] => (*kind, body),
            _ => return Err("it does not begin with the four bytes of a CDR message".to_owned()),
        };
        let (is_little, max_alignment) = match kind {
            0 | 1 => (kind == 1, 8),
            6 | 7 => (kind == 7, 4),
            _ => {
                return Err(format!(
                    "its bytes have the CDR representation {kind}; expected 0, 1 (CDR), 6 or 7 (plain XCDR2)"
                ));
            }
        };
        let mut reader = Reader { body, at: 0, is_little, max_alignment };
        reader.node(&self.root, row)?;
        let rest = body.len() - reader.at;
        // Writers fill up to four or eight bytes.
        if rest >= 8 {
            return Err(format!("it has {rest} bytes more than its definition describes"));
        }
        Ok(())
    }
}

/// One line of a definition.
struct Field {
    kind: String,
    name: String,
    array: Size,
}

#[derive(Clone, Copy)]
enum Size {
    One,
    Fixed(usize),
    Varying,
}

/// `package/msg/Type` as `package/Type`, the form in which definitions name each other.
fn short(name: &str) -> String {
    name.replace("/msg/", "/").replace("/srv/", "/").replace("/action/", "/")
}

/// The definition of a message and of those in it, by name.
fn definitions(name: &str, text: &str) -> Result<BTreeMap<String, Vec<Field>>, String> {
    let mut all = BTreeMap::new();
    let (mut own, mut fields, mut is_head) = (short(name), Vec::new(), false);
    for (i, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.len() >= 3 && line.bytes().all(|b| b == b'=') {
            all.insert(std::mem::take(&mut own), std::mem::take(&mut fields));
            is_head = true;
        } else if let Some(head) = line.strip_prefix("MSG:").filter(|_| is_head) {
            own = short(head.trim());
            is_head = false;
        } else if line.starts_with("IDL:") && is_head {
            return Err("it is defined in IDL".to_owned());
        } else if let Some(field) = field(line).map_err(|e| format!("line {} of its definition: {e}", i + 1))? {
            fields.push(field);
        }
    }
    all.insert(own, fields);
    Ok(all)
}

/// A line as a field; none for constants, comments and blank lines.
fn field(line: &str) -> Result<Option<Field>, String> {
    let code = line.split('#').next().unwrap_or_default().trim();
    let Some((kind, rest)) = code.split_once(char::is_whitespace) else {
        return if code.is_empty() { Ok(None) } else { Err(format!("`{code}` has no name; expected `type name`")) };
    };
    let rest = rest.trim();
    let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
    let (name, rest) = rest.split_at(end);
    if rest.trim_start().starts_with('=') {
        return Ok(None);
    }
    if name.is_empty() {
        return Err(format!("`{code}` is not a field; expected `type name`"));
    }
    let (kind, array) = match kind.split_once('[') {
        None => (kind, Size::One),
        Some((kind, size)) => {
            let size = size.strip_suffix(']').ok_or_else(|| format!("`{code}`: a bracket is not closed"))?;
            let is_varying = size.is_empty() || size.starts_with("<=");
            let fixed = || size.parse().map(Size::Fixed).map_err(|_| format!("`{code}`: `{size}` is not a length"));
            (kind, if is_varying { Size::Varying } else { fixed()? })
        }
    };
    Ok(Some(Field { kind: kind.to_owned(), name: name.to_owned(), array }))
}

struct Compiler<'a> {
    definitions: &'a BTreeMap<String, Vec<Field>>,
    columns: Vec<String>,
    skipped: Vec<String>,
    n_parts: usize,
}

impl Compiler<'_> {
    /// A named type; its numbers have columns where `is_kept`.
    fn named(&mut self, name: &str, path: &str, is_kept: bool, depth: usize) -> Result<Node, String> {
        if depth > MAX_DEPTH || self.columns.len() > MAX_COLUMNS {
            return Err(format!(
                "{name} lies more than {MAX_DEPTH} definitions deep, or has more than {MAX_COLUMNS} numbers"
            ));
        }
        let (package, _) = name.split_once('/').unwrap_or_default();
        let definitions = self.definitions;
        let Some(fields) = definitions.get(name) else {
            return match name {
                "builtin_interfaces/Time" | "builtin_interfaces/Duration" => Ok(self.times(path, is_kept)),
                _ => Err(format!("the definition of {name} is missing")),
            };
        };
        if fields.is_empty() {
            // A message without fields has one byte: IDL knows no empty structures.
            return Ok(Node::Number(Number::U8, None));
        }
        let parts = fields.iter().map(|field| {
            let path = if path.is_empty() { field.name.clone() } else { format!("{path}.{}", field.name) };
            match field.array {
                Size::One => self.one(&field.kind, package, &path, is_kept, depth),
                Size::Fixed(n) if n <= MAX_ARRAY && is_kept && !is_text(&field.kind) => {
                    let each = (0..n).map(|i| self.one(&field.kind, package, &format!("{path}_{i}"), true, depth));
                    Ok(Node::All(each.collect::<Result<_, _>>()?))
                }
                Size::Fixed(n) => {
                    self.skip(is_kept, &path, &format!("{n} {}", plural(&field.kind)));
                    Ok(Node::Array(n, Box::new(self.one(&field.kind, package, &path, false, depth)?)))
                }
                Size::Varying => {
                    self.skip(is_kept, &path, &format!("a varying number of {}", plural(&field.kind)));
                    Ok(Node::Sequence(Box::new(self.one(&field.kind, package, &path, false, depth)?)))
                }
            }
        });
        Ok(Node::All(parts.collect::<Result<_, _>>()?))
    }

    fn one(&mut self, kind: &str, package: &str, path: &str, is_kept: bool, depth: usize) -> Result<Node, String> {
        self.n_parts += 1;
        if self.n_parts > MAX_PARTS {
            return Err(format!("it has more than {MAX_PARTS} parts"));
        }
        if let Some(number) = Number::of(kind) {
            let column = is_kept.then(|| {
                self.columns.push(path.to_owned());
                self.columns.len() - 1
            });
            return Ok(Node::Number(number, column));
        }
        if is_text(kind) {
            self.skip(is_kept, path, "text");
            return if kind.starts_with('w') {
                Err(format!("{path} is a wstring, which ROS 2 writes in two ways"))
            } else {
                Ok(Node::Text)
            };
        }
        let name = match kind {
            "Header" => "std_msgs/Header".to_owned(),
            _ if kind.contains('/') => short(kind),
            _ => format!("{package}/{kind}"),
        };
        self.named(&name, path, is_kept, depth + 1)
    }

    /// `int32 sec`, `uint32 nanosec`, which definitions may leave out.
    fn times(&mut self, path: &str, is_kept: bool) -> Node {
        let mut part = |name: &str, number| {
            let column = is_kept.then(|| {
                self.columns.push(format!("{path}.{name}"));
                self.columns.len() - 1
            });
            Node::Number(number, column)
        };
        Node::All(vec![part("sec", Number::I32), part("nanosec", Number::U32)])
    }

    fn skip(&mut self, is_kept: bool, path: &str, what: &str) {
        if is_kept {
            self.skipped.push(format!("{path} ({what})"));
        }
    }
}

fn is_text(kind: &str) -> bool {
    let base = kind.split("<=").next().unwrap_or_default();
    matches!(base, "string" | "wstring")
}

fn plural(kind: &str) -> String {
    if is_text(kind) { "texts".to_owned() } else { format!("{kind} values") }
}

/// The bytes of a message behind its first four.
struct Reader<'a> {
    body: &'a [u8],
    at: usize,
    is_little: bool,
    max_alignment: usize,
}

impl Reader<'_> {
    fn node(&mut self, node: &Node, row: &mut [f64]) -> Result<(), String> {
        match node {
            Node::Number(number, column) => {
                let value = self.number(*number)?;
                if let Some(cell) = column.and_then(|column| row.get_mut(column)) {
                    *cell = value;
                }
            }
            Node::Text => {
                let length = self.length()?;
                self.take(length)?;
            }
            Node::All(nodes) => {
                for node in nodes {
                    self.node(node, row)?;
                }
            }
            Node::Array(n, node) => self.many(*n, node, row)?,
            Node::Sequence(node) => {
                let n = self.length()?;
                self.many(n, node, row)?;
            }
        }
        Ok(())
    }

    fn many(&mut self, n: usize, node: &Node, row: &mut [f64]) -> Result<(), String> {
        if let Node::Number(number, None) = node
            && n > 0
        {
            self.align(number.size());
            let bytes = n.checked_mul(number.size()).ok_or("it claims more elements than it has bytes")?;
            self.take(bytes)?;
            return Ok(());
        }
        // Every element takes a byte at least, so this ends with the message.
        for _ in 0..n {
            let before = self.at;
            self.node(node, row)?;
            if self.at == before {
                break;
            }
        }
        Ok(())
    }

    fn align(&mut self, size: usize) {
        self.at = self.at.next_multiple_of(size.min(self.max_alignment).max(1));
    }

    fn length(&mut self) -> Result<usize, String> {
        Ok(self.number(Number::U32)? as usize)
    }

    fn take(&mut self, n: usize) -> Result<&[u8], String> {
        let end = self.at.checked_add(n);
        let bytes = end.and_then(|end| self.body.get(self.at..end));
        let found = bytes
            .ok_or_else(|| format!("it has {} bytes behind its head, too few for its definition", self.body.len()))?;
        self.at += n;
        Ok(found)
    }

    fn number(&mut self, number: Number) -> Result<f64, String> {
        self.align(number.size());
        let is_little = self.is_little;
        let taken = self.take(number.size())?;
        let mut bytes = [0; 8];
        for (to, from) in bytes.iter_mut().zip(taken) {
            *to = *from;
        }
        if !is_little && let Some(bytes) = bytes.get_mut(..number.size()) {
            bytes.reverse();
        }
        let whole = u64::from_le_bytes(bytes);
        Ok(match number {
            Number::U8 | Number::U16 | Number::U32 | Number::U64 => whole as f64,
            Number::I8 => f64::from(whole as u8 as i8),
            Number::I16 => f64::from(whole as u16 as i16),
            Number::I32 => f64::from(whole as u32 as i32),
            Number::I64 => whole as i64 as f64,
            Number::F32 => f64::from(f32::from_bits(whole as u32)),
            Number::F64 => f64::from_bits(whole),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "\
# A wrench that was measured
std_msgs/Header header
uint8 MAX=3        # a constant
float64 force -1.5
bool[3] is_wet
int16[20] raw
float32[] many
string<=5 note \"#\"
Pair pair
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
===
MSG: lab_msgs/Pair
int8 a
uint64 b
";

    #[test]
    fn a_definition_gives_columns_and_names_what_is_passed_over() {
        let message = Message::parse("lab_msgs/msg/Force", TEXT).unwrap();
        let names = [
            "header.stamp.sec",
            "header.stamp.nanosec",
            "force",
            "is_wet_0",
            "is_wet_1",
            "is_wet_2",
            "pair.a",
            "pair.b",
        ];
        assert_eq!(message.columns, names);
        let skipped = [
            "header.frame_id (text)",
            "raw (20 int16 values)",
            "many (a varying number of float32 values)",
            "note (text)",
        ];
        assert_eq!(message.skipped, skipped);
    }

    #[test]
    fn bytes_are_read_in_both_orders() {
        let message = Message::parse("p/msg/T", "int8 a\nfloat64 b\nuint16 c").unwrap();
        for is_little in [true, false] {
            let mut data = vec![0, u8::from(is_little), 0, 0, 0xff, 0, 0, 0, 0, 0, 0, 0];
            let (b, c) = (2.5_f64, 513_u16);
            data.extend(if is_little { b.to_le_bytes() } else { b.to_be_bytes() });
            data.extend(if is_little { c.to_le_bytes() } else { c.to_be_bytes() });
            let mut row = [f64::NAN; 3];
            message.decode(&data, &mut row).unwrap();
            assert_eq!(row, [-1.0, 2.5, 513.0]);
            let short = message.decode(&data[..data.len() - 1], &mut row).unwrap_err();
            assert_eq!(short, "it has 17 bytes behind its head, too few for its definition");
            data.extend([0; 8]);
            assert_eq!(
                message.decode(&data, &mut row).unwrap_err(),
                "it has 8 bytes more than its definition describes"
            );
        }
        let other = message.decode(&[0, 3, 0, 0], &mut []).unwrap_err();
        assert_eq!(other, "its bytes have the CDR representation 3; expected 0, 1 (CDR), 6 or 7 (plain XCDR2)");
    }

    #[test]
    fn what_is_not_understood_is_named() {
        for (text, problem) in [
            ("float64", "line 1 of its definition: `float64` has no name; expected `type name`"),
            ("float64[x] a", "line 1 of its definition: `float64[x] a`: `x` is not a length"),
            ("Other a", "the definition of p/Other is missing"),
            ("wstring a", "a is a wstring, which ROS 2 writes in two ways"),
            ("T t", "p/T lies more than 32 definitions deep, or has more than 10000 numbers"),
        ] {
            assert_eq!(Message::parse("p/msg/T", text).unwrap_err(), problem);
        }
        let bomb = "A[16] a\n===\nMSG: p/A\nB[16] b\n===\nMSG: p/B\nC[16] c\n===\nMSG: p/C\nfloat64[16] x";
        assert!(Message::parse("p/msg/T", bomb).is_err());
        let level = |i: usize| format!("===\nMSG: p/L{i}\n{}", format!("L{}[] a\n", i + 1).repeat(16));
        let deep = format!("L0[] a\n{}===\nMSG: p/L20\nint8 x", (0..20).map(level).collect::<String>());
        assert_eq!(Message::parse("p/msg/T", &deep).unwrap_err(), "it has more than 100000 parts");
    }

    #[test]
    fn a_length_that_is_a_lie_takes_no_time() {
        let message = Message::parse("p/msg/T", "E[] a\nfloat64 b\n===\nMSG: p/E\nstring s").unwrap();
        let mut data = vec![0, 1, 0, 0];
        data.extend(u32::MAX.to_le_bytes());
        assert!(message.decode(&data, &mut [0.0]).is_err());
    }
}
