#!/usr/bin/env bash
# Same bits for any number of threads, from any frame on and at any speed, in scenes that have what the demo has not:
# the antimeridian, smoke and dust, malformed PDUs, several DIS versions, sensors with a memory. More of them:
# test_determinism_scenes_deep.sh.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
deep=${PITVIPER_SCENES_DEEP:-no}

# shown NAME CASE options: the case's exercise as its first lines say it is seen, with coarse vehicles and ground
shown() {
    local name=$1 case=$2; shift 2
    regress_case "$case"
    replay "$tmp/$case.pcap" "$tmp/$name" --no-png "${case_options[@]}" "${coarse[@]}" "$@"
    check "$name: a replay of $case" [ "$code" = 0 ]
}

# a sensor's raw counts are files alone; of all else the hash is enough
raw_same() { [ -d "$1/raw" ] && diff -rq "$1/raw" "$2/raw"; }
# raw_part A B: A has some, and B has them all
raw_part() {
    local files
    files=$(cd "$1" && find raw -type f) && [ -n "$files" ] || return 1
    for file in $files; do cmp "$1/$file" "$2/$file" || return 1; done
}
sensors=(--set sensor.preset=staring_lwir,staring_mwir,tv)
flir=(--set sensor.preset=scanning_flir --set detector.agc_s=2)

# Bits that are the same with several things changed at once are so with each of them: a replay stands for several.
shown one antimeridian --threads 1 "${sensors[@]}"
check "some frames" [ "$(frames "$tmp/one")" -ge 6 ]
all_threads=(5)
[ $deep = no ] || all_threads=(2 5 8)
for threads in "${all_threads[@]}"; do
    shown many antimeridian --threads $threads "${sensors[@]}" --speed 10
    check "antimeridian: $threads threads, speed 10, same bits" same_hashes "$tmp/one" "$tmp/many"
    check "antimeridian: $threads threads, speed 10, same counts" raw_same "$tmp/one" "$tmp/many"
done
# without a sensor's preset the planes before it are the same; their hashes do not hold its counts
shown real antimeridian --threads 2 --to 1352 --speed 1 --no-files
check "antimeridian: 2 threads, speed 1, no sensor: the same frames" part_of "$tmp/real" "$tmp/one" 3
if [ $deep = yes ]; then
    shown bare antimeridian --threads 1
    check "antimeridian: a sensor changes no plane before it" same_planes "$tmp/one" "$tmp/bare"
fi

# by 8 threads, with nothing skipped, from the second frame on
cases=(impact bundles)
[ $deep = no ] || cases+=(pole helicopter)
for case in "${cases[@]}"; do
    few=(); [ $case != impact ] || few=("${flir[@]}")
    shown one $case --threads 1 "${few[@]}"
    shown many $case --threads 8 --no-skip --from 1353 "${few[@]}"
    check "$case: 8 threads, no skips, from the middle: the frames from there on" part_of "$tmp/many" "$tmp/one" 4
    check "$case: --from leaves some out" [ "$(numbered "$tmp/many" | wc -l)" -lt "$(numbered "$tmp/one" | wc -l)" ]
    [ $case != impact ] || check "impact: same counts" raw_part "$tmp/many" "$tmp/one"
    [ $deep = yes ] || [ $case = impact ] || continue
    shown causal $case --causal --no-files --threads 3
    shown again $case --causal --no-files --threads 1
    check "$case: causal, same bits" same_hashes "$tmp/causal" "$tmp/again"
done

# the versions of the protocol write the same exercise
for version in 5 6 7; do shown dis$version dis$version --no-files --threads 1 --only 2,5; done
check "versions 5 and 7: same bits" same_hashes "$tmp/dis5" "$tmp/dis7"
check "versions 6 and 7: same bits" same_hashes "$tmp/dis6" "$tmp/dis7"
versions() { for v in 5 6 7; do od -An -tu1 -j68 -N1 "$tmp/dis$v.pcap"; done | tr -d ' \n'; }
check "which are three" [ "$(versions)" = 567 ] # pcap 24 + 16, IP 20, UDP 8: the first PDU
finish
