#!/bin/sh
# Draws what benches have measured.
# usage: sh bench/charts.sh TABLES CHARTS
#        sh bench/charts.sh TABLES CHARTS blade     draws blade.svg alone; shapes: shapes.svg
#     TABLES  directory of the benches' CSV files
#     CHARTS  directory of the SVG files
# quadrature.csv gives quadrature.svg and quadrature_triangles.svg, stepping.csv stepping.svg and stepping_cuts.svg, kernel.csv chains.svg,
# the others one of their own name. A table that is missing is an error. Needs gnuplot.
set -u
tables=$1
charts=$2
mkdir -p "$charts" || exit 2
# where BENCH: when its table was made, and on what
where() { echo "$(date -r "$tables/$1.csv" +%Y-%m-%d), $(uname -m | tr _ -), one thread"; }

for bench in ${3:-quadrature conditioning stepping front space thin shapes scaling blade open kernel}; do
    [ -s "$tables/$bench.csv" ] || { echo "$0: $tables/$bench.csv is missing: make bench-$bench" >&2; exit 2; }
done

# The same in all charts: 1, 2, 8 ours, 3, 4 RXFEM or virtual nodes, 5 to 7 and 9 others
styles='set style line 1 lc rgb "#c00000" lw 2 pt 7 ps 1.1
set style line 2 lc rgb "#e08030" lw 2 pt 5 ps 0.9
set style line 3 lc rgb "#2060b0" lw 2 pt 9 ps 1.1
set style line 4 lc rgb "#2060b0" lw 1 dt 2 pt 8 ps 1.1
set style line 5 lc rgb "#308040" lw 2 pt 13 ps 1.1
set style line 6 lc rgb "#808080" lw 2 pt 11 ps 0.9
set style line 7 lc rgb "#000000" lw 1 pt 1 ps 0.9
set style line 8 lc rgb "#c00000" lw 1 dt 2 pt 6 ps 1.1
set style line 9 lc rgb "#000000" lw 1 dt 3 pt 4 ps 0.9'

# series REGION METHOD COLUMNS: an awk expression of rows of quadrature.csv, of the integrand xx+yy+zz, as a gnuplot data block.
# Errors below 1e-18 are drawn there.
series() {
    awk -F, -v region="$1" -v method="$2" '
        $1 == region && $3 == method && $5 == "xx+yy+zz" { error = $9 < 1e-18 ? 1e-18 : $9; print '"$3"' }' "$tables/quadrature.csv"
}

# Error by the time to make a rule (above), and per evaluation when a thousand share it (below); a panel for each region
panels() {
    echo 'set terminal svg size 1180,780 font "sans,12" background "white"'
    echo "set output '$charts/quadrature.svg'"
    for region in plane kink sphere; do
        for method in gxfem positive rxfem "rxfem clipped" adaptive regular "rxfem one"; do
            name=$(echo "$region $method" | tr ' ' _)
            for column in '$11 + $12, error, $4' '$14, error, $4'; do
                case $column in '$11'*) block=make_$name ;; *) block=each_$name ;; esac
                echo "\$$block << EOD"
                series "$region" "$method" "$column"
                echo "EOD"
            done
        done
    done
    cat <<END
$styles
set multiplot layout 2,3 title "Integral of x^2 + y^2 + z^2 over a part of one cut tetrahedron   ($(where quadrature))" font "sans,15"
set xlabel font ",11"; set logscale xy; set grid back lc rgb "#dddddd"; set format x "10^{%L}"; set format y "10^{%L}"
set yrange [3e-19:3]; set ytics 1e3; set key off
END
    for row in make each; do
        for region in plane kink sphere; do
            case $region in plane) text="plane, 1 triangle" ;; kink) text="kink, 2 triangles" ;; *) text="sphere, $(series sphere gxfem '$2') triangles" ;; esac
            if [ $row = make ]; then
                echo "set title '$text' offset 0,-0.6; set xlabel 'time of cut and rule, us'; set xrange [1:1e6]"
            else
                echo "set title ''; set xlabel 'evaluation + 1/1000 of cut and rule, us'; set xrange [0.01:3e4]"
            fi
            if [ $region = plane ]; then echo "set ylabel 'error, share of the element'"; else echo "set ylabel ''"; fi
            if [ $row$region = eachsphere ]; then echo 'set key at graph 0.99,0.68 right samplen 1.2 font "sans,10"'; else echo 'set key off'; fi
            printf 'plot '
            n=0
            for method in gxfem positive rxfem "rxfem clipped" adaptive regular "rxfem one"; do
                n=$((n + 1))
                style=$n
                case $method in
                "rxfem one") [ $row = each ] || continue; style="3 lw 1 dt 3 pt 10"; title="RXFEM, once a side" ;;
                gxfem) title="gxfem, moments" ;;
                positive) title="positive, degree 1-4" ;;
                rxfem) title="RXFEM, degree 1-4" ;;
                "rxfem clipped") title="RXFEM, clipped" ;;
                adaptive) title="adaptive, depth 1-6" ;;
                regular) title="regular, 5-100 cells" ;;
                esac
                [ $n -eq 1 ] || printf ', '
                printf '$%s_%s using 1:2 with linespoints ls %s title "%s"' $row "$(echo "$region $method" | tr ' ' _)" "$style" "$title"
            done
            echo
        done
    done
    echo 'unset multiplot'
}

# What a curved cut of more and more triangles costs in one element, and what RXFEM's rule is off then
triangles() {
    echo 'set terminal svg size 1180,480 font "sans,12" background "white"'
    echo "set output '$charts/quadrature_triangles.svg'"
    for method in gxfem rxfem triangles; do
        echo "\$$method << EOD"
        series spheres "$method" '$2, $11 + $12, error, $12'
        echo "EOD"
    done
    cat <<END
$styles
set multiplot layout 1,2 title "A sphere's octant cut by more and more triangles in one tetrahedron   ($(where quadrature))" font "sans,15"
set logscale xy; set grid back lc rgb "#dddddd"; set format y "10^{%L}"
set xlabel "triangles that meet the element"; set xrange [2:1000]
set ylabel "time, us"; set yrange [5:1e6]; set key left top
plot \$gxfem using 1:2 with linespoints ls 1 title "gxfem: the whole cut", \$rxfem using 1:2 with linespoints ls 3 title "RXFEM: path and rule", \$rxfem using 1:4 with linespoints ls 4 title "RXFEM: its rule alone"
set ylabel "error, share of the element"; set yrange [3e-19:3]; set ytics 1e3; set key right center
plot \$gxfem using 1:3 with linespoints ls 1 title "gxfem", \$rxfem using 1:3 with linespoints ls 3 title "RXFEM", \$triangles using 1:3 with linespoints ls 6 title "the triangles, beside the round sphere"
unset multiplot
END
}

# Condition numbers as a slice or a corner piece gets small
conditioning() {
    echo 'set terminal svg size 1180,480 font "sans,12" background "white"'
    echo "set output '$charts/conditioning.svg'"
    for name in slice corner; do
        for kind in copies,diagonal,off copies,diagonal,on copies,multigrid,off sign,none,off sign,diagonal,off sign,volume,off; do
            echo "\$${name}_$(echo $kind | tr , _) << EOD"
            awk -F, -v name=$name -v kind=$kind '$1 == name && $3 "," $4 "," $5 == kind { print $2, $6 }' "$tables/conditioning.csv" | sort -g
            echo "EOD"
        done
    done
    cat <<END
$styles
set multiplot layout 1,2 title "Condition of M + dt^2 K, a cube of five tetrahedra (RXFEM's Fig. 14)   ($(where conditioning))" font "sans,15"
set logscale xy; set grid back lc rgb "#dddddd"; set format x "10^{%L}"; set format y "10^{%L}"; set yrange [1:1e42]; set ytics 1e6
set ylabel "condition number"; set key right top
set title "a slice off the cube"; set xlabel "thickness of the slice, m"
plot \$slice_sign_none_off using 1:2 with linespoints ls 3 title "RXFEM, unscaled", \$slice_sign_diagonal_off using 1:2 with linespoints ls 4 title "RXFEM, diagonal", \$slice_sign_volume_off using 1:2 with linespoints ls 5 title "RXFEM, volume ratios (its own)", \$slice_copies_diagonal_off using 1:2 with linespoints ls 1 title "gxfem's copies, diagonal", \$slice_copies_multigrid_off using 1:2 with linespoints ls 2 title "the same, multigrid"
set title "a corner off one element"; set xlabel "volume of the piece, share of the element"
plot \$corner_sign_none_off using 1:2 with linespoints ls 3 title "RXFEM, unscaled", \$corner_sign_diagonal_off using 1:2 with linespoints ls 4 title "RXFEM, diagonal", \$corner_sign_volume_off using 1:2 with linespoints ls 5 title "RXFEM, volume ratios (its own)", \$corner_copies_diagonal_off using 1:2 with linespoints ls 1 title "gxfem's copies, diagonal", \$corner_copies_diagonal_on using 1:2 with linespoints ls 8 title "the same, piece moves as a point", \$corner_copies_multigrid_off using 1:2 with linespoints ls 2 title "gxfem's copies, multigrid"
unset multiplot
END
}

# What a cut costs by what it touches, what a step and memory cost, and the unknowns that cuts leave, against sizes
scaling() {
    echo 'set terminal svg size 1180,740 font "sans,12" background "white"'
    echo "set output '$charts/scaling.svg'"
    block="$(awk -F, '$1 == "cuts" { print $3; exit }' "$tables/scaling.csv") elements"
    for sweep in "elements plane 3" "elements curved 3" "elements curved-pool 3" "cuts parallel 4" "cuts crossing 4" "triangles curved 5"; do
        set -- $sweep
        echo "\$$1_$2 << EOD" | tr - _
        awk -F, -v sweep="$1" -v kind="$2" -v x="$3" '$1 == sweep && $2 == kind { print $x, $8 / ($7 + $5), $14, $17, 1000 * $12 / $14, 1e3 * $18 / $14 }' "$tables/scaling.csv"
        echo "EOD"
    done
    cat <<END
$styles
set multiplot layout 2,3 title "A block of tetrahedra under cuts   ($(where scaling))" font "sans,15"
set logscale xy; set grid back lc rgb "#dddddd"; set key left top samplen 1.5 font ",11"
set ylabel "cut, us per new cell and triangle"; set yrange [1:300]
set xlabel "elements"; set xrange [500:2e6]; set format x "10^{%L}"
plot \$elements_plane using 1:2 with linespoints ls 1 title "a plane", \$elements_curved using 1:2 with linespoints ls 3 title "a curved sheet", \$elements_curved_pool using 1:2 with linespoints ls 3 dt 2 title "in memory that was there"
set xlabel "cuts so far, $block"; set xrange [0.7:1500]; set format x "%g"
plot \$cuts_parallel using 1:2 with linespoints ls 1 title "parallel planes", \$cuts_crossing using 1:2 with linespoints ls 2 title "crossing planes"
set xlabel "triangles of the cut, $block"; set xrange [1:2e5]; set format x "10^{%L}"
plot \$triangles_curved using 1:2 with linespoints ls 3 title "a curved sheet"
set ylabel "step, us per unknown"; set yrange [0.05:30]; set xlabel "unknowns"; set xrange [*:*]
plot \$elements_plane using 3:5 with linespoints ls 1 title "by elements, seven planes", \$cuts_parallel using 3:5 with linespoints ls 8 title "by parallel planes", \$cuts_crossing using 3:5 with linespoints ls 2 title "by crossing planes"
set ylabel "memory of the cut body, kB per unknown"; set yrange [0.1:10]
plot \$elements_plane using 3:6 with linespoints ls 1 title "by elements, seven planes", \$cuts_parallel using 3:6 with linespoints ls 8 title "by parallel planes", \$cuts_crossing using 3:6 with linespoints ls 2 title "by crossing planes"
set ylabel "unknowns"; set yrange [*:1e9]; set format y "10^{%L}"; set xlabel "cuts so far, $block"; set xrange [0.7:1500]; set format x "%g"
plot \$cuts_parallel using 1:3 with linespoints ls 1 title "gxfem = VNA = least", \$cuts_crossing using 1:3 with linespoints ls 2 title "the same, crossing", \$cuts_parallel using 1:4 with linespoints ls 1 dt 2 title "remeshed", \$cuts_crossing using 1:4 with linespoints ls 2 dt 2 title "remeshed, crossing"
unset multiplot
END
}

# stepping_rows BLOCK SCENE SERIES COLUMNS: an awk expression of rows of stepping.csv that have a motion, as a gnuplot data block.
# Differences below 1e-9 are drawn there.
stepping_rows() {
    echo "\$$1 << EOD"
    awk -F, -v scene="$2" -v series="$3" '
        $1 == scene && $2 == series && $8 != "" { beside = $9 < 1e-9 ? 1e-9 : $9; print '"$4"' }' "$tables/stepping.csv"
    echo "EOD"
}

block_name() { echo "$1" | tr -c 'A-Za-z0-9\n' _; }

# Error of the motion against time; a panel for each scene
stepping() {
    echo 'set terminal svg size 1180,560 font "sans,12" background "white"'
    echo "set output '$charts/stepping.svg'"
    for scene in slab_in_five accordion; do
        for kind in "BDF1" "BDF2" "midpoint" "midpoint; 2 Newton" "BDF2; lumped" "VNA; BDF2" "deletion; BDF2" "CG tolerance" "Newton iterations"; do
            stepping_rows "${scene}_$(block_name "$kind")" $scene "$kind" '$7 / 1000, $8'
        done
    done
    for kind in BDF2 midpoint; do stepping_rows "affine_$kind" "slab_in_five affine" "$kind" '$7 / 1000, $8'; done
    cat <<END
$styles
set multiplot layout 1,2 title "Error of the motion of a cut body after 0.33 s, in the same space   ($(where stepping))" font "sans,15"
set logscale xy; set grid back lc rgb "#dddddd"; set format y "10^{%L}"
set xlabel "computing time, s per simulated second"; set ylabel "error, share of the motion"; set yrange [3e-7:3]
END
    for scene in slab_in_five accordion; do
        echo "set title '$(echo $scene | tr _ ' ')'; set key bottom left samplen 1.5 font ',10'"
        [ $scene = slab_in_five ] || echo "set key off; set ylabel ''"
        affine="\$affine_BDF2 using 1:2 with linespoints ls 1 pt 4 title 'affine copies, BDF2; a reference of their own', \$affine_midpoint using 1:2 with linespoints ls 5 pt 4 title 'affine copies, midpoint',"
        [ $scene = slab_in_five ] || affine=
        echo "plot $affine \$${scene}_BDF1 using 1:2 with linespoints ls 2 title 'BDF1, dt 33 to 2 ms', \$${scene}_BDF2 using 1:2 with linespoints ls 1 title 'BDF2', \$${scene}_BDF2__lumped using 1:2 with linespoints ls 8 title 'BDF2, lumped mass', \$${scene}_midpoint using 1:2 with linespoints ls 5 lw 1 dt 2 pt 12 title 'midpoint', \$${scene}_midpoint__2_Newton using 1:2 with linespoints ls 5 title 'midpoint, 2 Newton', \$${scene}_VNA__BDF2 using 1:2 with linespoints ls 3 title 'VNA, BDF2', $(deletion_of $scene) \$${scene}_CG_tolerance using 1:2 with linespoints ls 6 title 'BDF1, 8 ms: CG 1e-1 to 1e-6', \$${scene}_Newton_iterations using 1:2 with linespoints ls 7 title 'BDF1, 8 ms: Newton 1 to 16'"
    done
    echo 'unset multiplot'
}

# front_rows BLOCK SCENE UNKNOWNS METHOD: time and error of its runs in motion, by time, as a gnuplot data block. UNKNOWNS: least and most
front_rows() {
    echo "\$$1 << EOD"
    awk -F, -v scene="$2" -v least="${3% *}" -v most="${3#* }" -v method="$4" '
        $1 == scene && $2 == "motion" && $3 + 0 >= least + 0 && $3 + 0 <= most + 0 && $4 == method && $9 != "" { print $9 / 1000, $10 }' \
        "$tables/front.csv" | sort -g
    echo "EOD"
}

# Error of the motion against time beside local solvers; a panel for each of four scenes
front() {
    echo 'set terminal svg size 1180,900 font "sans,12" background "white"'
    echo "set output '$charts/front.svg'"
    panels='accordion 1e6,30000 50000;uncut 1e6,20000 30000;accordion 1e8,30000 50000;accordion 1e6,4000 5000'
    echo "$panels" | tr ';' '\n' | while IFS=, read -r scene unknowns; do
        for kind in BDF1 BDF2 midpoint explicit XPBD VBD "VBD; Chebyshev"; do
            front_rows "$(block_name "$scene $unknowns $kind")" "$scene" "$unknowns" "$kind"
        done
    done
    cat <<END
$styles
set multiplot layout 2,2 title "Error of the motion over 0.33 s beside local solvers   ($(where front))" font "sans,15"
set logscale xy; set grid back lc rgb "#dddddd"; set format y "10^{%L}"
set xlabel "computing time, s per simulated second"; set ylabel "error, share of the motion"; set yrange [1e-4:3]
END
    echo "$panels" | tr ';' '\n' | while IFS=, read -r scene unknowns; do
        echo "set title '$scene, $(front_unknowns "$scene" "$unknowns") unknowns'; set key bottom left samplen 1.5 font ',10'"
        name() { block_name "$scene $unknowns $1"; }
        echo "plot \$$(name BDF1) using 1:2 with points ls 2 title 'BDF1', \$$(name BDF2) using 1:2 with points ls 1 title 'BDF2', \$$(name midpoint) using 1:2 with points ls 8 title 'midpoint', \$$(name explicit) using 1:2 with points ls 5 title 'explicit', \$$(name XPBD) using 1:2 with linespoints ls 3 title 'XPBD, 2 to 500 substeps', \$$(name VBD) using 1:2 with points ls 6 title 'VBD', \$$(name 'VBD; Chebyshev') using 1:2 with points ls 7 title 'VBD, Chebyshev'"
    done
    echo 'unset multiplot'
}

front_unknowns() { awk -F, -v scene="$1" -v least="${2% *}" -v most="${2#* }" '$1 == scene && $3 + 0 >= least + 0 && $3 + 0 <= most + 0 { print $3; exit }' "$tables/front.csv"; }

# Element deletion's part of a plot; where it leaves nothing, its name says so.
deletion_of() {
    if grep -q "^$1,deletion; BDF2,.*no element is left" "$tables/stepping.csv"; then
        echo "NaN with linespoints ls 9 title 'element deletion: nothing is left',"
    else
        echo "\$$1_deletion__BDF2 using 1:2 with linespoints ls 9 title 'element deletion, BDF2',"
    fi
}

# What integrals by points and the thickness of cuts change of the motion, beside what the time step does
stepping_cuts() {
    echo 'set terminal svg size 1180,900 font "sans,12" background "white"'
    echo "set output '$charts/stepping_cuts.svg'"
    for scene in slab_in_five accordion; do
        for kind in exact RXFEM "RXFEM one" positive "positive one" adaptive "adaptive one" regular "regular one"; do
            stepping_rows "${scene}_$(block_name "$kind")" $scene "$kind" '$7 / 1000, beside'
        done
        for kind in "gxfem; solids" "Algorithm 1"; do stepping_rows "${scene}_$(block_name "$kind")" $scene "$kind" '$3, beside'; done
    done
    cat <<END
$styles
set multiplot layout 2,2 title "Motion beside that of exact integrals and thin cuts, same steps   ($(where stepping))" font "sans,15"
set logscale xy; set grid back lc rgb "#dddddd"; set format x "10^{%L}"; set format y "10^{%L}"; set yrange [3e-10:30]
END
    for scene in slab_in_five accordion; do
        step=$(awk -F, -v scene=$scene '$1 == scene && $2 == "exact" { print $8 }' "$tables/stepping.csv")
        title=$(echo $scene | tr _ ' ')
        if [ $scene = slab_in_five ]; then echo "set ylabel 'difference, share of the motion'"; else echo "set ylabel ''"; fi
        echo "set title '$title: integrals' offset 0,-0.6; set xlabel 's per simulated second (open: one evaluation a part)'; set key bottom right samplen 1.5 font ',10'; set xrange [*:*]"
        [ $scene = slab_in_five ] || echo "set key off"
        if rxfem_refuses $scene; then echo "set label 1 'RXFEM refuses it: cuts cross' at graph 0.97,0.06 right font ',10'"; else echo "unset label 1"; fi
        echo "plot $step with lines ls 7 title 'error of the time step', \$${scene}_exact using 1:2 with points ls 1 ps 1.6 title 'gxfem, exact (0, drawn at 1e-9)', $(rxfem_of $scene) \$${scene}_positive using 1:2 with linespoints ls 2 title 'positive rule, degree 1, 2', \$${scene}_positive_one using 1:2 with points ls 2 pt 4 notitle, \$${scene}_adaptive using 1:2 with linespoints ls 5 title 'adaptive, depth 1 to 4', \$${scene}_adaptive_one using 1:2 with points ls 5 pt 12 notitle, \$${scene}_regular using 1:2 with linespoints ls 6 title 'regular, 5 to 50 cells', \$${scene}_regular_one using 1:2 with points ls 6 pt 10 notitle"
    done
    for scene in slab_in_five accordion; do
        step=$(awk -F, -v scene=$scene '$1 == scene && $2 == "exact" { print $8 }' "$tables/stepping.csv")
        if [ $scene = slab_in_five ]; then echo "unset label 1; set ylabel 'difference, share of the motion'"; else echo "set ylabel ''"; fi
        echo "set title '$(echo $scene | tr _ ' '): thickness' offset 0,-0.6; set xlabel 'thickness of the cuts, edges'; set xrange [5e-7:2e-2]; set key top left"
        [ $scene = slab_in_five ] || echo "set key off"
        echo "plot $step with lines ls 7 title 'error of the time step', \$${scene}_gxfem__solids using 1:2 with linespoints ls 1 title 'gxfem, solids', \$${scene}_Algorithm_1 using 1:2 with linespoints ls 3 title 'Algorithm 1, as published'"
    done
    echo 'unset multiplot'
}

rxfem_refuses() { grep -q "^$1,RXFEM,.*cross" "$tables/stepping.csv"; }

rxfem_of() {
    if rxfem_refuses $1; then
        echo "NaN with points ls 3 title 'RXFEM: refused',"
    else
        echo "\$$1_RXFEM using 1:2 with points ls 3 title 'RXFEM, 24 points a side', \$$1_RXFEM_one using 1:2 with points ls 3 pt 8 notitle,"
    fi
}

# space_rows BLOCK SCENE METHOD COLUMNS: an awk expression of rows of space.csv that have a drop, as a gnuplot data block
space_rows() {
    echo "\$$1 << EOD"
    awk -F, -v scene="$2" -v method="$3" '$1 == scene && $3 == method && $7 != "" { print '"$4"' }' "$tables/space.csv" | sort -g
    echo "EOD"
}

# How far slices and folds bend, by their thickness in elements; and the error by the number of unknowns
space() {
    echo 'set terminal svg size 1180,520 font "sans,12" background "white"'
    echo "set output '$charts/space.svg'"
    for method in cut affine VNA deletion conforming; do
        space_rows slices_$method slices $method '$5, 100 * $7 / $8'
        space_rows accordion_$method accordion $method '$6, $9'
    done
    cat <<END
$styles
set multiplot layout 1,2 title "The same cuts at rest under refinement, beside conforming meshes   ($(where space))" font "sans,15"
set logscale xy; set grid back lc rgb "#dddddd"
set title "five slices in one layer of elements, refined"; set xlabel "thickness of a slice, elements"; set ylabel "drop of its end, % of the converged"
set xrange [0.05:*]; set yrange [0.1:300]; set key bottom right samplen 1.5
plot \$slices_conforming using 1:2 with points ls 5 title "conforming mesh of each slice", \$slices_cut using 1:2 with points ls 1 title "cut, gxfem (and RXFEM's space)", \$slices_affine using 1:2 with points ls 2 title "the same, affine copies below one element", \$slices_VNA using 1:2 with points ls 3 title "VNA", \$slices_deletion using 1:2 with points ls 9 title "element deletion, where any is left", 100 with lines ls 7 lw 1 notitle
set title "accordion, 6 folds"; set xlabel "unknowns"; set ylabel "error of the drop of its bottom"; set xrange [*:*]; set yrange [1e-2:2]; set format x "10^{%L}"; set key bottom left
plot \$accordion_conforming using 1:2 with linespoints ls 5 title "conforming mesh", \$accordion_cut using 1:2 with linespoints ls 1 title "cut, gxfem (and RXFEM's space)", \$accordion_VNA using 1:2 with linespoints ls 3 title "VNA", \$accordion_deletion using 1:2 with linespoints ls 9 title "element deletion"
unset multiplot
END
}

# thin_rows BLOCK COLUMNS TEST: rows of thin.csv for which a test of awk holds, as a gnuplot data block
thin_rows() {
    echo "\$$1 << EOD"
    awk -F, 'NR > 1 && ('"$3"') { print '"$2"' }' "$tables/thin.csv"
    echo "EOD"
}

# How far slices bend with affine copies and without, by their thickness; the time to an error
thin() {
    echo 'set terminal svg size 1180,480 font "sans,12" background "white"'
    echo "set output '$charts/thin.svg'"
    for nu in 0.3 0.4; do thin_rows bends_${nu#0.} '$3, 100 * $5, 100 * $6, 100 * $7' "\$1 == \"placement\" && \$4 == $nu"; done
    thin_rows affine '$6, $5' '$1 == "cost" && $2 ~ /^affine/'
    thin_rows linear '$6, $5' '$1 == "cost" && $2 ~ /^linear x/'
    thin_rows meshed '$6, $5' '$1 == "cost" && $2 ~ /meshed/'
    cat <<END
$styles
set multiplot layout 1,2 title "Slices within one layer of elements, at rest   ($(where thin))" font "sans,15"
set logscale xy; set grid back lc rgb "#dddddd"; set key bottom right samplen 1.5
set xlabel "thickness of the slice, elements"; set ylabel "drop of its end, % of elements of high order"; set xrange [0.015:1.5]; set yrange [0.01:200]
plot \$bends_3 using 1:2 with linespoints ls 1 title "affine copies, Poisson's ratio 0.3, worst placement", \$bends_3 using 1:3 with lines ls 8 title "best placement", \$bends_4 using 1:2 with linespoints ls 2 title "0.4, worst placement", \$bends_3 using 1:4 with linespoints ls 3 title "linear elements, 0.3", 100 with lines ls 7 notitle
set xlabel "one balance, ms"; set ylabel "error of the drop"; set xrange [*:*]; set yrange [1e-3:2]; set format y "10^{%L}"; set key bottom left
plot \$affine using 1:2 with linespoints ls 1 title "cut, affine copies", \$linear using 1:2 with linespoints ls 3 title "cut, linear elements, refined", \$meshed using 1:2 with linespoints ls 5 title "slice meshed on its own, linear elements"
unset multiplot
END
}

# How far shapes bend that are carved out of a grid, beside meshes that fit, of one material and of two: by unknowns, by time
shapes() {
    echo 'set terminal svg size 1180,860 font "sans,12" background "white"'
    echo "set output '$charts/shapes.svg'"
    for series in one two; do
        for mesh in carved mapped stuffed kinked; do
            echo "\$${series}_$mesh << EOD"
            awk -F, -v series=$series -v mesh=$mesh '$1 == series && $2 == mesh { print $6, $9 == "" ? "NaN" : $9, -$7, $8 }' "$tables/shapes.csv"
            echo "EOD"
        done
    done
    cat <<END
$styles
set multiplot layout 2,2 title "A free ellipsoid of one material (above) and of two: deflection and lowest frequency   ($(where shapes))" font "sans,15"
set logscale xy; set grid back lc rgb "#dddddd"; set key bottom left samplen 1.5; set ylabel "error"; set yrange [2e-3:1]; set format y "10^{%L}"
END
    for series in one two; do
        fitted="\$${series}_mapped using COLUMN:3 with linespoints ls 3 title 'mapped mesh, deflection', \$${series}_mapped using COLUMN:4 with linespoints ls 4 title 'its frequency'"
        [ $series = two ] || fitted="$fitted, \$one_stuffed using COLUMN:3 with linespoints ls 5 title 'stuffed mesh, deflection'"
        for column in 1 2; do
            [ $column = 1 ] && { echo 'set xlabel "unknowns"; set xrange [300:60000]'; slope="600 * x ** (-2.0 / 3) / 8"; } || { echo 'set xlabel "a time step, ms"; set xrange [0.05:8]'; slope=NaN; }
            kinked="" # without steps
            [ $series$column = two1 ] && kinked=", \$two_kinked using 1:3 with linespoints ls 2 title 'carved with kinks, deflection'"
            echo "plot \$${series}_carved using $column:3 with linespoints ls 1 title 'carved, deflection', \$${series}_carved using $column:4 with linespoints ls 8 title 'its frequency', $(echo "$fitted" | sed "s/COLUMN/$column/g")$kinked, $slope with lines ls 7 title '$([ $column = 1 ] && echo second order)'"
        done
    done
    echo "unset multiplot"
}

# How far the walls of a blade's cut are off known sheets, over tolerances: by these, and by the time for each divided element
blade() {
    echo 'set terminal svg size 1180,480 font "sans,12" background "white"'
    echo "set output '$charts/blade.svg'"
    for motion in calm swinging violent; do
        echo "\$$motion << EOD"
        awk -F, -v motion=$motion '$1 == "error" && $2 == motion && $4 == 60 && $6 == 0.5 { print $5, $11, $14, $15 }' "$tables/blade.csv" | sort -g
        echo "EOD"
    done
    cat <<END
$styles
set multiplot layout 1,2 title "A blade that follows a sheet of a moving body, 60 frames: distance of the cut's walls from it   ($(where blade))" font "sans,15"
set logscale xy; set grid back lc rgb "#dddddd"; set format x "10^{%L}"; set format y "10^{%L}"; set yrange [1e-4:1]
set xlabel "tolerance, edges of an element"; set ylabel "distance, edges of an element"; set xrange [5e-4:0.2]; set key left top
plot \$calm using 1:3 with linespoints ls 1 title "calm, largest", \$calm using 1:4 with linespoints ls 8 title "calm, root mean square", \$swinging using 1:3 with linespoints ls 2 title "swinging, largest", \$violent using 1:3 with linespoints ls 3 title "violent, largest", \$violent using 1:4 with linespoints ls 4 title "violent, root mean square", x with lines ls 7 title "the tolerance"
set xlabel "time for each divided element, us, over tolerances of 0.1 to 0.001"; set ylabel ""; set xrange [*:*]; set format x "%g"; set key off
plot \$calm using 2:3 with linespoints ls 1, \$calm using 2:4 with linespoints ls 8, \$swinging using 2:3 with linespoints ls 2, \$violent using 2:3 with linespoints ls 3, \$violent using 2:4 with linespoints ls 4
unset multiplot
END
}

# open_rows RUNNER WORKLOADS BLOCK X: of the workloads whose names match, what they took by an expression X, as a data block
open_rows() {
    echo "\$$(block_name "$3 $1") << EOD"
    awk -F, -v runner="$1" -v match_name="$2" '$2 == runner && $1 ~ match_name && $5 == "success" { print '"$4"', $7 / 1000 }' "$tables/open.csv" | sort -g
    echo "EOD"
}

# Chains and single Booleans beside other kernels
open() {
    echo 'set terminal svg size 1180,480 font "sans,12" background "white"'
    echo "set output '$charts/open.svg'"
    for runner in gxfem manifold manifold-wasm CGAL; do
        open_rows $runner '^dome_' dome 'substr($1, 6)'
        open_rows $runner '^spheres_' spheres '$4'
    done
    cat <<END
$styles
set multiplot layout 1,2 title "Booleans beside other kernels, from meshes to the result   ($(where open))" font "sans,15"
set logscale xy; set grid back lc rgb "#dddddd"; set ylabel "s"; set key bottom right; set format y "10^{%L}"
set title "a dome less capsules, evaluated after each"; set xlabel "capsules"
plot \$dome_gxfem with linespoints ls 1 title "gxfem", \$dome_manifold with linespoints ls 3 title "manifold", \$dome_manifold_wasm with linespoints ls 4 title "manifold, WebAssembly", \$dome_CGAL with linespoints ls 5 title "CGAL, corefinement"
set title "a sphere less a moved copy"; set xlabel "triangles of both"; set format x "10^{%L}"; set ylabel ""
plot \$spheres_gxfem with linespoints ls 1 title "gxfem", \$spheres_manifold with linespoints ls 3 title "manifold", \$spheres_manifold_wasm with linespoints ls 4 title "manifold, WebAssembly", \$spheres_CGAL with linespoints ls 5 title "CGAL, corefinement"
unset multiplot
END
}

# chain_rows COLUMN: of chains by length in kernel.csv
chain_rows() { awk -F, -v column="$1" '$1 ~ /^chain_/ { print substr($1, 7), $column }' "$tables/kernel.csv"; }
chains() {
    echo 'set terminal svg size 640,420 font "sans,12" background "white"'
    echo "set output '$charts/chains.svg'"
    echo '$time << EOD'; chain_rows 2; echo EOD
    echo '$step << EOD'; chain_rows 3; echo EOD
    echo '$memory << EOD'; chain_rows 10; echo EOD
    cat <<END
$styles
set title "Turned cubes united one by one, nothing rounded in between"
set logscale xyy2; set grid back lc rgb "#dddddd"; set key top left; set format y "10^{%L}"; set format y2 "10^{%L}"
set xlabel "cubes"; set ylabel "s of the processor"; set y2label "MB"; set ytics nomirror; set y2tics
plot \$time using 1:(\$2/1e6) with linespoints ls 1 title "the whole chain, s", \$step using 1:(\$2/1e6) with linespoints ls 2 title "the last step, s", \$memory using 1:(\$2/1e6) axes x1y2 with linespoints ls 3 title "memory, MB (right)"
END
}
if [ "${3:-}" = blade ]; then
    blade | gnuplot || exit 1
    echo "wrote $charts/blade.svg"
    exit 0
fi
if [ "${3:-}" = shapes ]; then
    shapes | gnuplot || exit 1
    echo "wrote $charts/shapes.svg"
    exit 0
fi
panels | gnuplot && triangles | gnuplot && conditioning | gnuplot && stepping | gnuplot && stepping_cuts | gnuplot && front | gnuplot && space | gnuplot && thin | gnuplot && shapes | gnuplot && scaling | gnuplot && blade | gnuplot && open | gnuplot && chains | gnuplot || exit 1
echo "wrote $charts/quadrature.svg, quadrature_triangles.svg, conditioning.svg, stepping.svg, stepping_cuts.svg, front.svg, space.svg, thin.svg, shapes.svg, scaling.svg, blade.svg, open.svg, chains.svg"
