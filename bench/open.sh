#!/bin/sh
# Runs the like of the Open Boolean Benchmark's workloads by gxboolean and, where they are installed, by other kernels that stand in the
# same frame: manifold (natively if pkg-config knows it, else npm's WebAssembly build) and CGAL's corefinement. One thread each.
# usage: sh bench/open.sh BUILD TABLE [--small]
#     BUILD  where bench/open and gxboolean of the same flags are; works in BUILD/bench/open_work
#     TABLE  CSV file; the rows go to stdout, too
#     LIMIT    seconds that a runner may take for a workload (120)
#     RUNNERS  those that are to run (gxfem manifold manifold-wasm CGAL; WebAssembly only where manifold is not)
#     CXX      compiler of the others' runners (c++)
# Each workload is run up to three times while that takes less than ten seconds a time; the row is that of the median. A runner that is
# missing is left out, and that is said.
set -u
[ $# -ge 2 ] || { echo "usage: $0 BUILD TABLE [--small]" >&2; exit 2; }
build=$1
table=$2
small=${3:-}
work=$build/bench/open_work
LIMIT=${LIMIT:-120}
CXX=${CXX:-c++}
RUNNERS=${RUNNERS:-gxfem manifold manifold-wasm CGAL}
bench=$(dirname -- "$0")
rm -rf "$work"
mkdir -p "$work/out" || exit 2

# Is there a runner of this name? Builds it if it has to be.
have() {
    case $1 in
    gxfem) ;;
    manifold)
        pkg-config --exists manifold 2>/dev/null &&
            # shellcheck disable=SC2046
            "$CXX" -std=c++17 -O3 -march=native "$bench/open_manifold.cc" -o "$build/bench/open_manifold" \
                $(pkg-config --cflags --libs manifold) >"$work/manifold.log" 2>&1 ;;
    manifold-wasm)
        command -v node >/dev/null 2>&1 && command -v npm >/dev/null 2>&1 &&
            npm install --no-audit --no-fund --prefix "$build/bench/npm" manifold-3d@3 >"$work/npm.log" 2>&1 ;;
    CGAL)
        "$CXX" -std=c++17 -O3 -march=native -frounding-math "$bench/open_cgal.cc" -o "$build/bench/open_cgal" -lgmp -lmpfr \
            >"$work/cgal.log" 2>&1 ;;
    esac
}

# answer RUNNER WORKLOAD: runs it, and leaves its result in RUNNER/WORKLOAD.json
answer() {
    set -- "$1" --request "$work/$2.json" --result "$work/$1/$2.json"
    case $1 in
    gxfem) shift; timeout "$LIMIT" "$build/bench/gxboolean" "$@" --last-only ;;
    manifold) shift; timeout "$LIMIT" "$build/bench/open_manifold" "$@" ;;
    manifold-wasm) shift
        timeout "$LIMIT" node "$bench/open_manifold.mjs" "$build/bench/npm/node_modules/manifold-3d/manifold.js" "$@" ;;
    CGAL) shift; timeout "$LIMIT" "$build/bench/open_cgal" "$@" ;;
    esac >/dev/null 2>&1
}

# rows RUNNER WORKLOAD: a row for each time that it is run
rows() {
    for _ in 1 2 3; do
        rm -f "$work/$1/$2.json" "$work"/out/*
        start=$(date +%s)
        answer "$1" "$2"
        code=$? took=$(($(date +%s) - start + 1))
        [ $code -ne 124 ] || took=timeout
        "$build/bench/open" read "$work" "$2" "$1" $took
        [ $took != timeout ] && [ "$took" -lt 10 ] || break
    done
}

workloads=$("$build/bench/open" write "$work" $small) || exit 1
{
    echo "workload,runner,operations,input_triangles,status,done,ms,export_ms,triangles,euler,volume,ray_volume"
    for runner in $RUNNERS; do
        [ $runner != manifold-wasm ] || [ ! -d "$work/manifold" ] || continue
        have $runner || { [ $runner = manifold ] || echo "open: $runner is left out: it cannot be built or installed" >&2; continue; }
        mkdir -p "$work/$runner"
        for workload in $workloads; do
            rows $runner "$workload" | sort -t , -k 7 -g | awk '{ row[NR] = $0 } END { print row[int((NR + 1) / 2)] }'
        done
    done
} | tee "$table.part" && mv "$table.part" "$table" && rm -rf "$work"
