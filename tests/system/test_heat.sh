#!/usr/bin/env bash
# The ground's heat in frames: a function of log, settings and time alone, whatever is rendered of it; shade, stands and
# weather that show; marks over a restart.
. "$(dirname "$0")/common.sh"
# the grid of time as it is by default; slopes, shadows and shapes coarser
bare=("${quick[@]}" --set heat.step_s=600 --set heat.vehicle_step_s=30 --set heat.shadow_m=64)

exercise tests/regress/departed/scenario.yaml "$tmp/gone.pcap"
look=(--bands lwir --rate 0.01 --threads 1 --no-png --config "$tmp/look.yaml")
cat >"$tmp/look.yaml" <<'YAML'
sensor: {hfov_deg: 24}
exercise: {aim: 1:3001:1}
observer: {range_m: 60, height_m: 45}
terrain: {detail: off}
YAML
sha_of() { grep "\"frame\":$2," "$1/truth.jsonl" | grep -o '"frame_sha256":"[0-9a-f]*"'; }
same_frame() { [ -n "$(sha_of "$1" "$3")" ] && [ "$(sha_of "$1" "$3")" = "$(sha_of "$2" "$3")" ]; }

replay "$tmp/gone.pcap" "$tmp/whole" "${look[@]}"
check "19 frames" [ "$(frames "$tmp/whole")" = 19 ]
replay "$tmp/gone.pcap" "$tmp/late" "${look[@]}" --from +1750 --bands lwir,mwir,optical
check "--from: the last two frames" [ "$(frames "$tmp/late")" = 2 ]
for name in 000017 000018; do # of the whole run, the two alone
    for plane in lwir truth; do mkdir -p "$tmp/end/frames/$plane" && cp "$tmp/whole/frames/$plane/$name.exr" "$tmp/end/frames/$plane/"; done
done
check "--from, and other bands beside it: those of the whole" same_planes "$tmp/end" "$tmp/late"
replay "$tmp/gone.pcap" "$tmp/one" "${look[@]}" --only 1,18 --threads 2 --no-skip
check "two threads, two frames, --no-skip: the same bits" same_frame "$tmp/whole" "$tmp/one" 1
check "and of the other" same_frame "$tmp/whole" "$tmp/one" 18

# A tank stood there for an hour in the morning: without its marks the ground would be another. A world whose weather is
# constant, or measured, is another too; test_heat_deep.sh has the other settings.
other() { # WHAT SETTING...
    local what=$1; shift
    replay "$tmp/gone.pcap" "$tmp/other" "${look[@]}" --only 1 "$@"
    check "$what: replayed" [ "$code" = 0 ]
    check "$what: changes the frame" not same_frame "$tmp/one" "$tmp/other" 1
}
other "constant weather" --set weather.day=constant
{
    echo 'time_utc,air_temp_c,direct_w_m2,diffuse_w_m2,wind_mps'
    for hour in {0..23}; do printf '2026-06-21T%02d:00:00Z,%d,0,%d,4\n' "$hour" $((8 + hour / 4)) $((hour > 4 && hour < 20 ? 150 : 0)); done
} >"$tmp/rain.csv"
other "a weather file" --set weather.day="$tmp/rain.csv"
check "run.json names the file" grep -q '"weather/rain.csv"' "$tmp/other/run.json"
replay "$tmp/gone.pcap" "$tmp/bad" "${look[@]}" --only 1 --set weather.day="$tmp/none.csv"
check "no such weather file: an error" [ "$code" != 0 ]
check "that names it" complained 'none.csv'
replay "$tmp/gone.pcap" "$tmp/bad" "${look[@]}" --only 1 --set weather.day=sunny
check "no such day: an error with what there is" complained 'clear'
replay "$tmp/gone.pcap" "$tmp/bad" "${look[@]}" --only 1 --set heat.facets=8
check "even facets: an error" complained 'odd'

# Hills in low sun, from far.
hills=(--only 0 --set exercise.utc=2026-06-21T18:45:00Z --set terrain.relief_m=80 --set observer.range_m=2500 --set observer.height_m=400
    --set heat.step_s=1800)
replay "$tmp/gone.pcap" "$tmp/shaded" "${look[@]}" "${hills[@]}"
replay "$tmp/gone.pcap" "$tmp/unshaded" "${look[@]}" "${hills[@]}" --set heat.shadow_m=0
check "shadows of hills change the frame" not same_frame "$tmp/shaded" "$tmp/unshaded" 0

broken() { # WHAT SETTING FILE WHERE
    replay "$tmp/gone.pcap" "$tmp/bad" "${look[@]}" --only 1 --set heat.step_s=3600 --set heat.vehicle_step_s=600 --set "$2=$3"
    check "$1: an error" [ "$code" != 0 ]
    check "that says where" complained "$4"
}

# Over a restart: what stood before, and the temperatures of vehicles, are written and read.
replay "$tmp/gone.pcap" "$tmp/first" "${look[@]}" --only 0,1,2 --set heat.marks="$tmp/marks.csv" --set heat.vehicles="$tmp/kept_k.csv"
check "marks are written" grep -q '^stand,' "$tmp/marks.csv"
check "a trail is among them" grep -q '^track,' "$tmp/marks.csv"
cp "$tmp/marks.csv" "$tmp/kept.csv"
check "temperatures of vehicles are kept" grep -q '^1:3001:1,' "$tmp/kept_k.csv"
check "without files before, the same bits" same_frame "$tmp/one" "$tmp/first" 1
replay "$tmp/gone.pcap" "$tmp/again" "${look[@]}" --only 2 --set heat.marks="$tmp/kept.csv" --set heat.vehicles="$tmp/kept_k.csv"
check "both are read: replayed" [ "$code" = 0 ]
printf 'stand,what is this\n' >"$tmp/kept.csv"
broken "a broken file of marks" heat.marks "$tmp/kept.csv" 'kept.csv'
# Temperatures of vehicles are refused with a line where they are broken.
printf 'entity,model,unix_s,node_k\n1:3001:1,tank,5,warm\n' >"$tmp/kept_k.csv"
broken "a broken file of them" heat.vehicles "$tmp/kept_k.csv" 'kept_k.csv:2'

# Temperatures of parts that are given: those are shown, others stay.
patches_of() { grep "\"frame\":$2," "$1/truth.jsonl" | grep -o '"patch_temp_k":\[[^]]*\]' | head -1 | grep -o '[0-9.]\+'; }
begin_s=$(grep '"frame":0,' "$tmp/whole/truth.jsonl" | grep -o '"time_s":[0-9.]*' | head -1 | cut -d: -f2)
second_s=$(grep '"frame":1,' "$tmp/one/truth.jsonl" | grep -o '"time_s":[0-9.]*' | head -1 | cut -d: -f2)
# a ramp that passes 350 K at the time of frame 1
awk -v a="$begin_s" -v b="$second_s" 'BEGIN { printf "entity,part,t_s,temp_k\n*,engine_deck,%.6f,340\n*,engine_deck,%.6f,360\n", a, 2 * b - a }' >"$tmp/given.csv"
replay "$tmp/gone.pcap" "$tmp/given" "${look[@]}" --only 1 --set heat.given="$tmp/given.csv" --save-frame 1
check "given temperatures: replayed" [ "$code" = 0 ]
check "they change the frame" not same_frame "$tmp/one" "$tmp/given" 1
patches_of "$tmp/one" 1 >"$tmp/one.k"
patches_of "$tmp/given" 1 >"$tmp/given.k"
check "some patches are of 350 K" [ "$(grep -cE '^(350|349.99|350.00)' "$tmp/given.k")" -ge 3 ]
check "and the others as they were" [ "$(paste "$tmp/one.k" "$tmp/given.k" | awk '$1 != $2 && ($2 < 349.98 || $2 > 350.02)' | wc -l)" = 0 ]
check "and there are others" [ "$(paste "$tmp/one.k" "$tmp/given.k" | awk '$1 == $2' | wc -l)" -ge 20 ]
check "run.json names the file" grep -q '"heat/given.csv"' "$tmp/given/run.json"
replay "$tmp/gone.pcap" "$tmp/given2" "${look[@]}" --only 1 --threads 2 --from +1 --set heat.given="$tmp/given.csv"
check "the same bits with two threads and --from" same_frame "$tmp/given" "$tmp/given2" 1
rm "$tmp/given.csv"
check "a frame file needs the table no more" "$pitviper" frame "$tmp/given/frame_000001.pvf"
printf 'entity,part,t_s,temp_k\n*,engine_deck,0,9000\n' >"$tmp/given.csv"
broken "a temperature out of range" heat.given "$tmp/given.csv" 'given.csv:2'

finish
