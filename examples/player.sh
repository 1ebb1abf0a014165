#!/bin/sh
# Makes player.h from player.html, player.css and player.js: the page as C strings, in two arrays, around the place of the frames.
# usage: sh examples/player.sh HTML CSS JS >HEADER
set -u
[ $# -eq 3 ] || { echo "usage: $0 HTML CSS JS" >&2; exit 2; }
awk -v style="$2" -v script="$3" '
    function put_file(tag, file,    got, line) {
        put("<" tag ">")
        while ((got = (getline line <file)) > 0) put(line)
        if (got < 0) exit 1
        put("</" tag ">")
    }
    function put(line) { gsub(/\\/, "&&", line); gsub(/"/, "\\\\&", line); print "    \"" line "\\n\"," }
    BEGIN {
        print "/* Made from player.html, player.css and player.js by player.sh: change those instead. */"
        print "#ifndef GXIO_PLAYER_H\n#define GXIO_PLAYER_H\n\n/* clang-format off */"
        print "/* Lines of the page above its frames, then those below; NULL ends each. */"
        print "static const char *const gxio_player_top[] = {"
    }
    /^<link rel="stylesheet" href="player.css">$/ { put_file("style", style); next }
    /^<script src="player.js"><\/script>$/ { put_file("script", script); next }
    { put($0) }
    /^<script id="frames"/ { print "    0};\nstatic const char *const gxio_player_end[] = {" }
    END { print "    0};\n/* clang-format on */\n\n#endif /* GXIO_PLAYER_H */" }' "$1"
