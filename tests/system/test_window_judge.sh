#!/usr/bin/env bash
# Window panes in the sun and in shade against Mitsuba 3 (polarised light, slabs of glass of index 1.5 before black): the image of the
# sun in one, the sky near square and at a grazing angle, sunlit ground: within 2 %; ground at the foot of the wall within 4 %.
# test_window_judge_deep.sh: light sampled over the hemisphere, too, and more of Mitsuba's samples.
. "$(dirname "$0")/common.sh"
judges python3.mitsuba

mkdir -p "$tmp/house"
"$build/tests/scenery_scene" "$tmp/house" panes || fail "scenery_scene"
python3 tests/system/window_judge.py "$tmp/house" >"$tmp/views" || fail "window_judge.py"
cat "$tmp/views"
off() { awk -v view="$1" '$1 == view { print $6 < 0 ? -$6 : $6 }' "$tmp/views"; }
for view in glint sky grazing shade ground; do check "$view: $(off $view) %" is "$(off $view)" '<' 2; done
check "foot of the wall: $(off foot) %" is "$(off foot)" '<' 4
share() { awk -v view="$1" '$1 == view { print $4 }' "$tmp/views"; }
check "the sun is in the glint" is "$(share glint)" '>' 1000
check "a pane at a grazing angle mirrors seven times as much" is "$(share grazing)" '>' "$(awk -v a="$(share sky)" 'BEGIN { print 7 * a }')"
finish
