//! Proofs that the constraints of a solved ntg problem hold at every time, not only at points.
//!
//! A solver holds constraints at points and hopes in between. For flat outputs the trajectory is a polynomial on each
//! knot interval, so what happens between can be *proved*: in interval arithmetic, with branch and bound in time
//! (docs/maths.md, section 15; docs/certify.md says exactly what is proved and what is trusted).
//!
//! ```text
//! Program, Solution --collect--> Statement --certify--> Certificate --write--> a file that ntg-check re-proves
//! ```

pub mod certify;
pub mod change;
pub mod collect;
pub mod elementary;
mod ends;
mod evaluate;
pub mod guarantee;
pub mod interval;
pub mod jet;
mod mend;
mod processor;
mod products;
pub mod prove;
pub mod spline;
pub mod statement;
pub mod summary;
mod table;
pub mod tightened;
pub mod tube;
pub mod write;

pub use certify::{Certificate, Finding, Verdict, certify};
pub use collect::statement;
pub use guarantee::{Guarantee, Guaranteed, guarantee};
pub use interval::Interval;
pub use prove::Options;
pub use tube::{Tube, tube};
