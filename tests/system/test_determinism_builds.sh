#!/usr/bin/env bash
# Same bits whatever instructions the tracer uses, and from a debug build as from an optimized one.
#
# Other tracers. Embree says only which triangle is met; range, normal and place on it are computed again in double, with
# the instructions of x86-64-v3 whatever the tracer has. A ray through an edge two triangles share may be given to either,
# so that ids might differ there; in 5.3 million pixels of the demo at 480x320 and five of tests/regress at 384x256 none
# did, sse4.2 and avx512 against avx2. Hence no tolerance here: the first pixel that differs is news. Should that come,
# picture_difference says how far from an edge it lies.
#
# Other builds. -Og and -O3 of gcc give the same bits, truth.jsonl included, since a * b + c is contracted nowhere (and
# clang's -O3 does, too). Contracted everywhere, 2 to 34 % of the radiances change, by 1.3e-6 of themselves at most away
# from edges, and no id.
. "$(dirname "$0")/common.sh"

# shown NAME CASE PROGRAM options: coarse vehicles and ground, and of the frames two, late ones
shown() {
    local name=$1 case=$2 program=$3; shift 3
    regress_case "$case"
    "$program" replay "$tmp/$case.pcap" --out "$tmp/$name" --overwrite --size 96x64 --threads 1 --no-png "${bare[@]}" "${case_options[@]}" \
        "${coarse[@]}" --only 5,7 "$@" \
        >"$tmp/stdout" 2>"$tmp/stderr" || { fail "$name: $program does not replay $case"; tail -n 5 "$tmp/stderr"; }
}

isas=(sse4.2)
if grep -qw avx512vl /proc/cpuinfo; then isas+=(avx512); else echo "skipped: no AVX-512 in this processor"; fi
cases=(tank antimeridian impact) # turning parts; the Earth's edge; smoke, dust and flame
for case in "${cases[@]}"; do
    shown "$case" "$case" "$pitviper" --set sensor.preset=staring_lwir
    check "$case: some frames" [ "$(frames "$tmp/$case")" = 2 ]
    for isa in "${isas[@]}"; do
        shown other "$case" "$pitviper" --set sensor.preset=staring_lwir --isa "$isa"
        check "$case, $isa: it is that" grep -q "\"isa\": *\"$isa\"" "$tmp/other/run.json"
        check "$case, $isa: same bits as avx2" same_hashes "$tmp/$case" "$tmp/other"
        check "$case, $isa: same planes in the files" same_planes "$tmp/$case" "$tmp/other"
        check "$case, $isa: same counts of the sensor" diff -rq "$tmp/$case/raw" "$tmp/other/raw"
        check "$case, $isa: same truth" cmp "$tmp/$case/truth.jsonl" "$tmp/other/truth.jsonl"
    done
done

# every object of the rooms is compiled without contraction and without fast mathematics
commands=$build/compile_commands.json
rooms() { grep -E '"command".* -c [^"]*/((dis|terrain|entities|render|sensor)/[^"]*|main|pitviper_[a-z]*)\.c(pp)?"' "$commands"; }
check "how the rooms are compiled is known" [ "$(rooms | wc -l)" -ge 150 ]
check "all without contraction" [ "$(rooms | grep -vc -e '-ffp-contract=off')" = 0 ]
check "none with -ffast-math, -Ofast or another contraction" \
    [ "$(rooms | grep -cE -e '-ffast-math|-Ofast|-funsafe-math|-ffp-contract=(fast|on)')" = 0 ]

# a debug build beside the optimized one of the same tree
release=$(dirname "$build")/release/pitviper
stale() { [ -n "$(find dis terrain entities render sensor main.c pitviper*.[ch] -newer "$release" -name '*.[ch]*' -print -quit)" ]; }
if ! grep -q '^CMAKE_BUILD_TYPE:[A-Z]*=Debug$' "$build/CMakeCache.txt"; then
    echo "skipped: debug against release, this is no debug build; build/asan compares itself"
elif [ ! -x "$release" ] || stale; then
    echo "skipped: debug against release, no $release of these sources"
else
    for case in "${cases[@]}"; do
        shown optimized "$case" "$release" --set sensor.preset=staring_lwir
        check "$case: debug and release, same bits" same_hashes "$tmp/$case" "$tmp/optimized"
        check "$case: debug and release, same planes in the files" same_planes "$tmp/$case" "$tmp/optimized"
        check "$case: debug and release, same truth" cmp "$tmp/$case/truth.jsonl" "$tmp/optimized/truth.jsonl"
    done
    shown other tank "$release" --set sensor.preset=staring_lwir --seed 2
    check "the twin: another seed, other bits" not same_hashes "$tmp/tank" "$tmp/other"
fi
finish
