#!/usr/bin/env bash
# `pitviper inspect` on invented exercises, whose cast is known: everybody is listed, bundling hides nobody, and
# what is malformed is counted and never printed raw.
. "$(dirname "$0")/common.sh"

exercise demo "$tmp/demo.pcap"
run inspect "$tmp/demo.pcap"
check "inspect ends well" [ $code = 0 ]
for id in 11 12 13 21 22 31 41; do check "1:3001:$id is listed" grep -q "1:3001:$id" "$tmp/stdout"; done
check "the shot is listed" grep -qE '1:3001:31 fires 1:3001:41 .*at 1:3001:22' "$tmp/stdout"
check "the hit is listed" grep -qiE '1:3001:41.*entity impact' "$tmp/stdout"
check "nothing dropped" grep -qE '^ +nothing' <(grep -A1 '^Dropped' "$tmp/stdout")
states=$(awk '$2 == 1 && /Entity State/ { print $1 }' "$tmp/stdout" | head -n 1)

run inspect "$tmp/demo.pcap" --pdus tsv
check "--pdus tsv ends well" [ $code = 0 ]
check "a line an Entity State, and the header" [ "$(wc -l <"$tmp/stdout")" = $((${states:-0} + 1)) ]
columns() { awk -F'\t' '{ print NF }' "$tmp/stdout" | sort -u; }
check "27 columns everywhere" [ "$(columns)" = 27 ]

cp "$tmp/stdout" "$tmp/plain.tsv"
exercise demo "$tmp/bundle.pcap" dis.bundle=true dis.fillers=true
run inspect "$tmp/bundle.pcap" --pdus tsv
check "bundles: the same Entity States, but for the packet number" \
    cmp -s <(cut -f2- "$tmp/plain.tsv") <(cut -f2- "$tmp/stdout")

exercise bad-pdus "$tmp/bad.pcap"
run inspect "$tmp/bad.pcap"
check "malformed PDUs: ends well" [ $code = 0 ]
check "malformed PDUs: counted by reason" [ "$(sed -n '/^Dropped/,/^$/p' "$tmp/stdout" | grep -cE '^ +[1-9]')" -ge 7 ]
raw() { grep -qP '[\x00-\x08\x0b-\x1f\x7f-\xff]' "$tmp/stdout"; }
not() { ! "$@"; }
check "malformed PDUs: no raw bytes on the screen" not raw
run inspect "$tmp/bad.pcap" --pdus tsv
check "malformed PDUs: still 27 columns everywhere" [ "$(columns)" = 27 ]

exercise aircraft "$tmp/aircraft.pcap"
run inspect "$tmp/aircraft.pcap"
check "heights of aircraft are from the ground, F-16: 5.09 m" grep -q 'aircraft, 15.1 x 9.45 x 5.09$' "$tmp/stdout"

head -c 3000 "$tmp/demo.pcap" >"$tmp/cut.pcap"
run inspect "$tmp/cut.pcap"
check "a truncated log is shown" [ $code = 0 ]
finish
