//! The words of the language: which are reserved, which begin a declaration, which is nearest.
//!
//! `grammar.pest` holds the same list once more, because a grammar cannot ask; a test compares them.

/// Words that begin a declaration and never an expression.
pub const ITEM_WORDS: &[&str] = &[
    "agent",
    "collocation",
    "const",
    "continuation",
    "continuous",
    "fn",
    "guess",
    "let",
    "maximize",
    "minimize",
    "output",
    "param",
    "phase",
    "problem",
    "table",
    "temporal",
    "trajectory",
    "variable",
];

/// Words with a meaning in expressions, some of which also begin a declaration.
pub const EXPRESSION_WORDS: &[&str] = &[
    "der", "duration", "end", "final", "for", "if", "in", "initial", "integral", "partial", "pi", "prod", "start",
    "sum", "t", "tau",
];

/// Words that Rust refuses as names even in their raw form.
pub(crate) const NEVER_NAMES: &[&str] = &["Self", "crate", "self", "super"];

/// Words that begin a declaration though they are reserved for expressions, or not at all.
pub const OTHER_ITEM_WORDS: &[&str] = &[
    "at", "domain", "duration", "dynamics", "final", "initial", "input", "jump", "measure", "periodic", "scenario",
    "shared", "start", "state",
];

/// Whether no name may be so.
pub(crate) fn is_reserved(word: &str) -> bool {
    [ITEM_WORDS, EXPRESSION_WORDS].iter().any(|words| words.contains(&word))
}

/// The word that begins a declaration and is most like `word`, if any is.
pub(crate) fn nearest_item_word(word: &str) -> Option<&'static str> {
    nearest(word, ITEM_WORDS.iter().chain(OTHER_ITEM_WORDS).copied())
}

/// The candidate that is most like `word`, if one can be reached by changing at most a third of
/// its letters; the first one among equals.
pub(crate) fn nearest<'a>(word: &str, candidates: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    // A word so long is no slip of the pen, and the distance costs the product of both lengths.
    const LONGEST: usize = 64;
    let length = word.chars().count();
    if length > LONGEST {
        return None;
    }
    let near = candidates.map(|candidate| (distance(word, candidate), candidate));
    let near = near.filter(|(far, candidate)| *far <= (length.max(candidate.chars().count()) / 3).max(1));
    near.filter(|(far, _)| *far < length).min_by_key(|(far, _)| *far).map(|(_, candidate)| candidate)
}

/// How many letters must be inserted, removed or changed to turn one word into the other
/// (Levenshtein's distance), a capital counting as its small letter.
fn distance(a: &str, b: &str) -> usize {
    let letters = |word: &str| word.to_lowercase().chars().collect::<Vec<_>>();
    let (a, b) = (letters(a), letters(b));
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.iter().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let change = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = change.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_counts_single_letters() {
        assert_eq!(distance("kitten", "sitting"), 3);
        assert_eq!(distance("", "abc"), 3);
        assert_eq!(distance("Let", "let"), 0);
    }

    #[test]
    fn slips_find_their_word_and_others_find_none() {
        assert_eq!(nearest_item_word("trajctory"), Some("trajectory"));
        assert_eq!(nearest_item_word("maximise"), Some("maximize"));
        assert_eq!(nearest_item_word("velocity"), None);
        assert_eq!(nearest_item_word(&"x".repeat(100_000)), None);
    }

    #[test]
    fn the_grammar_reserves_the_same_words_and_of_two_that_begin_alike_the_longer_first() {
        let grammar = include_str!("grammar.pest");
        let rule = grammar
            .split_once("reserved = @{")
            .and_then(|(_, rest)| rest.split_once('}'))
            .expect("the rule is there")
            .0;
        let mut reserved: Vec<String> = Vec::new();
        for group in rule.lines().filter(|line| line.contains('"')) {
            let (first, rests) = group.split_once('~').expect("a letter and what may follow");
            let first = first.split('"').nth(1).expect("a letter");
            let rests: Vec<&str> = rests.split('"').skip(1).step_by(2).collect();
            let hidden = |k: usize| rests[..k].iter().any(|before| rests[k].starts_with(before));
            assert!(!(0..rests.len()).any(hidden), "{group}");
            reserved.extend(rests.iter().map(|rest| format!("{first}{rest}")));
            // With a question mark the letter is a word itself.
            reserved.extend(group.contains(")?").then(|| first.to_owned()));
        }
        let mut words: Vec<&str> =
            [ITEM_WORDS, EXPRESSION_WORDS].iter().flat_map(|list| list.iter()).copied().collect();
        reserved.sort_unstable();
        words.sort_unstable();
        assert_eq!(reserved, words);
    }

    #[test]
    fn the_lists_are_sorted_and_do_not_overlap() {
        let all: Vec<&str> =
            [ITEM_WORDS, EXPRESSION_WORDS, NEVER_NAMES].iter().flat_map(|list| list.iter()).copied().collect();
        let mut sorted = all.clone();
        sorted.sort_unstable();
        sorted.dedup();
        assert_eq!(sorted.len(), all.len());
        assert!([ITEM_WORDS, EXPRESSION_WORDS].iter().all(|list| list.is_sorted()));
    }
}
