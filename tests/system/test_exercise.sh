#!/usr/bin/env bash
# The same exercise, said in other ways and at other places of the Earth: the seeker sees the same thing. An
# invented exercise has an answer on paper: the missile 41 flies at truck 22 and ends 1.2 m above its base.
. "$(dirname "$0")/common.sh"

quick=(--rate 1 --size 64x48 --no-files --threads 1 "${coarse[@]}")
exercise demo "$tmp/v7.pcap"
replay "$tmp/v7.pcap" "$tmp/v7" "${quick[@]}"
check "the host is the missile that hits" [ "$(host_of "$tmp/v7")" = 1:3001:41 ]

# target OUT LINE KEY: of truck 22 in that line of the truth
target() { sed -n "$2p" "$1/truth.jsonl" | grep -oE '"entity": *"1:3001:22".*' | grep -oE "\"$3\": *-?[0-9.eE+-]+" | head -n 1 | sed 's/.*: *//'; }
n=$(wc -l <"$tmp/v7/truth.jsonl")
check "frames over the whole flight" [ "$n" -ge 8 ]
check "far at first" is "$(target "$tmp/v7" 1 range_m)" '>' 2000
check "near at last" is "$(target "$tmp/v7" "$n" range_m)" '<' 300
check "it grows" is "$(target "$tmp/v7" "$n" pixels)" '>' "$(target "$tmp/v7" 2 pixels)"
check "it is seen at last" is "$(target "$tmp/v7" "$n" visible_fraction)" '>' 0.3
check "it closes" is "$(target "$tmp/v7" "$((n - 2))" closing_mps)" '>' 200

# In other words: version and bundling change no bit, of an early frame nor of the last.
some_hashes() { for line; do hashes "$tmp/v7" | grep -oE '[0-9a-f]{64}' | sed -n "${line}p"; done; }
early_and_last=$(some_hashes 3 "$n")
check "two hashes" [ "$(wc -w <<<"$early_and_last")" = 2 ]
for variant in dis.version=6 dis.version=5 "dis.bundle=true dis.fillers=true" "dis.version=5 dis.bundle=true"; do
    # shellcheck disable=SC2086
    exercise demo "$tmp/variant.pcap" $variant
    replay "$tmp/variant.pcap" "$tmp/variant" "${quick[@]}" --only "2,$((n - 1))"
    check "$variant: same bits as version 7" [ "$(hashes "$tmp/variant" | grep -oE '[0-9a-f]{64}')" = "$early_and_last" ]
    rm -rf "$tmp/variant"
done

# Of where the target is, one band tells.
quick+=(--bands lwir)
# Elsewhere: the road, the shot and the geometry are the same; only ground and sun differ.
near() { # WHAT A B TOLERANCE
    check "$1: $2 and $3 within $4" awk -v a="$2" -v b="$3" -v t="$4" 'BEGIN { d = a - b; exit !(a != "" && b != "" && d <= t && -d <= t) }'
}
for place in "place.lat_deg=-33.5 place.lon_deg=151" "place.lat_deg=20 place.lon_deg=179.9995" "place.lat_deg=85 place.lon_deg=-40" \
    dis.stamp_s=3592 dis.stamps=absolute; do
    # shellcheck disable=SC2086
    exercise demo "$tmp/place.pcap" $place
    replay "$tmp/place.pcap" "$tmp/place" "${quick[@]}"
    check "$place: as many frames" [ "$(wc -l <"$tmp/place/truth.jsonl")" = "$n" ]
    for line in 2 $((n / 2)) $((n - 1)); do
        # 0.5 m: the ellipsoid's curvature differs by latitude, by millimetres over 2.5 km; frame times by a stamp's 2 us
        near "$place, frame $line: range" "$(target "$tmp/place" $line range_m)" "$(target "$tmp/v7" $line range_m)" 0.5
        near "$place, frame $line: aspect" "$(target "$tmp/place" $line aspect_deg)" "$(target "$tmp/v7" $line aspect_deg)" 0.2
        near "$place, frame $line: depression" "$(target "$tmp/place" $line depression_deg)" "$(target "$tmp/v7" $line depression_deg)" 0.2
    done
    rm -rf "$tmp/place"
done

# Another seed is another ground, a turn another direction of everything: still found.
exercise demo "$tmp/seed.pcap" seed=7 place.turn_deg=70
replay "$tmp/seed.pcap" "$tmp/seed" "${quick[@]}"
m=$(wc -l <"$tmp/seed/truth.jsonl")
check "seed 7: near at last" is "$(target "$tmp/seed" "$m" range_m)" '<' 300
check "seed 7: it grows" is "$(target "$tmp/seed" "$m" pixels)" '>' "$(target "$tmp/seed" 2 pixels)"
finish
