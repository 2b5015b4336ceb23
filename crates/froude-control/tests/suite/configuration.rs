//! What `new` does not accept, in words.

use froude_control::Controller;
use froude_control::config::{AxisConfig, Config, CountGains, Gains};

fn refused(change: impl FnOnce(&mut AxisConfig)) -> String {
    let mut config = Config::PUBLISHED;
    change(&mut config.axes[1]);
    Controller::new(config).unwrap_err().to_string()
}

#[test]
fn refusals_say_what_was_found_and_what_is_accepted() {
    assert_eq!(refused(|a| a.limits.speed_m_s = f64::NAN), "axis 1: limits.speed_m_s is NaN, must be in 0.001..=100");
    assert_eq!(refused(|a| a.drive.encoder_sign = 0.5), "axis 1: drive.encoder_sign squared is 0.25, must be in 1..=1");
    assert_eq!(
        refused(|a| (a.drive.coulomb_lower_n_m, a.drive.viscous_lower_n_m_s_rad) = (0.0, 0.0)),
        "axis 1: no friction is declared, so no coast distance; give coulomb_lower_n_m or viscous_lower_n_m_s_rad"
    );
    let close = refused(|a| a.limits.low_switch_m = -0.045);
    assert!(
        close.starts_with("axis 1: the low end switch is 0.00500000")
            && close.ends_with("lower unhomed_speed_m_s or move the switch"),
        "{close}"
    );
    let narrow = refused(|a| (a.limits.high_switch_m, a.limits.following_error_m) = (0.5, 0.5));
    assert_eq!(narrow, "axis 1: soft limits 0.5 m and 0 m leave no travel; lower following_error_m");
    let weak = refused(|a| a.limits.command_v = 1.0);
    assert!(
        weak.starts_with("axis 1: the acceleration limit takes 1.4")
            && weak.ends_with("V and 1 V are allowed; lower acceleration_m_s2"),
        "{weak}"
    );
    let slow = Controller::new(Config { tick_us: 0, ..Config::PUBLISHED }).unwrap_err().to_string();
    assert_eq!(slow, "tick_us is 0, must be in 50..=10000");
}

#[test]
fn the_published_configuration_is_accepted() {
    assert!(Controller::new(Config::PUBLISHED).is_ok());
}

/// The paper's gains: K_p/(4000 K_i) = 1.003 s and K_d/K_p = 0.100 s, whatever the scale.
#[test]
fn gains_in_counts_keep_the_papers_ratios() {
    let counts = CountGains { proportional: 1.32e-6, derivative: 1.32e-7, integral: 3.29e-10 };
    // Volts per unit of the controller's output, and counts per radian.
    let volts_per_unit = 1900.0;
    let scale = volts_per_unit * 4000.0 / (2.0 * core::f64::consts::PI);
    let gains = Gains {
        proportional_v_rad: scale * counts.proportional,
        derivative_v_s_rad: scale * counts.derivative,
        integral_v_rad_s: scale * counts.integral * 4000.0,
        derivative_filter_hz: 150.0,
    };
    // Half a unit in the last digit of K_i is 0.15 %.
    assert!((gains.proportional_v_rad / gains.integral_v_rad_s - 1.003).abs() < 0.0015);
    assert!((gains.derivative_v_s_rad / gains.proportional_v_rad - 0.1).abs() < 1e-15);
    let back = CountGains::from_si(&gains, 4000.0, 250);
    assert!((back.integral / (volts_per_unit * counts.integral) - 1.0).abs() < 1e-14);
    assert!((back.proportional / (volts_per_unit * counts.proportional) - 1.0).abs() < 1e-14);
}
