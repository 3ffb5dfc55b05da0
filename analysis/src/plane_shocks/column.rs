//! Columns of a granular medium that transmits no tension: spall at a free end, and compaction of a loosened column.
//!
//! The compressed medium has the uniaxial modulus E and the speed c = √(E/ρ); the open medium has the modulus 0. Its
//! two characteristic speeds coincide at zero: the velocity of each particle is constant, and the strain grows linearly.

use super::{PlaneState, PlaneWaveError, check_positive};

/// Compaction shock in a loosened column, driven by a piston.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompactionShock {
    /// Speed D of the shock, m/s.
    pub speed: f64,
    /// Pressure behind the shock, Pa.
    pub pressure: f64,
    /// Energy dissipated per unit volume swept, J/m³: ½pε₀.
    pub dissipation: f64,
}

impl CompactionShock {
    /// Computes the shock from the piston speed v_p, for the density ρ, the modulus E and the extension ε₀ of the
    /// loosened column:
    ///
    /// ```text
    /// D = c² (√(ε₀² + 4v_p²/c²) − ε₀)/(2v_p),    p = ρDv_p,    D² = p/[ρ(ε₀ + p/E)].
    /// ```
    ///
    /// D tends to c for small ε₀ and to the snow plough v_p/ε₀ for great ε₀.
    ///
    /// # Errors
    /// The density, the modulus or the piston speed is not positive, or the extension is negative.
    pub fn new(
        density: f64,
        modulus: f64,
        loosening: f64,
        piston_speed: f64,
    ) -> Result<Self, PlaneWaveError> {
        check_positive("the density", density)?;
        check_positive("the modulus", modulus)?;
        check_positive("the speed of the piston", piston_speed)?;
        if !(loosening.is_finite() && loosening >= 0.0) {
            return Err(PlaneWaveError::OutOfRange {
                quantity: "the extension of the loosened column",
                value: loosening,
                allowed: "it must be finite and at least 0",
            });
        }
        let sound = (modulus / density).sqrt();
        let mach = 2.0 * piston_speed / sound;
        // c²(√(ε₀² + m²) − ε₀)/(2v_p) with m = 2v_p/c, written without cancellation.
        let root = (loosening * loosening + mach * mach).sqrt();
        let speed = sound * mach / (root + loosening);
        let pressure = density * speed * piston_speed;
        Ok(Self { speed, pressure, dissipation: 0.5 * pressure * loosening })
    }
}

/// Shape in time of the velocity of a pulse behind its sharp front.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PulseShape {
    /// Constant velocity (Π).
    Rectangle,
    /// Velocity that falls linearly to zero (Λ).
    Triangle,
}

/// Reflection of a compressive pulse at the free end of a granular column.
///
/// The front meets the end at t = 0; d is the distance from the end. For t ≥ d/c the column at d < ct₀/2 is free of
/// stress and moves with v = 2f(2d/c), where f is the velocity of the pulse; everything behind comes to rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spall {
    density: f64,
    sound_speed: f64,
    velocity: f64,
    duration: f64,
    shape: PulseShape,
}

impl Spall {
    /// Creates the problem from the density ρ, the modulus E, and the velocity v₀ of the front, the duration t₀ and the
    /// shape of the pulse.
    ///
    /// # Errors
    /// A number is not finite and positive, or a result is not.
    pub fn new(
        density: f64,
        modulus: f64,
        velocity: f64,
        duration: f64,
        shape: PulseShape,
    ) -> Result<Self, PlaneWaveError> {
        check_positive("the density", density)?;
        check_positive("the modulus", modulus)?;
        check_positive("the velocity of the pulse", velocity)?;
        check_positive("the duration of the pulse", duration)?;
        let sound_speed = (modulus / density).sqrt();
        let own = Self { density, sound_speed, velocity, duration, shape };
        let results = [own.sound_speed, own.thickness(), own.pressure()];
        if !results.iter().all(|value| value.is_finite() && *value > 0.0) {
            return Err(PlaneWaveError::NotFinite);
        }
        Ok(own)
    }

    /// Returns the duration t₀ of the pulse, s.
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Returns the shape of the pulse.
    pub fn shape(&self) -> PulseShape {
        self.shape
    }

    /// Returns the speed c of sound in the compressed column, m/s.
    pub fn sound_speed(&self) -> f64 {
        self.sound_speed
    }

    /// Returns the thickness ct₀/2 of the layer that leaves the column, m.
    pub fn thickness(&self) -> f64 {
        0.5 * self.sound_speed * self.duration
    }

    /// Returns the pressure ρcv₀ behind the front of the pulse, Pa.
    pub fn pressure(&self) -> f64 {
        self.density * self.sound_speed * self.velocity
    }

    /// Returns the velocity f of the pulse at the time `time` after its front, m/s.
    pub fn pulse_velocity(&self, time: f64) -> f64 {
        let phase = time / self.duration;
        match self.shape {
            _ if !(0.0..1.0).contains(&phase) => 0.0,
            PulseShape::Rectangle => self.velocity,
            PulseShape::Triangle => self.velocity * (1.0 - phase),
        }
    }

    /// Returns the velocity v = 2f(2d/c) of the spalled layer at the distance `distance` from the end, m/s.
    pub fn spall_velocity(&self, distance: f64) -> f64 {
        2.0 * self.pulse_velocity(2.0 * distance / self.sound_speed)
    }

    /// Returns the width of the gap between the spalled layer and the column at the time `time`, m; 0 for the triangle,
    /// whose layer extends without a gap.
    pub fn gap(&self, time: f64) -> f64 {
        match self.shape {
            PulseShape::Rectangle => 2.0 * self.velocity * (time - 0.5 * self.duration).max(0.0),
            PulseShape::Triangle => 0.0,
        }
    }

    /// Returns the state at the distance `distance` > 0 from the end and the time `time` ≥ 0 after the front has met
    /// the end. The velocity points to the end. The gap of the rectangle is a displacement jump, not part of the strain.
    pub fn state(&self, distance: f64, time: f64) -> PlaneState {
        let (c, v0) = (self.sound_speed, self.velocity);
        if distance <= c * time && distance < self.thickness() {
            let extension = match self.shape {
                PulseShape::Rectangle => 0.0,
                PulseShape::Triangle => 4.0 * v0 * (time - distance / c) / (c * self.duration),
            };
            return PlaneState {
                strain: -extension,
                velocity: self.spall_velocity(distance),
                pressure: 0.0,
            };
        }
        let velocity = self.pulse_velocity(time + distance / c);
        PlaneState { strain: velocity / c, velocity, pressure: self.density * c * velocity }
    }
}
