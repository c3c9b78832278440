#!/usr/bin/env bash
# One record of a target, five formats: the same frames' targets from truth.jsonl, coco.json, Data PDUs, ST 0903 and shared
# memory, each read by a reader of its own, have the same box once each format's index base is taken off; and a box that
# is off by one in any of them is noticed. What sensor/frame/target_record.h says of COCO's box is shown.
. "$(dirname "$0")/common.sh"
judges ffmpeg python3.numpy python3.pycocotools python3.opendis python3.stanag4609 python3.tstrans
needs "video: built without FFmpeg's libraries" has_video

# seen from the last truck of a column: the next one, the second behind it, of the third a part of pixels; hidden tanks; a
# far helicopter, a quarter of a pixel
cat >"$tmp/column.yaml" <<'Y'
vehicles:
  - {name: Truck, id: 11, type: 1.1.222.7.1.0.0, count: 4, spacing_m: 14, behind_m: -60, route_m: [[0, 0], [400, 40]], speed_mps: 6}
  - {name: Tank, id: 21, type: 1.1.222.1.1.1.0, count: 3, spacing_m: 9, behind_m: -190, route_m: [[0, 12], [400, 40]], speed_mps: 6}
  - {name: Heli, id: 31, type: 1.2.225.20.1.0.0, route_m: [1400, 60], height_m: 60, heading_deg: 200}
Y
exercise "$tmp/column.yaml" "$tmp/column.pcap"

# the log's port is 3000, so an address of this test's own
address=127.$((1 + $$ % 250)).$((1 + RANDOM % 250)).1
coproc receiver { python3 tests/system/data_pdus.py receive $address 3000 "$tmp/pdus"; }
receiver_pid=$receiver_PID # bash forgets it once the receiver has ended
read -r -t $patience listening <&"${receiver[0]}"
check "a receiver of Data PDUs listens" [ "${listening:-}" = listening ]
options=(--size 96x64 --rate 1 --threads 2 --bands lwir --host 1:3001:14 --from 1353 --to 1355 --set sensor.hfov_deg=40
    --speed 2 --coco --address $address --set publish.dis=truth)
ring=five_$$ video=$tmp/video
python3 tests/system/five_records.py watch "$ring" "$tmp/memory.jsonl" &
watcher=$!
run replay "$tmp/column.pcap" --out "$tmp/out" "${options[@]}" --memory "$ring" --set publish.memory_record=truth \
    --video "$video" --set publish.vmti=truth
check "a replay with all formats" [ $code = 0 ] || cat "$tmp/stderr"
echo "end" >&"${receiver[1]}"
wait "$receiver_pid" 2>/dev/null
wait "$watcher"
check "ffmpeg takes the metadata out of lwir.ts" quiet ffmpeg -v error -y -i "$video/lwir.ts" -map 0:d:0 -c copy -f data "$tmp/lwir.klv"
python3 tests/system/five_records.py compare "$tmp" || fail "five formats, one box"
finish
