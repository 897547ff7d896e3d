//! Every function of the language over a range that crosses its kinks, turns and ends: the checker, which computes each
//! of them in another way, accepts what is proved of values and of integrals.

use ntg_certify::prove::Options;
use ntg_certify::{certify::certify, statement, write};
use ntg_compiler::model::Loader;
use ntg_compiler::source::Source;
use ntg_interp::Interpreted;
use ntg_runtime::prelude::*;

struct NoFiles;

impl Loader for NoFiles {
    fn load(&self, path: &str) -> Result<String, String> {
        Err(format!("there is no `{path}`"))
    }
}

/// Functions of `y`, which goes through 0 and to 1 at most in size.
const FUNCTIONS: [&str; 36] = [
    "sin(3 * y)",
    "cos(3 * y)",
    "tan(y)",
    "asin(0.8 * y)",
    "acos(0.8 * y)",
    "asin(0.999999 * y)",
    "acos(0.999999 * y)",
    "acos(cos(y + 1.3))",
    "atan(3 * y)",
    "atan2(y, y^2 + 0.5)",
    "sinh(2 * y)",
    "cosh(2 * y)",
    "cosh(y) / (1 + y^2)",
    "tanh(4 * y)",
    "abs(y)",
    "abs(abs(y) - 0.5)",
    "abs(y)^1.5",
    "abs(y)^0.5",
    "abs(y)^3",
    "(y + 1.2)^2.5",
    "1 / (y + 1.5)",
    "sqrt(y + 1.1)",
    "sqrt(abs(y))",
    "log(y + 1.1)",
    "exp(2 * y)",
    "exp(-y^2) * sinh(y)",
    "hypot(y, 0.3)",
    "norm((y, der(y)))",
    "max(y, 0.2)",
    "min(y, -y)",
    "sign(y)",
    "y * abs(y)",
    "softplus(5 * y)",
    "logistic(5 * y)",
    "smooth_abs(y, 0.1)",
    "smooth_max(y, 0, 0.1)",
];

/// Where `y` begins and ends, with its slopes.
const ENDS: [[f64; 4]; 3] = [[1.0, -1.0, -0.3, 0.8], [-1.0, 2.0, 1.0, 0.5], [0.2, 0.5, 0.9, 0.0]];

#[test]
fn the_checker_accepts_what_is_proved_of_every_function() {
    for (function, [y0, v0, y1, v1]) in FUNCTIONS.iter().flat_map(|f| ENDS.map(|ends| (f, ends))) {
        let text = format!(
            "problem P {{
                duration T = 1;
                output y: spline(order = 5, intervals = 3);
                let e = {function};
                minimize integral(der(y, 3)^2) + 0.001 * integral(e^2);
                initial {{ y == {y0}; der(y) == {v0}; }}
                trajectory {{ e >= -100; }}
                final {{ y == {y1}; der(y) == {v1}; }}
            }}"
        );
        let source = Source::new("function.ntg", text.clone());
        let program = ntg_compiler::compile(&source, &NoFiles).expect("a sound spec").program;
        let problem = Interpreted::new(&program);
        let report = solve(&problem, &Settings::default()).expect("a problem");
        let statement = statement(&program, &report.solution, &text).expect("a solution");
        let certificate = certify(statement, &Options::default());
        assert!(certificate.is_proved(), "{function} from {y0} to {y1}");
        let checked = ntg_check::verify(&write::text(&certificate));
        assert!(checked.is_ok(), "{function} from {y0} to {y1}: {checked:?}");
    }
}
