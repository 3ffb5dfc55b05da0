//! The section `[background]` of a model given as equations: values and derivatives of the unknowns.

use super::{NumberSlot, SOLVE, SlotTarget};
use crate::error::CaseError;
use crate::node::{Node, format_segment};
use crate::section::SectionReader;
use crate::value::parse_number;
use models::equations::{JetVariable, MAX_ORDER, TextModel};

/// Name of a jet variable in `[background]`: `value`, or `d` and the variables of the derivatives.
pub fn derivative_name(variable: JetVariable) -> String {
    let letters: String = ["t", "1", "2", "3"]
        .iter()
        .zip(variable.orders)
        .map(|(letter, order)| letter.repeat(order.into()))
        .collect();
    if letters.is_empty() { "value".to_owned() } else { format!("d{letters}") }
}

/// Orders of the derivative `name` in a model of `dimensions` dimensions.
fn parse_derivative(name: &str, dimensions: usize) -> Option<[u8; 4]> {
    let mut orders = [0u8; 4];
    if name == "value" {
        return Some(orders);
    }
    let letters = name.strip_prefix('d').filter(|letters| !letters.is_empty())?;
    for letter in letters.chars() {
        let axis = match letter {
            't' => 0,
            '1'..='3' => (letter as usize) - ('0' as usize),
            _ => return None,
        };
        if axis > dimensions || orders.iter().sum::<u8>() == MAX_ORDER {
            return None;
        }
        orders[axis] += 1;
    }
    Some(orders)
}

/// Reader of the section `[background]`.
pub(super) struct BackgroundReader<'r, 'a> {
    pub(super) section: &'r SectionReader<'a>,
    pub(super) model: &'r TextModel,
    pub(super) slots: &'r mut Vec<NumberSlot>,
    pub(super) values: &'r mut Vec<f64>,
    pub(super) solved: &'r mut Vec<JetVariable>,
}

impl BackgroundReader<'_, '_> {
    pub(super) fn read(&mut self) -> Result<(), CaseError> {
        let first = self.slots.len();
        for (name, node) in self.section.entries() {
            let Some(unknown) = self.model.find_unknown(name) else {
                let names: Vec<&str> = self.model.unknowns().iter().map(|own| own.name).collect();
                return Err(self.section.unknown_key_error(name, &names));
            };
            let key = format_segment(name);
            match node {
                Node::Table(table) => {
                    for (derivative, inner) in table.entries() {
                        let own = format!("{key}.{}", format_segment(derivative));
                        let orders = parse_derivative(derivative, self.model.dimensions());
                        let Some(orders) = orders else {
                            let allowed = format!(
                                "allowed: value, and derivatives such as dt, d1, d11 of at most order {MAX_ORDER}, with \
                                 t and axes 1 to {}",
                                self.model.dimensions()
                            );
                            return Err(self.section.key_error(
                                &own,
                                "unknown derivative",
                                allowed,
                            ));
                        };
                        self.read_number(&own, inner, JetVariable { unknown, orders })?;
                    }
                }
                node => self.read_number(&key, node, JetVariable { unknown, orders: [0; 4] })?,
            }
        }
        // In the order of the unknowns, as resolved cases are written.
        let variable = |slot: &NumberSlot| match slot.target {
            SlotTarget::Background(variable) => Some(variable),
            SlotTarget::Parameter(_) => None,
        };
        let slots = self.slots.drain(first..).zip(self.values.drain(first..));
        let mut pairs: Vec<(NumberSlot, f64)> = slots.collect();
        pairs.sort_by_key(|(slot, _)| variable(slot));
        for (slot, value) in pairs {
            self.slots.push(slot);
            self.values.push(value);
        }
        self.solved.sort_unstable();
        Ok(())
    }

    fn read_number(
        &mut self,
        key: &str,
        node: &Node,
        variable: JetVariable,
    ) -> Result<(), CaseError> {
        if self.solved.contains(&variable)
            || self.slots.iter().any(|slot| slot.target == SlotTarget::Background(variable))
        {
            let allowed = "give each derivative once, e.g. d12 or d21";
            return Err(self.section.key_error(key, "found the same derivative twice", allowed));
        }
        if node.as_text().as_deref() == Some(SOLVE) && variable.orders != [0; 4] {
            self.solved.push(variable);
            return Ok(());
        }
        let Some(value) = node.as_value().and_then(parse_number) else {
            let found = format!("found {}", node.describe());
            let allowed = "expected a number, or \"solve\" for a derivative";
            return Err(self.section.key_error(key, found, allowed));
        };
        let unknown = self.model.unknowns()[variable.unknown].name;
        let (own_key, label) = match derivative_name(variable).as_str() {
            "value" => (format!("background.{unknown}"), unknown.to_owned()),
            derivative => {
                (format!("background.{unknown}.{derivative}"), format!("{derivative} {unknown}"))
            }
        };
        self.slots.push(NumberSlot {
            key: own_key,
            label,
            unit: self.unit_of(variable),
            target: SlotTarget::Background(variable),
        });
        self.values.push(value);
        Ok(())
    }

    /// Unit of a jet variable, for axis labels.
    fn unit_of(&self, variable: JetVariable) -> String {
        let unit = &self.model.text().unknowns[variable.unknown].unit;
        let Some(unit) = unit else { return String::new() };
        let [time, space @ ..] = variable.orders;
        let space: u8 = space.iter().sum();
        let power = |order: u8, name: &str| match order {
            0 => String::new(),
            1 => format!("/{name}"),
            order => format!("/{name}^{order}"),
        };
        format!("{unit}{}{}", power(space, "m"), power(time, "s"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivative_names_are_read_back() {
        for name in ["value", "dt", "d1", "d12", "d22", "dt12", "dtt11"] {
            let orders = parse_derivative(name, 2).expect("a derivative");
            assert_eq!(derivative_name(JetVariable { unknown: 0, orders }), name);
        }
        for name in ["d", "d3", "dx", "d11111", "t", "v"] {
            assert_eq!(parse_derivative(name, 2), None, "{name}");
        }
        assert_eq!(parse_derivative("d21", 2), parse_derivative("d12", 2));
    }
}
