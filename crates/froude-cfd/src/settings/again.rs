//! Settings that are computed again: from the inflow, on a finer mesh, on the grids of a family, in another domain.
//!
//! Such a case is named by the one that it repeats and a suffix: `H4LT-u0.3-a90-finer2`. It enters no fit. `-cold` says what is left of where a case starts from, the others what its mesh and its domain do to it.
//!
//! | suffix | computed |
//! | --- | --- |
//! | `-cold` | from the inflow instead of another case's fields |
//! | `-fine` | on the finer mesh that corrects the campaign's |
//! | `-coarser`, `-finer`, `-finer2`, … | on the grid 1 below the campaign's in a family by √2, and 1, 2, … above it |
//! | `-r6` | in a domain of 6 lengths of the body |

/// How a setting is computed again.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Again {
    /// From the inflow.
    Cold,
    /// On the finer mesh.
    Fine,
    /// On the grid of a family that is so many steps of √2 finer than the campaign's; −1 is the coarser one.
    Grid(i32),
    /// In a domain of another radius, in lengths of the body.
    Domain(f64),
}

impl Again {
    /// What its name ends with.
    #[must_use]
    pub fn suffix(self) -> String {
        match self {
            Self::Cold => "cold".to_owned(),
            Self::Fine => "fine".to_owned(),
            Self::Grid(..=-1) => "coarser".to_owned(),
            Self::Grid(0 | 1) => "finer".to_owned(),
            Self::Grid(level) => format!("finer{level}"),
            Self::Domain(radius) => format!("r{radius}"),
        }
    }

    /// The case that one of this name repeats, and how; `None` of a case that repeats none.
    #[must_use]
    pub fn of(id: &str) -> Option<(&str, Self)> {
        let (first, suffix) = id.rsplit_once('-')?;
        let again = match suffix {
            "cold" => Self::Cold,
            "fine" => Self::Fine,
            "coarser" => Self::Grid(-1),
            "finer" => Self::Grid(1),
            _ => match (suffix.strip_prefix("finer"), suffix.strip_prefix('r')) {
                (Some(level), _) => Self::Grid(level.parse().ok().filter(|level| *level > 1)?),
                (None, Some(radius)) => Self::Domain(radius.parse().ok().filter(|r: &f64| r.is_finite())?),
                (None, None) => return None,
            },
        };
        Some((first, again))
    }

    /// Linear refinement over the mesh of the campaign where it is one of a family \[-\].
    #[must_use]
    pub fn refinement(self) -> f64 {
        match self {
            Self::Grid(level) => core::f64::consts::SQRT_2.powi(level),
            Self::Cold | Self::Fine | Self::Domain(_) => 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_says_what_is_repeated_and_how() {
        for again in [
            Again::Cold,
            Again::Fine,
            Again::Grid(-1),
            Again::Grid(1),
            Again::Grid(3),
            Again::Domain(6.0),
            Again::Domain(12.5),
        ] {
            let id = format!("H4LT-u0.3-a90-laminar-{}", again.suffix());
            assert_eq!(Again::of(&id), Some(("H4LT-u0.3-a90-laminar", again)), "{id}");
        }
        for id in ["H4LT-u0.3-a90", "body-u0.3-a-90", "H4LT-u0.3-a0-laminar", "x-rough", "x-finer1", "x", "x-finerer"] {
            assert_eq!(Again::of(id), None, "{id}");
        }
    }
}
