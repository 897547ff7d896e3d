//! What the words of the language mean: for hover, and beside proposals.

/// What a word of the language means, in a line.
pub fn explained(word: &str) -> Option<String> {
    let words = match word {
        "agent" => "`agent uav[i in 1 .. 3] { ... }`: an independent timeline, or a family of them",
        "phase" => "`phase leg after start { ... }`: a stretch of time with its own splines and constraints",
        "const" => "`const N = 3;`: known when the spec is compiled",
        "param" => "`param v_max = 0.25 [km/s];`: a value that a program may change without compiling again",
        "variable" => "`variable m0 in 1 .. 5 [kg];`: a free number, constant in time",
        "output" => "`output x, y [km]: spline(order = 5, intervals = 8);`: what moves",
        "problem" => "`problem Name { ... }`: one optimal control problem",
        "state" => "`state r[3] [m], m in 1 .. 2 [kg];`: what equations of motion determine",
        "input" => "`input u in -1 .. 1 [N]: held;`: what is chosen freely along the way",
        "dynamics" => "`dynamics { der(x) == v; }`: the equations of motion, one for each state",
        "use" => {
            "`use std::rotation;`, `use \"shuttle.ntg\" as shuttle;`: constants, functions and tables of a library"
        }
        "fn" => {
            "`fn blend(u, w) = ...;`, `fn lift(v [m/s]) [N] { let q = ...; ... }`: a function, written out where it is applied"
        }
        "let" => "`let speed [km/s] = hypot(der(x), der(y));`: a named expression, also reported and plotted",
        "table" => "`table thrust(t [s]) [kN] = linear { 0: 18; 6: 0; }`: data",
        "continuation" => "`continuation width = (20, 10, 5) [deg];`: a parameter solved for in turn",
        "duration" => "`duration T in 1 .. 9 [s];`, or `duration(phase)` in an expression",
        "start" => "`start in 0 .. 600 [s];` in an agent, or `start(phase)` in an expression",
        "end" => "`end(phase)`: the time at which a phase or agent ends",
        "initial" => "`initial { ... }`: what holds at the start; `initial(e)`: the value there",
        "trajectory" => "`trajectory { ... }`: what holds all the way",
        "final" => "`final { ... }`: what holds at the end; `final(e)`: the value there",
        "temporal" => "`temporal { ... }`: what belongs to no single point, such as event times",
        "minimize" => "`minimize fuel [kg]: e;`: a term of the objective; terms add up",
        "maximize" => "`maximize range: e;`: a term of the objective; terms add up",
        "collocation" => "`collocation gauss(points = 5);`, `collocation uniform(breakpoints = 41);`",
        "guess" => "`guess { (x, y) through (0, 0), (1, 5) [km];  T = 9 [s]; }`: where to begin",
        "continuous" => "`input u: continuous;`: no jumps; `continuous x up to 1;`: how smoothly phases meet",
        "at" => "`at 2.5 [s] { ... }`: what holds at one time; `at(2.5 [s], e)`: the value there",
        "domain" => "`domain s [m];`: everything is a function of `s` instead of the time `t`",
        "scenario" => "`scenario plant[k in 1 .. 20] { ... }`: the same problem for several cases at once",
        "shared" => "`shared u until 1 [s];`: an input that all members of a scenario have in common",
        "until" => "`shared u until 1 [s];`: up to when the members of a scenario share an input",
        "weight" => "`scenario plant[k in 1 .. 20] weight p[k] { ... }`: with what each member counts",
        "periodic" => "`periodic x, y;`: outputs that end as they begin, with their derivatives",
        "soft" => "`soft(200 [1/s]): c;`: a constraint that may be missed, at a price",
        "except" => "`trajectory except final { ... }`: everywhere but at that end",
        "from" => {
            "`trajectory from a to b { ... }`: a part of the trajectory; `param a[n, 3] [m] from \"a.csv\" columns 1 .. 3;`: data"
        }
        "measure" => "`measure { at(2 [s], x) == 3 [m] sigma 0.1 [m]; }`: what was measured, by least squares",
        "sigma" => "`at(2 [s], x) == 3 [m] sigma 0.1 [m];` in `measure`: the standard deviation",
        "rows" => "`const n = rows(\"a.csv\");`: how many rows a file has",
        "jump" => "`jump m;`: an output that is not continuous at the start of the phase",
        "der" => "`der(e)`, `der(e, 2)`: derivative in real time, by the chain rule",
        "partial" => "`partial(f(s, w), s)`: partial derivative of a function or table",
        "integral" => "`integral(e)`: over real time",
        "sum" => "`sum(i in 1 .. N, e)`",
        "prod" => "`prod(i in 1 .. N, e)`",
        "if" => "`if a <= b smooth w { x } else { y }`: a value that depends on a condition",
        "else" => "`if a <= b { x } else { y }`: the value where the condition does not hold",
        "smooth" => "`if a <= b smooth w { x } else { y }`: the width over which both branches blend",
        "for" => "`for i in 1 .. N { ... }`: constraints or guesses for every index",
        "t" => "mission time",
        "tau" => "scaled time of the phase, from 0 to 1",
        "pi" => "3.14159...",
        "hypot" => "`hypot(a, b, ...)`: sqrt(a^2 + b^2 + ...)",
        "atan2" => "`atan2(y, x)`: the angle of the point (x, y)",
        "logistic" => "`logistic(u)`: 1 / (1 + exp(-u))",
        "softplus" => "`softplus(u)`: log(1 + exp(u))",
        "smooth_abs" => "`smooth_abs(u, width)`: hypot(u, width)",
        "smooth_max" => "`smooth_max(u, v, width)`",
        "spline" => "`spline(order = 5, intervals = 8, smoothness = 3)`, or `knots = (0, 0.2, 1)`",
        "gauss" => "`gauss(points = 5)`: Gauss-Legendre points in every knot interval",
        "uniform" => "`uniform(breakpoints = 41)`: equally spaced points, trapezoid rule",
        "in" => "`in 0 .. 5 [m]`: bounds of which either may be missing, or the range of an index",
        "held" => "`input u: held;`: one value in each interval",
        "order" => "`order = 5`: polynomials of degree 4 in each interval",
        "intervals" => "`intervals = 8`: pieces of equal length",
        "smoothness" => "`smoothness = 3`: values and derivatives up to order 2 are continuous",
        "knots" => "`knots = (0, 0.2, 1)`: ends of the intervals in scaled time",
        "points" => "`points = 3`: points in each interval",
        "breakpoints" => "`breakpoints = 41`: equally spaced points, both ends included",
        "equalities" => "`equalities = 3`: equations at so many points of their own in each interval",
        "inequalities" => "`inequalities = points`: inequalities at the points alone, not at the ends of intervals",
        "linear" => "`table f(x) = linear { ... }`: straight lines between nodes",
        "monotone" => "`table f(x) = monotone { ... }`: smooth, through the nodes, without overshoot",
        "bspline" => "`table f(x) = bspline(order = 4) { ... }`: the spline through all nodes",
        "fit" => {
            "`table f(x) = fit bspline(order = 4, intervals = 6) from \"f.csv\";`: the nearest spline by least squares"
        }
        "even" => "`table f(a even [deg]) = ...`: mirrored at 0",
        "extrapolate" => "`monotone(extrapolate = linear)`: beyond its nodes a table goes on with its end slope",
        "after" => "`phase coast after boost { ... }`: which phase it follows",
        "through" => "`(x, y) through (0, 0), (1, 5) [km];` in `guess`: a coarse route",
        "dot" => "`dot(a, b)`: the product of two vectors, a number",
        "cross" => "`cross(a, b)`: the vector product of two vectors of 3",
        "norm" => "`norm(v)`: the length of a vector",
        "transpose" => "`transpose(A)`: rows become columns",
        "identity" => "`identity(n)`: the matrix with ones on its diagonal",
        "diagonal" => "`diagonal(v)`: the matrix with these numbers on its diagonal",
        "outer" => "`outer(a, b)`: the matrix of all products `a[i] * b[j]`",
        "skew" => "`skew(v)`: the matrix with `skew(v) * w == cross(v, w)`",
        "min" => "`min(a, b, ...)`, `min(v)`, `min(i in 1 .. n, e)`: the least",
        "max" => "`max(a, b, ...)`, `max(v)`, `max(i in 1 .. n, e)`: the greatest",
        "abs" => "`abs(x)`: the size without the sign; it has a corner at 0",
        "sign" => "`sign(x)`: -1, 0 or 1",
        "sqrt" => "`sqrt(x)`: the square root; the unit is that of the root",
        "exp" => "`exp(x)`: of a pure number",
        "log" => "`log(x)`: the natural logarithm of a pure number",
        "sin" | "cos" | "tan" => {
            return Some(format!("`{word}(x)`: of an angle, a pure number in radians; `30 [deg]` is one"));
        }
        "asin" | "acos" | "atan" => return Some(format!("`{word}(x)`: an angle in radians")),
        "sinh" | "cosh" | "tanh" => return Some(format!("`{word}(x)`: of a pure number")),
        _ => return None,
    };
    Some(words.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use ntg_compiler::model::tools;
    use ntg_compiler::syntax::{EXPRESSION_WORDS, ITEM_WORDS, OTHER_ITEM_WORDS};

    #[test]
    fn every_word_of_the_language_says_what_it_is() {
        let words = ITEM_WORDS.iter().chain(OTHER_ITEM_WORDS).chain(EXPRESSION_WORDS).copied();
        let silent: Vec<&str> = words.chain(tools::functions()).filter(|word| explained(word).is_none()).collect();
        assert!(silent.is_empty(), "{silent:?}");
    }
}
