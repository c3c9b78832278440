#!/usr/bin/env bash
# Which folder may include which, no circle of includes, and first lines that say what a file is.
cd "$(dirname "$0")/../.." && exec python3 tests/layers/layers.py .
