/* predicates_flags.c - the predicates of gxfem_boolean.h against exact rationals, for any compiler flags (see
   flags.sh).

       predicates_flags [CASES] [nearest|up|down|zero] [flush] [seed=S]

   For CASES near-degenerate cases (100000) times nine predicates it prints the wrong signs, nanoseconds per call by
   the filter and by the exact stage, the exact stage's share, and the share of each of the filter's bounds that true
   errors used up. Exit status 1 if a sign is wrong, a bound was exceeded, or good arithmetic is refused. */
#define GXFEM_STATIC
#define GXFEM_BOOLEAN_IMPLEMENTATION
#include "../gxfem_boolean.h"

#include "predicate_cases.h"

#include <fenv.h>
#include <time.h>
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

enum { BATCH = 512, BOUND_EVERY = 8, REPEATS = 16 };

/* [0] decided by the filter, [1] decided exactly */
typedef struct tally {
    uint64_t calls[2], timed[2], wrong;
    clock_t ticks[2];
} tally;

/* ---- does the filter decide? The same bounds as in the predicates; a difference would only show in the printed
   shares ---- */

static int filter_side(const gxb_point *point, const gxb_plane *plane) {
    double bound, value;
    if (!(point->ball.error < PC_NO_BALL)) return 0;
    value = gxbp_filter_side(&point->ball, &plane->filter, &bound);
    return gxbp_filter_sign(value, bound);
}

static int filter_orient2d(const double a[2], const double b[2], const double c[2]) {
    const double ax = gxbp_fence(a[0] - c[0]), ay = gxbp_fence(a[1] - c[1]), bx = gxbp_fence(b[0] - c[0]),
                 by = gxbp_fence(b[1] - c[1]);
    return gxbp_filter_sign(ax * by - ay * bx,
                            16 * gxbp_power(-52) * (gxbp_abs(ax * by) + gxbp_abs(ay * bx)) + gxbp_power(-600));
}

static int filter_compare(const gxb_ball *a, const gxb_ball *b, int axis) {
    const double difference = gxbp_fence(a->x[axis] - b->x[axis]);
    return gxbp_filter_sign(difference,
                            2 * (a->error + b->error) + 2 * gxbp_power(-52) * gxbp_abs(difference) + gxbp_power(-600));
}

static int filter_orient(const gxb_ball *a, const gxb_ball *b, const gxb_ball *c, const gxb_plane *plane) {
    const double *n = plane->filter.n;
    double u[3], v[3];
    const double eu = gxbp_filter_difference(u, a, b), ev = gxbp_filter_difference(v, a, c);
    int axis = 0;
    while (axis < 2 && gxbp_abs(n[axis]) < plane->filter.norm) axis++;
    {
        const int i = (axis + 1) % 3, j = (axis + 2) % 3;
        const double U = gxbp_max(gxbp_abs(u[i]), gxbp_abs(u[j])), V = gxbp_max(gxbp_abs(v[i]), gxbp_abs(v[j]));
        const double bound = 4 * (U * ev + V * eu + eu * ev) + 32 * gxbp_power(-52) * U * V + gxbp_power(-600);
        return gxbp_filter_sign(u[i] * v[j] - u[j] * v[i], bound);
    }
}

static int filter_decides(const pc_objects *k, int kind) {
    const pc_case *c = k->input;
    const double *circle[4], *sphere[5];
    int i;
    for (i = 0; i < 4; i++) circle[i] = c->circle[i];
    for (i = 0; i < 5; i++) sphere[i] = c->sphere[i];
    switch (kind) {
    case PC_ORIENT2D: return filter_orient2d(c->point, c->line[0], c->line[1]) != 0;
    case PC_ORIENT3D:
    case PC_SIDE_EXPLICIT: return filter_side(&k->point, &k->plane[3]) != 0;
    case PC_SIDE_LINE: return filter_side(&k->line, &k->plane[3]) != 0;
    case PC_SIDE_PLANES: return filter_side(&k->planes, &k->plane[3]) != 0;
    case PC_INCIRCLE: return gxbp_filter_incircle(circle) != 0;
    case PC_INSPHERE: return gxbp_filter_insphere(sphere) != 0;
    case PC_COMPARE: return filter_compare(&k->line.ball, &k->planes.ball, k->axis) != 0;
    default: return filter_orient(&k->line.ball, &k->planes.ball, &k->other.ball, &k->plane[0]) != 0;
    }
}

/* ---- a batch: inputs and exact answers first, then the calls, timed ---- */

static pc_case cases[BATCH];
static pc_objects objects[BATCH];
static signed char expected[BATCH][PC_KINDS];
static clock_t build_ticks;
static volatile int sink;

static void print_case(const pc_case *c, int kind, int axis, int got, int want) {
    const double *x = (const double *)c;
    int i;
    printf("WRONG %s (axis %d): %d instead of %d at", pc_kind_names[kind], axis, got, want);
    for (i = 0; i < PC_CASE_DOUBLES; i++) printf(" %a", x[i]);
    printf("\n");
}

static void prepare(pc_random *random, double worst[PC_BOUNDS]) {
    int i, kind;
    clock_t start;
    for (i = 0; i < BATCH; i++) {
        const rat_mark mark = rat_arena_mark();
        pc_exact exact;
        do pc_generate(random, &cases[i]);
        while (!pc_answer(&cases[i], i % 3, &exact));
        for (kind = 0; kind < PC_KINDS; kind++) expected[i][kind] = (signed char)exact.sign[kind];
        if (i % BOUND_EVERY == 0) {
            pc_build(&cases[i], i % 3, &objects[i]);
            pc_bound_shares(&objects[i], &exact, worst);
        }
        rat_arena_release(mark);
    }
    start = clock();
    for (i = 0; i < BATCH; i++) pc_build(&cases[i], i % 3, &objects[i]);
    build_ticks += clock() - start;
}

static void measure(tally *t, const int *list, int count, int kind, int stage) {
    const int repeats = stage == 0 ? REPEATS : 1;
    const clock_t start = clock();
    int i, k, sum = 0;
    for (k = 0; k < repeats; k++)
        for (i = 0; i < count; i++) sum += pc_call(&objects[list[i]], kind);
    t->ticks[stage] += clock() - start;
    t->timed[stage] += (uint64_t)(count * repeats);
    sink = sum;
}

static void run_kind(tally *t, int kind) {
    int list[2][BATCH], count[2] = {0, 0}, i, stage;
    for (i = 0; i < BATCH; i++) {
        int got;
        if (expected[i][kind] == PC_INVALID) continue;
        stage = !filter_decides(&objects[i], kind);
        list[stage][count[stage]++] = i;
        got = pc_call(&objects[i], kind);
        if (got == expected[i][kind]) continue;
        if (t->wrong++ < 3) print_case(&cases[i], kind, i % 3, got, expected[i][kind]);
    }
    for (stage = 0; stage < 2; stage++) {
        t->calls[stage] += (uint64_t)count[stage];
        measure(t, list[stage], count[stage], kind, stage);
    }
}

static double nanoseconds(clock_t ticks, uint64_t count) {
    return count == 0 ? 0 : (double)ticks / CLOCKS_PER_SEC * 1e9 / (double)count;
}

static int report(const tally *t, const double worst[PC_BOUNDS], uint64_t done) {
    uint64_t wrong = 0;
    int kind, exceeded = 0;
    for (kind = 0; kind < PC_KINDS; kind++) {
        const uint64_t calls = t[kind].calls[0] + t[kind].calls[1];
        printf("  %-21s %9.0f calls, %.0f wrong, filter %5.1f ns, exact %6.0f ns, %5.2f %% exact\n",
               pc_kind_names[kind], (double)calls, (double)t[kind].wrong,
               nanoseconds(t[kind].ticks[0], t[kind].timed[0]), nanoseconds(t[kind].ticks[1], t[kind].timed[1]),
               calls == 0 ? 0 : 100 * (double)t[kind].calls[1] / (double)calls);
        wrong += t[kind].wrong;
    }
    printf("  building 4 planes and 4 points: %.0f ns; largest share of a bound used:", nanoseconds(build_ticks, done));
    for (kind = 0; kind < PC_BOUNDS; kind++) {
        printf("%s %s %.3f", kind == 0 ? "" : ",", pc_bound_names[kind], worst[kind]);
        if (!(worst[kind] <= 1)) exceeded = 1;
    }
    printf("\nwrong signs: %.0f\n", (double)wrong);
    if (exceeded) printf("a bound was exceeded\n");
    return wrong != 0 || exceeded;
}

static int set_environment(const char *word) {
#ifdef FE_UPWARD
    if (strcmp(word, "up") == 0) return fesetround(FE_UPWARD) == 0;
    if (strcmp(word, "down") == 0) return fesetround(FE_DOWNWARD) == 0;
    if (strcmp(word, "zero") == 0) return fesetround(FE_TOWARDZERO) == 0;
#endif
#if defined(__SSE2__)
    if (strcmp(word, "flush") == 0) {
        _mm_setcsr(_mm_getcsr() | 0x8040);
        return 1;
    }
#endif
    return strcmp(word, "nearest") == 0;
}

int main(int argc, char **argv) {
    static tally tallies[PC_KINDS];
    double worst[PC_BOUNDS] = {0, 0, 0, 0};
    uint64_t wanted = 100000, done, seed = 1;
    pc_random random;
    int i, kind;
    for (i = 1; i < argc; i++) {
        if (argv[i][0] >= '0' && argv[i][0] <= '9')
            wanted = strtoull(argv[i], NULL, 10);
        else if (strncmp(argv[i], "seed=", 5) == 0)
            seed = strtoull(argv[i] + 5, NULL, 10);
        else if (!set_environment(argv[i])) {
            fprintf(stderr, "predicates_flags: %s: not known here\n", argv[i]);
            return 2;
        }
    }
    if (!gxbp_arithmetic_holds(1)) {
        printf("the trial of arithmetic fails\n");
        return 1;
    }
    random = pc_seeded(seed);
    for (done = 0; done < wanted; done += BATCH) {
        prepare(&random, worst);
        for (kind = 0; kind < PC_KINDS; kind++) run_kind(&tallies[kind], kind);
    }
    printf("%.0f cases, seed %.0f\n", (double)done, (double)seed);
    return report(tallies, worst, done);
}
