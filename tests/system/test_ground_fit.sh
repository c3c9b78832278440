#!/usr/bin/env bash
# Ground and sea invented for exercises without land vehicles, or with one that is far off: everybody is seen whole from
# above, ships on water; what does not fit is set onto the ground and said.
. "$(dirname "$0")/common.sh"
bare=("${quick[@]}" --set terrain.spacing_m=8)

# case NAME: a scenario from standard input, recorded
case_of() {
    { echo "duration_s: 12"; echo "place: {lat_deg: 48, lon_deg: 11, height_m: ${2:-500}}"; echo "vehicles:"; cat; } >"$tmp/$1.yaml"
    exercise "$tmp/$1.yaml" "$tmp/$1.pcap"
}
# whole NAME ENTITY...: each, looked at from 45 degrees above, is visible to 0.95 at least in every frame
whole() {
    local name=$1 entity least; shift
    for entity; do
        replay "$tmp/$name.pcap" "$tmp/$name" --rate 0.2 --no-files --threads 1 --bands optical --set observer.range_m=120 \
            --set observer.height_m=120 --set "exercise.aim=1:3001:$entity"
        check "$name: a replay" [ "$code" = 0 ]
        check "$name: 1:3001:$entity is in the frames" [ "$(grep -c "\"entity\":\"1:3001:$entity\"" "$tmp/$name/truth.jsonl")" -ge 2 ]
        least=$(grep -oE "\"entity\":\"1:3001:$entity\"[^}]*\"visible_fraction\":[0-9.]+" "$tmp/$name/truth.jsonl" |
            sed 's/.*://' | sort -g | head -n 1)
        check "$name: 1:3001:$entity visible to ${least:-nothing}" is "$least" '>=' 0.95
    done
}

case_of village <<'EOF'
  - {name: Tank, type: tank, route_m: [[0, 0], [100, 0]], speed_mps: 5}
  - {name: Man, type: person, count: 2, spacing_m: 6, route_m: [[60, 80], [90, 110]], speed_mps: 1.4, height_m: 6}
  - {name: House, type: 5.1.225.1.1.0.0, route_m: [[-150, -60]], height_m: -12}
  - {name: Man, type: person, route_m: [[-140, -40]], height_m: -11}
  - {name: Crate, type: 6.1.225.1.0.0.0, route_m: [[20, -60]], height_m: -3}
EOF
whole village 4 5
check "village: fitted to all" said 'fitted to 6 land entities'

case_of parked <<'EOF'
  - {name: Man, type: person, count: 3, spacing_m: 6, route_m: [[20, 0], [60, 10]], speed_mps: 1.4, height_m: 9}
  - {name: Heli, type: helicopter, route_m: [[0, 20]], height_m: 9, parked: true, engine: false}
EOF
whole parked 4
check "parked: the helicopter too" said 'fitted to 4 land entities'

for off in -30 20; do
    case_of "column$off" <<EOF
  - {name: Tank, type: tank, count: 4, spacing_m: 40, route_m: [[0, 0], [150, 0]], speed_mps: 5}
  - {name: Odd, type: tank, route_m: [[-160, 0], [-10, 0]], speed_mps: 5, height_m: $off}
EOF
    where=above
    [ "$off" -lt 0 ] && where=under
    whole "column$off" 4 5
    check "column$off: fitted to the four" said 'fitted to 4 land entities'
    check "column$off: the fifth is set onto it, and that is said" \
        said "1 entity does not fit it and is set onto it: 1:3001:5 Odd 5, sent ${off#-}\\.. m $where it.*terrain\\.ground"
done

case_of coast 0 <<'EOF'
  - {name: Tank, type: tank, count: 2, spacing_m: 40, route_m: [[0, 0], [200, 100]], speed_mps: 5, height_m: 12}
  - {name: Ship, type: 1.3.225.6.1.0.0, route_m: [[1500, 0], [1700, 200]], speed_mps: 8}
  - {name: Deep, type: 1.4.225.1.1.0.0, route_m: [[1300, -300], [1400, -200]], speed_mps: 4, height_m: -40}
EOF
whole coast 1 3
check "coast: the sea is said" said 'sea: flat at 0\.0 m .*shore half-way'
check "coast: and who is under it" said '1 submarine is under water'
replay "$tmp/coast.pcap" "$tmp/deep" --rate 0.2 --no-files --threads 1 --bands optical --set exercise.aim=1:3001:4
check "coast: the submarine is not seen" grep -qE '"entity":"1:3001:4"[^}]*"visible_fraction":0\.0' "$tmp/deep/truth.jsonl"

check "coast: an aim under water is said" said 'aim: 1:3001:4 is under water, so pictures show the sea above it; exercise.aim=ID'
case_of lone 0 <<'EOF'
  - {name: Deep, type: 1.4.225.1.1.0.0, route_m: [[1300, -300], [1400, -200]], speed_mps: 4, height_m: -40}
EOF
replay "$tmp/lone.pcap" "$tmp/lone" --only 0 --size 16x16 --threads 1 --no-files --bands lwir
check "lone submarine: said" said 'aim: 1:3001:1 is under water, so pictures show the sea above it; .*--host ID rides'
case_of pair 0 <<'EOF'
  - {name: Deep, type: 1.4.225.1.1.0.0, route_m: [[1300, -300], [1400, -200]], speed_mps: 4, height_m: -40}
  - {name: Ship, type: 1.3.225.6.1.0.0, route_m: [[1500, 0], [1700, 200]], speed_mps: 8}
EOF
replay "$tmp/pair.pcap" "$tmp/pair" --only 0 --size 16x16 --threads 1 --no-files --bands lwir
check "submarine and ship: the ship is looked at" said 'aim: 1:3001:2 Ship 2, circled'

# the same bits however many threads, and with nothing skipped; noise of the ground and shadows on it too
few=(--only 0 --no-png --bands optical,lwir --set observer.range_m=900 --set observer.height_m=300 --set sensor.hfov_deg=60
    --set terrain.detail=on --set heat.shadow_m=64)
replay "$tmp/coast.pcap" "$tmp/one" "${few[@]}" --threads 1
replay "$tmp/coast.pcap" "$tmp/two" "${few[@]}" --threads 3 --no-skip
check "coast: 3 threads, --no-skip: same bits" same_hashes "$tmp/one" "$tmp/two"
check "coast: 3 threads, --no-skip: same planes" same_planes "$tmp/one" "$tmp/two"

# live: who comes after the ground was chosen is set onto it all the same
case_of late <<'EOF'
  - {name: Tank, type: tank, count: 4, spacing_m: 40, route_m: [[0, 0], [150, 0]], speed_mps: 5}
  - {name: Late, type: tank, route_m: [[-160, 0], [-10, 0]], speed_mps: 5, height_m: 25, appears_s: 5}
EOF
replay "$tmp/late.pcap" "$tmp/late" --causal --rate 0.5 --no-files --threads 1 --bands optical --set observer.range_m=120 \
    --set observer.height_m=120 --set exercise.aim=1:3001:5
check "late: seen" grep -qE '"entity":"1:3001:5"[^}]*"visible_fraction":1\.0' "$tmp/late/truth.jsonl"
finish
