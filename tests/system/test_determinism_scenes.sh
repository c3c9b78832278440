#!/usr/bin/env bash
# Same bits for any number of threads, from any frame on and at any speed, in scenes that have what the demo has not:
# the antimeridian, a pole, smoke and dust, malformed PDUs, several DIS versions, sensors with a memory.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"

# shown NAME CASE options: the case's exercise as its first lines say it is seen
shown() {
    local name=$1 case=$2; shift 2
    regress_case "$case"
    replay "$tmp/$case.pcap" "$tmp/$name" --no-png "${case_options[@]}" "$@"
    check "$name: a replay of $case" [ "$code" = 0 ]
}

# a sensor's raw counts are files alone; of all else the hash is enough
raw_same() { [ -d "$1/raw" ] && diff -rq "$1/raw" "$2/raw"; }
sensors=(--set sensor.preset=staring_lwir,staring_mwir,tv)
flir=(--set sensor.preset=scanning_flir --set detector.agc_s=2)

regress_case antimeridian
shown one antimeridian --threads 1 "${sensors[@]}"
check "some frames" [ "$(frames "$tmp/one")" -ge 6 ]
for threads in 2 5 8; do
    shown many antimeridian --threads $threads "${sensors[@]}"
    check "antimeridian: $threads threads, same bits" same_hashes "$tmp/one" "$tmp/many"
    check "antimeridian: $threads threads, same counts" raw_same "$tmp/one" "$tmp/many"
done
shown fast antimeridian "${sensors[@]}" --speed 10
check "antimeridian: speed 10, same bits" same_hashes "$tmp/one" "$tmp/fast"
shown real antimeridian --to 1352 --speed 1 --no-files
check "antimeridian: speed 1, the same frames" part_of "$tmp/real" "$tmp/one" 3
# without a sensor's preset the planes before it are the same
shown bare antimeridian
check "antimeridian: a sensor changes no plane before it" same_planes "$tmp/one" "$tmp/bare"

for case in impact pole bundles helicopter; do
    few=(); [ $case != impact ] || few=("${flir[@]}")
    shown one $case --threads 1 "${few[@]}"
    shown eight $case --threads 8 "${few[@]}"
    check "$case: 8 threads, same bits" same_hashes "$tmp/one" "$tmp/eight"
    [ $case != impact ] || check "impact: 8 threads, same counts" raw_same "$tmp/one" "$tmp/eight"
    shown noskip $case --no-skip --no-files
    check "$case: no skips, same bits" same_hashes "$tmp/one" "$tmp/noskip"
    shown late $case --from 1353 --no-files
    check "$case: --from: the frames from there on" part_of "$tmp/late" "$tmp/one" 3
    check "$case: --from leaves some out" [ "$(numbered "$tmp/late" | wc -l)" -lt "$(numbered "$tmp/one" | wc -l)" ]
done
for case in impact bundles; do
    shown causal $case --causal --no-files --threads 3
    shown again $case --causal --no-files --threads 1
    check "$case: causal, same bits" same_hashes "$tmp/causal" "$tmp/again"
done

# the versions of the protocol write the same exercise
for version in 5 6 7; do shown dis$version dis$version; done
check "versions 5 and 7: same bits" same_hashes "$tmp/dis5" "$tmp/dis7"
check "versions 6 and 7: same bits" same_hashes "$tmp/dis6" "$tmp/dis7"
versions() { for v in 5 6 7; do od -An -tu1 -j68 -N1 "$tmp/dis$v.pcap"; done | tr -d ' \n'; }
check "which are three" [ "$(versions)" = 567 ] # pcap 24 + 16, IP 20, UDP 8: the first PDU
finish
