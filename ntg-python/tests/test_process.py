"""The package as a process: import time, the command, Ctrl-C."""

import os
import signal
import subprocess
import sys
import time

import pytest

from conftest import SPECS

FLIGHT = str(SPECS / "low_observable.ntg")


def run(*words, **more):
    return subprocess.run([sys.executable, *words], capture_output=True, text=True, timeout=120, **more)


def test_the_package_alone_imports_nothing_heavy():
    said = run("-c", "import sys, ntg; print([m for m in ('numpy', 'pandas', 'matplotlib') if m in sys.modules])")
    assert said.stdout.strip() == "[]", said.stderr


def test_python_m_ntg_is_the_command(tmp_path):
    said = run("-m", "ntg", "check", FLIGHT)
    assert said.returncode == 0, said.stderr
    said = run("-m", "ntg", "solve", FLIGHT, "--set", "signature_max=7", "--samples", "3")
    assert said.returncode == 0 and "128.2529" in said.stdout, said.stdout + said.stderr
    assert run("-m", "ntg").returncode == 2
    assert run("-m", "ntg", "solve", str(tmp_path / "nowhere.ntg")).returncode == 2
    assert run("-m", "ntg", "--version").stdout.startswith("ntg ")


@pytest.mark.skipif(os.name != "posix", reason="sends SIGINT")
@pytest.mark.parametrize(
    "work",
    [
        "[flight.solve() for _ in range(100000)]",
        "flight.solve_many({'v_max': [0.22 + 1e-7 * i for i in range(200000)]})",
    ],
)
def test_ctrl_c_ends_a_solve_and_a_study_with_keyboard_interrupt(work):
    program = f"""
import ntg
flight = ntg.load({FLIGHT!r})
print("ready", flush=True)
try:
    {work}
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""
    process = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "ready\n"
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    assert process.stdout.readline() == "interrupted\n"
    assert process.wait(30) == 0


def test_types_are_there_and_complete():
    pytest.importorskip("mypy")
    program = "import ntg\nreveal_type(ntg.load('a').solve(v=1).objective)\nreveal_type(ntg.Settings().tolerance)\n"
    said = run("-m", "mypy", "--strict", "-c", program)
    assert said.returncode == 0, said.stdout
    assert said.stdout.count('Revealed type is "float"') + said.stdout.count('"builtins.float"') == 2, said.stdout
