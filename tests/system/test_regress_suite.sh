#!/usr/bin/env bash
# The cases of tests/regress against their records: from here and from a copy elsewhere, by one thread and by many, with
# another tracer's instructions.
. "$(dirname "$0")/common.sh"
export TMPDIR=$tmp # what failed on purpose is not kept
data=${PITVIPER_DATA:-../shared/data}
if [ -d "$data" ]; then PITVIPER_DATA=$(realpath "$data") && export PITVIPER_DATA; fi

cases=(tests/regress/*/case.yaml)
# passes WHAT COUNT: code 0, and a line a case that says ok, or skipped for want of a log
passes() {
    check "$1: exit code" [ $code = 0 ]
    check "$1: a line for each of $2 cases" [ "$(grep -cE '^[a-z0-9_]+ +(ok|skipped: log missing)' "$tmp/stdout")" = "$2" ]
    [ $code = 0 ] || cat "$tmp/stdout"
}

check "some cases" [ ${#cases[@]} -ge 10 ]
check "all records together are small" [ "$(cat tests/regress/*/record/* | wc -c)" -le 1700000 ]
run regress tests/regress/*/ --threads 1 --junit "$tmp/junit.xml" --report "$tmp/report.html"
cat "$tmp/stdout"
passes "one thread" ${#cases[@]}
mutated='tank|antimeridian|dis7|pole|helicopter|bundles' # the cases of test_mutants.sh
check "the cases of mutants: no other bits" [ "$(grep -cE "^($mutated) +ok  \(" "$tmp/stdout")" = 6 ]
check "JUnit: every case" [ "$(grep -c '<testcase ' "$tmp/junit.xml")" = ${#cases[@]} ]
check "JUnit: none failed" grep -q 'failures="0" errors="0"' "$tmp/junit.xml"
check "the report: every case" [ "$(grep -c '<details id="case' "$tmp/report.html")" = ${#cases[@]} ]

# elsewhere: nothing is known by where the repository lies
cp -r tests/regress "$tmp/copied cases"
program=$(realpath "$pitviper")
(cd "$tmp/copied cases" && "$program" regress tank impact bundles pole --threads 5 --isa sse4.2 >"$tmp/stdout" 2>"$tmp/stderr")
code=$?
passes "many threads, sse4.2, elsewhere" 4

# without its log a case says so, and none has failed
PITVIPER_DATA='' run regress tests/regress/recorded
check "without the log: skipped" grep -qE '^recorded +skipped: log missing: PITVIPER_DATA is not set' "$tmp/stdout"
check "without the log: exit code" [ $code = 0 ]
check "without the log: its line and the sum" [ "$(wc -l <"$tmp/stdout")" = 2 ]

# the twin: a record of another sun is not met
sed -i 's/"azimuth_deg":25[0-9]/"azimuth_deg":240/' "$tmp/copied cases/tank/record/truth.jsonl"
run regress "$tmp/copied cases/tank" --junit "$tmp/junit.xml"
check "a spoilt record: fails" [ $code = 1 ]
check "a spoilt record: is named" grep -qE '^tank +FAILED: sun: sun\.azimuth_deg' "$tmp/stdout"
check "a spoilt record: JUnit" grep -q 'failures="1"' "$tmp/junit.xml"
finish
