#!/bin/sh
# The interface of the headers for another language, on stdout. usage: sh declare.sh python|csharp|abi
# CC: a compiler whose -E reads the headers (cc)
here=$(CDPATH= cd -- "$(dirname -- "$0")" && pwd) || exit 2
printf '#include "%s.h"\n' gxfem gxfem_boolean gxfem_integrate gxfem_solve |
    "${CC:-cc}" -E -DGXFEM_API=GXFEM_PUBLIC -I"$here/../.." -x c - | python3 "$here/declare.py" "$1"
