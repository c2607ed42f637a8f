"""How far the localizer is off, against one that is told the receiver's true errors.

Run ``python benchmarks/bench_positioning.py``; walks of ten minutes, errors correlated in time by
published models (``tests/vehicles/positioning/drives.py``).
"""

import argparse
import math
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tests.vehicles.positioning.drives import TRUTHS, Truth, follow, readings, rms, told, walk

from reasoned_explorer.vehicles.positioning.localizer import LocalizerSettings


def _row(name: str, truth: Truth, *, walks: int, minutes: float, tells_sigma: bool) -> None:
    path = walk(minutes * 60.0)
    ours, best = [], []
    took_s = 0.0
    for seed in range(walks):
        said = readings(path, truth, seed, tells_sigma=tells_sigma)
        started = time.process_time()
        ours.append(follow(path, said, LocalizerSettings()))
        took_s += time.process_time() - started
        # One that is told the truth needs no receiver's word for it.
        best.append(follow(path, readings(path, truth, seed, tells_sigma=False), told(truth)))
    ours_m, best_m = (rms(np.concatenate([walk.position_m for walk in errors])) for errors in (ours, best))
    heading_deg = math.degrees(rms(np.concatenate([walk.heading_rad for walk in ours])))
    worst_deg = math.degrees(max(rms(walk.heading_rad) for walk in ours))
    real_time = walks * minutes * 60.0 / took_s
    print(
        f"{name:22} {'GST' if tells_sigma else '   '} {ours_m:9.4f} {best_m:9.4f} {ours_m / best_m:7.3f}"
        f" {heading_deg:8.2f} {worst_deg:8.2f} {real_time:9.0f}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--walks", type=int, default=12)
    parser.add_argument("--minutes", type=float, default=10.0)
    settings = parser.parse_args()
    print(f"{settings.walks} walks of {settings.minutes:g} min; RMS after the first half minute")
    print(f"{'receiver':26} {'ours m':>9} {'told m':>9} {'ratio':>7} {'head °':>8} {'worst °':>8} {'x real':>9}")
    for name, truth in TRUTHS.items():
        for tells_sigma in (True, False):
            _row(name, truth, walks=settings.walks, minutes=settings.minutes, tells_sigma=tells_sigma)


if __name__ == "__main__":
    main()
