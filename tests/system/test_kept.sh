#!/usr/bin/env bash
# What is kept from frame to frame changes no bit: late ones of more than a hundred frames are those that are rendered alone,
# and those of a run that keeps and skips nothing. A missile flies at parked vehicles, small at first, past which a truck drives:
# one is hit, burns and smokes. All bands: also what the radar keeps of its clutter, and the heat of vehicles.
. "$(dirname "$0")/common.sh"

cat >"$tmp/parked.yaml" <<'Y'
duration_s: 14
place: {lat_deg: 36, lon_deg: -123, height_m: 120}
vehicles:
  - {name: Tank, id: 11, type: 1.1.222.1.1.1.0, force: 2, route_m: [0, 0], heading_deg: 40}
  - {name: Tank, id: 12, type: 1.1.222.1.1.1.0, force: 2, route_m: [9, 6], heading_deg: 100, turret: swing}
  - {name: Truck, id: 21, type: 1.1.222.7.1.0.0, force: 2, route_m: [-8, 5], heading_deg: 10}
  - {name: Truck, id: 22, type: 1.1.222.7.1.0.0, force: 2, route_m: [60, 70], heading_deg: 10}
  - {name: Truck, id: 23, type: 1.1.222.7.1.0.0, force: 2, route_m: [[-5, -90], [-5, 90]], speed_mps: 10}
  - {name: Heli, id: 31, type: 1.2.225.20.1.0.0, route_m: [1500, 100], height_m: 60, heading_deg: 265}
shots:
  - {name: Rocket, id: 51, type: 2.2.225.1.1.3.0, from: Heli 31, at: Truck 21, time_s: 1, launch_mps: 200, boost_mps: 300, boost_s: 0.6, drag_mps2: 5, hit: entity, damage: destroyed}
  - {name: Missile, id: 41, type: 2.2.225.1.1.3.0, from: Heli 31, at: Tank 11, time_s: 4.5, launch_mps: 65, boost_mps: 280, boost_s: 0.6, drag_mps2: 5, hit: entity, damage: destroyed}
Y
exercise "$tmp/parked.yaml" "$tmp/parked.pcap"
few=(--rate 25 --host 1:3001:41 --no-png --no-files "${coarse[@]}" --set quality.budget=off)
replay "$tmp/parked.pcap" "$tmp/all" "${few[@]}" --threads 2
check "a replay" [ "$code" = 0 ]
hashes "$tmp/all" | grep -oE '[0-9a-f]{64}' >"$tmp/each"
count=$(wc -l <"$tmp/each")
kept() { run_json "$1" | grep -oE '"kept":[0-9]+' | cut -d: -f2; }
echo "$count frames, $(kept "$tmp/all") points kept"
check "more than a hundred frames" [ "$count" -gt 102 ]
check "points are kept" [ "$(kept "$tmp/all")" -gt 300 ]

nth() { sed -n "$(($1 + 1))p" "$tmp/each"; } # frames are numbered from 0 on
late=$((count - 2)) middle=$((count / 2))
for n in $late $middle; do
    replay "$tmp/parked.pcap" "$tmp/alone" "${few[@]}" --threads 1 --only "$n"
    check "frame $n alone: nothing is kept for it" [ "$(kept "$tmp/alone")" = 0 ]
    check "frame $n alone, one thread: as after those before it" [ "$(hashes "$tmp/alone" | grep -oE '[0-9a-f]{64}')" = "$(nth "$n")" ]
done
check "the twin: another frame is another picture" [ "$(nth $late)" != "$(nth $((late - 1)))" ]

replay "$tmp/parked.pcap" "$tmp/noskip" "${few[@]}" --threads 2 --no-skip --only "$((late - 20)),$((late - 4)),$late"
check "--no-skip keeps nothing" [ "$(kept "$tmp/noskip")" = 0 ]
check "--no-skip: the same bits" [ "$(hashes "$tmp/noskip" | grep -oE '[0-9a-f]{64}')" = "$(nth $((late - 20)); nth $((late - 4)); nth $late)" ]
finish
