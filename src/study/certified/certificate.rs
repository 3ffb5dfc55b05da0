//! Certificate of the verdict on all states of a box about the state of a case.

use super::{BoxAssessor, CellVerdict, Proof};
use crate::Error;
use crate::case::{Case, SweepParameter};
use certificates::{
    Axis, Certificate, Claim, FORMAT_VERSION, Number, Part, ProvedVerdict, format_number,
};
use serde::Serialize;

/// Largest number of halvings of a box along each axis.
const MAX_HALVINGS: u32 = 5;

/// Range of a number of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct BoxRange {
    /// Key of the number, such as `model.friction_angle_deg`.
    pub key: String,
    /// Least and largest value, in the unit of the key.
    pub ends: [f64; 2],
}

/// Fault of a [`BoxRange`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("range of {key}: {found}; {allowed}")]
pub struct BoxRangeError {
    /// Key of the number.
    pub key: String,
    /// Value found.
    pub found: String,
    /// Values allowed.
    pub allowed: String,
}

/// What is proved of the states of a box.
#[derive(Clone, Debug, Serialize)]
pub struct CertifiedState {
    /// Method of the proof and its assumptions.
    pub method: String,
    /// Verdict on all states of the box.
    pub verdict: &'static str,
    /// Numbers that run over the box; the others have the values of the case.
    #[serde(rename = "box")]
    pub axes: Vec<Axis>,
    /// Shares of the box by the verdict of its parts.
    #[serde(serialize_with = "crate::study::map::summary::serialize_as_object")]
    pub shares: [(&'static str, f64); 4],
    /// Lower and upper bound on the bound on the non-coaxiality |Δ| over the box, degrees; `None` of a model without it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noncoaxiality_bound_deg: Option<[f64; 2]>,
    /// Least margin of the deciding quantities, from 0 to 1; `None` without a certificate.
    pub least_margin: Option<f64>,
    /// The proof; `None` if the verdict is not proved for all states of the box.
    #[serde(skip)]
    pub certificate: Option<Certificate>,
}

/// Proves the verdict on the state of a case, or on all states with up to two numbers in these ranges. A box in which that
/// fails is halved along its axes, at most five times.
///
/// # Errors
/// No proof is known for the material or its state, or for a number with a range; a range is empty.
pub fn certify_state(case: &Case, ranges: &[BoxRange]) -> Result<CertifiedState, Error> {
    let proof = Proof::find(case).map_err(|error| case.locate_error(error))?;
    let parameters = check_ranges(case, proof, ranges)?;
    let axes = [parameters.first().copied(), parameters.get(1).copied()];
    let ends = [0, 1].map(|axis| ranges.get(axis).map_or([0.0; 2], |own| own.ends));
    let mut found = Parts {
        assessor: BoxAssessor::new(case, axes, proof),
        axis_count: ranges.len(),
        shares: [0.0; 4],
        proved: Default::default(),
    };
    found.prove(&ends, MAX_HALVINGS, 1.0);
    let noncoaxiality_bound_deg = found.bound_noncoaxiality(&ends, MAX_HALVINGS);
    let names = proof.verdict_names(case, &parameters);
    let shares = found.shares;
    let is_all = |verdict: CellVerdict| shares[verdict as usize] == 1.0;
    let all = CellVerdict::ALL.into_iter().find(|&own| is_all(own));
    let verdict = all.unwrap_or(CellVerdict::NotDecided);
    let method = match verdict {
        CellVerdict::IllPosed => proof.method(),
        _ => proof.method() + proof.scope(case, &parameters),
    };
    let [well_posed, ill_posed] = found.proved;
    let proved = match verdict {
        CellVerdict::WellPosed => Some((ProvedVerdict::WellPosed, well_posed)),
        CellVerdict::IllPosed => Some((ProvedVerdict::IllPosed, ill_posed)),
        CellVerdict::NotDecided | CellVerdict::NoState => None,
    };
    let axes: Vec<Axis> = ranges
        .iter()
        .map(|BoxRange { key, ends: [from, to] }| Axis { key: key.clone(), from: *from, to: *to })
        .collect();
    let certificate = proved.map(|(verdict, parts)| Certificate {
        certificate: FORMAT_VERSION,
        statement: format!("{}: {}", names[verdict as usize], method),
        test: proof.test(),
        verdict,
        numbers: constants(case, proof, ranges),
        axes: axes.clone(),
        least_margin: least_margin(&parts),
        parts,
    });
    Ok(CertifiedState {
        method,
        verdict: names[verdict as usize],
        axes,
        shares: std::array::from_fn(|code| (names[code], shares[code])),
        noncoaxiality_bound_deg,
        least_margin: certificate.as_ref().map(|own| own.least_margin),
        certificate,
    })
}

/// Whether a certificate is about the state of a case, or about a box about it.
///
/// # Errors
/// No proof is known for the material or its state.
pub fn is_certificate_of(case: &Case, certificate: &Certificate) -> Result<bool, Error> {
    let proof = Proof::find(case).map_err(|error| case.locate_error(error))?;
    let range = |own: &Axis| BoxRange { key: own.key.clone(), ends: [own.from, own.to] };
    let ranges: Vec<BoxRange> = certificate.axes.iter().map(range).collect();
    Ok(certificate.test == proof.test() && certificate.numbers == constants(case, proof, &ranges))
}

/// Checks that a proof is known over these ranges.
fn check_ranges(
    case: &Case,
    proof: Proof,
    ranges: &[BoxRange],
) -> Result<Vec<SweepParameter>, BoxRangeError> {
    let find = |key: &str| {
        let own = SweepParameter::find_by_name(key)?;
        own.key().is_used_by(case.medium()).then_some(own)
    };
    let keys = proof.test().keys();
    let check = |(index, BoxRange { key, ends: [low, high] }): (usize, &BoxRange)| {
        let found = format!("{} to {}", format_number(*low), format_number(*high));
        let fault = |found: String, allowed: String| {
            Err(BoxRangeError { key: key.clone(), found, allowed })
        };
        if ranges[..index].iter().any(|own| own.key == *key) {
            return fault("given twice".into(), "expected one range of a number".into());
        }
        if index > 1 {
            return fault("a third range".into(), "expected ranges of at most two numbers".into());
        }
        if !(low < high && low.is_finite() && high.is_finite()) {
            return fault(found, "expected two finite numbers, the least first".into());
        }
        match find(key).filter(|_| keys.contains(&key.as_str())) {
            Some(own) => Ok(own),
            None => {
                let names = keys.iter().filter(|own| find(own).is_some()).copied();
                let names = names.collect::<Vec<_>>().join(", ");
                let found =
                    "the verdict does not depend on this number, or nothing is proved over it";
                fault(found.into(), format!("expected one of {names}"))
            }
        }
    };
    let found = ranges.iter().enumerate().map(check).collect::<Result<_, _>>()?;
    // Angles of a certificate lie within a full turn.
    let angle = "background.noncoaxiality_deg";
    let numbers = constants(case, proof, ranges).into_iter().map(|own| (own.key, [own.value; 2]));
    let all = ranges.iter().map(|own| (own.key.clone(), own.ends)).chain(numbers);
    for (key, [low, high]) in all {
        if key == angle && !(low > -180.0 && high < 180.0) {
            let found = format!("{} to {}", format_number(low), format_number(high));
            let allowed = "expected angles between -180 and 180".into();
            return Err(BoxRangeError { key, found, allowed });
        }
    }
    Ok(found)
}

/// Values in the case of the numbers that the proof takes and that have no range; zero where the case has none.
fn constants(case: &Case, proof: Proof, ranges: &[BoxRange]) -> Vec<Number> {
    let value = |key: &&str| {
        let is_range = ranges.iter().any(|own| own.key == **key);
        let found = SweepParameter::find_by_name(key).filter(|_| !is_range)?;
        let value = found.value(&case.material.numbers).filter(|own| !own.is_nan());
        Some(Number { key: (*key).to_owned(), value: value.unwrap_or(0.0) })
    };
    proof.test().keys().iter().filter_map(value).collect()
}

fn least_margin(parts: &[Part]) -> f64 {
    parts.iter().flat_map(|part| &part.claims).map(Claim::margin).fold(f64::INFINITY, f64::min)
}

/// Parts of a box.
struct Parts {
    assessor: BoxAssessor,
    axis_count: usize,
    /// Shares of the box by verdict.
    shares: [f64; 4],
    /// Parts proved well-posed and ill-posed.
    proved: [Vec<Part>; 2],
}

impl Parts {
    /// The halves of a box along each axis.
    fn halve(&self, ends: &[[f64; 2]; 2]) -> Vec<[[f64; 2]; 2]> {
        let halves = |axis: usize| {
            let [low, high] = ends[axis];
            let middle = 0.5 * low + 0.5 * high;
            if axis < self.axis_count {
                vec![[low, middle], [middle, high]]
            } else {
                vec![[low, high]]
            }
        };
        let (first, second) = (halves(0), halves(1));
        second.iter().flat_map(|&y| first.iter().map(move |&x| [x, y])).collect()
    }

    /// Lower and upper bound on the bound on the non-coaxiality, degrees, over all parts after a number of halvings; `None`
    /// if there is none in one of them.
    fn bound_noncoaxiality(&mut self, ends: &[[f64; 2]; 2], halvings: u32) -> Option<[f64; 2]> {
        if halvings == 0 || self.axis_count == 0 {
            return self.assessor.bound_noncoaxiality(ends);
        }
        let parts = self.halve(ends);
        parts.iter().try_fold([f64::INFINITY, f64::NEG_INFINITY], |all, own| {
            let [low, high] = self.bound_noncoaxiality(own, halvings - 1)?;
            Some([low.min(all[0]), high.max(all[1])])
        })
    }

    fn prove(&mut self, ends: &[[f64; 2]; 2], halvings: u32, share: f64) {
        let found = self.assessor.assess(ends);
        let is_proved = matches!(found.verdict, CellVerdict::WellPosed | CellVerdict::IllPosed);
        if !is_proved && halvings > 0 && self.axis_count > 0 {
            let parts = self.halve(ends);
            let share = share / parts.len() as f64;
            parts.iter().for_each(|own| self.prove(own, halvings - 1, share));
            return;
        }
        self.shares[found.verdict as usize] += share;
        if let Some(own) = self.proved.get_mut(found.verdict as usize) {
            own.push(Part { ends: ends[..self.axis_count].to_vec(), claims: found.claims });
        }
    }
}
