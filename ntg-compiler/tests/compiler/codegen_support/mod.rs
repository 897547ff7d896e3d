//! Small programs made by hand, and generated code as a person reads it.

use ntg_compiler::codegen::generate;
use ntg_compiler::expr::{Dag, InputId, NodeId};
use ntg_compiler::program::{KernelBody, Program};
use ntg_structure::{
    Agent, At, Bounds, Call, Degree, Domain, Duration, Group, Kernel, Output, Part, Phase, PhaseRef, Place, Points,
    Row, Slot, Spline, Start, Structure, Term, Unit,
};

/// The generated code, formatted.
pub(crate) fn expand(program: &Program) -> String {
    let file = syn::parse2(generate(program)).expect("generated code parses as Rust");
    prettyplease::unparse(&file)
}

/// A kernel's formulas over inputs `a, b, c, ...` without derivatives.
pub(crate) fn body(inputs: &[&str], formulas: impl FnOnce(&mut Dag, &[NodeId]) -> Vec<NodeId>) -> KernelBody {
    let mut dag = Dag::new();
    let ids: Vec<NodeId> = (0..inputs.len()).map(|i| dag.input(InputId(i as u32))).collect();
    let values = formulas(&mut dag, &ids);
    let labels = (0..values.len()).map(|row| format!("formula {row}")).collect();
    let names = inputs.iter().map(|name| (*name).to_owned()).collect();
    KernelBody { dag, inputs: inputs.len(), names, labels, values, jacobian: vec![], hessian: vec![], probes: vec![] }
}

/// A program of one kernel that is only evaluated.
pub(crate) fn one_kernel(body: KernelBody) -> Program {
    let shape = Kernel {
        name: "path".into(),
        data: body.inputs,
        rows: body.values.len(),
        degree: vec![Degree::Constant; body.values.len()],
        ..Kernel::default()
    };
    let structure =
        Structure { name: "P".into(), source: "p.ntg".into(), kernels: vec![shape], ..Structure::default() };
    Program { structure, kernels: vec![body] }
}

/// `problem Rest { duration T = 5; output x: spline(order = 4, intervals = 8);`
/// `minimize integral(der(x)^2); }`, as the compiler would state it.
pub(crate) fn rest() -> Program {
    let mut program = one_kernel(body(&["x_1", "T"], |dag, z| {
        let square = dag.powi(z[0], 2);
        vec![dag.div(square, z[1])]
    }));
    let kernel = &mut program.kernels[0];
    let (dag, weight) = (&mut kernel.dag, InputId(2));
    let (two, x_1, w) = (dag.constant(2.0), dag.input(InputId(0)), dag.input(weight));
    let duration = dag.input(InputId(1));
    let twice = dag.mul(two, x_1);
    kernel.jacobian = vec![dag.div(twice, duration)];
    let second = dag.div(two, duration);
    kernel.hessian = vec![dag.mul(w, second)];
    kernel.probes = vec![kernel.values[0]];
    kernel.labels = vec!["integral(der(x)^2)".into()];

    let place = Place { line: 4, column: 5, text: "integral(der(x)^2)".into() };
    let structure = &mut program.structure;
    structure.name = "Rest".into();
    structure.doc = "From rest to rest.".into();
    structure.source = "specs/rest.ntg".into();
    structure.kernels[0] = Kernel {
        name: "path".into(),
        slots: 1,
        data: 1,
        rows: 1,
        jacobian: vec![(0, 0)],
        hessian: vec![(0, 0)],
        degree: vec![Degree::Quadratic],
        probes: vec![place.clone()],
    };
    let x = Slot::Flat { phase: PhaseRef::default(), at: At::Here, output: 0, index: None, derivative: 1 };
    structure.groups = vec![Group {
        loops: vec![],
        domain: Domain::Path { phase: PhaseRef::default(), points: 0, part: Part::WHOLE },
        call: Call {
            slots: vec![x],
            data: vec![ntg_structure::Data::Duration(PhaseRef::default())],
            ..Call::default()
        },
        rows: vec![Row::Cost { term: 0 }],
        bounds: None,
    }];
    structure.terms = vec![Term { name: None, place, unit: Unit::default() }];
    structure.agents = vec![Agent {
        name: None,
        family: None,
        start: Start::Fixed(None),
        duration_name: None,
        place: Place::default(),
    }];
    structure.phases = vec![phase()];
    program
}

/// The one phase of `rest`.
pub(crate) fn phase() -> Phase {
    let breakpoints = (0..=8).map(|i| f64::from(i) / 8.0).collect();
    Phase {
        name: None,
        agent: 0,
        family: None,
        after: None,
        duration: Duration::Free(Bounds::default()),
        duration_name: Some("T".into()),
        outputs: vec![Output {
            name: "x".into(),
            doc: "The place.".into(),
            unit: Unit { symbol: "km".into(), factor: 1000.0 },
            family: None,
            vector: None,
            spline: Spline { order: 4, smoothness: 3, breakpoints },
        }],
        points: vec![Points::Gauss { points: 5 }],
        place: Place::default(),
    }
}
