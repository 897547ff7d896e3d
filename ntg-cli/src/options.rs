//! What the library's settings are called on the command line.
//!
//! Takes text in which settings stand between backticks, `max_iterations`; gives the same text with the options that set
//! them, `--max-iterations`.

use std::time::Duration;

use ntg_runtime::multistart::MultiReport;
use ntg_runtime::report::Report;
use ntg_runtime::settings::InvalidSetting;

/// Settings and their options.
const OPTIONS: [(&str, &str); 9] = [
    ("max_iterations", "--max-iterations"),
    ("time_limit", "--time-limit"),
    ("tolerance", "--tolerance"),
    ("scales", "--scale"),
    ("refine", "--refine"),
    ("between", "--between refine"),
    ("between_tolerance", "--between-tolerance"),
    ("method", "--method"),
    ("starts", "--starts"),
];

/// The text with options in the place of settings.
pub(crate) fn worded(text: &str) -> String {
    OPTIONS
        .iter()
        .fold(text.to_owned(), |text, (setting, option)| text.replace(&format!("`{setting}`"), &format!("`{option}`")))
}

/// The report with advice for the command line.
pub(crate) fn in_options(mut report: Report) -> Report {
    report.advice = worded(&report.advice);
    report
}

/// The same for every minimum of many starts.
pub(crate) fn all_in_options(mut found: MultiReport) -> MultiReport {
    let reports = found.minima.iter_mut().map(|minimum| &mut minimum.report).chain(found.nearest.as_deref_mut());
    reports.for_each(|report| report.advice = worded(&report.advice));
    found
}

/// What is wrong with an option.
pub(crate) fn invalid(error: &InvalidSetting) -> String {
    let option = OPTIONS.iter().find(|(setting, _)| *setting == error.field).map(|(_, option)| *option);
    option.map_or_else(|| error.to_string(), |option| format!("{option}: {}", error.message))
}

/// The limit that `--time-limit` sets.
pub(crate) fn time_limit(seconds: f64) -> Result<Duration, String> {
    let longest = Duration::MAX.as_secs_f64();
    Duration::try_from_secs_f64(seconds).map_err(|_| match seconds >= longest {
        true => {
            format!("--time-limit {seconds:e}: at most {longest:.1e} seconds; without the option there is no limit")
        }
        false => format!("--time-limit {seconds}: a positive number of seconds"),
    })
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;
    use ntg_runtime::status::Status;

    use super::*;
    use crate::arguments::Ntg;

    #[test]
    fn advice_names_options_that_solve_has_and_no_setting() {
        let solve = Ntg::command().find_subcommand("solve").expect("the command").clone();
        let known: Vec<String> = solve.get_arguments().filter_map(|a| a.get_long()).map(|o| format!("--{o}")).collect();
        for status in [
            Status::Acceptable,
            Status::Stationary,
            Status::ViolatedBetween { constraints: vec![] },
            Status::Infeasible { rows: vec![] },
            Status::IterationLimit,
            Status::TimeLimit,
            Status::Cancelled,
            Status::StepTooSmall,
            Status::Unbounded,
            Status::Contradiction { bounds: vec![] },
            Status::SubproblemFailed,
        ] {
            let advice = worded(status.advice());
            for option in advice.split('`').skip(1).step_by(2) {
                let name = option.split(' ').next().unwrap_or_default();
                assert!(known.iter().any(|known| known == name), "`{option}` of: {advice}");
            }
        }
        assert!(worded(Status::IterationLimit.advice()).contains("`--max-iterations`"));
    }
}
