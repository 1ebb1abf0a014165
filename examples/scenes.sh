#!/bin/sh
# Runs scenes and writes what they say as one page.
# usage: sh examples/scenes.sh PROGRAMS PAGE [SCENE_OPTION]... -- SCENE...
#     PROGRAMS  directory of the built scenes
#     PAGE      Markdown file to write; where gnuplot is, charts/locking.svg beside it. It shows pictures/SCENE.png.
#     CC, CFLAGS are named on the page
# Goes on where a scene is wrong; exits with 1 then.
set -u
programs=$1
page=$2
shift 2
options=
while [ $# -gt 0 ] && [ "$1" != -- ]; do options="$options $1"; shift; done
[ $# -gt 1 ] || { echo "usage: $0 PROGRAMS PAGE [SCENE_OPTION]... -- SCENE..." >&2; exit 2; }
shift
directory=$(dirname -- "$page")
mkdir -p "$directory" || exit 2
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
: >"$work/rows"
: >"$work/said"
failed=

for scene in "$@"; do
    csv=
    "$programs/$scene" --help | grep -q -- '--csv' && csv="--csv $work/csv"
    # shellcheck disable=SC2086
    "$programs/$scene" $options --table "$work/rows" $csv >"$work/one"
    code=$?
    cat "$work/one"
    { echo; echo "### $scene"; echo; sed -n '1s/^[^:]*: //p' "$work/one"; echo; echo '```'; sed -e 1d -e 's/^  //' "$work/one"
      if [ $code -ne 0 ]; then echo "ended with exit code $code"; fi
      echo '```'; } >>"$work/said"
    [ $code -eq 0 ] || failed="$failed $scene"
done

# chart FILE: share of beam theory's drop by the slice's thickness in elements, from lines
# SCENE,cut|conforming|affine,SLICE,THICKNESS,REFINEMENT,UNKNOWNS,SHARE with the thickness in elements of refinement 1
chart() {
    mkdir -p "$(dirname -- "$1")"
    { echo 'set terminal svg size 760,460 font "sans,12" background "white"'; echo "set output '$1'"
      echo 'set logscale x 2; set yrange [0:105]; set grid; set key below'
      echo 'set xlabel "thickness of the slice, elements"; set ylabel "drop of the end, % of beam theory"'
      awk -F, 'BEGIN { name["cut"] = "cut, linear elements"; name["affine"] = "cut, affine copies"
                       name["conforming"] = "slice meshed on its own, linear elements" }
               { key = $1 ": " name[$2]
                 if (!(key in rows)) order[++n] = key
                 rows[key] = rows[key] ($2 == "conforming" ? $5 : $4 * $5) " " 100 * $7 "\n" }
          END { for (i = 1; i <= n; i++) printf("$k%d << EOD\n%sEOD\n", i, rows[order[i]])
                printf("plot ")
                for (i = 1; i <= n; i++) printf("%s$k%d with points pointtype %d title \"%s\" noenhanced", i == 1 ? "" : ", ", i, 5 + i, order[i])
                print "" }'; } | gnuplot
}

# Pictures, three in a row
gallery() {
    echo "| | | |"
    echo "| --- | --- | --- |"
    count=0
    for scene in "$@"; do
        printf '| ![%s](pictures/%s.png) `%s`: %s ' "$scene" "$scene" "$scene" "$(awk -v name="### $scene" '
            $0 == name { found = 1; next } found && /[^ ]/ { print; exit }' "$work/said")"
        count=$((count + 1))
        [ $((count % 3)) -ne 0 ] || echo "|"
    done
    [ $((count % 3)) -eq 0 ] || echo "|"
}

{
    echo "# Scenes"
    echo
    echo "The scenes of the two papers, by their parameters where they give them, and two in which a blade cuts while the body moves"
    echo "(\`overhang\`, \`surgeon\`), two whose body is made of closed surfaces (\`organ\`, \`trainer\`), three that end in contact"
    echo "(\`pile\`, \`lips\`, \`sausage\`), and one whose ribbon is thinner than an element (\`ribbon\`); one file each in \`examples/\`."
    echo
    gallery "$@"
    echo
    echo "    make examples"
    echo "    build/helix_plate --out frames          # --help: all options; --small: seconds"
    echo "    build/octopus --mesh FILE               # octopus, bunny_groove, armadillo on a mesh of yours"
    echo "    build/octopus --shape FILE --cells N    # or of your closed surface, without a mesh"
    echo "    make scenes                             # all of them: this page (minutes)"
    echo "    make pictures                           # the pictures above (f3d)"
    echo
    echo "Each prints the numbers that show whether it is right, and ends with exit code 1 if one is not: where surfaces cut, no copy"
    echo "more than the least possible, which another program counts; volume and mass kept to 1e-12; a watertight surface; deflections"
    echo "equal to brute-force integration in the same space; and checks of its own. \`scene.h\` has what they share, for scenes of your"
    echo "own too: sheets that advance strip by strip, strokes of a blade, times, files, checks; \`slab.h\`: brute-force integration,"
    echo "locking; \`cheese.h\`: surfaces; \`touching.h\`: the ground, depths of pieces in each other."
    echo "\`gxcut.c\` and \`gxboolean.c\` are the command-line programs, \`gxio.h\` their readers and writers, \`gxshape.h\` their shapes,"
    echo "\`gxoverlap.h\` how deep pieces are in each other, \`gxfailure.h\` their words for a refusal,"
    echo "\`gxjson.h\` and \`gxrunner.h\` what a benchmark asks of \`gxboolean\`."
    echo
    echo "## Times"
    echo
    echo "Written by \`make scenes\`${options:+ with$options}. $(${CC:-cc} --version | head -n 1), ${CFLAGS:-}, $(uname -m), one thread. Times are of the"
    echo "machine that ran it: mean milliseconds, of cuts over the frames in which one happens, of the rest over all frames."
    echo
    echo "| scene | elements | unknowns before | after | cut triangles | arrangement | enrichment | integrals | model | linearise | prepare | solve | forces | skin | frame | worst frame | frames/s | peak MB | checks |"
    echo "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | --- |"
    cat "$work/rows"
    echo
    echo "A frame is the cut, the step and the skin. arrangement, enrichment, integrals: of the cut; model, linearise, prepare, solve,"
    echo "forces: of the step; skin: view, skin, positions and normals of its vertices; peak: the body's memory, by its allocator."
    if [ -s "$work/csv" ] && command -v gnuplot >/dev/null && chart "$directory/charts/locking.svg" <"$work/csv"; then
        echo
        echo "![how far slices bend, linear elements and affine copies, beside beam theory, by their thickness in elements](charts/locking.svg)"
        echo
        echo "Locking of linear elements: cut slices (the slab's own mesh, refined) and slices meshed on their own bend alike far too little"
        echo "while they are thin beside an element. Integration is not the cause: the checks below compare the same"
        echo "slices against integrals by brute force. With affine copies (\`gx_body_desc.affine_below\`) they bend in the slab's own mesh."
    fi
    echo
    echo "## What they say"
    cat "$work/said"
} >"$work/page"
mv "$work/page" "$page" || exit 2
echo "wrote $page"
[ -z "$failed" ] || { echo "wrong:$failed" >&2; exit 1; }
