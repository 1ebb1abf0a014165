#!/bin/sh
# wasm.sh [DIR] - the library as WebAssembly, with and without vectors, run by node: does it give the results of the native build?
# Compares hashes of cuts (gxcut) and of Booleans of surfaces (hash_boolean.c), and random cases (fuzz.c). In a build that is known to
# be wrong, creation must refuse (creation.c). Prints a line per build and `N passed, N failed`.
# JOBS=N: builds at a time (2). CASES=N: random cases in each (2000). CLANG=: the compiler (clang), with its wasm-ld and with
# wasi-libc in SYSROOT= (/usr).
set -u
dir=${1:-build/wasm}
jobs=${JOBS:-2}
cases=${CASES:-2000}
clang=${CLANG:-clang}
wasm="$clang --target=wasm32-wasi --sysroot=${SYSROOT:-/usr} -std=c99 -w -I."
stack=-Wl,-z,stack-size=4194304         # for the fuzzer's oracle; the library does with wasm-ld's 64 kB
mkdir -p "$dir" || exit 1
rm -rf "${dir:?}"/*
. tests/topology.sh

node_run() { node --no-warnings tests/run_wasi.mjs "$@"; }

# Programs are built without the library's flags, so that errors are the library's.
programs() {
    for program in examples/gxcut tests/hash_boolean tests/fuzz; do
        "$@" -O1 -DGXFEM_LINKED -c $program.c -o "$dir/$prefix$(basename $program).o" || return
    done
}

native() {
    prefix=native_ && programs ${CC:-cc} -std=c99 -w -I. && ${CC:-cc} -std=c99 -w -O2 -I. -c "$dir/library.c" -o "$dir/native.o" || return
    for program in gxcut hash_boolean fuzz; do ${CC:-cc} "$dir/native_$program.o" "$dir/native.o" -o "$dir/native_$program" -lm || return; done
    outcome "$dir/native" "$dir/native_gxcut" "$dir/native_hash_boolean" "$dir/native_fuzz"
}

one() { # NAME FLAGS...
    name=$dir/$1
    shift
    $wasm "$@" -c "$dir/library.c" -o "$name.o" || return
    for program in gxcut hash_boolean fuzz; do
        $wasm "$dir/wasm_$program.o" "$name.o" $stack -o "${name}_$program.wasm" -lm || return
    done
    outcome "$name" "node_run ${name}_gxcut.wasm" "node_run ${name}_hash_boolean.wasm" "node_run ${name}_fuzz.wasm"
}

# creation.c as it is, and with vectors where the headers avoid them: clang before 16 is then wrong, and creation must refuse
creation() { # NAME WHAT FOLDER
    $wasm -O2 -msimd128 "$3/tests/creation.c" $stack -o "$dir/$1.wasm" -lm && node_run "$dir/$1.wasm" "$2" >"$dir/$1.out" && echo "$2" >>"$dir/$1.out"
}

vectors() {
    mkdir -p "$dir/vectors/tests" || return
    for header in gxfem*.h; do sed 's/"no-simd128"/"simd128"/' $header >"$dir/vectors/$header"; done
    cp tests/creation.c "$dir/vectors/tests/"
    creation made made .
    creation vectors $forced "$dir/vectors"
}

forced=made
if [ "$($clang -dumpversion | cut -d . -f 1)" -lt 16 ]; then forced=refused; fi
prefix=wasm_
programs $wasm || exit 1
first() { native; one O2 -O2; one O3 -O3; }
second() { one O2_simd -O2 -msimd128; one O3_simd -O3 -msimd128; vectors; }
if [ "$jobs" -gt 1 ]; then first & second & wait; else first; second; fi

judge native "native: $(sed -n 5p "$dir/native.out" 2>/dev/null | cut -d ';' -f 1)" whole native
for name in O2 O2_simd O3 O3_simd; do judge $name "WebAssembly, $name: the same" same $name; done
judge made "WebAssembly, O2_simd: objects are made" grep -q '^made$' "$dir/made.out"
judge vectors "WebAssembly, O2_simd, with vectors in all functions: $forced" grep -q "^$forced\$" "$dir/vectors.out"
verdict
