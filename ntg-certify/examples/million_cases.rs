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
    for case in 1..=count {
        let operation = cases::arithmetic(&mut random);
        // Half of the functions have one argument.
        let function = if random.bool() {
            cases::elementary(&mut random, &mut reference)
        } else {
            cases::binary(&mut random, &mut reference)
        };
        for words in operation.into_iter().chain(function) {
            escaped += 1;
            println!("{words}");
        }
        if case.is_multiple_of(count.div_ceil(10)) {
            eprintln!("{case} of {count} cases, {escaped} escaped");
        }
    }
    let (units, name) = reference.worst;
    println!("{count} cases of operations and {count} of functions: {escaped} escaped");
    println!("largest error of ntg-math: {units} units of the last place ({name})");
    std::process::ExitCode::from(u8::from(escaped > 0))
}
