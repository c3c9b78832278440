#!/usr/bin/env bash
# The cases of tests/regress against their records, but those of test_regress_suite_heat.sh and test_regress_suite_radar.sh,
# which take as long.
# From a copy elsewhere, by more threads and another tracer's instructions: test_regress_elsewhere.sh.
# labels: two
. "$(dirname "$0")/common.sh"
export TMPDIR=$tmp # what failed on purpose is not kept
data=${PITVIPER_DATA:-../shared/data}
if [ -d "$data" ]; then PITVIPER_DATA=$(realpath "$data") && export PITVIPER_DATA; fi

heat=(day departed exhaust halt) # long warmed up
radar=(recorded seeker walls woods) # a radar's, with plants, or of another simulator
part=${PITVIPER_SUITE_PART:-rest}
cases=()
for folder in tests/regress/*/; do
    of=rest
    [[ " ${heat[*]} " != *" $(basename "$folder") "* ]] || of=heat
    [[ " ${radar[*]} " != *" $(basename "$folder") "* ]] || of=radar
    [ $of != "$part" ] || cases+=("$folder")
done

case $part in
    heat) check "the cases of heat" [ ${#cases[@]} = ${#heat[@]} ] ;;
    radar) check "the cases of radar" [ ${#cases[@]} = ${#radar[@]} ] ;;
    *) check "some cases" [ ${#cases[@]} -ge 9 ] ;;
esac
check "all records together are small" [ "$(cat tests/regress/*/record/* | wc -c)" -le 1950000 ]
run regress "${cases[@]}" --threads 1 --junit "$tmp/junit.xml" --report "$tmp/report.html"
cat "$tmp/stdout"
check "exit code" [ $code = 0 ]
check "a line for each of ${#cases[@]} cases" [ "$(grep -cE '^[a-z0-9_]+ +(ok|skipped: log missing)' "$tmp/stdout")" = ${#cases[@]} ]
if [ "$part" = rest ]; then
    mutated='tank|antimeridian|dis7|pole|helicopter|bundles' # the cases of test_mutants.sh
    check "the cases of mutants: no other bits" [ "$(grep -cE "^($mutated) +ok  \(" "$tmp/stdout")" = 6 ]
fi
check "JUnit: every case" [ "$(grep -c '<testcase ' "$tmp/junit.xml")" = ${#cases[@]} ]
check "JUnit: none failed" grep -q 'failures="0" errors="0"' "$tmp/junit.xml"
check "the report: every case" [ "$(grep -c '<details id="case' "$tmp/report.html")" = ${#cases[@]} ]
finish
