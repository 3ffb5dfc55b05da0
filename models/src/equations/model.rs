//! A model given as text: names, definitions, equations; checked, differentiated and compiled once.

use super::check::{
    Names, added_terms, check_units, parse_definitions, parse_equations, sort_definitions,
};
use super::elimination::eliminate;
use super::error::{TextError, TextPlace, line_and_column};
use super::graph::{Graph, JetVariable, MultiIndex, Node, NodeId};
use super::names::{intern_names, intern_unknowns};
use super::printer::{Printer, jet_name, name_nodes};
use super::program::Program;
use super::syntax::{BinaryOperator, Callee, Derivative, Expression, ExpressionKind};
use crate::common::system::Unknown;
use std::collections::HashMap;

/// Largest number of unknowns of a model.
pub const MAX_UNKNOWNS: usize = 64;

/// Largest number of unknowns that remain after the elimination of those that an equation gives as in `s = …`.
pub const MAX_DIFFERENTIAL_UNKNOWNS: usize = 16;

/// Largest number of nodes of the graph of all expressions.
pub(super) const MAX_NODES: usize = 200_000;

/// A named quantity of a model text.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// Name in expressions.
    pub name: String,
    /// SI unit, e.g. `kg/m^3`; `None` if no unit is given.
    pub unit: Option<String>,
}

/// A named expression or equation of a model text.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedText {
    /// Name.
    pub name: String,
    /// Expression, or equation with `=`.
    pub text: String,
}

/// A model as text.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModelText {
    /// Number of space dimensions, 1 to 3.
    pub dimensions: usize,
    /// Unknowns in the order of results.
    pub unknowns: Vec<Quantity>,
    /// Names of the unknowns that are the velocity components, for the material derivative `D`; may be empty.
    pub velocity: Vec<String>,
    /// Parameters.
    pub parameters: Vec<Quantity>,
    /// Names for expressions, in any order.
    pub definitions: Vec<NamedText>,
    /// Equations, at most as many as unknowns.
    pub equations: Vec<NamedText>,
    /// Names of the equations that a body force balances at the background.
    pub driven: Vec<String>,
}

/// A coefficient of the linearised equations: that of a derivative of an unknown in one equation.
#[derive(Clone, Debug, PartialEq)]
pub struct SymbolEntry {
    /// Index of the equation.
    pub row: usize,
    /// The derivative of an unknown that the coefficient multiplies; in the moving frame.
    pub variable: JetVariable,
    /// The coefficient as an expression in the names of the model.
    pub expression: String,
}

/// Place and range of bytes of a sub-expression.
#[derive(Clone, Debug)]
pub(super) struct Origin {
    pub(super) place: TextPlace,
    pub(super) text: String,
}

/// Coefficients of linearised equations and the program that computes them.
#[derive(Clone, Debug)]
pub(super) struct Symbol {
    pub(super) unknowns: &'static [Unknown],
    pub(super) equations: &'static [&'static str],
    /// Row and column of each coefficient, and the orders of its derivative.
    pub(super) places: Vec<(usize, usize, MultiIndex)>,
    /// Index of each equation in the model.
    pub(super) rows: Vec<usize>,
    pub(super) program: Program,
}

/// A model read from text, ready to be evaluated.
#[derive(Clone, Debug)]
pub struct TextModel {
    pub(super) text: ModelText,
    pub(super) unknowns: &'static [Unknown],
    pub(super) equations: &'static [&'static str],
    /// Index of each velocity component among the unknowns.
    pub(super) velocity: Vec<usize>,
    /// Whether a body force balances each equation.
    pub(super) is_driven: Vec<bool>,
    /// Coefficients of the linearised equations.
    pub(super) entries: Vec<SymbolEntry>,
    /// All linearised equations.
    pub(super) symbol: Symbol,
    /// The linearised equations without the unknowns that an equation gives.
    pub(super) reduced_symbol: Symbol,
    /// Computes the residual of each equation, then the terms of each equation.
    pub(super) residual: Program,
    /// Number of terms of each equation.
    pub(super) term_counts: Vec<usize>,
    /// Sub-expressions of the text, by the nodes that they and their derivatives are computed by.
    pub(super) origins: HashMap<NodeId, Origin>,
    unused_parameters: Vec<String>,
}

impl TextModel {
    /// Reads, checks and compiles a model.
    ///
    /// # Errors
    /// A text is not well-formed, a name is unknown, definitions are cyclic, units do not match, there are more
    /// equations than unknowns, or an unknown is in no equation; see [`TextError`].
    pub fn new(text: &ModelText) -> Result<Self, TextError> {
        let names = Names::new(text)?;
        let definitions = parse_definitions(text, &names)?;
        let order = sort_definitions(text, &definitions)?;
        let equations = parse_equations(text, &names)?;
        check_units(text, &definitions, &order, &equations)?;

        let mut lowering = Lowering {
            graph: Graph::new(names.velocity.clone()),
            nodes: HashMap::new(),
            origins: HashMap::new(),
            dimensions: text.dimensions,
        };
        lowering.insert_quantities(text);
        for &index in &order {
            let definition = &text.definitions[index];
            let place = TextPlace::Definition(definition.name.clone());
            let node = lowering.lower(&place, &definition.text, &definitions[index])?;
            lowering.nodes.insert(definition.name.clone(), node);
        }
        let mut roots = Vec::new();
        let mut terms: Vec<Vec<NodeId>> = Vec::new();
        for (equation, sides) in text.equations.iter().zip(&equations) {
            let place = TextPlace::Equation(equation.name.clone());
            let [left, right] =
                [0, 1].map(|side| lowering.lower(&place, &equation.text, &sides[side]));
            let (left, right) = (left?, right?);
            roots.push(lowering.graph.subtract(left, right));
            let mut own = Vec::new();
            for side in sides {
                for term in added_terms(side) {
                    own.push(lowering.lower(&place, &equation.text, term)?);
                }
            }
            terms.push(own);
        }
        let mut derivatives = Vec::new();
        for (row, &root) in roots.iter().enumerate() {
            let own = lowering.graph.jet_derivatives(root);
            derivatives.extend(own.into_iter().map(|(variable, node)| (row, variable, node)));
            if lowering.graph.reachable(&[root]).len() > MAX_NODES {
                let place = TextPlace::Equation(text.equations[row].name.clone());
                let found = format!("more than {MAX_NODES} operations");
                return Err(TextError::new(place, found, "simplify the equation"));
            }
        }
        for (index, unknown) in text.unknowns.iter().enumerate() {
            if !derivatives.iter().any(|(_, variable, _)| variable.unknown == index) {
                let place = TextPlace::Unknown(unknown.name.clone());
                let remedy = "use it in an equation, or leave it out of unknowns";
                return Err(TextError::new(place, "in no equation", remedy));
            }
        }
        let counts = [text.equations.len(), text.unknowns.len()];
        let reduced = eliminate(&mut lowering.graph, &derivatives, counts);
        if let Some(first) = reduced.columns.get(MAX_DIFFERENTIAL_UNKNOWNS) {
            let place = TextPlace::Unknown(text.unknowns[*first].name.clone());
            let found = format!("{} unknowns that no equation gives", reduced.columns.len());
            let remedy = format!(
                "at most {MAX_DIFFERENTIAL_UNKNOWNS}, besides unknowns of equations such as s = ... without \
                 derivatives of s"
            );
            return Err(TextError::new(place, found, remedy));
        }
        let graph = &lowering.graph;
        let printer = Printer { graph, text, named: name_nodes(&lowering.nodes, graph) };
        let entries = derivatives
            .iter()
            .map(|&(row, variable, node)| SymbolEntry {
                row,
                variable,
                expression: printer.print(node, row, variable),
            })
            .collect();
        let residual_roots: Vec<NodeId> =
            roots.iter().copied().chain(terms.iter().flatten().copied()).collect();
        let used = graph.reachable(&residual_roots);
        let symbol_roots = derivatives.iter().chain(&reduced.entries).map(|(.., node)| *node);
        let all_roots: Vec<NodeId> = residual_roots.iter().copied().chain(symbol_roots).collect();
        let origin_of =
            |id: NodeId| Some((id, lowering.origins.get(&graph.find_source(id))?.clone()));
        let origins = graph.reachable(&all_roots).into_iter().filter_map(origin_of).collect();
        let is_used =
            |index: usize| used.iter().any(|id| graph.node(*id) == Node::Parameter(index));
        let unused_parameters = text
            .parameters
            .iter()
            .enumerate()
            .filter(|(index, _)| !is_used(*index))
            .map(|(_, parameter)| parameter.name.clone())
            .collect();
        let all = counts.map(|count| (0..count).collect::<Vec<_>>());
        let symbol = Symbol::new(text, graph, &all, &derivatives);
        let remaining = [reduced.rows, reduced.columns];
        let reduced_symbol = Symbol::new(text, graph, &remaining, &reduced.entries);
        Ok(Self {
            unknowns: symbol.unknowns,
            equations: symbol.equations,
            velocity: names.velocity,
            is_driven: text
                .equations
                .iter()
                .map(|equation| text.driven.contains(&equation.name))
                .collect(),
            entries,
            symbol,
            reduced_symbol,
            residual: Program::new(graph, &residual_roots),
            term_counts: terms.iter().map(Vec::len).collect(),
            origins,
            unused_parameters,
            text: text.clone(),
        })
    }

    /// The text of the model.
    pub fn text(&self) -> &ModelText {
        &self.text
    }

    /// Number of space dimensions.
    pub fn dimensions(&self) -> usize {
        self.text.dimensions
    }

    /// Names of the unknowns.
    pub fn unknowns(&self) -> &'static [Unknown] {
        self.unknowns
    }

    /// Names of the equations.
    pub fn equations(&self) -> &'static [&'static str] {
        self.equations
    }

    /// Coefficients of the linearised equations that do not vanish identically.
    pub fn entries(&self) -> &[SymbolEntry] {
        &self.entries
    }

    /// Names of the parameters that no equation uses.
    pub fn unused_parameters(&self) -> &[String] {
        &self.unused_parameters
    }

    /// Number of operations that compute all coefficients of the linearised equations.
    pub fn operation_count(&self) -> usize {
        self.symbol.program.len()
    }

    /// Number of unknowns that are eliminated before the analysis, since an equation gives them.
    pub fn eliminated_count(&self) -> usize {
        self.unknowns.len() - self.reduced_symbol.unknowns.len()
    }

    /// Index of the unknown `name`.
    pub fn find_unknown(&self, name: &str) -> Option<usize> {
        self.text.unknowns.iter().position(|own| own.name == name)
    }

    /// Index of the parameter `name`.
    pub fn find_parameter(&self, name: &str) -> Option<usize> {
        self.text.parameters.iter().position(|own| own.name == name)
    }

    /// Name of a jet variable in expressions, e.g. `d1(d2(v1))`.
    pub fn jet_name(&self, variable: JetVariable) -> String {
        jet_name(&self.text, variable)
    }
}

impl Symbol {
    /// The coefficients `entries` of the equations and unknowns `rows` and `columns` of a model.
    fn new(
        text: &ModelText,
        graph: &Graph,
        [rows, columns]: &[Vec<usize>; 2],
        entries: &[(usize, JetVariable, NodeId)],
    ) -> Self {
        let place = |&(row, variable, _): &(usize, JetVariable, NodeId)| {
            let index = |list: &[usize], own: usize| list.iter().position(|other| *other == own);
            let (row, column) = (index(rows, row)?, index(columns, variable.unknown)?);
            Some((row, column, variable.orders))
        };
        let unknowns: Vec<String> =
            columns.iter().map(|own| text.unknowns[*own].name.clone()).collect();
        let equations: Vec<String> =
            rows.iter().map(|own| text.equations[*own].name.clone()).collect();
        let roots: Vec<NodeId> = entries.iter().map(|(.., node)| *node).collect();
        Self {
            unknowns: intern_unknowns(&unknowns),
            equations: intern_names(&equations),
            places: entries.iter().filter_map(place).collect(),
            rows: rows.clone(),
            program: Program::new(graph, &roots),
        }
    }
}

/// Builds the graph from trees.
struct Lowering {
    graph: Graph,
    /// Node of each name.
    nodes: HashMap<String, NodeId>,
    origins: HashMap<NodeId, Origin>,
    dimensions: usize,
}

impl Lowering {
    fn insert_quantities(&mut self, text: &ModelText) {
        for (index, unknown) in text.unknowns.iter().enumerate() {
            let node = self.graph.jet(JetVariable { unknown: index, orders: [0; 4] });
            self.nodes.insert(unknown.name.clone(), node);
        }
        for (index, parameter) in text.parameters.iter().enumerate() {
            let node = self.graph.parameter(index);
            self.nodes.insert(parameter.name.clone(), node);
        }
        let pi = self.graph.pi();
        self.nodes.insert("pi".into(), pi);
    }

    fn lower(
        &mut self,
        place: &TextPlace,
        text: &str,
        expression: &Expression,
    ) -> Result<NodeId, TextError> {
        let error = |found: &str, remedy: &str| TextError {
            position: Some(line_and_column(text, expression.span.start)),
            ..TextError::new(place.clone(), found, remedy)
        };
        let node = match &expression.kind {
            ExpressionKind::Number { value, is_exact } => {
                return Ok(self.graph.number(*value, *is_exact));
            }
            ExpressionKind::Name(name) => {
                return self
                    .nodes
                    .get(name)
                    .copied()
                    .ok_or_else(|| error("an unknown name", "define it"));
            }
            ExpressionKind::Negate(inner) => {
                let inner = self.lower(place, text, inner)?;
                self.graph.negate(inner)
            }
            ExpressionKind::Binary(operator, both) => {
                let a = self.lower(place, text, &both[0])?;
                let b = self.lower(place, text, &both[1])?;
                match operator {
                    BinaryOperator::Add => self.graph.add(a, b),
                    BinaryOperator::Subtract => self.graph.subtract(a, b),
                    BinaryOperator::Multiply => self.graph.multiply(a, b),
                    BinaryOperator::Divide => {
                        if self.graph.as_exact_number(b) == Some(0.0) {
                            return Err(error("a division by 0", "write another divisor"));
                        }
                        self.graph.divide(a, b)
                    }
                    BinaryOperator::Power => self.graph.power(a, b),
                }
            }
            ExpressionKind::Call(callee, arguments) => {
                let a = self.lower(place, text, &arguments[0])?;
                match callee {
                    Callee::Function(function) => self.graph.function(*function, a),
                    Callee::Function2(function) => {
                        let b = self.lower(place, text, &arguments[1])?;
                        self.graph.function2(*function, a, b)
                    }
                    Callee::Derivative(derivative) => {
                        debug_assert!(
                            !matches!(derivative, Derivative::Space(axis) if *axis >= self.dimensions)
                        );
                        let result = match derivative {
                            Derivative::Time => self.graph.differentiate_by_time(a),
                            Derivative::Space(axis) => self.graph.differentiate(a, axis + 1),
                            Derivative::Material => self.graph.differentiate_materially(a),
                        };
                        result.map_err(|_| {
                            let found = "derivatives of more than fourth order in all";
                            error(found, "introduce an unknown for a derivative")
                        })?
                    }
                }
            }
        };
        self.origins.entry(node).or_insert_with(|| Origin {
            place: place.clone(),
            text: text[expression.span.clone()].to_owned(),
        });
        Ok(node)
    }
}
