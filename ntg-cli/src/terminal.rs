//! Text for the width of a terminal: sentences folded between words, tables cut between columns.
//!
//! Takes lines and a width; gives lines that are no wider, but for words that are. Where output is no terminal there is no
//! width, and nothing is folded: programs read lines.

use console::Term;

/// Narrower than this nothing can be laid out, and the terminal may break lines as it likes.
const LEAST: usize = 20;
/// A label with its value behind it, `  iterations  17`, is at most so wide.
const LABEL: usize = 16;

/// How wide standard output is; none where it is no terminal.
pub(crate) fn width() -> Option<usize> {
    of(&Term::stdout())
}

/// How wide standard error is; none where it is no terminal.
pub(crate) fn width_of_errors() -> Option<usize> {
    of(&Term::stderr())
}

fn of(term: &Term) -> Option<usize> {
    let columns = term.is_term().then(|| term.size_checked()).flatten()?.1;
    Some(usize::from(columns)).filter(|columns| *columns >= LEAST)
}

/// Every line of a text, folded between words; what goes on stands deeper than where it began.
pub(crate) fn folded(text: &str, width: Option<usize>) -> String {
    let Some(width) = width else { return text.to_owned() };
    text.split('\n').map(|line| line_folded(line, width)).collect::<Vec<_>>().join("\n")
}

fn line_folded(line: &str, width: usize) -> String {
    if chars(line) <= width {
        return line.to_owned();
    }
    let deeper = " ".repeat(hang(line).min(width / 2));
    let mut lines: Vec<String> = vec![];
    let mut now = String::new();
    for word in words(line) {
        if !now.trim().is_empty() && chars(&now) + chars(word.trim_end()) > width {
            lines.push(now.trim_end().to_owned());
            now.clone_from(&deeper);
            now.push_str(word.trim_start());
        } else {
            now.push_str(word);
        }
    }
    lines.push(now.trim_end().to_owned());
    lines.join("\n")
}

/// Words, each with the white space behind it; white space in front is a word.
fn words(line: &str) -> impl Iterator<Item = &str> {
    let mut rest = line;
    std::iter::from_fn(move || {
        let letters = rest.find(' ').unwrap_or(rest.len());
        let spaces = rest[letters..].find(|c| c != ' ').unwrap_or(rest.len() - letters);
        let (word, behind) = rest.split_at(letters + spaces);
        rest = behind;
        (!word.is_empty()).then_some(word)
    })
}

/// Where a line goes on: beneath the value behind its label, else a little deeper than where it begins.
fn hang(line: &str) -> usize {
    let indent = chars(line) - chars(line.trim_start());
    let value = line.trim_start().find("  ").map(|end| {
        let behind = &line.trim_start()[end..];
        indent + chars(&line.trim_start()[..end]) + chars(behind) - chars(behind.trim_start())
    });
    value.filter(|value| indent > 0 && *value <= LABEL).unwrap_or(indent + 2)
}

fn chars(text: &str) -> usize {
    text.chars().count()
}

/// Columns side by side, right-aligned; those that do not fit follow beneath, each time with the first one before them.
pub(crate) fn table(columns: &[Vec<String>], width: Option<usize>) -> Vec<String> {
    let wide: Vec<usize> = columns.iter().map(|own| own.iter().map(|cell| chars(cell)).max().unwrap_or(0)).collect();
    let Some(first) = columns.first() else { return vec![] };
    let mut lines = vec![];
    let mut next = 1;
    loop {
        let from = next;
        let mut used = wide[0];
        while next < columns.len() && (next == from || width.is_none_or(|width| used + 1 + wide[next] <= width)) {
            used += 1 + wide[next];
            next += 1;
        }
        if from > 1 {
            lines.push(String::new());
        }
        for row in 0..first.len() {
            let shown = std::iter::once(0).chain(from..next);
            let cells = shown.map(|k| format!("{:>w$}", columns[k].get(row).map_or("", String::as_str), w = wide[k]));
            lines.push(cells.collect::<Vec<_>>().join(" "));
        }
        if next >= columns.len() {
            return lines;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_folded_between_words_beneath_what_they_began_with() {
        let said = "P: solved\n  violation   3.4e-9 at the points, 7.0e-9 between them (relative)\n  warning: `low` is violated between the points by 0.04 at t = 5 s";
        let expected = "P: solved
  violation   3.4e-9 at the points,
              7.0e-9 between them
              (relative)
  warning: `low` is violated between the
    points by 0.04 at t = 5 s";
        assert_eq!(folded(said, Some(40)), expected);
        assert_eq!(folded(said, None), said);
        assert_eq!(folded("a_word_that_is_wider_than_all", Some(20)), "a_word_that_is_wider_than_all");
        assert_eq!(folded("", Some(20)), "");
    }

    #[test]
    fn columns_that_do_not_fit_follow_with_the_first_before_them() {
        let column = |cells: [&str; 2]| cells.map(str::to_owned).to_vec();
        let columns = [column(["t", "0.5"]), column(["left", "1"]), column(["right", "22"]), column(["up", "3"])];
        assert_eq!(
            table(&columns, Some(9)),
            ["  t left", "0.5    1", "", "  t right", "0.5    22", "", "  t up", "0.5  3"]
        );
        assert_eq!(table(&columns, Some(14)), ["  t left right", "0.5    1    22", "", "  t up", "0.5  3"]);
        assert_eq!(table(&columns, None), ["  t left right up", "0.5    1    22  3"]);
        assert_eq!(table(&columns[..1], Some(9)), ["  t", "0.5"]);
        // A column that is too wide by itself is shown.
        assert_eq!(table(&columns[..2], Some(3)), ["  t left", "0.5    1"]);
    }
}
