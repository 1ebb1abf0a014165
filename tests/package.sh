#!/bin/sh
# Installs gxfem into a folder, by CMake and by make, and builds a small program against what is there, as users do: by
# find_package, add_subdirectory and pkg-config. Tests that CMake builds are tried too: the short ones.
# usage: sh tests/package.sh DIRECTORY      (for builds and installs; emptied)
#     CC  the compiler (cc)      JOBS  how many at a time (2)
set -u
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd) || exit 2
[ $# -eq 1 ] || { echo "usage: $0 DIRECTORY" >&2; exit 2; }
mkdir -p "$1" && work=$(CDPATH= cd -- "$1" && pwd) || exit 2
rm -rf "${work:?}"/*
CC=${CC:-cc}
export CC
jobs=${JOBS:-2}
version=$(awk '/^#define GXFEM_VERSION_(MAJOR|MINOR|PATCH) / { v = v dot $3; dot = "." } END { print v }' "$root/gxfem.h")
passed=0
failed=0

has() { command -v "$1" >/dev/null 2>&1; }

# try NAME COMMAND...: the command must succeed; if it does not, the end of what it said is shown
try() {
    name=$1
    shift
    if "$@" >"$work/log" 2>&1; then passed=$((passed + 1)); else
        failed=$((failed + 1))
        echo "FAILED $name"
        tail -n 20 "$work/log" | sed 's/^/  /'
    fi
}

# says PROGRAM...: the consumer prints the version, and has cut
says() { "$@" | grep -Fx "gxfem $version, 2 fragments"; }

# consumer FOLDER CMAKE-ARGUMENTS...: configures, builds and runs the program of tests/package
consumer() {
    folder=$work/$1
    shift
    cmake -S "$root/tests/package" -B "$folder" "$@" && cmake --build "$folder" -j "$jobs" && says "$folder/consumer"
}

# by_pkg_config PREFIX: the same by pkg-config alone
by_pkg_config() {
    PKG_CONFIG_PATH=$1/share/pkgconfig
    export PKG_CONFIG_PATH
    [ "$(pkg-config --modversion gxfem)" = "$version" ] || { echo "version: $(pkg-config --modversion gxfem)"; return 1; }
    # shellcheck disable=SC2046
    $CC $(pkg-config --cflags gxfem) "$root/tests/package/consumer.c" $(pkg-config --libs gxfem) -o "$1/consumer" && says "$1/consumer"
}

# holds PREFIX: the four headers are there, and are ours
holds() {
    for header in gxfem gxfem_boolean gxfem_integrate gxfem_solve; do
        cmp "$root/$header.h" "$1/include/$header.h" || return 1
    done
}

# The tests that CMake builds, without those that take long
short_tests() {
    targets="embed two_units"
    if cmake --build "$work/build" --target help | grep -q test_recipes; then targets="$targets test_recipes"; fi
    # shellcheck disable=SC2086
    cmake --build "$work/build" -j "$jobs" --target $targets || return 1
    (cd "$work/build" && ctest --output-on-failure -R "^($(echo "$targets" | tr ' ' '|'))\$")
}

if has cmake; then
    prefix=$work/by_cmake
    try "cmake configures" cmake -S "$root" -B "$work/build" -DCMAKE_BUILD_TYPE=Debug -DCMAKE_INSTALL_PREFIX="$prefix"
    try "cmake's short tests" short_tests
    try "cmake installs" cmake -P "$work/build/cmake_install.cmake"
    try "cmake installs the headers" holds "$prefix"
    try "find_package" consumer find_package -DCMAKE_PREFIX_PATH="$prefix" -DGXFEM_WANTED="${version%.*}"
    try "add_subdirectory" consumer add_subdirectory -DGXFEM_SOURCE="$root"
    if has pkg-config; then try "pkg-config, installed by cmake" by_pkg_config "$prefix"; fi
else
    echo "no cmake here: find_package, add_subdirectory and cmake's tests are left out"
fi

prefix=$work/by_make
try "make install" make -s -C "$root" install PREFIX="$prefix"
try "make install copies the headers" holds "$prefix"
if has pkg-config; then
    try "pkg-config, installed by make" by_pkg_config "$prefix"
else
    echo "no pkg-config here: left out"
fi
try "make install into a stage" make -s -C "$root" install PREFIX=/usr DESTDIR="$work/stage"
try "make install into a stage copies the headers" holds "$work/stage/usr"
try "a stage is not named in gxfem.pc" grep -qx 'prefix=/usr' "$work/stage/usr/share/pkgconfig/gxfem.pc"

echo "package: $passed passed, $failed failed"
[ $failed -eq 0 ]
