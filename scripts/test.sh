#!/usr/bin/env bash
# Checks everything: lint, format, types, all tests, on all processors.
#
#   ./scripts/test.sh                        everything
#   ./scripts/test.sh --quick                in a minute: no ROS, so no compiler; no Monte Carlo runs;
#                                            types of the package, not of its tests
#   ./scripts/test.sh tests/passive -k past  arguments go to pytest; -n 0 keeps to one process
set -euo pipefail
project="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)"
source "$project/scripts/set_up.sh"

# Every test of a command starts processes: none of them should compile all files once more.
unset PYTHONDONTWRITEBYTECODE

kind=test
selection=()
typed=()
if [[ "${1:-}" == "--quick" ]]; then
    shift
    kind=quick
    selection=(-m "not graph and not system and not slow and not data")
    typed=(src)
fi
set_up "$kind"
cd "$project"

workers="$(nproc)"
if [[ "$kind" == test ]]; then
    workers=$((workers * 2)) # what a graph leaves of the processors, others use
    workers=$((workers < 50 ? workers : 50)) # each has a ROS domain, of 101
fi
failed=()
check() { # NAME COMMAND...: run one check; the others run even if it fails
    local name="$1"
    shift
    echo "== $name" >&2
    "$@" || failed+=("$name")
}

types_found() { # what the types, checked beside the tests, have come to
    local code=0
    wait "$types" || code=$?
    cat "$types_output" >&2
    return "$code"
}

check lint .venv/bin/ruff check .
check format .venv/bin/ruff format --check .
if [[ -d .venv/lib/python3.10 ]]; then
    echo "== types are checked with Python 3.11 or newer: the last numpy for 3.10 types less" >&2
else
    types_output="$(mktemp)"
    .venv/bin/python scripts/check_types.py "${typed[@]}" >"$types_output" 2>&1 &
    types=$!
    trap 'kill "$types" 2>/dev/null || true; rm -f "$types_output"' EXIT
fi
if [[ $# == 0 && ! -d tests/__pycache__ ]]; then
    # Or every worker would compile all tests; one that cannot be read is told of below.
    each="$(($(find tests -name "test_*.py" | wc -l) / $(nproc) + 1))"
    find tests -name "test_*.py" -print0 | xargs -0 -n "$each" -P "$(nproc)" \
        .venv/bin/python -m pytest --collect-only -q >/dev/null 2>&1 || true
fi
check tests .venv/bin/python -m pytest -n "$workers" "${selection[@]}" "$@"
if [[ -n "${types:-}" ]]; then
    check types types_found
fi

if ((${#failed[@]})); then
    echo "Failed: ${failed[*]}." >&2
    exit 1
fi
echo "Lint, format, types and ${selection[0]:+quick }tests passed." >&2
