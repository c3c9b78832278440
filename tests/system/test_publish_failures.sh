#!/usr/bin/env bash
# What takes the frames fails: readers of the shared memory that stop or die, a receiver of the stream that vanishes, an
# encoder that fails, a full disk. Every frame that is due is made; what is lost is counted and said once. Longer, with
# recovery: test_publish_failures_deep.sh. labels: small
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"

exercise demo "$tmp/demo.pcap"
frames_of() { json_numbers "$tmp/$1/run.json" frames | tail -n 1; }
# consumer OUT NAME FIELD: of latency_ms.consumers in its run.json
consumer() { run_json "$tmp/$1" | grep -oE "\"$2\":\{\"[a-z][^}]*\}" | tail -n 1 | grep -oE "\"$3\":[0-9.]+" | cut -d: -f2; }
said_times() { grep -cE -e "$2" "$tmp/$1.out"; } # said_times NAME TEXT
# watched NAME options: 21 frames of a replay by the clock, 64x48, one band, without files
watched() {
    local name=$1; shift
    "$pitviper" replay "$tmp/demo.pcap" --out "$tmp/$name" --size 64x48 --bands lwir --rate 10 --from 1364 --to 1366 --threads 1 \
        --speed 1 --no-files --set quality.budget=off "$@" >"$tmp/$name.out" 2>&1
    code=$?
}
readers=()
trap 'kill -KILL "${readers[@]}" 2>/dev/null; wait "${readers[@]}" 2>/dev/null; chmod -R u+w "$tmp" 2>/dev/null; rm -rf "$tmp"' EXIT

# ---- a full disk: the live node writes into a file system of its own, which is too small -------------------------
own_disk() { unshare -rm true 2>/dev/null && unshare -rm bash -c "mount -t tmpfs -o size=4k none '$tmp'" 2>/dev/null; }
if own_disk; then
    mkdir "$tmp/disk"
    for kind in full roomy; do
        free_port
        size=$([ $kind = full ] && echo 24k || echo 64m)
        unshare -rm bash -c "mount -t tmpfs -o size=$size none '$tmp/disk' && \"\$@\"; code=\$?; cp '$tmp/disk/out/run.json' '$tmp/$kind.json' 2>/dev/null; exit \$code" \
            bash "$pitviper" run --out "$tmp/disk/out" --address 127.0.0.1 --port $port --size 64x48 --rate 5 --frames 10 --for 25 \
            --bands lwir --threads 1 --set exercise.listen_s=0.5 --set quality.budget=off >"$tmp/$kind.out" 2>&1 &
        node[$kind]=$!
        "$pitviper" exercise demo --send 127.0.0.1:$port >/dev/null 2>&1 &
        readers+=($!)
    done
else
    echo "skipped in part: this user may not mount a file system of their own: no full disk"
fi

# ---- readers of the shared memory, and a receiver of the stream -------------------------------------------------
name=pitviper_failures_$$
stream=udp://127.0.0.1:$((port + 3001))
if command -v cc >/dev/null && cc -O1 -I etc/include etc/examples/read_memory.c -o "$tmp/reader" 2>/dev/null; then
    "$tmp/reader" $name --wait 20 >"$tmp/stopped" 2>&1 & stopped=$!
    "$tmp/reader" $name --wait 20 >"$tmp/killed" 2>&1 & killed=$!
    "$tmp/reader" $name --wait 20 --in-order >"$tmp/reads" 2>&1 & reads=$!
    disown $killed
    readers+=($stopped $killed $reads)
    (
        for ((i = 0; i < 200; i++)); do [ -s "$tmp/stopped" ] && [ -s "$tmp/killed" ] && break; sleep 0.05; done
        kill -STOP $stopped
        kill -KILL $killed
    ) &
else
    reads=
    echo "skipped in part: no C compiler: no readers of the shared memory"
fi
options=(--memory $name)
"$pitviper" run --help | grep -q -- --stream && options+=(--stream "$stream")
watched readers "${options[@]}"
check "readers that stop and die: the replay ends well" [ "$code" = 0 ] || cat "$tmp/readers.out"
check "readers that stop and die: every frame is made" [ "$(frames_of readers)" = 21 ]
check "and written" [ "$(consumer readers memory count)" = 21 -a "$(consumer readers memory left_out)" = 0 ]
check "the memory's name is gone" [ ! -e /dev/shm/$name ]
if [ -n "$reads" ]; then
    kill -CONT $stopped
    wait $reads
    check "a reader beside them gets every frame" [ "$(grep -c '^frame ' "$tmp/reads")" = 21 ] || tail -n 3 "$tmp/reads"
    check "the one that was stopped did stop" [ "$(grep -c '^frame ' "$tmp/stopped")" -lt 21 ]
    wait $stopped 2>/dev/null
fi
if grep -q "^video: $stream" "$tmp/readers.out"; then
    check "nothing receives: said once" [ "$(said_times readers 'no program receives it')" = 1 ]
    check "and counted" grep -qE "datagrams: sent=[0-9]+ refused=[1-9]" "$tmp/readers.out"
    check "and the frames are sent on" [ "$(consumer readers video count)" = 21 ]
fi

# ---- an encoder ----------------------------------------------------------------------------------------------
if [ -f "$build/tests/libfail_encoder.so" ] && grep -q "^video: $stream" "$tmp/readers.out"; then
    LD_PRELOAD=$build/tests/libfail_encoder.so FAIL_ENCODER=5,1 watched encoder --stream "$stream"
    check "an encoder that fails: the replay ends well" [ "$code" = 0 ] || cat "$tmp/encoder.out"
    check "an encoder that fails: every frame is made" [ "$(frames_of encoder)" = 21 ]
    check "said once" [ "$(said_times encoder 'the encoder .* failed')" = 1 -a "$(said_times encoder 'going on without')" = 1 ]
    check "and counted" grep -qE ' 16 frames lack the video of lwir' "$tmp/encoder.out"
else
    echo "skipped in part: no encoder, or none that can be made to fail"
fi

# ---- the disk, at the end -------------------------------------------------------------------------------------
if [ -d "$tmp/disk" ]; then
    ended roomy 40
    check "with room: it ends well" [ $code = 0 ] || cat "$tmp/roomy.out"
    ended full 40
    check "a full disk: exit code 1" [ $code = 1 ] || cat "$tmp/full.out"
    for kind in full roomy; do check "$kind: every frame is made" grep -q 'frames made 10,' "$tmp/$kind.out"; done
    check "a full disk: said once of images, once of truth" [ "$(said_times full 'going on without')" -le 2 -a "$(said_times full 'going on without')" -ge 1 ]
    check "and counted" grep -qE 'frames without their files: .* [1-9][0-9]* could not be written' "$tmp/full.out"
    check "with room nothing is" not grep -qE 'going on without|without their files' "$tmp/roomy.out"
fi
finish
