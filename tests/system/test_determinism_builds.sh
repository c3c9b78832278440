#!/usr/bin/env bash
# Same bits whatever instructions the tracer uses, and from a debug build as from an optimized one.
# This script: sse4.2, and how all is compiled; test_determinism_avx512.sh and test_determinism_debug.sh: the rest.
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
. "$(dirname "$0")/determinism.sh"

same_as_avx2 sse4.2

# every object of the rooms is compiled without contraction and without fast mathematics
commands=$build/compile_commands.json
rooms() { grep -E '"command".* -c [^"]*/((dis|terrain|entities|render|sensor)/[^"]*|main|pitviper_[a-z]*)\.c(pp)?"' "$commands"; }
check "how the rooms are compiled is known" [ "$(rooms | wc -l)" -ge 150 ]
check "all without contraction" [ "$(rooms | grep -vc -e '-ffp-contract=off')" = 0 ]
check "none with -ffast-math, -Ofast or another contraction" \
    [ "$(rooms | grep -cE -e '-ffast-math|-Ofast|-funsafe-math|-ffp-contract=(fast|on)')" = 0 ]
finish
