"""How long worlds take to generate, and where the time goes.

Run: ``python benchmarks/bench_generator.py [--profile]``. Times are seconds of processor time of one process, so that
what else runs disturbs them little; "cold" includes the imports. Each warm figure is the best and the median of five
seeds. Aims: 1 km² in 1 s, 400 m in 0.35 s warm and 0.5 s cold.
"""

import argparse
import cProfile
import itertools
import pstats
import statistics
import time

SIZES_M = (400.0, 1000.0)


def main() -> None:
    parser = argparse.ArgumentParser(description="Time the world generator.")
    parser.add_argument("--profile", action="store_true", help="also print where the time of a 1 km² town goes")
    arguments = parser.parse_args()

    start = time.process_time()
    from reasoned_explorer.world.generator import DISTRICTS, generate_world

    world = generate_world("park", seed=0)
    print(f"park, 400 m, cold: {time.process_time() - start:.2f} s, {len(world.objects)} objects")
    for size_m, district in itertools.product(SIZES_M, DISTRICTS):
        taken, number = [], 0
        for seed in range(1, 6):
            start = time.process_time()
            number = len(generate_world(district, seed=seed, size_m=size_m).objects)
            taken.append(time.process_time() - start)
        best, median = min(taken), statistics.median(taken)
        print(f"{district}, {size_m:g} m: best {best:.2f} s, median {median:.2f} s, {number} objects")
    if arguments.profile:
        profile = cProfile.Profile()
        profile.runcall(generate_world, "town", seed=1, size_m=1000.0)
        pstats.Stats(profile).sort_stats("cumulative").print_stats(30)


if __name__ == "__main__":
    main()
