#!/usr/bin/env bash
# As test_model_mutants.sh, thousands of files, under strace: no socket is made, no program started. labels: deep
. "$(dirname "$0")/common.sh"
needs strace command -v strace
PITVIPER_MUTANT_MODELS=500 PITVIPER_MUTANT_STRACE=strace exec bash "$(dirname "$0")/test_model_mutants.sh" "$@"
