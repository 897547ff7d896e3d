//! Words that have as much room as there is: what is longer loses its middle, so that a unit or an index stays at its end.

/// Widths of a letter, in parts of the size of its font. SVG does not know the font; these are above the mean of DejaVu Sans, which is
/// a wide one.
const LETTER: f64 = 0.5;
const BOLD: f64 = 0.6;

/// What stands in the place of what is left out.
const LEFT_OUT: &str = "...";

/// How many units of the drawing a text takes.
pub(super) fn width(text: &str, size: u32) -> u32 {
    (LETTER * f64::from(size) * text.chars().count() as f64).ceil() as u32
}

/// The text, or as much of its beginning and of its end as there is room for.
pub(super) fn fitted(text: &str, size: u32, room: u32) -> String {
    cut(text, (f64::from(room) / (LETTER * f64::from(size))) as usize)
}

/// The same of bold letters.
pub(super) fn fitted_bold(text: &str, size: u32, room: u32) -> String {
    cut(text, (f64::from(room) / (BOLD * f64::from(size))) as usize)
}

/// At most so many letters; two thirds of what is kept are of the beginning.
fn cut(text: &str, most: usize) -> String {
    let letters: Vec<char> = text.chars().collect();
    if letters.len() <= most {
        return text.to_owned();
    }
    let kept = most.saturating_sub(LEFT_OUT.len());
    let end = kept / 3;
    let (first, last) = (&letters[..kept - end], &letters[letters.len() - end..]);
    first.iter().chain(&LEFT_OUT.chars().collect::<Vec<_>>()).chain(last).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_too_long_keeps_its_beginning_and_its_end() {
        assert_eq!(cut("speed [m/s]", 11), "speed [m/s]");
        assert_eq!(cut("speed over the ground [m/s]", 18), "speed over...[m/s]");
        assert_eq!([cut("ẋẏż", 3), cut("ẋẏżẋẏ", 4), cut("abcde", 0)], ["ẋẏż", "ẋ...", "..."]);
        assert_eq!((width("abcd", 200), fitted("abcdefgh", 200, 400)), (400, "a...".to_owned()));
        assert_eq!(fitted_bold("abcdefgh", 200, 960), "abcdefgh");
    }
}
