#!/usr/bin/env bash
# As test_plants_judge.sh, of a stand of trees. labels: deep
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/plants.sh"

judged stand 44.6 1 4 # of the blocks' dim ones: Mitsuba starts its shadow rays up to 5 mm off, past the nearest leaves
finish
