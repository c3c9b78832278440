#!/usr/bin/env bash
# Reference data that tests in C name are here; without a file they leave out the parts that need it, and end well.
. "$(dirname "$0")/common.sh"

mapfile -t files < <(grep -rhoE --include='*.c' 'reference_path\([a-z_]+, "[^"]+"' tests | cut -d'"' -f2 | sort -u)
for file in "${files[@]}"; do needs_data "$file"; done
check "files that tests in C need are known: ${#files[@]}" [ ${#files[@]} -ge 10 ]
finish
