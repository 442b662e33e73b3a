#!/bin/sh
# Run the tests of the library on other interpreters of Python, each in a temporary environment:
#
#     tests/interpreters.sh                                    python3.12 and python3.13 of the path
#     tests/interpreters.sh python3.13 some/folder/python3.12  these
#
# An interpreter needs not be at hand to know whether the lock can be installed for it, so that is
# checked for 3.11 to 3.14: every package has a wheel, or may be built from source.
set -u
cd "$(dirname "$0")/.." || exit 1
python=$PWD/.venv/bin/python
[ -x "$python" ] || { echo "No environment here: make setup" >&2; exit 1; }
[ $# -gt 0 ] || set -- python3.12 python3.13

failed=0
for interpreter in "$@"; do
    path=$(command -v "$interpreter") || {
        echo "$interpreter: not found; allowed: the name or path of an interpreter" >&2
        failed=1
        continue
    }
    # Pyenv has a command for each version, also for those that it does not run in this folder.
    version=$("$path" --version 2>&1) || {
        echo "$path: $version" >&2
        failed=1
        continue
    }
    echo "== $version"
    "$python" tests/library_environments.py newest --python "$path" || failed=1
done

for version in 3.11 3.12 3.13 3.14; do
    sources="--no-binary connection-pool"
    # On 3.14 the set-up also builds immutables, which needs a compiler of C.
    [ "$version" != 3.14 ] || sources="$sources --no-binary immutables"
    # shellcheck disable=SC2086
    if "$python" -m uv pip install --dry-run --quiet --no-deps --require-hashes --python-version "$version" \
        --target "${TMPDIR:-/tmp}/nowhere" --only-binary :all: $sources -r requirements.lock; then
        echo "Python $version: requirements.lock can be installed"
    else
        echo "Python $version: requirements.lock cannot be installed" >&2
        failed=1
    fi
done
exit $failed
