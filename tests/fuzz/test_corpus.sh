#!/usr/bin/env bash
# The fuzz entry points over a corpus: every datagram of invented exercises, good and bad, captures of them, and
# all of these cut short and with octets turned. labels: small
. "$(dirname "$0")/../system/common.sh"

[ -x "$build/tests/fuzz_tests" ] || { echo "skipped: no $build/tests/fuzz_tests"; exit 77; }

mkdir "$tmp/pdu" "$tmp/log"
exercise bad-pdus "$tmp/log/bad.pcap" --datagrams "$tmp/pdu"
exercise demo "$tmp/log/bundle.pcap" dis.bundle=true dis.version=6
exercise empty "$tmp/log/empty.pcap"
data=${PITVIPER_DATA:-../shared/data}/dis
cp "$data"/singles/*.pdu "$tmp/pdu/" 2>/dev/null
cp "$data"/singles.pcap "$tmp/log/" 2>/dev/null

# turned FILE OUT AT VALUE: one octet replaced
turned() {
    cp "$1" "$2"
    printf "\\x$4" | dd of="$2" bs=1 seek="$3" conv=notrunc status=none
}
for file in "$tmp"/pdu/00[0-4]?.pdu "$tmp"/pdu/dis*.pdu; do
    [ -s "$file" ] || continue
    for length in 1 11 12 40 103 143 150; do head -c $length "$file" >"$file.cut$length"; done
    turned "$file" "$file.count" 19 ff
    turned "$file" "$file.long" 8 7f
    turned "$file" "$file.version" 0 05
    for type in 01 02 03 0c 0d 0e 43; do turned "$file" "$file.type$type" 2 $type; done
done
for file in "$tmp"/log/*.pcap; do
    for length in 0 3 23 24 39 40 60 500 3001; do head -c $length "$file" >"$file.cut$length"; done
    for at in 0 4 16 20 21 32 35 36 54 56 60 61 64 78 79; do
        turned "$file" "$file.ff$at" $at ff
        turned "$file" "$file.00$at" $at 00
    done
done

all() { find "$tmp/$2" -type f -print0 | sort -z | xargs -0 "$build/tests/fuzz_tests" "$1" >"$tmp/said" 2>&1 || { tail -n 20 "$tmp/said"; return 1; }; }
check "any octets as PDUs" all fuzz_pdu pdu
check "any octets as a capture" all fuzz_log log
echo "$(find "$tmp/pdu" "$tmp/log" -type f | wc -l) inputs"
finish
