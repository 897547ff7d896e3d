//! Settings out of their ranges.

use ntg_runtime::settings::Settings;
use std::time::Duration;

#[test]
fn settings_out_of_range_are_refused_by_name() {
    assert_eq!(Settings::default().validate(), Ok(()));
    let field = |settings: Settings| settings.validate().expect_err("out of range").field;
    assert_eq!(field(Settings { tolerance: f64::NAN, ..Settings::default() }), "tolerance");
    assert_eq!(field(Settings { max_iterations: 0, ..Settings::default() }), "max_iterations");
    assert_eq!(field(Settings { samples: 0, ..Settings::default() }), "samples");
    assert_eq!(field(Settings { scales: vec![("x".into(), -1.0)], ..Settings::default() }), "scales");
    assert_eq!(field(Settings { time_limit: Some(Duration::ZERO), ..Settings::default() }), "time_limit");
}
