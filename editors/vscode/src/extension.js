// Starts `ntg lsp` and hands the editor's questions to it; all that is known about the language is on the other side.
"use strict";

const vscode = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

function start() {
  const command = vscode.workspace.getConfiguration("ntg").get("command", "ntg");
  const server = { command, args: ["lsp"] };
  client = new LanguageClient("ntg", "ntg", server, { documentSelector: [{ language: "ntg" }] });
  return client.start().catch((error) => {
    client = undefined;
    vscode.window.showErrorMessage(
      `\`${command} lsp\` does not start (${error.message}). ` +
        "Install it with `cargo install --path ntg-cli`, or name it in the setting `ntg.command`.",
    );
  });
}

async function stop() {
  const old = client;
  client = undefined;
  await old?.stop();
}

async function activate(context) {
  const restart = async () => {
    await stop();
    await start();
  };
  context.subscriptions.push(
    vscode.commands.registerCommand("ntg.restart", restart),
    vscode.workspace.onDidChangeConfiguration((event) => {
      if (event.affectsConfiguration("ntg.command")) {
        restart();
      }
    }),
  );
  await start();
}

module.exports = { activate, deactivate: stop };
