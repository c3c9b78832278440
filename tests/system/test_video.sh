#!/usr/bin/env bash
# --stream and --video: independent programs (ffmpeg, GStreamer; tshark: test_video_tshark.sh) receive what is sent while it is sent, by multicast and by
# unicast, and join in the middle: pictures equal to the PNG files within the codec's error, metadata to the bit.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
needs "video: built without FFmpeg's libraries" has_video
judges ffmpeg ffprobe gst-launch-1.0 gst.udpsrc gst.tsdemux gst.h264parse gst.avdec_h264 python3.numpy python3.PIL
group=239.77.$((RANDOM % 200 + 10)).9 port=$((20000 + RANDOM % 10000 * 4))
exercise demo "$tmp/demo.pcap"
flight "$tmp/flight.yaml"
exercise "$tmp/flight.yaml" "$tmp/flight.pcap" duration_s=120

# receive PROGRAM ARGUMENTS: in the background until finish_receivers; its pid in $pids
pids=()
receive() { local name=$1; shift; "$@" >"$tmp/$name.out" 2>"$tmp/$name.err" & pids+=($!); }
# they finish their files; ffmpeg, while it waits for a datagram, at a second signal. Without one they end by themselves
finish_receivers() {
    kill -INT "${pids[@]}" 2>/dev/null
    sleep 0.2; kill -INT "${pids[@]}" 2>/dev/null
    wait "${pids[@]}"; pids=()
}
# has_received NAME N: so many pictures, and packets of metadata
has_received() {
    [ "$(stat -c %s "$tmp/$1.gray" 2>/dev/null || echo 0)" -ge $(($2 * 96 * 64)) ] &&
        [ "$(grep -obUaP '\x06\x0e\x2b\x34\x02\x0b\x01\x01\x0e\x01\x03\x01' "$tmp/$1.klv" 2>/dev/null | wc -l)" -ge "$2" ]
}
# bound PORT N: until N sockets are
sockets_at() { awk -v p="$(printf ':%04X' "$1")" 'index($2, p) == 9' /proc/net/udp | wc -l; }
are_bound() { [ "$(sockets_at "$1")" -ge "$2" ]; }
bound() { until_true are_bound "$@" || fail "the receivers did not start"; }
live=(--bands lwir --from 1366 --rate 20 --planes none --set sensor.antialias=off --set quality.budget=off)
watch() { receive "$1" ffmpeg -v info -y -analyzeduration 1200000 -copyts -i "$2" -map 0:v -fps_mode passthrough -vf showinfo -f rawvideo -pix_fmt gray -flush_packets 1 "$tmp/$1.gray" -map 0:d -c copy -flush_packets 1 -f data "$tmp/$1.klv"; }

# ---- multicast, asynchronous metadata; targets of truth; the file beside it has every frame
watch group "udp://$group:$port?localaddr=127.0.0.1&timeout=${patience}000000"
receive gst timeout $patience gst-launch-1.0 -e udpsrc multicast-group="$group" port="$port" multicast-iface=lo ! tsdemux name=d d. ! queue ! h264parse ! \
    avdec_h264 ! videoconvert ! video/x-raw,format=GRAY8 ! filesink sync=false location="$tmp/gst.gray" d. ! queue ! meta/x-klv ! filesink \
    sync=false async=false buffer-mode=unbuffered location="$tmp/gst.klv"
bound "$port" 2
"$pitviper" replay "${bare[@]}" "$tmp/demo.pcap" --out "$tmp/a" --size 96x64 --threads 1 "${live[@]}" --to 1368 --speed 2 --video "$tmp/a.ts" \
    --stream "udp://$group:$port" --set network.interface=lo --set publish.vmti=truth >"$tmp/a.out" 2>&1 &
senders=($!)

# ---- unicast, synchronous metadata; the receiver joins while it is being sent, which goes on until it has enough
"$pitviper" replay "${bare[@]}" "$tmp/flight.pcap" --out "$tmp/b" --size 96x64 --threads 1 "${live[@]}" --speed 1 --video "$tmp/b" \
    --stream "udp://127.0.0.1:$((port + 2))" --set publish.klv=sync >"$tmp/b.out" 2>&1 &
senders+=($!)
until_true test -s "$tmp/b/truth.jsonl"
watch host "udp://127.0.0.1:$((port + 2))?timeout=${patience}000000"
bound $((port + 2)) 1
wait "${senders[0]}"
check "the replay that streams" [ $? = 0 ]
check "a receiver joins" until_true has_received host 15
kill -INT "${senders[1]}"
wait "${senders[1]}"
check "the replay that streams without a receiver at first, and is stopped" [ $? = 130 ]
check "that is reported once" [ "$(grep -c 'no program receives it' "$tmp/b.out")" = 1 ]
check "how to watch it is printed" grep -q "ffplay .* udp://127.0.0.1:$((port + 2)) .*vlc udp://@:$((port + 2))" "$tmp/b.out"
check "the group's receiver has what was sent" until_true has_received group 12
check "GStreamer has what was sent" until_true has_received gst 20
finish_receivers

replay "$tmp/demo.pcap" "$tmp/c-out" --size 96x64 --rate 4 --from 1366 --to 1367 --bands lwir --no-files --video "$tmp/c/" --set publish.video_codec=hevc-12
check "a replay to H.265" [ $code = 0 ]

cat >"$tmp/check.py" <<'PY'
import glob, json, os, re, subprocess, sys
import numpy as np
from PIL import Image
tmp = sys.argv[1]
KEY = bytes.fromhex("060e2b34020b01010e01030101000000")
def packets(octets):  # a KLV file: key, BER length, value
    out, at = [], 0
    while at + 17 < len(octets):
        assert octets[at:at + 16] == KEY, (at, octets[at:at + 16].hex())
        n, head = octets[at + 16], 17
        if n & 128: n, head = int.from_bytes(octets[at + 17:at + 17 + (n & 127)], "big"), 17 + (n & 127)
        out.append(octets[at:at + head + n])
        at += head + n
    assert at == len(octets), "a packet is cut off"
    return out
def read(name): return open(f"{tmp}/{name}", "rb").read()
def klv_of(ts):
    subprocess.run(["ffmpeg", "-v", "error", "-y", "-i", f"{tmp}/{ts}", "-map", "0:d", "-c", "copy", "-f", "data", f"{tmp}/x.klv"], check=True)
    return packets(read("x.klv"))
def probe(ts, stream): 
    text = subprocess.run(["ffprobe", "-v", "error", "-select_streams", stream, "-show_entries", "packet=pts", "-of", "csv=p=0", f"{tmp}/{ts}"],
                          check=True, capture_output=True, text=True).stdout
    return [w.strip(",") for w in text.split()]
def pngs(out): return [np.array(Image.open(p)).astype(float) for p in sorted(glob.glob(f"{tmp}/{out}/frames/lwir/*.png"))]
def error(a, b): return float(np.sqrt(np.mean((a - b) ** 2)))
def pictures(name, like): return np.frombuffer(read(name), np.uint8).reshape(-1, *like.shape).astype(float)
def unix_us(packet):  # ST 0601 tag 2 stands first
    at = 17 + (packet[16] & 127 if packet[16] & 128 else 0)
    assert packet[at] == 2 and packet[at + 1] == 8
    return int.from_bytes(packet[at + 2:at + 10], "big")
def is_some_of(part, whole):  # in order
    at = iter(whole)
    return all(p in at for p in part)
def pes(ts, pid):  # (time stamp or None, content) of each packet of that PID: a reader of its own
    found = []
    for at in range(0, len(ts), 188):
        p = ts[at:at + 188]
        assert p[0] == 0x47
        if (p[1] & 31) << 8 | p[2] != pid or not p[3] & 0x10: continue
        if p[1] & 0x40: found.append(b"")
        found[-1] += p[5 + p[4]:] if p[3] & 0x20 else p[4:]
    for b in found:
        t = b[9:14]
        yield (t[0] >> 1 & 7) << 30 | t[1] << 22 | (t[2] >> 1) << 15 | t[3] << 7 | t[4] >> 1 if b[7] & 0x80 else None, b[9 + b[8]:]
def stamped(ts, klv, hevc=False):  # MISB ST 0604: one in each picture, before its first slice, the time of its metadata
    uuid = bytes.fromhex("a8687dd4d7593758a5cef0338b6545f1") if hevc else b"MISPmicrosectime"
    video, data = list(pes(ts, 0x100)), list(pes(ts, 0x101))
    assert len(video) == len(data) == len(klv), (len(video), len(data), len(klv))
    for (at, picture), (klv_at, _), k in zip(video, data, klv):
        assert klv_at in (None, at), "metadata's time stamp is the picture's"
        before = []
        for nal in re.split(b"\0\0\1", picture)[1:]:
            kind = nal[0] >> 1 & 63 if hevc else nal[0] & 31
            if (kind < 32 if hevc else kind in (1, 5)): break
            if kind == (39 if hevc else 6): before.append(nal[2 if hevc else 1:].replace(b"\0\0\3", b"\0\0"))
        before = [b for b in before if uuid in b]
        assert len(before) == 1 and before[0][:18] == b"\x05\x1c" + uuid, before
        s = before[0][18:30]
        assert s[0] == 0x9f and s[3] == s[6] == s[9] == 0xff, s.hex()
        assert int.from_bytes(s[1:3] + s[4:6] + s[7:9] + s[10:12], "big") == unix_us(k), (s.hex(), unix_us(k))
most = 2.0  # of 256 levels, rms: tests/sensor/test_video_encoder.c
for out, ts, name, all_of in (("a", "a.ts", "group", 41), ("b", "b/lwir.ts", "host", None)):
    png, klv, pts = pngs(out), klv_of(ts), [int(p) for p in probe(ts, "v")]
    all_of = all_of or len(png)
    assert len(png) == len(klv) == len(pts) == all_of, (len(png), len(klv), len(pts))
    assert [round(b - a) for a, b in zip(pts, pts[1:])] == [4500] * (all_of - 1), "time stamps: 20 Hz of exercise time"
    # exercise time, modulo 33 bits, in both
    assert all(abs((unix_us(k) * 9 // 100 - p + 45) % 2**33 - 45) <= 2 for k, p in zip(klv, pts)), "metadata's time is the picture's"
    h264 = subprocess.run(["ffmpeg", "-v", "error", "-i", f"{tmp}/{ts}", "-map", "0:v:0", "-c", "copy", "-f", "h264", "-"], stdout=subprocess.PIPE).stdout
    stamps = [s[:12] for s in h264.replace(b"\0\0\3", b"\0\0").split(b"MISPmicrosectime")[1:]]  # ST 0604, in an SEI message
    assert all(s[0] == 0x9F and s[3] == s[6] == s[9] == 0xFF for s in stamps), stamps[:2]
    stamps = [int.from_bytes(s[1:3] + s[4:6] + s[7:9] + s[10:12], "big") for s in stamps]
    assert stamps == [unix_us(k) for k in klv], (stamps[:2], unix_us(klv[0]))
    stamped(read(ts), klv)
    of_klv = probe(ts, "d")
    assert of_klv == (["N/A"] * all_of if out == "a" else [str(p) for p in pts]), of_klv[:3]
    # program map: type and PID 0x101; stream id of its PES packets; synchronous: an AU cell's header before the key
    raw, of_type, of_id = read(ts), *((6, 0xBD) if out == "a" else (0x15, 0xFC))
    assert bytes([of_type, 0xE1, 0x01]) in raw[:1000] and bytes([0, 0, 1, of_id]) in raw and bytes([0, 0, 1, of_id ^ 0x41]) not in raw[:5000]
    at = raw.index(KEY)
    if out == "b": assert raw[at - 5] == 0 and raw[at - 3] == 0xDF and int.from_bytes(raw[at - 2:at], "big") == len(klv[0]), raw[at - 5:at]
    # as it was sent
    shown = [int(n) for n in re.findall(r"n: *\d+ pts: *(\d+)", read(f"{name}.err").decode(errors="replace"))]
    seen = pictures(f"{name}.gray", png[0])
    assert 12 <= len(seen) <= len(shown) and set(shown) <= set(pts) and shown == sorted(shown), (name, len(seen), len(shown))
    if out == "b": assert shown[0] > pts[0], "it was to join in the middle"
    errors = [error(s, png[pts.index(t)]) for s, t in zip(seen, shown)]
    print(f"{name}: {len(seen)} of {all_of} pictures received and decoded, error {max(errors):.2f} levels rms at most, PSNR {20 * np.log10(255 / max(errors)):.1f} dB")
    assert max(errors) <= most, errors
    got = packets(read(f"{name}.klv"))
    assert len(got) >= 12 and is_some_of(got, klv), (name, len(got))
mp4 = subprocess.run(["ffmpeg", "-v", "error", "-i", f"{tmp}/b/lwir.mp4", "-f", "rawvideo", "-pix_fmt", "gray", "-"], check=True, capture_output=True).stdout
mp4 = np.frombuffer(mp4, np.uint8).reshape(-1, *png[0].shape).astype(float)
errors = [error(a, b) for a, b in zip(mp4, png)]
print(f"file: error {max(errors):.2f} levels rms at most")
assert len(mp4) == len(png) and max(errors) <= most, errors
png, klv = pngs("a"), klv_of("a.ts")
seen = pictures("gst.gray", png[0])
best = [min(range(41), key=lambda i: error(s, png[i])) for s in seen]
assert len(seen) >= 20 and best == sorted(best) and max(error(s, png[i]) for s, i in zip(seen, best)) <= most, ("gst", len(seen))
got = packets(read("gst.klv"))
stamped(read("c/lwir.ts"), klv_of("c/lwir.ts"), True)
said = subprocess.run(["ffprobe", "-v", "error", "-show_frames", "-select_streams", "v", f"{tmp}/a.ts"], capture_output=True, text=True).stdout
assert said.count("User Data Unregistered SEI message") >= len(klv), "ffprobe shows the time stamps"
print(f"GStreamer: {len(seen)} pictures, {len(got)} metadata packets")
assert len(got) >= 20 and is_some_of(got, klv), ("gst", len(got))
PY
check "what was received" python3 "$tmp/check.py" "$tmp"
finish
