#!/usr/bin/env bash
# A vehicle's network of 60 thermal nodes over three hours against SciPy's Radau: every node's temperature at the end.
. "$(dirname "$0")/common.sh"

judges python3.scipy
"$build/tests/plate_vehicle" >"$tmp/vehicle.csv" || fail "Pitviper's own temperatures"
python3 tests/system/network_judge.py "$tmp/vehicle.csv" >"$tmp/judge.txt" 2>&1
check "the judge ends well" [ $? = 0 ]
cat "$tmp/judge.txt"
read -r _ worst moved <<<"$(grep '^node ' "$tmp/judge.txt")"
check "the nodes moved by more than 20 K: ${moved:-none}" is "${moved:-0}" '>' 20
check "worst node: ${worst:-none} K" is "${worst:-9}" '<' 0.01
check "heat from outside is heat stored" is "$(grep -oP '^heat \K.*' "$tmp/judge.txt")" '<' 1e-6

# its twin: the links 10 % stronger
awk -F, -v OFS=, '$1 == "link" { $4 *= 1.1 } { print }' "$tmp/vehicle.csv" >"$tmp/spoilt.csv"
read -r _ worst _ <<<"$(python3 tests/system/network_judge.py "$tmp/spoilt.csv")"
check "its twin is noticed: ${worst:-none} K" is "$worst" '>' 0.01
finish
