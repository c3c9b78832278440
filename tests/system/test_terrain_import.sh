#!/usr/bin/env bash
# `pitviper terrain import` as a user runs it: a store from small sheets made here; a
# wrong command line, a missing file, Ctrl-C. labels: small
. "$(dirname "$0")/common.sh"

# sheet NAME COLUMNS ROWS WEST SOUTH STEP AWK-EXPRESSION: a grid of degrees as ASCII
sheet() {
    { printf 'ncols %d\nnrows %d\nxllcorner %s\nyllcorner %s\ncellsize %s\nNODATA_value -9999\n' "${@:2:5}"
      awk -v nx="$2" -v ny="$3" "BEGIN { for (j = 0; j < ny; j++) { for (i = 0; i < nx; i++) printf \"%.3f \", $7; print \"\" } }"
    } >"$tmp/$1.asc"
    echo 'GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]]' \
        >"$tmp/$1.prj"
}
sheet west 90 120 11 46 1e-5 '200 + 5 * sin(i / 9) + j / 50'
sheet east 90 120 11.0009 46 1e-5 '(i - 40) ^ 2 + (j - 50) ^ 2 < 200 ? -9999 : 201 + j / 50'
few=(--horizon 1 --threads 2)

run terrain import "$tmp/west.asc" "$tmp/east.asc" -o "$tmp/a.store" "${few[@]}"
check "two sheets: exit code" [ $code = 0 ]
check "two sheets: what there is to do comes first" eval 'head -n 6 "$tmp/stdout" | grep -qE "^to do: [0-9.]+ M posts, .* M pixels to read; [0-9.]+ GB to write"'
check "two sheets: posts and files" said 'M posts, .* from 2 files'
check "two sheets: error against the files" said 'resampling: .*rms'
check "two sheets: the hole is counted" said 'voids: [1-9][0-9]* posts filled'
check "two sheets: quiet on standard error" [ ! -s "$tmp/stderr" ]
run terrain info "$tmp/a.store"
content=$(grep -oE 'content [0-9a-f]+' "$tmp/stdout")
check "info reads it" [ $code = 0 ]
check "info names the sources" said 'west\.asc'

run terrain import "$tmp/west.asc" -o "$tmp/a.store" "${few[@]}"
check "an existing store is not replaced" [ $code != 0 ]
check "and says how" complained 'overwrite'
cp "$tmp/a.store" "$tmp/kept"
run -q terrain import "$tmp/west.asc" "$tmp/east.asc" -o "$tmp/b.store" "${few[@]}" --threads 1
check "quiet: nothing said" [ ! -s "$tmp/stdout" ]
run terrain info "$tmp/b.store"
check "one thread: the same content" said "${content:-none}"

# a surface model of two houses: records beside the store, which a node shows, and bare ground
sheet town 120 100 11 46 1e-5 '200 + (i > 20 && i < 38 && j > 30 && j < 44 ? 6 : i > 70 && i < 85 && j > 60 && j < 72 ? 4 : 0)'
run terrain import --surface "$tmp/town.asc" -o "$tmp/town.store" "${few[@]}" --spacing 1 --buildings "$tmp/town.geojson"
check "buildings: two, said" eval '[ $code = 0 ] && said "town.geojson: 2 buildings with outlines and roofs"'
run terrain culture "$tmp/town.geojson" --store "$tmp/town.store"
check "buildings: read as they are" eval 'said "^buildings: 2:" && said "height stated of 2"'
run terrain import --surface "$tmp/town.asc" -o "$tmp/town2.store" "${few[@]}" --spacing 1 --buildings "$tmp/town.geojson" --json
check "buildings: an existing file is not replaced" eval '[ $code != 0 ] && complained overwrite && [ ! -e "$tmp/town2.store" ]'
cp "$tmp/town.geojson" "$tmp/town.kept"
run terrain import --surface "$tmp/town.asc" -o "$tmp/town.store" "${few[@]}" --spacing 1 --buildings "$tmp/town.geojson" --json --overwrite --threads 1
check "buildings: in JSON" eval 'grep -q "\"building_records\": 2" "$tmp/stdout"'
check "buildings: one thread, the same" cmp -s "$tmp/town.geojson" "$tmp/town.kept"
run terrain again "$tmp/town.store"
check "buildings: again the same" eval '[ $code = 0 ] && cmp -s "$tmp/town.geojson" "$tmp/town.kept"'
run terrain import "$tmp/west.asc" -o "$tmp/x.store" "${few[@]}" --buildings "$tmp/x.geojson"
check "buildings: only of surface models" eval '[ $code != 0 ] && complained "give --surface"'

# a file that names others: in its own folder, or where that is allowed
mkdir "$tmp/own"
printf '<VRTDataset rasterXSize="90" rasterYSize="120"><SRS>EPSG:4326</SRS><GeoTransform>11,1e-5,0,46.0012,0,-1e-5</GeoTransform>
<VRTRasterBand dataType="Float32" band="1"><SimpleSource><SourceFilename relativeToVRT="0">%s</SourceFilename><SourceBand>1</SourceBand>
</SimpleSource></VRTRasterBand></VRTDataset>\n' "$tmp/west.asc" | tee "$tmp/here.vrt" >"$tmp/own/there.vrt"
run terrain import "$tmp/here.vrt" -o "$tmp/v.store" "${few[@]}"
check "a VRT of its own folder" [ $code = 0 ]
run terrain import "$tmp/own/there.vrt" -o "$tmp/w.store" "${few[@]}"
check "a VRT of another folder is refused" eval '[ $code = 1 ] && complained "there.vrt names .*west.asc, which lies outside its folder.*--sources-from"'
run terrain import "$tmp/own/there.vrt" -o "$tmp/w.store" "${few[@]}" --sources-from "/nowhere,$tmp"
check "and read where that is allowed" [ $code = 0 ]
run terrain again "$tmp/w.store"
check "also when it is made again" eval '[ $code = 0 ] && said "sources-from /nowhere,$tmp"'
printf 'terrain: {elevation: %s/own/there.vrt}\n' "$tmp" >"$tmp/node.yaml"
run check "$tmp/node.yaml"
check "check: the same" eval '[ $code != 0 ] && complained "lies outside its folder.*terrain.sources_from"'
printf 'terrain: {elevation: %s/own/there.vrt, sources_from: [%s]}\n' "$tmp" "$tmp" >"$tmp/node.yaml"
run check "$tmp/node.yaml"
check "check: allowed" [ $code = 0 ]

echo cut >"$tmp/bad.tif"
while read -r named arguments; do
    # shellcheck disable=SC2086
    run terrain import $arguments --overwrite
    check "import $arguments: exit code" [ $code != 0 ]
    check "import $arguments: names $named" complained "$named"
done <<BAD
STORE $tmp/west.asc
gdalinfo $tmp/bad.tif -o $tmp/x.store
size $tmp/west.asc -o $tmp/x.store --size 12
threads $tmp/west.asc -o $tmp/x.store --threads 0
frob $tmp/west.asc -o $tmp/x.store --frob
BAD
check "nothing is left of what failed" [ -z "$(ls "$tmp" | grep '^x\.store')" ]
run terrain frobnicate
check "an unknown action is named" complained frobnicate
run terrain import --help
for option in --surface --buildings --cover --cover-table --photo --canopy-height --canopy-cover --vertical --geoid --origin --size --spacing \
              --horizon --out --overwrite --threads --sources-from --most-gb; do
    check "terrain --help names $option" grep -q -- "$option" "$tmp/stdout"
done

# Ctrl-C: what was there stays, and no half file
"$pitviper" terrain import "$tmp/west.asc" -o "$tmp/a.store" --overwrite --spacing 0.06 --size 0.15x0.15 --horizon 1 --threads 1 >"$tmp/stdout" 2>"$tmp/stderr" &
pid=$!
while kill -0 $pid 2>/dev/null && [ -z "$(ls "$tmp" | grep '\.tmp$')" ]; do sleep 0.02; done
kill -INT $pid 2>/dev/null
wait $pid
code=$?
check "Ctrl-C: exit code 130, not $code" [ $code = 130 ]
check "Ctrl-C: said" complained 'stopped'
check "Ctrl-C: the store is as it was" cmp -s "$tmp/a.store" "$tmp/kept"
check "Ctrl-C: no half file" [ -z "$(ls "$tmp" | grep '\.tmp$')" ]
finish
