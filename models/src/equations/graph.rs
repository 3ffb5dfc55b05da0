//! Expressions as a directed acyclic graph in which equal sub-expressions are one node, their total derivatives, and
//! their derivatives by the jet variables.
//!
//! An expression is a function of parameters and of the jet of the unknowns: values and derivatives in t and x. The
//! total derivative of an expression f is `dᵢf = Σ ∂f/∂J dᵢJ` over the jet variables J (chain rule). The derivatives by
//! all jet variables follow in one pass in reverse order of evaluation (reverse mode of automatic differentiation,
//! Linnainmaa 1970), as expressions in the same graph.
//!
//! Derivatives refer to the frame that moves with the background velocity V where the model declares a velocity:
//! ∂ₜ + v·∇ = ∂ₜ* + (v − V)·∇, where v − V vanishes exactly at the background.

use super::syntax::Function2;
use crate::common::scalar::Function;
use std::collections::HashMap;

/// Number of a node; operands have lower numbers than the node.
pub(super) type NodeId = u32;

/// Orders of the derivatives in t, x₁, x₂ and x₃.
pub type MultiIndex = [u8; 4];

/// A jet variable: a derivative of an unknown, or the unknown itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct JetVariable {
    /// Index of the unknown.
    pub unknown: usize,
    /// Orders of the derivatives.
    pub orders: MultiIndex,
}

/// Largest total order of derivatives.
pub const MAX_ORDER: u8 = 4;

/// A node of the graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Node {
    /// A number, by its bits, and whether it is exact.
    Number {
        bits: u64,
        is_exact: bool,
    },
    Pi,
    /// A parameter, by index.
    Parameter(usize),
    /// A jet variable at the background.
    Jet(JetVariable),
    /// Component of v − V, by axis; zero at the background.
    RelativeVelocity(usize),
    /// Component of V, by axis.
    FrameVelocity(usize),
    Add(NodeId, NodeId),
    Negate(NodeId),
    Multiply(NodeId, NodeId),
    Divide(NodeId, NodeId),
    /// Power with a whole exponent of at least 2.
    WholePower(NodeId, u32),
    /// Power with any exponent.
    Power(NodeId, NodeId),
    Function(Function, NodeId),
    Function2(Function2, NodeId, NodeId),
    /// 1 if the first operand is greater than the second, 0 if it is less.
    Greater(NodeId, NodeId),
}

impl Node {
    /// Operands of the node.
    pub(super) fn operands(self) -> impl Iterator<Item = NodeId> {
        let [first, second] = match self {
            Self::Number { .. }
            | Self::Pi
            | Self::Parameter(_)
            | Self::Jet(_)
            | Self::RelativeVelocity(_)
            | Self::FrameVelocity(_) => [None, None],
            Self::Negate(a) | Self::WholePower(a, _) | Self::Function(_, a) => [Some(a), None],
            Self::Add(a, b)
            | Self::Multiply(a, b)
            | Self::Divide(a, b)
            | Self::Power(a, b)
            | Self::Function2(_, a, b)
            | Self::Greater(a, b) => [Some(a), Some(b)],
        };
        first.into_iter().chain(second)
    }
}

/// Error: a derivative of an order above [`MAX_ORDER`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct OrderTooHigh;

/// The graph of all expressions of a model.
#[derive(Clone, Debug, Default)]
pub(super) struct Graph {
    nodes: Vec<Node>,
    ids: HashMap<Node, NodeId>,
    /// Whether a node depends on the jet.
    depends_on_jet: Vec<bool>,
    /// Total derivatives known so far, by node and axis (0: t).
    derivatives: HashMap<(NodeId, usize), NodeId>,
    /// The node of which a node is a derivative.
    derived_from: HashMap<NodeId, NodeId>,
    /// The node being differentiated.
    source: Option<NodeId>,
    /// Unknowns that are the velocity components, by axis.
    velocity: Vec<usize>,
}

impl Graph {
    /// An empty graph of a model whose velocity components are these unknowns; empty without velocity.
    pub(super) fn new(velocity: Vec<usize>) -> Self {
        Self { velocity, ..Self::default() }
    }

    pub(super) fn node(&self, id: NodeId) -> Node {
        self.nodes[id as usize]
    }

    /// Number of nodes.
    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether the node depends on the jet.
    pub(super) fn depends_on_jet(&self, id: NodeId) -> bool {
        self.depends_on_jet[id as usize]
    }

    fn insert(&mut self, node: Node) -> NodeId {
        if let Some(&id) = self.ids.get(&node) {
            return id;
        }
        let id = self.nodes.len() as NodeId;
        let depends = matches!(node, Node::Jet(_) | Node::RelativeVelocity(_))
            || node.operands().any(|own| self.depends_on_jet(own));
        self.nodes.push(node);
        self.depends_on_jet.push(depends);
        self.ids.insert(node, id);
        if let Some(source) = self.source {
            self.derived_from.insert(id, source);
        }
        id
    }

    /// The node of the text that is `id`, or of which `id` is a derivative.
    pub(super) fn find_source(&self, mut id: NodeId) -> NodeId {
        while let Some(source) = self.derived_from.get(&id) {
            id = *source;
        }
        id
    }

    pub(super) fn number(&mut self, value: f64, is_exact: bool) -> NodeId {
        self.insert(Node::Number { bits: value.to_bits(), is_exact })
    }

    fn whole(&mut self, value: i32) -> NodeId {
        self.number(f64::from(value), true)
    }

    pub(super) fn pi(&mut self) -> NodeId {
        self.insert(Node::Pi)
    }

    pub(super) fn parameter(&mut self, index: usize) -> NodeId {
        self.insert(Node::Parameter(index))
    }

    pub(super) fn jet(&mut self, variable: JetVariable) -> NodeId {
        self.insert(Node::Jet(variable))
    }

    /// The value of an exact number.
    pub(super) fn as_exact_number(&self, id: NodeId) -> Option<f64> {
        match self.node(id) {
            Node::Number { bits, is_exact: true } => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    fn is_zero(&self, id: NodeId) -> bool {
        self.as_exact_number(id) == Some(0.0)
    }

    fn is_one(&self, id: NodeId) -> bool {
        self.as_exact_number(id) == Some(1.0)
    }

    /// The exact result of an operation on exact numbers, if it is a whole number of modest size.
    fn fold(
        &mut self,
        a: NodeId,
        b: NodeId,
        operation: impl Fn(f64, f64) -> f64,
    ) -> Option<NodeId> {
        let is_modest = |x: &f64| x.fract() == 0.0 && x.abs() < 1e6;
        let a = self.as_exact_number(a).filter(is_modest)?;
        let b = self.as_exact_number(b).filter(is_modest)?;
        let value = operation(a, b);
        Some(self.number(value + 0.0, true))
    }

    pub(super) fn add(&mut self, a: NodeId, b: NodeId) -> NodeId {
        if self.is_zero(a) {
            return b;
        }
        if self.is_zero(b) {
            return a;
        }
        self.fold(a, b, |a, b| a + b).unwrap_or_else(|| self.insert(Node::Add(a.min(b), a.max(b))))
    }

    pub(super) fn subtract(&mut self, a: NodeId, b: NodeId) -> NodeId {
        let negative = self.negate(b);
        self.add(a, negative)
    }

    pub(super) fn negate(&mut self, a: NodeId) -> NodeId {
        match self.node(a) {
            Node::Number { bits, is_exact } => self.number(0.0 - f64::from_bits(bits), is_exact),
            Node::Negate(inner) => inner,
            _ => self.insert(Node::Negate(a)),
        }
    }

    pub(super) fn multiply(&mut self, a: NodeId, b: NodeId) -> NodeId {
        if self.is_zero(a) || self.is_one(b) {
            return a;
        }
        if self.is_zero(b) || self.is_one(a) {
            return b;
        }
        if let Some(product) = self.fold(a, b, |a, b| a * b) {
            return product;
        }
        // Signs move outwards, so that products that differ in sign share a node.
        match (self.node(a), self.node(b)) {
            (Node::Negate(inner), _) => {
                let product = self.multiply(inner, b);
                self.negate(product)
            }
            (_, Node::Negate(inner)) => {
                let product = self.multiply(a, inner);
                self.negate(product)
            }
            _ if self.as_exact_number(a) == Some(-1.0) => self.negate(b),
            _ if self.as_exact_number(b) == Some(-1.0) => self.negate(a),
            _ => self.insert(Node::Multiply(a.min(b), a.max(b))),
        }
    }

    pub(super) fn divide(&mut self, a: NodeId, b: NodeId) -> NodeId {
        if self.is_one(b) || (self.is_zero(a) && !self.is_zero(b)) {
            return a;
        }
        match (self.node(a), self.node(b)) {
            (Node::Negate(inner), _) => {
                let quotient = self.divide(inner, b);
                self.negate(quotient)
            }
            (_, Node::Negate(inner)) => {
                let quotient = self.divide(a, inner);
                self.negate(quotient)
            }
            _ => self.insert(Node::Divide(a, b)),
        }
    }

    pub(super) fn power(&mut self, base: NodeId, exponent: NodeId) -> NodeId {
        let is_whole = |x: &f64| x.fract() == 0.0 && x.abs() <= 1000.0;
        match self.as_exact_number(exponent).filter(is_whole) {
            Some(n) if n < 0.0 => {
                let power = self.whole_power(base, -n as u32);
                let one = self.whole(1);
                self.divide(one, power)
            }
            Some(n) => self.whole_power(base, n as u32),
            None if self.as_exact_number(exponent) == Some(0.5) => {
                self.function(Function::Sqrt, base)
            }
            None => self.insert(Node::Power(base, exponent)),
        }
    }

    fn whole_power(&mut self, base: NodeId, n: u32) -> NodeId {
        match (n, self.node(base)) {
            (0, _) => self.whole(1),
            (1, _) => base,
            (_, Node::Negate(inner)) => {
                let power = self.whole_power(inner, n);
                if n.is_multiple_of(2) { power } else { self.negate(power) }
            }
            _ => self.insert(Node::WholePower(base, n)),
        }
    }

    pub(super) fn function(&mut self, function: Function, a: NodeId) -> NodeId {
        self.insert(Node::Function(function, a))
    }

    pub(super) fn function2(&mut self, function: Function2, a: NodeId, b: NodeId) -> NodeId {
        self.insert(Node::Function2(function, a, b))
    }

    /// Nodes on which `roots` depend, the roots included, ascending: operands first.
    pub(super) fn reachable(&self, roots: &[NodeId]) -> Vec<NodeId> {
        let mut is_reached = vec![false; self.nodes.len()];
        let mut open = roots.to_vec();
        while let Some(id) = open.pop() {
            if !std::mem::replace(&mut is_reached[id as usize], true) {
                open.extend(self.node(id).operands());
            }
        }
        (0..self.nodes.len() as NodeId).filter(|id| is_reached[*id as usize]).collect()
    }

    /// Total derivative by the variable `axis`: 0 for t in the moving frame, 1 to 3 for x₁ to x₃.
    pub(super) fn differentiate(
        &mut self,
        id: NodeId,
        axis: usize,
    ) -> Result<NodeId, OrderTooHigh> {
        for node in self.reachable(&[id]) {
            if !self.derivatives.contains_key(&(node, axis)) {
                let derivative = self.differentiate_node(node, axis)?;
                self.derivatives.insert((node, axis), derivative);
            }
        }
        Ok(self.derivatives[&(id, axis)])
    }

    /// Material derivative ∂ₜ + v·∇ = ∂ₜ* + (v − V)·∇ in the frame moving with V.
    pub(super) fn differentiate_materially(&mut self, id: NodeId) -> Result<NodeId, OrderTooHigh> {
        let mut sum = self.differentiate(id, 0)?;
        for axis in 0..self.velocity.len() {
            let slope = self.differentiate(id, axis + 1)?;
            let velocity = self.insert(Node::RelativeVelocity(axis));
            let term = self.multiply(velocity, slope);
            sum = self.add(sum, term);
        }
        Ok(sum)
    }

    /// Derivative by t at a fixed place: ∂ₜ = ∂ₜ* − V·∇.
    pub(super) fn differentiate_by_time(&mut self, id: NodeId) -> Result<NodeId, OrderTooHigh> {
        let mut sum = self.differentiate(id, 0)?;
        for axis in 0..self.velocity.len() {
            let slope = self.differentiate(id, axis + 1)?;
            let velocity = self.insert(Node::FrameVelocity(axis));
            let term = self.multiply(velocity, slope);
            sum = self.subtract(sum, term);
        }
        Ok(sum)
    }

    fn differentiate_node(&mut self, id: NodeId, axis: usize) -> Result<NodeId, OrderTooHigh> {
        if !self.depends_on_jet(id) {
            return Ok(self.whole(0));
        }
        let raise = |mut variable: JetVariable| {
            variable.orders[axis] += 1;
            let is_allowed = variable.orders.iter().sum::<u8>() <= MAX_ORDER;
            is_allowed.then_some(variable).ok_or(OrderTooHigh)
        };
        match self.node(id) {
            Node::Jet(variable) => Ok(self.jet(raise(variable)?)),
            Node::RelativeVelocity(component) => {
                let unknown = self.velocity[component];
                Ok(self.jet(raise(JetVariable { unknown, orders: [0; 4] })?))
            }
            node => {
                let mut sum = self.whole(0);
                for operand in node.operands() {
                    // Operands come first in `reachable`.
                    let slope = self.derivatives[&(operand, axis)];
                    if self.is_zero(slope) {
                        continue;
                    }
                    let factor = self.partial_derivative(id, operand);
                    let term = self.multiply(factor, slope);
                    sum = self.add(sum, term);
                }
                Ok(sum)
            }
        }
    }

    /// Derivative of the operation of the node `id` by its operand; where both operands are the same node, half of the
    /// sum of both, since the caller adds it for each.
    fn partial_derivative(&mut self, id: NodeId, operand: NodeId) -> NodeId {
        self.source = Some(id);
        let derivative = self.differentiate_operation(id, operand);
        self.source = None;
        derivative
    }

    fn differentiate_operation(&mut self, id: NodeId, operand: NodeId) -> NodeId {
        match self.node(id) {
            Node::Add(..) => self.whole(1),
            Node::Negate(_) => self.whole(-1),
            Node::Multiply(a, b) => {
                if a == operand {
                    b
                } else {
                    a
                }
            }
            Node::Divide(a, b) if a == b => self.whole(0),
            Node::Divide(a, b) if a == operand => {
                let one = self.whole(1);
                self.divide(one, b)
            }
            Node::Divide(_, b) => {
                let quotient = self.divide(id, b);
                self.negate(quotient)
            }
            Node::WholePower(a, n) => {
                let factor = self.whole(n as i32);
                let power = self.whole_power(a, n - 1);
                self.multiply(factor, power)
            }
            Node::Power(a, b) if a == b => {
                // d xˣ = xˣ (1 + ln x), half of it for each operand.
                let logarithm = self.function(Function::Ln, a);
                let one = self.whole(1);
                let sum = self.add(one, logarithm);
                let half = self.number(0.5, true);
                let factor = self.multiply(half, sum);
                self.multiply(id, factor)
            }
            Node::Power(a, b) if a == operand => {
                let one = self.whole(1);
                let exponent = self.subtract(b, one);
                let power = self.power(a, exponent);
                self.multiply(b, power)
            }
            Node::Power(a, _) => {
                let logarithm = self.function(Function::Ln, a);
                self.multiply(id, logarithm)
            }
            Node::Function(function, a) => self.function_derivative(function, a, id),
            Node::Function2(Function2::Atan2, a, b) => {
                let squares = [a, b].map(|x| self.whole_power(x, 2));
                let sum = self.add(squares[0], squares[1]);
                if a == b {
                    self.whole(0)
                } else if a == operand {
                    self.divide(b, sum)
                } else {
                    let quotient = self.divide(a, sum);
                    self.negate(quotient)
                }
            }
            Node::Function2(function, a, b) => {
                // Operands that are the same node never differ: a kink, found on evaluation.
                let other = if a == operand { b } else { a };
                match function {
                    Function2::Max => self.insert(Node::Greater(operand, other)),
                    _ => self.insert(Node::Greater(other, operand)),
                }
            }
            // Piecewise constant.
            Node::Greater(..) => self.whole(0),
            Node::Number { .. }
            | Node::Pi
            | Node::Parameter(_)
            | Node::Jet(_)
            | Node::RelativeVelocity(_)
            | Node::FrameVelocity(_) => self.whole(0),
        }
    }

    /// Derivative of a function of one argument; `value` is the node of the function.
    fn function_derivative(&mut self, function: Function, a: NodeId, value: NodeId) -> NodeId {
        let one = self.whole(1);
        match function {
            Function::Sqrt => {
                let half = self.number(0.5, true);
                self.divide(half, value)
            }
            Function::Exp => value,
            Function::Ln => self.divide(one, a),
            Function::Sin => self.function(Function::Cos, a),
            Function::Cos => {
                let sine = self.function(Function::Sin, a);
                self.negate(sine)
            }
            Function::Tan => {
                let square = self.whole_power(value, 2);
                self.add(one, square)
            }
            Function::Asin | Function::Acos => {
                // 1 − a² = (1 − a)(1 + a) keeps its accuracy next to the ends.
                let (below, above) = (self.subtract(one, a), self.add(one, a));
                let product = self.multiply(below, above);
                let root = self.function(Function::Sqrt, product);
                let slope = self.divide(one, root);
                if function == Function::Asin { slope } else { self.negate(slope) }
            }
            Function::Atan => {
                let square = self.whole_power(a, 2);
                let sum = self.add(one, square);
                self.divide(one, sum)
            }
            Function::Sinh => self.function(Function::Cosh, a),
            Function::Cosh => self.function(Function::Sinh, a),
            Function::Tanh => {
                // 1/cosh² keeps its accuracy for large arguments.
                let cosine = self.function(Function::Cosh, a);
                let square = self.whole_power(cosine, 2);
                self.divide(one, square)
            }
            Function::Abs => self.function(Function::Sign, a),
            Function::Sign => self.whole(0),
        }
    }

    /// The expression at the background, where v − V vanishes.
    fn at_background(&mut self, id: NodeId, known: &mut HashMap<NodeId, NodeId>) -> NodeId {
        for own in self.reachable(&[id]) {
            if known.contains_key(&own) {
                continue;
            }
            let of = |operand: NodeId| known[&operand];
            let value = match self.node(own) {
                Node::RelativeVelocity(_) => self.whole(0),
                Node::Add(a, b) => self.add(of(a), of(b)),
                Node::Negate(a) => self.negate(of(a)),
                Node::Multiply(a, b) => self.multiply(of(a), of(b)),
                Node::Divide(a, b) => self.divide(of(a), of(b)),
                Node::WholePower(a, n) => self.whole_power(of(a), n),
                Node::Power(a, b) => self.power(of(a), of(b)),
                Node::Function(function, a) => self.function(function, of(a)),
                Node::Function2(function, a, b) => self.function2(function, of(a), of(b)),
                Node::Greater(a, b) => self.insert(Node::Greater(of(a), of(b))),
                Node::Number { .. }
                | Node::Pi
                | Node::Parameter(_)
                | Node::Jet(_)
                | Node::FrameVelocity(_) => own,
            };
            known.insert(own, value);
        }
        known[&id]
    }

    /// Derivatives of `root` at the background by all jet variables on which it depends, those that vanish identically
    /// left out.
    pub(super) fn jet_derivatives(&mut self, root: NodeId) -> Vec<(JetVariable, NodeId)> {
        let order = self.reachable(&[root]);
        let mut adjoints: HashMap<NodeId, NodeId> = HashMap::new();
        let one = self.whole(1);
        adjoints.insert(root, one);
        let mut found: Vec<(JetVariable, NodeId)> = Vec::new();
        for &id in order.iter().rev() {
            let Some(&adjoint) = adjoints.get(&id) else { continue };
            let variable = match self.node(id) {
                Node::Jet(variable) => Some(variable),
                Node::RelativeVelocity(axis) => {
                    Some(JetVariable { unknown: self.velocity[axis], orders: [0; 4] })
                }
                _ => None,
            };
            if let Some(variable) = variable {
                match found.iter_mut().find(|(own, _)| *own == variable) {
                    Some((_, sum)) => *sum = self.add(*sum, adjoint),
                    None => found.push((variable, adjoint)),
                }
            }
            for operand in self.node(id).operands() {
                if !self.depends_on_jet(operand) {
                    continue;
                }
                let factor = self.partial_derivative(id, operand);
                let term = self.multiply(adjoint, factor);
                if self.is_zero(term) {
                    continue;
                }
                let sum = match adjoints.get(&operand) {
                    Some(&own) => self.add(own, term),
                    None => term,
                };
                adjoints.insert(operand, sum);
            }
        }
        let mut known = HashMap::new();
        for (_, derivative) in &mut found {
            *derivative = self.at_background(*derivative, &mut known);
        }
        found.retain(|(_, derivative)| !self.is_zero(*derivative));
        found.sort_by_key(|(variable, _)| *variable);
        found
    }
}
