"""What a person gives by mistake: the exception says what is wrong and what is wanted, and nothing is changed."""

import copy
import pickle

import numpy as np
import pytest

import ntg
from conftest import MOVE, SPECS

LIMITED = """
problem Limited {
    duration T = 1 [s];
    param most[2] = (3, 4) [m/s];
    output x [m]: spline(order = 6, intervals = 2);
    minimize integral(der(x, 2)^2);
    initial { x == 0; }
    trajectory { der(x) <= most[1]; }
    final { x == 1 [m]; }
}
"""


def refused(cases):
    """Every case is a call, the class of its exception, and words of its message."""
    for call, error, words in cases:
        with pytest.raises(error, match=words):
            call()


def test_texts_and_paths_of_specs():
    refused(
        [
            (lambda: ntg.loads(None), TypeError, "a spec is a text .*not NoneType"),
            (lambda: ntg.loads(MOVE.encode()), TypeError, "not bytes; a file is compiled by `ntg.load`"),
            (lambda: ntg.loads("problem \ud800"), ntg.SpecError, "no Unicode text"),
            (lambda: ntg.loads(str(SPECS / "gates.ntg")), ValueError, "is a path and no spec"),
            (lambda: ntg.load(MOVE), ValueError, "text of several lines; .*`ntg.loads`"),
            (lambda: ntg.loads(MOVE, tables={"a.csv": 1}), TypeError, "that of 'a.csv' is int"),
            (lambda: ntg.loads(MOVE, tables=["a.csv"]), TypeError, "tables are a mapping"),
            (lambda: ntg.loads(""), ntg.SpecError, "there is no problem here"),
            (lambda: ntg.Problem("flight.ntg"), TypeError, "made by `ntg.load`"),
        ]
    )


def test_values_of_parameters(move):
    limited = ntg.loads(LIMITED)
    refused(
        [
            (lambda: move.solve(distance=[]), ntg.ParameterError, "no value is given"),
            (lambda: move.solve(distance=" "), ntg.ParameterError, "no value is given"),
            (lambda: move.solve(distance=b"1 m"), ntg.ParameterError, "bytes are decoded first"),
            (lambda: move.solve(distance=10**400), ntg.ParameterError, "too large"),
            (lambda: move.solve(distance=1j), ntg.ParameterError, "complex is neither a number"),
            (lambda: move.solve(distance={1.0}), ntg.ParameterError, "set is neither a number"),
            (lambda: move.solve({"distance[1]": 1}), ntg.ParameterError, "`distance` is one number, not an array"),
            (lambda: move.solve({f"distance[{-2**63}]": 1}), ntg.ParameterError, "not an array"),
            (lambda: limited.solve({"most[0]": 1}), ntg.ParameterError, r"members are `most\[1\]` to `most\[2\]`"),
            (lambda: limited.solve({f"most[{-2**63}]": "1 m/s"}), ntg.ParameterError, r"members are `most\[1\]`"),
            (lambda: limited.solve(most=1), ntg.ParameterError, "holds 2 values, but 1 is given"),
            (lambda: limited.solve(most=[1, None]), ntg.ParameterError, "member 2: NoneType is neither"),
            (lambda: limited.solve(most=["1 m/s", None]), ntg.ParameterError, "member 2: NoneType is neither"),
            (lambda: limited.solve(most=np.ones((2, 2))), ntg.ParameterError, "member 1: ndarray is neither"),
            (lambda: limited.solve(most=[1, "2 kg"]), ntg.ParameterError, "this is a mass"),
            (lambda: move.solve({1: 2}), TypeError, "names of parameters are texts, not int"),
            (lambda: move.solve([1, 2]), TypeError, "a mapping of names to values, not list"),
            (lambda: move.solve("distance=3"), TypeError, "a mapping of names to values, not str"),
        ]
    )
    mixed = limited.with_parameters(most=[1, "2 km/s"])
    assert mixed.parameters["most"].value == [1.0, 2000.0]


def test_settings_and_guesses(move, flight):
    refused(
        [
            (lambda: ntg.Settings(tolerance="1e-6"), ntg.SettingsError, "setting `tolerance`: a number, not '1e-6'"),
            (lambda: ntg.Settings(max_iterations=1.5), ntg.SettingsError, "setting `max_iterations`: a whole number"),
            (lambda: ntg.Settings(max_iterations=-1), ntg.SettingsError, "setting `max_iterations`: a whole number"),
            (lambda: ntg.Settings(samples=10**30), ntg.SettingsError, "setting `samples`: a whole number"),
            (lambda: ntg.Settings(time_limit="1 s"), ntg.SettingsError, "setting `time_limit`: a number of seconds"),
            (lambda: ntg.Settings(method=None), ntg.SettingsError, "setting `method`: a text"),
            (lambda: ntg.Settings(scales=[1]), ntg.SettingsError, "setting `scales`: numbers by the names"),
            (lambda: ntg.Settings(refine="fine"), ntg.SettingsError, "setting `refine`: a number, or None"),
            (lambda: move.solve(settings={"tolerance": 1e-6}), TypeError, "settings is an ntg.Settings, not dict"),
            (lambda: move.solve(settings=ntg.Settings), TypeError, "not the class Settings itself"),
            (lambda: move.solver(settings=None), TypeError, "settings is an ntg.Settings, not None"),
            (lambda: move.solve(guess="run.json"), TypeError, "guess is an ntg.Solution, not str"),
            (lambda: move.solver().solve(guess={"x": 1}), TypeError, "guess is an ntg.Solution, not dict"),
        ]
    )
    fall = ntg.loads(LIMITED.replace("output x", "output h").replace("(x", "(h").replace("x ==", "h =="))
    with pytest.raises(ntg.ParameterError, match="a solution of `Limited`, which has no output of `Move`"):
        move.solve(guess=fall.solve())
    assert move.solve(guess=move.solve(distance=2)).solved


def test_what_is_asked_of_a_solution(move, tmp_path):
    solution = move.solve()
    by, x = solution.sensitivity(), solution["x"]
    refused(
        [
            (lambda: solution[0], TypeError, "read by name, not by int"),
            (lambda: x("1 s"), TypeError, "times are numbers, in seconds; '1 s' is none"),
            (lambda: x(1j), TypeError, "times are numbers"),
            (lambda: x.derivative(1.0, -1), ValueError, "at least 0, not -1"),
            (lambda: x.derivative(1.0, 1.5), TypeError, "whole number, not float"),
            (lambda: solution.sample(-1), ValueError, "the number of times is at least 0"),
            (lambda: solution.sample("a"), TypeError, "times are numbers"),
            (lambda: solution.sensitivity(["distance"]), TypeError, "a list of names, and list is none"),
            (lambda: by.at("x", 1.0, -1), ValueError, "at least 0"),
            (lambda: by.at("speed", 1.0, 1), KeyError, "only outputs have derivatives"),
            (lambda: by.at("x", np.nan), ValueError, "a time is NaN"),
            (lambda: by.jacobian("objective"), TypeError, r"write \['objective'\]"),
            (lambda: by.jacobian([("x", 1, 2)]), TypeError, "a name with times"),
            (lambda: by.vector_jacobian(["objective"], [1, 2]), ValueError, "2 weights are given for 1 wanted"),
            (lambda: by.predict(distance="2 kg"), ntg.ParameterError, "this is a mass"),
            (lambda: solution.save(tmp_path / "no" / "a.json"), FileNotFoundError, "there is no folder"),
            (lambda: solution.html("xy"), TypeError, "tracks are pairs of names"),
            (lambda: pickle.dumps(solution), TypeError, "`save` it"),
            (lambda: copy.deepcopy(move.solver()), TypeError, "its problem can"),
        ]
    )


def test_tables_and_how_they_are_solved(flight):
    pandas, pyarrow = pytest.importorskip("pandas"), pytest.importorskip("pyarrow")
    cheap = flight.with_parameters(signature_max=7)
    table = {"v_max": [0.24, 0.25]}
    twice = pandas.DataFrame([[0.24, 0.25]], columns=["v_max", "v_max"])

    def many(table, **more):
        return lambda: cheap.solve_many(table, **more)

    refused(
        [
            (many(None), ntg.TableError, "NoneType is no table"),
            (many("sets.csv"), ntg.TableError, "str is no table"),
            (many(pandas.Series([0.24], name="v_max")), ntg.TableError, "Series is no table"),
            (many({"v_max": 0.24}), ntg.TableError, "column `v_max` is 0.24, one value"),
            (many({"v_max": "0.24"}), ntg.TableError, "column `v_max` is '0.24', one value"),
            (many(twice), ntg.TableError, "two columns are called `v_max`"),
            (many(pyarrow.table([[0.24], [0.25]], names=["v_max"] * 2)), ntg.TableError, "two columns are called"),
            (many({"v_max": [1j]}), ntg.TableError, "holds no numbers but complex"),
            (many({"v_max": np.array(["2020"], "datetime64[D]")}), ntg.TableError, "holds no numbers but datetime64"),
            (many({"v_max": ["0.24", None]}), ntg.TableError, "row 1: `v_max` has no value"),
            (many({"v_max": ["0.24", ""]}), ntg.TableError, "row 1: `v_max`: no value is given"),
            (many(np.array([0.24]), columns=["v_max"]), ntg.TableError, r"its shape is \(rows, 1\)"),
            (many(np.array([[0.24]]), columns="v_max"), TypeError, r"write \['v_max'\]"),
            (many(table, values="max(speed)"), TypeError, r"write \['max\(speed\)'\]"),
            (many(table, values=[3]), TypeError, "`values` are a list of names, and int is none"),
            (many(table, jobs=-1), ntg.TableError, "`jobs`.*at least 0, not -1"),
            (many(table, jobs=1.5), TypeError, "`jobs`.*whole number, not float"),
            (many(table, block=0), ntg.TableError, "`block`.*at least 1, not 0"),
            (many(table, settings=None), TypeError, "settings is an ntg.Settings"),
            (many(table, parameters={"v_max": 0.2}), ntg.TableError, "is a column, and given in `parameters` too"),
        ]
    )
    # More rows at a time than there are: no thread is begun for what is not there.
    found = cheap.solve_many(table, jobs=10**9)
    np.testing.assert_array_equal(found["objective"], cheap.solve_many(table, jobs=1)["objective"])


def test_what_is_wrong_with_a_study_is_found_before_any_worker_is_begun(flight):
    pytest.importorskip("ray"), pytest.importorskip("distributed")
    import ray

    import ntg.dask
    import ntg.ray

    table = {"v_max": [0.24]}

    class Client:
        """Begins nothing."""

        def submit(self):
            pytest.fail("a batch was sent")

        def nthreads(self):
            pytest.fail("workers were counted")

        def cancel(self, futures):
            assert futures == []

    for solve in (ntg.ray.solve_many, lambda *words, **more: ntg.dask.solve_many(*words, Client(), **more)):
        refused(
            [
                (lambda: solve(flight, {"v": [1.0]}), ntg.ParameterError, "no parameter `v`"),
                (lambda: solve(flight, table, values=["final(w)"]), ntg.ParameterError, "`w` is none of"),
                (lambda: solve(flight, table, values="max(speed)"), TypeError, "a list of names"),
                (lambda: solve(flight, table, batch=0), ntg.TableError, "`batch`.*at least 1"),
                (lambda: solve(flight, table, blok=3), TypeError, "no option `blok`"),
                (lambda: solve(flight, table, settings={}), TypeError, "settings is an ntg.Settings"),
                (lambda: solve("flight.ntg", table), TypeError, "an ntg.Problem, not str"),
            ]
        )
    refused(
        [
            (lambda: ntg.ray.solve_many(flight, table, workers=0), ValueError, "`workers`.*at least 1"),
            (lambda: ntg.dask.solve_many(flight, table), ValueError, "there is no Dask client"),
            (lambda: ntg.dask.solve_many(flight, table, 3), TypeError, "dask.distributed.Client, not int"),
        ]
    )
    assert not ray.is_initialized()


def test_mistakes_of_functions_for_jax_have_words_of_their_own(move):
    pytest.importorskip("jax")
    import ntg.jax

    def best(inputs, outputs, *values):
        return lambda: ntg.jax.function(move, inputs, outputs)(list(values))

    refused(
        [
            (best("distance", ["objective"], 1.0), TypeError, r"write \['distance'\]"),
            (best(["distanse"], ["objective"], 1.0), ntg.ParameterError, "no parameter `distanse`"),
            (best(["distance"], "objective", 1.0), TypeError, r"write \['objective'\]"),
            (best(["distance"], ["nope"], 1.0), KeyError, "there is no `nope`"),
            (best(["distance"], ["x"], 1.0), TypeError, "`x` is a function of time"),
            (best(["distance"], ["objective"], np.nan), ntg.ParameterError, "finite"),
            (best(["distance", "limit"], ["objective"], 1.0, 0.1), ntg.UnsolvedError, "Move: infeasible"),
        ]
    )
