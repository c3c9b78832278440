#!/usr/bin/env bash
# The same exercise anywhere along a parallel: turned about the Earth's axis, ground and all, it looks the same. Across
# the antimeridian and over the poles, where longitudes jump.
#
# What turns with the Earth is rounded otherwise: positions by 1 nm, the angles of a PDU (floats of up to pi) by 1.2e-7
# rad, 2 um on a vehicle 15 m long, ranges (floats of some 60 m) by 4 um or its neighbour. Radiances are compared where
# the sun stays where it was; where it is set back by hours the season goes on, and patterns of smoke are the world's.
. "$(dirname "$0")/common.sh"

# shown NAME CASE place.KEY=VALUE ... -- options: three frames, the first and the last and one between
shown() {
    local name=$1 case=$2 set=(); shift 2
    while [ "$1" != -- ]; do set+=("$1"); shift; done
    shift
    touch "$tmp/$case.pcap" # regress_case makes no log where there is one, and here it is not needed
    regress_case "$case"
    exercise "tests/regress/$case/scenario.yaml" "$tmp/$name.pcap" "${set[@]}"
    replay "$tmp/$name.pcap" "$tmp/$name" --no-png --only 1,4,7 --threads 1 "${case_options[@]}" --set models.sag_m=0.02 "$@"
    check "$name: a replay" [ "$code" = 0 ]
    check "$name: three frames" [ "$(wc -l <"$tmp/$name/truth.jsonl")" = 3 ]
}
# planes A B PLANES COLUMN: the largest, of the two that picture_difference compared
planes() {
    awk -v pair="pair $tmp/$1 $tmp/$2" -v planes="^($3)\$" -v name="$4" '
        $1 == "pair" { on = $0 == pair }
        on && $2 ~ planes { found++; for (i = 3; i < NF; i++) if ($i == name && $(i + 1) > most) most = $(i + 1) }
        END { print found ? most + 0 : "none" }' "$tmp/differences"
}
ids='truth\.(entity|part|material)'
# turned A B: geometry is that of A
turned() {
    check "$2: all ids of $1" [ "$(planes "$1" "$2" "$ids" changed)" = 0 ]
    check "$2: ranges within two roundings" is "$(planes "$1" "$2" 'truth\.range_m' largest)" '<=' 1.6e-5
    check "$2: normals within 2e-4, floats of small bent facets" is "$(planes "$1" "$2" 'truth\.n.' largest)" '<=' 2e-4
    check "$2: no radar power clearly another" [ "$(planes "$1" "$2" 'radar\.Y' clear)" = 0 ]
}
# pixels of a target, in the frame where it has most
largest() { json_numbers "$tmp/$1/truth.jsonl" pixels | sort -n | tail -n 1; }

# ---- the antimeridian ---------------------------------------------------------------------------
shown east antimeridian place.lon_deg=180 --
check "a target of 100 px" is "$(largest east)" '>=' 100
lon() { json_numbers "$tmp/$1/truth.jsonl" lon_deg | sort -g | sed -n "$2p"; }
check "the eye crosses: from east longitudes" is "$(lon east '$')" '>' 179.99
check "to west ones" is "$(lon east 1)" '<' -179.99
exercise tests/regress/antimeridian/scenario.yaml "$tmp/west.pcap" place.lon_deg=-180
check "-180 is 180: the same log" cmp -s "$tmp/east.pcap" "$tmp/west.pcap"
shown beside antimeridian place.lon_deg=179.9999 --
shown greenwich antimeridian place.lon_deg=0 dis.clock=2026-12-21T09:15:00Z -- --bands radar

# ---- the poles ------------------------------------------------------------------------------------
shown pole pole -- --bands radar "${coarse[@]}" # as above: no radiances
check "pole: a target of 100 px" is "$(largest pole)" '>=' 100
shown quarter pole place.lon_deg=125 dis.clock=2026-06-09T21:00:00Z -- --bands radar "${coarse[@]}"
shown half pole place.lon_deg=-145 dis.clock=2026-06-10T15:00:00Z -- --bands radar "${coarse[@]}"
sun() { json_numbers "$tmp/$1/truth.jsonl" elevation_deg | sort -g | sed -n "$2p"; }
check "pole: the sun stays at one height" is "$(awk -v a="$(sun pole 1)" -v b="$(sun pole '$')" 'BEGIN { print b - a }')" '<' 0.001
for lat in 90 -90; do
    shown at$lat pole place.lat_deg=$lat dis.clock=2026-03-20T14:00:00Z -- --bands radar "${coarse[@]}"
    check "$lat: a target of 100 px" is "$(largest at$lat)" '>=' 100
done

# ---- real ground, in two sheets that meet there ------------------------------------------------------
# sheet NAME WEST_DEG LON0: 0.05 x 0.1 degrees of hills about LON0, one side of it
sheet() {
    awk -v west="$2" -v lon0="$3" 'BEGIN {
        cell = 0.0005; n = 100; m = 200
        printf "ncols %d\nnrows %d\nxllcorner %.4f\nyllcorner -16.85\ncellsize %g\nNODATA_value -9999\n", n, m, west, cell
        for (j = 0; j < m; j++)
            for (i = 0; i < n; i++) {
                d = west + (i + 0.5) * cell - lon0; if (d < -180) d += 360
                printf "%.2f%s", 300 + 20 * sin(400 * d) + 10 * sin(500 * ((m - 1 - j + 0.5) * cell - 0.05)), i < n - 1 ? " " : "\n"
            }
    }' >"$tmp/$1.asc"
    echo 'GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]]' >"$tmp/$1.prj"
}
sheet a 179.95 180; sheet b -180 180; sheet c -0.05 0; sheet d 0 0
real() { # NAME LON SHEETS: optical and heat apart, it is night at one of them
    shown "$1" antimeridian place.lon_deg="$2" ground.elevation="$3" ground.vertical=ellipsoid -- --bands radar "${coarse[@]}" \
        --set terrain.elevation="$3" --set terrain.vertical=ellipsoid
    check "$1: two sheets without a gap" said '2 elevation sheets' && check "$1: no void between them" said '0 void posts'
}
real far 180 "$tmp/a.asc,$tmp/b.asc"
real near 0 "$tmp/c.asc,$tmp/d.asc"

# ---- compared, all by one program -------------------------------------------------------------------
pairs=(east beside east greenwich pole quarter pole half pole at90 near far)
check "compared" "$build/tests/picture_difference" "${pairs[@]/#/$tmp/}" >"$tmp/differences"
turned east beside
# 0.4 s of the sun: 1e-4 degree
check "beside: nowhere 0.1 % of a radiance" [ "$(planes east beside 'optical\..|.wir\.Y' slight)" = 0 ]
# a patch of a vehicle has four rays to the sun an hour: one that passes its own edge tells 0.02 K a day later
check "beside: temperatures within 0.05 K" is "$(planes east beside 'truth\.temp_k' largest)" '<=' 0.05
turned east greenwich
turned pole quarter
turned pole half
turned near far
check "the twin: another latitude is another picture" not [ "$(planes pole at90 "$ids" changed)" = 0 ]
finish
