#!/usr/bin/env bash
# --stream as tshark captures it: whole packets of MPEG-TS, continuous, with the program map of H.264 and metadata.
. "$(dirname "$0")/common.sh"
needs "video: built without FFmpeg's libraries" has_video
judges tshark
needs "capture on lo for this user" tshark -i lo -a duration:1 -w /dev/null

group=239.78.$((RANDOM % 200 + 10)).9 port=$((20000 + RANDOM % 10000 * 4))
exercise demo "$tmp/demo.pcap"
tshark -i lo -a duration:60 -f "udp port $port" -w "$tmp/group.pcap" 2>"$tmp/tshark.err" &
tshark=$!
for _ in $(seq 200); do grep -q "Capturing on" "$tmp/tshark.err" && [ -s "$tmp/group.pcap" ] && break; sleep 0.05; done
replay "$tmp/demo.pcap" "$tmp/a" --bands lwir --from 1366 --to 1368 --rate 20 --speed 2 --planes none --no-files --set sensor.antialias=off \
    --set quality.budget=off --stream "udp://$group:$port" --set network.interface=lo
check "the replay that streams" [ $code = 0 ]
sleep 0.5
kill -INT $tshark
wait $tshark

# columns LOG: octets of the datagram, stream types of a program map, continuity lost, malformed
columns() {
    tshark -r "$1" -d "udp.port==$port,mp2t" -T fields -E 'separator=;' -e udp.length -e mpeg_pmt.stream.type -e mp2t.cc.drop \
        -e _ws.malformed 2>/dev/null
}
bad() { awk -F';' '($1 - 8) % 188 || $1 > 1324 || $3 != "" || $4 != ""' "$1" | wc -l; }
columns "$tmp/group.pcap" >"$tmp/columns"
check "datagrams" [ "$(wc -l <"$tmp/columns")" -ge 40 ]
check "program maps: H.264 and private data" [ "$(grep -c ';0x1b,0x06;' "$tmp/columns")" -ge 15 ]
check "continuous, well formed, whole packets" [ "$(bad "$tmp/columns")" = 0 ]
# its twin: a datagram is lost
tshark -r "$tmp/group.pcap" -Y 'frame.number != 20' -w "$tmp/lost.pcap" 2>/dev/null
columns "$tmp/lost.pcap" >"$tmp/lost"
check "its twin: a lost datagram is noticed" [ "$(bad "$tmp/lost")" -ge 1 ]
finish
