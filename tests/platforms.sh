#!/bin/sh
# platforms.sh [DIR] - the library on other machines, built by cross compilers and run by emulators: does it decide there as it does here?
# On each that runs: hashes of cuts (gxcut) and of Booleans of surfaces (hash_boolean.c), cases that once failed and random cases
# (fuzz.c), the demo's 36 sticks in motion, the clock and files that replace others (system.c), and bodies saved there go on here and
# the other way round (exchange.c; not where the order of bytes is another). Where nothing runs programs, they are built only; by
# Microsoft's rules the headers are compiled only.
# Prints a line per platform and `N passed, N failed`; what cannot be installed or built here is left out, and said.
# JOBS=N: platforms at a time (2). CASES=N: random cases in each (2000). PLATFORMS=: those to try (all)
set -u
dir=${1:-build/platforms}
jobs=${JOBS:-2}
cases=${CASES:-2000}
mkdir -p "$dir" || exit 1
rm -rf "${dir:?}"/*
. tests/topology.sh
WINEDEBUG=-all # it runs programs of the console only
export WINEDEBUG

# NAME | COMPILER AND FLAGS | WHAT RUNS ITS PROGRAMS (none: they are its own; -: nothing) | WHAT IT IS
table() {
    cat <<'END'
native|${CC:-cc}||this machine
native-intrinsics|${CC:-cc} -DGXFEM_INTRINSICS||this machine, vectors by intrinsics
windows-x64|x86_64-w64-mingw32-gcc -static|wine|Windows, x86-64, by mingw-w64
windows-x86|i686-w64-mingw32-gcc -static|-|Windows, i686, by mingw-w64
aarch64|aarch64-linux-gnu-gcc -static|qemu-aarch64-static|ARM, 64 bits
aarch64-intrinsics|aarch64-linux-gnu-gcc -static -DGXFEM_INTRINSICS|qemu-aarch64-static|ARM, 64 bits, vectors by intrinsics
armhf|arm-linux-gnueabihf-gcc -static|qemu-arm-static|ARM, 32 bits
s390x|s390x-linux-gnu-gcc -static|qemu-s390x-static|S/390, the highest byte first
END
}

# Programs are built without the library's flags, so that errors are the library's.
build() { # NAME COMPILER...
    base=$dir/$1
    shift
    "$@" -std=c99 -w -O2 -I. -c "$dir/library.c" -o "${base}_library.o" || return
    for source in examples/gxcut tests/hash_boolean tests/fuzz tests/exchange tests/system; do
        "$@" -std=c99 -w -O1 -DGXFEM_LINKED $source.c "${base}_library.o" -o "${base}_$(basename $source).exe" -lm || return
    done
}

sixths="0.16666666666666666 0.33333333333333331 0.5 0.66666666666666663 0.83333333333333337"

# run NAME RUNNER: what one platform finds, in files of $dir
run() {
    base=$dir/$1 with=$2
    outcome "$base" "$with ${base}_gxcut.exe" "$with ${base}_hash_boolean.exe" "$with ${base}_fuzz.exe"
    $with "${base}_fuzz.exe" tests/corpus/* 2>&1 | tr -d '\r' >"${base}_corpus.out"
    sticks=
    for x in $sixths; do sticks="$sticks --sheet plane:$x,0.5,0.5,1,0,0 --sheet plane:0.5,$x,0.5,0,1,0"; done
    # shellcheck disable=SC2086
    $with "${base}_gxcut.exe" cube5 $sticks --fix 'z<0.001' --stretch 1.5,1.5,1.5 --young 1e5 --dt 0.01 --frames 20 --quiet \
        --out "${base}_frames" --report "${base}_demo.json" 2>&1 | tr -d '\r' >"${base}_demo.out"
    $with "${base}_system.exe" "${base}_files" 2>&1 | tr -d '\r' >"${base}_system.out"
    $with "${base}_exchange.exe" write "${base}_saved" 2>&1 | tr -d '\r' >"${base}_exchange.out"
}

one() { # NAME COMPILER RUNNER
    if ! command -v "${2%% *}" >/dev/null 2>&1; then echo "${2%% *} is not here" >"$dir/$1.missing"; return; fi
    if [ -n "$3" ] && [ "$3" != - ] && ! command -v "$3" >/dev/null 2>&1; then echo "$3 is not here" >"$dir/$1.missing"; return; fi
    # shellcheck disable=SC2086
    build "$1" $2 >"$dir/$1.log" 2>&1 || return
    echo built >"$dir/$1.built"
    [ "$3" = - ] || run "$1" "$3"
}

wanted() { case " ${PLATFORMS:-$1} native " in *" $1 "*) ;; *) return 1 ;; esac; }

table >"$dir/table"
CC=${CC:-cc}
worker() { # NUMBER: every jobs-th platform
    at=0
    while IFS='|' read -r name compiler runner what; do
        at=$((at + 1))
        [ $((at % jobs)) -eq "$1" ] || continue
        wanted "$name" || continue
        case $name in native*) compiler=$CC${compiler#*\}} ;; esac
        one "$name" "$compiler" "$runner" </dev/null
    done <"$dir/table"
}
for number in $(seq 0 $((jobs - 1))); do worker "$number" & done
wait

no_failure() { grep -q '^[0-9]* files, 0 failed$' "$dir/$1_corpus.out"; }
is_right() { grep -q '^0 failed$' "$dir/$1_system.out"; }
falls_apart() { grep -q '"fragments": *36\b' "$dir/$1_demo.json"; }
is_built() { [ -f "$dir/$1.built" ]; }
# What native finds in the platform's file is what it finds in its own, and the platform finds the same in the native one.
exchanges() { # NAME RUNNER
    for file in "$1" native; do
        "$dir/native_exchange.exe" read "$dir/${file}_saved" >"$dir/$1_there.out" || return
        [ $file = native ] && $2 "$dir/$1_exchange.exe" read "$dir/native_saved" | tr -d '\r' | cmp -s - "$dir/$1_there.out" && return
    done
    return 1
}
# A body saved where the order of bytes is another is refused.
refuses() { ! "$dir/native_exchange.exe" read "$dir/$1_saved" >/dev/null 2>&1; }

while IFS='|' read -r platform compiler runner title; do
    wanted "$platform" || continue
    if [ -f "$dir/$platform.missing" ]; then echo "left out $title: $(cat "$dir/$platform.missing")"; continue; fi
    if [ "$runner" = - ]; then judge "$platform" "$title: built" is_built "$platform"; continue; fi
    judge "$platform" "$title: the same topology, $(sed -n 5p "$dir/$platform.out" 2>/dev/null | cut -d ';' -f 1)" same "$platform"
    judge "${platform}_corpus" "$title: cases that once failed" no_failure "$platform"
    judge "${platform}_demo" "$title: the demo" falls_apart "$platform"
    judge "${platform}_system" "$title: the clock, files that replace others" is_right "$platform"
    case $platform in
    native) ;;
    s390x) judge "${platform}_exchange" "$title: its saved bodies are refused here" refuses "$platform" ;;
    *) judge "${platform}_exchange" "$title: saved bodies go on here and there" exchanges "$platform" "$runner" ;;
    esac
done <"$dir/table"

# Microsoft's compiler cannot be had here. clang keeps its rules for languages and types, and says what it would not take: as clang-cl,
# and with what clang adds of its own left aside, as cl.
microsoft() { # STANDARD LANGUAGE FILE FLAGS...
    standard_=$1 language=$2 file=$3
    shift 3
    clang --target=x86_64-pc-windows-msvc -fms-compatibility-version=19.29 -nostdlibinc -I. -isystem tests/microsoft -x "$language" \
        -std="$standard_" -Wall -Wextra -Wno-unused-function -Wno-unknown-pragmas "$@" -Werror -fsyntax-only "$file"
}
if command -v clang >/dev/null 2>&1 && wanted microsoft; then
    for standard in c11 c17 c++14 c++20; do
        case $standard in
        c++*) set -- c++ tests/compile/together.cc ;;
        *) set -- c tests/compile/together.c ;;
        esac
        judge microsoft "Microsoft's rules, clang-cl, $standard" microsoft $standard "$@"
        judge microsoft "Microsoft's rules, cl, $standard" microsoft $standard "$@" -U__clang__
    done
fi
verdict
