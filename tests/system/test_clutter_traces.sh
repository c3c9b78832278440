#!/usr/bin/env bash
# What drives of clutter raises dust and leaves warm lines behind it, and engines that run give off gas: they are in the image and
# change nothing else; the same bits by threads, without skips and from the frame's file.
. "$(dirname "$0")/common.sh"
judges python3.OpenEXR python3.numpy
bare=("${built[@]}")
cat >"$tmp/stands.yaml" <<'Y'
duration_s: 6
place: {lat_deg: 50.1, lon_deg: 8.6, height_m: 120}
vehicles: [{name: Tank, id: 11, type: 1.1.222.1.1.1.0, force: 2, route_m: [[0, 0]]}]
Y
head=class,shape,paint,where,density,group_low,group_high,spread_m,length_low_m,length_high_m,heat,running,recent,reach_m
table() { # lorries that drive over fields and pasture
    echo "$head"
    for where in field pasture; do echo "lorry,lorry,,$where,90,1,1,0,0,0,drives,0,0,1000"; done
}
table >"$tmp/drives.csv"
cp -r etc "$tmp/still" # tables by which no dust is raised, and engines give off nothing
awk -F, -v OFS=, '/^(dust|exhaust),/ { $15 = 1e-12 } 1' etc/effects.csv >"$tmp/still/effects.csv"
check "the table without dust differs" not cmp -s etc/effects.csv "$tmp/still/effects.csv"
exercise "$tmp/stands.yaml" "$tmp/log.pcap"
seen() { # seen OUT options: LWIR and MWIR from 600 m, of a wide field
    local out=$1; shift
    replay "$tmp/log.pcap" "$tmp/$out" --host observer --set observer.range_m=600 --size 160x96 --set sensor.hfov_deg=30 --band mwir,lwir \
        --set terrain.buildings=off --set terrain.clutter=1 --set terrain.clutter_table="$tmp/drives.csv" --only 3 "$@"
    check "$out: made" [ "$code" = 0 ]
}
seen one --threads 1 --save-frame 3
check "clutter drives" [ "$(run_json "$tmp/one" | grep -oE '"driving":[0-9]+' | head -1 | cut -d: -f2)" -gt 20 ]
seen many --threads 4
check "the same bits by threads" same_hashes "$tmp/one" "$tmp/many"
seen whole --threads 2 --no-skip
check "the same bits without skips" same_hashes "$tmp/one" "$tmp/whole"
"$pitviper" frame "$tmp/one/frame_000003.pvf" --threads 3 >"$tmp/stdout" 2>"$tmp/stderr"
check "the same bits from its file" [ "$(grep -oE 'frame [0-9a-f]{64}' "$tmp/stdout" | cut -d' ' -f2)" = \
    "$(grep -oE '"frame_sha256":"[0-9a-f]{64}' "$tmp/one/truth.jsonl" | tail -1 | cut -d'"' -f4)" ]
PITVIPER_ETC=$tmp/still seen still

# Pixels of bare ground that dust changes, and how far in standard deviations of the ground
python3 - "$tmp" >"$tmp/found" <<'P'
import glob, sys
import numpy, OpenEXR, Imath
tmp = sys.argv[1]
def planes(path):
    file = OpenEXR.InputFile(path)
    box = file.header()['dataWindow']
    shape = (box.max.y + 1, box.max.x + 1)
    whole = Imath.PixelType(Imath.PixelType.UINT)
    return {n: numpy.frombuffer(file.channel(n), numpy.uint32 if c.type == whole else numpy.float32).reshape(shape)
            for n, c in file.header()['channels'].items()}
def first(out, band):
    found = planes(glob.glob(f'{tmp}/{out}/frames/{band}/*.exr')[0])
    return found[sorted(found)[0]]
for band in ('mwir', 'lwir'):
    dusty, clear = first('one', band), first('still', band)
    change = abs(dusty / clear - 1)
    print(band, int((change > 0.005).sum()), int((change == 0).sum()), change.size)
P
cat "$tmp/found"
while read -r band changed same all; do
    check "$band: dust or gas is seen" [ "$changed" -ge 20 ]
    check "$band: and most of the image is as without" [ "$same" -ge $((all / 4)) ]
done <"$tmp/found"
check "both bands" has_lines "$tmp/found" 2
finish
