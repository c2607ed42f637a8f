"""How far the localizer is off, against one that is told the receiver's true errors.

Run ``python benchmarks/bench_positioning.py``; walks of ten minutes, errors correlated in time by
published models (``tests/vehicles/positioning/drives.py``). "Says" is what a localizer says of its own error; "white"
is one that takes all of the receiver's error to be new in each fix.
"""

import argparse
import math
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tests.vehicles.positioning.drives import TRUTHS, Truth, credulous, follow, readings, rms, told, walk

from reasoned_explorer.vehicles.positioning.localizer import LocalizerSettings


def _row(name: str, truth: Truth, *, walks: int, minutes: float, tells_sigma: bool) -> None:
    path = walk(minutes * 60.0)
    ours, best, white = [], [], []
    took_s = 0.0
    for seed in range(walks):
        said = readings(path, truth, seed, tells_sigma=tells_sigma)
        started = time.process_time()
        ours.append(follow(path, said, LocalizerSettings()))
        took_s += time.process_time() - started
        # One that is told the truth needs no receiver's word for it.
        said = readings(path, truth, seed, tells_sigma=False)
        best.append(follow(path, said, told(truth)))
        white.append(follow(path, said, credulous(truth)))
    ours_m, best_m, white_m = (rms(np.concatenate([e.position_m for e in errors])) for errors in (ours, best, white))
    says_m, white_says_m = (rms(np.concatenate([e.says_m for e in errors])) for errors in (ours, white))
    heading_deg = math.degrees(rms(np.concatenate([walk.heading_rad for walk in ours])))
    worst_deg = math.degrees(max(rms(walk.heading_rad) for walk in ours))
    real_time = walks * minutes * 60.0 / took_s
    figures = (ours_m, says_m, best_m, ours_m / best_m, white_m, white_says_m, heading_deg, worst_deg, real_time)
    print(f"{name:22} {'GST' if tells_sigma else '   '} " + " ".join(f"{figure:9.4g}" for figure in figures))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--walks", type=int, default=12)
    parser.add_argument("--minutes", type=float, default=10.0)
    settings = parser.parse_args()
    print(f"{settings.walks} walks of {settings.minutes:g} min; RMS after the first half minute")
    columns = ("ours m", "says m", "told m", "ratio", "white m", "says m", "head °", "worst °", "x real")
    print(f"{'receiver':26} " + " ".join(f"{column:>9}" for column in columns))
    for name, truth in TRUTHS.items():
        for tells_sigma in (True, False):
            _row(name, truth, walks=settings.walks, minutes=settings.minutes, tells_sigma=tells_sigma)


if __name__ == "__main__":
    main()
