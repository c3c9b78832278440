#!/usr/bin/env bash
# Buildings and clutter are a layer of the made world: variants of a sweep take it over, and make it again when the seed or
# their settings change; each has the bits of a run alone. A live node's frames with them are those of its replay.
. "$(dirname "$0")/common.sh"
bare=("${built[@]}")
. "$(dirname "$0")/live.sh"
regress_case village
quick=("${case_options[@]}" --set heat.facets=3 --set heat.step_s=3600 --set heat.shadow_m=64 --set terrain.detail=off
    --bands lwir --size 32x24 --threads 1)

# ---- variants --------------------------------------------------------------------------------------
cat >"$tmp/axes.yaml" <<'Y'
mode: zip
axes:
  observer.range_m:  [60, 90, 60, 60, 60, 60]
  seed:              [6, 6, 9, 6, 6, 6]
  terrain.buildings: [invented, invented, invented, "off", invented, invented]
  terrain.clutter:   [1, 1, 1, 1, 0, 1]
  detector.netd_lwir_k: [0.05, 0.05, 0.05, 0.05, 0.05, 0.04]
Y
run replay "$tmp/village.pcap" "${quick[@]}" --only 0 --sweep "$tmp/axes.yaml" --out "$tmp/s" --verbose
check "all are made" [ "$code $(grep -c '"status":"made"' "$tmp/s/manifest.jsonl")" = '0 6' ]
folders=($(grep -oE '"folder":"v[0-9a-f]{10}"' "$tmp/s/manifest.jsonl" | cut -d'"' -f4))
check "six folders" [ ${#folders[@]} = 6 ]
made=
for folder in "${folders[@]}"; do
    made+="$(grep -cE 'world: culture made$' "$tmp/s/$folder/log.txt") "
    "$pitviper" replay "$tmp/village.pcap" -c "$tmp/s/$folder/settings.yaml" --threads 2 --only 0 --out "$tmp/alone" --overwrite \
        >"$tmp/stdout" 2>"$tmp/stderr"
    check "$folder: the bits of a run alone" same_hashes "$tmp/alone" "$tmp/s/$folder"
    check "$folder: its truth" cmp -s "$tmp/alone/truth.jsonl" "$tmp/s/$folder/truth.jsonl"
    check "$folder: its choices" [ "$(grep -hE '^(buildings|clutter): [0-9]' "$tmp/stdout")" = \
        "$(grep -hE '^(buildings|clutter): [0-9]' "$tmp/s/$folder/log.txt")" ]
done
check "made anew for another seed, other buildings, other clutter, and back; not for another range: $made" \
    [ "$made" = '1 0 1 1 1 1 ' ]
hash_of() { hashes "$tmp/s/${folders[$1]}"; }
check "the first and the last are one scene" [ "$(hash_of 0)" = "$(hash_of 5)" ]
check "all others are others" [ "$(for k in 0 1 2 3 4; do hash_of $k; done | sort -u | wc -l)" = 5 ]

# ---- live ------------------------------------------------------------------------------------------
look=("${quick[@]}" --host observer --set exercise.aim=1:3001:11 --set exercise.listen_s=0.5 --no-files)
free_port
node live --address 127.0.0.1 --port $port --record "$tmp/live.pcapng" "${look[@]}"
check "it listens" heard_by live 'listening on'
sender tests/regress/village/scenario.yaml --set duration_s=900 --send 127.0.0.1:$port
check "it makes frames" makes live 3
stop live
end_sender
check "ends well" [ $code = 0 ]
check "it has buildings and clutter" grep -qE '^buildings: [1-9][0-9]* invented' "$tmp/live.out"
replay "$tmp/live.pcapng" "$tmp/live-again" --causal --port 0 --to "$(time_of "$tmp/live" '$')" --only "$(frames_of live)" "${look[@]}"
check "its recording replays" [ $code = 0 ]
check "every live frame is the replay's of that number" part_of "$tmp/live" "$tmp/live-again" 3
[ "$failures" = 0 ] || { tail -n 12 "$tmp/live.out"; tail -n 5 "$tmp/stderr"; }
finish
