//! A small reader of .nl files: values of objective and rows at a point. It knows the format and nothing of ntg.

/// A file as read.
pub(crate) struct Nl {
    pub(crate) variables: usize,
    pub(crate) start: Vec<f64>,
    pub(crate) bounds: Vec<(f64, f64)>,
    pub(crate) row_bounds: Vec<(f64, f64)>,
    shared: Vec<(Vec<(usize, f64)>, Tree)>,
    rows: Vec<(Tree, Vec<(usize, f64)>)>,
    objective: (Tree, Vec<(usize, f64)>),
    /// Header numbers, line by line.
    pub(crate) header: Vec<Vec<usize>>,
}

enum Tree {
    Number(f64),
    Variable(usize),
    Operation(usize, Vec<Tree>),
}

struct Words<'a>(std::iter::Peekable<std::str::SplitWhitespace<'a>>);

impl Words<'_> {
    fn word(&mut self) -> &str {
        self.0.next().expect("the file goes on")
    }

    fn number<T: std::str::FromStr>(&mut self) -> T {
        let word = self.word();
        word.parse().unwrap_or_else(|_| panic!("a number and not {word}"))
    }

    fn terms(&mut self, count: usize) -> Vec<(usize, f64)> {
        (0..count).map(|_| (self.number(), self.number())).collect()
    }

    fn tree(&mut self) -> Tree {
        let word = self.word().to_owned();
        let (kind, rest) = word.split_at(1);
        match kind {
            "n" => Tree::Number(rest.parse().expect("a number")),
            "v" => Tree::Variable(rest.parse().expect("a variable")),
            "o" => {
                let code = rest.parse().expect("a code");
                let count = match code {
                    11 | 12 | 54 => self.number(),
                    35 => 3,
                    0..=5 | 22 | 23 | 30 | 48 => 2,
                    _ => 1,
                };
                Tree::Operation(code, (0..count).map(|_| self.tree()).collect())
            }
            other => panic!("`{other}` begins no expression"),
        }
    }

    fn range(&mut self) -> (f64, f64) {
        let (none, kind) = ((f64::NEG_INFINITY, f64::INFINITY), self.number::<usize>());
        match kind {
            0 => (self.number(), self.number()),
            1 => (none.0, self.number()),
            2 => (self.number(), none.1),
            3 => none,
            4 => {
                let value = self.number();
                (value, value)
            }
            other => panic!("there is no kind {other} of bounds"),
        }
    }
}

impl Nl {
    pub(crate) fn read(text: &str) -> Self {
        let mut lines = text.lines();
        assert!(lines.next().expect("a header").starts_with("g3"));
        let numbers = |line: &str| -> Vec<usize> {
            let numbers = line.split('#').next().unwrap_or_default().split_whitespace();
            numbers.map(|word| word.parse().expect("a whole number")).collect()
        };
        let header: Vec<Vec<usize>> = lines.by_ref().take(9).map(numbers).collect();
        let (variables, rows) = (header[0][0], header[0][1]);
        let body: String = lines.flat_map(|line| [line, "\n"]).collect();
        let mut words = Words(body.split_whitespace().peekable());
        let mut nl = Self {
            variables,
            start: vec![0.0; variables],
            bounds: vec![],
            row_bounds: vec![],
            shared: vec![],
            rows: (0..rows).map(|_| (Tree::Number(0.0), vec![])).collect(),
            objective: (Tree::Number(0.0), vec![]),
            header,
        };
        while words.0.peek().is_some() {
            nl.segment(&mut words);
        }
        nl
    }

    fn segment(&mut self, words: &mut Words<'_>) {
        let word = words.word().to_owned();
        let (kind, rest) = word.split_at(1);
        let at = || rest.parse::<usize>().expect("a number");
        match kind {
            "V" => {
                assert_eq!(at(), self.variables + self.shared.len(), "shared expressions come in order");
                let count = words.number();
                let _: usize = words.number();
                let terms = words.terms(count);
                self.shared.push((terms, words.tree()));
            }
            "C" => self.rows[at()].0 = words.tree(),
            "O" => {
                let _: usize = words.number();
                self.objective.0 = words.tree();
            }
            "x" => words.terms(at()).into_iter().for_each(|(variable, value)| self.start[variable] = value),
            "r" => self.row_bounds = (0..self.rows.len()).map(|_| words.range()).collect(),
            "b" => self.bounds = (0..self.variables).map(|_| words.range()).collect(),
            "k" => assert!((0..at()).map(|_| words.number::<usize>()).is_sorted()),
            "J" => {
                let count = words.number();
                self.rows[at()].1 = words.terms(count);
            }
            "G" => {
                let count = words.number();
                self.objective.1 = words.terms(count);
            }
            other => panic!("there is no segment {other}"),
        }
    }

    /// The objective and the rows.
    pub(crate) fn values(&self, x: &[f64]) -> (f64, Vec<f64>) {
        let mut all = x.to_vec();
        let linear = |terms: &[(usize, f64)], all: &[f64]| terms.iter().map(|(v, c)| c * all[*v]).sum::<f64>();
        for (terms, tree) in &self.shared {
            all.push(linear(terms, &all) + value(tree, &all));
        }
        let row = |(tree, terms): &(Tree, Vec<(usize, f64)>)| value(tree, &all) + linear(terms, &all);
        (row(&self.objective), self.rows.iter().map(row).collect())
    }

    /// The variables of a row's linear part, which must be all of the row.
    pub(crate) fn variables_of(&self, row: usize) -> Vec<usize> {
        self.rows[row].1.iter().map(|(variable, _)| *variable).collect()
    }
}

fn value(tree: &Tree, all: &[f64]) -> f64 {
    let (code, operands) = match tree {
        Tree::Number(number) => return *number,
        Tree::Variable(variable) => return all[*variable],
        Tree::Operation(code, operands) => (*code, operands),
    };
    let at = |i: usize| value(&operands[i], all);
    let all_of = || operands.iter().map(|operand| value(operand, all));
    match code {
        0 => at(0) + at(1),
        1 => at(0) - at(1),
        2 => at(0) * at(1),
        3 => at(0) / at(1),
        5 => at(0).powf(at(1)),
        11 => all_of().fold(f64::INFINITY, f64::min),
        12 => all_of().fold(f64::NEG_INFINITY, f64::max),
        13 => at(0).floor(),
        15 => at(0).abs(),
        22 => f64::from(at(0) < at(1)),
        23 => f64::from(at(0) <= at(1)),
        30 => f64::from(at(0) != at(1)),
        35 => at(if at(0) != 0.0 { 1 } else { 2 }),
        37 => at(0).tanh(),
        38 => at(0).tan(),
        39 => at(0).sqrt(),
        40 => at(0).sinh(),
        41 => at(0).sin(),
        43 => at(0).ln(),
        44 => at(0).exp(),
        45 => at(0).cosh(),
        46 => at(0).cos(),
        48 => at(0).atan2(at(1)),
        49 => at(0).atan(),
        51 => at(0).asin(),
        53 => at(0).acos(),
        54 => all_of().sum(),
        other => panic!("operation {other} is not known"),
    }
}
