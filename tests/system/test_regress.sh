#!/usr/bin/env bash
# A case is recorded, passes, and fails in the channel that was spoilt and in no earlier one; whatever is wrong with case
# or record is said, and breaks no other case. More that is spoilt: test_regress_deep.sh.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/regress.sh"
judges python3

# ---- a record is made, and passes -------------------------------------------------------------
new_case good 32x24
sed -i 's/sag_m: 0.02/sag_m: 0.1/' "$tmp/good/case.yaml" # a case is run here some twenty times
echo "mine" >"$tmp/good/notes.txt"
# a table of its own, in the case's folder
grep -v '^#' etc/materials.csv | head -n 2 >"$tmp/good/own.csv"
sed -i 's/models: {sag_m: 0.1}/models: {sag_m: 0.1, materials: own.csv}/' "$tmp/good/case.yaml"
fails good 'no baseline yet: .*--update'
run regress --update "$tmp/good"
check "--update without --why: exit code" [ $code = 2 ]
check "--update without --why: what to do" complained 'why TEXT'
check "--update without --why: no record" [ ! -e "$tmp/good/record" ]
run regress --update "$tmp/good" --why 'seen: two <tanks> and a truck'
check "--update: exit code" [ $code = 0 ]
check "--update: the record" [ -s "$tmp/good/record/000005.exr" ] && [ -s "$tmp/good/record/000024.profile.exr" ]
check "--update: a small one" [ "$(cat "$tmp"/good/record/* | wc -c)" -le 75000 ]
check "--update: its paths are relative to the case" grep -q '"models.materials": "own.csv"' "$tmp/good/record/run.json"
check "--update: no absolute path in the record" not grep -rqF "$tmp" "$tmp/good/record/run.json" "$tmp/good/record/truth.jsonl" "$tmp/good/card.md"
check "--update: the card says why" grep -q '^- why: seen: two <tanks> and a truck$' "$tmp/good/card.md"
check "--update: the date of the exercise" grep -qE '^## pitviper .*exercise of 2026-06-21 17:0[0-9]:[0-9]{2} UTC$' "$tmp/good/card.md"
check "--update: the host, as replay says it" grep -qE '^good +chosen: host: 1:3001:41 ' "$tmp/stdout"
check "--update: the aim, as replay says it" grep -qE '^good +chosen: aim: 1:3001:[0-9]+' "$tmp/stdout"
check "--update: nothing is left over" [ ! -e "$tmp/good/record.part" ]
check "other files are left alone" grep -qx mine "$tmp/good/notes.txt"
touch "$tmp/good/record/notes.txt"
before=$(cat "$tmp"/good/record/*.{exr,jsonl,json} | cksum)
run regress --update "$tmp/good" --why again
check "the same again: same octets" [ "$before" = "$(cat "$tmp"/good/record/*.{exr,jsonl,json} | cksum)" ]
check "the same again: newest first" [ "$(grep '^- why' "$tmp/good/card.md" | head -n 1)" = '- why: again' ]
check "the same again: the old reason stays" [ "$(grep -c '^- why' "$tmp/good/card.md")" = 2 ]
check "the same again: what is not ours stays" [ -e "$tmp/good/record/notes.txt" ]

# ---- the channel that was spoilt is named -------------------------------------------------------
changed another_hour 's/T17:00/T18:30/'
changed another_seed 's/^  seed: 1/  seed: 2/'
changed heavy_rain 's/^  seed: 1/  seed: 1\n  weather: {visibility_m: 5000}/'
changed other_size 's/width_px: 32/width_px: 40/'
run regress "$tmp"/{another_seed,heavy_rain,other_size,another_hour} --report "$tmp/hour.html" --work "$tmp/work_of_hour"
check "four that fail: exit code" [ $code = 1 ]
for line in 'another_hour sun: sun\.' 'another_seed (entity|part|range): ' 'heavy_rain (temperature|optical): ' 'other_size size: expected 32 x 24 pixels, actual 40 x 24'; do
    check "$line" grep -qE "^${line%% *} +FAILED: ${line#* }" "$tmp/stdout" || tail -n 6 "$tmp/stdout"
done
check "hills where sky was: in words" test -z "$(sed 's/base64,[^"]*//g' "$tmp/hour.html" | cat - "$tmp/stdout" | grep -wiE '[+-]?(inf|nan)' | head -n 2)"
check "a changed setting comes first" [ "$(grep -m 1 '^heavy_rain ' "$tmp/stdout" |
    grep -cE "changed: setting weather.visibility_m is '5000', was '[0-9]+'")" = 1 ]

# another table: a column by a factor, in every material
fails_by_table rho_mwir 0.9 mwir

# ---- a case that is wrong, absent, hanging, crashing; beside a good one ----------------------------
changed absent 's|^scenario: demo|log: ${PITVIPER_NOWHERE}/a.pcap\nlog_may_be_absent: true|'
changed absent_file 's|^scenario: demo|log: a.pcap|'
changed bad_config 's/width_px: 32/width_px: 7/'
changed bad_set 's/^config/scenario_set: nobodys=5\nconfig/'
changed beyond 's/frames: .*/frames: [5, 24, 5000]/'
cp "$tmp/good/record/000005.exr" "$tmp/beyond/record/005000.exr"
changed slow 's/timeout_s: 300/timeout_s: 0.1/; s/sag_m: 0.1/sag_m: 0.0001/'
run regress "$tmp"/{good,absent,absent_file,bad_config,bad_set,beyond,slow} --junit "$tmp/junit.xml" --report "$tmp/report.html" \
    --work "$tmp/work" --jobs 3
check "among others: exit code" [ $code = 1 ]
check "among others: the good one" grep -qE '^good +ok' "$tmp/stdout"
check "a variable that is not set" grep -qE '^absent +skipped: log missing: PITVIPER_NOWHERE is not set' "$tmp/stdout"
check "a log that is not there" grep -qE '^absent_file +FAILED: log missing: .*a.pcap.*log_may_be_absent: true.*--allow-missing' "$tmp/stdout"
check "settings that are bad" grep -qE '^bad_config +FAILED: .*config.yaml:2: sensor.width_px' "$tmp/stdout"
check "a scenario's setting" grep -qE '^bad_set +FAILED: .*nobodys' "$tmp/stdout"
check "a frame that is not there" grep -qE '^beyond +FAILED: .*there is no frame 5000' "$tmp/stdout"
check "one that hangs" grep -qE '^slow +FAILED: .*ended after 0.1 s \(timeout_s\)' "$tmp/stdout"
check "in the order given" [ "$(awk '/ (ok|FAILED:|skipped:) / { printf "%s ", $1 }' "$tmp/stdout")" = "good absent absent_file bad_config bad_set beyond slow " ]

run regress "$tmp/good" "$tmp/absent_file" --allow-missing
check "passes, or --allow-missing: exit code" [ $code = 0 ]
check "--allow-missing: skipped" grep -qE '^absent_file +skipped: log missing' "$tmp/stdout"
check "passes: its line" grep -qE '^good +ok' "$tmp/stdout"
check "passes: to the bit" test -z "$(grep 'bits differ' "$tmp/stdout")"

# without `causal`: the user's own replay
changed plain '/^causal/d'
run regress --update "$tmp/plain" --why 'as replay has it' --work "$tmp/work"
"$pitviper" exercise demo -o "$tmp/demo.pcapng" >/dev/null
"$pitviper" replay "${bare[@]}" "$tmp/demo.pcapng" -c "$tmp/work/plain/config.yaml" --only 5,24 --out "$tmp/own" --no-png >/dev/null 2>&1
check "causal is false by default: the bits of a plain replay" test "$(hashes "$tmp/own")" = "$(tr -d ' \n' <"$tmp/plain/record/run.json" | grep -o '"frame_sha256":\[[^]]*\]')"
check "and not those of --causal" test "$(hashes "$tmp/own")" != "$(tr -d ' \n' <"$tmp/good/record/run.json" | grep -o '"frame_sha256":\[[^]]*\]')"

# a crash: the child gets a signal that it would give itself
changed crash 's/width_px: 32/width_px: 720/; s/height_px: 24/height_px: 486/; s/sag_m: 0.1/sag_m: 0.0001/; s/rate_hz: 5/rate_hz: 5\n    samples: 8/'
"$pitviper" regress "$tmp/crash" --work "$tmp/work" >"$tmp/stdout" 2>"$tmp/stderr" &
parent=$!
for ((i = 0; i < 400; i++)); do
    child=$(cat /proc/$parent/task/*/children 2>/dev/null | tr -d '\n')
    [ -n "$child" ] && grep -qz replay "/proc/${child%% *}/cmdline" 2>/dev/null && break
    sleep 0.05
done
sleep 0.2
kill -SEGV ${child%% *} 2>/dev/null
wait $parent
check "one that crashes: exit code" [ $? = 1 ]
check "one that crashes: said" grep -qE '^crash +FAILED: `pitviper replay` crashed: Segmentation fault' "$tmp/stdout" || cat "$tmp/stdout"

# ---- what is written for others ------------------------------------------------------------------
python3 - "$tmp/junit.xml" "$tmp/report.html" <<'PYTHON' || fail "junit.xml and report.html"
import base64, re, sys
import xml.etree.ElementTree as tree
from html.parser import HTMLParser
suite = tree.parse(sys.argv[1]).getroot()
assert suite.tag == "testsuite" and suite.get("tests") == "7", suite.attrib
assert (suite.get("errors"), suite.get("skipped"), suite.get("failures")) == ("5", "1", "0"), suite.attrib
cases = {c.get("name"): [k.tag for k in c if not k.tag.startswith("system")] for c in suite}
assert cases["good"] == [] and cases["absent"] == ["skipped"] and cases["slow"] == ["error"], cases
page = open(sys.argv[2]).read()
class Nesting(HTMLParser):
    open_tags = []
    def handle_starttag(self, tag, attrs):
        if tag not in ("meta", "img", "br"): self.open_tags.append(tag)
    def handle_startendtag(self, tag, attrs): pass
    def handle_endtag(self, tag): assert self.open_tags.pop() == tag, (tag, self.getpos())
nesting = Nesting()
nesting.feed(page)
assert not nesting.open_tags, nesting.open_tags
assert "a missile nears a truck &amp; its &lt;column&gt;" in page
pictures = re.findall(r'data:image/png;base64,([^"]+)"', page)
assert len(pictures) >= 4 and all(base64.b64decode(p)[:8] == b"\x89PNG\r\n\x1a\n" for p in pictures), len(pictures)
assert "http" not in re.sub(r'base64,[^"]+', "", page), "needs another file"
PYTHON
for what in 'the probable cause' 'actual - expected' 'To reproduce' 'pitviper replay' 'temperature' 'scale of colours'; do
    check "the report holds: $what" grep -q -- "$what" "$tmp/hour.html"
done
bash -c "$(awk '/To reproduce/ { on = 1; next } on' "$tmp/hour.html" | sed -n 's/^<pre[^>]*><code>//; /pitviper/p' | tail -n 1)" >"$tmp/stdout" 2>&1
check "the command by hand does it" grep -q '2 frames in' "$tmp/stdout" || cat "$tmp/stdout"

finish
