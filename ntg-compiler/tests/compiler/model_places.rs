//! Points of time, parts of a trajectory and periods: what each becomes, and where its rows are held.

use crate::model_support::{findings, program};
use ntg_compiler::program::Program;
use ntg_structure::{At, Domain, Instant, Part, Row, Slot};

/// Holds two specs with common declarations against each other; names that no text has are left out.
#[track_caller]
fn same(common: &str, short: &str, long: &str) {
    let nameless = |text: &str| {
        let mut program = program(&format!("problem P {{ {common} {text} }}"));
        program.structure.constraints.iter_mut().for_each(|constraint| constraint.name = None);
        program
    };
    let (short, long) = (nameless(short), nameless(long));
    assert_eq!(short.structure, long.structure);
    assert_eq!(short.kernels, long.kernels);
}

/// The parts of the trajectory for which constraints are held, by phase, each once.
fn parts(program: &Program) -> Vec<(usize, f64, f64)> {
    let mut found: Vec<(usize, f64, f64)> = vec![];
    for group in &program.structure.groups {
        let holds = group.rows.iter().any(|row| matches!(row, Row::Constraint { .. }));
        let Domain::Path { phase, part, .. } = &group.domain else { continue };
        let place = (phase.phase, part.from.tau(), part.to.tau());
        if holds && !found.contains(&place) {
            found.push(place);
        }
    }
    found.sort_by_key(|(phase, ..)| *phase);
    found
}

/// The places of outputs that are used at a fixed time, with their phases.
fn places(program: &Program) -> Vec<(usize, At)> {
    let slots = program.structure.groups.iter().flat_map(|group| &group.call.slots);
    let at = |slot: &Slot| match slot {
        Slot::Flat { phase, at, .. } if *at != At::Here => Some((phase.phase, *at)),
        _ => None,
    };
    slots.filter_map(at).collect()
}

fn inside(tau: f64) -> At {
    At::Inside(Instant::new(tau))
}

const FREE: &str = "duration T in 1 .. 5 [s]; output x, y [m]: spline(order = 5, intervals = 4); \
    output r[3] [m]: spline(order = 6, intervals = 4); minimize integral(der(x, 2)^2);";

const FIXED: &str = "duration T = 5 [s]; output x, y [m]: spline(order = 5, intervals = 4); \
    minimize integral(der(x, 2)^2);";

#[test]
fn a_block_at_a_time_is_temporal_with_values_at_that_time() {
    same(
        FREE,
        "at 0.4 * T { x == 3 [m];  limit: der(y) in 1 .. 2 [m/s]; }",
        "temporal { at(0.4 * T, x) == 3 [m];  limit: at(0.4 * T, der(y)) in 1 .. 2 [m/s]; }",
    );
    same(
        FIXED,
        "at 2 [s] { x^2 + y * x == 3 [m^2]; }",
        "temporal { at(0.4 * T, x)^2 + at(T / 2.5, y) * at(2 [s], x) == 3 [m^2]; }",
    );
    same(FREE, "at T / 2 { r == (1, 2, 3) [m]; }", "temporal { at(T / 2, r) == (1, 2, 3) [m]; }");
    same(FREE, "at T / 2 { r == 0; }", "temporal { for k in 1 .. 3 { at(0.5 * T, r[k]) == 0; } }");
}

#[test]
fn ends_are_initial_and_final_values() {
    same(FREE, "at 0 * T { x == 1 [m]; }", "temporal { initial(x) == 1 [m]; }");
    same(FREE, "at T { x == 1 [m]; }", "temporal { final(x) == 1 [m]; }");
    same(FIXED, "at 5 [s] { der(x) == 1 [m/s]; }", "temporal { final(der(x)) == 1 [m/s]; }");
}

#[test]
fn times_inside_expressions_are_those_of_the_place() {
    same(FIXED, "at 2 [s] { x == tau * 1 [m]; }", "temporal { at(2 [s], x) == 0.4 [m]; }");
    same(FREE, "at 0.4 * T { x == 1 [m/s] * t; }", "temporal { at(0.4 * T, x) == 0.4 * T * 1 [m/s]; }");
}

#[test]
fn a_clock_that_begins_later_counts_from_its_start() {
    let text = "problem P { start = 10 [s]; duration T = 4 [s]; output x [m]: spline(order = 4, intervals = 2); \
        minimize integral(der(x, 2)^2);  at 11 [s] { x == 1 [m]; }  initial { x == 0; } }";
    assert_eq!(places(&program(text)), [(0, inside(0.25))]);
}

const PHASES: &str = "output x [m]: spline(order = 5, intervals = 4, smoothness = 3); minimize integral(der(x, 2)^2); \
    phase a { duration in 1 .. 2 [s]; } phase b after a { duration T = 4 [s]; } \
    phase leg[i in 1 .. 3] after b { duration in 1 .. 2 [s]; } initial { x == 0; }";

#[test]
fn places_in_phases_are_multiples_of_their_durations_after_their_starts() {
    let at = |time: &str| places(&program(&format!("problem P {{ {PHASES} temporal {{ at({time}, x) <= 1 [m]; }} }}")));
    let only = |time: &str| at(time).into_iter().find(|(_, at)| *at != At::Start && *at != At::End);
    assert_eq!(only("0.5 * duration(a)"), Some((0, inside(0.5))));
    assert_eq!(only("start(b) + 1 [s]"), Some((1, inside(0.25))));
    assert_eq!(only("end(a) + 0.75 * b.T"), Some((1, inside(0.75))));
    assert_eq!(only("start(leg[2]) + duration(leg[2]) / 4"), Some((2, inside(0.25))));
    assert_eq!(only("end(leg[1]) + 0.1 * duration(leg[2])"), Some((2, inside(0.1))));
    // Where phases meet, the later one is meant.
    assert!(at("end(a)").contains(&(1, At::Start)));
    assert!(at("end(leg[3])").contains(&(2, At::End)));
}

#[test]
fn a_block_in_a_phase_is_about_that_phase() {
    let text = PHASES.replace("phase b after a {", "phase b after a { at start(b) + 3 [s] { x == 1 [m]; }");
    assert!(places(&program(&format!("problem P {{ {text} }}"))).contains(&(1, inside(0.75))));
    let family = PHASES.replace("after b {", "after b { at start(leg[i]) + duration(leg[i]) / 2 { x <= i * 1 [m]; }");
    assert!(places(&program(&format!("problem P {{ {family} }}"))).contains(&(2, inside(0.5))));
}

#[test]
fn an_agent_is_named_first() {
    let text = "problem P { agent u[i in 1 .. 2] { duration T in 1 .. 2 [s]; output x [m]: spline(order = 5, intervals = 4); \
        minimize integral(der(x, 2)^2); initial { x == 0; } at 0.25 * T { x == i * 1 [m]; } } \
        temporal { at(u[1], 0.5 * u[1].T, x) == at(u[2], 0.5 * u[2].T, x); } }";
    let found = places(&program(text));
    assert!(found.contains(&(0, inside(0.25))));
    assert_eq!(found.iter().filter(|place| **place == (0, inside(0.5))).count(), 2);
}

/// As [`places`], with those that differ from member to member one by one.
fn member_places(program: &Program) -> Vec<(usize, At)> {
    let all = places(program).into_iter().flat_map(|(phase, at)| match at {
        At::Among { places, .. } => {
            let instants = program.structure.places[places].instants.iter();
            instants.map(|instant| (phase, inside(instant.tau()))).collect()
        }
        other => vec![(phase, other)],
    });
    all.collect()
}

#[test]
fn times_from_a_list_are_places_of_one_formula() {
    let list = "const when[3] = (0.5, 1, 2) [s]; param seen[3] = (1, 2, 3) [m];";
    let of = |text: &str| program(&format!("problem P {{ {FIXED} {list} temporal {{ {text} }} }}"));
    for (short, long) in [
        (
            "for i in 1 .. 3 { at(when[i], x) >= seen[i]; }",
            "at(0.5 [s], x) >= seen[1];  at(1 [s], x) >= seen[2];  at(2 [s], x) >= seen[3];",
        ),
        ("for i in 1 .. 2 { at(i * 1.5 [s], x) >= 1 [m]; }", "at(1.5 [s], x) >= 1 [m];  at(3 [s], x) >= 1 [m];"),
    ] {
        let (short, long) = (of(short), of(long));
        assert_eq!(member_places(&short), member_places(&long));
        let held =
            |program: &Program| program.structure.groups.iter().filter(|group| group.domain == Domain::Mission).count();
        assert_eq!(held(&short), 1);
    }
}

#[test]
fn a_part_of_a_trajectory_has_the_rows_between_two_places() {
    let held = |block: &str| parts(&program(&format!("problem P {{ {FREE} initial {{ x == 0; }} {block} }}")));
    assert_eq!(held("trajectory from 0.4 * T to 0.6 * T { x <= 1 [m]; }"), [(0, 0.4, 0.6)]);
    assert_eq!(held("trajectory from 0.4 * T { x <= 1 [m]; }"), [(0, 0.4, 1.0)]);
    assert_eq!(held("trajectory to T / 4 { x <= 1 [m]; }"), [(0, 0.0, 0.25)]);
    let same_as_whole = "trajectory from 0 * T to T { x <= 1 [m]; }";
    same(FREE, same_as_whole, "trajectory { x <= 1 [m]; }");
}

#[test]
fn a_part_runs_through_the_phases_in_it() {
    let held = |block: &str| parts(&program(&format!("problem P {{ {PHASES} {block} }}")));
    let block = "trajectory from 0.5 * duration(a) to end(leg[1]) + 0.1 * duration(leg[2]) { x <= 1 [m]; }";
    assert_eq!(held(block), [(0, 0.5, 1.0), (1, 0.0, 1.0), (2, 0.0, 1.0), (2, 0.0, 0.1)]);
    assert_eq!(held("trajectory from end(a) to end(b) { x <= 1 [m]; }"), [(1, 0.0, 1.0)]);
    assert_eq!(held("trajectory from start(leg[1]) { x <= 1 [m]; }"), [(2, 0.0, 1.0)]);
    // A whole family stays one group of rows.
    let program = program(&format!("problem P {{ {PHASES} trajectory from end(b) {{ x <= 1 [m]; }} }}"));
    let rows = |group: &ntg_structure::Group| group.rows.iter().any(|row| matches!(row, Row::Constraint { .. }));
    let along = program.structure.groups.iter().filter(|g| rows(g) && matches!(g.domain, Domain::Path { .. }));
    assert!(along.clone().count() > 0 && along.clone().all(|group| group.loops.len() == 1));
}

#[test]
fn an_end_that_is_left_out_is_that_of_the_whole() {
    let open = |block: &str| {
        let program = program(&format!("problem P {{ {PHASES} {block} }}"));
        let mut found: Vec<(usize, bool, bool)> = vec![];
        for group in &program.structure.groups {
            let Domain::Path { phase, part: Part { with_first, with_last, .. }, .. } = &group.domain else { continue };
            if group.rows.iter().any(|row| matches!(row, Row::Constraint { .. }))
                && !found.contains(&(phase.phase, *with_first, *with_last))
            {
                found.push((phase.phase, *with_first, *with_last));
            }
        }
        found.sort_by_key(|(phase, ..)| *phase);
        found
    };
    let all = [(0, true, true), (1, true, true), (2, true, true), (2, true, false)];
    assert_eq!(open("trajectory except final { x <= 1 [m]; }"), all);
    let both = "trajectory except initial, final { x <= 1 [m]; }";
    assert_eq!(open(both), [(0, false, true), (1, true, true), (2, true, true), (2, true, false)]);
}

#[test]
fn what_is_periodic_has_equal_ends_up_to_its_smoothness() {
    same(
        FREE,
        "periodic x, r;",
        "temporal { initial(x) == final(x);  initial(der(x)) == final(der(x));  \
         initial(der(x, 2)) == final(der(x, 2));  initial(der(x, 3)) == final(der(x, 3));  \
         initial(r) == final(r);  initial(der(r)) == final(der(r));  initial(der(r, 2)) == final(der(r, 2));  \
         initial(der(r, 3)) == final(der(r, 3));  initial(der(r, 4)) == final(der(r, 4)); }",
    );
    same(
        FREE,
        "periodic x, r[2] up to 1;",
        "temporal { initial(x) == final(x);  initial(der(x)) == final(der(x));  \
         initial(r[2]) == final(r[2]);  initial(der(r[2])) == final(der(r[2])); }",
    );
    let phases = PHASES.replace("initial { x == 0; }", "");
    same(&phases, "periodic x up to 0;", "temporal { initial(x) == final(x); }");
}

#[test]
fn words_of_places_stay_names() {
    let text = "problem P { duration T = 1; let at = 2;  let from = 0.25; const to = 0.5; param soft = 1; \
        output except, periodic: spline(order = 5, intervals = 2); \
        minimize integral(der(except, 2)^2 + der(periodic, 2)^2);  initial { soft: except == at;  periodic == soft; } \
        trajectory from to * T to T { at: except <= 3;  from <= periodic; } at to * T { except == 1; } }";
    assert_eq!(parts(&program(text)), [(0, 0.5, 1.0)]);
    // A function of the spec that is called so wins.
    let own = "problem P { duration T = 1; fn at(a, b) = a + b; output x: spline(order = 5, intervals = 2); \
        minimize integral(at(x, 1)^2); initial { x == 0; } }";
    assert_eq!(places(&program(own)), []);
}

#[test]
fn parts_and_places_stay_silent() {
    let text = format!(
        "problem P {{ {FREE} initial {{ x == 0; }} periodic y; at 0.3 * T {{ x == 1 [m]; }} \
        trajectory except final {{ x <= 1 [m]; }} trajectory from 0.2 * T {{ y >= 0; }} }}"
    );
    assert_eq!(findings(&text), "");
}
