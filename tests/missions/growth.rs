//! Generated code does not grow with the number of vehicles, nor with that of joints.

use crate::{compile, shipped};

/// The text of `ntg expand`.
fn generated(text: &str) -> String {
    let tokens = ntg_compiler::codegen::generate(&compile(text).program);
    prettyplease::unparse(&syn::parse2(tokens).expect("generated code is Rust"))
}

#[test]
fn eight_vehicles_take_no_more_code_than_two() {
    for spec in
        ["multi_vehicle", "multi_vehicle_simultaneous", "multi_vehicle_look_after_strike", "multi_vehicle_separated"]
    {
        let text = shipped(spec);
        let of = |n: usize| generated(&text.replace("const N = 4;", &format!("const N = {n};"))).len();
        let (two, eight, hundred) = (of(2), of(8), of(100));
        assert!(eight as f64 <= 1.3 * two as f64, "{spec}: {eight} characters for 8 vehicles, {two} for 2");
        assert!(hundred as f64 <= 1.3 * two as f64, "{spec}: {hundred} characters for 100 vehicles, {two} for 2");
    }
}

#[test]
fn seven_joints_take_no_more_code_than_two() {
    let [two, seven] = ["gallery/arm_2", "gallery/arm_7"].map(|spec| generated(&shipped(spec)).len());
    assert!(seven as f64 <= 1.1 * two as f64, "{seven} characters for 7 joints, {two} for 2");
}
