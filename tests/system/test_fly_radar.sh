#!/usr/bin/env bash
# A missile that flies by the detections of its seeker's radar: in a replay of an exercise, as a node's own, and as the shot of a
# scenario. labels: small
. "$(dirname "$0")/common.sh"

cat >"$tmp/road.yaml" <<'END'
duration_s: 900
dis: {heartbeat_s: 2}
vehicles:
  - {name: Truck, id: 21, type: 1.1.222.7.1.0.0, force: 2, speed_mps: 3, route_m: [[0, 0], [60, 120], [80, 3000]]}
  - {name: Heli, id: 31, type: 1.2.225.20.1.0.0, route_m: [700, 100], height_m: 60, heading_deg: 265}
END
few=("${bare[@]}" --set terrain.woods=off --no-png --no-files --planes none --set exercise.listen_s=0.5 --set sensor.hfov_deg=3)
fly=(--fly ir_ag --set flight.from=1:3001:31 --set exercise.aim=1:3001:21)
value() { awk -F, -v name="$2" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) c = i } NR == 2 { print $c }' "$tmp/$1/flight.csv"; }

sed 's/duration_s: 900/duration_s: 8/' "$tmp/road.yaml" >"$tmp/short.yaml"
run exercise "$tmp/short.yaml" -o "$tmp/road.pcap"
flown() { # NAME options
    local name=$1; shift
    replay "$tmp/road.pcap" "$tmp/$name" --causal --size 32x24 "${few[@]}" "${fly[@]}" "$@"
    check "$name: flies" [ "$code" = 0 ]
    [ -e "$tmp/$name/flight.csv" ] && tail -n 1 "$tmp/$name/flight.csv"
}
radar=(--bands lwir,radar --set radar.preset=pulse_doppler_ku --set radar.ground=false --set radar.ground_bounce=false)
flown radar --rate 8 "${radar[@]}" --sight radar
check "radar: guided: $(value radar guided_share)" is "$(value radar guided_share)" '>' 0.5
check "radar: within the vehicle's length: $(value radar miss_m)" is "$(value radar miss_m)" '<' 6

# ---- the same radar in a flight of a scenario
sed -e '$a shots:\n  - {name: Missile, id: 41, type: 2.2.225.1.1.3.0, from: Heli 31, at: Truck 21, time_s: 1, flies: ir_ag}' "$tmp/short.yaml" >"$tmp/shot.yaml"
run fly "$tmp/shot.yaml" --sight radar -- --rate 5 --size 32x24 "${bare[@]}" --set terrain.woods=off "${radar[@]}"
check "fly --sight radar: ended with $code" [ "$code" = 0 ]
tail -n 1 "$tmp/stdout"
check "fly --sight radar: nearly all frames had a detection, and guided" awk -F, 'END { exit !($12 > 0.5 && $14 >= $13 - 3 && $9 < 10) }' "$tmp/stdout"
finish
