//! Arrays from files, constants from outside, measurements: what each becomes, and what is wrong with it.

use crate::model_support::Files;
use ntg_compiler::diagnostic::Code;
use ntg_compiler::model::Given;
use ntg_compiler::program::Program;
use ntg_compiler::source::Source;
use ntg_compiler::{compile, compile_with, syntax};
use ntg_structure::{At, Domain, Row, Slot};

const GATES: &str = "# x, y, z in m\n4, 2, 1.5\n8, 0, 3\n\n10, 5, 2 # the high one\n";
const REST: &str = "duration T = 5 [s]; output x [m]: spline(order = 4, intervals = 2);
    minimize integral((x - gate[1, 1])^2) / 1 [m^2*s];";

fn files() -> Files {
    Files(vec![
        ("gates.csv", GATES),
        ("run.csv", "0, 1\n1, 2\n2, 4\n3, 8\n4, 16\n"),
        ("titles.csv", "x, y\n1, 2\n"),
        ("ragged.csv", "1, 2\n3\n"),
        ("empty.csv", "# nothing\n"),
    ])
}

#[track_caller]
fn compiled(items: &str) -> Program {
    with(items, &[])
}

#[track_caller]
fn with(items: &str, given: &[(&str, &str)]) -> Program {
    let source = Source::new("spec.ntg", format!("problem P {{ {items} }}"));
    let given: Vec<Given> =
        given.iter().map(|(name, text)| Given { name: (*name).to_owned(), text: (*text).to_owned() }).collect();
    let compiled = compile_with(&source, &files(), &given);
    compiled.unwrap_or_else(|found| panic!("{}", found.render(&source))).program
}

/// Everything that is wrong: code, message, and the text that it is about.
fn wrong(items: &str, given: &[(&str, &str)]) -> Vec<(Code, String, String)> {
    let source = Source::new("spec.ntg", format!("problem P {{ {items} }}"));
    let given: Vec<Given> =
        given.iter().map(|(name, text)| Given { name: (*name).to_owned(), text: (*text).to_owned() }).collect();
    let found = compile_with(&source, &files(), &given).err().into_iter().flatten();
    found.map(|finding| (finding.code, finding.message.clone(), source.snippet(finding.span))).collect()
}

#[track_caller]
fn only(items: &str, code: Code, message: &str, about: &str) {
    let found = wrong(items, &[]);
    assert_eq!(found, [(code, message.to_owned(), about.to_owned())], "{items}");
}

#[test]
fn a_file_is_as_if_its_rows_were_written() {
    let read = |text: &str| {
        let program = compiled(&format!("{text} {REST}"));
        (program.structure.parameters.clone(), program.kernels)
    };
    let written = read("param gate[3, 3] = ((4, 2, 1.5), (8, 0, 3), (10, 5, 2)) [m];");
    for text in [
        "param gate[3, 3] [m] from \"gates.csv\";",
        "const n = rows(\"gates.csv\"); param gate[n, 3] [m] from \"gates.csv\" columns 1 .. n;",
    ] {
        let found = read(text);
        assert_eq!((&found.0, found.1.len()), (&written.0, written.1.len()), "{text}");
    }
    let column = compiled(&format!(
        "param gate[3, 1] [km] from \"gates.csv\" column 2; const first = 1; param pure from \"gates.csv\" column first; {REST}"
    ));
    let values: Vec<(&[f64], bool)> =
        column.structure.parameters.iter().map(|parameter| (&parameter.value[..], parameter.array)).collect();
    assert_eq!(values, [(&[2000.0, 0.0, 5000.0][..], true), (&[4.0, 8.0, 10.0][..], true)]);
}

#[test]
fn sizes_of_files_are_held_against_what_is_declared() {
    let param = |declared: &str| format!("param gate{declared}; {REST}");
    let size = Code::FileSize;
    only(
        &param("[8, 3] [m] from \"gates.csv\" columns 1 .. 3"),
        size,
        "\"gates.csv\" has 3 rows, `gate` has 8",
        "\"gates.csv\"",
    );
    only(
        &param("[3, 3] [m] from \"gates.csv\" columns 1 .. 2"),
        size,
        "`columns 1 .. 2` of \"gates.csv\" are 2 columns, `gate` has 3",
        "\"gates.csv\"",
    );
    only(&param("[3, 2] [m] from \"gates.csv\""), size, "\"gates.csv\" has 3 columns, `gate` has 2", "\"gates.csv\"");
    let outside = "\"gates.csv\" has 3 columns, not 4";
    only(&param("[3, 1] [m] from \"gates.csv\" column 4"), size, outside, "column 4");
    only(&param("[3, 3] [m] from \"gates.csv\" columns 0 .. 2"), size, "columns are counted from 1", "columns 0 .. 2");
    let list = format!("const far[2] [m] from \"gates.csv\" column 1; param gate[3, 3] [m] from \"gates.csv\"; {REST}");
    only(&list, size, "\"gates.csv\" has 3 rows, `far` has 2", "\"gates.csv\"");
}

#[test]
fn files_that_hold_no_numbers_are_told_of_once() {
    let param = |file: &str| format!("const n = rows(\"{file}\"); param gate[n, 2] [m] from \"{file}\"; {REST}");
    let unreadable = Code::UnreadableTable;
    only(&param("titles.csv"), unreadable, "`titles.csv`, line 1: `x` is not a number", "\"titles.csv\"");
    only(&param("none.csv"), unreadable, "`none.csv` cannot be read: no such file", "\"none.csv\"");
    let ragged = "`ragged.csv`, line 2: this row has 1 numbers, the first one has 2";
    only(&param("ragged.csv"), Code::RaggedTable, ragged, "\"ragged.csv\"");
    only(&param("empty.csv"), Code::RaggedTable, "`empty.csv` holds no rows", "\"empty.csv\"");
}

#[test]
fn what_belongs_to_files_stands_with_files_only() {
    let code = |items: &str| wrong(items, &[]).into_iter().map(|(code, ..)| code).collect::<Vec<_>>();
    assert_eq!(code(&format!("param gate[1, 1] [m] = ((1,),) [m]; {REST}")), [Code::Misplaced]);
    assert_eq!(code(&format!("param gate[3, 3] [m] from \"gates.csv\" column 1 .. 3; {REST}")), [Code::Misplaced]);
    assert_eq!(code(&format!("param gate[3, 1] [m] from \"gates.csv\" columns 1; {REST}")), [Code::Misplaced]);
    assert_eq!(code(&format!("param gate[3, 3] from gates; {REST}")), [Code::Unexpected]);
}

#[test]
fn the_new_words_are_names_elsewhere() {
    let text = "problem P {
        param rows = 1;
        const column = 2;
        param columns[column] = (1, 2);
        let sigma = rows + columns[1];
        fn measure(column) = 2 * column;
        duration T = 5;
        output from: spline(order = 4, intervals = 2);
        variable file in 0 .. 1;
        minimize sigma: integral((from - measure(sigma))^2) + file;
        trajectory { sigma: from <= sigma + 3; }
        measure { sigma: file == sigma sigma sigma; }
    }";
    let source = Source::new("spec.ntg", text);
    let compiled = compile(&source, &files());
    assert!(compiled.is_ok(), "{}", compiled.map_or_else(|found| found.render(&source), |_| String::new()));
}

#[test]
fn a_constant_from_outside_is_as_if_it_were_written() {
    let spec = |n: &str, g: &str| {
        format!(
            "const n = {n}; const twice = 2 * n; const g = {g};
            duration T = 5 [s]; output x [m]: spline(order = 4, intervals = twice);
            param a[n] = 1; let fall = g * T;
            minimize integral((der(x) - fall)^2) * sum(i in 1 .. n, a[i]) / 1 [m^2/s];"
        )
    };
    let plain = |program: Program| (program.structure.phases, program.structure.parameters, program.kernels);
    let nameless = |items: &str, given: &[(&str, &str)]| {
        let mut program = with(items, given);
        program.structure.phases.iter_mut().for_each(|phase| phase.place = Default::default());
        program.kernels.iter_mut().for_each(|kernel| kernel.labels.clear());
        plain(program)
    };
    let written = nameless(&spec("7", "3.5 [m/s^2]"), &[]);
    assert_eq!(nameless(&spec("3", "9.81 [m/s^2]"), &[("n", "7"), ("g", "3.5")]), written);
    assert_eq!(nameless(&spec("3", "9.81 [m/s^2]"), &[("n", "7"), ("g", "350 [cm/s^2]")]), written);
}

#[test]
fn constants_from_outside_that_are_none_are_told_of() {
    let items = "const n = 3; const list[2] = (1, 2); param p = 1 [m]; const g = 9.81 [m/s^2];
        duration T = 5 [s]; output x [m]: spline(order = 4, intervals = n);
        minimize integral((x - p)^2) * g;";
    let told = |name: &str, text: &str| {
        let found = wrong(items, &[(name, text)]);
        let [(code, message, _)] = &found[..] else { panic!("{found:?}") };
        (*code, message.clone())
    };
    let unknown = Code::UnknownName;
    assert_eq!(told("m", "5"), (unknown, "the problem has no constant `m`".to_owned()));
    assert_eq!(told("p", "5"), (unknown, "`p` is a parameter, no constant".to_owned()));
    assert_eq!(told("x", "5"), (unknown, "`x` is an output, no constant".to_owned()));
    let array = "`list` is an array: only numbers can be set where a spec is compiled";
    assert_eq!(told("list", "5"), (Code::NoNumber, array.to_owned()));
    assert_eq!(told("n", "many"), (Code::NotConstant, "`n = many`: `many` is no number".to_owned()));
    assert_eq!(told("n", "1, 2"), (Code::NotConstant, "`n = 1, 2`: 2 numbers are given, but one is needed".to_owned()));
    assert_eq!(told("n", "2.5").0, Code::NotWhole);
    let other = "`g` is an acceleration [m/s^2], but is set to a length [m]";
    assert_eq!(told("g", "3 [m]"), (Code::WrongUnit, other.to_owned()));
    let twice = wrong(
        "const n = rows(\"gates.csv\"); param gate[n, 3] [m] from \"gates.csv\"; duration T = 5 [s];
        output x [m]: spline(order = 4, intervals = 2); minimize integral((x - gate[1, 1])^2);",
        &[("n", "4")],
    );
    assert_eq!(twice.iter().map(|(code, ..)| *code).collect::<Vec<_>>(), [Code::FileSize]);
}

const MEASURED: &str = "const n = rows(\"run.csv\"); const time[n] [s] from \"run.csv\" column 1;
    param seen[n] [m] from \"run.csv\" column 2; param noise = 1 [cm];
    duration T = 4 [s]; output x [m]: spline(order = 4, intervals = 2);";

#[test]
fn measurements_at_the_times_of_a_list_are_one_formula() {
    let program = compiled(&format!(
        "{MEASURED} measure {{ for i in 1 .. n {{ place: at(time[i], x) == seen[i] sigma noise; }} }}"
    ));
    let structure = &program.structure;
    let [group] = &structure.groups[..] else { panic!("{:?}", structure.groups) };
    assert_eq!(
        (&group.domain, &group.rows[..], group.loops.len()),
        (&Domain::Mission, &[Row::Cost { term: 0 }][..], 1)
    );
    let at: Vec<At> = group
        .call
        .slots
        .iter()
        .filter_map(|slot| match slot {
            Slot::Flat { at, .. } => Some(*at),
            _ => None,
        })
        .collect();
    assert_eq!(at, [At::Among { places: 0, index: 0 }]);
    let taus: Vec<f64> = structure.places[0].instants.iter().map(|instant| instant.tau()).collect();
    assert_eq!((structure.places[0].first, taus), (1, vec![0.0, 0.25, 0.5, 0.75, 1.0]));
    assert_eq!((structure.measurements.len(), structure.terms[0].name.as_deref()), (1, Some("place")));
}

#[test]
fn code_does_not_grow_with_the_number_of_measurements() {
    let sizes = |n: usize| {
        let items =
            "const n = 5; duration T = 4 [s]; output x [m]: spline(order = 4, intervals = 2); param y[n] = 1 [m];
            measure { for i in 1 .. n { at(4 [s] * i / n, x^2) == y[i]^2 sigma 1 [m^2]; } }";
        let program = with(items, &[("n", &n.to_string())]);
        (program.kernels.len(), program.structure.groups.len())
    };
    assert_eq!(sizes(5), sizes(500));
}

#[test]
fn members_in_several_phases_are_parted_where_the_phase_changes() {
    let program = compiled(
        "const time[4] = (0.5, 1, 2, 3) [s]; param seen[4] = 1 [m];
        output x [m]: spline(order = 4, intervals = 2);
        phase a { duration = 1.5 [s]; } phase b after a { duration = 1.5 [s]; }
        measure { for i in 1 .. 4 { at(time[i], x) == seen[i] sigma 1 [m]; } }",
    );
    let structure = &program.structure;
    let count: usize = structure
        .measurements
        .iter()
        .map(|m| m.loops.iter().map(|over| (over.last.constant - over.first.constant + 1) as usize).product::<usize>())
        .sum();
    assert_eq!((count, structure.terms.len()), (4, 1));
    let phases: Vec<usize> = structure
        .groups
        .iter()
        .flat_map(|group| &group.call.slots)
        .filter_map(|slot| match slot {
            Slot::Flat { phase, at, .. } if *at != At::Here => Some(phase.phase),
            _ => None,
        })
        .collect();
    assert!(phases.contains(&0) && phases.contains(&1), "{phases:?}");
}

#[test]
fn what_is_no_measurement_is_told_of() {
    let measure = |statement: &str| format!("{MEASURED} measure {{ {statement} }}");
    let code = |statement: &str| wrong(&measure(statement), &[]).into_iter().map(|(code, ..)| code).collect::<Vec<_>>();
    let wrong_measurement = [Code::WrongMeasurement];
    assert_eq!(code("final(x) == 1 [m];"), wrong_measurement);
    assert_eq!(code("final(x) <= 1 [m] sigma 1 [m];"), wrong_measurement);
    assert_eq!(code("final(x) in 1 .. 2 [m] sigma 1 [m];"), wrong_measurement);
    assert_eq!(code("soft(3): final(x) == 1 [m] sigma 1 [m];"), wrong_measurement);
    assert_eq!(code("final(x) == 1 [m] sigma -1 [m];"), wrong_measurement);
    assert_eq!(code("final(x) == 1 [m] sigma 0 [m];"), wrong_measurement);
    assert_eq!(code("final(x) == 1 [m] sigma initial(x);"), wrong_measurement);
    assert_eq!(code("seen[1] == seen[2] sigma 1 [m];"), wrong_measurement);
    assert_eq!(code("final(x) == 1 [m] sigma 1 [s];"), [Code::DimensionMismatch]);
    assert_eq!(code("final(x) == 1 [s] sigma 1 [s];"), [Code::DimensionMismatch]);
    assert_eq!(code("x == 1 [m] sigma 1 [m];"), [Code::VariesAlong]);
    assert_eq!(code("at(9 [s], x) == 1 [m] sigma 1 [m];"), [Code::UnknownPlace]);
    let sigma = format!("{MEASURED} minimize integral(x^2); final {{ x == 1 [m] sigma 1 [m]; }}");
    assert_eq!(wrong(&sigma, &[]).into_iter().map(|(code, ..)| code).collect::<Vec<_>>(), [Code::Misplaced]);
    let senses = format!("{MEASURED} maximize final(x) / 1 [m]; measure {{ final(x) == 1 [m] sigma 1 [m]; }}");
    assert_eq!(wrong(&senses, &[]).into_iter().map(|(code, ..)| code).collect::<Vec<_>>(), [Code::MixedSenses]);
    let terms = format!("{MEASURED} minimize final(x); measure {{ final(x) == 1 [m] sigma 1 [m]; }}");
    assert_eq!(wrong(&terms, &[]).into_iter().map(|(code, ..)| code).collect::<Vec<_>>(), [Code::DimensionMismatch]);
}

#[test]
fn the_layout_of_data_and_measurements() {
    let text = "problem P {
    const n = rows(\"run.csv\");
    const time[n] [s] from \"run.csv\" column 1;
    param seen[n, 2] [m] from \"run.csv\" columns 1 .. 2;

    duration T = 4 [s];
    output x[2] [m]: spline(order = 4, intervals = 2);

    measure {
        for i in 1 .. n {
            place: at(time[i], x) == seen[i] sigma 1 [cm];
            speed: at(time[i], der(x[1]))
                == 2 * (seen[i, 1] - seen[i, 2]) / 1 [s]
                sigma 3 [m/s] + 0.5 * (seen[i, 1] + seen[i, 2]) / 1 [s];
        }
    }
}
";
    let laid = |text: &str| syntax::format(&Source::new("spec.ntg", text)).expect("a spec");
    assert_eq!(laid(text), text);
    let words: Vec<&str> = text.split_whitespace().collect();
    let in_a_row = laid(&words.join(" "));
    assert_eq!(laid(&in_a_row), in_a_row);
}
