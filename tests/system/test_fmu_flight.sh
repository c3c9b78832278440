#!/usr/bin/env bash
# A flight of the FMU by fmpy through the recorded demo: poses by pyproj and scipy, rates, lines of sight by truth.jsonl, and
# places in the ring; and the same bits from a host that says the same by CIGI alone. labels: small
. "$(dirname "$0")/common.sh"
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
finish
