/* animation: the README's animated picture. A bunny of jelly hangs by its ears and swings; curved sheets split it from
   below and slice it, and piece after piece falls.

   Nothing holds back what has been cut off: it falls out of the picture. What is left springs up. */
#include "scene.h"

enum { SLICES = 4, COLUMNS = 56, ROWS = 20 };

static const double turn = 6.283185307179586;
static const double held = 0.168;  /* m: the material above it is held */
static const double swing = 0.15;  /* m/s, along x */
static const double reach = 0.11;  /* of the sheets from the middle, m */
static const double split = 0.112; /* how far up the first cut goes, m */
static const double middle[2] = {-0.012, 0.006};

/* A sheet that waves about a height: its tilt along x and z, height and length of its waves along both, m */
typedef struct slice {
    double height, tilt[2], wave[2], length[2], from; /* from: share of the run at which it enters */
} slice;

static const slice slices[SLICES] = {{0.055, {0.006, 0.010}, {0.003, 0.003}, {0.06, 0.05}, 0.26},
                                     {0.074, {-0.014, 0.014}, {0.005, 0.003}, {0.07, 0.06}, 0.38},
                                     {0.094, {0.016, -0.010}, {0.005, 0.004}, {0.06, 0.07}, 0.50},
                                     {0.122, {0.012, 0.008}, {0.004, 0.003}, {0.05, 0.05}, 0.62}};

/* a: along x, as the sheet advances; b: along z */
static void slice_point(const void *user, double a, double b, double *x) {
    const slice *s = (const slice *)user;
    const double u = 2.0 * a - 1.0, v = 2.0 * b - 1.0;
    x[0] = middle[0] + reach * u;
    x[2] = middle[1] + reach * v;
    x[1] = s->height + s->tilt[0] * u + s->tilt[1] * v + s->wave[0] * sin(turn * reach * u / s->length[0]) +
           s->wave[1] * sin(turn * reach * v / s->length[1]);
}

/* a: upwards from below the feet; b: along z */
static void split_point(const void *user, double a, double b, double *x) {
    (void)user;
    x[1] = 0.02 + a * (split - 0.02);
    x[2] = middle[1] + reach * (2.0 * b - 1.0);
    x[0] = middle[0] + 0.005 * sin(turn * x[1] / 0.05) + 0.006 * sin(turn * x[2] / 0.08);
}

int main(int argc, char **argv) {
    const scene_desc desc = {.name = "animation",
                             .about = "A bunny hangs by its ears and is cut into slices, which fall.",
                             .mesh = "bunny",
                             .small_mesh = "bunny:0.016",
                             .any_mesh = 1,
                             .frames = 120,
                             .small_frames = 60,
                             .least_frames = 60};
    scene s;
    scene_sheet first, sheets[SLICES];
    size_t copy;
    int i;
    scene_open(&s, &desc, argc, argv);
    s.body_desc.young = 3e4;
    s.step.dt = 0.008;
    s.step.integrator = GXS_BDF2;
    s.step.newton_iterations = 2;
    s.step.gravity[1] = s.step.gravity[2];
    s.step.gravity[2] = 0.0;
    scene_make(&s);
    scene_hold(&s, 1, 1, held);
    scene_settle(&s, 1e-4);
    for (copy = 0; copy < s.view.copy_count; copy++) s.view.velocity[3 * copy] = s.view.copy_held[copy] ? 0.0 : swing;
    for (i = 0; i < SLICES; i++) sheets[i] = scene_make_sheet(&s, COLUMNS, ROWS, slice_point, &slices[i]);
    first = scene_make_sheet(&s, COLUMNS, 2 * ROWS, split_point, NULL);
    for (; s.frame < s.frames; scene_step(&s)) {
        scene_advance(&s, &first, 0.08, 0.2);
        for (i = 0; i < SLICES; i++) scene_advance(&s, &sheets[i], slices[i].from, slices[i].from + 0.09);
    }
    scene_check(&s, s.view.fragment_count >= 2 * SLICES, "fragments: %lu (at least %d)",
                (unsigned long)s.view.fragment_count, 2 * SLICES);
    scene_check_body(&s);
    scene_drop_sheet(&first);
    for (i = 0; i < SLICES; i++) scene_drop_sheet(&sheets[i]);
    return scene_close(&s);
}
