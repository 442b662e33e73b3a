"""Install the library alone, with the oldest or newest packages that it allows, and test it there.

python tests/library_environments.py [oldest] [newest] [--python VERSION]

Each environment is a temporary folder. It has the wheel, its nine dependencies and pytest.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path
from zipfile import ZipFile

PROJECT = Path(__file__).resolve().parents[1]
RESOLUTIONS = {"oldest": "lowest-direct", "newest": "highest"}
# Tests that need nothing but the library.
TESTS = (
    "docs/test_readme.py",
    "unit/test_docstring_examples.py",
    "unit/test_sweeps.py",
    "unit/test_transitions.py",
    "theory_front_law/test_front_speed.py",
)


def build_wheel(folder: Path) -> Path:
    """Build the wheel into a folder, and check that it has the library alone and its types."""
    command = [sys.executable, "-m", "flit_core.wheel", "--outdir", str(folder), str(PROJECT)]
    subprocess.run(command, check=True)
    [wheel] = folder.glob("*.whl")
    names = ZipFile(wheel).namelist()
    folders = {name.partition("/")[0] for name in names}
    # The metadata of the package are in a folder with its version after a dash.
    packages = {folder.partition("-")[0] for folder in folders}
    if packages != {"slippulse"} or "slippulse/py.typed" not in names:
        raise SystemExit(f"{wheel.name}: {sorted(packages)}; allowed: slippulse alone, with types")
    return wheel


def run_tests(packages: str, wheel: Path, folder: Path, python: str) -> int:
    """Install the wheel with the oldest or newest packages, and return the exit code of pytest."""
    uv = [sys.executable, "-m", "uv"]
    environment = folder / packages
    subprocess.run([*uv, "venv", "--quiet", "--python", python, environment], check=True)
    interpreter = environment / ("Scripts" if os.name == "nt" else "bin") / "python"
    with open(PROJECT / "pyproject.toml", "rb") as file:
        needed = tomllib.load(file)["project"]["dependencies"]
    install = [*uv, "pip", "install", "--quiet", "--python", interpreter]
    install += ["--only-binary", ":all:"]
    oldest_or_newest = ["--resolution", RESOLUTIONS[packages], *needed, str(wheel)]
    subprocess.run([*install, *oldest_or_newest], check=True)
    subprocess.run([*install, "pytest"], check=True)
    print(f"Library with the {packages} packages:", flush=True)
    subprocess.run([*uv, "pip", "list", "--python", interpreter], check=True)
    tests = [str(PROJECT / "tests" / name) for name in TESTS]
    variables = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    variables["SLIPPULSE_CACHE"] = str(folder / f"cache-{packages}")
    # The fixtures of the other tests need the replication.
    options = ["-q", "--noconftest", "--disable-warnings", "-p", "no:cacheprovider"]
    options += ["-c", str(PROJECT / "pyproject.toml")]
    command = [interpreter, "-m", "pytest", *options, *tests]
    return subprocess.run(command, cwd=folder, env=variables, check=False).returncode


def main() -> int:
    """Test the environments that are named, by default both."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("packages", nargs="*", default=[*RESOLUTIONS], help="oldest, newest")
    parser.add_argument("--python", default=sys.executable, help="an interpreter or its version")
    options = parser.parse_args()
    if unknown := {*options.packages} - {*RESOLUTIONS}:
        parser.error(f"packages: {', '.join(sorted(unknown))}; allowed: {', '.join(RESOLUTIONS)}")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        wheel = build_wheel(folder)
        codes = [run_tests(one, wheel, folder, options.python) for one in options.packages]
    return max(codes)


if __name__ == "__main__":
    sys.exit(main())
