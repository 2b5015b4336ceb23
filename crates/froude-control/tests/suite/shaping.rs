//! Shaping: the mode that a shaper is made for stays at rest.

use froude_control::profile::{Bounds, Profile, State};
use froude_control::shaper::{ShapedProfile, Shaper};

/// Amplitude that a mode (ω, ζ) driven by a reference has left after it ended: |∫ a(t) e^{iωt} e^{ζω t} dt|, by classical
/// Runge–Kutta steps of ẍ + 2ζω(ẋ − v) + ω²(x − r) = 0.
fn residual_m(mode_hz: f64, damping: f64, duration_s: f64, reference: impl Fn(f64) -> State) -> f64 {
    let omega = 2.0 * std::f64::consts::PI * mode_hz;
    let steps = (duration_s * mode_hz * 4000.0).ceil();
    let dt = duration_s / steps;
    // In the moving frame z = x − r: z̈ = −2ζω ż − ω² z − a.
    let slope =
        |t: f64, [z, w]: [f64; 2]| [w, -2.0 * damping * omega * w - omega * omega * z - reference(t).acceleration_m_s2];
    let add = |a: [f64; 2], h: f64, b: [f64; 2]| [a[0] + h * b[0], a[1] + h * b[1]];
    let mut s = [0.0, 0.0];
    for i in 0..steps as u64 {
        let t = i as f64 * dt;
        let k1 = slope(t, s);
        let k2 = slope(t + 0.5 * dt, add(s, 0.5 * dt, k1));
        let k3 = slope(t + 0.5 * dt, add(s, 0.5 * dt, k2));
        let k4 = slope(t + dt, add(s, dt, k3));
        for j in 0..2 {
            s[j] += dt / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j]);
        }
    }
    let [z, w] = s;
    (z * z + (w / omega).powi(2)).sqrt()
}

fn profile() -> Profile {
    // Ramps of 0.23 s: no multiple of the period of 2 Hz, which would leave nothing to cancel.
    Profile::plan(0.0, 1.0, Bounds { speed_m_s: 0.23, acceleration_m_s2: 1.0, jerk_m_s3: 0.0 })
}

/// Residual with a shaper over the residual without one.
fn ratio(shaper: Shaper, mode_hz: f64, damping: f64) -> f64 {
    let bare = profile();
    let shaped = ShapedProfile::new(bare, shaper);
    residual_m(mode_hz, damping, shaped.duration_s(), |t| shaped.sample(t))
        / residual_m(mode_hz, damping, bare.duration_s(), |t| bare.sample(t))
}

/// Of the integration: kinks of the acceleration within steps of 1/4000 period, of vibrations of about 1/10 of the static lag.
const INTEGRATION: f64 = 5e-3;

#[test]
fn shapers_cancel_the_mode_they_are_made_for() {
    for damping in [0.0, 0.05, 0.2] {
        assert!(ratio(Shaper::zv(2.0, damping), 2.0, damping) < INTEGRATION);
        assert!(ratio(Shaper::zvd(2.0, damping), 2.0, damping) < INTEGRATION);
    }
}

/// Undamped, two impulses half a period of f₀ apart leave |cos(πf/2f₀)| of a vibration at f; three leave its square.
#[test]
fn a_wrong_mode_leaves_what_theory_says_and_the_robust_shaper_leaves_its_square() {
    for wrong in [0.8, 0.9, 1.1, 1.2] {
        let one = (0.5 * std::f64::consts::PI * wrong).cos().abs();
        let zv = ratio(Shaper::zv(2.0, 0.0), 2.0 * wrong, 0.0);
        let zvd = ratio(Shaper::zvd(2.0, 0.0), 2.0 * wrong, 0.0);
        assert!((zv - one).abs() < INTEGRATION, "ZV at {wrong}: {zv}, theory {one}");
        assert!((zvd - one * one).abs() < INTEGRATION, "ZVD at {wrong}: {zvd}, theory {}", one * one);
    }
}

#[test]
fn no_shaping_is_the_profile_itself() {
    let bare = profile();
    let shaped = ShapedProfile::new(bare, Shaper::NONE);
    for i in 0..1000 {
        let t = f64::from(i) * 0.005;
        assert_eq!(shaped.sample(t), bare.sample(t));
    }
}
