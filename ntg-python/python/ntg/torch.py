"""A problem as a function that PyTorch differentiates.

>>> import torch, ntg, ntg.torch                             # doctest: +SKIP
>>> best = ntg.torch.function(ntg.load("flight.ntg"), ["v_max", "reach"], ["objective"])   # doctest: +SKIP
>>> p = torch.tensor([0.24, 1.0], dtype=torch.float64, requires_grad=True)                 # doctest: +SKIP
>>> best(p).sum().backward()                                 # doctest: +SKIP

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
    """From a tensor of values of the inputs, in declared units, to a tensor of the wanted numbers, of the same type.

    Inputs are parameters, members of arrays as `start[2]`. Every call solves from the solution of the call before.
    """
    import torch

    core = Function(problem, inputs, outputs, settings)

    class Optimum(torch.autograd.Function):
        @staticmethod
        def forward(context: Any, p: Any) -> Any:
            values = p.detach().cpu().double().numpy()
            if context.needs_input_grad[0]:
                # Here and not in `backward`, before which the function may be called with other values.
                context.save_for_backward(p.new_tensor(core.jacobian(values)))
            return p.new_tensor(core.value(values))

        @staticmethod
        def backward(context: Any, weights: Any) -> Any:
            (jacobian,) = context.saved_tensors
            return weights @ jacobian

    return Optimum.apply  # type: ignore[no-any-return]
