# gxfem: everything is built in build/; the library itself needs no building. `make help` lists what there is.
#
# CC, CFLAGS, LDFLAGS, JOBS and BUILD may be given on the command line: make check CC=clang BUILD=build/clang. So may a bench's
# flags and options: make bench-solver BUILD=build/o2 BENCH_CFLAGS=-O2 BENCH=--small. BUILD= keeps tables and programs of other flags.

CC ?= cc
CFLAGS ?= -O2
WARNINGS = -Wall -Wextra
BUILD ?= build
JOBS ?= 2
BENCH_CFLAGS ?= -O3 -march=native

headers = gxfem.h gxfem_boolean.h gxfem_integrate.h gxfem_solve.h
# The largest first, since they take longest. Those of which a part runs again, test_tight and test_tight_boolean, are short to read only.
tests := $(patsubst tests/%.c,%,$(wildcard tests/test_tight*.c) $(shell ls -S tests/test_*.c | grep -v test_tight))
# Compiling a header takes most of a test's time. So those tests that begin with the implementation of a header are compiled together:
# two programs for gxfem.h, one for each of two others. Each still has a program of its own, for one who works on it.
hash := \#
beginning = $(shell awk '/^$(hash)/ { n = ++lines[FILENAME] } n == 1 && /^$(hash)define GXFEM/ { first = FILENAME } \
    n == 2 && first == FILENAME && $$0 == "$(hash)include \"../$1\"" { print FILENAME; first = "" }' $(tests:%=tests/%.c))
of_gxfem := $(filter-out tests/test_baselines.c,$(call beginning,gxfem.h))
members_1 := $(shell printf '%s\n' $(of_gxfem) | awk 'NR % 2')
members_2 := $(filter-out $(members_1),$(of_gxfem))
members_solve := $(call beginning,gxfem_solve.h)
members_boolean := $(call beginning,gxfem_boolean.h)
together := $(foreach group,1 2 solve boolean,$(if $(members_$(group)),together_$(group)))
programs := $(together) $(filter-out $(patsubst tests/%.c,%,$(of_gxfem) $(members_solve) $(members_boolean)),$(tests))
linked_tests = $(patsubst tests/%.c,%,$(shell grep -l GXFEM_LINKED tests/test_*.c))
examples = $(patsubst examples/%.c,%,$(sort $(wildcard examples/*.c)))
scenes = $(filter-out embed gxcut gxboolean,$(examples))
linked_examples = $(filter-out embed,$(examples))
compile = $(CC) -std=c99 -g $(WARNINGS) $(CFLAGS)
linked = $(compile) -DGXFEM_LINKED
# No frame of the library is larger than 16 kB; a sanitizer's are.
small_frames = $(if $(findstring sanitize,$(CFLAGS)),,$(if $(findstring clang,$(CC)),-Wframe-larger-than=16384 \
    -Werror=frame-larger-than,-Werror=frame-larger-than=16384))
# Nothing is inlined, as compiling takes most of the tests' time. Checks of pointers' arithmetic would take as long again; what goes
# beyond an array is found where it is used.
sanitizers = -O1 -fno-inline -g1 -fsanitize=address,undefined -fno-sanitize=pointer-overflow -fno-sanitize-recover=all

help:
	@echo "make demo        cuts a cube of 5 tetrahedra into 36 sticks, simulates it, writes a page that plays it (needs a C compiler only)"
	@echo "make check-page  opens the demo's page in headless Chromium; installs Chromium and node where they are missing"
	@echo "make check       builds and runs the tests; installs Check and pkg-config where they are missing"
	@echo "make check-all   check, then lint, compile tests, sanitizers, compilers, flags, platforms and pages; takes longer"
	@echo "make examples    builds $(examples) in $(BUILD)/"
	@echo "make scenes      runs the scenes, writes docs/SCENES.md; SMALL=1: small ones, $(BUILD)/scenes/SCENES.md"
	@echo "make pictures    renders the scenes into docs/pictures/; installs f3d and a virtual display where they are missing;"
	@echo "                 PICTURES=: of these scenes only"
	@echo "make animation   pictures of the page on which one slices: the README's, docs/pictures/cut.webp, and page_*.png;"
	@echo "                 installs Chromium, node and img2webp"
	@echo "make lint        house rules of the four headers"
	@echo "make format      lays out all C files by .clang-format; installs clang-format where it is missing"
	@echo "make compile     the headers by every compiler and standard there is, C and C++"
	@echo "make sanitize    the tests under AddressSanitizer and UndefinedBehaviorSanitizer"
	@echo "make check-settled  the tests with bodies that give back memory at every cut, not once in thousands; TESTS=: these only"
	@echo "make fuzz        random cases, checked by properties of any input; SEED=, CASES=, SECONDS= (0: no limit)"
	@echo "make fuzz-blade  the same for blades in bodies that move"
	@echo "make flags       exact predicates against rationals under each compiler and set of flags"
	@echo "make hashes      the same cuts give the same topology under each compiler and set of flags"
	@echo "make check-wasm  cuts, Booleans and random cases as WebAssembly, run by node, beside the native build; installs clang's"
	@echo "                 parts for it and node where they are missing"
	@echo "make platforms   the same on Windows (by wine), ARM and S/390 (by qemu), and by the rules of Microsoft's compiler; installs"
	@echo "                 cross compilers and emulators where they are missing; CASES=100000: more random cases"
	@echo "make bench       all benches anew (half an hour), then charts; BENCH=--small: minutes, and docs/ stays as it is"
	@echo "make charts      docs/charts/, docs/BENCH.md, tables in README.md from what benches have measured; runs those"
	@echo "                 that have not; installs gnuplot"
	@echo "make page-blade  their chart and sections of blades alone, from make bench-blade bench-strokes"
	@echo "make page-shapes  that of shapes, from make bench-shapes; make page-web, page-intrinsics: likewise"
	@echo "make bench-NAME  one bench: CSV on stdout and in $(BUILD)/bench/, a table on stderr"
	@echo "  quadrature     integrals over parts of cut elements beside RXFEM, adaptive and regular sampling"
	@echo "  stepping       error of the motion against time, over all settings; other methods"
	@echo "  front          time to reach an error beside local solvers that games use, XPBD and VBD, by size and stiffness"
	@echo "  space          the same cuts under refinement beside conforming meshes: locking of thin slices"
	@echo "  thin           slices thinner than their elements, with affine copies and without: how far they bend, iterations, time"
	@echo "  shapes         bodies carved out of a grid beside meshes that fit: how they bend and swing, steps; making them; exactness;"
	@echo "                 MODELS=\"FILE ...\": of these surfaces too"
	@echo "  table2         scenes of GXFEM's Table 2 by RXFEM, virtual nodes and the literal Algorithm 1 too"
	@echo "  conditioning   RXFEM's Fig. 14, and a corner piece"
	@echo "  failure        hard cases: which method is right, wrong, refuses, diverges, crashes"
	@echo "  scaling        cost of a cut and a step, memory and unknowns against elements, cuts and triangles; MESH=FILE: that body too"
	@echo "  kernel         Booleans of closed surfaces; DATA=FOLDER: also of the OFF files there"
	@echo "  open           workloads like the Open Boolean Benchmark's beside manifold and CGAL; LIMIT=, RUNNERS=; installs CGAL and npm"
	@echo "  smallest       the smallest program with the kernel: time to compile and size, with and without GXFEM_STATIC"
	@echo "  solver         time steps by preconditioner, beside CHOLMOD (installs SuiteSparse where it is missing)"
	@echo "  violent        starts at which Newton's method is known to fail: inverted, flattened, collapsed bodies"
	@echo "  accuracy       static solutions beside closed forms and published values"
	@echo "  drift          what integrators conserve: energy, momenta; their order"
	@echo "  contact        pieces that press on each other: against closed forms; what a step with contact costs"
	@echo "  soak           100,000 steps of bodies that are cut, kicked and dropped: does a copy run away?"
	@echo "  frames         frames with a cut beside frames without one"
	@echo "  web            the page's jelly as WebAssembly, in node and in Chromium, beside native builds"
	@echo "  intrinsics     steps, contact, cuts and Booleans by intrinsics beside the compiler's own vectors, and by neither"
	@echo "  skin           the visual surface: moved in each frame, updated after a cut"
	@echo "  blade          blades in space through bodies that move: pieces, distance to known sheets, cost"
	@echo "  strokes        thousands of strokes that take material: memory and time beside a body cut at once"
	@echo "make amalgam     $(BUILD)/gxfem_all.h: the four headers in one"
	@echo "make check-amalgam  compile tests of that header"
	@echo "make install     the headers and gxfem.pc, for pkg-config; PREFIX=/usr/local, DESTDIR= (a stage)"
	@echo "make check-package  installs into $(BUILD)/package and uses that: by CMake, if it is there, and by pkg-config"
	@echo "make web         a page on which one slices a jelly, in $(BUILD)/web; any file server shows it (needs clang's parts for WebAssembly)"
	@echo "make check-web   opens it in headless Chromium: slices, pulls, undoes; installs Chromium and node where they are missing"
	@echo "make lib         a shared library of all that is public, $(library); docs/EMBEDDING.md says what for"
	@echo "make bindings    what other languages declare of it, out of the headers: Python, C#, tests/bindings/abi.txt (needs python3)"
	@echo "make check-bindings  tests these; installs numpy and mono's C# compiler where they are missing"
	@echo "make coverage    lines and branches of the headers that make check reaches: $(BUILD)/coverage/; needs gcc and gcov;"
	@echo "                 tests/unreached.txt says why others are not"
	@echo "make clean       removes $(BUILD)/"

# ---- programs

examples: $(examples:%=$(BUILD)/%)

$(BUILD)/%: examples/%.c $(headers) $(wildcard examples/*.h)
	@mkdir -p $(@D)
	$(compile) -I. $< -o $@ $(LDFLAGS) -lm

# All but embed share one object with the library's implementation; each also compiles on its own.
$(linked_examples:%=$(BUILD)/%): $(BUILD)/%: examples/%.c $(BUILD)/gxfem.o $(headers) $(wildcard examples/*.h)
	$(linked) -I. $< $(BUILD)/gxfem.o -o $@ $(LDFLAGS) -lm

$(BUILD)/gxfem.o: $(headers)
	@mkdir -p $(@D)
	printf '#define GXFEM_IMPLEMENTATION\n#include "gxfem.h"\n' | $(compile) $(small_frames) -I. -x c -c - -o $@

# The page that plays frames, as C. It is committed, so that examples need nothing but a C compiler.
examples/player.h: examples/player.html examples/player.css examples/player.js examples/player.sh
	sh examples/player.sh examples/player.html examples/player.css examples/player.js >$@.part && mv $@.part $@

# Sticks along z: five planes across x, five across y. The foot of the cube is held in its stretched place; the rest springs back.
sixths = 0.16666666666666666 0.33333333333333331 0.5 0.66666666666666663 0.83333333333333337
demo_cuts = $(foreach i,$(sixths),--sheet plane:$(i),0.5,0.5,1,0,0) $(foreach i,$(sixths),--sheet plane:0.5,$(i),0.5,0,1,0)

demo_run = $(BUILD)/demo/gxcut cube5 $(demo_cuts) --fix 'z<0.001' --stretch 1.5,1.5,1.5 --young 1e5 --dt 0.01 --frames 60

# The demo's own program, all in one and less optimised: who tries it waits for the compiler.
$(BUILD)/demo/gxcut: examples/gxcut.c $(headers) $(wildcard examples/*.h)
	@echo "Compiles the library and examples/gxcut.c into $@: about ten seconds."
	@mkdir -p $(@D)
	@$(CC) -std=c99 $(WARNINGS) -O1 -DGXFEM_STATIC -I. $< -o $@ $(LDFLAGS) -lm

demo: $(BUILD)/demo/gxcut
	@echo "Cuts a cube of five tetrahedra by 5 + 5 crossing planes into 36 sticks, stretches it, holds its foot, lets go."
	@$(demo_run) --out $(BUILD)/demo --report $(BUILD)/demo.json
	@$(demo_run) --quiet --format html --out $(BUILD)/demo/demo.html
	@echo "look      open $(BUILD)/demo/demo.html in a browser"

check-page: demo
	@if sh tests/install.sh page; then node tests/check_page.mjs $(BUILD)/demo/demo.html 36 $(BUILD)/check-page; \
	else echo "left out: no chromium"; fi

# ---- the page on which one slices a jelly

web_files = index.html page.js worker.js player.css player.js jelly.wasm jelly-simd.wasm
web: $(web_files:%=$(BUILD)/web/%)
	@echo "look      serve $(BUILD)/web, for example: python3 -m http.server -d $(BUILD)/web"

# What the page loads has no comments, but for those within a line, no empty lines and no indents.
bare = awk '!inside { sub(/^ +/, ""); sub(/ *\/\*[^*]*\*\/ *$$/, "") } !inside && /^ *\/\*/ { inside = 1 } !inside && NF; inside && /\*\/ *$$/ { inside = 0 }'

$(BUILD)/web/%: examples/web/%
	@mkdir -p $(@D)
	@$(bare) $< >$@

$(BUILD)/web/player.css $(BUILD)/web/player.js: $(BUILD)/web/%: examples/%
	@mkdir -p $(@D)
	@$(bare) $< >$@

# From clang 16 on vectors are right (gxfem_boolean.h): a step then takes two thirds of the time. Sizes and times are those of
# instructions that all browsers have had since 2021, of an instruction in place of a call for a square root, and of indices without
# padding.
newest_clang = $(shell for c in clang-21 clang-20 clang-19 clang-18 clang-17 clang-16 clang; do command -v $$c >/dev/null && echo $$c && break; done)
web_target = $(or $(CLANG),$(newest_clang)) --target=wasm32-wasi --sysroot=$(or $(SYSROOT),/usr)
web_clang = $(web_target) -std=c99 -Os $(WARNINGS) -I. \
    -fno-math-errno -mbulk-memory -mnontrapping-fptoint -msign-ext
web_link = -mexec-model=reactor -Wl,-z,stack-size=65536 -Wl,--stack-first -Wl,--strip-all,--compress-relocations -lm
# Linked by a command of its own: with -Os there, clang would run Binaryen's wasm-opt where it is installed, which makes steps slower.
$(BUILD)/web/jelly.wasm: web_vectors =
$(BUILD)/web/jelly-simd.wasm: web_vectors = -msimd128
$(BUILD)/web/jelly.wasm $(BUILD)/web/jelly-simd.wasm: examples/web/jelly.c examples/gxshape.h $(headers)
	@sh tests/install.sh web || sh tests/install.sh wasm
	@mkdir -p $(@D)
	$(web_clang) $(web_vectors) -c $< -o $(@:.wasm=.o)
	$(web_target) $(@:.wasm=.o) -o $@ $(web_link) && rm -f $(@:.wasm=.o)

check-web: web
	@if sh tests/install.sh page; then node tests/check_web.mjs $(BUILD)/web $(BUILD)/check-web; else echo "left out: no chromium"; fi

# ---- the shared library, and what other languages see of it

target := $(shell $(CC) -dumpmachine 2>/dev/null)
windows_target = $(or $(findstring mingw,$(target)),$(findstring windows,$(target)))
library = $(BUILD)/$(if $(windows_target),gxfem.dll,$(if $(findstring darwin,$(target)),libgxfem.dylib,libgxfem.so))
exported = $(if $(windows_target),__declspec(dllexport),__attribute__((visibility("default"))))

lib: $(library)

$(library): $(headers)
	@mkdir -p $(@D)
	printf '#define GXFEM_API $(exported)\n#define GXFEM_IMPLEMENTATION\n#include "gxfem.h"\n' | \
	    $(compile) -shared $(if $(windows_target),,-fPIC -fvisibility=hidden) -I. -x c - -o $@ $(LDFLAGS) -lm

bindings:
	@for kind in abi:tests/bindings/abi.txt python:examples/python/gxfem_declarations.py csharp:examples/csharp/Gxfem.cs; do \
	    sh examples/python/declare.sh $${kind%%:*} >$${kind#*:}.part && mv $${kind#*:}.part $${kind#*:} || exit 1; done

check-bindings: lib
	@sh tests/install.sh bindings || true
	@CC="$(CC)" sh tests/bindings.sh $(BUILD) $(library)

# ---- scenes. Without gnuplot only the chart is missing.

scenes: $(scenes:%=$(BUILD)/%)
	$(if $(SMALL),,@sh tests/install.sh charts || true)
	@CC="$(CC)" CFLAGS="$(CFLAGS)" sh examples/scenes.sh $(BUILD) $(if $(SMALL),$(BUILD)/scenes/SCENES.md --small,docs/SCENES.md) -- $(scenes)

pictures: $(patsubst %,$(BUILD)/%,$(or $(PICTURES),$(scenes)))
	@sh tests/install.sh pictures
	@sh examples/pictures.sh $(BUILD) docs/pictures $(PICTURES)

# The page on which one slices, recorded
animation: web
	@sh tests/install.sh animation
	@node examples/animation.mjs $(BUILD)/web $(BUILD)/frames docs/pictures

# ---- tests. Each runs in processes of its own (Check forks), so that a crash is one failed test.

check:
	@sh tests/install.sh check
	@$(MAKE) --no-print-directory -k -j$(JOBS) check-programs

check-programs: $(programs:%=run-%) run-gxcut run-gxboolean run-corpus

run-gxcut run-gxboolean: run-%: $(BUILD)/%
	@sh tests/test_$*.sh $(BUILD)/$*

# Cases that once failed, and a few of each kind
run-corpus: $(BUILD)/fuzz/fuzz $(BUILD)/fuzz_blade/fuzz
	@$(BUILD)/fuzz/fuzz tests/corpus/*
	@$(BUILD)/fuzz_blade/fuzz tests/corpus_blade/*

$(sort $(programs:%=run-%) $(tests:%=run-%)): run-%: $(BUILD)/tests/%
	@$< >$<.log 2>&1; code=$$?; cat $<.log; exit $$code

# Check's assertions do not tell compilers that a failed test goes no further.
test_flags = -Itests -Wno-unknown-warning-option -Wno-maybe-uninitialized $(shell pkg-config --cflags check)

# GXFEM_STATIC leaves out what a test does not call: compiling takes most of the tests' time.
$(BUILD)/tests/%: tests/%.c $(headers) $(wildcard tests/*.h examples/*.h bench/*.h)
	@mkdir -p $(@D)
	$(compile) -DGXFEM_STATIC $(test_flags) $< -o $@ $(LDFLAGS) $(shell pkg-config --libs check) -lm

$(BUILD)/tests/together_%.c: FORCE
	@mkdir -p $(@D)
	@awk -f tests/together.awk $(members_$*) >$@.new
	@if cmp -s $@.new $@; then rm $@.new; else mv $@.new $@; fi

# Without inlining, clang 14 reports temporary structs of exact numbers as used out of their scope.
$(together:%=$(BUILD)/tests/%): %: %.c $(headers) $(wildcard tests/*.c tests/*.h examples/*.h bench/*.h)
	$(compile) $(if $(findstring sanitize,$(CFLAGS)),-fno-sanitize-address-use-after-scope) -DGXFEM_STATIC -I. $(test_flags) $< -o $@ $(LDFLAGS) $(shell pkg-config --libs check) -lm

# Tests that need only the interface contain GXFEM_LINKED. They share the object of the examples.
$(linked_tests:%=$(BUILD)/tests/%): $(BUILD)/tests/%: tests/%.c $(BUILD)/gxfem.o $(headers) $(wildcard tests/*.h examples/*.h bench/*.h)
	@mkdir -p $(@D)
	$(linked) $(test_flags) $< $(BUILD)/gxfem.o -o $@ $(LDFLAGS) $(shell pkg-config --libs check) -lm

$(BUILD)/tests/test_tight: tests/test_memory.c
$(BUILD)/tests/test_tight_boolean: tests/test_surface_boolean.c

# The recipes' test includes the snippets of the page.
$(BUILD)/tests/test_recipes: $(BUILD)/recipes.h
$(BUILD)/tests/test_recipes: compile += -I$(BUILD) -DRECIPES_FOLDER='"$(BUILD)"' -pthread
$(BUILD)/tests/test_stack: compile += -pthread
$(BUILD)/recipes.h: docs/RECIPES.md tests/recipes.awk
	@mkdir -p $(@D)
	awk -f tests/recipes.awk $< >$@

# All tests except those of the benches' baselines
sanitize:
	@sh tests/install.sh check
	@CK_TIMEOUT_MULTIPLIER=10 $(MAKE) --no-print-directory -k -j$(JOBS) check-programs BUILD=$(BUILD)/sanitize CFLAGS="$(sanitizers)" \
	    tests="$(filter-out test_baselines,$(tests))"

# Every cut compacts, but for complexes of which a test wants to know the numbers later.
settles = -O1 '-DGXBP_IS_SPARSE(sparse)=((sparse)||cx->settled<UINT64_MAX/8)'
check-settled:
	@sh tests/install.sh check
	@$(MAKE) --no-print-directory -k -j$(JOBS) $(or $(TESTS:%=run-%),check-programs) BUILD=$(BUILD)/settled CFLAGS="$(settles)" \
	    tests="$(filter-out test_baselines,$(tests))"

# All but the longest
sanitize-scenes:
	@$(MAKE) --no-print-directory -j$(JOBS) scenes SMALL=1 BUILD=$(BUILD)/sanitize CFLAGS="$(sanitizers)" scenes="$(filter-out trainer pile sausage ribbon,$(scenes))"

# By libFuzzer (with sanitizers) if clang has it, starting from the corpus, for SECONDS. Otherwise, or with SEED or CASES, a loop over
# seeds.
# A case that fails is written to $(BUILD)/fuzz or $(BUILD)/fuzz_blade and replays by itself: $(BUILD)/fuzz/fuzz FILE.
SECONDS = 60
libfuzzer = clang -std=c99 -O1 -g -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=all -DFUZZ_LIBFUZZER
fuzz: source = fuzz
fuzz-blade: source = fuzz_blade
fuzz: corpus = corpus
fuzz-blade: corpus = corpus_blade
fuzz: longest = 128
fuzz-blade: longest = 400
fuzz fuzz-blade: folder = $(BUILD)/$(source)
fuzz: $(BUILD)/fuzz/fuzz
fuzz-blade: $(BUILD)/fuzz_blade/fuzz
fuzz fuzz-blade:
	@if [ -z "$(SEED)$(CASES)" ] && $(libfuzzer) tests/$(source).c -o $(folder)/libfuzzer -lm 2>/dev/null; then \
	    mkdir -p $(folder)/corpus && $(folder)/libfuzzer -max_total_time=$(SECONDS) -max_len=$(longest) -artifact_prefix=$(folder)/ $(folder)/corpus tests/$(corpus); \
	else $< --out=$(folder) --seed=$(or $(SEED),1) --cases=$(or $(CASES),0) --seconds=$(if $(CASES),0,$(SECONDS)); fi

$(BUILD)/fuzz/fuzz: tests/fuzz.c tests/fuzz.h tests/scarce.h tests/case_bytes.h tests/fuzz_cases.h tests/boolean_oracle.h tests/oracle.h tests/rational.h gxfem_boolean.h
	@mkdir -p $(@D)
	$(compile) -g $< -o $@ $(LDFLAGS) -lm

$(BUILD)/fuzz_blade/fuzz: tests/fuzz_blade.c tests/fuzz.h tests/scarce.h tests/case_bytes.h tests/fuzz_blade_cases.h tests/skin_check.h $(BUILD)/gxfem.o
	@mkdir -p $(@D)
	$(linked) $< $(BUILD)/gxfem.o -o $@ $(LDFLAGS) -lm

compile:
	@sh tests/compile.sh $(BUILD)/compile

# ---- what others adopt: one header of the four, files in their places. Headers that include only that one stand in for the four in tests.

# The version is written once, in the headers.
version = $(shell awk '/^.define GXFEM_VERSION_(MAJOR|MINOR|PATCH) / { v = v dot $$3; dot = "." } END { print v }' gxfem.h)

amalgam: $(BUILD)/gxfem_all.h

# Lower headers first, as each includes those. Of the shared block the first copy stays.
$(BUILD)/gxfem_all.h: gxfem_boolean.h gxfem_integrate.h gxfem_solve.h gxfem.h
	@mkdir -p $(@D)
	@{ echo '/* SPDX-License-Identifier: MIT */'; \
	    echo '/* gxfem_all.h - the headers of gxfem $(version) in one. Made by "make amalgam"; include it in their place. */'; \
	    awk '/^\/\* >>shared:/ { skip = shared++ } \
	        !skip && !/^#include "gxfem/; \
	        /^#endif \/\* GXFEM_SHARED_INCLUDED/ { skip = 0 }' $^; } >$@

check-amalgam: amalgam
	@mkdir -p $(BUILD)/amalgam
	@for header in $(headers); do echo '#include "../gxfem_all.h"' >$(BUILD)/amalgam/$$header; done
	@JOBS=$(JOBS) COMPILERS="$(COMPILERS)" STANDARDS="$(or $(STANDARDS),c99 c17 c++11 c++17)" sh tests/compile.sh $(BUILD)/compile_amalgam $(BUILD)/amalgam

PREFIX ?= /usr/local
install:
	@mkdir -p $(DESTDIR)$(PREFIX)/include $(DESTDIR)$(PREFIX)/share/pkgconfig
	cp $(headers) $(DESTDIR)$(PREFIX)/include/
	sed 's|@PREFIX@|$(PREFIX)|; s|@INCLUDEDIR@|$(PREFIX)/include|; s|@VERSION@|$(version)|' gxfem.pc.in \
	    >$(DESTDIR)$(PREFIX)/share/pkgconfig/gxfem.pc

check-package:
	@JOBS=$(JOBS) CC="$(CC)" sh tests/package.sh $(BUILD)/package

# Without optimisation, and nothing is inlined by force, so that each branch of the source is one of the program; counts are added
# atomically, as threads count too.
coverage:
	@sh tests/install.sh check
	@mkdir -p $(BUILD)/coverage && find $(BUILD)/coverage -name '*.gcda' -exec rm -f {} +
	@CK_TIMEOUT_MULTIPLIER=20 $(MAKE) --no-print-directory -k -j$(JOBS) check-programs CC=gcc BUILD=$(BUILD)/coverage \
	    CFLAGS="-O0 -Dalways_inline=unused --coverage -fprofile-update=prefer-atomic" >$(BUILD)/coverage/check.log 2>&1 || \
	    { grep -E 'FAILED|:[FE]:|error' $(BUILD)/coverage/check.log; echo "tests fail: $(BUILD)/coverage/check.log"; exit 1; }
	@sh tests/coverage.sh $(BUILD)/coverage

lint:
	@sh tests/lint.sh
	@sh tests/test_lint.sh
	@sh tests/test_coverage.sh

# By clang-format 14; other versions differ in details. Tables between "clang-format off" and "on" stay as they are.
formatted = $(headers) $(wildcard examples/*.[ch] tests/*.[ch] tests/compile/*.[ch] tests/compile/*.cc tests/package/*.c bench/*.[ch])
format:
	@sh tests/install.sh format
	@clang-format -i $(formatted)

formatted:
	@echo $(formatted)

flags:
	@JOBS=$(JOBS) FEWER=$(FEWER) sh tests/flags.sh

hashes:
	@JOBS=$(JOBS) FEWER=$(FEWER) sh tests/hashes.sh $(BUILD)/hashes

# What of it cannot be installed is left out.
platforms:
	@sh tests/install.sh platforms || true
	@JOBS=$(JOBS) CC="$(CC)" sh tests/platforms.sh $(BUILD)/platforms

check-wasm:
	@sh tests/install.sh wasm
	@JOBS=$(JOBS) sh tests/wasm.sh $(BUILD)/wasm

# ---- benches. Only their CSV goes to stdout. BENCH=--small: smaller ones, with a folder of their own for tables and charts

benches = quadrature stepping front space thin shapes table2 conditioning failure scaling kernel open smallest solver violent accuracy drift frames skin web blade strokes contact soak intrinsics
small = $(filter --small,$(BENCH))
tables = $(BUILD)/bench$(if $(small),/small)
# The compiler's own default: with -std=c99 gcc fuses no multiplications with additions, whatever -march says.
bench_standard = -std=gnu99
traces = $(tables)/traces

bench_programs = $(patsubst %,$(BUILD)/bench/%,$(filter-out smallest,$(benches)))
bench-programs: $(bench_programs)

$(filter-out %/solver,$(bench_programs)): $(BUILD)/bench/%: bench/%.c $(wildcard bench/*.h) $(headers)
	@mkdir -p $(@D)
	@$(CC) $(bench_standard) $(WARNINGS) $(BENCH_CFLAGS) -pthread $< -o $@ $(LDFLAGS) -lm

$(BUILD)/bench/space $(BUILD)/bench/thin $(BUILD)/bench/scaling $(BUILD)/bench/open $(BUILD)/bench/shapes: examples/gxio.h examples/gxjson.h
$(BUILD)/bench/shapes: examples/gxshape.h tests/models.h tests/cell_moments.h tests/workloads.h tests/oracle.h tests/rational.h
$(BUILD)/bench/kernel: tests/operand.h tests/workloads.h tests/oracle.h tests/rational.h

$(BUILD)/bench/solver: bench/solver.c $(wildcard bench/*.h) $(headers)
	@mkdir -p $(@D)
	@$(CC) $(bench_standard) $(WARNINGS) $(BENCH_CFLAGS) -pthread $(shell pkg-config --cflags CHOLMOD 2>/dev/null) $< -o $@ $(LDFLAGS) \
	    $(shell pkg-config --libs CHOLMOD 2>/dev/null || echo -lcholmod) -lm

# Frames are measured as users build: their table stands in the README.
$(BUILD)/bench/frames $(BUILD)/bench/web $(BUILD)/bench/blade $(BUILD)/bench/strokes $(BUILD)/bench/intrinsics: BENCH_CFLAGS = -O2

bench-solver:
	@sh tests/install.sh bench >&2
	@$(MAKE) --no-print-directory $(BUILD)/bench/solver >&2
	@mkdir -p $(tables)
	@$(BUILD)/bench/solver --out $(tables) $(BENCH)

bench-kernel: $(BUILD)/bench/kernel
	@mkdir -p $(tables)
	@$< $(tables)/kernel.csv $(DATA)

# Other kernels are optional: they need a C++ compiler, CGAL, and node with npm, or manifold known to pkg-config. RUNNERS=gxfem: none
bench-open: $(BUILD)/bench/open $(BUILD)/bench/gxboolean
	@[ -n "$(RUNNERS)" ] || sh tests/install.sh open >&2 || true
	@mkdir -p $(tables)
	@RUNNERS="$(RUNNERS)" sh bench/open.sh $(BUILD) $(tables)/open.csv $(BENCH)

$(BUILD)/bench/gxboolean: examples/gxboolean.c $(headers) $(wildcard examples/*.h)
	@mkdir -p $(@D)
	@$(CC) $(bench_standard) $(WARNINGS) $(BENCH_CFLAGS) -DGXFEM_STATIC -I. $< -o $@ $(LDFLAGS) -lm

# The page's modules beside native programs of its jelly: by CC and, where they are, by clang and with musl, the C library of the modules.
$(BUILD)/bench/web: examples/web/jelly.c examples/gxshape.h
web_clang_native = $(and $(newest_clang),$(BUILD)/bench/web_clang)
web_musl_native = $(and $(shell command -v musl-gcc),$(BUILD)/bench/web_musl)
$(BUILD)/bench/web_clang: CC = $(newest_clang)
$(BUILD)/bench/web_musl: CC = musl-gcc -static
$(BUILD)/bench/web_clang $(BUILD)/bench/web_musl: bench/web.c examples/web/jelly.c examples/gxshape.h $(wildcard bench/*.h) $(headers)
	@mkdir -p $(@D)
	@$(CC) $(bench_standard) $(WARNINGS) -O2 $< -o $@ $(LDFLAGS) -lm

bench-web:
	@sh tests/install.sh page musl >&2 || true
	@$(MAKE) --no-print-directory run-bench-web

run-bench-web: $(BUILD)/bench/web $(web_clang_native) $(web_musl_native)
	@$(MAKE) --no-print-directory web >&2
	@mkdir -p $(tables)
	@node bench/web.mjs $(tables)/web.csv $(BUILD)/web "$(shell $(CC) --version | grep -qi clang && echo clang || echo gcc) -O2=$<" \
	    $(web_clang_native:%="$(newest_clang) -O2=%") $(web_musl_native:%="gcc -O2 musl=%") $(BENCH)

# Builds of one program that differ in where vectors and wide products come from
$(BUILD)/bench/intrinsics: tests/operand.h tests/workloads.h tests/oracle.h tests/rational.h
$(BUILD)/bench/intrinsics_yes: vectors = -DGXFEM_INTRINSICS
$(BUILD)/bench/intrinsics_plain: vectors = -DGXFEM_SCALAR -U__SIZEOF_INT128__
$(BUILD)/bench/intrinsics_yes $(BUILD)/bench/intrinsics_plain: bench/intrinsics.c tests/operand.h tests/workloads.h $(wildcard bench/*.h) $(headers)
	@mkdir -p $(@D)
	@$(CC) $(bench_standard) $(WARNINGS) -O2 -Wno-unknown-pragmas $(vectors) $< -o $@ $(LDFLAGS) -lm

bench-intrinsics: $(BUILD)/bench/intrinsics $(BUILD)/bench/intrinsics_yes $(BUILD)/bench/intrinsics_plain
	@mkdir -p $(tables)
	@sh bench/intrinsics.sh $(tables)/intrinsics.csv extensions=$(BUILD)/bench/intrinsics intrinsics=$(BUILD)/bench/intrinsics_yes \
	    plain=$(BUILD)/bench/intrinsics_plain $(BENCH)

bench-smallest:
	@CC="$(CC)" sh bench/smallest.sh $(tables)

plain_benches = $(filter-out bench-solver bench-kernel bench-open bench-smallest bench-web bench-intrinsics bench-table2 bench-stepping,$(benches:%=bench-%))
$(plain_benches): bench-%: $(BUILD)/bench/%
	@mkdir -p $(tables)
	@$< $(tables)/$*.csv $(BENCH) $(if $(filter scaling,$*),$(MESH)) $(if $(filter shapes,$*),$(MODELS))

# Scenes with the frames of GXFEM's Table 2. OCTOPUS=FILE: the octopus on that mesh
table2 = sticks thin_slab accordion octopus
stepping = slab_in_five accordion
frames-sticks = 145
frames-thin_slab = 450
frames-accordion = 540
frames-octopus = 600

bench-table2:
	@$(MAKE) --no-print-directory $(BUILD)/bench/table2 $(table2:%=$(traces)/%.trace) >&2
	@$(BUILD)/bench/table2 $(tables)/table2.csv $(tables)/table2_ratios.csv $(BENCH) $(foreach s,$(table2),$(s)=$(traces)/$(s).trace)

bench-stepping:
	@$(MAKE) --no-print-directory $(BUILD)/bench/stepping $(stepping:%=$(traces)/%.trace) >&2
	@$(BUILD)/bench/stepping $(tables)/stepping.csv $(BENCH) $(foreach s,$(stepping),$(s)=$(traces)/$(s).trace)

$(sort $(table2:%=$(traces)/%.trace) $(stepping:%=$(traces)/%.trace)): $(traces)/%.trace: $(BUILD)/%
	@mkdir -p $(@D)
	@$< --quiet --trace $@ $(or $(small),$(frames-$*:%=--frames %)) $(if $(OCTOPUS),$(if $(filter octopus,$*),--mesh $(OCTOPUS)))

# The soak takes longer than all others. It has no chart, nor has contact.
charted = $(filter-out soak contact,$(benches))
bench:
	@rm -f $(charted:%=$(tables)/%.csv)
	@$(MAKE) --no-print-directory charts

# One bench after the other, since they measure. Failures are reported at the end; the tables that exist are drawn.
charts:
	@sh tests/install.sh charts >&2
	@mkdir -p $(tables) && rm -f $(tables)/failed
	@for bench in $(charted); do \
	    [ ! -s $(tables)/$$bench.csv ] || continue; \
	    echo "make bench-$$bench" >&2; \
	    $(MAKE) --no-print-directory bench-$$bench >/dev/null || echo "bench-$$bench" >>$(tables)/failed; \
	done
	@$(if $(small),cp README.md $(tables)/README.md;) \
	sh bench/charts.sh $(tables) $(if $(small),$(tables),docs)/charts && \
	sh bench/page.sh $(tables) $(if $(small),$(tables),docs)/BENCH.md $(if $(small),$(tables)/)README.md || echo charts >>$(tables)/failed
	@[ ! -e $(tables)/failed ] || { echo "failed: $$(tr '\n' ' ' <$(tables)/failed)" >&2; exit 1; }

# The section of browsers or of intrinsics alone, from a table that is there
page-web page-intrinsics: page-%:
	@sh bench/page.sh $(tables) docs/BENCH.md $*

# The chart and the sections of blades or of shapes alone, from tables that are there
page-blade page-shapes: page-%:
	@sh tests/install.sh charts >&2
	@sh bench/charts.sh $(tables) docs/charts $* && sh bench/page.sh $(tables) docs/BENCH.md $*

check-all: check
	@$(MAKE) --no-print-directory lint
	@$(MAKE) --no-print-directory examples
	@$(MAKE) --no-print-directory compile
	@$(MAKE) --no-print-directory check-amalgam
	@$(MAKE) --no-print-directory check-package
	@$(MAKE) --no-print-directory check-bindings
	@$(MAKE) --no-print-directory sanitize
	@$(MAKE) --no-print-directory sanitize-scenes
	@for cc in gcc clang; do \
	    if command -v $$cc >/dev/null; then $(MAKE) --no-print-directory check CC=$$cc BUILD=$(BUILD)/$$cc || exit 1; fi; done
	@$(MAKE) --no-print-directory flags
	@$(MAKE) --no-print-directory hashes
	@$(MAKE) --no-print-directory platforms
	@$(MAKE) --no-print-directory check-page
	@$(MAKE) --no-print-directory check-web

clean:
	rm -rf $(BUILD)

.PHONY: help web check-web lib bindings check-bindings examples demo check-page scenes pictures animation bench-programs check check-programs run-gxcut run-gxboolean run-corpus $(sort $(programs:%=run-%) $(tests:%=run-%)) FORCE sanitize sanitize-scenes check-settled compile amalgam check-amalgam install check-package coverage formatted lint format fuzz fuzz-blade flags hashes platforms check-wasm $(benches:%=bench-%) run-bench-web bench charts page-blade page-shapes page-web page-intrinsics check-all clean
