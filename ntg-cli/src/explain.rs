//! `ntg explain`: the manual's entry of a code.

use ntg_compiler::diagnostic::Code;

use crate::printer::Printer;
use crate::{Exit, arguments};

pub(crate) fn run(arguments: &arguments::Explain, printer: &Printer) -> Exit {
    let Some(wanted) = &arguments.code else {
        for code in Code::ALL {
            printer.line(&format!("{code}  {}", code.title()));
        }
        return Exit::Done;
    };
    // As a message shows it, `error[E042]`, or carelessly written, `e42`.
    let letters: String = wanted.chars().filter(char::is_ascii_alphanumeric).collect();
    let letters = letters.to_uppercase().replace("ERROR", "").replace("NOTE", "");
    let is_wanted = |code: &&Code| {
        let (kind, number) = code.text().split_at(1);
        // A bare number is an error's.
        let digits = letters.strip_prefix(kind).or((kind == "E").then_some(letters.as_str()));
        digits.and_then(|digits| digits.parse().ok()) == number.parse::<u32>().ok()
    };
    match Code::ALL.iter().find(is_wanted) {
        Some(code) => {
            printer.line(code.manual());
            Exit::Done
        }
        None => {
            tell!("error: there is no code `{wanted}`; `ntg explain` lists all of them");
            Exit::Bad
        }
    }
}
