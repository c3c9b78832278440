#!/usr/bin/env bash
# A vehicle's network of 60 thermal nodes over three hours against SciPy's Radau: every node's temperature at the end.
# labels: small
. "$(dirname "$0")/common.sh"

command -v python3 >/dev/null || { echo "skipped: no python3"; exit 77; }
"$build/tests/network_vehicle" >"$tmp/vehicle.csv" || fail "Pitviper's own temperatures"
python3 tests/system/network_judge.py "$tmp/vehicle.csv" >"$tmp/judge.txt" 2>&1
code=$?
cat "$tmp/judge.txt"
[ $code != 77 ] || exit 77
check "the judge ends well" [ $code = 0 ]
read -r _ worst moved <<<"$(grep '^node ' "$tmp/judge.txt")"
check "the nodes moved by more than 20 K: ${moved:-none}" is "${moved:-0}" '>' 20
check "worst node: ${worst:-none} K" is "${worst:-9}" '<' 0.01
check "heat from outside is heat stored" is "$(grep -oP '^heat \K.*' "$tmp/judge.txt")" '<' 1e-6
finish
