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
refuses "unknown output" 2 "--out: 'r.ply' does not end in .off, .obj or .stl" box:0,0,0,1,1,1 --out r.ply
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

# ---- requests of the Open Boolean Benchmark

# load I: a file of box I
load() { printf '{"op": "load-mesh", "path": "box_%s.off", "name": "\\u0062ox \\"%s\\""}' "$1" "$1"; }
# does OPERATION ARGUMENTS: a Boolean of solids
does() { printf ', {"op": "boolean-%s", "args": [%s]}' "$1" "$2"; }

"$program" box:0,0,0,3,3,3 --out box_0.off >stdout && "$program" box:1,1,-1,2,2,4 --out box_1.off >stdout &&
"$program" box:-1,1,1,4,2,2 --out box_2.off >stdout && "$program" box:1,-1,1,2,4,2 --out box_3.off >stdout
check "boxes" "$([ $? -eq 0 ] || echo 'no files')"
mkdir one two

# 4, 5, 6: a chain. 7, 8: its union of tools, and less than that. 9, 10: both ways differ by nothing. 11: two states of the chain.
# 12, 13: a chain that does not stand first. 14: a state of a chain that others have extended. 15, 16: one argument
{
    printf '{"kind": "boolean-benchmark", "version": 1, "id": "\\u00e9/1", "system_snapshot": {"x": [1, -2.5e3, null, true, {}, []]},\n'
    printf ' "runs": [{"case_id": "one", "out_dir": "one", "operations": [%s, %s, %s, %s' "$(load 0)" "$(load 1)" "$(load 2)" "$(load 3)"
    does difference 0,1; does difference 4,2; does difference 5,3; does union 1,2,3; does difference 0,7; does difference 6,8
    does difference 8,6; does intersection 4,5; does union 3,5; does intersection 2,12,2; does difference 4,3; does union 2
    does difference 15
    printf ']},\n {"case_id": "two", "out_dir": "two", "operations": [%s, {"op": "load-mesh", "path": "open.off"}' "$(load 0)"
    does union 0,1; does union 0,0
    printf ']}, {"case_id": "three", "out_dir": "two", "operations": [%s, {"op": "boolean-sum", "args": [0, 0]}]},\n' "$(load 0)"
    printf ' {"case_id": "four", "out_dir": "two", "operations": [%s' "$(load 0)"
    does union 0,1
    printf ']}]}\n'
} >request.json
"$program" --request request.json --result result.json >stdout 2>stderr
check "request" "$([ $? -eq 1 ] && grep -q '^gxboolean: result.json: not all operations succeeded' stderr || cat stderr)"
grep -q '"id": "\\u00e9/1"' result.json && grep -q '"case_id": "one", "status": "success"' result.json &&
    grep -q '"case_id": "two", "status": "invalid_input"' result.json && grep -q 'the surface is not closed' result.json &&
    grep -q '"case_id": "three", "status": "unsupported"' result.json && grep -q 'request.json:3: an unknown operation' result.json &&
    grep -q '"case_id": "four", "status": "invalid_input"' result.json && grep -q 'request.json:4: an argument is not the index' result.json
check "result" "$([ $? -eq 0 ] || cat result.json)"
check "operations" "$([ "$(grep -c '"status": "success", "debug_total_ms"' result.json)" -eq 20 ] || echo 'not 17 + 2 + 1 of success')"
if command -v python3 >/dev/null 2>&1; then
    check "is JSON" "$(python3 -c 'import json, sys; json.load(open("result.json"))' 2>&1)"
fi
for solid in 4:0:24 5:-4:22 6:-8:20 7:2:13 8:-8:20 11:-4:22 12:-6:25 13:2:1 14:-4:22 15:2:5 16:2:5; do
    gives "solid ${solid%%:*}" "${solid#*:}" one/op_"${solid%%:*}".off
done
gives "as solid 12" "-6:25" box_0.off --difference box_1.off --difference box_2.off --union box_3.off
for solid in 9 10; do check "solid $solid is empty" "$(sed -n 2p one/op_$solid.off | grep -v '^0 0 0$')"; done

rm -r one && mkdir one
"$program" --request request.json --result result.json --merged --mend --format stl --last-only >stdout 2>stderr
check "last only" "$([ "$(cd one && echo *)" = "op_10.stl op_11.stl op_13.stl op_14.stl op_16.stl op_9.stl" ] || ls one)"
gives "solid 11 as .stl" "-4:22" one/op_11.stl
"$program" box_0.off --difference box_1.off --out drilled.stl >stdout && gives "another as .stl" "0:24" drilled.stl

# misread LINE PATTERN TEXT: a request of this text is refused in this line
misread() {
    printf "$3" >bad.json
    refuses "request '$3'" 2 "bad.json:$1: .*$2" --request bad.json --result out.off
}
misread 1 "neither a value" ''
misread 2 "a key needs a colon" '{\n"kind" "x"}'
misread 1 "key should stand" '{"a": 1,}'
misread 3 "neither , nor \]" '{"a": [1\n,\n2 3]}'
misread 1 "neither , nor }" '{"a": 1 "b": 2}'
misread 1 "string does not end" '"ab\ncd"'
misread 1 "unknown escape" '"\\x"'
misread 1 "hexadecimal" '"\\u12g4"'
misread 1 "neither a value" '[nul]'
misread 1 "neither a value" '[1e999]'
misread 2 "stands behind" '{}\n{}'
misread 1 "nested too deeply" "$(awk 'BEGIN { while (n++ < 100) printf "[" }')"
echo '{"kind": "other", "runs": []}' >other.json
refuses "another kind" 2 "other.json: is no request of kind" --request other.json --result out.off
refuses "no such request" 2 "none.json: cannot be read" --request none.json --result out.off
refuses "request alone" 2 "--request: needs the other" --request request.json
refuses "result alone" 2 "--result: needs the other" --result out.off
refuses "request and surface" 2 "--request: names all surfaces" --request request.json --result out.off box_0.off
refuses "request and file" 2 "--request: names all surfaces" --request request.json --result out.off --out out.off
refuses "last alone" 2 "--last-only: belongs to --request" box_0.off --last-only
refuses "format alone" 2 "--format: belongs to --request" box_0.off --format off
refuses "unknown format" 2 "--format: 'ply' is none of" --request request.json --result out.off --format ply

echo "$passed passed, $failed failed"
[ $failed -eq 0 ]
