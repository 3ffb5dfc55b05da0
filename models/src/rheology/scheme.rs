//! Rheological schemes: trees of elements in series and in parallel, and their checks.

use super::element::Element;
use super::notation;
use crate::common::input::InputError;

/// Maximum number of elements of a scheme.
pub const MAX_ELEMENTS: usize = 1000;

/// Element with the name by which the notation of a tree refers to it.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedElement {
    /// Name: a letter, then letters, digits and `_`.
    pub name: String,
    /// Kind and constants.
    pub element: Element,
}

impl NamedElement {
    /// Creates an element with a name.
    pub fn new(name: impl Into<String>, element: Element) -> Self {
        Self { name: name.into(), element }
    }
}

/// Tree of a scheme; its leaves are indices of elements.
#[derive(Clone, Debug, PartialEq)]
pub enum SchemeTree {
    /// An element by its index.
    Element(usize),
    /// Branches with a common stress, whose strains add; at least two.
    Series(Vec<Self>),
    /// Branches with a common strain, whose stresses add; at least two.
    Parallel(Vec<Self>),
}

/// Quantity that is prescribed along a load path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoadControl {
    /// The strain is prescribed.
    Strain,
    /// The stress is prescribed, Pa.
    Stress,
}

/// Reason why a scheme is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SchemeError {
    /// The notation of the tree cannot be parsed.
    #[error(
        "{problem} at '{remainder}'; write names of elements joined by - (series) or | (parallel), with \
             parentheses around each branch that joins elements the other way"
    )]
    Notation {
        /// Problem, e.g. `a name is missing`.
        problem: &'static str,
        /// Text from the position of the problem on.
        remainder: String,
    },
    /// Branches are nested too deeply, or there are too many elements.
    #[error("{0}")]
    TooLarge(String),
    /// The tree contains a name that no element has.
    #[error("no element is called '{name}'; the elements are {}", known.join(", "))]
    UnknownElement {
        /// Name in the tree.
        name: String,
        /// Names of the elements.
        known: Vec<String>,
    },
    /// The name of an element is not a letter followed by letters, digits and `_`.
    #[error("'{0}' is no name of an element: a letter, then letters, digits and _")]
    InvalidName(String),
    /// Two elements have the same name.
    #[error("two elements are called '{0}'; each needs a name of its own")]
    DuplicateName(String),
    /// An element occurs more than once in the tree; each element has one strain and one stress.
    #[error("the element '{0}' occurs twice in the tree; define one element for each place")]
    RepeatedElement(String),
    /// An element does not occur in the tree.
    #[error("the element '{0}' is not in the tree")]
    UnusedElement(String),
    /// A constant of an element is invalid.
    #[error("element '{name}': {error}")]
    Constant {
        /// Name of the element.
        name: String,
        /// Error of the constant.
        error: InputError,
    },
    /// A series has neither spring nor damper: its strains are not unique.
    #[error(
        "the chain {0} has neither spring nor damper, so that the strains of its elements are not unique; put a \
             spring or a damper in series"
    )]
    RigidChain(String),
    /// Under prescribed strain a branch is at rest at any stress between limits.
    #[error(
        "the stress of the branch {0} at rest is not unique under prescribed strain; put a spring or a damper in \
             series with it, or prescribe the stress"
    )]
    IndeterminateStress(String),
    /// Under prescribed strain a closed contact admits no further compression.
    #[error(
        "the branch {0} admits no compression beyond its gap; put a spring or a damper in series with the \
             contact, or prescribe the stress"
    )]
    BoundedStrain(String),
}

/// Rheological scheme: named elements joined in series and in parallel.
#[derive(Clone, Debug, PartialEq)]
pub struct RheologicalScheme {
    elements: Vec<NamedElement>,
    tree: SchemeTree,
}

impl RheologicalScheme {
    /// Creates a scheme from its elements and the notation of its tree, e.g. `skeleton | (grains - contact)`: `-` joins
    /// in series, `|` in parallel; parentheses enclose each branch that is joined the other way.
    ///
    /// ```
    /// use wellposed_models::rheology::element::Element;
    /// use wellposed_models::rheology::scheme::{NamedElement, RheologicalScheme};
    ///
    /// let elements = vec![
    ///     NamedElement::new("skeleton", Element::Spring { modulus: 1e9 }),
    ///     NamedElement::new("collapsed", Element::Spring { modulus: 3e9 }),
    ///     NamedElement::new("pores", Element::Contact { gap: 0.01 }),
    /// ];
    /// let scheme = RheologicalScheme::parse(elements, "skeleton|((collapsed-pores))")?;
    /// assert_eq!(scheme.notation(), "skeleton | (collapsed - pores)");
    /// # Ok::<(), wellposed_models::rheology::scheme::SchemeError>(())
    /// ```
    ///
    /// # Errors
    /// The notation is not a tree of all elements, or an error of [`new`](Self::new).
    pub fn parse(elements: Vec<NamedElement>, notation: &str) -> Result<Self, SchemeError> {
        check_elements(&elements)?;
        let tree = notation::parse_tree(notation, &elements)?;
        Self::new(elements, tree)
    }

    /// Creates a scheme from its elements and its tree. A branch joined in the same way as the branch around it is
    /// merged with it.
    ///
    /// # Errors
    /// A name is invalid or occurs twice, a constant is invalid, an element is not exactly once in the tree, a branch
    /// has fewer than two branches, or a chain has neither spring nor damper.
    pub fn new(elements: Vec<NamedElement>, tree: SchemeTree) -> Result<Self, SchemeError> {
        check_elements(&elements)?;
        let mut is_used = vec![false; elements.len()];
        let tree = check_tree(tree, &elements, &mut is_used, 0)?;
        if let Some(index) = is_used.iter().position(|used| !used) {
            return Err(SchemeError::UnusedElement(elements[index].name.clone()));
        }
        let scheme = Self { elements, tree };
        match scheme.find_rigid_chain(&scheme.tree) {
            Some(chain) => Err(SchemeError::RigidChain(scheme.format_branch(chain))),
            None => Ok(scheme),
        }
    }

    /// Returns the elements.
    pub fn elements(&self) -> &[NamedElement] {
        &self.elements
    }

    /// Returns the tree, without branches that are joined in the same way as the branch around them.
    pub fn tree(&self) -> &SchemeTree {
        &self.tree
    }

    /// Formats the tree as [`parse`](Self::parse) reads it.
    pub fn notation(&self) -> String {
        self.format_branch(&self.tree)
    }

    /// Returns whether the scheme has dampers, so that its stress depends on the rate.
    pub fn has_damper(&self) -> bool {
        self.elements.iter().any(|own| matches!(own.element, Element::Damper { .. }))
    }

    /// Checks that a load path with this control determines strain and stress of the scheme.
    ///
    /// # Errors
    /// Under prescribed strain: the strain is bounded by a contact, or the stress is not unique at rest.
    pub fn check_control(&self, control: LoadControl) -> Result<(), SchemeError> {
        if control == LoadControl::Stress {
            return Ok(());
        }
        let is_contact = |element: &Element| matches!(element, Element::Contact { .. });
        if let Some(branch) = self.find_rigid_branch(&self.tree, &is_contact) {
            return Err(SchemeError::BoundedStrain(self.format_branch(branch)));
        }
        let is_rigid = |element: &Element| !element.is_regular();
        match self.find_rigid_branch(&self.tree, &is_rigid) {
            Some(branch) => Err(SchemeError::IndeterminateStress(self.format_branch(branch))),
            None => Ok(()),
        }
    }

    /// Finds a chain without spring and damper.
    fn find_rigid_chain<'a>(&self, tree: &'a SchemeTree) -> Option<&'a SchemeTree> {
        match tree {
            SchemeTree::Element(_) => None,
            SchemeTree::Series(_) if !self.has_regular_element(tree) => Some(tree),
            SchemeTree::Series(branches) | SchemeTree::Parallel(branches) => {
                branches.iter().find_map(|branch| self.find_rigid_chain(branch))
            }
        }
    }

    fn has_regular_element(&self, tree: &SchemeTree) -> bool {
        match tree {
            SchemeTree::Element(index) => self.elements[*index].element.is_regular(),
            SchemeTree::Series(branches) | SchemeTree::Parallel(branches) => {
                branches.iter().any(|branch| self.has_regular_element(branch))
            }
        }
    }

    /// Finds the branch that makes the graph of `tree` vertical somewhere, if the graphs of the elements with
    /// `is_rigid` are: one branch suffices in parallel, in series all of them are needed.
    fn find_rigid_branch<'a>(
        &self,
        tree: &'a SchemeTree,
        is_rigid: &dyn Fn(&Element) -> bool,
    ) -> Option<&'a SchemeTree> {
        match tree {
            SchemeTree::Element(index) => is_rigid(&self.elements[*index].element).then_some(tree),
            SchemeTree::Series(branches) => {
                let is_branch_rigid = |own| self.find_rigid_branch(own, is_rigid).is_some();
                branches.iter().all(is_branch_rigid).then_some(tree)
            }
            SchemeTree::Parallel(branches) => {
                branches.iter().find_map(|branch| self.find_rigid_branch(branch, is_rigid))
            }
        }
    }

    fn format_branch(&self, tree: &SchemeTree) -> String {
        notation::format_tree(tree, &self.elements)
    }
}

/// Checks names, constants and number of elements.
fn check_elements(elements: &[NamedElement]) -> Result<(), SchemeError> {
    if elements.len() > MAX_ELEMENTS {
        let count = elements.len();
        let text = format!("the scheme has {count} elements, more than {MAX_ELEMENTS}");
        return Err(SchemeError::TooLarge(text));
    }
    for (index, NamedElement { name, element }) in elements.iter().enumerate() {
        if !notation::is_name(name) {
            return Err(SchemeError::InvalidName(name.clone()));
        }
        if elements[..index].iter().any(|other| other.name == *name) {
            return Err(SchemeError::DuplicateName(name.clone()));
        }
        let locate = |error| SchemeError::Constant { name: name.clone(), error };
        element.check().map_err(locate)?;
    }
    Ok(())
}

/// Checks a tree and merges branches that are joined in the same way as the branch around them; `is_used` marks the
/// elements that occur.
fn check_tree(
    tree: SchemeTree,
    elements: &[NamedElement],
    is_used: &mut [bool],
    depth: usize,
) -> Result<SchemeTree, SchemeError> {
    if depth > notation::MAX_DEPTH {
        return Err(notation::depth_error());
    }
    let (branches, is_series) = match tree {
        SchemeTree::Element(index) => {
            return match is_used.get_mut(index) {
                None => Err(SchemeError::UnknownElement {
                    name: index.to_string(),
                    known: elements.iter().map(|own| own.name.clone()).collect(),
                }),
                Some(true) => Err(SchemeError::RepeatedElement(elements[index].name.clone())),
                Some(used) => {
                    *used = true;
                    Ok(SchemeTree::Element(index))
                }
            };
        }
        SchemeTree::Series(branches) => (branches, true),
        SchemeTree::Parallel(branches) => (branches, false),
    };
    let mut merged = Vec::with_capacity(branches.len());
    for branch in branches {
        match (check_tree(branch, elements, is_used, depth + 1)?, is_series) {
            (SchemeTree::Series(inner), true) | (SchemeTree::Parallel(inner), false) => {
                merged.extend(inner);
            }
            (branch, _) => merged.push(branch),
        }
    }
    match (merged.len(), is_series) {
        (0, _) => {
            Err(SchemeError::Notation { problem: "an empty branch", remainder: String::new() })
        }
        (1, _) => Ok(merged.remove(0)),
        (_, true) => Ok(SchemeTree::Series(merged)),
        (_, false) => Ok(SchemeTree::Parallel(merged)),
    }
}
