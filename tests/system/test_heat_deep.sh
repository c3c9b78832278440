#!/usr/bin/env bash
# The ground's heat on the grids that it has by default: the same bits whatever is rendered of it, by how many threads; and
# each setting of weather and grid that shows. labels: deep
. "$(dirname "$0")/common.sh"
bare=("${full[@]}")

exercise tests/regress/departed/scenario.yaml "$tmp/gone.pcap"
look=(--bands lwir --rate 0.01 --no-png --set sensor.hfov_deg=24 --set exercise.aim=1:3001:1 --set observer.range_m=60
    --set observer.height_m=45 --set terrain.detail=off)
sha_of() { grep "\"frame\":$2," "$1/truth.jsonl" | grep -o '"frame_sha256":"[0-9a-f]*"'; }
same_frame() { [ -n "$(sha_of "$1" "$3")" ] && [ "$(sha_of "$1" "$3")" = "$(sha_of "$2" "$3")" ]; }

replay "$tmp/gone.pcap" "$tmp/whole" "${look[@]}"
check "19 frames" [ "$(frames "$tmp/whole")" = 19 ]
replay "$tmp/gone.pcap" "$tmp/late" "${look[@]}" --from +1150
check "--from: the last frame is that of the whole" same_frame "$tmp/whole" "$tmp/late" 18
replay "$tmp/gone.pcap" "$tmp/one" "${look[@]}" --only 1,18 --threads 1
check "one thread, two frames: the same bits" same_frame "$tmp/whole" "$tmp/one" 1
check "and of the other" same_frame "$tmp/whole" "$tmp/one" 18
replay "$tmp/gone.pcap" "$tmp/all" "${look[@]}" --only 1 --no-skip
check "--no-skip: the same bits" same_frame "$tmp/whole" "$tmp/all" 1
replay "$tmp/gone.pcap" "$tmp/bands" "${look[@]}" --only 1,18 --bands lwir,mwir,optical
check "other bands change nothing in this one" same_planes "$tmp/bands" "$tmp/one"

for setting in weather.day=constant weather.cloud=0.8 weather.humidity_pct=10 heat.step_s=1800; do
    replay "$tmp/gone.pcap" "$tmp/other" "${look[@]}" --only 1 --set "$setting"
    check "$setting: replayed" [ "$code" = 0 ]
    check "$setting: changes the frame" not same_frame "$tmp/one" "$tmp/other" 1
done
finish
