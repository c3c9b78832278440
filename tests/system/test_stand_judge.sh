#!/usr/bin/env bash
# The shadow that a standing box leaves in the ground's heat against finite differences in two dimensions, which know the
# sun's circle and the material alone: where its edges lie, and how soft they are.
. "$(dirname "$0")/common.sh"
judges python3.numpy
tool=$build/tests/stand_profile
needs "program $tool" test -x "$tool"

# judged HOUR OF WANTED: the profile of an hour against the differences of another; edge, position, widths, rms
judged() {
    "$tool" "$1" >"$tmp/profile"
    python3 tests/system/stand_judge.py "$tmp/profile" "$2" >"$tmp/$1-$2" || fail "$1: no judgement"
    sed "s/^/$1 h, judged at $2: /" "$tmp/$1-$2"
}
for hour in 11 12 14; do
    judged $hour $hour
    while read -r edge off ours theirs rms; do
        far=0.02 rough=0.06
        [ "$edge" = shadow ] || far=0.004 rough=0.02
        check "$hour h, $edge: $off m off" is "$off" '<' $far
        check "$hour h, $edge: $ours m wide, differences $theirs" is "$(awk "BEGIN { print $ours / $theirs }")" '<' 1.4
        check "$hour h, $edge: as soft" is "$(awk "BEGIN { print $ours / $theirs }")" '>' 0.7
        check "$hour h, $edge: rms $rms of the fall" is "$rms" '<' $rough
    done <"$tmp/$hour-$hour"
    check "$hour h: both edges" has_lines "$tmp/$hour-$hour" 2
done
# its twin: a shadow of half an hour before
judged 11.5 12
read -r _ off _ _ rms <"$tmp/11.5-12"
check "half an hour is noticed: $off m, rms $rms" is "$rms" '>' 0.06
finish
