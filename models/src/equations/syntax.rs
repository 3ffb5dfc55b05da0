//! Grammar of expressions: a recursive-descent parser with operator precedence (Pratt 1973) that builds a tree.
//!
//! ```text
//! equation   = sum "=" sum
//! sum        = product { ("+" | "-") product }
//! product    = unary { ("*" | "/") unary }
//! unary      = ("-" | "+") unary | power
//! power      = atom [ "^" unary ]
//! atom       = number | name | function "(" sum { "," sum } ")" | "(" sum ")" | "sum" "(" index "," sum ")"
//! ```
//!
//! A name or function may end with indices in brackets: `s[1,2]` is `s12`. Inside `sum(j, …)`, a sum over the space
//! dimensions, `s[1,j]` is `s11`, `s12`, … in turn.

use super::error::{TextError, TextPlace, line_and_column};
use crate::common::scalar::Function;
use std::ops::Range;

/// Largest depth of the tree of an expression, so that no recursion over it overflows the stack.
const MAX_DEPTH: usize = 250;

/// Largest length of an expression in bytes.
const MAX_LENGTH: usize = 10_000;

/// Largest number of sums inside each other: the innermost expression is read once per combination of indices.
const MAX_NESTED_SUMS: usize = 3;

/// Name of a sum over the space dimensions.
const SUM: &str = "sum";

/// An expression with its range of bytes in the text.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Expression {
    pub(super) kind: ExpressionKind,
    pub(super) span: Range<usize>,
    depth: usize,
}

/// Kinds of expressions.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum ExpressionKind {
    /// A number, and whether its decimal digits are the double exactly.
    Number {
        value: f64,
        is_exact: bool,
    },
    Name(String),
    Negate(Box<Expression>),
    Binary(BinaryOperator, Box<[Expression; 2]>),
    /// A function or derivative with its arguments, as many as it takes.
    Call(Callee, Vec<Expression>),
}

/// Binary operators.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BinaryOperator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
}

/// Functions of two arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Function2 {
    /// Polar angle of the point (second argument, first argument).
    Atan2,
    /// Minimum.
    Min,
    /// Maximum.
    Max,
}

/// A derivative operator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Derivative {
    /// ∂ₜ.
    Time,
    /// ∂ᵢ, counted from 0.
    Space(usize),
    /// Material derivative ∂ₜ + v·∇.
    Material,
}

/// What a call applies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Callee {
    Function(Function),
    Function2(Function2),
    Derivative(Derivative),
}

/// Functions and derivatives by name, in the order of messages.
const CALLEES: [(&str, Callee); 22] = [
    ("dt", Callee::Derivative(Derivative::Time)),
    ("d1", Callee::Derivative(Derivative::Space(0))),
    ("d2", Callee::Derivative(Derivative::Space(1))),
    ("d3", Callee::Derivative(Derivative::Space(2))),
    ("D", Callee::Derivative(Derivative::Material)),
    ("sqrt", Callee::Function(Function::Sqrt)),
    ("exp", Callee::Function(Function::Exp)),
    ("ln", Callee::Function(Function::Ln)),
    ("sin", Callee::Function(Function::Sin)),
    ("cos", Callee::Function(Function::Cos)),
    ("tan", Callee::Function(Function::Tan)),
    ("asin", Callee::Function(Function::Asin)),
    ("acos", Callee::Function(Function::Acos)),
    ("atan", Callee::Function(Function::Atan)),
    ("atan2", Callee::Function2(Function2::Atan2)),
    ("sinh", Callee::Function(Function::Sinh)),
    ("cosh", Callee::Function(Function::Cosh)),
    ("tanh", Callee::Function(Function::Tanh)),
    ("abs", Callee::Function(Function::Abs)),
    ("sign", Callee::Function(Function::Sign)),
    ("min", Callee::Function2(Function2::Min)),
    ("max", Callee::Function2(Function2::Max)),
];

impl Callee {
    fn from_name(name: &str) -> Option<Self> {
        CALLEES.iter().find(|(own, _)| *own == name).map(|(_, callee)| *callee)
    }

    /// Name in expressions.
    pub(super) fn name(self) -> &'static str {
        CALLEES.iter().find(|(_, callee)| *callee == self).map_or("", |(name, _)| name)
    }

    fn argument_count(self) -> usize {
        if matches!(self, Self::Function2(_)) { 2 } else { 1 }
    }
}

/// Names with a meaning of their own, which no parameter, unknown or definition may have.
pub(super) fn reserved_names() -> impl Iterator<Item = &'static str> {
    CALLEES.iter().map(|(name, _)| *name).chain(["pi", SUM])
}

/// Whether a text is a name: a letter or underscore, then letters, digits and underscores.
pub(super) fn is_name(text: &str) -> bool {
    text.chars().next().is_some_and(starts_name) && text.chars().all(continues_name)
}

fn starts_name(c: char) -> bool {
    c.is_alphabetic() || c == '_'
}

fn continues_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Parses an expression in `dimensions` space dimensions.
pub(super) fn parse_expression(
    place: &TextPlace,
    text: &str,
    dimensions: usize,
) -> Result<Expression, TextError> {
    let mut parser = Parser::new(place, text, dimensions)?;
    let expression = parser.sum()?;
    match parser.peek() {
        None => Ok(expression),
        Some('=') => Err(parser.error("'='", "a definition is one expression without '='")),
        Some(_) => Err(parser.unexpected("an operator + - * / ^ or the end")),
    }
}

/// Parses an equation in `dimensions` space dimensions into its two sides.
pub(super) fn parse_equation(
    place: &TextPlace,
    text: &str,
    dimensions: usize,
) -> Result<[Expression; 2], TextError> {
    let mut parser = Parser::new(place, text, dimensions)?;
    let left = parser.sum()?;
    if !parser.skip('=') {
        let expected = "an operator + - * / ^ or '=' with the right-hand side, e.g. '= 0'";
        return Err(parser.unexpected(expected));
    }
    let right = parser.sum()?;
    match parser.peek() {
        None => Ok([left, right]),
        Some('=') => Err(parser.error("a second '='", "write one '=' per equation")),
        Some(_) => Err(parser.unexpected("an operator + - * / ^ or the end")),
    }
}

struct Parser<'a> {
    place: &'a TextPlace,
    text: &'a str,
    dimensions: usize,
    offset: usize,
    depth: usize,
    /// Indices of the enclosing sums and their values, from 1.
    indices: Vec<(&'a str, usize)>,
}

impl<'a> Parser<'a> {
    fn new(place: &'a TextPlace, text: &'a str, dimensions: usize) -> Result<Self, TextError> {
        if text.len() > MAX_LENGTH {
            let found = format!("{} bytes", text.len());
            let remedy = format!("at most {MAX_LENGTH}: use definitions for parts");
            return Err(TextError {
                position: Some([1, 1]),
                ..TextError::new(place.clone(), found, remedy)
            });
        }
        let mut parser = Self { place, text, dimensions, offset: 0, depth: 0, indices: Vec::new() };
        parser.skip_space();
        Ok(parser)
    }

    fn rest(&self) -> &'a str {
        &self.text[self.offset..]
    }

    fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    fn skip_space(&mut self) {
        let rest = self.rest();
        self.offset += rest.len() - rest.trim_start().len();
    }

    /// Skips `c` and the space after it, if it is next.
    fn skip(&mut self, c: char) -> bool {
        let found = self.rest().starts_with(c);
        if found {
            self.offset += c.len_utf8();
            self.skip_space();
        }
        found
    }

    fn error_at(&self, offset: usize, found: impl Into<String>, remedy: &str) -> TextError {
        TextError {
            position: Some(line_and_column(self.text, offset)),
            ..TextError::new(self.place.clone(), found, remedy)
        }
    }

    fn error(&self, found: impl Into<String>, remedy: &str) -> TextError {
        self.error_at(self.offset, found, remedy)
    }

    fn unexpected(&self, expected: &str) -> TextError {
        let found = match self.peek() {
            None => "the end".to_owned(),
            Some(c) => format!("'{}'", c.escape_debug()),
        };
        self.error(found, &format!("expected {expected}"))
    }

    fn nested<T>(
        &mut self,
        parse: impl FnOnce(&mut Self) -> Result<T, TextError>,
    ) -> Result<T, TextError> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(self.depth_error());
        }
        let result = parse(self);
        self.depth -= 1;
        result
    }

    /// Builds an expression one level deeper than its parts.
    fn build(
        &self,
        kind: ExpressionKind,
        span: Range<usize>,
        depths: impl IntoIterator<Item = usize>,
    ) -> Result<Expression, TextError> {
        let depth = 1 + depths.into_iter().max().unwrap_or(0);
        if depth > MAX_DEPTH {
            return Err(self.depth_error());
        }
        Ok(Expression { kind, span, depth })
    }

    fn depth_error(&self) -> TextError {
        let found = format!("more than {MAX_DEPTH} nested or successive operations");
        self.error(found, "use definitions for parts")
    }

    fn build_binary(
        &self,
        operator: BinaryOperator,
        left: Expression,
        right: Expression,
    ) -> Result<Expression, TextError> {
        let (span, depths) = (left.span.start..right.span.end, [left.depth, right.depth]);
        self.build(ExpressionKind::Binary(operator, Box::new([left, right])), span, depths)
    }

    /// Parses operands separated by operators of one precedence, which associate to the left.
    fn sequence(
        &mut self,
        operators: [(char, BinaryOperator); 2],
        operand: fn(&mut Self) -> Result<Expression, TextError>,
    ) -> Result<Expression, TextError> {
        let mut left = operand(self)?;
        loop {
            let found = operators.into_iter().find(|(sign, _)| self.peek() == Some(*sign));
            let Some((sign, operator)) = found else { return Ok(left) };
            if self.rest().starts_with("**") {
                return Err(self.error("'**'", "write a power as '^'"));
            }
            self.skip(sign);
            let right = operand(self)?;
            left = self.build_binary(operator, left, right)?;
        }
    }

    fn sum(&mut self) -> Result<Expression, TextError> {
        self.sequence([('+', BinaryOperator::Add), ('-', BinaryOperator::Subtract)], Self::product)
    }

    fn product(&mut self) -> Result<Expression, TextError> {
        self.sequence([('*', BinaryOperator::Multiply), ('/', BinaryOperator::Divide)], Self::unary)
    }

    fn unary(&mut self) -> Result<Expression, TextError> {
        let start = self.offset;
        if self.skip('-') {
            let operand = self.nested(Self::unary)?;
            let (span, depth) = (start..operand.span.end, operand.depth);
            return self.build(ExpressionKind::Negate(Box::new(operand)), span, [depth]);
        }
        if self.skip('+') {
            return self.nested(Self::unary);
        }
        let base = self.atom()?;
        if !self.skip('^') {
            return Ok(base);
        }
        let exponent = self.nested(Self::unary)?;
        self.build_binary(BinaryOperator::Power, base, exponent)
    }

    fn atom(&mut self) -> Result<Expression, TextError> {
        let start = self.offset;
        match self.peek() {
            Some('(') => {
                self.skip('(');
                let inner = self.nested(Self::sum)?;
                self.close(start)?;
                // The span includes the parentheses, so that texts of sub-expressions are well-formed.
                Ok(Expression { span: start..self.end_of_last(), ..inner })
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if starts_name(c) => self.name_or_call(),
            _ => Err(self.unexpected("a number, a name, a function or '('")),
        }
    }

    /// End of the last token: the offset before the space just skipped.
    fn end_of_last(&self) -> usize {
        self.text[..self.offset].trim_end().len()
    }

    fn close(&mut self, open: usize) -> Result<(), TextError> {
        if self.skip(')') {
            return Ok(());
        }
        let [line, column] = line_and_column(self.text, open);
        Err(self.unexpected(&format!(
            "an operator + - * / ^ or ')' for the '(' at line {line}, column {column}"
        )))
    }

    fn number(&mut self) -> Result<Expression, TextError> {
        let start = self.offset;
        let bytes = self.rest().as_bytes();
        let digits = |mut end: usize| {
            while bytes.get(end).is_some_and(u8::is_ascii_digit) {
                end += 1;
            }
            end
        };
        let mut end = digits(0);
        if bytes.get(end) == Some(&b'.') {
            end = digits(end + 1);
        }
        if matches!(bytes.get(end), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
            let exponent_end = digits(end + 1 + sign);
            if exponent_end > end + 1 + sign {
                end = exponent_end;
            }
        }
        let text = &self.rest()[..end];
        let value: f64 = match text.parse() {
            Ok(value) if f64::is_finite(value) => value,
            Ok(_) => return Err(self.error(text, "the number is too large for a double")),
            Err(_) => return Err(self.error(text, "expected a number such as 0.5, 2 or 1e-3")),
        };
        self.offset += end;
        if self.peek().is_some_and(starts_name) || self.peek() == Some('.') {
            return Err(self.unexpected("an operator after a number: write products with '*'"));
        }
        self.skip_space();
        let is_exact = is_exact_decimal(text, value);
        self.build(ExpressionKind::Number { value, is_exact }, start..start + end, [])
    }

    /// Reads letters, digits and underscores, as many as there are, and the space after them.
    fn word(&mut self) -> &'a str {
        let rest = self.rest();
        let end = rest.find(|c| !continues_name(c)).unwrap_or(rest.len());
        self.offset += end;
        self.skip_space();
        &rest[..end]
    }

    /// Parses indices in brackets, if there are any, and appends their digits to a name.
    fn append_indices(&mut self, name: &str) -> Result<String, TextError> {
        let mut name = name.to_owned();
        if !self.skip('[') {
            return Ok(name);
        }
        loop {
            let start = self.offset;
            let index = self.word();
            let bound = self.indices.iter().find(|(own, _)| *own == index).map(|(_, value)| *value);
            let Some(value) = bound.or(index.parse().ok().filter(|own| (1..=3).contains(own)))
            else {
                let known: Vec<&str> = self.indices.iter().map(|(own, _)| *own).collect();
                let remedy = match known[..] {
                    [] => "expected 1, 2 or 3, or the index of a sum, as in sum(j, d[j](v[j]))"
                        .to_owned(),
                    _ => format!("expected 1, 2, 3 or {}", known.join(", ")),
                };
                let found = match index {
                    "" => "no index".to_owned(),
                    _ => format!("the index {index}"),
                };
                return Err(self.error_at(start, found, &remedy));
            };
            name.push_str(&value.to_string());
            if self.skip(']') {
                return Ok(name);
            }
            if !self.skip(',') {
                return Err(self.unexpected("',' or ']' after an index"));
            }
        }
    }

    /// Parses `(j, …)` after `sum`, which starts at `start`: the sum of the expression over the space dimensions j.
    fn indexed_sum(&mut self, start: usize) -> Result<Expression, TextError> {
        const EXAMPLE: &str = "as in sum(j, d[j](v[j]))";
        let open = self.offset;
        if !self.skip('(') {
            return Err(self.unexpected(&format!("'(' after sum, {EXAMPLE}")));
        }
        let at = self.offset;
        let index = self.word();
        if !is_name(index) {
            self.offset = at;
            return Err(self.unexpected(&format!("an index, {EXAMPLE}")));
        }
        if self.indices.iter().any(|(own, _)| *own == index) {
            let remedy = "name the indices of sums inside each other differently";
            return Err(self.error_at(at, format!("the index {index} twice"), remedy));
        }
        if self.indices.len() == MAX_NESTED_SUMS {
            let found = format!("more than {MAX_NESTED_SUMS} sums inside each other");
            return Err(self.error_at(start, found, "use definitions for parts"));
        }
        if !self.skip(',') {
            return Err(self.unexpected(&format!("',' after the index, {EXAMPLE}")));
        }
        let body = self.offset;
        let mut total: Option<Expression> = None;
        for value in 1..=self.dimensions {
            self.offset = body;
            self.indices.push((index, value));
            let term = self.nested(Self::sum)?;
            self.indices.pop();
            total = Some(match total {
                None => term,
                Some(sum) => self.build_binary(BinaryOperator::Add, sum, term)?,
            });
        }
        self.close(open)?;
        match total {
            Some(total) => Ok(Expression { span: start..self.end_of_last(), ..total }),
            None => Err(self.error_at(start, "a sum", "a model has at least one dimension")),
        }
    }

    fn name_or_call(&mut self) -> Result<Expression, TextError> {
        let start = self.offset;
        let word = self.word();
        if word == SUM {
            return self.indexed_sum(start);
        }
        let name = &self.append_indices(word)?;
        let callee = Callee::from_name(name);
        let open = self.offset;
        if !self.rest().starts_with('(') {
            let span = start..self.end_of_last();
            return match callee {
                Some(_) => Err(self.unexpected(&format!("'(' after the function {name}"))),
                None => self.build(ExpressionKind::Name(name.to_owned()), span, []),
            };
        }
        let Some(callee) = callee else {
            let names: Vec<&str> = CALLEES.iter().map(|(name, _)| *name).collect();
            let nearest = nearest_name(name, names.iter().copied())
                .map_or(String::new(), |near| format!("did you mean {near}? "));
            let found = format!("'{name}(': no function is called {name}");
            let remedy = format!(
                "{nearest}functions: {}; write a product of {name} as {name}*(…)",
                names.join(", ")
            );
            return Err(self.error_at(start, found, &remedy));
        };
        self.skip('(');
        let mut arguments = vec![self.nested(Self::sum)?];
        while self.skip(',') {
            arguments.push(self.nested(Self::sum)?);
        }
        self.close(open)?;
        if arguments.len() != callee.argument_count() {
            let found = format!("{name} with {} arguments", arguments.len());
            let remedy = format!("{name} takes {}", callee.argument_count());
            return Err(self.error_at(start, found, &remedy));
        }
        let depth = arguments.iter().map(|own| own.depth).max();
        self.build(ExpressionKind::Call(callee, arguments), start..self.end_of_last(), depth)
    }
}

/// Whether the decimal `text` of at most 15 digits is the double `value` exactly: a multiple of 1/16 below 2³⁰, whose
/// decimal expansion has at most 14 digits.
fn is_exact_decimal(text: &str, value: f64) -> bool {
    let digits = text.bytes().take_while(|b| !matches!(b, b'e' | b'E'));
    digits.filter(u8::is_ascii_digit).count() <= 15
        && value < f64::from(1u32 << 30)
        && (16.0 * value).fract() == 0.0
}

/// The name most similar to `name`, if one is similar enough to be meant.
pub(super) fn nearest_name<'n>(
    name: &str,
    names: impl Iterator<Item = &'n str>,
) -> Option<&'n str> {
    names
        .map(|other| (strsim::damerau_levenshtein(name, other), other))
        .filter(|(distance, other)| *distance <= 1.max(name.len().max(other.len()) / 3))
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, other)| other)
}
