#!/usr/bin/env bash
# etc/mutate, on a toy of two functions, one whose answer a test knows and one that it only calls: mutants of the first are
# caught, those of the second live. What is drawn follows from the seed; comments, strings, preprocessor lines, types and sizes
# are never touched; the sources stay as they are.
. "$(dirname "$0")/common.sh"
judges ninja gcov

mkdir -p "$tmp/toy/src" "$tmp/toy/tests/toy" "$tmp/toy/tests/mutants"
cat >"$tmp/toy/src/toy.c" <<'C'
/* 77.7 * 2 is no code, nor is -77.7 */
#include <stdio.h>
#define LIMIT (77.7 + \
               77.7)
double weight_n(double mass_kg);
double drag_n(const double *speed_mps);
double small(double x);
double of_two(void);
double of_one(void);
static const double gravity_mps2 = 9.8; /* +- 2 */

double weight_n(double mass_kg) // 77.7 - 1
{
    if (mass_kg < 0 || mass_kg > LIMIT) return puts("77.7 - 1 < 2"), 0;
    return gravity_mps2 * mass_kg;
}

static inline double never(double x) { return x * 1.5; }

double drag_n(const double *speed_mps)
{
    double of[32] = {speed_mps[0]};
    printf("%g\n", 77.7 * of[0]);
    return 0.5 * of[0] + of[1];
}

double of_two(void)
{
    const double twice[3] = {3, 4, 0};
    return twice[0] + twice[1] + twice[2];
}

double of_one(void)
{
    const double once[3] = {3, 4, 0};
    return once[0] + once[1] + once[2];
}

double small(double x)
{
    return 1e-3 * x + 1e-4;
}
C
cat >"$tmp/toy/tests/toy/test_toy.c" <<'C'
double weight_n(double mass_kg);
double drag_n(const double *speed_mps);
double of_two(void);
double of_one(void);
int main(void)
{
    of_two();
    of_one();
    const double speed_mps = 3;
    drag_n(&speed_mps);
    return !(weight_n(10) > 97.99 && weight_n(10) < 98.01 && weight_n(-1) == 0);
}
C
cat >"$tmp/toy/CMakeLists.txt" <<'C'
cmake_minimum_required(VERSION 3.25)
project(toy C)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
enable_testing()
add_library(toy STATIC src/toy.c)
add_subdirectory(tests)
C
cat >"$tmp/toy/tests/CMakeLists.txt" <<'C'
add_executable(toy_tests toy/test_toy.c)
target_link_libraries(toy_tests PRIVATE toy)
add_test(NAME toy/test_toy COMMAND toy_tests test_toy)
C
cat >"$tmp/toy/tests/mutants/equivalent.csv" <<'C'
file,line,from,to,reason,nth
src/toy.c,return 0.5 * of[0] + of[1];,+,-,of[1] is 0
src/toy.c,return 0.5 * of[2];,+,-,of[2] is 0
src/toy.c,return twice[0] + twice[1] + twice[2];,+,-,twice[2] is 0,2
src/toy.c,return once[0] + once[1] + once[2];,+,-,which of them?
C
quiet cmake -G Ninja -S "$tmp/toy" -B "$tmp/toy/build/release" -DCMAKE_BUILD_TYPE=Debug || fail "the toy is not configured"
quiet ninja -C "$tmp/toy/build/release" || fail "the toy is not built"
cp "$tmp/toy/src/toy.c" "$tmp/before.c"

mutate() { etc/mutate --root "$tmp/toy" --build "$tmp/toy/build/release" --sources toy=src "$@" >"$tmp/stdout" 2>"$tmp/stderr"; }
check "a list" mutate --list --seed 1
cp "$tmp/stdout" "$tmp/first"
check "the same seed" mutate --list --seed 1
check "draws the same" cmp -s "$tmp/first" "$tmp/stdout"
check "another seed" mutate --list --seed 2
check "draws in another order" not cmp -s "$tmp/first" "$tmp/stdout"
check "of the same" cmp -s <(sort "$tmp/first") <(sort "$tmp/stdout")
# what may change, on paper: a number of floating type by 10 %, 9.8 by twice its 2, a small power of ten that is no factor
# by a thousand; each operator but `*` of a pointer. Not 77.7, the sizes, what is printed
sort >"$tmp/expected" <<'LIST'
|| -> &&
* -> /
* -> /
* -> /
* -> /
+ -> -
+ -> -
+ -> -
+ -> -
+ -> -
+ -> -
0.5 -> 0.55
1.5 -> 1.65
1e-3 -> 0.0011
1e-4 -> 0.1
9.8 -> 13.8
< -> <=
> -> >=
LIST
sed 's/^[^:]*:[0-9]* [^:]*: \(.* -> [^:]*\): .*/\1/' "$tmp/first" | sort >"$tmp/changes"
check "all that may change, and no more" cmp -s "$tmp/expected" "$tmp/changes"

check "a run" mutate --seed 1
lives='lived 1 unit and 0 system tests pass'
csv=$tmp/toy/build/mutate/mutants_1.csv
# are FUNCTION RESULT...: the results of the mutants of a function
are() { [ "$(results "$1")" = "$(printf '%s\n' "${@:2}" | sort)" ]; }
results() { python3 -c 'import csv, sys
for r in csv.DictReader(open(sys.argv[1])):
    if r["function"] == sys.argv[2]: print(r["from"], r["result"], r["caught_by"])' "$csv" "$1" | sort; }
check "what a test knows is caught" are weight_n '* answer toy/test_toy' "< $lives" "> $lives" '|| answer toy/test_toy'
check "so is a constant of the file" are '' '9.8 answer toy/test_toy'
check "what it only calls lives, but for what is the same" are drag_n "* $lives" '+ equivalent of[1] is 0' "0.5 $lives"
check "of two in a line the one that nth names is the same, the other lives" are of_two '+ equivalent twice[2] is 0' "+ $lives"
check "an entry that does not say which of two is meant counts for neither" are of_one "+ $lives" "+ $lives"
check "and is said" complained 'has several [+] -> - .*once.*next: say in nth'
check "what is in no object is equivalent" are never '* equivalent the same object' '1.5 equivalent the same object'
check "the table" grep -qx 'toy,18,4,3,0,11,21.4' "$tmp/stdout"
check "an entry that matches nothing is said" complained 'of\[2\].* any more; next'
[ $failures = 0 ] || cat "$csv" "$tmp/first" "$tmp/stdout" "$tmp/stderr"
check "the sources are as they were" cmp -s "$tmp/before.c" "$tmp/toy/src/toy.c"
check "a share too small fails" not mutate --seed 1 --go-on --least 90
check "and says so" complained 'FAILED: 21.4 %.*next'
id=$(sed -n 's/ .* 9\.8 -> .*//p' "$tmp/first")
check "one alone" mutate --only "$id" --out "$tmp/one.csv"
check "is one" [ "$(lines_in "$tmp/one.csv")" = 2 ]
check "no such room" not mutate --room nowhere
check "names those that are" complained 'no room nowhere; next: one of toy'
finish
