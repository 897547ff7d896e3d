//! A spec means the same in a file and inline.

use ntg::runtime::problem::Problem;
use ntg::runtime::structure::{Place, Structure};

mod file {
    ntg::ntg_file!("specs/van_der_pol.ntg");
}

mod inline {
    ntg::ntg! {
        /// The driven van der Pol oscillator, the first example of NTG, on NTG's own grid.
        ///
        /// Dynamics: z'' = -z + (1 - z^2) z' + u. So z is a flat output, and u a function of it.
        /// Twenty equally spaced breakpoints and the trapezoid rule: the optimum is 1.70221426283.
        problem VanDerPol {
            duration T = 5;
            output z: spline(order = 5, intervals = 2, smoothness = 3);
            collocation uniform(breakpoints = 20);

            /// The input that makes the oscillator follow z.
            let u = der(z, 2) + z - (1 - z^2) * der(z);

            minimize integral(0.5 * (z^2 + der(z)^2 + u^2));

            initial { z == 1;  der(z) == 0; }
            final   { der(z) - z == 1; }

            guess { z = 1; }
        }
    }
}

/// What a structure says, apart from where in which text it was said.
fn without_places(problem: &impl Problem) -> Structure {
    let mut structure = problem.structure();
    structure.source.clear();
    let places =
        structure.constraints.iter_mut().map(|c| &mut c.place).chain(structure.terms.iter_mut().map(|t| &mut t.place));
    places.for_each(|place| (place.line, place.column) = (0, 0));
    structure.agents.iter_mut().for_each(|agent| agent.place = Place::default());
    structure.phases.iter_mut().for_each(|phase| phase.place = Place::default());
    for kernel in &mut structure.kernels {
        kernel.probes.iter_mut().for_each(|place| (place.line, place.column) = (0, 0));
    }
    structure
}

#[test]
fn both_forms_state_the_same_problem() {
    assert_eq!(without_places(&file::VanDerPol::default()), without_places(&inline::VanDerPol::default()));
}

#[test]
fn both_forms_find_the_same_solution_to_the_last_bit() {
    let settings = ntg::runtime::settings::Settings::default();
    let file = file::VanDerPol::default().solve(&settings).expect("the spec can be set up");
    let inline = inline::VanDerPol::default().solve(&settings).expect("the spec can be set up");
    assert!(file.is_solved(), "{}", file.status());
    assert_eq!(file.objective().to_bits(), inline.objective().to_bits());
    assert_eq!(file.untyped().coefficients(), inline.untyped().coefficients());
    for t in file.times(7) {
        assert_eq!(file.u().at(t).to_bits(), inline.u().at(t).to_bits());
    }
}
