#!/usr/bin/env bash
# Light among plants against Mitsuba 3: the same trees, leaf spectra, sun and rays. First order, block by block: the lit crown
# and the shaded ground. All orders, which Pitviper has in closed form (render/light/canopy.h): the mean of the leaves. A stand
# of trees: test_plants_judge_deep.sh.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/plants.sh"

judged oak 44.6 4 2
judged pine 20 4 2

# its twin: leaves a tenth brighter in one band
awk '$1 == "material" && $3 == 1 { $4 *= 1.1 } { print }' "$tmp/oak/scene.txt" >"$tmp/scene.txt"
mv "$tmp/scene.txt" "$tmp/oak/scene.txt"
read -r _ _ percent <<<"$(python3 tests/system/plants_judge.py "$tmp/oak" 0)"
check "its twin is noticed: ${percent:-none} %" is "$percent" '>' 2
finish
