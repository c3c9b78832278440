#!/usr/bin/env bash
# As test_regress_suite.sh, of the cases that are long warmed up. labels: two
PITVIPER_SUITE_PART=heat exec bash "$(dirname "$0")/test_regress_suite.sh" "$@"
