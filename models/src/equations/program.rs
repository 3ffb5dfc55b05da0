//! Expressions compiled to a flat list of instructions, one per node of the graph, without branches or a tree walk.

use super::graph::{Graph, JetVariable, Node, NodeId};
use super::syntax::Function2;
use crate::common::scalar::{Function, Scalar, pi};
use std::collections::{HashMap, HashSet};

/// Problem of `min` and `max` at their kink.
const EQUAL_ARGUMENTS: &str = "is not differentiable where its arguments are equal";

/// An input of a program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Input {
    Number { value: f64, is_exact: bool },
    Pi,
    Parameter(usize),
    Jet(JetVariable),
    RelativeVelocity(usize),
    FrameVelocity(usize),
}

/// An instruction; operands are registers.
#[derive(Clone, Copy, Debug)]
enum Instruction {
    Add(u32, u32),
    Subtract(u32, u32),
    Negate(u32),
    Multiply(u32, u32),
    Divide(u32, u32),
    WholePower(u32, u32),
    Power(u32, u32),
    Function(Function, u32),
    Function2(Function2, u32, u32),
    Greater(u32, u32),
}

/// Compiled expressions. Registers hold the inputs, then the results of the instructions.
#[derive(Clone, Debug, Default)]
pub(super) struct Program {
    inputs: Vec<Input>,
    instructions: Vec<Instruction>,
    /// Node of each instruction.
    nodes: Vec<NodeId>,
    /// Whether the argument of each instruction varies with the jet, so that it must be differentiable.
    must_be_smooth: Vec<bool>,
    /// Registers of the results.
    outputs: Vec<u32>,
}

/// An instruction whose result is not defined or not differentiable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fault {
    /// Node of the instruction; `None` if an input is not finite.
    pub(super) node: Option<NodeId>,
    /// Description of the error, as the end of a sentence.
    pub(super) problem: &'static str,
    /// Value of the argument that decides.
    pub(super) argument: f64,
}

impl Program {
    /// Compiles the expressions `roots`.
    pub(super) fn new(graph: &Graph, roots: &[NodeId]) -> Self {
        let order = needed_nodes(graph, roots);
        let mut program = Self::default();
        let mut registers: HashMap<NodeId, u32> = HashMap::new();
        let as_input = |node: Node| match node {
            Node::Number { bits, is_exact } => {
                Some(Input::Number { value: f64::from_bits(bits), is_exact })
            }
            Node::Pi => Some(Input::Pi),
            Node::Parameter(index) => Some(Input::Parameter(index)),
            Node::Jet(variable) => Some(Input::Jet(variable)),
            Node::RelativeVelocity(axis) => Some(Input::RelativeVelocity(axis)),
            Node::FrameVelocity(axis) => Some(Input::FrameVelocity(axis)),
            _ => None,
        };
        for &id in &order {
            if let Some(input) = as_input(graph.node(id)) {
                registers.insert(id, program.inputs.len() as u32);
                program.inputs.push(input);
            }
        }
        for &id in &order {
            if registers.contains_key(&id) {
                continue;
            }
            let at = |id: NodeId| registers[&id];
            let instruction = match graph.node(id) {
                Node::Add(a, b) => match as_difference(graph, a, b) {
                    Some((a, b)) => Instruction::Subtract(at(a), at(b)),
                    None => Instruction::Add(at(a), at(b)),
                },
                Node::Negate(a) => Instruction::Negate(at(a)),
                Node::Multiply(a, b) => Instruction::Multiply(at(a), at(b)),
                Node::Divide(a, b) => Instruction::Divide(at(a), at(b)),
                Node::WholePower(a, n) => Instruction::WholePower(at(a), n),
                Node::Power(a, b) => Instruction::Power(at(a), at(b)),
                Node::Function(function, a) => Instruction::Function(function, at(a)),
                Node::Function2(function, a, b) => Instruction::Function2(function, at(a), at(b)),
                Node::Greater(a, b) => Instruction::Greater(at(a), at(b)),
                Node::Number { .. }
                | Node::Pi
                | Node::Parameter(_)
                | Node::Jet(_)
                | Node::RelativeVelocity(_)
                | Node::FrameVelocity(_) => continue,
            };
            registers.insert(id, (program.inputs.len() + program.instructions.len()) as u32);
            program.instructions.push(instruction);
            program.nodes.push(id);
            program.must_be_smooth.push(graph.depends_on_jet(id));
        }
        program.outputs = roots.iter().map(|root| registers[root]).collect();
        program
    }

    /// Number of instructions.
    pub(super) fn len(&self) -> usize {
        self.instructions.len()
    }

    /// Value of the result `index` after [`evaluate`](Self::evaluate).
    pub(super) fn output<T: Scalar>(&self, registers: &[T], index: usize) -> T {
        registers[self.outputs[index] as usize]
    }

    /// Evaluates the program in `registers`; `load` returns the value of an input that is no number.
    pub(super) fn evaluate<T: Scalar>(
        &self,
        registers: &mut Vec<T>,
        load: impl Fn(&Input) -> T,
    ) -> Result<(), Fault> {
        registers.clear();
        for input in &self.inputs {
            registers.push(match *input {
                Input::Number { value, is_exact: true } => T::from_exact(value),
                Input::Number { value, is_exact: false } => T::from_rounded(value),
                Input::Pi => pi(),
                ref other => load(other),
            });
        }
        let mut all_finite = true;
        for (index, instruction) in self.instructions.iter().enumerate() {
            let r = |register: u32| registers[register as usize];
            let result = match *instruction {
                Instruction::Add(a, b) => r(a) + r(b),
                Instruction::Subtract(a, b) => r(a) - r(b),
                Instruction::Negate(a) => -r(a),
                Instruction::Multiply(a, b) => r(a) * r(b),
                Instruction::Divide(a, b) => r(a) / r(b),
                Instruction::WholePower(a, n) => r(a).whole_power(n),
                Instruction::Power(a, b) => {
                    self.check_smooth(index, r(a), "is a power that is not differentiable at 0")?;
                    r(a).power(r(b))
                }
                Instruction::Function(function, a) => {
                    self.check_function(index, function, r(a))?;
                    if matches!(function, Function::Abs | Function::Sign) && r(a).sign() == Some(0)
                    {
                        T::from_exact(0.0)
                    } else {
                        r(a).apply(function)
                    }
                }
                Instruction::Function2(Function2::Atan2, a, b) => r(a).atan2(r(b)),
                Instruction::Function2(function, a, b) => {
                    let difference = r(a) - r(b);
                    self.check_smooth(index, difference, EQUAL_ARGUMENTS)?;
                    let is_first = difference.value() > 0.0;
                    if is_first == (function == Function2::Max) { r(a) } else { r(b) }
                }
                Instruction::Greater(a, b) => {
                    let difference = r(a) - r(b);
                    self.check_smooth(index, difference, EQUAL_ARGUMENTS)?;
                    T::from_exact(if difference.value() > 0.0 { 1.0 } else { 0.0 })
                }
            };
            all_finite &= result.is_finite();
            registers.push(result);
        }
        if all_finite { Ok(()) } else { Err(self.find_not_finite(registers)) }
    }

    /// Checks that an argument that varies with the jet has a certain sign.
    fn check_smooth<T: Scalar>(
        &self,
        index: usize,
        argument: T,
        problem: &'static str,
    ) -> Result<(), Fault> {
        if self.must_be_smooth[index] && !matches!(argument.sign(), Some(1 | -1)) {
            let (node, argument) = (Some(self.nodes[index]), argument.value());
            return Err(Fault { node, problem, argument });
        }
        Ok(())
    }

    fn check_function<T: Scalar>(
        &self,
        index: usize,
        function: Function,
        argument: T,
    ) -> Result<(), Fault> {
        match function {
            Function::Abs | Function::Sign => {
                self.check_smooth(index, argument, "is not differentiable at 0")
            }
            Function::Sqrt => self.check_smooth(index, argument, "is not differentiable at 0"),
            _ => Ok(()),
        }
    }

    /// The first instruction whose result is not finite, although its operands are.
    fn find_not_finite<T: Scalar>(&self, registers: &[T]) -> Fault {
        let problem = "is not finite";
        let (inputs, results) = registers.split_at(self.inputs.len());
        if let Some(bad) = inputs.iter().find(|own| !own.is_finite()) {
            return Fault { node: None, problem, argument: bad.value() };
        }
        let index = results.iter().position(|own| !own.is_finite()).unwrap_or(0);
        let deciding = match self.instructions[index] {
            Instruction::Divide(_, b) => b,
            Instruction::Add(a, _)
            | Instruction::Subtract(a, _)
            | Instruction::Negate(a)
            | Instruction::Multiply(a, _)
            | Instruction::WholePower(a, _)
            | Instruction::Power(a, _)
            | Instruction::Function(_, a)
            | Instruction::Function2(_, a, _)
            | Instruction::Greater(a, _) => a,
        };
        let argument = registers[deciding as usize].value();
        Fault { node: Some(self.nodes[index]), problem, argument }
    }
}

/// The sum of two nodes as a difference, if one of them is a negation.
fn as_difference(graph: &Graph, a: NodeId, b: NodeId) -> Option<(NodeId, NodeId)> {
    match (graph.node(a), graph.node(b)) {
        (_, Node::Negate(inner)) => Some((a, inner)),
        (Node::Negate(inner), _) => Some((b, inner)),
        _ => None,
    }
}

/// Nodes whose values are needed, ascending. A negation that is only added is not: it becomes a subtraction.
fn needed_nodes(graph: &Graph, roots: &[NodeId]) -> Vec<NodeId> {
    let mut found = HashSet::new();
    let mut open = roots.to_vec();
    while let Some(id) = open.pop() {
        if !found.insert(id) {
            continue;
        }
        match graph.node(id) {
            Node::Add(a, b) => {
                let (a, b) = as_difference(graph, a, b).unwrap_or((a, b));
                open.extend([a, b]);
            }
            node => open.extend(node.operands()),
        }
    }
    let mut found: Vec<NodeId> = found.into_iter().collect();
    found.sort_unstable();
    found
}
