//! The shipped specs: as generated code, and through the interpreter.

use std::path::Path;
use std::sync::LazyLock;

use ntg::runtime::problem::{Parametric, Problem};
use ntg::runtime::splines::Table;
use ntg_compiler::program::Program;
use ntg_compiler::source::Source;
use ntg_interp::Interpreted;

/// One spec, compiled both ways.
pub(crate) struct Spec {
    pub(crate) name: &'static str,
    pub(crate) generated: Box<dyn Parametric + Send>,
    pub(crate) program: Program,
    pub(crate) interpreted: Interpreted,
    pub(crate) tables: Vec<Table>,
}

/// Declares a module of generated code for each spec, and the list of them all.
macro_rules! specs {
    ($($module:ident: $path:tt => $problem:ident),+ $(,)?) => {
        $(
            #[allow(missing_docs, reason = "the specs of other people need no documentation here")]
            mod $module { ntg::ntg_file!($path); }
        )+
        const NAMES: &[&str] = &[$(stringify!($module)),+];
        /// All specs of the folder `specs/`, compiled once for all tests.
        pub(crate) fn all() -> &'static [Spec] {
            static ALL: LazyLock<Vec<Spec>> =
                LazyLock::new(|| vec![$(spec(stringify!($module), Box::new($module::$problem::default()))),+]);
            &ALL
        }
    };
}

specs! {
    gate_race: "specs/gate_race.ntg" => GateRace,
    gates: "specs/gates.ntg" => Gates,
    halo_orbit: "specs/halo_orbit.ntg" => HaloOrbit,
    kinematic_car: "specs/kinematic_car.ntg" => KinematicCar,
    kinematic_car_gauss: "specs/kinematic_car_gauss.ntg" => KinematicCarGauss,
    launch: "specs/launch.ntg" => Launch,
    low_observable: "specs/low_observable.ntg" => LowObservable,
    low_observable_alternation: "specs/low_observable_alternation.ntg" => LowObservableAlternation,
    low_observable_cosine: "specs/low_observable_cosine.ntg" => LowObservableCosine,
    low_observable_gauss: "specs/low_observable_gauss.ntg" => LowObservableGauss,
    low_observable_lock_loss: "specs/low_observable_lock_loss.ntg" => LowObservableLockLoss,
    low_observable_phases: "specs/low_observable_phases.ntg" => LowObservablePhases,
    low_observable_phases_cosine: "specs/low_observable_phases_cosine.ntg" => LowObservablePhasesCosine,
    missile_boost_coast: "specs/missile_boost_coast.ntg" => MissileBoostCoast,
    missile_intercept: "specs/missile_intercept.ntg" => MissileIntercept,
    multi_vehicle: "specs/multi_vehicle.ntg" => MultiVehicle,
    multi_vehicle_look_after_strike: "specs/multi_vehicle_look_after_strike.ntg" => MultiVehicleLookAfterStrike,
    multi_vehicle_separated: "specs/multi_vehicle_separated.ntg" => MultiVehicleSeparated,
    multi_vehicle_simultaneous: "specs/multi_vehicle_simultaneous.ntg" => MultiVehicleSimultaneous,
    powered_descent_6dof: "specs/powered_descent_6dof.ntg" => PoweredDescent6dof,
    probe: "specs/probe.ntg" => Probe,
    racing: "specs/racing.ntg" => Racing,
    radar_net: "specs/radar_net.ntg" => RadarNet,
    robust: "specs/robust.ntg" => Robust,
    strike_and_look: "specs/strike_and_look.ntg" => StrikeAndLook,
    round_the_mast: "specs/round_the_mast.ntg" => RoundTheMast,
    swarm: "specs/swarm.ntg" => Swarm,
    van_der_pol: "specs/van_der_pol.ntg" => VanDerPol,
    van_der_pol_gauss: "specs/van_der_pol_gauss.ntg" => VanDerPolGauss,
}

/// The text of a shipped spec.
pub(crate) fn source(name: &str) -> Source {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("specs").join(name).with_extension("ntg");
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    Source::new(format!("specs/{name}.ntg"), text)
}

struct BesideSpecs;

impl ntg_compiler::model::Loader for BesideSpecs {
    fn load(&self, path: &str) -> Result<String, String> {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("specs").join(path);
        std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))
    }
}

fn spec(name: &'static str, generated: Box<dyn Parametric + Send>) -> Spec {
    let source = source(name);
    let compiled = ntg_compiler::compile(&source, &BesideSpecs)
        .unwrap_or_else(|found| panic!("{}", found.iter().map(|d| d.render(&source)).collect::<Vec<_>>().join("\n")));
    let interpreted = Interpreted::new(&compiled.program);
    let tables =
        ntg::runtime::transcribe::interpolants(&interpreted.structure().tables).expect("the tables of shipped specs");
    Spec { name, generated, program: compiled.program, interpreted, tables }
}

#[test]
fn every_file_of_the_folder_is_listed() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("specs");
    for entry in std::fs::read_dir(folder).expect("the folder of specs") {
        let path = entry.expect("a readable entry").path();
        if path.extension().is_some_and(|e| e == "ntg") {
            let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
            assert!(NAMES.contains(&name.as_str()), "`{name}` is missing from tests/contract/specs.rs");
        }
    }
}
