//! `wellposed models`: lists the models, yield sets and other media with their equations and references.

use super::{CommandError, OutputFormat};
use crate::case::ModelKind;
use crate::report::SCHEMA_VERSION;
use models::registry;
use serde_json::json;
use std::io::Write;

/// Governing equations, in words and symbols, and reference of a model.
struct Description {
    name: &'static str,
    equations: &'static str,
    reference: &'static str,
}

/// Descriptions of the models and yield sets of the program, and of the two kinds without a registry entry. Models that
/// a program registers have a title alone.
const DESCRIPTIONS: [Description; 14] = [
    Description {
        name: "harris-grekova",
        equations: "Mohr–Coulomb yield; flow rule sin 2Δ = −(ω − s₂₁) sin(φ − ν)/(Q_D cos ν) with the intrinsic spin ω; \
                    balances of mass, momentum and spin",
        reference: "Harris & Grekova (2005)",
    },
    Description {
        name: "double-shearing",
        equations: "Mohr–Coulomb yield; the same flow rule with the rate of the stress angle, ω = dΨ_Σ/dt",
        reference: "Spencer (1964); Mehrabadi & Cowin (1978)",
    },
    Description {
        name: "plastic-potential",
        equations: "Mohr–Coulomb yield; coaxial flow, Δ = 0, with a dilatancy angle ν independent of the friction angle φ",
        reference: "plastic potential of Mohr–Coulomb type",
    },
    Description {
        name: "free-rotating",
        equations: "Mohr–Coulomb yield; the same flow rule with an undetermined ω: one equation fewer than unknowns",
        reference: "de Josselin de Jong (1977)",
    },
    Description {
        name: "classical",
        equations: "W = ½λ(tr Λ)² + μ|Λˢ|²",
        reference: "linear elasticity",
    },
    Description {
        name: "reduced-cosserat",
        equations: "W = ½λ(tr Λ)² + μ|Λˢ|² + α|Λᵃ|²,  Λᵢⱼ = ∂ⱼuᵢ + εᵢⱼₖφₖ",
        reference: "Cosserat solid without couple stress",
    },
    Description {
        name: "cosserat",
        equations: "W = ½λ(tr Λ)² + μ|Λˢ|² + α|Λᵃ|² + ½β(tr M)² + γ|Mˢ|² + η|Mᵃ|²,  Mₖⱼ = ∂ⱼφₖ",
        reference: "isotropic Cosserat (micropolar) solid",
    },
    Description {
        name: "cosserat-compliances",
        equations: "plane strain, compliances a₁, b₁, a₂, b₂, α₂; cubic unless a₁ + b₁ = a₂ − b₂",
        reference: "Sadovskii & Sadovskaya (2019)",
    },
    Description {
        name: "interlayer",
        equations: "|σ₂₁| ≤ τ₀ − κσ₁₁, |σ₁₂| ≤ τ₀ − κσ₂₂; with couple stress also |m₃₁| ≤ μ₀ − κσ₁₁, |m₃₂| ≤ μ₀ − κσ₂₂",
        reference: "slipping and rolling layers",
    },
    Description {
        name: "von-mises",
        equations: "τ̄ ≤ k,  τ̄² = ½|s|²",
        reference: "von Mises (1913)",
    },
    Description {
        name: "drucker-prager",
        equations: "τ̄ ≤ k − κσ_m,  τ̄² = ½|s|²",
        reference: "Drucker & Prager (1952)",
    },
    Description {
        name: "cosserat-mises",
        equations: "τ̄ ≤ k − κσ_m,  τ̄² = ½|s|² + ½h|σᵃ|² + ½|mˢ|²/ℓ_s² + ½|mᵃ|²/ℓ_a²",
        reference: "Drucker–Prager cone with antisymmetric stress and couple stress",
    },
    Description {
        name: "equations",
        equations: "the equations of the case file",
        reference: "docs/equations.md",
    },
    Description {
        name: "rheology",
        equations: "springs, dampers, hinges and rigid contacts in series and in parallel, along one axis",
        reference: "docs/rheology.md",
    },
];

/// A row of the list.
struct ModelRow {
    group: &'static str,
    name: &'static str,
    title: &'static str,
}

/// Prints the models, yield sets and other kinds with their equations and references.
///
/// # Errors
/// Standard output cannot be written.
pub fn list_models(format: OutputFormat, stdout: &mut dyn Write) -> Result<(), CommandError> {
    let row =
        |group| move |kind: ModelKind| ModelRow { group, name: kind.name(), title: kind.title() };
    let mut rows: Vec<ModelRow> = ModelKind::flow_kinds().into_iter().map(row("flow")).collect();
    rows.extend(ModelKind::solid_kinds().into_iter().map(row("solid")));
    let sets = registry::yield_sets();
    rows.extend(sets.iter().map(|set| ModelRow {
        group: "yield set",
        name: set.name,
        title: set.title,
    }));
    rows.extend(ModelKind::WITHOUT_ENTRY.map(row("other")));
    let describe = |name: &str| DESCRIPTIONS.iter().find(|own| own.name == name);
    match format {
        OutputFormat::Json => {
            let list: Vec<_> = rows
                .iter()
                .map(|row| {
                    let own = describe(row.name);
                    json!({
                        "group": row.group,
                        "name": row.name,
                        "title": row.title,
                        "equations": own.map(|own| own.equations),
                        "reference": own.map(|own| own.reference),
                    })
                })
                .collect();
            writeln!(stdout, "{:#}", json!({ "schema": SCHEMA_VERSION, "models": list }))?;
        }
        OutputFormat::Text => {
            let mut group = "";
            for row in &rows {
                if row.group != group {
                    let gap = if group.is_empty() { "" } else { "\n" };
                    writeln!(stdout, "{gap}{}", group_heading(row.group))?;
                    group = row.group;
                }
                writeln!(stdout, "  {:<22}{}", row.name, row.title)?;
                if let Some(own) = describe(row.name) {
                    writeln!(
                        stdout,
                        "  {:<22}{}\n  {:<22}{}",
                        "", own.equations, "", own.reference
                    )?;
                }
            }
        }
    }
    Ok(())
}

fn group_heading(group: &str) -> &'static str {
    match group {
        "flow" => "Granular flows, model.kind (wellposed map, point, run, check)",
        "solid" => "Solids, model.kind (wellposed map, point, dispersion, speeds, run, check)",
        "yield set" => "Yield sets of solids, yield.kind",
        _ => "Other kinds",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_model_of_the_program_is_described() {
        let mut text = Vec::new();
        list_models(OutputFormat::Json, &mut text).unwrap();
        let list: serde_json::Value = serde_json::from_slice(&text).unwrap();
        let rows = list["models"].as_array().unwrap();
        assert_eq!(rows.len(), DESCRIPTIONS.len());
        for row in rows {
            assert!(row["equations"].is_string() && row["reference"].is_string(), "{row}");
        }
    }
}
