//! The server over its real protocol: the process, its pipes, Content-Length frames.

use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use lsp_server::{Connection, Message, Notification, Request};
use serde_json::{Value, json};

const URI: &str = "file:///specs/flight.ntg";

/// An editor with one server.
struct Editor {
    server: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
    id: i64,
    version: i64,
}

impl Editor {
    fn new() -> Self {
        let mut command = Command::new(env!("CARGO_BIN_EXE_ntg-lsp"));
        let mut server = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("the server starts");
        let to = server.stdin.take().expect("it was asked for");
        let from = BufReader::new(server.stdout.take().expect("it was asked for"));
        let mut editor = Self { server, to, from, id: 0, version: 0 };
        let answer = editor.ask("initialize", json!({ "processId": null, "rootUri": null, "capabilities": {} }));
        assert_eq!(answer["capabilities"]["hoverProvider"], true);
        editor.tell("initialized", json!({}));
        editor
    }

    fn write(&mut self, message: &Value) {
        let text = message.to_string();
        write!(self.to, "Content-Length: {}\r\n\r\n{text}", text.len()).expect("the server listens");
        self.to.flush().expect("the server listens");
    }

    fn read(&mut self) -> Value {
        let mut length = 0;
        loop {
            let mut line = String::new();
            assert!(self.from.read_line(&mut line).expect("the server speaks") > 0, "the server has gone");
            if line == "\r\n" {
                break;
            }
            if let Some(number) = line.strip_prefix("Content-Length: ") {
                length = number.trim().parse().expect("a length");
            }
        }
        let mut bytes = vec![0; length];
        self.from.read_exact(&mut bytes).expect("as much as was announced");
        serde_json::from_slice(&bytes).expect("JSON")
    }

    fn tell(&mut self, method: &str, params: Value) {
        self.write(&json!({ "jsonrpc": "2.0", "method": method, "params": params }));
    }

    /// The answer to a request, or the error.
    fn try_ask(&mut self, method: &str, params: Value) -> Result<Value, Value> {
        self.id += 1;
        self.write(&json!({ "jsonrpc": "2.0", "id": self.id, "method": method, "params": params }));
        let answer = self.read();
        assert_eq!(answer["id"], self.id, "{answer}");
        match answer.get("error") {
            Some(error) => Err(error.clone()),
            None => Ok(answer["result"].clone()),
        }
    }

    #[track_caller]
    fn ask(&mut self, method: &str, params: Value) -> Value {
        self.try_ask(method, params).unwrap_or_else(|error| panic!("{method}: {error}"))
    }

    fn diagnostics(&mut self) -> Vec<Value> {
        let told = self.read();
        assert_eq!(told["method"], "textDocument/publishDiagnostics", "{told}");
        assert_eq!(told["params"]["version"], self.version);
        told["params"]["diagnostics"].as_array().cloned().expect("a list")
    }

    fn open(&mut self, text: &str) -> Vec<Value> {
        let document = json!({ "uri": URI, "languageId": "ntg", "version": self.version, "text": text });
        self.tell("textDocument/didOpen", json!({ "textDocument": document }));
        self.diagnostics()
    }

    fn change(&mut self, range: (u32, u32, u32, u32), text: &str) -> Vec<Value> {
        self.version += 1;
        let range = json!({
            "start": { "line": range.0, "character": range.1 },
            "end": { "line": range.2, "character": range.3 },
        });
        let document = json!({ "uri": URI, "version": self.version });
        let changes = json!([{ "range": range, "text": text }]);
        self.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": changes }));
        self.diagnostics()
    }

    /// A request about the first place of `word` in the text, `skip` places further on.
    fn at(&mut self, method: &str, text: &str, word: &str, skip: usize, more: &Value) -> Result<Value, Value> {
        let at = text.match_indices(word).nth(skip).unwrap_or_else(|| panic!("`{word}` stands in the text")).0;
        let before = &text[..at];
        let line = before.matches('\n').count();
        let character: usize = before.rsplit('\n').next().unwrap_or("").chars().map(char::len_utf16).sum();
        let mut params = json!({
            "textDocument": { "uri": URI },
            "position": { "line": line, "character": character },
        });
        for (key, value) in more.as_object().into_iter().flatten() {
            params[key] = value.clone();
        }
        self.try_ask(method, params)
    }

    fn hover(&mut self, text: &str, word: &str, skip: usize) -> String {
        let answer = self.at("textDocument/hover", text, word, skip, &json!({})).expect("an answer");
        answer["contents"]["value"].as_str().unwrap_or_default().to_owned()
    }

    fn proposals(&mut self, text: &str, word: &str) -> Vec<String> {
        let answer = self.at("textDocument/completion", text, word, 0, &json!({})).expect("an answer");
        let labels = answer.as_array().into_iter().flatten().filter_map(|item| item["label"].as_str());
        labels.map(str::to_owned).collect()
    }

    fn end(mut self) {
        assert_eq!(self.ask("shutdown", Value::Null), Value::Null);
        self.tell("exit", Value::Null);
        assert!(self.server.wait().expect("the server ends").success());
    }
}

/// A spec with letters of one, two and four bytes before names.
const TEXT: &str = "/// 𝛼 flight.
problem Flight {
    duration T in 1 .. 9 [s];
    /// Where it is.
    output x, ψ [km]: spline(order = 5, intervals = 4, smoothness = 3);
    param v_max = 250 [m/s];
    const two = 2;
    fn half(u) = u / two;
    /* 𝛼𝛼 */ let v [km/s] = der(x); // 𝛼
    let a = der(v) + half(der(ψ, 2));
    minimize effort: integral(a^2) / 1 [m^2/s^3];
    initial { x == 0;  v == 0 [km/s]; }
    trajectory { fast: v <= v_max; }
    final { x == 1 [km]; }
}
";

#[test]
fn diagnostics_come_as_one_types_and_go_when_it_is_mended() {
    let mut editor = Editor::new();
    assert_eq!(editor.open(TEXT), Vec::<Value>::new());
    // `/* 𝛼𝛼 */ let v [km/s] = der(x);`: each 𝛼 is two code units; the x stands at 4 + 33.
    let line = TEXT.lines().nth(8).expect("there");
    let column: usize = line[..line.find("x)").expect("there")].chars().map(char::len_utf16).sum();
    let column = u32::try_from(column).expect("short");
    let found = editor.change((8, column, 8, column + 1), "xy");
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0]["code"], "E020");
    assert_eq!(found[0]["severity"], 1);
    assert_eq!(found[0]["range"]["start"], json!({ "line": 8, "character": column }));
    assert_eq!(found[0]["range"]["end"], json!({ "line": 8, "character": column + 2 }));
    assert!(found[0]["message"].as_str().is_some_and(|m| m.contains("help: did you mean `x`?")), "{found:?}");
    assert_eq!(editor.change((8, column, 8, column + 2), "x"), Vec::<Value>::new());
    let broken = editor.change((8, column, 8, column + 1), "(");
    assert!(broken.iter().any(|finding| finding["code"].as_str() < Some("E020")), "{broken:?}");
    editor.end();
}

#[test]
fn hover_tells_value_unit_dimension_documentation_and_what_der_expands_to() {
    let mut editor = Editor::new();
    editor.open(TEXT);
    let output = editor.hover(TEXT, "x);", 0);
    assert!(output.contains("Where it is.") && output.contains("a length [m]"), "{output}");
    assert!(output.contains("11 coefficients"), "l (k - m) + m = 4 (5 - 3) + 3: {output}");
    let parameter = editor.hover(TEXT, "v_max;", 0);
    assert!(parameter.contains("value: 250 [m/s], a speed [m/s]"), "{parameter}");
    let named = editor.hover(TEXT, "v == 0", 0);
    assert!(named.contains("let v [km/s] = der(x)") && named.contains("a speed [m/s], shown in [km/s]"), "{named}");
    let constant = editor.hover(TEXT, "two;", 0);
    assert!(constant.contains("value: 2"), "{constant}");
    let derivative = editor.hover(TEXT, "der(v)", 0);
    assert!(derivative.contains("an acceleration") && derivative.contains("der(x, 2)"), "{derivative}");
    let unit = editor.hover(TEXT, "km/s] =", 0);
    assert!(unit.contains("a length [m], 1000 in SI units"), "{unit}");
    assert!(editor.hover(TEXT, "integral", 0).contains("over real time"));
    assert_eq!(editor.hover(TEXT, "flight", 0), "", "comments are no code");
    editor.end();
}

#[test]
fn definition_leads_to_the_declaration() {
    let mut editor = Editor::new();
    editor.open(TEXT);
    let found = editor.at("textDocument/definition", TEXT, "ψ, 2", 0, &json!({})).expect("an answer");
    assert_eq!(found[0]["range"]["start"], json!({ "line": 4, "character": 14 }));
    let found = editor.at("textDocument/definition", TEXT, "u / two", 0, &json!({})).expect("an answer");
    assert_eq!(found[0]["range"]["start"], json!({ "line": 7, "character": 12 }));
    editor.end();
}

#[test]
fn each_name_of_a_list_of_variables_is_known() {
    let text = TEXT.replace("const two", "/// Sizes.\n    variable wide [m], high in 1 .. 5 [m];\n    const two");
    let text = text.replace("fast: v <= v_max;", "fast: v <= v_max;  x <= wide + high;");
    let mut editor = Editor::new();
    editor.open(&text);
    for (word, column) in [("wide + high", 13), ("high; }", 23)] {
        let found = editor.at("textDocument/definition", &text, word, 0, &json!({})).expect("an answer");
        assert_eq!(found[0]["range"]["start"], json!({ "line": 7, "character": column }));
        let said = editor.hover(&text, word, 0);
        assert!(said.contains("Sizes.") && said.contains("[m]"), "{said}");
    }
    editor.end();
}

#[test]
fn rename_changes_every_mention_and_refuses_what_does_not_do() {
    let mut editor = Editor::new();
    editor.open(TEXT);
    let rename =
        |editor: &mut Editor, new: &str| editor.at("textDocument/rename", TEXT, "v)", 0, &json!({ "newName": new }));
    let edits = rename(&mut editor, "speed").expect("it does");
    let edits = edits["changes"][URI].as_array().expect("a list");
    // Declared once; used in `der(v)`, `v == 0` and `v <= v_max`.
    assert_eq!(edits.len(), 4, "{edits:?}");
    assert!(edits.iter().all(|edit| edit["newText"] == "speed"));
    for new in ["x", "let", "3d", "a b", ""] {
        let refused = rename(&mut editor, new).expect_err(new);
        assert!(refused["message"].as_str().is_some_and(|m| m.contains("does not do")), "{new}: {refused}");
    }
    editor.end();
}

#[test]
fn completion_knows_where_it_is() {
    let mut editor = Editor::new();
    editor.open(TEXT);
    let units = editor.proposals(TEXT, "m/s];");
    assert!(units.contains(&"km".to_owned()) && !units.contains(&"v_max".to_owned()), "{units:?}");
    let names = editor.proposals(TEXT, "der(v)");
    for name in ["x", "ψ", "v_max", "half", "two", "hypot", "der"] {
        assert!(names.contains(&name.to_owned()), "{name}: {names:?}");
    }
    assert!(!names.contains(&"u".to_owned()), "an argument is known in its function only");
    let words = editor.proposals(TEXT, "minimize");
    assert!(words.contains(&"trajectory".to_owned()), "{words:?}");
    assert!(editor.proposals(TEXT, "Where it").is_empty());
    // Names stay while a statement is being typed.
    editor.change((9, 4, 9, 4), "let b = (x + ");
    let names = editor.proposals(TEXT, "let a");
    assert!(names.contains(&"v_max".to_owned()), "{names:?}");
    editor.end();
}

#[test]
fn formatting_edits_only_what_changes() {
    let mut editor = Editor::new();
    let text = TEXT.replace("const two = 2;", "const two=2;");
    editor.open(&text);
    let params = json!({ "textDocument": { "uri": URI }, "options": { "tabSize": 2, "insertSpaces": true } });
    let edits = editor.ask("textDocument/formatting", params.clone());
    let edits = edits.as_array().expect("a list");
    assert_eq!(edits.len(), 1);
    // The comment behind a later statement moves too; the head and the end of the spec stay.
    assert_eq!(edits[0]["range"]["start"], json!({ "line": 6, "character": 0 }));
    assert!(edits[0]["newText"].as_str().is_some_and(|text| text.starts_with("    const two = 2;\n")));
    editor.change((0, 0, 0, 0), "problem ( ");
    assert_eq!(editor.ask("textDocument/formatting", params), Value::Null, "a broken spec is left alone");
    editor.end();
}

#[test]
fn the_outline_holds_what_is_declared() {
    let mut editor = Editor::new();
    editor.open(TEXT);
    let symbols = editor.ask("textDocument/documentSymbol", json!({ "textDocument": { "uri": URI } }));
    assert_eq!(symbols[0]["name"], "Flight");
    let names: Vec<&str> =
        symbols[0]["children"].as_array().into_iter().flatten().filter_map(|s| s["name"].as_str()).collect();
    assert_eq!(names, ["T", "x", "ψ", "v_max", "two", "half", "v", "a", "effort", "fast"]);
    editor.end();
}

#[test]
fn changes_that_wait_are_taken_together() {
    let (server, editor) = Connection::memory();
    let tell = |method: &str, params: Value| {
        editor.sender.send(Message::Notification(Notification::new(method.to_owned(), params))).expect("it is open");
    };
    let initialize = Request::new(1.into(), "initialize".to_owned(), json!({ "capabilities": {} }));
    editor.sender.send(Message::Request(initialize)).expect("it is open");
    tell("initialized", json!({}));
    let document = json!({ "uri": URI, "languageId": "ntg", "version": 0, "text": TEXT });
    tell("textDocument/didOpen", json!({ "textDocument": document }));
    for version in 1..=200 {
        let place = json!({ "line": 6, "character": 16 });
        let changes = json!([{ "range": { "start": place, "end": place }, "text": "1" }]);
        let document = json!({ "uri": URI, "version": version });
        tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": changes }));
    }
    drop(editor.sender);
    // All of it waits before the server starts.
    ntg_lsp::serve(&server).expect("the editor speaks the protocol");
    drop(server);
    let told: Vec<Message> = editor.receiver.iter().collect();
    let [Message::Response(_), Message::Notification(told)] = told.as_slice() else { panic!("{told:?}") };
    // `const two = 11...12;` with 200 ones is a number as good as 2.
    assert_eq!((&told.params["version"], &told.params["diagnostics"]), (&json!(200), &json!([])));
}

#[test]
fn what_is_not_known_is_refused_and_nothing_breaks() {
    let mut editor = Editor::new();
    let refused = editor.try_ask("textDocument/somethingElse", json!({})).expect_err("unknown");
    assert_eq!(refused["code"], -32601);
    let refused = editor.try_ask("textDocument/hover", json!({ "nothing": 1 })).expect_err("malformed");
    assert_eq!(refused["code"], -32602);
    editor.tell("textDocument/didChange", json!({ "nothing": 1 }));
    let nowhere = json!({ "textDocument": { "uri": URI }, "position": { "line": 9, "character": 9 } });
    assert_eq!(editor.ask("textDocument/hover", nowhere), Value::Null);
    editor.end();
}

#[test]
fn signatures_tell_the_arguments_and_which_is_next() {
    let mut editor = Editor::new();
    let with = |written: &str| TEXT.replace("der(v) + half(der(ψ, 2))", written);
    // What is asked, the signature, the argument that is next.
    for (written, label, argument) in [
        ("half(▮", "fn half(u)", "u"),
        ("hypot(der(x), ▮", "hypot(a, b, ...)", "b"),
        ("hypot(1, (2 + x▮", "hypot(a, b, ...)", "b"),
        ("hypot(1, half(2), 3, ▮4)", "hypot(a, b, ...)", "..."),
        ("der(x▮", "der(e)", "e"),
        ("der(x, ▮", "der(e, 2)", "2"),
    ] {
        let text = with(written).replacen('▮', "", 1);
        let place = with(written).find('▮').expect("a place");
        editor.version += 1;
        editor.open(&text);
        let before = &text[..place];
        let line = before.matches('\n').count();
        let character: usize = before.rsplit('\n').next().unwrap_or("").chars().map(char::len_utf16).sum();
        let position = json!({ "line": line, "character": character });
        let params = json!({ "textDocument": { "uri": URI }, "position": position });
        let answer = editor.ask("textDocument/signatureHelp", params);
        let active = answer["activeSignature"].as_u64().and_then(|at| usize::try_from(at).ok()).expect("a signature");
        let signature = &answer["signatures"][active];
        assert_eq!(signature["label"], label, "{written}: {answer}");
        let next = answer["activeParameter"].as_u64().and_then(|at| usize::try_from(at).ok()).expect("an argument");
        let ends = &signature["parameters"][next]["label"];
        let end = |k: usize| ends[k].as_u64().and_then(|at| usize::try_from(at).ok()).expect("an offset");
        assert_eq!(&label[end(0)..end(1)], argument, "{written}: {answer}");
    }
    assert_eq!(editor.at("textDocument/signatureHelp", TEXT, "x, ψ", 0, &json!({})), Ok(Value::Null));
    editor.end();
}

#[test]
fn what_a_help_proposes_and_mends_is_an_action() {
    let mut editor = Editor::new();
    // What is written, where one asks, what is proposed there: each time what leaves no error.
    for (right, wrong, word, proposed) in [
        ("v <= v_max", "v <= v_mx", "v_mx", &["v_max"][..]),
        ("= der(x);", "= diff(x);", "diff", &["der(x)"]),
        ("integral(a^2)", "a^2 * 1 [s]", "a^2", &["integral(a^2)", "initial(a^2)", "final(a^2)"]),
        ("x == 1 [km]", "x = 1 [km]", "= 1 [km]", &["=="]),
    ] {
        let text = TEXT.replace(right, wrong);
        editor.version += 1;
        let found = editor.open(&text);
        assert!(!found.is_empty(), "{wrong}");
        let more = json!({ "range": found[0]["range"], "context": { "diagnostics": [] } });
        let answer = editor.at("textDocument/codeAction", &text, word, 0, &more).expect("an answer");
        let actions = answer.as_array().expect("actions");
        let texts: Vec<&str> =
            actions.iter().filter_map(|own| own["edit"]["changes"][URI][0]["newText"].as_str()).collect();
        assert!(texts.iter().all(|own| proposed.contains(own)) && !texts.is_empty(), "{wrong}: {texts:?} {found:?}");
        let range = &actions[0]["edit"]["changes"][URI][0]["range"];
        let end =
            |end: &str, part: &str| range[end][part].as_u64().and_then(|at| u32::try_from(at).ok()).expect("a place");
        let range = (end("start", "line"), end("start", "character"), end("end", "line"), end("end", "character"));
        assert_eq!(editor.change(range, texts[0]), Vec::<Value>::new(), "{wrong}: {actions:?}");
        assert_eq!(actions[0]["kind"], "quickfix");
        assert_eq!(actions[0]["isPreferred"], texts.len() == 1);
    }
    editor.version += 1;
    editor.open(TEXT);
    let range = json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 14, "character": 0 } });
    let params = json!({ "textDocument": { "uri": URI }, "range": range, "context": { "diagnostics": [] } });
    assert_eq!(editor.ask("textDocument/codeAction", params), json!([]));
    editor.end();
}
