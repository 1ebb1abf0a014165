#!/bin/sh
# Tests the program examples/gxcut.c from outside: exit codes, messages, files, figures.
# usage: sh tests/test_gxcut.sh PATH/TO/gxcut
source=$(cd "$(dirname -- "$0")/.." && pwd)
. "$(dirname -- "$0")/program.sh"

# refuses NAME CODE PATTERN ARGUMENTS...: the program must exit with CODE, print one line that matches PATTERN, and leave no file
refuses() {
    name=$1 code=$2 pattern=$3
    shift 3
    rm -rf out r.json
    "$program" "$@" >stdout 2>stderr
    got=$? why=
    [ $got -eq "$code" ] || why="exit $got, not $code"
    [ "$(wc -l <stderr)" -eq 1 ] || why="$why; stderr is not one line"
    grep -Eiq "^gxcut: .*($pattern)" stderr || why="$why; stderr says '$(head -n 1 stderr)'"
    [ ! -s stdout ] || why="$why; stdout is not empty"
    [ ! -e out ] && [ ! -e r.json ] && [ -z "$(find . -name '*.part')" ] || why="$why; files are left"
    check "$name" "$why"
}

# runs NAME ARGUMENTS...: the program must exit with 0 and print nothing on stderr
runs() {
    name=$1
    shift
    rm -rf out r.json
    "$program" "$@" >stdout 2>stderr
    got=$? why=
    [ $got -eq 0 ] || why="exit $got"
    [ ! -s stderr ] || why="$why; stderr says '$(head -n 1 stderr)'"
    check "$name" "$why"
}

# has NAME KEY VALUE: the number in the last report must be VALUE
has() {
    got=$(sed -n 's/^ *"'"$2"'": *\([^,]*\),*$/\1/p' r.json 2>/dev/null)
    if [ "$got" = "$3" ]; then check "$1: $2" ""; else check "$1: $2" "is '$got', not $3"; fi
}

# near NAME KEY VALUE: the same to 1e-12
near() {
    got=$(sed -n 's/^ *"'"$2"'": *\([^,]*\),*$/\1/p' r.json 2>/dev/null)
    check "$1: $2" "$(awk -v a="$got" -v b="$3" 'BEGIN { d = a - b; if (a == "" || d > 1e-12 || d < -1e-12) print "is \"" a "\", not " b }')"
}

# sums NAME KEY VALUE: the numbers of "KEY": [...] or {...} must add up to VALUE and ascend within each [...]
sums() {
    check "$1: sum of $2" "$(tr -d '\n ' <r.json | sed 's/.*"'"$2"'":\([[{]\)/\1/; s/,"[a-z_]*":.*//' | tr '{}' '\n\n' |
        sed 's/"[0-9]*":/\n/g' | tr -d '[]' | awk -F, -v want="$3" '
            { for (i = 1; i <= NF; i++) { sum += $i; if (i > 1 && $i != "" && $i + 0 < $(i - 1) + 0) bad = 1 } }
            END { d = sum - want; if (bad) print "do not ascend"; else if (d > 1e-12 || d < -1e-12) print "is " sum ", not " want }')"
}

# mesh FILE X ELEMENTS...: a Medit mesh of five nodes; X: the first coordinate (line 6); an element: four indices and a
# reference (the first on line 15)
mesh() {
    name=$1 x=$2
    shift 2
    { printf 'MeshVersionFormatted 2\n# a comment\nDimension\n3\nVertices 5\n%s 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 -1 0\n' "$x"
      printf 'Edges\n1 1 2 0\nTetrahedra\n%s\n' $#
      for element in "$@"; do echo "$element"; done
      echo End; } >"$name"
}

# of_blade NAME KEY CONDITION: the number v in the object "blade" of the last report must be such that CONDITION holds
of_blade() {
    got=$(sed -n 's/^ *"blade": {.*"'"$2"'": \([^,}]*\)[,}].*/\1/p' r.json 2>/dev/null)
    check "$1: $2" "$(awk -v v="$got" 'BEGIN { v += 0; if (!('"$3"')) print "is " v ", not '"$3"'" }')"
}

# pass FILE FRAMES FROM TO: a horizontal edge of two points at z = 2.1 goes through a grid of 4 cubes a side along x
pass() {
    awk -v n="$2" -v from="$3" -v to="$4" 'BEGIN { for (i = 0; i < n; i++) {
        x = from + (to - from) * i / (n - 1); print x, -1, 2.1, x, 5, 2.1 } }' >"$1"
}

# page_lines: what the lines of page.html hold: "mesh VERTICES TRIANGLES FRAGMENTS CUT_TRIANGLES" or
# "frame VERTICES SECONDS_POSITIVE"; a line of any other length than its counts make it is "bad"
page_lines() {
    LC_ALL=C awk '
        function digit(c) { return index("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/", c) - 1 }
        function byte(i,   at, a, b) {
            at = int(i / 3) * 4 + i % 3 + 1
            a = digit(substr($2, at, 1)); b = digit(substr($2, at + 1, 1))
            return i % 3 == 0 ? a * 4 + int(b / 16) : i % 3 == 1 ? a % 16 * 16 + int(b / 4) : a % 4 * 64 + b
        }
        function word(i) { return byte(4 * i) + 256 * (byte(4 * i + 1) + 256 * (byte(4 * i + 2) + 256 * byte(4 * i + 3))) }
        /^(mesh|frame) / { padding = gsub(/=/, "="); size = length($2) / 4 * 3 - padding }
        /^mesh / {
            vertices = word(0); n = word(1); fragments = cuts = bad = 0
            split("", seen)
            if (size != 8 + 20 * n) bad = 1
            for (i = 0; i < 3 * n && !bad; i++) if (word(2 + i) >= vertices) bad = 1
            for (i = 0; i < n && !bad; i++) {
                if (!seen[word(2 + 3 * n + i)]++) fragments++
                if (word(2 + 4 * n + i)) cuts++
            }
            print bad ? "bad" : $1 " " vertices " " n " " fragments " " cuts
        }
        /^frame / { print size != 28 + 8 * vertices ? "bad" : $1 " " vertices " " (word(0) > 0 && word(0) < 2139095040) }' page.html
}

# ---- usage
refuses "no mesh" 2 "usage"
refuses "unknown option" 2 "frobnicate: unknown option" cube5 --frobnicate
refuses "value missing" 2 "--dt: needs a value" cube5 --dt
refuses "option twice" 2 "--dt: is given twice" cube5 --dt 1 --dt 1
refuses "two meshes" 2 "second mesh" cube5 cube5
refuses "NaN option" 2 "--young: 'nan' is not a finite number" cube5 --young nan
refuses "infinite option" 2 "--dt: '1e999' is not a finite number" cube5 --dt 1e999
refuses "trailing text" 2 "--dt: '1s' is not a finite number" cube5 --dt 1s
refuses "time step 0" 2 "--dt: must be above 0" cube5 --dt 0
refuses "poisson 0.5" 2 "--poisson" cube5 --poisson 0.5
refuses "affine -1" 2 "affine_below" cube5 --affine -1
refuses "thickness 0" 2 "--thickness" cube5 --thickness 0
refuses "frames -1" 2 "--frames" cube5 --frames -1
refuses "gravity of two" 2 "--gravity" cube5 --gravity 0,1
refuses "no such axis" 2 "--fix" cube5 --fix 'w<1'
refuses "nothing to hold" 2 "--fix: regions 1: .*region" cube5 --fix 'z<0.1' --fix 'z>1'
refuses "box of five" 2 "--fix: 'box:0,0,0,1,1' is not" cube5 --fix box:0,0,0,1,1
refuses "box turned over to hold" 2 "--fix: regions.high 0" cube5 --fix box:0,0,0,-1,1,1
refuses "sphere without radius" 2 "--fix: 'sphere:0,0,0' is not" cube5 --fix sphere:0,0,0
refuses "sphere that holds nothing" 2 "--fix: regions 0: .*region" cube5 --fix sphere:0.5,0.5,0.5,0.1
refuses "no such format" 2 "--format" cube5 --format stl
refuses "frames of a balance" 2 "--frames: does not go with --static" cube5 --static --frames 3
refuses "blade in a balance" 2 "--blade: does not go with --static" cube5 --static --blade k.blade
refuses "balance of a free body" 1 "frame 0: .*" cube5 --static
refuses "balance not reached" 1 "--static: no balance after 1 iterations: a residual of" cube5 --fix 'x<0.1' --young 2e4 --newton 1 --static
refuses "cut after the end" 2 "--cut-at" cube5 --frames 3 --cut-at 3
refuses "grid of 7" 2 "grid:1,1,1,7" grid:1,1,1,7
refuses "grid of 0" 2 "grid:0,1,1" grid:0,1,1
refuses "plane without normal" 2 "plane:0,0,0,0,0,0" cube5 --sheet plane:0,0,0,0,0,0
refuses "box turned over" 2 "box:1,0,0,0,1,1" cube5 --solid box:1,0,0,0,1,1
refuses "wave of length 0" 2 "wave:" cube5 --sheet wave:0,0,0,0,0,1,0.1,0
refuses "unknown cut" 2 "cut.ply: is no cut" cube5 --sheet cut.ply
"$program" --help >stdout 2>stderr
[ $? -eq 0 ] && grep -q "^usage: gxcut" stdout && [ ! -s stderr ]
check "help" "$([ $? -eq 0 ] || echo 'exit code or output')"

# ---- bad meshes
refuses "missing mesh" 2 "none.mesh: cannot be read" none.mesh
refuses "missing tetgen" 2 "none.node: cannot be read" none
mesh a.mesh 0 "1 2 3 4 0"
mesh a.mesh nan "1 2 3 4 0"
refuses "NaN coordinate" 2 "a.mesh:6: 'nan' is not a finite number" a.mesh
mesh a.mesh 1e400 "1 2 3 4 0"
refuses "infinite coordinate" 2 "a.mesh:6: '1e400' is not a finite number" a.mesh
mesh a.mesh 0 "1 2 3 4 0" "1 2 3 6 0"
refuses "index too large" 2 "a.mesh:16: node index 6 is out of range" a.mesh
mesh a.mesh 0 "0 2 3 4 0" "1 2 3 4 0"
refuses "index 0" 2 "a.mesh:15: node index 0 is out of range" a.mesh
mesh a.mesh 0 "1 2 3 -4 0"
refuses "index negative" 2 "a.mesh:15: '-4' is an index out of range" a.mesh
mesh a.mesh 0 "1 2 3 4 0" "1 2 3 5 0"
refuses "inverted element" 2 "a.mesh:16: element 1: .*(negative|inverted)" a.mesh --report r.json
mesh a.mesh 0 "1 2 3 4 0" "1 4 5 3 0"
refuses "flat element" 2 "a.mesh:16: element 1: .*(no volume|flat)" a.mesh --report r.json
mesh a.mesh 0 "1 2 3 4 0" "1 2 3 4 0"
refuses "the same element twice" 2 "a.mesh:1[56]: element [01]: " a.mesh
mesh a.mesh 0
refuses "no elements" 2 "a.mesh: .*(no elements|empty)" a.mesh
: >a.mesh
refuses "empty file" 2 "a.mesh:1: the file ends" a.mesh
mesh a.mesh 0 "1 2 3 4 0" "1 3 2 5 0"
for lines in 3 7 10 11 13 14 15; do
    head -n $lines a.mesh >b.mesh
    refuses "mesh cut off after line $lines" 2 "b.mesh:$lines: .*(the file ends|cut off|has no)" b.mesh
done
printf 'MeshVersionFormatted 1\nDimension 2\nEnd\n' >b.mesh
refuses "plane mesh" 2 "b.mesh:2: '2' is the dimension" b.mesh
printf 'MeshVersionFormatted 1\nDimension 3\nVertices 4000000000\n0 0 0 0\n' >b.mesh
refuses "count beyond the file" 2 "b.mesh:3: '4000000000' is a larger count" b.mesh
printf 'hello\n' >b.mesh
refuses "no mesh at all" 2 "b.mesh:1: 'hello'" b.mesh
printf '4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n' >t.node
printf '1 4 0\n1 1 2 3 4\n' >t.ele
refuses "node file cut off" 2 "t.node:4: the file ends" t.node
printf '4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1\n4 0 0 1\n' >t.node
refuses "coordinate missing" 2 "t.node:4: a coordinate is missing" t
printf '4 3 0 0\n1 0 0 0\n2 1 0 0\n2 0 1 0\n4 0 0 1\n' >t.node
refuses "node number out of order" 2 "t.node:4: '2' is out of order" t

# ---- bad cuts
refuses "missing cut" 2 "none.obj: cannot be read" cube5 --sheet none.obj
printf 'v 0 0 0\nv 1 0 inf\n' >c.obj
refuses "infinite vertex" 2 "c.obj:2: 'inf' is not a finite number" cube5 --sheet c.obj
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n' >c.obj
refuses "vertex index too large" 2 "c.obj:4: vertex index 3 is out of range" cube5 --sheet c.obj
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -4\n' >c.obj
refuses "vertex index before the first" 2 "c.obj:4: '-4' is an index out of range" cube5 --sheet c.obj
printf 'v 0 0 0\nv 1 0 0\nf 1 2\n' >c.obj
refuses "face of two corners" 2 "c.obj:3: the face has fewer than three" cube5 --sheet c.obj
printf 'OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n' >c.off
refuses "off cut off" 2 "c.off:5: the file ends" cube5 --sheet c.off
printf 'OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n' >c.off
refuses "off index" 2 "c.off:6: vertex index 3 is out of range" cube5 --sheet c.off
printf 'v 0.5 -1 -1\nv 0.5 3 -1\nv 0.5 -1 3\nf 1 2 3\n' >c.obj
refuses "open surface as solid" 1 "c.obj.*closed" cube5 --solid c.obj --report r.json
refuses "open surface as solid, second cut" 1 "cut 1.*closed" cube5 --solid box:0.1,0.1,0.1,0.2,0.2,0.2 --solid plane:0.5,0.5,0.5,1,0,0

# ---- bad blades
refuses "missing blade" 2 "none.blade: cannot be read" cube5 --blade none.blade
printf '# knife\n0 -9 0 1 -9 0\n' >k.blade
refuses "blade without frames" 2 "--blade: needs frames" cube5 --blade k.blade --frames 0
refuses "tolerance without blade" 2 "--blade-tolerance: needs a --blade" cube5 --blade-tolerance 0.1
refuses "advance without blade" 2 "--blade-advance: needs a --blade" cube5 --blade-advance 0.1
refuses "inside without blade" 2 "--blade-inside: needs a --blade" cube5 --blade-inside
refuses "negative tolerance" 2 "--blade-tolerance: must be at least 0" cube5 --blade k.blade --blade-tolerance -1
refuses "negative advance" 2 "--blade-advance: must be at least 0" cube5 --blade k.blade --blade-advance -1
refuses "NaN advance" 2 "--blade-advance: 'nan' is not a finite number" cube5 --blade k.blade --blade-advance nan
printf '\n # a comment\n\n' >k.blade
refuses "blade without an edge" 2 "k.blade: has no edge" cube5 --blade k.blade
: >k.blade
refuses "empty blade" 2 "k.blade: has no edge" cube5 --blade k.blade
printf '0 -9 0 1 -9 0\n# next\n0 -9 0\n' >k.blade
refuses "edge of one point" 2 "k.blade:3: the edge has one point" cube5 --blade k.blade
printf '0 -9 0 1 -9 0\n\n0 -9 0 1 -9 0\n# next\n0 -9 0 1 -9 0 2 -9 0\n' >k.blade
refuses "another number of points" 2 "k.blade:5: the edge has 3 points, and 2 in line 3" cube5 --blade k.blade
printf '0 -9 0 1 -9 0\n0 -9 0 1 -9\n0 -9 0 1 -9 0\n' >k.blade
refuses "coordinate of an edge missing" 2 "k.blade:2: a coordinate is missing" cube5 --blade k.blade
printf '0 -9 0 1 -9 0\n0 -9 0 1 -9' >k.blade
refuses "blade cut off" 2 "k.blade:2: the file ends where a coordinate" cube5 --blade k.blade
printf '0 -9 0 1 -9 0\n0 -9 0 1 -9 O\n' >k.blade
refuses "letter for a coordinate" 2 "k.blade:2: 'O' is not a finite number" cube5 --blade k.blade
printf '0 -9 0 1 -9 0\ninf -9 0 1 -9 0\n' >k.blade
refuses "infinite coordinate of an edge" 2 "k.blade:2: 'inf' is not a finite number" cube5 --blade k.blade
printf '0 -9 0 1 -9 0\n\000' >k.blade
refuses "binary blade" 2 "k.blade: is binary" cube5 --blade k.blade
printf '# knife\n0.5 -1 0.5 0.5 0.5 0.5\n' >k.blade
refuses "blade starts inside" 1 "k.blade:2: point [01] of the edge: .*--blade-inside" cube5 --blade k.blade --report r.json
printf '0 -9 0 1 -9 1e300\n' >k.blade
refuses "edge too far out" 1 "k.blade:1: point 1 of the edge: .*large" cube5 --blade k.blade --report r.json
printf '\n\n0 -9 0 1 -9 1e300\n' >k.blade
rm -rf out
"$program" cube5 --blade k.blade --frames 4 >stdout 2>stderr
check "frames before an edge that fails" "$([ $? -eq 1 ] && grep -q 'k.blade:3: .*the 2 frames before it are in out' stderr &&
    [ "$(grep -c 'frame_000[01].vtu' out/frames.pvd)" -eq 2 ] || cat stderr)"
rm -rf out

# ---- output that cannot be written
: >file
refuses "directory is a file" 2 "file/frame_0000.vtu: cannot be written|file: cannot" cube5 --frames 1 --out file
refuses "page nowhere" 2 "nowhere/p.html: cannot be written" cube5 --frames 1 --format html --out nowhere/p.html
refuses "report nowhere" 2 "nowhere/r.json: cannot be written" cube5 --frames 0 --report nowhere/r.json

# ---- good runs
planes_x= planes_y=
for value in 0.16666666666666666 0.33333333333333331 0.5 0.66666666666666663 0.83333333333333337; do
    planes_x="$planes_x --sheet plane:$value,0.5,0.5,1,0,0"
    planes_y="$planes_y --sheet plane:0.5,$value,0.5,0,1,0"
done
runs "5 parallel cuts" cube5 $planes_x --frames 0 --report r.json
has "5 parallel cuts" elements 5
has "5 parallel cuts" nodes 8
has "5 parallel cuts" copies 48
has "5 parallel cuts" dofs 144
has "5 parallel cuts" fragments 6
near "5 parallel cuts" volume 1
near "5 parallel cuts" mass 1000
sums "5 parallel cuts" cell_volumes 1
sums "5 parallel cuts" fragment_volumes 1
has "5 parallel cuts" frames 0
check "frames 0 writes none" "$([ ! -e out ] || echo 'out is there')"
hash=$(grep topology_hash r.json)
runs "5 parallel cuts again" cube5 $planes_x --frames 0 --report r.json --quiet
check "same hash" "$([ "$hash" = "$(grep topology_hash r.json)" ] || echo 'differs')"
check "quiet" "$([ ! -s stdout ] || echo 'stdout is not empty')"
runs "5 + 5 crossing cuts" cube5 $planes_x $planes_y --frames 0 --report r.json
has "5 + 5 crossing cuts" fragments 36
near "5 + 5 crossing cuts" volume 1
sums "5 + 5 crossing cuts" cell_volumes 1
sums "5 + 5 crossing cuts" fragment_volumes 1
runs "uncut" grid:2,2,2,6 --frames 0 --report r.json
has "uncut" cells 48
has "uncut" copies 27
has "uncut" fragments 1
near "uncut" volume 8
has "uncut" min_link_ratio 1
runs "box out of a grid" grid:2,2,2 --solid box:0.5,0.5,0.5,1.5,1.5,1.5 --frames 0 --report r.json
near "box out of a grid" volume 7
has "box out of a grid" fragments 1
runs "box as a shape" --shape box:0.5,0.5,0.5,1.5,1,1.25 --cells 5 --sheet plane:1,0.75,0.9,1,0.2,0.1 --frames 2 --report r.json
near "box as a shape" volume 0.375
has "box as a shape" fragments 2
refuses "shape and mesh" 2 "--shape" cube5 --shape box:0,0,0,1,1,1
refuses "shape that is open" 2 "plane:0.5,0.5,0.5,1,0,0: shape.surfaces.triangles .*closed" --shape plane:0.5,0.5,0.5,1,0,0
refuses "shape of no cells" 2 "--cells" --shape box:0,0,0,1,1,1 --cells 0
runs "inclusion" grid:2,2,2 --material box:0.5,0.5,0.5,1.5,1.5,1.75,5e6,0.3,2 --density 1 --frames 2 --report r.json
has "inclusion" fragments 1
near "inclusion" mass 9.25
check "inclusion: materials" "$(sed -n 's/^ *"materials": //p' r.json | tr -cs '0-9.' ' ' | awk '
    { for (i = 1; i <= 4; i++) { d = $i - (i == 1 || i == 2 ? 6.75 : i == 3 ? 1.25 : 2.5); if (d > 1e-12 || d < -1e-12) print "is " $0 } }
    END { if (NR != 1) print "are not there" }')"
runs "inclusion comes off" grid:2,2,2 --material box:0.5,0.5,0.5,1.5,1.5,1.75,5e6,0.3,2 --density 1 --release --frames 2 --report r.json
has "inclusion comes off" fragments 2
near "inclusion comes off" mass 9.25
runs "one inclusion in another, in a shape" --shape box:0,0,0,2,2,2 --cells 4 --material box:0.5,0.5,0.5,1.5,1.5,1.75,5e6,0.3,2 --density 1 \
    --material box:0.75,0.75,0.75,1.25,1.25,2.5,5e6,0.3,0.5 --release --frames 0 --report r.json
near "one inclusion in another, in a shape" mass 8.84375
refuses "open inclusion" 2 "plane:0.5,0.5,0.5,1,0,0: surfaces.triangles .*closed" cube5 --material plane:0.5,0.5,0.5,1,0,0,1e6,0.4,1000
refuses "inclusion without numbers" 2 "--material.*CUT,E,NU,RHO" cube5 --material box:0,0,0,1,1,x
refuses "inclusion that cannot be pressed" 2 "--material.*ratio" cube5 --material box:0,0,0,1,1,1,1e6,0.5,1000
refuses "release of nothing" 2 "--release: needs a --material" cube5 --release
runs "box kept of a grid" grid:2,2,2 --keep box:0.5,0.5,0.5,1.5,1.5,1.5 --frames 0 --report r.json
near "box kept of a grid" volume 1
has "box kept of a grid" fragments 1
runs "thick sheet" cube5 --sheet plane:0.5,0.5,0.5,1,0,0 --thickness 0.25 --frames 0 --report r.json
near "thick sheet" volume 0.75
has "thick sheet" fragments 2
runs "oblique plane and wave" grid:3,3,3,6 --sheet plane:1.5,1.5,1.5,1,2,3 --sheet wave:1.5,1.5,1.5,1,0,0,0.2,1.5 --frames 0 --report r.json
near "oblique plane and wave" volume 27
has "oblique plane and wave" fragments 4
printf '# quad\nv 0.5 -1 -1\nvt 0 0\nv 0.5 2 -1\nv 0.5 2 2\nv 0.5 -1 2\nvn 1 0 0\nf -4/1/1 -3//1 -2/1 -1\n' >c.obj
runs "obj quad" cube5 --sheet c.obj --frames 0 --report r.json
has "obj quad" fragments 2
printf 'OFF 4 1 0\n0.5 -1 -1\n0.5 2 -1\n0.5 2 2 # corner\n0.5 -1 2\n4 0 1 2 3 255 0 0\n' >c.off
runs "off quad" cube5 --sheet c.off --frames 0 --report r.json
has "off quad" fragments 2
printf '# nodes\n4 3 1 1\n0 0 0 0 7.5 1\n1 1 0 0 7.5 1\n2 0 1 0 7.5 1\n3 0 0 1 7.5 1\n# end\n' >t.node
printf '1 4 1\n0 0 1 2 3 9\n' >t.ele
runs "tetgen from 0" t.ele --frames 0 --report r.json
near "tetgen from 0" volume 0.16666666666666666
printf '4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n' >t.node
printf '1 4 0\n1 1 2 3 4\n' >t.ele
runs "tetgen from 1" t --frames 0 --report r.json
near "tetgen from 1" volume 0.16666666666666666
mesh a.mesh 0 "1 2 4 3 0" "1 3 5 2 0"
runs "file of the other orientation" a.mesh --frames 0 --report r.json
near "file of the other orientation" volume 0.33333333333333331
runs "frames" cube5 --sheet plane:0.5,0.5,0.5,1,0,0 --cut-at 2 --frames 4 --fix 'z>0.9' --stretch 1.1,1,1 --report r.json
check "four frames and a collection" "$([ "$(find out -type f | wc -l)" -eq 5 ] && [ "$(grep -c 'frame_000[0-3].vtu' out/frames.pvd)" -eq 4 ] || echo 'other files')"
has "frames" frames 4
has "frames" fragments 2
check "summary" "$(grep -q 'frames.pvd' stdout && grep -q 'ms each' stdout || echo 'incomplete')"
slice="grid:8,2,1 --sheet plane:0,0,0.2,0,0,1 --fix x<0.001 --young 1e9 --poisson 0 --gravity 0,0,-1 --static --report r.json"
runs "balance of stiff slices" $slice
has "balance of stiff slices" affine_copies 0
has "balance of stiff slices" dofs 324
stiff=$(sed -n 's/^ *"tip": \([^,]*\),*$/\1/p' r.json)
runs "balance of slices that bend" $slice --affine 1
has "balance of slices that bend" affine_copies 108
has "balance of slices that bend" dofs 1296
bent=$(sed -n 's/^ *"tip": \([^,]*\),*$/\1/p' r.json)
# rho g L^4 / (8 E I / A) = 0.1536 m for the lower one
check "slices bend as beams" "$(awk -v a="$bent" -v b="$stiff" 'BEGIN { if (!(a > 0.95 * 0.1536 && a < 1.03 * 0.1536 && b < 0.1 * a)) print "by " a ", stiff by " b }')"
runs "held in a box and a sphere" cube5 --sheet plane:0.5,0.5,0.5,1,0,0 --frames 2 --fix box:-1,-1,0.9,0.1,2,2 --fix sphere:1,1,1,0.5
runs "obj frames" cube5 $planes_x --frames 2 --format obj --out here
check "groups" "$([ "$(grep -c '^g ' here/frame_0001.obj)" -eq 6 ] && [ ! -e here/frames.pvd ] || echo 'other groups or files')"

# ---- a page
runs "page" cube5 $planes_x $planes_y --cut-at 2 --frames 4 --fix 'z<0.001' --stretch 1.5,1.5,1.5 --format html --out page.html
check "one file" "$([ -s page.html ] && [ ! -e out ] && [ -z "$(find . -name '*.part')" ] || echo 'none or others')"
check "page in the summary" "$(grep -q 'page.html; open it in a browser' stdout || echo 'missing')"
page_lines >lines
check "two meshes, two frames each" "$([ "$(cut -d ' ' -f 1 lines | tr '\n' ' ')" = "mesh frame frame mesh frame frame " ] || cat lines)"
check "12 triangles uncut, then 36 fragments with cut faces" "$(awk '/^mesh/ && ++n == 1 && ($3 != 12 || $4 != 1 || $5 != 0) ||
    /^mesh/ && n == 2 && ($4 != 36 || $5 < 120) || /^frame/ && $3 != 1 { print }' lines)"
awk -v folder="$source/examples/" 'function put(tag, file,    line) { print "<" tag ">"; while ((getline line <(folder file)) > 0) print line
        print "</" tag ">" }
    /^<link rel="stylesheet"/ { put("style", "player.css"); next }
    /^<script src=/ { put("script", "player.js"); next } { print }' "$source/examples/player.html" >player
grep -Ev '^(gxfem-frames|title|up|mesh|frame) ' page.html | cmp -s - player
check "the page is the player and its frames" "$([ $? -eq 0 ] || echo 'differs: is player.h older than what it is made from?')"
check "loads nothing" "$(grep -nE 'https?:|src=|href=|url\(|@import|import *\(|fetch *\(|XMLHttpRequest' page.html | cut -c 1-80)"
mesh 'a<"b.mesh' 0 "1 2 3 4 0"
runs "page of a name with <" 'a<"b.mesh' --frames 1 --format html --out page.html
check "title" "$(grep -qx 'title "a\\u003c\\u0022b.mesh"' page.html || grep '^title' page.html)"
printf 'v 0.5 -1 -1\nv 0.5 3 -1\nv 0.5 -1 3\nf 1 2 3\n' >c.obj
rm page.html
"$program" cube5 --solid c.obj --cut-at 2 --frames 4 --format html --out page.html >stdout 2>stderr
check "frames before a cut that fails" "$([ $? -eq 1 ] && [ "$(page_lines | grep -c '^frame')" -eq 2 ] &&
    [ "$(tail -n 1 page.html)" = '</html>' ] || echo 'are not in the page')"

# ---- contact
refuses "friction without contact" 2 "--friction: needs --contact" cube5 --friction 0.5
refuses "ground without contact" 2 "--ground: needs --contact" cube5 --ground 0
refuses "collider without contact" 2 "--collider: needs --contact" cube5 --collider sphere:0,0,0,1
refuses "negative friction" 2 "--friction: must be at least 0" cube5 --contact --friction -1
refuses "negative sleep" 2 "--sleep: must be at least 0" cube5 --sleep -1
refuses "unknown collider" 2 "--collider: 'ball:0,0,0,1' is not sphere" cube5 --contact --collider ball:0,0,0,1
refuses "collider without radius" 2 "--collider: 'sphere:0,0,0,0' is not sphere" cube5 --contact --collider sphere:0,0,0,0
refuses "flat box" 2 "--collider: 'box:0,0,0,1,0,1' is not sphere" cube5 --contact --collider box:0,0,0,1,0,1
refuses "short capsule" 2 "--collider: 'capsule:0,0,0,1,1,1' is not sphere" cube5 --contact --collider capsule:0,0,0,1,1,1

# in_contact NAME CONDITION: c (contacts), d (max_penetration) of the last report must be such that CONDITION holds
in_contact() {
    check "$1" "$(awk -F'[:,]' '/"contacts"/ { c = $2 } /"max_penetration"/ { d = $2 }
        END { if (!(c != "" && d != "" && ('"$2"'))) print "contacts " c ", penetration " d }' r.json)"
}
block="grid:2,2,2,6 --sheet plane:1,1,1.1,0.1,0.15,1 --dt 0.0166 --friction 0.4 --frames 40 --report r.json"
runs "block in two on the ground" $block --contact --ground 0 --sleep 0.1
in_contact "pieces rest on each other and on the ground" "c > 10 && d >= 0 && d < 0.05"
runs "block in two on a ball, a box and a capsule" $block --contact --collider sphere:1,1,-1,1 \
    --collider box:-1,-1,-2,0.5,0.5,-0.05 --collider capsule:1.6,0,-0.2,1.6,2,-0.2,0.2
in_contact "pieces rest on colliders" "c > 4 && d < 0.05"
runs "a capsule that is a ball" grid:1,1,1,6 --contact --collider capsule:0.5,0.5,-1,0.5,0.5,-1,0.99 --frames 9 --report r.json
in_contact "a block rests on it" "c > 0"

# ---- a blade
pass k.blade 41 -1 5
runs "pass through a swing" grid:4,4,4 --fix 'z>3.9' --stretch 1.1,1,1.2 --blade k.blade --frames 45 --report r.json
has "pass through a swing" fragments 2
near "pass through a swing" volume 64
sums "pass through a swing" fragment_volumes 64
of_blade "pass through a swing" moves "v == 41"
of_blade "pass through a swing" layers "v >= 1"
of_blade "pass through a swing" triangles "v > 0"
of_blade "pass through a swing" deviation "v > 0 && v < 0.1"
of_blade "pass through a swing" divided_elements "v >= 80 && v <= 320"
of_blade "pass through a swing" us_per_divided_element "v > 0"
check "blade in the summary" "$(grep -q '^blade .*41 moves' stdout && grep -q 'elements divided' stdout || cat stdout)"
check "skin of the cut in frames" "$(cmp -s out/frame_0005.vtu out/frame_0044.vtu && echo 'first and last are the same')"
runs "the same without a swing" grid:4,4,4 --gravity 0,0,0 --blade k.blade --frames 45 --report r.json --format html --out page.html
has "the same without a swing" fragments 2
page_lines >lines
check "a mesh in the page for each cut, with more and more faces" "$(awk '/^mesh/ { n++; if ($5 < faces) print; faces = $5 }
    END { if (n < 5 || !faces) print n " meshes" }' lines)"
check "two fragments in the page's last mesh" "$(awk '/^mesh/ { last = $4 } END { if (last != 2) print last }' lines)"
runs "later" grid:4,4,4 --gravity 0,0,0 --blade k.blade --cut-at 10 --frames 51 --report r.json
has "later" fragments 2
of_blade "later" moves "v == 41"
runs "the run ends first" grid:4,4,4 --gravity 0,0,0 --blade k.blade --frames 20 --report r.json
has "the run ends first" fragments 1
of_blade "the run ends first" moves "v == 20"
of_blade "the run ends first" divided_elements "v > 0"
runs "sheet and blade" grid:4,4,4 --gravity 0,0,0 --sheet plane:2.1,2,2,1,0,0 --cut-at 3 --blade k.blade --frames 50 --report r.json
has "sheet and blade" fragments 4
pass k.blade 2 -1 5
runs "in one move" grid:4,4,4 --gravity 0,0,0 --blade k.blade --frames 2 --report r.json
has "in one move" fragments 2
pass k.blade 3 -1 5
echo >>k.blade
awk 'BEGIN { for (i = 0; i < 8; i++) print 2.1, i - 1, -1, 2.1, i - 1, 2, 2.1, i - 1, 5, "# pass", i, "\n# between" }' >>k.blade
runs "lifted between two passes" grid:4,4,4 --gravity 0,0,0 --blade k.blade --frames 20 --report r.json
has "lifted between two passes" fragments 4
of_blade "lifted between two passes" moves "v == 11"
pass k.blade 21 2 4.01
runs "from inside out" grid:4,4,4 --gravity 0,0,0 --blade k.blade --blade-inside --frames 22 --report r.json
has "from inside out" fragments 1
of_blade "from inside out" divided_elements "v > 0"
pass k.blade 41 -1 5
runs "coarse" grid:4,4,4 --fix 'z>3.9' --stretch 1.1,1,1.2 --blade k.blade --blade-tolerance 0.5 --blade-advance 2 --frames 45 --report r.json
has "coarse" fragments 2
of_blade "coarse" triangles "v > 0 && v < 60"

# The slice of a tenth of an element hangs by one end.
low() { awk '/^v / && $4 < low { low = $4 } END { print low + 0 }' out/frame_0019.obj; }
slice="grid:8,2,2 --sheet plane:4,1,0.9,0,0,1 --sheet plane:4,1,1,0,0,1 --fix x<0.01 --frames 20 --young 1e9 --newton 3 --format obj"
# shellcheck disable=SC2086
runs "a stiff slice" $slice
stiff=$(low)
# shellcheck disable=SC2086
runs "a slice that bends" $slice --affine 1
check "how far it bends" "$(awk -v a="$(low)" -v b="$stiff" 'BEGIN { if (!(a < 10 * b && b < 0)) print a ", " b }')"

echo "$passed passed, $failed failed"
[ $failed -eq 0 ]
