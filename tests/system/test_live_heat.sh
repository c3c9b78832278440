#!/usr/bin/env bash
# A live node in front of tanks that drive, halt and fire: its recording shows the same heat again, to the bit: planes,
# temperatures of patches, and what the tanks are warmer than their ground.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
bare=("${full[@]}") # heat as it is by default

cat >"$tmp/tanks.yaml" <<'YAML'
duration_s: 60
place: {lat_deg: 52.1, lon_deg: 9.8, height_m: 80}
ground: {swell_m: 0.2}
dis: {clock: 2026-06-21T09:00:00Z, heartbeat_s: 1}
vehicles:
  - {name: Tank, id: 1, type: 1.1.222.1.1.1.0, route_m: [[-18, 0], [0, 0]], speed_mps: 6, turret: swing}
  - {name: Tank, id: 2, type: 1.1.222.1.1.1.0, route_m: [[-20, 12], [400, 12]], speed_mps: 3}
shots:
  - {from: Tank 1, at_m: [700, 300], time_s: 4, rounds: 20, every_s: 1.5, entity: false, type: 2.2.225.2.1.1.0,
     launch_mps: 1000, boost_mps: 0, drag_mps2: 0, loft_m: 0, weave_m: 0, hit: ground}
YAML
look=(--size 64x48 --bands lwir,mwir --rate 4 --host observer --no-files --set exercise.aim=1:3001:1
    --set observer.range_m=60 --set observer.height_m=25 --set sensor.hfov_deg=50 --set exercise.listen_s=0.5)
free_port
node heat --address 127.0.0.1 --port $port "${look[@]}" --record "$tmp/heat.pcapng" --frames 28 --for 50
check "it listens" heard_by heat 'listening on' 30
sender "$tmp/tanks.yaml" --send 127.0.0.1:$port
ended heat 90
end_sender
check "ends well" [ $code = 0 ]

last=$(time_of "$tmp/heat" '$')
replay "$tmp/heat.pcapng" "$tmp/again" --causal --port 0 --to "${last:-0}" "${look[@]}" --threads 1
check "its recording replays" [ $code = 0 ]
made=$(numbered "$tmp/heat" | wc -l)
echo "$made frames"
check "every live frame is the replay's of that number" part_of "$tmp/heat" "$tmp/again" 8

# warmth OUT: a line for each target of a frame: frame entity dt_k patch_temp_k
warmth() {
    local line frame
    while read -r line; do
        frame=${line#*\"frame\":}
        grep -oE '"entity":"[0-9:]+","marking"|"dt_k":[^,]*,"patch_temp_k":\[[^]]*' <<<"$line" |
            awk -F'"' -v frame="${frame%%,*}" '/^"entity"/ { who = $4 } /^"dt_k"/ { print frame, who, $0 }' |
            sed 's/"dt_k"://; s/,"patch_temp_k":\[/ /'
    done <"$1/truth.jsonl" | sort
}
warmth "$tmp/heat" >"$tmp/live.warmth"
warmth "$tmp/again" >"$tmp/again.warmth"
patches='^[0-9]+ 1:3001:[12] -?[0-9.]+ [0-9.]+(,[0-9.]+){50,}$'
check "each frame has the first tank's temperatures" \
    [ "$(grep -E "$patches" "$tmp/live.warmth" | grep -c ' 1:3001:1 ')" = "$made" ]
check "some have the second's" grep -qE '^[0-9]+ 1:3001:2 ' "$tmp/live.warmth"
check "the same temperatures" [ -z "$(comm -23 "$tmp/live.warmth" "$tmp/again.warmth")" ]
check "that change from frame to frame" \
    [ "$(grep ' 1:3001:1 ' "$tmp/live.warmth" | cut -d' ' -f4 | sort -u | wc -l)" -ge 5 ]
rise=$(grep ' 1:3001:1 ' "$tmp/live.warmth" | sort -n | awk 'NR == 1 { n = split($4, a, ",") } { split($4, b, ",") }
    END { for (i = 1; i <= n; i++) if (b[i] - a[i] > most) most = b[i] - a[i]; print most + 0 }')
check "driving and firing warm a patch by more than 0.2 K ($rise)" is "$rise" '>' 0.2
# the twin, of the first second
replay "$tmp/heat.pcapng" "$tmp/other" --causal --port 0 --to "$(time_of "$tmp/heat" 5)" "${look[@]}" \
    --set weather.air_temp_k=289
warmth "$tmp/other" >"$tmp/other.warmth"
check "another weather: other temperatures" [ -s "$tmp/other.warmth" ]
check "of every frame" [ -z "$(comm -12 "$tmp/live.warmth" "$tmp/other.warmth")" ]
[ "$failures" = 0 ] || { tail -n 12 "$tmp/heat.out"; cat "$tmp/stderr"; }
finish
