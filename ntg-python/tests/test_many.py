"""Many parameter sets: every kind of table, the same rows however they are cut."""

import numpy as np
import pytest

import ntg
from ntg import _ntg, _table


def sets(rows=40):
    random = np.random.default_rng(1)
    return {"v_max": 0.24 + 0.02 * random.random(rows), "reach": 0.5 + random.random(rows)}


def assert_same(one, other):
    """All columns but the clock's, bit for bit."""
    assert list(one) == list(other)
    for name in one:
        if name != "seconds":
            np.testing.assert_array_equal(np.asarray(one[name]), np.asarray(other[name]), err_msg=name)


@pytest.fixture(scope="module")
def cheap(flight):
    return flight.with_parameters(signature_max=7)


@pytest.fixture(scope="module")
def whole(cheap):
    return cheap.solve_many(sets(), values=["max(speed)", "final(x)"], jobs=1, block=8)


def test_rows_are_those_of_single_solves(cheap, whole):
    assert set(whole["status"]) == {"solved"}
    table = sets()
    for row in (0, 17, 39):
        alone = cheap.solve(v_max=table["v_max"][row], reach=table["reach"][row])
        assert whole["objective"][row] == pytest.approx(alone.objective, rel=1e-7)
        assert whole["T"][row] == pytest.approx(alone["T"], rel=1e-5)
        assert whole["final(x)"][row] == pytest.approx(alone["x"](alone.end), rel=1e-5)
        assert whole["binding"][row] == "arrival"
    cold = cheap.solve_many(sets(), block=1)
    alone = cheap.solve(v_max=table["v_max"][5], reach=table["reach"][5])
    assert cold["objective"][5] == alone.objective


def test_cores_and_blocks_that_are_sent_elsewhere_change_no_bit(cheap, whole):
    assert_same(whole, cheap.solve_many(sets(), values=["max(speed)", "final(x)"], jobs=2, block=8))
    # Blocks alone, in another order: as Ray and Dask send them.
    inputs, array, _ = _table.read(cheap._core, sets(), None)
    pieces = _ntg.blocks(array, 8)
    assert sorted(np.concatenate(pieces)) == list(range(40))
    parts = []
    for some in (pieces[3:], pieces[:3]):
        rows = np.concatenate(some)
        how = _table.How(["max(speed)", "final(x)"], 1, 8, [len(piece) for piece in some], None)
        found = dict(_ntg.sweep(cheap._core, inputs, array[rows], ntg.Settings(), how, None))
        found["row"] = rows
        parts.append(found)
    order = np.argsort(np.concatenate([part["row"] for part in parts]))
    joined = {name: np.concatenate([np.asarray(part[name]) for part in parts])[order] for name in whole}
    assert_same(whole, joined)


def test_every_kind_of_table_comes_back_as_what_it_was(cheap):
    pandas, polars, pyarrow = (pytest.importorskip(name) for name in ("pandas", "polars", "pyarrow"))
    table = {name: values[:4] for name, values in sets().items()}
    plain = cheap.solve_many(table)
    frame = pandas.DataFrame(table, index=list("abcd"))
    found = cheap.solve_many(frame)
    assert isinstance(found, pandas.DataFrame) and list(found.index) == list("abcd")
    assert_same(plain, found)
    found = cheap.solve_many(polars.DataFrame(table))
    assert isinstance(found, polars.DataFrame)
    assert_same(plain, {name: found[name] for name in found.columns})
    for arrow in (pyarrow.table(table), pyarrow.RecordBatch.from_pydict(table)):
        found = cheap.solve_many(arrow)
        assert isinstance(found, pyarrow.Table)
        assert_same(plain, {name: found[name] for name in found.column_names})
    array = np.column_stack(list(table.values()))
    assert_same(plain, cheap.solve_many(array, columns=list(table)))
    fields = np.rec.fromarrays(list(table.values()), names=list(table))
    assert_same(plain, cheap.solve_many(fields))


def test_texts_with_units_fixed_parameters_and_rows_that_fail(flight):
    table = {"v_min": [0.1, 0.3, 0.1], "v_max": ["250 m/s", "0.25", "0.25 km/s"]}
    found = flight.solve_many(table, parameters={"signature_max": 7}, block=1)
    assert list(found["v_max"]) == [0.25, 0.25, 0.25]
    assert found["status"][0] == found["status"][2] == "solved" and "speed_limits" in found["status"][1]
    assert found["objective"][0] == found["objective"][2] and np.isnan(found["objective"][1])


def test_what_is_no_table_is_refused_with_words(cheap):
    for table, more, words in [
        ({"v": [1.0]}, {}, "there is no parameter `v`"),
        ({}, {}, "no columns"),
        ({"v_max": [0.2, 0.3], "reach": [1.0]}, {}, "different lengths"),
        ({"v_max": [0.2, None]}, {}, "no number|finite"),
        ({"v_max": [0.2, np.nan]}, {}, "row 1: `v_max` is nan"),
        ({"v_max": ["fast"]}, {}, "row 0: `v_max`"),
        ({"v_max": ["1 kg"]}, {}, "row 0: `v_max`"),
        ({"v_max": [[0.2]]}, {}, "dimensions"),
        (np.zeros((2, 2)), {}, "needs `columns`"),
        (np.zeros((2, 2)), {"columns": ["v_max"]}, "has shape"),
        ([1, 2], {}, "is no table"),
        ({"v_max": [0.2]}, {"values": ["final(w)"]}, "`w` is none of"),
        ({"v_max": [0.2]}, {"parameters": {"w": 1}}, "no parameter `w`"),
    ]:
        with pytest.raises((ntg.TableError, ntg.ParameterError), match=words):
            cheap.solve_many(table, **more)


def test_an_empty_table_gives_an_empty_table(cheap):
    found = cheap.solve_many({"v_max": np.empty(0)})
    assert all(len(column) == 0 for column in found.values()) and "status" in found


def test_a_journal_lets_rows_survive(cheap, tmp_path):
    journal, seen = tmp_path / "study.journal", []

    def stop(done, rows):
        seen.append((done, rows))
        if done >= 10:
            raise KeyboardInterrupt

    table = sets(400)
    with pytest.raises(KeyboardInterrupt):
        cheap.solve_many(table, journal=journal, progress=stop)
    kept = journal.read_text().count("\n")
    assert 10 <= kept < 400
    found = cheap.solve_many(table, journal=journal)
    assert journal.read_text().startswith("".join(journal.read_text().splitlines(True)[:kept]))
    assert_same(found, cheap.solve_many(table))
    with pytest.raises(ntg.Error, match="belongs to another study"):
        cheap.solve_many(sets(7), journal=journal)


def test_progress_ends_with_all_rows(cheap, capsys):
    seen = []
    cheap.solve_many(sets(12), progress=lambda done, rows: seen.append((done, rows)))
    assert seen[-1] == (12, 12)
    cheap.solve_many(sets(3), progress=True)
    assert "3 of 3 rows" in capsys.readouterr().err
