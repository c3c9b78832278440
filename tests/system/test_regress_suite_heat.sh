#!/usr/bin/env bash
# As test_regress_suite.sh, of the cases that are long warmed up, a radar's, or have plants. labels: two
PITVIPER_SUITE_HEAT=yes exec bash "$(dirname "$0")/test_regress_suite.sh" "$@"
