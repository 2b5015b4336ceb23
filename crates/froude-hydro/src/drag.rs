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

    /// The force component's name in tables: `f_x` or `f_y`.
    #[must_use]
    pub const fn load(self) -> &'static str {
        match self {
            Self::X => "f_x",
            Self::Y => "f_y",
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

    /// Position of a coefficient, by its name.
    #[must_use]
    pub fn index_of(self, name: &str) -> Option<usize> {
        self.coefficients().iter().position(|c| c.name == name)
    }

    /// The law of one component, as a line of plain text.
    ///
    /// `q(v)` is `v*|v|`; `s(v_x)` is the direction of [`CrossTerm`].
    #[must_use]
    pub const fn equation(self, axis: Axis) -> &'static str {
        match (self, axis) {
            (Self::F1, X) => "-f_x = n*G_T*C_f*(v_ref*v_x + q(v_x))",
            (Self::F1, Y) => "-f_y = n*G_N*C_d*(v_ref*v_y + q(v_y))",
            (Self::F2, X) => "-f_x = n*G_T*(C_f_I*v_x + C_f_II*q(v_x))",
            (Self::F2, Y) => "-f_y = n*G_N*(C_d_I*v_y + C_d_II*q(v_y))",
            (Self::F3, X) => "-f_x = k*G_T*(C_f_I*v_x + C_f_II*q(v_x)) + G_HTx*(C_fHT_I*v_x + C_fHT_II*q(v_x))",
            (Self::F3 | Self::F4, Y) => {
                "-f_y = k*G_N*(C_d_I*v_y + C_d_II*q(v_y)) + G_HTy*(C_dHT_I*v_y + C_dHT_II*q(v_y))"
            }
            (Self::F4, X) => {
                "-f_x = k*G_T*(C_f_I*v_x + C_f_II*q(v_x)) + G_HTx*(C_fHT_I*v_x + C_fHT_II*q(v_x)) \
                 + s(v_x)*G_XY*(-C_XY_I*|v_y| + C_XY_II*v_y^2)"
            }
            (Self::F5, X) => {
                "-f_x = k*G_T*(C_f_I*v_x + C_f_II*q(v_x)) + G_HTx*C_fHT_II*q(v_x) \
                 + s(v_x)*G_XY*C_XY_II*v_y^2"
            }
            (Self::F5, Y) => "-f_y = k*G_N*(C_d_I*v_y + C_d_II*q(v_y)) + G_HTy*C_dHT_II*q(v_y)",
            (Self::F6, X) => "-f_x = 0.5*rho*A_x*C_f*q(v_x)",
            (Self::F6, Y) => "-f_y = 0.5*rho*A_y*C_d*q(v_y)",
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
    /// use froude_hydro::{Body, DragModel, Link, Setting, axes::velocity_when_towed_m_s};
    /// let body = Body {
    ///     link: Link { major_semi_axis_m: 0.0588, minor_semi_axis_m: 0.0394, half_length_m: 0.09 },
    ///     head_side_area_m2: 0.011,
    ///     tail_side_area_m2: 0.008,
    /// };
    /// let setting = Setting::as_published(body, 2.0, 1025.0);
    /// let v = velocity_when_towed_m_s(0.4, 30f64.to_radians());
    /// let [f_x, f_y] = DragModel::F6.force_n(&setting, v, &[0.3363, 1.6066]);
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

    /// The linear restrictions under which `general` becomes `self`.
    ///
    /// `None` when `self` is not nested in `general` (and for a model with itself).
    /// Nested are f1 ⊂ f2 ⊂ f3 ⊂ f4, f6 ⊂ f5 ⊂ f4, f6 ⊂ f3 and what follows from
    /// these. The rows hold for every number of links; they depend on the geometry
    /// and on `v_ref`, not on the density.
    ///
    /// | pair      | rows |
    /// |-----------|------|
    /// | f1 ⊂ f2   | `C^I = v_ref C^II`, per component |
    /// | f2 ⊂ f3   | `2 G_T C_f = G_HTx C_fHT`, `2 G_N C_d = G_HTy C_dHT`, for I and II |
    /// | f3 ⊂ f4   | `C_XY^I = C_XY^II = 0` |
    /// | f6 ⊂ f5   | `C_f^I = C_f^II = C_d^I = C_XY^II = 0`, `C_d^II = C_dHT^II` |
    /// | f5 ⊂ f4   | `C_fHT^I = C_dHT^I = C_XY^I = 0` |
    /// | f6 ⊂ f3   | the rows of f6 ⊂ f5 without `C_XY`, and `C_fHT^I = C_dHT^I = 0` |
    ///
    /// # Source
    ///
    /// Our derivation from USR eq. 9–14.
    #[must_use]
    pub fn restrictions_in(self, general: Self, s: &Setting) -> Option<Restrictions> {
        if !self.is_nested_in(general) {
            return None;
        }
        let mut rows = Restrictions::none(general);
        let one_link = Setting { n_links: 1.0, ..*s };
        let tie = |head_tail: Factor, link: Factor| -0.5 * head_tail.value(&one_link) / link.value(&one_link);
        let has_head_tail = general != Self::F2;

        match self {
            Self::F1 | Self::F2 => {
                if has_head_tail {
                    for (link, end) in [("C_f_I", "C_fHT_I"), ("C_f_II", "C_fHT_II")] {
                        rows.push(&[(link, 1.0), (end, tie(GHTx, LinksGT))]);
                    }
                    for (link, end) in [("C_d_I", "C_dHT_I"), ("C_d_II", "C_dHT_II")] {
                        rows.push(&[(link, 1.0), (end, tie(GHTy, LinksGN))]);
                    }
                }
                if self == Self::F1 {
                    rows.push(&[("C_f_I", 1.0), ("C_f_II", -s.v_ref_m_s)]);
                    rows.push(&[("C_d_I", 1.0), ("C_d_II", -s.v_ref_m_s)]);
                }
            }
            Self::F6 => {
                for name in ["C_f_I", "C_f_II", "C_d_I", "C_fHT_I", "C_dHT_I"] {
                    rows.push(&[(name, 1.0)]);
                }
                rows.push(&[("C_d_II", 1.0), ("C_dHT_II", -1.0)]);
            }
            Self::F5 => {
                for name in ["C_fHT_I", "C_dHT_I"] {
                    rows.push(&[(name, 1.0)]);
                }
            }
            Self::F3 | Self::F4 => {}
        }
        rows.push(&[("C_XY_I", 1.0)]);
        if self != Self::F5 {
            rows.push(&[("C_XY_II", 1.0)]);
        }
        Some(rows)
    }

    /// Whether every force of `self` is also one of `general`, for another model.
    #[must_use]
    pub const fn is_nested_in(self, general: Self) -> bool {
        matches!(
            (self, general),
            (Self::F1, Self::F2 | Self::F3 | Self::F4)
                | (Self::F2, Self::F3 | Self::F4)
                | (Self::F3 | Self::F5, Self::F4)
                | (Self::F6, Self::F3 | Self::F5 | Self::F4)
        )
    }
}

/// Homogeneous linear restrictions `R·β = 0` on a model's coefficients.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Restrictions {
    general: DragModel,
    rows: [[f64; MAX_COEFFICIENTS]; MAX_COEFFICIENTS],
    n_rows: usize,
}

impl Restrictions {
    const fn none(general: DragModel) -> Self {
        Self { general, rows: [[0.0; MAX_COEFFICIENTS]; MAX_COEFFICIENTS], n_rows: 0 }
    }

    /// Adds a row; names that the general model does not have drop out, and a row
    /// whose every name drops out is no row.
    fn push(&mut self, weights: &[(&str, f64)]) {
        let mut new = [0.0; MAX_COEFFICIENTS];
        let mut is_empty = true;
        for &(name, weight) in weights {
            if let Some(j) = self.general.index_of(name) {
                new[j] = weight;
                is_empty = false;
            }
        }
        if !is_empty {
            self.rows[self.n_rows] = new;
            self.n_rows += 1;
        }
    }

    /// The model whose coefficients are restricted.
    #[must_use]
    pub const fn general(&self) -> DragModel {
        self.general
    }

    /// Number of rows; they are linearly independent.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.n_rows
    }

    /// Whether there is nothing to restrict.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.n_rows == 0
    }

    /// The rows, each as long as the general model has coefficients.
    pub fn rows(&self) -> impl Iterator<Item = &[f64]> {
        let width = self.general.coefficients().len();
        self.rows[..self.n_rows].iter().map(move |row| &row[..width])
    }

    /// The force component a row restricts; no row mixes two.
    #[must_use]
    pub fn axis_of(&self, row: &[f64]) -> Option<Axis> {
        let infos = self.general.coefficients().iter();
        infos.zip(row).find(|(_, weight)| **weight != 0.0).map(|(info, _)| info.axis)
    }

    /// Largest `|R·β|` over the rows, in the coefficients' unit.
    #[must_use]
    pub fn largest_violation(&self, c: &[f64]) -> f64 {
        self.rows().map(|row| row.iter().zip(c).map(|(r, c)| r * c).sum::<f64>().abs()).fold(0.0, f64::max)
    }
}
