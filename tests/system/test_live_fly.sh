#!/usr/bin/env bash
# `pitviper run --fly ROW`: a node flies missiles of its own in a live exercise, by a recogniser's answers that come when they
# come; the recording flies them again, to the same octets and frames, whatever frames are rendered. The octets
# are read by a program of the standard alone: Fire, Entity States within the thresholds, Detonation.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
judges python3.numpy

cat >"$tmp/road.yaml" <<'END'
duration_s: 900
dis: {heartbeat_s: 2}
vehicles:
  - {name: Truck, id: 21, type: 1.1.222.7.1.0.0, force: 2, speed_mps: 3, route_m: [[0, 0], [60, 120], [80, 3000]]}
  - {name: Heli, id: 31, type: 1.2.225.20.1.0.0, route_m: [1300, 100], height_m: 90, heading_deg: 265}
END
free_port
sender "$tmp/road.yaml" --send 127.0.0.1:$port
few=("${bare[@]}" --set terrain.woods=off --no-png --no-files --planes none --set exercise.listen_s=0.5 --bands lwir --set sensor.hfov_deg=3 --set exercise.aim=1:3001:21)
fly=(--fly ir_ag --set flight.from=1:3001:31)
at=(--address 127.0.0.1 --port $port --rate 10 --size 96x64)
node known "${few[@]}" "${fly[@]}" "${at[@]}" --record "$tmp/known.pcapng" --sight recogniser --set flight.rounds=2 \
    --memory "pitviper_live_fly_$$" --set publish.memory_record=truth --set publish.detections_port=$((port + 1))
heard_by known 'listening on'
PITVIPER_MEMORY=pitviper_live_fly_$$ PITVIPER_PORT=$((port + 1)) python3 "$(dirname "$0")/../tools/loop_recogniser.py" 1:3001:21 \
    >"$tmp/recogniser.out" 2>&1 &
recogniser=$!
ended known
check "it ends by itself when its missiles have: $(tail -n 1 "$tmp/known.out")" [ "$code" = 0 ]
kill "$recogniser" 2>/dev/null; wait "$recogniser" 2>/dev/null
check "two missiles" [ "$(lines_in "$tmp/known/flight.csv")" = 3 ]
cat "$tmp/known/flight.csv"
check "that were guided by answers" awk -F, 'NR > 1 { sum += $11 } END { exit !(sum > 0.05) }' "$tmp/known/flight.csv"

# ---- again, from the recording alone
again() { # NAME options
    local name=$1; shift
    replay "$tmp/known.pcapng" "$tmp/$name" --causal --port 0 "${few[@]}" "${fly[@]}" --sight recogniser --set flight.rounds=2 "$@"
    check "$name: replays" [ "$code" = 0 ]
    check "$name: the same octets" cmp -s "$tmp/known/flight.pcapng" "$tmp/$name/flight.pcapng"
    check "$name: the same flights" cmp -s "$tmp/known/flight.csv" "$tmp/$name/flight.csv"
}
again alike --rate 10 --size 96x64 --threads 1 --memory "pitviper_live_fly_$$" --set publish.memory_record=truth
check "alike: the same frames" part_of "$tmp/known" "$tmp/alike" 10
again few --rate 2 --size 32x24 --threads 2 --to +60 # a frame after the end, too
check "few: other frames" [ "$(numbered "$tmp/few" | wc -l)" -lt "$(numbered "$tmp/alike" | wc -l)" ]
# the twin: the same recording without one of its sights is another flight
python3 - "$tmp/known.pcapng" "$tmp/lacks.pcapng" <<'END'
import sys
data = bytearray(open(sys.argv[1], 'rb').read())
sights = []
at = data.find(b'pitviper: sight ')
while at >= 0:
    sights.append(at)
    at = data.find(b'pitviper: sight ', at + 1)
for at in sights[len(sights) // 4:3 * len(sights) // 4]:
    data[at:at + 9] = b'otherwise'
open(sys.argv[2], 'wb').write(data)
END
replay "$tmp/lacks.pcapng" "$tmp/lacks" --causal --port 0 "${few[@]}" "${fly[@]}" --sight recogniser --set flight.rounds=2 --rate 2 --size 32x24
check "lacks: flies" [ "$code" = 0 ]
check "lacks: another flight" not cmp -s "$tmp/known/flight.csv" "$tmp/lacks/flight.csv"

# ---- what went out: as it was heard, and as a receiver believes it
python3 "$(dirname "$0")/../tools/flight_octets.py" "$tmp/known.pcapng" "$tmp/known/flight.pcapng" "$tmp/alike/truth.jsonl" 4711:1:1 0.5 >"$tmp/octets"
code=$?
check "what was heard of it is what it sent, and its reports are within the threshold: $(paste -sd' ' "$tmp/octets")" [ "$code" = 0 ]

end_sender
finish
