//! The axis along or about which a body is released: its names and units.

/// A motion of a rigid body, in the order of a 6 × 6 matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Motion {
    /// Along x.
    Surge,
    /// Along y.
    Sway,
    /// Along z.
    Heave,
    /// About x.
    Roll,
    /// About y.
    Pitch,
    /// About z.
    Yaw,
}

impl Motion {
    /// Each of them.
    pub const ALL: [Self; 6] = [Self::Surge, Self::Sway, Self::Heave, Self::Roll, Self::Pitch, Self::Yaw];
    /// Their names.
    pub const NAMES: [&'static str; 6] = ["surge", "sway", "heave", "roll", "pitch", "yaw"];

    /// As written in a campaign.
    #[must_use]
    pub const fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// Whether it turns the body.
    #[must_use]
    pub const fn is_rotation(self) -> bool {
        matches!(self, Self::Roll | Self::Pitch | Self::Yaw)
    }

    /// As it stands in the names of coefficients: `x` … `rz`.
    #[must_use]
    pub const fn letters(self) -> &'static str {
        match self {
            Self::Surge => "x",
            Self::Sway => "y",
            Self::Heave => "z",
            Self::Roll => "rx",
            Self::Pitch => "ry",
            Self::Yaw => "rz",
        }
    }

    /// Names of added mass, linear and quadratic damping: `A11`, `D_x_I`, `D_x_II`.
    #[must_use]
    pub fn decay_names(self) -> [String; 3] {
        let number = self as usize + 1;
        let letters = self.letters();
        [format!("A{number}{number}"), format!("D_{letters}_I"), format!("D_{letters}_II")]
    }

    /// Units of the three: kg, N s/m, N s²/m², or those of a rotation.
    #[must_use]
    pub const fn decay_units(self) -> [&'static str; 3] {
        if self.is_rotation() { ["kg*m^2", "N*m*s", "N*m*s^2"] } else { ["kg", "kg/s", "kg/m"] }
    }

    /// Names of the undamped frequency, and of linear and quadratic damping per moving inertia: `omega_x`, `d_x_I`, `d_x_II`.
    #[must_use]
    pub fn rate_names(self) -> [String; 3] {
        let letters = self.letters();
        [format!("omega_{letters}"), format!("d_{letters}_I"), format!("d_{letters}_II")]
    }

    /// Units of the three.
    #[must_use]
    pub const fn rate_units(self) -> [&'static str; 3] {
        ["rad/s", "1/s", if self.is_rotation() { "1" } else { "1/m" }]
    }

    /// Names that a log gives the position, beside `angle` or `position`.
    #[must_use]
    pub const fn column_names(self) -> &'static [&'static str] {
        match self {
            Self::Roll => &["angle", "roll", "phi", "heel"],
            Self::Pitch => &["angle", "pitch", "theta", "trim"],
            Self::Yaw => &["angle", "yaw", "psi", "heading"],
            _ => &["y/position", "position"],
        }
    }

    /// Unit of the position.
    #[must_use]
    pub const fn position_unit(self) -> &'static str {
        if self.is_rotation() { "rad" } else { "m" }
    }
}
