#!/usr/bin/env bash
# labels: deep
# What variants of a sweep share of the world decides no bit, by axis; test_sweep_share.sh has the quick ones. A hundred
# variants need no more memory than ten.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/sweep.sh"
bare=("${quick[@]}")

# Each changes one thing and comes back to it; the last two have woods, within 60 m of the aim.
cat >"$tmp/share.yaml" <<'Y'
mode: zip
axes:
  exercise.aim:           ["1:3001:11", "1:3001:21", "1:3001:11", "1:3001:11", "1:3001:11", "1:3001:11", "1:3001:11", "1:3001:11", "1:3001:11", "1:3001:21"]
  observer.range_m:       [300, 300, 900, 300, 300, 300, 300, 300, 300, 300]
  detector.netd_lwir_k:   [0.05, 0.05, 0.05, 0.3, 0.05, 0.05, 0.05, 0.05, 0.05, 0.05]
  exercise.local_solar:   [2026-06-21T10:00:00, 2026-06-21T10:00:00, 2026-06-21T10:00:00, 2026-06-21T10:00:00, 2026-06-21T04:30:00, 2026-06-21T10:00:00, 2026-06-21T10:00:00, 2026-06-21T10:00:00, 2026-06-21T10:00:00, 2026-06-21T10:00:00]
  weather.visibility_m:   [23000, 23000, 23000, 23000, 23000, 5000, 23000, 23000, 23000, 23000]
  weather.cloud:          [0, 0, 0, 0, 0, 0, 0.8, 0, 0, 0]
  seed:                   [1, 1, 1, 1, 1, 1, 1, 2, 1, 1]
  terrain.woods:          ["off", "off", "off", "off", "off", "off", "off", "off", "on", "on"]
  terrain.woods_half_m:   60
  exercise.host:          observer
Y
sweep "$tmp/share.yaml" "$tmp/s" --bands lwir,mwir --from 1364 --to 1364
check "all are made" [ "$code $(statuses "$tmp/s")" = '0  10 "status":"made" ' ]
compare "$tmp/s" 10

# memory of the process that makes them, KiB, when 40 are made and when 100 are
printf 'mode: random\ncount: 110\naxes: {observer.range_m: {from: 200, to: 900}, exercise.host: observer, seed: [1, 2, 3], weather.visibility_m: [5000, 23000]}\n' >"$tmp/many.yaml"
"$pitviper" replay "${bare[@]}" "$tmp/demo.pcap" "${few[@]}" --no-files --sweep "$tmp/many.yaml" --out "$tmp/m" >"$tmp/stdout" 2>"$tmp/stderr" &
sweep=$!
made() { [ "0$(grep -cs '"status":"made"' "$tmp/m/manifest.jsonl")" -ge "$1" ]; }
kib() { grep VmRSS "/proc/$(pgrep -P $sweep)/status" | tr -dc 0-9; }
until_true made 40; before=$(kib)
until_true made 100; after=$(kib)
wait $sweep
check "a hundred variants: one process makes them, in no more memory ($before, then $after KiB)" [ "$before" -gt 1024 -a "$after" -le $((before + 16384)) ]

finish
