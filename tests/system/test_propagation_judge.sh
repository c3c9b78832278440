#!/usr/bin/env bash
# Radio waves in gases, rain and cloud against ITU-Rpy: what is taken per km, in airs hot and cold, wet and dry.
. "$(dirname "$0")/common.sh"

judges python3.itur
judge=tests/system/propagation_judge.py
python3 $judge rows >"$tmp/rows.csv" 2>"$tmp/stderr"
check "the judge asks" [ $? = 0 ]
"$pitviper" probe propagation <"$tmp/rows.csv" >"$tmp/answers.csv" 2>"$tmp/stderr"
check "the probe answers" [ $? = 0 ]
python3 $judge judge <"$tmp/answers.csv" >"$tmp/judge.txt" 2>&1
check "the judge ends well" [ $? = 0 ]
cat "$tmp/judge.txt"
check "96 rows" [ "$(grep -oP '^rows \K.*' "$tmp/judge.txt")" = 96 ]
for what in gas rain cloud; do
    worst=$(grep -oP "^$what \K.*" "$tmp/judge.txt")
    check "$what: ${worst:-none}" is "${worst:-9}" '<' 1e-12 # the same formulae in doubles, summed in another order
done
# its dry air has the pressure of all air, 1 % more than ours; it goes beyond 20 km, 0.3 %; and bends
worst=$(grep -oP '^space \K.*' "$tmp/judge.txt")
check "from the ground to space: ${worst:-none}" is "${worst:-9}" '<' 0.02

# its twin: one of the dry air's values 1e-9 more
awk -F, -v OFS=, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == "dry_db_km") c = i } NR == 9 { $c = sprintf("%.17g", $c * (1 + 1e-9)) } { print }' \
    "$tmp/answers.csv" >"$tmp/spoilt.csv"
worst=$(python3 $judge judge <"$tmp/spoilt.csv" | grep -oP '^gas \K.*')
check "its twin is noticed: ${worst:-none}" is "$worst" '>' 1e-10
finish
