#!/usr/bin/env bash
# Three cases of tests/regress from a copy elsewhere, by many threads, with another tracer's instructions; beside them one
# whose record is of another sun. A case whose log is missing. labels: two
. "$(dirname "$0")/common.sh"
export TMPDIR=$tmp # what failed on purpose is not kept

# nothing is known by where the repository lies
mkdir "$tmp/copied cases"
cp -r tests/regress/{antimeridian,bundles,impact,tank} "$tmp/copied cases"
sed -i 's/"azimuth_deg":25[0-9]/"azimuth_deg":240/' "$tmp/copied cases/tank/record/truth.jsonl"
check "the twin: a record of another sun" not cmp -s tests/regress/tank/record/truth.jsonl "$tmp/copied cases/tank/record/truth.jsonl"
program=$(realpath "$pitviper")
(cd "$tmp/copied cases" && "$program" regress antimeridian bundles impact tank --threads 5 --isa sse4.2 --junit "$tmp/junit.xml" \
    >"$tmp/stdout" 2>"$tmp/stderr")
code=$?
check "many threads, sse4.2, elsewhere: three are ok" [ "$(grep -cE '^(antimeridian|bundles|impact) +ok' "$tmp/stdout")" = 3 ] ||
    cat "$tmp/stdout"
check "a spoilt record: exit code" [ $code = 1 ]
check "a spoilt record: is named" grep -qE '^tank +FAILED: sun: sun\.azimuth_deg' "$tmp/stdout"
check "a spoilt record: JUnit" grep -q 'failures="1"' "$tmp/junit.xml"

# without its log a case says so, and none has failed
PITVIPER_DATA='' run regress tests/regress/recorded
check "without the log: skipped" grep -qE '^recorded +skipped: log missing: PITVIPER_DATA is not set' "$tmp/stdout"
check "without the log: exit code" [ $code = 0 ]
check "without the log: its line and the sum" [ "$(wc -l <"$tmp/stdout")" = 2 ]
finish
