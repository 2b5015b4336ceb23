//! Whether two estimates agree, in a sentence.

use froude_records::comparison::Verdict;

use froude_records::number::{fixed, p_equation};

/// A verdict in words, with the numbers that it rests on; without a full stop.
#[must_use]
pub fn verdict_words(v: &Verdict) -> String {
    let load = v.load.as_ref().map(|l| {
        let links = l.n_links.map_or_else(String::new, |n| format!(", {n} links"));
        let at = format!("{} m/s, {}°{links}", fixed(l.speed_m_s, 3), fixed(l.angle_rad.to_degrees(), 1));
        format!("largest E_n of the forces {} ({} at {at})", signed(l.e_n), l.component)
    });
    let coefficient = v
        .coefficient
        .as_ref()
        .map(|c| format!("largest E_n of the coefficients {} ({})", signed(c.e_n), c.coefficient));
    let joint = v.p.map(|p| format!("all coefficients together {}", p_equation(p)));
    let numbers: Vec<String> = [load, coefficient, joint].into_iter().flatten().collect();
    let verdict = if v.agree { "agree within their uncertainties" } else { "differ by more than their uncertainties" };
    format!("{} and {} {verdict}: {}", v.first, v.second, numbers.join("; "))
}

fn signed(e_n: f64) -> String {
    let text = fixed(e_n, 2);
    if e_n > 0.0 { format!("+{text}") } else { text }
}
