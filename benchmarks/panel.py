"""What the panel costs: a run watched in it against the same run without, in turn, as a ratio of their throughput.

    python benchmarks/panel.py --pairs 5

Nobody looks at the panel here: it draws all that it would send to a browser, which takes its own time elsewhere.
"""

import argparse
import statistics
import tempfile
import time
from pathlib import Path

import walkerlab as wl
from walkerlab.widgets import Lab

IN_SIGHT = 24  # robots of the population that a browser shows at once


def bare(settings: wl.Settings) -> float:
    """Evolve without a panel: s."""
    started = time.perf_counter()
    wl.evolve(settings, progress=False)
    return time.perf_counter() - started


def watched(settings: wl.Settings) -> float:
    """Evolve in a panel: s, from the press on the button to the last walk."""
    with tempfile.TemporaryDirectory() as folder:
        lab = Lab(settings, Path(folder))
        lab.population.sight = [0, IN_SIGHT]
        time.sleep(2)  # in which it draws the world and asks what a run will cost
        started = time.perf_counter()
        lab.transport._on_press("start")
        while lab.transport.state in ("ready", "running"):
            time.sleep(0.005)
        took = time.perf_counter() - started
        lab.form.close()  # but not the panel: its workers are those of the next run
        return took


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pairs", type=int, default=5)
    parser.add_argument("--generations", type=int, default=12)
    options = parser.parse_args()
    settings = wl.Settings().with_(generations=options.generations)
    bare(settings.with_(generations=2))  # starts the workers, and builds what is built once
    ratios = []
    for _ in range(options.pairs):
        without, within = bare(settings), watched(settings)
        ratios.append(without / within)
        print(f"without {without:6.2f} s   in the panel {within:6.2f} s   throughput {ratios[-1]:.3f}")
    print(f"median throughput in the panel: {statistics.median(ratios):.3f} of that without")


if __name__ == "__main__":
    main()
