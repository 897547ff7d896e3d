"""Profiles as SVG, by matplotlib."""

import matplotlib

matplotlib.use("svg")
# The same data give the same file.
matplotlib.rcParams.update({"svg.hashsalt": "ntg", "svg.fonttype": "none", "font.size": 10})

import matplotlib.pyplot as plt  # noqa: E402
import matplotlib.ticker  # noqa: E402

NAMES = {"ntg": "ntg", "ipopt": "IPOPT"}
COLOURS = {"ntg": "#1f6fb4", "ipopt": "#d1495b"}
TITLES = {"iterations": "iterations", "cpu": "processor time"}


def draw(ratios, what, path):
    """One picture: the share of problems solved within a factor of the best."""
    figure, axes = plt.subplots(figsize=(6.4, 4.0))
    finite = [ratio for all_of in ratios.values() for ratio in all_of if ratio < float("inf")]
    last = max(finite, default=1.0) * 1.2
    for solver, all_of in ratios.items():
        count = len(all_of)
        within = [ratio for ratio in all_of if ratio < float("inf")]
        x = [1.0, *within, last]
        y = [0.0, *[(i + 1) / count for i in range(len(within))], len(within) / count if count else 0.0]
        axes.step(x, y, where="post", label=NAMES[solver], color=COLOURS[solver], linewidth=2)
    axes.set_xscale("log")
    for axis_format in (axes.xaxis.set_major_formatter, axes.xaxis.set_minor_formatter):
        axis_format(matplotlib.ticker.StrMethodFormatter("{x:g}"))
    axes.set_xlim(1.0, last)
    axes.set_ylim(0.0, 1.02)
    axes.set_xlabel(f"factor of the fewest {TITLES[what]}" if what == "iterations" else "factor of the least processor time")
    axes.set_ylabel("share of problems")
    axes.grid(True, which="both", alpha=0.25)
    axes.legend(loc="lower right")
    figure.tight_layout()
    figure.savefig(path, format="svg", metadata={"Date": None})
    plt.close(figure)
