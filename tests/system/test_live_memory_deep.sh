#!/usr/bin/env bash
# A live node for ten minutes, held up now and then: its memory in the last five
# minutes is no more than that of the five before and 8 MB. labels: deep
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
needs "/proc/PID/status" test -r /proc/self/status

# tanks that drive round for ever, over their own tracks
cat >"$tmp/scene.yaml" <<'Y'
duration_s: 900
dis: {heartbeat_s: 2, bundle: true}
vehicles:
  - {name: Tank, id: 11, type: tank, force: 2, count: 12, columns: 4, column_m: 20, spacing_m: 20, loop: true, route_m: [[0, 0], [0, 200], [60, 200], [60, 0]], speed_mps: 6, turret: swing}
Y
few=(--size 64x48 --rate 5 --bands optical,lwir --no-files --host observer --set exercise.listen_s=0.5)
free_port
node long --address 127.0.0.1 --port $port "${few[@]}" --record "$tmp/long.pcapng"
check "it listens" heard_by long 'listening on'
sender "$tmp/scene.yaml" --send 127.0.0.1:$port
check "it makes frames" makes long 1
resident() { awk '/^VmRSS/ { print $2 }' "/proc/${node[long]}/status"; } # KiB
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
check "flat in memory" [ "${most[0]}" -gt 0 -a "${most[1]}" -le $((most[0] + 8192)) ]
[ "$failures" = 0 ] || tail -n 20 "$tmp/long.out"
finish
