#!/usr/bin/env bash
# As test_determinism_builds.sh, where the processor has AVX-512.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/determinism.sh"
needs "AVX-512 in this processor" grep -qw avx512vl /proc/cpuinfo

same_as_avx2 avx512
finish
