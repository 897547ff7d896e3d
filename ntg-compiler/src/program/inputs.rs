//! The inputs of a kernel, collected while its formulas are copied.

use ntg_structure::{Data, Reduction, Slot};

use super::names::Names;

/// An input before all of them are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Provisional {
    Slot(usize),
    Reduction(usize),
    Data(usize),
}

/// Inputs in order of first use, each once, with a readable name.
#[derive(Default)]
pub(super) struct Inputs {
    pub(super) slots: Vec<Slot>,
    pub(super) reductions: Vec<Reduction>,
    pub(super) data: Vec<Data>,
    order: Vec<Provisional>,
    names: Vec<String>,
    taken: Names,
}

impl Inputs {
    pub(super) fn slot(&mut self, slot: Slot, name: &str) -> usize {
        match self.slots.iter().position(|s| *s == slot) {
            Some(k) => self.find(Provisional::Slot(k)),
            None => {
                self.slots.push(slot);
                self.push(Provisional::Slot(self.slots.len() - 1), name)
            }
        }
    }

    pub(super) fn data(&mut self, data: Data, name: &str) -> usize {
        match self.data.iter().position(|d| *d == data) {
            Some(k) => self.find(Provisional::Data(k)),
            None => {
                self.data.push(data);
                self.push(Provisional::Data(self.data.len() - 1), name)
            }
        }
    }

    pub(super) fn reduction(&mut self, reduction: Reduction, name: &str) -> usize {
        match self.reductions.iter().position(|r| *r == reduction) {
            Some(k) => self.find(Provisional::Reduction(k)),
            None => {
                self.reductions.push(reduction);
                self.push(Provisional::Reduction(self.reductions.len() - 1), name)
            }
        }
    }

    /// For every provisional input its final position: slots, then reductions, then data.
    pub(super) fn positions(&self) -> Vec<u32> {
        let (slots, reductions) = (self.slots.len(), self.reductions.len());
        let position = |p: &Provisional| match *p {
            Provisional::Slot(k) => k,
            Provisional::Reduction(k) => slots + k,
            Provisional::Data(k) => slots + reductions + k,
        };
        self.order.iter().map(|p| u32::try_from(position(p)).expect("fewer than 2^32 inputs")).collect()
    }

    /// Names by final position.
    pub(super) fn names(&self) -> Vec<String> {
        let mut names = vec![String::new(); self.order.len()];
        for (position, name) in self.positions().into_iter().zip(&self.names) {
            names[position as usize].clone_from(name);
        }
        names
    }

    fn push(&mut self, input: Provisional, name: &str) -> usize {
        self.order.push(input);
        self.names.push(self.taken.distinct(name));
        self.order.len() - 1
    }

    fn find(&self, input: Provisional) -> usize {
        self.order.iter().position(|p| *p == input).expect("an input is listed when it is made")
    }
}
