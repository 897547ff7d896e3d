//! Another independent variable, and scenarios: what each becomes.

use crate::model_support::{findings, program};
use ntg_compiler::program::Program;
use ntg_structure::Independent;

/// The program of a spec, without the names that no text has.
#[track_caller]
fn nameless(text: &str) -> Program {
    let mut program = program(&format!("problem P {{ {text} }}"));
    let structure = &mut program.structure;
    structure.constraints.iter_mut().for_each(|constraint| {
        constraint.name = None;
        constraint.place = Default::default();
    });
    structure.terms.iter_mut().for_each(|term| term.place = Default::default());
    structure.agents.iter_mut().for_each(|agent| agent.place = Default::default());
    structure.phases.iter_mut().for_each(|phase| phase.place = Default::default());
    structure.variables.iter_mut().for_each(|variable| variable.place = Default::default());
    structure.integrals.iter_mut().for_each(|integral| integral.place = Default::default());
    program
}

/// Holds two specs against each other, places left out.
#[track_caller]
fn same(short: &str, long: &str) {
    let (mut short, mut long) = (nameless(short), nameless(long));
    for kernel in short.structure.kernels.iter_mut().chain(&mut long.structure.kernels) {
        kernel.probes.iter_mut().for_each(|probe| *probe = Default::default());
    }
    assert_eq!(short.structure, long.structure);
}

#[test]
fn a_domain_is_time_by_another_name_and_unit() {
    let spec = |head: &str, s: &str, unit: &str| {
        format!(
            "{head} duration S in 1 .. 5 [{unit}]; start = 2 [{unit}]; output x [kg]: spline(order = 5, intervals = 4);
            minimize integral(der(x, 2)^2 * {s}^2) * 1 [{unit}/kg^2];
            initial {{ x == 1 [kg]; }} at S / 4 + 2 [{unit}] {{ der(x) == 1 [kg/{unit}]; }} guess {{ x = {s} * 1 [kg/{unit}]; }}"
        )
    };
    let (along, timed) = (nameless(&spec("domain s [m];", "s", "m")), nameless(&spec("", "t", "s")));
    assert_eq!(along.kernels, timed.kernels);
    assert_eq!(along.structure.groups, timed.structure.groups);
    assert_eq!(along.structure.phases, timed.structure.phases);
    assert_eq!(timed.structure.independent, Independent::default());
    assert_eq!(along.structure.independent.heading(), "s [m]");
}

#[test]
fn numbers_of_a_domain_are_in_si_units_and_shown_in_its_own() {
    let program = nameless(
        "domain t [min]; duration T = 2 [h]; output x: spline(order = 4, intervals = 2); minimize integral(x^2) / 1 [s];
        initial { x == 1; }",
    );
    let independent = &program.structure.independent;
    assert_eq!(independent.heading(), "t [min]");
    assert_eq!(independent.place(90.0, |t| t.to_string()), "t = 1.5 min");
}

#[test]
fn a_domain_without_a_unit_is_a_pure_number_among_quantities() {
    let text = "problem P { domain angle; duration = 2 * pi; output r [m]: spline(order = 4, intervals = 2);
        minimize length: integral(hypot(r, der(r))) / 1 [m]; initial { r == 1 [m]; } trajectory { r >= cos(angle) * 1 [m]; } }";
    assert_eq!(findings(text), "");
}

#[test]
fn the_words_of_domains_and_scenarios_are_names_elsewhere() {
    let text = "problem P { duration T = 2; param domain = 1; param weight = 2; let until = 3; let shared = 4;
        output scenario: spline(order = 4, intervals = 2); minimize integral(scenario^2 * domain * weight * until * shared);
        initial { scenario == 1; } }";
    assert_eq!(findings(text), "");
}

const COMMON: &str = "duration T in 1 .. 5 [s]; collocation gauss(points = 3, intervals = 4); param p[3] = (1, 2, 3);
    const S = 3; variable worst in 0 .. 9;";

#[test]
fn a_scenario_is_arrays_and_loops() {
    same(
        &format!(
            "{COMMON} scenario a[k in 1 .. S] weight p[k] {{
                state x [m]; input u [m/s]; output r[2] [m]: spline(order = 4); variable v in 0 .. 2 [m];
                let rate [1/s] = k * 1 [1/s]; let both[i in 1 .. 2] = r[i] + x;
                dynamics {{ der(x) == u - rate * x; }}
                minimize cost: integral(u^2) * 1 [s/m^2];
                initial {{ x == k * 1 [m]; r == 0; }}
                trajectory {{ for i in 1 .. 2 {{ both[i] <= 3 [m]; }} u in -1 [m/s] .. p[k] * 1 [m/s]; }}
                at T / 2 {{ x <= v; }}
                final {{ miss: x / 1 [m] + final(x) / 1 [m] <= worst; }}
                periodic r;
                guess {{ x = 1 [m] * tau; r through (0, 0), (1, 2) [m]; }}
            }}
            temporal {{ sum(i in 1 .. S, final(a[i].r[2])) == 1 [m]; }}"
        ),
        &format!(
            "{COMMON} state a_x[1 .. S] [m]; input a_u[1 .. S] [m/s]; output a_r[1 .. S, 2] [m]: spline(order = 4);
            variable a_v[1 .. S] in 0 .. 2 [m];
            let a_rate[k in 1 .. S] [1/s] = k * 1 [1/s]; let a_both[k in 1 .. S, i in 1 .. 2] = a_r[k, i] + a_x[k];
            dynamics {{ for k in 1 .. S {{ der(a_x[k]) == a_u[k] - a_rate[k] * a_x[k]; }} }}
            minimize cost: sum(k in 1 .. S, p[k] * (integral(a_u[k]^2) * 1 [s/m^2]));
            initial {{ for k in 1 .. S {{ a_x[k] == k * 1 [m]; a_r[k] == 0; }} }}
            trajectory {{
                for k in 1 .. S {{ for i in 1 .. 2 {{ a_both[k, i] <= 3 [m]; }} a_u[k] in -1 [m/s] .. p[k] * 1 [m/s]; }}
            }}
            at T / 2 {{ for k in 1 .. S {{ a_x[k] <= a_v[k]; }} }}
            final {{ for k in 1 .. S {{ miss: a_x[k] / 1 [m] + final(a_x[k]) / 1 [m] <= worst; }} }}
            periodic a_r;
            guess {{ for k in 1 .. S {{ a_x[k] = 1 [m] * tau; a_r[k] through (0, 0), (1, 2) [m]; }} }}
            temporal {{ sum(i in 1 .. S, final(a_r[i, 2])) == 1 [m]; }}"
        ),
    );
}

#[test]
fn without_weights_terms_are_means() {
    same(
        &format!(
            "{COMMON} scenario a[k in 2 .. S] {{ output x: spline(order = 4); minimize integral(x^2) / 1 [s]; initial {{ x == k; }} }}"
        ),
        &format!(
            "{COMMON} output a_x[2 .. S]: spline(order = 4); minimize sum(k in 2 .. S, integral(a_x[k]^2) / 1 [s] / (S - 2 + 1));
            initial {{ for k in 2 .. S {{ a_x[k] == k; }} }}"
        ),
    );
}

#[test]
fn bounds_that_depend_on_the_member_are_constraints() {
    same(
        &format!("{COMMON} scenario a[k in 1 .. S] {{ output x [m] in 0 .. k * 1 [m]: spline(order = 4); variable v in k ..; minimize integral(v * x^2) / 1 [s*m^2]; }}"),
        &format!(
            "{COMMON} output a_x[1 .. S] [m]: spline(order = 4); variable a_v[1 .. S];
            minimize sum(k in 1 .. S, integral(a_v[k] * a_x[k]^2) / 1 [s*m^2] / (S - 1 + 1));
            trajectory {{ for k in 1 .. S {{ a_x[k] in 0 .. k * 1 [m]; }} }} temporal {{ for k in 1 .. S {{ a_v[k] in k ..; }} }}"
        ),
    );
}

#[test]
fn a_scenario_stands_in_an_agent_and_goes_through_its_phases() {
    let text = "problem P {
        agent uav[i in 1 .. 2] {
            collocation gauss(points = 3, intervals = 2);
            scenario wind[k in 1 .. 3] { state x [m]; input u [m/s]; shared u until end(out);
                dynamics { der(x) == u + k * 1 [m/s]; } minimize integral(u^2) * 1 [s/m^2]; initial { x == 0; } }
            phase out { duration in 1 .. 2 [s]; }
            phase back after out { duration = 2 [s]; final { wind[2].x == 0; } }
        }
        temporal { final(uav[1], wind[2].x) <= 1 [m]; }
    }";
    let program = program(text);
    let shared = &program.structure.shared;
    assert_eq!(shared.len(), 1);
    assert_eq!((shared[0].phase, &shared[0].until), (0, &vec![1.0]));
}

#[test]
fn code_does_not_grow_with_the_members() {
    let spec = |members: usize| {
        format!(
            "duration T = 2 [s]; collocation gauss(points = 3, intervals = 4);
            scenario a[k in 1 .. {members}] {{ state x [m]; input u in -1 .. 1 [m/s]; shared u until 1 [s];
                dynamics {{ der(x) == u - k * x / 100 [s]; }} minimize integral(u^2) * 1 [s/m^2]; initial {{ x == 1 [m]; }} }}"
        )
    };
    let (few, many) = (nameless(&spec(3)), nameless(&spec(300)));
    let length = |program: &Program| ntg_compiler::codegen::generate(program).to_string().len();
    assert_eq!(few.structure.kernels.len(), many.structure.kernels.len());
    assert_eq!(few.structure.groups.len(), many.structure.groups.len());
    assert!(length(&many) < length(&few) + 100, "{} and {}", length(&few), length(&many));
}

#[test]
fn an_output_of_a_scenario_jumps_for_all_members_or_for_one() {
    let spec = |jumps: &str| {
        format!(
            "problem P {{ const S = 3; collocation gauss(points = 3, intervals = 4);
            scenario a[k in 1 .. S] {{ state p [m], v [m/s]; input u in -1 .. 1 [m/s^2];
                dynamics {{ der(p) == v;  der(v) == u; }} minimize integral(u^2) * 1 [s^3/m^2]; initial {{ p == 0;  v == 0; }} }}
            phase up {{ duration = 2 [s]; }}
            phase on after up {{ duration = 2 [s];  {jumps} }} }}"
        )
    };
    let text = |jumps: &str| ntg_compiler::codegen::generate(&program(&spec(jumps))).to_string();
    // By hand, one member after the other.
    assert_eq!(text("jump a.v, a[2].p;"), text("jump a[1].v, a[2].v, a[3].v, a[2].p;"));
    let each = "continuous a[1].v up to 0;  continuous a[2].v up to 0;  continuous a[3].v up to 0;";
    assert_eq!(text("continuous a.v up to 0;"), text(each));
    assert_ne!(text("jump a.v;"), text(""));
}
