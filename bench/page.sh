#!/bin/sh
# Writes what benches have measured as a page with tables and charts, and two parts of the README.
# usage: sh bench/page.sh TABLES PAGE README
#        sh bench/page.sh TABLES PAGE blade     writes the sections of blades anew, or makes them; needs their tables alone
#        sh bench/page.sh TABLES PAGE shapes    the same of shapes; web: of browsers; intrinsics: of these
#     TABLES  directory of the benches' CSV files; a missing one is an error
#     PAGE    the page; charts are in charts/ beside it
#     README  what stands between its lines `<!-- NAME -->` and `<!-- end of NAME -->` is written anew: why, speed
set -u
tables=$1
page=$2
readme=$3

wanted="quadrature stepping front conditioning failure table2 table2_ratios scaling kernel open smallest solver product violent accuracy drift frames skin web intrinsics blade strokes thin shapes"
parts=blade,shapes,web,intrinsics # that are written alone
case $readme in
blade) wanted="blade strokes" ;;
shapes|web|intrinsics) wanted=$readme ;;
esac
for bench in $wanted; do
    [ -s "$tables/$bench.csv" ] || { echo "$0: $tables/$bench.csv is missing: make bench-$(echo $bench | sed 's/_ratios//; s/product/solver/')" >&2; exit 2; }
done
for name in why speed; do
    case ,$parts, in *",$readme,"*) break ;; esac
    for line in "<!-- $name -->" "<!-- end of $name -->"; do
        [ "$(grep -cx -- "$line" "$readme")" = 1 ] || { echo "$0: $readme: no line \`$line\`, or several" >&2; exit 2; }
    done
done

# Rows of `case,method,verdict` as a matrix; the right ones counted
failure() {
    awk -F, '
        NR == 1 { next }
        !($1 in seen) { seen[$1] = 1; cases[++n] = $1 }
        !($2 in known) { known[$2] = 1; methods[++m] = $2 }
        { said[$1, $2] = $3; right[$2] += $3 == "right"; nearly[$2] += $3 == "right but for volume"; asked[$2]++ }
        END {
            printf("| case |"); for (j = 1; j <= m; j++) printf(" %s |", methods[j]); print ""
            printf("| --- |"); for (j = 1; j <= m; j++) printf(" --- |"); print ""
            for (i = 1; i <= n; i++) {
                printf("| %s |", cases[i]); for (j = 1; j <= m; j++) printf(" %s |", said[cases[i], methods[j]]); print ""
            }
            printf("| **right** |"); for (j = 1; j <= m; j++) printf(" %d of %d |", right[methods[j]], asked[methods[j]]); print ""
            printf("| **but for volume** |"); for (j = 1; j <= m; j++) printf(" %d |", nearly[methods[j]]); print ""
        }' "$tables/failure.csv"
}

# When the oldest table was made
measured() {
    for table in "$tables"/*.csv; do date -r "$table" +%Y-%m-%d; done | sort | head -n 1
}

# open.csv: a row for each workload, milliseconds of each runner, and how many times ours. What is wrong is said.
open_table() {
    awk -F, '
        NR == 1 { next }
        !($1 in input) { input[$1] = $4; count[$1] = $3; volume[$1] = $12; rows[++n] = $1 }
        !($2 in known) { known[$2] = 1; runners[++m] = $2 }
        { status[$1, $2] = $5; ms[$1, $2] = $7; triangles[$1, $2] = $9; got[$1, $2] = $11 }
        function say(row, runner,    off) {
            if (!((row, runner) in status)) return "-"
            if (status[row, runner] != "success") return status[row, runner]
            off = got[row, runner] - volume[row]
            text = sprintf("%.4g", ms[row, runner])
            if (runner != runners[1] && ms[row, runners[1]] > 0) text = text sprintf(", %.3g x", ms[row, runner] / ms[row, runners[1]])
            if (volume[row] == 0 && triangles[row, runner] > 0) return text "; leaves " triangles[row, runner] " triangles"
            if (off > 1e-3 * (volume[row] + 1) || -off > 1e-3 * (volume[row] + 1)) return text "; volume " got[row, runner]
            return text
        }
        END {
            printf("| workload | operations | triangles in | volume by rays |"); for (j = 1; j <= m; j++) printf(" %s, ms |", runners[j]); print ""
            printf("| --- | ---: | ---: | ---: |"); for (j = 1; j <= m; j++) printf(" ---: |"); print ""
            for (i = 1; i <= n; i++) {
                printf("| %s | %s | %s | %.6g |", rows[i], count[rows[i]], input[rows[i]], volume[rows[i]])
                for (j = 1; j <= m; j++) printf(" %s |", say(rows[i], runners[j])); print ""
            }
        }' "$tables/open.csv"
}

# A CSV file as a table, under the header given
table() {
    echo "$2"
    echo "$2" | sed 's/[^|][^|]*/ ---: /g; s/---:/---/'
    awk -F, 'NR > 1 { for (i = 1; i <= NF; i++) printf("| %s ", $i); print "|" }' "$tables/$1.csv"
}

# score METHOD: "right of asked" hard cases
score() { awk -F, -v method="$1" '$2 == method { right += $3 == "right"; asked++ } END { print right + 0 " of " asked }' "$tables/failure.csv"; }

# The largest error of our integrals, as a share of the element
integral_error() { awk -F, 'NR > 1 && $3 == "gxfem" && $9 > most { most = $9 } END { printf("%.0e", most) }' "$tables/quadrature.csv"; }

# item TEXT: an item of a list
item() { echo "- $*" | fold -s -w 117 | sed -e 's/ *$//' -e '2,$s/^/  /'; }

# What the README claims, a line of evidence each
why() {
    item "**Never refuses a cut.** Surfaces may be open, cross each other, run through nodes, miss each other by one rounding: right \
in $(score gxfem) [hard cases](docs/BENCH.md#hard-cases); the method RXFEM (2017) in $(score RXFEM)."
    item "**Never remeshes.** Where material separates, nodes get further displacements, never more than the least possible, \
which another program counts [from 1k to 1M elements, up to 1000 cuts](docs/BENCH.md#scaling)."
    item "**Exact.** Signs of polynomials decide which fragments there are. Nothing is snapped or perturbed. Integrals over cut \
elements [are off by $(integral_error) of an element at most](docs/BENCH.md#integrals-over-parts-of-cut-elements)."
    item "**Deterministic.** The same fragments from gcc and clang, 64 and 32 bits, \`-ffast-math\`, x87 and WebAssembly; the same \
bits for any number of threads. Tests compare hashes."
    item "**No dependency.** Four headers, C99 or C++11, and the C library. No threads, globals or output of their own."
}

# Frames of the regular blocks, by their number of elements
speed() {
    echo "| elements | unknowns | frame, ms | a cut, ms | frame with a cut, ms | the slowest, ms |"
    echo "| ---: | ---: | ---: | ---: | ---: | ---: |"
    awk -F, '$1 ~ /^lattice/ { printf("| %s | %s | %s | %s | %s | %s |\n", $2, $3, $4, $5, $6, $7) }' "$tables/frames.csv"
}

# range BENCH COLUMN CONDITION: least and greatest number of a column where an awk condition holds
range() {
    awk -F, "NR > 1 && ($3) { x = \$$2; if (low == \"\" || x < low) low = x; if (x > high) high = x } END { printf(\"%.1f to %.1f\", low, high) }" \
        "$tables/$1.csv"
}

# stalls SCENE SERIES: error of the motion with the smallest step
stalls() { awk -F, -v scene="$1" -v series="$2" '$1 == scene && $2 == series && $8 != "" { last = $8 } END { printf("%.2f", last) }' "$tables/stepping.csv"; }

# corner SCALING EXTENSION: condition number beside a corner piece of 1e-12
corner() { awk -F, -v scaling="$1" -v on="$2" '$1 == "corner" && $2 == "1e-12" && $3 == "copies" && $4 == scaling && $5 == on { printf("%.2g", $6) }' "$tables/conditioning.csv"; }

# Some cases of the solver's: iterations / milliseconds; memory and the time of a product by element
steps() {
    echo "| scene | unknowns | block-Jacobi | multigrid | the same, two threads | multigrid, assembled | CHOLMOD | product, ns per element: single / double | bytes per element | assembled |"
    echo "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"
    for row in "uncut-lattice-23k-1e6|uncut" "accordion-lattice-23k-1e6|accordion: cuts from both sides, 2.5 cells apart" \
        "accordion-lattice-23k-1e8|the same, E = 1e8" "loose-lattice-23k-1e6|loose: fragments, most of them falling" \
        "uncut-lattice-150k-1e6|uncut" "accordion-lattice-150k-1e6|accordion"; do
        awk -F, -v name="${row%|*}" -v text="${row#*|}" '
            $1 != name { next }
            FILENAME ~ /product/ { elements = $3; product[$2] = $4; next }
            { unknowns = $3; found[$2] = sprintf("%.1f / %.1f", $4, $7); ms[$2] = sprintf("%.1f", $2 == "cholmod" ? $6 : $7); bytes[$2] = $8 }
            END {
                if (unknowns)
                    printf("| %s | %d | %s | %s | %s | %s | %s | %.1f / %.1f | %.0f | %.0f |\n", text, unknowns, found["jacobi-free"], found["multigrid-free"],
                           ms["multigrid-free-2"], found["multigrid-assembled"], ms["cholmod"], product["single"], product["double"],
                           bytes["multigrid-free"] / elements, bytes["multigrid-assembled"] / elements)
            }' "$tables/product.csv" "$tables/solver.csv"
    done
}

# Ratios to Table 2, a column for each scene
ratios() {
    awk -F, '
        NR == 1 { next }
        !($1 in scenes) { scenes[$1] = 1; names[++n] = $1 }
        !($2 in known) { known[$2] = 1; of[++m] = $2 }
        { said[$2, $1] = $5 ($7 == "not met" ? " (not met)" : ""); promised[$2] = $6 }
        END {
            printf("| how many times as long |"); for (j = 1; j <= n; j++) printf(" %s |", names[j]); print " aim |"
            printf("| --- |"); for (j = 0; j <= n; j++) printf(" ---: |"); print ""
            for (i = 1; i <= m; i++) {
                printf("| %s |", of[i]); for (j = 1; j <= n; j++) printf(" %s |", said[of[i], names[j]]); printf(" %s |\n", promised[of[i]])
            }
        }' "$tables/table2_ratios.csv"
}

# fill NAME: the README's part of that name
fill() {
    { echo "<!-- $1 -->"; $1; echo "<!-- end of $1 -->"; } >"$readme.part" &&
        awk -v name="$1" -v part="$readme.part" '
            $0 == "<!-- " name " -->" { while ((getline line <part) > 0) print line; skip = 1 }
            !skip { print }
            $0 == "<!-- end of " name " -->" { skip = 0 }' "$readme" >"$readme.new" &&
        mv "$readme.new" "$readme" && rm -f "$readme.part"
}

scaling() {
    awk -F, '
        NR == 1 { print "| against | | elements | cuts | triangles of a cut | cut, us per touched element | per cell made and triangle | step, ms | unknowns | least | VNA | remeshed | MB |"
                  print "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"; next }
        { printf("| %s | %s | %s | %s | %s | %s | %.2f | %s | %s | %s | %s | %s | %s |\n", $1, $2, $3, $4, $5, $10, $8 / ($7 + $5), $12, $14, $15, $16, $17, $18) }' "$tables/scaling.csv"
}

# Error of all four integrals, as a share of the element, and times, of gxfem and of RXFEM's published rule
quadrature() {
    echo "| region | triangles | gxfem: error | cut, us | RXFEM: error | path, us | rule, us | rule / cut |"
    echo "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"
    awk -F, '
        NR == 1 || ($3 != "gxfem" && !($3 == "rxfem" && $4 == 2)) { next }
        { region = $1 " | " $2 }
        !(region in seen) { seen[region] = 1; regions[++n] = region }
        $9 + 0 > error[region, $3] + 0 { error[region, $3] = $9 }
        { path[region, $3] = $11; rule[region, $3] = $12 }
        END {
            for (i = 1; i <= n; i++) {
                r = regions[i]; cut = path[r, "gxfem"] + rule[r, "gxfem"]
                printf("| %s | %.1e | %.1f | %.1e | %.1f | %.1f | %.1f |\n", r, error[r, "gxfem"], cut, error[r, "rxfem"], path[r, "rxfem"], rule[r, "rxfem"], rule[r, "rxfem"] / cut)
            }
        }' "$tables/quadrature.csv"
}

# The least and the largest error of slices of space.csv with affine copies that are thinner than an element, in the finest mesh of each
affine_space() {
    awk -F, '$1 == "slices" && $3 == "affine" && $5 < 0.94 { last[$2] = $9 }
        END { for (p in last) { e = 100 * last[p]; if (!n++ || e < least) least = e; if (e > most) most = e }
              printf("%.1f to %.1f %%", least, most) }' "$tables/space.csv"
}

# Rows that nothing cheaper beats
front() {
    echo "| scene | what is turned | | s per simulated second | error |"
    echo "| --- | --- | --- | ---: | ---: |"
    for scene in slab_in_five accordion "slab_in_five affine"; do
        awk -F, -v scene="$scene" '$1 == scene && $8 != "" && $9 == ""' "$tables/stepping.csv" | sort -t, -g -k 7,7 | awk -F, '
            least == "" || $8 + 0 < least { least = $8 + 0; printf("| %s | %s | %s | %.2f | %.1e |\n", $1, $2, $3, $7 / 1000, $8) }'
    done
}

# The least time in which each method reaches an error, by scene, in ms per simulated second; in parentheses how far off the worst copy
# is in that run. -: no setting reaches it.
local_solvers() {
    awk -F, '
        function cell(method, level,   key) {
            key = scene[i] SUBSEP method SUBSEP level
            return key in least ? sprintf("%.0f (%.2g)", least[key], worst[key]) : "-"
        }
        NR == 1 { next }
        {
            s = $1 ", " $2 ", " $3
            if (!(s in known)) { known[s] = 1; scene[++n] = s }
            method = $4 ~ /^XPBD|^VBD/ ? substr($4, 1, 4) : "gxfem"
            sub(/;$/, "", method)
            if ($9 == "") next
            for (k = 1; k <= levels; k++) {
                key = s SUBSEP method SUBSEP k
                if ($10 + 0 <= level[k] && (!(key in least) || $9 + 0 < least[key])) { least[key] = $9 + 0; worst[key] = $11 + 0 }
            }
        }
        BEGIN { levels = split("0.1 0.03 0.01 0.004", level, " ") }
        END {
            printf("| scene, state, unknowns | method |"); for (k = 1; k <= levels; k++) printf(" %s |", level[k]); print ""
            printf("| --- | --- |"); for (k = 1; k <= levels; k++) printf(" ---: |"); print ""
            count = split("gxfem XPBD VBD", methods, " ")
            for (i = 1; i <= n; i++)
                for (m = 1; m <= count; m++) {
                    printf("| %s | %s |", m == 1 ? scene[i] : "", methods[m])
                    for (k = 1; k <= levels; k++) printf(" %s |", cell(methods[m], k))
                    print ""
                }
        }' "$tables/front.csv"
}

# Steps by the error asked for: by scene the error reached and the time, and the least time of any setting of the library
# that was as exact as what was asked
asked() {
    awk -F, '
        NR == 1 || $4 ~ /^XPBD|^VBD/ || $9 == "" { next }
        {
            s = $1 ", " $2 ", " $3
            if (!(s in known)) { known[s] = 1; scene[++n] = s }
            if ($4 ~ /^quality/) { split($4, word, " "); error[s, word[2]] = $10 + 0; ms[s, word[2]] = $9 + 0; next }
            for (k = 1; k <= levels; k++)
                if ($10 + 0 <= level[k] && (!((s, k) in least) || $9 + 0 < least[s, k])) least[s, k] = $9 + 0
        }
        BEGIN { levels = split("0.1 0.03 0.01", level, " ") }
        END {
            printf("| scene, state, unknowns |"); for (k = 1; k <= levels; k++) printf(" %s: reached | ms | by hand |", level[k]); print ""
            printf("| --- |"); for (k = 1; k <= levels; k++) printf(" ---: | ---: | ---: |"); print ""
            for (i = 1; i <= n; i++) {
                printf("| %s |", scene[i])
                for (k = 1; k <= levels; k++)
                    printf(" %.2g | %.0f | %s |", error[scene[i], level[k]], ms[scene[i], level[k]], (scene[i], k) in least ? sprintf("%.0f", least[scene[i], k]) : "-")
                print ""
            }
        }' "$tables/front.csv"
}

# Runs of METHOD that ended with more energy than a tenth of the fall, or not at all, of all its runs in motion
created() {
    awk -F, -v method="$1" '$2 == "motion" && index($4, method) == 1 { runs++; more += $9 == "" || $13 > 0.1 } END { print more + 0 " of " runs + 0 }' \
        "$tables/front.csv"
}

# Iterations / milliseconds of a step, by case and method; cholmod: milliseconds of factorisation and solution
solver() {
    awk -F, '
        NR == 1 { next }
        !($1 in unknowns) { cases[++n] = $1; unknowns[$1] = $3 }
        !($2 in known) { known[$2] = 1; methods[++m] = $2 }
        { said[$1, $2] = $2 == "cholmod" ? sprintf("%.1f", $6) : sprintf("%.1f / %.1f", $4, $7) }
        END {
            printf("| case | unknowns |"); for (j = 1; j <= m; j++) printf(" %s |", methods[j]); print ""
            printf("| --- | ---: |"); for (j = 1; j <= m; j++) printf(" ---: |"); print ""
            for (i = 1; i <= n; i++) {
                printf("| %s | %s |", cases[i], unknowns[cases[i]]); for (j = 1; j <= m; j++) printf(" %s |", said[cases[i], methods[j]]); print ""
            }
        }' "$tables/solver.csv"
}

# Four runs a row
violent() {
    echo "| body | start | in balance | most iterations | rises | not finite | at rest | most frames | most left |"
    echo "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"
    awk -F, '
        NR == 1 { next }
        !(($1, $2) in runs) { keys[++n] = $1 SUBSEP $2 }
        {
            k = $1 SUBSEP $2; runs[k]++; name[k] = $1 " | " $2
            balance[k] += $8 == "balance"; rises[k] += $12; bad[k] += $13; rest[k] += $14 > 0
            if ($6 > most[k]) most[k] = $6
            if ($14 > frames[k]) frames[k] = $14
            if ($15 + 0 > left[k] + 0) left[k] = $15
        }
        END {
            for (i = 1; i <= n; i++) {
                k = keys[i]
                printf("| %s | %d of %d | %d | %d | %d | %d of %d | %d | %s |\n", name[k], balance[k], runs[k], most[k], rises[k], bad[k], rest[k], runs[k], frames[k], left[k])
            }
        }' "$tables/violent.csv"
}

# The finest mesh of each series that is refined
accuracy() {
    echo "| case | quantity | elements | error | order |"
    echo "| --- | --- | ---: | ---: | ---: |"
    awk -F, '
        NR == 1 || $8 == "" { next }
        !(($1, $2) in last) { keys[++n] = $1 SUBSEP $2 }
        { last[$1, $2] = sprintf("| %s | %s | %s | %s | %s |", $1, $2, $3, $6, $8) }
        END { for (i = 1; i <= n; i++) print last[keys[i]] }' "$tables/accuracy.csv"
}

skin() {
    echo "| cells of the block | vertices | triangles | positions, us | and normals, us | a ray, us | cut, ms | rebuilt, ms | view, ms | made anew, ms | share changed |"
    echo "| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"
    awk -F, 'NR > 1 { for (i = 2; i <= NF; i++) printf("| %s ", $i); print "|" }' "$tables/skin.csv"
}

# blade_rows KIND COLUMNS: an awk expression of rows of blade.csv, as rows of a table
blade_rows() {
    awk -F, -v kind="$1" '$1 == kind { print "| " '"$2"' " |" }' "$tables/blade.csv"
}

# heading NAME...: the head of a table, numbers on the right but for the first column
heading() {
    for name in "$@"; do printf '| %s ' "$name"; done
    echo "|"
    shift
    printf '| --- '
    for name in "$@"; do printf '| ---: '; done
    echo "|"
}

blade() {
    text "Measured on $(date -r "$tables/blade.csv" +%Y-%m-%d); times are of the processor. Edges in space through blocks that move \
meanwhile, built by \`-O2\`. The blocks of the scenes have 12^3 cubes, six elements \
each, and move by steps. Elements count as often as they were divided; leaves are what each of them added. Overlap, sawing, retreats \
and the like are in \`bench/blade.h\`. Volume: how far it is off at most, as a share."
    echo
    heading scene fragments expected "elements divided" "leaves each" "us each" "smallest link" volume
    blade_rows scene '$2 " | " $7 " | " $8 " | " $9 " | " $10 " | " $11 " | " $12 " | " ($22 == "" ? 0 : $22)'
    echo
    text "Random straight passes through blocks of 4^3 cubes that move, with noise at each node and frame; flat: squeezed to a \
fifth, so that elements turn inside out."
    echo
    heading "noise, cubes" passes "two pieces" "one piece" "smallest link"
    blade_rows passes '$2 " | " $8 " | " $7 " | " ($23 == "" ? 0 : $23) " | " $12'
    echo
    text "Edges that follow known sheets in blocks of 8^3 cubes, all seeds: how far the walls of the cut are off."
    echo
    echo "![Distance of a blade's cut from known sheets](charts/blade.svg)"
    echo
    heading motion frames "tolerance, cubes" "least advance, cubes" "largest, cubes" "root mean square" "us an element" "a move, ms"
    blade_rows error '$2 " | " $4 " | " $5 " | " $6 " | " $14 " | " $15 " | " $11 " | " $16'
    echo
    text "The same path by a blade through a still block and by a block past a still blade: how far the section is from that of 800 \
frames, the mean over it."
    echo
    heading "what moves" frames fragments expected "off, cubes" "us an element"
    blade_rows relativity '$2 " | " $4 " | " $7 " | " $8 " | " $14 " | " $11'
    echo
    heading cost elements frames "elements divided" "leaves each" "us each" "a move, ms" "worst, ms" "a step, ms" "share of it" "ns a point"
    awk -F, '$1 ~ /^(cost|idle|sample)$/ {
        name["cost"] = "a pass"; name["idle"] = "a move far from the body"; name["sample"] = $2 == "located" ? "gx_body_locate" : "a move that cuts nothing"
        print "| " name[$1] " | " $3 " | " $4 " | " $9 " | " $10 " | " $11 " | " $16 " | " $18 " | " $19 " | " $20 " | " $21 " |" }' "$tables/blade.csv"
    echo
    text "A pass of $(awk -F, '$1 == "frame" { print $4; exit }' "$tables/blade.csv") frames through \
$(awk -F, '$1 == "frame" { print $3; exit }' "$tables/blade.csv") elements that swing by steps; all: all but the step."
    echo
    heading "part of a frame" "median, ms" "95 of 100 below, ms" "worst, ms" "share of a step"
    blade_rows frame '$2 " | " $16 " | " $17 " | " $18 " | " $20'
    echo
    heading "tools that carve" elements "elements divided" "us each" "a tool, ms" "worst, ms" volume
    blade_rows carve '$2 " | " $3 " | " $9 " | " $11 " | " $16 " | " $18 " | " ($22 == "" ? 0 : $22)'
}

# Rows of thin.csv of one series; EXPRESSION: of awk
thin_rows() {
    awk -F, -v series="$1" '
        function share(x) { return x == "" ? "" : sprintf(x < 0.01 ? "%.4f" : "%.3f", x) }
        $1 == series { first += !first * $6; print "| " '"$2"' " |" }' "$tables/thin.csv"
}

# Iterations of Newton's method: the default and up to five, with the time of a step as a multiple of one iteration's
thin_newton() {
    awk -F, '
        $1 == "newton" {
            of = $2; sub(/.* in /, "", of); kind = $2; sub(/ in .*/, "", kind)
            if (kind + 0 == 1) one[$3, of] = $6
            row[++n] = $3; step[n] = of; name[n] = kind; error[n] = $5; ms[n] = $6
        }
        END { for (i = 1; i <= n; i++)
            if (one[row[i], step[i]] > 0)
                printf("| %s | %s | %s | %.4f | %.1f |\n", row[i], step[i], name[i], error[i], ms[i] / one[row[i], step[i]]) }' "$tables/thin.csv"
}

# What thin.csv has for one case of a series: COLUMN by number
thin_value() { awk -F, -v series="$1" -v of="$2" -v column="$3" '$1 == series && $2 == of { printf("%.3g", $column); exit }' "$tables/thin.csv"; }

thin() {
    heading "t, cubes" "Poisson's ratio" "least of all placements" largest "without affine copies" aim
    thin_rows placement '$3 " | " $4 " | " share($5) " | " share($6) " | " share($7) " | " $8'
    echo
    text "t = 0.1 in other meshes, and the slices of slab_in_five, all in one layer; Poisson's ratio 0.3."
    echo
    heading "mesh or slice" "t, cubes" "drop" "without affine copies" aim
    thin_rows mesh '$2 " | " $3 " | " share($5) " | " share($7) " | " $8'
    thin_rows slices '$2 " | " $3 " | " share($5) " | " share($7) " | " $8'
    echo
    text "Poisson's ratio 0, t = 0.1: the first frequency is $(thin_value frequency "over beam theory's" 5) times beam theory's. Large drops, as \
shares of the length: $(thin_value large "load 1.8198" 5) and $(thin_value large "load 10.903" 5); of an inextensible rod \
$(thin_value large "load 1.8198" 7) and $(thin_value large "load 10.903" 7)."
    echo
    text "Iterations of conjugate gradients to 1e-2: at balance, without inertia; in steps of slab_in_five, 61 x 11 cubes."
    echo
    heading "" "t, cubes" iterations aim
    thin_rows balance '"balance | " $3 " | " $5 " | " $8'
    thin_rows motion '"motion | " $3 " | " $5 " | " $8'
    echo
    text "The time to an error: a slice of 8 x 2 cubes, t = 0.2, from rest to balance in two iterations of Newton's method to 1e-2; linear: \
the same cut in meshes refined so many times, or layers of cubes through a slice that is meshed on its own."
    echo
    heading "elements, refinement" unknowns error "time, multiples of the first"
    thin_rows cost '$2 " | " $7 " | " share($5) " | " sprintf("%.2g", $6 / first)'
    echo
    text "Newton's method in steps of slab_in_five: slices 30 cubes long are let go. Error: distance of the tip from that of converged \
steps, root of the mean square over the run, over the largest displacement. default: newton_iterations 0, and what it takes on average."
    echo
    heading "t, cubes" "a step" iterations error "time, multiples of one iteration's"
    thin_newton
    echo
    text "A product of the Hessian with a vector, as conjugate gradients have it, for each element:"
    echo
    heading elements "with affine copies, ns" "cut linear ones, ns" ratio aim
    thin_rows product '$2 " | " sprintf("%.0f | %.1f | %.1f", $5, $7, $6) " | " $8'
}

# Rows of shapes.csv of one series as an expression of awk; the third argument, if there is one: which of them
shapes_rows() {
    awk -F, -v series="$1" '
        function share(x) { return sprintf("%.2g %%", 100 * x) }
        $1 == series && ('"${3:-1}"') { print "| " '"$2"' " |" }' "$tables/shapes.csv"
}

# A body carved out of a grid beside the MESH of one material that has about as many unknowns: time for an unknown, as a multiple
shapes_ratio() {
    awk -F, -v mesh="$1" '
        $1 == "one" && $2 == "carved" { n[++count] = $6; time[count] = $9 / $6 }
        $1 == "one" && $2 == mesh { fitted[++fits] = $6; each[fits] = $9 / $6 }
        END {
            for (i = 1; i <= count; i++) {
                for (j = best = 1; j <= fits; j++) if ((fitted[j] / n[i] - 1) ^ 2 < (fitted[best] / n[i] - 1) ^ 2) best = j
                printf("%s%.2f", i > 1 ? ", " : "", time[i] / each[best])
            }
        }' "$tables/shapes.csv"
}

# The order of convergence from the last but two to the last grid: COLUMN by number
shapes_order() {
    awk -F, -v series="$1" -v mesh="$2" -v column="$3" '
        $1 == series && $2 == mesh { error[++n] = $column < 0 ? -$column : $column; cells[n] = $3 }
        END { first = n > 2 ? n - 2 : 1; printf("%.1f", log(error[first] / error[n]) / log(cells[n] / cells[first])) }' "$tables/shapes.csv"
}

# How many models have a body, how exact these are at most, how many are refused
shapes_models() {
    awk -F, '
        $1 != "model" { next }
        $14 == "" { refused[$2] = 1; next }
        { made[$2] = 1; if ($14 + 0 > moments) moments = $14 + 0; if ($15 + 0 > area) area = $15 + 0 }
        END {
            for (name in made) bodies++
            for (name in refused) others++
            printf("%d models have bodies: the errors are at most %.0e and %.0e.", bodies, moments, area)
            if (others) printf(" %d are refused, with the place: they are not closed, or reach beyond 2^100.", others)
        }' "$tables/shapes.csv"
}

shapes_section() {
    echo "### Shapes carved out of a grid"
    echo
    text "A free ellipsoid with half axes of 1, 0.6 and 0.45 m as a body of a closed surface (\`gx_body_desc.shape\`), beside meshes that fit \
it: cubes mapped to it, and isosurface stuffing. Linear elasticity, Poisson's ratio 0.3. Deflection: the work of a force that bends it; \
frequency: of the lowest mode. Errors are those against mapped meshes of 28 and 44 cubes along an edge, extrapolated. The order of the carved body \
over its last three grids is $(shapes_order one carved 7) in the deflection and $(shapes_order one carved 8) in the frequency. Of two \
materials, with a core ten times as stiff, it is $(shapes_order two carved 7) and $(shapes_order two carved 8): an element through which \
the interface goes has one gradient for both, so it is too stiff there. The mapped mesh fits the interface: \
$(shapes_order two mapped 7) and $(shapes_order two mapped 8)."
    echo
    text "Kinked: a trial outside the library (\`bench/kink.h\`). Elements through which the interface goes have a kink there, by a \
material of the caller. The copies are the same. The order is $(shapes_order two kinked 7) and $(shapes_order two kinked 8). No steps \
are taken with it."
    echo
    heading "mesh" "cells" elements unknowns "deflection, one material" "frequency" "step, ms" "CG iterations"
    shapes_rows one '$2 " | " $3 " | " $5 " | " $6 " | " share($7) " | " share($8) " | " $9 " | " $10'
    echo
    heading "mesh" "cells" elements unknowns "deflection, two materials" "frequency" "step, ms" "CG iterations"
    shapes_rows two '$2 " | " $3 " | " $5 " | " $6 " | " share($7) " | " share($8) " | " $9 " | " $10'
    echo
    echo "![errors of carved and fitted bodies by unknowns and by time](charts/shapes.svg)"
    echo
    text "A step of the carved body takes, for each unknown, so many times that of the mapped mesh with about as many: \
$(shapes_ratio mapped); of the stuffed one: $(shapes_ratio stuffed). Small carved bodies have more of their elements at the surface."
    echo
    text "Making a body of a bumpy ellipsoid, seconds of the processor, and the memory that it holds afterwards and at most."
    echo
    heading "cells" triangles elements unknowns s MB "at most"
    shapes_rows cost '$3 " | " $4 " | " $5 " | " $6 " | " $11 " | " $12 " | " $13'
    echo
    text "Models: the largest error of volume, centre and inertia, by the mass matrices of the cells, beside exact sums over the triangles \
of the model's outline, which a Boolean finds: the model itself, unless it crosses itself; that of the skin's area. $(shapes_models) Rows \
are those of 500 triangles or more. \`MODELS=\` names others than the first two to \`make bench-shapes\`. \`tests/test_nasty.c\` does the \
same with twenty that meshers fail on, of several materials too."
    echo
    heading "model" cells triangles elements unknowns moments "area of the skin"
    shapes_rows model '$2 " | " $3 " | " $4 " | " $5 " | " $6 " | " sprintf("%.0e", $14) " | " sprintf("%.0e", $15)' '$4 >= 500 && $14 != ""'
    echo
}

# A paragraph
text() { echo "$*" | fold -s -w 119 | sed 's/ *$//'; }

# The sections of blades: from the line "## Blades in moving bodies" up to "## Booleans of closed surfaces"
blade_sections() {
    echo "## Blades in moving bodies"
    echo
    blade
    echo
    echo "## Thousands of strokes"
    echo
    text "Blocks of cubes, six elements each, from which tools take material. Freshly cut: a body cut at once by the union of all \
tools; a carving refines its tools, so that no body is like it. us: for each element that a stroke touches, time of the processor."
    echo
    table strokes "| scene | cubes along an edge | strokes | kB | at most | freshly cut | leaves | freshly cut | same topology | us, first tenth | last tenth | freshly cut | median stroke, ms | longest | compactions | longest of these, ms |"
    echo
}

# The page's jelly in browsers
web_section() {
    echo "## In browsers"
    echo
    text "The jelly of the page on which one slices (\`examples/web\`): a cube of 10,368 elements that hangs by its top, with contact. \
Three strokes make eight pieces of it; the lower four fall onto the ground and onto each other. Measured: 240 steps of 1/60 s from then on, \
a mean, in one thread each; the skin is what is drawn of it. Frames: of a step and the skin; drawing has a thread of its own. Modules as \`make web\` builds \
them, native programs by \`-O2\`. Topology, bits: sums over the skin's triangles and over all positions at the end. With the C library \
of the modules, musl, a native program ends in their bits. The functions of another one differ in last places, and a blade in space finds the \
moving body elsewhere by as much."
    echo
    table web "| program | vectors | step, ms | the slowest | skin, ms | to the first | frames a second | pieces | vertices | topology | bits |"
    echo
}

# Vectors and wide products by the compiler's extensions, by intrinsics, and without
intrinsics_section() {
    echo "## Intrinsics"
    echo
    text "One program by \`-O2\`, with vectors and products of 128 bits by the compiler's own extensions; with GXFEM_INTRINSICS, as \
Microsoft's cl would have them; and in plain C with neither. Medians of nine rounds, in each of which the three run one after the \
other, time of the processor; instructions of the whole program. Topologies are the same. \`bench/intrinsics.c\` says what is run."
    echo
    table intrinsics "| workload | by | ms | to extensions | million instructions | to extensions |"
    echo
}

# only FIRST NEXT COMMAND: writes anew what stands from heading FIRST up to heading NEXT, or puts it there
only() {
    {
        awk -v first="$1" -v up_to="$2" '$0 == first || $0 == up_to { exit } { print }' "$page"
        $3
        awk -v up_to="$2" '$0 == up_to { on = 1 } on { print }' "$page"
    } >"$page.new" && mv "$page.new" "$page" || exit 2
    echo "wrote $page from \"$1\" up to \"$2\""
    exit 0
}

case $readme in
blade) only "## Blades in moving bodies" "## Booleans of closed surfaces" blade_sections ;;
shapes) only "### Shapes carved out of a grid" "### Beside local solvers" shapes_section ;;
web) only "## In browsers" "## Intrinsics" web_section ;;
intrinsics) only "## Intrinsics" "## Blades in moving bodies" intrinsics_section ;;
esac

{
    echo "# Accuracy against speed, and where methods fail"
    echo
    text "Written by \`make charts\` from what was measured on $(measured) and after, $(uname -m | tr _ -), one thread, by \
\`-O3 -march=native\` where nothing else is said. \`make bench\` measures all anew (half an hour). All methods drive the same \
scenes and take the library's time step: only what is compared differs."
    echo
    echo "## Integrals over parts of cut elements"
    echo
    echo "![error against the time to make a rule and to use it](charts/quadrature.svg)"
    echo "![a curved cut by its number of triangles](charts/quadrature_triangles.svg)"
    echo
    text "Parts of one cut tetrahedron, beside RXFEM's rules, adaptive and regular sampling. Errors: the largest of the four \
integrals, beside those over the whole element. Ours are at rounding level whatever the cut is. Up to about a hundred triangles \
in an element the whole cut takes less time than RXFEM's rule alone. With more, RXFEM's rule is faster, where its error is \
acceptable: it fits the same few functions for any number of triangles."
    echo
    quadrature
    echo
    echo "## Motion"
    echo
    echo "![error of the motion against computing time](charts/stepping.svg)"
    echo "![what integrals by points and the thickness of cuts change of the motion](charts/stepping_cuts.svg)"
    echo
    text "The midpoint rule damps nothing, so its linear systems are solved to 1e-3. The error is proportional to a cut's thickness. \
RXFEM's and positive rules give the same motion as exact integrals, but RXFEM's take far longer to make, and to step with unless \
derivatives are evaluated once per side. Virtual nodes are as good on thick slices (the accordion); on thin ones their error stalls \
at $(stalls slab_in_five 'VNA; BDF2') however small the step is. Element deletion leaves nothing of the slab; on the accordion its \
error is $(stalls accordion 'deletion; BDF2')."
    echo
    text "Runs that no cheaper run beats, over integrators, step lengths, iterations of Newton and CG, lumping, \
preconditioners, virtual nodes and deletion:"
    echo
    front
    echo
    text "slab_in_five affine: with affine copies, which are another space, beside a reference of their own, over a fifth of the time. \
The same steps of linear elements are off by $(awk -F, '$2 == "linear elements" { printf("%.0f %%", 100 * $8) }' "$tables/stepping.csv") there."
    echo
    text "The error of the space comes on top: linear elements lock in slices that are thin beside them, cut or conforming. A \
slice as thick as a quarter of an element bends 3 to 5 % as far as it should, as one element 38 %, as four elements 90 %; a \
conforming mesh of one layer 35 %, of four layers 90 %. With affine copies, in the same cut meshes, slices \
are off by $(affine_space), each in the finest mesh in which it is thinner than an element."
    echo
    echo "![drops of slices and folds under refinement](charts/space.svg)"
    echo
    echo "### Slices thinner than their elements"
    echo
    text "With affine copies (\`gx_body_desc.affine_below\`) such slices bend. Drops of clamped plates of 15 x 4 cubes, cut at any place \
within one layer, as shares of those by elements of high order (\`bench/plate.h\`)."
    echo
    thin
    echo
    echo "![drops with affine copies and without, and the time to an error](charts/thin.svg)"
    echo
    shapes_section
    echo "### Beside local solvers"
    echo
    text "XPBD [Macklin and Mueller 2021] and VBD [Chen et al. 2024] on the same copies and parts of elements, in single precision, 16 \
elements or copies side by side. The least time, in ms per simulated second, in which any setting of a method reaches an error of the \
motion over 0.33 s (rms of ten moments), or of the balance at its end; in parentheses the error of the worst copy in that run, as a share \
of the largest displacement. Each method is compared with the converged motion of its own mass. Runs in motion that create energy, \
more than a tenth of the fall, or blow up: XPBD $(created XPBD), VBD $(created VBD), gxfem BDF1 $(created BDF1), BDF2 $(created BDF2), \
midpoint $(created midpoint), explicit $(created explicit)."
    echo
    local_solvers
    echo
    echo "![error of the motion against time beside XPBD and VBD](charts/front.svg)"
    echo
    text "Steps by the error asked for (\`quality\`): the error reached, ms per simulated second, and those of the cheapest setting of ours \
that is as exact as what was asked, chosen by hand."
    echo
    asked
    echo
    echo "## Scenes of GXFEM's Table 2"
    echo
    text "EI: integrals, MB: finding the fragments, both per subdomain that a cut visited; dpsi: Hessians, CG: linear solve, \
per step; dt: a frame; C: all frames with a cut, C+U: all frames. Rows (paper): published, Intel i9-13900K. The \
paper's sticks are six, ours 36. RXFEM divides only 21 elements of the octopus before its cuts cross. So nearly all elements \
compared there are whole ones, which RXFEM evaluates once too. Virtual nodes have the wrong mass."
    echo
    table table2 "| scene | method | frames | unknowns | subdomains | EI, ms | MB, ms | dpsi, ms | CG, s | dt max, s | dt avg, s | C, s | C+U, s | ended |"
    echo
    text "Times of the other methods as multiples of ours; aim: the multiple for which gxfem was designed."
    echo
    ratios
    echo
    echo "## Conditioning"
    echo
    text "Slices of any thickness, down to 1e-12 of an element, leave the condition number of the scaled system at \
$(range conditioning 6 '$1 == "slice" && $3 == "copies" && $4 == "block"') ($(range conditioning 6 '$1 == "slice" && $3 == "copies" && $4 == "multigrid"') \
with multigrid). A corner piece of a volume ratio of 1e-12 raises it to $(corner block off) ($(corner multigrid off)); by default it \
moves as a point, and it stays at $(corner block on) ($(corner multigrid on))."
    echo
    echo "![condition number against the size of a slice and of a corner piece](charts/conditioning.svg)"
    echo
    echo "## Hard cases"
    echo
    text "Right: as many fragments as the cuts leave, their volume, and a motion that stays finite and falls as a body falls \
(\`bench/hard.h\`). \"But for volume\": cuts of some thickness take material away. The literal Algorithm 1 has cuts 1e-4 of an edge \
thick; \"Algorithm 1 mended\": 1e-10, and a Boolean that mends what rounding inverts. Crossing cuts are beyond RXFEM. Virtual nodes \
find all fragments, with the mass of whole elements. Empty: not run."
    echo
    failure
    echo
    echo "## Scaling"
    echo
    echo "![cost of a cut against elements, cuts and triangles; unknowns](charts/scaling.svg)"
    echo
    text "The cost of a cut is proportional to the cells that it makes, whatever the number of elements and of earlier cuts beside it. \
A touched element takes $(range scaling 10 '$2 == "plane"') us by a plane; $(range scaling 10 '$1 == "elements" && $2 == "curved"') us \
by a curved sheet with one triangle for every three elements, $(range scaling 10 '$2 == "curved-pool"') us in memory that the host \
has had before, on pages of 2 MB. Where a hundred planes cross, a touched element takes $(range scaling 10 '$2 == "crossing" && $4 == 100' | sed 's/ to.*//') us: \
it has many cells. \`MESH=FILE\` cuts any mesh in the same way."
    echo
    text "Least: what separation demands, counted apart from the library (\`bench/least.h\`); VNA: virtual nodes; remeshed: a \
mesh whose elements end at the cuts, at least."
    echo
    scaling
    echo
    echo "## Time steps by preconditioner"
    echo
    text "A block of tetrahedra hangs by its top and sways; E = 1e6 Pa, one Newton iteration to 1e-2. Iterations of conjugate \
gradients / milliseconds of a whole step; two threads: milliseconds; CHOLMOD (with OpenBLAS): milliseconds of its factorisation \
and solution alone. Product: the matrix-free operator alone, of single vectors as conjugate gradients have them and of double \
ones (\`gxs_solver_product\`); bytes: the most that the solver had. For the loose fragments multigrid is forced; the solver's \
own choice is block-Jacobi there. With \`-O2\` a product takes 2.1 times as long, of double vectors 2.3 times."
    echo
    steps
    echo
    text "All cases; cholmod: milliseconds of factorisation and solution alone. -2: two threads. 1e6, 1e8: Young's modulus, Pa."
    echo
    solver
    echo
    echo "## Violent starts"
    echo
    text "One step to balance, at most 40 iterations, each from the start; then frames of one iteration, at most 300. Poisson's \
ratio 0.4 and 0.4999, steps of 0.033 and 1 s: four runs a row. Rises: iterates of higher energy than the one before; at rest: \
frames until a millionth of the start's energy is left."
    echo
    violent
    echo
    echo "## Frames with a cut"
    echo
    text "Built by \`-O2\`. A frame is a step of 33 ms by one Newton iteration; with a cut that advances by a strip, which changes the \
solver's model and multigrid where it has touched them, $(range frames 8 1) times the mean frame."
    echo
    table frames "| block | elements | unknowns | frame without a cut, ms | cut, ms | frame with a cut, ms | worst, ms | to the mean frame |"
    echo
    echo "## The visual surface"
    echo
    skin
    echo
    web_section
    intrinsics_section
    blade_sections
    echo "## Booleans of closed surfaces"
    echo
    text "\"+\": evaluated after each operand, \"?\": surfaces that are not vouched for as simple. Times include components and \
their volumes; surface: the time without them."
    echo
    table kernel "| workload | median, us | least, us | triangles | components | volume | signs by filter | exact | allocations | peak, bytes | surface, us |"
    echo
    echo "![chains and single Booleans beside other kernels](charts/open.svg)"
    echo "![time and memory of a chain](charts/chains.svg)"
    echo
    text "Workloads like the Open Boolean Benchmark's, in its frame (\`gxboolean --request\`), one thread each: from meshes to the \
result, evaluated after every operation, without reading and writing files. manifold is built with its own release flags, and its \
WebAssembly build compiles itself in the first call; CGAL's corefinement has exact constructions. cubes: 1000 unions, then 1000 \
differences that leave nothing; turned: the same, turned, each cube moved by up to 1e-3 of its edge; csg: 60 bumpy spheres, united or \
taken away; terrain: a block less 224 tools; dome_N: a dome less N capsules. A time limit of 120 s. Volumes are compared with those \
that parallel rays through the input give."
    echo
    open_table
    echo
    text "The smallest program with the kernel, a tetrahedron less another, alone and with GXFEM_STATIC: time of the processor to \
compile it, and its size, stripped."
    echo
    table smallest "| program | compiler | s | bytes |"
    echo
    echo "## Static solutions"
    echo
    text "Linear elements converge with the order 1.9 to 2 against beam theory and twisted columns (1.5 to 1.75 where the finest mesh \
is still coarse), 1.8 (plane stress) and 1.5 (plane strain) on Cook's membrane, whose corner is singular. Nearly incompressible \
they lock. Volumes averaged over the cells of a node (\`bench/averaged.h\`) are a trial that is not in the library."
    echo
    accuracy
    echo
    echo "## What integrators keep"
    echo
    text "Backward Euler is of first, BDF2 and the midpoint rule of second order in position and energy."
    echo
    table drift "| integrator | dt, s | steps | energy | linear momentum | angular momentum | error of position |"
    echo
    echo "## Programs"
    echo
    text "\`make bench-NAME\` builds and runs one and writes CSV. The first lines of each file say what it measures and how it \
judges."
    echo
    echo "| file in \`bench/\` | what it is |"
    echo "| --- | --- |"
    echo "| \`quadrature.c\`, \`stepping.c\`, \`space.c\`, \`thin.c\`, \`shapes.c\`, \`front.c\`, \`table2.c\`, \`conditioning.c\`, \`failure.c\`, \`scaling.c\`, \`solver.c\`, \`violent.c\`, \`kernel.c\`, \`open.c\`, \`smallest.sh\`, \`accuracy.c\`, \`drift.c\`, \`frames.c\`, \`skin.c\`, \`web.c\` with \`web.mjs\`, \`intrinsics.c\` with \`intrinsics.sh\`, \`blade.c\`, \`strokes.c\` | the sections above, in this order but for Booleans |"
    echo "| \`contact.c\` | pieces that press on each other: against closed forms; what a step with contact costs |"
    echo "| \`soak.c\` | 100,000 steps of bodies that are cut, kicked and dropped: no copy may run away |"
    echo "| \`rxfem.h\`, \`rxfem_rules.h\`, \`rxfem_model.h\` | RXFEM (Koschier, Bender, Thuerey 2017), written for the bench |"
    echo "| \`vna.h\`, \`literal.h\` | virtual nodes (element duplication); GXFEM's Algorithm 1 as published, a Boolean for each subdomain |"
    echo "| \`local.h\` | XPBD and VBD |
| \`sampling.h\`, \`parts.h\` | integrals by points; element deletion |"
    echo "| \`open.sh\`, \`open_cgal.cc\`, \`open_manifold.cc\`, \`open_manifold.mjs\` | CGAL and manifold as runners of the Open Boolean Benchmark |"
    echo "| \`averaged.h\` | volumes averaged over the cells of a node, a trial |"
    echo "| \`kink.h\` | elements with a kink where an interface goes through them, a trial |"
    echo "| \`plate.h\` | clamped plates by elements of high order |"
    echo "| \`hard.h\`, \`least.h\` | the hard cases; the least number of unknowns |"
    echo "| \`charts.sh\`, \`page.sh\` | charts; this page and two parts of the README |"
} >"$page" || exit 2
fill why && fill speed || exit 2
echo "wrote $page and two parts of $readme"
