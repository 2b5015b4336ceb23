//! What is computed a row: operations in postfix order on a stack.

use froude_hydro::similarity::friction_ittc57;

/// One operation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Op {
    Number(f64),
    /// The channel with this place in the row.
    Channel(usize),
    Binary(Binary),
    WholePower(i32),
    Negate,
    Function(Function),
}

/// Operators between two operands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
}

impl Binary {
    fn of(self, left: f64, right: f64) -> f64 {
        match self {
            Self::Add => left + right,
            Self::Subtract => left - right,
            Self::Multiply => left * right,
            Self::Divide => left / right,
            Self::Power => left.powf(right),
        }
    }
}

/// Functions of one argument.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Function {
    Abs,
    Sqrt,
    Sin,
    Cos,
    Tan,
    Exp,
    Ln,
    Sign,
    /// The ITTC-57 line of a Reynolds number; NaN below 1000, where it has no meaning.
    FrictionIttc57,
}

impl Function {
    const ALL: [Self; 9] =
        [Self::Abs, Self::Sqrt, Self::Sin, Self::Cos, Self::Tan, Self::Exp, Self::Ln, Self::Sign, Self::FrictionIttc57];

    /// The function of this name.
    pub(super) fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|function| function.name() == name)
    }

    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Abs => "abs",
            Self::Sqrt => "sqrt",
            Self::Sin => "sin",
            Self::Cos => "cos",
            Self::Tan => "tan",
            Self::Exp => "exp",
            Self::Ln => "ln",
            Self::Sign => "sign",
            Self::FrictionIttc57 => "CF_ITTC57",
        }
    }

    pub(super) fn of(self, x: f64) -> f64 {
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
            Self::FrictionIttc57 => friction_ittc57(x).unwrap_or(f64::NAN),
        }
    }
}

/// Runs a program; NaN for a missing channel.
pub(super) fn run(program: &[Op], values: &[f64], stack: &mut Vec<f64>) -> f64 {
    stack.clear();
    for op in program {
        match *op {
            Op::Number(x) => stack.push(x),
            Op::Channel(place) => stack.push(values.get(place).copied().unwrap_or(f64::NAN)),
            Op::Binary(binary) => {
                let right = stack.pop().unwrap_or(f64::NAN);
                on_top(stack, |left| binary.of(left, right));
            }
            Op::WholePower(n) => on_top(stack, |x| x.powi(n)),
            Op::Negate => on_top(stack, |x| -x),
            Op::Function(function) => on_top(stack, |x| function.of(x)),
        }
    }
    stack.pop().unwrap_or(f64::NAN)
}

/// Puts `f` of the topmost value in its place.
fn on_top(stack: &mut [f64], f: impl Fn(f64) -> f64) {
    if let Some(top) = stack.last_mut() {
        *top = f(*top);
    }
}
