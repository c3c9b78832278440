#!/usr/bin/env bash
# A live flight with all its threads: the socket's, the pool's, the writer's, a recogniser's answers, which fall into the loop while
# the missile flies, an operator's key. Under the thread sanitizer any race ends it with 66. labels: small threads
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
judges python3.numpy

cat >"$tmp/road.yaml" <<'END'
duration_s: 900
dis: {heartbeat_s: 2}
vehicles:
  - {name: Truck, id: 21, type: 1.1.222.7.1.0.0, force: 2, speed_mps: 3, route_m: [[0, 0], [60, 120], [80, 3000]]}
  - {name: Heli, id: 31, type: 1.2.225.20.1.0.0, route_m: [2500, 100], height_m: 90, heading_deg: 265}
END
free_port
sender "$tmp/road.yaml" --send 127.0.0.1:$port
node loop "${bare[@]}" "${coarse[@]}" --set terrain.woods=off --no-png --planes none --set exercise.listen_s=0.3 --set sensor.hfov_deg=3 \
    --address 127.0.0.1 --port $port --rate 4 --size 24x16 --bands lwir --threads 3 --record "$tmp/loop.pcapng" \
    --fly at_loft --set flight.from=1:3001:31 --set exercise.aim=1:3001:21 --sight recogniser --set flight.rounds=2 \
    --set flight.key=true --set flight.operator_port=$((port + 2)) \
    --memory "pitviper_threads_$$" --set publish.memory_record=truth --set publish.detections_port=$((port + 1))
heard_by loop 'listening on'
PITVIPER_MEMORY=pitviper_threads_$$ PITVIPER_PORT=$((port + 1)) python3 "$(dirname "$0")/../tools/loop_recogniser.py" 1:3001:21 \
    >"$tmp/recogniser.out" 2>&1 &
recogniser=$!
heard_by loop 'run: ready'
# answers to frames that there are not, as fast as they go, and the key, until the run ends
python3 - $((port + 1)) $((port + 2)) "${node[loop]}" <<'END' &
import os, socket, sys, time
answers, key, node = map(int, sys.argv[1:])
to = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
number = 0
while os.path.exists(f'/proc/{node}'):
    to.sendto(b'{"frame": %d, "band": "lwir", "detections": []}' % (500000 + number % 400000), ('127.0.0.1', answers))
    to.sendto(b'aim %d 10 -5 launch' % number, ('127.0.0.1', key))
    number += 1
    time.sleep(0.01)
END
flood=$!
ended loop
end_sender
kill "$recogniser" "$flood" 2>/dev/null
wait "$recogniser" "$flood" 2>/dev/null
check "it ends by itself, with $code: $(tail -n 1 "$tmp/loop.out")" [ "$code" = 0 ]
check "no race" [ "$(grep -c ThreadSanitizer "$tmp/loop.out")" = 0 ]
check "two missiles" [ "$(lines_in "$tmp/loop/flight.csv")" = 3 ]
cat "$tmp/loop/flight.csv"
check "a recogniser was heard: $(lines_in "$tmp/loop/answers.jsonl") answers" [ "$(lines_in "$tmp/loop/answers.jsonl")" -ge 2 ]
check "and guided" awk -F, 'NR > 1 { sum += $11 } END { exit !(sum > 0) }' "$tmp/loop/flight.csv"
check "the key was, too" grep -qE 'operator: [1-9][0-9]* datagrams taken' "$tmp/loop.out"
[ "$failures" = 0 ] || tail -n 40 "$tmp/loop.out"
finish
