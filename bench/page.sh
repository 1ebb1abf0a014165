#!/bin/sh
# Writes what benches have measured as a page with tables and charts.
# usage: sh bench/page.sh TABLES PAGE
#     TABLES  directory of the benches' CSV files: failure.csv, table2.csv; a missing one is an error
#     PAGE    the page; charts are in charts/ beside it
set -u
tables=$1
page=$2

for bench in failure table2; do
    [ -s "$tables/$bench.csv" ] || { echo "$0: $tables/$bench.csv is missing: make bench-$bench" >&2; exit 2; }
done

# Rows of `case,method,verdict` as a matrix
failure() {
    awk -F, '
        NR == 1 { next }
        !($1 in seen) { seen[$1] = 1; cases[++n] = $1 }
        !($2 in known) { known[$2] = 1; methods[++m] = $2 }
        { said[$1, $2] = $3 }
        END {
            printf("| case |"); for (j = 1; j <= m; j++) printf(" %s |", methods[j]); print ""
            printf("| --- |"); for (j = 1; j <= m; j++) printf(" --- |"); print ""
            for (i = 1; i <= n; i++) {
                printf("| %s |", cases[i]); for (j = 1; j <= m; j++) printf(" %s |", said[cases[i], methods[j]]); print ""
            }
        }' "$tables/failure.csv"
}

table2() {
    awk -F, '
        NR == 1 { print "| scene | method | frames | unknowns | EI, ms | MB, ms | dpsi, ms | CG, s | dt max, s | dt avg, s | C, s | C+U, s | |"
                  print "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | --- |"; next }
        { for (i = 1; i <= 13; i++) printf("| %s ", $i); print "|" }' "$tables/table2.csv"
}

{
    echo "# Accuracy against speed, and where methods fail"
    echo
    echo "Written by \`make charts\` on $(date +%Y-%m-%d), $(uname -m | tr _ -), one thread. What each program does and how it judges stands in its first"
    echo "lines: \`bench/quadrature.c\`, \`stepping.c\`, \`space.c\`, \`table2.c\`, \`conditioning.c\`, \`failure.c\`, \`scaling.c\`. The baselines are written for"
    echo "the bench: \`rxfem.h\` (Koschier, Bender, Thuerey 2017), \`vna.h\` (element duplication), \`literal.h\` (GXFEM's Algorithm 1 as published,"
    echo "a Boolean for each subdomain), \`sampling.h\`, \`parts.h\` (integrals by points, element deletion). All take the library's time step: only what is compared differs."
    echo
    echo "## Integrals over parts of cut elements"
    echo
    echo "![error against the time to make a rule and to use it](charts/quadrature.svg)"
    echo "![a curved cut by its number of triangles](charts/quadrature_triangles.svg)"
    echo
    echo "## Motion"
    echo
    echo "![error of the motion against computing time](charts/stepping.svg)"
    echo "![what integrals by points and the thickness of cuts change of the motion](charts/stepping_cuts.svg)"
    echo
    echo "The error of the space is another matter: linear elements bend too little where a piece is thin beside them, cut or not."
    echo
    echo "![drops of slices and folds under refinement](charts/space.svg)"
    echo
    echo "## Scenes of GXFEM's Table 2"
    echo
    echo "EI: integrals, MB: finding the pieces, both per subdomain that a cut made look at; dpsi: Hessians, CG: linear solve, per step;"
    echo "dt: a frame; C: all frames with a cut, C+U: all frames. Rows (paper): published, Intel i9-13900K."
    echo
    table2
    echo
    echo "## Conditioning"
    echo
    echo "![condition number against the size of a slice and of a corner piece](charts/conditioning.svg)"
    echo
    echo "## Hard cases"
    echo
    echo "Right: as many pieces as the cuts leave, their volume, and a motion that stays finite. \"But for volume\": solids of some thickness take"
    echo "material away."
    echo
    failure
    echo
    echo "## Scaling"
    echo
    echo "![cost of a cut against elements, cuts and triangles; unknowns](charts/scaling.svg)"
} >"$page"
echo "wrote $page"
