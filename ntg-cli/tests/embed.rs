//! `ntg embed`: the crate that it writes, and what a C program finds with its library.
//!
//! The library is built once into a folder of its own below the target folder, without network. Where there is no C
//! compiler the test says so and checks the rest.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use ntg_compiler::model::Loader;
use ntg_compiler::source::Source;
use ntg_interp::Interpreted;
use ntg_runtime::Solver;
use ntg_runtime::settings::Settings;

const SPEC: &str = "tests/embed/cart.ntg";

/// Specs of tests name no files.
struct NoFiles;

impl Loader for NoFiles {
    fn load(&self, path: &str) -> Result<String, String> {
        Err(format!("{path}: no files are read here"))
    }
}

fn ntg(words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_ntg")).args(words).output().expect("the command runs")
}

/// What a command that succeeds prints.
#[track_caller]
fn done(output: &Output) -> String {
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{}\n{said}", String::from_utf8_lossy(&output.stdout));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// What a command that fails says.
#[track_caller]
fn refused(words: &[&str]) -> String {
    let output = ntg(words);
    assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stdout));
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// An empty folder for one test.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("embed-{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

fn in_words(path: &Path) -> &str {
    path.to_str().expect("a plain path")
}

/// A compiler, if there is one.
fn compiler(variable: &str, usual: &str) -> Option<String> {
    let name = std::env::var(variable).unwrap_or_else(|_| usual.to_owned());
    Command::new(&name).arg("--version").output().ok().filter(|output| output.status.success()).map(|_| name)
}

#[test]
fn a_crate_is_written_once_and_says_what_to_do_next() {
    let crate_ = folder("written").join("cart");
    let words = ["embed", SPEC, "-o", in_words(&crate_), "--state", "p0=p,v0=der(p)"];
    let said = done(&ntg(&words));
    assert!(said.contains("cargo build") && said.contains("cmake"), "{said}");
    let header = fs::read_to_string(crate_.join("include/cart.h")).expect("a header");
    for line in
        ["    double reach[2];", "    double class_;", "    CART_p = 0,", "    CART_T = 2,", "#define CART_READINGS 3"]
    {
        assert!(header.contains(line), "{line}\n{header}");
    }
    assert!(header.contains("Along the rail. In m, output, with derivatives."), "{header}");
    let example = fs::read_to_string(crate_.join("examples/loop.c")).expect("an example");
    assert!(example.contains("cart_read(solver, CART_p, 1, step, &parameters.v0)"), "{example}");
    assert!(example.contains("parameters.p0 *= 100.0;"), "the output is in m, the parameter in cm\n{example}");
    assert!(refused(&words).contains("--force"));
    done(&ntg(&[&words[..], &["--force"]].concat()));
}

#[test]
fn what_cannot_be_embedded_is_refused_in_words() {
    let crate_ = folder("refused").join("cart");
    let embed = |more: &[&str]| refused(&[&["embed", SPEC, "-o", in_words(&crate_)], more].concat());
    assert!(embed(&["--name", "Cart-1"]).contains("small letters"));
    assert!(embed(&["--name", "m"]).contains("hide"));
    assert!(embed(&["--state", "p0"]).contains("x_start=x"));
    assert!(embed(&["--state", "q0=p"]).contains("there are `p0`, `v0`, `v_max`, `class`"));
    assert!(embed(&["--state", "reach=p"]).contains("one number"));
    assert!(embed(&["--state", "p0=q"]).contains("there are `p`, `speed`, `T`"));
    assert!(embed(&["--state", "p0=der(speed)"]).contains("only outputs"));
    assert!(embed(&["--ntg", "nowhere"]).contains("a version"));
    assert!(embed(&["--ntg", "src"]).contains("not the source of ntg"));
    assert!(embed(&["--lang", "fortran"]).contains("[possible values: c]"));
    assert!(refused(&["embed", "tests/embed/cat.ntg"]).contains("did you mean `tests/embed/cart.ntg`?"));
    assert!(!crate_.exists(), "nothing is written before all is checked");
}

#[test]
fn tables_go_with_the_spec_wherever_they_are() {
    let place = folder("tables");
    fs::create_dir_all(place.join("specs")).expect("a folder");
    fs::create_dir_all(place.join("data")).expect("a folder");
    fs::write(place.join("data/drag.csv"), "0,0\n1,1\n2,4\n3,9\n").expect("a file");
    let spec = "problem Drag {\n    duration T = 1;\n    output x: spline(order = 5, intervals = 2);\n    \
                table drag(v) = monotone from \"../data/drag.csv\";\n    minimize integral(drag(der(x)) + der(x, 2)^2);\n    \
                initial { x == 0; }\n    final { x == 1; }\n}\n";
    fs::write(place.join("specs/drag.ntg"), spec).expect("a file");
    let crate_ = place.join("out");
    done(&ntg(&["embed", in_words(&place.join("specs/drag.ntg")), "-o", in_words(&crate_)]));
    assert!(crate_.join("spec/in/drag.ntg").is_file() && crate_.join("spec/data/drag.csv").is_file());
    done(&ntg(&["check", in_words(&crate_.join("spec/in/drag.ntg"))]));
}

/// The lines that `uses.c` prints, found by a solver in Rust.
fn lines_of_rust() -> Vec<String> {
    let text = fs::read_to_string(SPEC).expect("the spec");
    let compiled = ntg_compiler::compile(&Source::new("cart.ntg", text), &NoFiles);
    let program = compiled.unwrap_or_else(|found| panic!("{}", found.first().message)).program;
    let mut solver = Solver::new(Interpreted::new(&program), &Settings::default());
    solver.solve().expect("a first solution");
    let kernels = Interpreted::new(&program);
    let line = |k: i32| {
        solver.problem.set("p0", &[1.5 * f64::from(k) * 0.01]).expect("a parameter");
        solver.problem.set("v0", &[(40.0 - f64::from(k)) * 0.01]).expect("a parameter");
        let report = solver.resolve().expect("a report");
        assert!(report.is_solved(), "{}", report.status);
        let p = report.solution.output("p").expect("an output");
        let speed = report.solution.signals(&kernels)[0].at(0.9);
        let numbers = [p.derivative(0.9, 0), p.derivative(0.9, 1), p.derivative(0.9, 2), speed];
        numbers.map(|x| format!("{:016x}", x.to_bits())).join(" ")
    };
    (0..40).map(line).collect()
}

#[test]
fn a_c_program_finds_the_bits_of_rust_and_allocates_nothing_after_create() {
    let place = folder("built");
    let crate_ = place.join("cart");
    done(&ntg(&["embed", SPEC, "-o", in_words(&crate_), "--state", "p0=p,v0=der(p)"]));
    let Some(cc) = compiler("CC", "cc") else {
        println!("skipped: there is no C compiler `cc`");
        return;
    };
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("embed-target");
    let built = Command::new(env!("CARGO"))
        .args(["build", "--release", "--offline", "--target-dir", in_words(&target), "--manifest-path"])
        .arg(crate_.join("Cargo.toml"))
        .env("CARGO_PROFILE_RELEASE_OPT_LEVEL", "0") // It compiles faster, to the same bits.
        .env("CARGO_PROFILE_RELEASE_LTO", "off")
        .output();
    done(&built.expect("cargo runs"));

    let (include, library) = (crate_.join("include"), target.join("release/libcart.a"));
    let strict = ["-pedantic", "-Wall", "-Wextra", "-Werror", "-I", in_words(&include), "-I", "tests/embed"];
    let compile = |compiler: &str, standard: &str, sources: &[&Path], more: &[&str], out: &str| {
        let program = place.join(out);
        let output = Command::new(compiler)
            .arg(standard)
            .args(strict)
            .args(more)
            .args(sources)
            .arg("-o")
            .arg(&program)
            .args(if more.contains(&"-c") { vec![] } else { vec![in_words(&library), "-lpthread", "-ldl", "-lm"] })
            .output();
        done(&output.expect("the compiler runs"));
        program
    };
    let uses = [Path::new("tests/embed/uses.c"), Path::new("tests/embed/counting.c")];
    let uses = compile(&cc, "-std=c99", &uses, &[], "uses");
    let printed = done(&Command::new(uses).output().expect("the program runs"));
    let mut lines: Vec<&str> = printed.lines().collect();
    let counted = lines.pop().expect("a count");
    assert_eq!(lines, lines_of_rust());
    assert_eq!(counted, "allocations 0");

    let example = crate_.join("examples/loop.c");
    let example = compile(&cc, "-std=c99", &[&example], &[], "loop_c");
    let in_c = done(&Command::new(example).output().expect("the example runs"));
    assert_eq!(in_c.lines().count(), 11, "{in_c}");
    let Some(cxx) = compiler("CXX", "c++") else {
        println!("skipped: there is no C++ compiler `c++`");
        return;
    };
    let example = compile(&cxx, "-std=c++17", &[&crate_.join("examples/loop.cpp")], &[], "loop_cpp");
    assert_eq!(done(&Command::new(example).output().expect("the example runs")), in_c);
    let stateless = place.join("stateless");
    done(&ntg(&["embed", SPEC, "-o", in_words(&stateless)]));
    compile(&cc, "-std=c99", &[&stateless.join("examples/loop.c")], &["-c"], "stateless.o");
    let stand_in = crate_.join("ros2/stand_in");
    compile(&cxx, "-std=c++17", &[&crate_.join("ros2/src/node.cpp")], &["-c", "-I", in_words(&stand_in)], "node.o");
}
