#!/usr/bin/env bash
# Displayed colours against colour-science: 99 test surfaces of the CIE, the ColorChecker, materials, skies; and the table of
# tests/sensor/colour_spectra.h, by which test_colour pins the program itself.
. "$(dirname "$0")/common.sh"

judges python3.colour python3.prosail python3.numpy
python3 tests/system/colour_judge.py >"$tmp/judge.txt" 2>"$tmp/said.txt"
check "the judge ends well" [ $? = 0 ]
cat "$tmp/judge.txt"
check "grey stays grey" is "$(grep -oP '^sums \K.*' "$tmp/judge.txt")" '<' 1e-9
# set, how many, mean, 95th percentile: those of etc/reference/accuracy.md
while read -r what count mean p95; do
    read -r rows m p _ < <(grep -oP "^$what \K.*" "$tmp/judge.txt")
    check "$what: all $count" [ "${rows:-0}" = "$count" ]
    check "$what: mean ${m:-none}" is "${m:-9}" '<' "$mean"
    check "$what: 95th percentile ${p:-none}" is "${p:-99}" '<' "$p95"
done <<'END'
surfaces 99 4.75 9.4
checker 24 2.45 5.5
materials 7 1.52 3.35
sky 7 1.3 2.4
END
read -r rows bands lab rgb apart < <(grep -oP '^table \K.*' "$tmp/judge.txt")
check "table: every ninth surface" [ "${rows:-0}" = 11 ]
check "table: bands" is "${bands:-9}" '<' 6e-5
check "table: L* a* b*" is "${lab:-9}" '<' 6e-3
check "table: linear sRGB" is "${rgb:-9}" '<' 6e-6
check "table: CIEDE2000" is "${apart:-9}" '<' 6e-3

finish
