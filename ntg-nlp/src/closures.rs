//! Programs whose element functions are closures.
//!
//! A [`Program`] is the shortest way to the solver: [`Program::dense`] takes bounds and one closure that writes values,
//! gradients and Hessians of all functions; [`Program::add_block`] adds elements of any structure. Derivatives are the
//! caller's, so they may come from anywhere: by hand, by automatic differentiation, from a model.

use crate::contract::{Block, BlockValues, Entry, Evaluation, Limits, Nlp, NotFinite, Target};

/// What a closure writes: values, gradients and Hessians of the functions of one element by its slots. All are zero
/// before the closure is called.
#[derive(Clone, Debug)]
pub struct Functions {
    slots: usize,
    values: Vec<f64>,
    gradients: Vec<f64>,
    hessians: Vec<f64>,
}

impl Functions {
    /// Room for `rows` functions of `slots` numbers.
    fn new(slots: usize, rows: usize) -> Self {
        Self {
            slots,
            values: vec![0.0; rows],
            gradients: vec![0.0; rows * slots],
            hessians: vec![0.0; rows * slots * slots],
        }
    }

    /// Sets all numbers to zero.
    fn clear(&mut self) {
        self.values.fill(0.0);
        self.gradients.fill(0.0);
        self.hessians.fill(0.0);
    }

    /// Sets the value of a function.
    pub fn set_value(&mut self, row: usize, value: f64) {
        self.values[row] = value;
    }

    /// Sets the gradient of a function: one number a slot.
    pub fn set_gradient(&mut self, row: usize, gradient: &[f64]) {
        self.gradient_mut(row).copy_from_slice(gradient);
    }

    /// Sets the Hessian of a function: a symmetric matrix, row by row, of which the lower triangle is read.
    pub fn set_hessian(&mut self, row: usize, hessian: &[f64]) {
        self.hessian_mut(row).copy_from_slice(hessian);
    }

    /// The gradient of a function, to be written in place.
    pub fn gradient_mut(&mut self, row: usize) -> &mut [f64] {
        &mut self.gradients[row * self.slots..(row + 1) * self.slots]
    }

    /// The Hessian of a function, row by row, to be written in place.
    pub fn hessian_mut(&mut self, row: usize) -> &mut [f64] {
        let size = self.slots * self.slots;
        &mut self.hessians[row * size..(row + 1) * size]
    }
}

/// The functions of the elements of one block: from slots to values and derivatives.
type Closure = Box<dyn Fn(&[f64], &mut Functions) + Sync>;

/// One element: `slots = map x[variables] + offset`.
#[derive(Clone, Debug)]
pub struct Element {
    /// Indices of the program's variables, distinct and increasing.
    pub variables: Vec<u32>,
    /// One row a slot, one column a variable, row by row.
    pub map: Vec<f64>,
    /// The constant part of each slot.
    pub offset: Vec<f64>,
    /// Where each function goes.
    pub target: Vec<Target>,
    /// The factor of each function.
    pub weight: Vec<f64>,
}

/// A program made of closures.
pub struct Program {
    blocks: Vec<Block>,
    functions: Vec<Closure>,
    /// Bounds and typical sizes. Sizes are 1 unless the caller sets them.
    pub limits: Limits,
}

impl Program {
    /// A program without functions: `(lower, upper)` bounds of the variables and of the constraint rows.
    pub fn new(bounds: &[(f64, f64)], row_bounds: &[(f64, f64)]) -> Self {
        let (lower, upper) = bounds.iter().copied().unzip();
        let (row_lower, row_upper) = row_bounds.iter().copied().unzip();
        let (scale, row_scale) = (vec![1.0; bounds.len()], vec![1.0; row_bounds.len()]);
        let limits = Limits { lower, upper, scale, row_lower, row_upper, row_scale, ..Limits::default() };
        Self { blocks: Vec::new(), functions: Vec::new(), limits }
    }

    /// A program without structure: the closure writes the objective as function 0 and constraint `i` as function
    /// `i + 1`, of all variables.
    pub fn dense(
        bounds: &[(f64, f64)],
        row_bounds: &[(f64, f64)],
        functions: impl Fn(&[f64], &mut Functions) + Sync + 'static,
    ) -> Self {
        let (n, m) = (bounds.len(), row_bounds.len());
        let element = Element {
            variables: (0..n as u32).collect(),
            map: (0..n * n).map(|at| if at / n == at % n { 1.0 } else { 0.0 }).collect(),
            offset: vec![0.0; n],
            target: (0..=m as u32).map(|i| if i == 0 { Target::Objective } else { Target::Row(i - 1) }).collect(),
            weight: vec![1.0; m + 1],
        };
        let mut program = Self::new(bounds, row_bounds);
        program.add_block(n, m + 1, &[element], functions);
        program
    }

    /// Adds elements with the same `rows` functions of `slots` internal variables.
    pub fn add_block(
        &mut self,
        slots: usize,
        rows: usize,
        elements: &[Element],
        functions: impl Fn(&[f64], &mut Functions) + Sync + 'static,
    ) {
        let mut block = Block {
            elements: elements.len(),
            slots,
            rows,
            jacobian: (0..rows).flat_map(|row| (0..slots).map(move |slot| (row, slot))).collect(),
            hessian: (0..slots).flat_map(|i| (0..=i).map(move |j| (i, j))).collect(),
            variable_start: vec![0],
            map_start: vec![0],
            ..Block::default()
        };
        for element in elements {
            block.variables.extend(&element.variables);
            block.variable_start.push(block.variables.len());
            block.map.extend(&element.map);
            block.map_start.push(block.map.len());
        }
        block.offset = (0..slots).flat_map(|slot| elements.iter().map(move |e| e.offset[slot])).collect();
        block.target = (0..rows).flat_map(|row| elements.iter().map(move |e| e.target[row])).collect();
        block.weight = (0..rows).flat_map(|row| elements.iter().map(move |e| e.weight[row])).collect();
        self.blocks.push(block);
        self.functions.push(Box::new(functions));
    }

    /// Evaluates all elements; derivatives where the weights of the second ones are given.
    fn evaluate(
        &self,
        x: &[f64],
        weights: Option<(f64, &[f64])>,
        work: &mut [Work],
        out: &mut Evaluation,
    ) -> Result<(), NotFinite> {
        out.objective = 0.0;
        out.rows.fill(0.0);
        for (number, (block, work)) in self.blocks.iter().zip(work).enumerate() {
            for e in 0..block.elements {
                work.place(block, e, x);
                work.functions.clear();
                (self.functions[number])(&work.slots, &mut work.functions);
                work.add_values(block, e, out, number);
                if let Some((objective, rows)) = weights {
                    work.add_derivatives(block, e, objective, rows, &mut out.blocks[number]);
                }
            }
            let values = &out.blocks[number];
            check(number, block, values, weights.is_some())?;
        }
        Ok(())
    }
}

/// The first number of a block that is not finite.
fn check(number: usize, block: &Block, values: &BlockValues, with_derivatives: bool) -> Result<(), NotFinite> {
    let fault = |numbers: &[f64]| numbers.iter().position(|value| !value.is_finite());
    if let Some(at) = fault(&values.values) {
        let entry = Entry::Value { block: number, element: at % block.elements, row: at / block.elements };
        return Err(NotFinite { entry, value: values.values[at] });
    }
    if !with_derivatives {
        return Ok(());
    }
    if let Some(at) = fault(&values.jacobian) {
        let (row, _) = block.jacobian[at / block.elements];
        let entry = Entry::FirstDerivative { block: number, element: at % block.elements, row };
        return Err(NotFinite { entry, value: values.jacobian[at] });
    }
    if let Some(at) = fault(&values.hessian) {
        let entry = Entry::SecondDerivative { block: number, element: at % block.elements };
        return Err(NotFinite { entry, value: values.hessian[at] });
    }
    Ok(())
}

/// Buffers for the elements of one block.
#[derive(Clone, Debug)]
pub struct Work {
    slots: Vec<f64>,
    functions: Functions,
    hessian: Vec<f64>,
}

impl Work {
    /// Computes the slots of an element.
    fn place(&mut self, block: &Block, e: usize, x: &[f64]) {
        let (variables, map) = (block.variables(e), block.map(e));
        let width = variables.len();
        for (slot, u) in self.slots.iter_mut().enumerate() {
            let products = variables.iter().enumerate().map(|(k, v)| map[slot * width + k] * x[*v as usize]);
            *u = products.sum::<f64>() + block.offset[slot * block.elements + e];
        }
    }

    /// Adds the functions of an element to the objective and the rows.
    fn add_values(&self, block: &Block, e: usize, out: &mut Evaluation, number: usize) {
        for (row, &value) in self.functions.values.iter().enumerate() {
            let at = row * block.elements + e;
            out.blocks[number].values[at] = value;
            match block.target[at] {
                Target::Objective => out.objective += block.weight[at] * value,
                Target::Row(i) => out.rows[i as usize] += block.weight[at] * value,
            }
        }
    }

    /// Writes the derivatives of an element.
    fn add_derivatives(
        &mut self,
        block: &Block,
        e: usize,
        objective_weight: f64,
        multipliers: &[f64],
        out: &mut BlockValues,
    ) {
        let slots = block.slots;
        self.hessian.fill(0.0);
        for row in 0..block.rows {
            let at = row * block.elements + e;
            let factor = match block.target[at] {
                Target::Objective => objective_weight,
                Target::Row(i) => multipliers[i as usize],
            };
            for slot in 0..slots {
                let entry = row * slots + slot;
                out.jacobian[entry * block.elements + e] = self.functions.gradients[entry];
            }
            let own = &self.functions.hessians[row * slots * slots..(row + 1) * slots * slots];
            self.hessian.iter_mut().zip(own).for_each(|(sum, h)| *sum += factor * block.weight[at] * h);
        }
        for (entry, &(i, j)) in block.hessian.iter().enumerate() {
            out.hessian[entry * block.elements + e] = self.hessian[i * slots + j];
        }
    }
}

impl Nlp for Program {
    type Workspace = Vec<Work>;

    fn limits(&self) -> &Limits {
        &self.limits
    }

    fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    fn workspace(&self) -> (Vec<Work>, Evaluation) {
        let values = |block: &Block| BlockValues {
            values: vec![f64::NAN; block.rows * block.elements],
            jacobian: vec![f64::NAN; block.jacobian.len() * block.elements],
            hessian: vec![f64::NAN; block.hessian.len() * block.elements],
        };
        let work = |block: &Block| Work {
            slots: vec![0.0; block.slots],
            functions: Functions::new(block.slots, block.rows),
            hessian: vec![0.0; block.slots * block.slots],
        };
        let blocks = self.blocks.iter().map(values).collect();
        let evaluation = Evaluation { objective: 0.0, rows: vec![0.0; self.rows()], blocks };
        (self.blocks.iter().map(work).collect(), evaluation)
    }

    fn values(&self, x: &[f64], work: &mut Vec<Work>, out: &mut Evaluation) -> Result<(), NotFinite> {
        self.evaluate(x, None, work, out)
    }

    fn derivatives(
        &self,
        x: &[f64],
        objective_weight: f64,
        multipliers: &[f64],
        work: &mut Vec<Work>,
        out: &mut Evaluation,
    ) -> Result<(), NotFinite> {
        self.evaluate(x, Some((objective_weight, multipliers)), work, out)
    }
}
