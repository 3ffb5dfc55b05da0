//! Exact waves of an elastic–perfectly plastic bar in uniaxial strain, by front tracking.
//!
//! Mises' set in uniaxial strain, with the longitudinal stress σ, the transverse stress σ₂ and φ = σ − σ₂:
//!
//! ```text
//! ρ v̇ = ∂σ,   σ̇ = M ∂v,  φ̇ = 2μ ∂v  while |φ| < Y,   σ̇ = K ∂v,  φ̇ = 0  while φ = ±Y and loading continues,
//! ```
//!
//! M = λ + 2μ, K = λ + 2μ/3, Y = √3 k (Wood 1952). The stress–strain curve is piecewise linear with two slopes, so that
//! every Riemann problem is solved by fronts of the speeds ±√(M/ρ) and ±√(K/ρ), the elastic one ahead, and a contact at
//! rest across which φ jumps. Piecewise constant states remain piecewise constant: fronts are advanced to their next
//! collision, where the Riemann problem between the outer states is solved.

use models::solid::parameters::Isotropic;

/// Fronts with jumps below this fraction of the elastic limit are dropped, since collisions create ever smaller ones.
const MIN_JUMP: f64 = 1e-9;

/// Constants of an elastic–perfectly plastic bar in uniaxial strain.
#[derive(Clone, Copy, Debug)]
pub struct ElasticPlasticBar {
    /// Density ρ, kg/m³.
    pub density: f64,
    /// Elastic modulus of uniaxial strain M, Pa.
    pub elastic_modulus: f64,
    /// Plastic modulus of uniaxial strain K, Pa.
    pub plastic_modulus: f64,
    /// Shear modulus μ, Pa.
    pub shear_modulus: f64,
    /// Yield stress Y, Pa.
    pub yield_stress: f64,
    /// Length, m; the bar starts at x = 0.
    pub length: f64,
}

/// State of a section of the bar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UniaxialState {
    /// Velocity v, m/s.
    pub velocity: f64,
    /// Longitudinal stress σ, tension positive, Pa.
    pub stress: f64,
    /// Stress difference φ = σ − σ₂, Pa.
    pub stress_difference: f64,
}

/// Boundary condition at an end of the bar.
#[derive(Clone, Copy, Debug)]
pub enum EndCondition {
    /// Prescribed stress σ, Pa.
    Stress(f64),
    /// Prescribed velocity v, m/s.
    Velocity(f64),
}

/// Front between two states of a bar.
#[derive(Clone, Copy, Debug)]
pub struct Front {
    /// Position x of the front, m.
    pub position: f64,
    /// Speed dx/dt, m/s; 0 for a contact.
    pub speed: f64,
}

/// Bar at a time, s: states in the order of x, and the fronts between them.
#[derive(Clone, Debug)]
pub struct BarProfile {
    pub time: f64,
    pub states: Vec<UniaxialState>,
    pub fronts: Vec<Front>,
}

impl ElasticPlasticBar {
    pub fn new(solid: &Isotropic, strength: f64, length: f64) -> Self {
        Self {
            density: solid.density,
            elastic_modulus: solid.lambda + 2.0 * solid.mu,
            plastic_modulus: solid.lambda + 2.0 / 3.0 * solid.mu,
            shear_modulus: solid.mu,
            yield_stress: 3f64.sqrt() * strength,
            length,
        }
    }

    /// Computes √(M/ρ) and √(K/ρ), m/s.
    pub fn speeds(&self) -> [f64; 2] {
        [self.elastic_modulus, self.plastic_modulus].map(|modulus| (modulus / self.density).sqrt())
    }

    /// Computes the elastic limit in uniaxial strain: |σ| = Y M/2μ (Hugoniot elastic limit), Pa.
    pub fn elastic_limit(&self) -> f64 {
        self.yield_stress * self.elastic_modulus / (2.0 * self.shear_modulus)
    }

    /// Computes the waves that change the stress of a state to `stress` (Pa): the state behind the elastic front and
    /// the speed of the front; if the material yields, the same for the plastic front. Waves travel to larger x
    /// (`direction` 1) or to smaller x (−1).
    fn waves_to_stress(
        &self,
        ahead: UniaxialState,
        stress: f64,
        direction: f64,
    ) -> Vec<(UniaxialState, f64)> {
        let [elastic, plastic] = self.speeds();
        let per_stress = 2.0 * self.shear_modulus / self.elastic_modulus;
        let limit = self.yield_stress.copysign(stress - ahead.stress);
        let elastic_change = (limit - ahead.stress_difference) / per_stress;
        let change = stress - ahead.stress;
        let first = if change.abs() <= elastic_change.abs() { change } else { elastic_change };
        let state_behind =
            |ahead: UniaxialState, change: f64, stress_difference: f64, speed: f64| UniaxialState {
                velocity: ahead.velocity - direction * change / (self.density * speed),
                stress: ahead.stress + change,
                stress_difference,
            };
        let is_plastic = change.abs() > elastic_change.abs();
        let stress_difference =
            if is_plastic { limit } else { ahead.stress_difference + per_stress * change };
        let yielded = state_behind(ahead, first, stress_difference, elastic);
        let mut fronts = vec![(yielded, direction * elastic)];
        if is_plastic {
            fronts
                .push((state_behind(yielded, change - first, limit, plastic), direction * plastic));
        }
        fronts
    }

    /// Computes the velocity behind the waves that change the stress of a state to `stress` (Pa).
    fn velocity_at_stress(&self, ahead: UniaxialState, stress: f64, direction: f64) -> f64 {
        self.waves_to_stress(ahead, stress, direction)
            .last()
            .map_or(ahead.velocity, |last| last.0.velocity)
    }

    /// Finds the zero of an increasing piecewise linear function of the stress with the given kinks.
    fn find_zero(&self, mut kinks: Vec<f64>, value: impl Fn(f64) -> f64) -> f64 {
        kinks.sort_by(f64::total_cmp);
        let scale = self.elastic_limit();
        kinks.insert(0, kinks[0] - scale);
        kinks.push(kinks[kinks.len() - 1] + scale);
        let last = kinks.len() - 2;
        let segment = (0..last).find(|&i| value(kinks[i + 1]) >= 0.0).unwrap_or(last);
        let [a, b] = [kinks[segment], kinks[segment + 1]];
        let [at_a, at_b] = [value(a), value(b)];
        if at_a == at_b { a } else { a - at_a * (b - a) / (at_b - at_a) }
    }

    /// Computes the stresses at which the velocity behind the waves, as a function of the stress, has kinks.
    fn response_kinks(&self, state: UniaxialState) -> [f64; 3] {
        let per_stress = 2.0 * self.shear_modulus / self.elastic_modulus;
        [-self.yield_stress, state.stress_difference, self.yield_stress].map(|stress_difference| {
            state.stress + (stress_difference - state.stress_difference) / per_stress
        })
    }

    /// Computes the stress between two states that meet (Riemann problem).
    fn solve_riemann(&self, left: UniaxialState, right: UniaxialState) -> f64 {
        let kinks = [self.response_kinks(left), self.response_kinks(right)].concat();
        self.find_zero(kinks, |stress| {
            self.velocity_at_stress(left, stress, -1.0)
                - self.velocity_at_stress(right, stress, 1.0)
        })
    }

    /// Computes the stress at an end of the bar, whose waves travel in `direction` into a state.
    fn stress_at_end(&self, end: EndCondition, state: UniaxialState, direction: f64) -> f64 {
        match end {
            EndCondition::Stress(stress) => stress,
            EndCondition::Velocity(velocity) => self
                .find_zero(self.response_kinks(state).to_vec(), |stress| {
                    direction * (velocity - self.velocity_at_stress(state, stress, direction))
                }),
        }
    }

    /// Advances a profile to the time `until`, s. `ends`: for each end of the bar, conditions with the times from which
    /// they hold, in increasing order, the first 0.
    pub fn advance(
        &self,
        initial: &BarProfile,
        ends: &[Vec<(f64, EndCondition)>; 2],
        until: f64,
    ) -> BarProfile {
        let mut profile = initial.clone();
        let merge_distance = 1e-11 * self.length;
        let condition = |end: usize, time: f64| {
            let last = ends[end].iter().rev().find(|(from, _)| *from <= time);
            last.map_or(EndCondition::Stress(0.0), |own| own.1)
        };
        // Solve the Riemann problems of all initial jumps and of both ends.
        self.resolve_fronts(
            &mut profile,
            [0, 1].map(|end| Some(condition(end, 0.0))),
            merge_distance,
            true,
        );
        loop {
            let now = profile.time;
            let mut next = until;
            for &(from, _) in ends.iter().flatten() {
                if from > now {
                    next = next.min(from);
                }
            }
            let fronts = &profile.fronts;
            for pair in fronts.windows(2) {
                let closing = pair[0].speed - pair[1].speed;
                if closing > 0.0 {
                    next = next.min(now + (pair[1].position - pair[0].position).max(0.0) / closing);
                }
            }
            for front in fronts {
                if front.speed < 0.0 {
                    next = next.min(now - front.position.max(0.0) / front.speed);
                } else if front.speed > 0.0 {
                    next = next.min(now + (self.length - front.position).max(0.0) / front.speed);
                }
            }
            for front in &mut profile.fronts {
                front.position += front.speed * (next - now);
            }
            profile.time = next;
            if next >= until {
                return profile;
            }
            let reached = [0, 1].map(|end| {
                let at = [0.0, self.length][end];
                let front = if end == 0 { profile.fronts.first() } else { profile.fronts.last() };
                let is_there = front.is_some_and(|front| {
                    (front.position - at).abs() < merge_distance
                        && front.speed * (at - 0.5 * self.length) > 0.0
                });
                let changes = ends[end].iter().any(|(from, _)| *from == next);
                (changes || is_there).then(|| condition(end, next))
            });
            self.resolve_fronts(&mut profile, reached, merge_distance, false);
        }
    }

    /// Solves the Riemann problems where fronts meet (with `all`: at every front), and at the ends of the bar whose
    /// condition is given.
    fn resolve_fronts(
        &self,
        profile: &mut BarProfile,
        ends: [Option<EndCondition>; 2],
        merge_distance: f64,
        all: bool,
    ) {
        let (mut states, mut fronts) = (Vec::new(), Vec::new());
        let add =
            |states: &mut Vec<UniaxialState>, fronts: &mut Vec<Front>, position, (speed, state)| {
                if states.last() != Some(&state) {
                    fronts.push(Front { position, speed });
                    states.push(state);
                }
            };
        let old = &profile.fronts;
        let (mut first, mut last) = (0, old.len());
        if let Some(end) = ends[0] {
            while old.get(first).is_some_and(|front| front.position < merge_distance) {
                first += 1;
            }
            let ahead = profile.states[first];
            let wave = self.waves_to_stress(ahead, self.stress_at_end(end, ahead, 1.0), 1.0);
            states.push(wave.last().map_or(ahead, |own| own.0));
            // Fronts in the order of x, from the plastic to the elastic one, each with the state ahead of it.
            for index in (0..wave.len()).rev() {
                let state = if index > 0 { wave[index - 1].0 } else { ahead };
                add(&mut states, &mut fronts, 0.0, (wave[index].1, state));
            }
        } else {
            states.push(profile.states[0]);
        }
        if ends[1].is_some() {
            while last > first && old[last - 1].position > self.length - merge_distance {
                last -= 1;
            }
        }
        let mut index = first;
        while index < last {
            let mut end = index + 1;
            while end < last && old[end].position - old[index].position < merge_distance {
                end += 1;
            }
            let position = old[index].position;
            if end == index + 1 && !all {
                add(&mut states, &mut fronts, position, (old[index].speed, profile.states[end]));
                index = end;
                continue;
            }
            let (left, right) = (profile.states[index], profile.states[end]);
            let stress = self.solve_riemann(left, right);
            let [to_left, to_right] = [
                self.waves_to_stress(left, stress, -1.0),
                self.waves_to_stress(right, stress, 1.0),
            ];
            for &(state, speed) in &to_left {
                add(&mut states, &mut fronts, position, (speed, state));
            }
            // Contact: velocity and stress are continuous up to rounding, φ jumps.
            let inner = to_right.last().map_or(right, |own| own.0);
            let scale = MIN_JUMP * self.elastic_limit();
            let is_contact = states
                .last()
                .is_some_and(|own| (own.stress_difference - inner.stress_difference).abs() > scale);
            if is_contact {
                add(&mut states, &mut fronts, position, (0.0, inner));
            }
            for wave in (0..to_right.len()).rev() {
                let state = if wave > 0 { to_right[wave - 1].0 } else { right };
                add(&mut states, &mut fronts, position, (to_right[wave].1, state));
            }
            index = end;
        }
        if let Some(end) = ends[1] {
            let ahead = profile.states[last];
            for (state, speed) in
                self.waves_to_stress(ahead, self.stress_at_end(end, ahead, -1.0), -1.0)
            {
                add(&mut states, &mut fronts, self.length, (speed, state));
            }
        }
        (profile.states, profile.fronts) = (states, fronts);
        self.drop_negligible_fronts(profile);
    }

    /// Drops fronts whose jumps are all below [`MIN_JUMP`].
    fn drop_negligible_fronts(&self, profile: &mut BarProfile) {
        let scale = MIN_JUMP * self.elastic_limit();
        let impedance = (self.density * self.elastic_modulus).sqrt();
        let mut index = 0;
        while index < profile.fronts.len() {
            let [a, b] = [profile.states[index], profile.states[index + 1]];
            let jumps = [
                a.stress - b.stress,
                a.stress_difference - b.stress_difference,
                impedance * (a.velocity - b.velocity),
            ];
            if jumps.iter().all(|jump| jump.abs() < scale) {
                profile.fronts.remove(index);
                profile.states.remove(index + 1);
            } else {
                index += 1;
            }
        }
    }
}

impl BarProfile {
    /// Creates a stress-free profile of piecewise constant velocity.
    pub fn with_velocities(velocities: &[f64], jump_positions: &[f64]) -> Self {
        let state =
            |&velocity: &f64| UniaxialState { velocity, stress: 0.0, stress_difference: 0.0 };
        Self {
            time: 0.0,
            states: velocities.iter().map(state).collect(),
            fronts: jump_positions.iter().map(|&position| Front { position, speed: 0.0 }).collect(),
        }
    }

    /// Computes the mean state over an interval of x, m.
    pub fn mean_state(&self, from: f64, to: f64) -> UniaxialState {
        let mut sum = [0.0; 3];
        for (index, state) in self.states.iter().enumerate() {
            let start = if index == 0 { f64::MIN } else { self.fronts[index - 1].position };
            let end = self.fronts.get(index).map_or(f64::MAX, |front| front.position);
            let share = (to.min(end) - from.max(start)).max(0.0) / (to - from);
            let values = [state.velocity, state.stress, state.stress_difference];
            for (sum, value) in sum.iter_mut().zip(values) {
                *sum += share * value;
            }
        }
        UniaxialState { velocity: sum[0], stress: sum[1], stress_difference: sum[2] }
    }
}
