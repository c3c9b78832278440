#!/usr/bin/env bash
# etc/cost: small frames cost no more instructions than tests/cost.csv says; a record of less fails and names the frame, and
# what is not comparable is skipped.
. "$(dirname "$0")/common.sh"
judges valgrind

cost() { etc/cost "$@" >"$tmp/stdout" 2>"$tmp/stderr"; code=$?; }
cost --keep "$tmp/kept" "$build"
[ $code != 77 ] || skip "$(cat "$tmp/stderr")"
cat "$tmp/stdout"
check "no frame costs 3 % more than in the record" [ $code = 0 ] || cat "$tmp/stderr"
counts=$tmp/kept/counts.csv
rows=$(grep -cE '^[a-z-]+,[0-9]' "$counts")
check "every frame is counted" [ "$rows" = "$(grep -cE '^[a-z-]+,[0-9]' tests/cost.csv)" ]
check "at most 1e10 instructions in all" is "$(awk -F, '{ s += $2 } END { printf "%.0f", s }' "$counts")" '<' 1e10
check "a profile of each" [ "$(grep -l 'Client Request' "$tmp"/kept/profile.* | wc -l)" = "$rows" ]

# record FACTOR: of these counts, that of the frame `crowd` times FACTOR
record() { awk -F, -v OFS=, -v f="$1" '$1 == "crowd" { $2 = sprintf("%.0f", $2 * f) } { print }' "$counts" >"$tmp/record.csv"; }
judged() { cost --record "$tmp/record.csv" --counts "$counts" "$build"; }
record 1
judged
check "they are like themselves" [ $code = 0 ] && check "to the last instruction" [ "$(grep -c '+0.00 %' "$tmp/stdout")" = $((rows + 1)) ]
record 0.96
judged
check "a record of 4 % less: a failure" [ $code = 1 ]
check "which names the frame, alone" [ "$(grep 'beyond the record' "$tmp/stdout" | cut -d' ' -f1)" = crowd ]
check "and says how it is renewed" complained 'etc/cost --renew'
record 0.98
judged
check "2 % are none" [ $code = 0 ]
record 1.04
judged
check "4 % more: the record can be renewed" [ $code = 0 ] && check "and it is said" said '1 cheaper by more than 3 %'
sed '/^crowd,/d' "$counts" >"$tmp/record.csv"
judged
check "a frame without a record: a failure" [ $code = 1 ] && check "which is said" said '^crowd .*not in the record'
sed 's/^# compiler: .*/# compiler: another/' "$counts" >"$tmp/record.csv"
judged
check "another compiler: skipped" [ $code = 77 ] && check "and both are named" complained 'in the record: compiler: another'

cost --record "$tmp/new.csv" --counts "$counts" --renew "it draws more" "$build"
check "a record is written" [ $code = 0 ]
for line in '# reason: it draws more$' '# commit: [0-9a-f]' '# date: 20[0-9-]*$' '# compiler: ' '# embree: lib'; do
    check "with $line" grep -q "^$line" "$tmp/new.csv"
done
cost --record "$tmp/none.csv" --counts "$counts" "$build"
check "no record: a failure" [ $code = 1 ] && check "and what makes one" complained 'no record .*--renew'
cost --renew
check "no reason: a failure" [ $code = 1 ]
finish
