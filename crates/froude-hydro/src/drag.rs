//! The six whole-robot drag models f1 to f6, as force and as regressor.
//!
//! **Setting.** A straight chain `HkLT` in steady planar motion through water,
//! far from walls and surface.
//! **Frame.** Body axes, `x` forward along the links, `y` to starboard. Forces are
//! those of the fluid on the body, so a resisting force is negative for a
//! positive velocity.
//! **Units.** N, m/s, kg/m; a coefficient is `[-]`, or `[m/s]` when it belongs to a
//! linear term (the paper prints those as dimensionless, with an implied 1 m/s).
//!
//! With `q(v) = v|v|`, `n = k + 2` modules and
//! `G_T = ½ρπ·½(a+b)·2l`, `G_N = ½ρ·2a·2l`, `G_HTx = ½ρπab`, `G_HTy = ½ρA_HT`, `G_XY = ρal`:
//!
//! | model | `−f_x` | `−f_y` | source |
//! |-------|--------|--------|--------|
//! | f1 | `n G_T C_f (v_ref v_x + q_x)` | `n G_N C_d (v_ref v_y + q_y)` | USR eq. 9 |
//! | f2 | `n G_T (C_f^I v_x + C_f^II q_x)` | `n G_N (C_d^I v_y + C_d^II q_y)` | USR eq. 10 |
//! | f3 | f2 with `k` for `n`, `+ G_HTx (C_fHT^I v_x + C_fHT^II q_x)` | likewise with `G_HTy`, `C_dHT` | USR eq. 11 |
//! | f4 | f3 `+ G_XY (−C_XY^I \|v_y\| + C_XY^II v_y²)` | f3 | USR eq. 12 |
//! | f5 | f4 without `C_fHT^I`, `C_XY^I` | f3 without `C_dHT^I` | USR eq. 13 |
//! | f6 | `½ρ πab C_f q_x` | `½ρ (A_yH + k·2l·2a + A_yT) C_d q_y` | USR eq. 14 |
//!
//! Corrections of the printed equations: in eq. 11 the second head/tail area is `πa²`,
//! here `πab` as in the first; the signs of eq. 13 and 14 are those of a resisting
//! force, as in eq. 9; eq. 11 to 13 print `n − 2` for what is `k` here.
//!
//! Not here: yaw, added mass (see [`crate::link_parameters`]).

use core::f64::consts::PI;

use crate::geometry::Body;

/// The largest number of coefficients of any model (f4).
pub const MAX_COEFFICIENTS: usize = 10;

/// Everything a regressor needs besides the velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// Geometry of the modules.
    pub body: Body,
    /// `k`, number of plain links; the chain has `k + 2` modules.
    pub n_links: f64,
    /// Density of the water, kg/m³.
    pub density_kg_m3: f64,
    /// Reference speed of f1's linear term, m/s; 1 in the paper.
    pub v_ref_m_s: f64,
    /// How the cross terms act where the paper does not print them.
    pub cross_term: CrossTerm,
}

impl Setting {
    /// The paper's setting: `v_ref` = 1 m/s and cross terms as printed.
    #[must_use]
    pub fn as_published(body: Body, n_links: f64, density_kg_m3: f64) -> Self {
        Self { body, n_links, density_kg_m3, v_ref_m_s: 1.0, cross_term: CrossTerm::AsPrinted }
    }
}

/// How the cross terms of f4 and f5 depend on the direction of surge.
///
/// They are printed for `v_x ≥ 0`, where all published tests lie. A body that is
/// mirrored fore and aft needs a force that is odd in `v_x`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CrossTerm {
    /// As printed for `v_x ≥ 0`, with the opposite sign for `v_x < 0`. It jumps at
    /// broadside, where rounding of `U cos 90°` chooses the sign.
    AsPrinted,
    /// Multiplied by `v_x / √(v_x² + ε²)`: smooth and odd, for simulation. At
    /// `v_x = 3ε` it has 95 % of the printed value.
    Smooth {
        /// `ε`, m/s, above zero.
        epsilon_m_s: f64,
    },
}

impl CrossTerm {
    /// The factor of the cross terms at `v_x`, between −1 and 1 \[-\].
    #[must_use]
    pub fn direction(self, v_x_m_s: f64) -> f64 {
        match self {
            Self::AsPrinted => {
                if v_x_m_s < 0.0 {
                    -1.0
                } else {
                    1.0
                }
            }
            Self::Smooth { epsilon_m_s } => {
                let scale = libm::hypot(v_x_m_s, epsilon_m_s);
                if scale > 0.0 { v_x_m_s / scale } else { 0.0 }
            }
        }
    }
}

/// A force component in body axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Axis {
    /// Surge, along the links.
    X,
    /// Sway, across the links.
    Y,
}

impl Axis {
    /// Position in a `[x, y]` pair.
    #[must_use]
    pub const fn index(self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
        }
    }
}

/// The geometric factor in front of a coefficient, kg/m.
///
/// It is a mass per length: density times the area that the term refers to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Factor {
    /// `n G_T`: friction of all `n = k + 2` modules.
    ModulesGT,
    /// `k G_T`: friction of the plain links.
    LinksGT,
    /// `G_HTx = ½ρπab`: head and tail, end-on.
    GHTx,
    /// `n G_N`: cross-flow on all modules.
    ModulesGN,
    /// `k G_N`: cross-flow on the plain links.
    LinksGN,
    /// `G_HTy = ½ρ(A_yH + A_yT)`: head and tail, broadside.
    GHTy,
    /// `G_XY = ρal`: the cross terms.
    GXY,
    /// `½ρ A_x`, with `A_x = πab`.
    FrontalX,
    /// `½ρ A_y`, with `A_y = A_yH + k·2l·2a + A_yT`.
    SideY,
}

impl Factor {
    /// How reports write it.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::ModulesGT => "n*G_T",
            Self::LinksGT => "k*G_T",
            Self::GHTx => "G_HTx",
            Self::ModulesGN => "n*G_N",
            Self::LinksGN => "k*G_N",
            Self::GHTy => "G_HTy",
            Self::GXY => "G_XY",
            Self::FrontalX => "0.5*rho*A_x",
            Self::SideY => "0.5*rho*A_y",
        }
    }

    /// Its value in a setting, kg/m.
    ///
    /// # Example
    ///
    /// ```
    /// use froude_hydro::{Body, Factor, Link, Setting};
    /// let body = Body {
    ///     link: Link { major_semi_axis_m: 0.06, minor_semi_axis_m: 0.04, half_length_m: 0.09 },
    ///     head_side_area_m2: 0.011,
    ///     tail_side_area_m2: 0.008,
    /// };
    /// let two_links = Setting::as_published(body, 2.0, 1000.0);
    /// // ½ · 1000 · 0.12 · 0.18 · (2 links)
    /// assert!((Factor::LinksGN.value(&two_links) - 21.6).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn value(self, s: &Setting) -> f64 {
        let link = &s.body.link;
        let half_density = 0.5 * s.density_kg_m3;
        let g_t = half_density * link.friction_area_m2();
        let g_n = half_density * link.side_area_m2();
        match self {
            Self::ModulesGT => (s.n_links + 2.0) * g_t,
            Self::LinksGT => s.n_links * g_t,
            Self::ModulesGN => (s.n_links + 2.0) * g_n,
            Self::LinksGN => s.n_links * g_n,
            Self::GHTx | Self::FrontalX => half_density * PI * link.major_semi_axis_m * link.minor_semi_axis_m,
            Self::GHTy => half_density * s.body.head_tail_side_area_m2(),
            Self::GXY => s.density_kg_m3 * link.major_semi_axis_m * link.half_length_m,
            Self::SideY => half_density * s.body.side_area_m2(s.n_links),
        }
    }
}

/// How the term of a coefficient depends on the velocity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Motion {
    /// `−(v_ref v + v|v|)` along the coefficient's axis.
    LinearAndQuadratic,
    /// `−v`.
    Linear,
    /// `−v|v|`.
    Quadratic,
    /// `+s(v_x)|v_y|`: pushes forward (USR eq. 12 prints it so).
    CrossLinear,
    /// `−s(v_x) v_y²`.
    CrossQuadratic,
}

impl Motion {
    /// The velocity factor of the force term, sign included: m²/s², or m/s for the
    /// linear kinds.
    #[must_use]
    pub fn value(self, axis: Axis, s: &Setting, v_m_s: [f64; 2]) -> f64 {
        let along = v_m_s[axis.index()];
        let [v_x, v_y] = v_m_s;
        match self {
            Self::LinearAndQuadratic => -(s.v_ref_m_s * along + along * along.abs()),
            Self::Linear => -along,
            Self::Quadratic => -along * along.abs(),
            Self::CrossLinear => s.cross_term.direction(v_x) * v_y.abs(),
            Self::CrossQuadratic => -s.cross_term.direction(v_x) * v_y * v_y,
        }
    }
}

/// One coefficient of a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct CoefficientInfo {
    /// Name in tables and records, for example `C_d_II`.
    pub name: &'static str,
    /// The force component it acts on; none is shared by both.
    pub axis: Axis,
    /// `"1"` or `"m/s"`.
    pub unit: &'static str,
    /// Its geometric factor.
    pub factor: Factor,
    /// Its dependence on the velocity.
    pub motion: Motion,
}

impl CoefficientInfo {
    /// Force that a unit of this coefficient makes along its axis, N.
    ///
    /// The one expression behind [`DragModel::regressor`] and [`DragModel::force_n`].
    #[must_use]
    pub fn regressor(&self, s: &Setting, v_m_s: [f64; 2]) -> f64 {
        self.factor.value(s) * self.motion.value(self.axis, s, v_m_s)
    }
}

/// The drag models of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum DragModel {
    /// One coefficient per component for linear and quadratic drag (USR eq. 9).
    F1,
    /// Linear and quadratic drag apart (USR eq. 10).
    F2,
    /// Head and tail apart (USR eq. 11).
    F3,
    /// With cross terms in `f_x` (USR eq. 12).
    F4,
    /// f4 without the linear head/tail and cross terms (USR eq. 13).
    F5,
    /// Quadratic drag on the projected areas (USR eq. 14).
    F6,
}

const fn row(name: &'static str, axis: Axis, factor: Factor, motion: Motion) -> CoefficientInfo {
    let unit = match motion {
        Motion::Linear | Motion::CrossLinear => "m/s",
        _ => "1",
    };
    CoefficientInfo { name, axis, unit, factor, motion }
}

use Axis::{X, Y};
use Factor::{FrontalX, GHTx, GHTy, GXY, LinksGN, LinksGT, ModulesGN, ModulesGT, SideY};
use Motion::{CrossLinear, CrossQuadratic, Linear, LinearAndQuadratic, Quadratic};

const F1: [CoefficientInfo; 2] =
    [row("C_f", X, ModulesGT, LinearAndQuadratic), row("C_d", Y, ModulesGN, LinearAndQuadratic)];
const F2: [CoefficientInfo; 4] = [
    row("C_f_I", X, ModulesGT, Linear),
    row("C_d_I", Y, ModulesGN, Linear),
    row("C_f_II", X, ModulesGT, Quadratic),
    row("C_d_II", Y, ModulesGN, Quadratic),
];
const F4: [CoefficientInfo; 10] = [
    row("C_f_I", X, LinksGT, Linear),
    row("C_d_I", Y, LinksGN, Linear),
    row("C_f_II", X, LinksGT, Quadratic),
    row("C_d_II", Y, LinksGN, Quadratic),
    row("C_fHT_I", X, GHTx, Linear),
    row("C_dHT_I", Y, GHTy, Linear),
    row("C_fHT_II", X, GHTx, Quadratic),
    row("C_dHT_II", Y, GHTy, Quadratic),
    row("C_XY_I", X, GXY, CrossLinear),
    row("C_XY_II", X, GXY, CrossQuadratic),
];
const F3: [CoefficientInfo; 8] = [F4[0], F4[1], F4[2], F4[3], F4[4], F4[5], F4[6], F4[7]];
const F5: [CoefficientInfo; 7] = [F4[0], F4[1], F4[2], F4[3], F4[6], F4[7], F4[9]];
const F6: [CoefficientInfo; 2] = [row("C_f", X, FrontalX, Quadratic), row("C_d", Y, SideY, Quadratic)];

impl DragModel {
    /// All models, in the paper's order.
    pub const ALL: [Self; 6] = [Self::F1, Self::F2, Self::F3, Self::F4, Self::F5, Self::F6];

    /// `f1` … `f6`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::F1 => "f1",
            Self::F2 => "f2",
            Self::F3 => "f3",
            Self::F4 => "f4",
            Self::F5 => "f5",
            Self::F6 => "f6",
        }
    }

    /// The model of that name, written exactly as [`DragModel::name`] has it.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|model| model.name() == name)
    }

    /// The coefficients in the order that every vector of this crate uses.
    #[must_use]
    pub const fn coefficients(self) -> &'static [CoefficientInfo] {
        match self {
            Self::F1 => &F1,
            Self::F2 => &F2,
            Self::F3 => &F3,
            Self::F4 => &F4,
            Self::F5 => &F5,
            Self::F6 => &F6,
        }
    }

    /// What a unit of each coefficient contributes to the force, N.
    ///
    /// `out[j]` is the contribution of coefficient `j` along `coefficients()[j].axis`;
    /// negative means it resists a positive velocity. `out` holds at least
    /// `coefficients().len()` numbers; further ones are left alone, a shorter one
    /// takes as many as fit.
    pub fn regressor(self, s: &Setting, v_m_s: [f64; 2], out: &mut [f64]) {
        debug_assert!(out.len() >= self.coefficients().len());
        for (value, info) in out.iter_mut().zip(self.coefficients()) {
            *value = info.regressor(s, v_m_s);
        }
    }

    /// The force of the fluid on the body, N, body axes.
    ///
    /// `c` is in the order of [`DragModel::coefficients`]; missing ones count as
    /// zero. Built on the regressor, so a fit and a simulation cannot differ.
    ///
    /// # Example
    ///
    /// Mamba with two links at 0.4 m/s and 30°, tank coefficients (USR Table 9, f6):
    ///
    /// ```
    /// use froude_hydro::{Body, DragModel, Link, Setting};
    /// let body = Body {
    ///     link: Link { major_semi_axis_m: 0.0588, minor_semi_axis_m: 0.0394, half_length_m: 0.09 },
    ///     head_side_area_m2: 0.011,
    ///     tail_side_area_m2: 0.008,
    /// };
    /// let setting = Setting::as_published(body, 2.0, 1025.0);
    /// let (sin, cos) = 30f64.to_radians().sin_cos();
    /// let [f_x, f_y] = DragModel::F6.force_n(&setting, [0.4 * cos, -0.4 * sin], &[0.3363, 1.6066]);
    /// assert!((f_x + 0.1505).abs() < 1e-4 && (f_y - 2.0202).abs() < 1e-4);
    /// ```
    #[must_use]
    pub fn force_n(self, s: &Setting, v_m_s: [f64; 2], c: &[f64]) -> [f64; 2] {
        let mut unit = [0.0; MAX_COEFFICIENTS];
        self.regressor(s, v_m_s, &mut unit);
        let mut force_n = [0.0; 2];
        for ((info, unit), c) in self.coefficients().iter().zip(unit).zip(c) {
            force_n[info.axis.index()] += unit * c;
        }
        force_n
    }
}
