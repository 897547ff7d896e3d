"""One solve: known answers, functions of time, tables, files, pictures."""

import json
import pickle
import threading
import time

import numpy as np
import pytest

import ntg
from conftest import MOVE, SPECS


def test_the_flight_is_solved_in_three_lines():
    flight = ntg.load(str(SPECS / "low_observable.ntg"))
    solution = flight.solve(signature_max=7)
    assert solution.solved and solution.status == "solved" and solution.advice == ""
    # The published optimum, from the spec's documentation.
    assert solution.objective == pytest.approx(128.252905291, rel=1e-9)
    assert solution.raise_if_unsolved() is solution


def test_what_equations_miss_is_worth_something_of_the_objective():
    flat = ntg.load(str(SPECS / "low_observable.ntg")).solve(signature_max=7)
    assert flat.objective_correction == 0.0
    # A kick of a speed of 1 that one point of ten intervals sees: 0.1 on fine meshes.
    kicked = ntg.loads("""problem Kicked {
        duration T = 10;
        state x, v;
        input u;
        collocation gauss(points = 3, intervals = 10);
        minimize integral(u^2);
        dynamics { der(x) == v;  der(v) == u + (if t in 5.05 .. 5.15 { 10 } else { 0 }); }
        initial { x == 0;  v == 0; }
        final { v == 0; }
    }""").solve()
    assert kicked.resolution == "unresolved"
    assert kicked.objective > 0.2 and kicked.objective_correction < -0.1


def test_values_are_in_declared_units_with_the_shape_of_the_times(move):
    solution = move.solve(distance=3)
    assert solution.objective == pytest.approx(12 * 9 / 8, abs=1e-6)
    x = solution["x"]
    assert (x.unit, x.start, x.end) == ("m", 0.0, 2.0)
    t = np.array([[0.0, 0.5, 1.0], [1.5, 2.0, 99.0]])
    tau = np.minimum(t, 2) / 2
    np.testing.assert_allclose(x(t), 3 * (3 * tau**2 - 2 * tau**3), atol=1e-6)
    np.testing.assert_allclose(x.derivative(t), 3 * 6 * tau * (1 - tau) / 2, atol=1e-5)
    assert isinstance(x(1.0), float) and x(1) == x(1.0)
    assert np.isnan(x(np.nan)) and x([]).shape == (0,)
    # A named expression in its own unit, one by one and all at once.
    speed = solution["speed"]
    assert speed.unit == "cm/s" and speed(1.0) == pytest.approx(225, abs=1e-3)
    np.testing.assert_allclose(speed(t), 100 * x.derivative(t), rtol=1e-12)
    assert solution["T"] == 2.0 and solution["mean"] == pytest.approx(1.5)
    assert {"x", "speed", "T", "mean"} <= set(solution.keys())
    with pytest.raises(KeyError, match="there is no `y`; there are: `x`, `speed`"):
        solution["y"]
    with pytest.raises(ntg.Error, match="only outputs have derivatives"):
        speed.derivative(1.0)


def test_parameters_take_numbers_and_texts_with_units(move):
    metres = [move.solve(distance=d).objective for d in (0.5, "0.5", "50 cm", "50 [cm]", np.float64(0.5), [0.5])]
    assert len(set(metres)) == 1
    assert move.solve({"distance": 2}).objective == pytest.approx(12 * 4 / 8, abs=1e-6)
    other = move.with_parameters(distance="1 km")
    assert other.parameters["distance"] == ("distance", 1000.0, "m", "How far.")
    assert move.parameters["distance"].value == 1.0
    for value, words in [
        ("1 s", "length|m"),
        ("fast", "write a number"),
        (float("nan"), "finite"),
        ([1, 2], "holds 1 value, but 2 are given"),
        (None, "NoneType is neither a number"),
        (object(), "object is neither a number"),
    ]:
        with pytest.raises(ntg.ParameterError, match=words):
            move.solve(distance=value)
    with pytest.raises(ntg.ParameterError, match="there is no parameter `distanse`; the parameters are: `distance`"):
        move.solve(distanse=1)
    with pytest.raises(TypeError, match="given twice"):
        move.solve({"distance": 1}, distance=1)


def test_the_compiler_s_findings_are_data():
    text = "problem P {\n    output x [m]: spline(order = 5, intervals = 2);\n    minimize integral(y^2);\n}\n"
    with pytest.raises(ntg.SpecError) as caught:
        ntg.loads(text, name="p.ntg")
    finding = next(one for one in caught.value.findings if "`y`" in one.message)
    assert finding.severity == "error" and finding.code.startswith("E")
    assert (finding.line, finding.column, finding.end_column) == (3, 23, 24)
    assert "p.ntg:3:23" in str(caught.value)
    again = pickle.loads(pickle.dumps(caught.value))
    assert again.findings == caught.value.findings and str(again) == str(caught.value)
    assert isinstance(caught.value, ValueError)


def test_files_that_are_not_there_or_no_text(tmp_path):
    with pytest.raises(FileNotFoundError):
        ntg.load(tmp_path / "nowhere.ntg")
    (tmp_path / "bytes.ntg").write_bytes(b"problem \xff")
    with pytest.raises(ntg.SpecError, match="not UTF-8"):
        ntg.load(tmp_path / "bytes.ntg")


def test_an_unsolved_solve_says_so(move):
    solution = move.solve(limit=0.5)  # The mean speed is already 0.5.
    assert not solution.solved and solution.status == "infeasible"
    # The message says what is missed at the last point, the explanation which limits cannot hold together.
    assert "`reach` at the end misses its bound" in solution.message and "`slow`" in solution.explain()
    with pytest.raises(ntg.UnsolvedError, match="Move: infeasible") as caught:
        solution.raise_if_unsolved()
    assert caught.value.solution is solution
    stopped = move.solve(settings=ntg.Settings(max_iterations=1, method="sqp"), limit=0.8)
    assert stopped.iterations <= 1 and stopped.status in ("iteration_limit", "solved")


def test_settings_are_checked(move):
    wrong = [
        ntg.Settings(tolerance=-1),
        ntg.Settings(method="magic"),
        ntg.Settings(time_limit=-1.0),
        ntg.Settings(restoration="cubed"),
        ntg.Settings(inertia_correction="none"),
    ]
    for settings in wrong:
        with pytest.raises(ntg.SettingsError, match="setting `"):
            move.solve(settings=settings)


def test_restorations_and_corrections_of_the_inertia_find_the_same_optimum(move):
    optimum = move.solve(limit=0.8).objective
    settings = ntg.Settings(method="interior-point", restoration="squared", inertia_correction="by-shift")
    assert move.solve(settings=settings, limit=0.8).objective == pytest.approx(optimum, rel=1e-6)


def test_values_that_make_no_sense_are_a_finding_with_its_place(flight):
    solution_or_error = None
    try:
        solution_or_error = flight.solve(v_min=0.3, v_max=0.25)
    except ntg.SetupError as error:
        assert "speed_limits" in str(error)
        return
    assert not solution_or_error.solved and "speed_limits" in solution_or_error.message


def test_tables_of_a_solution(move):
    for name in ("pandas", "polars", "pyarrow"):
        pytest.importorskip(name)
    solution = move.solve()
    for table in (solution.to_pandas(11), solution.to_polars(np.linspace(0, 2, 11)), solution.to_arrow(11)):
        assert type(table).__module__.split(".")[0] in ("pandas", "polars", "pyarrow")
        np.testing.assert_array_equal(np.asarray(table["x"]), solution["x"](np.linspace(0, 2, 11)))
    assert solution.to_pandas().attrs["units"]["speed"] == "cm/s"
    assert solution.to_arrow().schema.field("speed").metadata == {b"unit": b"cm/s"}


def test_what_a_solve_knows_beside_its_curves(move):
    solution = move.solve()
    reach = solution.constraints["reach"]
    assert reach.sensitivity == pytest.approx(3.0, abs=1e-5) and reach.block == "final" and reach.unit == "m"
    assert solution.constraints["slow"].between.violation == 0
    assert solution.terms["effort"] == pytest.approx(solution.objective)
    assert solution.history[0].iteration == 0 and solution.phases[0].end == 2.0
    assert solution.times["T"] == 2.0 and solution.violation_between < 1e-6
    assert "solved" in solution.report() and "solved" in repr(solution)
    assert solution.problem.parameters["limit"].unit == "m/s"


def test_a_solution_is_saved_once_and_shown_as_a_page(move, tmp_path):
    solution = move.solve()
    solution.save(tmp_path / "run.json")
    run = json.loads((tmp_path / "run.json").read_text())
    assert run["format"] == "ntg-solution" and run["status"] == "solved"
    with pytest.raises(FileExistsError):
        solution.save(tmp_path / "run.json")
    solution.save(tmp_path / "page.html")
    assert "<!DOCTYPE html>" in (tmp_path / "page.html").read_text()
    assert solution._repr_html_().startswith("<iframe srcdoc=")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["page.html", "run.json"]


def test_pictures(flight):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    solution = flight.solve(signature_max=7)
    axes = solution.plot("speed", "signature")
    assert [place.get_ylabel() for place in axes.flat] == ["speed [km/s]", "signature"]
    place = solution.plot_track("x", "y")
    assert place.get_xlabel() == "x [km]" and place.get_aspect() in ("equal", 1.0)
    with pytest.raises(ValueError, match="is a number"):
        solution.plot("T")


def test_progress_is_told_and_may_stop(flight):
    seen = []
    assert flight.solve(signature_max=7, progress=seen.append).solved
    assert seen[0].iteration == 0 and all(isinstance(step, ntg.Progress) for step in seen)
    stopped = flight.solve(signature_max=7, progress=lambda step: step.iteration < 2)
    assert stopped.status == "cancelled" and not stopped.solved

    def fail(step):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        flight.solve(progress=fail)


def test_a_kept_solver_solves_again_and_from_the_last_solution(flight):
    solver = flight.solver(signature_max=7)
    first = solver.solve()
    moved = solver.resolve(x_start="-99.5 km")
    fresh = flight.solve(signature_max=7, x_start=-99.5)
    assert moved.solved and moved.objective == pytest.approx(fresh.objective, rel=1e-8)
    assert moved.iterations < fresh.iterations
    # Bit for bit what a fresh solve finds, and a mistake changes nothing.
    with pytest.raises(ntg.ParameterError):
        solver.solve(x_start=-100, x_stop=3)
    assert solver.solve().objective == fresh.objective
    assert solver.solve(x_start=-100).objective == first.objective
    assert solver.solve(guess=first).solved


def test_two_threads_with_one_solver(flight):
    solver = flight.solver(signature_max=7)
    inside, errors = threading.Event(), []

    def slow(step):
        inside.set()
        time.sleep(0.05)
        return step.iteration < 3

    worker = threading.Thread(target=lambda: solver.solve(progress=slow))
    worker.start()
    assert inside.wait(30)
    try:
        solver.solve()
    except ntg.BusyError as error:
        errors.append(error)
    worker.join()
    assert errors and "another thread" in str(errors[0])
    assert solver.solve().solved


def test_other_threads_run_while_it_solves(flight):
    ticks, done = [], threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.001)

    other = threading.Thread(target=tick)
    other.start()
    # A solve that held the interpreter's lock would leave no tick in its middle half, however long one waits.
    began, inside = time.perf_counter(), False
    while not inside and time.perf_counter() - began < 30:
        first = time.perf_counter()
        flight.solve()
        last = time.perf_counter()
        quarter = (last - first) / 4
        inside = any(first + quarter < tick < last - quarter for tick in ticks)
    done.set()
    other.join()
    assert inside


def test_problems_are_pickled_to_the_last_bit(flight):
    problem = flight.with_parameters(signature_max=7, v_max=0.2456789012345678)
    again = pickle.loads(pickle.dumps(problem))
    assert again._core.state == problem._core.state
    assert again.solve().objective == problem.solve().objective


def test_a_spec_as_text_reads_its_tables_from_memory():
    text = """
    problem P {
        duration T = 1;
        output x: spline(order = 5, intervals = 2);
        table f(x) = monotone from "f.csv";
        minimize integral(der(x, 2)^2 + f(x));
        initial { x == 0; }
        final { x == 1; }
    }
    """
    try:
        problem = ntg.loads(text, tables={"f.csv": "-1,1\n0,0\n1,1\n2,4\n"})
    except ntg.SpecError as error:
        pytest.fail(str(error))
    assert pickle.loads(pickle.dumps(problem)).solve().solved
    with pytest.raises(ntg.SpecError, match="give `folder` or `tables`"):
        ntg.loads(text)


def test_a_fork_solves_too(flight):
    import os

    if not hasattr(os, "fork"):
        pytest.skip("no fork here")
    flight.solve_many({"v_max": [0.24, 0.25]}, parameters={"signature_max": 7}, jobs=2)
    wanted = flight.solve(signature_max=7).objective
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            found = flight.solve(signature_max=7).objective
            many = flight.solve_many({"v_max": [0.25]}, parameters={"signature_max": 7}, jobs=2)["objective"][0]
            os.write(write, f"{found!r} {float(many)!r}".encode())
        finally:
            os._exit(0)
    os.waitpid(child, 0)
    found, many = os.read(read, 1000).decode().split()
    assert float(found) == wanted and float(many) == wanted


def test_text_of_the_example_is_kept(move):
    assert move.text == MOVE and move.name == "Move" and "least effort" in move.doc
    assert repr(move) == "<ntg.Problem Move: 2 parameters>"


FALL = """
problem Fall {
    const n = 4;
    const pull = 9.8 [m/s^2];
    param noise = 0.1 [m];
    param seen[5] = (0.1, 5, 19.5, 44.2, 78.3) [m];
    duration T = n * 1 [s];
    output y [m]: spline(order = 3, intervals = n);
    variable height [m];
    temporal { initial(y) == height; }
    initial { der(y) == 0; }
    trajectory { der(y, 2) == pull; }
    measure { for i in 0 .. 4 { track: at(i * 1 [s], y) == seen[i + 1] sigma noise; } }
}
"""


def test_measurements_give_values_with_their_deviations():
    found = ntg.loads(FALL).solve(settings=ntg.Settings(tolerance=1e-10)).estimate
    # One height shifts all five places: their mean difference to the fall, known to 0.1 m / sqrt(5).
    places = [0, 4.9, 19.6, 44.1, 78.4]
    shift = np.mean(np.array([0.1, 5, 19.5, 44.2, 78.3]) - places)
    assert found.values["height"] == pytest.approx(shift, abs=1e-8)
    assert found.deviations["height"] == pytest.approx(0.1 / np.sqrt(5), rel=1e-6)
    track = found.measurements["track"]
    assert (found.count, len(track.residuals), track.unit, track.indices[4]) == (5, 5, "m", (4,))
    assert sum(ratio**2 for ratio in track.ratios) == pytest.approx(found.chi2)
    assert found.unknown is None and found.correlations == [[1.0]]


def test_nothing_measured_is_no_estimate(move):
    assert move.solve().estimate is None


def test_constants_are_set_where_a_spec_is_loaded(tmp_path):
    path = tmp_path / "fall.ntg"
    path.write_text(FALL)
    slow = ntg.load(path, pull="8 m/s^2", noise=0.2)
    assert slow.solve().estimate.deviations["height"] == pytest.approx(0.2 / np.sqrt(5), rel=1e-6)
    assert slow.solve()["y"].derivative(4.0) == pytest.approx(32, rel=1e-9)
    assert ntg.loads(FALL, values={"pull": 8}).solve().objective == pytest.approx(
        slow.with_parameters(noise=0.1).solve().objective, rel=1e-9
    )
    # What was set goes with a pickled problem.
    assert pickle.loads(pickle.dumps(slow)).solve().objective == slow.solve().objective
    with pytest.raises(ntg.ParameterError, match="neither a parameter nor a constant `pul`; constants are `n`, `pull`"):
        ntg.load(path, pul=8)
    with pytest.raises(ntg.ParameterError, match="constant `n`: NoneType is neither a number"):
        ntg.load(path, n=None)
    with pytest.raises(ntg.SpecError, match="E0"):
        ntg.load(path, pull="8 kg")


VECTORS = """
problem Vectors {
    duration T = 2 [s];
    param goal[3] = (1, 2, 3) [m];
    param M[2, 3] = ((1, 2, 3), (4, 5, 6));
    output r[3] [m]: spline(order = 4, intervals = 1);
    output p[0 .. 1, 1 .. 2] [m]: spline(order = 4, intervals = 1);
    variable k[2] in 0 .. 5;
    let v [m/s] = der(r);
    let both = (k[1], 2 * k[2]);
    minimize integral(dot(der(r, 2), der(r, 2)) + sum(i in 0 .. 1, dot(der(p[i], 2), der(p[i], 2)))) + dot(k - (1, 2), k - (1, 2)) * 1 [m^2/s^3];
    initial { r == 0;  der(r) == 0;  p == 0;  der(p) == 0; }
    final { r == goal;  der(r) == 0;  for i in 0 .. 1 { p[i] == (goal[1], goal[2]);  der(p[i]) == 0; } }
}
"""


def test_vectors_and_matrices_have_the_shape_of_the_times_and_their_own(tmp_path):
    solution = ntg.loads(VECTORS).solve()
    r, p, v = (solution[name] for name in ("r", "p", "v"))
    assert (r.shape, p.shape, v.shape, r.unit) == ((3,), (2, 2), (3,), "m")
    assert r.elements == ("r[1]", "r[2]", "r[3]") and p.elements[:2] == ("p[0, 1]", "p[0, 2]")
    t = np.array([[0.0, 0.5], [1.0, 2.0]])
    assert r(1.0).shape == (3,) and r(t).shape == (2, 2, 3) and p(t).shape == (2, 2, 2, 2) and r([]).shape == (0, 3)
    # The cubic from rest to rest, of each element.
    shape = (3 - t) * t**2 / 4
    np.testing.assert_allclose(r(t), shape[..., None] * [1, 2, 3], atol=1e-6)
    np.testing.assert_allclose(p(t)[..., 1, :], shape[..., None] * [1, 2], atol=1e-6)
    np.testing.assert_allclose(v(t), r.derivative(t), atol=1e-9)
    assert [one(1.0) for one in map(solution.__getitem__, r.elements)] == r(1.0).tolist()
    # Numbers likewise; an element is asked for by its own name.
    np.testing.assert_allclose(solution["k"], [1, 2], atol=1e-6)
    np.testing.assert_allclose(solution["both"], [1, 4], atol=1e-6)
    assert solution["k[2]"] == solution.variables["k"][1] and solution["both[2]"] == solution.expressions["both"][1]
    assert {"r", "p", "k", "v", "both"} < set(solution) and "r[1]" in solution and "r[4]" not in solution
    assert list(solution.outputs) == ["r", "p"]
    # Tables have a column for each element.
    assert list(solution.sample(3))[:4] == ["t", "r[1]", "r[2]", "r[3]"] and solution.units["p[1, 2]"] == "m"
    with pytest.raises(ValueError, match="name one of its elements, `r\\[1\\]`"):
        solution.plot_track("r", "r[2]")
    assert [len(axes.lines) for axes in np.ravel(solution.plot("r", "r[1]"))] == [3, 1]
    # The saved form has the same arrays.
    solution.save(tmp_path / "run.json")
    saved = json.loads((tmp_path / "run.json").read_text())
    written = saved["outputs"]["r"]
    np.testing.assert_allclose(written["value"], r(np.array(written["t"])), atol=1e-12)
    assert np.shape(saved["outputs"]["p"]["value"]) == (401, 2, 2) and saved["outputs"]["p"]["first"] == [0, 1]
    assert np.shape(saved["variables"]["k"]["value"]) == (2,) and saved["lets"]["both"]["value"] == solution["both"].tolist()
    # What is differentiated or predicted is a vector, too, as far as it is a function of time.
    nearby = solution.sensitivity("goal[1]").predict({"goal[1]": 1.1})
    np.testing.assert_allclose(nearby["r"](2.0), [1.1, 2, 3], atol=1e-6)


def test_matrices_are_set_as_they_are_read():
    problem = ntg.loads(VECTORS)
    assert problem.parameters["M"].value == [[1, 2, 3], [4, 5, 6]] and problem.parameters["goal"].value == [1, 2, 3]
    other = np.arange(6.0).reshape(2, 3)
    for given in (other, other.tolist(), other.reshape(-1), [["0", "1", "2"], [3, 4, "5"]]):
        assert problem.with_parameters(M=given).parameters["M"].value == other.tolist()
    for wrong, words in [(other.T, "a matrix of 2 x 3"), ([[1, 2, 3], [4, 5]], "2 x 3"), ([[1, 2, None], [3, 4, 5]], "NoneType")]:
        with pytest.raises(ntg.ParameterError, match=words):
            problem.with_parameters(M=wrong)
