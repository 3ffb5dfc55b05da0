//! `wellposed models`: lists models, yield sets, media with contacts and joints, with equations and references.

use super::{CommandError, OutputFormat};
use crate::case::ModelKind;
use crate::report::SCHEMA_VERSION;
use models::registry;
use serde_json::json;
use std::io::Write;

/// Governing equations, in words and symbols, and reference of a model.
struct Description {
    group: &'static str,
    name: &'static str,
    equations: &'static str,
    reference: &'static str,
}

/// Descriptions of the models, yield sets, granular and porous media and layers of the program, and of the two kinds
/// without a registry entry. Models that a program registers have a title alone.
const DESCRIPTIONS: [Description; 25] = [
    Description {
        group: "flow",
        name: "harris-grekova",
        equations: "Mohr–Coulomb yield; flow rule sin 2Δ = −(ω − s₂₁) sin(φ − ν)/(Q_D cos ν) with the intrinsic spin ω; \
                    balances of mass, momentum and spin",
        reference: "Harris & Grekova (2005)",
    },
    Description {
        group: "flow",
        name: "double-shearing",
        equations: "Mohr–Coulomb yield; the same flow rule with the rate of the stress angle, ω = dΨ_Σ/dt",
        reference: "Spencer (1964); Mehrabadi & Cowin (1978)",
    },
    Description {
        group: "flow",
        name: "plastic-potential",
        equations: "Mohr–Coulomb yield; coaxial flow, Δ = 0, with a dilatancy angle ν independent of the friction angle φ",
        reference: "Drucker & Prager (1952); Davis (1968)",
    },
    Description {
        group: "flow",
        name: "free-rotating",
        equations: "Mohr–Coulomb yield; the same flow rule with an undetermined ω: one equation fewer than unknowns",
        reference: "de Josselin de Jong (1977)",
    },
    Description {
        group: "solid",
        name: "classical",
        equations: "W = ½λ(tr Λ)² + μ|Λˢ|²",
        reference: "Love (1927)",
    },
    Description {
        group: "solid",
        name: "reduced-cosserat",
        equations: "W = ½λ(tr Λ)² + μ|Λˢ|² + α|Λᵃ|²,  Λᵢⱼ = ∂ⱼuᵢ + εᵢⱼₖφₖ",
        reference: "Schwartz, Johnson & Feng (1984); Grekova, Kulesh & Herman (2009)",
    },
    Description {
        group: "solid",
        name: "cosserat",
        equations: "W = ½λ(tr Λ)² + μ|Λˢ|² + α|Λᵃ|² + ½β(tr M)² + γ|Mˢ|² + η|Mᵃ|²,  Mₖⱼ = ∂ⱼφₖ",
        reference: "Cosserat & Cosserat (1909); Nowacki (1986)",
    },
    Description {
        group: "solid",
        name: "cosserat-compliances",
        equations: "plane strain, compliances a₁, b₁, a₂, b₂, α₂; cubic unless a₁ + b₁ = a₂ − b₂",
        reference: "Sadovskii & Sadovskaya (2019)",
    },
    Description {
        group: "yield set",
        name: "interlayer",
        equations: "|σ₂₁| ≤ τ₀ − κσ₁₁, |σ₁₂| ≤ τ₀ − κσ₂₂; with couple stress also |m₃₁| ≤ μ₀ − κσ₁₁, |m₃₂| ≤ μ₀ − κσ₂₂",
        reference: "Sadovskii & Sadovskaya (2019)",
    },
    Description {
        group: "yield set",
        name: "von-mises",
        equations: "τ̄ ≤ k,  τ̄² = ½|s|²",
        reference: "von Mises (1913)",
    },
    Description {
        group: "yield set",
        name: "drucker-prager",
        equations: "τ̄ ≤ k − κσ_m,  τ̄² = ½|s|²",
        reference: "Drucker & Prager (1952)",
    },
    Description {
        group: "yield set",
        name: "cosserat-mises",
        equations: "τ̄ ≤ k − κσ_m,  τ̄² = ½|s|² + ½h|σᵃ|² + ½|mˢ|²/ℓ_s² + ½|mᵃ|²/ℓ_a²",
        reference: "Mühlhaus & Vardoulakis (1987); de Borst (1991)",
    },
    Description {
        group: "medium",
        name: "granular",
        equations: "particles with the moduli of [model], contacts without tension: stress projected onto τ ≤ æp, τ ≤ τ_s",
        reference: "Sadovskii & Sadovskaya (2012)",
    },
    Description {
        group: "medium",
        name: "porous",
        equations: "skeleton that yields at τ = τ_s, and a spring or a cone that acts when the pores are closed, tr ε ≤ −θ₀",
        reference: "Sadovskii & Sadovskaya (2019)",
    },
    Description {
        group: "joint",
        name: "elastic",
        equations: "C Ṡ = d,  C = δ/(ρ′c′²), per component of the traction S; d velocity difference of the faces",
        reference: "Sadovskii & Sadovskaya (2019)",
    },
    Description {
        group: "joint",
        name: "elastic-plastic",
        equations: "elastic, with |S_t| ≤ τ_s + Hχ − k_s S_n and associated slip χ, opening included",
        reference: "Sadovskii & Sadovskaya (2019)",
    },
    Description {
        group: "joint",
        name: "viscous",
        equations: "shear δa₀Ṡ + δa₁ṡ = d,  a₁ṡ = (S − s)/η",
        reference: "Sadovskii & Sadovskaya (2019)",
    },
    Description {
        group: "joint",
        name: "porous",
        equations: "S_n = b₀ε + b₁ min(θ₀ + ε, 0)",
        reference: "Sadovskii & Sadovskaya (2019)",
    },
    Description {
        group: "joint",
        name: "saturated",
        equations: "porous, with the pressure of a fluid that flows along the layer",
        reference: "Sadovskii & Sadovskaya (2019); Biot (1962)",
    },
    Description {
        group: "joint",
        name: "cracked",
        equations: "closed and elastic, or open without traction; with or without Coulomb friction",
        reference: "Sadovskii & Sadovskaya (2019)",
    },
    Description {
        group: "joint",
        name: "breaking",
        equations: "elastic-plastic until S_n reaches σ_t, then cracked",
        reference: "Sadovskii & Sadovskaya (2019)",
    },
    Description {
        group: "joint",
        name: "porous-viscous",
        equations: "S_n of porous, shear of viscous",
        reference: "Sadovskii & Sadovskaya (2019)",
    },
    Description {
        group: "joint",
        name: "porous-plastic",
        equations: "S_n of porous, shear of elastic-plastic without friction",
        reference: "Sadovskii & Sadovskaya (2019)",
    },
    Description {
        group: "other",
        name: "equations",
        equations: "the equations of the case file",
        reference: "references in the bundled cases cases/equations/*.toml; docs/equations.md",
    },
    Description {
        group: "other",
        name: "rheology",
        equations: "springs, dampers, hinges and rigid contacts in series and in parallel, along one axis",
        reference: "Sadovskii & Sadovskaya (2012, 2019); docs/rheology.md",
    },
];

/// A row of the list.
struct ModelRow {
    group: &'static str,
    name: &'static str,
    title: &'static str,
}

/// Prints models, yield sets, media with contacts, joints and other kinds with their equations and references.
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
    let medium = |(name, title)| ModelRow { group: "medium", name, title };
    rows.extend([("granular", "granular medium"), ("porous", "porous medium")].map(medium));
    rows.extend(registry::LAYERS.iter().map(|layer| ModelRow {
        group: "joint",
        name: layer.name,
        title: layer.title,
    }));
    rows.extend(ModelKind::WITHOUT_ENTRY.map(row("other")));
    let describe = |row: &ModelRow| {
        DESCRIPTIONS.iter().find(|own| [own.group, own.name] == [row.group, row.name])
    };
    match format {
        OutputFormat::Json => {
            let list: Vec<_> = rows
                .iter()
                .map(|row| {
                    let own = describe(row);
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
                if let Some(own) = describe(row) {
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
        "medium" => {
            "Media with contacts, a section beside model.kind = \"classical\" (wellposed shocks, run, check)"
        }
        "joint" => {
            "Joints of blocky media, joint.kind (wellposed run, check, dispersion, homogenise)"
        }
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
