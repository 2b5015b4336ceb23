//! The sets of terms, as data.
//!
//! Loads are those of the water on the body, the body's own inertia and weight taken off, in body axes; `v_x v_y v_z` m/s, `w_x w_y w_z` rad/s, angles in rad. A coefficient is called as in SNAME,
//! its letters being the factors of its term: `Y_vr` is |v| r of Fossen, v² r is `Y_vvr` of Abkowitz and MMG. The book has the same table.

/// The law of a thruster, the only law that is not a sum of terms.
pub(crate) const THRUSTER: &str = "thruster";

/// A set of terms.
#[derive(Debug, PartialEq)]
pub(crate) struct NamedLaw {
    /// As a campaign asks for it.
    pub(crate) name: &'static str,
    /// What it is of.
    pub(crate) words: &'static str,
    /// Where it is from.
    pub(crate) source: &'static str,
    /// Where it holds.
    pub(crate) range: &'static str,
    /// Known numbers that it cannot do without, and how they are declared.
    pub(crate) needs: &'static [(&'static str, &'static str)],
    /// For each load a common factor of its terms, and the terms.
    pub(crate) loads: &'static [(&'static str, &'static str, &'static str)],
}

const LENGTH: (&str, &str) = ("L", "[body] reference_length = \"2 m\"");
const DRAUGHT: (&str, &str) = ("d", "[constants] d = \"0.1 m\", the draught");
const DIAMETER: (&str, &str) = ("D", "[constants] D = \"0.1 m\", the diameter of the propeller");

/// The sets that a campaign may name.
pub(crate) static LAWS: [NamedLaw; 8] = [
    NamedLaw {
        name: "oblique",
        words: "oblique towing of a hull with lift",
        source: "SNAME (1952), Bulletin 1-5; Clarke, Gedling & Hine (1983), Trans. RINA 125, 45",
        range: "motion ahead, drift below stall; Y_uv is lift, Y_vv cross-flow, Y_v the part that grows with the speed alone; induced drag (X_vv) is in mmg and abkowitz",
        needs: &[],
        loads: &[
            ("f_x", "", "X_uu*v_x*abs(v_x)"),
            ("f_y", "", "Y_v*v_y + Y_uv*v_x*v_y + Y_vv*v_y*abs(v_y)"),
            ("m_z", "", "N_v*v_y + N_uv*v_x*v_y + N_vv*v_y*abs(v_y)"),
        ],
    },
    NamedLaw {
        name: "fossen_3dof",
        words: "added mass, linear and quadratic damping in surge, sway and yaw",
        source: "Fossen (2011), Handbook of Marine Craft Hydrodynamics and Motion Control, 6.4 and 7.1",
        range: "one forward speed, or low speed: the products of u with v and r are in Y_v, Y_r, N_v and N_r; X_vr and X_rr are the Coriolis force of the added mass: X_vr = -Y_v_dot, X_rr = -Y_r_dot",
        needs: &[],
        loads: &[
            ("f_x", "", "X_u_dot*v_x_dot + X_u*v_x + X_uu*v_x*abs(v_x) + X_vr*v_y*w_z + X_rr*w_z^2"),
            (
                "f_y",
                "",
                "Y_v_dot*v_y_dot + Y_r_dot*w_z_dot + Y_v*v_y + Y_r*w_z + Y_vv*v_y*abs(v_y) + Y_rv*abs(w_z)*v_y + Y_vr*abs(v_y)*w_z + Y_rr*w_z*abs(w_z)",
            ),
            (
                "m_z",
                "",
                "N_v_dot*v_y_dot + N_r_dot*w_z_dot + N_v*v_y + N_r*w_z + N_vv*v_y*abs(v_y) + N_rv*abs(w_z)*v_y + N_vr*abs(v_y)*w_z + N_rr*w_z*abs(w_z)",
            ),
        ],
    },
    NamedLaw {
        name: "fossen_6dof",
        words: "added mass, linear and quadratic damping along and about each axis by itself",
        source: "Fossen (2011), Handbook of Marine Craft Hydrodynamics and Motion Control, 7.5",
        range: "low speed, three planes of symmetry; no coupling of axes",
        needs: &[],
        loads: &[
            ("f_x", "", "X_u_dot*v_x_dot + X_u*v_x + X_uu*v_x*abs(v_x)"),
            ("f_y", "", "Y_v_dot*v_y_dot + Y_v*v_y + Y_vv*v_y*abs(v_y)"),
            ("f_z", "", "Z_w_dot*v_z_dot + Z_w*v_z + Z_ww*v_z*abs(v_z)"),
            ("m_x", "", "K_p_dot*w_x_dot + K_p*w_x + K_pp*w_x*abs(w_x)"),
            ("m_y", "", "M_q_dot*w_y_dot + M_q*w_y + M_qq*w_y*abs(w_y)"),
            ("m_z", "", "N_r_dot*w_z_dot + N_r*w_z + N_rr*w_z*abs(w_z)"),
        ],
    },
    NamedLaw {
        name: "abkowitz",
        words: "third-order polynomial of a ship, by the speed of each row",
        source: "Abkowitz (1964), HyA report Hy-5; Chislett & Strøm-Tejsen (1965), HyA report Hy-6",
        range: "ahead near the approach speed, drift and rate small enough for a third order; rows at rest are left out with `keep`; published Y_r, N_r, X_vr and X_rr include the ship's own mass, but these do not",
        needs: &[],
        loads: &[
            (
                "f_x",
                "",
                "X_u_dot*v_x_dot + X_0*speed^2 + X_vv*v_y^2 + X_vr*v_y*w_z + X_rr*w_z^2 + X_dd*speed^2*rudder^2 + X_vd*abs(speed)*v_y*rudder + X_rd*abs(speed)*w_z*rudder",
            ),
            (
                "f_y",
                "",
                "Y_v_dot*v_y_dot + Y_r_dot*w_z_dot + Y_0*speed^2 + Y_v*abs(speed)*v_y + Y_r*abs(speed)*w_z + Y_vvv*v_y^3/abs(speed) + Y_vvr*v_y^2*w_z/abs(speed) + Y_vrr*v_y*w_z^2/abs(speed) + Y_rrr*w_z^3/abs(speed) + Y_d*speed^2*rudder + Y_ddd*speed^2*rudder^3 + Y_vvd*v_y^2*rudder + Y_vdd*abs(speed)*v_y*rudder^2",
            ),
            (
                "m_z",
                "",
                "N_v_dot*v_y_dot + N_r_dot*w_z_dot + N_0*speed^2 + N_v*abs(speed)*v_y + N_r*abs(speed)*w_z + N_vvv*v_y^3/abs(speed) + N_vvr*v_y^2*w_z/abs(speed) + N_vrr*v_y*w_z^2/abs(speed) + N_rrr*w_z^3/abs(speed) + N_d*speed^2*rudder + N_ddd*speed^2*rudder^3 + N_vvd*v_y^2*rudder + N_vdd*abs(speed)*v_y*rudder^2",
            ),
        ],
    },
    NamedLaw {
        name: "mmg",
        words: "hull forces of the MMG standard method over v' and r', as pure numbers",
        source: "Yasukawa & Yoshimura (2015), J. Mar. Sci. Technol. 20, 37; X_0 is -R'_0",
        range: "ahead, hull without propeller and rudder, drift up to about 20 deg, r' up to about 1; the terms of r include the added mass of a steady turn",
        needs: &[LENGTH, DRAUGHT],
        loads: &[
            (
                "f_x",
                "0.5*density*L*d",
                "X_0*speed^2 + X_vv*v_y^2 + X_vr*L*v_y*w_z + X_rr*L^2*w_z^2 + X_vvvv*v_y^4/speed^2",
            ),
            (
                "f_y",
                "0.5*density*L*d",
                "Y_v*abs(speed)*v_y + Y_r*L*abs(speed)*w_z + Y_vvv*v_y^3/abs(speed) + Y_vvr*L*v_y^2*w_z/abs(speed) + Y_vrr*L^2*v_y*w_z^2/abs(speed) + Y_rrr*L^3*w_z^3/abs(speed)",
            ),
            (
                "m_z",
                "0.5*density*L^2*d",
                "N_v*abs(speed)*v_y + N_r*L*abs(speed)*w_z + N_vvv*v_y^3/abs(speed) + N_vvr*L*v_y^2*w_z/abs(speed) + N_vrr*L^2*v_y*w_z^2/abs(speed) + N_rrr*L^3*w_z^3/abs(speed)",
            ),
        ],
    },
    NamedLaw {
        name: "torpedo",
        words: "a torpedo-shaped vehicle with fins",
        source: "Prestero (2001), Verification of a six-degree of freedom simulation model for the REMUS AUV, MIT",
        range: "motion ahead, angles of attack and of the fins below stall",
        needs: &[],
        loads: &[
            ("f_x", "", "X_u_dot*v_x_dot + X_uu*v_x*abs(v_x) + X_wq*v_z*w_y + X_qq*w_y^2 + X_vr*v_y*w_z + X_rr*w_z^2"),
            (
                "f_y",
                "",
                "Y_v_dot*v_y_dot + Y_r_dot*w_z_dot + Y_vv*v_y*abs(v_y) + Y_rr*w_z*abs(w_z) + Y_uv*v_x*v_y + Y_ur*v_x*w_z + Y_wp*v_z*w_x + Y_pq*w_x*w_y + Y_uud*v_x^2*rudder",
            ),
            (
                "f_z",
                "",
                "Z_w_dot*v_z_dot + Z_q_dot*w_y_dot + Z_ww*v_z*abs(v_z) + Z_qq*w_y*abs(w_y) + Z_uw*v_x*v_z + Z_uq*v_x*w_y + Z_vp*v_y*w_x + Z_rp*w_z*w_x + Z_uud*v_x^2*elevator",
            ),
            ("m_x", "", "K_p_dot*w_x_dot + K_pp*w_x*abs(w_x)"),
            (
                "m_y",
                "",
                "M_w_dot*v_z_dot + M_q_dot*w_y_dot + M_ww*v_z*abs(v_z) + M_qq*w_y*abs(w_y) + M_uw*v_x*v_z + M_uq*v_x*w_y + M_vp*v_y*w_x + M_rp*w_z*w_x + M_uud*v_x^2*elevator",
            ),
            (
                "m_z",
                "",
                "N_v_dot*v_y_dot + N_r_dot*w_z_dot + N_vv*v_y*abs(v_y) + N_rr*w_z*abs(w_z) + N_uv*v_x*v_y + N_ur*v_x*w_z + N_wp*v_z*w_x + N_pq*w_x*w_y + N_uud*v_x^2*rudder",
            ),
        ],
    },
    NamedLaw {
        name: THRUSTER,
        words: "thrust and torque over voltage or rate of rotation, with a dead band, T = k s^2 ahead, -k s^2 astern, + c |s| v_x, s being the command beyond the dead band of its direction",
        source: "Fossen (2021), Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., ch. 9; the dead bands are ours",
        range: "steady commands; inflow that does not reverse the flow through the propeller",
        needs: &[],
        loads: &[],
    },
    NamedLaw {
        name: "propeller",
        words: "open-water thrust and torque, K = K_0 + K_1 J + K_2 J^2 with J = v_x/(n D), ahead and astern",
        source: "ITTC 7.5-02-03-02.1, Open water test",
        range: "rows with v_x and n of one sign: the first quadrant, and the third",
        needs: &[DIAMETER],
        loads: &[
            (
                "thrust",
                "density*D^2",
                "K_T0*D^2/(8*pi^2)*rotation_rate^2*sign(rotation_rate)*(1+sign(rotation_rate)) + K_T1*D/(4*pi)*rotation_rate*v_x*sign(rotation_rate)*(1+sign(rotation_rate)) + K_T2*0.5*v_x^2*sign(rotation_rate)*(1+sign(rotation_rate)) + K_T0_astern*D^2/(8*pi^2)*rotation_rate^2*sign(rotation_rate)*(1-sign(rotation_rate)) + K_T1_astern*D/(4*pi)*rotation_rate*v_x*sign(rotation_rate)*(1-sign(rotation_rate)) + K_T2_astern*0.5*v_x^2*sign(rotation_rate)*(1-sign(rotation_rate))",
            ),
            (
                "torque",
                "density*D^3",
                "K_Q0*D^2/(8*pi^2)*rotation_rate^2*sign(rotation_rate)*(1+sign(rotation_rate)) + K_Q1*D/(4*pi)*rotation_rate*v_x*sign(rotation_rate)*(1+sign(rotation_rate)) + K_Q2*0.5*v_x^2*sign(rotation_rate)*(1+sign(rotation_rate)) + K_Q0_astern*D^2/(8*pi^2)*rotation_rate^2*sign(rotation_rate)*(1-sign(rotation_rate)) + K_Q1_astern*D/(4*pi)*rotation_rate*v_x*sign(rotation_rate)*(1-sign(rotation_rate)) + K_Q2_astern*0.5*v_x^2*sign(rotation_rate)*(1-sign(rotation_rate))",
            ),
        ],
    },
];
