#!/usr/bin/env bash
# Scores of tracks against TrackEval and py-motmetrics, over random sequences: truths and tracks that come and go, overlap and swap.
. "$(dirname "$0")/common.sh"

judges python3.trackeval python3.motmetrics
judge=tests/system/tracks_judge.py
compare() { # compare JUDGE FILE: sets $worst and $sums
    python3 $judge "$1" <"$2" >"$tmp/judged" 2>&1 || { fail "$1 ends well"; tail -n 5 "$tmp/judged"; }
    worst=$(grep -oP '^worst \K.*' "$tmp/judged")
}
summed() { grep -oP "^sum $1 \K[0-9]*" "$tmp/judged"; }
equal() { awk -v worst="${1:-9}" 'BEGIN { exit !(worst <= 1e-12) }'; }

"$build/tests/track_scores" 0 300 >"$tmp/any.jsonl"
check "random sequences are scored" [ $? = 0 ]
compare trackeval "$tmp/any.jsonl"
check "TrackEval: IDF1, IDP, IDR, switches, MOTA ... are equal (${worst:-none})" equal "$worst"
for what in idtp idfp idfn switches mostly_tracked mostly_lost beside; do
    check "there was something to differ in: $what" [ "$(summed $what)" -gt 100 ]
done
"$build/tests/track_scores" 1000 40 alone >"$tmp/alone.jsonl"
compare motmetrics "$tmp/alone.jsonl"
check "py-motmetrics: IDF1, switches, fragmentations ... are equal (${worst:-none})" equal "$worst"
check "there was something to differ in: fragmentations" [ "$(summed fragmentations)" -gt 100 ]

# its twin: a switch more
head -n 9 "$tmp/any.jsonl" | sed -E '7s/"switches":([0-9]+)/"switches":1\1/' >"$tmp/spoilt.jsonl"
compare trackeval "$tmp/spoilt.jsonl"
check "its twin is noticed (${worst:-none})" not equal "$worst"
finish
