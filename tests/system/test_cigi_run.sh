#!/usr/bin/env bash
# `pitviper run --cigi HOST:PORT`: a live exercise seen by an eye that a host in Python moves, in step; the host's time counts
# from its first frame on, which is when it is. labels: small
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
judges python3.numpy python3.OpenEXR python3.pyproj python3.scipy
flight=$(dirname "$0")/../tools/cigi_flight.py

free_port
sender demo --set duration_s=900 --send 127.0.0.1:$port
few=("${bare[@]}" --address 127.0.0.1 --port $port --set exercise.listen_s=0.3 --size 96x64 --bands lwir --threads 2)
fly() { python3 "$flight" "$pitviper" live "$tmp/live" "${few[@]}" "$@" >"$tmp/stdout" 2>"$tmp/stderr" || { cat "$tmp/stdout" "$tmp/stderr"; return 1; }; }
check "a flight: each frame is where and when the host says" fly --record "$tmp/live.pcapng"
check "a time that goes ahead by hours is said once" [ "$(cat "$tmp/stdout" "$tmp/stderr" | grep -c 'went ahead by more than 600 s')" = 1 ]
check "and one that is to come, by seconds" [ "$(cat "$tmp/stdout" "$tmp/stderr" | grep -cE 'is [0-9.]+ s ahead of the exercise')" = 1 ]
check "no frame gives anything up: the host waits" not grep -q '"given_up"' "$tmp/live/truth.jsonl"
run replay "$tmp/live.pcapng" --out "$tmp/again" --host observer --size 32x24 --bands lwir --rate 10 --set exercise.listen_s=0.3 --causal --no-files
check "its recording is one of the exercise" [ $code = 0 ]
end_sender
finish
