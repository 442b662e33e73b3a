"""Speed as ratios within one run, for any machine, as `make benchmark` has it.

python -m tests.benchmark config/config.yaml results/benchmarks     measures, and writes benchmark.json there
"""

import json
import sys
import time
from pathlib import Path

from slippulse.configuration.problems import ConfigError
from slippulse.configuration.read import read_config, read_overlay
from slippulse.data.files import write_text

from . import measure


def main(config_path: str, folder: str) -> None:
    """Run every measurement and say the ratios."""
    Path(folder).mkdir(parents=True, exist_ok=True)
    config = read_config(read_overlay(config_path)).plain()
    accuracy, window = config["presets"]["paper"], config["measure"]["front_window"]
    parts = {
        "machine": measure.machine,
        "kernel": measure.kernel,
        "whole_scene": lambda: measure.whole_scene(accuracy, window),
        "exponents": lambda: measure.exponents(accuracy),
        "pipeline": lambda: measure.pipeline(Path(folder).parent),
    }
    found = {}
    for name, part in parts.items():
        began = time.perf_counter()
        found[name] = part()
        print(f"  {name}: {time.perf_counter() - began:.1f} s", file=sys.stderr, flush=True)
    output = Path(folder) / "benchmark.json"
    write_text(json.dumps(found, indent=1).replace("NaN", "null") + "\n", output)
    scene, kernel = found["whole_scene"], found["kernel"]
    for name, entry in kernel.items():
        print(
            f"{name}: {entry['block_updates_per_second']:.3g} block updates a second,"
            f" {entry['ratio_to_branch_free_order_4']:.2f} of a branch-free step of order 4,"
            f" {entry['ratio_to_branch_free_two_stage']:.2f} of a branch-free two-stage stencil"
        )
    faster = scene["times_faster_than_textbook"]
    print(
        f"whole scene: {scene['seconds']:.2f} s, front speed within {scene['front_speed_error']:.1e}; textbook scheme"
        f" at the same error, extrapolated: {faster['numba']:.3g} times as long compiled,"
        f" {faster['numpy']:.3g} in plain numpy"
    )
    print(f"twice the duration: {scene['cost_of_twice_the_duration']:.2f} times the cost; all in {output}")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        print("usage: python -m tests.benchmark CONFIGURATION FOLDER", file=sys.stderr)
        sys.exit(2)
    try:
        main(*sys.argv[1:])
    except ConfigError as error:
        sys.exit(str(error))
    except OSError as error:
        sys.exit(f"{sys.argv[2]}: {error.strerror}; allowed: a folder that can be written")
