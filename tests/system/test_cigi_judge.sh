#!/usr/bin/env bash
# CIGI packets that this program writes, in either octet order, as tshark reads them: every field of every packet.
# labels: small
. "$(dirname "$0")/common.sh"
judges tshark text2pcap
tools=$(dirname "$0")/../tools

# dissected HOST|IG ROUNDS: what is written, and what tshark reads, in $tmp/SENDER.values and .pdml
dissected() {
    "$build/tests/cigi_packets" "$2" "$1" >"$tmp/$1.hex" 2>"$tmp/$1.values" || return 1
    text2pcap -q -u 8004,8005 "$tmp/$1.hex" "$tmp/$1.pcap" 2>/dev/null
    tshark -r "$tmp/$1.pcap" -d udp.port==8005,cigi -T pdml >"$tmp/$1.pdml" 2>/dev/null
}
for sender in HOST IG; do
    check "$sender: packets are written and dissected" dissected $sender 16
    check "$sender: every field is tshark's" python3 "$tools/cigi_judge.py" "$tmp/$sender.values" "$tmp/$sender.pdml"
done
# its twins: one bit of a flag, and one field in another's place
sed '0,/"attach state": 0/s//"attach state": 1/' "$tmp/HOST.values" >"$tmp/twin"
check "another flag is noticed" not quiet python3 "$tools/cigi_judge.py" "$tmp/twin" "$tmp/HOST.pdml"
sed 's/"hat": \([^,]*\), "hot": \([^,]*\)/"hat": \2, "hot": \1/' "$tmp/IG.values" >"$tmp/twin"
check "fields that changed places are noticed" not quiet python3 "$tools/cigi_judge.py" "$tmp/twin" "$tmp/IG.pdml"
finish
