#!/usr/bin/env bash
# As test_mutants.sh, against the approved records of tests/regress. labels: deep two
PITVIPER_MUTANTS_APPROVED=yes exec bash "$(dirname "$0")/test_mutants.sh" "$@"
