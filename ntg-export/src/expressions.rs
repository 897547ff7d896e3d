//! A transcribed program as expressions of its variables (docs/maths.md, equation 4.3).
//!
//! Takes the compiler's program and its transcription; every element's formulas are written once for every point at
//! which they are evaluated. Finds: tables that are too large to be written out, numbers that are not finite.

use crate::error::ExportError;
use crate::graph::{Affine, Graph, Id};
use crate::kernel::Writer;
use crate::value::Value;
use ntg_compiler::program::Program;
use ntg_runtime::nlp::{Block, Nlp, Target};
use ntg_runtime::transcribe::Transcription;

/// One row, or the objective: `affine + sum of the rest`.
#[derive(Clone, Debug, Default)]
pub(crate) struct Row {
    pub(crate) affine: Affine,
    pub(crate) rest: Vec<Id>,
}

/// A whole program. Variables and rows are numbered as in the transcription.
#[derive(Clone, Debug)]
pub struct Expressions {
    pub(crate) graph: Graph,
    pub(crate) rows: Vec<Row>,
    /// In the user's sense: what is maximised has its own sign.
    pub(crate) objective: Row,
    pub(crate) maximize: bool,
    pub(crate) bounds: Vec<(f64, f64)>,
    pub(crate) row_bounds: Vec<(f64, f64)>,
    pub(crate) name: String,
    pub(crate) variable_names: Vec<String>,
    pub(crate) row_names: Vec<String>,
}

impl Expressions {
    /// Writes all formulas at all points; `transcription` is that of `program`.
    ///
    /// # Errors
    /// What cannot be written as expressions.
    pub fn new(program: &Program, transcription: &Transcription<'_>) -> Result<Self, ExportError> {
        let (variable_names, row_names) = transcription.names();
        let limits = transcription.limits();
        let pairs = |lower: &[f64], upper: &[f64]| lower.iter().copied().zip(upper.iter().copied()).collect();
        let mut writer = Writer { program, tables: transcription.tables(), graph: Graph::default(), numbers: 0 };
        let mut rows = vec![vec![]; transcription.rows()];
        let mut objective = vec![];
        for (number, block) in transcription.blocks().iter().enumerate() {
            for element in 0..block.elements {
                let slots = slots(block, element);
                let values = match transcription.call(number, element) {
                    Some(call) => writer.rows(&call, &slots)?,
                    None => slots,
                };
                for (row, value) in values.iter().enumerate() {
                    let lane = row * block.elements + element;
                    let value = value.times(block.weight[lane], &mut writer.graph);
                    match block.target[lane] {
                        Target::Objective => objective.push(value),
                        Target::Row(target) => rows[target as usize].push(value),
                    }
                }
            }
        }
        let maximize = program.structure.maximize;
        if maximize {
            objective = objective.iter().map(|value| value.times(-1.0, &mut writer.graph)).collect();
        }
        Ok(Self {
            rows: rows.iter().map(|values| added(values)).collect(),
            objective: added(&objective),
            graph: writer.graph,
            maximize,
            bounds: pairs(&limits.lower, &limits.upper),
            row_bounds: pairs(&limits.row_lower, &limits.row_upper),
            name: program.structure.name.clone(),
            variable_names: unique(variable_names),
            row_names: unique(row_names),
        })
    }
}

/// The slots of an element as affine functions of the variables.
fn slots(block: &Block, element: usize) -> Vec<Value> {
    let (variables, map) = (block.variables(element), block.map(element));
    let slot = |slot: usize| {
        let coefficients = &map[slot * variables.len()..][..variables.len()];
        let terms = variables.iter().copied().zip(coefficients.iter().copied()).filter(|(_, c)| *c != 0.0);
        let affine = Affine { constant: block.offset[slot * block.elements + element], terms: terms.collect() };
        Value { affine, rest: None }
    };
    (0..block.slots).map(slot).collect()
}

/// The sum of many values.
fn added(values: &[Value]) -> Row {
    let mut terms: Vec<(u32, f64)> = values.iter().flat_map(|value| value.affine.terms.iter().copied()).collect();
    terms.sort_by_key(|(variable, _)| *variable); // A stable sort: the order of addition is that of the elements.
    terms.dedup_by(|next, kept| {
        let is_same = next.0 == kept.0;
        kept.1 += if is_same { next.1 } else { 0.0 };
        is_same
    });
    terms.retain(|(_, c)| *c != 0.0);
    let constant = values.iter().map(|value| value.affine.constant).sum();
    Row { affine: Affine { constant, terms }, rest: values.iter().filter_map(|value| value.rest).collect() }
}

/// Names without quotes, each once: what comes again has a number.
fn unique(names: Vec<String>) -> Vec<String> {
    let mut count = std::collections::HashMap::new(); // Looked up, never iterated.
    let mut own = |name: String| {
        let name: String = name.chars().filter(|c| *c != '`' && !c.is_control()).collect();
        let times = count.entry(name.clone()).or_insert(0_usize);
        *times += 1;
        if *times == 1 { name } else { format!("{name} #{times}") }
    };
    names.into_iter().map(&mut own).collect()
}
