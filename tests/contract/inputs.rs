//! Random inputs for kernels, of the sizes that a solve would give them.

use ntg::runtime::structure::{Call, Data, Kernel, Slot, Structure};

/// Inputs and weights for several lanes.
#[derive(Clone)]
pub(crate) struct Sample {
    pub(crate) lanes: usize,
    pub(crate) inputs: Vec<f64>,
    pub(crate) weights: Vec<f64>,
}

/// A small generator of reproducible numbers in -1 .. 1 (xorshift64*, Vigna 2016).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let bits = self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11;
        bits as f64 / (1u64 << 52) as f64 - 1.0
    }
}

impl Sample {
    /// Inputs for one kernel: parameters have their values, flat outputs the size of some dozens
    /// of their units, times hundreds of seconds.
    pub(crate) fn new(structure: &Structure, kernel: usize, lanes: usize, seed: u64) -> Self {
        let mut random = Random(0x9E37_79B9_7F4A_7C15 ^ (seed << 32) ^ kernel as u64);
        random.next();
        let shape = &structure.kernels[kernel];
        let mut inputs = Vec::new();
        let call = find(structure, kernel).unwrap_or_else(|| panic!("no call of kernel {}", shape.name));
        for slot in &call.slots {
            for _ in 0..lanes {
                let r = random.next();
                inputs.push(match slot {
                    Slot::Flat { phase, output, .. } => {
                        let unit = &structure.phases[phase.phase].outputs[*output].unit;
                        60.0 * unit.factor * if r.abs() < 0.05 { 0.05 } else { r }
                    }
                    Slot::Duration(_) | Slot::Start(_) => 300.0 + 200.0 * r,
                    Slot::Variable { .. } | Slot::Integral { .. } => 1.0 + 0.5 * r,
                });
            }
        }
        for _ in 0..call.reductions.len() * lanes {
            inputs.push(1.0 + 0.5 * random.next());
        }
        for data in &call.data {
            for _ in 0..lanes {
                let r = random.next();
                inputs.push(match data {
                    Data::Parameter { parameter, .. } => structure.parameters[*parameter].value[0],
                    Data::Index(affine) => affine.at(&[1, 1, 1]) as f64,
                    Data::Tau | Data::TauWithin => 0.5 + 0.5 * r,
                    Data::Duration(_) | Data::Start(_) => 5.0 + r,
                });
            }
        }
        let weights = (0..shape.rows * lanes).map(|_| random.next()).collect();
        assert_eq!(inputs.len(), (shape.slots + shape.data) * lanes, "{}", shape.name);
        Self { lanes, inputs, weights }
    }

    /// The inputs with one slot lowered and raised, and the distance between the two, lane by lane.
    pub(crate) fn around(&self, slot: usize, step: f64) -> (Self, Self, Vec<f64>) {
        let (mut low, mut high) = (self.clone(), self.clone());
        let mut distance = Vec::new();
        for lane in 0..self.lanes {
            let index = slot * self.lanes + lane;
            let h = step * self.inputs[index].abs().max(1e-3);
            low.inputs[index] -= h;
            high.inputs[index] += h;
            distance.push(high.inputs[index] - low.inputs[index]);
        }
        (low, high, distance)
    }
}

/// Some call of a kernel, wherever it stands.
fn find(structure: &Structure, kernel: usize) -> Option<&Call> {
    fn inside(call: &Call, kernel: usize) -> Option<&Call> {
        if call.kernel == kernel {
            return Some(call);
        }
        call.reductions.iter().find_map(|r| inside(&r.body, kernel))
    }
    use ntg::runtime::structure::{Duration, GuessKind, Start};
    let groups = structure.groups.iter().chain(&structure.shown).flat_map(|g| g.bounds.iter().chain([&g.call]));
    let named = structure.named.iter().map(|n| &n.call).chain(structure.arguments.iter().map(|own| &own.call));
    let durations = structure.phases.iter().filter_map(|p| match &p.duration {
        Duration::Fixed(call) => Some(call),
        Duration::Free(bounds) => bounds.call.as_ref(),
    });
    let starts = structure.agents.iter().filter_map(|a| match &a.start {
        Start::Fixed(call) => call.as_ref(),
        Start::Free(bounds) => bounds.call.as_ref(),
    });
    let variables = structure.variables.iter().filter_map(|v| v.bounds.call.as_ref());
    let guesses = structure.guesses.iter().map(|g| match &g.kind {
        GuessKind::Output { value, .. }
        | GuessKind::Duration { value }
        | GuessKind::Variable { value, .. }
        | GuessKind::Start { value } => value,
        GuessKind::Route { values, .. } => values,
    });
    let measured = structure.measurements.iter().flat_map(|m| [&m.residual, &m.sigma]);
    let mut calls = groups.chain(named).chain(measured).chain(durations).chain(starts).chain(variables).chain(guesses);
    calls.find_map(|call| inside(call, kernel))
}

/// The derivative of the weighted sum of a kernel's rows with respect to one slot.
pub(crate) fn weighted(kernel: &Kernel, jacobian: &[f64], sample: &Sample, slot: usize, lane: usize) -> f64 {
    let entries = kernel.jacobian.iter().enumerate().filter(|(_, (_, of))| *of == slot);
    entries
        .map(|(entry, (row, _))| sample.weights[row * sample.lanes + lane] * jacobian[entry * sample.lanes + lane])
        .sum()
}

/// Asserts that two numbers agree, relative to their size or absolutely. Points at which either is
/// not finite are points outside the functions' domain. What is compared is told when it differs: there are millions.
#[track_caller]
pub(crate) fn close(wanted: f64, found: f64, relative: f64, absolute: f64, what: impl FnOnce() -> String) {
    if wanted.is_finite() && found.is_finite() {
        let error = (wanted - found).abs();
        let allowed = relative * wanted.abs().max(found.abs()) + absolute;
        assert!(error <= allowed, "{}: {wanted} but {found}, off by {error:e}, allowed {allowed:e}", what());
    }
}
