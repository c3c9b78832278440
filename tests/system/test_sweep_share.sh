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
  observer.range_m:       [300, 300, 700, 300]
  detector.netd_lwir_k:   [0.05, 0.05, 0.3, 0.05]
  exercise.local_solar:   [2026-06-21T10:00:00, 2026-06-21T10:00:00, 2026-06-21T10:00:00, 2026-06-21T04:30:00]
  exercise.host:          observer
Y
sweep "$tmp/share.yaml" "$tmp/s" --from 1364 --to 1364
check "all are made" [ "$code $(statuses "$tmp/s")" = '0  4 "status":"made" ' ]
compare "$tmp/s" 4

# aim, range and detector change no layer of the world: it is the exercise's
printf 'mode: zip\naxes: {exercise.host: observer, exercise.aim: ["1:3001:11", "1:3001:22", "1:3001:13"], observer.range_m: [300, 900, 600], detector.netd_lwir_k: [0.05, 0.1, 0.3]}\n' >"$tmp/aims.yaml"
sweep "$tmp/aims.yaml" "$tmp/a" --from 1364 --to 1364 --verbose
layers() { for folder in $(grep -oE 'v[0-9a-f]{10}' "$1/manifest.jsonl" | uniq); do grep -cE 'world: [a-z]+ made$' "$1/$folder/log.txt"; done | tr '\n' ' '; }
check "aim, range, detector: layers of the world that each variant makes" [ "$(layers "$tmp/a")" = '9 0 0 ' ]

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
