"""The Python environment of the comparisons: bench/.venv, from requirements.txt."""

import hashlib
import subprocess
import venv
from pathlib import Path

HERE = Path(__file__).resolve().parent
VENV = HERE / ".venv"


def environment():
    """Installs what requirements.txt lists, unless that very list is installed already; gives the interpreter."""
    python = VENV / "bin" / "python"
    wanted = HERE / "requirements.txt"
    mark = VENV / "installed"
    digest = hashlib.sha256(wanted.read_bytes()).hexdigest()
    if not (mark.exists() and mark.read_text() == digest and python.exists()):
        print("bench: setting up .venv", flush=True)
        venv.create(VENV, with_pip=True, clear=True)
        subprocess.run([python, "-m", "pip", "install", "--quiet", "-r", wanted], check=True)
        mark.write_text(digest)
    return python
