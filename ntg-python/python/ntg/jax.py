"""A problem as a function that JAX differentiates.

>>> import jax, ntg, ntg.jax                                 # doctest: +SKIP
>>> best = ntg.jax.function(ntg.load("flight.ntg"), ["v_max", "reach"], ["objective", ("x", [60.0, 120.0])])
>>> jax.grad(lambda p: best(p)[0])([0.24, 1.0])              # doctest: +SKIP

Gradients are those of the optimum by parameters: `Solution.sensitivity`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Sequence

from ._differentiable import Function
from ._settings import DEFAULT, Settings

if TYPE_CHECKING:
    from ._problem import Problem
    from ._sensitivity import Wanted

__all__ = ["function"]


def function(
    problem: "Problem", inputs: Sequence[str], outputs: "Sequence[Wanted]", settings: Settings = DEFAULT
) -> Callable[[Any], Any]:
    """From an array of values of the inputs, in declared units, to an array of the wanted numbers.

    Inputs are parameters, members of arrays as `start[2]`. It may stand in `jit`, `grad`, `vjp` and `vmap`; solves are
    made one after the other, each from the solution before. Numbers are as precise as JAX's own: 32 bits unless
    `jax_enable_x64` is set.
    """
    import jax
    import jax.numpy as jnp
    import numpy as np

    core = Function(problem, inputs, outputs, settings)
    kind = jnp.result_type(float)
    value = jax.ShapeDtypeStruct((core.size,), kind)
    matrix = jax.ShapeDtypeStruct((core.size, len(core.inputs)), kind)

    raised: list[Exception] = []

    def kept(work: Callable[[Any], Any]) -> Callable[[Any], Any]:
        """Keeps what a callback raises, because JAX wraps it."""

        def callback(p: Any) -> Any:
            raised.clear()
            try:
                return work(np.asarray(p))
            except Exception as error:
                raised.append(error)
                raise

        return callback

    @kept
    def solved(p: Any) -> Any:
        return np.asarray(core.value(p), kind)

    @kept
    def differentiated(p: Any) -> Any:
        return np.asarray(core.value(p), kind), np.asarray(core.jacobian(p), kind)

    @jax.custom_vjp
    def optimum(p: Any) -> Any:
        return jax.pure_callback(solved, value, jnp.asarray(p, kind), vmap_method="sequential")

    def forward(p: Any) -> Any:
        return jax.pure_callback(differentiated, (value, matrix), jnp.asarray(p, kind), vmap_method="sequential")

    def backward(jacobian: Any, weights: Any) -> Any:
        return (weights @ jacobian,)

    optimum.defvjp(forward, backward)

    def checked(p: Any) -> Any:
        values = jnp.asarray(p, kind)
        core.check(values.size)
        try:
            return optimum(values)
        except jax.errors.JaxRuntimeError:
            if not raised:
                raise
            raise raised.pop() from None

    return checked
