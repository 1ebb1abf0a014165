/* blade.c - blades that are moved through bodies which move meanwhile (blade.h): what comes of it, how near the cut is
   to where it should be, and what it costs.

   make bench-blade builds it by -O2, as users do, and runs it. It prints CSV and writes it to build/bench/blade.csv,
   and a table to stderr. usage: blade [FILE [--small]]; --small: small blocks and few passes.

   kind        a row
   scene       a scene of blade.h on a block of 12^3 cubes
   passes      random straight passes through blocks of 4^3 cubes that move, with noise: `fragments` of them, of
               `expected`, gave exactly two pieces; bridged: gave one
   error       edges that follow known sheets, over all seeds: distance of the walls to the sheet, in cubes. tolerance
               and advance: of the blade, in cubes. calm: a tenth of a cube a frame at 60 frames, violent: a cube
   relativity  the same path by a blade through a still body, and by a body past a still blade: max_error is how far
               the section is from that of 800 frames, the mean over it, in cubes
   cost        a pass through a block that moves calmly, with 60 and 600 frames
   sample      a move that cuts nothing, with 1001 points of the edge beside 2; gx_body_locate of 1000 points there
   idle        moves far from the block beside a step
   frame       a pass by steps, 60 frames, by phase: the blade, the cuts that it makes, the solver's model, the skin and
               its positions, the step; all: all but the step
   carve       tools in a block that moves calmly

   Times are of the processor. divided: elements that strips or tools have touched, each as often as it was. leaves:
   that were added, for each of those. link: the smallest share of a face that still joins two cells. median_ms, p95_ms
   and worst_ms: of a move, in `frame` of a frame's part, in `carve` of a tool. share: of a step. ns: for each sample.
   volume_error: the largest, as a share of the volume. */
#define _POSIX_C_SOURCE 200112L
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "blade.h"
#include "clock.h"
#include "csv.h"
#include "progress.h"

enum { MOST_FRAMES = 601, SEEDS = 12, POINTS = 1001 };

typedef struct row {
    const char *kind, *name;
    size_t elements, fragments, expected, divided, bridged;
    int frames;
    double tolerance, advance;
    double leaves, us, link, deviation;
    double most, rms; /* cubes */
    double median, p95, worst, step, share;
    double ns; /* for each sample */
    double volume;
} row;

static int small;

static void fail(const char *kind, const stage *s) {
    if (stage_ok(s)) return;
    fprintf(stderr, "blade: %s: %s, %s\n", kind, gx_result_text(s->failure.result),
            s->failure.field ? s->failure.field : "no field");
    exit(1);
}

static void check(gx_result result) {
    if (result == GX_OK) return;
    fprintf(stderr, "blade: %s\n", gx_result_text(result));
    exit(1);
}

static stage open_stage(uint32_t n, uint64_t seed, double noise, const gx_blade_desc *blade) {
    stage s;
    memset(&s, 0, sizeof s);
    s.cells[0] = s.cells[1] = s.cells[2] = n;
    s.random = seed * 7919;
    s.noise = noise;
    s.clock = processor_seconds;
    stage_open(&s, 250.0 * n, 0, blade);
    fail("opening", &s);
    return s;
}

/* ---- rows ---- */

/* A value, or nothing where there is none */
static const char *number(char text[16], const char *format, double value) {
    if (value > 0)
        snprintf(text, 16, format, value);
    else
        text[0] = 0;
    return text;
}

static const char *whole(char text[16], size_t value) { return number(text, "%.0f", (double)value); }

static void print_row(const row *r) {
    char t[21][16];
    csv_row("%s,%s,%s,%s,%s,%s,%s,%s,%s,%s,%s,%s,%s,%s,%s,%s,%s,%s,%s,%s,%s,%s,%s", r->kind, r->name,
            whole(t[0], r->elements), whole(t[1], (size_t)r->frames), number(t[2], "%g", r->tolerance),
            number(t[3], "%g", r->advance), whole(t[4], r->fragments), whole(t[5], r->expected),
            whole(t[6], r->divided), number(t[7], "%.2f", r->leaves), number(t[8], "%.1f", r->us),
            number(t[9], "%.1e", r->link), number(t[10], "%.1e", r->deviation), number(t[11], "%.2e", r->most),
            number(t[12], "%.2e", r->rms), number(t[13], "%.3f", r->median), number(t[14], "%.3f", r->p95),
            number(t[15], "%.3f", r->worst), number(t[16], "%.3f", r->step), number(t[17], "%.4f", r->share),
            number(t[18], "%.0f", r->ns), number(t[19], "%.1e", r->volume), whole(t[20], r->bridged));
}

/* What the stage's moves have been; times of a move only where all were measured */
static row row_of(const char *kind, const char *name, const stage *s) {
    const stage_tally *t = &s->tally;
    row r;
    memset(&r, 0, sizeof r);
    r.kind = kind;
    r.name = name;
    r.elements = s->view.element_count;
    r.frames = (int)t->moves;
    r.fragments = s->view.fragment_count;
    r.divided = t->divided;
    r.link = t->link;
    r.deviation = t->deviation;
    r.worst = 1e3 * t->slowest;
    r.volume = t->volume;
    if (t->divided == 0) return r;
    r.us = 1e6 * t->seconds / (double)t->divided;
    r.leaves = ((double)gxb_complex_leaf_count(s->body->complex) - (double)s->view.element_count) / (double)t->divided;
    return r;
}

static void put(const row *r, const char *line, ...) {
    char text[160];
    va_list values;
    print_row(r);
    va_start(values, line);
    vsnprintf(text, sizeof text, line, values);
    va_end(values);
    progress_clear();
    fprintf(stderr, "%-10s %-13s %s\n", r->kind, r->name, text);
}

/* ---- scenes and passes ---- */

static void measure_scene(const stage_scene *scene) {
    stage s;
    row r;
    memset(&s, 0, sizeof s);
    s.random = 1;
    s.clock = processor_seconds;
    stage_play(&s, scene, small ? 6 : 12, NULL);
    fail(scene->name, &s);
    r = row_of("scene", scene->name, &s);
    r.expected = scene->fragments;
    put(&r, "%2lu of %2lu fragments, %6lu elements divided, %.2f leaves and %6.1f us each, link %.1e, deviation %.1e",
        (unsigned long)r.fragments, (unsigned long)r.expected, (unsigned long)r.divided, r.leaves, r.us, r.link,
        r.deviation);
    stage_close(&s);
}

static void measure_passes(const char *name, double noise, double squeeze, int count) {
    row r;
    size_t right = 0, bridged = 0, divided = 0, moves = 0;
    double link = 1, deviation = 0, time = 0;
    int seed;
    for (seed = 1; seed <= count; seed++) {
        stage s = open_stage(4, (uint64_t)seed, noise, NULL);
        stage_motion m = stage_random_motion(&s, STAGE_CALM);
        m.squeeze[seed % 3] = squeeze;
        stage_random_pass(&s, &m, 40);
        fail(name, &s);
        right += s.view.fragment_count == 2;
        bridged += s.view.fragment_count < 2;
        divided += s.tally.divided;
        moves += s.tally.moves;
        time += s.tally.seconds;
        link = fmin(link, s.tally.link);
        deviation = fmax(deviation, s.tally.deviation);
        if (seed == count) r = row_of("passes", name, &s);
        stage_close(&s);
        if (seed % 64 == 0) progress_draw("blade", (size_t)seed, (size_t)count, name);
    }
    r.fragments = right;
    r.expected = (size_t)count;
    r.bridged = bridged;
    r.divided = divided;
    r.frames = (int)(moves / (size_t)count);
    r.link = link;
    r.deviation = deviation;
    r.us = 1e6 * time / (double)divided;
    r.leaves = r.worst = 0;
    put(&r, "%5lu of %5lu right, %lu in one piece, link %.1e", (unsigned long)right, (unsigned long)count,
        (unsigned long)bridged, link);
}

/* ---- errors ---- */

static void measure_error(const char *name, int kind, int frames, double tolerance, double advance) {
    const int seeds = small ? 2 : SEEDS;
    gx_blade_desc desc;
    double most = 0, sum = 0, time = 0, deviation = 0, volume = 0;
    size_t right = 0, moves = 0, divided = 0;
    row r;
    int seed;
    memset(&desc, 0, sizeof desc);
    desc.tolerance = tolerance;
    desc.min_advance = advance;
    memset(&r, 0, sizeof r);
    for (seed = 1; seed <= seeds; seed++) {
        stage s = open_stage(small ? 4 : 8, (uint64_t)seed, 0, &desc);
        const stage_sheet sheet = stage_random_sheet(&s);
        const stage_motion m = stage_random_motion(&s, kind);
        double square;
        stage_follow_sheet(&s, &sheet, &m, frames);
        most = fmax(most, stage_wall_error(&s, &sheet, &square));
        fail(name, &s);
        sum += square;
        right += s.view.fragment_count == 2;
        time += s.tally.seconds;
        moves += s.tally.moves;
        divided += s.tally.divided;
        deviation = fmax(deviation, s.tally.deviation);
        volume = fmax(volume, s.tally.volume);
        if (seed == seeds) r = row_of("error", name, &s);
        stage_close(&s);
    }
    r.frames = frames;
    r.tolerance = tolerance;
    r.advance = advance;
    r.fragments = right;
    r.expected = (size_t)seeds;
    r.deviation = deviation;
    r.most = most;
    r.rms = sqrt(sum / seeds);
    r.median = 1e3 * time / (double)moves;
    r.divided = divided;
    r.us = 1e6 * time / (double)divided;
    r.volume = volume;
    r.leaves = r.link = r.worst = 0;
    put(&r,
        "%4d frames, tolerance %5g, advance %4g: off by %.1e at most, %.1e rms; %lu of %d right, %.2f ms a move, "
        "%.1f us an element",
        frames, tolerance, advance, r.most, r.rms, (unsigned long)right, seeds, r.median, r.us);
}

static void measure_errors(void) {
    static const char *const names[3] = {"calm", "swinging", "violent"};
    static const int frames[5] = {20, 40, 60, 120, 240};
    static const double tolerances[5] = {0.001, 0.003, 0.01, 0.03, 0.1}, advances[3] = {0.25, 1, 2};
    int kind, i;
    for (kind = STAGE_CALM; kind <= STAGE_VIOLENT; kind++) {
        for (i = 0; i < 5; i++)
            if (!small || frames[i] == 60) measure_error(names[kind], kind, frames[i], 0.01, 0.5);
        for (i = 0; i < 5; i++)
            if (i != 2 && (!small || i % 4 == 0)) measure_error(names[kind], kind, 60, tolerances[i], 0.5);
        for (i = 0; i < (small ? 1 : 3); i++) measure_error(names[kind], kind, 60, 0.01, advances[i]);
    }
}

/* ---- relativity ---- */

/* The volume of the larger piece, cubes */
static double larger_piece(const stage *s) {
    double most = 0;
    size_t i;
    for (i = 0; i < s->view.fragment_count; i++) most = fmax(most, s->view.fragment_volume[i]);
    return most;
}

/* Returns the volume of the larger piece. reference: that of many frames; 0: this is it, and no row is put */
static double measure_rigid_pass(uint32_t n, int body_moves, int frames, double reference) {
    stage s = open_stage(n, 1, 0, NULL);
    double piece;
    row r;
    stage_pass_rigidly(&s, body_moves, frames);
    fail("relativity", &s);
    piece = larger_piece(&s);
    if (reference > 0) {
        r = row_of("relativity", body_moves ? "body moves" : "blade moves", &s);
        r.frames = frames;
        r.expected = 2;
        r.most = fabs(piece - reference) / ((double)n * n);
        put(&r, "%4d frames: %lu of 2 fragments, %6.1f us an element, the section is off by %.1e", frames,
            (unsigned long)r.fragments, r.us, r.most);
    }
    stage_close(&s);
    return piece;
}

static void measure_relativity(uint32_t n) {
    static const int factors[4] = {1, 2, 5, 20};
    const double reference = measure_rigid_pass(n, 0, 800, 0);
    int i;
    for (i = 0; i < 8; i++) measure_rigid_pass(n, i % 2, 20 * factors[i / 2], reference);
}

/* ---- cost ---- */

/* A straight edge along y, oblique, through a block that follows a motion. times: of each move, ms */
static void pass_calmly(stage *s, int frames, double *times) {
    const stage_motion m = stage_random_motion(s, STAGE_CALM);
    const double n = s->cells[0], far = 2 + 0.11 * n; /* the block turns by up to 0.15 */
    int k;
    for (k = 0; k <= frames; k++) {
        const double share = (double)k / frames, y = -far + (n + 2 * far) * share, before = s->tally.seconds;
        stage_pose(s, &m, share);
        stage_move(s, -n, y, 0.45 * n, 2 * n, y + 0.05 * n, 0.5 * n);
        times[k] = 1e3 * (s->tally.seconds - before);
    }
    stage_lift(s);
}

static void measure_cost(uint32_t n, int frames) {
    static double times[MOST_FRAMES];
    stage s = open_stage(n, 1, 0, NULL);
    row r;
    pass_calmly(&s, frames, times);
    fail("cost", &s);
    r = row_of("cost", "pass", &s);
    r.frames = frames;
    r.expected = 2;
    r.median = median(times, (size_t)frames + 1);
    put(&r, "%7lu elements, %3d frames: %5lu divided, %.2f leaves and %6.1f us each; a move %.3f ms, worst %.3f ms",
        (unsigned long)r.elements, frames, (unsigned long)r.divided, r.leaves, r.us, r.median, r.worst);
    stage_close(&s);
}

static double step_ms(stage *s) {
    const double start = processor_seconds(NULL);
    stage_step(s, s->swing, 0, -9.8);
    return 1e3 * (processor_seconds(NULL) - start);
}

/* A blade that is moved, but far from the body */
static void measure_idle(uint32_t n) {
    enum { MOVES = 21 };
    stage s = open_stage(n, 1, 0, NULL);
    double moves[MOVES], steps[MOVES];
    row r;
    int k;
    s.swing = 6;
    for (k = 0; k < MOVES; k++) {
        const double before = s.tally.seconds;
        steps[k] = step_ms(&s);
        stage_move(&s, -9, 10.0 * n + k, 0, 9, 10.0 * n + k, 0);
        moves[k] = 1e3 * (s.tally.seconds - before);
    }
    fail("idle", &s);
    r = row_of("idle", "far", &s);
    r.fragments = 0;
    r.link = 0;
    r.median = median(moves, MOVES);
    r.step = median(steps, MOVES);
    r.share = r.median / r.step;
    put(&r, "%7lu elements: a move %.3f ms, a step %.2f ms: %.2f %%", (unsigned long)r.elements, r.median, r.step,
        100 * r.share);
    stage_close(&s);
}

/* The time of a move that cuts nothing, s: the edge stays where it is in the middle of the block. */
static double still_move(uint32_t n, size_t points) {
    enum { MOVES = 21 };
    static double edge[3 * POINTS];
    stage s = open_stage(n, 1, 0, NULL);
    double times[MOVES];
    int k;
    for (k = 0; k < 30 + MOVES; k++) {
        const double y = -1 + (k < 30 ? k : 29) * (0.5 * n + 1) / 29, before = s.tally.seconds;
        size_t i;
        for (i = 0; i < points; i++) {
            edge[3 * i] = -1 + (n + 2.0) * (double)i / (double)(points - 1);
            edge[3 * i + 1] = y;
            edge[3 * i + 2] = 0.47 * n;
        }
        stage_move_edge(&s, edge, points);
        if (k >= 30) times[k - 30] = s.tally.seconds - before;
    }
    fail("sample", &s);
    stage_close(&s);
    return median(times, MOVES);
}

/* Points in the middle of the block, located in one call: s for each */
static double locate_points(uint32_t n) {
    enum { TIMES = 21, MANY = 1000 };
    static double points[3 * MANY];
    static gx_hit hits[MANY];
    stage s = open_stage(n, 1, 0, NULL);
    const stage_motion m = stage_random_motion(&s, STAGE_CALM);
    double times[TIMES];
    int k, i;
    for (k = 0; k < TIMES; k++) {
        double start;
        for (i = 0; i < MANY; i++) {
            points[3 * i] = n * (double)i / MANY;
            points[3 * i + 1] = 0.4 * n + 0.01 * k;
            points[3 * i + 2] = 0.47 * n;
        }
        stage_pose(&s, &m, (double)k / TIMES);
        check(gx_body_locate(s.body, points, 1, hits, NULL)); /* fits the boxes to the new pose */
        start = processor_seconds(NULL);
        check(gx_body_locate(s.body, points, MANY, hits, NULL));
        times[k] = (processor_seconds(NULL) - start) / MANY;
    }
    stage_close(&s);
    return median(times, TIMES);
}

static void measure_located(uint32_t n) {
    row r;
    memset(&r, 0, sizeof r);
    r.kind = "sample";
    r.name = "located";
    r.elements = (size_t)n * n * n * 6;
    r.ns = 1e9 * locate_points(n);
    put(&r, "%7lu elements: %.0f ns for a point that is located", (unsigned long)r.elements, r.ns);
}

static void measure_sample(uint32_t n) {
    const double few = still_move(n, 2), many = still_move(n, POINTS);
    row r;
    memset(&r, 0, sizeof r);
    r.kind = "sample";
    r.name = "still";
    r.elements = (size_t)n * n * n * 6;
    r.median = 1e3 * many;
    r.ns = 1e9 * (many - few) / (POINTS - 2);
    put(&r, "%7lu elements: %.0f ns for a point of the edge", (unsigned long)r.elements, r.ns);
}

/* ---- frames ---- */

enum { FRAMES = 60 };
enum { BLADE, CUT, MODEL, SKIN, STEP, ALL, PHASES };

/* ms of a frame's phases */
typedef struct frame_times {
    double of[PHASES][FRAMES + 1];
} frame_times;

/* When a step's clock was asked */
typedef struct asked {
    uint32_t calls;
    double solver; /* s: the solver's first call */
} asked;

/* The step's clock. The body asks it first; then the solver does, when the model is up to date. */
static double step_clock(void *user) {
    asked *a = (asked *)user;
    const double now = processor_seconds(NULL);
    if (a->calls++ == 1) a->solver = now;
    return now;
}

static void swing(stage *s, frame_times *t, int frame) {
    const double start = processor_seconds(NULL);
    asked a = {0, start};
    gx_step_desc step;
    memset(&step, 0, sizeof step);
    step.dt = 0.02;
    step.gravity[0] = s->swing;
    step.gravity[2] = -9.8;
    step.clock = step_clock;
    step.clock_user = &a;
    check(gx_body_step(s->body, &step, NULL, NULL));
    t->of[MODEL][frame] = 1e3 * (a.solver - start);
    t->of[STEP][frame] = 1e3 * (processor_seconds(NULL) - a.solver);
    stage_look(s);
}

static void draw(stage *s, double **positions, frame_times *t, int frame) {
    const double start = processor_seconds(NULL);
    gx_skin skin;
    check(gx_body_skin(s->body, NULL, &skin, NULL));
    *positions = (double *)realloc(*positions, 3 * skin.vertex_count * sizeof **positions);
    if (*positions == NULL) check(GX_ERROR_MEMORY);
    check(gx_body_skin_positions(s->body, *positions, NULL));
    t->of[SKIN][frame] = 1e3 * (processor_seconds(NULL) - start);
}

static void pass_by_steps(stage *s, uint32_t n, frame_times *t) {
    double *positions = NULL;
    int k;
    s->swing = 6;
    for (k = 0; k < 10; k++) swing(s, t, 0);
    draw(s, &positions, t, 0);
    stage_clear_tally(s);
    for (k = 0; k <= FRAMES; k++) {
        const double share = (double)k / FRAMES, y = -2 + (n + 4.0) * share;
        const stage_tally before = s->tally;
        stage_move(s, -2.0 * n, y, 0.45 * n, 3.0 * n, y + 0.7, 0.45 * n + 1.1);
        fail("frame", s);
        t->of[CUT][k] = 1e3 * (s->tally.cutting - before.cutting);
        t->of[BLADE][k] = 1e3 * (s->tally.seconds - before.seconds) - t->of[CUT][k];
        swing(s, t, k);
        draw(s, &positions, t, k);
        t->of[ALL][k] = t->of[BLADE][k] + t->of[CUT][k] + t->of[MODEL][k] + t->of[SKIN][k];
    }
    free(positions);
}

static void measure_frames(uint32_t n) {
    static const char *const names[PHASES] = {"blade", "cut", "model", "skin", "step", "all"};
    static frame_times t;
    stage s = open_stage(n, 1, 0, NULL);
    double step;
    int i;
    pass_by_steps(&s, n, &t);
    step = median(t.of[STEP], FRAMES + 1);
    for (i = 0; i < PHASES; i++) {
        row r = row_of("frame", names[i], &s);
        r.frames = FRAMES;
        r.expected = 2;
        r.median = median(t.of[i], FRAMES + 1); /* sorts them */
        r.p95 = t.of[i][(FRAMES * 95 + 99) / 100];
        r.worst = t.of[i][FRAMES];
        r.step = step;
        r.share = r.median / step;
        if (i != ALL) r.us = r.leaves = 0;
        put(&r, "%7lu elements: %7.3f ms a frame, one in 20 above %7.3f, worst %7.3f", (unsigned long)r.elements,
            r.median, r.p95, r.worst);
    }
    stage_close(&s);
}

/* ---- tools ---- */

enum { TOOLS = 20, BALL = 12 };

typedef struct tool {
    double x[(BALL + 1) * BALL][3];
    uint32_t t[2 * BALL * (BALL + 1)][3], vertices, triangles;
} tool;

static void add_tool_triangle(tool *t, uint32_t a, uint32_t b, uint32_t c) {
    uint32_t *to = t->t[t->triangles];
    if (a == b || b == c || c == a) return;
    to[0] = a;
    to[1] = b;
    to[2] = c;
    t->triangles++;
}

/* A ball, or one of few corners: a box; its middle at 0, of diameter 2 */
static void make_tool(tool *t, uint32_t round, uint32_t tall) {
    uint32_t i, j;
    t->vertices = t->triangles = 0;
    for (j = 0; j <= tall; j++)
        for (i = 0; i < round; i++, t->vertices++) {
            const double a = 6.283185307179586 * (i + 0.37) / round,
                         b = tall > 1 ? 3.141592653589793 * j / tall : 0.785 + 1.571 * j;
            t->x[t->vertices][0] = sin(b) * cos(a);
            t->x[t->vertices][1] = sin(b) * sin(a);
            t->x[t->vertices][2] = -cos(b);
        }
    for (j = 0; j < tall; j++)
        for (i = 0; i < round; i++) {
            const uint32_t a = tall > 1 && j == 0 ? 0 : j * round + i,
                           b = tall > 1 && j == 0 ? 0 : j * round + (i + 1) % round, high = (j + 1) * round,
                           c = tall > 1 && j + 1 == tall ? high : high + (i + 1) % round,
                           d = tall > 1 && j + 1 == tall ? high : high + i;
            add_tool_triangle(t, a, b, c);
            add_tool_triangle(t, a, c, d);
        }
    for (i = 2; i < round && tall == 1; i++) { /* its floor and its ceiling */
        add_tool_triangle(t, 0, i, i - 1);
        add_tool_triangle(t, round, round + i - 1, round + i);
    }
}

/* Carves by a tool of a radius, cubes, at a place of its own in the block each time. */
static void measure_carve(const char *name, uint32_t n, uint32_t round, uint32_t tall, double radius) {
    static tool made, placed;
    stage s = open_stage(n, 1, 0, NULL);
    const stage_motion m = stage_random_motion(&s, STAGE_CALM);
    double times[TOOLS], all = 0, removed = 0;
    size_t touched = 0;
    row r;
    int i;
    make_tool(&made, round, tall);
    for (i = 0; i < TOOLS; i++) {
        const double at[3] = {n * (0.2 + 0.6 * (i % 4) / 3), n * (0.2 + 0.6 * (i / 4) / 4), n * 0.45};
        gx_surface surface;
        gx_cut_report report;
        double start;
        uint32_t v, k;
        stage_pose(&s, &m, (double)i / TOOLS);
        placed = made;
        for (v = 0; v < placed.vertices; v++)
            for (k = 0; k < 3; k++) placed.x[v][k] = at[k] + radius * made.x[v][k];
        memset(&surface, 0, sizeof surface);
        surface.vertices = placed.x[0];
        surface.vertex_count = placed.vertices;
        surface.triangles = placed.t[0];
        surface.triangle_count = placed.triangles;
        start = processor_seconds(NULL);
        check(gx_body_carve(s.body, &surface, &report, NULL));
        times[i] = 1e3 * (processor_seconds(NULL) - start);
        all += times[i];
        touched += report.touched_elements;
        removed += report.removed_volume;
        check(gx_body_view(s.body, &s.view, NULL));
    }
    r = row_of("carve", name, &s);
    r.divided = touched;
    r.us = 1e3 * all / (double)touched;
    r.leaves = r.link = 0;
    r.frames = TOOLS;
    r.median = median(times, TOOLS);
    r.worst = times[TOOLS - 1];
    r.volume = fabs(s.view.volume + removed - s.volume) / s.volume;
    put(&r, "%7lu elements: %lu divided by %d tools, %.1f us each; a tool %.2f ms, worst %.2f ms",
        (unsigned long)r.elements, (unsigned long)r.divided, TOOLS, r.us, r.median, r.worst);
    stage_close(&s);
}

/* ---- all ---- */

static void measure_costs(void) {
    static const uint32_t sizes[3] = {12, 26, 55}; /* 10,368, 105,456 and 998,250 elements */
    const int count = small ? 1 : 2;
    int i;
    for (i = 0; i < (small ? 1 : 3); i++) measure_cost(small ? 8 : sizes[i], 60);
    for (i = 0; i < count; i++) measure_cost(small ? 8 : sizes[i], 600);
    for (i = 0; i < count; i++) measure_sample(small ? 8 : sizes[i]);
    for (i = 0; i < count; i++) measure_located(small ? 8 : sizes[i]);
    for (i = 0; i < count; i++) measure_idle(small ? 8 : sizes[i]);
}

int main(int argc, char **argv) {
    const char *path = csv_arguments(argc, argv, &small);
    int i;
    csv_open(
        argv[0], path,
        "kind,name,elements,frames,tolerance,advance,fragments,expected,divided,leaves,us_per_divided,link,deviation,"
        "max_error,rms_error,median_ms,p95_ms,worst_ms,step_ms,share,ns_per_sample,volume_error,bridged");
    for (i = 0; i < STAGE_SCENES; i++) measure_scene(&stage_scenes[i]);
    measure_passes("0.02", 0.02, 1, small ? 20 : 2000);
    measure_passes("0.06", 0.06, 1, small ? 20 : 500);
    measure_passes("0.1", 0.1, 1, small ? 20 : 500);
    measure_passes("0.1 flat", 0.1, 0.2, small ? 20 : 500);
    measure_errors();
    measure_relativity(small ? 5 : 8);
    measure_costs();
    measure_frames(small ? 8 : 19); /* 41,154 elements */
    measure_carve("box", small ? 8 : 12, 4, 1, 1.3);
    measure_carve("ball", small ? 8 : 12, BALL, BALL, 1.3);
    if (!small) measure_carve("ball", 26, BALL, BALL, 1.3);
    return csv_close();
}
