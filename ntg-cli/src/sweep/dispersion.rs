//! `--disperse "mass ~ normal(1000, 20) [kg]"`: parameters that are dispersed, and the design of their samples.

use clap::ValueEnum;
use ntg_interp::{Interpreted, quantity};
use ntg_sweep::{Design, Distribution};

use super::inputs;
use crate::arguments::numbers::whole;

/// How a dispersed parameter is written.
const FORM: &str = "a dispersed parameter is \"NAME ~ DISTRIBUTION [unit]\", such as \"mass ~ normal(1000, 20) [kg]\"";

/// Dispersed parameters.
#[derive(clap::Args, Debug)]
pub(super) struct Dispersed {
    /// Disperse a parameter: normal(MEAN, DEVIATION), normal(MEAN, DEVIATION, LEAST, GREATEST),
    /// uniform(LEAST, GREATEST), triangular(LEAST, LIKELIEST, GREATEST), lognormal(MEDIAN, DEVIATION),
    /// in the declared unit or in one that follows in brackets. Parameters are independent.
    #[arg(long, value_name = "NAME ~ DISTRIBUTION", requires = "samples", allow_hyphen_values = true)]
    disperse: Vec<String>,
    /// How many samples of the dispersed parameters; each is taken with every other parameter set.
    #[arg(long, value_name = "N", requires = "disperse", value_parser = whole::<u32>(1..=10_000_000))]
    samples: Option<u32>,
    /// How samples are laid out.
    #[arg(long, value_enum, default_value_t = Kind::MonteCarlo, requires = "disperse")]
    design: Kind,
    /// The seed of the samples: the same seed gives the same samples on every machine.
    #[arg(long, value_name = "N", default_value_t = 1, requires = "disperse", value_parser = whole::<u64>(0..=u64::MAX))]
    seed: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// Independent random samples.
    MonteCarlo,
    /// One sample in each of N equal parts of every distribution.
    LatinHypercube,
    /// The Sobol sequence, shifted at random; best with a power of two samples.
    Sobol,
}

/// Names of dispersed parameters, and their samples in declared units.
pub(super) struct Samples {
    pub(super) names: Vec<String>,
    pub(super) rows: Vec<Vec<f64>>,
}

impl Dispersed {
    /// All samples; one without any number where nothing is dispersed.
    pub(super) fn samples(&self, problem: &Interpreted) -> Result<Samples, String> {
        let read = |text: &String| read(problem, text).map_err(|message| format!("--disperse {text}: {message}"));
        let dispersed = self.disperse.iter().map(read).collect::<Result<Vec<_>, _>>()?;
        let design = match self.design {
            Kind::MonteCarlo => Design::MonteCarlo,
            Kind::LatinHypercube => Design::LatinHypercube,
            Kind::Sobol => Design::Sobol,
        };
        let points = design.points(self.samples.unwrap_or(1) as usize, dispersed.len(), self.seed)?;
        let row = |point: Vec<f64>| {
            point.iter().zip(&dispersed).map(|(u, (_, distribution, unit))| distribution.quantile(*u) * unit).collect()
        };
        Ok(Samples {
            rows: points.into_iter().map(row).collect(),
            names: dispersed.iter().map(|(name, ..)| name.clone()).collect(),
        })
    }
}

/// Name, distribution, and declared units in one of its unit.
fn read(problem: &Interpreted, text: &str) -> Result<(String, Distribution, f64), String> {
    let (name, rest) = text.split_once('~').ok_or(FORM)?;
    let (distribution, unit) = rest.find('[').map_or((rest, ""), |at| rest.split_at(at));
    let name = name.trim();
    let parameter = inputs::parameter(problem, name)?;
    inputs::place(problem, name)?;
    let factor = match unit.is_empty() {
        true => 1.0,
        false => match quantity(&format!("1 {unit}"), &parameter.unit)?[..] {
            [value] => parameter.unit.typed(value),
            _ => return Err(FORM.to_owned()),
        },
    };
    Ok((name.to_owned(), distribution.parse()?, factor))
}
