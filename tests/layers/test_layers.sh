#!/usr/bin/env bash
# Which folder may include which. A link alone does not prove it: an object that is already pulled in satisfies a call
# backwards. labels: small
set -u
cd "$(dirname "$0")/../.."

# room_of FILE: base, dis, terrain, entities, render, sensor or top (main.c and programs under etc/)
room_of() {
    local path=${1#tests/}
    case $path in
        dis/*|terrain/*|entities/*|render/*|sensor/*|base/*|fuzz/*|analytic/*) echo "${path%%/*}" ;;
        pitviper*) echo base ;;
        *) echo top ;;
    esac
}

# allowed ROOM HEADER FILE
allowed() {
    case $2 in
        pitviper.h|pitviper_channels.h) return 0 ;;
        # the workshop is no part of the product
        sensor/bench/*) case $3 in sensor/bench/*|tests/*|main.c) return 0 ;; *) return 1 ;; esac ;;
        tests/*) return 0 ;; # only tests have reason to, see below
    esac
    case $1:$2 in
        base:*) return 1 ;;
        dis:dis/*) ;;
        terrain:terrain/*) ;;
        entities:entities/*|entities:dis/*|entities:terrain/*) ;;
        # a Snapshot and the terrain, never a PDU or the table; pdu.h for its ids alone
        render:render/*|render:terrain/*) ;;
        render:entities/models/model.h|render:entities/import/model_import.h|render:entities/models/catalog.h|render:entities/table/snapshot.h|render:dis/pdu.h) ;;
        sensor:dis/*|sensor:terrain/*|sensor:entities/*|sensor:render/*|sensor:sensor/*) ;;
        top:*|fuzz:*|analytic:*) ;;
        *) return 1 ;;
    esac
}

# Libraries that one file, or one folder, knows: header pattern, place.
wrapped() {
    case $1 in
        GeographicLib/*) echo 'terrain/*.cpp' ;;
        gdal*|cpl_*|ogr_*) echo 'terrain/elevation/raster.c' ;;
        erfa.h) echo 'terrain/*' ;;
        OpenImageIO/*) echo 'sensor/publish/*.cpp' ;;
        embree*) echo 'render/*' ;;
        pcap*) echo 'dis/*' ;;
        assimp/*) echo 'entities/import/assimp.c' ;;
        fftw3.h) echo 'sensor/detector/transform.c' ;;
        jansson.h) echo 'sensor/publish/*' ;;
        *) echo '*' ;;
    esac
}

# check ROOT: a line for each include that is not allowed
check() (
    cd "$1" || exit
    find . -path ./build -prune -o -path './build-*' -prune -o -path ./.git -prune -o \
        -type f \( -name '*.c' -o -name '*.h' -o -name '*.cpp' \) -print | sed 's#^\./##' | sort |
    while read -r file; do
        room=$(room_of "$file")
        sed -nE 's/^[[:space:]]*#[[:space:]]*include[[:space:]]*([<"])([^>"]+)[>"].*/\1 \2/p' "$file" |
        while read -r kind header; do
            if [ "$kind" = '<' ]; then
                # the judges of a library's results may ask it
                case $file in tests/*|sensor/bench/*) continue ;; esac
                place=$(wrapped "$header")
                # shellcheck disable=SC2254
                case $file in $place) ;; *) echo "$file: <$header> belongs to $place alone" ;; esac
                continue
            fi
            if [[ $header == tests/* && $file != tests/* ]]; then
                echo "$file: product code includes $header"
            elif ! allowed "$room" "$header" "$file"; then
                echo "$file: $room may not include $header"
            elif [[ $header == *_private.h && ${header%/*} != "${file%/*}" && $file != sensor/bench/* ]]; then
                echo "$file: $header is private to ${header%/*}/"
            fi
        done
    done
)

# The twin: each planted include must be caught, each good one passed.
twin() {
    local tree wrong=0 file header
    tree=$(mktemp -d) || exit 1
    plant() { mkdir -p "$tree/$(dirname "$1")" && printf '#include %s\n' "$2" >"$tree/$1"; }
    while read -r verdict file header; do
        rm -rf "${tree:?}"/*
        plant "$file" "$header"
        found=$(check "$tree")
        if [ "$verdict" = bad ] && [ -z "$found" ]; then echo "twin: not caught: $header in $file"; wrong=1; fi
        if [ "$verdict" = good ] && [ -n "$found" ]; then echo "twin: wrongly caught: $found"; wrong=1; fi
    done <<'PLANTED'
bad pitviper_log.c "dis/pdu.h"
bad pitviper_log.c "sensor/bench/bench_private.h"
bad dis/pdu.c "sensor/bench/bench_private.h"
good sensor/bench/run.c "sensor/bench/bench_private.h"
good sensor/bench/render/precision_air.c "render/air/air_private.h"
bad sensor/node/live.c "sensor/bench/quality.h"
bad sensor/publish/html.c "sensor/bench/bench.h"
bad dis/pdu.c "terrain/earth/geodesy.h"
bad dis/pdu.c "entities/models/model.h"
bad terrain/earth/sun.c "dis/pdu.h"
bad entities/models/model.c "render/frame/render.h"
bad render/frame/render.c "entities/table/entity_table.h"
bad render/frame/render.c "dis/entity_state.h"
bad render/frame/render.c "sensor/detector/detector.h"
bad tests/dis/test_pdu.c "entities/models/model.h"
bad tests/render/test_render.c "sensor/publish/plane.h"
bad sensor/node/loop.c "render/parts/parts_private.h"
bad sensor/node/loop.c "loop.h"
bad dis/pdu.c "tests/check.h"
bad entities/models/model.c <GeographicLib/Geocentric.hpp>
bad sensor/truth/truth.c <jansson.h>
bad terrain/earth/geoid.c <gdal.h>
bad sensor/detector/scan.c <fftw3.h>
bad entities/models/sidecar.c <assimp/scene.h>
good dis/pdu.c "pitviper.h"
good dis/pdu.c "dis/reader_private.h"
good entities/table/entity_table.c "dis/entity_state.h"
good render/frame/render.c "entities/table/snapshot.h"
good sensor/node/loop.c "dis/log.h"
good sensor/publish/truth.c <jansson.h>
good tests/dis/test_pdu.c "tests/check.h"
good main.c "sensor/node/replay.h"
PLANTED
    rm -rf "$tree"
    return $wrong
}

twin || exit 1
violations=$(check .)
if [ -n "$violations" ]; then
    echo "$violations"
    echo "layers: $(echo "$violations" | wc -l) includes against the table in tests/layers/test_layers.sh"
    exit 1
fi
echo "layers: $(find dis terrain entities render sensor -name '*.[ch]*' | wc -l) files keep to their rooms"
