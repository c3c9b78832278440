#!/usr/bin/env bash
# What arrives after the socket of a live node is open and before its recording is: here that one is a FIFO whose reader comes
# late. The node does not use it, so that frames are those of the recording to the bit. labels: small
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
needs python3 python3 -c 1

free_port
mkfifo "$tmp/fifo"
sender demo --set duration_s=900 --send 127.0.0.1:$port
few=("${bare[@]}" --set exercise.listen_s=0.3 --size 96x64 --bands lwir --threads 2 --host observer --rate 5 --no-files)
node late --address 127.0.0.1 --port $port "${few[@]}" --frames 4 --record "$tmp/fifo"
sleep 2
timeout $patience cat "$tmp/fifo" >"$tmp/late.pcapng" &
reader=$!
ended late
check "a recording that cannot be read again is reported" grep -q 'cannot be read again' "$tmp/late.out"
wait $reader
end_sender
run replay "$tmp/late.pcapng" --causal --out "$tmp/again" "${few[@]}"
cat >"$tmp/same.py" <<'END2'
import json, sys
live, again = ({line['frame']: line['frame_sha256'] for line in map(json.loads, open(path))} for path in sys.argv[1:])
both = live.keys() & again.keys()  # a replay ends with the last datagram
sys.exit(not both or any(live[n] != again[n] for n in both))
END2
check "its replay has the same bits" python3 "$tmp/same.py" "$tmp/late/truth.jsonl" "$tmp/again/truth.jsonl"
finish
