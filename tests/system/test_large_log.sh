#!/usr/bin/env bash
# A log larger than what is kept in memory: the same frames as of its small twin, from the file, packed and from a pipe, in
# memory that does not grow with it; one that is cut while it is read.
. "$(dirname "$0")/common.sh"
bare=("${quick[@]}")
exercise demo "$tmp/small.pcap" duration_s=6
# after each packet many of PDUs that nobody shows (Designator), by the same sender at the same time
python3 - "$tmp/small.pcap" "$tmp/large.pcap" 100 <<'PY'
import struct, sys
small, large, wanted = sys.argv[1], sys.argv[2], float(sys.argv[3]) * 1e6
data = open(small, 'rb').read()
packets, at = [], 24
while at < len(data):
    octets = struct.unpack_from('<I', data, at + 8)[0]
    packets.append((data[at:at + 8], data[at + 16:at + 16 + octets]))
    at += 16 + octets
link = struct.unpack_from('<I', data, 20)[0]
ip = {1: 14, 101: 0, 228: 0, 113: 16}[link]
repeat = int(wanted / len(packets) / 1500)
with open(large, 'wb') as out:
    out.write(data[:24])
    for time, p in packets:
        out.write(time + struct.pack('<II', len(p), len(p)) + p)
        pdu = p[ip + 28:]
        filler = bytearray(pdu[:12]) + pdu[12:18] + bytes(1400 - 18)
        filler[2], filler[8:10] = 24, struct.pack('>H', 1400)
        head = bytearray(p[:ip + 28])
        head[ip + 2:ip + 4] = struct.pack('>H', 28 + 1400)
        head[ip + 24:ip + 26] = struct.pack('>H', 8 + 1400)
        one = time + struct.pack('<II', ip + 28 + 1400, ip + 28 + 1400) + bytes(head) + bytes(filler)
        out.write(one * repeat)
PY
check "the log is large" [ "$(stat -c %s "$tmp/large.pcap")" -gt 90000000 ]
# most MB ARGUMENTS: the command's code, and whether it took at most so much memory
cat >"$tmp/most.py" <<'PY'
import resource, subprocess, sys
code = subprocess.run(sys.argv[2:]).returncode
most = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
print('%d MB' % most, file=sys.stderr)
sys.exit(code or (0 if most <= float(sys.argv[1]) else 99))
PY
most() { python3 "$tmp/most.py" "$@" 2>"$tmp/stderr"; code=$?; used=$(tail -n 1 "$tmp/stderr"); }
entities() { sed -n '/^Entities/,/^Shapes/p' "$1"; }
"$pitviper" inspect "$tmp/small.pcap" >"$tmp/small.txt"
most 85 "$pitviper" inspect "$tmp/large.pcap" >"$tmp/large.txt"
check "inspect takes 32 MB of it and 32 octets a datagram: $used" [ $code = 0 ]
check "and finds the same entities" cmp <(entities "$tmp/small.txt") <(entities "$tmp/large.txt")
gzip -1 "$tmp/large.pcap" -c >"$tmp/large.pcap.gz"
most 85 "$pitviper" inspect "$tmp/large.pcap.gz" >"$tmp/packed.txt"
check "packed the same: $used" [ $code = 0 ]
check "the same text" cmp <(sed 1d "$tmp/large.txt") <(sed 1d "$tmp/packed.txt")

view=(--size 16x16 --rate 1 --from +2 --to +2 --bands lwir --no-files --set terrain.ground=trust)
replay "$tmp/small.pcap" "$tmp/small" "${view[@]}"
check "a frame of the small one" [ "$code" = 0 ]
replay "$tmp/large.pcap" "$tmp/large" "${view[@]}"
check "the same frame of the large one" same_hashes "$tmp/small" "$tmp/large"
check "its hash is of the file, which was read once" grep -q "$(sha256sum <"$tmp/large.pcap" | cut -c1-64)" "$tmp/large/run.json"
mkfifo "$tmp/pipe"
cat "$tmp/large.pcap.gz" >"$tmp/pipe" &
replay "$tmp/pipe" "$tmp/piped" "${view[@]}" --causal
check "of a pipe, packed: a frame" [ "$code" = 0 ]
check "of a pipe: its hash" grep -q "$(sha256sum <"$tmp/large.pcap.gz" | cut -c1-64)" "$tmp/piped/run.json"
finish
