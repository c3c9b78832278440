#!/usr/bin/env bash
# sensor.aim_offset and the walk of the line of sight, of an observer and of a munition: the aim is where it was told, drawn by the
# seed alone, and a frame is the same at any rate.
# labels: small
. "$(dirname "$0")/common.sh"
bare=("${quick[@]}")
exercise demo "$tmp/demo.pcap"
look=(--bands lwir --no-files --threads 1 --set sensor.refraction=off)
observer=("${look[@]}" --host observer --set exercise.aim=1:3001:11)

# middle OUT ID: of the whole box of a target in the first frame, px
middle() { head -n 1 "$1/truth.jsonl" | grep -oE "\"entity\":\"$2\",.*" | grep -oE '"amodal_box_px":\[[^]]*\]' | head -n 1 | tr -d '"a-z_:[]' | awk -F, '{ print ($1 + $3) / 2, ($2 + $4) / 2 }'; }
near() { awk -v got="$1" -v x="$2" -v y="$3" -v tol="$4" 'BEGIN { split(got, p, " "); exit !(p[1] != "" && (p[1] - x) ^ 2 + (p[2] - y) ^ 2 <= tol ^ 2) }'; }
replay "$tmp/demo.pcap" "$tmp/middle" "${observer[@]}" --from +8 --to +8
check "an observer's aim is in the middle" near "$(middle "$tmp/middle" 1:3001:11)" 48 32 1.5
replay "$tmp/demo.pcap" "$tmp/off" "${observer[@]}" --from +8 --to +8 --set sensor.aim_offset=0.25,-0.25
check "or where it is told: a quarter of the image right and above" near "$(middle "$tmp/off" 1:3001:11)" 72 16 1.5
replay "$tmp/demo.pcap" "$tmp/deg" "${observer[@]}" --from +8 --to +8 --set sensor.hfov_deg=6 --set 'sensor.aim_offset=-1,0.5 deg'
check "in degrees: of 96 px over 6" near "$(middle "$tmp/deg" 1:3001:11)" 32 40 1.5

# of a munition, whose gimbal follows its aim
munition=("${look[@]}" --from 1366 --to 1366)
replay "$tmp/demo.pcap" "$tmp/seeker" "${munition[@]}"
aim=$(head -n 1 "$tmp/seeker/truth.jsonl" | grep -oE '"aim":"[0-9:]+"' | cut -d'"' -f4)
[ -n "$aim" ] || aim=1:3001:22
at=$(middle "$tmp/seeker" "$aim")
replay "$tmp/demo.pcap" "$tmp/seeker_off" "${munition[@]}" --set sensor.aim_offset=0.25,-0.25
check "a munition's aim moves as far" near "$(middle "$tmp/seeker_off" "$aim")" "$(awk -v p="$at" 'BEGIN { split(p, a, " "); print a[1] + 24 }')" "$(awk -v p="$at" 'BEGIN { split(p, a, " "); print a[2] - 16 }')" 2

# drawn, and walking: by the seed, and at any rate
walk=("${observer[@]}" --set sensor.aim_offset=drawn --set sensor.walk_deg=0.4 --set sensor.walk_s=4)
replay "$tmp/demo.pcap" "$tmp/one" "${walk[@]}" --from +8 --to +8
replay "$tmp/demo.pcap" "$tmp/many" "${walk[@]}" --from +6 --to +8 --rate 2
last() { tail -n 1 "$1/truth.jsonl" | grep -oE '"frame_sha256":"[0-9a-f]+"'; }
check "the same frame at any rate" [ "$(last "$tmp/one")" = "$(last "$tmp/many")" ]
check "it moves between frames" [ "$(grep -oE '"boresight_error_deg":\[[^]]*\]' "$tmp/many/truth.jsonl" | sort -u | wc -l)" -ge 4 ]
replay "$tmp/demo.pcap" "$tmp/other" "${walk[@]}" --from +8 --to +8 --set seed=2
check "another seed, another place" [ "$(middle "$tmp/one" 1:3001:11)" != "$(middle "$tmp/other" 1:3001:11)" ]

replay "$tmp/demo.pcap" "$tmp/wrong" --set sensor.aim_offset=0.6,0
check "beyond the image: refused" complained "sensor.aim_offset: '0.6,0' is not none"
finish
