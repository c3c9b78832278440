#!/usr/bin/env bash
# What is given as a file and is none: a FIFO without a writer, a folder, a device, for every kind of file that is read. Each is
# refused by what it is, at once. A pipe where one makes sense is read, and waited for until a signal ends that.
. "$(dirname "$0")/common.sh"
cd "$tmp" || exit 1
pitviper=$(cd "$OLDPWD" && realpath "$pitviper")
exercise demo "$tmp/demo.pcap" duration_s=4

for name in f.csv f.yaml f.obj f.osg f.gltf f.flt f.gtx f.tif f.pvf f.store f.sheet f.mtl; do mkfifo "$name"; done
# refuses CODE WHAT arguments: ends with that code, at once, and says WHAT it is; standard input is $in
in=/dev/null
refuses() {
    local wanted=$1 what=$2; shift 2
    timeout -k 1 20 "$pitviper" "$@" <"$in" >"$tmp/stdout" 2>"$tmp/stderr"
    code=$?
    check "$*: ends with $wanted, not $code" [ $code = "$wanted" ]
    check "$*: says that it is a $what" complained "it is a $what.*not a regular file"
}
pipe='FIFO \(named pipe\)'

# settings, each key that names a file; the first is not set up further than that
for key in sensor.table radar.table radar.given radar.library weather.atmosphere weather.day heat.given heat.vehicles heat.marks \
    terrain.store terrain.elevation terrain.geoid terrain.cover terrain.cover_table terrain.clutter_table terrain.orthophoto models.catalog \
    models.materials quality.table; do
    refuses 2 "$pipe" replay demo.pcap --out out --set $key=./f.csv
done
check "no key that names a file is left out" [ "$("$pitviper" check --default | grep -ciE '^ *#? *(table|given|library|atmosphere|day|vehicles|marks|store|elevation|geoid|cover|cover_table|clutter_table|orthophoto|catalog|materials):')" -ge 18 ]
refuses 2 'character device' replay demo.pcap --out out --set heat.given=/dev/zero
refuses 2 "$pipe" replay demo.pcap --out out -c f.yaml
refuses 1 "$pipe" replay demo.pcap --out out --sweep f.yaml
refuses 1 directory replay . --out out
refuses 1 'character device' inspect /dev/zero
refuses 1 "$pipe" check f.yaml
refuses 1 "$pipe" frame f.pvf
refuses 1 "$pipe" terrain info f.store
refuses 1 "$pipe" bench compare f.csv f.csv
refuses 1 "$pipe" exercise f.yaml -o x.pcap
mkdir case; mkfifo case/case.yaml
refuses 2 "$pipe" regress case

# models; a sidecar beside one; a material library that one names
refuses 1 "$pipe" model info f.obj
rm f.yaml
for model in f.obj f.osg f.gltf f.flt; do refuses 1 "$pipe" model info $model; done
refuses 1 "$pipe" heat f.obj -o h
refuses 1 "$pipe" rcs f.obj -o r
refuses 1 "$pipe" rcs given:f.csv -o r
printf 'mtllib f.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n' >named.obj
run model info named.obj
check "a material library that is a FIFO is left out, and that is said" eval 'said "lost: 1 external_references" && complained "no regular file, and is left out: .*f\.mtl"'
sed -i "s|f.mtl|$tmp/other/abroad.mtl|" named.obj
mkdir other; mkfifo other/abroad.mtl
run model info named.obj
check "one elsewhere is not looked for" [ "$code" = 0 ]

# terrain
cat >dem.asc <<'ASC'
ncols 3
nrows 3
xllcorner 500000
yllcorner 5200000
cellsize 30
1 2 3
4 5 6
7 8 9
ASC
echo 'PROJCS["UTM 33N",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",15],PARAMETER["scale_factor",0.9996],PARAMETER["false_easting",500000],PARAMETER["false_northing",0],UNIT["metre",1]]' >dem.prj
for option in --surface --cover --photo --canopy-height --canopy-cover --geoid; do
    refuses 1 "$pipe" terrain import dem.asc --horizon 1 -o t.store $option f.tif
done
refuses 1 "$pipe" terrain import f.tif --horizon 1 -o t.store
mv dem.prj away.prj
mkfifo dem.prj
refuses 1 "$pipe" terrain import dem.asc --horizon 1 -o t.store
rm dem.prj; mv away.prj dem.prj; mkfifo dem.asc.ovr
refuses 1 "$pipe" terrain import . --horizon 1 -o t.store
rm dem.asc.ovr
# a file that names others: the FIFO is found, and no server is asked
cat >names.vrt <<'VRT'
<VRTDataset rasterXSize="3" rasterYSize="3"><SRS>EPSG:32633</SRS><GeoTransform>500000,30,0,5200000,0,-30</GeoTransform>
<VRTRasterBand dataType="Float32" band="1"><SimpleSource><SourceFilename relativeToVRT="0">SOURCE</SourceFilename>
<SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>
VRT
sed "s|SOURCE|$tmp/f.tif|" names.vrt >fifo.vrt
refuses 1 "$pipe" terrain import fifo.vrt --horizon 1 -o t.store
python3 - "$tmp/port" >/dev/null 2>&1 <<'PY' &
import socket, sys
s = socket.socket(); s.bind(('127.0.0.1', 0)); s.listen()
open(sys.argv[1] + '.part', 'w').write(str(s.getsockname()[1]))
import os; os.rename(sys.argv[1] + '.part', sys.argv[1])
s.accept(); open(sys.argv[1] + '.asked', 'w')
PY
server=$!
until_true test -s port
sed "s|SOURCE|/vsicurl/http://127.0.0.1:$(cat port)/a.tif|" names.vrt >net.vrt
run terrain import net.vrt --horizon 1 -o t.store
check "heights from a server are refused" [ "$code" = 1 ]
run terrain import "http://127.0.0.1:$(cat port)/a.tif" --horizon 1 -o t.store
check "by its name too" [ "$code" = 1 ]
check "and no request was made" [ ! -e port.asked ]
kill $server

# probes, which read their rows from standard input
probe() { local rows=$1; shift; echo "$rows" >rows.csv; in=rows.csv; refuses 1 "$pipe" probe "$@"; in=/dev/null; }
probe lat_deg,lon_deg geoid f.gtx
probe unix_s weather f.csv
probe unix_s,surface heat-ground f.csv 20 0
probe unix_s,model heat-node f.csv 20 0
probe f_cyc_px mrtd f.sheet
probe ox_m,oy_m,oz_m,dx,dy,dz rays f.obj

# pipes that make sense
check "settings of a shell's pipe" eval '"$pitviper" check <(echo "sensor: {width_px: 64}") >/dev/null 2>&1'
"$pitviper" inspect demo.pcap | sed 1d >file.txt
"$pitviper" inspect <(cat demo.pcap) | sed 1d >pipe.txt
check "a log of a pipe" cmp file.txt pipe.txt
mkfifo log.fifo
(gzip -c demo.pcap >log.fifo) &
"$pitviper" inspect log.fifo | sed 1d >fifo.txt
check "a log of a FIFO, packed" cmp file.txt fifo.txt
"$pitviper" replay log.fifo --out out >stdout 2>stderr &
waiting=$!
until_true eval '[ -e /proc/$waiting/fd ] && ls -l /proc/$waiting/fd | grep -q log.fifo'
kill -TERM $waiting
wait $waiting
check "a wait for a FIFO ends by SIGTERM, with its code" [ $? = 143 ]
finish
