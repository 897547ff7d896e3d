//! The tube of an oscillator, written by hand: `x'' = -x` from 1 at rest is the cosine.

/// A number, exactly.
fn exact(x: f64) -> String {
    if x == 0.0 {
        return "0p0".to_owned();
    }
    let (bits, sign) = (x.abs().to_bits(), if x < 0.0 { "-" } else { "" });
    format!("{sign}{}p{}", (bits & ((1 << 52) - 1)) | 1 << 52, (bits >> 52) as i32 - 1075)
}

fn list(all: &[f64]) -> String {
    all.iter().fold(all.len().to_string(), |words, x| words + " " + &exact(*x))
}

/// What a certificate says of the oscillator over a time of 1, in sixteen boxes.
#[derive(Clone)]
struct Oscillator {
    /// Bernstein coefficients of a cubic.
    spline: Vec<f64>,
    /// The operation that joins `x''` and `x` to what is to be 0.
    operation: &'static str,
    duration: f64,
    equations: &'static str,
    trees: &'static str,
    begin: &'static str,
    /// Of `x` and of `x'`: at all times, and at the end.
    bounds: [[f64; 4]; 2],
    /// Of each box: what `x` and `x'` begin with, `x''`, and the rest.
    boxes: Vec<[Vec<f64>; 5]>,
}

/// What an enclosure of the difference from the cubic on a sixteenth of the time may be too wide by.
const ROOM: f64 = 1e-4;

/// The cosine less the cubic, and the derivatives.
fn apart(spline: &[f64], t: f64) -> [f64; 2] {
    let [a, b, c, d] = spline else { panic!("a cubic") };
    let s = 1.0 - t;
    let x = a * s * s * s + 3.0 * b * s * s * t + 3.0 * c * s * t * t + d * t * t * t;
    let v = 3.0 * ((b - a) * s * s + 2.0 * (c - b) * s * t + (d - c) * t * t);
    [t.cos() - x, -t.sin() - v]
}

impl Oscillator {
    fn sound() -> Self {
        let spline = vec![1.0, 1.0, 1_f64.cos() + 1_f64.sin() / 3.0, 1_f64.cos()];
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for i in 0..=1000 {
            let found = apart(&spline, f64::from(i) / 1000.0);
            (0..2).for_each(|c| (low[c], high[c]) = (low[c].min(found[c]), high[c].max(found[c])));
        }
        let end = apart(&spline, 1.0);
        let room = ROOM;
        let bounds = std::array::from_fn(|c| [low[c] - room, high[c] + room, end[c] - 1e-8, end[c] + 1e-8]);
        let boxes = (0..16).map(|k| Self::cosine(f64::from(k) / 16.0)).collect();
        let (duration, equations, trees, begin) = (1.0, "1 0", "////../..//../..///../..//../..", "-");
        Self { spline, operation: "add", duration, equations, trees, begin, bounds, boxes }
    }

    /// A box from `a` on: the derivatives of Taylor's polynomial of degree 8 in Bernstein form.
    fn cosine(a: f64) -> [Vec<f64>; 5] {
        const DEGREE: usize = 8;
        let derivatives = [-a.cos(), a.sin(), a.cos(), -a.sin()];
        let mut powers = vec![];
        let mut factor = 1.0;
        for p in 0..=DEGREE {
            powers.push(derivatives[p % 4] * factor);
            factor /= 16.0 * (p + 1) as f64;
        }
        let binomial = |n: usize, k: usize| (0..k).fold(1.0, |all, i| all * (n - i) as f64 / (i + 1) as f64);
        let bernstein = |i: usize| (0..=i).map(|p| binomial(i, p) / binomial(DEGREE, p) * powers[p]).sum();
        let highest = (0..=DEGREE).map(bernstein).collect();
        [vec![a.cos(), -a.sin()], highest, vec![1e-9, 1e-9], vec![2e-9], vec![1.0, 0.0, 0.0, 1.0]]
    }

    fn text(&self) -> String {
        let mut text = format!(
            "ntg-certificate 2\nnumber 0p0\nnumber {}\nphase 0 1 2 0p0 1p0\nspline 0 4 8 0p0 0p0 0p0 0p0 1p0 1p0 1p0 1p0 {}\n\
             flat 0 0\nflat 0 2\ngraph\ninput 0\ninput 1\n{} 0 1\ngraph\nconst 0p0\nfunction 0 2 flat 1 flat 0\nfunction 1 0\n\
             claim undecided -inf inf 1 1 path 0 0 0 1 # motion\ncover .\ntube 0 {} {}\nunknown 0\n",
            exact(self.duration),
            list(&self.spline),
            self.operation,
            self.equations,
            self.trees,
        );
        for bounds in self.bounds {
            let words: Vec<String> = bounds.iter().map(|x| exact(*x)).collect();
            text += &format!("component {} {} # x\n", self.begin, words.join(" "));
        }
        for own in &self.boxes {
            let words: Vec<String> = own.iter().map(|all| list(all)).collect();
            text += &format!("box {}\n", words.join(" "));
        }
        text
    }

    fn check(&self) -> Result<usize, String> {
        ntg_check::verify_claims(&self.text()).map(|checked| checked["tubes"])
    }
}

#[test]
fn the_cosine_is_in_its_tube() {
    assert_eq!(Oscillator::sound().check(), Ok(1));
}

#[track_caller]
fn rejected(words: &str, change: impl Fn(&mut Oscillator)) {
    let mut spoilt = Oscillator::sound();
    change(&mut spoilt);
    let found = spoilt.check().expect_err(words);
    assert!(found.contains(words), "{found}");
}

#[test]
fn what_is_false_is_rejected() {
    for c in [0, 1] {
        rejected("it may be left", |all| all.bounds[c][0] += ROOM + 1e-6);
        rejected("it may be left", |all| all.bounds[c][1] -= ROOM + 1e-6);
    }
    for (c, which) in [(0, 2), (0, 3), (1, 2), (1, 3)] {
        rejected("its end may be missed", |all| all.bounds[c][which] = all.bounds[c][5 - which]);
    }
    rejected("tube 0", |all| all.operation = "sub");
    rejected("tube 0", |all| all.spline[0] += 1e-3);
    rejected("tube 0", |all| all.spline[1] += 1e-3);
    rejected("tube 0", |all| all.spline[2] += 1e-2);
    rejected("tube 0", |all| all.begin = "0");
}

#[test]
fn what_proves_nothing_is_rejected() {
    rejected("differences may leave", |all| all.boxes[0][2][1] = 1e-15);
    rejected("highest derivatives may leave", |all| all.boxes[1][3][0] = 1e-17);
    rejected("tube 0", |all| all.boxes[2][0][0] += 1e-6);
    rejected("tube 0", |all| all.boxes[2][1][3] += 1e-6);
    rejected("tube 0", |all| all.boxes.swap(1, 2));
    rejected("not described", |all| all.boxes.truncate(15));
    rejected("not described in full", |all| all.boxes[0][2].truncate(1));
    rejected("not described in full", |all| all.boxes[0][1].clear());
    rejected("independent", |all| all.boxes[3][4] = vec![1.0, 2.0, 2.0, 4.0]);
    rejected("left out", |all| all.equations = "0");
    rejected("do not determine", |all| all.equations = "2 0 0");
    rejected("leaves times out", |all| all.trees = "////../..//../..///../..//../.");
    rejected("does not cover", |all| all.trees = "");
}
