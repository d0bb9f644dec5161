#!/usr/bin/env bash
# Checks everything: lint, format, types, all tests. Arguments go to pytest and replace its
# default, all tests: ./scripts/test.sh tests/passive -k past
set -euo pipefail
project="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)"
source "$project/scripts/set_up.sh"

set_up test
cd "$project"
failed=()
check() { # NAME COMMAND...: run one check; the others run even if it fails
    local name="$1"
    shift
    echo "== $name" >&2
    "$@" || failed+=("$name")
}

check lint .venv/bin/ruff check .
check format .venv/bin/ruff format --check .
if [[ -d .venv/lib/python3.10 ]]; then
    echo "== types are checked with Python 3.11 or newer: the last numpy for 3.10 types less" >&2
else
    check types .venv/bin/mypy
fi
check tests .venv/bin/python -m pytest "$@"

if ((${#failed[@]})); then
    echo "Failed: ${failed[*]}." >&2
    exit 1
fi
echo "Lint, format, types and tests passed." >&2
