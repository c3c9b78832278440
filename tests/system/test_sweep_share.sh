#!/usr/bin/env bash
# What variants of a sweep share of the world decides no bit: each is the run of its own settings.yaml in a process of its
# own, whatever was made before it. A variant whose process is killed fails alone, and the next begins anew.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/sweep.sh"
bare=("${quick[@]}")

# Each changes one thing and comes back to it; all else: test_sweep_share_deep.sh.
cat >"$tmp/share.yaml" <<'Y'
mode: zip
axes:
  exercise.aim:           ["1:3001:11", "1:3001:21", "1:3001:11", "1:3001:11"]
  detector.netd_lwir_k:   [0.05, 0.05, 0.3, 0.05]
  exercise.local_solar:   [2026-06-21T10:00:00, 2026-06-21T10:00:00, 2026-06-21T10:00:00, 2026-06-21T04:30:00]
  exercise.host:          observer
Y
sweep "$tmp/share.yaml" "$tmp/s" --from 1364 --to 1364
check "all are made" [ "$code $(statuses "$tmp/s")" = '0  4 "status":"made" ' ]
compare "$tmp/s" 4

# killed in the middle: it fails alone
printf 'axes: {detector.netd_lwir_k: [0.1, 0.2, 0.3]}\n' >"$tmp/three.yaml"
"$pitviper" replay "${bare[@]}" "$tmp/demo.pcap" "${few[@]}" --rate 10 --to 1369 --sweep "$tmp/three.yaml" --out "$tmp/k" >"$tmp/stdout" 2>"$tmp/stderr" &
sweep=$!
first() { [ -n "$(find "$tmp/k" -path '*/frames/lwir/*' 2>/dev/null | head -n 1)" ]; }
until_true first
kill -KILL "$(pgrep -P $sweep)"
wait $sweep
check "killed: exit code" [ $? = 1 ]
check "killed: the others are made" [ "$(statuses "$tmp/k")" = ' 1 "status":"failed" 2 "status":"made" ' ]
check "killed: said so" grep -q 'variant 1, .*: ended by a signal' "$tmp/stderr"
sweep "$tmp/three.yaml" "$tmp/k" --rate 10 --to 1369
check "killed: made when asked again" [ "$(statuses "$tmp/k")" = ' 2 "status":"kept" 1 "status":"made" ' ]

finish
