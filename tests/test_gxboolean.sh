#!/bin/sh
# Tests the program examples/gxboolean.c from outside: exit codes, messages, files, figures.
# usage: sh tests/test_gxboolean.sh PATH/TO/gxboolean
. "$(dirname -- "$0")/program.sh"

# refuses NAME CODE PATTERN ARGUMENTS...: the program must exit with CODE, print one line that matches PATTERN, and leave no file
refuses() {
    name=$1 code=$2 pattern=$3
    shift 3
    rm -f out.off
    "$program" "$@" >stdout 2>stderr
    got=$? why=
    [ $got -eq "$code" ] || why="exit $got, not $code"
    [ "$(wc -l <stderr)" -eq 1 ] || why="$why; stderr is not one line"
    grep -Eq "^gxboolean: .*($pattern)" stderr || why="$why; stderr says '$(head -n 1 stderr)'"
    [ ! -s stdout ] || why="$why; stdout is not empty"
    [ ! -e out.off ] && [ -z "$(find . -name '*.part')" ] || why="$why; files are left"
    check "$name" "$why"
}

# gives NAME "EULER:VOLUME ..." ARGUMENTS...: the result must have these components, in any order, volumes to 1e-12
gives() {
    name=$1 want=$2
    shift 2
    "$program" "$@" >stdout 2>stderr
    got=$? why=
    [ $got -eq 0 ] || why="exit $got"
    [ ! -s stderr ] || why="$why; stderr says '$(head -n 1 stderr)'"
    awk '$1 ~ /^[0-9]+$/ { printf "%d:%.12g\n", $3, $4 }' stdout | sort >got
    printf '%s\n' $want | sed '/^$/d' | sort | cmp -s - got || why="$why; components are $(tr '\n' ' ' <got)"
    check "$name" "$why"
}

refuses "no surface" 2 "usage"
refuses "unknown option" 2 "--frobnicate: unknown option" box:0,0,0,1,1,1 --frobnicate
refuses "value missing" 2 "--union: needs a value" box:0,0,0,1,1,1 --union
refuses "option as value" 2 "--union: needs a value" box:0,0,0,1,1,1 --union --fine
refuses "no operation" 2 "b.off: has no operation before it" box:0,0,0,1,1,1 b.off
refuses "operation first" 2 "--union: comes before the first surface" --union box:0,0,0,1,1,1
refuses "unknown rule" 2 "--rule: 'even' is none of" box:0,0,0,1,1,1 --rule even
refuses "unknown output" 2 "--out: 'r.stl' does not end in .off or .obj" box:0,0,0,1,1,1 --out r.stl
refuses "missing file" 2 "none.off: cannot be read" box:0,0,0,1,1,1 --union none.off
refuses "a plane alone" 2 "plane:0,0,0,0,0,1: is not closed" plane:0,0,0,0,0,1
printf 'OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n' >open.off
refuses "open surface" 1 "open.off:6: the surface is not closed" box:0,0,0,1,1,1 --union open.off --out out.off
refuses "no such folder" 2 "none/r.off: cannot be written" box:0,0,0,1,1,1 --out none/r.off
"$program" --help >stdout 2>stderr
check "help" "$([ $? -eq 0 ] && grep -q '^usage: gxboolean' stdout && [ ! -s stderr ] || echo 'exit code or output')"

set -- box:0,0,0,3,3,3 --difference box:1,1,-1,2,2,4 --difference box:-1,1,1,4,2,2 --difference box:1,-1,1,2,4,2
gives "drilled" "-8:20" "$@"
gives "drilled, merged, into a file" "-8:20" "$@" --merged --out drilled.obj
gives "from that file" "-8:20" drilled.obj
gives "split" "-4:10 -4:10" drilled.obj --split plane:1.5,1.5,1.5,1,1,1 --fine --out halves.off
gives "split by an open surface" "2:1 2:1" box:-1,-1,-1,1,1,-0.5 --split plane:0,0,0,1,0,0
gives "symmetric difference" "2:1 2:1" box:0,0,0,2,1,1 --symmetric box:1,0,0,3,1,1
gives "intersection" "2:1" box:0,0,0,2,1,1 --intersection box:1,0,0,3,1,1
gives "union" "2:3" box:0,0,0,2,1,1 --union box:1,0,0,3,1,1 --coarse
gives "cavity" "4:26" box:0,0,0,3,3,3 --difference box:1,1,1,2,2,2
gives "nothing" "" box:0,0,0,1,1,1 --difference box:0,0,0,1,1,1
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n' >twice.obj
gives "wound twice" "2:0.166666666667" twice.obj
gives "odd" "" twice.obj --rule odd
gives "negative" "" twice.obj --rule negative

echo "$passed passed, $failed failed"
[ $failed -eq 0 ]
