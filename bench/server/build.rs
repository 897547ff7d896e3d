//! Writes the fleets of 2, 4 and 8 aircraft: the project's specs with another `N`, as `ntg!` invocations.

use std::fmt::Write;
use std::{env, fs, path::Path};

const FLEETS: [(&str, &str); 4] = [
    ("fleet", "multi_vehicle"),
    ("fleet_equal", "multi_vehicle_simultaneous"),
    ("fleet_later", "multi_vehicle_look_after_strike"),
    ("fleet_apart", "multi_vehicle_separated"),
];

const SIZES: [usize; 3] = [2, 4, 8];

/// How the specs say their number of aircraft.
const AIRCRAFT: &str = "const N = 4;";

fn main() {
    let mut code = String::new();
    for (name, file) in FLEETS {
        let path = format!("../../specs/{file}.ntg");
        println!("cargo::rerun-if-changed={path}");
        let spec = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
        assert_eq!(spec.matches(AIRCRAFT).count(), 1, "{path} says `{AIRCRAFT}` once");
        for n in SIZES {
            let spec = spec.replace(AIRCRAFT, &format!("const N = {n};"));
            writeln!(code, "pub(super) mod {name}_{n} {{\nntg::ntg! {{\n{spec}\n}}\n}}").expect("a string takes all");
        }
    }
    let folder = env::var_os("OUT_DIR").expect("cargo sets OUT_DIR");
    fs::write(Path::new(&folder).join("fleets.rs"), code).expect("OUT_DIR can be written");
}
