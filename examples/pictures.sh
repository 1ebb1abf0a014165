#!/bin/sh
# Renders frames of the scenes with f3d, on a virtual display where there is none.
# usage: sh examples/pictures.sh PROGRAMS DIRECTORY
#     PROGRAMS  directory of the built scenes; frames go into PROGRAMS/pictures
#     DIRECTORY of SCENE.png
set -u
[ $# -eq 2 ] || { echo "usage: $0 PROGRAMS DIRECTORY" >&2; exit 2; }
programs=$1
directory=$2
mkdir -p "$directory" "$programs/pictures" || exit 2
colors=0,0.85,0.37,0.30,0.2,0.95,0.65,0.30,0.4,0.98,0.88,0.55,0.6,0.60,0.80,0.65,0.8,0.35,0.62,0.75,1,0.36,0.40,0.65
failed=0

# on a display: COMMAND...
display() { if [ -n "${DISPLAY:-}" ]; then "$@"; else xvfb-run -a "$@"; fi; }

# picture SCENE EVERY FRAME ARRAY AZIMUTH ELEVATION: the FRAME-th of each EVERY-th frame, coloured by `fragment` or, outer surface and
# faces of cuts, by `surface`
picture() {
    echo "$1"
    rm -rf "$programs/pictures/$1"
    if [ "$4" = surface ]; then range=--range=0,1; else range=; fi
    # shellcheck disable=SC2086
    "$programs/$1" --quiet --every "$2" --out "$programs/pictures/$1" &&
    display f3d "$programs/pictures/$1/frame_$3.vtu" --output="$directory/$1.png" --resolution 640,420 --up=+Z --cells --scalars="$4" $range \
        --colormap=$colors --bg-color=1,1,1 --fxaa --ssao --camera-azimuth-angle="$5" --camera-elevation-angle="$6" --quiet && return
    echo "$1: no picture" >&2
    failed=1
}

picture sticks 25 0005 fragment 30 25
picture thin_slab 15 0005 fragment 35 15
picture swiss_cheese 3 0022 fragment 60 20
picture accordion 10 0011 surface 20 8
picture hinged_slices 20 0009 fragment 35 15
picture slab_in_five 30 0009 fragment 35 12
picture unfolding_blocks 10 0014 surface 20 8
picture helix_plate 20 0019 surface 25 22
exit $failed
