#!/usr/bin/env bash
# As test_alloc.sh, at every place. labels: deep
PITVIPER_ALLOC_PLACES=all exec bash "$(dirname "$0")/test_alloc.sh" "$@"
