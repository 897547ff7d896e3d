//! What an editor waits for after a keystroke, in long specs of several kinds: from the change to the diagnostics of the
//! new text, over the protocol. A person takes 20 ms for at once.
//!
//! Processor time of the whole process, so that other work on the machine does not count.
//! `cargo bench -p ntg-lsp --bench keystroke -- bodies 250 500 1000`: one kind, other lengths.

mod long;

use cpu_time::ProcessTime;
use lsp_server::{Connection, Message, Notification, Request};
use serde_json::json;

const URI: &str = "file:///bench/spec.ntg";

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

    /// Types over the number in `param knob = 1;`, which stands at a line.
    fn type_over(&mut self, line: usize, with: &str) -> usize {
        self.version += 1;
        let at = long::KNOB.len() - 2;
        let place = |character| json!({ "line": line, "character": character });
        let range = json!({ "start": place(at), "end": place(at + 1) });
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

/// Milliseconds of a keystroke, the median of several.
fn median(mut keystroke: impl FnMut(usize)) -> f64 {
    const TIMES: usize = 21;
    keystroke(0);
    let mut times: Vec<f64> = (1..=TIMES)
        .map(|turn| {
            let start = ProcessTime::now();
            keystroke(turn);
            start.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[TIMES / 2]
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let lengths: Vec<usize> = arguments.iter().filter_map(|argument| argument.parse().ok()).collect();
    let lengths = if lengths.is_empty() { vec![500] } else { lengths };
    let kinds: Vec<&String> = arguments.iter().filter(|argument| argument.parse::<usize>().is_err()).collect();
    println!("{:<10} {:>6} {:>10} {:>12}", "spec", "lines", "right, ms", "half, ms");
    for (name, shape) in
        long::SHAPES.iter().filter(|(name, _)| kinds.is_empty() || kinds.iter().any(|kind| kind == name))
    {
        for lines in &lengths {
            let text = shape(*lines);
            let line = text.lines().position(|line| line == long::KNOB).expect("there is a place to type");
            let mut editor = Editor::new();
            assert_eq!(editor.open(&text), 0, "{name} is right");
            let right = median(|turn| assert_eq!(editor.type_over(line, ["1", "2"][turn % 2]), 0));
            let half = median(|turn| assert!(editor.type_over(line, ["(", "["][turn % 2]) > 0));
            println!("{name:<10} {:>6} {right:>10.1} {half:>12.1}", text.lines().count());
        }
    }
}
