//! Solves and certifies specs, and prints a table: `cargo run --release -p ntg-certify --example all SPEC ...`
//! With `TUBE=1` also the tube, with `GUARANTEE=1` also what a guarantee does, with `VERBOSE=1` every finding.

use ntg_certify::statement::Kind;
use ntg_certify::{Options, Verdict};
use ntg_compiler::source::Source;
use ntg_interp::Interpreted;
use ntg_runtime::prelude::*;

struct Beside(std::path::PathBuf);

impl ntg_compiler::model::Loader for Beside {
    fn load(&self, path: &str) -> Result<String, String> {
        std::fs::read_to_string(self.0.join(path)).map_err(|error| error.to_string())
    }
}

fn main() {
    for path in std::env::args().skip(1) {
        let path = std::path::PathBuf::from(path);
        let text = std::fs::read_to_string(&path).expect("a readable spec");
        let source = Source::new(path.display().to_string(), text.clone());
        let loader = Beside(path.parent().map(std::path::Path::to_path_buf).unwrap_or_default());
        let Ok(compiled) = ntg_compiler::compile(&source, &loader) else { panic!("{}", path.display()) };
        let problem = Interpreted::new(&compiled.program);
        let report = match solve(&problem, &Settings::default()) {
            Ok(report) => report,
            Err(error) => {
                println!("{}: {error}", path.display());
                continue;
            }
        };
        let statement = ntg_certify::statement(&compiled.program, &report.solution, &text).expect("a solution");
        let mut certificate = ntg_certify::certify(statement, &Options::default());
        let count = |test: fn(&Verdict) -> bool| certificate.findings.iter().filter(|f| test(&f.verdict)).count();
        let boxes: usize = certificate.findings.iter().flat_map(|f| &f.covers).map(Vec::len).sum();
        println!(
            "{}: solved {} in {:.3} s, certified in {:.3} s with {boxes} boxes: {} proved, {} refuted, {} undecided, {} equalities",
            path.file_name().unwrap_or_default().display(),
            report.is_solved(),
            report.seconds,
            certificate.seconds,
            count(|v| matches!(v, Verdict::Proved)),
            count(|v| matches!(v, Verdict::Refuted(..))),
            count(|v| matches!(v, Verdict::Undecided(_))),
            count(|v| matches!(v, Verdict::Within(_))),
        );
        if std::env::var("TUBE").is_ok() {
            let tube = ntg_certify::tube(&certificate, &report.solution);
            print!("{tube}");
            certificate.tubes = tube.evidence;
        }
        let text = ntg_certify::write::text(&certificate);
        let began = std::time::Instant::now();
        let checked = ntg_check::verify(&text);
        println!("  checked {} bytes in {:.3} s: {checked:?}", text.len(), began.elapsed().as_secs_f64());
        if let Ok(folder) = std::env::var("CERTIFICATES") {
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            std::fs::write(std::path::Path::new(&folder).join(format!("{name}.cert")), &text).expect("a folder");
        }
        if std::env::var("GUARANTEE").is_ok() {
            let task = ntg_certify::guarantee::Task { program: &compiled.program, problem: &problem, spec: &text };
            let seconds = report.seconds;
            let wanted = ntg_certify::Guarantee::default();
            match ntg_certify::guarantee::proved_from(task, report.clone(), &Settings::default(), &wanted) {
                Ok(found) => {
                    let all: f64 = found.rounds.iter().map(|round| round.solve + round.certify).sum();
                    let checked = ntg_check::verify(&ntg_certify::write::text(&found.certificate));
                    println!(
                        "  guarantee: {:?} after {} rounds, {:.1} solves' time, cost {:.2e}, check {:?}",
                        found.ending,
                        found.rounds.len(),
                        all / seconds,
                        found.cost(),
                        checked.map(|checked| checked.get("proved").copied().unwrap_or(0)),
                    );
                    if found.ending != ntg_certify::guarantee::Ending::Proved {
                        println!("  {:?}\n  {:?}", found.rounds, found.changes);
                    }
                }
                Err(error) => println!("  guarantee: {error}"),
            }
        }
        if std::env::var("VERBOSE").is_ok() {
            for (subject, finding) in certificate.each() {
                let boxes: usize = finding.covers.iter().map(Vec::len).sum();
                let kind = match subject.kind {
                    Kind::Constraint(_) => "constraint",
                    Kind::Term(_) => "term",
                    Kind::Named(_) => "named",
                };
                println!("  {kind} {}: {:?} {:?} {boxes} boxes", subject.name, finding.verdict, finding.values);
            }
        }
    }
}
