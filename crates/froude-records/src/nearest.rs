//! The known name that a misspelt one was probably meant to be.

/// Nearest of `known` to `name`, when it is near enough to be worth saying.
///
/// Near enough: the same but for capitals, or at most one edit (insertion,
/// deletion, replacement, swap of neighbours) for every three letters, one at least.
#[must_use]
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    all_nearest(name, known).first().copied()
}

/// Every one of `known` that is as near as the nearest, in their order.
fn all_nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    const LONGEST: usize = 64;
    let letters = name.chars().take(LONGEST + 1).count();
    if letters == 0 || letters > LONGEST {
        return Vec::new();
    }
    let near: Vec<(usize, &str)> = known
        .into_iter()
        .filter(|candidate| candidate.len() <= LONGEST)
        .map(|candidate| {
            let is_same = candidate.eq_ignore_ascii_case(name);
            (if is_same { 0 } else { strsim::osa_distance(name, candidate) }, candidate)
        })
        .filter(|(distance, candidate)| {
            let longest = letters.max(candidate.len());
            *distance <= (longest / 3).max(1) && *distance < letters.max(2)
        })
        .collect();
    let least = near.iter().map(|(distance, _)| *distance).min();
    near.into_iter().filter(|(distance, _)| Some(*distance) == least).map(|(_, candidate)| candidate).collect()
}

/// `did you mean …?` or the list of known names, for the end of a message.
#[must_use]
pub fn suggestion<'a>(name: &str, known: impl IntoIterator<Item = &'a str> + Clone) -> String {
    if let Some(meant) = meant(name, known.clone()) {
        return meant;
    }
    let names: Vec<&str> = known.into_iter().collect();
    format!("known: {}", names.join(", "))
}

/// `did you mean …?` for one name that is near enough, or two that are equally near; nothing where more are.
#[must_use]
pub fn meant<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    match all_nearest(name, known).as_slice() {
        [only] => Some(format!("did you mean `{only}`?")),
        [one, other] => Some(format!("did you mean `{one}` or `{other}`?")),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_of_the_finger_is_understood_and_nonsense_is_not() {
        let known = ["speed", "angle", "f_x", "f_y", "configuration"];
        assert_eq!(nearest("sped", known), Some("speed"));
        assert_eq!(nearest("Speed", known), Some("speed"));
        assert_eq!(nearest("agnle", known), Some("angle"));
        assert_eq!(nearest("fx", known), Some("f_x"));
        assert_eq!(nearest("configuraton", known), Some("configuration"));
        assert_eq!(nearest("temperature", known), None);
        assert_eq!(nearest("", known), None);
        assert_eq!(nearest(&"x".repeat(1000), known), None);
        assert_eq!(suggestion("sped", known), "did you mean `speed`?");
        assert_eq!(suggestion("f_z", known), "did you mean `f_x` or `f_y`?", "both are one letter away");
        assert_eq!(suggestion("f7", ["f1", "f2", "f3"]), "known: f1, f2, f3", "none is nearer than the others");
    }
}
