#!/usr/bin/env bash
# `pitviper terrain culture`: what files of buildings hold, in words and as GeoJSON that GDAL reads; the same of an
# extract as ogr2ogr makes it of OpenStreetMap; settings and `check`; terrain databases that are not read. labels: small
. "$(dirname "$0")/common.sh"
judges ogr2ogr ogrinfo python3

cat >"$tmp/town.geojson" <<'JSON'
{"type": "FeatureCollection", "features": [
{"type": "Feature", "properties": {"building": "house", "building:levels": "2"}, "geometry": {"type": "Polygon", "coordinates": [[[13.0, 47.0], [13.0002, 47.0], [13.0002, 47.0001], [13.0, 47.0001], [13.0, 47.0]]]}},
{"type": "Feature", "properties": {"building": "yes", "height": "39'6\""}, "geometry": {"type": "Polygon", "coordinates": [[[13.001, 47.0], [13.0012, 47.0], [13.0012, 47.0001], [13.001, 47.0001], [13.001, 47.0]]]}},
{"type": "Feature", "properties": {"building": "yes", "height": "9999"}, "geometry": {"type": "Polygon", "coordinates": [[[13.002, 47.0], [13.0022, 47.0], [13.0022, 47.0001], [13.002, 47.0001], [13.002, 47.0]]]}},
{"type": "Feature", "properties": {"building": "yes"}, "geometry": {"type": "Polygon", "coordinates": [[[13.003, 47.0], [13.0032, 47.0001], [13.0032, 47.0], [13.003, 47.0001], [13.003, 47.0]]]}},
{"type": "Feature", "properties": {"highway": "primary", "lanes": "2"}, "geometry": {"type": "LineString", "coordinates": [[13, 46.9995], [13.004, 47.0]]}},
{"type": "Feature", "properties": {"natural": "tree", "height": "12,5"}, "geometry": {"type": "Point", "coordinates": [13.0005, 46.9999]}},
{"type": "Feature", "properties": {"man_made": "silo"}, "geometry": {"type": "Point", "coordinates": [13.0007, 46.9999]}},
{"type": "Feature", "properties": {"landuse": "forest"}, "geometry": {"type": "Polygon", "coordinates": [[[13.002, 47.0], [13.0022, 47.0], [13.0022, 47.0001], [13.002, 47.0]]]}}
]}
JSON
printf 'lat,lon,kind,height_m,marked\n47.0003,13.0003,birch,9,yes\n' >"$tmp/trees.csv"

run terrain culture "$tmp/town.geojson" --trees "$tmp/trees.csv" --half-width 500 -o "$tmp/out.geojson"
check "taken" [ $code = 0 ]
check "buildings" said 'buildings: 3: 3 house'
check "heights: 39 feet 6 inches are 12.04 m, above the ridges of two storeys" said '\.\. 12\.0 m high; height stated of 1, by levels of 1, by use and size of 1'
check "lines" said 'lines: 1: 1 road'
check "points" said 'points: 1: 1 silo'
check "trees" said 'trees: 2: 1 birch, 1 english_oak'
check "marked" said '1 with marked trunks'
check "left out" said 'left out: 1 with outlines that cross themselves.*, 1 of kinds that are not shown'
check "mended" said '1 that could not be true'
check "one line of it" [ "$(grep -c 'warning' "$tmp/stderr")" = 1 ]
check "GDAL reads what is written" [ "$(ogrinfo -q -al -where "record='building'" "$tmp/out.geojson" | grep -c '^OGRFeature')" = 3 ]
python3 - "$tmp" >"$tmp/verdict" <<'PY'
import json, sys
tmp = sys.argv[1]
given = json.load(open(tmp + '/town.geojson'))['features']
made = json.load(open(tmp + '/out.geojson'))['features']
first = [f for f in made if f['properties']['record'] == 'building'][0]
want = given[0]['geometry']['coordinates'][0]
got = first['geometry']['coordinates'][0]
print(all(abs(a - b) < 2e-9 for p, q in zip(want, got) for a, b in zip(p, q)) and len(want) == len(got))
print(first['properties']['eaves_m'] == 6 and first['properties']['levels'] == 2)
print([f['properties']['width_m'] for f in made if f['properties']['record'] == 'line'] == [6.5])
PY
check "places, heights and widths come back" [ "$(tr '\n' ' ' <"$tmp/verdict")" = "True True True " ]
run terrain culture "$tmp/town.geojson" -o "$tmp/out.geojson"
check "not overwritten unasked" [ $code = 1 ]

# as ogr2ogr writes OpenStreetMap's own format: most tags in other_tags
cat >"$tmp/town.osm" <<'XML'
<?xml version="1.0"?>
<osm version="0.6">
<node id="1" lat="47.0" lon="13.0"/><node id="2" lat="47.0" lon="13.0002"/><node id="3" lat="47.0001" lon="13.0002"/>
<node id="4" lat="47.0001" lon="13.0"/>
<node id="5" lat="46.9999" lon="13.0005"><tag k="natural" v="tree"/><tag k="height" v="11"/></node>
<way id="10"><nd ref="1"/><nd ref="2"/><nd ref="3"/><nd ref="4"/><nd ref="1"/>
<tag k="building" v="apartments"/><tag k="building:levels" v="5"/><tag k="roof:shape" v="flat"/></way>
<way id="11"><nd ref="1"/><nd ref="3"/><tag k="highway" v="track"/></way>
</osm>
XML
(cd "$tmp" && ogr2ogr osm.gpkg town.osm 2>/dev/null)
run terrain culture "$tmp/osm.gpkg" -o "$tmp/osm.geojson"
check "of an extract: taken" [ $code = 0 ]
check "the block" said 'buildings: 1: 1 flats'
check "five storeys of three metres" said '15\.0 \.\. 15\.0 m high; height stated of 0, by levels of 1'
check "the track and the tree" said 'lines: 1: 1 track'
check "11 m of it" grep -q '"height_m": 11.00' "$tmp/osm.geojson"

# more than is read is not left out unsaid
python3 - "$tmp" <<'PY'
import json, sqlite3, sys
square = [[13, 47], [13.0002, 47], [13.0002, 47.0001], [13, 47.0001], [13, 47]]
tags = {'a%d' % k: 'x' for k in range(96)}
json.dump({'type': 'FeatureCollection', 'features': [{'type': 'Feature', 'properties': dict(tags, building='house'),
           'geometry': {'type': 'Polygon', 'coordinates': [square]}}]}, open(sys.argv[1] + '/tags.geojson', 'w'))
many = sqlite3.connect(sys.argv[1] + '/layers.gpkg')
sqlite3.connect(sys.argv[1] + '/osm.gpkg').backup(many)
for k in range(1025):
    many.execute('CREATE TABLE l%d (fid INTEGER PRIMARY KEY, geom POINT)' % k)
    many.execute("INSERT INTO gpkg_contents (table_name, data_type, identifier, srs_id) "
                 "VALUES ('l%d', 'features', 'l%d', 4326)" % (k, k))
    many.execute("INSERT INTO gpkg_geometry_columns VALUES ('l%d', 'geom', 'POINT', 4326, 0, 0)" % k)
many.commit()
PY
run terrain culture "$tmp/layers.gpkg"
check "a thousand layers and more" complained 'has 10[0-9]+ layers, more than 1024'
run terrain culture "$tmp/tags.geojson"
check "an attribute that is not read is told" complained 'more attributes than are read'

# a terrain store is what they stand on
python3 - "$tmp/dem.asc" <<'PY'
import sys
with open(sys.argv[1], 'w') as f:
    f.write('ncols 60\nnrows 60\nxllcorner 12.997\nyllcorner 46.997\ncellsize 0.0001\nNODATA_value -9999\n')
    for y in range(60): f.write(' '.join(str(500 + x) for x in range(60)) + '\n')
PY
run terrain import "$tmp/dem.asc@srs=EPSG:4326@ellipsoid" -o "$tmp/town.store" --horizon 1 --threads 2
check "a store" [ $code = 0 ]
run terrain culture "$tmp/town.geojson" --store "$tmp/town.store" -o "$tmp/on.geojson"
check "on it" [ $code = 0 ]
python3 - "$tmp" >"$tmp/verdict" <<'PY'
import json, math, sys
made = json.load(open(sys.argv[1] + '/on.geojson'))['features']
# posts rise 1 m every 0.0001 degrees to the east: the west walls of two houses, 0.001 degrees apart, stand 10 m apart in height
base = [f['properties']['base_m'] for f in made if f['properties']['record'] == 'building']
print(abs(base[1] - base[0] - 10) < 0.2, [round(b, 2) for b in base])
PY
check "base heights are those of the ground: $(cat "$tmp/verdict")" grep -q '^True' "$tmp/verdict"

# what is not read says what to do
mkdir -p "$tmp/cdb/Tiles" "$tmp/cdb/Metadata"
echo '{"asset": {"version": "1.0"}}' >"$tmp/tileset.json"
echo x >"$tmp/hills.flt"
for case in "tileset.json:3D Tiles" "hills.flt:OpenFlight" "cdb:CDB"; do
    run terrain culture "$tmp/${case%%:*}"
    check "${case#*:} as buildings" complained "${case#*:}.*(is|are) not read"
    run terrain import "$tmp/${case%%:*}" -o "$tmp/no.store"
    check "${case#*:} as elevation" complained "${case#*:}.*(is|are) not read"
done
run terrain culture "$tmp/nothing.geojson"
check "no such file" complained 'no such file'
run terrain culture
check "no file named" [ $code = 2 ]
run terrain culture "$tmp/town.geojson" --at 91,0
check "no such place" [ $code = 2 ]

# settings
for case in "buildings: town.geojson:0" "buildings: off:0" "buildings: invented:0" "buildings: ofF:1" "buildings: nothing.gpkg:1" \
    "trees: trees.csv:0" "trees: town.geojson:1" "buildings: [town.geojson, osm.gpkg]:0"; do
    printf 'terrain: {%s}\n' "${case%:*}" >"$tmp/node.yaml"
    run check "$tmp/node.yaml"
    check "check of ${case%:*}" [ $code = "${case##*:}" ]
done
finish
