//! Phases, agents and their families: time, templates, continuity, paths.

use std::collections::HashMap;

use crate::model_support::{World, close, findings, good, named, value, value_at};
use ntg_compiler::expr::Node;
use ntg_compiler::model::problem::*;
use ntg_structure::Block;

const PHASES: &str = "problem Sounding {
    output h [km]: spline(order = 6, intervals = 4, smoothness = 4);
    output s: spline(order = 6, intervals = 4, smoothness = 4);
    param g = 10 [m/s^2];
    let v [m/s] = der(h);
    let weight [N] = mass * g;
    let work [J] = integral(weight * v);
    duration T in 10 .. 100 [s];
    phase coast after boost {
        duration in 1 .. 200 [s];
        let mass [kg] = 2 [kg];
        output h: spline(order = 5, intervals = 2, smoothness = 3);
        output extra: spline(order = 4, intervals = 1);
        jump s;
        continuous h up to 1;
        collocation uniform(breakpoints = 11);
    }
    phase boost {
        duration burn in 5 .. 60 [s];
        let mass [kg] = 3 [kg] - 0.01 [kg/s] * t;
        minimize integral(v^2) / 1 [m^2/s];
    }
    minimize duration(boost) / 1 [s] + integral(s^2) / 1 [s] + final(coast, extra) + initial(s) + final(s);
    initial { h == 0; }
    final { v == 0; }
    trajectory { limit: weight <= 50 [N]; }
    temporal { end(boost) <= 30 [s];  start(coast) - end(boost) <= 1 [s];  T >= burn_limit; }
    param burn_limit = 3 [s];
    guess { h = 20 [km] * tau;  duration(boost) = 30 [s];  duration(coast) = 60 [s];  s = t / T; }
}";

fn flat(name: &str, _: Option<i64>, order: usize, at: At) -> f64 {
    let end = match at {
        At::Here => 0.0,
        At::Start => 100.0,
        At::End => 200.0,
        At::Inside(_) | At::Among { .. } => 300.0,
    };
    end + name.len() as f64 + 10.0 * order as f64
}

fn other(name: &str) -> f64 {
    match name {
        "T" => 5.0,
        "t" => 2.0,
        "tau" => 0.4,
        "start" => 7.0,
        _ => 1.5,
    }
}

const WORLD: World<'static> = World { flat: &flat, other: &other };

#[test]
fn phases_are_in_order_of_time_and_have_their_own_splines() {
    let p = good(PHASES);
    let names: Vec<&str> = p.phases.iter().filter_map(|phase| phase.name.as_deref()).collect();
    assert_eq!(names, ["boost", "coast"]);
    assert_eq!((p.phases[0].after, p.phases[1].after), (None, Some(0)));
    assert_eq!(p.agents[0].phases, [0, 1]);
    let orders = |k: usize| p.phases[k].outputs.iter().map(|o| (o.name.as_str(), o.spline.order)).collect::<Vec<_>>();
    assert_eq!(orders(0), [("h", 6), ("s", 6)]);
    assert_eq!(orders(1), [("h", 5), ("s", 6), ("extra", 4)]);
    assert_eq!(p.phases[1].outputs[0].unit.symbol, "km");
    assert_eq!(p.phases[0].collocation, Collocation::Gauss { points: 5, equalities: 5, ends: true });
    assert_eq!(p.phases[1].collocation, Collocation::Uniform { points: 11 });
    assert_eq!(p.agents[0].duration_name.as_deref(), Some("T"));
    assert_eq!(p.phases[0].duration_name.as_deref(), Some("burn"));
}

#[test]
fn templates_are_resolved_in_each_phase() {
    let text = PHASES.replace("T >= burn_limit;", "T >= burn_limit; duration(boost) >= 1 [s];");
    let p = good(&text);
    let limits: Vec<&Constraint> = p.constraints.iter().filter(|c| c.block == Block::Trajectory).collect();
    assert_eq!(limits.len(), 2);
    close(value(&p, limits[0].body, WORLD), 10.0 * (3.0 - 0.01 * 2.0));
    close(value(&p, limits[1].body, WORLD), 20.0);
    assert_eq!(limits[0].name.as_deref(), Some("boost.limit"));
    assert!(p.named.iter().filter(|named| named.name == "weight").count() == 2);
    // A total that is the same wherever it is seen from is one number.
    let work: Vec<&Named> = p.named.iter().filter(|named| named.name == "work").collect();
    assert_eq!((work.len(), &work[0].domain), (1, &Domain::Mission));
    let v = 10.0 + 1.0;
    close(value(&p, work[0].body, WORLD), 5.0 * (29.8 * v + 20.0 * v));
}

#[test]
fn ends_totals_and_events_are_those_of_the_path() {
    let p = good(PHASES);
    // duration(boost) + two phases of 5 s * s^2 + extra and s at their ends + s at the start.
    let expected = 5.0 + 2.0 * 5.0 * 1.0 + 205.0 + 101.0 + 201.0;
    close(value(&p, p.objective[0].body, WORLD), expected);
    let v = 10.0 + 1.0;
    close(value(&p, p.objective[1].body, WORLD), 5.0 * v * v);
    let temporal: Vec<&Constraint> = p.constraints.iter().filter(|c| c.block == Block::Temporal).collect();
    // The bounds on T come first, then the block in order.
    close(value(&p, temporal[0].body, WORLD), 10.0);
    close(value(&p, temporal[1].body, WORLD), 12.0);
    close(value(&p, temporal[2].body, WORLD), -5.0);
    close(value(&p, temporal[3].body, WORLD), 10.0);
    let initial = p.constraints.iter().find(|c| c.block == Block::Initial).expect("an initial condition");
    assert_eq!(initial.domain, Domain::Start(PhaseAt { phase: 0, agent: None, index: None }));
    let last = p.constraints.iter().find(|c| c.block == Block::Final).expect("a final condition");
    assert_eq!(last.domain, Domain::End(PhaseAt { phase: 1, agent: None, index: None }));
}

#[test]
fn outputs_are_continuous_as_far_as_the_smaller_spline_and_the_phase_say() {
    let names = |text: &str| -> Vec<String> {
        let p = good(text);
        let junctions = p.constraints.iter().filter(|c| c.block == Block::Continuity);
        junctions.map(|c| c.name.clone().expect("junctions are named")).collect()
    };
    let (h, dh) = ("coast.continuity of h", "coast.continuity of der(h, 1)");
    assert_eq!(names(PHASES), [h, dh]);
    let free = PHASES.replace("continuous h up to 1;", "").replace("jump s;", "continuous s up to 0;");
    assert_eq!(names(&free), [h, dh, "coast.continuity of der(h, 2)", "coast.continuity of s"]);
    let p = good(PHASES);
    let first = p.constraints.iter().find(|c| c.block == Block::Continuity).expect("a junction");
    close(value(&p, first.body, WORLD), 101.0 - 201.0);
}

#[test]
fn a_guess_over_phases_uses_the_whole_time() {
    let p = good(PHASES);
    let GuessKind::Output { value: node, .. } = p.guesses[3].kind.clone() else { panic!("an output") };
    close(value(&p, node, WORLD), (7.0 + 0.4 * 10.0) / 10.0);
    assert_eq!(p.guesses[0].scope, GuessScope::Agent(0, None));
    assert_eq!(p.guesses[1].scope, GuessScope::Phase(PhaseAt { phase: 0, agent: None, index: None }));
}

#[test]
fn a_family_of_phases_stays_one() {
    let p = good(
        "problem Gates {
        param gate[4] = (1, 2, 3, 4) [m];
        output x [m], y[1 .. 2] [m]: spline(order = 5, intervals = 2, smoothness = 3);
        minimize integral(der(x, 2)^2) / 1 [m^2/s^3] + end(leg[4]) / 1 [s] + sum(i in 1 .. 4, duration(leg[i])) / 1 [s];
        phase leg[i in 1 .. 4] after leg[i - 1] {
            duration in 1 .. 9 [s];
            final { x == gate[i]; }
            jump y[2];
        }
        phase home after leg[4] { duration in 1 .. 2 [s]; }
        initial { x == 0; }
        final { x == 5 [m]; }
        guess { for i in 1 .. 4 { duration(leg[i]) = i * 1 [s]; } }
    }",
    );
    assert_eq!(p.phases.len(), 2);
    let family = p.phases[0].family.clone().expect("a family");
    assert_eq!((family.first.constant, family.last.constant), (1, 4));
    let gate = p.constraints.iter().find(|c| c.block == Block::Final && !c.loops.is_empty()).expect("a gate");
    assert_eq!(gate.loops, std::slice::from_ref(&family));
    let index = Some(Form { constant: 0, terms: vec![(family.index, 1)] });
    assert_eq!(gate.domain, Domain::End(PhaseAt { phase: 0, agent: None, index }));
    let bound = gate.bounds.lower.expect("an equality");
    close(value_at(&p, bound, WORLD, &HashMap::from([(family.index.0, 3)])), 3.0);
    // The total is a reduction over the family and the phase after it.
    let x = 1.0 + 20.0;
    close(value(&p, p.objective[0].body, WORLD), 5.0 * 5.0 * x * x + 12.0 + 4.0 * 5.0);
    // Inside the family from one member to the next, and from its last member home.
    let junctions: Vec<&Constraint> = p.constraints.iter().filter(|c| c.block == Block::Continuity).collect();
    assert_eq!(junctions.iter().filter(|c| c.loops.is_empty()).count(), 3);
    let inner = junctions.iter().find(|c| c.loops.len() == 1 && c.span == junctions[0].span).expect("an inner one");
    assert_eq!((inner.loops[0].first.constant, inner.loops[0].last.constant), (2, 4));
    let initial = p.constraints.iter().find(|c| c.block == Block::Initial).expect("an initial condition");
    let first = Form { constant: 1, terms: vec![] };
    assert_eq!(initial.domain, Domain::Start(PhaseAt { phase: 0, agent: None, index: Some(first) }));
    assert_eq!(p.guesses[0].loops.len(), 1);
    let y: Vec<&&Constraint> =
        junctions.iter().filter(|c| c.name.as_deref().is_some_and(|n| n.contains("of y"))).collect();
    assert!(y.iter().all(|c| c.loops.last().is_some_and(|over| (1..=2).contains(&over.last.constant))));
}

#[test]
fn a_family_of_agents_stays_one_and_meets_in_temporal() {
    let p = good("problem Strike {
        const n = 3;
        param from[n] = (1, 2, 3) [km];
        agent uav[i in 1 .. n] {
            start in 0 .. 600 [s];
            duration T in 100 .. 900 [s];
            output x [km]: spline(order = 5, intervals = 4, smoothness = 3);
            let v = der(x);
            minimize integral(v^2) / 1 [km^2/s];
            initial { x == from[i]; }
            trajectory { fast: v <= 0.3 [km/s] + 0.01 [km/s] * i; }
            final { x == 0; }
        }
        agent looker {
            output x [km]: spline(order = 5, intervals = 4);
            phase look { duration in 1 .. 2 [s]; }
            phase leave after look { duration in 1 .. 2 [s]; }
            trajectory { x >= 0; }
        }
        minimize end(uav[1]) / 1 [s] + sum(i in 1 .. n, integral(uav[i], x)) / 1 [km*s];
        temporal {
            for i in 1 .. n - 1 { end(uav[i]) == end(uav[i + 1]); }
            start(looker) - uav[2].T in -600 .. -300 [s];
            final(looker.look, x) >= initial(uav[2], x);
        }
        guess { for i in 1 .. n { start(uav[i]) = 10 [s] * i; uav[i].x = from[i] * (1 - tau); } duration(looker.look) = 1 [s]; }
    }");
    assert_eq!(p.agents.len(), 2);
    let family = p.agents[0].family.clone().expect("a family");
    assert!(matches!(p.agents[0].start, Start::Free(_)) && matches!(p.agents[1].start, Start::Fixed(None)));
    let fast = p.constraints.iter().find(|c| c.name.as_deref() == Some("uav.fast")).expect("it has a path");
    assert_eq!(fast.loops, std::slice::from_ref(&family));
    let bound = fast.bounds.upper.expect("a bound");
    close(value_at(&p, bound, WORLD, &HashMap::from([(family.index.0, 2)])), 320.0);
    let term = p.objective.iter().find(|term| term.loops == [family.clone()]).expect("each pays its share");
    assert_eq!(p.objective.len(), 2);
    assert!(matches!(p.dag.node(term.body), Node::Binary(..) | Node::Input(_)));
    let simultaneous = p.constraints.iter().find(|c| c.block == Block::Temporal).expect("a strike");
    assert_eq!(simultaneous.loops.len(), 1);
    let total = p.objective.iter().find(|term| term.loops.is_empty()).expect("the problem's own");
    close(value(&p, total.body, WORLD), 12.0 + 3.0 * 5.0 / 1e3);
    assert_eq!(p.guesses.len(), 3);
    assert!(matches!(&p.guesses[1].scope, GuessScope::Agent(0, Some(form)) if form.terms.len() == 1));
    assert_eq!(p.constraints.iter().filter(|c| c.name.is_none() && c.block == Block::Trajectory).count(), 2);
}

#[test]
fn an_event_time_under_a_name_may_be_used_along_the_way() {
    let p = good(
        "problem P {
        output z: spline(order = 5, intervals = 2);
        minimize integral(der(z, 2)^2);
        phase a { duration in 1 .. 2; }
        phase b after a { duration in 1 .. 2;  let since = t - end(a);  trajectory { z <= since; } }
    }",
    );
    close(value(&p, named(&p, "since"), WORLD), 2.0 - 12.0);
}

#[test]
fn names_of_other_scopes_need_their_path() {
    let text = "problem P {
        agent a { duration T = 5; output z: spline(order = 5, intervals = 2); minimize integral(z^2); }
        agent b { duration T = 5; output w: spline(order = 5, intervals = 2); minimize integral(z^2); }
        temporal { T <= 3; }
    }";
    let found = findings(text);
    assert_eq!(found.matches("E020").count(), 2, "{found}");
}

/// Text of three hours, each with its own price: statements of the problem, of each hour, and the objective.
fn hours(common: &str, own: &str, total: &str) -> String {
    format!(
        "problem Storage {{
            param price[3] = (1, 3, 2);
            {common}
            collocation gauss(points = 2, intervals = 1);
            state E in 0 .. 2;
            input u in -1 .. 1: held;
            dynamics {{ der(E) == -u; }}
            initial {{ E == 1; }}
            phase hour[i in 1 .. 3] {{ duration = 1; {own} }}
            {total}
        }}"
    )
}

#[test]
fn what_a_family_names_by_its_index_itself_stands_in_totals() {
    for own in ["let c = i * u;", "let p = price[i];  let c = p * i * u;", "let w = (i, 2 * i);  let c = w[2] * u;"] {
        for total in ["maximize integral(c);", "maximize integral(c) - final(c);", "minimize initial(c)^2;"] {
            good(&hours("", own, total));
        }
        let (p, q) = (
            good(&hours("", own, "maximize integral(c);")),
            good(&hours("", own, "maximize sum(k in 1 .. 3, integral(hour[k], c));")),
        );
        assert_eq!((p.phases.len(), q.phases.len()), (1, 1), "{own}: the family stays one");
    }
}

#[test]
fn an_index_of_the_whole_problem_is_none_of_a_family() {
    for (common, own) in [
        ("let e[i in 1 .. 3] = 2 * price[i];", "let c = e[i] * u;"),
        ("let all = sum(i in 1 .. 3, price[i]);", "let c = all * price[i] * u;"),
        ("trajectory { for i in 1 .. 3 { u <= price[i]; } }", "let c = i * u;"),
    ] {
        good(&hours(common, own, "maximize integral(c);"));
    }
}
