#!/usr/bin/env bash
# A live node in front of tanks that drive, halt and fire: its recording shows the same heat again, to the bit: planes,
# temperatures of patches, and what the tanks are warmer than their ground.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
bare=("${full[@]}") # heat as it is by default

cat >"$tmp/tanks.yaml" <<'YAML'
duration_s: 900
place: {lat_deg: 52.1, lon_deg: 9.8, height_m: 80}
ground: {swell_m: 0.2}
dis: {clock: 2026-06-21T09:00:00Z, heartbeat_s: 1}
vehicles:
  - {name: Tank, id: 1, type: 1.1.222.1.1.1.0, route_m: [[-18, 0], [0, 0]], speed_mps: 6, turret: swing}
  - {name: Tank, id: 2, type: 1.1.222.1.1.1.0, route_m: [[-20, 12], [4000, 12]], speed_mps: 1}
shots:
  - {from: Tank 1, at_m: [700, 300], time_s: 1, rounds: 800, every_s: 1, entity: false, type: 2.2.225.2.1.1.0,
     launch_mps: 1000, boost_mps: 0, drag_mps2: 0, loft_m: 0, weave_m: 0, hit: ground}
YAML
look=(--size 32x24 --bands lwir,mwir --rate 2 --host observer --no-files --set exercise.aim=1:3001:1
    --set observer.range_m=60 --set observer.height_m=25 --set sensor.hfov_deg=50 --set exercise.listen_s=0.5)
# warmth OUT [COUNT]: a line for each target of a frame, of so many frames: frame entity dt_k patch_temp_k
warmth() {
    head -n "${2:--0}" "$1/truth.jsonl" | sed 's/"targets":/\n&/; s/{"entity":/\n&/g' | awk -F'"' '
        /^\{"frame":/ { frame = $3; gsub(/[^0-9]/, "", frame) }
        /^\{"entity":/ && match($0, /"dt_k":[^,]*,"patch_temp_k":\[[^]]*/) {
            line = substr($0, RSTART, RLENGTH); gsub(/"dt_k":|"patch_temp_k":\[/, "", line); sub(/,/, " ", line)
            print frame, $4, line }' | sort
}
patches='^[0-9]+ 1:3001:[12] -?[0-9.]+ [0-9.]+(,[0-9.]+){50,}$'
temps() { grep -E "$patches" "$tmp/live.warmth" | grep " 1:3001:$1 " | sort -n; } # of one tank, a line a frame
rise() { # of the patch that has become warmest since the first frame, K
    temps 1 | awk 'NR == 1 { n = split($4, a, ",") } { split($4, b, ",") }
        END { for (i = 1; i <= n; i++) if (b[i] - a[i] > most) most = b[i] - a[i]; print most + 0 }'
}
free_port
node heat --address 127.0.0.1 --port $port "${look[@]}" --record "$tmp/heat.pcapng"
check "it listens" heard_by heat 'listening on'
sender "$tmp/tanks.yaml" --send 127.0.0.1:$port
# until what is looked for below has been seen
for ((n = 6; n < 400; n += 2)); do
    makes heat $n || break
    warmth "$tmp/heat" $n >"$tmp/live.warmth" # the line after them may not be whole
    is "$(rise)" '>' 0.25 && [ "$(temps 1 | cut -d' ' -f4 | sort -u | wc -l)" -ge 5 ] && [ -n "$(temps 2)" ] && break
done
stop heat
end_sender
check "ends well" [ $code = 0 ]

last=$(time_of "$tmp/heat" '$')
replay "$tmp/heat.pcapng" "$tmp/again" --causal --port 0 --to "${last:-0}" "${look[@]}" --threads 1
check "its recording replays" [ $code = 0 ]
made=$(numbered "$tmp/heat" | wc -l)
echo "$made frames"
check "every live frame is the replay's of that number" part_of "$tmp/heat" "$tmp/again" 6
warmth "$tmp/heat" >"$tmp/live.warmth"
warmth "$tmp/again" >"$tmp/again.warmth"
check "each frame has the first tank's temperatures" [ "$(temps 1 | wc -l)" = "$made" ]
check "some have the second's" [ -n "$(temps 2)" ]
check "the same temperatures" [ -z "$(comm -23 "$tmp/live.warmth" "$tmp/again.warmth")" ]
check "that change from frame to frame" [ "$(temps 1 | cut -d' ' -f4 | sort -u | wc -l)" -ge 5 ]
check "driving and firing warm a patch by more than 0.2 K ($(rise))" is "$(rise)" '>' 0.2
# the twin, of the first frames
replay "$tmp/heat.pcapng" "$tmp/other" --causal --port 0 --to "${last:-0}" "${look[@]}" --only "$(frames_of heat | cut -d, -f-2)" --set weather.air_temp_k=289
warmth "$tmp/other" >"$tmp/other.warmth"
check "another weather: other temperatures" [ -s "$tmp/other.warmth" ]
check "of every frame" [ -z "$(comm -12 "$tmp/live.warmth" "$tmp/other.warmth")" ]
[ "$failures" = 0 ] || { tail -n 12 "$tmp/heat.out"; cat "$tmp/stderr"; }
finish
