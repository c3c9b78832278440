#!/usr/bin/env bash
# etc/scores over its small sweep: as tests/scores.csv says; a record that says otherwise fails and names the row. What the figures
# are made of: the answers of tests/system/recognisers.py's recognisers, scored by `pitviper score`, whose own tests are elsewhere.
. "$(dirname "$0")/common.sh"
judges python3.numpy

scores() { python3 etc/scores "$@" "$build" >"$tmp/stdout" 2>"$tmp/stderr"; code=$?; }
scores --sweep small --out "$tmp/out"
cat "$tmp/stdout"
check "no share is beyond the record" [ $code = 0 ] || cat "$tmp/stderr"
rows=$tmp/out/rows.csv
check "of each recogniser a row of all" [ "$(grep -cE '^small,(hottest|contrast|shape),all,4,2,' "$rows")" = 3 ]
check "every row of the record" [ "$(grep -c '^small,' "$rows")" = "$(grep -c '^small,' tests/scores.csv)" ]
# the hottest pixel always answers: as many false alarms as frames, less those that it found
check "the hottest pixel answers once a frame" eval '[ "$(awk -F, "\$2 == \"hottest\" && \$3 == \"all\" { print \$4 - \$5 * \$6 - \$4 * \$10 }" "$rows")" = 0 ]'
check "false alarms a square degree: of a field of 5.4962 by 4.1234 degrees" eval \
    'awk -F, "\$2 == \"contrast\" && \$3 == \"all\" { exit !(sqrt((\$10 / \$13 / (5.4962 * 4.1234) - 1) ^ 2) < 0.002) }" "$rows"'

# the page has the record's figures
for name in hottest contrast shape; do
    line=$(awk -F, -v n=$name '$1 == "full" && $2 == n && $3 == "all" { printf "| %s | %.2f (%.2f .. %.2f) | %.2f | %.2f (", n, $6, $7, $8, $14, $10 }' tests/scores.csv)
    check "the page's figures of $name are the record's: $line" grep -qF "$line" etc/reference/recognisers.md
done

# judged COLUMN VALUE: by a record in which that of the hottest pixel is another
judged() { awk -F, -v OFS=, -v c="$1" -v v="$2" '$1 == "small" && $2 == "hottest" && $3 == "all" { $c = v } { print }' "$rows" >"$tmp/record.csv"
    scores --sweep small --rows "$rows" --record "$tmp/record.csv"; }
judged 1 small
check "it is like itself" eval '[ $code = 0 ] && ! said "beyond|was "'
judged 7 0.95
check "fewer found than the record's interval has: a failure" eval '[ $code = 1 ] && said "hottest +all .*found is beyond the record"'
check "which says how it is renewed" complained 'etc/scores --renew'
judged 12 0.01
check "more false alarms: a failure" eval '[ $code = 1 ] && said "false_a_frame is beyond"'
judged 6 0.6
check "another share within the interval is named, and no failure" eval '[ $code = 0 ] && said "found was 0.6"'
grep -v ',hottest,all' "$rows" >"$tmp/record.csv"
scores --sweep small --rows "$rows" --record "$tmp/record.csv"
check "a row without a record: a failure" eval '[ $code = 1 ] && said "not in the record"'
(cat "$rows"; echo "small,another,all,4,2,1,1,1,,0,0,0,,,") >"$tmp/record.csv"
scores --sweep small --rows "$rows" --record "$tmp/record.csv"
check "a record that was not measured, too" eval '[ $code = 1 ] && said "another all is in the record"'
scores --rows "$rows" --record "$tmp/new.csv" --renew "it is harder"
check "a record is written, with its reason" eval '[ $code = 0 ] && grep -qx "# reason: it is harder" "$tmp/new.csv" && grep -q "^# commit: " "$tmp/new.csv"'
scores --sweep small --rows "$rows" --record "$tmp/new.csv"
check "which is read again" [ $code = 0 ]
scores --record "$tmp/none.csv"
check "no record: a failure, with the next step" eval '[ $code = 1 ] && complained "no record .*--renew"'
finish
