#!/usr/bin/env bash
# `pitviper inspect` on recordings of others: the summary, and a line per Entity State as tshark wrote them. labels: small
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/inspect.sh"
needs_data dis/vrf-dis5-tow-vs-armor.pcap
data=$data/dis

# ---- the summary -------------------------------------------------------------------------------------------
tow=$data/vrf-dis5-tow-vs-armor.pcap
expect 0 '462  *1 Entity State' "$tow"
expect 0 '15  *2 Fire' "$tow"
expect 0 '1:3001:70  *O1:3001_3  *1.1.222.1.1.1.0  *2  *70 ' "$tow"
expect 0 '1:3001:90 of 1:3001:66 ends: entity impact (1), target 1:3001:74' "$tow"
expect 0 '861  *72 Attribute' "$data/vrf-dis7-gaz69-blocks.pcap"
expect 0 '759  other_exercise' "$tow" --exercise 9
expect 0 'try --port 0' "$tow" --port 3001
expect 0 '462  *1 Entity State' "$tow" --port 0
head -c 100000 "$tow" >"$tmp/cut.pcap"
expect 0 'ends inside a packet' "$tmp/cut.pcap"
"$pitviper" inspect "$tow" >/dev/full 2>"$tmp/said"
check "a full disk is told" [ $? = 1 ]

# ---- one line per Entity State -----------------------------------------------------------------------------
for name in vrf-dis5-tow-vs-armor vrf-dis7-gaz69-blocks vrf-dis7-gaz69-straight; do
    "$pitviper" inspect "$data/$name.pcap" --pdus tsv >"$tmp/ours.tsv" || fail "$name: exit code"
    cmp "$tmp/ours.tsv" "$data/$name.espdu.tsv" || fail "$name: the lines differ from tshark's"
    "$pitviper" inspect "$data/$name.pcap" --pdus tsv --full | cut -f 1-27 | cmp - "$tmp/ours.tsv" ||
        fail "$name: --full changes the first columns"
done
# its twin
check "another line is noticed" not quiet cmp <(sed '2s/1/2/' "$tmp/ours.tsv") "$data/$name.espdu.tsv"
finish
