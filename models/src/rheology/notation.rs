//! Notation of rheological trees: `-` in series, `|` in parallel, parentheses around branches.
//!
//! There is no precedence between `-` and `|` to remember: a branch that joins elements in both ways needs
//! parentheses.

use super::scheme::{NamedElement, SchemeError, SchemeTree};

/// Maximum depth of nested branches.
pub(super) const MAX_DEPTH: usize = 100;

/// Returns whether a text is a name of an element: a letter, then letters, digits and `_`.
pub(super) fn is_name(text: &str) -> bool {
    text.starts_with(char::is_alphabetic) && text.chars().all(is_name_character)
}

/// Returns the error of branches that are nested too deeply.
pub(super) fn depth_error() -> SchemeError {
    SchemeError::TooLarge(format!("branches are nested more than {MAX_DEPTH} deep"))
}

/// Formats a tree.
pub(super) fn format_tree(tree: &SchemeTree, elements: &[NamedElement]) -> String {
    let (branches, separator) = match tree {
        SchemeTree::Element(index) => return elements[*index].name.clone(),
        SchemeTree::Series(branches) => (branches, " - "),
        SchemeTree::Parallel(branches) => (branches, " | "),
    };
    let branch = |own: &SchemeTree| match own {
        SchemeTree::Element(_) => format_tree(own, elements),
        _ => format!("({})", format_tree(own, elements)),
    };
    branches.iter().map(branch).collect::<Vec<_>>().join(separator)
}

/// Parses a tree whose leaves are names of `elements`.
///
/// # Errors
/// The text is not the notation of a tree, or a name is unknown.
pub(super) fn parse_tree(text: &str, elements: &[NamedElement]) -> Result<SchemeTree, SchemeError> {
    let mut parser = Parser { rest: text, elements };
    let tree = parser.parse_branches(0)?;
    match parser.peek() {
        None => Ok(tree),
        Some(')') => Err(parser.error("a parenthesis that closes none")),
        Some(_) => Err(parser.error("- or | is missing")),
    }
}

fn is_name_character(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

struct Parser<'a> {
    rest: &'a str,
    elements: &'a [NamedElement],
}

impl Parser<'_> {
    /// Returns the next character that is not a space.
    fn peek(&mut self) -> Option<char> {
        self.rest = self.rest.trim_start();
        self.rest.chars().next()
    }

    fn error(&self, problem: &'static str) -> SchemeError {
        /// Maximum length of the text in a message, characters.
        const MAX_LENGTH: usize = 40;
        let remainder = match self.rest.char_indices().nth(MAX_LENGTH) {
            Some((end, _)) => format!("{}…", &self.rest[..end]),
            None if self.rest.is_empty() => "the end".to_owned(),
            None => self.rest.to_owned(),
        };
        SchemeError::Notation { problem, remainder }
    }

    /// Parses branches joined by one of `-` and `|`.
    fn parse_branches(&mut self, depth: usize) -> Result<SchemeTree, SchemeError> {
        let first = self.parse_branch(depth)?;
        let Some(separator @ ('-' | '|')) = self.peek() else { return Ok(first) };
        let mut branches = vec![first];
        loop {
            match self.peek() {
                Some(own) if own == separator => {
                    self.rest = &self.rest[1..];
                    branches.push(self.parse_branch(depth)?);
                }
                Some('-' | '|') => return Err(self.error("- and | without parentheses")),
                _ => break,
            }
        }
        Ok(match separator {
            '-' => SchemeTree::Series(branches),
            _ => SchemeTree::Parallel(branches),
        })
    }

    /// Parses a name or branches in parentheses.
    fn parse_branch(&mut self, depth: usize) -> Result<SchemeTree, SchemeError> {
        if depth >= MAX_DEPTH {
            return Err(depth_error());
        }
        if self.peek() == Some('(') {
            self.rest = &self.rest[1..];
            let tree = self.parse_branches(depth + 1)?;
            return match self.peek() {
                Some(')') => {
                    self.rest = &self.rest[1..];
                    Ok(tree)
                }
                Some(_) => Err(self.error("- or | is missing")),
                None => Err(self.error("a parenthesis is not closed")),
            };
        }
        let end = self.rest.find(|c| !is_name_character(c)).unwrap_or(self.rest.len());
        let name = &self.rest[..end];
        if name.is_empty() {
            return Err(self.error("the name of an element is missing"));
        }
        let Some(index) = self.elements.iter().position(|own| own.name == name) else {
            let known = self.elements.iter().map(|own| own.name.clone()).collect();
            return Err(SchemeError::UnknownElement { name: name.to_owned(), known });
        };
        self.rest = &self.rest[end..];
        Ok(SchemeTree::Element(index))
    }
}
