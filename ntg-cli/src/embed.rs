//! `ntg embed`: a crate that builds a C library from one spec.

mod files;
mod header;
mod loops;
mod names;
mod source;

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use ntg_c::readings::readings;
use ntg_compiler::model::Loader;
use ntg_interp::Interpreted;
use ntg_runtime::settings::{Method, Settings};

use crate::printer::Printer;
use crate::{Exit, setup};

/// Write a crate that builds a static and a shared library from a spec, with a header for C99 and C++.
///
/// The library solves the problem again and again with other parameters: after create it allocates nothing, starts no
/// thread, opens no file and prints nothing. The crate holds the spec, the header, files for CMake, loops in C and C++,
/// and a node for ROS 2. Parameters that are measured in a loop are named with what they measure.
/// Exit status: 0 done, 2 on errors.
///
/// Examples:
///   ntg embed specs/low_observable.ntg -o flight
///   ntg embed specs/low_observable.ntg -o flight --state x_start=x,y_start=y
///   ntg embed mpc.ntg --name cart --state "p0=p,v0=der(p)"
///   cmake -S flight -B build && cmake --build build     # the libraries and the loops
#[derive(Args, Debug)]
#[command(verbatim_doc_comment)]
pub(crate) struct Embed {
    /// The spec file.
    spec: PathBuf,
    /// For which language.
    #[arg(long, value_enum, default_value_t = Language::C)]
    lang: Language,
    /// The folder of the crate; without it, the name beside the command's folder.
    #[arg(long, short, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// What every name of C begins with; without it, the problem's name in small letters.
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// Parameters that a loop measures, each with the output, derivative of an output or named expression that it is a
    /// measurement of: `x_start=x,v0=der(x)`.
    #[arg(long, value_name = "PARAMETER=READING", value_delimiter = ',')]
    state: Vec<String>,
    /// Where the crate gets ntg from: a folder with its source, a git repository, or a version; without it, the source
    /// around the spec or the command, else the version of the command.
    #[arg(long, value_name = "SOURCE")]
    ntg: Option<String>,
    /// Replace files that exist.
    #[arg(long)]
    force: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Language {
    /// C99, and C++ from C++11 on.
    C,
}

/// Loads what a spec names, and remembers it.
struct Recording<L> {
    loader: L,
    loaded: RefCell<Vec<(String, String)>>,
}

impl<L: Loader> Loader for Recording<L> {
    fn load(&self, path: &str) -> Result<String, String> {
        let text = self.loader.load(path)?;
        let mut loaded = self.loaded.borrow_mut();
        if loaded.iter().all(|(known, _)| known != path) {
            loaded.push((path.to_owned(), text.clone()));
        }
        Ok(text)
    }
}

/// Writes the crate.
pub(crate) fn run(arguments: &Embed, printer: &Printer) -> Result<Exit, String> {
    let Language::C = arguments.lang;
    let (source, loader) = crate::files::read(&arguments.spec).map_err(|failure| {
        failure.show();
        String::new()
    })?;
    let loader = Recording { loader, loaded: RefCell::default() };
    let compiled = ntg_compiler::compile(&source, &loader).map_err(|found| {
        crate::files::show(&source, found.iter());
        String::new()
    })?;
    crate::files::show(&source, compiled.notes.iter());
    let structure = &compiled.program.structure;

    let name = names::prefix(arguments.name.as_deref(), &structure.name)?;
    let folder = arguments.output.clone().unwrap_or_else(|| PathBuf::from(&name));
    let dependency = source::of(arguments.ntg.as_deref(), &[&arguments.spec, &folder])?;

    // One iteration tells what can be read; that it is no solution does not matter.
    let problem = Interpreted::new(&compiled.program);
    let once = Settings { max_iterations: 1, method: Method::InteriorPoint, ..Settings::default() };
    let report = ntg_runtime::solve(&problem, &once).map_err(|error| setup::words(&error, &source))?;
    let readings = names::Readings::new(&name, &readings(&report.solution, &problem));
    let parameters = names::parameters(structure);
    let state = loops::measured(&arguments.state, structure, &parameters, &readings)?;

    let header = header::Header {
        name: &name,
        structure,
        parameters: &parameters,
        readings: &readings,
        source: &file_name(&source.name),
    };
    let written = files::Crate {
        name: &name,
        problem: &structure.name,
        spec: (&file_name(&source.name), &source.text),
        loaded: &loader.loaded.borrow(),
        read: &[vec![arguments.spec.clone()], loader.loader.loaded()].concat(),
        header: &header.text(),
        dependency: &dependency,
        loops: &loops::Loops { name: &name, readings: &readings, state: &state },
    };
    let count = written.write(&folder, arguments.force)?;
    let shown = folder.display();
    printer.line(&format!(
        "{shown}: {count} files, {} parameters, {} readings, header {shown}/include/{name}.h\n  \
         cargo build --release --manifest-path {shown}/Cargo.toml     # the libraries alone\n  \
         cmake -S {shown} -B build && cmake --build build     # with the loops in {shown}/examples",
        ntg_c::planner::count(structure),
        readings.all.len(),
    ));
    Ok(Exit::Done)
}

/// The last part of a spec's path; a name for one that has none.
fn file_name(name: &str) -> String {
    let last = Path::new(name).file_name().and_then(|name| name.to_str());
    last.filter(|name| name.ends_with(".ntg")).unwrap_or("problem.ntg").to_owned()
}
