//! A row of a kernel as a function of the place alone.
//!
//! Takes a call with the values of its loops' indices; gives a row's values at any positions, if nothing but one mover's
//! position, parameters and indices goes into it. What goes into other rows of the kernel alone has any value.

use ntg_runtime::problem::Problem;
use ntg_runtime::splines::Table;
use ntg_runtime::structure::{Affine, At, Call, Data, Loop, PhaseRef, ReduceOp, Slot, Structure};

use crate::run::Scene;

/// What all fields of a problem share.
pub(super) struct Space<'a> {
    pub(super) problem: &'a dyn Problem,
    pub(super) structure: &'a Structure,
    pub(super) tables: &'a [Table],
    pub(super) scene: &'a Scene,
    /// SI units in one unit of each coordinate.
    pub(super) factors: Vec<f64>,
}

/// A function of the place.
pub(super) struct Field<'a> {
    space: &'a Space<'a>,
    call: &'a Call,
    row: usize,
    indices: Vec<i64>,
    /// Whether it depends on a coordinate.
    pub(super) depends: Vec<bool>,
}

/// The values of all indices for every member of nested loops.
pub(super) fn members(loops: &[Loop]) -> Vec<Vec<i64>> {
    let mut members = vec![vec![]];
    for one in loops {
        let inside = |outer: Vec<i64>| {
            let range = one.first.at(&outer)..=one.last.at(&outer);
            range.map(move |value| outer.iter().copied().chain([value]).collect::<Vec<i64>>())
        };
        members = members.into_iter().flat_map(inside).collect();
    }
    members
}

/// `x[2]` and `uav[1].` of a slot.
fn path(structure: &Structure, phase: &PhaseRef, output: usize, index: Option<i64>, indices: &[i64]) -> Option<String> {
    let declared = structure.phases.get(phase.phase)?;
    let agent = structure.agents.get(declared.agent)?;
    let indexed = |name: &str, index: Option<i64>| index.map_or_else(|| name.to_owned(), |i| format!("{name}[{i}]"));
    let output = declared.outputs.get(output)?;
    let own = match (output.family, index) {
        (Some(family), Some(index)) => format!("{}{}", output.name, family.index(index)),
        _ => indexed(&output.name, index),
    };
    let member = agent.family.and(phase.agent.as_ref()).map(|form| form.at(indices));
    Some(agent.name.as_ref().map_or_else(|| own.clone(), |name| format!("{}.{own}", indexed(name, member))))
}

impl<'a> Space<'a> {
    /// A row of a call as a function of the place; none where it is of something else, too.
    pub(super) fn field(&'a self, call: &'a Call, row: usize, indices: Vec<i64>) -> Option<Field<'a>> {
        let mut field = Field { space: self, call, row, indices, depends: vec![false; self.scene.axes.len()] };
        let mut mover = None;
        let indices = field.indices.clone();
        let into = |input: usize| self.enters(call.kernel, row, input);
        field.look((call, &into), &indices, &mut mover)?;
        (field.depends.contains(&true) && field.is_still()).then_some(field)
    }

    /// Whether an input goes into a row. A kernel that is only shown has no derivatives, and one row.
    fn enters(&self, kernel: usize, row: usize, input: usize) -> bool {
        let kernel = self.structure.kernels.get(kernel);
        kernel.is_none_or(|kernel| kernel.jacobian.is_empty() || kernel.jacobian.contains(&(row, input)))
    }

    /// The values of a call without slots: parameters and indices alone.
    pub(super) fn numbers(&self, call: &Call, indices: &[i64]) -> Option<Vec<f64>> {
        if !call.slots.is_empty() || !call.reductions.is_empty() {
            return None;
        }
        let inputs: Vec<f64> = call.data.iter().map(|data| self.data(data, indices)).collect::<Option<_>>()?;
        let mut values = vec![f64::NAN; self.structure.kernels.get(call.kernel)?.rows];
        self.problem.values(call.kernel, 1, &inputs, self.tables, &mut values);
        Some(values)
    }

    fn data(&self, data: &Data, indices: &[i64]) -> Option<f64> {
        match data {
            Data::Parameter { parameter, index } => {
                let member = index.as_ref().map_or(1, |form| form.at(indices));
                let value = &self.structure.parameters.get(*parameter)?.value;
                value.get(usize::try_from(member - 1).ok()?).copied()
            }
            Data::Index(form) => Some(form.at(indices) as f64),
            Data::Tau | Data::TauWithin | Data::Duration(_) | Data::Start(_) => None,
        }
    }

    /// Which mover and which of its coordinates a slot is.
    fn coordinate(&self, slot: &Slot, indices: &[i64]) -> Option<(usize, usize)> {
        let Slot::Flat { phase, at: At::Here, output, index, derivative: 0 } = slot else { return None };
        let index = index.as_ref().map(|form: &Affine| form.at(indices));
        let path = path(self.structure, phase, *output, index, indices)?;
        let tracks = self.scene.tracks.iter().enumerate();
        tracks
            .filter_map(|(mover, track)| track.paths.iter().position(|own| *own == path).map(|axis| (mover, axis)))
            .next()
    }
}

impl Field<'_> {
    /// Finds what goes into a call; none where that is more than a place.
    fn look(
        &mut self,
        (call, enters): (&Call, &dyn Fn(usize) -> bool),
        indices: &[i64],
        mover: &mut Option<usize>,
    ) -> Option<()> {
        for (_, slot) in call.slots.iter().enumerate().filter(|(input, _)| enters(*input)) {
            let (whose, axis) = self.space.coordinate(slot, indices)?;
            if *mover.get_or_insert(whose) != whose {
                return None;
            }
            self.depends[axis] = true;
        }
        for (number, reduction) in call.reductions.iter().enumerate() {
            if enters(call.slots.len() + number) {
                for member in inside(&reduction.over, indices) {
                    self.look((&reduction.body, &|_| true), &member, mover)?;
                }
            }
        }
        Some(())
    }

    /// Whether it stays the same whatever is put where time and durations go in.
    fn is_still(&self) -> bool {
        let somewhere = [[0.3; 3], [-0.7, 1.1, 0.4]];
        let values = |filler: f64| self.filled(&somewhere, filler);
        let bits = |values: Vec<f64>| values.into_iter().map(f64::to_bits).collect::<Vec<u64>>();
        bits(values(0.25)) == bits(values(0.75))
    }

    /// The row at each position, SI. Positions are in the units of the coordinates.
    pub(super) fn values(&self, positions: &[[f64; 3]]) -> Vec<f64> {
        self.filled(positions, 0.5)
    }

    fn filled(&self, positions: &[[f64; 3]], filler: f64) -> Vec<f64> {
        let rows = self.evaluate(self.call, &self.indices, (positions, filler));
        let own = self.row * positions.len();
        rows.get(own..own + positions.len()).map_or_else(|| vec![f64::NAN; positions.len()], <[f64]>::to_vec)
    }

    /// All rows: `rows * positions` numbers, row by row; unknown inputs have one value.
    fn evaluate(&self, call: &Call, indices: &[i64], (positions, filler): (&[[f64; 3]], f64)) -> Vec<f64> {
        let lanes = positions.len();
        let mut inputs = Vec::with_capacity((call.slots.len() + call.reductions.len() + call.data.len()) * lanes);
        for slot in &call.slots {
            match self.space.coordinate(slot, indices) {
                Some((_, axis)) => inputs.extend(positions.iter().map(|at| at[axis] * self.space.factors[axis])),
                None => inputs.extend(std::iter::repeat_n(filler, lanes)),
            }
        }
        for reduction in &call.reductions {
            let (empty, join): (f64, fn(f64, f64) -> f64) = match reduction.op {
                ReduceOp::Sum => (0.0, |a, b| a + b),
                ReduceOp::Product => (1.0, |a, b| a * b),
                ReduceOp::Min => (f64::INFINITY, f64::min),
                ReduceOp::Max => (f64::NEG_INFINITY, f64::max),
            };
            let mut joined = vec![];
            for member in inside(&reduction.over, indices) {
                let values = self.evaluate(&reduction.body, &member, (positions, filler));
                joined = match joined.is_empty() {
                    true => values[..lanes].to_vec(),
                    false => joined.iter().zip(&values).map(|(a, b)| join(*a, *b)).collect(),
                };
            }
            joined.resize(lanes, empty);
            inputs.extend(joined);
        }
        for data in &call.data {
            let value = self.space.data(data, indices).unwrap_or(filler);
            inputs.extend(std::iter::repeat_n(value, lanes));
        }
        let rows = self.space.structure.kernels.get(call.kernel).map_or(0, |kernel| kernel.rows);
        let mut values = vec![f64::NAN; rows * lanes];
        self.space.problem.values(call.kernel, lanes, &inputs, self.space.tables, &mut values);
        values
    }
}

/// The indices of each member of one more loop.
fn inside<'i>(over: &Loop, indices: &'i [i64]) -> impl Iterator<Item = Vec<i64>> + use<'i> {
    (over.first.at(indices)..=over.last.at(indices)).map(|value| indices.iter().copied().chain([value]).collect())
}
