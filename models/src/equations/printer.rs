//! Coefficients of the linearised equations as text.

use super::graph::{Graph, JetVariable, Node, NodeId};
use super::model::ModelText;
use super::syntax::Callee;
use std::collections::HashMap;

/// Name of a jet variable in expressions.
pub(super) fn jet_name(text: &ModelText, variable: JetVariable) -> String {
    let mut name = text.unknowns[variable.unknown].name.clone();
    for (axis, operator) in ["dt", "d1", "d2", "d3"].iter().enumerate().rev() {
        for _ in 0..variable.orders[axis] {
            name = format!("{operator}({name})");
        }
    }
    name
}

/// Names of nodes for printing: of definitions and unknowns. Unknowns and parameters keep their names where a
/// definition gives them another one, as in `s21 = "s12"`.
pub(super) fn name_nodes(
    nodes: &HashMap<String, NodeId>,
    graph: &Graph,
) -> HashMap<NodeId, String> {
    let mut named: Vec<(&String, NodeId)> = nodes.iter().map(|(name, id)| (name, *id)).collect();
    named.sort();
    let is_short = |id: NodeId| match graph.node(id) {
        Node::Number { .. } | Node::Parameter(_) => true,
        Node::Jet(variable) => variable.orders == [0; 4],
        _ => false,
    };
    named
        .into_iter()
        .filter(|(_, id)| !is_short(*id))
        .map(|(name, id)| (id, name.clone()))
        .collect()
}

/// Prints nodes as expressions in the names of the model.
pub(super) struct Printer<'a> {
    pub(super) graph: &'a Graph,
    pub(super) text: &'a ModelText,
    pub(super) named: HashMap<NodeId, String>,
}

/// Longest expression of a coefficient that is printed in full, in characters.
const MAX_PRINTED: usize = 80;

impl Printer<'_> {
    /// Prints the coefficient `node` of `variable` in equation `row`; a long one as the derivative that it is.
    pub(super) fn print(&self, node: NodeId, row: usize, variable: JetVariable) -> String {
        let mut printed = String::new();
        if self.write(node, 0, &mut printed) {
            return printed;
        }
        let by = jet_name(self.text, variable);
        format!("∂[{}]/∂[{by}]", self.text.equations[row].name)
    }

    /// Appends `node`, in parentheses if it binds less than `level`; whether it is short enough.
    fn write(&self, id: NodeId, level: u8, out: &mut String) -> bool {
        if out.len() > MAX_PRINTED {
            return false;
        }
        if let Some(name) = self.named.get(&id) {
            out.push_str(name);
            return true;
        }
        let own = match self.graph.node(id) {
            Node::Add(..) => 1,
            Node::Negate(_) => 1,
            Node::Multiply(..) | Node::Divide(..) => 2,
            Node::WholePower(..) | Node::Power(..) => 3,
            _ => 4,
        };
        let open = own < level;
        if open {
            out.push('(');
        }
        let written = match self.graph.node(id) {
            Node::Number { bits, .. } => {
                out.push_str(&f64::from_bits(bits).to_string());
                true
            }
            Node::Pi => {
                out.push_str("pi");
                true
            }
            Node::Parameter(index) => {
                out.push_str(&self.text.parameters[index].name);
                true
            }
            Node::Jet(variable) => {
                out.push_str(&jet_name(self.text, variable));
                true
            }
            Node::RelativeVelocity(_) => {
                out.push('0');
                true
            }
            Node::FrameVelocity(axis) => {
                out.push_str(&self.text.velocity[axis]);
                true
            }
            Node::Add(a, b) => match (self.graph.node(a), self.graph.node(b)) {
                (_, Node::Negate(inner)) => {
                    self.write(a, 1, out) && self.write_after(" - ", inner, 2, out)
                }
                (Node::Negate(inner), _) => {
                    self.write(b, 1, out) && self.write_after(" - ", inner, 2, out)
                }
                _ => self.write(a, 1, out) && self.write_after(" + ", b, 1, out),
            },
            Node::Negate(a) => self.write_after("-", a, 2, out),
            Node::Multiply(a, b) => self.write(a, 2, out) && self.write_after("*", b, 3, out),
            Node::Divide(a, b) => self.write(a, 2, out) && self.write_after("/", b, 3, out),
            Node::WholePower(a, n) => {
                let written = self.write(a, 4, out);
                out.push_str(&format!("^{n}"));
                written
            }
            Node::Power(a, b) => self.write(a, 4, out) && self.write_after("^", b, 4, out),
            Node::Function(function, a) => {
                out.push_str(Callee::Function(function).name());
                self.write_arguments(&[a], out)
            }
            Node::Function2(function, a, b) => {
                out.push_str(Callee::Function2(function).name());
                self.write_arguments(&[a, b], out)
            }
            Node::Greater(a, b) => {
                // (1 + sign(a − b))/2
                out.push_str("(1 + sign(");
                let written = self.write(a, 1, out) && self.write_after(" - ", b, 2, out);
                out.push_str("))/2");
                written
            }
        };
        if open {
            out.push(')');
        }
        written && out.len() <= MAX_PRINTED
    }

    fn write_after(&self, sign: &str, id: NodeId, level: u8, out: &mut String) -> bool {
        out.push_str(sign);
        self.write(id, level, out)
    }

    fn write_arguments(&self, arguments: &[NodeId], out: &mut String) -> bool {
        for (index, argument) in arguments.iter().enumerate() {
            if !self.write_after(if index == 0 { "(" } else { ", " }, *argument, 0, out) {
                return false;
            }
        }
        out.push(')');
        true
    }
}
