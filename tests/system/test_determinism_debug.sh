#!/usr/bin/env bash
# A debug build beside the optimized one of the same tree: the same bits. In build/asan, by etc/test --all.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/determinism.sh"
needs "debug build: this one is optimized" grep -q '^CMAKE_BUILD_TYPE:[A-Z]*=Debug$' "$build/CMakeCache.txt"
release=$(dirname "$build")/release/pitviper
stale() { [ -n "$(find dis terrain entities render sensor main.c pitviper*.[ch] -newer "$release" -name '*.[ch]*' -print -quit)" ]; }
needs "$release of these sources" eval '[ -x "$release" ] && ! stale'

for case in "${cases[@]}"; do
    shown "$case" "$case" "$pitviper" --set sensor.preset=staring_lwir
    shown optimized "$case" "$release" --set sensor.preset=staring_lwir
    check "$case: debug and release, same bits" same_hashes "$tmp/$case" "$tmp/optimized"
    check "$case: debug and release, same planes in the files" same_planes "$tmp/$case" "$tmp/optimized"
    check "$case: debug and release, same truth" cmp "$tmp/$case/truth.jsonl" "$tmp/optimized/truth.jsonl"
done
shown other tank "$release" --set sensor.preset=staring_lwir --seed 2
check "the twin: another seed, other bits" not same_hashes "$tmp/tank" "$tmp/other"
finish
