#!/usr/bin/env bash
# Settings: the file to begin with is good, means nothing until a # is taken away, and then means what it says;
# what is wrong is said with its line. labels: small
. "$(dirname "$0")/common.sh"

run check --default
cp "$tmp/stdout" "$tmp/node.yaml"
check "--default: exit code" [ $code = 0 ]
check "every section is there" test "$(grep -cE '^(sensor|detector|exercise|terrain|weather):$' "$tmp/node.yaml")" = 5
run check "$tmp/node.yaml"
check "the file to begin with is good" [ $code = 0 ]
check "and changes nothing" test "$(wc -l <"$tmp/stdout")" = 1

sed -i 's/^  # width_px: .*/  width_px: 320/; s/^# seed: .*/seed: 9/' "$tmp/node.yaml"
run check "$tmp/node.yaml"
check "two lines changed: good" [ $code = 0 ]
check "two lines changed: both said" test "$(grep -cE '^  (sensor.width_px = 320 px|seed = 9)$' "$tmp/stdout")" = 2

# each default as a file of its own: it reads back, within its range
section=
mkdir "$tmp/one"
while IFS= read -r line; do
    case $line in
        [a-z]*:) section=${line%:} ;;
        '  # '*)
            # a line of help may hold a colon too: keys are single words
            [[ ${line#  # } =~ ^[a-z0-9_]+:\ . ]] &&
                printf '%s:\n  %s\n' "$section" "${line#  # }" >"$tmp/one/$section.${line#  # }.yaml" ;;
    esac
done < <("$pitviper" check --default)
run check "$tmp"/one/*.yaml
check "defaults tried" [ "$(ls "$tmp/one" | wc -l)" -ge 50 ]
check "each is good by itself" test -z "$(grep -vE 'overrides a sensor preset|needs terrain.elevation|detector.(raw|smear).*yaml: not valid' "$tmp/stderr")"

printf 'sensor:\n  width_px: 7\n' >"$tmp/bad.yaml"
run check "$tmp/node.yaml" "$tmp/bad.yaml"
check "one of two is bad: exit code" [ $code = 1 ]
check "one of two is bad: the good one is said" grep -q 'node.yaml: valid' "$tmp/stdout"
check "one of two is bad: file and line" complained "bad.yaml:2: sensor.width_px: '7' is not a whole number in 8 .. 8192 px"
# all that is wrong is said in one run, each with its line
cat >"$tmp/many.yaml" <<YAML
sensor:
  width_px: 0
  bands: [optical, lwr]
  wdith_px: 3
  preset: staring_lwri
detector:
  bits: 9
heat:
  facets: 4
  step_s: fast
publish: {planes: [range, range], pairs: targets}
weather:
  air_temp_k: 275 k
  day: cleer
radar: {preset: seeker_49}
exercise: {utc: now, from_s: [1, 2]}
sensro: {width_px: 3}
YAML
run check "$tmp/many.yaml"
check "many errors: exit code" [ $code = 1 ]
for at in "2: sensor.width_px: '0' is not a whole number in 8 .. 8192 px" "3: sensor.bands: 'optical,lwr'" "4: no such key: sensor.wdith_px" \
          "7: detector.bits: 9" "9: heat.facets: 4" "10: heat.step_s: 'fast' is not" "11: publish.planes" "11: publish.pairs: 'targets' is not" \
          "13: weather.air_temp_k: '275 k' is not a number in 220 .. 330 K" "14: weather.day: 'cleer'" "16: exercise.utc: 'now'" \
          "16: exercise.from_s needs one value" "17: no such key: sensro" "5: sensor.preset" "15: radar.preset"; do
    check "many errors: $at" complained "many.yaml:$at"
done
check "many errors: each line names the program" [ "$(grep -vc '^pitviper: error: ' "$tmp/stderr")" = 0 ]
check "many errors: no error twice" [ -z "$(sort "$tmp/stderr" | uniq -d)" ]
# so many that nobody reads them: bounded
{ echo 'sensor:'; for i in $(seq 200); do echo "  key_$i: 1"; done; } >"$tmp/endless.yaml"
run check "$tmp/endless.yaml"
check "200 errors: at most some 60 lines" eval '[ $code = 1 -a "$(wc -l <"$tmp/stderr")" -le 60 ] && complained "too many errors"'
# a list in YAML is what its text with commas is; --set takes the text
printf 'sensor: {bands: [optical, lwir], preset: [staring_lwir, tv]}\npublish: {planes: [range, entity]}\n' >"$tmp/listed.yaml"
printf 'sensor: {bands: "optical,lwir", preset: "staring_lwir, tv"}\npublish: {planes: "range , entity"}\n' >"$tmp/text.yaml"
run check "$tmp/listed.yaml"
check "lists: good" [ $code = 0 ]
tail -n +2 "$tmp/stdout" >"$tmp/listed"
run check "$tmp/text.yaml"
check "lists: as the texts" eval '[ $code = 0 -a -s "$tmp/listed" ] && tail -n +2 "$tmp/stdout" | cmp -s - "$tmp/listed"'
printf 'terrain: {elevation: [%s/a, %s/b]}\n' "$tmp" "$tmp" >"$tmp/sheets.yaml"
run check "$tmp/sheets.yaml"
check "lists: of files" complained "cannot read $tmp/a"
printf 'sensor: {bands: [[optical], lwir]}\n' >"$tmp/nested.yaml"
run check "$tmp/nested.yaml"
check "lists: of lists are refused" eval '[ $code = 1 ] && complained "nested.yaml:1: sensor.bands: .* is not one item"'

printf 'terrain:\n  elevation: %s/a,%s/node.yaml\n' "$tmp" "$tmp" >"$tmp/files.yaml"
run check "$tmp/files.yaml"
check "a file that is not there" complained "terrain.elevation: cannot read $tmp/a"
check "one that is" test "$(grep -c 'cannot read' "$tmp/stderr")" = 1
printf 'sensor:\n  bands: lwir,sonar\n' >"$tmp/bands.yaml"
printf 'sensor:\n  preset: nobodys\n' >"$tmp/preset.yaml"
printf 'weather:\n  atmosphere: of_mars\n' >"$tmp/air.yaml"
for name in bands preset air; do
    run check "$tmp/$name.yaml"
    check "$name that no node has: exit code" [ $code = 1 ]
    check "$name that no node has: said, and in which file" complained "(sonar|nobodys|of_mars)" && complained "$name.yaml"
done
run check
check "no file: exit code" [ $code = 2 ]
run check --default "$tmp/node.yaml"
check "--default and a file: exit code" [ $code = 2 ]
run check "$tmp/nowhere.yaml"
check "no such file" complained 'cannot open .*nowhere.yaml'
if "$pitviper" check --default >/dev/full 2>"$tmp/stderr"; then fail "a full disk: exit code"; fi
check "a full disk: said" complained 'cannot write'
finish
