#!/usr/bin/env bash
# `pitviper fly --seeds N` with a recogniser: a row a flight, the median of the misses and its interval by order statistics, which
# numpy and scipy find in the table, too; a path a flight in the plot; and each flight again by its own recording.
. "$(dirname "$0")/common.sh"

judges python3.numpy python3.scipy
. "$(dirname "$0")/../tools/loop_common.sh"

seeds=9
few=(--size 32x24 --bands lwir --rate 10 --planes none --set publish.memory_record=truth --no-png "${bare[@]}" --threads 2)
loop_over() { # NAME OPTIONS...: the flights of all seeds
    local name=$1; shift
    run fly "$tmp/short.yaml" --seeds $seeds --set seed=11 "$@"
    cp "$tmp/stdout" "$tmp/$name.csv"
    check "$name: ended with $code: $(tail -n 2 "$tmp/stderr")" [ "$code" = 0 ]
    tail -n 1 "$tmp/$name.csv"
}
loop_over seeds --frames "$tmp/seeds" --plot "$tmp/seeds.svg" --recogniser "$knows" -- "${few[@]}"
python3 - "$tmp/seeds.csv" $seeds >"$tmp/judged" <<'END'
import csv, re, sys
import numpy
from scipy.stats import binom
lines = open(sys.argv[1]).read().splitlines()
rows, n = list(csv.DictReader(lines[:-1])), int(sys.argv[2])
said = re.fullmatch(r'CEP (\S+) m over (\d+) flights, 95 % interval (\S+) \.\. (\S+) m', lines[-1])
miss = numpy.sort([float(row['miss_m']) for row in rows])
k = max(k for k in range(1, n) if binom.cdf(k - 1, n, 0.5) <= 0.025)
want = numpy.median(miss), miss[k - 1], miss[n - k]
print([row['seed'] for row in rows] == [str(11 + i) for i in range(n)], len(set(miss)) == n,
      said is not None and int(said[2]) == n and all(abs(float(said[i]) / w - 1) < 1e-3 for i, w in zip((1, 3, 4), want)),
      sum(row['hit'] == 'entity' for row in rows), *('%.3g' % w for w in want))
END
read -r numbered apart agrees hits cep low high <"$tmp/judged"
check "a row a seed" [ "$numbered" = True ]
check "all of another miss" [ "$apart" = True ]
check "the circular error probable and its interval: $cep, $low .. $high m" [ "$agrees" = True ]
check "it knows the truth, so most hit: $hits of $seeds" [ "$hits" -ge 7 ]
check "a path a flight" [ "$(grep -c '<path\|<polyline' "$tmp/seeds.svg")" -ge $((2 * seeds)) ]
check "each in a folder of its own" [ "$(find "$tmp/seeds" -name sights.csv | wc -l)" = $seeds ]
run fly "$tmp/short.yaml" --set seed=14 --sights "$tmp/seeds/seed_14/sights.csv" -- "${few[@]}"
check "and again by its recording" [ "$(tail -n 1 "$tmp/stdout")" = "$(grep '^14,' "$tmp/seeds.csv")" ]

finish
