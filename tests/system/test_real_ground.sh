#!/usr/bin/env bash
# An exercise over real elevation, cover and photograph: it says what it took, vehicles stand on the ground, and the
# bits do not depend on threads.
. "$(dirname "$0")/common.sh"
bare=("${quick[@]}" --set terrain.spacing_m=0 --set terrain.detail=on) # posts, and noise within classes, are of the files
needs_data terrain/autzen/autzen_dtm_1m.tif
data=$data/terrain/autzen
data=$(realpath "$data") # the settings lie elsewhere, and names in them are relative to them

exercise demo "$tmp/demo.pcap" place.lat_deg=44.0565 place.lon_deg=-123.0690 place.height_m=106
cat >"$tmp/ground.yaml" <<EOF
terrain:
  elevation: $data/autzen_dtm_1m.tif
  cover: $data/autzen_cover_1m.tif
  orthophoto: $data/autzen_rgb_1m.tif
EOF
# without antialiasing, what a frame sees is near: its file needs one attempt (test_real_ground_deep.sh: several)
few=(--config "$tmp/ground.yaml" --rate 0.4 --only 1,3 --no-png --threads 1 --size 64x48 --set sensor.antialias=off)
said_only=("${few[@]}" --bands lwir --size 16x16 --no-files) # where the picture does not matter
replay "$tmp/demo.pcap" "$tmp/one" "${few[@]}" --save-frame 1
check "a replay" [ "$code" = 0 ]
for line in 'posts 1 m apart' 'above the geoid, which lies -22\.4' 'resampling left 0\.01 m rms' 'table worldcover' \
    'photograph: 1 m' 'are set onto the ground'; do
    check "it says: $line" said "$line"
done
# one frame of it by itself: its part of the ground is in the file, and its name nowhere
size=$(stat -c %s "$tmp/one/frame_000001.pvf")
check "a frame file of $size octets" [ "$size" -lt 1600000 ]
run frame "$tmp/one/frame_000001.pvf" --threads 3
check "the frame alone: same bits" [ "$code" = 0 ]
check "the frame alone: of files" said 'ground: of files'
check "the frame alone: without their names" not grep -q autzen_dtm "$tmp/one/frame_000001.pvf"
replay "$tmp/demo.pcap" "$tmp/two" "${few[@]}" --threads 3
check "3 threads, same bits" same_hashes "$tmp/one" "$tmp/two"

differ() { ! same_hashes "$@"; }
replay "$tmp/demo.pcap" "$tmp/trust" "${few[@]}" --set terrain.ground=trust
quiet() { ! complained "$@"; }
check "no eye below the ground" quiet "below the ground"
check "trust: they stay" said 'stay where they were sent'
check "trust: other bits" differ "$tmp/one" "$tmp/trust"
replay "$tmp/demo.pcap" "$tmp/fit" "${said_only[@]}" --set terrain.ground=fit
check "fit: a correction" said 'smooth correction of at most'
# the fit leads the ground through what was sent: what is left is centimetres
left=$(grep -oE 'they were sent [0-9.]+ m' "$tmp/stdout" | grep -oE '[0-9.]+')
check "fit: within 0.2 m (median), not ${left:-nothing}" is "$left" '<' 0.2

# sent 60 m too low, the missile flies below this ground: its pictures are of nothing, and that is said
exercise demo "$tmp/low.pcap" place.lat_deg=44.0565 place.lon_deg=-123.0690 place.height_m=46
replay "$tmp/low.pcap" "$tmp/low" "${said_only[@]}" --set terrain.spacing_m=4
check "an eye below the ground is said" complained 'below the ground in [0-9]+ of [0-9]+ frames.*terrain\.ground=fit'

replay "$tmp/demo.pcap" "$tmp/none" --config "$tmp/ground.yaml" --set terrain.elevation=/nowhere.tif
check "a missing file ends it" [ "$code" = 1 ]
check "and says which, and what to do" complained 'terrain\.elevation: cannot read /nowhere\.tif.*gdalinfo'
replay "$tmp/demo.pcap" "$tmp/none" --set "terrain.cover=$data/autzen_cover_1m.tif"
check "cover without elevation is refused" complained 'terrain\.cover needs terrain\.elevation'
for wrong in cover orthophoto; do
    replay "$tmp/demo.pcap" "$tmp/none" --set "terrain.elevation=$data/autzen_dtm_1m.tif" --set terrain.spacing_m=4 \
        --set "terrain.$wrong=$data/autzen_dtm_1m.tif"
    check "elevation as $wrong is refused" complained "terrain\\.$wrong: .*is it elevation"
done
finish
