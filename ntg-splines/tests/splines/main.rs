//! Splines, quadrature and tables against identities and closed forms. One binary, because every binary would compile
//! what it compares with, optimised, again.

mod bsplines;
mod fit;
mod monotone;
mod quadrature;
mod tables;
