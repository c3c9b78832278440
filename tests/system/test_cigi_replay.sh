#!/usr/bin/env bash
# `pitviper replay LOG --cigi HOST:PORT`: a host in Python gives time and eye of each frame and waits for it; place, attitude
# and heights against pyproj, scipy and the frame's own ranges. A host and a network that falter change no bit.
# labels: small
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
judges python3.numpy python3.OpenEXR python3.pyproj python3.scipy
flight=$(dirname "$0")/../tools/cigi_flight.py

exercise demo "$tmp/demo.pcap"
quick=("${bare[@]}" --size 96x64 --bands lwir --threads 2)
fly() { local out=$1; shift; python3 "$flight" "$pitviper" "$tmp/demo.pcap" "$out" "${quick[@]}" "$@" >"$tmp/stdout" 2>"$tmp/stderr" || { cat "$tmp/stdout" "$tmp/stderr"; return 1; }; }
check "a flight: each frame is where and when the host says" fly "$tmp/one"
check "what is not read is said" complained 'id 220'
check "frames before the host says where the eye is are none" complained 'has not said where the eye is'
check "the same flight, with pauses and repetitions" fly "$tmp/two" --rough
counted() { run_json "$tmp/$1" | grep -oE '"cigi":\{[^}]*\}[^}]*\}' | grep -q "$2"; } # counted OUT TEXT: of counters.cigi
check "frames asked for, without a picture, and what is not read are counted" counted one '"asked":8,"without_picture":5,.*"time_ahead":3,.*"skipped":{"220":1}'
check "and what is refused" counted two '"dropped":{"first_packet":6}'
check "gives the same bits" same_hashes "$tmp/one" "$tmp/two"

# a host that never comes
free_port
"$pitviper" replay "$tmp/demo.pcap" --out "$tmp/alone" "${quick[@]}" --cigi 127.0.0.1:9 --set exercise.cigi_port=0 >"$tmp/alone.out" 2>&1
check "a port of its own that is none is refused" [ $? = 2 ]
"$pitviper" replay "$tmp/demo.pcap" --out "$tmp/alone" "${quick[@]}" --cigi "[::1]:9" --set exercise.cigi_port=$port >"$tmp/alone.out" 2>&1 &
alone=$!
check "it says that no host has answered" until_true grep -q 'no host has answered' "$tmp/alone.out"
run replay "$tmp/demo.pcap" --out "$tmp/second" --cigi "[::1]:9" --set exercise.cigi_port=$port
check "a second one on its port is refused" [ $code = 1 ]
check "and says which setting chooses another" complained 'exercise.cigi_port'
kill -INT $alone
wait $alone
check "told to stop, it stops" [ $? = 130 ]

refused() { # refused WHAT TEXT OPTION...
    local what=$1 text=$2; shift 2
    run replay "$tmp/demo.pcap" --out "$tmp/not" "$@"
    check "$what is refused" [ $code != 0 ]
    check "$what: it says why" complained "$text"
}
refused "an address that is none" 'HOST:PORT' --cigi localhost:8004
refused "a port that is none" 'HOST:PORT' --cigi 127.0.0.1:0
refused "an entity that carries the sensor" 'moves the eye' --cigi 127.0.0.1:8004 --host 1:3001:13
refused "a speed" 'without --speed' --cigi 127.0.0.1:8004 --speed 1
refused "frames by number" 'without --only' --cigi 127.0.0.1:8004 --only 1
finish
