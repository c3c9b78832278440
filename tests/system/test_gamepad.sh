#!/usr/bin/env bash
# A gamepad of SDL2's (a virtual one) in the window's program: its datagrams are those of a head tracker, by the sticks and the time
# between; and it turns the eye of a live node, on a display that is none.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
bare=("${bare[@]}" "${coarse[@]}")
needs "projector: built without SDL2" has_projector
pad=$build/tests/libvirtual_pad.so
needs "gamepads that are not there: a sanitizer is in this build" test -r "$pad"

mkdir "$tmp/pad"
for axes in level body; do
    check "poses of a gamepad, $axes" python3 "$(dirname "$0")/../tools/gamepad_judge.py" "$build/pitviper-projector" "$pad" "$tmp/pad" $axes
done

# a live node, which is turned
free_port
head=127.0.0.1:$port
free_port
echo '20000 0 0 0 1' >"$tmp/pad/pad"
LD_PRELOAD=$pad VIRTUAL_PAD=$tmp/pad/pad SDL_VIDEODRIVER=dummy SDL_RENDER_DRIVER=software node eye --address 127.0.0.1 --port $port --size 32x24 \
    --rate 5 --bands lwir --host 1:3001:13 --set exercise.listen_s=0.3 --no-files --head $head --projector lwir --set projector.gamepad=body
check "it says where it takes poses" heard_by eye "listening on"
sender demo --set duration_s=900 --send 127.0.0.1:$port
check "that a gamepad turns the eye is said" heard_by eye 'gamepad: .* turns the eye'
yaws() { grep -oE '"head":\{[^}]*\}' "$tmp/eye/truth.jsonl" | grep -E '"buttons":1[^0-9]' | grep -oE '"yaw_deg":-?[0-9.]+' | sort -u | wc -l; }
three() { [ "$(yaws)" -ge 3 ]; }
check "and its frames look elsewhere, each" until_of eye three || grep -oE '"head":\{[^}]*\}' "$tmp/eye/truth.jsonl" | tail -n 2
stop eye
end_sender
check "it ends well" [ $code = 0 ] || tail "$tmp/eye.out"

exercise demo "$tmp/demo.pcap"
refused() { # refused WHAT TEXT OPTION...
    local what=$1 text=$2; shift 2
    SDL_VIDEODRIVER=dummy replay "$tmp/demo.pcap" "$tmp/not" --size 32x24 --bands lwir --no-files "$@"
    check "$what is refused" [ $code != 0 ]
    check "$what: it says why" complained "$text" || cat "$tmp/stderr"
}
refused "a gamepad without a window" 'projector.gamepad: the projector' --head $head --set projector.gamepad=body
refused "a gamepad that turns nothing" 'exercise.head its poses' --projector lwir --set projector.gamepad=level
finish
