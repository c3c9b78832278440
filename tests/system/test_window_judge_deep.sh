#!/usr/bin/env bash
# Window panes against Mitsuba 3, as test_window_judge.sh, with eight times as many of Mitsuba's samples: as frames have them by
# default, and with light sampled over the hemisphere. labels: deep
. "$(dirname "$0")/common.sh"
judges python3.mitsuba

mkdir -p "$tmp/house"
"$build/tests/scenery_scene" "$tmp/house" panes sampled || fail "scenery_scene"
python3 tests/system/window_judge.py "$tmp/house" 8 >"$tmp/views" || fail "window_judge.py"
cat "$tmp/views"
off() { awk -v view="$1" -v column="$2" '$1 == view { print $column < 0 ? -$column : $column }' "$tmp/views"; }
for view in glint sky grazing shade ground foot; do
    [ $view = foot ] && most=4 || most=2
    check "$view: $(off $view 6) %" is "$(off $view 6)" '<' $most
    check "$view, sampled: $(off $view 8) %" is "$(off $view 8)" '<' 2
done
finish
