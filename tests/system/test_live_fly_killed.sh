#!/usr/bin/env bash
# `pitviper run --fly ROW --sight recogniser`, whose recogniser is killed in flight (SIGKILL): the missile coasts from then on, the
# next of the salvo flies without a sight, and flights and run end by themselves; the recording flies them again, to the same octets.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
judges python3.numpy

cat >"$tmp/road.yaml" <<'END'
duration_s: 900
dis: {heartbeat_s: 2}
vehicles:
  - {name: Truck, id: 21, type: 1.1.222.7.1.0.0, force: 2, speed_mps: 9, route_m: [[0, 0], [60, 120], [80, 6000]]}
  - {name: Heli, id: 31, type: 1.2.225.20.1.0.0, route_m: [2600, 100], height_m: 150, heading_deg: 265}
END
free_port
sender "$tmp/road.yaml" --send 127.0.0.1:$port
few=("${bare[@]}" "${coarse[@]}" --set terrain.woods=off --no-png --no-files --planes none --set exercise.listen_s=0.5 --bands lwir --set sensor.hfov_deg=3
    --set exercise.aim=1:3001:21 --fly ir_ag --set flight.from=1:3001:31 --sight recogniser --set flight.rounds=2
    --set flight.key=true)
node killed "${few[@]}" --address 127.0.0.1 --port $port --rate 10 --size 32x24 --record "$tmp/killed.pcapng" \
    --memory "pitviper_killed_$$" --set publish.memory_record=truth --set publish.detections_port=$((port + 1)) \
    --set flight.operator_port=$((port + 2))
heard_by killed 'listening on'
PITVIPER_MEMORY=pitviper_killed_$$ PITVIPER_PORT=$((port + 1)) python3 "$(dirname "$0")/../tools/loop_recogniser.py" 1:3001:21 \
    >"$tmp/recogniser.out" 2>&1 &
recogniser=$!
# launched when all is made that frames need; killed when several lines of sight are in the recording, which is written once a second
heard_by killed 'run: ready'
(echo 'aim 1 0 0 launch' >/dev/udp/127.0.0.1/$((port + 2))) 2>/dev/null
sights() { [ "$(grep -ac 'pitviper: sight ' "$tmp/killed.pcapng")" -ge 1 ] && has_lines "$tmp/killed/answers.jsonl" 5; }
check "lines of sight are taken in flight" until_of killed sights
kill -KILL "$recogniser"
check "while the first still flies" not grep -q 'ended at' "$tmp/killed.out"
wait "$recogniser" 2>/dev/null # 137
ended killed
end_sender
check "it ends by itself, with $code: $(tail -n 1 "$tmp/killed.out")" [ "$code" = 0 ]
cat "$tmp/killed/flight.csv"
column() { awk -F, -v name="$1" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) c = i } /^[0-9]/ { printf "%s ", $c }' "$tmp/killed/flight.csv"; }
read -r first second <<<"$(column guided_share)"
read -r end next <<<"$(column end)"
check "two missiles, which end in the ground or beyond: $end, $next" awk -v e="$end $next" 'BEGIN { exit !(e ~ /^(ground|passed|life) (ground|passed|life)$/) }'
check "none hits: $(column hit)" not grep -q ',entity,' "$tmp/killed/flight.csv"
check "the first was guided: $first of its steps" is "${first:-0}" '>' 0.02
check "and coasts after: $first" is "${first:-1}" '<' 0.9
check "the second coasts from the start" [ "$second" = 0.0000 ]

# by the recording's notes: no line of sight after the kill, and what guides after the last is that one alone, for the row's memory_s
memory_s=$(awk -F, '$1 == "name" { for (i = 1; i <= NF; i++) if ($i == "memory_s") c = i } $1 == "ir_ag" { print $c }' etc/missiles.csv)
python3 - "$tmp/killed.pcapng" "$tmp/killed/flight.csv" "$memory_s" >"$tmp/last" <<'END'
import csv, re, sys
taken = [float.fromhex(m.decode()) for m in re.findall(rb'pitviper: sight (?:before|after) (\S+)', open(sys.argv[1], 'rb').read())]
first, second = csv.DictReader(open(sys.argv[2]))
fire_s, flight_s = float(first['fire_s']), float(first['flight_s'])
most = (taken[-1] + float(sys.argv[3]) - fire_s + 0.02) / flight_s
print(len(taken), '%.4f' % most, '%.3f' % (fire_s + flight_s - taken[-1]))
END
read -r sights most coasted <"$tmp/last"
check "as many lines of sight as answers, at most: $sights" [ "${sights:-0}" -ge 2 -a "${sights:-99}" -le "$(lines_in "$tmp/killed/answers.jsonl")" ]
check "none in the last $coasted s of the first" is "${coasted:-0}" '>' 0.5
check "guided by them and no longer: $first, at most $most" is "${first:-1}" '<' "${most:-0}"

replay "$tmp/killed.pcapng" "$tmp/again" --causal --port 0 "${few[@]}" --rate 2 --size 32x24 --to +60
check "replays" [ "$code" = 0 ]
check "the same octets" cmp -s "$tmp/killed/flight.pcapng" "$tmp/again/flight.pcapng"
check "the same flights" cmp -s "$tmp/killed/flight.csv" "$tmp/again/flight.csv"
finish
