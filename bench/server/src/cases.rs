//! The problems that are compared, each by the name that bench/run gives it.

use ntg::prelude::Problem;

mod specs {
    pub(super) mod van_der_pol {
        ntg::ntg_file!("../../specs/van_der_pol.ntg");
    }
    pub(super) mod kinematic_car {
        ntg::ntg_file!("../../specs/kinematic_car.ntg");
    }
    pub(super) mod flight {
        ntg::ntg_file!("../../specs/low_observable.ntg");
    }
    pub(super) mod free {
        ntg::ntg_file!("../specs/free.ntg");
    }
    pub(super) mod cosine {
        ntg::ntg_file!("../../specs/low_observable_cosine.ntg");
    }
    pub(super) mod phases {
        ntg::ntg_file!("../../specs/low_observable_phases.ntg");
    }
    pub(super) mod phases_cosine {
        ntg::ntg_file!("../../specs/low_observable_phases_cosine.ntg");
    }
    pub(super) mod intercept {
        ntg::ntg_file!("../../specs/missile_intercept.ntg");
    }
    pub(super) mod boost_coast {
        ntg::ntg_file!("../../specs/missile_boost_coast.ntg");
    }
    include!(concat!(env!("OUT_DIR"), "/fleets.rs"));
}

use specs::boost_coast::MissileBoostCoast;
use specs::intercept::MissileIntercept;

/// The problem of a name, with its spec's own parameters where the name says nothing else.
pub fn problem(name: &str) -> Option<Box<dyn Problem>> {
    Some(match name {
        "van_der_pol" => Box::new(specs::van_der_pol::VanDerPol::default()),
        "kinematic_car" => Box::new(specs::kinematic_car::KinematicCar::default()),
        "b1" => Box::new(specs::free::Free::default()),
        "b2" => Box::new(specs::flight::LowObservable::default()),
        "b2_cosine" => Box::new(specs::cosine::LowObservableCosine::default()),
        "b3" => Box::new(specs::phases::LowObservablePhases::default()),
        "b3_cosine" => Box::new(specs::phases_cosine::LowObservablePhasesCosine::default()),
        "intercept_right" => Box::new(MissileIntercept::default()),
        "intercept_left" => Box::new(MissileIntercept { y_via: 0.0, ..MissileIntercept::default() }),
        "boost_coast_300" => Box::new(MissileBoostCoast::default()),
        "boost_coast_30" => Box::new(MissileBoostCoast { a_max: 30.0, ..MissileBoostCoast::default() }),
        _ => return fleet(name),
    })
}

fn fleet(name: &str) -> Option<Box<dyn Problem>> {
    Some(match name {
        "fleet_2" => Box::new(specs::fleet_2::MultiVehicle::default()),
        "fleet_4" => Box::new(specs::fleet_4::MultiVehicle::default()),
        "fleet_8" => Box::new(specs::fleet_8::MultiVehicle::default()),
        "fleet_equal_2" => Box::new(specs::fleet_equal_2::MultiVehicleSimultaneous::default()),
        "fleet_equal_4" => Box::new(specs::fleet_equal_4::MultiVehicleSimultaneous::default()),
        "fleet_equal_8" => Box::new(specs::fleet_equal_8::MultiVehicleSimultaneous::default()),
        "fleet_later_2" => Box::new(specs::fleet_later_2::MultiVehicleLookAfterStrike::default()),
        "fleet_later_4" => Box::new(specs::fleet_later_4::MultiVehicleLookAfterStrike::default()),
        "fleet_later_8" => Box::new(specs::fleet_later_8::MultiVehicleLookAfterStrike::default()),
        "fleet_apart_2" => Box::new(specs::fleet_apart_2::MultiVehicleSeparated::default()),
        "fleet_apart_4" => Box::new(specs::fleet_apart_4::MultiVehicleSeparated::default()),
        "fleet_apart_8" => Box::new(specs::fleet_apart_8::MultiVehicleSeparated::default()),
        _ => return None,
    })
}
