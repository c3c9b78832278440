#!/usr/bin/env bash
# etc/scores over its whole sweep: no recogniser finds more or less, or gives more or fewer false alarms, than tests/scores.csv says.
# labels: deep two
. "$(dirname "$0")/common.sh"
judges python3.numpy

check "no share is beyond the record" python3 etc/scores --out "$tmp/out" "$build"
column() { awk -F, -v of="$2" '$2 == "'"$1"'" && $3 == "all" { print $of }' "$tmp/out/rows.csv"; }
check "all answer as many frames" [ "$(column hottest 4)" = "$(column shape 4)" ]
check "contrast finds more than the hottest pixel" is "$(column contrast 6)" '>' "$(column hottest 6)"
check "shape has fewer false alarms than contrast" is "$(column shape 10)" '<' "$(column contrast 10)"
check "and a better average precision" is "$(column shape 15)" '>' "$(column contrast 15)"
finish
