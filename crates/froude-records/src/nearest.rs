//! The known name that a misspelt one was probably meant to be.

/// Nearest of `known` to `name`, when it is near enough to be worth saying.
///
/// Near enough: the same but for capitals, or at most one edit (insertion,
/// deletion, replacement, swap of neighbours) for every three letters, one at least.
#[must_use]
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    const LONGEST: usize = 64;
    let letters: Vec<char> = name.chars().take(LONGEST + 1).collect();
    if letters.is_empty() || letters.len() > LONGEST {
        return None;
    }
    known
        .into_iter()
        .filter(|candidate| candidate.len() <= LONGEST)
        .map(|candidate| {
            let distance = if candidate.eq_ignore_ascii_case(name) {
                0
            } else {
                edits(&letters, &candidate.chars().collect::<Vec<_>>())
            };
            (distance, candidate)
        })
        .min_by_key(|(distance, _)| *distance)
        .filter(|(distance, candidate)| {
            let longest = letters.len().max(candidate.len());
            *distance <= (longest / 3).max(1) && *distance < letters.len().max(2)
        })
        .map(|(_, candidate)| candidate)
}

/// Edits from `a` to `b` (optimal string alignment).
fn edits(a: &[char], b: &[char]) -> usize {
    let mut before_last: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let replaced = last[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut best = replaced.min(last[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(before_last[j - 2] + 1);
            }
            row.push(best);
        }
        before_last = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}

/// `; did you mean …?` or the list of known names, for the end of a message.
#[must_use]
pub fn suggestion<'a>(name: &str, known: impl IntoIterator<Item = &'a str> + Clone) -> String {
    if let Some(near) = nearest(name, known.clone()) {
        return format!("did you mean `{near}`?");
    }
    let names: Vec<&str> = known.into_iter().collect();
    format!("known: {}", names.join(", "))
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
    }
}
