#!/usr/bin/env bash
# Memory runs out, once, at one place after another (tests/alloc/fail_alloc.c): every run ends by itself, with 1 and a
# message, or with 0 and what the good run said. A sample over all places; test_alloc_all.sh tries each.
. "$(dirname "$0")/common.sh"

build=$(realpath "$build")
pitviper=$build/pitviper preload=$build/tests/libfail_alloc.so
needs "$preload (sanitizers have an allocator of their own)" test -f "$preload"
places_most=${PITVIPER_ALLOC_PLACES:-12} # for all commands together
export pitviper preload tmp

# ---- small things to read: three models, one visibility, a ground of 30 m; a model of somebody else's
cp -r etc "$tmp/etc"
printf 'type,model,origin\n1,truck,base\n2,missile,centre\n1.3,box.obj,base\n*,unknown,base\n' >"$tmp/etc/catalog.csv"
sed -i '/^5000,/d' "$tmp/etc/atmosphere/us1976/visibilities.csv"
{ echo "mtllib box.mtl"; box_obj hull 0 4 0 2 0 1 green; } >"$tmp/etc/box.obj"
printf 'newmtl green\nKd 0.1 0.3 0.1\n' >"$tmp/etc/box.mtl"
printf 'axes: +x +z\norigin: auto\njoints:\n  - {nodes: hull, axis: up, pivot: centre, class: primary_turret_1, metric: azimuth, limits_deg: [-5, 5]}\nmaterials: {"*": paint_olive}\n' \
    >"$tmp/etc/box.yaml"
exercise demo "$tmp/demo.pcap"
printf 'sensor: {width_px: 48, height_px: 32, rate_hz: 0.1}\nmodels: {sag_m: 0.1}\nterrain: {spacing_m: 30, woods: off, buildings: off, clutter: 0}
heat: {facets: 3, step_s: 3600, shadow_m: 64, vehicle_step_s: 600}\n' >"$tmp/config.yaml"
printf 'ox_m,oy_m,oz_m,dx,dy,dz\n-9,0,-1,1,0,0\n' >"$tmp/rays.csv"
printf 'model,visibility_km,band,observer_m,target_m,range_km,temp_k\nus1976,23,lwir,10,10,1,290\n' >"$tmp/air.csv"
printf 'lat_deg,lon_deg\n10,20\n' >"$tmp/geoid.csv"

# each with a cache of its own, which is empty: what was kept is not made again, and its places not met
pv() { XDG_CACHE_HOME=$PWD/cache LD_PRELOAD=$preload "$pitviper" "$@"; }
woods() {
    pv replay "$tmp/demo.pcap" --config "$tmp/config.yaml" --threads 1 --out out --bands lwir --from 1366 --to 1366 \
        --set sensor.rate_hz=1 --set terrain.woods=on --set terrain.woods_half_m=100 --set terrain.woods_trees=200 "$@"
}
# command_of NAME: what is run, in a folder of its own
command_of() {
    case $1 in
        replay) pv replay "$tmp/demo.pcap" --config "$tmp/config.yaml" --threads 1 --out out ;;
        sensor) pv replay "$tmp/demo.pcap" --config "$tmp/config.yaml" --threads 1 --out out --bands lwir \
            --set sensor.preset=staring_lwir --from 1362 --to 1363 --set sensor.rate_hz=1 --save-frame 1 ;;
        woods) woods ;;
        saved) woods --save-frame 4 ;;
        inspect) pv inspect "$tmp/demo.pcap" ;;
        model) pv model info "$tmp/etc/box.obj" ;;
        rays) pv probe rays truck <"$tmp/rays.csv" ;;
        air) pv probe atmosphere <"$tmp/air.csv" ;;
        geoid) pv probe geoid <"$tmp/geoid.csv" ;;
        exercise) pv exercise demo -o out.pcap ;;
    esac
}
# outcome: what must be the same as in the good run
outcome() {
    if [ -e out/run.json ]; then tr -d ' \n' <out/run.json | grep -o '"frame_sha256":\[[^]]*\]'; fi
    [ ! -e out.pcap ] || sha256sum <out.pcap
    grep -v '^wall\|^ *[0-9.]* ms' stdout || true
}
# A probe goes on with the next row; this one's last column has the reason.
row_says_why() { [ "$1" = air ] && tail -n 1 stdout | grep -q 'see the log' && grep -q memory stderr; }
# one NAME PLACE: memory fails there; says what went wrong, or nothing
one() {
    local folder=$tmp/run/$1-$2 code=0
    mkdir -p "$folder"
    cd "$folder" || return
    FAIL_ALLOC=$2 FAIL_ALLOC_LIST=list PITVIPER_ETC=$tmp/etc \
        timeout -k 5 60 bash -c "command_of $1" >stdout 2>stderr || code=$?
    case $code in
        0) cmp -s <(outcome) "$tmp/good-$1" || row_says_why "$1" || echo "$1 $2: ended with 0 and another result" ;;
        1) grep -q memory stderr || echo "$1 $2: ended with 1 and did not say of memory: $(tail -n 1 stderr)" ;;
        *) echo "$1 $2: ended with $code: $(tail -n 1 stderr)" ;;
    esac
    grep -aqs '^failed' list || echo "$1 $2: the place was not met again"
    cd "$tmp" && rm -rf "$folder"
}
export -f pv woods command_of outcome row_says_why one

# ---- where each command allocates
mkdir "$tmp/places"
names="replay sensor woods inspect model rays air geoid exercise"
[ "$places_most" != all ] || names+=" saved" # twice the seconds
for name in $names; do
    mkdir -p "$tmp/good"
    (
        cd "$tmp/good" || exit 1
        FAIL_ALLOC_LIST=$tmp/list-$name PITVIPER_ETC=$tmp/etc bash -c "command_of $name" >stdout 2>stderr
        code=$?
        outcome >"$tmp/good-$name"
        [ $code = 0 ] || cat stderr
        exit $code
    )
    check "$name: runs where memory suffices" [ $? = 0 ]
    rm -rf "$tmp/good"
    # a place that an earlier command had needs no second run
    sed 's/^\([0-9a-f]\{16\}\) .*/'"$name"' \1/p;d' "$tmp/list-$name" >>"$tmp/places/all"
done
sort -u -k2,2 "$tmp/places/all" >"$tmp/places/each"
count=$(wc -l <"$tmp/places/each")
check "there are places where memory can fail" [ "$count" -gt 200 ]
# by hash: over the whole program, and others when it changes
if [ "$places_most" = all ]; then chosen=$count; else chosen=$places_most; fi
head -n "$chosen" "$tmp/places/each" | xargs -P "$(nproc)" -L 1 bash -c 'one "$@"' one >"$tmp/wrong" 2>&1
checks=$((checks + chosen))
while read -r line; do
    fail "$line"
    grep -ah "^$(awk '{ print $2 }' <<<"${line/:/}") " "$tmp"/list-* | head -n 1 | cut -d ' ' -f 2- |
        xargs addr2line -f -s -i -e "$pitviper" 2>/dev/null | grep -v '^??' | tr '\n' ' '
    echo
done <"$tmp/wrong"
echo "$chosen of $count places"
finish
