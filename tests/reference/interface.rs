//! Plane wave on the plane interface x₂ = 0 of two solids: amplitudes of the reflected and transmitted waves from the
//! Knott–Zoeppritz equations.

use super::IsotropicSolid;

/// Kind of body wave: longitudinal (P) or shear (S).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BodyWave {
    P,
    S,
}

/// Plane wave at an interface: v = amplitude · a g(t − n·x/c).
#[derive(Clone, Copy, Debug)]
pub struct InterfaceWave {
    /// Unit propagation direction n.
    pub direction: [f64; 2],
    /// Polarisation a: n for P; n rotated by 90° anticlockwise for S.
    pub polarisation: [f64; 2],
    /// Propagation speed c of the wave, m/s.
    pub speed: f64,
    /// Amplitude relative to that of the incident wave.
    pub amplitude: f64,
    solid: IsotropicSolid,
}

impl InterfaceWave {
    /// Wave of amplitude 1 with slowness p (s/m) along x₁, propagating upwards or downwards; `None` beyond the
    /// critical angle.
    fn new(wave: BodyWave, solid: &IsotropicSolid, p: f64, is_upward: bool) -> Option<Self> {
        let speed = match wave {
            BodyWave::P => solid.pressure_speed(),
            BodyWave::S => solid.shear_speed(),
        };
        let sin = p * speed;
        let cos = (1.0 - sin * sin).sqrt();
        let direction = [sin, if is_upward { cos } else { -cos }];
        let polarisation = match wave {
            BodyWave::P => direction,
            BodyWave::S => [-direction[1], direction[0]],
        };
        (sin.abs() < 1.0).then_some(Self {
            direction,
            polarisation,
            speed,
            amplitude: 1.0,
            solid: *solid,
        })
    }

    /// Continuous quantities at the interface, per unit of g: v₁, v₂ and the tractions σ₁₂, σ₂₂, from
    /// σ = −(λ(a·n) + μ(a nᵀ + n aᵀ)) amplitude g/c.
    pub fn continuous_quantities(&self) -> [f64; 4] {
        let ([a1, a2], [n1, n2]) = (self.polarisation, self.direction);
        let (lambda, mu) = (self.solid.lambda, self.solid.mu);
        let shear = -mu * (a1 * n2 + a2 * n1) / self.speed;
        let normal = -(lambda * (a1 * n1 + a2 * n2) + 2.0 * mu * a2 * n2) / self.speed;
        [a1, a2, shear, normal].map(|value| self.amplitude * value)
    }

    /// Energy flux through the interface along x₂, per unit of g².
    pub fn energy_flux(&self) -> f64 {
        self.solid.density * self.speed * self.direction[1] * self.amplitude.powi(2)
    }

    /// Arrival time at a point, s, if the incident wave passes x = 0 at time 0.
    pub fn arrival_time(&self, x: [f64; 2]) -> f64 {
        (self.direction[0] * x[0] + self.direction[1] * x[1]) / self.speed
    }

    /// Velocity of the wave at a point and a time t (s), per unit amplitude of the incident wave, for a time function g
    /// and an incident wave that passes x = 0 at time 0.
    pub fn velocity(&self, x: [f64; 2], t: f64, g: impl Fn(f64) -> f64) -> [f64; 2] {
        let value = self.amplitude * g(t - self.arrival_time(x));
        self.polarisation.map(|a| a * value)
    }
}

/// Plane waves above the interface (incident, reflected P, reflected S) and below it (transmitted P, transmitted S).
#[derive(Clone, Copy, Debug)]
pub struct InterfaceWaves {
    pub above: [InterfaceWave; 3],
    pub below: [InterfaceWave; 2],
}

/// Solves for the reflected and transmitted waves of a wave incident from above, at an angle (rad) between its
/// direction and the normal; `None` beyond a critical angle.
pub fn solve_interface_waves(
    above: &IsotropicSolid,
    below: &IsotropicSolid,
    incident: BodyWave,
    angle: f64,
) -> Option<InterfaceWaves> {
    let speed = match incident {
        BodyWave::P => above.pressure_speed(),
        BodyWave::S => above.shear_speed(),
    };
    let p = angle.sin() / speed;
    let incident = InterfaceWave::new(incident, above, p, false)?;
    let mut others = [
        InterfaceWave::new(BodyWave::P, above, p, true)?,
        InterfaceWave::new(BodyWave::S, above, p, true)?,
        InterfaceWave::new(BodyWave::P, below, p, false)?,
        InterfaceWave::new(BodyWave::S, below, p, false)?,
    ];
    // Reflected − transmitted = −incident; tractions are divided by an impedance.
    let units = [1.0, 1.0, above.density * speed, above.density * speed];
    let columns = others.map(|wave| wave.continuous_quantities());
    let right = incident.continuous_quantities();
    let mut rows: [[f64; 5]; 4] = std::array::from_fn(|i| {
        let sign = |j: usize| if j < 2 { 1.0 } else { -1.0 };
        std::array::from_fn(|j| match j {
            4 => -right[i] / units[i],
            _ => sign(j) * columns[j][i] / units[i],
        })
    });
    let amplitudes = solve_linear_system(&mut rows);
    for (wave, amplitude) in others.iter_mut().zip(amplitudes) {
        wave.amplitude = amplitude;
    }
    Some(InterfaceWaves { above: [incident, others[0], others[1]], below: [others[2], others[3]] })
}

/// Solves four linear equations by Gauss–Jordan elimination with partial pivoting.
fn solve_linear_system(rows: &mut [[f64; 5]; 4]) -> [f64; 4] {
    for column in 0..4 {
        let pivot =
            (column..4).max_by(|a, b| rows[*a][column].abs().total_cmp(&rows[*b][column].abs()));
        rows.swap(column, pivot.expect("rows"));
        let pivot_row = rows[column].map(|value| value / rows[column][column]);
        rows[column] = pivot_row;
        for (index, row) in rows.iter_mut().enumerate() {
            if index != column {
                let factor = row[column];
                row.iter_mut().zip(pivot_row).for_each(|(value, pivot)| *value -= factor * pivot);
            }
        }
    }
    rows.map(|row| row[4])
}
