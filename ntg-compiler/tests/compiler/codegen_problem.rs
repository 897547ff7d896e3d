//! What a program looks like as a Rust type: parameters, contract, solution.

use crate::codegen_support::{expand, phase, rest};
use ntg_compiler::codegen::generate;
use ntg_structure::{
    Agent, Block, Call, Constraint, Domain, Family, Loop, Named, Parameter, Part, PhaseRef, Place, Start, Table,
    TableAxis, TableExtrapolation, TableMethod, TableSymmetry, Unit, Variable,
};

fn unit(symbol: &str, factor: f64) -> Unit {
    Unit { symbol: symbol.into(), factor }
}

fn parameter(name: &str, unit: Unit, array: bool, value: &[f64]) -> Parameter {
    Parameter { name: name.into(), doc: String::new(), unit, array, grid: None, value: value.to_vec() }
}

fn named(name: &str, domain: Domain, loops: usize, family: Option<Family>) -> Named {
    Named {
        name: name.into(),
        doc: String::new(),
        unit: unit("km/s", 1000.0),
        family,
        agent: 0,
        loops: vec![Loop::default(); loops],
        domain,
        call: Call::default(),
    }
}

fn along(phase: usize) -> Domain {
    Domain::Path { phase: PhaseRef { phase, ..PhaseRef::default() }, points: 0, part: Part::WHOLE }
}

fn constraint(name: &str) -> Constraint {
    let (place, block, unit) = (Place::default(), Block::Trajectory, Unit::default());
    Constraint { name: Some(name.into()), place, block, unit, sides: 0 }
}

/// The lines of an item that begins with `start`, up to the line that closes it.
#[track_caller]
fn item(text: &str, start: &str) -> String {
    let lines: Vec<&str> = text.lines().collect();
    let first = lines.iter().position(|line| line.trim_start().starts_with(start)).expect("the item is there");
    let indent = lines[first].len() - lines[first].trim_start().len();
    let closing = format!("{}}}", " ".repeat(indent));
    let last = first + lines[first..].iter().position(|line| *line == closing).expect("the item ends");
    lines[first..=last].iter().map(|line| format!("{}\n", line.get(indent..).unwrap_or(line))).collect()
}

#[test]
fn a_whole_problem_reads_well() {
    insta::assert_snapshot!(expand(&rest()));
}

#[test]
fn parameters_are_fields_in_their_declared_units() {
    let mut program = rest();
    program.structure.parameters = vec![
        parameter("v_max", unit("km/s", 1000.0), false, &[250.0]),
        parameter("width", unit("deg", std::f64::consts::PI / 180.0), false, &[0.3 * (std::f64::consts::PI / 180.0)]),
        parameter("start_x", unit("km", 1000.0), true, &[-100e3, -97e3]),
        parameter("type", Unit::default(), false, &[1e-9]),
    ];
    program.structure.parameters[0].doc = "Fastest flight.\nAt any height.".into();
    let text = expand(&program);
    let parts = ["pub struct Rest {", "impl ::core::default::Default for Rest", "fn update(&self"];
    insta::assert_snapshot!(parts.map(|part| item(&text, part)).join("\n"));
}

#[test]
fn a_replaceable_table_is_a_field_with_nodes_and_values() {
    let mut program = rest();
    let axis = |name: &str, nodes: &[f64]| TableAxis {
        name: name.into(),
        unit: unit("km", 1000.0),
        nodes: nodes.to_vec(),
        symmetry: TableSymmetry::Plain,
    };
    program.structure.tables = vec![Table {
        name: "ref_line".into(),
        doc: String::new(),
        axes: vec![axis("s", &[0.0, 1000.0]), axis("h", &[0.0, 500.0, 1500.0])],
        unit: unit("kN", 1000.0),
        values: vec![1e3, 2e3, 3e3, 4e3, 5e3, 6e3],
        method: TableMethod::Monotone,
        extrapolation: TableExtrapolation::Clamp,
        replaceable: true,
    }];
    let text = expand(&program);
    let parts = ["pub struct RefLineTable", "impl ::core::default::Default for Rest", "fn update(&self"];
    insta::assert_snapshot!(parts.map(|part| item(&text, part)).join("\n"));
}

#[test]
fn a_solution_has_fields_for_outputs_and_methods_for_the_rest() {
    let mut program = rest();
    let structure = &mut program.structure;
    structure.phases[0].outputs[0].family = Some(Family::of(1, 3));
    structure.named = vec![
        named("speed", along(0), 0, None),
        named("report", Domain::Mission, 0, None),
        named("gap", along(0), 1, Some(Family::of(0, 4))),
    ];
    structure.variables = vec![Variable {
        name: "m0".into(),
        doc: "Mass at the start.".into(),
        unit: unit("kg", 1.0),
        family: None,
        bounds: ntg_structure::Bounds::default(),
        place: Place::default(),
    }];
    structure.constraints = vec![constraint("turn")];
    let text = expand(&program);
    insta::assert_snapshot!(["pub struct RestSolution", "impl RestSolution"].map(|part| item(&text, part)).join("\n"));
}

#[test]
fn phases_and_agents_nest_as_in_the_spec() {
    let mut program = rest();
    let structure = &mut program.structure;
    let agent = |name: &str, family| Agent {
        name: Some(name.into()),
        family,
        start: Start::Fixed(None),
        duration_name: None,
        place: Place::default(),
    };
    structure.agents = vec![agent("uav", Some(Family::of(1, 3))), agent("striker", None)];
    structure.phases = vec![phase(), phase(), phase()];
    for (phase, (name, agent)) in structure.phases.iter_mut().zip([("covert", 0), ("exposed", 0), ("", 1)]) {
        phase.name = (!name.is_empty()).then(|| name.into());
        phase.agent = agent;
        phase.duration_name = None;
    }
    structure.named =
        vec![named("speed", along(0), 1, None), named("speed", along(1), 1, None), named("sig", along(1), 1, None)];
    structure.constraints = vec![constraint("uav.covert.turn")];
    let text = expand(&program);
    let types = ["RestSolution", "RestUav", "RestUavCovert"];
    let parts = types.map(|name| item(&text, &format!("pub struct {name}")) + &item(&text, &format!("impl {name}")));
    insta::assert_snapshot!(parts.join("\n"));
}

#[test]
fn size_grows_neither_with_breakpoints_nor_with_members() {
    let of_size = |intervals: u32, members: i64| {
        let mut program = rest();
        let output = &mut program.structure.phases[0].outputs[0];
        output.spline.breakpoints = (0..=intervals).map(|i| f64::from(i) / f64::from(intervals)).collect();
        output.family = Some(Family::of(1, members));
        program.structure.parameters =
            vec![parameter("p", Unit::default(), true, &vec![0.5; usize::try_from(members).expect("small")])];
        generate(&program).to_string().split_whitespace().count()
    };
    assert_eq!(of_size(10, 10), of_size(1000, 1000));
}
