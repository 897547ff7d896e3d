//! How long an editor waits after a keystroke, in specs of growing length: from the change to the diagnostics of the
//! new text, over the protocol. A person takes 20 ms for at once.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use lsp_server::{Connection, Message, Notification, Request};
use serde_json::json;

const URI: &str = "file:///bench/spec.ntg";

/// The low-observability flight with more named expressions and constraints, to a number of lines.
fn spec(lines: usize) -> String {
    let flight = include_str!("../../specs/low_observable.ntg");
    let (before, after) = flight.rsplit_once("    trajectory {\n").expect("the spec has a trajectory");
    let mut more = String::new();
    let mut limits = String::from("    trajectory {\n");
    let count = lines.saturating_sub(flight.lines().count()) / 4;
    for i in 0..count {
        more.push_str(&format!(
            "    /// Distance from a radar of the net.\n    let slant_{i} [km] = hypot(x - {i} [km], y + 3 [km], altitude);\n    \
             let seen_{i} = logistic((slant_{i} / 1 [km] - log(slant_{i} / 7 [km]) * signature) / 0.1);\n"
        ));
        limits.push_str(&format!("        hidden_{i}: seen_{i} <= 2;\n"));
    }
    format!("{before}{more}{limits}{after}")
}

/// The server's other end.
struct Editor {
    connection: Connection,
    version: i32,
}

impl Editor {
    fn new() -> Self {
        let (server, client) = Connection::memory();
        std::thread::spawn(move || ntg_lsp::serve(&server));
        let editor = Self { connection: client, version: 0 };
        editor.send(Message::Request(Request::new(1.into(), "initialize".to_owned(), json!({ "capabilities": {} }))));
        editor.connection.receiver.recv().expect("the server answers");
        editor.notify("initialized", json!({}));
        editor
    }

    fn send(&self, message: Message) {
        self.connection.sender.send(message).expect("the server listens");
    }

    fn notify(&self, method: &str, params: serde_json::Value) {
        self.send(Message::Notification(Notification::new(method.to_owned(), params)));
    }

    fn diagnostics(&self) -> usize {
        let Message::Notification(told) = self.connection.receiver.recv().expect("the server answers") else {
            panic!("the server tells of diagnostics only");
        };
        told.params["diagnostics"].as_array().map_or(0, Vec::len)
    }

    fn open(&self, text: &str) -> usize {
        let document = json!({ "uri": URI, "languageId": "ntg", "version": 0, "text": text });
        self.notify("textDocument/didOpen", json!({ "textDocument": document }));
        self.diagnostics()
    }

    /// Types over the number in `param reach = 1 [km];`.
    fn type_over(&mut self, with: &str) -> usize {
        self.version += 1;
        let place = |character| json!({ "line": 23, "character": character });
        let range = json!({ "start": place(18), "end": place(19) });
        self.notify(
            "textDocument/didChange",
            json!({
                "textDocument": { "uri": URI, "version": self.version },
                "contentChanges": [{ "range": range, "text": with }],
            }),
        );
        self.diagnostics()
    }
}

fn keystroke(c: &mut Criterion) {
    let mut group = c.benchmark_group("keystroke");
    for lines in [125, 250, 500, 1000] {
        let text = spec(lines);
        let mut editor = Editor::new();
        let good = editor.open(&text);
        for (name, letters) in [("good", ["1", "2"]), ("half-typed", ["(", "["])] {
            let mut turn = 0;
            group.bench_function(BenchmarkId::new(name, text.lines().count()), |b| {
                b.iter(|| {
                    turn += 1;
                    let found = editor.type_over(letters[turn % 2]);
                    assert!(name == "good" && found == good || name != "good" && found > 0, "{found}");
                });
            });
        }
    }
}

criterion_group!(benches, keystroke);
criterion_main!(benches);
