#!/usr/bin/env bash
# The unlit sides of a painted box over grass against Mitsuba 3: the same sky by direction, sun, ground and paint. More suns, airs and
# grounds: test_faces_judge_deep.sh.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/faces.sh"

faces nir us1976 23 45 0.4 grass_green glossy

# its twin: the ground a third brighter
awk '$1 == "channel" { $8 *= 1.33 } { print }' "$tmp/faces/scene.txt" >"$tmp/scene.txt"
mv "$tmp/scene.txt" "$tmp/faces/scene.txt"
worst=$(python3 tests/system/faces_judge.py "$tmp/faces" 1 | awk '{ if (-$9 > worst) worst = -$9 } END { print worst }')
check "its twin is noticed: ${worst:-none} %" is "$worst" '>' 5
finish
