# topology.sh - shared by scripts that build the library for other machines: does it decide there as it does here? Sourced.
#     $dir     where things are written
#     $cases   random cases
# A program is given as a command: its path, or an emulator and its path.

printf '#define GXFEM_IMPLEMENTATION\n#include "gxfem.h"\n' >"$dir/library.c"

topology() { # FILE COMMAND...: its topology hash
    report=$1
    shift
    "$@" --frames 0 --quiet --report "$report" >/dev/null && sed -n 's/.*"topology_hash": *"\([0-9a-f]*\)".*/\1/p' "$report"
}

cuts() { # FILE COMMAND...
    file=$1
    shift
    topology "$file" "$@" cube5 --sheet plane:0.3333,0.5,0.5,1,0,0 --sheet plane:0.5,0.6667,0.5,0,1,0 --sheet plane:0.5,0.5,0.5,1,1,1
    topology "$file" "$@" grid:2,2,2,6 --sheet plane:1,1,1,1,0,0 --sheet plane:1,1,0.75,0,0.5,1 --solid box:0.5,0.25,0.125,1.5,1,1.75
    topology "$file" "$@" grid:3,2,2,5 --solid box:0.9,0.9,0.9,2.1,2.1,2.1 --sheet plane:1.5,1,1,1,0.25,0.125
}

# Its counts are compared too, but not its time, nor how some systems end lines.
random() { "$@" --out="$dir" --cases="$cases" | tr -d '\r' | sed 's/, [0-9]* s$//'; }

# outcome FILE GXCUT HASH_BOOLEAN FUZZ: five lines, in FILE.out
outcome() {
    # shellcheck disable=SC2086
    { cuts "$1.json" $2; $3 | tr -d '\r'; random $4; } >"$1.out" 2>"$1.err"
}

passed=0
failed=0
judge() { # NAME WHAT CONDITION...
    name=$1 what=$2
    shift 2
    if "$@"; then passed=$((passed + 1)); echo "passed   $what"; return; fi
    failed=$((failed + 1))
    echo "FAILED   $what"
    for file in "$dir/$name.out" "$dir/$name.err"; do if [ -s "$file" ]; then head -n 40 "$file"; fi; done
}
whole() { [ "$(grep -c . "$dir/$1.out")" -eq 5 ] && grep -q ' 0 failed;' "$dir/$1.out"; }
same() { whole "$1" && cmp -s "$dir/native.out" "$dir/$1.out"; }

verdict() {
    echo "$passed passed, $failed failed"
    [ $failed -eq 0 ]
}
