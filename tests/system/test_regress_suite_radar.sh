#!/usr/bin/env bash
# As test_regress_suite.sh, of the cases that are a radar's, have plants, or are of another simulator. labels: two
PITVIPER_SUITE_PART=radar exec bash "$(dirname "$0")/test_regress_suite.sh" "$@"
