//! Boxes of time: how a cover divides the cells of a phase, and functions on its boxes.

use crate::evaluate::{Piece, evaluate, halves, jets, needs, piece};
use crate::interval::Interval;
use crate::jet::Jet;
use crate::read::{Certificate, Flat, Sound, TAU};

/// Some cells of a phase.
pub(crate) struct Walk<'a> {
    pub(crate) certificate: &'a Certificate,
    pub(crate) phase: usize,
    /// The first of the cells, and the one behind the last.
    pub(crate) cells: (usize, usize),
    /// What is wanted of each box.
    pub(crate) flats: Vec<Flat>,
}

/// A box: polynomials, scaled time among them, and its length.
pub(crate) struct Part {
    pub(crate) pieces: Vec<(Flat, Piece)>,
    pub(crate) length: Interval,
}

impl Part {
    pub(crate) fn halves(&self) -> [Self; 2] {
        let both = |(flat, piece): &(Flat, Piece)| {
            let (left, right) = halves(piece);
            ((*flat, left), (*flat, right))
        };
        let (left, right) = self.pieces.iter().map(both).unzip();
        let length = self.length.scaled(-1);
        [Self { pieces: left, length }, Self { pieces: right, length }]
    }

    /// The polynomial of a flat.
    pub(crate) fn piece(&self, flat: Flat) -> Piece {
        let found = self.pieces.iter().find(|(own, _)| *own == flat);
        found.map_or(vec![Interval::ENTIRE], |(_, piece)| piece.clone())
    }

    /// A function in the middle of the box, and everywhere on it.
    pub(crate) fn jets(&self, certificate: &Certificate, function: usize, integrals: &[Interval]) -> (Jet, Jet) {
        let all: Vec<(Flat, (Jet, Jet))> = self.pieces.iter().map(|(flat, piece)| (*flat, jets(piece))).collect();
        let nothing = (Jet::NOTHING, Jet::NOTHING);
        let find = |flat: Flat| all.iter().find(|(own, _)| *own == flat).map_or(nothing, |(_, jets)| *jets);
        let evaluate = |here: &dyn Fn(Flat) -> Jet| evaluate(certificate, function, integrals, here);
        (evaluate(&|flat| find(flat).0), evaluate(&|flat| find(flat).1))
    }
}

impl<'a> Walk<'a> {
    /// The cells with all that functions need.
    pub(crate) fn of(certificate: &'a Certificate, functions: &[usize], phase: usize, cells: (usize, usize)) -> Self {
        Self { certificate, phase, cells, flats: needs(certificate, functions) }
    }

    fn cell(&self, cell: usize) -> Sound<Part> {
        let cuts = &self.certificate.phases[self.phase];
        let ends = [cuts[cell], cuts[cell + 1]].map(Interval::point);
        let one = |flat: &Flat| match *flat {
            TAU => Ok((TAU, ends.to_vec())),
            own if self.certificate.splines[own.0].phase == self.phase => {
                Ok((own, piece(self.certificate, own, cell)?))
            }
            _ => Err("a spline of another phase is used".to_owned()),
        };
        Ok(Part { pieces: self.flats.iter().map(one).collect::<Result<_, _>>()?, length: ends[1] - ends[0] })
    }

    /// A part of the equal parts of a cell that has been halved so many times.
    pub(crate) fn part(&self, (cell, halvings, number): (usize, u32, u64)) -> Sound<Part> {
        if !(self.cells.0..self.cells.1).contains(&cell) || halvings > 63 || number >> halvings != 0 {
            return Err("its witness is at no time".to_owned());
        }
        let mut part = self.cell(cell)?;
        for bit in (0..halvings).rev() {
            let [left, right] = part.halves();
            part = if number >> bit & 1 == 1 { right } else { left };
        }
        Ok(part)
    }

    /// Goes through the boxes of a cover: for each cell a tree, `/` for a box that is halved (the first half first), `.`
    /// for one that is not.
    pub(crate) fn along(&self, cover: &[String], visit: &mut dyn FnMut(&Part) -> Sound<()>) -> Sound<()> {
        if cover.is_empty() || self.cells.0 + cover.len() != self.cells.1 {
            return Err("its cover does not cover all times".to_owned());
        }
        for (cell, tree) in (self.cells.0..).zip(cover) {
            let mut open = vec![self.cell(cell)?];
            for letter in tree.chars() {
                let part = open.pop().ok_or("a cover has too many boxes")?;
                match letter {
                    '/' => open.extend(part.halves().into_iter().rev()),
                    '.' => visit(&part)?,
                    _ => return Err("a cover has an unknown sign".to_owned()),
                }
            }
            if !open.is_empty() {
                return Err("a cover leaves times out".to_owned());
            }
        }
        Ok(())
    }
}
