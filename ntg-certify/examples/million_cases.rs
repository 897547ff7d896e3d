//! 10^6 random cases of interval operations against exact rationals, and as many of functions against multi-precision.
//!
//! `cargo run --release -p ntg-certify --example million_cases [COUNT [SEED]]`

#[path = "support/cases.rs"]
mod cases;

fn main() -> std::process::ExitCode {
    let mut arguments = std::env::args().skip(1).filter_map(|a| a.parse::<u64>().ok());
    let (count, seed) = (arguments.next().unwrap_or(1_000_000), arguments.next().unwrap_or(1));
    let (mut random, mut reference) = (fastrand::Rng::with_seed(seed), cases::Reference::new());
    let mut escaped = 0_u64;
    let mut say = |found: Option<String>| {
        if let Some(words) = found {
            escaped += 1;
            println!("{words}");
        }
    };
    for _ in 0..count {
        say(cases::arithmetic(&mut random));
        // Half of the functions have one argument.
        say(if random.bool() {
            cases::elementary(&mut random, &mut reference)
        } else {
            cases::binary(&mut random, &mut reference)
        });
    }
    let (units, name) = reference.worst;
    println!("{count} cases of operations and {count} of functions: {escaped} escaped");
    println!("largest error of ntg-math: {units} units of the last place ({name})");
    std::process::ExitCode::from(u8::from(escaped > 0))
}
