//! From a solve to a [`Run`].

use indexmap::IndexMap;
use ntg_compiler::diagnostic::{Diagnostic, Severity};
use ntg_compiler::source::Source;
use ntg_runtime::problem::Problem;
use ntg_runtime::report::{ConstraintReport, Report, Trace};
use ntg_runtime::settings::Progress;
use ntg_runtime::structure::{Block, Points, Structure, Unit};

use super::{
    Constraint, Discretisation, FORMAT, Finding, Grid, Independent, Iteration, Member, Multiplier, Phase, Quantity,
    Run, Scene, Series, Spec, Step, Term, VERSION, Values, Violation, Worst, layout, measured, reading, sides,
};

/// Samples of each output and named expression.
const SAMPLES: usize = 401;
/// Stretches of the finer grid for each point of the transcription.
const FINER: usize = 10;
/// How near to a jump, relative to the whole time, its left value is taken.
const NEAR: f64 = 1e-9;

/// A solve and what led to it.
pub struct Recording<'a> {
    /// The problem with its parameters as they were.
    pub problem: &'a dyn Problem,
    /// What the solve said.
    pub report: &'a Report,
    /// Why there is no solution, where someone asked.
    pub explanation: Option<&'a ntg_runtime::explain::Explanation>,
    /// What the starts found of which this is the best, where there were several.
    pub starts: Option<&'a ntg_runtime::multistart::MultiReport>,
    /// The spec.
    pub source: &'a Source,
    /// What the compiler had to say about it.
    pub notes: &'a [Diagnostic],
    /// All iterations that were seen, of all steps of a continuation.
    pub iterations: &'a [Progress],
}

impl Recording<'_> {
    /// Everything about the solve as plain data.
    pub fn run(&self) -> Run {
        let reading = reading::read(self.source);
        let mut run = self.numbers(&reading);
        for (path, series) in &mut run.lets {
            series.helper = !series.t.is_empty() && reading.helpers.contains(crate::figure::base(path));
        }
        run.scene = crate::scene::find(&run, self.problem, &reading);
        run
    }

    fn numbers(&self, reading: &reading::Reading) -> Run {
        let (report, solution) = (self.report, &self.report.solution);
        let structure = solution.structure();
        let independent = &structure.independent;
        let mut run = Run {
            format: FORMAT.to_owned(),
            version: VERSION,
            problem: report.problem.clone(),
            doc: structure.doc.clone(),
            independent: Independent {
                name: independent.name.clone(),
                unit: independent.unit.symbol.clone(),
                factor: independent.unit.factor,
            },
            status: report.status.label(),
            resolution: report.resolution().map(|resolution| resolution.word().to_owned()).unwrap_or_default(),
            between_tolerance: report.between_tolerance,
            advice: report.advice_beside(self.explanation).to_owned(),
            warnings: report.warnings().into_iter().map(|warning| warning.message).collect(),
            objective: report.objective,
            objective_unit: report.objective_unit.symbol.clone(),
            objective_fine: report.objective_fine,
            objective_zero: report.objective_zero,
            terms: report.terms.iter().map(term).collect(),
            iterations: report.iterations,
            seconds: report.seconds,
            violation: Violation { points: report.violation.points, between: report.violation.between },
            explanation: self.explanation.map(Into::into),
            starts: self.starts.map(Into::into),
            refinement: report.refined.as_ref().map(Into::into),
            estimate: report.estimate.as_ref().map(Into::into),
            layout: layout(structure),
            unknowns: solution.coefficients().to_vec(),
            row_multipliers: solution.row_multipliers().to_vec(),
            outputs: self.outputs(),
            lets: self.lets(),
            times: solution.event_times().into_iter().collect(),
            phases: solution.phases().into_iter().map(|p| Phase { name: p.name, start: p.start, end: p.end }).collect(),
            variables: solution.variables().into_iter().map(|v| (v.name, quantity(v.value, &v.unit))).collect(),
            parameters: parameters(structure),
            constraints: self.constraints(),
            history: report.history.iter().map(step).collect(),
            convergence: iterations(self.iterations, report),
            discretisation: self.discretisation(),
            scene: Scene::default(),
            spec: Some(Spec {
                name: self.source.name.clone(),
                text: self.source.text.clone(),
                findings: self.notes.iter().map(|note| finding(note, self.source)).collect(),
            }),
        };
        measured::fill(&mut run, solution, &reading.measured);
        sides::fill(&mut run, (solution, self.problem), &self.source.text);
        in_units_of_time(&mut run);
        run
    }

    fn outputs(&self) -> IndexMap<String, Series> {
        let structure = self.report.solution.structure();
        let doc = |name: &str| {
            let last = name.rsplit('.').next().unwrap_or(name);
            let base = last.split('[').next().unwrap_or(last);
            let mut outputs = structure.phases.iter().flat_map(|phase| &phase.outputs);
            outputs.find(|output| output.name == base).map(|output| output.doc.clone()).unwrap_or_default()
        };
        let trajectories = self.report.solution.trajectories().into_iter();
        let series = trajectories.map(|trajectory| {
            let t = self.times(trajectory.start(), trajectory.end());
            let value = t.iter().map(|t| trajectory.at(*t)).collect();
            (trajectory.name().to_owned(), over(trajectory.unit(), doc(trajectory.name()), t, value))
        });
        series.collect()
    }

    fn lets(&self) -> IndexMap<String, Series> {
        let signals = self.report.solution.signals(self.problem).into_iter();
        let series = signals.map(|signal| {
            let t = signal.span().map(|(start, end)| self.times(start, end)).unwrap_or_default();
            let value = match t.is_empty() {
                true => vec![signal.at(0.0)],
                false => t.iter().map(|t| signal.at(*t)).collect(),
            };
            (signal.name().to_owned(), over(signal.unit(), signal.doc().to_owned(), t, value))
        });
        series.collect()
    }

    /// Equally spaced times, with both sides of every start of a phase between them.
    fn times(&self, start: f64, end: f64) -> Vec<f64> {
        let last = (SAMPLES - 1) as f64;
        let mut times: Vec<f64> = (0..SAMPLES).map(|i| start + (end - start) * i as f64 / last).collect();
        if let Some(time) = times.last_mut() {
            *time = end;
        }
        for phase in self.report.solution.phases() {
            let before = phase.start - NEAR * (end - start);
            if before > start && phase.start < end {
                times.extend([before, phase.start]);
            }
        }
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }

    fn constraints(&self) -> Vec<Constraint> {
        // Only another problem than the solved one has no traces.
        let traces = self.report.solution.traces(self.problem, FINER).unwrap_or_default();
        let all = self.report.constraints.iter().enumerate();
        all.map(|(index, report)| {
            let own: Vec<&Trace> = traces.iter().filter(|trace| trace.constraint == index).collect();
            constraint(report, &own)
        })
        .collect()
    }

    fn discretisation(&self) -> Discretisation {
        let solution = &self.report.solution;
        let structure = solution.structure();
        Discretisation {
            variables: solution.coefficients().len(),
            coefficients: solution.spline_coefficients().len(),
            rows: solution.rows(),
            phases: structure.phases.iter().map(|phase| grid(structure, phase)).collect(),
        }
    }
}

/// Every time in the unit that the independent variable is shown in; until then they are in SI units.
fn in_units_of_time(run: &mut Run) {
    let factor = run.independent.factor;
    let shown = |time: &mut f64| *time /= factor;
    let measurements = run.estimate.iter_mut().flat_map(|estimate| &mut estimate.measurements);
    measurements.flat_map(|m| &mut m.residuals).filter_map(|residual| residual.t.as_mut()).for_each(shown);
    run.times.values_mut().for_each(shown);
    run.phases.iter_mut().flat_map(|phase| [&mut phase.start, &mut phase.end]).for_each(shown);
    run.outputs.values_mut().chain(run.lets.values_mut()).flat_map(|series| &mut series.t).for_each(shown);
    for constraint in &mut run.constraints {
        let worst = constraint.points.iter_mut().chain(&mut constraint.between);
        worst.filter_map(|worst| worst.t.as_mut()).for_each(shown);
        if let Some(multiplier) = &mut constraint.multiplier {
            multiplier.t.iter_mut().for_each(shown);
            multiplier.value *= if multiplier.density { factor } else { 1.0 };
        }
        let is_density = constraint.multiplier.as_ref().is_some_and(|multiplier| multiplier.density);
        for member in &mut constraint.members {
            member.t.iter_mut().chain(&mut member.multiplier_t).chain(&mut member.mean_t).for_each(shown);
            member.multiplier.iter_mut().for_each(|value| *value *= if is_density { factor } else { 1.0 });
            member.mean.iter_mut().for_each(|mean| *mean *= factor);
        }
    }
}

fn over(unit: &Unit, doc: String, t: Vec<f64>, value: Vec<f64>) -> Series {
    Series { unit: unit.symbol.clone(), factor: unit.factor, doc, t, value, ..Series::default() }
}

fn quantity(value: f64, unit: &Unit) -> Quantity {
    Quantity { unit: unit.symbol.clone(), factor: unit.factor, value }
}

fn term(term: &ntg_runtime::report::TermReport) -> Term {
    Term { name: term.name.clone(), value: term.value, fine: term.fine, unit: term.unit.symbol.clone() }
}

fn parameters(structure: &Structure) -> IndexMap<String, Values> {
    let shown = structure.parameters.iter().map(|parameter| {
        let value = parameter.value.iter().map(|value| parameter.unit.typed(*value)).collect();
        (parameter.name.clone(), Values { unit: parameter.unit.symbol.clone(), value, shape: parameter.shape() })
    });
    shown.collect()
}

fn constraint(report: &ConstraintReport, traces: &[&Trace]) -> Constraint {
    let worst = |worst: &Option<ntg_runtime::report::Worst>| {
        worst.as_ref().map(|worst| Worst {
            violation: worst.violation,
            relative: worst.relative,
            value: worst.value,
            t: worst.time,
            phase: worst.phase.clone(),
            indices: worst.indices.clone(),
        })
    };
    Constraint {
        name: report.name.clone(),
        block: block(report.block).to_owned(),
        line: report.place.line,
        column: report.place.column,
        text: report.place.text.clone(),
        unit: report.unit.symbol.clone(),
        points: worst(&report.points),
        between: worst(&report.between),
        multiplier: report.multiplier.as_ref().map(|found| Multiplier {
            value: found.value,
            density: found.density,
            t: found.time,
        }),
        sensitivity: report.sensitivity,
        members: traces.iter().map(|trace| member(trace)).collect(),
        proof: None,
    }
}

fn block(block: Block) -> &'static str {
    match block {
        Block::Initial => "initial",
        Block::Trajectory => "trajectory",
        Block::Final => "final",
        Block::Temporal => "temporal",
        Block::Continuity => "continuity",
        Block::Corner => "corner",
    }
}

fn member(trace: &Trace) -> Member {
    let indices = if trace.indices.is_empty() { String::new() } else { format!("{:?}", trace.indices) };
    let name = match (trace.phase.is_empty(), indices.is_empty()) {
        (false, false) => format!("{} {indices}", trace.phase),
        _ => format!("{}{indices}", trace.phase),
    };
    let timed = trace.points.iter().any(|(t, _)| t.is_finite());
    let (t, value): (Vec<f64>, Vec<f64>) = trace.points.iter().copied().unzip();
    let (multiplier_t, multiplier) = trace.multipliers.iter().copied().unzip();
    Member {
        name,
        lower: Some(trace.lower).filter(|bound| bound.is_finite()),
        upper: Some(trace.upper).filter(|bound| bound.is_finite()),
        t: if timed { t } else { vec![] },
        value,
        multiplier_t: if timed { multiplier_t } else { vec![] },
        multiplier,
        mean_t: trace.means.iter().flat_map(|(from, to, _)| [*from, *to]).collect(),
        mean: trace.means.iter().flat_map(|(.., mean)| [*mean, *mean]).collect(),
        curve: None,
    }
}

fn step(step: &ntg_runtime::report::StepReport) -> Step {
    Step {
        parameters: step.parameters.iter().map(|value| (value.name.clone(), value.value)).collect(),
        status: step.status.to_string(),
        objective: step.objective,
        iterations: step.iterations,
        seconds: step.seconds,
    }
}

/// Iterations with the step of the continuation that each belongs to: counting begins anew in
/// every step. The point that is reported follows, if it was not seen: what comes after the iterations may better it.
fn iterations(seen: &[Progress], report: &Report) -> Vec<Iteration> {
    let mut step = 0;
    let mut found = vec![];
    for progress in seen {
        if progress.iteration == 0 {
            step += 1;
        }
        found.push(Iteration {
            step: step.max(1),
            iteration: progress.iteration,
            objective: progress.objective,
            primal: progress.primal,
            dual: progress.dual,
            length: progress.step,
        });
    }
    let made = report.history.last().map_or(0, |step| step.iterations);
    let reported = report.residuals.scaled;
    let is_reported = |last: &Iteration| last.primal == reported.primal && last.dual == reported.dual;
    if found.last().is_some_and(|last| last.iteration < made || !is_reported(last)) {
        found.push(Iteration {
            step,
            iteration: made,
            objective: minimised(report),
            primal: reported.primal,
            dual: reported.dual,
            length: f64::NAN,
        });
    }
    found
}

/// The objective as iterations have it: SI, and smaller is better.
fn minimised(report: &Report) -> f64 {
    let sign = if report.solution.structure().maximize { -1.0 } else { 1.0 };
    sign * report.objective * report.objective_unit.factor
}

fn finding(finding: &Diagnostic, source: &Source) -> Finding {
    let severity = match finding.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Note => "note",
    };
    Finding {
        code: finding.code.text().to_owned(),
        severity: severity.to_owned(),
        message: finding.message.clone(),
        help: finding.help.clone().unwrap_or_default(),
        line: source.place(finding.span.start).line,
    }
}

fn grid(structure: &Structure, phase: &ntg_runtime::structure::Phase) -> Grid {
    let agent = structure.agents.get(phase.agent).and_then(|agent| agent.name.as_deref());
    let name: Vec<&str> = agent.into_iter().chain(phase.name.as_deref()).collect();
    let words = phase.points.iter().filter_map(|points| match points {
        Points::Gauss { points } => Some(format!("{points} Gauss points in each interval")),
        Points::Uniform { points } => Some(format!("{points} equally spaced points")),
        Points::Breakpoints => Some("both ends of each interval".to_owned()),
        Points::LeftLimits => None,   // They belong to the breakpoints.
        Points::Times { .. } => None, // No spec has them.
    });
    let splines = phase.outputs.iter().filter(|output| !output.is_helper()).map(|output| {
        let spline = &output.spline;
        let intervals = spline.breakpoints.len().saturating_sub(1);
        let family = output.family.map_or_else(String::new, |f| format!("[{} .. {}]", f.first, f.last));
        let coefficients = intervals * (spline.order - spline.smoothness) + spline.smoothness;
        let words = format!(
            "order {}, smoothness {}, {intervals} intervals: {coefficients} coefficients",
            spline.order, spline.smoothness
        );
        (format!("{}{family}", output.name), words)
    });
    Grid { name: name.join("."), points: words.collect::<Vec<_>>().join(", "), splines: splines.collect() }
}
