#!/usr/bin/env bash
# A node on a terrain store: what it says, the same bits for any threads and from a frame file; stores that are damaged,
# moved, stale or contradicted by other settings; terrain info and its pictures.
. "$(dirname "$0")/common.sh"
needs_data terrain/autzen/autzen_dtm_1m.tif
data=$data/terrain/autzen
bare=("${quick[@]}" --set terrain.spacing_m=0 --set terrain.detail=on) # posts, and noise within classes, are of the store

# sources of its own, to be changed and removed
for name in dtm cover rgb; do cp "$data/autzen_${name}_1m.tif" "$tmp/$name.tif"; done
store=$tmp/a.store
run terrain import "$tmp/dtm.tif" --cover "$tmp/cover.tif" --photo "$tmp/rgb.tif" --size 0.4x0.4 --horizon 1 -o "$store"
check "a store" [ "$code" = 0 ]
exercise demo "$tmp/demo.pcap" place.lat_deg=44.0565 place.lon_deg=-123.0690 "ground.store=$store"
few=(--rate 0.2 --only 1 --size 48x32 --no-png --threads 1 --set "terrain.store=$store")

replay "$tmp/demo.pcap" "$tmp/one" "${few[@]}" --threads 1 --save-frame 1
check "a replay" [ "$code" = 0 ]
for line in 'terrain store a\.store, 1 m posts shown at 1 m over 0\.4' 'cover: 1 m classes' 'photograph: 1 m' \
    'are set onto the ground'; do
    check "it says: $line" said "$line"
done
left=$(grep -oE 'they were sent [0-9.]+ m' "$tmp/stdout" | grep -oE '[0-9.]+')
check "an exercise over the same store is sent within 0.1 m (median), not ${left:-nothing}" is "$left" '<' 0.1

# a frame file refers to the store
frame=$(ls "$tmp"/one/*.pvf)
check "a frame file is small" [ "$(stat -c %s "$frame")" -lt 100000 ]
run frame "$frame" --threads 3
check "the frame alone: same bits" [ "$code" = 0 ]
check "the frame alone: of the store" said 'terrain store .*a\.store'
mv "$store" "$tmp/b.store"
run frame "$frame"
check "its store moved" [ "$code" = 1 ]
check "is said, and what to do" complained 'was made over the terrain store .*a\.store; put it back'

# a store of other content under that name
run terrain import "$tmp/dtm.tif" --size 0.05x0.05 --horizon 1 -o "$store"
run frame "$frame"
check "another store under its name" complained 'not the one that the frame was made over'
mv "$tmp/b.store" "$store"

# cut, or its sources changed: made again; sources missing: used as it is
truncate -s 100000 "$store"
replay "$tmp/demo.pcap" "$tmp/two" "${few[@]}" --threads 3 --no-skip
check "a cut store is said" said 'not as long as its header says.*; it is made again'
check "and gives the same bits, on 3 threads without skips too" same_hashes "$tmp/one" "$tmp/two"
touch "$tmp/cover.tif"
replay "$tmp/demo.pcap" "$tmp/three" "${few[@]}"
check "a changed source is said" said 'cover\.tif has changed since .* it is made again'
check "and gives the same bits" same_hashes "$tmp/one" "$tmp/three"
rm "$tmp/cover.tif"
replay "$tmp/demo.pcap" "$tmp/four" "${few[@]}" --bands lwir --no-files
check "a missing source is said" said 'used as it is: .*cover\.tif'

# of sources outside its own folder it is not made again unasked: a store may be a stranger's (tests/terrain/test_terrain_import.c)
mkdir "$tmp/mine" "$tmp/given"
cp "$tmp/dtm.tif" "$tmp/mine/secret.tif"
given=$tmp/given/a.store
run terrain import "$tmp/mine/secret.tif" --size 0.4x0.4 --horizon 1 -o "$given"
touch "$tmp/mine/secret.tif"
run terrain info "$given"
check "a source elsewhere has changed: said" said 'CHANGED; the store is used as it is: .*secret\.tif lies outside'
replay "$tmp/demo.pcap" "$tmp/foreign" "${few[@]}" --bands lwir --no-files --set "terrain.store=$given"
check "a source elsewhere has changed: used as it is" [ "$code" = 0 ]
check "and the command that makes it again is named" said "used as it is: secret\.tif has changed, but secret\.tif lies outside the store's own folder .*terrain again"
truncate -s 100000 "$given"
replay "$tmp/demo.pcap" "$tmp/foreign" "${few[@]}" --no-files --set "terrain.store=$given"
check "cut, it is refused" [ "$code" = 1 ]
check "with that reason, and that command" complained 'made of .*mine/secret\.tif, outside its own folder.*terrain again'
check "and stays as it is" [ "$(stat -c %s "$given")" = 100000 ]
run terrain again "$given"
check "asked for, it is made" [ "$code" = 0 ]
check "of what is printed" said '^elevation .*mine/secret\.tif'
run terrain info "$given"
check "and is whole" said 'sources: as they were'

# terrain info
run terrain info "$store" --out "$tmp/pictures" --verify
check "info" [ "$code" = 0 ]
for line in 'level 0: 4[0-9][0-9] x 4[0-9][0-9] posts 1 m apart' 'posts, level 0 +[0-9]+ octets' 'grass [0-9.]+ %' \
    'cover\.tif is not here' 'verified' 'crowns: 0; buildings: 0'; do
    check "info says: $line" said "$line"
done
for picture in hillshade classes; do
    check "$picture.png" [ "$(head -c 4 "$tmp/pictures/$picture.png" | tail -c 3)" = PNG ]
done

# refused
printf 'x' | dd of="$store" bs=1 seek=100000 conv=notrunc status=none
run terrain info "$store" --verify
check "damaged data are found by --verify" [ "$code" = 1 ]
check "and said" complained 'damaged.*terrain import'
printf 'x' | dd of="$store" bs=1 seek=40 conv=notrunc status=none
replay "$tmp/demo.pcap" "$tmp/none" "${few[@]}"
check "a damaged header without the sources ends it" [ "$code" = 1 ]
check "with both reasons" complained 'cover\.tif'
check "and the next step" complained 'cannot be used: its header is damaged, nor made again.*terrain import'
truncate -s 1000 "$store"
printf 'terrain:\n  store: %s\n' "$store" >"$tmp/store.yaml"
run check "$tmp/store.yaml"
check "check finds it too" complained 'terrain\.store'
replay "$tmp/demo.pcap" "$tmp/none" "${few[@]}"
check "nothing is left of its options: the next step" complained 'cannot be used: .*; make it again with .pitviper terrain import'
finish
