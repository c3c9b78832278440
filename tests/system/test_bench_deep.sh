#!/usr/bin/env bash
# pitviper bench all, quickly: every suite's rows are there and whole, and every error that has a limit keeps it. No time
# is judged. What the command says, compares and refuses: test_bench.sh. labels: deep
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/bench_rows.sh"
judges python3

unset PITVIPER_DATA
run bench all --quick --threads 2 --csv "$tmp/all.csv" --report "$tmp/all.html"
ends_whole "$tmp/all.csv"
for suite in dis network speed; do
    check "$suite: some rows have a limit" [ "$(grep -c "^$suite,.*,yes," "$tmp/all.csv")" -ge 2 ]
    check "$suite: a chapter of the page" grep -q "<h2 id=\"$suite\">" "$tmp/all.html"
done
# table SUITE: its rows
table() { grep "^$1," "$tmp/all.csv" >"$tmp/$1.csv"; }
# has SUITE WHAT
has() { check "$1 has a row: $2" grep -q "^$1,.*$2" "$tmp/$1.csv"; }

table dis
for what in "Entity State: decode" "Entity State: encode" "Fire: decode" "Detonation: encode" bundles "capture: read" \
            "report: walk" "report: update alone" "snapshot"; do has dis "$what"; done

table speed
for what in "ground: " "ground: pyramid" "40 m up: frame" "100 m up: frame" "300 m up: frame" "1000 m up: frame" \
            "rays alone" "one ray a pixel" "1 thread: snapshot" "1 thread: air" "1 thread: visibility" \
            "1 thread: sun rays" \
            "1 thread: shading" "small targets" "pass over edges" "truth of targets" "hash of the planes" "256 x 256" \
            "close target: one ray a pixel" "adaptive edges" "1 thread: frame" "optical alone, one ray" \
            "radar alone" "files of a frame" "heat of the ground: spin-up" "heat of the ground: a step" \
            "heat of the ground: shadows of a day" "heat of the ground: a hit, with shadows" \
            "heat of the ground: a hit, without" "heat of the ground: 100 m up.*as the air" \
            "heat of the ground: 100 m up.*no shadows" "heat of the ground: 100 m up.*with shadows" "heat of a vehicle: a step" "heat of the vehicles: the longest" "heat of the vehicles: the mean" \
            "100 m up: default quality.*,yes," "set-up: ground" "set-up: catalog" "set-up: places of plants" "set-up: plants grown" \
            "set-up: ground warmed up" "set-up: twenty tanks" "set-up: all" "sweep: a variant" \
            "memory: posts" "memory: arena" "memory: resident"; do
    has speed "$what"
done

table skip
for what in "outside a block" "by their sphere" "parts missed" "behind the part that was met" "below a block" \
            "walked together" \
            "sun rays miss" "stops the sun" "too low to stop" "nothing behind" "beside a small target" \
            "first rays" "smoke" \
            "all of them" "bands nobody asked for" "planes nobody asked for"; do has skip "$what"; done

table network
for what in "IPv4: datagrams" "IPv4: bundles" "IPv4: arrival to taken" "IPv4: most" recorder "live node: ready" \
            "live node: reports heard" \
            "live node: arrival to pose" "live node: frame time to published" "live node: memory"; do
    has network "$what"
done

# every approximation has its knob, with one default each, whose error is what is stated
table precision
for knob in "Earth to local frame" "latitude. longitude. height" "geoid between posts" "the sun's place" \
            "powers of two" \
            "spacing of invented ground" "reach of the finest level" "height of a post" "detail: weakest octave" "posts of terrain from files" \
            "dead reckoning" "radiance of a black body" "temperature of a radiance" \
            "plants simplified" "rays a pixel among plants" "reach of low plants" "light between leaves" \
            "light on the ground" "smoke along a ray" "air before a pixel. visible" "air before a pixel. thermal" \
            "radiance of the sky" "light of the sky on a plane" "range to the ground" "range to a part" "rays a pixel" \
            "rays a pixel. 8-12 um" "rays over a small target" "light from all around" "mirrors of a radar path" \
            "rays a pixel. radar" "facets" "facets. silhouette" "optics' blur" "a small target's place" "electrons of a radiance" \
            "steps of the ground's heat" "elements of the ground's heat" "slopes of the ground's heat" "steps of a vehicle's heat" "patches of a vehicle" \
            "cells of past shade" "display" "converter" \
            "display's curve" "ray tubes a wavelength" "mirrors of a ray tube"; do
    check "precision has one default of: $knob" \
        [ "$(grep -cE "^precision,\"?$knob: .*,yes,.*,(\* )?default$" "$tmp/precision.csv")" = 1 ]
    check "precision has other settings of: $knob" \
        [ "$(grep -E "^precision,\"?$knob: .*,(\*|)$" "$tmp/precision.csv" | grep -vc "settings better")" -ge 1 ]
    has precision "$knob: settings better than the default"
done
for when in morning noon afternoon; do
    for kind in grass bare_soil road sand; do
        for then in "in it" afterwards; do has precision "shade of the $when, $then, $kind: colder by.*,yes,"; done
    done
done
has precision "shade of past hours: ground that was never shaded"

# ---- the page, and a run beside itself
check "the page is HTML" python3 tests/system/bench_page.py "$tmp/all.html" 90
run bench compare "$tmp/all.csv" "$tmp/all.csv" --slower 1.01
check "a run is like itself" [ $code = 0 ]
rows=$(grep -c within\ noise "$tmp/stdout")
check "in every row" grep -qE "^($((rows - 1))) rows in both: \1 within noise" "$tmp/stdout"

table stability
for what in "time stamp to seconds" "exercise clock unwrapped" "denormals, infinities" \
            "latitude, longitude, height to ECEF" "ENU axes: jump" \
            "1000 km away" "origins anywhere" "sun over leap seconds" "geoid: a pole" "ground: cliffs" \
            "ground of files: voids" \
            "dead reckoning, nine algorithms" "turn to turn" "psi, theta, phi" "turrets at any angle" \
            "Entity State: each float" \
            "Detonation: each float" "scenario: each key" "effects.csv" "probes: each column" "built-in models" \
            "1e6 to 1" \
            "model files: needles"; do has stability "$what"; done
for what in "parts: a plate" "parts: needles" leaks "ground: rough" "by eights" "light: Planck" "light: smoke" \
            "sun: " "picture: a block" \
            "any place on Earth" "8192 x 1" "crowd: " "eye: in a block" "radar: " "detector: " "display: " \
            "threads: " "plants: leaves edge-on" "plants: skimmed tops" "plants: trees at the origin and 200 km" \
            "plants: a million trees" "heat: 1 K to 2000 K" "heat: the same: energy" "heat: polar day and night" \
            "heat: 1950 and 2090" "heat: seven threads" "heat: back and forth in time" \
            "network: 1 K to 2000 K" "network: the same: temperatures"; do
    has stability "$what"
done

table woods
for view in "100 m up, 5 degrees down" "300 m up, 10 degrees down" "300 m up, 8 down, 6 wide" "1000 m up, 20 degrees down"; do
    has woods "$view: one ray a pixel, full detail.*planes of one thread, nothing skipped\",yes,"
    has woods "$view: one ray a pixel, two levels.*planes of one thread, nothing skipped\",yes,"
    has woods "$view: default quality, full detail"
    has woods "$view: default quality: pixels sampled again"
    for plane in red green blue "3-5 um" "8-12 um"; do has woods "$view: two levels, $plane"; done
done
has woods "memory: with frames of all views, full detail.*,yes,"

run bench speed --quick --size 17
check "a size that is none is refused" [ $code = 1 ]
check "and said" complained "size: '17' is not"
run bench speed --quick --ground 1x1 --model "$tmp/none.obj"
check "a model that is not there is refused" [ $code = 1 ]
check "and said, too" complained "none.obj"

finish
