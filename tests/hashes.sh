#!/bin/sh
# hashes.sh [DIR] - are results the same under every compiler and flag, and are they right?
# Builds gxcut in many ways, cuts the same files by each, and compares their topology_hash. Compares hashes of Booleans of surfaces
# (hash_boolean.c). Lets the same builds of the library decide random cases, which fuzz.c checks.
# Prints a line per build and `N passed, N failed`. JOBS=N: builds at a time. CASES=N: random cases in each (500). FEWER=1: without
# builds that `make check` and `make flags` are much like.
set -u
dir=${1:-build/hashes}
jobs=${JOBS:-2}
cases=${CASES:-500}
mkdir -p "$dir" || exit 1
passed=0
failed=0

# Two wavy sheets that cross, and a box, as files: decimals that every build reads exactly
awk 'BEGIN { n = 17; for (s = 0; s < 2; s++) { file = ARGV[1] "/sheet" s ".obj"
        for (j = 0; j < n; j++) for (i = 0; i < n; i++) { u = -0.5 + 3 * i / (n - 1); v = -0.5 + 3 * j / (n - 1); w = 0.9 + 0.2 * sin(4 * u) * cos(3 * v)
            if (s == 0) printf "v %.17g %.17g %.17g\n", u, v, w > file; else printf "v %.17g %.17g %.17g\n", w, u, v > file }
        for (j = 1; j < n; j++) for (i = 1; i < n; i++) { a = (j - 1) * n + i; printf "f %d %d %d\nf %d %d %d\n", a, a + 1, a + n + 1, a, a + n + 1, a + n > file } } }' "$dir"

sixths=""
for x in 0.16666666666666666 0.33333333333333331 0.5 0.66666666666666663 0.83333333333333337; do
    sixths="$sixths --sheet plane:$x,0.5,0.5,1,0,0 --sheet plane:0.5,$x,0.5,0,1,0"
done

hash_of() { # binary, arguments
    "$@" --frames 0 --quiet --report "$report" >/dev/null 2>&1 || { echo "failed"; return; }
    sed -n 's/.*"topology_hash": *"\([0-9a-f]*\)".*/\1/p' "$report"
}

hashes() { # binary
    hash_of "$1" cube5 $sixths
    hash_of "$1" grid:2,2,2,6 --sheet "$dir/sheet0.obj" --sheet "$dir/sheet1.obj"
    hash_of "$1" grid:2,2,2,5 --sheet "$dir/sheet0.obj" --solid box:0.5,0.25,0.125,1.5,1,1.75 --sheet plane:1,1,1,1,0,0
}

# The programs, built without the library's flags, since they compute with doubles too: errors are the library's
programs() { # compiler, -m32 or nothing
    for program in examples/gxcut tests/hash_boolean tests/fuzz; do
        "$@" -std=c99 -O1 -w -I. -DGXFEM_LINKED -c $program.c -o "$dir/$(basename $program)_$*.o" 2>/dev/null
    done
}

random() { "$1" tests/corpus/* && "$1" --out="$dir" --cases="$cases"; } # binary

# one FILE COMPILER FLAGS...: builds the library and the programs, writes the hashes to FILE; no file if nothing can be built here
one() {
    file=$1
    shift
    printf '#include <errno.h>\n#include <stdint.h>\n#include <stdio.h>\nint main(void) { return 0; }\n' >"$file.c"
    "$@" -w "$file.c" -o "$file.probe" -lm >"$file.log" 2>&1 || return 0
    printf '#define GXFEM_IMPLEMENTATION\n#include "gxfem.h"\n' >"$file.c"
    plain=$1 # the flags that are left for linking the programs
    case "$*" in *-m32*) plain="$1 -m32" ;; esac
    "$@" -w -I. -c "$file.c" -o "$file.o" >>"$file.log" 2>&1 || { echo "failed" >"$file"; return; }
    for program in gxcut hash_boolean fuzz; do
        $plain "$dir/${program}_$plain.o" "$file.o" -o "$file.$program" -lm >>"$file.log" 2>&1 || { echo "failed" >"$file"; return; }
    done
    report=$file.json
    { hashes "$file.gxcut"; "$file.hash_boolean" && random "$file.fuzz" >>"$file.log" 2>&1 || echo "failed"; } | tr '\n' ' ' >"$file"
}

count=0
try() { # compiler flags...
    command -v "$1" >/dev/null 2>&1 || return
    count=$((count + 1))
    rm -f "$dir/$count"
    echo "$*" >"$dir/$count.build"
}

each() { # first: builds first, first + jobs, ...
    i=$1
    while [ "$i" -le $count ]; do
        one "$dir/$i" $(cat "$dir/$i.build")
        i=$((i + jobs))
    done
}

x86=$(uname -m | grep -c -E 'x86_64|i.86')
fma=$(grep -c -m1 ' fma ' /proc/cpuinfo 2>/dev/null || true)
for cc in gcc clang; do
    try $cc -std=c99 -O0
    [ -n "${FEWER-}" ] || try $cc -std=c99 -O2
    # -Ofast below is that and more
    [ -n "${FEWER-}" ] && [ "$x86" = 1 ] && [ "${fma:-0}" != 0 ] || try $cc -std=gnu99 -O3 -ffast-math
    [ -n "${FEWER-}" ] || try $cc -std=c99 -O1 -DGXB_LIMB32
    [ $cc = clang ] || try $cc -std=c99 -O1 -DGXFEM_INTRINSICS
    if [ "$x86" = 1 ]; then
        if [ "${fma:-0}" != 0 ]; then try $cc -std=gnu99 -Ofast -march=native; fi
        if [ $cc = gcc ]; then try $cc -std=c99 -O2 -mfpmath=387; fi
        try $cc -std=c99 -O2 -m32
        try $cc -std=c99 -O2 -m32 -ffast-math
    fi
done
if [ "$x86" = 1 ]; then # flush-to-zero and denormals-are-zero from the first instruction on
    printf '%s\n' '#include <xmmintrin.h>' '__attribute__((constructor)) static void flush(void) { _mm_setcsr(_mm_getcsr() | 0x8040); }' >"$dir/flush.h"
    try gcc -std=c99 -O2 -include "$dir/flush.h"
    try clang -std=c99 -O2 -include "$dir/flush.h"
fi
for cc in gcc clang; do programs $cc & programs $cc -m32; wait; done
for worker in $(seq "$jobs"); do each "$worker" & done
wait
for i in $(seq $count); do
    build=$(cat "$dir/$i.build")
    if [ ! -f "$dir/$i" ]; then echo "skipped  $build (does not build here)"; continue; fi
    got=$(cat "$dir/$i")
    : "${first:=$got}"
    case $got in *failed*) got="a failure (see $dir/$i.log)" ;; esac
    if [ "$got" = "$first" ]; then passed=$((passed + 1)); echo "same     $build"
    else failed=$((failed + 1)); echo "DIFFERS  $build: $got, not $first"; fi
done
echo "$passed passed, $failed failed"
[ $failed -eq 0 ] && [ $passed -gt 0 ]
