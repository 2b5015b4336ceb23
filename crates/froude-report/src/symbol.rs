//! Names of coefficients and loads as symbols: `C_d_II` is C with a subscript d
//! and a superscript II.
//!
//! The name in the files stays the truth: tables print it beside the symbol. A
//! name that is not built of ASCII letters, digits and underscores is left as it is.

/// How a run of text is set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Style {
    Upright,
    Bold,
    Italic,
    Subscript,
    Superscript,
}

/// Text in runs of one style each.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Rich {
    pub(crate) runs: Vec<(Style, String)>,
}

impl Rich {
    /// Upright text.
    pub(crate) fn plain(text: &str) -> Self {
        Self::styled(Style::Upright, text)
    }

    /// Text in one style.
    pub(crate) fn styled(style: Style, text: &str) -> Self {
        Self { runs: vec![(style, text.to_owned())] }
    }

    /// The same, followed by more.
    pub(crate) fn then(mut self, more: Self) -> Self {
        self.runs.extend(more.runs);
        self
    }

    /// The same, followed by upright text.
    pub(crate) fn and(self, text: &str) -> Self {
        self.then(Self::plain(text))
    }
}

/// Greek letters that stand as whole words in names.
fn greek(word: &str) -> Option<&'static str> {
    Some(match word {
        "alpha" => "α",
        "beta" => "β",
        "delta" => "δ",
        "epsilon" => "ε",
        "eta" => "η",
        "theta" => "θ",
        "lambda" => "λ",
        "mu" => "μ",
        "nu" => "ν",
        "rho" => "ρ",
        "sigma" => "σ",
        "omega" => "ω",
        _ => return None,
    })
}

/// The symbol of a name.
pub(crate) fn symbol(name: &str) -> Rich {
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let is_simple = !name.is_empty() && name.len() <= 24 && name.chars().all(is_word);
    if !is_simple || !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        return Rich::plain(name);
    }
    let mut parts: Vec<&str> = name.split('_').collect();
    if parts.iter().any(|p| p.is_empty()) {
        return Rich::plain(name);
    }
    let mut head = parts.remove(0);
    let mut lower: Vec<&str> = Vec::new();
    // A11 is an A with the subscript 11.
    if parts.is_empty() && head.len() > 1 && head[1..].chars().all(|c| c.is_ascii_digit()) {
        lower.push(&head[1..]);
        head = &head[..1];
    }
    let upper = match parts.last() {
        Some(&last @ ("I" | "II" | "III")) => {
            parts.pop();
            Some(last)
        }
        _ => None,
    };
    lower.extend(parts);
    let head = match greek(head) {
        Some(letter) => Rich::styled(Style::Italic, letter),
        None if head.len() == 1 => Rich::styled(Style::Italic, head),
        None => Rich::plain(head),
    };
    let mut out = head;
    if !lower.is_empty() {
        out = out.then(Rich::styled(Style::Subscript, &lower.join(",")));
    }
    if let Some(upper) = upper {
        out = out.then(Rich::styled(Style::Superscript, upper));
    }
    out
}

/// A symbol with its unit in brackets: `f_x [N]`; a pure number stands alone.
pub(crate) fn symbol_and_unit(name: &str, unit: &str) -> Rich {
    let symbol = symbol(name);
    if unit.is_empty() { symbol } else { symbol.and(&format!(" [{}]", unit_text(unit))) }
}

/// A unit as in print: `kg/m^3` is `kg/m³`, `N s^2/m^2` is `N s²/m²`, `1` stays `1`.
pub(crate) fn unit_text(unit: &str) -> String {
    let mut out = String::with_capacity(unit.len());
    let mut rest = unit.chars().peekable();
    while let Some(c) = rest.next() {
        let next = rest.peek().copied();
        if c == '^' && next.is_some_and(|n| n == '-' || n.is_ascii_digit()) {
            if next == Some('-') {
                rest.next();
                out.push('⁻');
            }
            while let Some(digit) = rest.peek().and_then(|d| d.to_digit(10)) {
                out.push(['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][digit as usize]);
                rest.next();
            }
        } else if c == '*' {
            out.push(' ');
        } else {
            out.push(c);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(name: &str) -> String {
        symbol(name)
            .runs
            .iter()
            .map(|(style, text)| match style {
                Style::Subscript => format!("_{{{text}}}"),
                Style::Superscript => format!("^{{{text}}}"),
                _ => text.clone(),
            })
            .collect()
    }

    #[test]
    fn names_become_symbols_and_strange_names_stay() {
        assert_eq!(flat("C_d_II"), "C_{d}^{II}");
        assert_eq!(flat("C_fHT_I"), "C_{fHT}^{I}");
        assert_eq!(flat("C_f"), "C_{f}");
        assert_eq!(flat("A11"), "A_{11}");
        assert_eq!(flat("mu_n"), "μ_{n}");
        assert_eq!(flat("J_eff"), "J_{eff}");
        assert_eq!(flat("k"), "k");
        for strange in ["<b>", "_", "a__b", "", "1st", "Ünit", "C d"] {
            assert_eq!(flat(strange), strange);
        }
    }

    #[test]
    fn units_get_real_exponents() {
        assert_eq!(unit_text("kg/m^3"), "kg/m³");
        assert_eq!(unit_text("N*s^2/m^2"), "N s²/m²");
        assert_eq!(unit_text("m^-1"), "m⁻¹");
        assert_eq!(unit_text("^"), "^");
    }
}
