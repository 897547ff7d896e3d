//! Typical sizes of variables and rows (docs/maths.md, section 5).
//!
//! Takes the guess, bounds and units; gives positive numbers. The coefficients of one output in
//! one agent share one size, so that scaling commutes with the spline.

use super::error::SetupError;
use super::instances::{family_len, family_members};
use super::layout::Time;
use super::rows::{RowInfo, RowKind, bound_size};
use super::sizes::SMALL_GUESS;
use super::slots::AffineMap;
use super::{Transcription, names};
use crate::settings::{Scaling, Settings};
use ntg_nlp::multiples;
use ntg_structure::{Family, GuessKind, Unit};
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::ops::Range;

/// Below this fraction of its size a variable says that the size is too large: the tolerance of what it stands in is looser
/// by as much; a size below this fraction of its variable is too small. A law: that of the acceptable end (1e-6) to the default
/// tolerance.
const TOO_LARGE: f64 = 1e-2;

/// At a point that a solve has found, what is below this fraction of its size lies at a bound, which tells no size. A law:
/// the tolerance of a rough solution, which starts on coarser knots have.
const AT_BOUND: f64 = 1e-4;

/// A guess that is such a part of one of the same kind is what rounding leaves of 0, as `50 * cos(90 [deg])` beside
/// `50 * sin(90 [deg])`. A law: from a part of one rounding to a hundred of them; what is smaller is meant.
const ROUNDING: Range<f64> = 2e-17..1e-14;
/// An inferred size that is so many times as large or as small as those of its kind is that of a function that is singular or
/// flat at the guess, as a distance is where two vehicles meet. A choice: such sizes are off by 1e-16 or 1e16.
const OTHER_KIND: f64 = 1e6;

/// An output whose guess varies by such a part of what it is has its size from what it varies by. A choice: from rounding to
/// where a size of either kind serves.
const OFFSET: Range<f64> = 1e-10..1e-3;

/// Whether what lies between two numbers varies by next to nothing beside what it is (docs/maths.md, equation 5.5a).
pub(crate) fn is_beside_offset(low: f64, high: f64) -> bool {
    OFFSET.contains(&((high - low) / low.abs().max(high.abs())))
}

/// What has a size of its own: an output in all phases of an agent, or a variable.
pub(crate) struct Quantity<'a> {
    name: &'a str,
    family: Option<Family>,
    index: Option<i64>,
    pub(crate) unit: &'a Unit,
    /// Of an output its phases, and its number among the outputs of each.
    pub(crate) members: Vec<(usize, usize)>,
    pub(crate) coefficients: Vec<u32>,
}

impl Transcription<'_> {
    /// Sets all sizes from a guess; `Settings::scales` takes precedence.
    ///
    /// # Errors
    /// A name in `Settings::scales` that is nothing's.
    pub fn set_scales(&mut self, guess: &[f64], settings: &Settings) -> Result<(), SetupError> {
        let automatic = settings.scaling != Scaling::Off;
        let mut scale = vec![1.0; self.limits.lower.len()];
        self.origin.clear();
        self.limits.doubtful = vec![];
        if automatic {
            self.origin = self.origins(guess);
            self.limits.doubtful = self.automatic(guess, &mut scale);
        }
        let from_guess = scale.clone();
        for (name, size) in &settings.scales {
            self.named(name, *size, &mut scale)?;
        }
        self.has_named_size = from_guess.iter().zip(&scale).map(|(before, now)| !automatic || before != now).collect();
        self.limits.scale = scale;
        self.limits.row_scale = if automatic { self.row_scales() } else { vec![1.0; self.limits.row_lower.len()] };
        Ok(())
    }

    /// Raises sizes by a point that a solve has found where they are next to nothing beside others: those by the guess of
    /// that solve, or those with which it was solved (docs/maths.md, equation 5.10).
    /// Without scaling, or for another number of variables, nothing is raised.
    pub(crate) fn raise_sizes(&mut self, others: &[f64], settings: &Settings) {
        if settings.scaling == Scaling::Off || others.len() != self.limits.scale.len() {
            return;
        }
        let is_at_bound = |size: f64, other: f64| size < AT_BOUND * other;
        if self.limits.scale.iter().zip(others).any(|(size, other)| is_at_bound(*size, *other)) {
            let raised = |(size, other): (&f64, &f64)| if is_at_bound(*size, *other) { *other } else { *size };
            self.limits.scale = self.limits.scale.iter().zip(others).map(raised).collect();
            self.limits.row_scale = self.row_scales();
        }
    }

    /// Sets all sizes at a point that a solve from a guess has found, see [`Transcription::raise_sizes`].
    ///
    /// # Errors
    /// As [`Transcription::set_scales`].
    pub(crate) fn set_scales_near(&mut self, x: &[f64], guess: &[f64], settings: &Settings) -> Result<(), SetupError> {
        self.set_scales(guess, settings)?;
        let by_guess = std::mem::take(&mut self.limits.scale);
        self.set_scales(x, settings)?;
        self.raise_sizes(&by_guess, settings);
        Ok(())
    }

    /// Sets all sizes at a solution: the larger of those with which it was solved and those that it has. Limits are set.
    pub(crate) fn set_scales_at(&mut self, x: &[f64], solved: &[f64]) {
        let mut scale: Vec<f64> = x.iter().zip(solved).map(|(x, size)| x.abs().max(*size)).collect();
        for agent in &self.model.layout.agents {
            for output in self.outputs_of(agent.phases.clone()) {
                let largest = output.coefficients.iter().map(|v| scale[*v as usize]).fold(0.0, f64::max);
                output.coefficients.iter().for_each(|v| scale[*v as usize] = largest);
            }
        }
        scale.iter_mut().for_each(|size| *size = usable(*size, &Unit::default()));
        self.limits.scale = scale;
        self.limits.row_scale = self.row_scales();
    }

    /// Where outputs begin whose guess varies by next to nothing beside what it is: at its middle (docs/maths.md, equation
    /// 5.5a). Empty where there are none.
    fn origins(&self, guess: &[f64]) -> Vec<f64> {
        let mut origins = vec![];
        for output in self.model.layout.agents.iter().flat_map(|agent| self.outputs_of(agent.phases.clone())) {
            let values = output.coefficients.iter().map(|v| guess[*v as usize]);
            let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (v.min(l), v.max(h)));
            if is_beside_offset(low, high) {
                origins.resize(guess.len(), 0.0);
                output.coefficients.iter().for_each(|v| origins[*v as usize] = f64::midpoint(low, high));
            }
        }
        origins
    }

    /// Equation 5.5: the largest guessed coefficient or guess; else what balances constraints; else the unit. Gives the
    /// variables whose guess says little about their size: it is small beside the unit, or is one unit for want of a guess.
    fn automatic(&self, guess: &[f64], scale: &mut [f64]) -> Vec<bool> {
        let (structure, layout) = (&self.model.structure, &self.model.layout);
        let agents = layout.agents.iter();
        let outputs: Vec<Quantity> = agents.flat_map(|agent| self.outputs_of(agent.phases.clone())).collect();
        let variables = structure.variables.iter().zip(&layout.variable_first).flat_map(|(declared, first)| {
            family_members(declared.family).into_iter().zip(*first..).map(|(index, variable)| Quantity {
                name: &declared.name,
                family: declared.family,
                index,
                unit: &declared.unit,
                members: vec![],
                coefficients: vec![variable],
            })
        });
        let (count, mut quantities) = (outputs.len(), outputs);
        quantities.extend(variables);
        let mut guess = guess.to_vec();
        let from_origin = |known: &[f64]| -> Vec<f64> {
            let origins = self.origin.iter().copied().chain(std::iter::repeat(0.0));
            known.iter().zip(origins).map(|(value, origin)| value - origin).collect()
        };
        let largest = |quantity: &Quantity, of: &[f64]| {
            quantity.coefficients.iter().map(|v| of[*v as usize].abs()).fold(0.0, f64::max)
        };
        let beside = from_origin(&guess);
        let mut guessed: Vec<f64> = quantities.iter().map(|one| largest(one, &beside)).collect();
        let kinds = Kinds::of(quantities.iter().zip(guessed.iter().copied()));
        for (quantity, guessed) in quantities.iter().zip(&mut guessed) {
            if kinds.range(quantity).is_some_and(|(_, most)| ROUNDING.contains(&(*guessed / most))) {
                *guessed = 0.0;
                quantity.coefficients.iter().for_each(|v| guess[*v as usize] = 0.0);
            }
        }
        let bound = |variable: usize| bound_size((self.limits.lower[variable], self.limits.upper[variable]));
        let own = |variable: usize| if guess[variable] == 0.0 { bound(variable) } else { guess[variable].abs() };
        for (variable, scale) in scale.iter_mut().enumerate().skip(layout.coefficients) {
            *scale = usable(own(variable), &Unit::default());
        }
        let (outputs, variables) = quantities.split_at(count);
        for (output, guessed) in outputs.iter().zip(&guessed) {
            let size = usable(*guessed, output.unit);
            output.coefficients.iter().for_each(|v| scale[*v as usize] = size);
        }
        for variable in variables {
            let only = variable.coefficients[0] as usize;
            scale[only] = usable(own(only), variable.unit);
        }
        let groups: Vec<Vec<u32>> = outputs.iter().map(|output| output.coefficients.clone()).collect();
        // One unit everywhere is what nobody has guessed above 0 (section 8.1), and no size of its own; where a boundary condition or
        // the guess of a variable says so, it is.
        let is_fixed = |v: &u32| self.linear.value(&AffineMap { terms: vec![(*v, 1.0)], offset: 0.0 }).is_some();
        let is_unit = |o: &&Quantity| o.coefficients.iter().all(|v| guess[*v as usize] == o.unit.factor);
        let (mut known, mut doubtful) = (guess.clone(), vec![false; guess.len()]);
        let is_small = |(quantity, guessed): &(&Quantity, &f64)| **guessed < SMALL_GUESS * quantity.unit.factor;
        let small = quantities.iter().zip(&guessed).filter(is_small).map(|(quantity, _)| quantity);
        for quantity in small.chain(quantities.iter().filter(is_unit)) {
            quantity.coefficients.iter().for_each(|v| doubtful[*v as usize] = true);
        }
        let told = structure.guesses.iter().filter_map(|guess| match &guess.kind {
            GuessKind::Variable { variable, .. } => Some(&*structure.variables.get(*variable)?.name),
            _ => None,
        });
        let told: HashSet<&str> = told.collect(); // Looked up, never iterated.
        let is_guessed = |quantity: &Quantity| quantity.members.is_empty() && told.contains(quantity.name);
        let is_told = |quantity: &&Quantity| quantity.coefficients.iter().any(is_fixed) || is_guessed(quantity);
        for quantity in quantities.iter().filter(is_unit).filter(|quantity| !is_told(quantity)) {
            quantity.coefficients.iter().for_each(|v| known[*v as usize] = 0.0);
        }
        // Its own bound would tell it there; where functions have no slopes at the bound, so it is.
        let sizes = from_origin(&known);
        if !self.balance_sizes(&groups, (&known, &sizes), scale) {
            self.balance_sizes(&groups, (&guess, &sizes), scale);
        }
        let sizes: Vec<f64> = quantities.iter().map(|quantity| largest(quantity, scale)).collect();
        // One unit for want of a guess is no example of its kind.
        let is_example = |quantity: &&Quantity| !is_unit(quantity) || is_told(quantity);
        let own = quantities.iter().zip(guessed.iter().zip(&sizes)).map(|(quantity, (guessed, size))| {
            (quantity, if guessed == size && is_example(&quantity) { *size } else { 0.0 })
        });
        let kinds = Kinds::of(own);
        for ((quantity, guessed), size) in quantities.iter().zip(&guessed).zip(sizes) {
            let Some((least, most)) = kinds.range(quantity).filter(|_| *guessed != size) else { continue };
            // What has a guess, however small, is of the kind; what has none may differ by more.
            let beyond = if *guessed > 0.0 { 1.0 } else { OTHER_KIND };
            if size * OTHER_KIND < least || size > beyond * most {
                let size = size.clamp(least, most);
                quantity.coefficients.iter().for_each(|v| scale[*v as usize] = size);
            }
        }
        let is_helper = |quantity: &&Quantity| is_unit(quantity) && ntg_structure::is_helper(quantity.name);
        let mut helpers = outputs.iter().filter(is_helper).map(|own| own.coefficients.clone()).collect::<Vec<_>>();
        helpers.extend(self.declared_helpers().filter(|v| guess[*v as usize] == 0.0).map(|v| vec![v]));
        if !helpers.is_empty() {
            let sizes = self.helper_sizes(&helpers, &guess, scale);
            let found = helpers.iter().zip(sizes).filter_map(|(own, size)| Some((own, size?)));
            found.for_each(|(own, size)| own.iter().for_each(|v| scale[*v as usize] = size));
        }
        doubtful
    }

    /// Gives helpers that nobody has guessed, which are one unit everywhere or declared and 0, their size: at the tip of a cone,
    /// where one unit is next to nothing, it tells no direction. Afterwards their size by the guess is the same.
    pub(crate) fn guess_helpers(&self, x: &mut [f64]) {
        let helpers: BTreeSet<u32> = self.helpers().collect();
        for (own, unit) in self.groups() {
            if own.iter().all(|v| x[*v as usize] == unit && helpers.contains(v)) {
                own.iter().for_each(|v| x[*v as usize] = self.limits.scale[*v as usize]);
            }
        }
        let declared: Vec<Vec<u32>> =
            self.declared_helpers().filter(|v| x[*v as usize] == 0.0).map(|v| vec![v]).collect();
        if declared.is_empty() {
            return;
        }
        let of_cones = self.helper_sizes(&declared, x, &self.limits.scale);
        for (own, _) in declared.iter().zip(of_cones).filter(|(_, size)| size.is_some()) {
            own.iter().for_each(|v| x[*v as usize] = self.limits.scale[*v as usize]);
        }
    }

    /// Replaces sizes that a point shows to be too large, if it is a solution (docs/maths.md, section 11.12): what a solution
    /// is judged by.
    pub fn take_smaller_sizes(&mut self, x: &[f64]) {
        if let Some(sizes) = self.smaller_sizes(x) {
            self.limits.scale = sizes;
            self.limits.row_scale = self.row_scales();
        }
    }

    /// Smaller sizes, where a solution shows that the guess told too large ones: the larger of what balances constraints at
    /// `x` and what the variables are there, where that is below a part of the size that they have. None where no size is so
    /// much too large. What would be `NOTHING` beside its bound or unit is rounding of 0.
    pub(crate) fn smaller_sizes(&self, x: &[f64]) -> Option<Vec<f64>> {
        const NOTHING: f64 = 1e-8;
        let scale = &self.limits.scale;
        let groups = self.groups();
        let mut largest: Vec<f64> = x.iter().map(|x| x.abs()).collect();
        for (group, _) in &groups {
            let most = group.iter().map(|v| largest[*v as usize]).fold(0.0, f64::max);
            group.iter().for_each(|v| largest[*v as usize] = most);
        }
        let is_small =
            |v: usize| !self.has_named_size.get(v).is_some_and(|named| *named) && largest[v] < TOO_LARGE * scale[v];
        if !(0..scale.len()).any(is_small) {
            return None;
        }
        // What balances constraints at `x`, where all other sizes are known.
        let known: Vec<f64> = (0..scale.len()).map(|v| if is_small(v) { 0.0 } else { scale[v] }).collect();
        let mut balanced = vec![0.0; scale.len()];
        self.balance_sizes(&self.output_groups(), (x, &known), &mut balanced);
        let units = self.units();
        let smaller = |v: usize| {
            let size = balanced[v].max(largest[v]);
            let least = match bound_size((self.limits.lower[v], self.limits.upper[v])) {
                0.0 => units[v],
                bound => bound,
            };
            (is_small(v) && size < TOO_LARGE * scale[v] && size > NOTHING * least).then_some(size)
        };
        let sizes: Vec<Option<f64>> = (0..scale.len()).map(smaller).collect();
        let differs = sizes.iter().any(Option::is_some);
        differs.then(|| sizes.into_iter().zip(scale).map(|(smaller, size)| smaller.unwrap_or(*size)).collect())
    }

    /// The size of each variable, or what the variables that share it are at a solution, where that is so many times as large
    /// that the guess told too small a one: what rounding of the solution is judged by.
    pub(crate) fn grown_sizes(&self, x: &[f64]) -> Vec<f64> {
        let scale = &self.limits.scale;
        let scaled: Vec<f64> = x.iter().zip(scale).map(|(x, size)| x / size).collect();
        let grown = |(multiple, size): (f64, &f64)| if TOO_LARGE * multiple > 1.0 { multiple * size } else { *size };
        multiples(&self.limits, &scaled).into_iter().zip(scale).map(grown).collect()
    }

    /// The coefficients of each output.
    pub(super) fn output_groups(&self) -> Vec<Vec<u32>> {
        self.groups().into_iter().map(|(group, _)| group).collect()
    }

    /// The coefficients of each output, and its unit.
    fn groups(&self) -> Vec<(Vec<u32>, f64)> {
        let agents = self.model.layout.agents.iter();
        let outputs = agents.flat_map(|agent| self.outputs_of(agent.phases.clone()));
        outputs.map(|output| (output.coefficients, output.unit.factor)).collect()
    }

    /// The unit of each variable: that of its output or declaration.
    pub(crate) fn units(&self) -> Vec<f64> {
        let mut units = vec![1.0; self.limits.lower.len()];
        self.groups().into_iter().for_each(|(group, unit)| group.iter().for_each(|v| units[*v as usize] = unit));
        let (structure, layout) = (&self.model.structure, &self.model.layout);
        for (declared, first) in structure.variables.iter().zip(&layout.variable_first) {
            let own = units.iter_mut().skip(*first as usize).take(family_len(declared.family));
            own.for_each(|unit| *unit = declared.unit.factor);
        }
        units
    }

    /// The number of the size of each variable: the coefficients of one output in one agent share theirs.
    pub(super) fn alike(&self) -> Vec<u32> {
        let mut alike: Vec<u32> = (0..).take(self.limits.lower.len()).collect();
        for agent in &self.model.layout.agents {
            for output in self.outputs_of(agent.phases.clone()) {
                let Some(first) = output.coefficients.first() else { continue };
                output.coefficients.iter().for_each(|v| alike[*v as usize] = *first);
            }
        }
        alike
    }

    /// Every output of some phases once, with the coefficients of all of them.
    pub(crate) fn outputs_of(&self, phases: Range<usize>) -> Vec<Quantity<'_>> {
        let mut found: Vec<Quantity> = vec![];
        let mut known: HashMap<(&str, Option<i64>), usize> = HashMap::new(); // Looked up, never iterated.
        for phase in phases {
            let member = &self.model.layout.phases[phase];
            for (number, output) in member.outputs.iter().enumerate() {
                let declared = &self.model.structure.phases[member.phase].outputs[output.output];
                let at = *known.entry((&declared.name, output.index)).or_insert_with(|| {
                    found.push(Quantity {
                        name: &declared.name,
                        family: declared.family,
                        index: output.index,
                        unit: &declared.unit,
                        members: vec![],
                        coefficients: vec![],
                    });
                    found.len() - 1
                });
                found[at].members.push((phase, number));
                found[at].coefficients.extend(&output.coefficients);
            }
        }
        found
    }

    /// Equation 5.6: the larger bound; else the unit.
    fn row_scales(&self) -> Vec<f64> {
        let limits = &self.limits;
        let bounds = limits.row_lower.iter().zip(&limits.row_upper);
        let size = |((lower, upper), info): ((&f64, &f64), &RowInfo)| {
            let bound = bound_size((*lower, *upper));
            match info.kind {
                RowKind::Constraint(c) => usable(bound, &self.model.structure.constraints[c].unit),
                RowKind::Integral(_) => {
                    let (block, element, _) = info.maker;
                    let variable = self.elements.blocks[block].variables(element)[0];
                    limits.scale.get(variable as usize).copied().unwrap_or(1.0)
                }
            }
        };
        bounds.zip(&self.elements.rows).map(size).collect()
    }

    /// Sets the size of everything that a name means: outputs, variables, durations.
    fn named(&self, name: &str, size: f64, scale: &mut [f64]) -> Result<(), SetupError> {
        let (structure, layout) = (&self.model.structure, &self.model.layout);
        let mut found = false;
        for (agent, member) in layout.agents.iter().enumerate() {
            let path = names::agent(structure, layout, agent);
            for output in self.outputs_of(member.phases.clone()) {
                if names::means_member(name, &path, (output.name, output.family), output.index) {
                    found = true;
                    output.coefficients.iter().for_each(|v| scale[*v as usize] = size * output.unit.factor);
                }
            }
            if let Time::Free(variable) = member.start
                && names::means(name, &path, "start", None)
            {
                found = true;
                scale[variable as usize] = size;
            }
        }
        for (phase, member) in layout.phases.iter().enumerate() {
            if let Time::Free(variable) = member.duration
                && names::means_duration(structure, layout, name, phase)
            {
                found = true;
                scale[variable as usize] = size;
            }
        }
        for (declared, first) in structure.variables.iter().zip(&layout.variable_first) {
            for (member, index) in family_members(declared.family).into_iter().enumerate() {
                if names::means_member(name, "", (&declared.name, declared.family), index) {
                    found = true;
                    scale[*first as usize + member] = size * declared.unit.factor;
                }
            }
        }
        if found { Ok(()) } else { Err(names::unknown("a typical size", name, structure)) }
    }
}

/// The least and the largest sizes of what is of one kind: members of one array, or quantities with one unit.
#[derive(Default)]
struct Kinds<'a> {
    by_name: BTreeMap<&'a str, (f64, f64)>,
    by_unit: BTreeMap<&'a str, (f64, f64)>,
}

impl<'a> Kinds<'a> {
    /// Of quantities whose sizes are known; 0 is none.
    fn of(sizes: impl Iterator<Item = (&'a Quantity<'a>, f64)>) -> Self {
        let mut kinds = Self::default();
        for (quantity, size) in sizes.filter(|(_, size)| *size > 0.0) {
            let add = |ranges: &mut BTreeMap<&'a str, (f64, f64)>, kind| {
                let range = ranges.entry(kind).or_insert((size, size));
                *range = (range.0.min(size), range.1.max(size));
            };
            add(&mut kinds.by_name, quantity.name);
            if !quantity.unit.symbol.is_empty() {
                add(&mut kinds.by_unit, &quantity.unit.symbol);
            }
        }
        kinds
    }

    /// The range of sizes of the kind of a quantity; none where there are none.
    fn range(&self, quantity: &Quantity) -> Option<(f64, f64)> {
        let ranges = [self.by_name.get(quantity.name), self.by_unit.get(&quantity.unit.symbol[..])];
        ranges.into_iter().flatten().copied().reduce(|one, other| (one.0.min(other.0), one.1.max(other.1)))
    }
}

/// A size that can be divided by: the given one if it is positive and finite, else the unit.
fn usable(size: f64, unit: &Unit) -> f64 {
    if size > f64::MIN_POSITIVE && size.is_finite() { size } else { unit.factor }
}
