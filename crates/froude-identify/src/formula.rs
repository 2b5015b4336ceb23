//! Force laws as a person writes them: `f_y = "Y_v*v + Y_vav*v*abs(v)"`.
//!
//! The text is parsed by `exmex` over values that are affine in the coefficients:
//! each carries, per coefficient, the program that computes its regressor and the
//! unit of that program. So the parse itself proves that the law is linear in its
//! coefficients, and finds the unit of each of them.
//!
//! **Names.** A constant given by name, `pi`, a channel of the table, an alias
//! (`u v w p q r` for `v_x v_y v_z w_x w_y w_z`); every other name is a coefficient,
//! unless it is the name of a load or of a column that the table could have had.
//! **Grammar.** `+ - * / ^`, parentheses, `abs sqrt sin cos tan exp ln sign`.
//! `-v^2` is `-(v^2)`, `a/b*c` is `(a/b)*c`; `a^b^c` is refused as ambiguous.
//! **Units.** SI dimensions; a coefficient has the load's unit over its regressor's.
//! An angle is a pure number.
//!
//! Not here: products of coefficients, terms without a coefficient (fix that
//! coefficient's value instead), fractional units of a coefficient.

use std::fmt::Write as _;
use std::str::FromStr;

use exmex::{BinOp, Express, FlatEx, MakeOperators, MatchLiteral, Operator};

/// Exponents of m, kg, s, K and A.
pub type Dim = [i8; 5];

/// Most characters of a formula.
pub const LENGTH_LIMIT: usize = 4096;
/// Most parentheses open at once.
pub const DEPTH_LIMIT: usize = 24;
/// Most coefficients of a formula.
pub const COEFFICIENT_LIMIT: usize = 64;

/// A law for one load, linear in its coefficients.
#[derive(Debug, Clone, PartialEq)]
pub struct Formula {
    /// The load that it gives, by its column name: `f_x` … `m_z`.
    pub load: String,
    /// The text as written.
    pub text: String,
    /// Coefficients and their dimensions, in order of first appearance.
    pub coefficients: Vec<(String, Dim)>,
    /// Channels that it reads, by column name, in order of first appearance.
    pub channels: Vec<String>,
    /// Whether one of the coefficients is an offset: its regressor reads no channel.
    pub offset: bool,
    /// A program per coefficient.
    programs: Vec<Vec<Op>>,
}

/// Why a formula cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FormulaError {
    /// Nothing but blanks.
    #[error("the formula is empty; write for example \"Y_v*v + Y_vav*v*abs(v)\"")]
    Empty,
    /// More characters than [`LENGTH_LIMIT`].
    #[error("the formula has {length} characters; at most {LENGTH_LIMIT} are read")]
    TooLong {
        /// How many it has.
        length: usize,
    },
    /// More parentheses open than [`DEPTH_LIMIT`].
    #[error("at character {position} more than {DEPTH_LIMIT} parentheses are open at once")]
    TooDeep {
        /// Counted from 1.
        position: usize,
    },
    /// A character that no formula has.
    #[error(
        "character {position} is {character:?}; a formula is made of names, numbers, \
         + - * / ^ and parentheses"
    )]
    Character {
        /// Counted from 1.
        position: usize,
        /// The character.
        character: char,
    },
    /// A number that is too large, or not one.
    #[error("{text:?} at character {position} is not a finite number")]
    Number {
        /// Counted from 1.
        position: usize,
        /// As written.
        text: String,
    },
    /// Something in a place where it cannot stand.
    #[error("at character {position} stands {found}, but {expected} is expected there")]
    Syntax {
        /// Counted from 1.
        position: usize,
        /// What stands there, in words or in quotes.
        found: String,
        /// What would be right.
        expected: &'static str,
    },
    /// `a^b^c`.
    #[error(
        "at character {position} a power is raised to a power; write (a^b)^c or a^(b^c) to say \
         which is meant"
    )]
    PowerOfPower {
        /// Counted from 1.
        position: usize,
    },
    /// A name before a parenthesis that is no function.
    #[error(
        "{name} at character {position} is not a function; known are abs, sqrt, sin, cos, tan, \
         exp, ln and sign; a product is written {name}*(…)"
    )]
    UnknownFunction {
        /// Counted from 1.
        position: usize,
        /// The name.
        name: String,
    },
    /// The name of a column that the table does not have.
    #[error("{name} is the name of a column, which the table does not have")]
    MissingColumn {
        /// The name.
        name: String,
    },
    /// An alias of a column that the table does not have.
    #[error("{name} stands for the column {column}, which the table does not have")]
    MissingAlias {
        /// As written.
        name: String,
        /// The column's name.
        column: String,
    },
    /// A load on the right side.
    #[error("{name} is the name of a load and cannot stand in a formula; give a coefficient another name")]
    LoadName {
        /// The name.
        name: String,
    },
    /// Coefficients multiplied, or inside a function.
    #[error("the formula is not linear in its coefficients: {term}")]
    NotLinear {
        /// The offending part.
        term: String,
    },
    /// A term without a coefficient.
    #[error(
        "the part {part} has no coefficient; give it one, and fix its value in [identify.fixed] \
         if it is known"
    )]
    FixedPart {
        /// The part.
        part: String,
    },
    /// No coefficient at all.
    #[error("the formula has no coefficient: every name in it is a channel or a constant")]
    NoCoefficient,
    /// More coefficients than [`COEFFICIENT_LIMIT`].
    #[error("the formula has {count} coefficients; at most {COEFFICIENT_LIMIT} are read")]
    TooManyCoefficients {
        /// How many it has.
        count: usize,
    },
    /// A sum of unlike quantities.
    #[error("{left} is {left_unit} and {right} is {right_unit}: they cannot be added")]
    UnlikeSum {
        /// First part.
        left: String,
        /// Its unit.
        left_unit: String,
        /// Second part.
        right: String,
        /// Its unit.
        right_unit: String,
    },
    /// One coefficient beside two units.
    #[error(
        "the coefficient {coefficient} stands beside {first} in one term and beside {second} in \
         another; give the two terms different names"
    )]
    CoefficientUnits {
        /// Its name.
        coefficient: String,
        /// Unit of the first regressor.
        first: String,
        /// Unit of the second.
        second: String,
    },
    /// A function of a quantity with a unit.
    #[error("{function}({argument}) needs a pure number, but {argument} is {unit}")]
    DimensionalArgument {
        /// The function.
        function: &'static str,
        /// Its argument.
        argument: String,
        /// The argument's unit.
        unit: String,
    },
    /// An exponent with a unit, or one that varies under a base with a unit.
    #[error("the exponent {exponent} of {base} {reason}")]
    Exponent {
        /// The exponent.
        exponent: String,
        /// The base.
        base: String,
        /// What is wrong.
        reason: String,
    },
    /// The unit of a coefficient would have a fractional power, or a huge one.
    #[error(
        "the coefficient {coefficient} would have the unit {unit}; only whole powers up to 127 \
         can be recorded"
    )]
    CoefficientUnit {
        /// Its name.
        coefficient: String,
        /// The unit it would have.
        unit: String,
    },
    /// A constant part that cannot be computed.
    #[error("{part} is not a finite number")]
    NotFinite {
        /// The part.
        part: String,
    },
    /// A coefficient times zero.
    #[error("the coefficient {coefficient} is multiplied by zero")]
    ZeroRegressor {
        /// Its name.
        coefficient: String,
    },
    /// The expression library refused what our own check let pass.
    #[error("the formula cannot be read: {message}")]
    Parser {
        /// The library's words.
        message: String,
    },
}

/// Column name of a motion alias: `u v w p q r`.
#[must_use]
pub fn channel_of_alias(name: &str) -> Option<&'static str> {
    Some(match name {
        "u" => "v_x",
        "v" => "v_y",
        "w" => "v_z",
        "p" => "w_x",
        "q" => "w_y",
        "r" => "w_z",
        _ => return None,
    })
}

/// Column name of a load, itself or by its alias: `X Y Z K M N`.
#[must_use]
pub fn load_column(name: &str) -> Option<&'static str> {
    Some(match name {
        "X" | "f_x" => "f_x",
        "Y" | "f_y" => "f_y",
        "Z" | "f_z" => "f_z",
        "K" | "m_x" => "m_x",
        "M" | "m_y" => "m_y",
        "N" | "m_z" => "m_z",
        _ => return None,
    })
}

/// Names of columns that a table may have: never a coefficient by oversight.
fn is_column_name(name: &str) -> bool {
    let base = name.strip_suffix("_dot").unwrap_or(name);
    matches!(
        base,
        "v_x"
            | "v_y"
            | "v_z"
            | "w_x"
            | "w_y"
            | "w_z"
            | "speed"
            | "angle"
            | "temperature"
            | "n_links"
            | "density"
            | "kinematic_viscosity"
            | "repeat"
            | "configuration"
    ) || base.starts_with("std_")
}

impl Formula {
    /// Reads a formula for `load` (column name or alias).
    ///
    /// `channels` gives the dimension of a column of the table, `None` where there is
    /// none; `load_dim` is the load's; `constants` are known numbers in SI by name, and
    /// come before channels of the same name.
    ///
    /// # Errors
    ///
    /// [`FormulaError`]: bad text, not linear, unlike units, nothing to find.
    ///
    /// # Example
    ///
    /// ```
    /// use froude_identify::formula::Formula;
    /// let speed = [1, 0, -1, 0, 0];
    /// let newton = [1, 1, -2, 0, 0];
    /// let columns = |name: &str| (name == "v_y").then_some(speed);
    /// let sway = Formula::parse("Y", "Y_v*v + Y_vav*v*abs(v)", &columns, newton, &[])?;
    /// assert_eq!(sway.channels, ["v_y"]);
    /// assert_eq!(sway.coefficients[1], ("Y_vav".to_owned(), [-1, 1, 0, 0, 0])); // kg/m
    /// let mut row = [0.0; 2];
    /// sway.regressor(&[-0.5], &mut row);
    /// assert_eq!(row, [-0.5, -0.25]);
    /// # Ok::<(), froude_identify::formula::FormulaError>(())
    /// ```
    pub fn parse(
        load: &str,
        text: &str,
        channels: &dyn Fn(&str) -> Option<Dim>,
        load_dim: Dim,
        constants: &[(String, f64, Dim)],
    ) -> Result<Self, FormulaError> {
        let tokens = tokens(text)?;
        check_grammar(&tokens)?;

        // What each name is, in order of appearance.
        let mut names: Vec<(&str, Term)> = Vec::new();
        let mut columns: Vec<String> = Vec::new();
        let mut coefficients: Vec<&str> = Vec::new();
        for (i, token) in tokens.iter().enumerate() {
            let Token { kind: Kind::Name, text: name, .. } = *token else { continue };
            if is_call(&tokens, i) || names.iter().any(|(known, _)| *known == name) {
                continue;
            }
            names.push((name, resolve(name, channels, constants, &mut columns, &mut coefficients)?));
        }
        if coefficients.len() > COEFFICIENT_LIMIT {
            return Err(FormulaError::TooManyCoefficients { count: coefficients.len() });
        }

        let canonical = canonical_text(&tokens);
        let parser = |e: exmex::ExError| FormulaError::Parser { message: e.to_string() };
        let expression = FlatEx::<Term, Operators, Literals>::parse_wo_compile(&canonical).map_err(parser)?;
        let values: Vec<Term> = expression
            .var_names()
            .iter()
            .map(|variable| {
                let known = names.iter().find(|(name, _)| name == variable);
                known
                    .map(|(_, term)| term.clone())
                    .ok_or_else(|| FormulaError::Parser { message: format!("unknown name {variable}") })
            })
            .collect::<Result<_, _>>()?;
        let affine = expression.eval(&values).map_err(parser)?.0?;

        if let Some(part) = affine.fixed.as_ref().filter(|part| !part.is_zero()) {
            if affine.parts.is_empty() {
                return Err(FormulaError::NoCoefficient);
            }
            return Err(FormulaError::FixedPart { part: part.text.clone() });
        }
        if affine.parts.is_empty() {
            return Err(FormulaError::NoCoefficient);
        }
        let mut out = Self {
            load: load_column(load).unwrap_or(load).to_owned(),
            text: text.to_owned(),
            coefficients: Vec::new(),
            channels: columns,
            offset: false,
            programs: Vec::new(),
        };
        for name in coefficients {
            let Some((_, part)) = affine.parts.iter().find(|(known, _)| known == name) else {
                return Err(FormulaError::ZeroRegressor { coefficient: name.to_owned() });
            };
            if part.is_zero() {
                return Err(FormulaError::ZeroRegressor { coefficient: name.to_owned() });
            }
            let unit = Unit::of(load_dim).over(part.unit);
            let dim = unit.whole().ok_or_else(|| FormulaError::CoefficientUnit {
                coefficient: name.to_owned(),
                unit: unit.to_string(),
            })?;
            out.offset |= !part.program.iter().any(|op| matches!(op, Op::Channel(_)));
            out.coefficients.push((name.to_owned(), dim));
            out.programs.push(part.program.clone());
        }
        Ok(out)
    }

    /// What a unit of each coefficient adds to the load, SI.
    ///
    /// `values` are the channels in the order of [`Formula::channels`], SI; `out[j]`
    /// belongs to `coefficients[j]`. A channel without a value counts as NaN; of `out`
    /// as many are written as it holds. A regressor outside a function's domain
    /// (`sqrt`, `ln` of a negative number) is NaN.
    pub fn regressor(&self, values: &[f64], out: &mut [f64]) {
        let mut stack = Vec::with_capacity(16);
        for (value, program) in out.iter_mut().zip(&self.programs) {
            *value = run(program, values, &mut stack);
        }
    }
}

fn resolve<'a>(
    name: &'a str,
    channels: &dyn Fn(&str) -> Option<Dim>,
    constants: &[(String, f64, Dim)],
    columns: &mut Vec<String>,
    coefficients: &mut Vec<&'a str>,
) -> Result<Term, FormulaError> {
    if let Some((_, value, dim)) = constants.iter().find(|(known, ..)| known == name) {
        if !value.is_finite() {
            return Err(FormulaError::NotFinite { part: name.to_owned() });
        }
        return Ok(Term::fixed(vec![Op::Number(*value)], Unit::of(*dim), name));
    }
    if name == "pi" {
        return Ok(Term::fixed(vec![Op::Number(std::f64::consts::PI)], Unit::ONE, name));
    }
    let aliased = channel_of_alias(name);
    let column = aliased.filter(|column| channels(column).is_some()).unwrap_or(name);
    if load_column(name).is_some() {
        return Err(FormulaError::LoadName { name: name.to_owned() });
    }
    if let Some(dim) = channels(column) {
        let index = columns.iter().position(|known| known == column).unwrap_or_else(|| {
            columns.push(column.to_owned());
            columns.len() - 1
        });
        return Ok(Term::fixed(vec![Op::Channel(index)], Unit::of(dim), name));
    }
    if let Some(column) = aliased {
        return Err(FormulaError::MissingAlias { name: name.to_owned(), column: column.to_owned() });
    }
    if is_column_name(name) {
        return Err(FormulaError::MissingColumn { name: name.to_owned() });
    }
    coefficients.push(name);
    Ok(Term::coefficient(name))
}

// Text: tokens, grammar, and the form handed to the expression library.

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Name,
    Number,
    Sign,     // + or -
    Operator, // * / ^
    Open,
    Close,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Token<'a> {
    kind: Kind,
    text: &'a str,
    /// In characters, counted from 1.
    position: usize,
}

const FUNCTIONS: [&str; 8] = ["abs", "sqrt", "sin", "cos", "tan", "exp", "ln", "sign"];

fn tokens(text: &str) -> Result<Vec<Token<'_>>, FormulaError> {
    if text.trim().is_empty() {
        return Err(FormulaError::Empty);
    }
    let length = text.chars().count();
    if length > LENGTH_LIMIT {
        return Err(FormulaError::TooLong { length });
    }
    // From here on every character that passes is one byte: byte place = character place.
    let bytes = text.as_bytes();
    let mut out = Vec::new();
    let mut at = 0;
    while let Some(&byte) = bytes.get(at) {
        let rest = &bytes[at..];
        let count = |f: fn(&u8) -> bool| rest.iter().take_while(|b| f(b)).count();
        let (kind, n) = match byte {
            b' ' | b'\t' | b'\n' | b'\r' => {
                at += 1;
                continue;
            }
            b'a'..=b'z' | b'A'..=b'Z' | b'_' => (Kind::Name, count(|b| b.is_ascii_alphanumeric() || *b == b'_')),
            b'0'..=b'9' | b'.' => (Kind::Number, number_length(rest)),
            b'+' | b'-' => (Kind::Sign, 1),
            b'*' | b'/' | b'^' => (Kind::Operator, 1),
            b'(' => (Kind::Open, 1),
            b')' => (Kind::Close, 1),
            _ => {
                let character = text.get(at..).and_then(|rest| rest.chars().next());
                return Err(FormulaError::Character { position: at + 1, character: character.unwrap_or('\u{fffd}') });
            }
        };
        let position = at + 1;
        let text = &text[at..at + n];
        let is_finite = |text: &str| f64::from_str(text).is_ok_and(f64::is_finite);
        if kind == Kind::Number && !is_finite(text) {
            return Err(FormulaError::Number { position, text: text.to_owned() });
        }
        out.push(Token { kind, text, position });
        at += n;
    }
    Ok(out)
}

/// Length of `12`, `1.5`, `.5`, `2e-3` at the start of the bytes; at least 1.
fn number_length(bytes: &[u8]) -> usize {
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let mut n = digits(0);
    if bytes.get(n) == Some(&b'.') {
        n += 1;
        n += digits(n);
    }
    if matches!(bytes.get(n), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(n + 1), Some(b'+' | b'-')));
        let exponent = bytes.get(n + 1 + sign).map_or(0, |_| digits(n + 1 + sign));
        if exponent > 0 {
            n += 1 + sign + exponent;
        }
    }
    n
}

/// Whether the name at `i` is a function with its argument.
fn is_call(tokens: &[Token], i: usize) -> bool {
    FUNCTIONS.contains(&tokens[i].text) && tokens.get(i + 1).is_some_and(|next| next.kind == Kind::Open)
}

const OPERAND: &str = "a name, a number or \"(\"";
const OPERATOR: &str = "an operator or the end";

fn check_grammar(tokens: &[Token]) -> Result<(), FormulaError> {
    let mut open: Vec<usize> = Vec::new(); // positions of open parentheses
    // Whether the operand just ended was the exponent of a power, per open parenthesis.
    let mut in_exponent = vec![false];
    let mut wants_operand = true;
    for (i, token) in tokens.iter().enumerate() {
        let Token { kind, text, position } = *token;
        let wrong = |expected: &'static str| FormulaError::Syntax { position, found: format!("{text:?}"), expected };
        match (kind, wants_operand) {
            (Kind::Name | Kind::Number, true) => {
                let called = tokens.get(i + 1).is_some_and(|next| next.kind == Kind::Open);
                let is_function = FUNCTIONS.contains(&text);
                if kind == Kind::Name && is_function && !called {
                    let next = tokens.get(i + 1);
                    return Err(FormulaError::Syntax {
                        position: next.map_or(position + text.len(), |t| t.position),
                        found: next.map_or("the end".to_owned(), |t| format!("{:?}", t.text)),
                        expected: "\"(\" after a function's name",
                    });
                }
                if kind == Kind::Name && called && !is_function {
                    return Err(FormulaError::UnknownFunction { position, name: text.to_owned() });
                }
                wants_operand = kind == Kind::Name && is_function;
            }
            (Kind::Open, true) => {
                open.push(position);
                in_exponent.push(false);
                if open.len() > DEPTH_LIMIT {
                    return Err(FormulaError::TooDeep { position });
                }
            }
            (Kind::Sign, true) => {
                // One sign before an operand; before an exponent only a number takes it.
                let before = i.checked_sub(1).map(|j| tokens[j]);
                let after_power = before.is_some_and(|t| t.text == "^");
                if before.is_some_and(|t| t.kind == Kind::Sign) && i >= 2 {
                    let two_back = tokens[i - 2].kind;
                    if !matches!(two_back, Kind::Name | Kind::Number | Kind::Close) {
                        return Err(wrong(OPERAND));
                    }
                } else if before.is_some_and(|t| t.kind == Kind::Sign) {
                    return Err(wrong(OPERAND));
                }
                if after_power && tokens.get(i + 1).is_none_or(|t| t.kind != Kind::Number) {
                    return Err(wrong("a number or \"(\" as the exponent"));
                }
            }
            (Kind::Operator | Kind::Close, true) => return Err(wrong(OPERAND)),
            (Kind::Name | Kind::Number | Kind::Open, false) => return Err(wrong(OPERATOR)),
            (Kind::Close, false) => {
                if open.pop().is_none() {
                    return Err(wrong("no \")\" without its \"(\""));
                }
                in_exponent.pop();
            }
            (Kind::Sign | Kind::Operator, false) => {
                let level = in_exponent.last_mut();
                let is_power = text == "^";
                if let Some(level) = level {
                    if is_power && *level {
                        return Err(FormulaError::PowerOfPower { position });
                    }
                    *level = is_power;
                }
                wants_operand = true;
            }
        }
    }
    let end = tokens.last().map_or(1, |t| t.position + t.text.len());
    let at_end = |expected| FormulaError::Syntax { position: end, found: "the end".to_owned(), expected };
    if wants_operand {
        return Err(at_end(OPERAND));
    }
    if !open.is_empty() {
        return Err(at_end("\")\""));
    }
    Ok(())
}

/// The text with signs made into products and names in braces, as the library reads
/// it without doubt: there `-v^2` would be `(-v)^2`, and `1e-3` a sum.
fn canonical_text(tokens: &[Token]) -> String {
    let mut out = String::new();
    for (i, token) in tokens.iter().enumerate() {
        let before = i.checked_sub(1).map(|j| tokens[j]);
        match token.kind {
            Kind::Name if !is_call(tokens, i) => {
                let _ = write!(out, "{{{}}}", token.text);
            }
            Kind::Sign if before.is_none_or(|t| !matches!(t.kind, Kind::Name | Kind::Number | Kind::Close)) => {
                // ~ is minus one; after / it divides, which is the same.
                match (token.text, before.map(|t| t.text)) {
                    ("-", Some("^")) => out.push('~'), // ~2 is minus two
                    ("-", Some("/")) => out.push_str("~/"),
                    ("-", _) => out.push_str("~*"),
                    _ => {}
                }
            }
            _ => out.push_str(token.text),
        }
    }
    out
}

/// Literals: numbers, `~` for minus one, `~2` for minus two.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Literals;

impl MatchLiteral for Literals {
    fn is_literal(text: &str) -> Option<&str> {
        let bytes = text.as_bytes();
        let sign = usize::from(bytes.first() == Some(&b'~'));
        let starts = matches!(bytes.get(sign), Some(b'0'..=b'9' | b'.'));
        let length = sign + if starts { number_length(&bytes[sign..]) } else { 0 };
        if length == 0 { None } else { text.get(..length) }
    }
}

// Values: affine in the coefficients, each part a program with a unit.

#[derive(Debug, Clone, Copy, PartialEq)]
enum Op {
    Number(f64),
    Channel(usize),
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    WholePower(i32),
    Negate,
    Function(Function),
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Function {
    Abs,
    Sqrt,
    Sin,
    Cos,
    Tan,
    Exp,
    Ln,
    Sign,
}

impl Function {
    const fn name(self) -> &'static str {
        match self {
            Self::Abs => "abs",
            Self::Sqrt => "sqrt",
            Self::Sin => "sin",
            Self::Cos => "cos",
            Self::Tan => "tan",
            Self::Exp => "exp",
            Self::Ln => "ln",
            Self::Sign => "sign",
        }
    }

    fn of(self, x: f64) -> f64 {
        match self {
            Self::Abs => x.abs(),
            Self::Sqrt => x.sqrt(),
            Self::Sin => x.sin(),
            Self::Cos => x.cos(),
            Self::Tan => x.tan(),
            Self::Exp => x.exp(),
            Self::Ln => x.ln(),
            Self::Sign if x == 0.0 => 0.0,
            Self::Sign => x.signum(),
        }
    }
}

/// Runs a program in postfix order; NaN for a missing channel.
fn run(program: &[Op], values: &[f64], stack: &mut Vec<f64>) -> f64 {
    stack.clear();
    for op in program {
        let value = match *op {
            Op::Number(x) => x,
            Op::Channel(i) => values.get(i).copied().unwrap_or(f64::NAN),
            Op::Negate => -stack.pop().unwrap_or(f64::NAN),
            Op::WholePower(n) => stack.pop().unwrap_or(f64::NAN).powi(n),
            Op::Function(function) => function.of(stack.pop().unwrap_or(f64::NAN)),
            Op::Add | Op::Subtract | Op::Multiply | Op::Divide | Op::Power => {
                let right = stack.pop().unwrap_or(f64::NAN);
                let left = stack.pop().unwrap_or(f64::NAN);
                match *op {
                    Op::Add => left + right,
                    Op::Subtract => left - right,
                    Op::Multiply => left * right,
                    Op::Divide => left / right,
                    _ => left.powf(right),
                }
            }
        };
        stack.push(value);
    }
    stack.pop().unwrap_or(f64::NAN)
}

/// Exponents in twelfths, so that halves, thirds and quarters are exact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Unit([i32; 5]);

const TWELVE: i32 = 12;
/// No exponent grows beyond this many twelfths; further ones stay there and are refused.
const LARGEST: i32 = 1 << 20;

impl Unit {
    const ONE: Self = Self([0; 5]);

    fn of(dim: Dim) -> Self {
        Self(dim.map(|x| i32::from(x) * TWELVE))
    }

    fn with(self, other: Self, f: fn(i32, i32) -> i32) -> Self {
        let mut out = [0; 5];
        for (i, x) in out.iter_mut().enumerate() {
            *x = f(self.0[i], other.0[i]).clamp(-LARGEST, LARGEST);
        }
        Self(out)
    }

    fn times(self, other: Self) -> Self {
        self.with(other, |a, b| a + b)
    }

    fn over(self, other: Self) -> Self {
        self.with(other, |a, b| a - b)
    }

    /// `None` where a twelfth is not enough, or the exponent is huge.
    fn power(self, exponent: f64) -> Option<Self> {
        let mut out = [0; 5];
        for (x, &from) in out.iter_mut().zip(&self.0) {
            let exact = f64::from(from) * exponent;
            let rounded = exact.round();
            if (exact - rounded).abs() > 1e-9 || rounded.abs() > f64::from(LARGEST) {
                return None;
            }
            *x = rounded as i32;
        }
        Some(Self(out))
    }

    fn whole(self) -> Option<Dim> {
        let mut out = [0; 5];
        for (x, twelfths) in out.iter_mut().zip(self.0) {
            if twelfths % TWELVE != 0 {
                return None;
            }
            *x = i8::try_from(twelfths / TWELVE).ok().filter(|x| *x != i8::MIN)?;
        }
        Some(out)
    }
}

/// `kg/m`, `m^2/s^2`, `N`, `N m`, `1/s`; `1` for a pure number.
impl std::fmt::Display for Unit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        const NEWTON: Unit = Unit([TWELVE, TWELVE, -2 * TWELVE, 0, 0]);
        const NEWTON_METRE: Unit = Unit([2 * TWELVE, TWELVE, -2 * TWELVE, 0, 0]);
        if *self == NEWTON {
            return f.write_str("N");
        }
        if *self == NEWTON_METRE {
            return f.write_str("N m");
        }
        // Mass first, as in kg m/s^2.
        let named = [("kg", self.0[1]), ("m", self.0[0]), ("s", self.0[2]), ("K", self.0[3]), ("A", self.0[4])];
        let power = |name: &str, twelfths: i32| match twelfths {
            TWELVE => name.to_owned(),
            _ if twelfths % TWELVE == 0 => format!("{name}^{}", twelfths / TWELVE),
            _ if twelfths % 6 == 0 => format!("{name}^({}/2)", twelfths / 6),
            _ => format!("{name}^({twelfths}/12)"),
        };
        let above: Vec<String> = named.iter().filter(|(_, x)| *x > 0).map(|(name, x)| power(name, *x)).collect();
        let below: Vec<String> = named.iter().filter(|(_, x)| *x < 0).map(|(name, x)| power(name, -*x)).collect();
        f.write_str(if above.is_empty() { "1" } else { "" })?;
        f.write_str(&above.join(" "))?;
        match below.as_slice() {
            [] => Ok(()),
            [one] => write!(f, "/{one}"),
            many => write!(f, "/({})", many.join(" ")),
        }
    }
}

/// How tightly the outermost operator of a text binds.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
enum Binding {
    Sum,
    Product,
    Power,
    Atom,
}

/// A quantity without coefficients.
#[derive(Debug, Clone)]
struct Part {
    program: Vec<Op>,
    unit: Unit,
    /// As a reader would write it, for messages.
    text: String,
    binding: Binding,
}

impl Part {
    fn one() -> Self {
        Self { program: vec![Op::Number(1.0)], unit: Unit::ONE, text: "1".to_owned(), binding: Binding::Atom }
    }

    fn number(&self) -> Option<f64> {
        match self.program[..] {
            [Op::Number(x)] => Some(x),
            _ => None,
        }
    }

    fn is_zero(&self) -> bool {
        self.number() == Some(0.0)
    }

    fn is(&self, value: f64) -> bool {
        self.number() == Some(value) && self.unit == Unit::ONE && self.text.starts_with(['1', '-'])
    }

    /// The text, in parentheses where it binds less tightly than its place asks.
    fn inside(&self, binding: Binding) -> String {
        if self.binding < binding { format!("({})", self.text) } else { self.text.clone() }
    }

    /// Appends `other` and `op`; folds the program where both are numbers.
    fn join(&mut self, op: Op, other: &Self) {
        let folds = self.number().is_some() && other.number().is_some();
        self.program.extend_from_slice(&other.program);
        self.program.push(op);
        if folds {
            self.program = vec![Op::Number(run(&self.program, &[], &mut Vec::new()))];
        }
    }

    /// As it is, if a program that is one number has a finite one.
    fn finite(self) -> Result<Self, FormulaError> {
        if self.number().is_some_and(|x| !x.is_finite()) {
            return Err(FormulaError::NotFinite { part: self.text });
        }
        Ok(self)
    }

    fn labelled(mut self, text: String, binding: Binding) -> Result<Self, FormulaError> {
        self.text = shortened(text);
        self.binding = binding;
        self.finite()
    }

    fn sum(mut self, other: &Self, op: Op) -> Result<Self, FormulaError> {
        let sign = if op == Op::Add { "+" } else { "-" };
        if self.unit != other.unit {
            return Err(FormulaError::UnlikeSum {
                left: self.text,
                left_unit: self.unit.to_string(),
                right: other.text.clone(),
                right_unit: other.unit.to_string(),
            });
        }
        let right = other.inside(if op == Op::Add { Binding::Sum } else { Binding::Product });
        let text = format!("{} {sign} {right}", self.text);
        self.join(op, other);
        self.labelled(text, Binding::Sum)
    }

    /// `other` is the factor that has no coefficient; `is_first` says on which side it
    /// was written.
    fn product(mut self, other: &Self, is_first: bool) -> Result<Self, FormulaError> {
        if other.is(1.0) {
            return Ok(self);
        }
        if self.is(1.0) {
            return Ok(other.clone());
        }
        if other.is(-1.0) && is_first {
            return Ok(self.negated());
        }
        if self.is(-1.0) && !is_first {
            return Ok(other.clone().negated());
        }
        let (left, right) = if is_first { (other, &self) } else { (&self, other) };
        let text = format!("{}*{}", left.inside(Binding::Product), right.inside(Binding::Power));
        self.unit = self.unit.times(other.unit);
        self.join(Op::Multiply, other);
        self.labelled(text, Binding::Product)
    }

    fn quotient(mut self, other: &Self) -> Result<Self, FormulaError> {
        if other.is(1.0) {
            return Ok(self);
        }
        if other.is(-1.0) {
            return Ok(self.negated());
        }
        let text = format!("{}/{}", self.inside(Binding::Product), other.inside(Binding::Power));
        if other.is_zero() {
            return Err(FormulaError::NotFinite { part: shortened(text) });
        }
        self.unit = self.unit.over(other.unit);
        self.join(Op::Divide, other);
        self.labelled(text, Binding::Product)
    }

    fn negated(mut self) -> Self {
        self.text = shortened(format!("-{}", self.inside(Binding::Product)));
        self.binding = Binding::Product;
        match self.number() {
            Some(x) => self.program = vec![Op::Number(-x)],
            None => self.program.push(Op::Negate),
        }
        self
    }

    fn power(mut self, exponent: &Self) -> Result<Self, FormulaError> {
        let wrong = |reason: String| FormulaError::Exponent {
            exponent: exponent.text.clone(),
            base: self.text.clone(),
            reason,
        };
        if exponent.unit != Unit::ONE {
            return Err(wrong(format!("is {}, but must be a pure number", exponent.unit)));
        }
        if self.unit != Unit::ONE {
            let Some(n) = exponent.number() else {
                return Err(wrong(format!("varies, but the base is {}; its unit would vary too", self.unit)));
            };
            self.unit = self
                .unit
                .power(n)
                .ok_or_else(|| wrong(format!("gives {} a power that cannot be recorded", self.unit)))?;
        }
        let text = format!("{}^{}", self.inside(Binding::Atom), exponent.inside(Binding::Atom));
        let whole = exponent.number().filter(|n| n.fract() == 0.0 && n.abs() <= 64.0);
        match (whole, self.number()) {
            (Some(n), None) => self.program.push(Op::WholePower(n as i32)),
            _ => self.join(Op::Power, exponent),
        }
        self.labelled(text, Binding::Power)
    }

    fn function(mut self, function: Function) -> Result<Self, FormulaError> {
        self.unit = match function {
            Function::Abs => self.unit,
            Function::Sign => Unit::ONE,
            Function::Sqrt => self.unit.power(0.5).ok_or_else(|| FormulaError::Exponent {
                exponent: "1/2".to_owned(),
                base: self.text.clone(),
                reason: format!("gives {} a power that cannot be recorded", self.unit),
            })?,
            _ if self.unit == Unit::ONE => Unit::ONE,
            _ => {
                return Err(FormulaError::DimensionalArgument {
                    function: function.name(),
                    argument: self.text,
                    unit: self.unit.to_string(),
                });
            }
        };
        match self.number() {
            Some(x) => self.program = vec![Op::Number(function.of(x))],
            None => self.program.push(Op::Function(function)),
        }
        let text = format!("{}({})", function.name(), self.text);
        self.labelled(text, Binding::Atom)
    }
}

/// A long text without its middle: messages are read by people.
fn shortened(text: String) -> String {
    const LONGEST: usize = 120;
    let length = text.chars().count();
    if length <= LONGEST {
        return text;
    }
    let head: String = text.chars().take(LONGEST / 2).collect();
    let tail: String = text.chars().skip(length - LONGEST / 2 + 1).collect();
    format!("{head}…{tail}")
}

/// Affine in the coefficients: a fixed part and a regressor per coefficient.
#[derive(Debug, Clone, Default)]
struct Affine {
    fixed: Option<Part>,
    parts: Vec<(String, Part)>,
}

/// What the expression library computes with; the first error wins.
#[derive(Debug, Clone)]
struct Term(Result<Affine, FormulaError>);

impl Default for Term {
    fn default() -> Self {
        Self(Ok(Affine::default()))
    }
}

impl FromStr for Term {
    type Err = String;

    /// A literal of the canonical text; `~` is a minus sign that binds.
    fn from_str(text: &str) -> Result<Self, String> {
        let (sign, digits) = text.strip_prefix('~').map_or((1.0, text), |rest| (-1.0, rest));
        let magnitude = if digits.is_empty() { Ok(1.0) } else { f64::from_str(digits) };
        let value = sign * magnitude.map_err(|e| e.to_string())?;
        let minus = if sign < 0.0 { "-" } else { "" };
        let digits = if digits.is_empty() { "1" } else { digits };
        Ok(Self::fixed(vec![Op::Number(value)], Unit::ONE, &format!("{minus}{digits}")))
    }
}

impl Term {
    fn fixed(program: Vec<Op>, unit: Unit, text: &str) -> Self {
        let part = Part { program, unit, text: text.to_owned(), binding: Binding::Atom };
        Self(Ok(Affine { fixed: Some(part), parts: Vec::new() }))
    }

    fn coefficient(name: &str) -> Self {
        Self(Ok(Affine { fixed: None, parts: vec![(name.to_owned(), Part::one())] }))
    }

    fn both(self, other: Self, f: fn(Affine, Affine) -> Result<Affine, FormulaError>) -> Self {
        Self(match (self.0, other.0) {
            (Ok(a), Ok(b)) => f(a, b),
            (Err(e), _) | (_, Err(e)) => Err(e),
        })
    }

    fn map(self, function: Function) -> Self {
        Self(self.0.and_then(|a| a.function(function)))
    }
}

impl Affine {
    fn fixed(part: Part) -> Self {
        Self { fixed: Some(part), parts: Vec::new() }
    }

    /// The value where it has no coefficient.
    fn known(&self) -> Option<&Part> {
        if self.parts.is_empty() { self.fixed.as_ref() } else { None }
    }

    fn text(&self) -> String {
        let terms = self.parts.iter().map(|(name, part)| {
            if part.is(1.0) { name.clone() } else { format!("{name}*{}", part.inside(Binding::Power)) }
        });
        let fixed = self.fixed.iter().map(|part| part.text.clone());
        shortened(terms.chain(fixed).collect::<Vec<_>>().join(" + "))
    }

    /// As a factor.
    fn factor_text(&self) -> String {
        let is_sum = self.parts.len() + usize::from(self.fixed.is_some()) > 1
            || self.known().is_some_and(|part| part.binding == Binding::Sum);
        if is_sum { format!("({})", self.text()) } else { self.text() }
    }

    fn sum(mut self, other: Self, op: Op) -> Result<Self, FormulaError> {
        let signed = |part: Part| if op == Op::Add { part } else { part.negated() };
        for (name, part) in other.parts {
            let Some(place) = self.parts.iter().position(|(known, _)| *known == name) else {
                self.parts.push((name, signed(part)));
                continue;
            };
            let (name, here) = self.parts.swap_remove(place);
            let sum = here.sum(&part, op).map_err(|e| match e {
                FormulaError::UnlikeSum { left_unit, right_unit, .. } => {
                    FormulaError::CoefficientUnits { coefficient: name.clone(), first: left_unit, second: right_unit }
                }
                other => other,
            })?;
            self.parts.push((name, sum));
        }
        self.fixed = match (self.fixed, other.fixed) {
            (Some(a), Some(b)) => Some(a.sum(&b, op)?),
            (Some(a), None) => Some(a),
            (None, b) => b.map(signed),
        };
        Ok(self)
    }

    fn product(self, other: Self) -> Result<Self, FormulaError> {
        match (self.known(), other.known()) {
            (_, Some(factor)) => self.each(|part| part.product(factor, false)),
            (Some(factor), None) => other.each(|part| part.product(factor, true)),
            (None, None) => {
                let term = format!("{}*{}", self.factor_text(), other.factor_text());
                Err(FormulaError::NotLinear { term: format!("{term} multiplies coefficients with each other") })
            }
        }
    }

    fn quotient(self, other: &Self) -> Result<Self, FormulaError> {
        if let Some(divisor) = other.known() {
            return self.each(|part| part.quotient(divisor));
        }
        let term = format!("{}/{}", self.factor_text(), other.factor_text());
        Err(FormulaError::NotLinear { term: format!("{term} divides by a coefficient") })
    }

    fn power(self, other: &Self) -> Result<Self, FormulaError> {
        let what = match (self.known(), other.known()) {
            (Some(base), Some(exponent)) => return base.clone().power(exponent).map(Self::fixed),
            (None, _) => "raises a coefficient to a power",
            (_, None) => "has a coefficient in its exponent",
        };
        let term = format!("{}^{}", self.factor_text(), other.factor_text());
        Err(FormulaError::NotLinear { term: format!("{term} {what}") })
    }

    fn function(self, function: Function) -> Result<Self, FormulaError> {
        match self.known() {
            Some(argument) => argument.clone().function(function).map(Self::fixed),
            None => Err(FormulaError::NotLinear {
                term: format!("{}({}) has a coefficient in it", function.name(), self.text()),
            }),
        }
    }

    /// Applies `f` to the fixed part and to every regressor.
    fn each(self, f: impl Fn(Part) -> Result<Part, FormulaError>) -> Result<Self, FormulaError> {
        Ok(Self {
            fixed: self.fixed.map(&f).transpose()?,
            parts: self
                .parts
                .into_iter()
                .map(|(name, part)| Ok((name, f(part)?)))
                .collect::<Result<_, FormulaError>>()?,
        })
    }
}

/// The operators and functions of a formula.
#[derive(Debug, Clone)]
struct Operators;

impl MakeOperators<Term> for Operators {
    fn make<'a>() -> Vec<Operator<'a, Term>> {
        // Nothing is called commutative, so that the library keeps the order written.
        let binary = |repr, prio, apply| Operator::make_bin(repr, BinOp { apply, prio, is_commutative: false });
        let unary = |repr, apply| Operator::make_unary(repr, apply);
        vec![
            binary("+", 0, |a: Term, b: Term| a.both(b, |a, b| a.sum(b, Op::Add))),
            binary("-", 0, |a: Term, b: Term| a.both(b, |a, b| a.sum(b, Op::Subtract))),
            binary("*", 1, |a: Term, b: Term| a.both(b, Affine::product)),
            binary("/", 1, |a: Term, b: Term| a.both(b, |a, b| a.quotient(&b))),
            binary("^", 2, |a: Term, b: Term| a.both(b, |a, b| a.power(&b))),
            unary("abs", |a: Term| a.map(Function::Abs)),
            unary("sqrt", |a: Term| a.map(Function::Sqrt)),
            unary("sin", |a: Term| a.map(Function::Sin)),
            unary("cos", |a: Term| a.map(Function::Cos)),
            unary("tan", |a: Term| a.map(Function::Tan)),
            unary("exp", |a: Term| a.map(Function::Exp)),
            unary("ln", |a: Term| a.map(Function::Ln)),
            unary("sign", |a: Term| a.map(Function::Sign)),
        ]
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const SPEED: Dim = [1, 0, -1, 0, 0];
    const RATE: Dim = [0, 0, -1, 0, 0];
    const NEWTON: Dim = [1, 1, -2, 0, 0];
    const ONE: Dim = [0; 5];

    /// A table of planar motion.
    fn columns(name: &str) -> Option<Dim> {
        Some(match name {
            "v_x" | "v_y" | "speed" => SPEED,
            "w_z" => RATE,
            "v_y_dot" => [1, 0, -2, 0, 0],
            "angle" => ONE,
            _ => return None,
        })
    }

    fn constants() -> Vec<(String, f64, Dim)> {
        vec![
            ("L".to_owned(), 2.0, [1, 0, 0, 0, 0]),
            ("rho".to_owned(), 1000.0, [-3, 1, 0, 0, 0]),
            ("n".to_owned(), 2.0, ONE),
        ]
    }

    fn parse(text: &str) -> Result<Formula, FormulaError> {
        Formula::parse("f_y", text, &columns, NEWTON, &constants())
    }

    fn message(text: &str) -> String {
        parse(text).unwrap_err().to_string()
    }

    /// The regressors at named channel values.
    fn row(formula: &Formula, at: &[(&str, f64)]) -> Vec<f64> {
        let values: Vec<f64> =
            formula.channels.iter().map(|c| at.iter().find(|(name, _)| name == c).unwrap().1).collect();
        let mut out = vec![0.0; formula.coefficients.len()];
        formula.regressor(&values, &mut out);
        out
    }

    const AT: [(&str, f64); 6] =
        [("v_x", 1.5), ("v_y", -0.5), ("speed", 1.6), ("w_z", 0.25), ("v_y_dot", 0.1), ("angle", 0.3)];

    fn value(text: &str) -> f64 {
        row(&parse(text).unwrap(), &AT)[0]
    }

    #[test]
    fn sway_of_a_ship_is_read_with_units_and_aliases() {
        let f = Formula::parse("Y", "Y_0 + Y_v * v + Y_vav * v*abs(v) + Y_vvr * v^2*r", &columns, NEWTON, &[]).unwrap();
        assert_eq!(f.load, "f_y");
        assert_eq!(f.channels, ["v_y", "w_z"]);
        assert!(f.offset);
        let expected: [(&str, Dim); 4] =
            [("Y_0", NEWTON), ("Y_v", [0, 1, -1, 0, 0]), ("Y_vav", [-1, 1, 0, 0, 0]), ("Y_vvr", [-1, 1, 1, 0, 0])];
        for ((name, dim), (wanted, wanted_dim)) in f.coefficients.iter().zip(expected) {
            assert_eq!((name.as_str(), *dim), (wanted, wanted_dim));
        }
        assert_eq!(row(&f, &AT), [1.0, -0.5, -0.25, 0.0625]);
        assert!(!parse("Y_v*v").unwrap().offset);
    }

    #[test]
    fn a_coefficient_may_stand_in_several_terms() {
        let f = parse("a*v_x - a*v_y + 2*b*v_x*v_y/L^2*L").unwrap();
        assert_eq!(f.coefficients.len(), 2);
        assert_eq!(row(&f, &AT), [2.0, -0.75]);
    }

    #[test]
    fn a_bracket_of_coefficients_is_multiplied_out() {
        let f = parse("0.5*rho*L^2*(C_1*v*abs(v) + C_2*r*L*u)").unwrap();
        assert_eq!(f.coefficients, [("C_1".to_owned(), ONE), ("C_2".to_owned(), ONE)]);
        assert_eq!(row(&f, &AT), [-500.0, 1500.0]);
    }

    #[test]
    fn signs_and_powers_bind_as_on_paper() {
        assert_eq!(value("-c*v_x^2"), -2.25);
        assert_eq!(value("c*-v_x^2"), -2.25);
        assert_eq!(value("-v_x^2*c"), -2.25);
        assert_eq!(value("c*(-v_x)^2"), 2.25);
        assert_eq!(value("c*v_x^-2"), 1.0 / 2.25);
        assert_eq!(value("c*v_x^+2"), 2.25);
        assert_eq!(value("c/-v_x^2"), -1.0 / 2.25);
        assert_eq!(value("c/v_x/v_x*v_y"), -0.5 / 2.25);
        assert_eq!(value("c*v_x - -c*v_y"), 1.0);
        assert_eq!(value("c*v_x - c*v_y - c*v_x"), 0.5);
        assert_eq!(value("c*(v_x - v_y - v_x)"), 0.5);
        assert_eq!(value("-(c*(v_x - (v_y - v_x)))"), -3.5);
        assert_eq!(value("+c*1e-3*v_x"), 1.5e-3);
        assert_eq!(value("c*.5*v_x^n"), 1.125);
        assert_eq!(value("c*2^(3^2)/512."), 1.0);
        assert_eq!(value("c*(2^3)^2"), 64.0);
        assert_eq!(value("\tc *\nv_x "), 1.5);
    }

    #[test]
    fn functions_are_the_usual_ones() {
        assert_eq!(value("c*abs(v_y)"), 0.5);
        assert_eq!(value("c*sign(v_y)"), -1.0);
        assert_eq!(value("c*sign(v_y - v_y)"), 0.0);
        assert_eq!(value("c*sqrt(v_x^2)"), 1.5);
        assert_eq!(value("c*sin(angle)"), 0.3f64.sin());
        assert_eq!(value("c*cos(2*angle)*tan(angle)"), 0.6f64.cos() * 0.3f64.tan());
        assert_eq!(value("c*exp(-angle)"), (-0.3f64).exp());
        assert_eq!(value("c*ln(v_x/speed)"), (1.5f64 / 1.6).ln());
        assert_eq!(value("c*sin(pi/2)*v_x"), 1.5);
        assert_eq!(value("c*sin(angle)^2*v_x"), 1.5 * 0.3f64.sin().powi(2));
        assert!(value("c*sqrt(v_y)*sqrt(v_y)").is_nan());
    }

    #[test]
    fn half_powers_are_followed_and_whole_ones_recorded() {
        let f = parse("c*sqrt(abs(v))*abs(u)^1.5").unwrap();
        assert_eq!(f.coefficients[0].1, [-1, 1, 0, 0, 0]);
        assert_eq!(
            message("c*abs(v)^1.5"),
            "the coefficient c would have the unit kg/(m^(1/2) s^(1/2)); only whole powers up to \
             127 can be recorded"
        );
        assert_eq!(message("c*abs(v)^1.87"), "the exponent 1.87 of abs(v) gives m/s a power that cannot be recorded");
        // With a reference speed the power law is a pure number times newtons.
        let f =
            Formula::parse("f_x", "k*abs(u/U_0)^1.87", &columns, NEWTON, &[("U_0".to_owned(), 1.0, SPEED)]).unwrap();
        assert_eq!(f.coefficients[0].1, NEWTON);
        assert!((row(&f, &AT)[0] - 1.5f64.powf(1.87)).abs() < 1e-15);
    }

    #[test]
    fn what_is_not_linear_is_refused() {
        let start = "the formula is not linear in its coefficients: ";
        for (text, reason) in [
            ("a*b*v", "a*b multiplies coefficients with each other"),
            ("(a + b*v)*(c*u)", "(a + b*v)*c*u multiplies coefficients with each other"),
            ("a*v/b", "a*v/b divides by a coefficient"),
            ("1/a", "1/a divides by a coefficient"),
            ("a^2*v", "a^2 raises a coefficient to a power"),
            ("v*2^a", "2^a has a coefficient in its exponent"),
            ("abs(a)*v", "abs(a) has a coefficient in it"),
            ("sin(a*v + 1)", "sin(a*v + 1) has a coefficient in it"),
        ] {
            assert_eq!(message(text), format!("{start}{reason}"), "{text}");
        }
    }

    #[test]
    fn unlike_units_are_refused_with_both() {
        for (text, expected) in [
            ("c*(v + v^2)", "v is m/s and v^2 is m^2/s^2: they cannot be added"),
            ("c*(v + r*L - 1)", "v + r*L is m/s and 1 is 1: they cannot be added"),
            ("c*v*(1 + u)", "1 is 1 and u is m/s: they cannot be added"),
            (
                "c*v + c*v*abs(v)",
                "the coefficient c stands beside m/s in one term and beside m^2/s^2 in another; \
                 give the two terms different names",
            ),
            ("c*sin(v)", "sin(v) needs a pure number, but v is m/s"),
            ("c*exp(-v/L)", "exp(-v/L) needs a pure number, but -v/L is 1/s"),
            ("c*u^angle", "the exponent angle of u varies, but the base is m/s; its unit would vary too"),
            ("c*2^v", "the exponent v of 2 is m/s, but must be a pure number"),
            (
                "c*v^-99*v^-99",
                "the coefficient c would have the unit kg m^199/s^200; only whole powers up to 127 \
                 can be recorded",
            ),
        ] {
            assert_eq!(message(text), expected, "{text}");
        }
    }

    #[test]
    fn parts_without_a_coefficient_are_refused() {
        assert_eq!(
            message("c*v - 0.5*rho*L^2*v*abs(v)"),
            "the part -0.5*rho*L^2*v*abs(v) has no coefficient; give it one, and fix its value in \
             [identify.fixed] if it is known"
        );
        assert!(parse("c*v + 0").is_ok());
        let none = "the formula has no coefficient: every name in it is a channel or a constant";
        assert_eq!(message("v*abs(v)"), none);
        assert_eq!(message("0"), none);
        assert_eq!(message("rho*v"), none);
        assert_eq!(message("c*0*1 + a*v"), "the coefficient c is multiplied by zero");
        assert_eq!(message("c*(1 - 1)"), "the coefficient c is multiplied by zero");
        assert_eq!(message("c*v/(1-1)"), "v/(1 - 1) is not a finite number");
        assert_eq!(message("c*1/0"), "1/0 is not a finite number");
        assert_eq!(message("c*10^400"), "10^400 is not a finite number");
        assert_eq!(message("c*sqrt(-1)"), "sqrt(-1) is not a finite number");
    }

    #[test]
    fn names_that_could_be_meant_otherwise_are_refused() {
        for (text, expected) in [
            ("c*w", "w stands for the column v_z, which the table does not have"),
            ("c*w_y", "w_y is the name of a column, which the table does not have"),
            ("c*v_x_dot", "v_x_dot is the name of a column, which the table does not have"),
            ("Y*v", "Y is the name of a load and cannot stand in a formula; give a coefficient another name"),
            ("c*f_x", "f_x is the name of a load and cannot stand in a formula; give a coefficient another name"),
            (
                "c*sinh(v)",
                "sinh at character 3 is not a function; known are abs, sqrt, sin, cos, tan, exp, ln \
                 and sign; a product is written sinh*(…)",
            ),
        ] {
            assert_eq!(message(text), expected, "{text}");
        }
    }

    #[test]
    fn text_that_is_no_formula_is_refused_where_it_fails() {
        for (text, expected) in [
            ("", "the formula is empty; write for example \"Y_v*v + Y_vav*v*abs(v)\""),
            (" \n", "the formula is empty; write for example \"Y_v*v + Y_vav*v*abs(v)\""),
            ("c*v² ", "character 4 is '²'; a formula is made of names, numbers, + - * / ^ and parentheses"),
            ("c = v", "character 3 is '='; a formula is made of names, numbers, + - * / ^ and parentheses"),
            ("c*1e999", "\"1e999\" at character 3 is not a finite number"),
            ("c*.", "\".\" at character 3 is not a finite number"),
            ("c*v)", "at character 4 stands \")\", but no \")\" without its \"(\" is expected there"),
            ("c*(v", "at character 5 stands the end, but \")\" is expected there"),
            ("c*", "at character 3 stands the end, but a name, a number or \"(\" is expected there"),
            ("c**v", "at character 3 stands \"*\", but a name, a number or \"(\" is expected there"),
            ("c*()", "at character 4 stands \")\", but a name, a number or \"(\" is expected there"),
            ("2 v*c", "at character 3 stands \"v\", but an operator or the end is expected there"),
            ("2v*c", "at character 2 stands \"v\", but an operator or the end is expected there"),
            ("1.2.3*c", "at character 4 stands \".3\", but an operator or the end is expected there"),
            ("(c)(v)", "at character 4 stands \"(\", but an operator or the end is expected there"),
            ("--c*v", "at character 2 stands \"-\", but a name, a number or \"(\" is expected there"),
            ("c - - - v", "at character 7 stands \"-\", but a name, a number or \"(\" is expected there"),
            ("c*v^-u", "at character 5 stands \"-\", but a number or \"(\" as the exponent is expected there"),
            ("c*sin", "at character 6 stands the end, but \"(\" after a function's name is expected there"),
            ("c*abs*v", "at character 6 stands \"*\", but \"(\" after a function's name is expected there"),
            (
                "c*v^2^3",
                "at character 6 a power is raised to a power; write (a^b)^c or a^(b^c) to say which \
                 is meant",
            ),
        ] {
            assert_eq!(message(text), expected, "{text}");
        }
    }

    #[test]
    fn long_deep_and_wide_formulas_are_bounded() {
        let long = format!("c*v{}", " + c*v".repeat(900));
        assert_eq!(message(&long), "the formula has 5403 characters; at most 4096 are read");
        let deep = |n: usize| format!("{}c*v{}", "(".repeat(n), ")".repeat(n));
        assert!(parse(&deep(DEPTH_LIMIT)).is_ok());
        assert_eq!(message(&deep(DEPTH_LIMIT + 1)), "at character 25 more than 24 parentheses are open at once");
        assert_eq!(message(&"(".repeat(4096)), message(&deep(DEPTH_LIMIT + 1)));
        let wide = |n: usize| (0..n).map(|i| format!("c{i}*v")).collect::<Vec<_>>().join("+");
        assert_eq!(parse(&wide(64)).unwrap().coefficients.len(), 64);
        assert_eq!(message(&wide(65)), "the formula has 65 coefficients; at most 64 are read");
        // The longest sum that fits is still a sum.
        let sum = format!("c*v{}", "+c*v".repeat(1000));
        assert_eq!(value(&sum), 1001.0 * -0.5);
        assert!(parse(&format!("c*v{}", "*1".repeat(2000))).is_ok());
    }

    #[test]
    fn a_column_named_like_an_alias_and_a_constant_come_first() {
        let own = |name: &str| (name == "r").then_some(ONE);
        assert_eq!(Formula::parse("f_x", "c*r", &own, NEWTON, &[]).unwrap().channels, ["r"]);
        // A caller that resolves aliases itself gets column names all the same.
        let both = |name: &str| matches!(name, "v" | "v_y").then_some(SPEED);
        assert_eq!(Formula::parse("f_x", "c*v + d*v_y", &both, NEWTON, &[]).unwrap().channels, ["v_y"]);
        let f = Formula::parse("f_x", "c*v", &both, NEWTON, &[("v".to_owned(), 3.0, ONE)]).unwrap();
        assert!(f.offset && f.channels.is_empty());
        assert_eq!(f.coefficients[0].1, NEWTON);
        let bad = [("L".to_owned(), f64::NAN, ONE)];
        let refused = Formula::parse("f_x", "c*L", &both, NEWTON, &bad).unwrap_err();
        assert_eq!(refused.to_string(), "L is not a finite number");
    }

    #[test]
    fn short_rows_do_not_harm() {
        let f = parse("a*v + b*r + c").unwrap();
        let mut out = [7.0; 2];
        f.regressor(&[1.0], &mut out);
        assert!(out[0] == 1.0 && out[1].is_nan());
        f.regressor(&[1.0, 2.0, 3.0], &mut []);
    }

    // A second reading of the grammar: a random tree is written out, read by `Formula`,
    // and computed here.

    #[derive(Debug, Clone)]
    enum Tree {
        Number(f64),
        Name(usize),
        Negative(Box<Tree>),
        Binary(char, Box<Tree>, Box<Tree>),
        Call(&'static str, Box<Tree>),
    }

    /// Pure numbers, so that every tree has a unit.
    const NAMES: [&str; 3] = ["x", "y", "alpha_1"];

    impl Tree {
        fn binding(&self) -> u8 {
            match self {
                Self::Binary('+' | '-', ..) => 0,
                Self::Binary('*' | '/', ..) | Self::Negative(_) => 1,
                Self::Binary(..) => 2,
                _ => 3,
            }
        }

        fn text(&self) -> String {
            let inside = |tree: &Self, least: u8| {
                if tree.binding() < least { format!("({})", tree.text()) } else { tree.text() }
            };
            match self {
                Self::Number(x) => format!("{x:?}"),
                Self::Name(i) => NAMES[*i].to_owned(),
                Self::Negative(a) => format!("-{}", inside(a, 2)),
                Self::Binary('^', a, b) => format!("{}^{}", inside(a, 3), inside(b, 3)),
                Self::Binary(op @ ('*' | '/'), a, b) => {
                    // A sign may stand behind * and /: that is part of what is tested.
                    let right = if matches!(**b, Self::Negative(_)) { b.text() } else { inside(b, 2) };
                    format!("{} {op}{right}", inside(a, 1))
                }
                Self::Binary(op, a, b) => format!("{}{op} {}", inside(a, 0), inside(b, 1)),
                Self::Call(name, a) => format!("{name}({})", a.text()),
            }
        }

        /// The value, every operation being wrong by the part `rounding`.
        fn value(&self, at: &[f64], rounding: f64) -> f64 {
            match self {
                Self::Number(x) => *x,
                Self::Name(i) => at[*i],
                Self::Negative(a) => -a.value(at, rounding),
                Self::Binary(op, a, b) => {
                    let (a, b) = (a.value(at, rounding), b.value(at, rounding));
                    let exact = match op {
                        '+' => a + b,
                        '-' => a - b,
                        '*' => a * b,
                        '/' => a / b,
                        _ => a.powf(b),
                    };
                    exact * (1.0 + rounding)
                }
                Self::Call(name, a) => {
                    let a = a.value(at, rounding);
                    match *name {
                        "abs" => a.abs(),
                        "sin" => a.sin(),
                        "cos" => a.cos(),
                        "sign" if a == 0.0 => 0.0,
                        "sign" => a.signum(),
                        _ => a.exp(),
                    }
                }
            }
        }
    }

    fn any_tree() -> impl Strategy<Value = Tree> {
        let leaf = prop_oneof![
            (1..40u8).prop_map(|i| Tree::Number(f64::from(i) / 8.0)),
            (0..NAMES.len()).prop_map(Tree::Name),
        ];
        leaf.prop_recursive(5, 40, 2, |inner| {
            prop_oneof![
                1 => inner.clone().prop_map(|a| Tree::Negative(Box::new(a))),
                6 => (prop::sample::select(vec!['+', '-', '*', '/', '^']), inner.clone(), inner.clone())
                    .prop_map(|(op, a, b)| Tree::Binary(op, Box::new(a), Box::new(b))),
                1 => (prop::sample::select(vec!["abs", "sin", "cos", "sign", "exp"]), inner)
                    .prop_map(|(name, a)| Tree::Call(name, Box::new(a))),
            ]
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        /// Read back, a tree has the value it was written with.
        #[test]
        fn a_written_tree_is_read_back(tree in any_tree(), at in [-2.0..2.0f64, -2.0..2.0f64, -2.0..2.0f64]) {
            let pure = |name: &str| NAMES.contains(&name).then_some(ONE);
            let text = format!("c*({})", tree.text());
            let expected = tree.value(&at, 0.0);
            // A tree can be ill-conditioned: the sine of a large power, a small difference.
            let blur = [-1e-13, 1e-13].map(|e| (tree.value(&at, e) - expected).abs()).into_iter().fold(0.0, f64::max);
            match Formula::parse("f_x", &text, &pure, NEWTON, &[]) {
                Ok(f) => {
                    let values: Vec<f64> = f
                        .channels
                        .iter()
                        .map(|name| at[NAMES.iter().position(|n| n == name).unwrap()])
                        .collect();
                    let mut out = [0.0];
                    f.regressor(&values, &mut out);
                    let close = (out[0] - expected).abs() <= 1e-9 * (1.0 + expected.abs()) + blur;
                    let same = out[0] == expected || (out[0].is_nan() && expected.is_nan());
                    prop_assert!(close || same || !expected.is_finite() || expected.abs() > 1e12 || blur.is_nan(),
                        "{text}: {} {expected}", out[0]);
                }
                Err(FormulaError::NotFinite { .. } | FormulaError::ZeroRegressor { .. }) => {}
                Err(other) => prop_assert!(false, "{text}: {other}"),
            }
        }

        /// Whatever is typed, there is an answer and no panic.
        #[test]
        fn any_text_is_answered(text in "[cvrLn0-9 .*/^()+\\-_eE]{0,60}") {
            let _ = parse(&text);
        }

        #[test]
        fn any_unicode_is_answered(text in "\\PC{0,60}") {
            let _ = parse(&text);
        }
    }
}
