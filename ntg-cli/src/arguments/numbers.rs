//! Options that take numbers, negative ones too: what they take is told where they get something else.

use std::any::TypeId;
use std::num::IntErrorKind;
use std::ops::RangeInclusive;

use clap::{Arg, Command, CommandFactory};

use super::Ntg;

/// The command. Where an option takes a number, `-1` is one, and no option that there is not.
pub(crate) fn command() -> Command {
    Ntg::command().mut_subcommands(|command| {
        command.mut_args(|option| {
            let is_number = is_number(&option);
            option.allow_negative_numbers(is_number)
        })
    })
}

/// Whether an option's value is a number.
fn is_number(option: &Arg) -> bool {
    let numbers = [TypeId::of::<u32>(), TypeId::of::<u64>(), TypeId::of::<usize>(), TypeId::of::<f64>()];
    let value = option.get_value_parser().type_id();
    numbers.iter().any(|number| value == *number)
}

/// Reads a whole number within bounds; that it is at most `u64::MAX` is worth no word but to who wants more.
pub(crate) fn whole<T: TryFrom<u64>>(range: RangeInclusive<u64>) -> impl Fn(&str) -> Result<T, String> + Clone {
    move |text| {
        let read = text.parse::<u64>();
        let number = read.as_ref().ok().filter(|number| range.contains(number));
        number.and_then(|number| T::try_from(*number).ok()).ok_or_else(|| {
            let (least, greatest) = (range.start(), range.end());
            let is_beyond = read.is_err_and(|error| *error.kind() == IntErrorKind::PosOverflow);
            match *greatest == u64::MAX && !is_beyond {
                true => format!("a whole number from {least} on"),
                false => format!("a whole number from {least} to {greatest}"),
            }
        })
    }
}

/// Reads a number.
pub(crate) fn number(text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| "a number, such as `0.5` or `1e-6`".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_such_number_is_told_what_would_be_one() {
        let count = whole::<u32>(2..=1_000_000);
        assert_eq!(count("2"), Ok(2));
        for wrong in ["-1", "1", "1.5", "1e3", "x", "", "1000001", "99999999999999999999999"] {
            assert_eq!(count(wrong), Err("a whole number from 2 to 1000000".to_owned()), "{wrong}");
        }
        let any = whole::<usize>(1..=u64::MAX);
        assert_eq!((any("1"), any("0")), (Ok(1), Err("a whole number from 1 on".to_owned())));
        assert_eq!(any("99999999999999999999999"), Err(format!("a whole number from 1 to {}", u64::MAX)));
        assert_eq!((number("-1e-3"), number("x").is_err()), (Ok(-1e-3), true));
    }

    #[test]
    fn every_option_that_takes_a_number_takes_negative_ones() {
        let options = |command: &Command| command.get_arguments().cloned().collect::<Vec<Arg>>();
        let command = command();
        let numbers: Vec<Arg> = command.get_subcommands().flat_map(options).filter(is_number).collect();
        assert!(numbers.len() >= 15, "options of other types have been added or taken away: {}", numbers.len());
        assert!(numbers.iter().all(Arg::is_allow_negative_numbers_set));
    }
}
