#!/bin/sh
# flags.sh - the predicates against exact rationals under each compiler and set of flags; and creation.c in builds that would mislead
# them: creation must refuse.
#
#     flags.sh [CASES] [PATTERN]...
#
# CASES: 5000 unless given; 10000000 is the full proof (some six minutes per configuration).
# PATTERN: runs only the configurations whose names match (of the shell, with ? for a space: *fast*, gcc?c99?O2).
# Prints a line for each, and `N passed, N failed` at the end. Exit status 1 if one failed.
# VERBOSE=1 also prints each configuration's figures: ns per call, shares of filter and exact stage.
# FEWER=1: by gnu99 alone, where each set of flags is tried by c99 too.
# JOBS: the number at a time (default: the number of processors).
here=$(cd "$(dirname "$0")" && pwd) || exit 2
cases=5000
case ${1-} in [0-9]*) cases=$1; shift ;; esac
patterns=${*:-*}
jobs=${JOBS:-$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)}
work=$(mktemp -d "${TMPDIR:-/tmp}/gxfem_flags.XXXXXX") || exit 2
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM

chosen() {
    set -f
    for pattern in $patterns; do
        # shellcheck disable=SC2254
        case $1 in $pattern) set +f; return 0 ;; esac
    done
    set +f
    return 1
}

# builds PROBE COMPILER FLAGS...: does it build programs at all? Configurations run side by side, so each has a probe of its own.
builds() {
    probe=$1
    shift
    printf '#include <stdint.h>\n#include <stdio.h>\nint main(void) { return 0; }\n' > "$probe.c"
    "$@" -o "$probe" "$probe.c" -lm 2> /dev/null && "$probe"
}

has_fma() { grep -qw fma /proc/cpuinfo 2> /dev/null || sysctl -n machdep.cpu.features 2> /dev/null | grep -qw FMA; }

# One configuration: run_one NAME ARGUMENTS-OF-THE-PROGRAM COMPILER FLAGS...
run_one() {
    name=$1 arguments=$2
    shift 2
    out=$work/$(echo "$name" | tr ' /' '__')
    if ! builds "$out.probe" "$@"; then
        echo "skipped" > "$out.state"
        echo "skipped  $name (this compiler or system has no such mode)"
        return
    fi
    # shellcheck disable=SC2086
    if "$@" -o "$out" "$here/predicates_flags.c" -lm 2> "$out.log" && "$out" "$cases" $arguments >> "$out.log" 2>&1; then
        echo "passed" > "$out.state"
        echo "passed   $name: $(sed -n 's/^wrong signs: /wrong signs /p' "$out.log") of $cases x 9"
    else
        echo "failed" > "$out.state"
        echo "FAILED   $name"
        cat "$out.log"
        return
    fi
    if [ -n "${VERBOSE-}" ]; then cat "$out.log"; fi
}

# Does creation work or refuse? run_creation NAME MODE FOLDER COMPILER FLAGS...; FOLDER has the headers, and creation.c in tests/
run_creation() {
    name=$1 mode=$2 folder=$3
    shift 3
    out=$work/$(echo "$name" | tr ' /' '__')
    if ! builds "$out.probe" "$@"; then
        echo "skipped" > "$out.state"
        echo "skipped  $name (this compiler or system has no such mode)"
    elif "$@" -w -o "$out" "$folder/tests/creation.c" -lm > "$out.log" 2>&1 && "$out" "$mode" >> "$out.log" 2>&1; then
        echo "passed" > "$out.state"
        echo "passed   $name: $mode"
    else
        echo "failed" > "$out.state"
        echo "FAILED   $name"
        cat "$out.log"
    fi
}

count=0
# Side by side, up to JOBS at a time: next FUNCTION NAME ARGUMENTS...
next() {
    chosen "$2" || return 0
    "$@" &
    count=$((count + 1))
    if [ $((count % jobs)) -eq 0 ]; then wait; fi
}

# configuration NAME ARGUMENTS COMPILER FLAGS...
configuration() { next run_one "$@"; }
creation() { next run_creation "$@"; }

# The headers with a fence that does nothing
mkdir -p "$work/unfenced/tests"
for header in "$here"/../gxfem*.h; do
    sed '/__asm__("" : GXBP_REGISTER(x));/d' "$header" > "$work/unfenced/$(basename "$header")"
done
cp "$here/creation.c" "$work/unfenced/tests/"

for compiler in gcc clang; do
    command -v $compiler > /dev/null 2>&1 || { echo "skipped  $compiler (not installed)"; continue; }
    $compiler --version 2> /dev/null | head -n 1
    if [ -n "${FEWER-}" ]; then standards=gnu99; else standards="c99 gnu99"; fi
    for standard in $standards; do
        configuration "$compiler $standard O0" "" $compiler -std=$standard -O0
        configuration "$compiler $standard O2" "" $compiler -std=$standard -O2
        configuration "$compiler $standard O3 native" "" $compiler -std=$standard -O3 -march=native
        configuration "$compiler $standard Ofast" "" $compiler -std=$standard -Ofast
        configuration "$compiler $standard fast-math" "" $compiler -std=$standard -O2 -ffast-math
        if has_fma; then
            configuration "$compiler $standard fast-math fma" "" $compiler -std=$standard -O3 -ffast-math -mfma -ffp-contract=fast
            configuration "$compiler $standard contract fma" "" $compiler -std=$standard -O2 -mfma -ffp-contract=fast
            configuration "$compiler $standard Ofast fma flush" "flush" $compiler -std=$standard -Ofast -mfma
        fi
    done
    configuration "$compiler limb32" "" $compiler -std=c99 -O2 -DGXB_LIMB32
    [ "$compiler" = clang ] || configuration "$compiler intrinsics" "" $compiler -std=c99 -O2 -DGXFEM_INTRINSICS
    configuration "$compiler limb32 fast-math" "" $compiler -std=gnu99 -Ofast -DGXB_LIMB32
    configuration "$compiler m32" "" $compiler -std=c99 -O2 -m32
    configuration "$compiler m32 fast-math" "" $compiler -std=gnu99 -O3 -ffast-math -m32
    configuration "$compiler flush" "flush" $compiler -std=c99 -O2
    for mode in up down zero; do
        configuration "$compiler round $mode" "$mode" $compiler -std=c99 -O2
        configuration "$compiler round $mode fast-math flush" "$mode flush" $compiler -std=gnu99 -O3 -ffast-math
    done
    creation "$compiler creating" made "$here/.." $compiler -std=c99 -O2
    creation "$compiler creating fast-math" made "$here/.." $compiler -std=gnu99 -Ofast
    creation "$compiler creating fast-math, no fence" refused "$work/unfenced" $compiler -std=gnu99 -Ofast
    if [ $compiler = gcc ]; then
        creation "gcc creating x87 24 bits" single "$here/.." gcc -std=c99 -O2 -mfpmath=387
        creation "gcc creating x87 24 bits m32" single "$here/.." gcc -std=c99 -O2 -m32 -mfpmath=387
        configuration "gcc x87 c99" "" gcc -std=c99 -O2 -mfpmath=387
        configuration "gcc x87 gnu99" "" gcc -std=gnu99 -O2 -mfpmath=387
        configuration "gcc x87 gnu99 O0" "" gcc -std=gnu99 -O0 -mfpmath=387
        configuration "gcc x87 fast-math" "" gcc -std=gnu99 -O3 -ffast-math -mfpmath=387
        configuration "gcc x87 round up" "up" gcc -std=gnu99 -O2 -mfpmath=387
        configuration "gcc x87 m32" "" gcc -std=gnu99 -O2 -m32 -mfpmath=387
        configuration "gcc single-precision-constant" "" gcc -std=gnu99 -O2 -fsingle-precision-constant
        configuration "gcc all fast" "flush" gcc -std=gnu99 -Ofast -march=native -fsingle-precision-constant -fno-signed-zeros
    else
        configuration "clang fp-model fast" "" clang -std=c99 -O3 -ffp-model=fast
        configuration "clang fp-model fast fma" "flush" clang -std=c99 -O3 -march=native -ffp-model=fast
    fi
done
wait
tally() { cat "$work"/*.state 2> /dev/null | grep -c "^$1"; }
passed=$(tally passed) failed=$(tally failed) skipped=$(tally skipped)
if [ "$skipped" -gt 0 ]; then echo "$skipped skipped"; fi
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
