//! The controller's configuration for this rig.
//!
//! **Model.** What a motor sees that drives through the declared gear ([`AxisParameters::apparent`]): this is what an identification
//! from currents finds and what the feed-forward needs. The lower bound of friction, for the coast distance, is 0.85 of it.
//!
//! **Gains.** The position loop must be stiff against the chain, or the load mode and the motor's mix: K_p (n/R)² K_T K_amp is ten
//! times K_e on the long axis. The motor alone on that stiffness is damped with ratio 0.7 by K_d; T_i is 0.2 s. The paper's ratios
//! (T_i = 1 s, K_d/K_p = 0.1 s) belong to a loop that is softer than its chain.
//!
//! **Limits.** Homing is slow (18 mm/s): beyond the open switch the drive is blocked towards the stop, and a stiff loop that wants to go on
//! there looks like a drive that does not follow. The command is called saturated after 30 ms: that is how long a motor whose encoder
//! has failed at creep runs away.
//!
//! **Shaper.** ZVD at the *load's* mode √(K_e/M)/2π with the body as mounted, not at the 13 Hz that the current shows.

use crate::load::Load;
use crate::parameters::AxisParameters;
use froude_control::config::{AxisConfig, Config, Drive, Gains, Limits};

/// Stiffness of the position loop over that of the chain.
const LOOP_OVER_CHAIN: [f64; 2] = [10.0, 4.0];
/// Largest command, V: 1.5 times what a loaded axis needs at full acceleration and speed. On y 3.34 A, so that noise of the current
/// monitor on a cut command is no over-current; on x less, or a blind encoder would drive the bare platform through its travel.
const COMMAND_V: [f64; 2] = [9.5, 4.5];
/// Damping ratio of the motor on that stiffness.
const LOOP_DAMPING: f64 = 0.7;
/// T_i, s.
const INTEGRAL_S: f64 = 0.2;
/// Part of the declared friction that the coast distance may count on.
const SURE_FRICTION: f64 = 0.85;

/// Configuration for a carriage with this load, from the declared parameters.
#[must_use]
pub fn control_config(loads: &[Load; 2]) -> Config {
    let axes = [(AxisParameters::long(), 0), (AxisParameters::short(), 1)];
    Config {
        axes: axes.map(|(parameters, i)| axis_config(&parameters, &loads[i], LOOP_OVER_CHAIN[i], COMMAND_V[i])),
        tick_us: crate::twin::TICK_US,
        late_us: 1_000,
        host_silence_us: 200_000,
    }
}

fn axis_config(axis: &AxisParameters, load: &Load, loop_over_chain: f64, command_v: f64) -> AxisConfig {
    let mass_kg = load.mass_kg(axis);
    let seen = axis.apparent(mass_kg, load.wheel_load_n(axis));
    let mode_hz = axis.load_mode_hz(mass_kg);
    // Volts at the motor per newton at the chain.
    let v_per_n = axis.chain_m_rad() / (axis.torque_constant_n_m_a * crate::parameters::AMPLIFIER_A_V);
    let stiffness_n_m = loop_over_chain * axis.stiffness_n_m;
    let damping_n_s_m = 2.0 * LOOP_DAMPING * libm::sqrt(stiffness_n_m * axis.motor_mass_kg());
    let per_rad = v_per_n * axis.chain_m_rad();
    AxisConfig {
        gains: Gains {
            proportional_v_rad: stiffness_n_m * per_rad,
            derivative_v_s_rad: damping_n_s_m * per_rad,
            integral_v_rad_s: stiffness_n_m * per_rad / INTEGRAL_S,
            derivative_filter_hz: 300.0,
        },
        drive: Drive {
            inertia_kg_m2: seen.inertia_kg_m2,
            coast_inertia_kg_m2: seen.inertia_kg_m2,
            viscous_n_m_s_rad: seen.viscous_n_m_s_rad,
            viscous_lower_n_m_s_rad: SURE_FRICTION * seen.viscous_n_m_s_rad,
            coulomb_n_m: seen.coulomb_n_m,
            coulomb_lower_n_m: SURE_FRICTION * seen.coulomb_n_m,
            held_band: 1.0 - axis.efficiency_forward * axis.efficiency_backward,
            drag_n_s2_m2: (load.drag_n_s2_m2() + load.strut_n_s2_m2(axis)) / axis.efficiency_forward,
            torque_constant_n_m_a: axis.torque_constant_n_m_a,
            amplifier_a_v: crate::parameters::AMPLIFIER_A_V,
            gear_ratio: axis.gear_ratio,
            sprocket_radius_m: axis.sprocket_radius_m,
            counts_per_revolution: axis.counts_per_revolution,
            encoder_sign: axis.encoder_sign,
        },
        limits: Limits {
            hard_low_m: axis.hard_low_m,
            hard_high_m: axis.hard_high_m,
            low_switch_m: axis.low_switch_m(),
            high_switch_m: axis.high_switch_m(),
            speed_m_s: 0.6,
            unhomed_speed_m_s: 0.018,
            acceleration_m_s2: 1.0,
            command_v,
            current_a: 3.5,
            continuous_current_a: 2.0,
            thermal_time_s: 20.0,
            following_error_m: 0.01,
            saturation_s: 0.03,
            encoder_errors_per_s: 10,
            polarity_m: 0.005,
            stuck_s: 0.05,
        },
        mode_hz,
        mode_damping: axis.load_mode_damping(mass_kg),
        is_robust_shaper: true,
    }
}
