#!/bin/sh
# Tests the shared library and what other languages see of it: the list of its functions and structs is current and true, as are the
# declarations made from it; the classes for Python work and give C's bits; the snippets of docs/EMBEDDING.md compile.
# usage: sh tests/bindings.sh BUILD LIBRARY      LIBRARY: as `make lib` builds it
#     CC  the compiler (cc)
# What needs an interpreter or a compiler that is not here is left out, and that is said.
set -u
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd) || exit 2
[ $# -eq 2 ] || { echo "usage: $0 BUILD LIBRARY" >&2; exit 2; }
library=$(CDPATH= cd -- "$(dirname -- "$2")" && pwd)/$(basename -- "$2")
work=$1/bindings
rm -rf "$work" && mkdir -p "$work" || exit 2
CC=${CC:-cc}
passed=0
failed=0

has() { command -v "$1" >/dev/null 2>&1; }
skip() { echo "$1: left out: $2"; }

# try NAME COMMAND...: the command must succeed; if it does not, the end of what it said is shown
try() {
    name=$1
    shift
    if "$@" >"$work/log" 2>&1; then passed=$((passed + 1)); else
        failed=$((failed + 1))
        echo "FAILED $name"
        tail -n 20 "$work/log" | sed 's/^/  /'
    fi
}

# The library exports what the list says, no more.
exports() {
    nm -D --defined-only "$library" | awk '$2 == "T" { print $3 }' | sort >"$work/exported"
    sed -n 's/^.*[ *]\(gx[bis]*_[a-z0-9_]*\)(.*/\1/p' "$root/tests/bindings/abi.txt" | grep -v '^(' | sort >"$work/listed"
    diff "$work/listed" "$work/exported"
}

# The list's sizes and places are the compiler's. Those of bit-fields cannot be asked for.
places() {
    awk 'BEGIN { print "#include <stddef.h>\n#include \"gxfem.h\"\n#include \"gxfem_boolean.h\"\n#include \"gxfem_integrate.h\"\n#include \"gxfem_solve.h\"" }
        /^struct .*bytes$/ { name = $2; sub(":", "", name); printf("typedef char size_of_%s[sizeof(%s) == %s ? 1 : -1];\n", name, name, $3); next }
        /^[a-z]/ { name = "" }
        name != "" && / : [0-9]+$/ { next }
        name != "" { member = $0; if (match(member, /\(\*+[a-z_0-9]+\)/)) member = substr(member, RSTART, RLENGTH); else sub(/.*[ *]/, "", member)
            gsub(/[(*)]|\[.*/, "", member); printf("typedef char place_of_%s_%s[offsetof(%s, %s) == %s ? 1 : -1];\n", name, member, name, member, $1) }
        ' "$root/tests/bindings/abi.txt" >"$work/places.c"
    [ "$(grep -c place_of "$work/places.c")" -gt 300 ] && "$CC" -std=c99 -fsyntax-only -I"$root" "$work/places.c"
}

# current KIND FILE: the file is what the headers give
current() {
    sh "$root/examples/python/declare.sh" "$1" >"$work/$1" && diff "$2" "$work/$1"
}

# snippets LANGUAGE: those of the page, one after the other
snippets() {
    awk -v fence="\`\`\`$1" '$0 == fence { on = 1; next } /^```/ { on = 0 } on' "$root/docs/EMBEDDING.md"
}

# The interpreter that has numpy
python=
for candidate in python3 /usr/bin/python3; do
    if has $candidate && $candidate -c 'import numpy' 2>/dev/null; then python=$candidate; break; fi
done

try "functions that the library exports" exports
try "sizes and places of members" places
if has python3; then
    try "abi.txt is current" current abi "$root/tests/bindings/abi.txt"
    try "gxfem_declarations.py is current" current python "$root/examples/python/gxfem_declarations.py"
    try "Gxfem.cs is current" current csharp "$root/examples/csharp/Gxfem.cs"
else skip "declarations" "no python3"; fi
if [ -n "$python" ]; then
    GXFEM_LIBRARY=$library
    export GXFEM_LIBRARY
    "$CC" -std=c99 -I"$root" "$root/tests/bindings/bits.c" "$library" -Wl,-rpath,"$(dirname -- "$library")" -o "$work/bits" &&
        "$work/bits" >"$work/bits.txt"
    try "Python, bits as C's" "$python" "$root/tests/bindings/test_python.py" "$work/bits.txt"
    try "cut.py" env MPLBACKEND=agg "$python" "$root/examples/python/cut.py" 12
else skip "Python" "no numpy"; fi
snippets cpp >"$work/snippets.cc"
for standard in c++11 c++17; do
    if has "${CXX:-c++}"; then try "C++ snippets, $standard" "${CXX:-c++}" -std=$standard -Wall -Wextra -Werror -fsyntax-only -I"$root" "$work/snippets.cc"
    else skip "C++ snippets, $standard" "no C++ compiler"; fi
done
snippets csharp >"$work/snippets.cs"
if has mcs; then try "C# snippets" mcs -unsafe -target:library -out:"$work/snippets.dll" "$work/snippets.cs" "$root/examples/csharp/Gxfem.cs"
else skip "C# snippets" "no mcs"; fi

echo "bindings: $passed passed, $failed failed"
[ $failed -eq 0 ]
