#!/usr/bin/env bash
# run --head: a tracker in Python turns the eye of a vehicle's sensor, among octets that no tracker sends; each frame's camera is that of the
# pose which its line says (pyproj, scipy); a pose holds when the tracker stops; the recording replays to the same bits.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
bare=("${bare[@]}" "${coarse[@]}")
judges python3.numpy python3.pyproj python3.scipy

few=(--size 32x24 --rate 5 --bands lwir --host 1:3001:13 --set exercise.listen_s=0.3)
free_port
head=127.0.0.1:$port
free_port
node head --address 127.0.0.1 --port $port "${few[@]}" --threads 1 --no-files --head $head --record "$tmp/head.pcapng"
check "it says where it takes poses" heard_by head "listening on"
sender demo --set duration_s=900 --send 127.0.0.1:$port
check "frames are made before there is a tracker" makes head 2
python3 tests/tools/head_sender.py send $head "$tmp/head" 12 garbage &
tracker=$!
check "the tracker is heard" until_of head not quiet kill -0 $tracker
lines=$(lines_in "$tmp/head/truth.jsonl")
check "frames go on without it" makes head $((lines + 4))
stop head
end_sender
wait $tracker
check "it ends well" [ $code = 0 ] || tail "$tmp/head.out"
check "the cameras are those of the poses" python3 tests/tools/head_sender.py judge "$tmp/head"
# NAME: field of the head in each line
heads() { grep -oE '"head":\{"sequence":[0-9]+' "$tmp/head/truth.jsonl" | grep -oE '[0-9]+$'; }
check "no frame before the first pose has one" [ "$(head -2 "$tmp/head/truth.jsonl" | grep -c '"head":')" = 0 ]
check "the last pose is held" [ "$(heads | tail -3 | sort -u | wc -l)" = 1 ]
check "and frames before it have others" [ "$(heads | sort -u | wc -l)" -ge 5 ]
counted() { run_json "$tmp/head" | grep -oE '"head":\{"taken":[0-9]+,"refused":\{[^}]*\}\}' | grep -oE "\"$1\":[0-9]+" | grep -oE '[0-9]+'; }
taken=$(counted taken) old=$(counted old) size=$(counted size)
check "poses are counted: $taken" [ "$taken" -ge 12 ]
check "repeated ones too: $old" [ "$old" = "$taken" ]
check "those of a wrong size, of three kinds: $size" [ "$size" -ge $((3 * (taken / 8))) ]
for reason in magic version flags range; do
    check "$reason: $(counted $reason)" [ "$(counted $reason)" -ge $((taken / 8)) ]
done
check "each datagram is taken or refused" [ $((old + size + $(counted magic) + $(counted version) + $(counted flags) + $(counted range))) = $((2 * taken)) ]

kept=$(grep '"head":' "$tmp/head/truth.jsonl" | sed -n 3p | grep -oE '^\{"frame":[0-9]+' | grep -oE '[0-9]+$')
replay "$tmp/head.pcapng" "$tmp/again" --save-frame "$kept" --causal --port 0 "${few[@]}" --no-files --threads 2 --head $head --to "$(time_of "$tmp/head" '$')"
check "its recording replays" [ $code = 0 ] || cat "$tmp/stderr"
made=$(numbered "$tmp/head" | wc -l)
check "to the same bits" agree "$tmp/head" "$tmp/again" $((made - 1))
turned() { grep -oE '"frame":[0-9]+|"head":\{[^}]*\}|"ecef_from_cam":\[[^]]*\]' "$1/truth.jsonl" | paste -sd' ' | sed 's/"frame"/\n&/g'; }
same_eyes() { comm -13 <(turned "$tmp/again" | sort) <(turned "$tmp/head" | sort) >"$tmp/other"; ! grep -q frame "$tmp/other"; }
check "and to the same eyes" same_eyes

run frame "$tmp/again/frame_$(printf '%06d' "$kept").pvf" --out "$tmp/frame"
check "a saved frame renders to the same planes" [ $code = 0 ] || cat "$tmp/stderr"

# its twin: without poses the frames are others
replay "$tmp/head.pcapng" "$tmp/plain" --causal --port 0 "${few[@]}" --no-files --threads 2 --to "$(time_of "$tmp/head" '$')"
check "its twin: without --head" [ $code = 0 ]
check "has other bits" not quiet agree "$tmp/head" "$tmp/plain" $((made - 1))

# the example's datagrams are those of the page
check "the example sends the same octets" python3 - <<'PY'
import struct, sys
sys.path[:0] = ['etc/examples', 'tests/tools']
sys.argv = ['', 'none']
import send_head
pose = send_head.Pose()
pose.turn(yaw=200, pitch=-95, roll=1.5, zoom=2)
send_head.take_key(pose, '3')
send_head.take_events(struct.pack('=IhBB', 0, 1, 129, 5), {}, pose)
got = pose.datagram(True)
assert got == struct.pack('>4sHHIIQ4f', b'PVHD', 1, 2, 1, 36, struct.unpack('>Q', got[16:24])[0], -160, -90, 1.5, 2), got.hex()
PY

# what cannot be
exercise demo "$tmp/demo.pcap"
refused() { # refused WHAT TEXT OPTION...
    local what=$1 text=$2; shift 2
    run "$@"
    check "$what is refused" [ $code != 0 ]
    check "$what: it says why" complained "$text" || cat "$tmp/stderr"
}
refused "a recording without poses" 'holds no poses of a head' replay "$tmp/demo.pcap" --out "$tmp/not" --head $head --size 32x24 --bands lwir
refused "an address that is none" 'is not ADDRESS:PORT' replay "$tmp/demo.pcap" --out "$tmp/not" --head localhost:5010
refused "a host that turns it, too" 'turns the eye already' replay "$tmp/demo.pcap" --out "$tmp/not" --head $head --cigi 127.0.0.1:9
finish
