#!/usr/bin/env bash
# Recordings of `pitviper exercise` as tshark reads them: every PDU, of each version, well formed.
. "$(dirname "$0")/common.sh"
judges tshark

# one PDU a datagram: tshark 4.0 stops behind the first of a bundle
field() { tshark -r "$1" -T fields -e "dis.$2" 2>/dev/null; }
malformed() { tshark -r "$1" -Y _ws.malformed 2>/dev/null | wc -l; }
for version in 5 6 7; do
    log=$tmp/v$version.pcap
    run exercise demo -o "$log" --set dis.version=$version --set dis.exercise=9
    pdus=$(grep -oE '[0-9]+ PDUs' "$tmp/stdout" | cut -d' ' -f1)
    check "version $version: tshark sees it, and exercise 9" [ "$(field "$log" proto_ver | sort -u) $(field "$log" exer_id | sort -u)" = "$version 9" ]
    check "version $version: tshark counts $pdus PDUs" [ "$(field "$log" pdu_type | grep -c .)" = "$pdus" ]
    check "version $version: nothing malformed to tshark" [ "$(malformed "$log")" = 0 ]
done
# its twin
run exercise bad-pdus -o "$tmp/bad.pcap"
check "bad PDUs are malformed to tshark" [ "$(malformed "$tmp/bad.pcap")" -gt 0 ]
finish
