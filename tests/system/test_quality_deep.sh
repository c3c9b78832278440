#!/usr/bin/env bash
# The table that quality.* picks from, measured twice: the same errors to the digit, on one processor and on all; no time
# is judged. labels: deep
. "$(dirname "$0")/common.sh"

run bench quality --quick --table "$tmp/q1.csv"
check "a table" [ "$code" = 0 ]
# frames of the errors are by as many threads as there are processors
pitviper_on_one() { taskset -c 0 "$pitviper" "$@" >"$tmp/stdout" 2>"$tmp/stderr"; code=$?; }
pitviper_on_one bench quality --quick --table "$tmp/q2.csv"
check "a table again" [ "$code" = 0 ]
measured() { grep -E '^(bare|woods),' "$1" | cut -d, -f1-9 | sort; }
# rows that a time leaves out of one of them are not compared
check "a table with rows of both scenes" [ "$(grep -c '^bare,' "$tmp/q1.csv")" -ge 8 -a "$(grep -c '^woods,' "$tmp/q1.csv")" -ge 5 ]
check "the quickest on bare ground first" grep -q '^bare,1,0,0,' <(grep -m 1 -E '^(bare|woods),' "$tmp/q1.csv")
check "in woods one ray errs more in red light" [ "$(cut -d, -f5 <(grep '^woods,1,0,0,' "$tmp/q1.csv") | cut -d. -f1)" -gt \
    "$(cut -d, -f5 <(grep '^bare,1,0,0,' "$tmp/q1.csv") | cut -d. -f1)" ]
check "the same errors" [ -z "$(comm -3 <(measured "$tmp/q1.csv") <(measured "$tmp/q2.csv") |
    cut -d, -f1-4 | tr -d '\t' | sort | uniq -d)" ]
check "rows in both" [ "$(comm -12 <(measured "$tmp/q1.csv") <(measured "$tmp/q2.csv") | wc -l)" -ge 4 ]
finish
