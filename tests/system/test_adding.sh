#!/usr/bin/env bash
# etc/ADDING.md: its commands as they stand there, in an empty folder: a vehicle, a material, a sensor; the shape's code
# compiles; a channel by files alone. And whose rows win, and what a file of the wrong size is told.
. "$(dirname "$0")/common.sh"
here=$PWD
real=$(realpath "$pitviper")
mkdir "$tmp/bin" "$tmp/work"
# as a user has it on the path; pictures small, one frame, quickly begun, which is all that is left out
cat >"$tmp/bin/pitviper" <<END
#!/bin/sh
case \$1 in replay) exec "$real" "\$@" --size 64x48 --only 0 --no-png --threads 1 ${bare[*]} ${coarse[*]} ;; *) exec "$real" "\$@" ;; esac
END
chmod +x "$tmp/bin/pitviper"
blocks() { awk -v head="$1" '$0 ~ "^ *```" head "$" { on = 1; next } /^ *```/ { on = 0 } on' etc/ADDING.md; }
recipe() { # recipe NAME: its blocks, one script
    blocks "sh $1" >"$tmp/$1.sh"
    check "$1: has commands" [ -s "$tmp/$1.sh" ]
    (cd "$tmp/work" && PATH=$tmp/bin:$PATH bash -eu "$tmp/$1.sh") >"$tmp/stdout" 2>"$tmp/stderr"
    code=$?
    check "$1: every command ends well" [ $code = 0 ]
    [ $code = 0 ] || tail -n 5 "$tmp/stderr"
}
box() { # box NAME X Y Z DX DY DZ FIRST: a block from x y z, its vertices numbered from FIRST
    awk -v n="$1" -v x="$2" -v y="$3" -v z="$4" -v a="$5" -v b="$6" -v c="$7" -v f="$8" 'BEGIN {
        for (k = 0; k < 8; k++) print "v", x + a * (k % 2), y + b * (int(k / 2) % 2), z + c * int(k / 4)
        print "o " n
        split("1 3 4 2 5 6 8 7 1 2 6 5 2 4 8 6 4 3 7 8 3 1 5 7", i, " ")
        for (k = 0; k < 6; k++) print "f", f+i[4*k+1]-1, f+i[4*k+2]-1, f+i[4*k+3]-1, f+i[4*k+4]-1 }'
}
# millimetres, x forward, z up: 12 x 6 x 4 m with its turret
{ box hull -6000 -3000 0 12000 6000 3000 1; box turret -1000 -1000 3000 2000 2000 1000 9; } >"$tmp/work/hovercraft.obj"
exercise demo "$tmp/work/exercise.pcap"

# ---- a vehicle
"$real" model info "$tmp/work/hovercraft.obj" --length 12 --width 6 --height 4 >"$tmp/info"
check "the size asked for, and what would give it" grep -qF "\`axes: '+x +z'\`" "$tmp/info"
check "the unit" grep -qF '`scale: 0.001` (the file is in millimetres)' "$tmp/info"
recipe vehicle
check "vehicle: no warning of its size" not grep -q 'catalog: .*is .* x ' "$tmp/stderr"
check "vehicle: it is listed, first, with its turret" grep -qE '1\.1\.222\.1\.\*.*hovercraft\.obj +12\.00 x 6\.00 x 4\.00 .*catalog\.csv:2 .*primary_turret_1 azimuth' "$tmp/stdout"
check "vehicle: truth says so" grep -q '"hovercraft"' "$tmp/work/out-vehicle/truth.jsonl"
check "vehicle: what it does not have is of etc/catalog.csv" grep -q '"truck"' "$tmp/work/out-vehicle/truth.jsonl"
check "vehicle: a picture of 8 sides" [ "$(head -c 24 "$tmp/work/hovercraft.png" | od -An -tu1 -j16 | awk '{ print $3 * 256 + $4, $7 * 256 + $8 }')" = "1440 540" ]

# the file as it comes, against the row and against what such types usually measure
mkdir "$tmp/raw"
cp "$tmp/work/hovercraft.obj" "$tmp/raw/"
printf 'models:\n  catalog: c.csv\n' >"$tmp/raw/node.yaml"
printf 'type,model,origin,length_m,width_m,height_m\n1.1.222.1,hovercraft.obj,base,12,6,4\n' >"$tmp/raw/c.csv"
run check "$tmp/raw/node.yaml"
check "wrong size: figures of both" complained "c\.csv:2: .*4e\+03 x 1.2e\+04 x 6e\+03 m .* but the row says 12 x 6 x 4"
check "wrong size: the remedy" complained "axes: '\+x \+z'.*scale: 0\.001.*millimetres"
printf 'scale: 0.0008\n' >"$tmp/raw/hovercraft.yaml"
printf 'type,model,origin\n1.1.222.1.*,hovercraft.obj,base\n' >"$tmp/raw/c.csv"
run check "$tmp/raw/node.yaml"
check "no size in the row: the type's own" complained "3\.2 x 9\.6 x 4\.8 m .* but etc/catalog\.csv:[0-9]+ \(tank.*says 9\.53 x 3\.59 x 2\.6: .*axes: '\+x \+z'"
printf "scale: 0.0254\naxes: '+x +z'\n" >"$tmp/raw/hovercraft.yaml"
printf 'type,model,origin,length_m,width_m,height_m\n1.1.222.1,hovercraft.obj,base,12,6,4\n' >"$tmp/raw/c.csv"
run check "$tmp/raw/node.yaml"
check "only the unit is wrong" complained 'says 12 x 6 x 4: `scale: 0\.001` in its sidecar'

# ---- a material
recipe material
check "material: another colour" not cmp -s "$tmp/work/hovercraft.png" "$tmp/work/orange.png"
run check "$tmp/work/node.yaml"
sed -i 's/models.materials.*//; /materials:/d' "$tmp/work/node.yaml"
run check "$tmp/work/node.yaml"
check "material: without its row it is said" complained "hovercraft.yaml:3: materials: 'paint_orange' is not a row"
check "material: and where that came from" complained 'node.yaml:2: models.catalog: see the error above'

# ---- a sensor
recipe sensor
check "sensor: it is what was chosen" grep -q '^lwir: my_camera, F/2' "$tmp/stdout"
run replay "$tmp/work/exercise.pcap" --set sensor.table="$tmp/work/sensors.csv" --set sensor.preset=nobodys --out "$tmp/o"
check "sensor: one that neither table has" complained "no sensor named 'nobodys' \(nor in .*sensors.csv\); there are: staring_lwir"
run replay "$tmp/work/exercise.pcap" --set sensor.table="$tmp/work/sensors.csv" --out "$tmp/o"
check "sensor: a table and no name" complained 'sensors.csv is a table of sensors; choose one'

# ---- a shape
blocks 'c shape' >"$tmp/parametric_kiosk.c"
check "shape: code" [ -s "$tmp/parametric_kiosk.c" ]
declaration=$(grep -oE 'Status parametric_kiosk\(Model \*out, double sag_m\);' etc/ADDING.md | head -n 1)
row=$(grep -oE '\{"kiosk", parametric_kiosk, NULL\},' etc/ADDING.md | head -n 1)
check "shape: declaration and row" [ -n "$declaration" -a -n "$row" ]
sed "s|^static const struct {|$declaration\n&|; s|^    {\"tank\", parametric_tank, NULL},|    $row\n&|" entities/shapes/parametric.c >"$tmp/parametric.c"
check "shape: the row is in" grep -q kiosk "$tmp/parametric.c"
for file in parametric_kiosk parametric; do
    check "shape: $file.c compiles" "${CC:-cc}" -std=gnu17 -D_GNU_SOURCE -Wall -Werror -Wno-missing-prototypes -I. -include entities/shapes/parametric.h -fsyntax-only "$tmp/$file.c"
done

# ---- what is listed is there
# shellcheck disable=SC2016
for path in $(grep -oE '`(etc|dis|terrain|render|sensor|entities|tests)/[a-z0-9_./]+`' etc/ADDING.md | tr -d '`' | sort -u); do
    case $path in */kiosk.c|*/) continue ;; esac
    check "listed and there: $path" [ -e "$path" ]
done

# ---- a channel: 8-14 um in lwir's place, by files alone, through a response of its own; its figures are lwir's own
etc=$tmp/etc
mkdir "$etc"
cp -r etc/*.csv etc/atmosphere "$etc/"
awk -F, '/^#/ { print; next } { print $0 (++n == 1 ? ",response" : ",") }' "$etc/channels.csv" >"$etc/channels.new" && mv "$etc/channels.new" "$etc/channels.csv"
echo 'lwir_wide,8,14,emissive,lwir,a microbolometer,bolometer.csv' >>"$etc/channels.csv"
printf 'wavelength_um,response\n8,0.9\n11,1\n14,0.5\n' >"$etc/bolometer.csv"
echo 'lwir_wide,8,14,1.9' >>"$etc/atmosphere/bands.csv"
column() { # column FILE OLD NEW: a copy of a column at the end
    awk -F, -v old="$2" -v new="$3" '/^#/ || !NF { print; next } !h { for (i = 1; i <= NF; i++) if ($i == old) h = i; print $0 "," new; next } { print $0 "," $h }' "$1" >"$1.new" && mv "$1.new" "$1"
}
column "$etc/materials.csv" rho_lwir rho_lwir_wide
column "$etc/effects.csv" ext_lwir ext_lwir_wide
column "$etc/effects.csv" albedo_lwir albedo_lwir_wide
tables() { # tables FOLDER FILE KEYS PREFIX...: FILE_lwir_wide.csv: its keys and the columns <prefix>lwir, named anew
    folder=$1 file=$2 keys=$3; shift 3
    awk -F, -v keys="$keys" -v want="$*" '/^#/ { next } !n { split(want, p, " "); for (k in p) { if (p[k] == "-") p[k] = ""; m++ }
        for (i = 1; i <= keys; i++) line = line (i > 1 ? "," : "") $i
        for (k = 1; k <= m; k++) { for (i = 1; i <= NF; i++) if ($i == p[k] "lwir") at[k] = i; line = line "," p[k] "lwir_wide" }
        print line; n = 1; next }
        { line = $1; for (i = 2; i <= keys; i++) line = line "," $i; for (k = 1; k <= m; k++) line = line "," $at[k]; print line }' \
        "$folder/$file.csv" >"$folder/${file}_lwir_wide.csv"
}
for model in us1976; do
    a=$etc/atmosphere/$model
    tables "$a" phase 2 -
    tables "$a/clear" air 1 extinction_ scatter_
    cp "$a/clear/paths_lwir.csv" "$a/clear/paths_lwir_wide.csv"
    for v in "$a"/[0-9]*; do
        tables "$v" haze 1 extinction_ scatter_
        tables "$v" sun 2 direct_ diffuse_
        tables "$v" sky_thermal 2 -
        [ ! -e "$v/paths_lwir.csv" ] || cp "$v/paths_lwir.csv" "$v/paths_lwir_wide.csv"
        [ ! -e "$v/sky_scattered.csv" ] || tables "$v" sky_scattered 4 -
        [ ! -e "$v/scattered.csv" ] || tables "$v" scattered 5 -
    done
done
grep '^staring_lwir,' "$etc/sensors.csv" | sed 's/^staring_lwir,lwir/bolometer,lwir_wide/' >>"$etc/sensors.csv"
PITVIPER_ETC=$etc run replay "$tmp/work/exercise.pcap" --bands optical,lwir_wide --set sensor.preset=bolometer --size 64x48 --only 0 --no-png --threads 1 "${coarse[@]}" --out "$tmp/wide"
check "channel: it runs" [ $code = 0 ]
check "channel: a picture" [ -s "$tmp/wide/frames/lwir_wide/000000.exr" ]
check "channel: truth has its sums" grep -q '"lwir_wide":{"contrast_k"' "$tmp/wide/truth.jsonl"
check "channel: a detector looks at it" grep -q '^lwir_wide: bolometer, F/2' "$tmp/stdout"
check "channel: run.json" grep -q 'optical,lwir_wide' "$tmp/wide/run.json"
check "channel: its response is among the tables used" grep -q '"bolometer.csv"' "$tmp/wide/run.json"
check "channel: its air is not the weather's, which is said" grep -qE '^air: lwir_wide keeps the clear air of us1976 \(15 C and 5\.9 g/m3 .* the weather has 15 C and 7\.7' "$tmp/stdout"
sed -i 's/^11,1$/11,0.95/' "$etc/bolometer.csv"
PITVIPER_ETC=$etc run replay "$tmp/work/exercise.pcap" --bands lwir_wide --out "$tmp/o"
check "channel: a response that is not relative to its greatest" complained 'bolometer.csv: the greatest response is 0.95, and must be 1'
sed -i 's/^11,0.95$/11,1/' "$etc/bolometer.csv"
sed -i 's/,ext_lwir_wide/,ext_other/' "$etc/effects.csv"
PITVIPER_ETC=$etc run replay "$tmp/work/exercise.pcap" --bands lwir_wide --size 64x48 --only 0 --no-png --threads 1 "${coarse[@]}" --out "$tmp/wide2"
check "channel: a column that is missing" complained 'effects.csv.*ext_lwir_wide'
run replay "$tmp/work/exercise.pcap" --bands lwir,lwir_wide --out "$tmp/o"
check "channel: no such" complained "'lwir,lwir_wide' is not a list of .*mwir, lwir, swir"
run replay "$tmp/work/exercise.pcap" --bands swir,optical --out "$tmp/o"
check "channel: one of a place" complained 'swir takes the place of another'
cd "$here" || exit 1
finish
