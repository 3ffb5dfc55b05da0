//! Implicit step of a rheological scheme, solved exactly.
//!
//! In a step of duration Δt every element must end on its graph of stress against strain increment (backward Euler for
//! the damper). The graphs are monotone polylines, so are their sums: along the stress for branches in series, along
//! the strain for branches in parallel. The sum of the whole tree is read at the prescribed strain or stress, and the
//! result is handed down. Where several branches may move at the same stress, the first takes as much as it can; an
//! element that need not move stays. Strain increments, not strains, are the coordinates: a stiff branch that has moved
//! far keeps the digits of its stress.
//!
//! The step is the minimum of a convex function, and its loss is the gap of its duality (Moreau 1974; Sadovskii &
//! Sadovskaya 2019 for schemes with rigid contacts): the work of the new stress is the change of the stored energy, the
//! dissipated energy and the loss of the implicit step, which is not negative.

use super::element::ElementState;
use super::polyline::{Coordinate, MonotonePolyline};
use super::scheme::{LoadControl, RheologicalScheme, SchemeTree};
use crate::common::decimal::format_rounded;

/// State of a scheme.
#[derive(Clone, Debug, PartialEq)]
pub struct SchemeState {
    /// States of the elements, in the order of [`RheologicalScheme::elements`].
    pub elements: Vec<ElementState>,
    /// Strain ε of the scheme.
    pub strain: f64,
    /// Stress σ of the scheme, Pa.
    pub stress: f64,
    /// Work ∫ σ dε per volume, by the stress at the end of each step, J/m³.
    pub work: f64,
    /// Slope dσ/dε of the graph of the last step where it ended, on the side of its start, Pa; infinite if vertical.
    pub tangent_modulus: f64,
}

/// Reason why a step has no end state.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// The scheme cannot reach the strain: a damper is rigid in a jump, or a contact is closed.
    #[error(
        "the strain {} cannot be reached: in this step the strain is from {} to {}",
        format_rounded(*value),
        format_bound(bounds[0]),
        format_bound(bounds[1])
    )]
    Strain {
        /// Prescribed strain.
        value: f64,
        /// Lowest and highest strain that can be reached.
        bounds: [f64; 2],
    },
    /// The scheme does not bear the stress.
    #[error(
        "the stress {} Pa is not borne: the stress of this scheme is from {} to {} Pa",
        format_rounded(*value),
        format_bound(bounds[0]),
        format_bound(bounds[1])
    )]
    Stress {
        /// Prescribed stress, Pa.
        value: f64,
        /// Lowest and highest stress that can be borne, Pa.
        bounds: [f64; 2],
    },
    /// Strain, stress or energy overflow.
    #[error("strain, stress or energy is not finite")]
    NotFinite,
}

fn format_bound(bound: f64) -> String {
    match bound {
        f64::NEG_INFINITY => "−∞".to_owned(),
        f64::INFINITY => "∞".to_owned(),
        bound => format_rounded(bound),
    }
}

/// Graph of a branch with those of its branches.
struct BranchGraph {
    graph: MonotonePolyline,
    branches: Vec<Self>,
}

impl SchemeState {
    /// Returns the sum of the stored energies of the springs per volume, J/m³.
    pub fn stored_energy(&self, scheme: &RheologicalScheme) -> f64 {
        let elements = scheme.elements().iter().zip(&self.elements);
        elements.map(|(own, state)| own.element.stored_energy(state)).sum()
    }

    /// Returns the sum of the energies dissipated by dampers and hinges per volume, J/m³.
    pub fn dissipated_energy(&self) -> f64 {
        self.elements.iter().map(|state| state.dissipated_energy).sum()
    }

    /// Returns the sum of the losses of the implicit steps per volume, J/m³.
    pub fn step_loss(&self) -> f64 {
        self.elements.iter().map(|state| state.step_loss).sum()
    }

    /// Returns work less stored energy, dissipated energy and loss of the steps, J/m³; zero up to rounding for a
    /// history from rest.
    pub fn ledger_residual(&self, scheme: &RheologicalScheme) -> f64 {
        self.work - (self.stored_energy(scheme) + self.dissipated_energy() + self.step_loss())
    }
}

impl RheologicalScheme {
    /// Returns the state at rest, without strain and stress.
    pub fn rest_state(&self) -> SchemeState {
        SchemeState {
            elements: vec![ElementState::default(); self.elements().len()],
            strain: 0.0,
            stress: 0.0,
            work: 0.0,
            tangent_modulus: 0.0,
        }
    }

    /// Advances the state by one implicit step of `duration` ≥ 0 (s), to the strain or the stress (Pa) `target`. In a
    /// step without duration, a jump, dampers are rigid. Under prescribed strain the scheme must pass
    /// [`check_control`](Self::check_control); else a stress that is not unique is the nearest to the last one. A
    /// strain that is not unique under prescribed stress is the nearest to the last one.
    ///
    /// # Errors
    /// The strain or the stress cannot be reached, or the result overflows; the state is then unchanged.
    pub fn advance(
        &self,
        state: &mut SchemeState,
        control: LoadControl,
        target: f64,
        duration: f64,
    ) -> Result<(), StepError> {
        let total = self.build_graph(self.tree(), &state.elements, duration);
        let nearest = |[low, high]: [f64; 2], last: f64| last.max(low).min(high);
        let [strain_increment, stress] = match control {
            LoadControl::Strain => {
                let increment = target - state.strain;
                let interval = total.graph.interval_at(Coordinate::Strain, increment);
                let interval = interval.ok_or_else(|| StepError::Strain {
                    value: target,
                    bounds: total.graph.range(Coordinate::Strain).map(|bound| state.strain + bound),
                })?;
                [increment, nearest(interval, state.stress)]
            }
            LoadControl::Stress => {
                let interval = total.graph.interval_at(Coordinate::Stress, target);
                let interval = interval.ok_or_else(|| StepError::Stress {
                    value: target,
                    bounds: total.graph.range(Coordinate::Stress),
                })?;
                [nearest(interval, 0.0), target]
            }
        };
        let mut next = state.clone();
        self.hand_down(self.tree(), &total, [strain_increment, stress], &mut next.elements);
        next.strain = match control {
            LoadControl::Strain => target,
            LoadControl::Stress => state.strain + strain_increment,
        };
        next.stress = stress;
        next.work += stress * strain_increment;
        // A corner at the end of the step may be passed by rounding.
        let inside = strain_increment * (1.0 - 1e-9);
        next.tangent_modulus =
            total.graph.slope_beside(Coordinate::Strain, inside, strain_increment > 0.0);
        let is_finite = next.elements.iter().all(|own| {
            [own.strain, own.stress, own.dissipated_energy, own.step_loss]
                .iter()
                .all(|value| value.is_finite())
        });
        if !(is_finite && next.strain.is_finite() && next.work.is_finite()) {
            return Err(StepError::NotFinite);
        }
        *state = next;
        Ok(())
    }

    fn build_graph(
        &self,
        tree: &SchemeTree,
        states: &[ElementState],
        duration: f64,
    ) -> BranchGraph {
        let (branches, along) = match tree {
            SchemeTree::Element(index) => {
                let element = &self.elements()[*index].element;
                let graph = element.step_graph(&states[*index], duration);
                return BranchGraph { graph, branches: Vec::new() };
            }
            SchemeTree::Series(branches) => (branches, Coordinate::Stress),
            SchemeTree::Parallel(branches) => (branches, Coordinate::Strain),
        };
        let branches: Vec<BranchGraph> =
            branches.iter().map(|own| self.build_graph(own, states, duration)).collect();
        let graphs: Vec<&MonotonePolyline> = branches.iter().map(|own| &own.graph).collect();
        BranchGraph { graph: MonotonePolyline::sum(&graphs, along), branches }
    }

    /// Moves the elements of a branch to the end of a step, in which the branch has the strain increment and the stress
    /// `end`.
    fn hand_down(
        &self,
        tree: &SchemeTree,
        graph: &BranchGraph,
        end: [f64; 2],
        states: &mut [ElementState],
    ) {
        match tree {
            SchemeTree::Element(index) => {
                self.elements()[*index].element.advance(&mut states[*index], end[0], end[1]);
            }
            SchemeTree::Series(branches) => {
                let shares = allocate(end[0], &graph.branches, Coordinate::Stress, end[1], |_| 0.0);
                for ((branch, own), share) in branches.iter().zip(&graph.branches).zip(shares) {
                    self.hand_down(branch, own, [share, end[1]], states);
                }
            }
            SchemeTree::Parallel(branches) => {
                let last = |index: usize| self.branch_stress(&branches[index], states);
                let shares = allocate(end[1], &graph.branches, Coordinate::Strain, end[0], last);
                for ((branch, own), share) in branches.iter().zip(&graph.branches).zip(shares) {
                    self.hand_down(branch, own, [end[0], share], states);
                }
            }
        }
    }

    /// Returns the stress of a branch, Pa.
    fn branch_stress(&self, tree: &SchemeTree, states: &[ElementState]) -> f64 {
        match tree {
            SchemeTree::Element(index) => states[*index].stress,
            SchemeTree::Series(branches) => self.branch_stress(&branches[0], states),
            SchemeTree::Parallel(branches) => {
                branches.iter().map(|branch| self.branch_stress(branch, states)).sum()
            }
        }
    }
}

/// Divides the `total` of strain increments in series, or of stresses in parallel, among branches with the common value
/// `x` of the coordinate `along`. Each branch starts from the admissible value next to `preferred`, and the first ones
/// take as much of the rest as they can. The last rest is a rounding error; it goes to the branch whose graph is the
/// steepest, where it displaces `x` least, up to the next vertex of that graph.
fn allocate(
    total: f64,
    branches: &[BranchGraph],
    along: Coordinate,
    x: f64,
    preferred: impl Fn(usize) -> f64,
) -> Vec<f64> {
    let interval = |own: &BranchGraph| own.graph.interval_at(along, x).unwrap_or([f64::NAN; 2]);
    let intervals: Vec<[f64; 2]> = branches.iter().map(interval).collect();
    let mut shares: Vec<f64> = intervals
        .iter()
        .enumerate()
        .map(|(index, [low, high])| preferred(index).max(*low).min(*high))
        .collect();
    let mut rest = total - shares.iter().sum::<f64>();
    for (share, [low, high]) in shares.iter_mut().zip(&intervals) {
        // Ends of intervals are taken exactly: beyond them a branch may have to move far.
        let taken = (*share + rest).max(*low).min(*high);
        rest -= taken - *share;
        *share = taken;
    }
    let slope = |index: usize| {
        let [low, high] = intervals[index];
        let beside = |is_before| branches[index].graph.slope_beside(along, x, is_before);
        if low < high { f64::INFINITY } else { beside(true).max(beside(false)) }
    };
    let slopes = (0..branches.len()).map(slope).enumerate();
    let steepest = slopes.max_by(|(_, a), (_, b)| a.total_cmp(b));
    // A vertical branch has taken the rest, up to the rounding error of its share.
    if let Some((index, slope)) = steepest
        && slope.is_finite()
    {
        let [low, high] = branches[index].graph.piece_range(along, x);
        shares[index] = (shares[index] + rest).max(low).min(high);
    }
    shares
}
