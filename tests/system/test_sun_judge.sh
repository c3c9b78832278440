#!/usr/bin/env bash
# The sides of a box over a clear day against plates by NumPy under pvlib's sun (Bird): how much warmer one is than the other.
. "$(dirname "$0")/common.sh"
judges python3.pvlib

cat >"$tmp/box.obj" <<'BOX'
o box
v -2 -1 0.4
v 2 -1 0.4
v -2 1 0.4
v 2 1 0.4
v -2 -1 1.9
v 2 -1 1.9
v -2 1 1.9
v 2 1 1.9
f 1 3 4
f 1 4 2
f 5 6 8
f 5 8 7
f 1 2 6
f 1 6 5
f 3 7 8
f 3 8 4
f 1 5 7
f 1 7 3
f 2 4 8
f 2 8 6
BOX
printf '%s\n' 'file: box.obj' 'axes: +x +z' 'origin: 0 0 0' 'materials: {"*": paint_olive}' 'roles: {"*": passive}' \
    'thickness_mm: {"*": 10}' >"$tmp/box.yaml"
run heat "$tmp/box.yaml" --at 45 0 --day 2026-06-21 --heading 270 -o "$tmp/box"
check "heat: exit code" [ $code = 0 ]

# judge SPOILT: hours, ours, the judge's, of the rear (east) less the front (west); SPOILT: a factor on the front's column
judge() {
    awk -F, -v OFS=, -v by="$1" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == "box_front") c = i }
                                 NR > 1 { $c = 288 + by * ($c - 288) } { print }' "$tmp/box/nodes.csv" >"$tmp/nodes.csv"
    python3 tests/system/sun_judge.py "$tmp/nodes.csv" 90:box_rear 270:box_front
}
worst() {
    awk '{ miss = $2 > $3 ? $2 - $3 : $3 - $2; if (miss > worst) worst = miss } END { print NR == 6 ? worst : "none" }' "$1"
}
judge 1 >"$tmp/judge.txt"
cat "$tmp/judge.txt"
check "the sun warms a side by more than 10 K" awk '$3 > 10 { found = 1 } END { exit !found }' "$tmp/judge.txt"
check "worst hour: $(worst "$tmp/judge.txt") K" is "$(worst "$tmp/judge.txt")" '<' 1
judge 0.8 >"$tmp/twin.txt" # its twin
check "its twin is noticed: $(worst "$tmp/twin.txt") K" is "$(worst "$tmp/twin.txt")" '>' 1
finish
