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
        ntg::ntg_file!("../specs/cosine.ntg");
    }
}

/// The problem of a name, with its spec's own parameters.
pub fn problem(name: &str) -> Option<Box<dyn Problem>> {
    Some(match name {
        "van_der_pol" => Box::new(specs::van_der_pol::VanDerPol::default()),
        "kinematic_car" => Box::new(specs::kinematic_car::KinematicCar::default()),
        "b1" => Box::new(specs::free::Free::default()),
        "b2" => Box::new(specs::flight::LowObservable::default()),
        "b2_cosine" => Box::new(specs::cosine::Cosine::default()),
        _ => return None,
    })
}
