#!/usr/bin/env bash
# A flight over real ground as rendered by default: the same bits for any number of threads, and from a frame file, whose
# part of the ground must reach as far as any of its rays. labels: deep
. "$(dirname "$0")/common.sh"
needs_data terrain/autzen/autzen_dtm_1m.tif
data=$data/terrain/autzen

exercise demo "$tmp/demo.pcap" place.lat_deg=44.0565 place.lon_deg=-123.0690 place.height_m=106
few=(--rate 0.4 --no-png --set "terrain.elevation=$data/autzen_dtm_1m.tif" --set "terrain.cover=$data/autzen_cover_1m.tif"
    --set "terrain.orthophoto=$data/autzen_rgb_1m.tif")
replay "$tmp/demo.pcap" "$tmp/one" "${few[@]}" --threads 1 --save-frame 1
check "a replay" [ "$code" = 0 ]
check "a part of the ground that reaches beyond the frame" said 'ground within 20000 m of what is seen'
size=$(stat -c %s "$tmp/one/frame_000001.pvf")
check "a frame file of $size octets" [ "$size" -lt 4000000 ]
run frame "$tmp/one/frame_000001.pvf" --threads 3
check "the frame alone: same bits" [ "$code" = 0 ]
replay "$tmp/demo.pcap" "$tmp/two" "${few[@]}" --threads 3
check "3 threads, same bits" same_hashes "$tmp/one" "$tmp/two"
finish
