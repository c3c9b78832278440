#!/usr/bin/env bash
# A flight of the FMU by fmpy through the recorded demo: poses by pyproj and scipy, rates, lines of sight by truth.jsonl, and
# places in the ring; and the same bits from a host that says the same by CIGI alone; a live flight, and its recording.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
judges python3.numpy python3.fmpy python3.pyproj python3.scipy
flight=$(dirname "$0")/../tools/fmu_flight.py
fmu() { python3 "$flight" "$build/pitviper_seeker.fmu" "$@" >"$tmp/stdout" 2>"$tmp/stderr" || { cat "$tmp/stdout" "$tmp/stderr"; return 1; }; }

exercise demo "$tmp/demo.pcap"
quick=("${bare[@]}" --size 96x64 --bands lwir --threads 2 --no-files)
check "a flight" fmu fly "$pitviper" "$tmp/demo.pcap" "$tmp/one" "${quick[@]}"
check "what it says by CIGI" fmu say "$tmp"
check "the same by CIGI alone" fmu again "$tmp/said" "$pitviper" "$tmp/demo.pcap" "$tmp/two" "${quick[@]}"
check "gives the same bits" same_hashes "$tmp/one" "$tmp/two"
check "and every packet is read" not grep -q 'are skipped' "$tmp/stderr"

# a live exercise: seen by the FMU, recorded, and replayed
free_port
sender demo --set duration_s=900 --send 127.0.0.1:$port
listen=(--set exercise.listen_s=0.3 "${quick[@]}")
check "a live flight" fmu live "$pitviper" "$tmp/live" --address 127.0.0.1 --port $port --record "$tmp/live.pcapng" "${listen[@]}"
end_sender
run replay "$tmp/live.pcapng" --cigi recorded --out "$tmp/again" "${listen[@]}"
check "its recording has the same bits" same_hashes "$tmp/live" "$tmp/again"
finish
