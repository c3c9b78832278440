#!/usr/bin/env bash
# Metadata of a flight over real ground: frame centre and corners lie on the ground of the elevation file.
. "$(dirname "$0")/common.sh"
needs_data terrain/autzen/autzen_dtm_1m.tif
judges gdaltransform gdal_translate gdalinfo oiiotool python3.numpy python3.klvdata python3.stanag4609 python3.tstrans

tif=$data/terrain/autzen/autzen_dtm_1m.tif
exercise demo "$tmp/real.pcap" place.lat_deg=44.0565 place.lon_deg=-123.0690 place.height_m=106
# --pairs all: a range plane of the ground alone
replay "$tmp/real.pcap" "$tmp/real" --set "terrain.elevation=$(realpath "$tif")" --host observer --rate 0.05 \
    --size 63x47 --samples 1 --bands lwir --no-png --pairs all --set publish.klv_files=true --set publish.planes=range \
    --set observer.range_m=2600 --set observer.height_m=1500
check "a replay over real ground" [ "$code" = 0 ]
python3 tests/system/klv_test.py ground "$tmp/real" "$tif" EPSG:26910+5773 || fail "frame centre, corners and range"
# its twin: the ground's file 50 m to the east
read -r x0 y0 x1 y1 <<<"$(gdalinfo "$tif" | sed -nE 's/^(Upper Left|Lower Right) +\( *([0-9.-]+), *([0-9.-]+)\).*/\2 \3/p' | tr '\n' ' ')"
gdal_translate -q -a_ullr "$(awk "BEGIN { print $x0 + 50 }")" "$y0" "$(awk "BEGIN { print $x1 + 50 }")" "$y1" "$tif" "$tmp/moved.tif"
python3 tests/system/klv_test.py ground "$tmp/real" "$tmp/moved.tif" EPSG:26910+5773 >"$tmp/said" 2>&1
check "its twin is noticed" grep -q '^FAILED: ' "$tmp/said"
finish
