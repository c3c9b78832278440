#!/usr/bin/env bash
# Of 300 mutants of the product, drawn by a seed, nine of ten are noticed by a test (etc/mutate). labels: deep two
. "$(dirname "$0")/common.sh"
judges ninja gcov
[ -x "$build/tests/sensor_tests" ] || skip "no tests in $build"
seed=${PITVIPER_MUTATE_SEED:-1}
check "90 % of the mutants are caught" etc/mutate --build "$build" --seed "$seed" --count 300 --jobs 2 --least 90
finish
