#!/usr/bin/env bash
# Tracks in score.json, from truth.jsonl and answers.jsonl: by TrackEval, and by counting what coasts, purity and delays; the order
# of both files; the page beside it.
. "$(dirname "$0")/common.sh"
judges python3.trackeval
judge=tests/system/score_tracks_judge.py

for seed in 1 2; do
    mkdir "$tmp/$seed"
    python3 $judge make "$tmp/$seed" $seed || fail "the judge makes a run"
    run score "$tmp/$seed"
    check "score $seed" [ $code = 0 ] || cat "$tmp/stderr"
    check "tracks $seed" python3 $judge judge "$tmp/$seed" "$tmp/$seed/score.json"
done
sed 's/"coasts": /&1/' "$tmp/1/score.json" >"$tmp/spoilt.json"
check "its twin is noticed" not quiet python3 $judge judge "$tmp/1" "$tmp/spoilt.json"

# the same page to the octet of answers in another order, and beside another recogniser
cp "$tmp/1/score.html" "$tmp/first.html"
shuf --random-source=<(yes) "$tmp/1/answers.jsonl" >"$tmp/shuffled.jsonl" && cp "$tmp/shuffled.jsonl" "$tmp/1/answers.jsonl"
run score "$tmp/1" --overwrite
check "answers in another order: the same page" cmp "$tmp/1/score.html" "$tmp/first.html"
cat >"$tmp/page.py" <<'PY'
# well-formed by another parser, self-contained, and with the figures of score.json
import html.parser, json, sys
text = open(sys.argv[1], encoding="utf-8").read()
class Page(html.parser.HTMLParser):
    void, open_, words = {"meta", "img", "br"}, [], []
    def handle_starttag(self, tag, attributes):
        if tag not in self.void: self.open_.append(tag)
        for name, value in attributes:
            assert name not in ("src",) or value.startswith("data:image/png;base64,"), value
            assert not name.startswith("on"), name
        assert tag not in ("script", "link", "iframe", "object"), tag
    def handle_endtag(self, tag): assert self.open_.pop() == tag, tag
    def handle_startendtag(self, tag, attributes): pass
    def handle_data(self, data): self.words.append(data.strip())
page = Page()
page.feed(text)
assert not page.open_, page.open_
for r in json.load(open(sys.argv[2]))["recognisers"]:
    for figure in (f"{r['tracks']['idf1']:.3f}", f"{r['total']['detection']['value']:.2f}", f"{r['errors']['rms_px']:.2f}", str(r["answers"]) + " answers"):
        assert figure in page.words, figure
    assert r["name"] in page.words
PY
check "the page" python3 "$tmp/page.py" "$tmp/1/score.html" "$tmp/1/score.json"
python3 - "$tmp/2/answers.jsonl" >"$tmp/hostile.jsonl" <<'PY'
import json, sys
for k, line in enumerate(open(sys.argv[1])):
    a = json.loads(line)
    if k % 9 == 0: a["class"] = "</td><script>x()</script>&\"'"[: 20 + k % 9]
    if k % 4: print(json.dumps(a))
PY
run score "$tmp/2" "$tmp/2/answers.jsonl" "$tmp/hostile.jsonl" --out "$tmp/both"
check "two recognisers" [ $code = 0 ] || cat "$tmp/stderr"
check "the page of two, one with hostile classes" python3 "$tmp/page.py" "$tmp/both/score.html" "$tmp/both/score.json"
sed 's/<h2>/<h2><script>/' "$tmp/both/score.html" >"$tmp/spoilt.html"
check "its twin is noticed: a script" not quiet python3 "$tmp/page.py" "$tmp/spoilt.html" "$tmp/both/score.json"
finish
