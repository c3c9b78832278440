#!/usr/bin/env bash
# A live node for ten minutes, held up now and then: its memory in the last five minutes is no more than that of the five
# before and 4 %, for frames that show more take up to some MB more: a loss of 4 kB a frame is seen. What grows until it is
# full, and is bounded, is full by then: tracks (32768), which it begins with, and sources of dust (16384), a report of a
# vehicle each. labels: deep
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
needs "/proc/PID/status" test -r /proc/self/status

# tanks that drive round for ever, over their own tracks
cat >"$tmp/scene.yaml" <<'Y'
duration_s: 900
dis: {heartbeat_s: 0.15, bundle: true}
vehicles:
  - {name: Tank, id: 11, type: tank, force: 2, count: 12, columns: 4, column_m: 20, spacing_m: 20, loop: true, route_m: [[0, 0], [0, 200], [60, 200], [60, 0]], speed_mps: 6, turret: swing}
Y
few=(--size 64x48 --rate 5 --bands optical,lwir --no-files --host observer --set exercise.listen_s=0.5 --set heat.marks="$tmp/marks.csv")

# tracks of half a minute, which the node saves, side by side until there are as many as it keeps
free_port
node short --address 127.0.0.1 --port $port "${few[@]}"
check "it listens" heard_by short 'listening on'
sender "$tmp/scene.yaml" --send 127.0.0.1:$port
check "it makes frames" makes short 100
stop short
end_sender
check "told to stop: ends well" [ $code = 0 ]
mv "$tmp/marks.csv" "$tmp/some.csv"
awk -F, -v OFS=, '/^track/ { row[n++] = $0; next }
    { print }
    END { for (i = 0; i < 32768 && n > 0; i++) { $0 = row[i % n]; aside = 300 + 60 * int(i / n)
          $5 = sprintf("%.6f", $5 + aside); $8 = sprintf("%.6f", $8 + aside); print } }' "$tmp/some.csv" >"$tmp/marks.csv"
check "tracks to begin with" [ "$(grep -c ^track "$tmp/marks.csv")" = 32768 ]

free_port
node long --address 127.0.0.1 --port $port "${few[@]}" --record "$tmp/long.pcapng"
check "it listens" heard_by long 'listening on'
sender "$tmp/scene.yaml" --send 127.0.0.1:$port
check "it makes frames" makes long 1
resident() { awk '/^RssAnon/ { print $2 }' "/proc/${node[long]}/status"; } # KiB; pages of files come and go as the machine likes
most=(0 0) # of each half, KiB
curve=()
for ((tick = 0; tick < 60; tick++)); do
    sleep 10
    runs long || break
    if [ $((tick % 6)) = 5 ]; then kill -STOP "${node[long]}"; sleep 0.5; kill -CONT "${node[long]}"; fi
    now=$(resident)
    [ "$now" -le "${most[$((tick / 30))]}" ] || most[$((tick / 30))]=$now
    curve+=($now)
done
check "it ran for ten minutes" runs long
made=$(lines_in "$tmp/long/truth.jsonl")
stop long
end_sender
check "told to stop: ends well" [ $code = 0 ]
tail -n 4 "$tmp/long.out"
echo "KiB, every ten seconds: ${curve[*]}"
echo "$made frames; at most ${most[0]} KiB in the first five minutes, ${most[1]} KiB in the last"
check "hundreds of frames" [ "$made" -ge 500 ]
check "flat in memory" [ "${most[0]}" -gt 0 -a "${most[1]}" -le $((most[0] * 104 / 100)) ]
[ "$failures" = 0 ] || tail -n 20 "$tmp/long.out"
finish
