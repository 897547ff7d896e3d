//! The protocol: messages in, answers and diagnostics out.
//!
//! One thread, no state but the open documents. Changes that wait in the queue are taken together before the compiler
//! looks at the text again, so that a fast typist never waits for old texts.

use std::collections::HashMap;
use std::path::PathBuf;

use lsp_server::{Connection, ErrorCode, Message, Notification, Request, Response};
use lsp_types::notification::{self, Notification as _};
use lsp_types::request::{self, Request as _};
use lsp_types::{
    CodeAction, CodeActionKind, CodeActionOrCommand, CodeActionProviderCapability, CompletionOptions,
    CompletionResponse, Diagnostic, DiagnosticRelatedInformation, DiagnosticSeverity, DidChangeTextDocumentParams,
    DocumentSymbolResponse, GotoDefinitionResponse, Hover, HoverContents, HoverProviderCapability, Location,
    MarkupContent, MarkupKind, NumberOrString, OneOf, PrepareRenameResponse, PublishDiagnosticsParams, RenameOptions,
    ServerCapabilities, SignatureHelpOptions, TextDocumentPositionParams, TextDocumentSyncCapability,
    TextDocumentSyncKind, TextEdit, Uri, WorkspaceEdit,
};
use ntg_compiler::diagnostic::{Diagnostic as Finding, Severity};
use ntg_compiler::source::Span;
use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::analysis::{Analysis, Beside};
use crate::lines::Lines;
use crate::{actions, complete, hover, libraries, outline, rename, signature};

/// What went wrong between the editor and the server.
pub type ProtocolError = Box<dyn std::error::Error + Send + Sync>;

/// Answers one editor until it says goodbye.
///
/// # Errors
/// The connection broke, or the editor does not speak the protocol.
pub fn serve(connection: &Connection) -> Result<(), ProtocolError> {
    connection.initialize(serde_json::to_value(capabilities())?)?;
    let mut server = Server { connection, documents: HashMap::new() };
    let mut waiting = None;
    loop {
        let message = match waiting.take() {
            Some(message) => message,
            None => {
                server.publish()?;
                let Ok(message) = connection.receiver.recv() else { return Ok(()) };
                message
            }
        };
        match message {
            Message::Request(request) => {
                if connection.handle_shutdown(&request)? {
                    return Ok(());
                }
                let response = server.request(request);
                connection.sender.send(Message::Response(response))?;
            }
            Message::Notification(notification) => server.notification(notification),
            Message::Response(_) => {}
        }
        waiting = connection.receiver.try_recv().ok();
    }
}

/// What this server can do.
fn capabilities() -> ServerCapabilities {
    ServerCapabilities {
        text_document_sync: Some(TextDocumentSyncCapability::Kind(TextDocumentSyncKind::INCREMENTAL)),
        hover_provider: Some(HoverProviderCapability::Simple(true)),
        completion_provider: Some(CompletionOptions {
            trigger_characters: Some(vec!["[".to_owned(), ".".to_owned()]),
            ..CompletionOptions::default()
        }),
        signature_help_provider: Some(SignatureHelpOptions {
            trigger_characters: Some(vec!["(".to_owned(), ",".to_owned()]),
            ..SignatureHelpOptions::default()
        }),
        code_action_provider: Some(CodeActionProviderCapability::Simple(true)),
        definition_provider: Some(OneOf::Left(true)),
        references_provider: Some(OneOf::Left(true)),
        rename_provider: Some(OneOf::Right(RenameOptions {
            prepare_provider: Some(true),
            work_done_progress_options: lsp_types::WorkDoneProgressOptions::default(),
        })),
        document_symbol_provider: Some(OneOf::Left(true)),
        document_formatting_provider: Some(OneOf::Left(true)),
        ..ServerCapabilities::default()
    }
}

/// An open document. The compiler looks at a text when someone asks, and then once.
struct Document {
    uri: Uri,
    version: Option<i32>,
    text: String,
    analysis: Option<Analysis>,
    /// Whether the editor has not yet been told what is wrong with this text.
    is_new: bool,
}

struct Server<'a> {
    connection: &'a Connection,
    /// By URI as the editor writes it.
    documents: HashMap<String, Document>,
}

impl Document {
    fn analysis(&mut self) -> &Analysis {
        let (uri, text) = (&self.uri, &self.text);
        self.analysis.get_or_insert_with(|| {
            let path = path(uri);
            let name = path.as_ref().map_or_else(|| uri.as_str().to_owned(), |path| path.display().to_string());
            let folder = path.and_then(|path| path.parent().map(PathBuf::from));
            Analysis::new(&name, text.clone(), Beside(folder))
        })
    }
}

impl Server<'_> {
    fn notification(&mut self, notification: Notification) {
        // What does not have the protocol's form cannot be answered: notifications have no answer.
        let Notification { method, params } = notification;
        match method.as_str() {
            notification::DidOpenTextDocument::METHOD => {
                let Ok(params) = serde_json::from_value::<lsp_types::DidOpenTextDocumentParams>(params) else { return };
                let document = params.text_document;
                self.open(document.uri, Some(document.version), document.text);
            }
            notification::DidChangeTextDocument::METHOD => {
                if let Ok(params) = serde_json::from_value(params) {
                    self.change(params);
                }
            }
            notification::DidCloseTextDocument::METHOD => {
                let Ok(params) = serde_json::from_value::<lsp_types::DidCloseTextDocumentParams>(params) else {
                    return;
                };
                self.documents.remove(params.text_document.uri.as_str());
                // Nothing is wrong any more with a document that nobody looks at.
                let _ = self.send(PublishDiagnosticsParams::new(params.text_document.uri, vec![], None));
            }
            _ => {}
        }
    }

    fn open(&mut self, uri: Uri, version: Option<i32>, text: String) {
        let document = Document { uri: uri.clone(), version, text, analysis: None, is_new: true };
        self.documents.insert(uri.as_str().to_owned(), document);
    }

    fn change(&mut self, params: DidChangeTextDocumentParams) {
        let Some(document) = self.documents.get_mut(params.text_document.uri.as_str()) else { return };
        for change in params.content_changes {
            match change.range {
                None => document.text = change.text,
                Some(range) => {
                    let lines = Lines::new(&document.text);
                    let start = lines.byte(&document.text, range.start);
                    let end = lines.byte(&document.text, range.end).max(start);
                    document.text.replace_range(start..end, &change.text);
                }
            }
        }
        document.version = Some(params.text_document.version);
        document.analysis = None;
        document.is_new = true;
    }

    /// Tells the editor what is wrong with every text that is new.
    fn publish(&mut self) -> Result<(), ProtocolError> {
        let mut told = vec![];
        for document in self.documents.values_mut().filter(|document| document.is_new) {
            document.is_new = false;
            let (uri, version) = (document.uri.clone(), document.version);
            let analysis = document.analysis();
            let diagnostics = analysis.found.iter().map(|finding| diagnostic(analysis, &uri, finding)).collect();
            told.push(PublishDiagnosticsParams::new(uri, diagnostics, version));
        }
        told.into_iter().try_for_each(|params| self.send(params))
    }

    fn send(&self, params: PublishDiagnosticsParams) -> Result<(), ProtocolError> {
        let method = notification::PublishDiagnostics::METHOD.to_owned();
        self.connection.sender.send(Message::Notification(Notification::new(method, params)))?;
        Ok(())
    }

    fn request(&mut self, request: Request) -> Response {
        let id = request.id.clone();
        match self.answer(request) {
            Ok(value) => Response::new_ok(id, value),
            Err((code, message)) => Response::new_err(id, code as i32, message),
        }
    }

    fn answer(&mut self, request: Request) -> Result<Value, (ErrorCode, String)> {
        let Request { method, params, .. } = request;
        let answer = match method.as_str() {
            request::HoverRequest::METHOD => self.hover(given::<lsp_types::HoverParams>(params)?),
            request::Completion::METHOD => self.completion(given::<lsp_types::CompletionParams>(params)?),
            request::SignatureHelpRequest::METHOD => {
                let params: lsp_types::SignatureHelpParams = given(params)?;
                let place = self.place(&params.text_document_position_params);
                json(place.and_then(|(analysis, byte)| signature::help(analysis, byte)))
            }
            request::CodeActionRequest::METHOD => self.actions(given::<lsp_types::CodeActionParams>(params)?),
            request::GotoDefinition::METHOD => self.definition(given::<lsp_types::GotoDefinitionParams>(params)?),
            request::References::METHOD => self.references(given::<lsp_types::ReferenceParams>(params)?),
            request::PrepareRenameRequest::METHOD => self.prepare_rename(given(params)?),
            request::Rename::METHOD => return self.rename(given(params)?),
            request::DocumentSymbolRequest::METHOD => {
                let params: lsp_types::DocumentSymbolParams = given(params)?;
                let symbols = self.document(&params.text_document.uri).map(|d| outline::symbols(d.analysis()));
                json(symbols.map(DocumentSymbolResponse::Nested))
            }
            request::Formatting::METHOD => {
                let params: lsp_types::DocumentFormattingParams = given(params)?;
                let document = self.document(&params.text_document.uri);
                json(document.and_then(|document| outline::layout(document.analysis())))
            }
            _ => return Err((ErrorCode::MethodNotFound, format!("`{method}` is not known here"))),
        };
        Ok(answer)
    }

    fn document(&mut self, uri: &Uri) -> Option<&mut Document> {
        self.documents.get_mut(uri.as_str())
    }

    /// The text and the byte that a request is about.
    fn place(&mut self, params: &TextDocumentPositionParams) -> Option<(&Analysis, usize)> {
        let document = self.document(&params.text_document.uri)?;
        let analysis = document.analysis();
        Some((analysis, analysis.lines.byte(&analysis.source.text, params.position)))
    }

    fn hover(&mut self, params: lsp_types::HoverParams) -> Value {
        let place = self.place(&params.text_document_position_params);
        json(place.and_then(|(analysis, byte)| {
            let (value, span) = hover::hover(analysis, byte)?;
            let range = Some(analysis.lines.range(&analysis.source.text, span));
            Some(Hover { contents: HoverContents::Markup(MarkupContent { kind: MarkupKind::Markdown, value }), range })
        }))
    }

    fn completion(&mut self, params: lsp_types::CompletionParams) -> Value {
        let place = self.place(&params.text_document_position);
        json(place.map(|(analysis, byte)| CompletionResponse::Array(complete::proposals(analysis, byte))))
    }

    fn actions(&mut self, params: lsp_types::CodeActionParams) -> Value {
        let uri = params.text_document.uri.clone();
        json(self.document(&params.text_document.uri).map(|document| {
            let analysis = document.analysis();
            let byte = |position| analysis.lines.byte(&analysis.source.text, position);
            let part = Span::new(byte(params.range.start), byte(params.range.end).max(byte(params.range.start)));
            let fixes = actions::fixes(analysis, part);
            let only = |finding: usize| fixes.iter().filter(|fix| fix.finding == finding).count() == 1;
            fixes.iter().map(|fix| action(analysis, &uri, fix, only(fix.finding))).collect::<Vec<_>>()
        }))
    }

    fn definition(&mut self, params: lsp_types::GotoDefinitionParams) -> Value {
        let uri = params.text_document_position_params.text_document.uri.clone();
        let place = self.place(&params.text_document_position_params);
        json(place.and_then(|(analysis, byte)| {
            let uses = analysis.uses();
            if let Some((used, name, _)) = libraries::find(&uses, &analysis.source.text, analysis.word(byte)) {
                let uri: Uri = format!("file://{}", used.path.as_ref()?.display()).parse().ok()?;
                let range = Lines::new(&used.source.text).range(&used.source.text, name.span);
                return Some(GotoDefinitionResponse::Array(vec![Location::new(uri, range)]));
            }
            let mention = analysis.names().at(byte)?;
            let places = mention.declarations.iter().map(|at| analysis.names().declarations[*at].name.span);
            let range = |span| analysis.lines.range(&analysis.source.text, span);
            let locations = places.map(|span| Location::new(uri.clone(), range(span))).collect();
            Some(GotoDefinitionResponse::Array(locations))
        }))
    }

    fn references(&mut self, params: lsp_types::ReferenceParams) -> Value {
        let uri = params.text_document_position.text_document.uri.clone();
        let place = self.place(&params.text_document_position);
        json(place.and_then(|(analysis, byte)| {
            let first = *analysis.names().at(byte)?.declarations.first()?;
            let places = analysis.names().places(&analysis.names().together(first));
            let range = |span| analysis.lines.range(&analysis.source.text, span);
            Some(places.into_iter().map(|span| Location::new(uri.clone(), range(span))).collect::<Vec<_>>())
        }))
    }

    fn prepare_rename(&mut self, params: TextDocumentPositionParams) -> Value {
        json(self.place(&params).and_then(|(analysis, byte)| {
            let mention = analysis.names().at(byte)?;
            Some(PrepareRenameResponse::Range(analysis.lines.range(&analysis.source.text, mention.span)))
        }))
    }

    fn rename(&mut self, params: lsp_types::RenameParams) -> Result<Value, (ErrorCode, String)> {
        let uri = params.text_document_position.text_document.uri.clone();
        let Some((analysis, byte)) = self.place(&params.text_document_position) else { return Ok(Value::Null) };
        let edits = rename::edits(analysis, byte, &params.new_name);
        let edits = edits.map_err(|message| (ErrorCode::RequestFailed, message))?;
        #[expect(clippy::mutable_key_type, reason = "the protocol's type is a map by URI")]
        let changes = HashMap::from([(uri, edits)]);
        Ok(json(Some(WorkspaceEdit { changes: Some(changes), ..WorkspaceEdit::default() })))
    }
}

fn action(analysis: &Analysis, uri: &Uri, fix: &actions::Fix, is_preferred: bool) -> CodeActionOrCommand {
    let edit = TextEdit::new(analysis.lines.range(&analysis.source.text, fix.span), fix.text.clone());
    #[expect(clippy::mutable_key_type, reason = "the protocol's type is a map by URI")]
    let changes = HashMap::from([(uri.clone(), vec![edit])]);
    CodeActionOrCommand::CodeAction(CodeAction {
        title: format!("write `{}`", fix.text),
        kind: Some(CodeActionKind::QUICKFIX),
        diagnostics: analysis.found.get(fix.finding).map(|finding| vec![diagnostic(analysis, uri, finding)]),
        edit: Some(WorkspaceEdit { changes: Some(changes), ..WorkspaceEdit::default() }),
        is_preferred: Some(is_preferred),
        ..CodeAction::default()
    })
}

fn given<T: DeserializeOwned>(params: Value) -> Result<T, (ErrorCode, String)> {
    serde_json::from_value(params).map_err(|error| (ErrorCode::InvalidParams, error.to_string()))
}

/// An answer; `null` says that there is none.
fn json<T: serde::Serialize>(answer: Option<T>) -> Value {
    answer.and_then(|answer| serde_json::to_value(answer).ok()).unwrap_or(Value::Null)
}

fn diagnostic(analysis: &Analysis, uri: &Uri, finding: &Finding) -> Diagnostic {
    let range = |span| analysis.lines.range(&analysis.source.text, span);
    let severity = match finding.severity {
        Severity::Error => DiagnosticSeverity::ERROR,
        Severity::Warning => DiagnosticSeverity::WARNING,
        Severity::Note => DiagnosticSeverity::INFORMATION,
    };
    let help = finding.help.as_ref().map_or_else(String::new, |help| format!("\nhelp: {help}"));
    let elsewhere: String = finding
        .libraries
        .iter()
        .filter_map(|library| Some((&library.source, library.source.place(library.span?.start))))
        .map(|(source, place)| format!("\nin {}, line {}, column {}", source.name, place.line, place.column))
        .collect();
    let related = finding.labels.iter().map(|(span, message)| DiagnosticRelatedInformation {
        location: Location::new(uri.clone(), range(*span)),
        message: message.clone(),
    });
    Diagnostic {
        range: range(finding.span),
        severity: Some(severity),
        code: Some(NumberOrString::String(finding.code.text().to_owned())),
        source: Some("ntg".to_owned()),
        message: format!("{}{elsewhere}{help}", finding.message),
        related_information: Some(related.collect()),
        ..Diagnostic::default()
    }
}

/// The file that a URI names.
fn path(uri: &Uri) -> Option<PathBuf> {
    let path = uri.as_str().strip_prefix("file://")?;
    let path = percent_encoding::percent_decode_str(path).decode_utf8().ok()?;
    // `file:///C:/x` is a path of Windows behind a slash too many.
    let drive = path.strip_prefix('/').filter(|rest| rest.as_bytes().get(1) == Some(&b':'));
    Some(PathBuf::from(drive.unwrap_or(&path)))
}
