"""The other side of bench/server: ntg and ripopt, asked one question a line."""

import json
import subprocess
from pathlib import Path

WORKSPACE = Path(__file__).resolve().parent.parent


class Server:
    """Built and started by the first question: the peers alone need no Rust."""

    def __init__(self):
        self.process = None

    def start(self):
        build = ["cargo", "build", "--release", "--quiet", "--package", "ntg-bench", "--manifest-path", str(WORKSPACE / "Cargo.toml")]
        subprocess.run(build, check=True)
        binary = WORKSPACE / "target" / "release" / "ntg-bench"
        self.process = subprocess.Popen([str(binary)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def ask(self, by, question, **more):
        """One answer; an error of the server is raised here."""
        if self.process is None:
            self.start()
        self.process.stdin.write(json.dumps({"by": by, **question, **more}) + "\n")
        self.process.stdin.flush()
        answer = json.loads(self.process.stdout.readline())
        if isinstance(answer, dict) and "error" in answer:
            raise RuntimeError(answer["error"])
        return answer


class Asked:
    """One solver of the server on one case, with the face of `casadi_solvers.Solver`."""

    def __init__(self, server, by, question):
        self.server, self.by, self.question = server, by, question

    def answer(self, seconds, solves):
        return self.server.ask(self.by, self.question, seconds=seconds, solves=solves)
