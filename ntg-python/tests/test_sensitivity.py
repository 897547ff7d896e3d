"""Derivatives of solutions: closed forms, predictions, JAX and PyTorch."""

import numpy as np
import pytest

import ntg


def test_a_cubic_depends_on_its_distance_as_on_paper(move):
    solution = move.solve(distance=3)
    by = solution.sensitivity()
    assert by.parameters == ["distance", "limit"] and by.strict and by.weak == []
    # 12 d^2 / T^3.
    assert by.of("objective") == pytest.approx({"distance": 24 * 3 / 8, "limit": 0}, abs=1e-6)
    assert by.of("mean") == pytest.approx({"distance": 0.5, "limit": 0})
    t = np.array([[0.0, 0.5], [1.0, 2.0]])
    tau = t / 2
    np.testing.assert_allclose(by.at("x", t)[..., 0], 3 * tau**2 - 2 * tau**3, atol=1e-7)
    np.testing.assert_allclose(by.at("speed", t)[..., 0], 100 * 3 * tau * (1 - tau), atol=1e-5)
    np.testing.assert_allclose(by.at("x", 1.0, order=1)[0], 0.75, atol=1e-7)
    wanted = ["objective", ("x", [0.5, 1.0])]
    jacobian = by.jacobian(wanted)
    assert jacobian.shape == (3, 2)
    np.testing.assert_allclose(by.vector_jacobian(wanted, [1, 2, 3]), [1, 2, 3] @ jacobian)
    assert solution.sensitivity("distance").parameters == ["distance"]


def test_a_prediction_is_the_solution_where_that_is_linear(move):
    predicted = move.solve(distance=3).sensitivity().predict(distance="4 m")
    assert predicted["x"](1.0) == pytest.approx(2, abs=1e-6) and predicted["T"] == 2.0
    assert predicted["mean"] == pytest.approx(2.0) and predicted["speed"].unit == "cm/s"


def test_what_cannot_be_differentiated_says_so(move):
    solution = move.solve()
    by = solution.sensitivity()
    for call, error, words in [
        (lambda: solution.sensitivity("speed"), ntg.ParameterError, "no parameter `speed`"),
        (lambda: by.of("x"), KeyError, "no number `x`"),
        (lambda: by.at("T", 0.0), KeyError, "no function of time `T`"),
        (lambda: by.predict(speed=1), ntg.ParameterError, "no parameter `speed`"),
        (lambda: by.predict()["y"], KeyError, "no `y`"),
        (lambda: move.solve(limit=0.5).sensitivity(), ntg.SensitivityError, "no solution to differentiate"),
    ]:
        with pytest.raises(error, match=words):
            call()


def test_jax_differentiates_and_trains(move):
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    import ntg.jax

    best = ntg.jax.function(move, ["distance"], ["objective", ("x", [1.0])])
    np.testing.assert_allclose(best([3.0]), [13.5, 1.5], atol=1e-6)
    np.testing.assert_allclose(jax.jacrev(best)(jax.numpy.array([3.0]))[:, 0], [9.0, 0.5], atol=1e-6)
    np.testing.assert_allclose(jax.jit(jax.grad(lambda p: best(p)[0] ** 2))(jax.numpy.array([3.0])), [243.0], rtol=1e-6)
    # The distance whose effort is 6: d = 2.
    loss = jax.grad(lambda p: (best(p)[0] - 6.0) ** 2)
    p = jax.numpy.array([3.0])
    for _ in range(30):
        p = p - 0.008 * loss(p)
    np.testing.assert_allclose(p, [2.0], atol=1e-3)
    with pytest.raises(ValueError, match="2 values are given for 1 inputs"):
        best([1.0, 2.0])


def test_torch_differentiates_and_trains(move):
    torch = pytest.importorskip("torch")
    import ntg.torch

    best = ntg.torch.function(move, ["distance"], ["objective", ("x", [1.0])])
    p = torch.tensor([3.0], dtype=torch.float64, requires_grad=True)
    optimiser = torch.optim.SGD([p], lr=0.008)
    for _ in range(30):
        optimiser.zero_grad()
        ((best(p)[0] - 6.0) ** 2).backward()
        optimiser.step()
    assert abs(p.item() - 2.0) < 1e-3
    assert torch.autograd.gradcheck(best, (p,), eps=1e-4, atol=1e-5)
