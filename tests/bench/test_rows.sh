#!/usr/bin/env bash
# bash tests/bench/test_rows.sh BUILD SUITE[/ROOM]: the rows of a suite of `pitviper bench`, or of one room's part of it, quickly:
# they are there and whole, and every error that has a limit keeps it. No time is judged. tests/CMakeLists.txt lists the
# groups. What the command says, compares and refuses: tests/system/test_bench.sh.
group=$2
. tests/system/common.sh
. tests/system/bench_rows.sh
judges python3

unset PITVIPER_DATA
suite=${group%/*}
run bench "$group" --quick --threads 2 --csv "$tmp/rows.csv" --report "$tmp/rows.html"
ends_whole "$tmp/rows.csv" 3
check "a chapter of the page" grep -q "<h2 id=\"$suite\">" "$tmp/rows.html"
check "the page is HTML" python3 tests/system/bench_page.py "$tmp/rows.html" 3

some_have_limits() { check "some rows have a limit" [ "$(grep -c "^$suite,.*,yes," "$tmp/rows.csv")" -ge 2 ]; }
# rows WHAT ...: there is one of each
rows() {
    local what
    for what in "$@"; do check "a row: $what" grep -q "^$suite,.*$what" "$tmp/rows.csv"; done
}
# tunables NAME ...: every approximation has one default, whose error is what is stated, and other settings
tunables() {
    local name
    for name in "$@"; do
        check "one default of: $name" [ "$(grep -cE "^precision,\"?$name: .*,yes,.*,(\* )?default$" "$tmp/rows.csv")" = 1 ]
        check "other settings of: $name" \
            [ "$(grep -E "^precision,\"?$name: .*,(\*|)$" "$tmp/rows.csv" | grep -vc "settings better")" -ge 1 ]
        rows "$name: settings better than the default"
    done
}

case $group in
speed)
    some_have_limits
    rows "ground: " "ground: pyramid" "40 m up: frame" "100 m up: frame" "300 m up: frame" "1000 m up: frame" \
        "rays alone" "one ray a pixel" "1 thread: snapshot" "1 thread: air" "1 thread: visibility" "1 thread: sun rays" \
        "1 thread: shading" "small targets" "pass over edges" "truth of targets" "hash of the planes" "256 x 256" \
        "close target: one ray a pixel" "adaptive edges" "1 thread: frame" "optical alone, one ray" "radar alone" \
        "files of a frame" "heat of the ground: spin-up" "heat of the ground: a step" "heat of the ground: shadows of a day" \
        "heat of the ground: a hit, with shadows" "heat of the ground: a hit, without" "heat of the ground: 100 m up.*as the air" \
        "heat of the ground: 100 m up.*no shadows" "heat of the ground: 100 m up.*with shadows" "heat of a vehicle: a step" \
        "heat of the vehicles: the longest" "heat of the vehicles: the mean" "100 m up: default quality.*,yes," \
        "set-up: ground" "set-up: catalog" "set-up: places of plants" "set-up: plants grown" "set-up: ground warmed up" \
        "set-up: twenty tanks" "set-up: all" "sweep: a variant" "air: tables of a frame.*,yes," "air: the same from 10 km.*,yes," \
        "sea: frame from 20 m, level, rays bend.*,yes," "sea: frame from 10 km, level, rays bend.*,yes," \
        "beyond: frame from 14 km, the horizon.*,yes," "beyond: frame from 99 km, the horizon.*,yes," \
        "gloss: unlit side of a close target.*,yes," "gloss: the same, without contact shadows" \
        "twilight: optical frame and its display, sun at -6 degrees.*,yes," \
        "twilight: optical frame and its display, sun at -18 degrees.*,yes," "memory: posts" "memory: arena" "memory: resident"
    run bench speed --quick --size 17
    check "a size that is none is refused" [ $code = 2 ]
    check "and said" complained "size: '17' is not"
    run bench speed --quick --ground 1x1 --model "$tmp/none.obj"
    check "a model that is not there is refused" [ $code = 2 ]
    check "and said, too" complained "none.obj" ;;
skip)
    rows "outside a block" "by their sphere" "parts missed" "behind the part that was met" "below a block" "walked together" \
        "sun rays miss" "stops the sun" "too low to stop" "nothing behind" "beside a small target" "first rays" "smoke" \
        "all of them" "bands nobody asked for" "planes nobody asked for" ;;
network)
    some_have_limits
    rows "IPv4: datagrams" "IPv4: bundles" "IPv4: arrival to taken" "IPv4: most" recorder "live node: ready" \
        "live node: reports heard" "live node: arrival to pose" "live node: frame time to published" "live node: memory" ;;
loop)
    for case in "default quality" "one ray a pixel"; do
        rows "a host's loop, 256 x 256, $case: pose sent to work begun" "$case: light, rendering" "$case: rendered to in shared memory" \
            "$case: to taken by the recogniser" "$case: answer sent to received" "$case: pose to the next pose"
    done ;;
crowd) ;;
precision/terrain)
    tunables "Earth to local frame" "latitude. longitude. height" "geoid between posts" "the sun's place" "powers of two" \
        "spacing of invented ground" "reach of the finest level" "height of a post" "detail: weakest octave" \
        "posts of terrain from files" ;;
precision/entities)
    tunables "dead reckoning" ;;
precision/render)
    tunables "radiance of a black body" "temperature of a radiance" "light on the ground" "smoke along a ray" \
        "air before a pixel. visible" "air before a pixel. thermal" "radiance of the sky" "light of the sky on a plane" \
        "range to the ground" "range to a part" "steps of the ground's heat" "elements of the ground's heat" \
        "slopes of the ground's heat" "steps of a vehicle's heat" "patches of a vehicle" "cells of past shade" \
        "ray tubes a wavelength" "mirrors of a ray tube"
    for when in morning noon afternoon; do
        for kind in grass bare_soil road sand; do
            for then in "in it" afterwards; do rows "shade of the $when, $then, $kind: colder by.*,yes,"; done
        done
    done
    rows "shade of past hours: ground that was never shaded" "weather: transmittance, 3.4-4.8 um.*,yes," \
        "weather: longwave.*,yes," "weather: rain.*,yes," "weather: direct sun.*,yes," \
        "daylight, b, sun from 18 degrees" "daylight, nir, sun 8 degrees up" "limb: sky past the Earth, 3.4-4.8 um.*,yes," \
        "limb: sky past the Earth, 8-12 um.*,yes," "limb: ground to the horizon, 3.4-4.8 um.*,yes," \
        "limb: ground to the horizon, 8-12 um.*,yes," "faces: unlit sides of a box, over grass.*,yes," \
        "faces: unlit sides of a box, over snow.*,yes," ;;
precision/sensor)
    tunables "plants simplified" "rays a pixel among plants" "reach of low plants" "light between leaves" "rays a pixel" \
        "rays a pixel. 8-12 um" "rays over a small target" "light from all around" "mirrors of a radar path" \
        "rays a pixel. radar" "facets" "facets. silhouette" "optics' blur" "a small target's place" "electrons of a radiance" \
        "display" "converter" "display's curve" "display's colours"
    some_have_limits
    rows "steps of sampling: bare ground, quarter: horizon" "steps of sampling: 20 vehicles, 8-12 um, checkerboard: targets whole" \
        "steps of sampling: woods, default: woods, means of 4 x 4" "steps of sampling: flight on a vehicle, quarter: stated error" ;;
stability/dis)
    rows "time stamp to seconds" "exercise clock unwrapped" "denormals, infinities" ;;
stability/terrain)
    rows "latitude, longitude, height to ECEF" "ENU axes: jump" "1000 km away" "origins anywhere" "sun over leap seconds" \
        "geoid: a pole" "ground: cliffs" "ground of files: voids" ;;
stability/entities)
    rows "dead reckoning, nine algorithms" "turn to turn" "psi, theta, phi" "turrets at any angle" "Entity State: each float" \
        "Detonation: each float" "scenario: each key" "effects.csv" "probes: each column" "built-in models" "1e6 to 1" \
        "model files: needles" ;;
stability/render)
    rows "parts: a plate" "parts: needles" leaks "ground: rough" "by eights" "light: Planck" "light: smoke" "sun: " "air: any weather" "air: across" \
        "refraction: eyes" "refraction: dip" "beyond: dip" "beyond: tangent" "beyond: height across" "beyond: pictures" \
        "gloss: factors" "gloss: white blocks" "gloss: any paint" \
        "picture: a block" "any place on Earth" "8192 x 1" "crowd: " "eye: in a block" "radar: " "plants: leaves edge-on" \
        "plants: skimmed tops" "plants: trees at the origin and 200 km" "plants: a million trees" "heat: 1 K to 2000 K" \
        "heat: the same: energy" "heat: polar day and night" "heat: 1950 and 2090" "heat: seven threads" \
        "heat: back and forth in time" "network: 1 K to 2000 K" "network: the same: temperatures" "scenery: eyes in a street" \
        "scenery: at the poles" "scenery: 1 .. 200 km" "scenery: an eye at 1 um" "scenery: eyes within" "scenery: temperatures" ;;
stability/sensor)
    rows "detector: " "display: " "threads: " "twilight: displays, sun" "twilight: displays, largest" "twilight: displays grow" ;;
woods)
    for view in "100 m up, 5 degrees down" "300 m up, 10 degrees down" "300 m up, 8 down, 6 wide" "1000 m up, 20 degrees down"; do
        rows "$view: one ray a pixel, full detail.*planes of one thread, nothing skipped\",yes,"
        rows "$view: one ray a pixel, tables.*planes of one thread, nothing skipped\",yes,"
        rows "$view: default quality, full detail" "$view: default quality: pixels sampled again"
        for plane in red green blue "3-5 um" "8-12 um"; do rows "$view: tables, $plane"; done
        rows "$view: default quality, tables" "$view: tables: cover"
        for plane in red "3-5 um" "8-12 um"; do
            for figure in mean "mean, one ray" "one ray, blocks of 4 px" "one ray, blocks of 8 px" "structural error, blocks of 4 px" \
                "contrast of a pixel, one ray" "contrast of a pixel" "autocorrelation length"; do
                rows "$view: tables, $plane: $figure"
            done
        done
    done
    rows "seeker: optical, 8-12 um, radar, with truth, all threads.*planes and map of one thread, nothing skipped\",yes," \
        "seeker: optical, 1 thread" "seeker: radar, 1 thread: echoes summed"
    rows "memory: with frames of all views, full detail.*,yes," "woods: set-up of tables" "memory: with a forest of tables" \
        "tables: visible share of vehicles, as in frames" "tables: visible share of vehicles, by its plants alone" \
        "tables, red: false alarms" "tables, 8-12 um: false alarms" "tables: vehicles by their surroundings: AUC" \
        "tables: told from full detail: AUC" "flight: tables, red: change of representation, pixels" \
        "flight: tables, 8-12 um: change from frame to frame, blocks of 4 px" "flight: first frame over the median, tables" \
        "flight: slowest frame over the median, tables"
    run bench woods --quick --parts errors+flights
    check "a part that is none is refused" [ $code = 2 ]
    check "and said" complained "parts: .errors.flights. is not"
    run bench woods --quick --views 15
    check "a view that is none is refused" [ $code = 2 ]
    check "and said" complained "views: .15. is not" ;;
*) fail "no rows are known of $group" ;;
esac

finish
