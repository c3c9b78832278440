#!/usr/bin/env bash
# --projector: what an X server without a screen shows equals the table's levels of each image, to the bit; frames keep their bits;
# a display that stands still holds no frame up, and costs its own images alone; one that dies ends nothing.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
bare=("${bare[@]}" "${coarse[@]}")
judges Xvfb python3.numpy python3.OpenEXR python3.PIL python3.pyproj python3.scipy
needs "projector: built without SDL2" has_projector
unset DISPLAY WAYLAND_DISPLAY SDL_VIDEODRIVER
export SDL_RENDER_DRIVER=software XDG_RUNTIME_DIR=$tmp

mkdir "$tmp/screen"
Xvfb -displayfd 3 -screen 0 320x240x24 -fbdir "$tmp/screen" -nolisten tcp 3>"$tmp/display" >"$tmp/xvfb.out" 2>&1 &
server=$!
check "an X server" until_true test -s "$tmp/display" || { cat "$tmp/xvfb.out"; finish; }
screen=:$(cat "$tmp/display")

exercise demo "$tmp/demo.pcap"
printf 'radiance,level\n20,0\n28,200\n34,40\n60,255\n' >"$tmp/radiance.csv" # up, down and up again
printf 'level,counts\n65535,0\n1000.5,8000\n60000,16383\n' >"$tmp/counts.csv"
of=(--size 48x36 --rate 1 --bands optical,lwir --planes none --set detector.raw=true --set sensor.preset=staring_lwir,tv)
counted() { run_json "$1" | grep -oE '"projector":\{"on":"[^"]*",[^{}]*' | grep -oE "\"$2\":[0-9]+" | grep -oE '[0-9]+'; } # counted OUT KEY
# the second frame comes a thousand seconds later: the first stays
shows() { # shows WHAT BAND TABLE|display|counts BITS SCALE [WIDTHxHEIGHT [OPTION...]]
    local what=$1 band=$2 source=$3 bits=$4 scale=$5 window=${6:-} options=(); shift 5; [ $# = 0 ] || shift
    [ ! -f "$source" ] || options+=(--set projector.table="$source")
    [ -z "$window" ] || options+=(--set projector.window=$window)
    rm -rf "$tmp/still"
    DISPLAY=$screen "$pitviper" replay "$tmp/demo.pcap" --out "$tmp/still" --overwrite "${bare[@]}" "${of[@]}" --threads 2 --speed 0.001 \
        --projector $band --set projector.bits=$bits --set projector.scale=$scale "${options[@]}" "$@" >"$tmp/still.out" 2>&1 &
    local still=$!
    check "$what" python3 tests/tools/shown_pixels.py 200 "$tmp/screen/Xvfb_screen0" "$tmp/still" $band "$source" $bits $scale $window
    cp "$tmp/screen/Xvfb_screen0" "$tmp/kept"
    kill -INT $still
    wait $still
    check "$what: one image is shown" [ "$(counted "$tmp/still" shown)" = 1 ] || cat "$tmp/still.out"
}
shows "levels by radiance, through a table that goes down, too" lwir "$tmp/radiance.csv" 8 whole
sed 's/28,200/28,190/' "$tmp/radiance.csv" >"$tmp/other.csv"
check "its twin is noticed: another table" not quiet python3 tests/tools/shown_pixels.py 1 "$tmp/kept" "$tmp/still" lwir "$tmp/other.csv" 8 whole
shows "16 bits of levels by counts: red is high, green is low" lwir "$tmp/counts.csv" 16 one
shows "16 bits of counts as they are, in a window" lwir counts 16 whole 200x120 --set projector.vsync=off
shows "a display image, by nearest neighbours" optical display 8 fit

# frames and their bits are the same
of=(--size 48x36 --bands lwir --no-files --to +16)
replay "$tmp/demo.pcap" "$tmp/plain" "${of[@]}" --rate 4
DISPLAY=$screen replay "$tmp/demo.pcap" "$tmp/seen" "${of[@]}" --rate 4 --projector lwir --set projector.wait_ms=10000
check "a replay that waits for each flip" [ $code = 0 ] || cat "$tmp/stderr"
check "has the same bits" same_hashes "$tmp/plain" "$tmp/seen"
check "and shows all of them" [ "$(counted "$tmp/seen" shown)" = "$(grep -c . "$tmp/seen/truth.jsonl")" ]
check "none is dropped, none is late" [ "$(counted "$tmp/seen" dropped) $(counted "$tmp/seen" late) $(counted "$tmp/seen" waited_out)" = "0 0 0" ]

# in step with a CIGI host, whose Start of Frame waits for the flip
DISPLAY=$screen python3 tests/tools/cigi_flight.py "$pitviper" "$tmp/demo.pcap" "$tmp/cigi" "${bare[@]}" --size 48x36 --bands lwir --threads 2 \
    --projector lwir --set projector.wait_ms=10000 >"$tmp/cigi.out" 2>&1
check "in step with a host" [ $? = 0 ] || cat "$tmp/cigi.out"
check "every frame is flipped before the next is asked for" [ "$(counted "$tmp/cigi" shown) $(counted "$tmp/cigi" dropped) $(counted "$tmp/cigi" waited_out)" = "$(grep -c . "$tmp/cigi/truth.jsonl") 0 0" ]

# a display that stands still: frames go on; images that were never shown are counted; then it goes on, and then it dies
DISPLAY=$screen "$pitviper" replay "$tmp/demo.pcap" --out "$tmp/slow" "${bare[@]}" --size 48x36 --bands lwir --no-files --rate 20 --speed 1 \
    --threads 2 --projector lwir >"$tmp/slow.out" 2>&1 &
slow=$!
window_of() { pgrep -P "$1" -x pitviper-projec; }
check "its window is a process of its own" until_true quiet window_of $slow
window=$(window_of $slow)
check "frames are made" until_true has_lines "$tmp/slow/truth.jsonl" 5
kill -STOP $window
lines=$(lines_in "$tmp/slow/truth.jsonl")
check "frames go on while the display stands still" until_true has_lines "$tmp/slow/truth.jsonl" $((lines + 20))
kill -CONT $window
lines=$(lines_in "$tmp/slow/truth.jsonl")
check "and when it goes on" until_true has_lines "$tmp/slow/truth.jsonl" $((lines + 20))
kill -KILL $window
lines=$(lines_in "$tmp/slow/truth.jsonl")
check "and when it has died" until_true has_lines "$tmp/slow/truth.jsonl" $((lines + 20))
kill -INT $slow
wait $slow
check "it ends as it was told" [ $? = 130 ]
check "that it died is said once" [ "$(grep -c 'its program has ended; frames go on' "$tmp/slow.out")" = 1 ]
made=$(grep -c . "$tmp/slow/truth.jsonl")
shown=$(counted "$tmp/slow" shown) dropped=$(counted "$tmp/slow" dropped)
check "some are shown, and some are not: $shown, $dropped of $made" [ "$shown" -ge 5 -a "$dropped" -ge 20 ]
check "every frame is one or the other, but for what it died with" [ $((made - shown - dropped)) -ge 0 -a $((made - shown - dropped)) -le 2 ]
after=$(run_json "$tmp/slow" | grep -oE '"after_render_ms":\{[^}]*"count":[0-9]+' | grep -oE '[0-9]+$')
check "each flip is of an image that was given: $after of $shown" [ "$after" = "$shown" ]
flips=$(grep -c '"projector":[0-9.]' "$tmp/slow/truth.jsonl")
check "the time of each flip is in the ledger: $flips of $shown" [ "$flips" -ge 5 -a "$flips" -le "$shown" ]

# the window system itself ends
DISPLAY=$screen "$pitviper" replay "$tmp/demo.pcap" --out "$tmp/end" "${bare[@]}" --size 48x36 --bands lwir --no-files --rate 20 --speed 1 \
    --threads 2 --projector lwir >"$tmp/end.out" 2>&1 &
end=$!
check "frames are made and shown" until_true has_lines "$tmp/end/truth.jsonl" 5
kill -TERM $server
wait $server
lines=$(lines_in "$tmp/end/truth.jsonl")
check "they go on without an X server" until_true has_lines "$tmp/end/truth.jsonl" $((lines + 20))
kill -INT $end
wait $end
check "and the run ends well" [ $? = 130 ]

refused() { # refused WHAT TEXT OPTION...
    local what=$1 text=$2; shift 2
    SDL_VIDEODRIVER=${driver-dummy} replay "$tmp/demo.pcap" "$tmp/not" --size 48x36 --bands lwir --no-files "$@"
    check "$what is refused" [ $code != 0 ]
    check "$what: it says why" complained "$text" || cat "$tmp/stderr"
}
refused "a band that is none" "'mwir' is no band of this run: lwir" --projector mwir
refused "a display that is not there" 'there is no display 7' --projector lwir --set projector.display=7
refused "a window that is too small" 'has no room on 32 x 32: projector.scale: fit' --projector lwir --set projector.window=32x32
refused "a size that is none" 'projector.window: .32. is neither full nor WIDTHxHEIGHT' --projector lwir --set projector.window=32
refused "bits between" 'projector.bits: 12 is not 8 or 16' --projector lwir --set projector.bits=12
refused "counts without a sensor" 'no raw counts without a sensor' --projector lwir --set projector.bits=16
refused "a table of more bits" 'at most 255, with projector.bits: 8' --projector lwir --set projector.table="$tmp/counts.csv" --set sensor.preset=staring_lwir
driver='' refused "a machine without a display" 'no window system here|there is no window' --projector lwir
finish
