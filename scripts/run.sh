#!/usr/bin/env bash
# Runs the pipeline: ./scripts/run.sh [ARGS] = python scripts/run_pipeline.py [ARGS] in an
# environment of its own, which the first start makes (.venv, a few minutes).
set -euo pipefail
project="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)"
source "$project/scripts/set_up.sh"

set_up run
exec "$project/.venv/bin/python" "$project/scripts/run_pipeline.py" "$@"
