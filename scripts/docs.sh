#!/usr/bin/env bash
# Builds the documentation into docs/_build/html, without network; a warning is an error. Arguments
# go to sphinx-build, e.g. -E to read everything anew.
set -euo pipefail
project="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)"
source "$project/scripts/set_up.sh"

set_up docs
cd "$project"
if ! .venv/bin/python -m sphinx -W --keep-going -q -b html "$@" docs docs/_build/html; then
    refuse "The documentation has errors: see the lines above, mend them and start again."
fi
echo "The documentation is in docs/_build/html/index.html." >&2
