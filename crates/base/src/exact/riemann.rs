//! Exact Riemann problem of the ideal gas.
//!
//! Two constant states meet at x = 0. A shock or a rarefaction propagates into each of them. Between the two waves, the
//! pressure p* and the velocity u* are constant, and the density jumps at a contact discontinuity. With
//!
//! f_K(p) = (p − p_K) √(A_K/(p + B_K)) for a shock (p > p_K), A_K = 2/((γ+1)ρ_K), B_K = (γ−1)/(γ+1) p_K,
//! f_K(p) = 2c_K/(γ−1) ((p/p_K)^((γ−1)/2γ) − 1) for a rarefaction,
//!
//! p* is the root of f_L(p) + f_R(p) + u_R − u_L = 0 and u* = (u_L + u_R + f_R − f_L)/2. The function is increasing and
//! concave, so that Newton's method converges from every initial guess as soon as an iterate is below the root.
//!
//! Limits: neither state is a vacuum, and no vacuum forms between them.
//! Source: E. F. Toro, *Riemann Solvers and Numerical Methods for Fluid Dynamics*, 3rd ed. (2009), chapter 4.
use super::{Error, check_gamma};

/// Maximum number of Newton steps; the largest pressure ratio in double precision needs fewer.
const MAX_STEPS: usize = 200;
/// Relative change of pressure at which the iteration has reached round-off.
const ROUND_OFF: f64 = 1e-15;
/// Factor on the pressure if a Newton step would make it negative.
const RETREAT: f64 = 1e-3;

/// State of a one-dimensional gas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Density of the gas.
    pub density: f64,
    /// Velocity of the gas.
    pub velocity: f64,
    /// Pressure of the gas.
    pub pressure: f64,
}

/// Star region between the two outer waves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Star {
    /// Pressure p*.
    pub pressure: f64,
    /// Velocity u*, which is the speed of the contact.
    pub velocity: f64,
    /// Density on the left of the contact.
    pub density_left: f64,
    /// Density on the right of the contact.
    pub density_right: f64,
}

/// One of the two outer waves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wave {
    /// A shock.
    Shock {
        /// Speed of the shock.
        speed: f64,
    },
    /// A rarefaction fan.
    Rarefaction {
        /// Speed of the head, at the undisturbed gas.
        head: f64,
        /// Speed of the tail, at the star region.
        tail: f64,
    },
}

/// Solution of a Riemann problem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RiemannProblem {
    left: State,
    right: State,
    gamma: f64,
    star: Star,
}

impl State {
    /// A state with the given density, velocity and pressure.
    pub fn new(density: f64, velocity: f64, pressure: f64) -> Self {
        Self { density, velocity, pressure }
    }

    /// Speed of sound √(γp/ρ).
    pub fn sound_speed(&self, gamma: f64) -> f64 {
        (gamma * self.pressure / self.density).sqrt()
    }

    fn check(&self, side: &'static str) -> Result<(), Error> {
        let State { density, velocity, pressure } = *self;
        let positive = 0.0 < density && density.is_finite() && 0.0 < pressure && pressure.is_finite();
        if positive && velocity.is_finite() { Ok(()) } else { Err(Error::State { side, density, velocity, pressure }) }
    }
}

impl RiemannProblem {
    /// Solves the problem of the states `left` and `right`; an error if a state is not physical or a vacuum forms.
    pub fn new(left: State, right: State, gamma: f64) -> Result<Self, Error> {
        check_gamma(gamma)?;
        left.check("left")?;
        right.check("right")?;
        let difference = right.velocity - left.velocity;
        let limit = 2.0 / (gamma - 1.0) * (left.sound_speed(gamma) + right.sound_speed(gamma));
        if difference >= limit {
            return Err(Error::Vacuum { difference, limit });
        }
        let pressure = star_pressure(&left, &right, gamma);
        let (jump_left, _) = velocity_jump(&left, gamma, pressure);
        let (jump_right, _) = velocity_jump(&right, gamma, pressure);
        let velocity = 0.5 * (left.velocity + right.velocity + jump_right - jump_left);
        let density_left = star_density(&left, gamma, pressure);
        let density_right = star_density(&right, gamma, pressure);
        Ok(Self { left, right, gamma, star: Star { pressure, velocity, density_left, density_right } })
    }

    /// The state on the left.
    pub fn left(&self) -> State {
        self.left
    }

    /// The state on the right.
    pub fn right(&self) -> State {
        self.right
    }

    /// State of the star region.
    pub fn star(&self) -> Star {
        self.star
    }

    /// The wave that propagates into the left state.
    pub fn left_wave(&self) -> Wave {
        mirrored_wave(self.wave(&mirrored(&self.left), -self.star.velocity))
    }

    /// The wave that propagates into the right state.
    pub fn right_wave(&self) -> Wave {
        self.wave(&self.right, self.star.velocity)
    }

    /// Position at time `t` of the right shock for a diaphragm at `x0`; `None` if the right wave is a rarefaction.
    pub fn right_shock_position(&self, x0: f64, t: f64) -> Option<f64> {
        shock_position(self.right_wave(), x0, t)
    }

    /// Position at time `t` of the left shock for a diaphragm at `x0`; `None` if the left wave is a rarefaction.
    pub fn left_shock_position(&self, x0: f64, t: f64) -> Option<f64> {
        shock_position(self.left_wave(), x0, t)
    }

    /// State on the ray x/t = `speed`.
    pub fn sample(&self, speed: f64) -> State {
        if speed <= self.star.velocity {
            let state = self.sample_right(&mirrored(&self.left), -self.star.velocity, self.star.density_left, -speed);
            mirrored(&state)
        } else {
            self.sample_right(&self.right, self.star.velocity, self.star.density_right, speed)
        }
    }

    /// State at `x` and time `t` for a diaphragm at `x0`; the initial state if `t` is not positive.
    pub fn state(&self, x: f64, t: f64, x0: f64) -> State {
        if t > 0.0 {
            self.sample((x - x0) / t)
        } else if x < x0 {
            self.left
        } else {
            self.right
        }
    }

    fn wave(&self, outer: &State, star_velocity: f64) -> Wave {
        let (gamma, ratio) = (self.gamma, self.star.pressure / outer.pressure);
        let c = outer.sound_speed(gamma);
        if ratio > 1.0 {
            let mach = ((gamma + 1.0) / (2.0 * gamma) * ratio + (gamma - 1.0) / (2.0 * gamma)).sqrt();
            Wave::Shock { speed: outer.velocity + c * mach }
        } else {
            let c_star = c * ratio.powf((gamma - 1.0) / (2.0 * gamma));
            Wave::Rarefaction { head: outer.velocity + c, tail: star_velocity + c_star }
        }
    }

    fn sample_right(&self, outer: &State, star_velocity: f64, star_density: f64, speed: f64) -> State {
        let star = State::new(star_density, star_velocity, self.star.pressure);
        match self.wave(outer, star_velocity) {
            Wave::Shock { speed: shock } => {
                if speed < shock {
                    star
                } else {
                    *outer
                }
            }
            Wave::Rarefaction { head, .. } if head <= speed => *outer,
            Wave::Rarefaction { tail, .. } if speed <= tail => star,
            Wave::Rarefaction { .. } => fan(outer, self.gamma, speed),
        }
    }
}

/// State inside a right-running fan, Toro (4.63).
fn fan(outer: &State, gamma: f64, speed: f64) -> State {
    let c = outer.sound_speed(gamma);
    let ratio = 2.0 / (gamma + 1.0) - (gamma - 1.0) / ((gamma + 1.0) * c) * (outer.velocity - speed);
    State {
        density: outer.density * ratio.powf(2.0 / (gamma - 1.0)),
        velocity: 2.0 / (gamma + 1.0) * (-c + 0.5 * (gamma - 1.0) * outer.velocity + speed),
        pressure: outer.pressure * ratio.powf(2.0 * gamma / (gamma - 1.0)),
    }
}

/// Root p* of f_L + f_R + u_R − u_L.
fn star_pressure(left: &State, right: &State, gamma: f64) -> f64 {
    let mut p = two_rarefaction_pressure(left, right, gamma);
    for _ in 0..MAX_STEPS {
        let (f_left, slope_left) = velocity_jump(left, gamma, p);
        let (f_right, slope_right) = velocity_jump(right, gamma, p);
        let step = (f_left + f_right + right.velocity - left.velocity) / (slope_left + slope_right);
        let next = if step < p { p - step } else { p * RETREAT };
        let change = (next - p).abs();
        p = next;
        if change <= ROUND_OFF * p {
            break;
        }
    }
    p
}

/// Pressure p* for two rarefactions, Toro (4.46): exact if both waves are rarefactions, else an initial guess.
fn two_rarefaction_pressure(left: &State, right: &State, gamma: f64) -> f64 {
    let z = 0.5 * (gamma - 1.0) / gamma;
    let (c_left, c_right) = (left.sound_speed(gamma), right.sound_speed(gamma));
    let above = c_left + c_right - 0.5 * (gamma - 1.0) * (right.velocity - left.velocity);
    let below = c_left / left.pressure.powf(z) + c_right / right.pressure.powf(z);
    (above / below).powf(1.0 / z).max(f64::MIN_POSITIVE)
}

/// The function f_K(p) and its derivative, Toro (4.6), (4.37).
fn velocity_jump(outer: &State, gamma: f64, p: f64) -> (f64, f64) {
    if p > outer.pressure {
        let a = 2.0 / ((gamma + 1.0) * outer.density);
        let b = (gamma - 1.0) / (gamma + 1.0) * outer.pressure;
        let root = (a / (p + b)).sqrt();
        ((p - outer.pressure) * root, root * (1.0 - 0.5 * (p - outer.pressure) / (p + b)))
    } else {
        let c = outer.sound_speed(gamma);
        let z = 0.5 * (gamma - 1.0) / gamma;
        let ratio = p / outer.pressure;
        (2.0 * c / (gamma - 1.0) * (ratio.powf(z) - 1.0), ratio.powf(z - 1.0) / (outer.density * c))
    }
}

fn star_density(outer: &State, gamma: f64, p: f64) -> f64 {
    let ratio = p / outer.pressure;
    if ratio > 1.0 {
        let g = (gamma - 1.0) / (gamma + 1.0);
        outer.density * (ratio + g) / (g * ratio + 1.0)
    } else {
        outer.density * ratio.powf(1.0 / gamma)
    }
}

fn mirrored(state: &State) -> State {
    State { velocity: -state.velocity, ..*state }
}

fn mirrored_wave(wave: Wave) -> Wave {
    match wave {
        Wave::Shock { speed } => Wave::Shock { speed: -speed },
        Wave::Rarefaction { head, tail } => Wave::Rarefaction { head: -head, tail: -tail },
    }
}

fn shock_position(wave: Wave, x0: f64, t: f64) -> Option<f64> {
    match wave {
        Wave::Shock { speed } => Some(x0 + speed * t),
        Wave::Rarefaction { .. } => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64, relative: f64) {
        assert!((a - b).abs() <= relative * b.abs().max(1e-300), "{a} is not {b}");
    }

    fn sod() -> RiemannProblem {
        RiemannProblem::new(State::new(1.0, 0.0, 1.0), State::new(0.125, 0.0, 0.1), 1.4).unwrap()
    }

    #[test] // rows of riemann_star_states.csv: left, right, p*, u*, ρ*L, ρ*R
    fn star_states_follow_the_table() {
        let rows: [([f64; 3], [f64; 3], [f64; 4]); 7] = [
            ([1.0, 0.0, 1.0], [0.125, 0.0, 0.1], [0.3031301781, 0.92745262, 0.4263194282, 0.2655737117]),
            ([0.445, 0.698, 3.528], [0.5, 0.0, 0.571], [2.466097919, 1.528723027, 0.3445684742, 1.304084532]),
            ([1.0, 0.0, 1000.0], [1.0, 0.0, 0.01], [460.8937875, 19.59745139, 0.5750622985, 5.999240705]),
            ([1.0, 0.0, 0.01], [1.0, 0.0, 100.0], [46.09504425, -6.19632825, 5.992416864, 0.5751127898]),
            (
                [5.99924, 19.5975, 460.894],
                [5.99242, -6.19633, 46.095],
                [1691.646955, 8.689774412, 14.28234995, 31.04260164],
            ),
            ([1.0, 0.75, 1.0], [0.125, 0.0, 0.1], [0.4662935668, 1.360905519, 0.5798666875, 0.3397002349]),
            ([1.0, 0.0, 1e5], [1.0, 0.0, 1.0], [46089.37875, 195.9745139, 0.5750622985, 5.999240705]),
        ];
        for (l, r, expected) in rows {
            let star =
                RiemannProblem::new(State::new(l[0], l[1], l[2]), State::new(r[0], r[1], r[2]), 1.4).unwrap().star();
            close(star.pressure, expected[0], 2e-9);
            close(star.velocity, expected[1], 2e-9);
            close(star.density_left, expected[2], 2e-9);
            close(star.density_right, expected[3], 2e-9);
        }
    }

    #[test] // row toro2_123 of riemann_star_states.csv: two rarefactions near vacuum
    fn near_vacuum_is_solved_and_vacuum_refused() {
        let problem = |u: f64| RiemannProblem::new(State::new(1.0, -u, 0.4), State::new(1.0, u, 0.4), 1.4);
        close(problem(2.0).unwrap().star().pressure, 0.00189387342, 1e-8);
        assert!(matches!(problem(4.0), Err(Error::Vacuum { .. })));
        assert!(matches!(
            RiemannProblem::new(State::new(-1.0, 0.0, 1.0), State::new(1.0, 0.0, 1.0), 1.4),
            Err(Error::State { side: "left", .. })
        ));
        assert!(RiemannProblem::new(State::new(1.0, f64::NAN, 1.0), State::new(1.0, 0.0, 1.0), 1.4).is_err());
    }

    #[test] // row sod of riemann_star_states.csv
    fn waves_of_sod() {
        let Wave::Rarefaction { head, tail } = sod().left_wave() else { panic!("left wave of Sod is a rarefaction") };
        close(head, -1.183216, 1e-6);
        close(tail, -0.070272813, 1e-7);
        close(sod().right_shock_position(0.5, 0.2).unwrap(), 0.5 + 0.2 * 1.7521557, 1e-7);
        assert_eq!(sod().left_shock_position(0.5, 0.2), None);
    }

    #[test]
    fn samples_keep_the_riemann_invariant_in_the_fan() {
        for i in 0..20 {
            let s = sod().sample(-1.18 + 0.055 * f64::from(i));
            close(s.pressure / s.density.powf(1.4), 1.0, 1e-12);
            close(s.velocity + 5.0 * s.sound_speed(1.4), 5.0 * 1.4_f64.sqrt(), 1e-12);
        }
    }

    #[test]
    fn shocks_keep_mass_momentum_and_energy() {
        let p = sod();
        let Wave::Shock { speed } = p.right_wave() else { panic!("right wave of Sod is a shock") };
        let flux = |s: State| {
            let u = s.velocity - speed;
            [s.density * u, s.density * u * u + s.pressure, u * (3.5 * s.pressure + 0.5 * s.density * u * u)]
        };
        let (behind, ahead) = (flux(p.sample(speed - 1e-9)), flux(p.sample(speed + 1e-9)));
        for (b, a) in behind.iter().zip(ahead) {
            close(*b, a, 1e-12);
        }
    }

    #[test] // row slow_shock_mach3 of riemann_star_states.csv
    fn mirrored_problem_is_the_mirror_image() {
        let (l, r) = (State::new(3.857143, -0.810631, 10.33333), State::new(1.0, -3.44, 1.0));
        let p = RiemannProblem::new(l, r, 1.4).unwrap();
        let m = RiemannProblem::new(mirrored(&r), mirrored(&l), 1.4).unwrap();
        close(p.right_shock_position(0.5, 0.5).unwrap(), 0.5 + 0.5 * 0.10964773, 1e-7);
        for i in -20..20 {
            let x = 0.37 * f64::from(i) + 0.01;
            let (a, b) = (p.sample(x), mirrored(&m.sample(-x)));
            close(a.density, b.density, 1e-12);
            close(a.pressure, b.pressure, 1e-12);
        }
    }
}
