//! Formulas of time in a case file, for example `0.1 * sin(omega * t)`.
//!
//! The grammar is that of a calculator: `+ - * / ^`, parentheses, functions of one or two arguments, the names `t`
//! (time), `omega` (angular frequency of the motion), `pi`, `e` and `deg` (one degree in radians), and, in formulas of
//! position, `x`, `y` and `z`. A power has precedence over a sign, −t² is −(t²), and groups from the right.
//! [`Formula::parse`] only builds the syntax tree. Its evaluation is generic in the type of number, so that derivatives
//! come from the same tree (`motion::time_function`).
use std::ops::Range;

use super::quantity::DEGREE;

/// Greatest depth of nesting, which bounds the recursion; far above any useful formula.
const DEEPEST: usize = 64;

/// A formula as a syntax tree.
#[derive(Clone, Debug, PartialEq)]
pub enum Formula {
    /// A number.
    Number(f64),
    /// Time.
    Time,
    /// Angular frequency of the motion.
    Omega,
    /// A coordinate of the position, 0 for x; permitted only in formulas of position.
    Coordinate(usize),
    /// Negation of the argument.
    Negative(Box<Formula>),
    /// A function of one argument.
    Call(Function, Box<Formula>),
    /// An operation on two arguments.
    Pair(Operation, Box<Formula>, Box<Formula>),
}

/// Functions of one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "each is the function of its name")]
pub enum Function {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Exp,
    Ln,
    Sqrt,
    Abs,
}

/// Operations on two arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "each is the operation of its name")]
pub enum Operation {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Min,
    Max,
}

/// Reason why a text is not a formula, and the bytes that cause it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{message}")]
pub struct FormulaError {
    /// Range of bytes of the text.
    pub span: Range<usize>,
    /// Description of the error.
    pub message: String,
    /// Permitted text at this position, if it is known.
    pub allowed: Option<String>,
}

const FUNCTIONS: [(&str, Function); 13] = [
    ("sin", Function::Sin),
    ("cos", Function::Cos),
    ("tan", Function::Tan),
    ("asin", Function::Asin),
    ("acos", Function::Acos),
    ("atan", Function::Atan),
    ("sinh", Function::Sinh),
    ("cosh", Function::Cosh),
    ("tanh", Function::Tanh),
    ("exp", Function::Exp),
    ("ln", Function::Ln),
    ("sqrt", Function::Sqrt),
    ("abs", Function::Abs),
];
const PAIRS: [(&str, Operation); 2] = [("min", Operation::Min), ("max", Operation::Max)];
const NAMES: [&str; 5] = ["t", "omega", "pi", "e", "deg"];
const COORDINATES: [&str; 3] = ["x", "y", "z"];

impl Formula {
    /// Parses a formula of time.
    pub fn parse(text: &str) -> Result<Self, FormulaError> {
        Self::parse_in(text, 0)
    }

    /// Parses a formula of time and of the first `coordinates` of x, y and z.
    pub fn parse_in(text: &str, coordinates: usize) -> Result<Self, FormulaError> {
        let mut parser = Parser { text, at: 0, depth: 0, coordinates: &COORDINATES[..coordinates.min(3)] };
        let formula = parser.sum()?;
        match parser.peek() {
            None => Ok(formula),
            Some(')') => Err(parser.wrong_char("this parenthesis closes nothing")),
            Some(_) => Err(parser.wrong_char("an operator is missing here").allow("`+ - * / ^`")),
        }
    }

    /// Value at time `t` with the angular frequency `omega`.
    pub fn value(&self, t: f64, omega: f64) -> f64 {
        self.value_at(&[], t, omega)
    }

    /// Value at the position `x` and time `t`; missing coordinates are zero.
    pub fn value_at(&self, x: &[f64], t: f64, omega: f64) -> f64 {
        let inner = |a: &Self| a.value_at(x, t, omega);
        match self {
            Self::Number(number) => *number,
            Self::Time => t,
            Self::Omega => omega,
            Self::Coordinate(axis) => x.get(*axis).copied().unwrap_or(0.0),
            Self::Negative(a) => -inner(a),
            Self::Call(function, a) => function.value(inner(a)),
            Self::Pair(operation, a, b) => operation.value(inner(a), inner(b)),
        }
    }

    /// True when the tree contains the node `wanted`.
    pub fn contains(&self, wanted: &Self) -> bool {
        self == wanted
            || match self {
                Self::Number(_) | Self::Time | Self::Omega | Self::Coordinate(_) => false,
                Self::Negative(a) | Self::Call(_, a) => a.contains(wanted),
                Self::Pair(_, a, b) => a.contains(wanted) || b.contains(wanted),
            }
    }

    /// All names that a formula may contain.
    pub fn vocabulary() -> impl Iterator<Item = &'static str> {
        NAMES.into_iter().chain(FUNCTIONS.map(|f| f.0)).chain(PAIRS.map(|f| f.0))
    }
}

impl Function {
    /// Value of the function at `x`.
    pub fn value(self, x: f64) -> f64 {
        match self {
            Self::Sin => x.sin(),
            Self::Cos => x.cos(),
            Self::Tan => x.tan(),
            Self::Asin => x.asin(),
            Self::Acos => x.acos(),
            Self::Atan => x.atan(),
            Self::Sinh => x.sinh(),
            Self::Cosh => x.cosh(),
            Self::Tanh => x.tanh(),
            Self::Exp => x.exp(),
            Self::Ln => x.ln(),
            Self::Sqrt => x.sqrt(),
            Self::Abs => x.abs(),
        }
    }
}

impl Operation {
    /// Result of the operation on `x` and `y`.
    pub fn value(self, x: f64, y: f64) -> f64 {
        match self {
            Self::Add => x + y,
            Self::Subtract => x - y,
            Self::Multiply => x * y,
            Self::Divide => x / y,
            Self::Power => x.powf(y),
            Self::Min => x.min(y),
            Self::Max => x.max(y),
        }
    }
}

impl FormulaError {
    fn allow(mut self, allowed: &str) -> Self {
        self.allowed = Some(allowed.to_owned());
        self
    }
}

struct Parser<'t> {
    text: &'t str,
    at: usize,
    depth: usize,
    coordinates: &'static [&'static str],
}

type Parsed = Result<Formula, FormulaError>;

impl Parser<'_> {
    /// sum := product (('+' | '-') product)*
    fn sum(&mut self) -> Parsed {
        let mut left = self.product()?;
        loop {
            let operation = match self.peek() {
                Some('+') => Operation::Add,
                Some('-') => Operation::Subtract,
                _ => return Ok(left),
            };
            self.at += 1;
            left = pair(operation, left, self.product()?);
        }
    }

    /// product := signed (('*' | '/') signed)*
    fn product(&mut self) -> Parsed {
        let mut left = self.signed()?;
        loop {
            let operation = match self.peek() {
                Some('*') => Operation::Multiply,
                Some('/') => Operation::Divide,
                _ => return Ok(left),
            };
            self.at += 1;
            left = pair(operation, left, self.signed()?);
        }
    }

    /// signed := ('+' | '-') signed | power
    fn signed(&mut self) -> Parsed {
        match self.peek() {
            Some('-') => self.deeper(|p| Ok(Formula::Negative(Box::new(p.signed()?)))),
            Some('+') => self.deeper(Self::signed),
            _ => self.power(),
        }
    }

    /// power := atom ('^' signed)?
    fn power(&mut self) -> Parsed {
        let base = self.atom()?;
        if self.peek() != Some('^') {
            return Ok(base);
        }
        self.deeper(|p| Ok(pair(Operation::Power, base, p.signed()?)))
    }

    /// Consumes one character and parses what follows, one level of nesting deeper.
    fn deeper(&mut self, parse: impl FnOnce(&mut Self) -> Parsed) -> Parsed {
        if self.depth == DEEPEST {
            return Err(self.wrong_char("the formula is nested too deeply"));
        }
        self.at += 1;
        self.depth += 1;
        let formula = parse(self)?;
        self.depth -= 1;
        Ok(formula)
    }

    /// atom := number | name | name '(' sum (',' sum)? ')' | '(' sum ')'
    fn atom(&mut self) -> Parsed {
        match self.peek() {
            Some('(') => {
                let open = self.at;
                let inner = self.deeper(Self::sum)?;
                self.close(open)?;
                Ok(inner)
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_alphabetic() || c == '_' => self.name(),
            Some(_) => Err(self.wrong_char("a number, a name or `(` is missing here")),
            None => Err(self.wrong(self.at..self.at, "the formula ends where a number, a name or `(` should follow")),
        }
    }

    fn number(&mut self) -> Parsed {
        let start = self.at;
        let bytes = self.text.as_bytes();
        let digit = |i: usize| bytes.get(i).is_some_and(u8::is_ascii_digit);
        let mut end = start;
        while digit(end) || bytes.get(end) == Some(&b'.') {
            end += 1;
        }
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        if matches!(bytes.get(end), Some(b'e' | b'E')) && digit(end + 1 + sign) {
            end += 1 + sign;
            while digit(end) {
                end += 1;
            }
        }
        self.at = end;
        match self.text[start..end].parse::<f64>() {
            Ok(x) if x.is_finite() => Ok(Formula::Number(x)),
            _ => Err(self.wrong(start..end, format!("`{}` is not a number", &self.text[start..end]))),
        }
    }

    fn name(&mut self) -> Parsed {
        let start = self.at;
        let rest = &self.text[start..];
        let length = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
        let (name, span) = (&rest[..length], start..start + length);
        self.at += length;
        match name {
            "t" => return Ok(Formula::Time),
            "omega" => return Ok(Formula::Omega),
            "pi" => return Ok(Formula::Number(std::f64::consts::PI)),
            "e" => return Ok(Formula::Number(std::f64::consts::E)),
            "deg" => return Ok(Formula::Number(DEGREE)),
            _ => {}
        }
        if let Some(axis) = self.coordinates.iter().position(|c| *c == name) {
            return Ok(Formula::Coordinate(axis));
        }
        if let Some((_, function)) = FUNCTIONS.iter().find(|f| f.0 == name) {
            let (argument, _) = self.arguments(&span, false)?;
            return Ok(Formula::Call(*function, Box::new(argument)));
        }
        if let Some((_, operation)) = PAIRS.iter().find(|f| f.0 == name) {
            let (first, second) = self.arguments(&span, true)?;
            return Ok(pair(*operation, first, second.unwrap_or(Formula::Time)));
        }
        Err(self.wrong(span, format!("unknown name `{name}` in a formula")))
    }

    /// Parses the arguments of the function whose name is at `name`.
    fn arguments(&mut self, name: &Range<usize>, two: bool) -> Result<(Formula, Option<Formula>), FormulaError> {
        let called = &self.text[name.clone()];
        if self.peek() != Some('(') {
            let example = if two { "(t, 1)" } else { "(t)" };
            return Err(
                self.wrong(name.clone(), format!("`{called}` needs its argument in parentheses, `{called}{example}`"))
            );
        }
        let open = self.at;
        let first = self.deeper(Self::sum)?;
        let second = match (self.peek(), two) {
            (Some(','), true) => Some(self.deeper(Self::sum)?),
            (Some(','), false) => return Err(self.wrong_char(format!("`{called}` takes one argument"))),
            (_, true) => return Err(self.wrong(name.clone(), format!("`{called}` takes two arguments"))),
            (_, false) => None,
        };
        self.close(open)?;
        Ok((first, second))
    }

    fn close(&mut self, open: usize) -> Result<(), FormulaError> {
        match self.peek() {
            Some(')') => {
                self.at += 1;
                Ok(())
            }
            Some(_) => Err(self.wrong_char("an operator or `)` is missing here")),
            None => Err(self.wrong(open..open + 1, "this parenthesis is never closed")),
        }
    }

    /// The next character that is not a space, without consuming it.
    fn peek(&mut self) -> Option<char> {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start().len();
        self.text[self.at..].chars().next()
    }

    fn wrong_char(&self, message: impl Into<String>) -> FormulaError {
        let length = self.text[self.at..].chars().next().map_or(0, char::len_utf8);
        self.wrong(self.at..self.at + length, message)
    }

    fn wrong(&self, span: Range<usize>, message: impl Into<String>) -> FormulaError {
        FormulaError { span, message: message.into(), allowed: None }
    }
}

fn pair(operation: Operation, a: Formula, b: Formula) -> Formula {
    Formula::Pair(operation, Box::new(a), Box::new(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn precedence_is_that_of_mathematics() {
        let same = |a: &str, b: &str| assert_eq!(Formula::parse(a).unwrap(), Formula::parse(b).unwrap(), "{a} {b}");
        same("-t^2", "-(t^2)");
        same("2^-t^2", "2^(-(t^2))");
        same("1 - 2 - t*3/4", "((1 - 2) - ((t*3)/4))");
        same("-t*2", "(-t)*2");
        same("1e-3*t + .5E2", "0.001 * t + 50.");
        assert!(Formula::parse("sin(omega*t)").unwrap().contains(&Formula::Omega));
        assert!(!Formula::parse("max(t, pi)").unwrap().contains(&Formula::Omega));
    }

    #[test]
    fn numbers_come_out_of_formulas() {
        let value = |text: &str| Formula::parse(text).unwrap().value(0.5, 3.0);
        assert_eq!(value("-t^2 + 2*omega - max(1, t)/4"), -0.25 + 6.0 - 0.25);
        assert_eq!(value("sin(omega*t) + exp(-t)*sqrt(abs(t - 1))"), 1.5f64.sin() + (-0.5f64).exp() * 0.5f64.sqrt());
        assert_eq!(value("90*deg"), std::f64::consts::FRAC_PI_2);
        let place = Formula::parse_in("2*x^2 - y*t", 2).unwrap();
        assert_eq!(place.value_at(&[3.0, 4.0], 0.5, 0.0), 16.0);
        assert!(Formula::parse("x").is_err() && Formula::parse_in("z", 2).is_err());
    }

    #[test]
    fn mistakes_have_their_place() {
        let at = |text: &str| {
            let e = Formula::parse(text).unwrap_err();
            (text[e.span.clone()].to_owned(), e.span.start, e.message)
        };
        assert_eq!(at("sin(t"), ("(".into(), 3, "this parenthesis is never closed".into()));
        assert_eq!(at("2 t"), ("t".into(), 2, "an operator is missing here".into()));
        assert_eq!(at("t + )").0, ")");
        assert_eq!(at("t)"), (")".into(), 1, "this parenthesis closes nothing".into()));
        assert_eq!(at("3 * omga"), ("omga".into(), 4, "unknown name `omga` in a formula".into()));
        assert_eq!(at("1 + sin t"), ("sin".into(), 4, "`sin` needs its argument in parentheses, `sin(t)`".into()));
        assert_eq!(at("min(t)").2, "`min` takes two arguments");
        assert_eq!(at("cos(t, 1)").0, ",");
        assert_eq!(at("1.2.3").2, "`1.2.3` is not a number");
        assert!(at("t +").2.contains("ends") && at("").2.contains("ends"));
        assert!(at(&"(".repeat(500)).2.contains("deeply") && at(&"-".repeat(500)).2.contains("deeply"));
    }

    proptest! {
        #[test]
        fn any_text_is_refused_without_panic(text in "[-+*/^() ,.eétπ0-9a-z]{0,24}") {
            if let Err(e) = Formula::parse(&text) {
                prop_assert!(text.get(e.span).is_some());
            }
        }
    }
}
