//! Checks of a model text before it is compiled: names, order of definitions, units.

use super::error::{TextError, TextPlace, line_and_column};
use super::model::{MAX_UNKNOWNS, ModelText, NamedText};
use super::syntax::{
    self, BinaryOperator, Callee, Derivative, Expression, ExpressionKind, nearest_name,
};
use super::units::{Dimension, UnitChecker, unit_names};
use std::collections::HashMap;
use std::ops::Range;

/// Largest number of definitions of a model.
const MAX_DEFINITIONS: usize = 500;

/// Checked names of a model.
pub(super) struct Names {
    pub(super) velocity: Vec<usize>,
    all: Vec<String>,
    has_velocity: bool,
}

impl Names {
    pub(super) fn new(text: &ModelText) -> Result<Self, TextError> {
        if !(1..=3).contains(&text.dimensions) {
            let found = format!("{} space dimensions", text.dimensions);
            return Err(TextError::new(TextPlace::Velocity(0), found, "expected 1, 2 or 3"));
        }
        let too_many = |place: TextPlace, count: usize, most: usize, what: &str| {
            TextError::new(place, format!("{count} {what}"), format!("at most {most}"))
        };
        if let Some(first) = text.unknowns.get(MAX_UNKNOWNS) {
            let place = TextPlace::Unknown(first.name.clone());
            return Err(too_many(place, text.unknowns.len(), MAX_UNKNOWNS, "unknowns"));
        }
        if let Some(first) = text.definitions.get(MAX_DEFINITIONS) {
            let place = TextPlace::Definition(first.name.clone());
            return Err(too_many(place, text.definitions.len(), MAX_DEFINITIONS, "definitions"));
        }
        let unknowns =
            text.unknowns.iter().map(|own| (&own.name, TextPlace::Unknown(own.name.clone())));
        let parameters =
            text.parameters.iter().map(|own| (&own.name, TextPlace::Parameter(own.name.clone())));
        let definitions =
            text.definitions.iter().map(|own| (&own.name, TextPlace::Definition(own.name.clone())));
        let mut all: Vec<String> = Vec::new();
        for (name, place) in unknowns.chain(parameters).chain(definitions) {
            if !syntax::is_name(name) {
                let remedy = "a name is a letter, then letters, digits and underscores";
                return Err(TextError::new(
                    place,
                    format!("the name '{}'", name.escape_debug()),
                    remedy,
                ));
            }
            if syntax::reserved_names().any(|own| own == name) {
                let remedy = format!(
                    "choose another name; reserved: {}",
                    syntax::reserved_names().collect::<Vec<_>>().join(", ")
                );
                return Err(TextError::new(place, format!("the name {name}"), remedy));
            }
            if all.contains(name) {
                let remedy = "name each unknown, parameter and definition differently";
                return Err(TextError::new(place, format!("the name {name} twice"), remedy));
            }
            all.push(name.clone());
        }
        let mut velocity = Vec::new();
        for (index, name) in text.velocity.iter().enumerate() {
            let place = TextPlace::Velocity(index);
            if text.velocity.len() != text.dimensions {
                let found = format!("{} components", text.velocity.len());
                let remedy = format!("name {} unknowns, one per dimension", text.dimensions);
                return Err(TextError::new(place, found, remedy));
            }
            match text.unknowns.iter().position(|own| own.name == *name) {
                Some(unknown) => velocity.push(unknown),
                None => {
                    let names = text.unknowns.iter().map(|own| own.name.as_str());
                    let listed: Vec<&str> = names.clone().collect();
                    let near = suggest(name, names);
                    let remedy = format!("{near}unknowns: {}", listed.join(", "));
                    return Err(TextError::new(place, format!("'{name}'"), remedy));
                }
            }
        }
        if text.equations.len() > text.unknowns.len() {
            let (equations, unknowns) = (text.equations.len(), text.unknowns.len());
            let place = TextPlace::Equation(text.equations[unknowns].name.clone());
            let s = if unknowns == 1 { "" } else { "s" };
            let found = format!("{equations} equations for {unknowns} unknown{s}");
            let remedy = "leave out an equation that follows from the others, or add its unknown";
            return Err(TextError::new(place, found, remedy));
        }
        for (index, name) in text.driven.iter().enumerate() {
            if !text.equations.iter().any(|own| own.name == *name) {
                let names = text.equations.iter().map(|own| own.name.as_str());
                let listed: Vec<&str> = names.clone().collect();
                let remedy = format!("{}equations: {}", suggest(name, names), listed.join(", "));
                let found = format!("'{name}'");
                return Err(TextError::new(TextPlace::Driven(index), found, remedy));
            }
        }
        Ok(Self { has_velocity: !velocity.is_empty(), velocity, all })
    }

    /// Checks all names and derivatives of an expression.
    fn check(
        &self,
        place: &TextPlace,
        text: &str,
        dimensions: usize,
        expression: &Expression,
    ) -> Result<(), TextError> {
        let error = |found: String, remedy: String| TextError {
            position: Some(line_and_column(text, expression.span.start)),
            ..TextError::new(place.clone(), found, remedy)
        };
        match &expression.kind {
            ExpressionKind::Name(name) if name != "pi" && !self.all.contains(name) => {
                let near = suggest(name, self.all.iter().map(String::as_str));
                let remedy = format!("{near}names: {}", self.all.join(", "));
                Err(error(format!("the unknown name '{name}'"), remedy))
            }
            ExpressionKind::Call(Callee::Derivative(Derivative::Space(axis)), _)
                if *axis >= dimensions =>
            {
                let found = format!("d{} in a model of {dimensions} dimensions", axis + 1);
                Err(error(found, format!("derivatives in space: d1 to d{dimensions}")))
            }
            ExpressionKind::Call(Callee::Derivative(Derivative::Material), _)
                if !self.has_velocity =>
            {
                let remedy =
                    "add velocity = [...] with the unknowns of the velocity, or write dt(...)";
                Err(error("the derivative D without a velocity".into(), remedy.into()))
            }
            _ => operands(expression).try_for_each(|own| self.check(place, text, dimensions, own)),
        }
    }
}

fn suggest<'n>(name: &str, names: impl Iterator<Item = &'n str>) -> String {
    nearest_name(name, names).map_or(String::new(), |near| format!("did you mean {near}? "))
}

/// Direct sub-expressions.
fn operands(expression: &Expression) -> impl Iterator<Item = &Expression> {
    let list: &[Expression] = match &expression.kind {
        ExpressionKind::Number { .. } | ExpressionKind::Name(_) => &[],
        ExpressionKind::Negate(inner) => std::slice::from_ref(&**inner),
        ExpressionKind::Binary(_, both) => &**both,
        ExpressionKind::Call(_, arguments) => arguments,
    };
    list.iter()
}

/// The terms that an expression adds or subtracts, without their signs.
pub(super) fn added_terms(expression: &Expression) -> Vec<&Expression> {
    let (mut open, mut terms) = (vec![expression], Vec::new());
    while let Some(own) = open.pop() {
        match &own.kind {
            ExpressionKind::Binary(BinaryOperator::Add | BinaryOperator::Subtract, both) => {
                open.extend(both.iter().rev());
            }
            ExpressionKind::Negate(inner) => open.push(inner),
            _ => terms.push(own),
        }
    }
    terms
}

pub(super) fn parse_definitions(
    text: &ModelText,
    names: &Names,
) -> Result<Vec<Expression>, TextError> {
    let parse = |own: &NamedText| {
        let place = TextPlace::Definition(own.name.clone());
        let expression = syntax::parse_expression(&place, &own.text, text.dimensions)?;
        names.check(&place, &own.text, text.dimensions, &expression)?;
        Ok(expression)
    };
    text.definitions.iter().map(parse).collect()
}

pub(super) fn parse_equations(
    text: &ModelText,
    names: &Names,
) -> Result<Vec<[Expression; 2]>, TextError> {
    let parse = |(index, own): (usize, &NamedText)| {
        let place = TextPlace::Equation(own.name.clone());
        if text.equations[..index].iter().any(|other| other.name == own.name) {
            return Err(TextError::new(place, "the name twice", "name each equation differently"));
        }
        let sides = syntax::parse_equation(&place, &own.text, text.dimensions)?;
        for side in &sides {
            names.check(&place, &own.text, text.dimensions, side)?;
        }
        Ok(sides)
    };
    text.equations.iter().enumerate().map(parse).collect()
}

/// Order of the definitions in which each follows those that it uses.
pub(super) fn sort_definitions(
    text: &ModelText,
    definitions: &[Expression],
) -> Result<Vec<usize>, TextError> {
    let find = |name: &str| text.definitions.iter().position(|own| own.name == name);
    let uses = |index: usize| {
        let (mut open, mut found) = (vec![&definitions[index]], Vec::new());
        while let Some(own) = open.pop() {
            if let ExpressionKind::Name(name) = &own.kind {
                found.extend(find(name).map(|used| (used, own.span.clone())));
            }
            open.extend(operands(own));
        }
        found
    };
    let uses: Vec<Vec<(usize, Range<usize>)>> = (0..definitions.len()).map(uses).collect();
    let mut order: Vec<usize> = Vec::new();
    let mut is_done = vec![false; definitions.len()];
    while order.len() < definitions.len() {
        let ready: Vec<usize> = (0..definitions.len())
            .filter(|&own| !is_done[own] && uses[own].iter().all(|(used, _)| is_done[*used]))
            .collect();
        if ready.is_empty() {
            return Err(cycle_error(text, &uses, &is_done));
        }
        ready.iter().for_each(|&own| is_done[own] = true);
        order.extend(ready);
    }
    Ok(order)
}

fn cycle_error(
    text: &ModelText,
    uses: &[Vec<(usize, Range<usize>)>],
    is_done: &[bool],
) -> TextError {
    let next =
        |own: usize| uses[own].iter().find(|(used, _)| !is_done[*used]).map(|(used, _)| *used);
    let mut path = vec![is_done.iter().position(|done| !done).unwrap_or(0)];
    let cycle = loop {
        let last = path[path.len() - 1];
        let Some(used) = next(last) else { break path };
        if let Some(start) = path.iter().position(|own| *own == used) {
            break path.split_off(start);
        }
        path.push(used);
    };
    let first = cycle[0];
    let names: Vec<&str> =
        cycle.iter().chain([&first]).map(|own| text.definitions[*own].name.as_str()).collect();
    let following = cycle.get(1).copied().unwrap_or(first);
    let span = uses[first].iter().find(|(used, _)| *used == following);
    let own = &text.definitions[first];
    TextError {
        position: span.map(|(_, span)| line_and_column(&own.text, span.start)),
        ..TextError::new(
            TextPlace::Definition(own.name.clone()),
            format!("definitions that use each other: {}", names.join(" → ")),
            "define one of them without the others, or make it an unknown with an equation",
        )
    }
}

/// Checks the units of all texts if the unknowns have units; parameters without a unit are then pure numbers.
pub(super) fn check_units(
    text: &ModelText,
    definitions: &[Expression],
    order: &[usize],
    equations: &[[Expression; 2]],
) -> Result<(), TextError> {
    let without: Vec<&str> = text
        .unknowns
        .iter()
        .filter(|own| own.unit.is_none())
        .map(|own| own.name.as_str())
        .collect();
    let mut dimensions: HashMap<String, Option<Dimension>> = HashMap::new();
    dimensions.insert("pi".into(), Some(Dimension::NONE));
    let unknowns = text.unknowns.iter().map(|own| (own, TextPlace::Unknown(own.name.clone())));
    let parameters =
        text.parameters.iter().map(|own| (own, TextPlace::Parameter(own.name.clone())));
    for (quantity, place) in unknowns.chain(parameters) {
        let parsed = quantity.unit.as_deref().map_or(Ok(Dimension::NONE), Dimension::parse);
        let dimension = parsed.map_err(|part| {
            let found = format!("the unit '{}'", part.escape_debug());
            let remedy = format!("write SI units without prefixes, e.g. kg/m^3: {}", unit_names());
            TextError::new(place, found, remedy)
        })?;
        dimensions.insert(quantity.name.clone(), Some(dimension));
    }
    if !without.is_empty() {
        return Ok(());
    }
    for &index in order {
        let own = &text.definitions[index];
        let place = TextPlace::Definition(own.name.clone());
        let dimension_of = |name: &str| dimensions.get(name).copied().flatten();
        let checker = UnitChecker { place: &place, text: &own.text, dimension_of };
        let found = checker.dimension(&definitions[index])?;
        dimensions.insert(own.name.clone(), found);
    }
    for (own, sides) in text.equations.iter().zip(equations) {
        let place = TextPlace::Equation(own.name.clone());
        let dimension_of = |name: &str| dimensions.get(name).copied().flatten();
        let checker = UnitChecker { place: &place, text: &own.text, dimension_of };
        checker.check_equal([&sides[0], &sides[1]])?;
    }
    Ok(())
}
