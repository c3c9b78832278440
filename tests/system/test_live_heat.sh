#!/usr/bin/env bash
# A live node in front of a tank that drives, halts and fires: its recording shows the same heat again, to the bit: planes,
# temperatures of patches, and what the tank is warmer than its ground.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"

cat >"$tmp/tank.yaml" <<'YAML'
duration_s: 12
place: {lat_deg: 52.1, lon_deg: 9.8, height_m: 80}
ground: {swell_m: 0.2}
dis: {clock: 2026-06-21T09:00:00Z, heartbeat_s: 1}
vehicles:
  - {name: Tank, type: 1.1.222.1.1.1.0, route_m: [[-30, 0], [0, 0]], speed_mps: 6, turret: swing}
shots:
  - {from: Tank 1, at_m: [700, 300], time_s: 7, rounds: 2, every_s: 1.5, entity: false, type: 2.2.225.2.1.1.0,
     launch_mps: 1000, boost_mps: 0, drag_mps2: 0, loft_m: 0, weave_m: 0, hit: ground}
YAML
look=(--size 64x48 --bands lwir,mwir --rate 5 --host observer --no-files --set exercise.aim=1:3001:1 --set observer.range_m=60
    --set observer.height_m=25)
free_port
node heat --address 127.0.0.1 --port $port "${look[@]}" --record "$tmp/heat.pcapng" --frames 60 --for 40
check "it listens" heard_by heat 'listening on' 20
sender "$tmp/tank.yaml" --send 127.0.0.1:$port
check "it finds the tank" heard_by heat '^ground:' 20
wait "$sender"
sleep 0.3
kill -INT "${node[heat]}" 2>/dev/null
ended heat 20
check "ends well" [ $code = 0 ]

last=$(time_of "$tmp/heat" '$')
replay "$tmp/heat.pcapng" "$tmp/again" --causal --port 0 --to "${last:-0}" "${look[@]}" --threads 1
check "its recording replays" [ $code = 0 ]
made=$(numbered "$tmp/heat" | wc -l)
echo "$made frames"
check "every live frame is the replay's of that number" part_of "$tmp/heat" "$tmp/again" 10

# warmth OUT: `number dt_k patch_temp_k...`, a frame a line
warmth() {
    sed -E 's/.*"frame":([0-9]+),.*"dt_k":([^,]*),"patch_temp_k":\[([^]]*)\].*/\1 \2 \3/' "$1/truth.jsonl" | sort
}
warmth "$tmp/heat" >"$tmp/live.warmth"
warmth "$tmp/again" >"$tmp/again.warmth"
check "each frame has the tank's temperatures" [ "$(grep -cE '^[0-9]+ -?[0-9.]+ [0-9.]+(,[0-9.]+){50,}$' "$tmp/live.warmth")" = "$made" ]
check "the same temperatures" [ -z "$(comm -23 "$tmp/live.warmth" "$tmp/again.warmth")" ]
check "that change from frame to frame" [ "$(cut -d' ' -f3 "$tmp/live.warmth" | sort -u | wc -l)" -ge 5 ]
# a barrel of this model has its patches among them, and two rounds warm their bore: on its surface a fraction of that shows within seconds
warmest_rise() { # between the first and the last frame, of any patch
    sort -n "$tmp/live.warmth" | awk 'NR == 1 { n = split($3, a, ",") } { m = split($3, b, ",") }
        END { for (i = 1; i <= n; i++) if (b[i] - a[i] > most) most = b[i] - a[i]; print most }'
}
rise=$(warmest_rise)
check "driving and firing warm a patch by more than 0.3 K ($rise)" is "$rise" ">" 0.3
# the twin
replay "$tmp/heat.pcapng" "$tmp/other" --causal --port 0 --to "${last:-0}" "${look[@]}" --set weather.air_temp_k=289
warmth "$tmp/other" >"$tmp/other.warmth"
check "another weather: other temperatures" [ -z "$(comm -12 "$tmp/live.warmth" "$tmp/other.warmth")" ]
[ "$failures" = 0 ] || { tail -n 12 "$tmp/heat.out"; cat "$tmp/stderr"; }
finish
