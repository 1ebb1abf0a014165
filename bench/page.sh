#!/bin/sh
# Writes what benches have measured as a page with tables and charts, and the matrix of hard cases into the README.
# usage: sh bench/page.sh TABLES PAGE README
#     TABLES  directory of the benches' CSV files: failure.csv, table2.csv, table2_ratios.csv, scaling.csv; a missing one is an error
#     PAGE    the page; charts are in charts/ beside it
#     README  what stands between its lines `<!-- matrix -->` and `<!-- end of matrix -->` becomes the matrix
set -u
tables=$1
page=$2
readme=$3

for bench in failure table2 table2_ratios scaling; do
    [ -s "$tables/$bench.csv" ] || { echo "$0: $tables/$bench.csv is missing: make bench-${bench%_ratios}" >&2; exit 2; }
done
for line in '<!-- matrix -->' '<!-- end of matrix -->'; do
    [ "$(grep -cx -- "$line" "$readme")" = 1 ] || { echo "$0: $readme: no line \`$line\`, or several" >&2; exit 2; }
done

# Rows of `case,method,verdict` as a matrix; short: a word for each verdict, and the right ones counted
failure() {
    awk -F, -v short="$1" '
        function say(verdict) {
            if (!short) return verdict
            if (verdict == "right but for volume") return "volume"
            if (verdict ~ /^wrong: .*pieces$/) return "**pieces**"
            if (verdict ~ /^wrong/) return "**" (verdict ~ /falls/ ? "fall" : "mass") "**"
            if (verdict ~ /^(refused|diverged|crashed|busy)/) return "**" substr(verdict, 1, match(verdict, /[: ]/) - 1) "**"
            return verdict
        }
        NR == 1 { next }
        !($1 in seen) { seen[$1] = 1; cases[++n] = $1 }
        !($2 in known) { known[$2] = 1; methods[++m] = $2 }
        { said[$1, $2] = say($3); right[$2] += $3 == "right"; nearly[$2] += $3 == "right but for volume"; asked[$2]++ }
        END {
            printf("| case |"); for (j = 1; j <= m; j++) printf(" %s |", methods[j]); print ""
            printf("| --- |"); for (j = 1; j <= m; j++) printf(" --- |"); print ""
            for (i = 1; i <= n; i++) {
                printf("| %s |", cases[i]); for (j = 1; j <= m; j++) printf(" %s |", said[cases[i], methods[j]]); print ""
            }
            if (!short) exit
            printf("| right |"); for (j = 1; j <= m; j++) printf(" %d of %d |", right[methods[j]], asked[methods[j]]); print ""
            printf("| but for volume |"); for (j = 1; j <= m; j++) printf(" %d |", nearly[methods[j]]); print ""
        }' "$tables/failure.csv"
}

# A CSV file as a table, under the header given
table() {
    echo "$2"
    echo "$2" | sed 's/[^|][^|]*/ ---: /g; s/---:/---/'
    awk -F, 'NR > 1 { for (i = 1; i <= NF; i++) printf("| %s ", $i); print "|" }' "$tables/$1.csv"
}

matrix() {
    echo "<!-- matrix -->"
    echo "Written by \`make charts\`. volume: right but for what a cut's thickness takes away; pieces: too many or too few; mass: the right pieces"
    echo "with a wrong volume; fall: a piece falls otherwise than a point; empty: not asked. In full: [docs/BENCH.md](docs/BENCH.md)."
    echo
    failure 1
    echo "<!-- end of matrix -->"
}

scaling() {
    awk -F, '
        NR == 1 { print "| against | | elements | cuts | triangles of a cut | cut, us per touched element | per cell made and triangle | step, ms | unknowns | least | VNA | remeshed | MB |"
                  print "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"; next }
        { printf("| %s | %s | %s | %s | %s | %s | %.2f | %s | %s | %s | %s | %s | %s |\n", $1, $2, $3, $4, $5, $10, $8 / ($7 + $5), $12, $14, $15, $16, $17, $18) }' "$tables/scaling.csv"
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
    echo "dt: a frame; C: all frames with a cut, C+U: all frames. Rows (paper): published, Intel i9-13900K. The paper's sticks are six, ours 36."
    echo
    table table2 "| scene | method | frames | unknowns | subdomains | EI, ms | MB, ms | dpsi, ms | CG, s | dt max, s | dt avg, s | C, s | C+U, s | ended |"
    echo
    table table2_ratios "| scene | ratio to | theirs, s | ours, s | ratio | promised | |"
    echo
    echo "## Conditioning"
    echo
    echo "![condition number against the size of a slice and of a corner piece](charts/conditioning.svg)"
    echo
    echo "## Hard cases"
    echo
    echo "Right: as many pieces as the cuts leave, their volume, and a motion that stays finite and falls as a body falls (\`bench/hard.h\`). \"But for"
    echo "volume\": cuts of some thickness take material away; \"Algorithm 1 mended\": cuts 1e-10 thick instead of 1e-4, and a Boolean that mends. Virtual nodes find"
    echo "all pieces, with the mass of whole elements."
    echo
    failure ""
    echo
    echo "## Scaling"
    echo
    echo "![cost of a cut against elements, cuts and triangles; unknowns](charts/scaling.svg)"
    echo
    echo "Least: what separation demands, counted apart from the library (\`bench/least.h\`); VNA: virtual nodes; remeshed: a mesh whose elements end at"
    echo "the cuts, at least."
    echo
    scaling
} >"$page" || exit 2
matrix >"$readme.matrix" &&
    awk -v matrix="$readme.matrix" '
        $0 == "<!-- matrix -->" { while ((getline line <matrix) > 0) print line; skip = 1 }
        !skip { print }
        $0 == "<!-- end of matrix -->" { skip = 0 }' "$readme" >"$readme.new" &&
    mv "$readme.new" "$readme" || exit 2
rm -f "$readme.matrix"
echo "wrote $page and the matrix in $readme"
