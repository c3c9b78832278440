#!/usr/bin/env bash
# A recording of `pitviper run --cigi` holds what the host says: its replay has the same frames to the bit, however the host and
# the network behaved, with one thread as with two. labels: small
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
judges python3.numpy python3.OpenEXR python3.pyproj python3.scipy tshark
flight=$(dirname "$0")/../tools/cigi_flight.py

free_port
sender demo --set duration_s=900 --send 127.0.0.1:$port
few=("${bare[@]}" --set exercise.listen_s=0.3 --size 96x64 --bands lwir)
fly() { python3 "$flight" "$pitviper" live "$tmp/live" --rough "${few[@]}" --threads 2 --address 127.0.0.1 --port $port --record "$tmp/live.pcapng" >"$tmp/stdout" 2>"$tmp/stderr" || { cat "$tmp/stdout" "$tmp/stderr"; return 1; }; }
check "a live flight, with pauses and repetitions" fly
end_sender
again() { # again OUT OPTION...
    local out=$1; shift
    run replay "$tmp/live.pcapng" --cigi recorded --out "$tmp/$out" "${few[@]}" --no-files "$@"
}
again two --threads 2 --set exercise.cigi_view=3
check "its replay has the same bits" same_hashes "$tmp/live" "$tmp/two"
again one --threads 1 --set exercise.cigi_view=3 --set exercise.cigi_port=9
check "with one thread, and whatever the port is" same_hashes "$tmp/live" "$tmp/one"
again other --threads 2
check "the view that the host does not place has no frames" [ $code != 0 ]
check "tshark reads the host's datagrams in it" [ "$(tshark -r "$tmp/live.pcapng" 2>/dev/null | grep -c ' CIGI ')" -ge 9 ]
run replay "$tmp/live.pcapng" --host observer --out "$tmp/exercise" --rate 10 "${few[@]}" --no-files --causal --threads 2
check "without that word it is a recording of the exercise" [ $code = 0 ]
# one bit of the eye's place in a datagram of the last frame
python3 - "$tmp/live.pcapng" "$tmp/twin.pcapng" <<'END2'
import struct, sys
data = bytearray(open(sys.argv[1], 'rb').read())
at = data.index(struct.pack('>d', 420.))  # the height of the carrier
data[at + 4] ^= 1
open(sys.argv[2], 'wb').write(data)
END2
run replay "$tmp/twin.pcapng" --cigi recorded --out "$tmp/twin" "${few[@]}" --no-files --threads 2 --set exercise.cigi_view=3
check "another bit of the eye's place is another frame" not same_hashes "$tmp/live" "$tmp/twin"

refused() { # refused WHAT TEXT ARGUMENT...
    local what=$1 text=$2; shift 2
    run "$@" --out "$tmp/not"
    check "$what is refused" [ $code != 0 ]
    check "$what: it says why" complained "$text"
}
exercise demo "$tmp/demo.pcapng"
refused "a recording without a host" 'holds no CIGI host' replay "$tmp/demo.pcapng" --cigi recorded
refused "a pipe" 'not from a pipe' replay <(cat "$tmp/live.pcapng") --cigi recorded
refused "a live node" 'HOST:PORT' run --cigi recorded --for 1
finish
