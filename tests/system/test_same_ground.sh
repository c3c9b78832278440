#!/usr/bin/env bash
# `replay` and `replay --causal` show the same ground, plants and roads, to the bit, of a log, and of a live node's recording
# those that the node had, though vehicles were reported later where it knew of none.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
bare=("${quickly[@]}") # with plants and buildings

# a truck drives past what the observer looks at, long after a node has chosen its ground; over waves that it does not know
cat >"$tmp/later.yaml" <<'YAML'
duration_s: 60
place: {lat_deg: 52.1, lon_deg: 9.8, height_m: 80}
ground: {swell_m: 0.6}
dis: {clock: 2026-06-21T09:00:00Z, heartbeat_s: 2}
vehicles:
  - {name: Tank, id: 1, type: 1.1.222.1.1.1.0, route_m: [0, 0]}
  - {name: Truck, id: 2, type: 1.1.222.7.1.0.0, route_m: [[-260, 15], [300, 40]], speed_mps: 9}
YAML
exercise "$tmp/later.yaml" "$tmp/later.pcap"
look=(--size 32x24 --bands optical --host observer --set exercise.aim=1:3001:1 --set observer.range_m=60
    --set observer.height_m=40 --set observer.rate_dps=0 --set sensor.hfov_deg=50 --set exercise.listen_s=0.5 --no-png
    --set terrain.woods_half_m=150 --set terrain.spacing_m=8)
# seen OUT LOG TIME options: one frame, named as if it were the first
seen() {
    local out=$1 log=$2 at=$3 file; shift 3
    replay "$log" "$out" --port 0 --from "$at" --to "$at" "${look[@]}" "$@"
    check "$out: replays" [ $code = 0 ]
    grep -E '^woods: [0-9]+ trees' "$tmp/stdout" >"$out/woods" # what is planted
    for file in "$out"/frames/*/*.exr; do mv -n "$file" "$(dirname "$file")/000000.exr"; done
}
# what does not move: shape, class and normal of the ground and its plants, and all of the optical band
same_ground() {
    local said
    said=$("$build/tests/picture_difference" "$1" "$2" 2>&1)
    grep -E '^plane (truth.(cover|material|n[xyz]|range_m)|optical)' <<<"$said" >"$tmp/planes"
    [ "$(lines_in "$tmp/planes")" = 9 ] && not grep -v ' changed 0 ' "$tmp/planes" && cmp -s "$1/woods" "$2/woods"
}
seen "$tmp/plain" "$tmp/later.pcap" +6
seen "$tmp/causal" "$tmp/later.pcap" +6 --causal
check "a log: the same ground" same_ground "$tmp/plain" "$tmp/causal"
# the twin: another seed
seen "$tmp/twin" "$tmp/later.pcap" +6 --causal --seed 2
check "another seed: other ground" not same_ground "$tmp/plain" "$tmp/twin"

# ---- a live node's ---------------------------------------------------------------------------------------------
free_port
node live --address 127.0.0.1 --port $port --rate 1 "${look[@]}" --no-files --record "$tmp/live.pcapng"
check "it listens" heard_by live 'listening on'
sender "$tmp/later.yaml" --send 127.0.0.1:$port
for ((n = 1; n < 200; n++)); do
    makes live $n || break
    is "$(time_of "$tmp/live" '$')" '>' "$(time_of "$tmp/live" 1 | awk '{ print $1 + 7 }')" && break
done
stop live
end_sender
check "ends well" [ $code = 0 ]
check "its recording tells what its world was made from" grep -aq 'pitviper: world until 0x' "$tmp/live.pcapng"
seen "$tmp/live-plain" "$tmp/live.pcapng" +6
seen "$tmp/live-causal" "$tmp/live.pcapng" +6 --causal
check "a recording: the same ground" same_ground "$tmp/live-plain" "$tmp/live-causal"
check "that which the node had" grep -qxFf "$tmp/live-plain/woods" "$tmp/live.out"
# another way to listen: other choices, not another world
seen "$tmp/live-late" "$tmp/live.pcapng" +6 --causal --set exercise.listen_s=3
check "whatever is listened to" same_ground "$tmp/live-plain" "$tmp/live-late"
# the twin: without its note it is a log like others
sed 's/pitviper: world until/pitviper: wOrld until/' "$tmp/live.pcapng" >"$tmp/other.pcapng"
seen "$tmp/other" "$tmp/other.pcapng" +6
check "without the note: other ground" not same_ground "$tmp/live-plain" "$tmp/other"
[ "$failures" = 0 ] || { tail -n 12 "$tmp/live.out"; cat "$tmp/stderr"; }
finish
